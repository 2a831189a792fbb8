//! Clouds that break numerics, through the whole chain: scales from 10⁻⁶ to 10⁹, coordinates of ten million with
//! millimetres in them, clouds that are a point, a line, a plane or a lattice, duplicates, outliers.

mod brute_force;
mod chain;
mod near_plane;
mod time;

use crate::common;
use chain::{Chain, SIZE_PX, load};
use glam::{DVec3, Vec3};
use pointreel::analysis::LONE_RADIUS;
use pointreel::math::Aabb;
use pointreel::measure::{Orientation, angle_deg, flip};
use pointreel::scene::{Camera, Primitive, UpAxis};

const DELTA: f32 = 0.05;

/// Well-mixed numbers from a seed (splitmix64).
struct Random(u64);

impl Random {
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        // 20 bits, so that sums with whole numbers stay exact in f32.
        ((z ^ (z >> 31)) >> 44) as f64 / f64::from(1u32 << 20)
    }

    /// Evenly in −1..1 on each axis.
    fn cube(&mut self) -> DVec3 {
        DVec3::new(self.unit(), self.unit(), self.unit()) * 2.0 - 1.0
    }
}

/// At random on the unit sphere, to f32.
fn sphere(count: usize) -> Vec<DVec3> {
    let mut random = Random(1);
    let inside = std::iter::repeat_with(|| random.cube());
    inside
        .filter(|place| (0.01..1.0).contains(&place.length_squared()))
        .map(|place| place.normalize().as_vec3().as_dvec3())
        .take(count)
        .collect()
}

/// At random within the cube from −1 to 1.
fn block(count: usize) -> Vec<DVec3> {
    let mut random = Random(2);
    std::iter::repeat_with(|| random.cube()).take(count).collect()
}

fn scaled(positions: &[DVec3], factor: impl Into<DVec3>) -> Vec<DVec3> {
    let factor = factor.into();
    positions.iter().map(|&position| position * factor).collect()
}

fn check(name: &str, positions: &[DVec3]) -> Chain {
    let chain = load(positions, DELTA);
    chain.check(name, positions, DELTA, &chain.camera());
    chain
}

#[test]
fn scales_from_a_millionth_to_a_thousand_million() {
    for factor in [1e-6, 1e-3, 1.0, 1e3, 1e6, 1e9] {
        let chain = check(&format!("× {factor:e}"), &scaled(&sphere(1500), DVec3::splat(factor)));
        let outwards = chain
            .surface()
            .into_iter()
            .all(|(position, (normal, _))| Vec3::from_array(position.map(f32::from_bits)).dot(normal) > 0.0);
        assert!(outwards, "× {factor:e}");
    }
}

#[test]
fn extreme_aspect_ratios() {
    for (x, y, z) in [(1e6, 1.0, 1.0), (1.0, 1e-6, 1.0), (1e6, 1.0, 1e-3), (1e-4, 1e4, 1e-4)] {
        let factors = DVec3::new(x, y, z);
        check(&format!("aspect {factors}"), &scaled(&sphere(1500), factors));
        check(&format!("block of aspect {factors}"), &scaled(&block(1500), factors));
    }
}

#[test]
fn one_to_eight_points() {
    for count in 1..=8 {
        for far in [0.0, 1e7] {
            let positions: Vec<DVec3> = block(count).iter().map(|&place| place + far).collect();
            check(&format!("{count} points at {far}"), &positions);
        }
    }
}

#[test]
fn points_that_are_all_equal() {
    for place in [DVec3::ZERO, DVec3::new(3.0, -7.0, 0.125), DVec3::splat(1e9 + 0.1)] {
        let chain = check(&format!("all at {place}"), &vec![place; 1000]);
        let tree = chain.frame.levels.octree().unwrap();
        assert_eq!((tree.depth(), tree.leaf_count()), (0, 1));
        assert!((tree.loss() - 0.999).abs() < 1e-6);
        let surface: Vec<_> = chain.surface().into_values().collect();
        assert_eq!(surface, [(Vec3::Z, LONE_RADIUS)]);
    }
}

