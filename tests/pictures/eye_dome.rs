//! Eye-dome lighting and the grid: the expected images of constructed scenes, and both renderers against each other.

use crate::common::{self, Surfel, camera_at, draw, draw_on_cpu, sphere, surfels};
use glam::{DVec3, Vec3};
use image::RgbaImage;
use pointreel::cloud::{PointRecord, VoxelRecord};
use pointreel::measure::{mean_squared_error, psnr_db};
use pointreel::scene::{
    Background, Camera, Content, EyeDome, GroundPlane, Lighting, PointStyle, Primitive, Projection, ScenePacket,
    Settings, Splatting, Strategy, Style, UpAxis,
};
use std::sync::Arc;

const GRAY: [u8; 3] = [200; 3];

/// A GPU rounds the summed colours to half floats, and positions to a 256th of a pixel.
const MIN_PSNR_DB: f64 = 48.0;

/// A pixel that rounding puts to the other side of an edge changes the light of eight more.
const MAX_DIFFERING: f64 = 2e-3;

/// The same for points, whose centres are rounded before their pixel is determined, and for voxels, which are edges
/// everywhere.
const MIN_PSNR_OF_EDGES_DB: f64 = 35.0;
const MAX_DIFFERING_OF_EDGES: f64 = 5e-3;

/// Maximum difference of a channel where pixels count as equal.
const STEP: u8 = 4;

fn keep(picture: &RgbaImage, name: &str) {
    if let Some(folder) = std::env::var_os("POINTREEL_KEEP_PICTURES") {
        let path = std::path::Path::new(&folder).join(format!("{name}.png"));
        picture.save(path).unwrap();
    }
}

#[track_caller]
fn assert_same_picture(packet: &ScenePacket, name: &str) {
    let (gpu, cpu) = (draw(packet), draw_on_cpu(packet));
    keep(&gpu, &format!("{name}_gpu"));
    keep(&cpu, &format!("{name}_cpu"));
    let psnr = psnr_db(mean_squared_error(&gpu, &cpu).unwrap());
    let differs = |(a, b): (&image::Rgba<u8>, &image::Rgba<u8>)| a.0.iter().zip(b.0).any(|(a, b)| a.abs_diff(b) > STEP);
    let differing = gpu.pixels().zip(cpu.pixels()).filter(|&pair| differs(pair)).count();
    let share = differing as f64 / f64::from(gpu.width() * gpu.height());
    let (least, most) = match packet.style.primitive {
        Primitive::Point | Primitive::Mesh | Primitive::Voxel => (MIN_PSNR_OF_EDGES_DB, MAX_DIFFERING_OF_EDGES),
        Primitive::Surfel | Primitive::Ellipse | Primitive::Sprite => (MIN_PSNR_DB, MAX_DIFFERING),
    };
    assert!(
        psnr >= least && share <= most,
        "{name}: {psnr:.1} dB, {share:.5} differ"
    );
}

fn lit() -> Style {
    Style::default().with(|style| {
        style.light.eye_dome = EyeDome::On;
        style.light.lighting = Lighting::Unlit;
        style.backdrop.background = Background::solid([30, 60, 90]);
    })
}

fn of_points() -> Style {
    Style {
        primitive: Primitive::Point,
        points: PointStyle {
            size_px: 3.0,
            ..PointStyle::default()
        },
        ..lit()
    }
}

/// Points two pixels apart in two planes across the view axis: left of it at `depths[0]` from the target towards the
/// eye, right of it at `depths[1]`. Seen from `unit` × 4 units away.
fn step(depths: [f32; 2], unit: f32, size: [u32; 2], projection: Projection) -> ScenePacket {
    let camera = Camera {
        projection,
        fov_deg: 45.0,
        ..camera_at(4.0 * f64::from(unit))
    };
    let px = 4.0 * 2.0 * (22.5f32).to_radians().tan() / size[1] as f32;
    let [columns, rows] = size.map(|edge| edge as i32 / 2 + 20);
    let mut points = Vec::new();
    for row in -rows / 2..rows / 2 {
        for column in -columns / 2..columns / 2 {
            // No point is closer to the axis than the extent of its square.
            let right = 2.0 * column as f32 + 1.0 + 0.5 * (2.0 * column as f32 + 1.0).signum();
            let depth = depths[usize::from(column >= 0)];
            let place = Vec3::new(right * px, (2.0 * row as f32 + 0.5) * px, depth);
            points.push(Surfel {
                position: place * unit,
                normal: Vec3::Z,
                radius: 0.1,
                color: GRAY,
            });
        }
    }
    surfels(&points, &camera, of_points(), size)
}

const STEP_SIZE: [u32; 2] = [64, 720];

/// The channel of the central row, column by column.
fn center_row(picture: &RgbaImage) -> Vec<u8> {
    let y = picture.height() / 2;
    (0..picture.width()).map(|x| picture.get_pixel(x, y).0[0]).collect()
}

