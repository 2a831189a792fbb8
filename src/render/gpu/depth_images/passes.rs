//! The programs that filter depth images and make points of them: entry points of one shader.

pub(super) use crate::render::gpu::compute::UNIFORM;

use super::network::center_of_window;
use crate::render::gpu::compute::{Bound, BufferRow, ComputePrograms, ComputeShader, EntryRow};
use crate::render::gpu::constants::{self, DEPTH_TILE_PX};
use crate::render::gpu::context::Context;
use crate::render::gpu::gpu_data::DepthImaging;
use crate::render::gpu::layout::Shared;
use crate::render::gpu::recording::Recording;
use crate::render::gpu::wgsl::shader_file;

/// Bindings of `depth_images/image.wgsl`. The camera's measurements.
pub(super) const SAMPLES: u32 = 1;
/// Metres of each number.
pub(super) const TABLE: u32 = 2;
/// Depths.
pub(super) const BEFORE: u32 = 3;
/// Depths after a pass.
pub(super) const AFTER: u32 = 4;
/// Temporal mean of the frames so far.
pub(super) const MEAN: u32 = 5;
/// For how many frames each pixel was a hole.
pub(super) const AGES: u32 = 6;
/// x and y at a depth of 1; `NO_RAY` where the lens shows nothing.
pub(super) const RAYS: u32 = 7;
/// Bytes of red, green and blue, one pixel after the other.
pub(super) const COLORS: u32 = 8;
/// One for each pixel.
pub(super) const MADE_POINTS: u32 = 9;

/// Buffer bindings of the passes, by their names in WGSL.
const BUFFERS: [BufferRow; 9] = [
    BufferRow::read(SAMPLES, "samples", "array<u32>"),
    BufferRow::read(TABLE, "table", "array<f32>"),
    BufferRow::read(BEFORE, "before", "array<f32>"),
    BufferRow::read_write(AFTER, "after", "array<f32>"),
    BufferRow::read_write(MEAN, "mean", "array<f32>"),
    BufferRow::read_write(AGES, "ages", "array<u32>"),
    BufferRow::read(RAYS, "rays", "array<vec2f>"),
    BufferRow::read(COLORS, "colors", "array<u32>"),
    BufferRow::read_write(MADE_POINTS, "made_points", "array<PointRecord>"),
];

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
        file: shader_file!("depth_images/near.wgsl"),
        buffers: &[SAMPLES, TABLE, AFTER],
    },
    EntryRow {
        entry: "median",
        file: shader_file!("depth_images/median.wgsl"),
        buffers: &[BEFORE, AFTER],
    },
    EntryRow {
        entry: "bilateral",
        file: shader_file!("depth_images/bilateral.wgsl"),
        buffers: &[BEFORE, AFTER],
    },
    EntryRow {
        entry: "flying",
        file: shader_file!("depth_images/flying.wgsl"),
        buffers: &[BEFORE, AFTER],
    },
    EntryRow {
        entry: "erode",
        file: shader_file!("depth_images/flying.wgsl"),
        buffers: &[BEFORE, AFTER],
    },
    EntryRow {
        entry: "mean_over_time",
        file: shader_file!("depth_images/temporal.wgsl"),
        buffers: &[BEFORE, MEAN, AGES],
    },
    EntryRow {
        entry: "reproject",
        file: shader_file!("depth_images/reproject.wgsl"),
        buffers: &[BEFORE, RAYS, COLORS, MADE_POINTS],
    },
];

/// All of them.
pub(in crate::render::gpu) const SHADER: ComputeShader = ComputeShader {
    label: "depth images",
    rows: &ROWS,
    given: &[
        ("generated/depth_images", constants::of_depth_images),
        ("generated/center_of_window", center_of_window),
    ],
    uniform: ("imaging", &DepthImaging::LAYOUT),
    buffers: &BUFFERS,
};

/// All programs.
#[derive(Debug)]
pub(super) struct Programs(ComputePrograms);

impl Programs {
    pub(super) fn new(context: &Context) -> Self {
        Self(ComputePrograms::new(context, SHADER))
    }

    /// Records a pass over all pixels; `buffer` returns the buffer of each binding. Precondition: the adapter has
    /// enough workgroups ([`groups`]).
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
        self.0.dispatch(&mut pass, row, Bound::whole(&group), groups(size_px));
    }
}

/// Returns the name of a pass for timings: its filter's on the command line.
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
