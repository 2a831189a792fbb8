//! Constants of Rust as WGSL, which shaders import, so that none is written twice. Constants of one part of an image
//! are with that part.

use super::gpu_data::{
    BACK_FACES_CULLED, BACK_FACES_DARKER, KERNEL_BOX, KERNEL_HAT, LIGHTING_PER_FRAGMENT, LIGHTING_PER_SURFEL,
    LIGHTING_PER_VERTEX,
};
use super::photos::{
    ANSWER_CLIPPED, ANSWER_SHOWN, ANSWER_UNSEEN, PHOTO_CLIPS_BY_ANY, PHOTO_CLIPS_BY_VOTE, PHOTO_IS_WHITE,
    PHOTO_LEAVES_HOLES, PHOTO_RELIGHTS,
};
use crate::analysis::screen::constants as screen;
use crate::cloud::{ELLIPSE_STEPS, VertexRecord};
use crate::render::constants::{
    BACK_SIDE, CUBE_REACH_HALF_EDGES, EWA_MEAN_WEIGHT, EWA_MIN_DETERMINANT, FACET_MIN_SIZE, HEADLIGHT_AMBIENT,
    HEADLIGHT_SHININESS, HEADLIGHT_SPECULAR, MASK_FALLOFF, OPAQUE_WEIGHT, PHOTO_AGREEMENT_ROUNDS, PHOTO_MAX_TAPS,
    PHOTO_MIN_COSINE, PHOTO_MIN_FACING, PHOTO_NOT_LOOKING, PHOTO_OPACITY, PHOTO_PER_DISAGREEMENT2,
    PHOTO_PER_STEP_ANGLE2, PHOTO_RIM, PHOTO_SAME_ANGLE2, PHOTO_TRUST_NEAR_STEPS, SPRITE_MARGIN_PX, SPRITE_NEARER,
    SQUARE_REACH_RADII, UPRIGHT_NORMAL_Y,
};
use crate::rgbd::filter_constants as filter;
use crate::scene::{
    DIELECTRIC, GAP_ONE_SURFACE, GAP_SOLID, GAPS_PER_SLIT, GAPS_PER_SPECK, PIXEL_LINES, PhotoStyle, PhotoViews,
    RIM_OPAQUE, RIM_OPEN, SplatFilter,
};
use crate::stereo::matching::constants as stereo;
use std::fmt::Debug;

/// Bind groups: the view is bound in every pass.
pub(super) const VIEW_GROUP: u32 = 0;
/// Bind group of a screen-space pass: the textures that it reads, and its uniforms.
pub(super) const SOURCE_GROUP: u32 = 1;
/// Bind group of a pass over records: points or voxels, or the corners that the strategy `compute` has made of them.
pub(super) const STREAM_GROUP: u32 = 1;
/// Bind group of a pass over records: the stream of shapes.
pub(super) const SHAPE_GROUP: u32 = STREAM_GROUP + 1;
/// Bind group of the output of the compute stage.
pub(super) const OUTPUT_GROUP: u32 = SHAPE_GROUP + 1;

/// Edge of the pixels of a workgroup, and how many it holds with those around them that the widest window reads.
pub(super) const DEPTH_TILE_PX: u32 = 16;
const DEPTH_TILE_VALUES: u32 = {
    let edge = DEPTH_TILE_PX + 2 * filter::BILATERAL_REACH as u32;
    edge * edge
};

/// Edge of the pixels of a workgroup.
pub(super) const STEREO_TILE_PX: u32 = 8;

/// Invocations that share the labels of a pixel, two in each word.
pub(super) const STEREO_LANES: u32 = 32;

/// Most labels of a pixel: costs of a path at two pixels are in the memory of a workgroup.
pub(super) const STEREO_MAX_LABELS: u32 = 512;

/// Pixels over which sums of columns and squares run on.
pub(super) const STEREO_STRIP_PX: u32 = 16;

/// Sentinel value for a missing label: less than any label.
pub(super) const NO_LABEL: f32 = -1e30;

