//! Drawable data of a frame.

use crate::scene::{Primitive, Style};
use crate::sequence::PreparedFrame;

/// True if `frame` has the data to draw a style.
pub fn can_draw(frame: &PreparedFrame, style: &Style) -> bool {
    match style.primitive {
        Primitive::Surfel | Primitive::Sprite => {
            frame.shapes.is_some() || style.has_screen_normals() && !style.shows_normal_errors()
        }
        Primitive::Ellipse => frame.shapes.is_some() && frame.has_ellipses,
        Primitive::Voxel => frame.levels.octree().is_some(),
        Primitive::Mesh => frame.mesh.is_some() || !frame.frame.has_faces(),
        Primitive::Point => true,
    }
}
