//! The streams that images are drawn from: those that are resident, and those that compute passes make of them.

use super::coded::{self, CodeExpander};
use super::context::Context;
use super::depth_images::DepthMaker;
use super::gather::{Gatherer, Selected};
use super::instancing::{self, Chunk, Indexed, RECORD_BYTES, RecordInstancing, Stream};
use super::plan::Plan;
use super::recording::Recording;
use super::residency::{Residency, StreamContents};
use super::visible::{VisibleMaker, Wanted};
use crate::render::RenderStats;

/// Resident streams, and the passes that make others of them.
#[derive(Debug)]
pub(super) struct Streams {
    pub(super) residency: Residency,
    gatherer: Gatherer,
    pub(super) visible: VisibleMaker,
    codes: CodeExpander,
    pub(super) depth_images: DepthMaker,
}

/// The layouts of uploaded records.
pub(super) struct UploadBy<'a> {
    pub(super) context: &'a Context,
    pub(super) instancing: &'a dyn RecordInstancing,
    pub(super) indexed: &'a mut Indexed,
}

impl Streams {
    /// No stream, and a budget for those that stay.
    pub(super) fn new(budget_bytes: u64) -> Self {
        Self {
            residency: Residency::new(budget_bytes),
            gatherer: Gatherer::new(),
            visible: VisibleMaker::default(),
            codes: CodeExpander::default(),
            depth_images: DepthMaker::default(),
        }
    }

    /// Drops everything on the GPU that is drawn, or made to be drawn.
    pub(super) fn clear(&mut self) {
        self.residency.clear();
        self.gatherer.clear();
        self.visible.clear();
        self.codes.clear();
    }

    /// Makes the nodes of byte codes again, for benchmarks.
    pub(super) fn invalidate(&mut self) {
        self.codes.invalidate();
    }

    /// Uploads the streams of a plan that are not resident, and allocates those that passes make.
    pub(super) fn upload(&mut self, by: UploadBy<'_>, plan: &Plan<'_>, stats: &mut RenderStats) {
        let UploadBy {
            context,
            instancing,
            indexed,
        } = by;
        let chunked_for = plan.drawable.chunked_for;
        for records in &plan.drawable.streams {
            let mut of_images = None;
            let depth_images = &mut self.depth_images;
            let resident_bytes = self.residency.ensure(records, |contents| match contents {
                StreamContents::Records(bytes) => instancing::upload(instancing, context, chunked_for, bytes),
                StreamContents::Nodes(bytes) => Gatherer::upload_nodes(context, bytes),
                StreamContents::Mesh(mesh) => indexed.upload(context, chunked_for, mesh),
                StreamContents::Images(images) => {
                    let made = of_images.insert(depth_images.make(context, images));
                    Stream {
                        byte_size: u64::from(made.count) * RECORD_BYTES as u64,
                        chunks: vec![Chunk::to_gather_from(made.count, made.buffer.clone())],
                    }
                }
                StreamContents::Code(cloud) => CodeExpander::upload(context, cloud),
            });
            // Images take fewer bytes than the points made from them.
            let uploaded_bytes = of_images.as_ref().map_or(resident_bytes, |made| made.uploaded_bytes);
            stats.passes += of_images.map_or(0, |made| made.passes);
            stats.uploads += u64::from(uploaded_bytes > 0);
            stats.uploaded_bytes += uploaded_bytes;
        }
        if let Some(selection) = plan.drawable.selection {
            let selected = Selected {
                selection,
                nodes: &plan.stream_keys(),
                chunked_for,
            };
            let uploaded_bytes = self.gatherer.ensure(context, instancing, selected);
            stats.uploads += u64::from(uploaded_bytes > 0);
            stats.uploaded_bytes += uploaded_bytes;
        }
        if let (Some(visible), Some(points)) = (plan.drawable.visible, plan.drawable.streams.first()) {
            let wanted = Wanted {
                visible,
                points: points.key(),
                chunked_for,
            };
            self.visible.ensure(context, instancing, wanted);
        }
        if let (Some(code), Some(stream)) = (plan.drawable.code, plan.drawable.streams.first()) {
            let wanted = coded::Wanted {
                code,
                stream: stream.key(),
                chunked_for,
            };
            self.codes.ensure(context, instancing, wanted);
        }
    }

    /// Records the passes that make the streams of a plan, where they are not there. Returns the number of passes.
    pub(super) fn record(&mut self, recording: &mut Recording<'_>, plan: &Plan<'_>) -> u64 {
        let mut passes = 0;
        if plan.drawable.selection.is_some() {
            passes += self.gatherer.record(recording, &self.residency);
        }
        if plan.drawable.visible.is_some() {
            passes += self.visible.record(recording, &self.residency);
        }
        if plan.drawable.code.is_some() {
            passes += self.codes.record(recording, &self.residency);
        }
        passes
    }

    /// Returns the streams that a plan draws, as far as they are there.
    pub(super) fn drawn(&self, plan: &Plan<'_>) -> Vec<&Stream> {
        if plan.drawable.selection.is_some() {
            return self.gatherer.streams();
        }
        if plan.drawable.visible.is_some() {
            return self.visible.streams();
        }
        if plan.drawable.code.is_some() {
            return self.codes.streams();
        }
        let keys = plan.stream_keys();
        keys.into_iter().filter_map(|key| self.residency.get(key)).collect()
    }
}
