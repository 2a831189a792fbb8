//! What is skipped, beside each node by itself; and in which order the rest comes.

use super::super::tests::{any_camera, packet_of_surfels};
use super::super::transform::homogeneous;
use super::*;
use crate::cloud::{coarser_normal, largest_normal_error, quantise_normal};
use crate::scene::{Camera, Projection, ScenePacket, UpAxis};
use glam::{DVec3, Vec2};
use proptest::prelude::*;

/// Runs `look` on the traversal of a packet.
fn traversed<T>(packet: &ScenePacket, look: impl FnOnce(&Traversal<'_>, &[Block]) -> T) -> T {
    let coded = Coded::of(packet).expect("a byte code");
    let view = PixelView::new(packet);
    let transform = Transform::new(&view, &coded.cloud.cube());
    let reaches = coded.reaches();
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

/// The middle of a cell from the eye, in view space.
fn from_eye(traversal: &Traversal<'_>, level: u32, cell: [u32; 3]) -> DVec3 {
    let view = traversal.view;
    let center = traversal.coded.cloud.cube().cell_center(level, cell);
    let [high, low] = view.eye();
    let eye = [high.as_dvec3(), low.as_dvec3()];
    view.rotation().as_dmat3() * (center.as_dvec3() - eye[0] - eye[1])
}

/// Whether a ball is beyond the near plane, or beyond a side of the picture by some pixels.
fn is_outside(view: &PixelView, center: DVec3, radius: f64) -> bool {
    /// Splats are widened by two pixels, and pixels are whole.
    const MARGIN_PX: f64 = 4.0;
    let is_beside = |axis: usize, side_px: f64, outwards: f64| {
        // The plane through the eye and these pixels holds (1, slope) along the axis and the way ahead.
        let per_slope = f64::from(view.px_per_slope[axis]);
        let slope = (side_px - f64::from(view.middle_px[axis])) / per_slope;
        let normal = outwards * per_slope.signum() / slope.hypot(1.0);
        normal * (center[axis] + slope * center.z) > radius
    };
    let sides = |axis: usize| {
        let edge_px = f64::from(view.size_px[axis]);
        is_beside(axis, -MARGIN_PX, -1.0) || is_beside(axis, edge_px + MARGIN_PX, 1.0)
    };
    -center.z + radius < f64::from(view.near) || sides(0) || sides(1)
}

/// Of points within −1 to 1 and unit normals around `main`; with `spread` 0 all have one, which is drawn as it is.
fn surfels_of(points: &[[[f32; 3]; 2]], main: Vec3, spread: f32) -> Vec<([f32; 3], Vec3)> {
    let main = quantise_normal(main.normalize_or(Vec3::Y));
    let main = quantised_normals(FINEST_NORMAL_BITS)[main as usize];
    let surfel = |&[point, aside]: &[[f32; 3]; 2]| {
        let normal = main + spread * Vec3::from_array(aside);
        (point, normal.normalize_or(main))
    };
    points.iter().map(surfel).collect()
}

prop_compose! {
    fn any_packet(largest_spread: f32)(
        points in prop::collection::vec(prop::array::uniform2(prop::array::uniform3(-1f32..1.0)), 1..300),
        main in prop::array::uniform3(-1f32..1.0),
        spread in 0f32..=largest_spread,
        depth in 1u32..9,
        camera in any_camera(),
    ) -> ScenePacket {
        packet_of_surfels(&surfels_of(&points, main.into(), spread), depth, &camera)
    }
}

proptest! {
    /// Every node that is in the picture and faces the eye, by its own middle and normal alone, is in a block.
    #[test]
    fn nothing_that_can_be_seen_is_skipped(packet in any_packet(3.0)) {
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

    /// No block is beyond a side of the picture, or behind the eye, with all that its splats may reach.
    #[test]
    fn what_is_certainly_outside_is_skipped(packet in any_packet(3.0)) {
        traversed(&packet, |traversal, blocks| {
            let cloud = traversal.coded.cloud;
            for block in blocks {
                let edge = cloud.cube().cell_edge(block.level);
                let own = cloud.attributes()[block.node].radius_edges() * edge;
                let reach = traversal.coded.largest_scale() * (own + edge);
                // The ball around the box, along the axes of the view, around the ball around the cell.
                let diagonal = 3f32.sqrt();
                let radius = diagonal * (0.5 * diagonal * edge + reach);
                let cell = cell_of(traversal, block.node, block.level);
                let center = from_eye(traversal, block.level, cell);
                prop_assert!(
                    !is_outside(traversal.view, center, f64::from(1.001 * radius)),
                    "{:?} at {}", block, center
                );
            }
            Ok(())
        })?;
    }

    /// No block shows only its back, by more than what normals and cones are rounded by. All points have one normal: so the
    /// cones below are as narrow as they get.
    #[test]
    fn what_is_certainly_turned_away_is_skipped(packet in any_packet(0.0)) {
        traversed(&packet, |traversal, blocks| {
            let cloud = traversal.coded.cloud;
            // A step of half openings; what is added at each level that they are gathered through, and as much for rounding of
            // cosines near 1; and twice the error of a normal.
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
                // The angle between the normal and the ways from the eye to all that the block has.
                let off_normal = normal.angle_between(center) + share.min(1.0).asin();
                prop_assert!(
                    share >= 1.0 || off_normal + rounding > std::f64::consts::FRAC_PI_2,
                    "{:?} at {} with {}", block, center, normal
                );
            }
            Ok(())
        })?;
    }

    /// Of any two blocks that follow each other, the nearer comes first: of the two octants of one node that they are in, by the
    /// distances of their middles along the view.
    #[test]
    fn nearer_octants_come_first(packet in any_packet(3.0)) {
        traversed(&packet, |traversal, blocks| {
            let path = |block: &Block| {
                let deepest = block.level;
                let cell = cell_of(traversal, block.node, deepest);
                (0..=deepest).map(move |level| {
                    let cell = cell.map(|along| along >> (deepest - level));
                    (level, cell)
                })
            };
            for pair in blocks.windows(2) {
                let parted = path(&pair[0]).zip(path(&pair[1])).find(|(a, b)| a != b);
                let (first, then) = parted.expect("no block is within another");
                let [first, then] = [first, then].map(|(level, cell)| {
                    -from_eye(traversal, level, cell).z
                });
                prop_assert!(first <= then + 1e-5 * then.abs(), "{} before {}", first, then);
            }
            Ok(())
        })?;
    }
}

fn ball_camera(distance: f64) -> Camera {
    Camera {
        target_in_world: DVec3::ZERO,
        distance,
        azimuth_deg: 20.0,
        elevation_deg: 35.0,
        fov_deg: 60.0,
        up: UpAxis::Y,
        projection: Projection::Perspective,
    }
}

/// A ball by itself: of its nodes not many more come than face the eye, and of those in a corner of the picture's sides not many
/// more than are in the picture.
#[test]
fn of_a_ball_half_is_skipped() {
    let golden_angle = std::f32::consts::PI * (3.0 - 5f32.sqrt());
    let count = 60_000;
    let surfels: Vec<([f32; 3], Vec3)> = (0..count)
        .map(|index| {
            let y = 1.0 - 2.0 * (index as f32 + 0.5) / count as f32;
            let around = Vec2::from_angle(golden_angle * index as f32) * (1.0 - y * y).sqrt();
            let normal = Vec3::new(around.x, y, around.y);
            (normal.to_array(), normal)
        })
        .collect();
    for (distance, is_whole) in [(4.0, true), (1.2, false)] {
        let packet = packet_of_surfels(&surfels, 7, &ball_camera(distance));
        traversed(&packet, |traversal, blocks| {
            let (cloud, view) = (traversal.coded.cloud, traversal.view);
            let deepest = cloud.depth();
            let found: usize = blocks.iter().map(|block| block.nodes(cloud).len()).sum();
            let leaves = cloud.level(deepest);
            let seen = cloud.cells(deepest).into_iter().zip(leaves.clone());
            let seen = seen.filter(|&(cell, leaf)| {
                let center = from_eye(traversal, deepest, cell);
                let normal = cloud.attributes()[leaf].normal() as usize;
                let normal = view.rotate(quantised_normals(FINEST_NORMAL_BITS)[normal]);
                normal.as_dvec3().dot(center) < 0.0 && !is_outside(view, center, 0.0)
            });
            let seen = seen.count();
            let nodes = leaves.len();
            assert!(
                (seen..=2 * seen).contains(&found),
                "{found} of {nodes} nodes, {seen} are seen"
            );
            assert_eq!(is_whole, 3 * seen > leaves.len());
        });
    }
}
