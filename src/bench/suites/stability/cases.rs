//! The cases: clouds and cameras that break numerics, and the image that each must give.

use crate::cloud::{Positions, RawCloud};
use crate::scene::{Camera, Primitive};
use crate::sequence::Shape;
use glam::{DVec3, Vec3};
use std::f64::consts::TAU;

/// Points of a case: few, as many images are drawn, and enough for a closed surface.
const POINTS: usize = 3_000;

/// A cloud that is seen from somewhere.
#[derive(Clone, Copy)]
pub(super) struct Scenery {
    /// Makes the points.
    pub(super) cloud: fn() -> RawCloud,
    /// From the camera that shows the whole cloud to the one of the case.
    pub(super) camera: fn(Camera) -> Camera,
}

/// Expected image of a case.
#[derive(Clone, Copy)]
pub(super) enum Expected {
    /// The shape with this formula, ray-traced.
    Shape(Shape),
    /// The disks of its points, ray-traced: nothing else is known of it.
    Disks,
    /// Image of another cloud, drawn by the CPU: one without the difficulty of this one.
    Of(Scenery),
    /// The background: nothing is visible.
    Background,
    /// None: an error message gives the reason.
    Refusal,
}

/// A case of the suite.
#[derive(Clone, Copy)]
pub(super) struct Case {
    pub(super) name: &'static str,
    pub(super) seen: Scenery,
    pub(super) expected: Expected,
    /// Primitives that can show it.
    pub(super) primitives: &'static [Primitive],
}

/// Primitives of most cases.
pub(super) const ALL: &[Primitive] = &[
    Primitive::Point,
    Primitive::Surfel,
    Primitive::Ellipse,
    Primitive::Sprite,
    Primitive::Voxel,
];

/// Primitives with their own size: cells of an octree over seven orders are larger than the parts next to the eye.
const SPLATS: &[Primitive] = &[
    Primitive::Point,
    Primitive::Surfel,
    Primitive::Ellipse,
    Primitive::Sprite,
];

/// Primitives drawn with the splat shapes of files.
const DISKS: &[Primitive] = &[Primitive::Surfel, Primitive::Sprite];

const SPHERE: Scenery = of(sphere);

/// A cloud that fills the image.
const fn of(cloud: fn() -> RawCloud) -> Scenery {
    seen(cloud, |camera| camera)
}

const fn seen(cloud: fn() -> RawCloud, camera: fn(Camera) -> Camera) -> Scenery {
    Scenery { cloud, camera }
}

const fn case(name: &'static str, seen: Scenery, expected: Expected, primitives: &'static [Primitive]) -> Case {
    Case {
        name,
        seen,
        expected,
        primitives,
    }
}

/// All cases: of the camera first, then of coordinates, of attributes, and of frames with few points.
pub(super) const CASES: &[Case] = &[
    case(
        "near plane, target at 0.01",
        seen(balls, |it| towards(it, 0.01)),
        Expected::Disks,
        SPLATS,
    ),
    case(
        "near plane, target at 10",
        seen(balls, |it| towards(it, 10.0)),
        Expected::Disks,
        SPLATS,
    ),
    case(
        "near plane, target at 1e5",
        seen(balls, |it| towards(it, 1e5)),
        Expected::Disks,
        SPLATS,
    ),
    case(
        "field of view 1°",
        seen(sphere, |it| with_fov(it, 1.0)),
        Expected::Shape(Shape::Sphere),
        ALL,
    ),
    case(
        "field of view 120°",
        seen(sphere, |it| with_fov(it, 120.0)),
        Expected::Shape(Shape::Sphere),
        ALL,
    ),
    case(
        "field of view 170°",
        seen(sphere, |it| with_fov(it, 170.0)),
        Expected::Shape(Shape::Sphere),
        ALL,
    ),
    case(
        "plane at 1°",
        seen(plane, |it| at_elevation(it, 1.0)),
        Expected::Disks,
        ALL,
    ),
    case(
        "plane at 0.1°",
        seen(plane, |it| at_elevation(it, 0.1)),
        Expected::Disks,
        ALL,
    ),
    case(
        "plane edge on",
        seen(plane, |it| at_elevation(it, 0.0)),
        Expected::Disks,
        SPLATS,
    ),
    case("coplanar sheets", of(sheets), Expected::Disks, SPLATS),
    case("× 1e-10", of(|| scaled(1e-10)), Expected::Of(SPHERE), ALL),
    case("× 1e10", of(|| scaled(1e10)), Expected::Of(SPHERE), ALL),
    case("× 1e-30", of(|| scaled(1e-30)), Expected::Refusal, &[]),
    case("× 1e30", of(|| scaled(1e30)), Expected::Refusal, &[]),
    case("coordinates of 1e38", of(|| scaled(1e38)), Expected::Refusal, &[]),
    case("ten million away", of(far_away), Expected::Of(SPHERE), ALL),
    case("radii 0, NaN, ±∞, 1e±30", of(bad_radii), Expected::Of(SPHERE), DISKS),
    case(
        "normals 0, NaN, ±∞",
        of(bad_normals),
        Expected::Of(of(without_normals)),
        DISKS,
    ),
    case("normals of length 1e±30", of(long_normals), Expected::Of(SPHERE), DISKS),
    case("one point", of(|| equal_points(1)), Expected::Disks, ALL),
    case("all points equal", of(|| equal_points(POINTS)), Expected::Disks, SPLATS),
    case("no points", of(|| equal_points(0)), Expected::Background, ALL),
];

