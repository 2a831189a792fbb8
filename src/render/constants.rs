//! Numbers that renderers on both sides know, and the truth. WGSL gets them from here (`gpu/constants.rs`).

use crate::scene::{Primitive, Style};

/// How far the visibility pass is pushed back, in splat radii. One radius is as far as two splats of one surface that
/// still overlap can lie apart in depth at 45 degrees.
pub(super) const DEPTH_SLACK_RADII: f32 = 1.0;

/// How fast a splat's mask falls off: at the rim of its disk it is exp(-3) = 0.05.
pub(super) const MASK_FALLOFF: f32 = 3.0;

/// Summed weight from which a pixel hides the background: a lone splat is opaque within 0.7 of its radius and fades
/// towards its rim.
const OPAQUE_WEIGHT: f32 = 0.22;

/// The same of points: a little less than the mask is at the rim. As points face the screen, those on a slope lie
/// behind one another, and the rim of the front one is all that is blended there.
const OPAQUE_WEIGHT_OF_POINTS: f32 = 0.049;

/// Weight from which a pixel hides the background. Where masks are not summed up, weights are opacities.
pub(super) fn opaque_weight(style: &Style) -> f32 {
    if !style.blends_at_depths() {
        1.0
    } else if style.primitive == Primitive::Point {
        OPAQUE_WEIGHT_OF_POINTS
    } else {
        OPAQUE_WEIGHT
    }
}

/// Light of a surface that is seen edge-on.
pub(super) const HEAD_LIGHT_AMBIENT: f32 = 0.25;
/// White that is added where a surface faces the eye.
pub(super) const HEAD_LIGHT_SPECULAR: f32 = 0.15;
/// Exponent of that white. Renderers multiply, since it is worked out for every fragment of every layer: the cube of
/// the eighth power.
pub(super) const HEAD_LIGHT_SHININESS: u32 = 24;
/// Factor on the colour of a surfel that is seen from behind, where that is to be told.
pub(super) const BACK_SIDE: f32 = 0.8;

/// Normals with more of the y axis are taken for parallel to it: another axis gives the directions of a surfel's
/// square.
pub(super) const UPRIGHT_NORMAL_Y: f32 = 0.99;

/// How far the corners of a surfel's square are from its middle, in radii: √2, rounded up.
pub(super) const SQUARE_REACH_RADII: f32 = 1.4143;
/// How far the corners of a cube are from its middle, in half edges: √3, rounded up.
pub(super) const CUBE_REACH_HALF_EDGES: f32 = 1.7321;

/// Greys of the nearest and the farthest depth in the picture of the visibility pass.
pub(super) const NEAREST_GREY: f32 = 0.95;
pub(super) const FARTHEST_GREY: f32 = 0.15;

/// Cells of the grid on the ground that are narrower have no lines.
pub(super) const NARROWEST_CELL_PX: f32 = 4.0;
/// Wider ones have full lines.
pub(super) const WIDEST_CELL_PX: f32 = 16.0;

/// Opacities of the grid's lines at its spacing, at ten times it and at a tenth.
pub(super) const USUAL_LINES: f32 = 0.4;
pub(super) const COARSE_LINES: f32 = 0.6;
pub(super) const FINE_LINES: f32 = 0.2;
