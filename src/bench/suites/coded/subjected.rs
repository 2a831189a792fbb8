//! The frame that is measured, and the settings that it is drawn with.

use crate::bench::runner::Runner;
use crate::bench::subject::Subject;
use crate::levels::octree::{CodedCloud, Octree};
use crate::scene::{Footprint, Lighting, RendererChoice, ScenePacket, Style};
use crate::sequence::PreparedFrame;
use std::sync::Arc;

/// Drawn by the CPU, from the byte code.
pub(super) fn style() -> Style {
    Style::default().with(|style| {
        style.drawing.renderer = RendererChoice::Cpu;
        style.light.lighting = Lighting::PerSurfel;
        style.codes.footprint = Footprint::Masks;
    })
}

/// A frame whose byte code is measured.
pub(super) struct Subjected<'a> {
    pub(super) subject: &'a Subject<'a>,
    /// Name in the rows: of the frame if several are measured.
    pub(super) name: String,
    pub(super) frame: PreparedFrame,
    pub(super) octree: Arc<Octree>,
    pub(super) cloud: Arc<CodedCloud>,
}

/// Nodes of a byte code that were drawn in the last image; of other content all records, each of which may have been
/// drawn in several tiles.
pub(super) fn drawn_records(processor: &Runner, packet: &ScenePacket) -> f64 {
    if packet.content.coded().is_some() {
        processor.stats().drawn_instances as f64
    } else {
        packet.content.record_count() as f64
    }
}
