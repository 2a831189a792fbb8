//! The skipped nodes, compared with testing each node by itself; and the order of the rest.

use super::super::tests::{any_camera, packet_of_surfels};
use super::super::transform::homogeneous;
use super::*;
use crate::analysis::test_shapes::Random;
use crate::cloud::{coarser_normal, largest_normal_error, quantise_normal};
use crate::scene::{BackFaces, Camera, PicturePlane, Projection, ScenePacket, UpAxis};
use glam::{DVec3, Vec2};
use proptest::prelude::*;

/// Runs `look` on the traversal of a packet.
fn traversed<T>(packet: &ScenePacket, look: impl FnOnce(&Traversal<'_>, &[Block]) -> T) -> T {
    let coded = Coded::of(packet).expect("a byte code");
    let view = PixelView::new(packet);
    let transform = Transform::new(&view, &coded.cloud.cube());
    let reaches = coded.cloud.reaches(coded.largest_scale());
    let normal_error = largest_normal_error(coded.normal_bits);
    let traversal = Traversal::new(&coded, &view, &transform, &reaches, normal_error);
    let blocks = traversal.blocks();
    look(&traversal, &blocks)
}

/// The cell of a node on its level.
fn cell_of(traversal: &Traversal<'_>, node: usize, level: u32) -> [u32; 3] {
    let cloud = traversal.coded.cloud;
    cloud.cells(level)[node - cloud.level(level).start]
}

/// The centre of a cell from the eye, in view space.
fn from_eye(traversal: &Traversal<'_>, level: u32, cell: [u32; 3]) -> DVec3 {
    let view = traversal.view;
    let center = traversal.coded.cloud.cube().cell_center(level, cell);
    let eye = view.eye().map(Vec3::as_dvec3);
    view.rotation().as_dmat3() * (center.as_dvec3() - eye[0] - eye[1])
}

/// Returns true if a box in view space is beyond the near plane, or beyond a side of the image by some pixels.
fn is_outside(view: &PixelView, center: DVec3, half: DVec3) -> bool {
    /// Splats count as two pixels wider, and pixels are whole.
    const MARGIN_PX: f64 = 4.0;
    let is_outside = |axis: usize, side_px: f64, outwards: f64| {
        // The plane through the eye and these pixels is where `axis + slope · z` is 0.
        let per_slope = f64::from(view.px_per_slope[axis]);
        let slope = (side_px - f64::from(view.center_px[axis])) / per_slope;
        let beyond = outwards * per_slope.signum() * (center[axis] + slope * center.z);
        // For the corner that is farthest inwards.
        beyond > half[axis] + slope.abs() * half.z
    };
    let sides = |axis: usize| {
        let edge_px = f64::from(view.size_px[axis]);
        is_outside(axis, -MARGIN_PX, -1.0) || is_outside(axis, edge_px + MARGIN_PX, 1.0)
    };
    -center.z + half.z < f64::from(view.near) || sides(0) || sides(1)
}

/// Points within −1 to 1 with unit normals around `main`; with `spread` 0 all have one, which is drawn as it is.
fn surfels_of(seed: u64, count: usize, main: Vec3, spread: f32) -> Vec<([f32; 3], Vec3)> {
    let mut random = Random(seed);
    let main = quantise_normal(main.normalize_or(Vec3::Y));
    let main = quantised_normals(FINEST_NORMAL_BITS)[main as usize];
    let mut surfel = |_| {
        let point = random.cube().to_array();
        let normal = main + spread * random.cube();
        (point, normal.normalize_or(main))
    };
    (0..count).map(&mut surfel).collect()
}

prop_compose! {
    /// Few points are one block, thousands are hundreds.
    fn any_packet(largest_spread: f32)(
        seed: u64,
        count in prop_oneof![1usize..300, 2000usize..8000],
        main in prop::array::uniform3(-1f32..1.0),
        spread in 0f32..=largest_spread,
        depth in 1u32..9,
        target in prop::array::uniform3(-2f64..2.0),
        camera in any_camera(),
    ) -> ScenePacket {
        let camera = Camera { target_in_world: target.into(), ..camera };
        packet_of_surfels(&surfels_of(seed, count, main.into(), spread), depth, &camera)
    }
}

proptest! {
    /// Every node that is in the image and faces the eye, by its own centre and normal alone, is in a block.
    #[test]
    fn nothing_visible_is_skipped(packet in any_packet(3.0)) {
        traversed(&packet, |traversal, blocks| {
            let (coded, view) = (traversal.coded, traversal.view);
            let cloud = coded.cloud;
            let deepest = cloud.depth();
            let leaves = cloud.level(deepest);
            let mut is_drawn = vec![false; leaves.len()];
            for block in blocks {
                for leaf in cloud.descendants(block.node..block.node + 1, deepest - block.level) {
                    is_drawn[leaf - leaves.start] = true;
                }
            }
            let normals = quantised_normals(coded.normal_bits);
            for (index, cell) in cloud.cells(deepest).into_iter().enumerate() {
                let center = from_eye(traversal, deepest, cell);
                let px = homogeneous(view, center.as_vec3()) / -center.z as f32;
                let normal = cloud.attributes()[leaves.start + index].normal();
                let normal = view.rotate(normals[coarser_normal(normal, coded.normal_bits) as usize]);
                let is_inside = -center.z > f64::from(view.near)
                    && (0.0..view.size_px[0] as f32).contains(&px.x)
                    && (0.0..view.size_px[1] as f32).contains(&px.y);
                let is_seen = is_inside && normal.as_dvec3().dot(center) < 0.0;
                prop_assert!(is_drawn[index] || !is_seen, "{:?} at {}", cell, px);
            }
            Ok(())
        })?;
    }

    /// No block is beyond a side of the image, or behind the eye, with all that its splats may reach.
    #[test]
    fn blocks_certainly_outside_the_view_are_skipped(packet in any_packet(3.0)) {
        traversed(&packet, |traversal, blocks| {
            let cloud = traversal.coded.cloud;
            for block in blocks {
                let half_edge = 0.5 * f64::from(cloud.cube().cell_edge(block.level));
                let reach = f64::from(traversal.reach(block.node, block.level));
                let rotation = traversal.view.rotation().as_dmat3();
                let half = rotation.abs() * DVec3::splat(half_edge) + reach;
                let cell = cell_of(traversal, block.node, block.level);
                let center = from_eye(traversal, block.level, cell);
                prop_assert!(
                    !is_outside(traversal.view, center, half),
                    "{:?} at {}", block, center
                );
            }
            Ok(())
        })?;
    }

    /// No block shows only its back, by more than the rounding of normals and cones. All points have one normal: so the
    /// cones below are as narrow as they get.
    #[test]
    fn blocks_certainly_back_facing_are_skipped(packet in any_packet(0.0)) {
        traversed(&packet, |traversal, blocks| {
            let cloud = traversal.coded.cloud;
            // One step of half opening angles; the angle added at each level through which they are gathered, and the
            // same amount for rounding of cosines near 1; and twice the error of a normal.
            let rounding = std::f64::consts::PI / 255.0
                + 2e-3 * f64::from(cloud.depth() + 1)
                + 2.0 * f64::from(largest_normal_error(traversal.coded.normal_bits) + 1e-3);
            for block in blocks {
                let edge = f64::from(cloud.cube().cell_edge(block.level));
                let cell = cell_of(traversal, block.node, block.level);
                let center = from_eye(traversal, block.level, cell);
                let share = 0.5 * 3f64.sqrt() * edge / center.length();
                let normal = quantised_normals(FINEST_NORMAL_BITS)
                    [cloud.attributes()[block.node].normal() as usize];
                let normal = traversal.view.rotate(normal).as_dvec3();
                // The angle between the normal and the directions from the eye to everything in the block.
                let off_normal = normal.angle_between(center) + share.min(1.0).asin();
                prop_assert!(
                    share >= 1.0 || off_normal + rounding > std::f64::consts::FRAC_PI_2,
                    "{:?} at {} with {}", block, center, normal
                );
            }
            Ok(())
        })?;
    }

    #[test]
    fn nearer_octants_come_first(packet in any_packet(3.0)) {
        assert_nearer_octants_first(&packet);
    }
}

/// Of any two consecutive blocks, the nearer comes first: of the two octants of their common node, by the distances of
/// their centres along the view.
fn assert_nearer_octants_first(packet: &ScenePacket) {
    traversed(packet, |traversal, blocks| {
        let path = |block: &Block| {
            let deepest = block.level;
            let cell = cell_of(traversal, block.node, deepest);
            (0..=deepest).map(move |level| (level, cell.map(|along| along >> (deepest - level))))
        };
        for pair in blocks.windows(2) {
            let parted = path(&pair[0]).zip(path(&pair[1])).find(|(a, b)| a != b);
            let (first, then) = parted.expect("no block is within another");
            let [first, then] = [first, then].map(|(level, cell)| -from_eye(traversal, level, cell).z);
            assert!(first <= then + 1e-5 * then.abs(), "{first} before {then}");
        }
    });
}

/// A ball has blocks farther down than octants of octants.
#[test]
fn nearer_octants_come_first_on_deeper_levels() {
    for (azimuth_deg, elevation_deg) in [(10.0, 20.0), (100.0, -50.0), (-160.0, 70.0)] {
        let packet = packet_of_surfels(&ball(), 7, &camera_at(azimuth_deg, elevation_deg, 0.0));
        let deepest = traversed(&packet, |_, blocks| blocks.iter().map(|block| block.level).max());
        assert_eq!(deepest, Some(3));
        assert_nearer_octants_first(&packet);
    }
}

/// Points evenly on a sphere of radius 1.
fn ball() -> Vec<([f32; 3], Vec3)> {
    let golden_angle = std::f32::consts::PI * (3.0 - 5f32.sqrt());
    let count = 60_000;
    let surfel = |index: u32| {
        let y = 1.0 - 2.0 * (index as f32 + 0.5) / count as f32;
        let around = Vec2::from_angle(golden_angle * index as f32) * (1.0 - y * y).sqrt();
        let normal = Vec3::new(around.x, y, around.y);
        (normal.to_array(), normal)
    };
    (0..count).map(surfel).collect()
}

/// From 4 radii, towards a point at this height above the centre.
fn camera_at(azimuth_deg: f64, elevation_deg: f64, target_y: f64) -> Camera {
    Camera {
        target_in_world: DVec3::new(0.0, target_y, 0.0),
        distance: 4.0,
        azimuth_deg,
        elevation_deg,
        fov_deg: 60.0,
        up: UpAxis::Y,
        projection: Projection::Perspective,
        plane: PicturePlane::CENTERED,
    }
}

/// The fraction skipped of a ball that shows its front, and of one that is above the image except for its edge.
#[test]
fn much_of_a_sphere_is_skipped() {
    // From 4 radii, 38 % of it faces the eye; blocks whose cones extend over the silhouette are added. Blocks have
    // edges of a quarter, and their own splats, which may reach into the image, twice that.
    let above = -4.0 * 30f64.to_radians().tan() - 0.9;
    for (target_y, back_faces, largest_share) in [(0.0, BackFaces::Culled, 0.6), (above, BackFaces::Drawn, 0.6)] {
        let mut packet = packet_of_surfels(&ball(), 7, &camera_at(0.0, 0.0, target_y));
        packet.style.surfels.back_faces = back_faces;
        traversed(&packet, |traversal, blocks| {
            let cloud = traversal.coded.cloud;
            let drawn: usize = blocks.iter().map(|block| block.nodes(cloud).len()).sum();
            let share = drawn as f64 / cloud.level(cloud.depth()).len() as f64;
            assert!((0.1..largest_share).contains(&share), "{share} at {target_y}");
        });
    }
}
