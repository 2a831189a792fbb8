//! Trees against their points, and cuts against the definition evaluated on every node.

use super::node_code::NORMAL_ERROR_DEG;
use super::rule::{NodeClass, Rule};
use super::split::Child;
use super::*;
use crate::analysis::test_shapes::{self, Random};
use crate::cloud::{oct_decode, oct_encode};
use crate::levels::LodMetric;
use crate::math::{Cube, Frustum, Sphere, order_of_codes};
use glam::{DVec3, Mat4, Vec3, Vec4};
use proptest::prelude::*;
use std::collections::{HashMap, HashSet};

pub(super) type Records = (Arc<Vec<PointRecord>>, Arc<Vec<ShapeRecord>>);

/// Points in Morton order with these normals and radii.
fn records(positions: &[Vec3], normal: impl Fn(usize) -> Vec3, radius: f32) -> Records {
    let codes = Cube::around(positions).map_or_else(Vec::new, |cube| cube.codes(positions));
    let order = order_of_codes(&codes);
    let at = order.iter().map(|&index| index as usize);
    let point = |index: usize| PointRecord {
        position: positions[index].to_array(),
        color: [index as u8, (index / 7) as u8, 200, 255],
    };
    let shape = |index: usize| ShapeRecord {
        normal: oct_encode(normal(index)),
        radius,
        ellipse: 0,
        scalar: index as f32,
    };
    (
        Arc::new(at.clone().map(point).collect()),
        Arc::new(at.map(shape).collect()),
    )
}

pub(super) fn torus(count: usize) -> Records {
    let torus = test_shapes::torus(count, 0.4, &mut Random(5));
    records(&torus.positions, |index| torus.normals[index], 0.01)
}

/// Dense and sparse parts with normals anywhere, and points at one place.
fn odd_cloud() -> Records {
    let mut random = Random(9);
    let mut positions: Vec<Vec3> = (0..700).map(|_| random.cube()).collect();
    positions.extend((0..700).map(|_| random.cube() * 1e-3));
    positions.extend([Vec3::splat(0.25); 70]);
    let normals: Vec<Vec3> = positions
        .iter()
        .map(|_| (random.cube() - 0.5).normalize_or(Vec3::Z))
        .collect();
    records(&positions, |index| normals[index], 0.0)
}

/// The cube around some points.
pub(super) fn cube_around(points: &[PointRecord]) -> Cube {
    let positions: Vec<Vec3> = points.iter().map(|point| Vec3::from_array(point.position)).collect();
    Cube::around(&positions).unwrap_or(Cube::EMPTY)
}

pub(super) fn tree_of((points, shapes): &Records, precision: Precision) -> SphereTree {
    SphereTree::build(&cube_around(points), points, shapes, precision)
}

/// A coded tree, and one that is not.
fn trees_of(of: &Records) -> [SphereTree; 2] {
    [Precision::Coded, Precision::Exact].map(|precision| tree_of(of, precision))
}

/// A 60° view of 500×500 pixels towards a place.
pub(super) fn view_to(eye: Vec3, target: Vec3, lod_px: f32, metric: LodMetric) -> SelectView {
    let forward = (target - eye).normalize();
    let right = forward.any_orthonormal_vector();
    let up = right.cross(forward);
    let space_from_view = Mat4::from_cols(
        right.extend(0.0),
        up.extend(0.0),
        (-forward).extend(0.0),
        eye.extend(1.0),
    );
    let focal = 3f32.sqrt();
    let clip_from_view = Mat4::from_cols(
        Vec4::new(focal, 0.0, 0.0, 0.0),
        Vec4::new(0.0, focal, 0.0, 0.0),
        Vec4::new(0.0, 0.0, 0.0, -1.0),
        Vec4::new(0.0, 0.0, 0.001, 0.0),
    );
    SelectView {
        frustum: Frustum::from_clip_matrix(&(clip_from_view * space_from_view.inverse())),
        eye,
        pixels_per_unit_at_1: focal * 250.0,
        lod_px,
        metric,
        deepest_level: SelectView::ALL_LEVELS,
    }
}

