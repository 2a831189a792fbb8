//! Additions compared with products, masks with integrals, and culling with none.

use super::blocks::Block;
use super::decode::Decoder;
use super::masks::{self, FULL_WEIGHT, MASKS};
use super::transform::{Transform, homogeneous, in_view};
use super::*;
use crate::cloud::{PointRecord, ShapeRecord, oct_encode, quantised_directions};
use crate::levels::octree::{CodedCloud, Octree, StopCriterion};
use crate::render::cpu::tests::packet_of;
use crate::render::cpu::view::{PixelRect, PixelView};
use crate::scene::{BackFaces, Camera, CodedCells, Content, Footprint, PicturePlane, Projection, Style, UpAxis};
use glam::{DVec3, Vec3};
use proptest::prelude::*;
use std::sync::Arc;

/// Colour of all points.
pub(super) const COLOR: [u8; 4] = [200, 100, 50, 255];

/// A packet of points with one normal as a byte code, seen by a camera.
fn packet_of_points(points: &[[f32; 3]], depth: u32, camera: &Camera) -> ScenePacket {
    let surfels: Vec<_> = points.iter().map(|&point| (point, Vec3::Z)).collect();
    packet_of_surfels(&surfels, depth, camera)
}

/// A packet of points with normals as a byte code, seen by a camera.
pub(super) fn packet_of_surfels(surfels: &[([f32; 3], Vec3)], depth: u32, camera: &Camera) -> ScenePacket {
    let positions: Vec<Vec3> = surfels.iter().map(|&(point, _)| point.into()).collect();
    let cube = crate::math::Cube::around(&positions).expect("a point");
    let order = crate::math::order_of_codes(&cube.codes(&positions));
    let in_order = || order.iter().map(|&index| index as usize);
    let positions: Vec<Vec3> = in_order().map(|index| positions[index]).collect();
    let records = positions.iter().map(|position| PointRecord {
        position: position.to_array(),
        color: COLOR,
    });
    let shapes = in_order().map(|index| ShapeRecord {
        normal: oct_encode(surfels[index].1),
        radius: 0.01,
        ellipse: 0,
        scalar: 0.0,
    });
    let colors = vec![[9; 4]; positions.len()];
    let octree = Octree::build(&positions, &colors, StopCriterion::Depth(depth));
    let (points, shapes) = (Arc::new(records.collect()), Arc::new(shapes.collect()));
    let cloud = CodedCloud::new(&Arc::new(octree), &points, &shapes);
    let mut packet = packet_of([320, 200]);
    packet.view = camera.transform(DVec3::ZERO, packet.viewport_px);
    packet.style = Style::default()
        .with(|style| style.codes.footprint = Footprint::Masks)
        .painted();
    packet.bounds = crate::math::Aabb::from_points(&positions);
    packet.content = Content::Coded(CodedCells {
        deepest_level: cloud.depth(),
        cloud: Arc::new(cloud),
        lod_px: 0.0,
    });
    packet
}

prop_compose! {
    pub(super) fn any_camera()(
        azimuth_deg in -180f64..180.0,
        elevation_deg in -89f64..89.0,
        distance in 0.1f64..20.0,
        fov_deg in 20f64..100.0,
    ) -> Camera {
        Camera { target_in_world: DVec3::ZERO, distance, azimuth_deg, elevation_deg, fov_deg, up: UpAxis::Y,
            projection: Projection::Perspective, plane: PicturePlane::CENTERED }
    }
}

