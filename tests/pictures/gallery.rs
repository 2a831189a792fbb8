//! The initial view of any input: each dataset of `../shared/data` and generated clouds that mislead, with default
//! settings. The visible fraction of a cloud is counted point by point.

#![allow(clippy::print_stdout, reason = "what was measured, for `--nocapture`")]

use crate::data::shared;
use glam::{DVec3, Vec3};
use pointreel::cloud::{Positions, RawCloud};
use pointreel::headless::{CameraChoice, Headless};
use pointreel::math::Aabb;
use pointreel::render::AnyRenderer;
use pointreel::scene::{
    BackFaces, Backdrop, Background, Camera, CaptureKind, FirstLook, Primitive, RendererChoice, Settings, Style, UpAxis,
};
use pointreel::sequence::{FrameEntry, Loader, LoaderOptions, OpenOptions, Sequence, Shape};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

const SIZE_PX: [u32; 2] = [960, 600];

/// Figures of an initial view.
struct Shown {
    look: Arc<FirstLook>,
    /// Fraction of the finite points of the first frame that are within the image.
    inside: f64,
    /// The same of those within the trimmed bounds.
    trimmed_inside: f64,
    /// Extent of the points of the trimmed part in the image, as a fraction of its smaller side: of the longer side of
    /// the rectangle around them.
    filled: f64,
    /// Of the pixels that points within the image fall on, the fraction that shows something.
    drawn: f64,
}

fn first_picture(sequence: Sequence) -> Shown {
    let sequence = Arc::new(sequence);
    let loader = Loader::new(Arc::clone(&sequence), LoaderOptions::default()).unwrap();
    let renderer = AnyRenderer::open(RendererChoice::Cpu).unwrap();
    let mut headless = Headless::new(Arc::clone(&sequence), loader, renderer);
    let look = headless.first_look().unwrap();
    let style = Style {
        backdrop: Backdrop {
            background: Background::solid([255, 0, 255]),
            ..(Settings::default().resolved(&look)).backdrop
        },
        ..Settings::default().resolved(&look)
    };
    let camera = CameraChoice::default().camera(&look, sequence.origin(), SIZE_PX);
    let frame = headless.frame(0, &style).unwrap();
    let picture = headless.draw(&frame, &camera, &style, SIZE_PX).unwrap();
    let positions = frame.frame.positions();
    let trimmed = look.trimmed;
    let is_trimmed = |p: &Vec3| p.cmpge(trimmed.min).all() && p.cmple(trimmed.max).all();
    let place = |p: &Vec3| in_picture(&camera, sequence.origin() + p.as_dvec3());
    let inside = positions.iter().filter(|p| place(p).is_some()).count();
    let retained: Vec<&Vec3> = positions.iter().filter(|p| is_trimmed(p)).collect();
    let places: Vec<[f64; 2]> = retained.iter().filter_map(|p| place(p)).collect();
    let extent = |axis: usize| {
        let values = || places.iter().map(|place| place[axis]);
        values().fold(f64::MIN, f64::max) - values().fold(f64::MAX, f64::min)
    };
    let met = places.iter().filter(|place| {
        let pixel = picture.get_pixel(place[0] as u32, place[1] as u32);
        pixel.0[..3] != [255, 0, 255]
    });
    Shown {
        inside: inside as f64 / positions.len() as f64,
        trimmed_inside: places.len() as f64 / retained.len() as f64,
        filled: extent(0).max(extent(1)) / f64::from(SIZE_PX[0].min(SIZE_PX[1])),
        drawn: met.count() as f64 / places.len() as f64,
        look,
    }
}

/// The pixel of a position, if it is before the eye and within the image.
fn in_picture(camera: &Camera, place: DVec3) -> Option<[f64; 2]> {
    let px = camera.to_px(place, SIZE_PX)?;
    let is_inside = px.x >= 0.0 && px.y >= 0.0 && px.x < f64::from(SIZE_PX[0]) && px.y < f64::from(SIZE_PX[1]);
    is_inside.then_some([px.x, px.y])
}

