//! Triangles: soft edges, rounded corners, curves, turned text.
//!
//! **How it works.** A corner is rounded to a 256th of a pixel. Each edge is then a linear function of pixels in whole
//! numbers, not negative inside; one that is neither a left nor an upper edge is one less, so that a centre on it is
//! outside (the top-left rule). Where a row enters and leaves all three is a division each, and the span between is
//! painted without further tests.
//!
//! Colours and texture coordinates are planes through the corners as egui gave them, evaluated at each pixel from the
//! first corner. Nothing is summed up along a row, so it makes no difference from where a row is painted.

use super::PixelRect;
use super::blend::{channels, lay, over, packed, rounded};
use super::canvas::Canvas;
use super::pieces::{SUBPIXELS, TriangleFill, fixed};
use super::textures::SampledTexture;
use egui::Pos2;
use egui::epaint::Vertex;

/// Paints the part of a triangle in `area`, which is on the canvas.
#[inline(always)]
pub(super) fn paint(
    corners: &[Vertex; 3],
    kind: TriangleFill,
    source: &SampledTexture<'_>,
    area: &PixelRect,
    canvas: &mut Canvas<'_>,
) {
    let Some(edges) = edges(corners, area.min) else {
        return;
    };
    match kind {
        TriangleFill::Flat => {
            let color = packed(corners[0].color);
            for_spans(edges, area, |y, from, to| {
                lay(color, canvas.span(y, from, to));
            });
        }
        TriangleFill::Shaded => {
            let color = TriangleInterpolant::new(corners, colors(corners));
            for_spans(edges, area, |y, from, to| {
                let row = color.row(y);
                for (x, pixel) in (from..).zip(canvas.span(y, from, to)) {
                    *pixel = over(rounded(row.at(x)), *pixel);
                }
            });
        }
        TriangleFill::Textured => {
            let color = TriangleInterpolant::new(corners, colors(corners));
            let size = [source.size[0] as f32, source.size[1] as f32];
            let texel_at = |uv: Pos2| [uv.x * size[0], uv.y * size[1]];
            let [a, b, c] = corners;
            let texels = [texel_at(a.uv), texel_at(b.uv), texel_at(c.uv)];
            let texel = TriangleInterpolant::new(corners, texels);
            for_spans(edges, area, |y, from, to| {
                let (color, texel) = (color.row(y), texel.row(y));
                for (x, pixel) in (from..).zip(canvas.span(y, from, to)) {
                    let mut shade = source.at(texel.at(x));
                    for (channel, tint) in shade.iter_mut().zip(color.at(x)) {
                        *channel *= tint * (1.0 / 255.0);
                    }
                    *pixel = over(rounded(shade), *pixel);
                }
            });
        }
    }
}

#[inline(always)]
fn colors([a, b, c]: &[Vertex; 3]) -> [[f32; 4]; 3] {
    let color = |vertex: &Vertex| channels(packed(vertex.color));
    [color(a), color(b), color(c)]
}

/// An edge at a pixel's centre, in 256ths squared; not negative inside.
#[derive(Clone, Copy)]
struct Edge {
    at_first: i64,
    per_column: i64,
    per_row: i64,
}

/// The edges relative to a pixel; `None` if their interior is empty.
#[inline(always)]
fn edges(corners: &[Vertex; 3], first: [u32; 2]) -> Option<[Edge; 3]> {
    let place = |vertex: &Vertex| [fixed(vertex.pos.x), fixed(vertex.pos.y)];
    let (a, mut b, mut c) = (place(&corners[0]), place(&corners[1]), place(&corners[2]));
    let doubled_area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    if doubled_area == 0 {
        return None;
    }
    if doubled_area < 0 {
        std::mem::swap(&mut b, &mut c);
    }
    let center = |at: u32| i64::from(at) * SUBPIXELS + SUBPIXELS / 2;
    let center = [center(first[0]), center(first[1])];
    Some([
        Edge::new(a, b, center),
        Edge::new(b, c, center),
        Edge::new(c, a, center),
    ])
}