#[test]
fn a_step_is_as_dark_as_the_formula_says() {
    let packet = step([0.0, -0.04], 1.0, STEP_SIZE, Projection::Perspective);
    // Three of eight neighbours are 1 % nearer: one in the row at 1.4 px, two at √2 px.
    let steps = 300.0 / 8.0 * 0.01 * (1.4 + 2.0 * 1.4 / 2f32.sqrt());
    let expected = 200.0 * (-steps).exp();
    assert!((40.0..160.0).contains(&expected), "{expected}");
    for (by, picture) in [("CPU", draw_on_cpu(&packet)), ("GPU", draw(&packet))] {
        let row = center_row(&picture);
        let edge = row.iter().position(|&channel| channel != 200).unwrap();
        assert!(
            (f32::from(row[edge]) - expected).abs() < 2.0,
            "{by}: {row:?} {expected}"
        );
        // A single pixel next to the step, on its far side.
        let dark = row.iter().filter(|&&channel| channel != 200).count();
        assert!(dark == 1 && (31..=33).contains(&edge), "{by}: {row:?}");
    }
}

#[test]
fn a_plane_that_is_seen_face_on_keeps_its_colors() {
    let packet = step([0.0, 0.0], 1.0, STEP_SIZE, Projection::Perspective);
    for picture in [draw_on_cpu(&packet), draw(&packet)] {
        let [width, height] = STEP_SIZE;
        assert_eq!(common::count_color(&picture, GRAY), (width * height) as usize);
    }
}

#[test]
fn a_deep_step_retains_some_color_and_an_infinite_one_is_an_edge() {
    let dark_of = |depth: f32| {
        let packet = step([0.0, depth], 1.0, STEP_SIZE, Projection::Perspective);
        let row = center_row(&draw_on_cpu(&packet));
        *row.iter().min().unwrap()
    };
    // 6 % of the colour, regardless of the depth of the step.
    assert!((10..=14).contains(&dark_of(-0.5)), "{}", dark_of(-0.5));
    assert_eq!(dark_of(-0.5), dark_of(-1.5));

    // Only background on the right.
    let mut packet = step([0.0, 0.0], 1.0, STEP_SIZE, Projection::Perspective);
    packet.style.points.size_px = 2.0;
    let points = packet.content.points().unwrap();
    let left = points.iter().filter(|point| point.position[0] < 0.0);
    packet.content = Content::Points(std::sync::Arc::new(left.copied().collect()));
    let behind = packet.style.backdrop.background.top;
    for picture in [draw_on_cpu(&packet), draw(&packet)] {
        let row = center_row(&picture);
        let end = row.iter().position(|&channel| channel == behind[0]).unwrap();
        let edge = 200.0 * (-0.5f32).exp();
        assert!((f32::from(row[end - 1]) - edge).abs() < 1.0, "{row:?}");
        assert!(row[..end - 1].iter().all(|&channel| channel == 200));
        assert!(row[end..].iter().all(|&channel| channel == behind[0]));
    }
}

#[test]
fn a_wide_isolated_point_has_one_color() {
    for size_px in [3.0, 6.0, 10.0] {
        let mut packet = step([0.0, 0.0], 1.0, STEP_SIZE, Projection::Perspective);
        packet.style.points.size_px = size_px;
        let points = Arc::clone(packet.content.points().unwrap());
        packet.content = Content::Points(Arc::new(vec![PointRecord {
            position: [0.0; 3],
            ..points[0]
        }]));
        for picture in [draw_on_cpu(&packet), draw(&packet)] {
            let edge = size_px as usize;
            assert_eq!(common::count_color(&picture, GRAY), edge * edge, "{size_px}");
        }
    }
}

#[test]
fn light_does_not_depend_on_the_unit_and_little_on_the_projection() {
    let packet = |unit, projection| step([0.02, -0.02], unit, STEP_SIZE, projection);
    let expected = draw_on_cpu(&packet(1.0, Projection::Perspective));
    for unit in [1e-6, 1e6] {
        let picture = draw_on_cpu(&packet(unit, Projection::Perspective));
        let (_, most) = common::difference(&picture, &expected);
        assert!(most <= 1, "{unit}: {most}");
    }
    let darkest = |picture: &RgbaImage| f32::from(*center_row(picture).iter().min().unwrap());
    for picture in [
        draw_on_cpu(&packet(1.0, Projection::Orthographic)),
        draw(&packet(1.0, Projection::Orthographic)),
    ] {
        let [parallel, central] = [darkest(&picture), darkest(&expected)];
        assert!((parallel - central).abs() < 3.0, "{parallel} {central}");
    }
}

#[test]
fn off_and_undecided_auto_draw_no_shading() {
    let scene = sphere(2000, 1.0);
    let picture = |eye_dome, eye_dome_strength| {
        let style = lit().with(|style| {
            style.light.eye_dome = eye_dome;
            style.light.eye_dome_strength = eye_dome_strength;
        });
        draw_on_cpu(&surfels(&scene, &camera_at(2.0), style, [200, 150]))
    };
    let off = picture(EyeDome::Off, 1.0);
    assert_eq!(picture(Settings::default().decided().light.eye_dome, 1.0), off);
    assert_eq!(picture(EyeDome::On, 0.0), off);
    let on = picture(EyeDome::On, 1.0);
    assert!(common::difference(&on, &off).0 > 1000);
}