/// Views of something around the origin: all of it from two sides, some of it, and from within.
fn views(lod_px: f32, metric: LodMetric) -> Vec<SelectView> {
    let view =
        |eye: [f32; 3], target: [f32; 3]| view_to(Vec3::from_array(eye), Vec3::from_array(target), lod_px, metric);
    vec![
        view([3.0, 4.0, 5.0], [0.0; 3]),
        view([0.0, 0.0, -40.0], [0.0; 3]),
        view([0.3, 2.0, 0.2], [1.0, 0.2, 0.0]),
        view([0.9, 0.1, 0.0], [0.0, 1.0, 0.0]),
    ]
}

fn hints(culls_back_faces: bool) -> CutHints<'static> {
    CutHints {
        culls_back_faces,
        before: None,
    }
}

/// The nodes that each structure of a tree draws, by its name.
fn drawn_by_all(
    tree: &SphereTree,
    of: &Records,
    view: &SelectView,
    hints: CutHints<'_>,
) -> Vec<(&'static str, Vec<Child>)> {
    let (points, shapes) = of;
    let named = |cut: &Cut, nodes: HashMap<u32, Child>| cut.listed.drawn.iter().map(|name| nodes[name]).collect();
    let mut drawn: Vec<(&'static str, Vec<Child>)> = Vec::new();
    if tree.codes.len() == tree.nodes.len() {
        let qsplat = QSplat::of(tree, points, shapes);
        drawn.push(("qsplat", named(&qsplat.cut(view, hints), QSplat::nodes(tree))));
    }
    for (name, max_points) in [("spt", usize::MAX), ("hspt", HIERARCHY_POINTS), ("hspt of few", 8)] {
        let sequences = SequentialTree::of(tree, max_points);
        drawn.push((name, named(&sequences.cut(view, hints), sequences.nodes(tree))));
    }
    drawn
}

/// Each node's points, by brute force.
pub(super) fn points_below(tree: &SphereTree, node: Child) -> Vec<u32> {
    match node {
        Child::Leaf(point) => vec![point],
        Child::Inner(index) => {
            let children = tree.division.inners[index as usize].children();
            children.flat_map(|child| points_below(tree, child)).collect()
        }
    }
}

/// ε in units of the threshold, and whether nothing of the node can be seen: by angles, as the definition has it.
fn size_and_drop(tree: &SphereTree, node: u32, view: &SelectView, culls: bool) -> (f64, bool) {
    let bounds = &tree.nodes[node as usize].bounds;
    let to_eye = view.eye.as_dvec3() - bounds.sphere.center.as_dvec3();
    let (distance, radius) = (to_eye.length(), f64::from(bounds.sphere.radius));
    let is_outside =
        view.frustum.planes().iter().any(|plane| {
            plane.truncate().as_dvec3().dot(bounds.sphere.center.as_dvec3()) + f64::from(plane.w) < -radius
        });
    let mut seen_share = 1.0;
    let mut faces_away = false;
    if bounds.cone.cosine > -1.0 && distance > radius {
        let gamma = (bounds.cone.axis.as_dvec3().dot(to_eye) / distance).acos();
        let gamma = if culls {
            gamma
        } else {
            gamma.min(std::f64::consts::PI - gamma)
        };
        let seen_at = gamma - f64::from(bounds.cone.cosine).acos() - (radius / distance).asin();
        faces_away = culls && seen_at > std::f64::consts::FRAC_PI_2;
        seen_share = seen_at.max(0.0).cos();
    }
    let per_px = f64::from(view.pixels_per_unit_at_1) / (distance - radius) / f64::from(view.lod_px);
    let size = match view.metric {
        LodMetric::Edge => (2.0 / 3f64.sqrt() * f64::from(bounds.radius) * per_px).powi(2),
        LodMetric::Area => seen_share * std::f64::consts::PI * (f64::from(bounds.radius) * per_px).powi(2),
    };
    let size = if distance <= radius || view.lod_px == 0.0 {
        f64::INFINITY
    } else {
        size
    };
    (size, is_outside || faces_away)
}

/// (leaf ∨ small) ∧ ¬small(parent) of all that can be seen; leaves are seen with their parents.
fn drawn_by_definition(tree: &SphereTree, view: &SelectView, culls: bool) -> HashSet<Child> {
    let node_class = |node: u32| {
        let (size, is_dropped) = size_and_drop(tree, node, view, culls);
        let ends = tree.division.inners[node as usize].level as u32 >= view.deepest_level;
        (
            size <= 1.0 || view.deepest_level < SelectView::ALL_LEVELS && ends,
            is_dropped,
        )
    };
    let mut drawn = HashSet::new();
    for (inner, index) in tree.division.inners.iter().zip(0_u32..) {
        let (is_small, is_dropped) = node_class(index);
        let (parent_is_small, parent_is_dropped) = node_class(inner.parent);
        let is_below_divided = index == 0 || !parent_is_small && !parent_is_dropped;
        if is_small && !is_dropped && is_below_divided {
            drawn.insert(Child::Inner(index));
        }
        if !is_small && !is_dropped {
            drawn.extend(inner.children().filter(|child| matches!(child, Child::Leaf(_))));
        }
    }
    drawn
}

#[test]
fn spheres_and_cones_are_nested_and_contain_all_descendants() {
    for (of, tree) in [torus(3000), odd_cloud()]
        .iter()
        .flat_map(|of| trees_of(of).map(|tree| (of, tree)))
    {
        let (points, shapes) = of;
        for (node, index) in tree.nodes.iter().zip(0_u32..) {
            let above = &tree.nodes[tree.division.inners[index as usize].parent as usize].bounds;
            assert!(node.bounds.radius <= above.radius && node.bounds.radius <= node.sphere.radius);
            assert!(tree.codes.is_empty() || node.bounds.radius == node.sphere.radius);
            assert!(node.bounds.sphere == above.sphere || above.sphere.holds(&node.bounds.sphere));
            assert!(node.bounds.cone == above.cone || node.bounds.cone.is_within(&above.cone));
            for point in points_below(&tree, Child::Inner(index)) {
                let (point, shape) = (points[point as usize], shapes[point as usize]);
                let disk = Sphere {
                    center: Vec3::from_array(point.position),
                    radius: shape.radius,
                };
                let off_center = node.sphere.center.distance(disk.center);
                assert!(off_center <= node.bounds.radius * (1.0 + 1e-6), "{node:?} {disk:?}");
                assert!(
                    node.sphere.holds(&disk) && node.bounds.sphere.holds(&disk),
                    "{node:?} {disk:?}"
                );
                let cosine = oct_decode(shape.normal).dot(node.bounds.cone.axis);
                assert!(cosine >= node.bounds.cone.cosine, "{node:?} {cosine}");
            }
        }
    }
}

#[test]
fn smooth_surfaces_have_cones_and_tight_spheres() {
    let of = torus(20_000);
    for (tree, max_wider) in trees_of(&of).into_iter().zip([1.5, 1.05]) {
        let known = tree
            .nodes
            .iter()
            .filter(|node| !node.bounds.cone.is_everything())
            .count();
        assert!(known * 10 > tree.nodes.len() * 9, "{known} of {}", tree.nodes.len());
        let (mut of_tree, mut around_disks) = (0.0, 0.0);
        for (node, index) in tree.nodes.iter().zip(0_u32..) {
            let disks = points_below(&tree, Child::Inner(index))
                .into_iter()
                .map(|point| Sphere {
                    center: Vec3::from_array(of.0[point as usize].position),
                    radius: 0.01,
                });
            let around = Sphere::around(disks);
            around_disks += f64::from(around.radius);
            of_tree += f64::from(node.sphere.radius);
            // Nodes with more points are spheres around the spheres of their children.
            let is_around_disks = tree.codes.is_empty() && tree.division.inners[index as usize].point_count() <= 64;
            assert!(!is_around_disks || node.sphere.radius <= around.radius, "{node:?}");
        }
        assert!(of_tree < max_wider * around_disks, "{}", of_tree / around_disks);
    }
}

#[test]
fn drawn_nodes_match_the_definition() {
    for (of, tree) in [torus(3000), odd_cloud()]
        .iter()
        .flat_map(|of| trees_of(of).map(|tree| (of, tree)))
    {
        for metric in [LodMetric::Edge, LodMetric::Area] {
            for culls in [false, true] {
                for lod_px in [0.0, 1.0, 4.0, 30.0, 1000.0] {
                    for view in views(lod_px, metric) {
                        let expected = drawn_by_definition(&tree, &view, culls);
                        for (name, drawn) in drawn_by_all(&tree, of, &view, hints(culls)) {
                            let found: HashSet<Child> = drawn.iter().copied().collect();
                            assert_eq!(found.len(), drawn.len(), "{name}: none twice");
                            assert!(found == expected, "{name}: {metric:?}, {lod_px} px, from {}", view.eye);
                        }
                    }
                }
            }
        }
    }
}

/// Number of times that each point is covered by the drawn nodes.
fn coverage(tree: &SphereTree, of: &Records, drawn: &[Child]) -> Vec<u32> {
    let mut coverage = vec![0; of.0.len()];
    for &node in drawn {
        for point in points_below(tree, node) {
            coverage[point as usize] += 1;
        }
    }
    coverage
}

#[test]
fn every_point_is_covered_once_where_all_are_visible() {
    for of in [
        torus(3000),
        odd_cloud(),
        records(&[], |_| Vec3::Z, 1.0),
        records(&[Vec3::ONE], |_| Vec3::Z, 1.0),
    ] {
        let tree = tree_of(&of, Precision::Coded);
        for metric in [LodMetric::Edge, LodMetric::Area] {
            for lod_px in [0.0, 2.0, 500.0] {
                let mut view = views(lod_px, metric)[0];
                for deepest_level in [SelectView::ALL_LEVELS, 3, 0] {
                    view.deepest_level = deepest_level;
                    for (name, drawn) in drawn_by_all(&tree, &of, &view, hints(false)) {
                        let coverage = coverage(&tree, &of, &drawn);
                        assert!(coverage.iter().all(|&times| times == 1), "{name} at {lod_px} px");
                    }
                }
            }
        }
    }
}

proptest! {
    #[test]
    fn descendants_of_small_nodes_are_small_and_of_dropped_ones_dropped(
        positions in prop::collection::vec(prop::array::uniform3(-1f32..1.0), 1..200),
        flatness in 0f32..1.0,
        eye in prop::array::uniform3(-4f32..4.0),
        lod_px in 0.1f32..200.0,
        is_by_area: bool,
        culls: bool,
        is_coded: bool,
    ) {
        let positions: Vec<Vec3> = positions.into_iter().map(|[x, y, z]| Vec3::new(x, y, z * flatness)).collect();
        let normal = |index: usize| (Vec3::Z + flatness * positions[index]).normalize();
        let of = records(&positions, normal, 0.05);
        let tree = tree_of(&of, if is_coded { Precision::Coded } else { Precision::Exact });
        let metric = if is_by_area { LodMetric::Area } else { LodMetric::Edge };
        let view = view_to(Vec3::from_array(eye), Vec3::new(0.1, 0.2, 0.3), lod_px, metric);
        let rule = Rule::new(&view, &hints(culls));
        let node_class = |node: u32| rule.node_class(&tree.nodes[node as usize].bounds, 0, || false);
        for (inner, index) in tree.division.inners.iter().zip(0_u32..).skip(1) {
            match node_class(inner.parent) {
                NodeClass::Small => prop_assert!(node_class(index) != NodeClass::Divided),
                NodeClass::Dropped => prop_assert_eq!(node_class(index), NodeClass::Dropped),
                NodeClass::Divided => {}
            }
        }
        let expected = drawn_by_definition(&tree, &view, culls);
        for (name, drawn) in drawn_by_all(&tree, &of, &view, hints(culls)) {
            let found: HashSet<Child> = drawn.into_iter().collect();
            prop_assert!(found == expected, "{name}");
        }
    }
}

/// Each structure of a cloud.
fn structures(of: &Records) -> Vec<SphereLevels> {
    let kinds = [
        SphereKind::QSplat,
        SphereKind::Sequential,
        SphereKind::Printed,
        SphereKind::Hierarchical,
    ];
    kinds
        .map(|kind| SphereLevels::build(kind, cube_around(&of.0), Arc::clone(&of.0), Arc::clone(&of.1)))
        .into()
}

#[test]
fn near_the_threshold_the_previous_view_decides() {
    let of = torus(5000);
    for levels in structures(&of) {
        let [view, ..] = views(6.0, LodMetric::Area)[..] else {
            panic!("a view")
        };
        let names = |cut: &Cut| cut.listed.drawn.iter().copied().collect::<HashSet<u32>>();
        let first = levels.cut(&view, CutHints::default());
        let with_before = |lod_px: f32| {
            let before = Some(&first);
            let hints = CutHints {
                before,
                ..CutHints::default()
            };
            levels.cut(&SelectView { lod_px, ..view }, hints)
        };
        let fresh = |lod_px: f32| levels.cut(&SelectView { lod_px, ..view }, CutHints::default());
        let kind = levels.kind();
        assert!(names(&fresh(6.3)) != names(&first), "{kind:?}");
        if kind != SphereKind::Printed {
            assert!(names(&with_before(6.3)) == names(&first), "{kind:?}");
            assert!(names(&with_before(5.7)) == names(&first), "{kind:?}");
        }
        // Nodes that were subdivided stay so, unless the threshold is more than a tenth beyond.
        let divided = |cut: &Cut| cut.listed.divided.iter().copied().collect::<HashSet<u32>>();
        assert!(divided(&with_before(6.3)).is_superset(&divided(&first)), "{kind:?}");
        assert!(!divided(&fresh(6.3)).is_superset(&divided(&first)), "{kind:?}");
        assert!(!divided(&with_before(8.0)).is_superset(&divided(&first)), "{kind:?}");
    }
}

#[test]
fn a_budget_is_respected_and_mostly_used() {
    let of = torus(20_000);
    for levels in structures(&of) {
        let [view, ..] = views(0.5, LodMetric::Area)[..] else {
            panic!("a view")
        };
        for max in [100, 1000, 5000, 1_000_000] {
            let cut = levels.cut_at_most(max, &view, CutHints::default());
            let all = levels.cut(&view, CutHints::default()).node_count();
            let kind = levels.kind();
            assert!(
                cut.node_count() <= max && cut.node_count() >= max.min(all) / 2,
                "{kind:?}: {cut:?}"
            );
        }
    }
}

fn written(levels: &SphereLevels, cut: &Cut) -> (Vec<PointRecord>, Vec<ShapeRecord>) {
    match levels.write(cut, usize::MAX, RecordBuffers::default()) {
        super::Records::Surfels { points, shapes } => (points, shapes),
        other => panic!("nodes are drawn as surfels: {other:?}"),
    }
}

#[test]
fn sequence_leaves_are_the_points_and_qsplat_leaves_are_near_them() {
    let of = torus(2000);
    let (points, shapes) = &of;
    let [view, ..] = views(0.0, LodMetric::Area)[..] else {
        panic!("a view")
    };
    for levels in structures(&of) {
        let cut = levels.cut(&view, CutHints::default());
        let (drawn, drawn_shapes) = written(&levels, &cut);
        assert_eq!(drawn.len(), 2000);
        if levels.kind() != SphereKind::QSplat {
            let mut slots: Vec<usize> = drawn_shapes
                .iter()
                .map(|shape| shapes.iter().position(|of| of.scalar == shape.scalar).unwrap())
                .collect();
            assert!(
                drawn
                    .iter()
                    .zip(&drawn_shapes)
                    .zip(&slots)
                    .all(|((point, shape), &slot)| { *point == points[slot] && *shape == shapes[slot] })
            );
            slots.sort_unstable();
            assert!(slots.into_iter().eq(0..2000));
            continue;
        }
        for (point, shape) in drawn.iter().zip(&drawn_shapes) {
            let disk = |point: &PointRecord, shape: &ShapeRecord| Sphere {
                center: Vec3::from_array(point.position),
                radius: shape.radius,
            };
            let drawn = disk(point, shape);
            let held = points
                .iter()
                .zip(shapes.iter())
                .filter(|(point, shape)| drawn.holds(&disk(point, shape)));
            let is_alike = |(_, of): (&PointRecord, &ShapeRecord)| {
                oct_decode(of.normal).dot(oct_decode(shape.normal)) > NORMAL_ERROR_DEG.to_radians().cos()
            };
            assert!({ held }.any(is_alike), "{point:?} {shape:?}");
        }
    }
}

#[test]
fn qsplat_nodes_take_six_bytes_plus_one_pointer_per_group() {
    let of = torus(10_000);
    let tree = tree_of(&of, Precision::Exact);
    let groups = tree
        .division
        .inners
        .iter()
        .filter(|inner| !inner.inner_children().is_empty())
        .count();
    let size = structures(&of)[0].size();
    assert_eq!(size.nodes, 10_000 + tree.nodes.len());
    // The root is a group as well.
    assert_eq!(size.bytes, 6 * size.nodes + 4 * (groups + 1));
    assert!(size.bytes < 10 * 10_000, "{} bytes", size.bytes);
}

#[test]
fn the_published_rule_draws_some_nodes_with_their_parents_and_counts_them() {
    // A sphere of radius 1 around two points: r_min is √π, and r_max of the points is √π + 1.
    let of = records(&[Vec3::NEG_X, Vec3::X], |_| Vec3::Y, 0.0);
    let tree = tree_of(&of, Precision::Exact);
    let sequence = PrintedSequence::of(&tree, &of.0);
    let nodes = sequence.nodes();
    let root_tau = 0.01;
    for (distance, expected, duplicates) in [
        (100.0, vec![Child::Leaf(0), Child::Leaf(1)], 0),
        (200.0, vec![Child::Inner(0), Child::Leaf(0), Child::Leaf(1)], 2),
        (300.0, vec![Child::Inner(0)], 0),
    ] {
        let mut view = view_to(Vec3::new(0.0, 0.0, distance), Vec3::ZERO, 1.0, LodMetric::Area);
        view.lod_px = root_tau * view.pixels_per_unit_at_1;
        let cut = sequence.cut(&view, CutHints::default());
        let drawn: HashSet<Child> = cut.listed.drawn.iter().map(|name| nodes[name]).collect();
        assert_eq!(drawn, HashSet::from_iter(expected), "from {distance}");
        assert_eq!(cut.stats().duplicates, duplicates, "from {distance}");
        assert_eq!(cut.stats().emitted, drawn.len());
    }
}

#[test]
fn the_published_rule_covers_every_point_more_often_with_smaller_thresholds() {
    let of = torus(3000);
    let tree = tree_of(&of, Precision::Exact);
    let sequence = PrintedSequence::of(&tree, &of.0);
    let nodes = sequence.nodes();
    for lod_px in [2.0, 8.0, 40.0] {
        let [view, ..] = views(lod_px, LodMetric::Area)[..] else {
            panic!("a view")
        };
        let cut = sequence.cut(&view, CutHints::default());
        let drawn: Vec<Child> = cut.listed.drawn.iter().map(|name| nodes[name]).collect();
        assert!(coverage(&tree, &of, &drawn).iter().all(|&times| times >= 1));
        // By brute force: nodes whose points are a subset of another's.
        let below: Vec<HashSet<u32>> = drawn
            .iter()
            .map(|&node| points_below(&tree, node).into_iter().collect())
            .collect();
        let is_below = |one: usize| (0..below.len()).any(|other| other != one && below[one].is_subset(&below[other]));
        let expected = (0..below.len()).filter(|&one| is_below(one)).count();
        assert_eq!(cut.stats().duplicates, expected, "at {lod_px} px");
        assert!(expected > 0);
    }
}

#[test]
fn the_eye_may_be_anywhere() {
    let of = odd_cloud();
    for levels in structures(&of) {
        for eye in [Vec3::splat(0.25), Vec3::ZERO, DVec3::splat(1e30).as_vec3()] {
            let view = view_to(eye, Vec3::new(0.1, 0.2, 0.4), 1.0, LodMetric::Area);
            let cut = levels.cut(&view, CutHints::default());
            assert_eq!(written(&levels, &cut).0.len(), cut.node_count());
        }
    }
}
