//! The records of packets as a ray meets them: by the rules of the renderers.

use super::ray::{Drawn, Met, Miss, Ray};
use crate::cloud::{MeshRecords, PointRecord, ShapeRecord, decode_ellipse, oct_decode};
use crate::scene::{DrawSettings, PointShape, PointSize, Primitive, ScenePacket, Surfels, Voxels};
use glam::{DVec2, DVec3, Vec3};

/// The longer half axis of the thinnest ellipse, in radii: see [`ShapeRecord`].
const LONGEST_HALF_AXIS: f64 = std::f64::consts::SQRT_2;

/// Points as squares or disks of pixels.
pub(super) struct Sprites<'a> {
    points: &'a [PointRecord],
    shapes: Option<&'a [ShapeRecord]>,
    size: PointSize,
    shape: PointShape,
}

impl<'a> Sprites<'a> {
    pub(super) fn new(packet: &ScenePacket, points: &'a [PointRecord], shapes: Option<&'a [ShapeRecord]>) -> Self {
        Self {
            points,
            shapes,
            size: PointSize::of(packet),
            shape: packet.style.drawn_points().shape,
        }
    }

    /// Half the edge of a point in the scene.
    fn half_edge(&self, record: usize) -> f64 {
        let radius = self.shapes.map_or(0.0, |shapes| shapes[record].radius);
        0.5 * f64::from(self.size.edge + self.size.edge_per_radius * radius)
    }
}

impl Drawn for Sprites<'_> {
    fn len(&self) -> usize {
        self.points.len()
    }

    fn position(&self, record: usize) -> Vec3 {
        Vec3::from_array(self.points[record].position)
    }

    fn reach(&self, record: usize) -> f64 {
        self.half_edge(record)
    }

    fn reach_px(&self) -> f64 {
        0.5 * f64::from(self.size.min_px)
    }

    fn faces_eye(&self, _: usize, _: DVec3) -> bool {
        true
    }

    fn meet(&self, ray: &Ray, record: usize, offset: DVec3) -> Option<Met> {
        let (depth, aside_px) = ray.project(offset)?;
        let half_px = ray.length_px(self.half_edge(record), depth).max(self.reach_px());
        if self.shape != PointShape::Gaussian {
            return meet_sprite(depth, aside_px, half_px, self.shape);
        }
        let aside = aside_px.length() / half_px;
        (aside <= 1.0).then_some(Met {
            depth,
            slack: half_px / ray.length_px(1.0, depth),
            aside,
        })
    }
}

/// Returns the intersection of the ray with the square or the disk of a point.
fn meet_sprite(depth: f64, aside_px: DVec2, half_px: f64, shape: PointShape) -> Option<Met> {
    let aside_max_px = aside_px.abs().max_element();
    let covers = match shape {
        PointShape::Square => aside_max_px <= half_px,
        // And the pixel that contains the point.
        PointShape::Disk | PointShape::Gaussian => aside_px.length() <= half_px || aside_max_px <= 0.5,
    };
    covers.then_some(Met {
        depth,
        slack: 0.0,
        aside: 0.0,
    })
}

/// Surfels as the disks or ellipses whose depths decide visibility.
pub(super) struct Disks<'a> {
    points: &'a [PointRecord],
    shapes: &'a [ShapeRecord],
    scale: f64,
    are_ellipses: bool,
    cull_back_faces: bool,
}

impl<'a> Disks<'a> {
    pub(super) fn new(surfels: &'a Surfels, style: &DrawSettings) -> Self {
        let [visibility, _] = style.surfels.splatting.scales(style.surfels.enlargement);
        Self {
            points: &surfels.points,
            shapes: &surfels.shapes,
            scale: f64::from(style.surfels.splat_scale) * f64::from(visibility),
            are_ellipses: style.primitive == Primitive::Ellipse,
            cull_back_faces: style.culls_back_faces(),
        }
    }

    fn normal(&self, record: usize) -> DVec3 {
        oct_decode(self.shapes[record].normal).as_dvec3()
    }

    fn radius(&self, record: usize) -> f64 {
        self.scale * f64::from(self.shapes[record].radius)
    }

