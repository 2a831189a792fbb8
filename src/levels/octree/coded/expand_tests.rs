//! The nodes drawn in a view compared with a test of each leaf by itself.

use super::tests::{records, tree_of};
use super::*;
use crate::analysis::test_shapes::Random;
use crate::math::Frustum;
use glam::{Mat3, Mat4, Vec3, Vec4};
use proptest::prelude::*;

/// A code of points on bumpy patches whose normals all are near one direction, or of a closed surface.
fn cloud_of(seed: u64, count: usize, is_closed: bool) -> CodedCloud {
    let mut random = Random(seed);
    let surfel = |_| {
        let normal = random.cube().normalize_or(Vec3::Y);
        let normal = if is_closed {
            normal
        } else {
            (normal + 4.0 * Vec3::Z).normalize()
        };
        let position = if is_closed { normal } else { random.cube() };
        (position, normal, 0.03)
    };
    let records = records(&(0..count).map(surfel).collect::<Vec<_>>());
    CodedCloud::new(&tree_of(&records, StopCriterion::Depth(7)), &records.0, &records.1)
}

fn view(eye: Vec3, target: Vec3, lod_px: f32, culls_back_faces: bool) -> CodeView {
    let back = (eye - target).normalize();
    let right = back.any_orthonormal_vector();
    let rotation = Mat3::from_cols(right, back.cross(right), back).transpose();
    let near = 0.01;
    let clip = Mat4::from_cols(
        Vec4::new(2.0, 0.0, 0.0, 0.0),
        Vec4::new(0.0, 2.0, 0.0, 0.0),
        Vec4::new(0.0, 0.0, 0.0, -1.0),
        Vec4::new(0.0, 0.0, near, 0.0),
    );
    let frustum = Frustum::from_clip_matrix(&(clip * Mat4::from_mat3(rotation) * Mat4::from_translation(-eye)));
    let [left, right, bottom, top, _] = frustum.planes().map(Vec4::truncate);
    CodeView {
        eye_high: eye,
        eye_low: Vec3::ZERO,
        forward: -back,
        sides: [left, right, bottom, top],
        near,
        px_per_slope: 300.0,
        lod_px,
        deepest_level: u32::MAX,
        culls_back_faces,
        culls_by_own_normals: false,
        reach_radii: 1.5,
        normal_bits: 17,
        offset_bits: 3,
    }
}

/// Descendants of a node on the level of the leaves.
fn leaves_of(cloud: &CodedCloud, node: CodeNode) -> Range<usize> {
    let number = node.number as usize;
    cloud.descendants(number..number + 1, cloud.depth() - node.level)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn all_leaves_that_may_be_seen_are_drawn_once(
        seed: u64,
        count in 1usize..3000,
        is_closed: bool,
        eye in prop::array::uniform3(-3f32..3.0),
        target in prop::array::uniform3(-0.5f32..0.5),
        lod_px in prop::sample::select(vec![0.0f32, 2.0, 30.0, 1e6]),
        culls: bool,
        normal_bits in prop::sample::select(vec![13u32, 15, 17]),
    ) {
        let (eye, target) = (Vec3::from(eye), Vec3::from(target));
        prop_assume!((eye - target).length() > 0.1);
        let cloud = cloud_of(seed, count, is_closed);
        let view = CodeView { normal_bits, ..view(eye, target, lod_px, culls) };
        let drawn = cloud.drawn_nodes(&view);
        let leaves = cloud.level(cloud.depth());
        let mut is_covered = vec![false; leaves.len()];
        for node in &drawn {
            for leaf in leaves_of(&cloud, *node) {
                prop_assert!(!is_covered[leaf - leaves.start], "leaf {leaf} is drawn twice");
                is_covered[leaf - leaves.start] = true;
            }
            let edge = cloud.cube().cell_edge(node.level);
            let center = cloud.cube().cell_center(node.level, node.cell);
            // Of the nearest corner; a leaf may be larger.
            let nearest = (center - eye).dot(view.forward) - 0.5 * edge * view.forward.abs().element_sum();
            let is_small = nearest > 0.0 && edge * view.px_per_slope / nearest < 1.001 * lod_px;
            prop_assert!(is_small || node.level == cloud.depth(), "{node:?} is too large");
        }
        let order: Vec<(u32, u32)> = drawn.iter().map(|node| (node.level, node.number)).collect();
        prop_assert!(order.is_sorted());
        // The centre of a splat that is in the image and faces the eye.
        let cells = cloud.cells(cloud.depth());
        for (cell, leaf) in cells.into_iter().zip(leaves.clone()) {
            let node = CodeNode { number: leaf as u32, level: cloud.depth(), cell };
            let (point, shape) = cloud.surfel(node, normal_bits, 3);
            let offset = Vec3::from(point.position) - eye;
            let is_between = view.sides.iter().all(|side| side.dot(offset) > 0.0);
            let is_inside = is_between && offset.dot(view.forward) > view.near;
            let faces = crate::cloud::oct_decode(shape.normal).dot(offset) < 0.0;
            if is_inside && (faces || !culls) {
                prop_assert!(is_covered[leaf - leaves.start], "leaf {leaf} is missing");
            }
        }
    }
}

#[test]
fn nothing_behind_the_eye_and_nothing_that_faces_away_is_drawn() {
    let patch = cloud_of(1, 2000, false);
    let (front, back) = (Vec3::Z * 4.0, Vec3::Z * -4.0);
    assert!(!patch.drawn_nodes(&view(front, Vec3::ZERO, 0.0, true)).is_empty());
    assert_eq!(patch.drawn_nodes(&view(front, 2.0 * front, 0.0, false)), []);
    assert_eq!(patch.drawn_nodes(&view(back, Vec3::ZERO, 0.0, true)), []);
    // About half of a closed surface; by their own normals, exactly the nodes that face the eye.
    let ball = cloud_of(2, 3000, true);
    let whole = view(front, Vec3::ZERO, 0.0, false);
    let all = ball.drawn_nodes(&whole);
    let facing = ball.drawn_nodes(&view(front, Vec3::ZERO, 0.0, true)).len();
    assert!(
        (4 * facing..6 * facing).contains(&(2 * all.len())),
        "{facing} of {}",
        all.len()
    );
    let by_own_normals = CodeView {
        culls_back_faces: true,
        culls_by_own_normals: true,
        ..whole
    };
    let faces = |node: &&CodeNode| {
        let center = ball.cube().cell_center(node.level, node.cell);
        crate::cloud::oct_decode(ball.surfel(**node, 17, 3).1.normal).dot(center - front) < -1e-3
    };
    let found = ball.drawn_nodes(&by_own_normals);
    assert!(all.iter().filter(faces).all(|node| found.contains(node)));
    assert!(found.len() < facing && found.len() <= all.iter().filter(faces).count() + 10);
}

#[test]
fn words_hold_masks_ranks_and_attributes() {
    let cloud = cloud_of(3, 1500, true);
    let (words, [ranks, attributes, end]) = (cloud.words(), cloud.word_starts());
    assert_eq!(words.len(), end);
    let bytes: &[u8] = bytemuck::cast_slice(&words[..ranks]);
    assert_eq!(&bytes[..cloud.masks().len()], cloud.masks());
    for node in (0..cloud.masks().len()).step_by(RANK_MASKS) {
        assert_eq!(1 + words[ranks + node / RANK_MASKS] as usize, cloud.first_child(node));
    }
    let of_nodes: &[NodeAttributes] = bytemuck::cast_slice(&words[attributes..]);
    assert_eq!(of_nodes, cloud.attributes());
}
