//! Numbers that renderers on both sides know, and the truth. WGSL gets them from here (`gpu/constants.rs`, `effects`).

use crate::scene::{DrawSettings, Primitive, SplatFilter};

/// Depth bias of the visibility pass, in splat radii, of the ground truth and of points drawn as patches; of surfels it
/// is a setting, with the same default.
pub(super) const DEPTH_SLACK_RADII: f32 = 1.0;

/// Falloff of a splat's mask: at the edge of its disk it is exp(-3) = 0.05.
pub(super) const MASK_FALLOFF: f32 = 3.0;

/// Summed weight from which a pixel hides the background: a lone splat is opaque within 0.7 of its radius and fades
/// towards its edge.
// Not closed where three edges only just meet (0.15): up to 20 pixels of a white sphere of 3,000 points are darker.
// 0.05 closes them but hardens outlines (10,000 points: FLIP 0.0078 instead of 0.0061). 3·exp(−3) = 0.149 still leaves
// 9 darker pixels (3,000 points).
pub(super) const OPAQUE_WEIGHT: f32 = 0.22;

/// Opaque weight of points, see [`OPAQUE_WEIGHT`]: slightly below the mask value at the edge. As points face the
/// screen, those on a slope lie behind one another, and the edge of the front one is all that is blended there.
// With the weight of surfels, the background shines through steep parts of a surface.
const OPAQUE_WEIGHT_OF_POINTS: f32 = 0.049;

/// Weight from which a pixel hides the background. Where masks are not summed up, weights are opacities.
pub(super) fn opaque_weight(style: &DrawSettings) -> f32 {
    if !style.blends_at_depths() {
        1.0
    } else if style.primitive == Primitive::Point {
        OPAQUE_WEIGHT_OF_POINTS
    } else {
        OPAQUE_WEIGHT
    }
}

/// Additional reach of filtered splats compared with others, in pixels: the squares of [`SplatFilter::Ewa`], and the
/// rounding of distant splats.
pub(super) const EWA_REACH_PX: f32 = 1.1 * SQUARE_REACH_RADII * SplatFilter::RADIUS_PX + 1.0;

const _: () = assert!(EWA_REACH_PX > SplatFilter::CLAMP_RADIUS_PX);

/// Summed weight from which a surface of splats hides the background that are much smaller than a pixel: its mean where
/// their disks cover a square lattice with least overlap.
// Relative to this mean instead of 0.22, the minimum between three splats, an edge of far points covers the expected
// pixels to within 0.05 pixels (`tests/pictures/ewa.rs`), without a second sum.
pub(super) const EWA_MEAN_WEIGHT: f32 = 0.5;

/// Pixels of a filtered splat to the fourth power are not taken for less, so that quotients are numbers.
pub(super) const EWA_MIN_DETERMINANT: f32 = 1e-19;

/// Maximum number of samples in view-dependent texturing along the long axis of a pixel's footprint.
pub(super) const PHOTO_MAX_TAPS: f32 = 4.0;

/// Width of the border in which images fade out, as a fraction of an edge, so that it is not visible.
pub(super) const PHOTO_RIM: f32 = 0.02;

/// Down-weighting of an image per squared difference of its colour (of 0 to 1) from the mean of all: to half at a
/// difference of 16 of 255 in each channel, which is more than image noise and less than another object.
// Redwood's frames on a plain depth buffer: 36.66 → 36.72 dB with 16; 36.68 with 6, 36.71 with 10 and with 25.
pub(super) const PHOTO_PER_DISAGREEMENT2: f32 = 84.67;

/// Squared angle, relative to σ², within which an image is as good as one from the eye's position: a twentieth of σ.
/// Pixels are no finer, and it keeps quotients finite.
pub(super) const PHOTO_SAME_ANGLE2: f32 = 0.0025;

/// Number of times the mean of the images is recomputed, once it is known which of them disagree with it.
pub(super) const PHOTO_AGREEMENT_ROUNDS: u32 = 2;

/// Sentinel that replaces the cosine of an image that does not see a point: below all cosines.
pub(super) const PHOTO_NOT_LOOKING: f32 = -2.0;