/// The limits that every initial view meets.
fn check(name: &str, sequence: Sequence) -> Shown {
    let shown = first_picture(sequence);
    println!(
        "{name}: {} up {} ({}), {:?}; inside {:.3}, of the trimmed part {:.3}, which fills {:.2}, drawn {:.3}; planes \
         {:.2}, spread {:.1}",
        shown.look.kind.name(),
        shown.look.up.name(),
        shown.look.up_why,
        shown.look.primitive,
        shown.inside,
        shown.trimmed_inside,
        shown.filled,
        shown.drawn,
        shown.look.planar_share,
        shown.look.spacing_spread,
    );
    assert!(shown.inside >= 0.90, "{name}: {} inside", shown.inside);
    assert!(
        shown.trimmed_inside >= 0.95,
        "{name}: {} of the trimmed part inside",
        shown.trimmed_inside
    );
    // If all points coincide, the cloud has no size.
    if shown.look.trimmed.radius() > 0.0 {
        assert!(shown.filled >= 0.70, "{name}: filled {}", shown.filled);
    }
    // The background shows between points of a ragged cloud, but only in single pixels.
    assert!(shown.drawn >= 0.90, "{name}: {} drawn", shown.drawn);
    let all = shown.inside.min(shown.drawn * shown.trimmed_inside);
    assert!(all >= 0.90, "{name}: {all} inside and drawn");
    shown
}

fn of_cloud(raw: RawCloud) -> Sequence {
    Sequence::with_decoder(vec![FrameEntry::file("generated")], move |_| Ok(raw.clone()))
}

fn of_points(points: Vec<[f32; 3]>) -> Sequence {
    of_cloud(RawCloud::from_positions(Positions::F32(points)))
}

/// Numbers from 0 to 1, the same on every machine.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f32 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f32 / (1u64 << 24) as f32
    }

    fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.next()
    }
}

/// A column with a head and two legs, 1.8 high, standing on zero: Y is up.
fn figure(count: usize) -> Vec<Vec3> {
    let mut random = Random(7);
    let mut points = Vec::new();
    while points.len() < count {
        let turn = random.between(0.0, std::f32::consts::TAU);
        let (sin, cos) = turn.sin_cos();
        let part = random.next();
        points.push(if part < 0.4 {
            let side = if part < 0.2 { -0.12 } else { 0.12 };
            Vec3::new(side + 0.08 * cos, random.between(0.0, 0.85), 0.08 * sin)
        } else if part < 0.85 {
            Vec3::new(0.25 * cos, random.between(0.85, 1.5), 0.14 * sin)
        } else {
            let y = random.between(-1.0, 1.0);
            let across = (1.0 - y * y).sqrt();
            Vec3::new(0.12 * across * cos, 1.65 + 0.15 * y, 0.12 * across * sin)
        });
    }
    points
}

/// The points seen by a camera at zero that looks along Z: the nearest in each direction, and those next to them.
fn seen_along_z(points: Vec<[f32; 3]>) -> Vec<[f32; 3]> {
    let direction = |[x, y, z]: [f32; 3]| [x, y].map(|along| (150.0 * along / z).round() as i32);
    let mut nearest: HashMap<[i32; 2], f32> = HashMap::new();
    for &point in &points {
        let depth = nearest.entry(direction(point)).or_insert(f32::INFINITY);
        *depth = depth.min(point[2]);
    }
    let is_seen = |point: &[f32; 3]| point[2] <= nearest[&direction(*point)] + 0.03;
    points.into_iter().filter(is_seen).collect()
}

#[test]
fn outliers_do_not_shrink_the_view_of_a_person() {
    // A depth camera: Y down, Z forward, invisible points saved as 65.535 m.
    let figure = figure(68_000).into_iter().map(|p| [p.x, 0.9 - p.y, 2.4 + p.z]);
    let mut points = seen_along_z(figure.collect());
    let mut random = Random(3);
    for _ in 0..100 {
        let slope = [random.between(-0.5, 0.5), random.between(-0.4, 0.4)];
        points.push([65.535 * slope[0], 65.535 * slope[1], 65.535]);
    }
    let shown = check("outliers", of_points(points));
    assert_eq!(shown.look.up, UpAxis::NegY);
    assert_eq!(shown.look.kind, CaptureKind::CameraFrame);
    assert!(shown.look.full.extent().z < 3.0, "65.535 m stands for no measurement");
    assert!(shown.look.trimmed.extent().max_element() < 2.0);
}