/// Slopes from which on a ray is none.
pub(super) const NO_RAY: f32 = 1e9;

/// The radius of records that turn out not to be drawn only once they are written.
const RADIUS_OF_NOTHING: f32 = -1.0;

/// Result of the selection test on a node of a sequence; open is one that single-precision floats leave undecided.
const NODE_CLASS_DROPPED: u32 = 0;
const NODE_CLASS_SMALL: u32 = 1;
const NODE_CLASS_DIVIDED: u32 = 2;
const NODE_CLASS_OPEN: u32 = 3;

/// Records that the strategy `compute` hands to a workgroup.
pub(super) const GROUP_RECORDS: u32 = 256;

/// Records that the strategy `uniform` draws at once: 64 KiB, the largest uniform binding that every adapter has.
pub(super) const BATCH_RECORDS: u32 = 4096;

/// Corners of the triangle around a splat.
pub(super) const VERTICES_PER_TRIANGLE: u32 = 3;

/// Corners of a quad, and indices of its two triangles.
pub(super) const VERTICES_PER_QUAD: u32 = 4;
pub(super) const INDICES_PER_QUAD: u32 = 6;

/// Splats that are seen at a smaller one are filtered as at this one.
const MIN_COSINE: f32 = SplatFilter::MIN_COSINE;
/// The two numbers of a normal that is none, as WGSL reads them.
const NO_NORMAL: u32 = {
    let [x, y] = VertexRecord::NO_NORMAL;
    (y as u16 as u32) << 16 | x as u16 as u32
};

/// The texture of a vertex without one.
const NO_TEXTURE: u32 = VertexRecord::NO_TEXTURE;

/// Maximum number of input images that are sampled at a position, and blended there.
const PHOTO_MAX_ASKED: u32 = PhotoViews::MAX_ASKED as u32;
const PHOTO_MAX_BLENDED: u32 = PhotoStyle::MAX_VIEWS as u32;

/// Constants of Rust as WGSL declares them, by the same names.
macro_rules! declared {
    ($($name:ident),+ $(,)?) => {
        [$($crate::render::gpu::constants::declaration(stringify!($name), $name)),+].join("\n")
    };
}

pub(in crate::render) use declared;

/// The declarations that all shaders share.
pub(super) fn shared() -> String {
    let declared = declared![
        ANSWER_CLIPPED,
        ANSWER_SHOWN,
        ANSWER_UNSEEN,
        BACK_FACES_CULLED,
        BACK_FACES_DARKER,
        BACK_SIDE,
        BATCH_RECORDS,
        CUBE_REACH_HALF_EDGES,
        DIELECTRIC,
        ELLIPSE_STEPS,
        EWA_MIN_DETERMINANT,
        EWA_MEAN_WEIGHT,
        FACET_MIN_SIZE,
        GAP_ONE_SURFACE,
        GAP_SOLID,
        GAPS_PER_SLIT,
        GAPS_PER_SPECK,
        GROUP_RECORDS,
        HEADLIGHT_AMBIENT,
        HEADLIGHT_SHININESS,
        HEADLIGHT_SPECULAR,
        KERNEL_BOX,
        KERNEL_HAT,
        MIN_COSINE,
        LIGHTING_PER_FRAGMENT,
        LIGHTING_PER_SURFEL,
        LIGHTING_PER_VERTEX,
        MASK_FALLOFF,
        NO_NORMAL,
        NO_TEXTURE,
        OPAQUE_WEIGHT,
        OUTPUT_GROUP,
        PHOTO_AGREEMENT_ROUNDS,
        PHOTO_CLIPS_BY_ANY,
        PHOTO_CLIPS_BY_VOTE,
        PHOTO_IS_WHITE,
        PHOTO_MIN_COSINE,
        PHOTO_MIN_FACING,
        PHOTO_LEAVES_HOLES,
        PHOTO_MAX_ASKED,
        PHOTO_MAX_BLENDED,
        PHOTO_MAX_TAPS,
        PHOTO_NOT_LOOKING,
        PHOTO_OPACITY,
        PHOTO_PER_DISAGREEMENT2,
        PHOTO_PER_STEP_ANGLE2,
        PHOTO_RELIGHTS,
        PHOTO_RIM,
        PHOTO_SAME_ANGLE2,
        PHOTO_TRUST_NEAR_STEPS,
        RADIUS_OF_NOTHING,
        RIM_OPAQUE,
        RIM_OPEN,
        SHAPE_GROUP,
        SOURCE_GROUP,
        SPRITE_MARGIN_PX,
        SPRITE_NEARER,
        SQUARE_REACH_RADII,
        STREAM_GROUP,
        UPRIGHT_NORMAL_Y,
        NODE_CLASS_DIVIDED,
        NODE_CLASS_DROPPED,
        NODE_CLASS_OPEN,
        NODE_CLASS_SMALL,
        VERTICES_PER_QUAD,
        VERTICES_PER_TRIANGLE,
        VIEW_GROUP,
    ];
    [pixel_lines(), declared].join("\n")
}

