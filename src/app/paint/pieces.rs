//! From egui's meshes to painted pieces: fills, images and triangles, in pixels.
//!
//! **How it works.** egui gives triangles only, but most of a window consists of pairs of triangles that form
//! rectangles aligned with rows and columns: backgrounds, glyphs, images. They are found here, once for each new shape,
//! and are painted by rows without edge tests. The rest are rounded corners, soft edges, curves and rotated text.
//!
//! A pixel is covered if its centre is, with corners rounded to 256ths of a pixel; a centre on an edge belongs to the
//! shape whose left or upper edge it is (the top-left rule), so shapes that meet neither overlap nor leave a gap.

use super::PixelRect;
use super::blend::{alpha, packed};
use egui::epaint::{Vertex, WHITE_UV};
use egui::{Color32, Mesh, Pos2, TextureId};

/// Steps in a pixel.
pub(super) const SUBPIXELS: i64 = 256;

/// Corners of triangles farther away are not drawn: products of edges would not fit in 64 bits.
const FARTHEST_PX: f32 = 1_048_576.0;

/// Something that is painted at one go.
#[derive(Debug, Clone)]
pub(super) enum Piece {
    /// Pixels of one colour.
    Fill { area: PixelRect, color: u32 },
    /// A part of the texture, its rows and columns matching the window's.
    Image {
        area: PixelRect,
        place: TexturePlacement,
        tint: u32,
    },
    /// Anything else; corners are the mesh's.
    Triangle {
        area: PixelRect,
        corners: [u32; 3],
        kind: TriangleFill,
    },
}

/// Fill of a triangle: the computation that its pixels need.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum TriangleFill {
    /// One colour.
    Flat,
    /// A colour for each corner.
    Shaded,
    /// The texture too.
    Textured,
}

/// Texture placement in the window: at `corner_px` it is at `corner_uv`.
#[derive(Debug, Clone, Copy)]
pub(super) struct TexturePlacement {
    corner_px: [f32; 2],
    corner_uv: [f32; 2],
    uv_per_px: [f32; 2],
}

impl TexturePlacement {
    /// The coordinate along an axis at the centre of a pixel, times the texture's edge.
    #[inline(always)]
    pub(super) fn texel_at(&self, axis: usize, pixel: u32, edge: usize) -> f32 {
        let from_corner_px = pixel as f32 + 0.5 - self.corner_px[axis];
        (self.corner_uv[axis] + from_corner_px * self.uv_per_px[axis]) * edge as f32
    }
}

/// A mesh in pixels, cut into pieces.
#[derive(Debug, Clone)]
pub(super) struct PixelMesh {
    pub(super) texture: TextureId,
    pub(super) clip: PixelRect,
    /// Around all pixels that any piece may change.
    pub(super) bounds: PixelRect,
    /// Pixels that hide everything below.
    pub(super) hidden_by_fill: PixelRect,
    /// Rectangle hidden by the image if the texture is opaque.
    pub(super) hidden_by_image: PixelRect,
    /// Positions in pixels.
    pub(super) vertices: Vec<Vertex>,
    pub(super) pieces: Vec<Piece>,
}

impl PixelMesh {
    /// Cuts a mesh into pieces; triangles that cannot be drawn are skipped.
    pub(super) fn new(mesh: &Mesh, clip: PixelRect, pixels_per_point: f32) -> Self {
        let to_pixels = |vertex: &Vertex| Vertex {
            pos: Pos2::new(vertex.pos.x * pixels_per_point, vertex.pos.y * pixels_per_point),
            ..*vertex
        };
        let mut this = Self {
            texture: mesh.texture_id,
            clip,
            bounds: PixelRect::NOTHING,
            hidden_by_fill: PixelRect::NOTHING,
            hidden_by_image: PixelRect::NOTHING,
            vertices: mesh.vertices.iter().map(to_pixels).collect(),
            pieces: Vec::new(),
        };
        let (triangles, _) = mesh.indices.as_chunks::<3>();
        this.pieces.reserve(triangles.len() / 2);
        let mut rest = triangles;
        while let [first, after @ ..] = rest {
            rest = after;
            let Some(corners) = this.corners(first) else {
                continue;
            };
            if let Some(second) = after.first().and_then(|second| this.corners(second))
                && let Some(piece) = this.rectangle(&corners, &second)
            {
                rest = &after[1..];
                this.push(piece);
            } else {
                this.push_triangle(*first, &corners);
            }
        }
        if this.pieces.iter().all(|piece| !piece.has_corners()) {
            this.vertices = Vec::new();
        }
        this
    }

    fn corners(&self, indices: &[u32; 3]) -> Option<[Vertex; 3]> {
        let mut corners = [Vertex::default(); 3];
        for (corner, &index) in corners.iter_mut().zip(indices) {
            *corner = *self.vertices.get(index as usize)?;
        }
        // NaN and infinities turn the sum into NaN.
        let sum = |Vertex { pos, uv, .. }: &Vertex| pos.x * 0.0 + pos.y * 0.0 + uv.x * 0.0 + uv.y * 0.0;
        let are_numbers = corners.iter().map(sum).sum::<f32>() == 0.0;
        are_numbers.then_some(corners)
    }

    /// Returns true if the texture is white all over the triangle.
    fn is_plain(&self, corners: &[Vertex]) -> bool {
        self.texture == TextureId::default() && corners.iter().all(|corner| corner.uv == WHITE_UV)
    }

