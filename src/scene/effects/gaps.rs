//! Gap filling in a surface of splats, where the input images show that something is there.
//!
//! **How it works.** Surfaces of points have gaps of a few pixels: where input images disagree about a depth, where a
//! disk ends a little before the next one begins. A pixel that the surface does not cover whole is in a gap if all four
//! lines through it (its row, its column, both diagonals) meet the surface on both sides, no more than [`gap_px`] steps
//! apart (closings by lines: Serra 1982). So outlines stay as they are, except for holes of that size, and a gap is
//! closed as a whole. Beyond the borders of an image nothing is known, and nothing speaks against a gap there. A slit,
//! as between a curtain and the wall behind it, is open along itself: of half the width it is closed if the three other
//! lines meet the surface. (One line alone would round corners of outlines, and borders would be slits.)
//!
//! The surface in the gap is taken to be flat: along the shortest of the four lines through the pixel, the reversed
//! depth of a plane goes from one end to the other in even steps. If the ends belong to two things, one behind the
//! other, it is the farther one's: the view between them passes the nearer one. The input images are sampled at that
//! position, as at others (`scene/photos/mod.rs`). Gaps that they see through, and surfaces that none of them sees,
//! stay open: a handle is still a handle. But along outlines, where input images and points are a pixel apart, specks
//! remain. Each pixel of one has the mean colour of the closed pixels around it along the four lines, if the ends of
//! none are farther apart than a tenth of the width of gaps.
//!
//! Done after lighting, over the whole image: `render/cpu/photos/gaps.rs`,
//! `shaders/passes/resolve_photos.wgsl`.

use crate::scene::{PhotoRelight, ScenePacket};

/// Returns the maximum width of gaps that are closed: steps of a column or a row or both from one side to the other; 0
/// where gaps stay open.
pub fn gap_px(packet: &ScenePacket) -> u32 {
    let style = &packet.style;
    // Gaps are closed after lighting: with relighting, only their surroundings would be lit.
    let is_relit = style.photos.relight != PhotoRelight::Off;
    let has_surface = style.is_shaded_with_distances() && packet.lighting().is_deferred();
    let shown = packet.posed_images.as_ref();
    let are_there = shown.is_some_and(|shown| !shown.posed_images.all().is_empty());
    if !are_there || !has_surface || is_relit {
        return 0;
    }
    (0.01 * style.photos.gaps * packet.whole_height_px()).round() as u32
}

/// Returns the width of specks where gaps of `gap_px` are closed.
pub(crate) fn speck_px(gap_px: u32) -> u32 {
    (gap_px as f32 / GAPS_PER_SPECK) as u32
}

/// The steps from a pixel along four lines.
pub(crate) const PIXEL_LINES: [[i32; 2]; 4] = [[1, 0], [0, 1], [1, 1], [1, -1]];

/// Ends of a line are of one surface, here and at splat edges, if the reversed depth of one is at least this share of
/// the other's.
pub(crate) const GAP_ONE_SURFACE: f32 = 0.95;

/// Ratio of the width of gaps to the width of slits that are closed.
pub(crate) const GAPS_PER_SLIT: f32 = 2.0;

/// Ratio of the width of gaps that are closed to the width of specks.
// A speck is as wide as the pixels that a texel of a depth image covers, a tenth of a gap. Filling specks removed all
// 122 dots along the outlines of one of Redwood's images; its PSNR changed by 0.05 dB at most.
pub(crate) const GAPS_PER_SPECK: f32 = 10.0;

/// Opacity from which a pixel belongs to the surface around a gap.
pub(crate) const GAP_SOLID: f32 = 0.5;