/// Returns the WGSL constants of the screen-space surfel passes.
pub(super) fn of_screen_normals() -> String {
    /// The place of a point that is hidden.
    const NOT_VISIBLE: u32 = u32::MAX;
    /// Sentinel for a pixel without depth in a depth map.
    const NO_DEPTH: f32 = f32::MAX;
    /// Lower bound of divisors that could be zero: a normal number, which no adapter flushes to zero.
    const MIN_POSITIVE: f32 = 1e-30;
    [
        declaration("BORDER_PX", screen::BORDER_PX as u32),
        declaration("CELLS_BEFORE", screen::CELLS_BEFORE as u32),
        declaration("CELLS_OF_WINDOW", screen::CELLS_OF_WINDOW as u32),
        declaration("CLOSING_ROWS_PX", screen::CLOSING_ROWS_PX),
        declaration("MIN_NEIGHBOURS", screen::MIN_NEIGHBOURS),
        declaration("MIN_OF_PLANE", screen::MIN_OF_PLANE),
        declaration("MIN_OF_RAMP", screen::MIN_OF_RAMP),
        declaration("MIN_POSITIVE", MIN_POSITIVE),
        declaration("MIN_RADIUS_PX", screen::MIN_RADIUS_PX),
        declaration("MIN_SPREAD", screen::MIN_SPREAD as f32),
        declaration("MAX_DOUBLINGS", screen::MAX_DOUBLINGS as u32),
        declaration("MAX_DOUBLINGS_OF_LENDING", screen::MAX_DOUBLINGS_OF_LENDING as u32),
        declaration("MAX_LEVELS", screen::MAX_LEVELS),
        declaration("MAX_REACH_CELLS", screen::MAX_REACH_CELLS),
        declaration("MAX_REACH_PX", screen::MAX_REACH_PX as u32),
        declaration("NOT_VISIBLE", NOT_VISIBLE),
        declaration("NO_DEPTH", NO_DEPTH),
        declaration("PI", std::f32::consts::PI),
        declaration("RADIUS_SPACINGS", screen::RADIUS_SPACINGS),
        declaration("WIDE_WINDOW", screen::WIDE_WINDOW as u32),
    ]
    .join("\n")
}

/// Returns the WGSL constants of the passes that filter depth images and convert them to points.
pub(super) fn of_depth_images() -> String {
    /// More than any depth.
    const NO_DEPTH: f32 = f32::MAX;
    /// Points farther away are discarded: products with a ray stay finite.
    const FARTHEST_POINT_M: f32 = 1e28;
    [
        declaration("BILATERAL_REACH", filter::BILATERAL_REACH as u32),
        declaration("DEPTH_TILE_PX", DEPTH_TILE_PX),
        declaration("DEPTH_TILE_VALUES", DEPTH_TILE_VALUES),
        declaration("FARTHEST_POINT_M", FARTHEST_POINT_M),
        declaration("MIN_EXPONENT", filter::MIN_EXPONENT),
        declaration("LOG2_E", std::f32::consts::LOG2_E),
        declaration("MEDIAN_REACH", filter::MEDIAN_REACH as u32),
        declaration("NO_DEPTH", NO_DEPTH),
        declaration("NO_RAY", NO_RAY),
        declaration("SENSOR_BEST_M", filter::SENSOR_BEST_M),
        declaration("SENSOR_NOISE_M", filter::SENSOR_NOISE_M),
        declaration("SENSOR_NOISE_PER_M", filter::SENSOR_NOISE_PER_M),
    ]
    .join("\n")
}

