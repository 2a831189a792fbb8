//! A closed white surface without light is white: for every primitive and blending mode, no pixel that the truth
//! covers with all its samples is darker than white.
//!
//! Held: every primitive, every mode of splatting, both renderers and every strategy; and every primitive in white
//! light from all sides, in each deferred lighting, and with antialiasing. Modes of one pass are not white
//! on purpose, and are held to be so; `visibility` shows depths and no colours. `two-pass` fades at the edges of its
//! disks, and so where three of them only just meet: held to be few pixels.

use crate::common::{camera_at, draw, draw_on_cpu, plain};
use glam::{DVec3, Vec3};
use image::RgbaImage;
use pointreel::cloud::{
    Attributes, Frame, MeshRecords, PointRecord, Positions, RawCloud, ShapeRecord, TriangleRecord, VertexRecord,
    decode_ellipse, oct_encode,
};
use pointreel::levels::Lod;
use pointreel::render::truth::{Disks, RayTraced, Truth, TruthView};
use pointreel::scene::{
    Antialiasing, Background, Camera, CodeStyle, Content, DrawingStyle, Environment, Footprint, Kernel, LevelStyle,
    LightRig, Lighting, PointLight, PointShape, PointStyle, Primitive, RendererChoice, Scene, ScenePacket, SplatFilter,
    SplatGeometry, Splatting, Strategy, Style, VoxelLight,
};
use pointreel::sequence::{ColorSource, PrepareCounters, PreparedFrame, Sequence, Shape, prepare};
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

const SIZE: [u32; 2] = [240, 200];

/// The maximum that rounding to bytes may take from white.
const MIN_WHITE: u8 = 254;

/// The modes that blend beyond the edges of touching disks, or blend nothing.
const CLOSING: [Splatting; 3] = [Splatting::Enlarged, Splatting::TwoPassEnlarged, Splatting::Opaque];

/// A unit sphere whose points are at random positions and white, prepared for a style: radii are estimated.
fn white_sphere(count: usize, style: &Style) -> PreparedFrame {
    let sampled = Sequence::of(Shape::Sphere.frame(count)).frame(0).unwrap();
    let positions: Vec<[f32; 3]> = sampled.positions().iter().map(Vec3::to_array).collect();
    let raw = RawCloud {
        attributes: Attributes {
            colors: Some(vec![[255; 4]; count]),
            normals: Some(positions.clone()),
            ..Attributes::default()
        },
        ..RawCloud::from_positions(Positions::F32(positions))
    };
    let frame = Frame::from_raw(raw, DVec3::ZERO).unwrap();
    let needs = Scene::needs(style);
    prepare(0, Arc::new(frame), 0.0, &needs, &PrepareCounters::default())
}

fn camera() -> Camera {
    Camera {
        azimuth_deg: 20.0,
        elevation_deg: -35.0,
        ..camera_at(1.8)
    }
}

/// Pixels whose samples all meet something.
fn covered_by(truth_on: impl Fn(&TruthView) -> Truth) -> Vec<bool> {
    let [on_black, on_white] = [[0; 3], [255; 3]].map(|color| {
        let background = Background::solid(color);
        truth_on(&TruthView::new(
            &camera(),
            DVec3::ZERO,
            SIZE,
            Lighting::Unlit,
            background,
        ))
        .image
    });
    on_black
        .pixels()
        .zip(on_white.pixels())
        .map(|(black, white)| black == white)
        .collect()
}

fn covered_by_disks(points: &[PointRecord], shapes: &[ShapeRecord]) -> Vec<bool> {
    let disks = Disks {
        points,
        shapes,
        are_ellipses: false,
        cull_back_faces: true,
    };
    covered_by(|view| Truth::of_disks(&disks, view))
}

fn covered_by_sphere() -> Vec<bool> {
    let sphere = RayTraced {
        shape: Shape::Sphere,
        cull_back_faces: true,
    };
    covered_by(|view| Truth::of_shape(sphere, view, 0.0))
}

/// Without light, on black. White alone would not be taken for colours.
fn white() -> Style {
    Style {
        colors: ColorSource::File.into(),
        ..plain()
    }
}