#[test]
fn objects_standing_on_zero_determine_the_up_axis() {
    for (name, turn, expected) in [
        ("y up", (|p| p) as fn(Vec3) -> Vec3, UpAxis::Y),
        ("y down", |p| Vec3::new(p.x, -p.y, -p.z), UpAxis::NegY),
        ("z up", |p| Vec3::new(p.x, -p.z, p.y), UpAxis::Z),
    ] {
        let points = figure(30_000).into_iter().map(|p| turn(p).to_array());
        let shown = check(name, of_points(points.collect()));
        assert_eq!(shown.look.up, expected, "{name}");
        assert_eq!(shown.look.primitive, Primitive::Surfel, "{name}");
    }
}

/// A wall that the sensor saw from one side, with normals to that side.
#[test]
fn a_wall_is_seen_from_its_front_and_does_not_vanish_from_behind() {
    let mut random = Random(5);
    let points: Vec<[f32; 3]> = (0..40_000)
        .map(|_| {
            [
                random.between(-2.0, 2.0),
                random.between(0.5, 3.0),
                -3.0 - random.between(0.0, 0.01),
            ]
        })
        .collect();
    for facing in [1.0, -1.0] {
        let mut raw = RawCloud::from_positions(Positions::F32(points.clone()));
        raw.attributes.normals = Some(vec![[0.0, 0.0, facing]; points.len()]);
        let shown = check("wall", of_cloud(raw));
        assert!(!shown.look.is_closed);
        let style = Settings::default().resolved(&shown.look);
        assert_eq!(style.surfels.back_faces, BackFaces::Darker);
    }
}

/// Rings of a scanner that rotates about Z over a plain with walls far away.
#[test]
fn a_sweep_is_seen_from_above_and_drawn_as_points() {
    let mut points = Vec::new();
    for ring in 0..32 {
        let elevation = (-25.0 + ring as f32 * 0.9).to_radians();
        for step in 0..1800 {
            let azimuth = (step as f32 * 0.2).to_radians();
            let to_ground = if elevation < 0.0 {
                1.8 / -elevation.sin()
            } else {
                f32::MAX
            };
            let to_wall = 40.0 + 30.0 * (3.0 * azimuth).sin().abs();
            let range = to_ground.min(to_wall / elevation.cos());
            let across = range * elevation.cos();
            points.push([across * azimuth.cos(), across * azimuth.sin(), range * elevation.sin()]);
        }
    }
    let shown = check("sweep", of_points(points));
    assert_eq!(shown.look.kind, CaptureKind::Sweep);
    assert_eq!(shown.look.up, UpAxis::Z);
    assert_eq!(shown.look.primitive, Primitive::Point);
    assert!(shown.look.from.elevation_deg > 15.0);
    assert_eq!(shown.look.color_hints().prefers_height, Some(true));
}

#[test]
fn closed_shapes_are_culled_and_open_ones_are_not() {
    for shape in [Shape::Sphere, Shape::Torus] {
        let shown = check(shape.name(), Sequence::of(shape.frame(60_000)));
        assert!(shown.look.is_closed, "{}", shape.name());
        assert_eq!(shown.look.primitive, Primitive::Surfel);
    }
    // A hemisphere, open at the top.
    let frame = Sequence::of(Shape::Sphere.frame(60_000)).frame(0).unwrap();
    let retained: Vec<usize> = (0..frame.len())
        .filter(|&slot| frame.positions()[slot].y < 0.0)
        .collect();
    let take = |values: &[Vec3]| retained.iter().map(|&slot| values[slot].to_array()).collect();
    let mut raw = RawCloud::from_positions(Positions::F32(take(frame.positions())));
    raw.attributes.normals = Some(take(frame.normals().unwrap()));
    let shown = check("shell", of_cloud(raw));
    assert!(!shown.look.is_closed);
}

