//! Surfels, round or not, in the six modes of the 4D media paper, Fig. 3, and as hard disks.

use super::amplification::{Amplification, QUAD_VARYINGS};
use super::drawable::{Drawable, Passes};
use crate::render::gpu::constants::VERTICES_PER_TRIANGLE;
use crate::render::gpu::passes::ScreenPass;
use crate::render::gpu::passes::geometry::{
    ATTRIBUTE, NO_DEPTH, OPAQUE, REGULAR, SURFACE_ATTRIBUTE, SURFACE_NO_DEPTH, SURFACE_OPAQUE, SURFACE_REGULAR,
    VISIBILITY, VISIBILITY_SQUARE,
};
use crate::render::gpu::passes::screen::{DEPTH_VIEW, RESOLVE};
use crate::render::gpu::residency::RecordSource;
use crate::render::gpu::wgsl::shader_file;
use crate::scene::{Primitive, ScenePacket, SplatGeometry, Splatting, VisibilityShape};

/// One quad in the plane of the surfel, with a disk.
pub(super) const DISK: Amplification = Amplification {
    name: "surfel",
    files: &[
        shader_file!("primitives/disk_axes.wgsl"),
        shader_file!("primitives/surfels.wgsl"),
    ],
    varyings: QUAD_VARYINGS,
    vertices_per_record: 4,
    reads_shapes: true,
    is_indexed: false,
    writes_depths: false,
    compute_amplifies: true,
    passes: &[
        &VISIBILITY,
        &VISIBILITY_SQUARE,
        &ATTRIBUTE,
        &REGULAR,
        &NO_DEPTH,
        &OPAQUE,
        &SURFACE_ATTRIBUTE,
        &SURFACE_REGULAR,
        &SURFACE_NO_DEPTH,
        &SURFACE_OPAQUE,
    ],
};

/// Quad around an ellipse.
pub(super) const ELLIPSE: Amplification = Amplification {
    name: "ellipse",
    files: &[
        shader_file!("primitives/ellipse_axes.wgsl"),
        shader_file!("primitives/surfels.wgsl"),
    ],
    ..DISK
};

/// Triangle around the disk: fewer vertices and triangles, more pixels outside the disk. The squares of
/// [`Splatting::Regular`] are not part of it.
pub(super) const DISK_IN_TRIANGLE: Amplification = Amplification {
    name: "surfel in triangle",
    vertices_per_record: VERTICES_PER_TRIANGLE,
    passes: &[
        &VISIBILITY,
        &ATTRIBUTE,
        &NO_DEPTH,
        &OPAQUE,
        &SURFACE_ATTRIBUTE,
        &SURFACE_NO_DEPTH,
        &SURFACE_OPAQUE,
    ],
    ..DISK
};

/// Triangle around an ellipse.
pub(super) const ELLIPSE_IN_TRIANGLE: Amplification = Amplification {
    name: "ellipse in triangle",
    files: ELLIPSE.files,
    ..DISK_IN_TRIANGLE
};

/// One quad that faces the screen, around the disk.
pub(super) const SPRITE: Amplification = Amplification {
    name: "sprite",
    files: &[shader_file!("primitives/disk_axes.wgsl")],
    varyings: shader_file!("primitives/sprites.wgsl"),
    writes_depths: true,
    // A corner has three times as many values as one on a surface. The vertex stage computes it only once anyway:
    // `compute` draws sprites in the same way as `storage`.
    compute_amplifies: false,
    ..DISK
};

/// Sprite around an ellipse.
pub(super) const ELLIPSE_SPRITE: Amplification = Amplification {
    name: "ellipse sprite",
    files: &[shader_file!("primitives/ellipse_axes.wgsl")],
    ..SPRITE
};

/// Precondition: `packet` draws surfels.
pub(super) fn drawable(packet: &ScenePacket) -> Drawable<'_> {
    let style = &packet.style;
    let is_deferred = style.light.lighting.is_deferred();
    let (passes, resolve): (Passes, Option<&'static ScreenPass>) = match style.surfels.splatting {
        Splatting::Regular if is_deferred => (&[&SURFACE_REGULAR], Some(&RESOLVE)),
        Splatting::Regular => (&[&REGULAR], None),
        Splatting::NoDepth | Splatting::Sorted if is_deferred => (&[&SURFACE_NO_DEPTH], Some(&RESOLVE)),
        Splatting::NoDepth | Splatting::Sorted => (&[&NO_DEPTH], None),
        Splatting::Opaque if is_deferred => (&[&SURFACE_OPAQUE], Some(&RESOLVE)),
        Splatting::Opaque => (&[&OPAQUE], None),
        Splatting::Visibility => match style.visibility_shape() {
            VisibilityShape::Disk => (&[&VISIBILITY], Some(&DEPTH_VIEW)),
            VisibilityShape::Square => (&[&VISIBILITY_SQUARE], Some(&DEPTH_VIEW)),
        },
        Splatting::TwoPass | Splatting::Enlarged | Splatting::TwoPassEnlarged => {
            let passes: Passes = match (style.visibility_shape(), is_deferred) {
                (VisibilityShape::Disk, false) => &[&VISIBILITY, &ATTRIBUTE],
                (VisibilityShape::Disk, true) => &[&VISIBILITY, &SURFACE_ATTRIBUTE],
                (VisibilityShape::Square, false) => &[&VISIBILITY_SQUARE, &ATTRIBUTE],
                (VisibilityShape::Square, true) => &[&VISIBILITY_SQUARE, &SURFACE_ATTRIBUTE],
            };
            (passes, Some(&RESOLVE))
        }
    };
    let points = packet.content.points().map(RecordSource::of);
    let shapes = packet.content.shapes().map(RecordSource::of);
    let is_ellipse = style.primitive == Primitive::Ellipse;
    let amplification = match (style.draws_sprites(), style.splat_geometry(), is_ellipse) {
        (true, _, false) => &SPRITE,
        (true, _, true) => &ELLIPSE_SPRITE,
        (false, SplatGeometry::Quad, false) => &DISK,
        (false, SplatGeometry::Quad, true) => &ELLIPSE,
        (false, SplatGeometry::Triangle, false) => &DISK_IN_TRIANGLE,
        (false, SplatGeometry::Triangle, true) => &ELLIPSE_IN_TRIANGLE,
    };
    Drawable {
        amplification,
        streams: points.into_iter().chain(shapes).collect(),
        selection: None,
        visible: None,
        code: None,
        chunked_for: &DISK,
        cull_back_faces: style.culls_back_faces(),
        passes,
        depth_pass: Some((amplification, &VISIBILITY)),
        resolve,
    }
}