    /// Returns the piece for two triangles that make up a rectangle of one tint.
    #[inline]
    fn rectangle(&self, a: &[Vertex; 3], b: &[Vertex; 3]) -> Option<Piece> {
        let tint = a[0].color;
        if a.iter().chain(b).any(|corner| corner.color != tint) {
            return None;
        }
        let xs = a.map(|corner| corner.pos.x);
        let ys = a.map(|corner| corner.pos.y);
        let low = Pos2::new(min(xs), min(ys));
        let high = Pos2::new(max(xs), max(ys));
        // For each axis, at the lower and at the upper edge; the texture must be neither rotated nor skewed.
        let mut uv: [[Option<f32>; 2]; 2] = [[None; 2]; 2];
        // Corners are numbered 0 to 3, with a sum of 6; the corner that one triangle lacks is opposite to the one that
        // the other lacks.
        let mut missing = [6; 2];
        for (triangle, missing) in [a, b].into_iter().zip(&mut missing) {
            let mut seen = 0_u32;
            for corner in triangle {
                let is_right = corner.pos.x == high.x;
                let is_below = corner.pos.y == high.y;
                if !is_right && corner.pos.x != low.x || !is_below && corner.pos.y != low.y {
                    return None;
                }
                let number = u32::from(is_right) + 2 * u32::from(is_below);
                *missing -= number.min(*missing);
                seen |= 1 << number;
                let sides = [usize::from(is_right), usize::from(is_below)];
                for ((uv, side), value) in uv.iter_mut().zip(sides).zip([corner.uv.x, corner.uv.y]) {
                    if *uv[side].get_or_insert(value) != value {
                        return None;
                    }
                }
            }
            if seen.count_ones() != 3 {
                return None;
            }
        }
        if missing[0] + missing[1] != 3 {
            return None;
        }
        let area = self.area(low, high);
        if self.is_plain(a) && self.is_plain(b) {
            let color = packed(tint);
            return Some(Piece::Fill { area, color });
        }
        let [[left, right], [top, bottom]] = uv.map(|edges| edges.map(Option::unwrap_or_default));
        let size_px = high - low;
        let place = TexturePlacement {
            corner_px: [low.x, low.y],
            corner_uv: [left, top],
            uv_per_px: [(right - left) / size_px.x, (bottom - top) / size_px.y],
        };
        let tint = packed(tint);
        Some(Piece::Image { area, place, tint })
    }

    fn push_triangle(&mut self, indices: [u32; 3], corners: &[Vertex; 3]) {
        let is_near = |corner: &Vertex| corner.pos.x.abs() <= FARTHEST_PX && corner.pos.y.abs() <= FARTHEST_PX;
        if !corners.iter().all(is_near) {
            return;
        }
        let xs = corners.map(|corner| corner.pos.x);
        let ys = corners.map(|corner| corner.pos.y);
        let area = self.area(Pos2::new(min(xs), min(ys)), Pos2::new(max(xs), max(ys)));
        let colors = corners.map(|corner| corner.color);
        let is_plain = self.is_plain(corners);
        if is_plain && colors == [Color32::TRANSPARENT; 3] {
            return;
        }
        let kind = if !is_plain {
            TriangleFill::Textured
        } else if colors == [colors[0]; 3] {
            TriangleFill::Flat
        } else {
            TriangleFill::Shaded
        };
        let corners = indices;
        self.push(Piece::Triangle { area, corners, kind });
    }

    fn push(&mut self, piece: Piece) {
        let area = *piece.area();
        if area.is_empty() {
            return;
        }
        match piece {
            Piece::Fill { color: 0, .. } | Piece::Image { tint: 0, .. } => return,
            Piece::Fill { color, .. } if alpha(color) == 255 => {
                grow(&mut self.hidden_by_fill, area);
            }
            Piece::Image { tint, .. } if tint == u32::MAX => {
                grow(&mut self.hidden_by_image, area);
            }
            _ => {}
        }
        self.bounds = self.bounds.union(&area);
        self.pieces.push(piece);
    }

    /// Pixels whose centres are in a rectangle and which are not clipped.
    fn area(&self, low: Pos2, high: Pos2) -> PixelRect {
        let first = |edge_px: f32| {
            let edge = fixed(edge_px.clamp(-FARTHEST_PX, FARTHEST_PX));
            ((edge + SUBPIXELS / 2 - 1).div_euclid(SUBPIXELS)).max(0) as u32
        };
        let covered = PixelRect {
            min: [first(low.x), first(low.y)],
            max: [first(high.x), first(high.y)],
        };
        covered.intersection(&self.clip)
    }
}

impl Piece {
    /// Pixels that it may change.
    pub(super) fn area(&self) -> &PixelRect {
        match self {
            Self::Fill { area, .. } | Self::Image { area, .. } | Self::Triangle { area, .. } => area,
        }
    }

    fn has_corners(&self) -> bool {
        matches!(self, Self::Triangle { .. })
    }
}

/// A coordinate in 256ths of a pixel.
#[inline(always)]
pub(super) fn fixed(at_px: f32) -> i64 {
    (at_px * SUBPIXELS as f32).round_ties_even() as i64
}

fn min([a, b, c]: [f32; 3]) -> f32 {
    a.min(b).min(c)
}

fn max([a, b, c]: [f32; 3]) -> f32 {
    a.max(b).max(c)
}

fn grow(largest: &mut PixelRect, area: PixelRect) {
    if area.area_px() > largest.area_px() {
        *largest = area;
    }
}
