//! Constants of the screen-space surfel estimation, shared by the CPU and the GPU (`shaders/screen_normals`).

/// The radius in which neighbours are looked for, in spacings of the points: about 28 are within it.
pub const RADIUS_SPACINGS: f32 = 3.0;

/// Maximum reach of the square of a point from its pixel: it is seven pixels wide.
pub(crate) const MAX_REACH_PX: usize = 3;

/// Border width: the maximum distance from its pixel at which anything is searched.
pub(crate) const BORDER_PX: usize = 7;

/// Minimum number of nearer pixels to fit a plane that separates a surface from its occluder.
pub(crate) const MIN_OF_RAMP: f32 = 4.0;

/// The coarsest level: its cells are 128 pixels wide.
pub(crate) const MAX_LEVELS: u32 = 7;

/// Cells of a row that are read at once, which is how wide a window is.
pub(crate) const CELLS_OF_WINDOW: usize = 8;

/// Factor by which the reach of a wide window is larger.
pub(crate) const WIDE_WINDOW: usize = 2;

/// Maximum reach of a window from its centre, in cells: then it is no more than eight cells wide.
pub(crate) const MAX_REACH_CELLS: f32 = 3.5;

/// Minimum radius of neighbourhoods, in pixels.
pub(crate) const MIN_RADIUS_PX: f32 = 2.0;

/// Cells before the first one of a row, and rows before the first.
pub(crate) const CELLS_BEFORE: usize = 8;

/// A neighbourhood with fewer is searched again with twice the radius.
pub(crate) const MIN_NEIGHBOURS: f32 = 6.0;

/// Three points are a plane.
pub(crate) const MIN_OF_PLANE: f32 = 3.0;

/// Radii are doubled so often at most.
pub(crate) const MAX_DOUBLINGS: usize = 3;

/// So often where the normal of a neighbour is looked for: as far as rows of a floor are apart.
pub(crate) const MAX_DOUBLINGS_OF_LENDING: usize = 5;

/// The variance of a plane in its second direction is more than this share of that in the first: else it is a line and
/// its noise.
pub(crate) const MIN_SPREAD: f64 = 2e-3;

/// Half the height of splats that close rows of pixels, whose points are anywhere in them.
pub(crate) const CLOSING_ROWS_PX: f32 = 0.75;