/// The unit sphere with normals and colours.
fn sphere() -> RawCloud {
    Shape::Sphere.cloud(POINTS)
}

fn without_normals() -> RawCloud {
    let mut cloud = sphere();
    cloud.attributes.normals = None;
    cloud
}

/// The sphere scaled by `factor`.
fn scaled(factor: f64) -> RawCloud {
    moved(|position| position * factor)
}

fn far_away() -> RawCloud {
    moved(|position| position + DVec3::new(1e7, -1e7, 3.0))
}

fn moved(to: impl Fn(DVec3) -> DVec3) -> RawCloud {
    let mut cloud = sphere();
    let positions = (0..cloud.positions.len()).map(|index| to(cloud.positions.get(index)).to_array());
    cloud.positions = Positions::F64(positions.collect());
    cloud
}

/// Numbers that are not lengths.
const NO_LENGTHS: [f32; 6] = [0.0, f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e30, 1e-30];

/// Radii that cannot be drawn: all are estimated, as if the file had none.
fn bad_radii() -> RawCloud {
    let mut cloud = sphere();
    let radii = NO_LENGTHS.into_iter().cycle().take(cloud.positions.len());
    cloud.attributes.radii = Some(radii.collect());
    cloud
}

/// Normals without a direction: all are estimated.
fn bad_normals() -> RawCloud {
    let mut cloud = sphere();
    let numbers = NO_LENGTHS[..4].iter().cycle().take(cloud.positions.len());
    cloud.attributes.normals = Some(numbers.map(|&number| [number; 3]).collect());
    cloud
}

/// Normals whose squared length is infinite or 0: their directions are known.
fn long_normals() -> RawCloud {
    let mut cloud = sphere();
    let normals = cloud.attributes.normals.iter_mut().flatten();
    for (normal, length) in normals.zip([1e30, 1e-30].into_iter().cycle()) {
        *normal = (Vec3::from_array(*normal) * length).to_array();
    }
    cloud
}

fn equal_points(count: usize) -> RawCloud {
    let mut cloud = RawCloud::from_positions(Positions::F32(vec![[3.0, -7.0, 0.125]; count]));
    cloud.attributes.colors = Some(vec![[220, 60, 40, 255]; count]);
    cloud
}

/// The whole of the cloud through another lens.
fn with_fov(camera: Camera, fov_deg: f64) -> Camera {
    let half_sine = |fov_deg: f64| (0.5 * fov_deg).to_radians().sin();
    Camera {
        fov_deg,
        distance: camera.distance * half_sine(camera.fov_deg) / half_sine(fov_deg),
        ..camera
    }
}

/// Balls in front of the eye, which is at the origin and looks along −Z.
const BALLS: usize = 8;

/// Distance of the nearest ball; each of the others is ten times as far away as the one before it.
const NEAREST_BALL: f64 = 0.01;

