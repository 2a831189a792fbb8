//! Reference implementation of picking: examines every record under a pixel with formulas of its own.

use super::tests::SIZE;
use crate::cloud::{decode_ellipse, oct_decode};
use crate::scene::{PointShape, PointSizing, Primitive, ScenePacket};
use glam::{DMat3, DVec2, DVec3, Vec3};

/// From a place of the frame to clip space as the shaders' matrix does it, but in f64; and back to where rays go.
pub(super) struct Oracle<'a> {
    pub(super) packet: &'a ScenePacket,
    /// Centre of the pixel.
    pub(super) px: DVec2,
}

impl Oracle<'_> {
    fn offset(&self, position: [f32; 3]) -> DVec3 {
        let view = &self.packet.view;
        Vec3::from_array(position).as_dvec3() - view.eye_high.as_dvec3() - view.eye_low.as_dvec3()
    }

    fn rotation(&self) -> DMat3 {
        self.packet.view.view_from_frame_rotation.as_dmat3()
    }

    /// From the eye through the pixel: the corner of the near plane's rectangle that its place says.
    fn direction(&self) -> DVec3 {
        let [width, height] = SIZE.map(f64::from);
        let [right, up] = self.packet.view.center_ndc.map(f64::from);
        let clip = DVec2::new(
            2.0 * self.px.x / width - 1.0 - right,
            1.0 - 2.0 * self.px.y / height - up,
        );
        let [focal_x, focal_y] = self.packet.view.focal.map(f64::from);
        self.rotation().inverse() * DVec3::new(clip.x / focal_x, clip.y / focal_y, -1.0)
    }

    fn near(&self) -> f64 {
        f64::from(self.packet.view.near)
    }

    /// Returns `t` and half edges where the ray intersects the plane given by a centre and two half edges.
    fn plane(&self, offset: DVec3, u: DVec3, v: DVec3) -> Option<[f64; 3]> {
        let matrix = DMat3::from_cols(u, v, -self.direction());
        if matrix.determinant() == 0.0 {
            return None;
        }
        let DVec3 { x, y, z } = matrix.inverse() * -offset;
        (z >= self.near()).then_some([z, x, y])
    }

    /// The depth of a point at an offset from the eye, if its square or disk covers the pixel.
    fn point_over_pixel(&self, offset: DVec3) -> Option<f64> {
        let half_px = 0.5 * f64::from(self.packet.style.points.size_px);
        let place = self.rotation() * offset;
        let clip = self.packet.view.clip_from_view().as_dmat4() * place.extend(1.0);
        let ndc = clip.truncate() / clip.w;
        let [width, height] = SIZE.map(f64::from);
        let px = DVec2::new(width * (0.5 + 0.5 * ndc.x), height * (0.5 - 0.5 * ndc.y));
        let aside = px - self.px;
        let is_near = |reach_px: f64| aside.abs().max_element() <= reach_px;
        let covers = match self.packet.style.drawn_points().shape {
            PointShape::Square => is_near(half_px),
            PointShape::Disk | PointShape::Gaussian => aside.length_squared() <= half_px * half_px || is_near(0.5),
        };
        (clip.w > 0.0 && ndc.z <= 1.0 && covers).then_some(clip.w)
    }

    pub(super) fn point(&self) -> Option<usize> {
        let style = &self.packet.style;
        let points = style.drawn_points();
        let shape = points.shape;
        let shapes = self.packet.content.shapes();
        let mut best: Option<(f64, usize)> = None;
        let mut blended = Vec::new();
        for (slot, point) in self.packet.content.points().unwrap().iter().enumerate() {
            let place = self.rotation() * self.offset(point.position);
            let clip = self.packet.view.clip_from_view().as_dmat4() * place.extend(1.0);
            let ndc = clip.truncate() / clip.w;
            let [width, height] = SIZE.map(f64::from);
            let px = DVec2::new(width * (0.5 + 0.5 * ndc.x), height * (0.5 - 0.5 * ndc.y));
            let aside = px - self.px;
            let scale = f64::from(style.points.scale);
            let px_per_unit = 0.5 * height * f64::from(self.packet.view.focal[1]) / clip.w;
            let min_px = match shape {
                PointShape::Square => 0.505,
                PointShape::Disk | PointShape::Gaussian => 0.715,
            };
            let in_scene_px = |radius: f64| (scale * radius * px_per_unit).max(min_px);
            let half_px = match points.sizing {
                PointSizing::Pixels if shape == PointShape::Gaussian || style.lights_points() => {
                    min_px.max(0.5 * f64::from(style.points.size_px))
                }
                PointSizing::Pixels => 0.5 * f64::from(style.points.size_px),
                PointSizing::Projected => in_scene_px(f64::from(self.packet.params.point_spacing) / 2f64.sqrt()),
                PointSizing::Adaptive => in_scene_px(f64::from(shapes.unwrap()[slot].radius)),
            };
            let is_near = |reach_px: f64| aside.abs().max_element() <= reach_px;
            let is_round = aside.length_squared() <= half_px * half_px;
            let covers = match shape {
                PointShape::Square => is_near(half_px),
                PointShape::Disk => is_round || is_near(0.5),
                PointShape::Gaussian => is_round,
            };
            if clip.w > 0.0 && ndc.z <= 1.0 && covers && shape == PointShape::Gaussian {
                blended.push((clip.w, half_px / px_per_unit, aside.length() / half_px, slot));
            } else if clip.w > 0.0 && ndc.z <= 1.0 && covers && best.is_none_or(|(depth, _)| clip.w <= depth) {
                best = Some((clip.w, slot));
            }
        }
        best.map(|(_, slot)| slot).or_else(|| max_of_blended(blended))
    }

    pub(super) fn surfel(&self) -> Option<usize> {
        let style = &self.packet.style;
        let shapes = self.packet.content.shapes().unwrap();
        let mut met = Vec::new();
        for (slot, (point, shape)) in self.packet.content.points().unwrap().iter().zip(&**shapes).enumerate() {
            let offset = self.offset(point.position);
            let normal = oct_decode(shape.normal).as_dvec3();
            if style.culls_back_faces() && normal.dot(offset) > 0.0 {
                continue;
            }
            let radius = f64::from(shape.radius) * f64::from(style.surfels.splat_scale);
            let [u, v] = if style.primitive == Primitive::Ellipse && shape.ellipse != 0 {
                let ellipse = decode_ellipse(shape.normal, shape.ellipse);
                let (axis, ratio) = (ellipse.axis.as_dvec3(), f64::from(ellipse.ratio));
                let longer = (2.0 / (1.0 + ratio * ratio)).sqrt();
                [axis * longer, normal.cross(axis) * ratio * longer]
            } else {
                normal.any_orthonormal_pair().into()
            };
            if let Some([depth, a, b]) = self.plane(offset, u * radius, v * radius)
                && a * a + b * b <= 1.0
            {
                met.push((depth, radius, a.hypot(b), slot));
            }
        }
        max_of_blended(met)
    }

    /// The record of the nearest triangle or point of a mesh, and where it is met.
    pub(super) fn triangle(&self) -> Option<(usize, DVec3)> {
        let mesh = self.packet.content.mesh().unwrap();
        let eye = -self.offset([0.0; 3]);
        let mut best: Option<(f64, usize, DVec3)> = None;
        for (record, triangle) in mesh.triangles.iter().enumerate() {
            let [a, b, c] = triangle
                .corners
                .map(|corner| self.offset(mesh.vertices[corner as usize].position));
            let depth = if a == b && b == c {
                self.point_over_pixel(a)
            } else {
                let met = self.plane(a, b - a, c - a);
                met.filter(|&[_, p, q]| p >= 0.0 && q >= 0.0 && p + q <= 1.0)
                    .map(|[depth, ..]| depth)
            };
            if let Some(depth) = depth
                && best.is_none_or(|(nearest, ..)| depth <= nearest)
            {
                best = Some((depth, record, eye + depth * self.direction()));
            }
        }
        best.map(|(_, record, place)| (record, place))
    }

    /// The record of the nearest face towards the eye.
    pub(super) fn voxel(&self) -> Option<usize> {
        let voxels = self.packet.content.voxels().unwrap();
        let mut best: Option<(f64, usize)> = None;
        for (record, voxel) in voxels.records.iter().enumerate() {
            let half = 0.5 * f64::from(voxels.cube_edge) / f64::from(1u32 << voxel.level);
            let offset = self.offset(voxel.center);
            for axis in 0..3 {
                if offset[axis].abs() <= half {
                    continue;
                }
                let along = |axis: usize| DVec3::AXES[axis % 3] * half;
                let face = offset - along(axis) * offset[axis].signum();
                if let Some([depth, a, b]) = self.plane(face, along(axis + 1), along(axis + 2))
                    && a.abs().max(b.abs()) <= 1.0
                    && best.is_none_or(|(nearest, _)| depth <= nearest)
                {
                    best = Some((depth, record));
                }
            }
        }
        best.map(|(_, record)| record)
    }
}

/// Returns the record whose centre is nearest there, of those no farther behind the nearest than its radius. Each is a
/// depth, a radius, a fraction of the radius and a slot.
fn max_of_blended(mut met: Vec<(f64, f64, f64, usize)>) -> Option<usize> {
    let backmost = met.iter().map(|&(depth, radius, ..)| depth + radius).reduce(f64::min)?;
    met.retain(|&(depth, ..)| depth <= backmost);
    met.sort_by(|a, b| a.2.total_cmp(&b.2));
    met.first().map(|&(.., slot)| slot)
}