proptest! {
    /// Every node of every block is at the product of a matrix and its centre, in f64: off by at most 2⁻²¹ of the sizes
    /// of the summands (each of at most 21 additions rounds by 2⁻²⁴ of its result, but the sizes halve).
    #[test]
    fn incremental_positions_match_matrix_products(
        points in prop::collection::vec(prop::array::uniform3(-1f32..1.0), 1..300),
        depth in 0u32..12,
        camera in any_camera(),
    ) {
        let packet = packet_of_points(&points, depth, &camera);
        let coded = Coded::of(&packet).unwrap();
        let view = PixelView::new(&packet);
        let cloud = coded.cloud;
        let transform = Transform::new(&view, &cloud.cube());
        let root = Block { node: 0, level: 0, drawn_level: cloud.depth(), center: transform.root };
        let mut decoder = Decoder::default();
        let (nodes, centers) = decoder.decode(cloud, &transform, &root);
        prop_assert_eq!(nodes, cloud.level(cloud.depth()));
        let rotation = packet.view.view_from_frame_rotation.as_dmat3();
        let eye = packet.view.eye_high.as_dvec3() + packet.view.eye_low.as_dvec3();
        let [midpoint, per_slope] = [view.center_px, view.px_per_slope].map(|px| px.map(f64::from));
        let sizes = 2.0 * (cloud.cube().edge + packet.view.eye_high.length()) * per_slope_of(&view);
        for (cell, center) in cloud.cells(cloud.depth()).into_iter().zip(centers) {
            let position = cloud.cube().cell_center(cloud.depth(), cell).as_dvec3();
            let seen = rotation * (position - eye);
            let exact = DVec3::new(
                per_slope[0] * seen.x - midpoint[0] * seen.z,
                per_slope[1] * seen.y - midpoint[1] * seen.z,
                -seen.z,
            );
            let error = (center.truncate().as_dvec3() - exact).abs().max_element();
            prop_assert!(error <= f64::from(sizes) * 2f64.powi(-21), "{} {:?}", error, center);
        }
    }

    #[test]
    fn pixels_unproject_to_view_space(vector in prop::array::uniform3(-9f32..9.0)) {
        let view = crate::render::cpu::tests::view_of([320, 200]);
        let vector = Vec3::from_array(vector);
        let back = in_view(&view, homogeneous(&view, vector).extend(0.0));
        prop_assert!((back - vector).length() < 1e-4);
    }

    /// All nodes of the level that is drawn are in one block, or in none if they cannot be seen.
    #[test]
    fn blocks_contain_each_visible_node_once(
        points in prop::collection::vec(prop::array::uniform3(-1f32..1.0), 1..400),
        depth in 0u32..9,
        camera in any_camera(),
        lod_px in 0f32..60.0,
    ) {
        let mut packet = packet_of_points(&points, depth, &camera);
        packet.style.surfels.back_faces = BackFaces::Drawn;
        let Content::Coded(cells) = &mut packet.content else { unreachable!() };
        cells.lod_px = lod_px;
        let coded = Coded::of(&packet).unwrap();
        let view = PixelView::new(&packet);
        let transform = Transform::new(&view, &coded.cloud.cube());
        let reaches = coded.cloud.reaches(coded.largest_scale());
        let traversal = Traversal::new(&coded, &view, &transform, &reaches, 0.1);
        let blocks = traversal.blocks();
        let deepest = coded.cloud.depth();
        let mut is_drawn = vec![false; coded.cloud.level(deepest).len()];
        let first_leaf = coded.cloud.level(deepest).start;
        for block in &blocks {
            prop_assert!(block.level <= block.drawn_level && block.drawn_level <= deepest);
            let below = deepest - block.level;
            for leaf in coded.cloud.descendants(block.node..block.node + 1, below) {
                prop_assert!(!std::mem::replace(&mut is_drawn[leaf - first_leaf], true));
            }
        }
        let whole = PixelRect::of_picture(view.size_px);
        for (leaf, cell) in coded.cloud.cells(deepest).into_iter().enumerate() {
            let center = coded.cloud.cube().cell_center(deepest, cell);
            let seen = view.rotate(view.offset_from_eye(center.to_array()));
            let px = homogeneous(&view, seen) / -seen.z;
            let is_inside = -seen.z > view.near
                && (0.0..whole.end[0] as f32).contains(&px.x)
                && (0.0..whole.end[1] as f32).contains(&px.y);
            prop_assert!(is_drawn[leaf] || !is_inside, "{:?}", cell);
        }
    }
}