#[test]
fn lines() {
    for direction in [DVec3::X, DVec3::new(1.0, 1.0, 1.0), DVec3::new(0.25, -2.0, 0.5)] {
        let line: Vec<DVec3> = (0..500).map(|step| direction * f64::from(step) / 128.0).collect();
        let chain = check(&format!("a line along {direction}"), &line);
        let spacing = direction.length() as f32 / 128.0;
        for (normal, radius) in chain.surface().into_values() {
            let off = (angle_deg(normal, direction.as_vec3(), Orientation::Ignored) - 90.0).abs();
            assert!(off < 0.1, "{normal} is {off}° from across {direction}");
            assert!(
                radius > 0.5 * spacing,
                "a gap beside a disk of {radius}, points every {spacing}"
            );
        }
    }
}

#[test]
fn planes() {
    let mut random = Random(3);
    for normal in [Vec3::Y, Vec3::new(0.0, 0.6, 0.8)] {
        // On multiples of 2⁻⁸, so that points are exactly on the plane in f32 too.
        let plane: Vec<DVec3> = (0..2000)
            .map(|_| {
                let [a, b] = [random.unit(), random.unit()].map(|unit| (unit * 256.0).round() / 64.0);
                if normal == Vec3::Y {
                    DVec3::new(a, 0.0, b)
                } else {
                    DVec3::new(a, b * 4.0, b * -3.0)
                }
            })
            .collect();
        let chain = check(&format!("a plane across {normal}"), &plane);
        for (found, _) in chain.surface().into_values() {
            let off = angle_deg(found, normal, Orientation::Ignored);
            // The octahedral record of 2 × 16 bits is accurate to 0.01°.
            assert!(off < 0.02, "{found} is {off}° from {normal}");
        }
    }
}

/// 17 points along each axis lie on all borders of 16 cells. The last one belongs to the last cell, which parts from it
/// on the next finer level, where all are apart.
#[test]
fn lattices_on_cell_borders() {
    for step in [1.0f32, 0.125, 1e6, 0.1, 1.0 / 3.0] {
        let lattice: Vec<DVec3> = (0..17 * 17 * 17)
            .map(|i| Vec3::new((i % 17) as f32, (i / 17 % 17) as f32, (i / 289) as f32) * step)
            .map(Vec3::as_dvec3)
            .collect();
        let chain = load(&lattice, 0.0);
        let name = format!("a lattice of {step}");
        chain.check(&name, &lattice, 0.0, &chain.camera());
        let tree = chain.frame.levels.octree().unwrap();
        assert_eq!(tree.leaf_count(), lattice.len(), "{name}");
        assert_eq!(tree.depth(), 5, "{name}");
        // Multiples of the last two are rounded, some to below a border.
        if step == 1.0 || step == 0.125 || step == 1e6 {
            assert_eq!(tree.level_counts()[..5], [1, 8, 64, 512, 4096], "{name}");
        }
    }
}

#[test]
fn duplicates() {
    for times in [2, 5, 50] {
        let distinct = block(400);
        let positions: Vec<DVec3> = (0..times).flat_map(|_| distinct.iter().copied()).collect();
        let chain = check(&format!("every point {times} times"), &positions);
        let tree = chain.frame.levels.octree().unwrap();
        assert_eq!(tree.leaf_count(), distinct.len(), "as deep as parts them, no deeper");
        let expected = 1.0 - 1.0 / times as f32;
        assert!((tree.loss() - expected).abs() < 1e-6);
    }
}

#[test]
fn outliers_a_thousand_away() {
    let cloud = sphere(2000);
    let alone = load(&cloud, DELTA).surface();
    // Farther points mean no measurement.
    let far = [DVec3::splat(1e3), DVec3::new(-1e3, 0.0, 0.0)];
    for outliers in [&far[..1], &far[..]] {
        let with_outliers: Vec<DVec3> = cloud.iter().chain(outliers).copied().collect();
        let chain = load(&with_outliers, DELTA);
        let unit = Aabb {
            min: Vec3::NEG_ONE,
            max: Vec3::ONE,
        };
        let near = Camera::framing(&unit, chain.origin, UpAxis::Y);
        let name = format!("{} outliers", outliers.len());
        chain.check(&name, &with_outliers, DELTA, &near);
        let mut surface = chain.surface();
        let origin = chain.origin.as_vec3();
        for &outlier in outliers {
            let key = (outlier.as_vec3() - origin).to_array().map(f32::to_bits);
            let (_, radius) = surface.remove(&key).unwrap();
            assert!(radius < 1.0, "{name}: an outlier of radius {radius} hides the cloud");
        }
        // Distant points change nothing here.
        assert_eq!(surface.len(), alone.len());
        for (position, (normal, radius)) in surface {
            let (normal_alone, radius_alone) = alone[&position];
            assert!(
                (radius / radius_alone - 1.0).abs() < 1e-6,
                "{name}: {radius} for {radius_alone}"
            );
            assert!(
                angle_deg(normal, normal_alone, Orientation::Matters) < 0.02,
                "{name}: {normal} for {normal_alone}"
            );
        }
    }
}