/// Opacity factor for surfaces coloured from images: edges of disks are not softer than these.
pub(super) const PHOTO_OPACITY: f32 = 3.0;

/// Weight of an image near a depth discontinuity: slightly to the side, it shows something else.
pub(super) const PHOTO_TRUST_NEAR_STEPS: f32 = 0.02;

/// Weight factor of the viewing angle near a depth discontinuity: an image counts in full if it looks in the direction
/// of the eye; 1 over the square of the angle at which it does not, 3°.
pub(super) const PHOTO_PER_STEP_ANGLE2: f32 = 364.8;

/// Minimum cosine for the pixel footprint: on a surface seen at a more grazing angle, the footprint is that at this
/// cosine.
pub(super) const PHOTO_MIN_COSINE: f32 = 0.1;

/// Minimum facing cosine of depth-map normals: there are none where the surface is seen at a smaller cosine than at 80°
/// (Yang et al. 2006 §4.1).
pub(super) const PHOTO_MIN_FACING: f32 = 0.173_648_18;

/// Light of a surface that is seen edge-on.
pub(super) const HEADLIGHT_AMBIENT: f32 = 0.25;
/// White that is added where a surface faces the eye.
pub(super) const HEADLIGHT_SPECULAR: f32 = 0.15;
/// Exponent of that white. Renderers multiply, since it is worked out for every fragment of every layer: the cube of
/// the eighth power.
pub(super) const HEADLIGHT_SHININESS: u32 = 24;
/// Factor on the colour of a surfel seen from behind, where back sides are to be distinguished.
pub(super) const BACK_SIDE: f32 = 0.8;

/// Normals with more of the y axis are taken for parallel to it: another axis gives the directions of a surfel's
/// square.
pub(super) const UPRIGHT_NORMAL_Y: f32 = 0.99;

/// Margin of a sprite's square beyond its disk, for rasterisers that round corners; and the factor by which it is
/// nearer, for rounding.
pub(super) const SPRITE_MARGIN_PX: f32 = 0.1;
pub(super) const SPRITE_NEARER: f32 = 1.000_001;

/// Volumes that patches span with the eye, in cubes of their distances, are not taken for less: they are seen edge on.
pub(super) const FACET_MIN_SIZE: f32 = 1e-30;

/// Distance of the corners of a surfel's square from its centre, in radii: √2, rounded up.
pub(super) const SQUARE_REACH_RADII: f32 = 1.4143;
/// Distance of the corners of a cube from its centre, in half edges: √3, rounded up.
pub(super) const CUBE_REACH_HALF_EDGES: f32 = 1.7321;

/// Greys of the nearest and the farthest depth in the image of the visibility pass.
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

/// Luma of display-referred colours (ITU-R BT.601), by which FXAA finds edges.
pub(super) const FXAA_RED: f32 = 0.299;
pub(super) const FXAA_GREEN: f32 = 0.587;
pub(super) const FXAA_BLUE: f32 = 0.114;
/// Contrast below which there is no edge: absolute, and relative to the lightest pixel (both as Lottes 2009 advises for
/// high quality).
pub(super) const FXAA_MIN_CONTRAST: f32 = 1.0 / 16.0;
pub(super) const FXAA_MIN_SHARE: f32 = 1.0 / 8.0;
/// Share of the contrast by which the mean of both sides changes where an edge ends.
pub(super) const FXAA_END_OF_EDGE: f32 = 0.25;
/// Difference of a pixel from its surroundings, as a fraction of the contrast, from which it is a detail; and the
/// maximum fraction of the surroundings that is blended in.
pub(super) const FXAA_DETAIL: f32 = 0.25;
pub(super) const FXAA_MAX_BLENDED: f32 = 0.75;

/// Depth bias of the visibility pass that blends the splats of `style`, in splat radii.
pub(super) fn depth_slack_radii(style: &DrawSettings) -> f32 {
    if style.draws_surfels() {
        style.surfels.depth_offset
    } else {
        DEPTH_SLACK_RADII
    }
}