impl Edge {
    /// From one corner to the next, clockwise, rows counted downwards.
    #[inline(always)]
    fn new(from: [i64; 2], to: [i64; 2], center: [i64; 2]) -> Self {
        let along = [to[0] - from[0], to[1] - from[1]];
        let is_left = along[1] < 0;
        let is_upper = along[1] == 0 && along[0] > 0;
        let at_first = along[0] * (center[1] - from[1]) - along[1] * (center[0] - from[0]);
        Self {
            at_first: at_first - i64::from(!(is_left || is_upper)),
            per_column: -along[1] * SUBPIXELS,
            per_row: along[0] * SUBPIXELS,
        }
    }
}

/// Calls `span` with row, first column and the one after the last, for each row with pixels inside all edges.
#[inline(always)]
fn for_spans(mut edges: [Edge; 3], area: &PixelRect, mut span: impl FnMut(u32, u32, u32)) {
    let width = i64::from(area.max[0] - area.min[0]);
    for y in area.min[1]..area.max[1] {
        let (mut from, mut to) = (0, width);
        for edge in &mut edges {
            let value = edge.at_first;
            edge.at_first += edge.per_row;
            if edge.per_column > 0 {
                if value < 0 {
                    from = from.max((edge.per_column - 1 - value) / edge.per_column);
                }
            } else if value < 0 {
                to = 0;
            } else if edge.per_column < 0 {
                // Distances beyond the width do not matter, and a comparison is cheaper than a division.
                if value < -edge.per_column * width {
                    to = to.min(value / -edge.per_column + 1);
                }
            }
        }
        if from < to {
            span(y, area.min[0] + from as u32, area.min[0] + to as u32);
        }
    }
}

/// Values that are linear over a triangle.
struct TriangleInterpolant<const N: usize> {
    corner_px: [f32; 2],
    at_corner: [f32; N],
    per_column: [f32; N],
    per_row: [f32; N],
}

/// Interpolant along a row.
struct RowInterpolant<const N: usize> {
    corner_px: f32,
    at_corner: [f32; N],
    per_column: [f32; N],
}

impl<const N: usize> TriangleInterpolant<N> {
    #[inline(always)]
    fn new(corners: &[Vertex; 3], [a, b, c]: [[f32; N]; 3]) -> Self {
        let (origin, second, third) = (corners[0].pos, corners[1].pos, corners[2].pos);
        let (to_b, to_c) = (second - origin, third - origin);
        let per_area = 1.0 / (to_b.x * to_c.y - to_c.x * to_b.y);
        let (mut per_column, mut per_row) = ([0.0; N], [0.0; N]);
        for at in 0..N {
            let (rise_b, rise_c) = (b[at] - a[at], c[at] - a[at]);
            per_column[at] = (rise_b * to_c.y - rise_c * to_b.y) * per_area;
            per_row[at] = (rise_c * to_b.x - rise_b * to_c.x) * per_area;
        }
        Self {
            corner_px: [origin.x, origin.y],
            at_corner: a,
            per_column,
            per_row,
        }
    }

    #[inline(always)]
    fn row(&self, y: u32) -> RowInterpolant<N> {
        let down_px = y as f32 + 0.5 - self.corner_px[1];
        let mut at_corner = self.at_corner;
        for (value, per_row) in at_corner.iter_mut().zip(self.per_row) {
            *value += per_row * down_px;
        }
        RowInterpolant {
            corner_px: self.corner_px[0],
            at_corner,
            per_column: self.per_column,
        }
    }
}

impl<const N: usize> RowInterpolant<N> {
    #[inline(always)]
    fn at(&self, x: u32) -> [f32; N] {
        let right_px = x as f32 + 0.5 - self.corner_px;
        let mut values = self.at_corner;
        for (value, per_column) in values.iter_mut().zip(self.per_column) {
            *value += per_column * right_px;
        }
        values
    }
}