fn per_slope_of(view: &PixelView) -> f32 {
    // The distance in pixels from the centre, and the centre itself.
    view.px_per_slope[0].abs().max(1.0) + view.center_px[0].max(view.center_px[1])
}

/// The weights of a mask compared with the definition, sampled at pixel centres: the ellipse of a disk that is seen
/// from straight ahead, a little wider for the filter.
#[test]
fn masks_match_disks_seen_face_on() {
    let normals = [
        Vec3::Z,
        Vec3::new(0.6, 0.0, 0.8),
        Vec3::new(0.5, -0.7, 0.51).normalize(),
        Vec3::new(0.9, 0.43, 0.05).normalize(),
    ];
    for normal in normals {
        let shape = masks::shape_of(normal);
        for radius in [0.6, 1.3, 2.2, 5.0, 11.0] {
            let size = masks::size_of(radius).unwrap();
            let mask = MASKS.get(shape, size, [0.5, 0.5]);
            let (mut weights, mut sum_x, mut sum_y) = (0.0, 0.0, 0.0);
            for row in 0..mask.height {
                let y = f32::from(row) + f32::from(mask.top);
                for (column, &weight) in MASKS.row(mask, row.into()).iter().enumerate() {
                    let x = column as f32 + f32::from(mask.left);
                    // In the plane of the disk, along the screen direction of the normal and across it.
                    let tilt = normal.truncate();
                    let along = tilt.normalize_or(glam::Vec2::X);
                    let offset = glam::Vec2::new(x, y);
                    let [p, q] = [offset.dot(along), offset.perp_dot(along)];
                    let d = (p / normal.z.max(1e-3)).hypot(q) / radius;
                    // Shapes are up to 5° off, sizes an eighth, and the filter widens both axes.
                    let reach = |half_axis: f32| (1.13 * half_axis).hypot(0.71) + 0.3;
                    let (along, across) = (reach(radius * (normal.z + 0.18)), reach(radius));
                    if (p / along).hypot(q / across) > 1.0 {
                        assert_eq!(weight, 0, "{normal} {radius}: {x} {y}");
                    }
                    if d < 0.8 {
                        assert!(weight > 0, "{normal} {radius}: {x} {y}");
                    }
                    let weight = f32::from(weight) / FULL_WEIGHT;
                    weights += weight;
                    sum_x += weight * x;
                    sum_y += weight * y;
                }
            }
            assert!(weights >= 0.5, "{normal} {radius}: twice what makes a pixel opaque");
            // Half the spacing of mask positions, which is the distance from a pixel centre to the next position, plus
            // a tenth for sampling.
            let off = if radius < 3.0 { 0.125 } else { 0.25 } + 0.1;
            let [x, y] = [sum_x, sum_y].map(|sum: f32| (sum / weights).abs());
            // For splats narrower than a pixel, samples do not determine the centre.
            if radius * normal.z >= 1.0 {
                assert!(x < off && y < off, "{normal} {radius}: {x} {y}");
            }
            let whole = std::f32::consts::PI * radius * radius * normal.z * 0.3167;
            if radius * normal.z > 2.0 {
                assert!(
                    (0.8..1.4).contains(&(weights / whole)),
                    "{normal} {radius}: {weights} {whole}"
                );
            }
        }
    }
}

#[test]
fn mask_sizes_are_quarters_of_octaves() {
    assert_eq!(masks::size_of(0.0), Some(0));
    assert_eq!(masks::size_of(0.5), Some(0));
    assert_eq!(masks::size_of(0.6249), Some(0));
    assert_eq!(masks::size_of(0.625), Some(1));
    assert_eq!(masks::size_of(1.0), Some(4));
    assert_eq!(masks::size_of(15.99), Some(19));
    assert_eq!(masks::size_of(16.0), None);
    assert_eq!(masks::size_of(f32::NAN), None);
}

#[test]
fn opposite_normals_share_one_shape() {
    for &normal in quantised_directions(4) {
        assert_eq!(masks::shape_of(normal), masks::shape_of(-normal), "{normal}");
    }
    let bytes = MASKS.byte_size();
    assert!(bytes < 16 << 20, "{bytes}");
}
