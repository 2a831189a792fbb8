//! GPU primitives: one file per primitive, with the names of `render/cpu/primitives`. It defines the expansion of a
//! record, the records, and the passes that draw them.
//!
//! | primitive | passes |
//! |---|---|
//! | point | point, or round point |
//! | point, lit | solid, or opaque |
//! | point `gaussian` | visibility, attribute, resolve |
//! | voxel | solid |
//! | mesh | solid, or round solid |
//! | surfel `regular`, `no-depth` | splat |
//! | surfel `opaque` | opaque |
//! | surfel `visibility` | visibility, depth view |
//! | surfel, other modes | visibility, attribute, resolve |
//!
//! Ellipses and sprites are drawn as surfels are.
//!
//! Where shading is deferred, *surface* passes are used instead of those that write colours, and shade and resolve
//! follow. Shadow maps are drawn by visibility, or by depth for voxels and triangles.

mod amplification;
mod drawable;
mod mesh;
mod points;
mod surfels;
mod voxels;

pub use amplification::Amplification;
pub(super) use drawable::Drawable;

use super::coded::CodeInView;
use crate::scene::{Content, Primitive, ScenePacket};

/// All of them.
pub const AMPLIFICATIONS: [&Amplification; 12] = [
    &points::PIXEL,
    &points::SQUARE,
    &points::SQUARE_WITH_SHAPE,
    &surfels::DISK,
    &surfels::ELLIPSE,
    &surfels::SPRITE,
    &surfels::ELLIPSE_SPRITE,
    &surfels::DISK_IN_TRIANGLE,
    &surfels::ELLIPSE_IN_TRIANGLE,
    &voxels::LIT_BY_FACES,
    &voxels::LIT_BY_NORMALS,
    &mesh::TRIANGLE,
];

/// Returns the drawable content of a packet: the only function that inspects the content, once per image.
pub(super) fn drawable(packet: &ScenePacket) -> Drawable<'_> {
    let style = &packet.style;
    match &packet.content {
        // For the first only the background is drawn.
        Content::Nothing | Content::Points(_) => points::drawable(packet),
        Content::Coded(cells) => of_surfels(packet).of_code(CodeInView {
            cells,
            view: packet.code_view(cells),
        }),
        Content::Selected(selected) => of_surfels(packet).selecting(&selected.selection),
        Content::Visible(visible) => of_surfels(packet).of_visible(visible),
        Content::Surfels(_) => of_surfels(packet),
        Content::Voxels(voxels) => voxels::drawable(voxels, style),
        Content::Mesh(mesh) => mesh::drawable(mesh, style),
    }
}

/// Points with radii and normals.
fn of_surfels(packet: &ScenePacket) -> Drawable<'_> {
    if packet.style.primitive == Primitive::Point {
        points::drawable(packet)
    } else {
        surfels::drawable(packet)
    }
}