fn packet_of(frame: &PreparedFrame, style: &Style) -> ScenePacket {
    Scene::default().packet(frame, DVec3::ZERO, &camera(), style, SIZE)
}

/// Number of covered pixels darker than white, and the value of the darkest.
fn darker(picture: &RgbaImage, is_covered: &[bool]) -> (usize, u8) {
    let covered = picture.pixels().zip(is_covered).filter(|&(_, &is_covered)| is_covered);
    let darkest = covered.map(|(pixel, _)| pixel.0[..3].iter().copied().min().unwrap());
    darkest.fold((0, 255), |(count, min), channel| {
        (count + usize::from(channel < MIN_WHITE), min.min(channel))
    })
}

#[track_caller]
fn assert_white(picture: &RgbaImage, is_covered: &[bool], what: &str) {
    let all = is_covered.iter().filter(|&&is_covered| is_covered).count();
    assert!(all > 10_000, "{what}: {all} pixels are covered");
    let (count, darkest) = darker(picture, is_covered);
    assert!(
        count == 0,
        "{what}: {count} of {all} are darker than white, the darkest {darkest}"
    );
}

fn in_mode(splatting: Splatting) -> Style {
    white().with(|style| style.surfels.splatting = splatting)
}

fn with_strategy(style: &Style, strategy: Strategy) -> Style {
    style.with(|style| style.drawing.strategy = strategy)
}

/// The image of the CPU, and of each strategy of the GPU.
fn for_each_picture(frame: &PreparedFrame, style: &Style, mut check: impl FnMut(&RgbaImage, &str)) {
    check(&draw_on_cpu(&packet_of(frame, style)), "processor");
    for &strategy in Strategy::ALL {
        let packet = packet_of(frame, &with_strategy(style, strategy));
        check(&draw(&packet), strategy.name());
    }
}

/// Coarse disks are large compared with pixels, so that some are in the corners where three disks only just meet.
#[test]
fn surfels_in_the_modes_that_close_surfaces_are_white() {
    for count in [300, 3_000, 30_000] {
        let frame = white_sphere(count, &white());
        let is_covered = covered_by_disks(&frame.points, frame.shapes.as_ref().unwrap());
        for splatting in CLOSING {
            for_each_picture(&frame, &in_mode(splatting), |picture, by| {
                assert_white(picture, &is_covered, &format!("{count} surfels, {splatting}, {by}"));
            });
        }
    }
}

#[test]
fn sprites_in_the_modes_that_close_surfaces_are_white() {
    for count in [300, 3_000] {
        let frame = white_sphere(count, &white());
        let is_covered = covered_by_disks(&frame.points, frame.shapes.as_ref().unwrap());
        for splatting in CLOSING {
            let style = in_mode(splatting).with(|style| style.primitive = Primitive::Sprite);
            for_each_picture(&frame, &style, |picture, by| {
                assert_white(picture, &is_covered, &format!("{count} sprites, {splatting}, {by}"));
            });
        }
    }
}

/// Of disks that are not enlarged, three edges sum up to less than opaque.
#[test]
fn two_pass_surfels_are_white_except_for_corners_between_disks() {
    for (count, max_share) in [(300, 0.05), (3_000, 0.003), (30_000, 0.001)] {
        let frame = white_sphere(count, &white());
        let is_covered = covered_by_disks(&frame.points, frame.shapes.as_ref().unwrap());
        let all = is_covered.iter().filter(|&&is_covered| is_covered).count();
        for_each_picture(&frame, &in_mode(Splatting::TwoPass), |picture, by| {
            let (darker, _) = darker(picture, &is_covered);
            assert!(
                darker as f64 <= max_share * all as f64,
                "{count} surfels, {by}: {darker} of {all}"
            );
        });
    }
}

/// Pixels that are covered with all that are around them.
fn inner(is_covered: &[bool]) -> Vec<bool> {
    let [width, height] = SIZE.map(|edge| edge as usize);
    let around = |at: usize, edge: usize| at.saturating_sub(1)..(at + 2).min(edge);
    let is_inner = |x: usize, y: usize| {
        let mut rows = around(y, height);
        rows.all(|y| around(x, width).all(|x| is_covered[width * y + x]))
    };
    (0..width * height).map(|at| is_inner(at % width, at / width)).collect()
}

