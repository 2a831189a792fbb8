//! Drawable content: the records of an image, and the passes over them.

use super::amplification::Amplification;
use crate::levels::Selection;
use crate::render::gpu::coded::CodeInView;
use crate::render::gpu::passes::{GeometryPass, ScreenPass};
use crate::render::gpu::residency::RecordSource;
use crate::render::gpu::targets::Target;
use crate::scene::VisiblePoints;
use std::sync::Arc;

/// Passes over records, in the order in which they are drawn.
pub(super) type Passes = &'static [&'static GeometryPass];

/// A packet's records, and the passes over them.
#[derive(Debug)]
pub(in crate::render::gpu) struct Drawable<'a> {
    pub(in crate::render::gpu) amplification: &'static Amplification,
    /// In the order of their bind groups; none if the frame lacks data that the primitive needs.
    pub(in crate::render::gpu) streams: Vec<RecordSource<'a>>,
    /// Selection of the nodes to draw, if the streams hold all nodes of a structure.
    pub(in crate::render::gpu) selection: Option<&'a Arc<Selection>>,
    /// Visible points and their shapes, to be determined if the stream holds all points.
    pub(in crate::render::gpu) visible: Option<&'a Arc<VisiblePoints>>,
    /// Byte code whose nodes are to be decoded, if the stream is one.
    pub(in crate::render::gpu) code: Option<CodeInView<'a>>,
    /// The amplification that limits the chunks of these streams.
    pub(in crate::render::gpu) chunked_for: &'static Amplification,
    pub(in crate::render::gpu) cull_back_faces: bool,
    pub(in crate::render::gpu) passes: Passes,
    /// Shadow map pass over the same streams; `None` for unlit content.
    pub(in crate::render::gpu) depth_pass: Option<(&'static Amplification, &'static GeometryPass)>,
    /// Resolve pass that composites their result over the background, if they do not draw into the image.
    pub(in crate::render::gpu) resolve: Option<&'static ScreenPass>,
}

impl<'a> Drawable<'a> {
    /// Restricts the drawable to some nodes, with the records of all as its streams, followed by the streams that these
    /// are tested against.
    pub(super) fn selecting(self, selection: &'a Arc<Selection>) -> Self {
        let of_test = match &**selection {
            Selection::Filtered(filter) => {
                vec![RecordSource::of(filter.bounds()), RecordSource::of(filter.parents())]
            }
            Selection::At(_) | Selection::Every { .. } => Vec::new(),
        };
        let streams = self.streams.into_iter().chain(of_test);
        Self {
            streams: streams.map(RecordSource::into_nodes).collect(),
            selection: Some(selection),
            ..self
        }
    }

    /// Restricts the drawable to visible points, with all points as its stream, or those that images are converted to.
    pub(super) fn of_visible(self, visible: &'a Arc<VisiblePoints>) -> Self {
        let points = match &visible.images {
            Some(images) => RecordSource::of_images(images),
            None => RecordSource::of(&visible.points).into_nodes(),
        };
        Self {
            streams: vec![points],
            visible: Some(visible),
            ..self
        }
    }

    /// Draws the nodes of a byte code, which is its stream.
    pub(super) fn of_code(self, code: CodeInView<'a>) -> Self {
        Self {
            streams: vec![RecordSource::of_code(&code.cells.cloud)],
            code: Some(code),
            ..self
        }
    }

    /// Returns true if one of its passes draws into this target.
    pub(in crate::render::gpu) fn draws_into(&self, target: Target) -> bool {
        let mut targets = self.passes.iter().filter_map(|pass| pass.color);
        targets.any(|color| color.target == target)
    }
}
