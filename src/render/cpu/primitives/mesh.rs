//! Triangles, and the vertices between them as points.

use crate::cloud::{MeshRecords, TriangleRecord, VertexRecord, oct_decode};
use crate::render::cpu::blocks::{Extent, Placed};
use crate::render::cpu::finish::Held;
use crate::render::cpu::records::DrawnRecords;
use crate::render::cpu::shading::unit_color;
use crate::render::cpu::spans::for_each_span;
use crate::render::cpu::sprites::Sprite;
use crate::render::cpu::tile::{Tile, WIDTH};
use crate::render::cpu::triangle::{ShadedTriangle, TextureOnTriangle, Triangle, TriangleLight, TriangleShading, fill};
use crate::render::cpu::view::{PixelRect, PixelView};
use crate::scene::{DrawSettings, PointStyle, ScenePacket};
use fearless_simd::Simd;
use glam::Vec3;
use rayon::prelude::*;
use std::ops::Range;

/// Vertices that are worth handing to another thread.
const VERTICES_PER_TASK: usize = 1 << 12;

/// Triangles of a packet.
#[derive(Debug, Clone, Copy)]
pub(in crate::render::cpu) struct Mesh<'a> {
    pub(super) records: &'a MeshRecords,
    pub(super) style: &'a DrawSettings,
}

impl Placed for Mesh<'_> {
    fn len(&self) -> usize {
        self.records.triangles.len()
    }

    fn position(&self, record: usize) -> [f32; 3] {
        self.records.center(record).to_array()
    }

    fn reach(&self, record: usize) -> f32 {
        let center = self.records.center(record);
        let [a, b, c] = self.records.corners(record).map(|corner| corner.distance(center));
        // Slightly larger, to allow for the rounding of the centre.
        1.0001 * a.max(b).max(c)
    }
}

impl<'a> Mesh<'a> {
    /// Projects the vertices of the mesh to the image once: each is needed by several triangles, and these by several
    /// tiles.
    pub(super) fn seen(&self, packet: &ScenePacket) -> SeenMesh<'a> {
        let view = PixelView::new(packet);
        let vertices = self.records.vertices.par_iter().with_min_len(VERTICES_PER_TASK);
        SeenMesh {
            vertices: vertices.map(|vertex| SeenVertex::new(&view, vertex)).collect(),
            mesh: *self,
        }
    }
}

/// Triangles with their vertices in view space.
pub(super) struct SeenMesh<'a> {
    mesh: Mesh<'a>,
    vertices: Vec<SeenVertex>,
}

/// A vertex as seen from the eye.
#[derive(Debug, Clone, Copy)]
struct SeenVertex {
    /// In view space.
    place: Vec3,
    /// Normal in view space; zero if lighting is per face.
    normal: Vec3,
    /// Pixel position; not meaningful behind the near plane.
    px: [f64; 2],
}

impl SeenVertex {
    fn new(view: &PixelView, vertex: &VertexRecord) -> Self {
        let place = view.rotate(view.offset_from_eye(vertex.position));
        let normal = match vertex.normal {
            VertexRecord::NO_NORMAL => Vec3::ZERO,
            packed => view.rotate(oct_decode(packed)),
        };
        Self {
            place,
            normal,
            px: to_px(view, place),
        }
    }
}

fn to_px(view: &PixelView, place: Vec3) -> [f64; 2] {
    let px = |axis: usize| {
        let slope = f64::from(place[axis]) / -f64::from(place.z);
        f64::from(view.center_px[axis]) + slope * f64::from(view.px_per_slope[axis])
    };
    [px(0), px(1)]
}

impl Placed for SeenMesh<'_> {
    fn len(&self) -> usize {
        self.mesh.len()
    }

    fn position(&self, record: usize) -> [f32; 3] {
        self.mesh.position(record)
    }

    fn reach(&self, record: usize) -> f32 {
        self.mesh.reach(record)
    }
}

impl DrawnRecords for SeenMesh<'_> {
    type Scratch = ();

    fn held(&self, packet: &ScenePacket) -> Held {
        Held::surfaces(packet).unwrap_or(Held::SolidColors)
    }

    fn extent(&self) -> Extent {
        let has_points = self.mesh.records.has_points();
        Extent {
            scale: 1.0,
            margin_px: if has_points { 0.5 * self.point_size_px() } else { 0.0 },
            ..Extent::default()
        }
    }

    /// Draws the triangles; of two at the same distance the later one is visible.
    #[inline(always)]
    fn draw<S: Simd>(
        &self,
        simd: S,
        view: &PixelView,
        tile: &mut Tile,
        clip: PixelRect,
        records: impl Iterator<Item = Range<usize>> + Clone,
        (): &mut (),
    ) {
        for record in records.flat_map(|range| &self.mesh.records.triangles[range]) {
            if record.is_point() {
                self.draw_point(view, tile, clip, record);
            } else {
                self.draw_triangle(simd, view, tile, clip, record);
            }
        }
    }
}

