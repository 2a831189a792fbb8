//! Options for opening depth image recordings.

use crate::rgbd::Filters;
use std::path::PathBuf;

/// The option that turns poses round.
pub(in crate::source) const INVERT_POSES: &str = "--invert-poses";

/// User-supplied options of a depth image recording; everything unspecified is found in its folder.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RgbdOptions {
    /// Filters of the depth images.
    pub filters: Filters,
    /// They are the defaults: one that would drop most of an image is not applied.
    pub filters_are_automatic: bool,
    /// Pattern of the names of depth images, within the folder that is opened.
    pub depth: Option<String>,
    /// Pattern of the names of colour images.
    pub color: Option<String>,
    /// `fx,fy,cx,cy` in pixels, or a file that contains them.
    pub intrinsics: Option<String>,
    /// Units of the depth images that are a metre.
    pub depth_scale: Option<f64>,
    /// A file with the poses of the camera.
    pub poses: Option<PathBuf>,
    /// Poses lead from the world to the camera, and not from the camera to the world.
    pub invert_poses: bool,
    /// Frames, both ends included, that become one cloud by their poses.
    pub merge: Option<(usize, usize)>,
    /// Voxel size for merging their points, metres; 0 keeps all points. By default, points are merged if there are very
    /// many.
    pub merge_edge_m: Option<f64>,
    /// Frames among these whose points are excluded.
    pub skipped: Vec<usize>,
}