/// Eight balls from 0.01 to 1e5 units away, all as large in the image: four in a row, in two rows.
fn balls() -> RawCloud {
    const POINTS_PER_BALL: usize = 400;
    /// Slopes of the centres, and radius as a fraction of the distance.
    const SPACING: f64 = 0.2;
    const RADIUS: f64 = 0.07;
    let golden_angle = TAU * 0.381_966_011_250_105;
    let mut positions = Vec::new();
    let mut normals = Vec::new();
    let mut colors = Vec::new();
    let mut radii = Vec::new();
    for ball in 0..BALLS {
        let distance = NEAREST_BALL * 10f64.powi(ball as i32);
        let [column, row] = [(ball % 4) as f64 - 1.5, (ball / 4) as f64 - 0.5];
        let center = distance * DVec3::new(SPACING * column, SPACING * row, -1.0);
        for point in 0..POINTS_PER_BALL {
            let y = 1.0 - 2.0 * (point as f64 + 0.5) / POINTS_PER_BALL as f64;
            let (sin, cos) = (golden_angle * point as f64).sin_cos();
            let normal = DVec3::new((1.0 - y * y).sqrt() * cos, y, (1.0 - y * y).sqrt() * sin);
            positions.push((center + RADIUS * distance * normal).to_array());
            normals.push(normal.as_vec3().to_array());
            colors.push([230, 40 + 25 * ball as u8, 60, 255]);
            // A point has an area of 4π/n of the unit sphere.
            radii.push((1.3 * RADIUS * distance * (4.0 / POINTS_PER_BALL as f64).sqrt()) as f32);
        }
    }
    let mut cloud = RawCloud::from_positions(Positions::F64(positions));
    cloud.attributes.colors = Some(colors);
    cloud.attributes.normals = Some(normals);
    cloud.attributes.radii = Some(radii);
    cloud
}

/// The eye at the origin and the target at a distance along −Z: the image does not depend on that.
fn towards(camera: Camera, distance: f64) -> Camera {
    Camera {
        target_in_world: DVec3::new(0.0, 0.0, -distance),
        distance,
        azimuth_deg: 0.0,
        elevation_deg: 0.0,
        fov_deg: 45.0,
        ..camera
    }
}

/// The camera at an angle above the plane.
fn at_elevation(camera: Camera, elevation_deg: f64) -> Camera {
    Camera {
        elevation_deg,
        ..camera
    }
}

/// A plane with normals along Y.
fn plane() -> RawCloud {
    sheet(0.0, [60, 140, 230, 255])
}

/// Two sheets in one plane in two colours, with interleaved points.
fn sheets() -> RawCloud {
    let [first, second] = [sheet(0.0, [230, 60, 40, 255]), sheet(0.5, [40, 90, 230, 255])];
    let place = |cloud: &RawCloud, index| cloud.positions.get(index).to_array();
    let positions = (0..first.positions.len()).flat_map(|index| [place(&first, index), place(&second, index)]);
    let mut cloud = RawCloud::from_positions(Positions::F64(positions.collect()));
    let normals = first.attributes.normals.into_iter().flatten();
    cloud.attributes.normals = Some(normals.flat_map(|normal| [normal; 2]).collect());
    let colors = first.attributes.colors.into_iter().flatten();
    let others = second.attributes.colors.into_iter().flatten();
    cloud.attributes.colors = Some(colors.zip(others).flat_map(|(color, other)| [color, other]).collect());
    cloud
}

/// A square lattice in the plane y = 0, shifted by a part of its step.
fn sheet(shift: f64, color: [u8; 4]) -> RawCloud {
    const EDGE: usize = 40;
    let place = |index: usize| (index as f64 + shift) / EDGE as f64 * 2.0 - 1.0;
    let positions = (0..EDGE * EDGE).map(|index| [place(index % EDGE), 0.0, place(index / EDGE)]);
    let mut cloud = RawCloud::from_positions(Positions::F64(positions.collect()));
    cloud.attributes.normals = Some(vec![[0.0, 1.0, 0.0]; EDGE * EDGE]);
    cloud.attributes.colors = Some(vec![color; EDGE * EDGE]);
    cloud
}