#[test]
fn lines_and_clusters_are_seen_whole() {
    let mut random = Random(9);
    let line = (0..5_000).map(|_| {
        let along = random.between(-10.0, 10.0);
        [along, 0.3 * along, 0.0]
    });
    let shown = check("line", of_points(line.collect()));
    assert_eq!(shown.look.primitive, Primitive::Point);
    let mut random = Random(11);
    let mut ball = |center: [f32; 3], radius: f32, count: usize| -> Vec<[f32; 3]> {
        let mut place = || {
            let offset = Vec3::new(
                random.between(-1.0, 1.0),
                random.between(-1.0, 1.0),
                random.between(-1.0, 1.0),
            );
            (Vec3::from_array(center) + radius * offset.normalize_or_zero()).to_array()
        };
        (0..count).map(|_| place()).collect()
    };
    let mut clusters = ball([0.0; 3], 1.0, 50_000);
    clusters.extend(ball([14.0, 0.5, 2.0], 0.8, 6_000));
    let shown = check("two clusters", of_points(clusters));
    assert!(shown.look.trimmed.max.x > 14.0, "the smaller one is there");
}

#[test]
fn no_point_one_point_and_equal_points_are_framed() {
    for points in [Vec::new(), vec![[3.0, 4.0, 5.0]], vec![[3.0, 4.0, 5.0]; 500]] {
        let sequence = of_points(points.clone());
        let frame = sequence.frame(0).unwrap();
        let look = FirstLook::of(&[&frame], sequence.origin());
        assert_eq!(look.trimmed, Aabb::from_points(frame.positions()));
        let camera = look.camera(sequence.origin(), 1.6);
        assert!(camera.distance > 0.0 && camera.distance.is_finite());
        assert!(camera.target_in_world.is_finite());
    }
}

/// The datasets of `../shared/data`, which a clone of the project does not have, and the expected kind of each.
#[test]
fn every_data_set_is_initially_complete_and_upright() {
    use CaptureKind::{CameraFrame, Object, Sweep};
    let Some(data) = shared("") else {
        return;
    };
    let sets: [(&str, Option<CaptureKind>, UpAxis, Option<Primitive>); 10] = [
        (
            "sequences/cesiumman_24fps",
            Some(Object),
            UpAxis::Y,
            Some(Primitive::Surfel),
        ),
        (
            "sequences/pcl_openni_3frames/pcd",
            Some(CameraFrame),
            UpAxis::NegY,
            None,
        ),
        (
            "sequences/ouster_os1_128_3scans",
            Some(Sweep),
            UpAxis::Z,
            Some(Primitive::Point),
        ),
        (
            "sequences/ouster_8beam_10scans",
            Some(Sweep),
            UpAxis::Z,
            Some(Primitive::Point),
        ),
        // Its stem rises along Z from the pot.
        ("sequences/plant4d_tomato", Some(Object), UpAxis::Z, None),
        ("static/bun_zipper.ply", Some(Object), UpAxis::Y, Some(Primitive::Mesh)),
        ("static/copc__lone-star.copc.laz", None, UpAxis::Z, None),
        (
            "static/fragment.pcd",
            Some(Object),
            UpAxis::NegY,
            Some(Primitive::Surfel),
        ),
        ("models/CesiumMan.glb", Some(Object), UpAxis::Y, Some(Primitive::Mesh)),
        ("models/Fox/Fox.gltf", Some(Object), UpAxis::Y, Some(Primitive::Mesh)),
    ];
    for (name, kind, up, primitive) in sets {
        let shown = check(name, open(&data.join(name)));
        assert!(kind.is_none_or(|kind| kind == shown.look.kind), "{name}");
        assert_eq!(shown.look.up, up, "{name}: {}", shown.look.up_why);
        assert!(primitive.is_none_or(|one| one == shown.look.primitive), "{name}");
    }
    corpus(&data.join("corpus"));
}

/// Files of other programs that stood on their heads, were giant disks or could not be seen.
#[test]
fn foreign_files_are_upright_and_visible() {
    let Some(folder) = shared("meaning") else {
        return;
    };
    for (name, up, primitive) in [
        ("up_tree.ply", UpAxis::Z, None),
        ("up_terrain.txt", UpAxis::Z, None),
        ("up_stairs.pcd", UpAxis::Z, Some(Primitive::Surfel)),
        ("sparse_aerial.las", UpAxis::Z, Some(Primitive::Point)),
        ("few_points.las", UpAxis::Z, Some(Primitive::Point)),
        ("cube_24_vertices.ply", UpAxis::Z, Some(Primitive::Mesh)),
        ("ME_cube_blender.ply", UpAxis::Z, Some(Primitive::Mesh)),
    ] {
        let look = first_picture(open(&folder.join(name))).look;
        assert_eq!(look.up, up, "{name}: {}", look.up_why);
        assert!(
            primitive.is_none_or(|one| one == look.primitive),
            "{name}: {}",
            look.primitive_why
        );
    }
}