impl SeenMesh<'_> {
    /// One pixel at least.
    fn point_size_px(&self) -> f32 {
        self.mesh.style.points.size_px.max(1.0)
    }

    #[inline(always)]
    fn draw_triangle<S: Simd>(
        &self,
        simd: S,
        view: &PixelView,
        tile: &mut Tile,
        clip: PixelRect,
        record: &TriangleRecord,
    ) {
        let corners = record.corners.map(|corner| &self.vertices[corner as usize]);
        // The outline, and not the affine functions of the triangle, decides which pixels are covered: along an edge
        // these are rounded differently on both sides, and a closed mesh would have pinholes.
        let (count, outline) = in_front(view, corners);
        let outline = &outline[..count];
        if !may_touch(outline, clip) {
            return;
        }
        // Most triangles cover no pixel of a tile, or none at all: nothing is computed for these.
        let mut seen: Option<ShadedTriangle<'_>> = None;
        for_each_span(
            outline,
            clip,
            #[inline(always)]
            |y, columns| {
                let shaded = seen.get_or_insert_with(|| ShadedTriangle {
                    triangle: Triangle::new(view, corners.map(|corner| corner.place)),
                    shading: self.shading(view, record, corners),
                });
                fill(simd, view, tile, shaded, y, columns);
            },
        );
    }

    fn shading(&self, view: &PixelView, record: &TriangleRecord, corners: [&SeenVertex; 3]) -> TriangleShading<'_> {
        let lighting = self.mesh.style.light.lighting;
        let face = view.rotate(oct_decode(record.normal));
        let normals = corners.map(|corner| {
            if corner.normal == Vec3::ZERO {
                face
            } else {
                corner.normal
            }
        });
        TriangleShading {
            colors: record.corners.map(|corner| self.color(corner)),
            texture: self.texture(record),
            light: TriangleLight::new(lighting, corners.map(|corner| corner.place), normals, face),
            normals: lighting.is_deferred().then_some(normals),
        }
    }

    /// The texture of the first corner: the others have the same.
    fn texture(&self, record: &TriangleRecord) -> Option<TextureOnTriangle<'_>> {
        let records = self.mesh.records;
        let [a, b, c] = record.corners.map(|corner| &records.vertices[corner as usize]);
        (a.texture != VertexRecord::NO_TEXTURE).then(|| TextureOnTriangle {
            textures: &records.textures,
            texture: a.texture as usize,
            places: [a.texture_place, b.texture_place, c.texture_place],
        })
    }

    fn color(&self, vertex: u32) -> [f32; 3] {
        let [red, green, blue, _] = self.mesh.records.vertices[vertex as usize].color;
        unit_color([red, green, blue])
    }

    /// A vertex that belongs to no triangle, without light.
    #[inline(always)]
    fn draw_point(&self, view: &PixelView, tile: &mut Tile, clip: PixelRect, record: &TriangleRecord) {
        let [vertex, ..] = record.corners;
        let SeenVertex { place, px, .. } = self.vertices[vertex as usize];
        let depth = view.near / -place.z;
        if !(depth > 0.0 && depth <= 1.0) {
            return;
        }
        let PointStyle { shape, .. } = self.mesh.style.drawn_points();
        let sprite = Sprite {
            place_px: px.map(|place| place as f32),
            half_px: 0.5 * self.point_size_px(),
            shape,
        };
        let color = self.color(vertex);
        let [left, top] = tile.origin;
        sprite.for_each_row(
            clip,
            #[inline(always)]
            |y, columns| {
                let row = (y - top) as usize * WIDTH;
                for x in columns {
                    put(tile, row + (x - left) as usize, depth, color);
                }
            },
        );
    }
}

/// Draws a pixel of a point, unless something is nearer. It has no normal: when the finished surface is lit, it is not.
#[inline(always)]
fn put(tile: &mut Tile, at: usize, depth: f32, color: [f32; 3]) {
    if depth < tile.depth[at] {
        return;
    }
    tile.depth[at] = depth;
    for (channel, value) in tile.colors.iter_mut().zip(color) {
        channel[at] = value;
    }
    if let Some(weight) = tile.weight.get_mut(at) {
        *weight = 1.0;
        for (values, value) in tile.surfaces.iter_mut().zip([0.0, 0.0, 0.0, depth]) {
            values[at] = value;
        }
    }
}

/// The part of a triangle in front of the near plane, in pixels: the number of its corners, and these.
#[inline(always)]
fn in_front(view: &PixelView, corners: [&SeenVertex; 3]) -> (usize, [[f64; 2]; 4]) {
    let is_in_front = |corner: &SeenVertex| corner.place.z <= -view.near;
    let mut outline = [[0.0; 2]; 4];
    if corners.into_iter().all(is_in_front) {
        for (place, corner) in outline.iter_mut().zip(corners) {
            *place = corner.px;
        }
        return (3, outline);
    }
    let mut count = 0;
    let mut add = |px: [f64; 2]| {
        outline[count] = px;
        count += 1;
    };
    for (index, corner) in corners.into_iter().enumerate() {
        let next = corners[(index + 1) % 3];
        if is_in_front(corner) {
            add(corner.px);
        }
        // Starting from the corner in front, so that triangles on both sides of an edge are cut at the same position.
        match (is_in_front(corner), is_in_front(next)) {
            (true, false) => add(to_px(view, on_near_plane(view, corner.place, next.place))),
            (false, true) => add(to_px(view, on_near_plane(view, next.place, corner.place))),
            _ => {}
        }
    }
    (count, outline)
}

/// Returns the intersection of the near plane with the line from a point in front of it to one behind it.
fn on_near_plane(view: &PixelView, in_front: Vec3, behind: Vec3) -> Vec3 {
    let share = (-view.near - in_front.z) / (behind.z - in_front.z);
    let mut place = in_front + (behind - in_front) * share;
    place.z = -view.near;
    place
}

/// Returns true if the bounding box of an outline has pixels of `clip`.
#[inline(always)]
fn may_touch(outline: &[[f64; 2]], clip: PixelRect) -> bool {
    (0..2).all(|axis| {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for corner in outline {
            low = low.min(corner[axis]);
            high = high.max(corner[axis]);
        }
        high >= f64::from(clip.start[axis]) && low <= f64::from(clip.end[axis])
    })
}
