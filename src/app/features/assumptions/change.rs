//! Alternatives to assumptions.

use crate::cloud::{ColorDepth, NoData};
use crate::io::ColumnMap;
use crate::rgbd::Filters;
use crate::scene::{Choice, Primitive, UpAxis};
use crate::sequence::{ColorSource, OpenOptions};
use std::path::PathBuf;
use std::sync::Arc;

/// An alternative to an assumption; `None` is the automatic choice.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::app) enum Change {
    /// Another up axis.
    Up(Option<UpAxis>),
    /// Another primitive; `Auto` is the automatic choice.
    Primitive(Choice<Primitive>),
    /// Other colours; `Auto` is the automatic choice.
    Colors(ColorSource),
    /// Other options of reading: the inputs are opened again.
    Read(ReadChange),
}

/// A change of the options by which inputs are read; `None` is the automatic choice.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::app) enum ReadChange {
    /// Columns of text and of files without a header.
    Columns(Option<ColumnMap>),
    /// Depth values per metre.
    DepthScale(Option<f64>),
    /// `fx,fy,cx,cy` or a file.
    Intrinsics(Option<String>),
    /// A file with the poses of the camera, or none of them; the automatic choice is not to rotate frames by them
    /// either.
    Poses(Option<PathBuf>),
    /// Poses lead from the world to the camera.
    InvertPoses,
    /// Values of a missing point; [`NoData::Auto`] is the automatic choice.
    NoData(NoData),
    /// The least range of colours.
    ColorDepth(Option<ColorDepth>),
    /// A pattern of the names of files that are frames.
    Only(Option<Arc<str>>),
    /// Edge of the cells in which points of merged frames are joined, metres.
    MergeCells(Option<f64>),
    /// Frames per second.
    Fps(Option<f64>),
    /// Filters of depth images; [`Filters::USUAL`] is the automatic choice.
    Filters(Filters),
}

impl ReadChange {
    /// Changes `open`.
    pub(in crate::app) fn apply(&self, open: &mut OpenOptions) {
        match self.clone() {
            Self::Columns(columns) => open.read = open.read.with_columns(columns),
            Self::DepthScale(scale) => open.rgbd.depth_scale = scale,
            Self::Intrinsics(text) => open.rgbd.intrinsics = text,
            Self::Poses(file) => {
                open.rgbd.invert_poses &= file.is_some();
                open.rgbd.poses = file;
            }
            Self::InvertPoses => open.rgbd.invert_poses = true,
            Self::NoData(rule) => open.no_data = rule,
            Self::ColorDepth(depth) => open.color_depth = depth,
            Self::Only(pattern) => open.only = pattern,
            Self::MergeCells(edge_m) => open.rgbd.merge_edge_m = edge_m,
            Self::Fps(fps) => open.fps = fps,
            Self::Filters(filters) => {
                open.rgbd.filters = filters;
                open.rgbd.filters_are_automatic = filters == Filters::USUAL;
            }
        }
    }

    /// True if it changes nothing of `open`.
    pub(in crate::app) fn is_in(&self, open: &OpenOptions) -> bool {
        let mut changed = open.clone();
        self.apply(&mut changed);
        changed == *open
    }

    /// True if points may be elsewhere afterwards: a view or a clip that was made before does not fit.
    pub(in crate::app) fn moves_points(&self) -> bool {
        match self {
            Self::Columns(_)
            | Self::DepthScale(_)
            | Self::Intrinsics(_)
            | Self::Poses(_)
            | Self::InvertPoses
            | Self::NoData(_)
            | Self::Only(_) => true,
            Self::ColorDepth(_) | Self::MergeCells(_) | Self::Fps(_) | Self::Filters(_) => false,
        }
    }
}

/// A field for any other value.
#[derive(Debug, Clone, Copy)]
pub(in crate::app) struct Field {
    /// Shown in the empty field.
    pub(in crate::app) hint: &'static str,
    /// Parses a change; `Err` says what was expected.
    pub(in crate::app) parse: fn(&str) -> Result<ReadChange, String>,
}