/// Multiplying by a power of two changes the exponents of all numbers and nothing else.
#[test]
fn scaling_by_powers_of_two_changes_nothing() {
    let cloud = sphere(2000);
    let base = load(&cloud, DELTA);
    let base_tree = base.frame.levels.octree().unwrap();
    for exponent in [-20, -3, 1, 30] {
        let factor = 2f64.powi(exponent);
        let chain = load(&scaled(&cloud, DVec3::splat(factor)), DELTA);
        let tree = chain.frame.levels.octree().unwrap();
        assert_eq!((tree.depth(), tree.masks()), (base_tree.depth(), base_tree.masks()));
        let surface = chain.surface();
        for (position, (normal, radius)) in base.surface() {
            let scaled = position.map(|bits| (f32::from_bits(bits) * factor as f32).to_bits());
            let expected = (normal, radius * factor as f32);
            assert_eq!(surface[&scaled], expected, "2^{exponent}");
        }
        let [camera, base_camera] = [chain.camera(), base.camera()];
        for lod_px in [0.0, 2.0, 8.0] {
            let visible = brute_force::visible_set(tree, &chain.select_view(&camera, lod_px));
            let expected = brute_force::visible_set(base_tree, &base.select_view(&base_camera, lod_px));
            assert!(visible == expected, "2^{exponent}, τ {lod_px}");
        }
        for primitive in [Primitive::Surfel, Primitive::Voxel, Primitive::Point] {
            let [image, expected] = [chain.draw(&camera, primitive), base.draw(&base_camera, primitive)];
            let difference = common::difference(&image, &expected);
            assert_eq!(difference, (0, 0), "2^{exponent} as {primitive}");
        }
    }
}

/// Other factors round every coordinate to 24 bits once more.
#[test]
fn scaling_by_other_factors_changes_almost_nothing() {
    let cloud = sphere(2000);
    let base = load(&cloud, DELTA);
    let base_tree = base.frame.levels.octree().unwrap();
    for factor in [1e-6, 0.1, 3.0, 1e9] {
        let chain = load(&scaled(&cloud, DVec3::splat(factor)), DELTA);
        let tree = chain.frame.levels.octree().unwrap();
        assert_eq!(tree.depth(), base_tree.depth(), "× {factor:e}");
        for (found, expected) in tree.level_counts().iter().zip(base_tree.level_counts()) {
            // A point changes cells if it is within 2⁻²⁴ of the cube's edge length from a border; the three axes have
            // fewer than 2¹⁰ of them: hardly one of 2000. One that does may fill a cell and empty another.
            assert!(found.abs_diff(*expected) <= 4, "× {factor:e}: {found} for {expected}");
        }
        for primitive in [Primitive::Surfel, Primitive::Voxel] {
            let [image, expected] = [
                chain.draw(&chain.camera(), primitive),
                base.draw(&base.camera(), primitive),
            ];
            let error = flip(&expected, &image).unwrap().mean();
            assert!(error < 2e-4, "× {factor:e} as {primitive}: FLIP {error}");
        }
    }
}

/// Pixels from the upper left at which a camera sees the points, in the order of their coordinates.
fn places_px(chain: &Chain, camera: &Camera, shift: DVec3) -> Vec<[f64; 2]> {
    let view = camera.transform(chain.origin, SIZE_PX);
    let mut places: Vec<([f64; 3], [f64; 2])> = chain
        .positions()
        .iter()
        .map(|&position| {
            let in_view = view.to_view(position).as_dvec3();
            let half_px = SIZE_PX.map(|edge| 0.5 * f64::from(edge));
            let x = half_px[0] * (1.0 - f64::from(view.focal[0]) * in_view.x / in_view.z);
            let y = half_px[1] * (1.0 + f64::from(view.focal[1]) * in_view.y / in_view.z);
            let place = position.as_dvec3() + chain.origin - shift;
            (place.to_array(), [x, y])
        })
        .collect();
    places.sort_by(|a, b| a.partial_cmp(b).unwrap());
    places.into_iter().map(|(_, place)| place).collect()
}

