//! Options of recordings of depth images.

use super::values::{FrameRange, not_negative_f64, positive_f64};
use crate::rgbd::Filters;
use crate::source::RgbdOptions;
use clap::Args;
use std::path::PathBuf;

/// What nobody says is found in the folder of the recording.
#[derive(Debug, Clone, Default, Args)]
#[command(next_help_heading = "Depth images (RGB-D)")]
pub(super) struct RgbdArgs {
    /// Names of depth images in the folder INPUT, such as 'depth/*.png'
    #[arg(long, value_name = "PATTERN")]
    depth_images: Option<String>,

    /// Pattern of the names of their colour images
    #[arg(long, value_name = "PATTERN", requires = "depth_images")]
    color_images: Option<String>,

    /// fx,fy,cx,cy (pixels) or a file: a matrix, JSON of Open3D, XML of PCL
    #[arg(long, value_name = "FILE|fx,fy,cx,cy")]
    intrinsics: Option<String>,

    /// Units of the depth images that are a metre, such as 1000 or 5000
    #[arg(long, value_name = "N", value_parser = positive_f64)]
    depth_scale: Option<f64>,

    /// Poses, sensor to world (TUM, KITTI, Redwood, Open3D, matrices); none: ignore those found
    #[arg(long, value_name = "FILE|none")]
    poses: Option<PathBuf>,

    /// Poses lead from the world to the sensor, as extrinsics do
    #[arg(long)]
    invert_poses: bool,

    /// Frames A to B, both included, counted from 0, as one cloud, by their poses
    #[arg(long, value_name = "A..B")]
    merge_frames: Option<FrameRange>,

    /// Edge of cells in which points of merged frames are joined; 0: all stay (else up to 8 million)
    #[arg(long, value_name = "METRES", value_parser = not_negative_f64, requires = "merge_frames")]
    merge_cells: Option<f64>,

    /// near,median,bilateral,flying,temporal or none (pictures: the first 4), with numbers: near:from=0.3:to=4
    #[arg(long, value_name = "NAMES")]
    rgbd_filters: Option<Filters>,
}

impl RgbdArgs {
    /// What was given, as it was typed.
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

    /// What was given; `usual` are the filters where none were.
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
            left_out: Vec::new(),
        }
    }
}