fn ball(style: Style) -> ScenePacket {
    let camera = Camera {
        azimuth_deg: 25.0,
        elevation_deg: 17.0,
        ..camera_at(1.9)
    };
    surfels(&sphere(3000, 1.0), &camera, style, [301, 223])
}

#[test]
fn both_renderers_light_surfels_alike_in_every_mode() {
    for &splatting in Splatting::ALL {
        let style = lit().with(|style| {
            style.surfels.splatting = splatting;
            style.light.lighting = Lighting::PerFragment;
        });
        assert_same_picture(&ball(style), &format!("dome_{splatting}"));
    }
    for &strategy in Strategy::ALL {
        let style = lit().with(|style| style.drawing.strategy = strategy);
        assert_same_picture(&ball(style), &format!("dome_{strategy}"));
    }
}

#[test]
fn both_renderers_light_points_and_voxels_alike() {
    for point_size_px in [1.0, 4.0] {
        let style = Style {
            points: PointStyle {
                size_px: point_size_px,
                ..PointStyle::default()
            },
            ..of_points()
        };
        assert_same_picture(&ball(style), &format!("dome_points_{point_size_px}"));
    }
    let cells = (0..16 * 16).map(|cell| {
        let (x, y) = ((cell % 16) as f32, (cell / 16) as f32);
        VoxelRecord {
            center: [
                x / 8.0 - 0.9375,
                ((x * 0.7).sin() + (y * 0.5).cos()) * 0.2,
                y / 8.0 - 0.9375,
            ],
            color: [220, 160, 80],
            level: 4,
        }
    });
    let camera = Camera {
        elevation_deg: 40.0,
        ..camera_at(2.0)
    };
    let style = Style {
        primitive: Primitive::Voxel,
        ..lit()
    };
    let packet = common::voxels(cells.collect(), 2.0, &camera, style, [301, 223]);
    assert_same_picture(&packet, "dome_voxels");
}

fn with_grid(mut packet: ScenePacket) -> ScenePacket {
    let background = packet.style.backdrop.background;
    packet.style.backdrop.grid = true;
    packet.ground = Some(GroundPlane::under(&packet.bounds, DVec3::ZERO, UpAxis::Y, background));
    packet
}

#[test]
fn both_renderers_draw_the_same_grid_and_what_is_before_it_hides_it() {
    for eye_dome in [EyeDome::On, EyeDome::Off] {
        for primitive in [Primitive::Surfel, Primitive::Point] {
            let style = of_points().with(|style| {
                style.primitive = primitive;
                style.light.eye_dome = eye_dome;
            });
            let packet = with_grid(ball(style));
            assert_same_picture(&packet, &format!("grid_{primitive}_{eye_dome}"));
        }
    }
    let no_depth = lit().with(|style| style.surfels.splatting = Splatting::NoDepth);
    assert_same_picture(&with_grid(ball(no_depth)), "grid_no_depth");

    let hides = ball(lit().with(|style| style.light.eye_dome = EyeDome::Off));
    let (plain, lined) = (draw_on_cpu(&hides), draw_on_cpu(&with_grid(hides)));
    // The centre of the ball is in front of the plane, which is seen from above.
    let midpoint = |picture: &RgbaImage| *picture.get_pixel(150, 111);
    assert_eq!(midpoint(&plain), midpoint(&lined));
    assert!(common::difference(&plain, &lined).0 > 1000);
}

/// Seen from straight above, lines are where their coordinates project to.
#[test]
fn lines_are_at_multiples_of_the_spacing() {
    let camera = Camera {
        elevation_deg: 90.0,
        ..camera_at(2.0)
    };
    let size = [200, 200];
    let mut packet = surfels(&[], &camera, lit(), size);
    packet.bounds = pointreel::math::Aabb {
        min: Vec3::new(-5.0, 0.0, -5.0),
        max: Vec3::new(5.0, 1.0, 5.0),
    };
    let packet = with_grid(packet);
    let ground = packet.ground.unwrap();
    assert_eq!((ground.spacing, ground.point_in_frame), (1.0, Vec3::ZERO));
    // At a distance of 2 and with 90 degrees, 4 units are 200 px: of lines 50 px apart, one is between the two central
    // columns.
    for (by, picture) in [("CPU", draw_on_cpu(&packet)), ("GPU", draw(&packet))] {
        let bright = |x: u32| f32::from(picture.get_pixel(x, 75).0[0]);
        for (line, opacity) in [(50, 0.4), (100, 0.6), (150, 0.4)] {
            // It covers half of either pixel, with this opacity; every tenth line is stronger.
            let red = 255.0 * ground.color[0];
            let expected = 30.0 + 0.5 * opacity * (red - 30.0);
            for pixel in [line - 1, line] {
                let found = bright(pixel);
                assert!((found - expected).abs() <= 1.5, "{by} {pixel}: {found} {expected}");
            }
            // Finer lines are five pixels apart, and barely visible.
            assert!(bright(line - 3) < 40.0, "{by} {line}: {}", bright(line - 3));
        }
    }
}