    /// Returns the distance of a position on the plane of a surfel from its centre, as a fraction of the distance to
    /// its edge there.
    fn share_of_rim(&self, record: usize, offset: DVec3) -> f64 {
        let radius = self.radius(record);
        let ShapeRecord { normal, ellipse, .. } = self.shapes[record];
        if !self.are_ellipses || ellipse == 0 {
            return offset.length() / radius;
        }
        let ellipse = decode_ellipse(normal, ellipse);
        let [longer, shorter] = ellipse.half_axes_of_quadratic_mean(radius as f32).map(f64::from);
        let along = ellipse.axis.as_dvec3().dot(offset);
        let across = (offset.length_squared() - along * along).max(0.0).sqrt();
        (along / longer).hypot(across / shorter)
    }
}

impl Drawn for Disks<'_> {
    fn len(&self) -> usize {
        self.points.len().min(self.shapes.len())
    }

    fn position(&self, record: usize) -> Vec3 {
        Vec3::from_array(self.points[record].position)
    }

    fn reach(&self, record: usize) -> f64 {
        let longest = if self.are_ellipses { LONGEST_HALF_AXIS } else { 1.0 };
        longest * self.radius(record)
    }

    fn reach_px(&self) -> f64 {
        0.0
    }

    fn faces_eye(&self, record: usize, offset: DVec3) -> bool {
        !self.cull_back_faces || self.normal(record).dot(offset) <= 0.0
    }

    fn meet(&self, ray: &Ray, record: usize, offset: DVec3) -> Option<Met> {
        let (normal, direction) = (self.normal(record), ray.direction());
        let depth = normal.dot(offset) / normal.dot(direction);
        let aside = self.share_of_rim(record, depth * direction - offset);
        // Neither holds for a disk that is seen edge-on, or has zero size.
        (depth > 0.0 && aside <= 1.0).then_some(Met {
            depth,
            slack: self.radius(record),
            aside,
        })
    }
}

/// Cells as cubes.
pub(super) struct Cubes<'a> {
    voxels: &'a Voxels,
}

/// The space of a cell.
#[derive(Debug, Clone, Copy)]
pub(super) struct CellBox {
    center: DVec3,
    half_edge: f64,
}

impl CellBox {
    /// Returns true if the cell may contain a point: with its faces, which f32 rounds.
    pub(super) fn contains(&self, place: DVec3) -> bool {
        (place - self.center).abs().max_element() <= self.half_edge * (1.0 + 1e-4)
    }
}

impl<'a> Cubes<'a> {
    pub(super) fn new(voxels: &'a Voxels) -> Self {
        Self { voxels }
    }

    pub(super) fn cell(&self, record: usize) -> CellBox {
        CellBox {
            center: self.position(record).as_dvec3(),
            half_edge: self.half_edge(record),
        }
    }

    fn half_edge(&self, record: usize) -> f64 {
        let level = i32::from(self.voxels.records[record].level);
        0.5 * f64::from(self.voxels.cube_edge) * 0.5f64.powi(level)
    }
}

impl Drawn for Cubes<'_> {
    fn len(&self) -> usize {
        self.voxels.records.len()
    }

    fn position(&self, record: usize) -> Vec3 {
        Vec3::from_array(self.voxels.records[record].center)
    }

    fn reach(&self, record: usize) -> f64 {
        3f64.sqrt() * self.half_edge(record)
    }

    fn reach_px(&self) -> f64 {
        0.0
    }

    fn faces_eye(&self, _: usize, _: DVec3) -> bool {
        true
    }

    fn meet(&self, ray: &Ray, record: usize, offset: DVec3) -> Option<Met> {
        let half_edge = self.half_edge(record);
        let (mut enter, mut leave) = (f64::NEG_INFINITY, f64::INFINITY);
        let direction = ray.direction();
        for axis in 0..3 {
            let (offset, direction) = (offset[axis], direction[axis]);
            if direction == 0.0 {
                if offset.abs() > half_edge {
                    return None;
                }
                continue;
            }
            let [a, b] = [-half_edge, half_edge].map(|half| (offset + half) / direction);
            enter = enter.max(a.min(b));
            leave = leave.min(a.max(b));
        }
        // From inside a cube none of its faces is drawn.
        (enter <= leave && enter > 0.0).then_some(Met {
            depth: enter,
            slack: 0.0,
            aside: 0.0,
        })
    }
}

