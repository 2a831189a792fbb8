//! Surfaces estimated block by block, and signs by representatives.

use crate::analysis::test_shapes::{self, Random};
use crate::analysis::*;

/// The surface without signs, which are decided differently.
fn unsigned(surface: &Surface) -> (Vec<Vec3>, &[f32], &[u32]) {
    let normals = surface.normals.iter();
    let upwards = |normal: &Vec3| match normal.to_array().iter().find(|&&c| c != 0.0) {
        Some(&first) if first < 0.0 => -*normal,
        _ => *normal,
    };
    (normals.map(upwards).collect(), &surface.radii, &surface.without_plane)
}

/// With a sensor, neighbour lists exist for one block at a time; without one, for all of these few points.
#[test]
fn blocks_match_a_single_pass_bit_for_bit() {
    let mut random = Random(24);
    let row: Vec<Vec3> = (0..700).map(|i| Vec3::X * i as f32).collect();
    let equal = vec![Vec3::ONE; 40_000];
    let cube: Vec<Vec3> = (0..1037).map(|_| random.cube()).collect();
    let torus = test_shapes::torus(70_001, 0.4, &mut random).positions;
    // Outliers far apart, whose cells extend farther than either limit on disks allows.
    let mut outliers = test_shapes::sphere(40_000, &mut random).positions;
    outliers.extend((0..20).map(|i| Vec3::new(1e3 * i as f32, 1e4, (i * i) as f32)));
    let few = [&[][..], &cube[..1], &cube[..3], &cube];
    for cloud in few.into_iter().chain([&row[..], &equal, &torus, &outliers]) {
        let whole = estimate_surface(cloud, None);
        let in_blocks = estimate_surface(cloud, Some(Vec3::splat(7.0)));
        assert_eq!(whole.orientation, Orientation::Neighbours);
        assert_eq!(in_blocks.orientation, Orientation::Sensor);
        assert!(unsigned(&whole) == unsigned(&in_blocks), "{}", cloud.len());
    }
}

/// Share of normals that face outwards when signs are those of representatives.
fn share_outwards(shape: &test_shapes::Sampled) -> f64 {
    let tree = PointTree::new(&shape.positions);
    let found = super::blocks::surface(&tree, DEFAULT_NEIGHBOURS, PlaneFit::Plain, &Progress::default()).unwrap();
    let mut normals = found.normals;
    super::orientation::face_as_representatives(&tree, DEFAULT_NEIGHBOURS, &mut normals);
    let normals = tree.to_file_order(&normals);
    let pairs = normals.iter().zip(&shape.normals);
    let outwards = pairs.filter(|(found, truth)| found.dot(**truth) > 0.0);
    outwards.count() as f64 / normals.len() as f64
}

#[test]
fn representatives_turn_closed_surfaces_outwards() {
    let mut random = Random(31);
    let sphere = test_shapes::sphere(60_000, &mut random);
    let two = sphere
        .clone()
        .and(test_shapes::sphere(60_000, &mut random).moved(Vec3::X * 5.0));
    let torus = test_shapes::torus(60_000, 0.4, &mut random);
    for (name, shape) in [("sphere", &sphere), ("two spheres", &two), ("torus", &torus)] {
        let share = share_outwards(shape);
        assert!(share == 1.0, "{share} of {name}");
    }
}

#[test]
fn large_clouds_are_oriented_by_representatives() {
    assert_eq!(orientation_of(MAX_JOINED, None), Orientation::Neighbours);
    let beyond = MAX_JOINED + 1;
    assert_eq!(orientation_of(beyond, None), Orientation::Representatives);
    let sensor = Some(Vec3::ZERO);
    assert_eq!(orientation_of(beyond, sensor), Orientation::Sensor);
    assert!(surface_steps(beyond, None) < surface_steps(MAX_JOINED, None));
}