/// The filter reaches less than a pixel beyond outlines, so it takes white from as far inside.
#[test]
fn filtered_surfels_in_the_modes_that_close_surfaces_are_white_inside_outlines() {
    for count in [3_000, 30_000, 300_000] {
        let frame = white_sphere(count, &white());
        let is_covered = inner(&covered_by_disks(&frame.points, frame.shapes.as_ref().unwrap()));
        for splatting in [Splatting::Enlarged, Splatting::TwoPassEnlarged] {
            let style = in_mode(splatting).with(|style| style.surfels.filter = SplatFilter::Ewa);
            for_each_picture(&frame, &style, |picture, by| {
                assert_white(
                    picture,
                    &is_covered,
                    &format!("{count} filtered surfels, {splatting}, {by}"),
                );
            });
        }
    }
}

/// Everything covered by the largest disks in the ellipses is covered by the ellipses.
#[test]
fn ellipses_in_the_modes_that_close_surfaces_are_white() {
    let of_ellipses = |splatting| in_mode(splatting).with(|style| style.primitive = Primitive::Ellipse);
    let frame = white_sphere(3_000, &of_ellipses(Splatting::Enlarged));
    let shapes = frame.shapes.as_ref().unwrap();
    assert!(shapes.iter().filter(|shape| shape.ellipse != 0).count() > 2_000);
    let inscribed: Vec<ShapeRecord> = shapes
        .iter()
        .map(|shape| {
            let ellipse = decode_ellipse(shape.normal, shape.ellipse);
            let [_, radius] = ellipse.half_axes_of_quadratic_mean(shape.radius);
            ShapeRecord { radius, ..*shape }
        })
        .collect();
    let is_covered = covered_by_disks(&frame.points, &inscribed);
    for splatting in CLOSING {
        for_each_picture(&frame, &of_ellipses(splatting), |picture, by| {
            assert_white(picture, &is_covered, &format!("ellipses, {splatting}, {by}"));
        });
    }
}

#[test]
fn surfels_of_every_geometry_are_white() {
    let frame = white_sphere(3_000, &white());
    let is_covered = covered_by_disks(&frame.points, frame.shapes.as_ref().unwrap());
    for &geometry in SplatGeometry::ALL {
        for splatting in CLOSING {
            let style = in_mode(splatting).with(|style| style.surfels.geometry = geometry);
            for_each_picture(&frame, &style, |picture, by| {
                assert_white(picture, &is_covered, &format!("{geometry}, {splatting}, {by}"));
            });
        }
    }
}

#[test]
fn weakly_enlarged_surfels_are_white() {
    let frame = white_sphere(300, &white());
    let is_covered = covered_by_disks(&frame.points, frame.shapes.as_ref().unwrap());
    for enlargement in [1.45, 1.6] {
        for splatting in [Splatting::Enlarged, Splatting::TwoPassEnlarged] {
            let mut style = in_mode(splatting);
            style.surfels.enlargement = enlargement;
            let packet = packet_of(&frame, &style);
            for (picture, by) in [(draw_on_cpu(&packet), "processor"), (draw(&packet), "GPU")] {
                assert_white(&picture, &is_covered, &format!("{splatting} by {enlargement}, {by}"));
            }
        }
    }
}

/// Where masks are opacities, the background shines through their edges: Fig. 3 (a) and (b) of the paper show that.
#[test]
fn one_pass_shows_the_artefacts_of_the_paper() {
    let frame = white_sphere(3_000, &white());
    let is_covered = covered_by_disks(&frame.points, frame.shapes.as_ref().unwrap());
    for splatting in [Splatting::Regular, Splatting::NoDepth] {
        for_each_picture(&frame, &in_mode(splatting), |picture, by| {
            let (count, _) = darker(picture, &is_covered);
            assert!(count > 1000, "{splatting}, {by}: {count}");
        });
    }
}

