//! Options of recordings of depth images.

use super::values::{FrameRange, not_negative_f64, positive_f64};
use crate::rgbd::Filters;
use crate::source::RgbdOptions;
use clap::Args;
use std::path::PathBuf;

/// Depth image options; those not given are detected from the folder of the recording.
#[derive(Debug, Clone, Default, Args)]
#[command(next_help_heading = "Depth images (RGB-D)")]
pub(super) struct RgbdArgs {
    /// Names of the depth images in the folder INPUT, such as 'depth/*.png' [default: detected]
    #[arg(long, hide_short_help = true, value_name = "PATTERN")]
    depth_images: Option<String>,

    /// Names of their colour images [default: detected]
    #[arg(long, hide_short_help = true, value_name = "PATTERN", requires = "depth_images")]
    color_images: Option<String>,

    /// Camera intrinsics in pixels, or a file: matrix, Open3D JSON, PCL XML [default: detected]
    #[arg(long, hide_short_help = true, value_name = "FILE|fx,fy,cx,cy")]
    intrinsics: Option<String>,

    /// Depth units per metre, such as 1000 or 5000 [default: detected]
    #[arg(long, hide_short_help = true, value_name = "N", value_parser = positive_f64)]
    depth_scale: Option<f64>,

    /// Camera poses, sensor to world (TUM, KITTI, Redwood, Open3D, matrices); none ignores those found [default:
    /// detected]
    #[arg(long, hide_short_help = true, value_name = "FILE|none")]
    poses: Option<PathBuf>,

    /// Invert the poses: they are extrinsics, world to sensor
    #[arg(long, hide_short_help = true)]
    invert_poses: bool,

    /// Merge frames A to B (inclusive, counted from 0) into one cloud by their poses
    #[arg(long, hide_short_help = true, value_name = "A..B")]
    merge_frames: Option<FrameRange>,

    /// Voxel size for merging, in metres; 0 keeps all points [default: auto above 8 M points]
    #[arg(
        long,
        hide_short_help = true,
        value_name = "METRES",
        value_parser = not_negative_f64,
        requires = "merge_frames",
    )]
    merge_cells: Option<f64>,

    /// Depth filters: near, median, bilateral, flying, temporal (comma-separated) or none, with parameters such as
    /// near:from=0.3:to=4 [default: the first four for images, none for info, check and convert]
    #[arg(long, hide_short_help = true, value_name = "NAMES")]
    rgbd_filters: Option<Filters>,
}

impl RgbdArgs {
    /// Returns the given options as they were typed.
    pub(in crate::cli) fn in_words(&self) -> Vec<String> {
        let text = |text: &Option<String>| text.clone();
        let path = |path: &PathBuf| path.display().to_string();
        let range = |range: &FrameRange| format!("{}..{}", range.first, range.last);
        let given = [
            ("depth-images", text(&self.depth_images)),
            ("color-images", text(&self.color_images)),
            ("intrinsics", text(&self.intrinsics)),
            ("depth-scale", self.depth_scale.map(|scale| scale.to_string())),
            ("poses", self.poses.as_ref().map(path)),
            ("merge-frames", self.merge_frames.as_ref().map(range)),
            ("merge-cells", self.merge_cells.map(|edge| edge.to_string())),
            ("rgbd-filters", self.rgbd_filters.map(|filters| filters.to_string())),
        ];
        let given = given.into_iter();
        let inverted = self.invert_poses.then(|| "--invert-poses".to_owned());
        given
            .filter_map(|(option, value)| Some(format!("--{option} {}", value?)))
            .chain(inverted)
            .collect()
    }

    /// Returns the given options; `usual` are the filters where none were given.
    pub(in crate::cli) fn options(&self, usual: Filters) -> RgbdOptions {
        RgbdOptions {
            filters: self.rgbd_filters.unwrap_or(usual),
            filters_are_automatic: self.rgbd_filters.is_none(),
            depth: self.depth_images.clone(),
            color: self.color_images.clone(),
            intrinsics: self.intrinsics.clone(),
            depth_scale: self.depth_scale,
            poses: self.poses.clone(),
            invert_poses: self.invert_poses,
            merge: self.merge_frames.map(|range| (range.first, range.last)),
            merge_edge_m: self.merge_cells,
            skipped: Vec::new(),
        }
    }
}
