//! Display list of the shapes shown, and its difference from the previous one.
//!
//! **How it works.** egui hands over all shapes of a window each time, in the order in which they are painted. They are
//! compared with the previous ones: equal shapes at both ends of the list are found first, then each new shape in
//! between is searched among the next few old ones. Shapes in both lists, in the same order, keep their meshes; a pixel
//! that none of the others touches is made of the same shapes in the same order as before, so the bounds of the others
//! are the damage.
//!
//! Shapes are compared as they are, not by a hash: a difference is mostly found in the first few numbers. A text is
//! identified by the allocation of its galley, which cannot be another one's as long as the old list holds it.

use super::pieces::PixelMesh;
use super::{PixelRect, textures::Textures};
use egui::epaint::{ClippedPrimitive, ClippedShape, PaintCallback, Primitive, TextShape};
use egui::{Context, Rect, Shape};
use std::sync::Arc;

/// Number of old shapes compared with a new one before it counts as new: more than a widget consists of.
const LOOK_AHEAD: usize = 48;

/// A shape and its pixels.
#[derive(Debug)]
pub(super) struct TessellatedShape {
    shape: ClippedShape,
    pub(super) parts: Vec<TessellatedMesh>,
}

/// One mesh of a shape.
#[derive(Debug)]
pub(super) struct TessellatedMesh {
    pub(super) mesh: PixelMesh,
    /// The version of its texture when it was last damage.
    texture_version: u64,
}

impl TessellatedShape {
    /// Calls `damage` with the bounds of meshes whose texture is another one by now.
    pub(super) fn follow_textures(&mut self, textures: &Textures, mut damage: impl FnMut(PixelRect)) {
        for part in &mut self.parts {
            let version = textures.version(part.mesh.texture);
            if std::mem::replace(&mut part.texture_version, version) != version {
                damage(part.mesh.bounds);
            }
        }
    }
}

/// The window that shapes are painted to.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct WindowScale {
    pub(super) size_px: [u32; 2],
    pub(super) pixels_per_point: f32,
}

/// Replaces `entries` by `shapes`, and calls `damage` with the bounds of shapes in only one of them.
pub(super) fn replace(
    entries: &mut Vec<TessellatedShape>,
    shapes: Vec<ClippedShape>,
    ctx: &Context,
    screen: WindowScale,
    textures: &Textures,
    mut damage: impl FnMut(PixelRect),
) {
    let mut leaves = Vec::with_capacity(shapes.len());
    for shape in shapes {
        flatten(shape, &mut leaves);
    }
    let old = std::mem::take(entries);
    let retained = matches(&old, &leaves);
    let new = leaves.iter().zip(&retained).filter(|(_, retained)| retained.is_none());
    let mut meshes = tessellated(new.map(|(shape, _)| shape.clone()).collect(), ctx, screen);
    let mut old = old.into_iter().enumerate();
    let mut changed = |entry: &TessellatedShape| {
        for part in &entry.parts {
            damage(part.mesh.bounds);
        }
    };
    entries.reserve(leaves.len());
    for (shape, retained) in leaves.into_iter().zip(retained) {
        let Some(retained) = retained else {
            let parts = meshes.next().unwrap_or_default().into_iter();
            let parts = parts.map(|mesh| TessellatedMesh {
                texture_version: textures.version(mesh.texture),
                mesh,
            });
            let parts = parts.collect();
            let entry = TessellatedShape { shape, parts };
            changed(&entry);
            entries.push(entry);
            continue;
        };
        // Old entries before the next retained one are no longer shown.
        for (index, entry) in old.by_ref() {
            if index == retained {
                entries.push(entry);
                break;
            }
            changed(&entry);
        }
    }
    old.for_each(|(_, entry)| changed(&entry));
}