#[test]
fn points_of_any_shape_are_white() {
    let is_covered = covered_by_sphere();
    for &shape in PointShape::ALL {
        let style = Style {
            primitive: Primitive::Point,
            points: PointStyle {
                size_px: 14.0,
                shape,
                ..PointStyle::default()
            },
            ..white()
        };
        let frame = white_sphere(10_000, &style);
        for_each_picture(&frame, &style, |picture, by| {
            assert_white(picture, &is_covered, &format!("points, {shape}, {by}"));
        });
    }
}

#[test]
fn voxels_are_white() {
    let style = Style {
        primitive: Primitive::Voxel,
        ..white()
    };
    let frame = white_sphere(30_000, &style);
    let is_covered = covered_by_sphere();
    for_each_picture(&frame, &style, |picture, by| {
        assert_white(picture, &is_covered, &format!("voxels, {by}"));
    });
}

/// White triangles on the sphere, from pole to pole.
fn white_mesh(style: &Style) -> ScenePacket {
    const COLUMNS: u32 = 240;
    const ROWS: u32 = 120;
    let place = |row: u32, column: u32| {
        let (latitude, longitude) = (f64::from(row) / f64::from(ROWS), f64::from(column) / f64::from(COLUMNS));
        let (height, ring) = ((PI * latitude).cos(), (PI * latitude).sin());
        DVec3::new(ring * (TAU * longitude).sin(), height, ring * (TAU * longitude).cos()).as_vec3()
    };
    let vertices = (0..=ROWS).flat_map(|row| (0..COLUMNS).map(move |column| [row, column]));
    let vertices = vertices.map(|[row, column]| VertexRecord {
        position: place(row, column).to_array(),
        color: [255; 4],
        texture_place: [0.0; 2],
        normal: oct_encode(place(row, column).normalize()),
        texture: VertexRecord::NO_TEXTURE,
    });
    let vertices: Vec<VertexRecord> = vertices.collect();
    let quads = (0..ROWS).flat_map(|row| (0..COLUMNS).map(move |column| [row, column]));
    let triangles = quads.flat_map(|[row, column]| {
        let at = |row: u32, column: u32| COLUMNS * row + column % COLUMNS;
        let [a, b] = [at(row, column), at(row, column + 1)];
        let [c, d] = [at(row + 1, column), at(row + 1, column + 1)];
        [[a, c, b], [b, c, d]]
    });
    let normal_of = |corners: [u32; 3]| {
        let places = corners.map(|corner| Vec3::from_array(vertices[corner as usize].position));
        places.iter().sum::<Vec3>().normalize()
    };
    let triangles: Vec<TriangleRecord> = triangles
        .map(|corners| TriangleRecord {
            corners,
            normal: oct_encode(normal_of(corners)),
        })
        .collect();
    let mesh = MeshRecords::new(Arc::new(vertices), Arc::new(triangles));
    let frame = white_sphere(100, style);
    ScenePacket {
        content: Content::Mesh(Arc::new(mesh)),
        ..packet_of(&frame, style)
    }
}

/// All that closes a surface, by its name; each with the points that it needs.
fn closing_styles() -> Vec<(String, Style, usize)> {
    let of_points = |shape| {
        white().with(|style| {
            style.primitive = Primitive::Point;
            style.points.size_px = 14.0;
            style.points.shape = shape;
            style.points.light = PointLight::Normals;
        })
    };
    let of_voxels = |light| {
        white().with(|style| {
            style.primitive = Primitive::Voxel;
            style.voxels.light = light;
        })
    };
    let surfels = CLOSING
        .iter()
        .map(|&mode| (format!("surfels, {mode}"), in_mode(mode), 3_000));
    let ellipses = CLOSING.iter().map(|&mode| {
        let style = in_mode(mode).with(|style| style.primitive = Primitive::Ellipse);
        (format!("ellipses, {mode}"), style, 3_000)
    });
    let points = PointShape::ALL
        .iter()
        .map(|&shape| (format!("{shape} points"), of_points(shape), 10_000));
    let voxels = VoxelLight::ALL
        .iter()
        .map(|&light| (format!("voxels lit by {light}"), of_voxels(light), 30_000));
    let mesh = white().with(|style| style.primitive = Primitive::Mesh);
    let filtered = in_mode(Splatting::Enlarged).with(|style| style.surfels.filter = SplatFilter::Ewa);
    surfels
        .chain(ellipses)
        .chain(points)
        .chain(voxels)
        .chain([
            ("mesh".to_owned(), mesh, 0),
            ("filtered surfels".to_owned(), filtered, 30_000),
        ])
        .collect()
}