/// Returns the WGSL constants of the stereo matching passes.
pub(super) fn of_stereo() -> String {
    /// Uniqueness flag stored with the label of a winner.
    const IS_UNIQUE: u32 = 1 << 16;
    /// More than any cost.
    const STEREO_NEVER: u32 = u32::MAX;
    /// Costs of all labels and of one more to each side, twice.
    const STEREO_PATH_VALUES: u32 = 2 * (STEREO_MAX_LABELS + 2);
    [
        declaration("CENSUS_HALF_HEIGHT", stereo::CENSUS_HALF_HEIGHT as i32),
        declaration("CENSUS_HALF_WIDTH", stereo::CENSUS_HALF_WIDTH as i32),
        declaration("EVEN_WINDOW", u32::from(stereo::EVEN_WINDOW)),
        declaration("IS_UNIQUE", IS_UNIQUE),
        declaration("NO_LABEL", NO_LABEL),
        declaration("PARABOLA_REACH", stereo::PARABOLA_REACH as i32),
        declaration("REFINE_REACH", stereo::REFINE_REACH as i32),
        declaration("STEREO_LANES", STEREO_LANES),
        declaration("STEREO_NEVER", STEREO_NEVER),
        declaration("STEREO_PATH_VALUES", STEREO_PATH_VALUES),
        declaration("STEREO_STRIP_PX", STEREO_STRIP_PX),
        declaration("STEREO_TILE_PX", STEREO_TILE_PX),
    ]
    .join("\n")
}

/// Returns the WGSL constants of the shaders of an amplification: its vertices, and the count per record in a draw
/// call.
pub(super) fn of_amplification(vertices_per_record: u32, drawn_per_record: u32) -> String {
    [
        declaration("VERTICES_PER_RECORD", vertices_per_record),
        declaration("DRAWN_PER_RECORD", drawn_per_record),
    ]
    .join("\n")
}

/// A number with a type of WGSL.
pub(in crate::render) trait Number: Debug + Copy {
    const TYPE: &'static str;
    const SUFFIX: &'static str;
}

impl Number for f32 {
    const TYPE: &'static str = "f32";
    const SUFFIX: &'static str = "f";
}

impl Number for i32 {
    const TYPE: &'static str = "i32";
    const SUFFIX: &'static str = "i";
}

impl Number for u32 {
    const TYPE: &'static str = "u32";
    const SUFFIX: &'static str = "u";
}

/// The lines through a pixel on which the ends of gaps and splat edges are.
fn pixel_lines() -> String {
    let lines = PIXEL_LINES.map(|[x, y]| format!("vec2i({x}, {y})"));
    format!("const PIXEL_LINES = array({});", lines.join(", "))
}

pub(in crate::render) fn declaration<T: Number>(name: &str, value: T) -> String {
    // Rust writes as many digits as are needed to distinguish a number from its neighbours.
    format!("const {name}: {} = {value:?}{};", T::TYPE, T::SUFFIX)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_formatted_as_valid_wgsl() {
        assert_eq!(declaration("A", 0.22f32), "const A: f32 = 0.22f;");
        assert_eq!(declaration("B", 1e-30f32), "const B: f32 = 1e-30f;");
        assert_eq!(declaration("C", 16.0f32), "const C: f32 = 16.0f;");
        assert_eq!(declaration("D", 256u32), "const D: u32 = 256u;");
    }
}