/// Takes nested shapes apart and drops those that cannot be seen.
fn flatten(shape: ClippedShape, leaves: &mut Vec<ClippedShape>) {
    let is_drawn = match &shape.shape {
        Shape::Noop | Shape::Callback(_) => false,
        // The tessellator assumes that indices are valid vertices.
        Shape::Mesh(mesh) => mesh.is_valid(),
        _ => true,
    };
    if !is_drawn || !shape.clip_rect.is_positive() {
        return;
    }
    match shape.shape {
        Shape::Vec(shapes) => {
            for inner in shapes {
                flatten(
                    ClippedShape {
                        clip_rect: shape.clip_rect,
                        shape: inner,
                        transform_after_tessellation: shape.transform_after_tessellation,
                    },
                    leaves,
                );
            }
        }
        _ => leaves.push(shape),
    }
}

/// For each new shape the old entry it is equal to, in ascending order.
fn matches(old: &[TessellatedShape], new: &[ClippedShape]) -> Vec<Option<usize>> {
    let is_same = |(old, new): &(&TessellatedShape, &ClippedShape)| are_same(&old.shape, new);
    let before = old.iter().zip(new).take_while(is_same).count();
    let (old_rest, new_rest) = (&old[before..], &new[before..]);
    let after = old_rest.iter().rev().zip(new_rest.iter().rev());
    let after = after.take_while(is_same).count();
    let mut retained: Vec<Option<usize>> = (0..before).map(Some).collect();
    retained.reserve(new_rest.len());
    let old_end = old.len() - after;
    let mut next = before;
    for shape in &new_rest[..new_rest.len() - after] {
        let end = old_end.min(next + LOOK_AHEAD);
        let found = (next..end).find(|&index| are_same(&old[index].shape, shape));
        next = found.map_or(next, |index| index + 1);
        retained.push(found);
    }
    retained.extend((old_end..old.len()).map(Some));
    retained
}

/// Returns true if both are painted alike.
fn are_same(a: &ClippedShape, b: &ClippedShape) -> bool {
    if a.clip_rect != b.clip_rect || a.transform_after_tessellation != b.transform_after_tessellation {
        return false;
    }
    match (&a.shape, &b.shape) {
        (Shape::Text(a), Shape::Text(b)) => are_same_text(a, b),
        (Shape::Mesh(a), Shape::Mesh(b)) => Arc::ptr_eq(a, b) || a == b,
        (a, b) => a == b,
    }
}

fn are_same_text(a: &TextShape, b: &TextShape) -> bool {
    a.pos == b.pos
        && Arc::ptr_eq(&a.galley, &b.galley)
        && a.underline == b.underline
        && a.fallback_color == b.fallback_color
        && a.override_text_color == b.override_text_color
        && a.opacity_factor == b.opacity_factor
        && a.angle == b.angle
}

/// The meshes of each shape.
///
/// egui puts neighbours into one mesh and does not tell which is whose. Callbacks are always by themselves, so one
/// stands between any two shapes.
fn tessellated(shapes: Vec<ClippedShape>, ctx: &Context, screen: WindowScale) -> impl Iterator<Item = Vec<PixelMesh>> {
    let separator = ClippedShape {
        clip_rect: Rect::EVERYTHING,
        shape: Shape::Callback(PaintCallback {
            rect: Rect::NOTHING,
            callback: Arc::new(()),
        }),
        transform_after_tessellation: egui::emath::TSTransform::IDENTITY,
    };
    let count = shapes.len();
    let mut separated = Vec::with_capacity(2 * count);
    for shape in shapes {
        separated.extend([shape, separator.clone()]);
    }
    let primitives = if count == 0 {
        Vec::new()
    } else {
        ctx.tessellate(separated, screen.pixels_per_point)
    };
    let mut primitives = primitives.into_iter();
    (0..count).map(move |_| {
        let of_shape = primitives.by_ref().map_while(|primitive| {
            let ClippedPrimitive { clip_rect, primitive } = primitive;
            match primitive {
                Primitive::Mesh(mesh) => Some((clip_rect, mesh)),
                Primitive::Callback(_) => None,
            }
        });
        let meshes = of_shape.map(|(clip_rect, mesh)| {
            let scale = screen.pixels_per_point;
            let clip = PixelRect::of_clip(clip_rect, scale, screen.size_px);
            PixelMesh::new(&mesh, clip, scale)
        });
        meshes.filter(|mesh| !mesh.bounds.is_empty()).collect()
    })
}
