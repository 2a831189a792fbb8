//! The programs that filter depth images and make points of them: entry points of one shader.

pub(super) use crate::render::gpu::compute::UNIFORM;

use super::network::middle_of_window;
use crate::render::gpu::compute::{ComputePrograms, ComputeShader, EntryRow};
use crate::render::gpu::constants::{self, DEPTH_GROUP, DEPTH_TILE_PX};
use crate::render::gpu::context::Context;
use crate::render::gpu::gpu_data::DepthImaging;
use crate::render::gpu::recording::Recording;

/// Bindings of `depth_images/image.wgsl`.
pub(super) const SAMPLES: u32 = 1;
pub(super) const TABLE: u32 = 2;
pub(super) const BEFORE: u32 = 3;
pub(super) const AFTER: u32 = 4;
pub(super) const MEAN: u32 = 5;
pub(super) const AGES: u32 = 6;
pub(super) const RAYS: u32 = 7;
pub(super) const COLORS: u32 = 8;
pub(super) const MADE_POINTS: u32 = 9;

/// Those that are only read.
const READ_ONLY: [u32; 5] = [SAMPLES, TABLE, BEFORE, RAYS, COLORS];

/// An entry point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Pass {
    Near,
    Median,
    Bilateral,
    Flying,
    Erode,
    Temporal,
    Reproject,
}

/// In the order of [`Pass`].
const ROWS: [EntryRow; 7] = [
    EntryRow {
        entry: "near",
        buffers: &[SAMPLES, TABLE, AFTER],
    },
    EntryRow {
        entry: "median",
        buffers: &[BEFORE, AFTER],
    },
    EntryRow {
        entry: "bilateral",
        buffers: &[BEFORE, AFTER],
    },
    EntryRow {
        entry: "flying",
        buffers: &[BEFORE, AFTER],
    },
    EntryRow {
        entry: "erode",
        buffers: &[BEFORE, AFTER],
    },
    EntryRow {
        entry: "mean_over_time",
        buffers: &[BEFORE, MEAN, AGES],
    },
    EntryRow {
        entry: "reproject",
        buffers: &[BEFORE, RAYS, COLORS, MADE_POINTS],
    },
];

/// The WGSL of all of them.
pub(in crate::render::gpu) fn source() -> String {
    [
        constants::shared().as_str(),
        &constants::of_depth_images(),
        include_str!("../../../../shaders/common/records.wgsl"),
        include_str!("../../../../shaders/depth_images/image.wgsl"),
        include_str!("../../../../shaders/depth_images/near.wgsl"),
        include_str!("../../../../shaders/depth_images/median.wgsl"),
        &middle_of_window(),
        include_str!("../../../../shaders/depth_images/bilateral.wgsl"),
        include_str!("../../../../shaders/depth_images/flying.wgsl"),
        include_str!("../../../../shaders/depth_images/temporal.wgsl"),
        include_str!("../../../../shaders/depth_images/reproject.wgsl"),
    ]
    .join("\n")
}

/// All programs.
#[derive(Debug)]
pub(super) struct Programs(ComputePrograms);

impl Programs {
    pub(super) fn new(context: &Context) -> Self {
        Self(ComputePrograms::new(
            context,
            ComputeShader {
                label: "depth images",
                source,
                rows: &ROWS,
                read_only: &READ_ONLY,
                uniform_bytes: size_of::<DepthImaging>() as u64,
                group: DEPTH_GROUP,
            },
        ))
    }

    /// Records a pass over all pixels; `buffer` knows what is bound to each binding. Precondition: the adapter has as
    /// many workgroups ([`groups`]).
    pub(super) fn record<'a>(
        &self,
        recording: &mut Recording<'_>,
        which: Pass,
        size_px: [u32; 2],
        buffer: impl Fn(u32) -> &'a wgpu::Buffer,
    ) {
        let row = which as usize;
        let group = self.0.group(recording.context, row, buffer);
        let mut pass = recording.begin_compute(name_of(which));
        self.0.dispatch(&mut pass, row, (&group, 0), groups(size_px));
    }
}

/// What a pass is called where times are shown: as its filter is on the command line.
fn name_of(which: Pass) -> &'static str {
    match which {
        Pass::Near => "near",
        Pass::Median => "median",
        Pass::Bilateral => "bilateral",
        Pass::Flying | Pass::Erode => "flying",
        Pass::Temporal => "temporal",
        Pass::Reproject => "reproject",
    }
}

/// Workgroups across and down.
pub(super) fn groups(size_px: [u32; 2]) -> [u32; 2] {
    size_px.map(|edge| edge.div_ceil(DEPTH_TILE_PX))
}