/// Constants for missing points decide neither where a cloud is nor how large it is.
#[test]
fn missing_points_do_not_affect_the_image() {
    let Some(folder) = shared("meaning") else {
        return;
    };
    for (name, max_extent) in [
        ("Z01_utm_one_zero_point.ply", 10.0),
        ("Z02_utm_1pct_zero_points.ply", 10.0),
        ("L04b_one_y_int_min.las", 10.0),
        ("Z07b_100_zero_object_at_5.ply", 4.0),
        ("P11_integer_mm_zero_points.ply", 4000.0),
    ] {
        let sequence = open(&folder.join(name));
        let origin = sequence.origin();
        let shown = first_picture(sequence);
        let size = shown.look.trimmed.extent().max_element();
        assert!(size < max_extent, "{name}: {size}");
        let far = shown.look.trimmed.center().length();
        assert!(far < 5.0 * size, "{name}: {far} from the origin {origin}");
        assert!(shown.trimmed_inside > 0.99 && shown.filled > 0.4, "{name}");
    }
}

/// Each kind of missing point with its neighbours: in a survey, near the sensor, one and many, in single and double
/// precision. The rest is as it would be without them.
#[test]
fn generated_missing_points_do_not_affect_the_image() {
    let constants: [[f64; 3]; 6] = [
        [0.0; 3],
        [-9999.0; 3],
        [0.0, 0.0, -32_768.0],
        [1e30; 3],
        [-2_147_483.648, 3.0, 4.0],
        [65.535, 65.535, 65.535],
    ];
    for at in [DVec3::ZERO, DVec3::new(431_200.0, 4_581_300.0, 35.0)] {
        let clean: Vec<[f64; 3]> = figure(6000)
            .iter()
            .map(|point| (at + DVec3::new(7.0, 5.0, 3.0) + point.as_dvec3()).to_array())
            .collect();
        let bounds = |positions: Vec<[f64; 3]>| {
            let sequence = of_cloud(RawCloud::from_positions(Positions::F64(positions)));
            let frame = sequence.frame(0).unwrap();
            let look = FirstLook::of_sequence(&frame, &sequence);
            let corner = |corner: Vec3| sequence.origin() + corner.as_dvec3();
            (corner(look.trimmed.min), corner(look.trimmed.max), look.up)
        };
        let (min, max, up) = bounds(clean.clone());
        for constant in constants {
            for count in [1, 60, 2000] {
                let mut positions = clean.clone();
                positions.splice(100..100, vec![constant; count]);
                let found = bounds(positions);
                let moved = (found.0 - min).abs().max((found.1 - max).abs()).max_element();
                assert!(moved < 0.1, "{count} × {constant:?} at {at}: moved by {moved}");
                assert_eq!(found.2, up, "{count} × {constant:?} at {at}");
            }
        }
    }
}

fn open(path: &Path) -> Sequence {
    let points = std::num::NonZeroUsize::new(100_000);
    let options = OpenOptions::default();
    let read = options.read.with_mesh_sample_count(points);
    Sequence::open(&[path.to_owned()], &OpenOptions { read, ..options }).unwrap()
}

/// Every file of the corpus that has enough points to be a scene.
fn corpus(folder: &Path) {
    const MIN_POINTS: usize = 500;
    let mut files: Vec<PathBuf> = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else {
                files.push(path);
            }
        }
    }
    files.sort();
    for file in files {
        let name = file.strip_prefix(folder).unwrap().display().to_string();
        // Another test checks that it can be read.
        let Ok(sequence) = Sequence::discover(&[file]) else {
            continue;
        };
        let Ok(frame) = sequence.frame(0) else {
            continue;
        };
        let extent = frame.bounds().extent();
        if frame.len() < MIN_POINTS || extent.max_element() == 0.0 {
            continue;
        }
        check(&name, sequence);
    }
}
