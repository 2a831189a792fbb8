//! Ellipses of nodes against the points below.

use super::split::Child;
use super::tests::{cube_around, points_below, torus, tree_of, view_to};
use super::*;
use crate::cloud::{decode_ellipse, oct_decode};
use crate::levels::LodMetric;
use glam::{DVec3, Vec3};

#[test]
fn node_ellipses_have_the_second_moments_of_their_points() {
    let (points, disks) = torus(900);
    // Thin ones and circles, in many directions.
    let thin = |(index, shape): (u32, &ShapeRecord)| ShapeRecord {
        ellipse: (index.wrapping_mul(9973) << 16) | ((index % 4) * 16_000),
        ..*shape
    };
    let shapes: Arc<Vec<ShapeRecord>> = Arc::new((0..).zip(disks.iter()).map(thin).collect());
    let tree = SphereTree::build(&cube_around(&points), &points, &shapes, Precision::Exact);
    let round = tree_of(&(Arc::clone(&points), disks), Precision::Exact);
    assert!(round.nodes.iter().all(|node| node.ellipse == 0), "disks stay disks");
    for (index, node) in tree.nodes.iter().enumerate() {
        let below: Vec<usize> = (points_below(&tree, Child::Inner(index as u32)).into_iter())
            .map(|point| point as usize)
            .collect();
        let place = |point: usize| Vec3::from_array(points[point].position).as_dvec3();
        let mean = below.iter().map(|&point| place(point)).sum::<DVec3>() / below.len() as f64;
        let normal = oct_decode(node.normal).as_dvec3();
        let found = decode_ellipse(node.normal, node.ellipse);
        // Along the axis, and across it in the plane.
        let axis = found.axis.as_dvec3();
        let along = |axis: DVec3| {
            let of_point = |&point: &usize| {
                let shape = &shapes[point];
                let own = decode_ellipse(shape.normal, shape.ellipse);
                let [longer, shorter] = own.half_axes_of_quadratic_mean(shape.radius).map(f64::from);
                let own_normal = oct_decode(shape.normal).as_dvec3();
                let [u, v] = if shape.ellipse == 0 {
                    own_normal.any_orthonormal_pair().into()
                } else {
                    [own.axis.as_dvec3(), own_normal.cross(own.axis.as_dvec3())]
                };
                let of_ellipse = (longer * u.dot(axis)).powi(2) + (shorter * v.dot(axis)).powi(2);
                (place(point) - mean).dot(axis).powi(2) + 0.25 * of_ellipse
            };
            below.iter().map(of_point).sum::<f64>()
        };
        if found.ratio > 0.98 {
            // For a circle any axis is correct.
            continue;
        }
        let across = normal.cross(axis);
        let expected = (along(across) / along(axis)).sqrt();
        assert!(
            (f64::from(found.ratio) - expected).abs() < 1e-3,
            "{} for {expected}",
            found.ratio
        );
        // No other axis is longer.
        for turn in [0.05, -0.05] {
            let (sine, cosine) = f64::sin_cos(turn);
            assert!(along(axis * cosine + across * sine) < along(axis), "node {index}");
        }
    }
}

#[test]
fn sphere_sequences_draw_node_ellipses() {
    let (points, disks) = torus(900);
    let thin = |shape: &ShapeRecord| ShapeRecord {
        ellipse: 0x4000_4000,
        ..*shape
    };
    let shapes: Arc<Vec<ShapeRecord>> = Arc::new(disks.iter().map(thin).collect());
    for kind in [
        SphereKind::Sequential,
        SphereKind::Hierarchical,
        SphereKind::Printed,
        SphereKind::QSplat,
    ] {
        let levels = SphereLevels::build(kind, cube_around(&points), Arc::clone(&points), Arc::clone(&shapes));
        let view = view_to(Vec3::new(0.0, 3.0, 9.0), Vec3::ZERO, 30.0, LodMetric::Edge);
        let cut = levels.cut(&view, CutHints::default());
        let Records::Surfels { shapes: drawn, .. } = levels.write(&cut, usize::MAX, RecordBuffers::default()) else {
            panic!("{kind:?} draws surfels");
        };
        let thin = drawn.iter().filter(|shape| shape.ellipse != 0).count();
        let nodes = drawn.iter().filter(|shape| shape.radius > 0.01).count();
        assert!(nodes > 20, "{kind:?}: {nodes} nodes");
        match kind {
            SphereKind::QSplat => assert!(thin < nodes / 2, "{kind:?} has no room: {thin} of {nodes}"),
            _ => assert!(thin > nodes / 2, "{kind:?}: {thin} of {nodes}"),
        }
    }
}