/// Triangles, and the vertices between them as squares or disks of pixels.
pub(super) struct Triangles<'a> {
    mesh: &'a MeshRecords,
    half_px: f64,
    shape: PointShape,
}

impl<'a> Triangles<'a> {
    pub(super) fn new(mesh: &'a MeshRecords, packet: &ScenePacket) -> Self {
        Self {
            mesh,
            half_px: 0.5 * f64::from(PointSize::of(packet).min_px),
            shape: packet.style.drawn_points().shape,
        }
    }

    fn is_point(&self, record: usize) -> bool {
        self.mesh.triangles[record].is_point()
    }

    /// Returns its corners relative to the eye, for a triangle whose centre is at this offset.
    fn corners_from_eye(&self, record: usize, offset: DVec3) -> [DVec3; 3] {
        let midpoint = self.position(record).as_dvec3();
        self.mesh
            .corners(record)
            .map(|corner| offset + (corner.as_dvec3() - midpoint))
    }
}

impl Drawn for Triangles<'_> {
    fn len(&self) -> usize {
        self.mesh.triangles.len()
    }

    fn position(&self, record: usize) -> Vec3 {
        self.mesh.center(record)
    }

    fn reach(&self, record: usize) -> f64 {
        let midpoint = self.position(record).as_dvec3();
        let corners = self.mesh.corners(record).map(Vec3::as_dvec3);
        corners
            .into_iter()
            .map(|corner| corner.distance(midpoint))
            .fold(0.0, f64::max)
    }

    fn reach_px(&self) -> f64 {
        if self.mesh.has_points() { self.half_px } else { 0.0 }
    }

    fn faces_eye(&self, _: usize, _: DVec3) -> bool {
        true
    }

    fn meet(&self, ray: &Ray, record: usize, offset: DVec3) -> Option<Met> {
        if self.is_point(record) {
            let (depth, aside_px) = ray.project(offset)?;
            return meet_sprite(depth, aside_px, self.half_px, self.shape);
        }
        let [a, b, c] = self.corners_from_eye(record, offset);
        let direction = ray.direction();
        // The ray passes all sides on the same side.
        let sides = [(a, b), (b, c), (c, a)].map(|(from, to)| from.cross(to).dot(direction));
        let is_inside = sides.iter().all(|&side| side >= 0.0) || sides.iter().all(|&side| side <= 0.0);
        let normal = (b - a).cross(c - a);
        let depth = normal.dot(a) / normal.dot(direction);
        // False if it is seen edge-on.
        (is_inside && depth > 0.0 && depth.is_finite()).then_some(Met {
            depth,
            slack: 0.0,
            aside: 0.0,
        })
    }

    /// From the nearest of its sides.
    fn miss(&self, ray: &Ray, record: usize, offset: DVec3) -> Option<Miss> {
        let (depth, aside_px) = ray.project(offset)?;
        let outline_px = if self.is_point(record) {
            (aside_px.length() - self.half_px).max(0.0)
        } else {
            let [a, b, c] = self.corners_from_eye(record, offset);
            let [a, b, c] = [ray.project(a)?.1, ray.project(b)?.1, ray.project(c)?.1];
            let sides = [(a, b), (b, c), (c, a)].map(|(from, to)| nearest_to_zero(from, to).length());
            sides.into_iter().fold(f64::INFINITY, f64::min)
        };
        Some(Miss {
            depth,
            aside_px: aside_px.length(),
            outline_px,
        })
    }
}

/// The place between two places that is nearest to zero.
fn nearest_to_zero(from: DVec2, to: DVec2) -> DVec2 {
    let along = to - from;
    let share = -from.dot(along) / along.length_squared().max(f64::MIN_POSITIVE);
    from + along * share.clamp(0.0, 1.0)
}