/// Largest distance between two lists of positions.
fn farthest_px(a: &[[f64; 2]], b: &[[f64; 2]]) -> f64 {
    let distances = a.iter().zip(b).map(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1]));
    distances.fold(0.0, f64::max)
}

/// The cloud of the shift tests, on multiples of 2⁻¹⁰, just below a millimetre, which f64 adds to ten million exactly.
fn millimetres() -> Vec<DVec3> {
    sphere(3000)
        .iter()
        .map(|&position| (position * 1024.0).round() / 1024.0)
        // Adding 0 turns −0 into 0.
        .map(|position| position + 0.0)
        .collect()
}

fn shifted(positions: &[DVec3], shift: DVec3) -> Vec<DVec3> {
    positions.iter().map(|&position| position + shift).collect()
}

/// The same view of a cloud that was shifted.
fn shifted_camera(camera: &Camera, shift: DVec3) -> Camera {
    Camera {
        target_in_world: camera.target_in_world + shift,
        ..*camera
    }
}

/// A scan in coordinates of a survey, ten million units away with detail of a thousandth, is the same image as at zero,
/// to the bit: the origin is a short number near it, and the rest is exact in f32.
#[test]
fn ten_million_away_with_millimetres() {
    let cloud = millimetres();
    let here = load(&cloud, DELTA);
    let camera = here.camera();
    let places = places_px(&here, &camera, DVec3::ZERO);
    let surface_here = here.surface();
    for shift in [
        DVec3::splat(1e7),
        DVec3::new(1e7, -1e7, 3.0),
        DVec3::new(4.5e5, 5.4e6 + 0.5, 130.0),
    ] {
        let shifted_cloud = shifted(&cloud, shift);
        let there = check(&format!("shifted by {shift}"), &shifted_cloud);
        let camera_there = shifted_camera(&camera, shift);
        let off_px = farthest_px(&places, &places_px(&there, &camera_there, shift));
        assert!(off_px < 1e-3, "{off_px} pixels off at {shift}");
        for primitive in [Primitive::Surfel, Primitive::Point] {
            let images = [there.draw(&camera_there, primitive), here.draw(&camera, primitive)];
            let difference = common::difference(&images[0], &images[1]);
            assert_eq!(difference, (0, 0), "at {shift} as {primitive}");
        }
        for (position, (normal, radius)) in there.surface() {
            let position = Vec3::from_array(position.map(f32::from_bits)).as_dvec3();
            let unshifted = (position + there.origin - shift).as_vec3() + 0.0;
            let (expected, expected_radius) = surface_here[&unshifted.to_array().map(f32::to_bits)];
            assert!(
                angle_deg(normal, expected, Orientation::Matters) < 0.02,
                "{normal} for {expected}"
            );
            assert!(
                (radius / expected_radius - 1.0).abs() < 1e-5,
                "{radius} for {expected_radius}"
            );
        }

        // Positions rounded to f32 must not pass.
        let rounded: Vec<DVec3> = shifted_cloud
            .iter()
            .map(|position| position.as_vec3().as_dvec3())
            .collect();
        let coarse = load(&rounded, DELTA);
        let coarse_px = farthest_px(&places, &places_px(&coarse, &camera_there, shift));
        assert!(coarse_px > 1.0, "{coarse_px}");
    }
}

/// A shift that no short number names: positions are rounded to f32 once more, which no pixel shows. (Voxels of points
/// on the borders of cells would change, for which the cloud above is made, with an edge of 2.)
#[test]
fn ten_million_and_a_third_away() {
    let cloud = sphere(3000);
    let here = load(&cloud, DELTA);
    let camera = here.camera();
    let places = places_px(&here, &camera, DVec3::ZERO);
    for shift in [
        DVec3::new(1e7 + 1.0 / 3.0, -1e7 + 0.123, 1e7 - 0.7),
        DVec3::splat(-4.321e6),
    ] {
        let there = check(&format!("shifted by {shift}"), &shifted(&cloud, shift));
        let camera_there = shifted_camera(&camera, shift);
        let off_px = farthest_px(&places, &places_px(&there, &camera_there, shift));
        assert!(off_px < 0.1, "{off_px} pixels off at {shift}");
        for primitive in [Primitive::Surfel, Primitive::Voxel, Primitive::Point] {
            let [image, expected] = [there.draw(&camera_there, primitive), here.draw(&camera, primitive)];
            let error = flip(&expected, &image).unwrap().mean();
            assert!(error < 2e-4, "FLIP {error} at {shift} as {primitive}");
        }
    }
}