/// Draws each of them as a style makes it, and checks the pixels inside of the outline of the sphere.
fn for_each_closing_style(change: impl Fn(&mut Style), strategies: &[Strategy]) {
    let is_covered = inner(&inner(&inner(&covered_by_sphere())));
    for (what, style, count) in closing_styles() {
        let style = style.with(&change);
        let packet = |style: &Style| match style.primitive {
            Primitive::Mesh => white_mesh(style),
            _ => packet_of(&white_sphere(count, style), style),
        };
        assert_white(
            &draw_on_cpu(&packet(&style)),
            &is_covered,
            &format!("{what}, processor"),
        );
        for &strategy in strategies {
            let picture = draw(&packet(&with_strategy(&style, strategy)));
            assert_white(&picture, &is_covered, &format!("{what}, {strategy}"));
        }
    }
}

#[test]
fn closed_surfaces_are_white_without_light() {
    for_each_closing_style(|_| {}, Strategy::ALL);
}

/// Under white light from all sides a white surface is white, in every lighting that light from all sides is of.
#[test]
fn closed_surfaces_are_white_in_white_light_from_all_sides() {
    for lighting in [Lighting::Lambert, Lighting::BlinnPhong] {
        let light = |style: &mut Style| {
            style.light.lighting = lighting;
            style.light.rig = LightRig::None;
        };
        for_each_closing_style(light, &[Strategy::Vertex]);
    }
    for (metallic, roughness) in [(0.0, 0.5), (1.0, 0.2), (1.0, 1.0), (0.5, 0.7)] {
        let light = |style: &mut Style| {
            style.light.lighting = Lighting::Physical;
            style.light.rig = LightRig::None;
            style.light.environment = Environment::Uniform;
            (style.light.metallic, style.light.roughness) = (metallic, roughness);
        };
        for_each_closing_style(light, &[Strategy::Vertex]);
    }
}

#[test]
fn closed_surfaces_are_white_with_antialiasing() {
    for antialiasing in [Antialiasing::Fxaa, Antialiasing::Supersample] {
        for_each_closing_style(|style| style.drawing.antialiasing = antialiasing, &[Strategy::Vertex]);
    }
}

/// Of each kernel, in the modes that close surfaces.
#[test]
fn kernels_are_white() {
    let frame = white_sphere(3_000, &white());
    let is_covered = covered_by_disks(&frame.points, frame.shapes.as_ref().unwrap());
    for &kernel in Kernel::ALL {
        for splatting in CLOSING {
            let style = in_mode(splatting).with(|style| style.surfels.kernel = kernel);
            for_each_picture(&frame, &style, |picture, by| {
                assert_white(picture, &is_covered, &format!("{kernel}, {splatting}, {by}"));
            });
        }
    }
}

/// As exact disks and as masks: pixels of single cells are not a surface.
#[test]
fn byte_codes_are_white() {
    for footprint in [Footprint::Disks, Footprint::Masks] {
        for splatting in [Splatting::Enlarged, Splatting::TwoPassEnlarged] {
            let style = Style {
                levels: LevelStyle {
                    lod: Lod::ThresholdPx(0.0),
                    ..white().levels
                },
                codes: CodeStyle {
                    footprint,
                    ..white().codes
                },
                drawing: DrawingStyle {
                    renderer: RendererChoice::Cpu,
                    ..white().drawing
                },
                ..in_mode(splatting)
            };
            let frame = white_sphere(30_000, &style);
            let picture = draw_on_cpu(&packet_of(&frame, &style));
            let what = format!("byte codes as {footprint}, {splatting}");
            let is_covered = covered_by_disks(&frame.points, frame.shapes.as_ref().unwrap());
            assert_white(&picture, &is_covered, &what);
        }
    }
}
