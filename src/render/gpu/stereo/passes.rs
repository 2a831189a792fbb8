//! Compute programs for stereo matching: entry points of one shader.

pub(super) use crate::render::gpu::compute::UNIFORM;

use crate::render::gpu::compute::{Bound, BufferRow, ComputePrograms, ComputeShader, EntryRow};
use crate::render::gpu::constants::{self, STEREO_LANES, STEREO_STRIP_PX, STEREO_TILE_PX};
use crate::render::gpu::context::Context;
use crate::render::gpu::gpu_data::StereoMatching;
use crate::render::gpu::layout::Shared;
use crate::render::gpu::wgsl::shader_file;

/// Bindings of `stereo/pair.wgsl`. Brightnesses of the left image followed by the right one's, four in a word.
pub(super) const PIXELS: u32 = 1;
/// The bits of each of these pixels.
pub(super) const CENSUS: u32 = 2;
/// Census bits, while they are computed.
pub(super) const MADE_CENSUS: u32 = 3;
/// Column sums, 16 bits for each pixel and label: line by line, pixel by pixel, label by label.
pub(super) const COLUMNS: u32 = 4;
/// Cost sums of all paths, or of squares, 16 bits for each pixel and label.
pub(super) const SUMS: u32 = 5;
/// The label of each pixel of the left image, with `IS_UNIQUE` where no other is as good, followed by the right one's.
pub(super) const WINNERS: u32 = 6;
/// Labels, `NO_LABEL` where there is none.
pub(super) const BEFORE: u32 = 7;
/// Labels after a pass.
pub(super) const AFTER: u32 = 8;

/// Buffer bindings of the passes, by their names in WGSL.
const BUFFERS: [BufferRow; 8] = [
    BufferRow::read(PIXELS, "pixels", "array<u32>"),
    BufferRow::read(CENSUS, "census_bits", "array<vec2u>"),
    BufferRow::read_write(MADE_CENSUS, "made_census", "array<vec2u>"),
    BufferRow::read_write(COLUMNS, "columns", "array<u32>"),
    BufferRow::read_write(SUMS, "sums", "array<u32>"),
    BufferRow::read_write(WINNERS, "winners", "array<u32>"),
    BufferRow::read(BEFORE, "before", "array<f32>"),
    BufferRow::read_write(AFTER, "after", "array<f32>"),
];

/// An entry point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Pass {
    Census,
    AlongPath,
    SumColumns,
    SumSquares,
    FindWinners,
    Choose,
    Meet,
    LayOnPlanes,
    Median,
}

/// In the order of [`Pass`].
const ROWS: [EntryRow; 9] = [
    EntryRow {
        entry: "census",
        file: shader_file!("stereo/census.wgsl"),
        buffers: &[PIXELS, MADE_CENSUS],
    },
    EntryRow {
        entry: "along_path",
        file: shader_file!("stereo/paths.wgsl"),
        buffers: &[PIXELS, CENSUS, SUMS],
    },
    EntryRow {
        entry: "sum_columns",
        file: shader_file!("stereo/squares.wgsl"),
        buffers: &[CENSUS, COLUMNS],
    },
    EntryRow {
        entry: "sum_squares",
        file: shader_file!("stereo/squares.wgsl"),
        buffers: &[COLUMNS, SUMS],
    },
    EntryRow {
        entry: "find_winners",
        file: shader_file!("stereo/winners.wgsl"),
        buffers: &[SUMS, WINNERS],
    },
    EntryRow {
        entry: "choose",
        file: shader_file!("stereo/choose.wgsl"),
        buffers: &[PIXELS, SUMS, WINNERS, AFTER],
    },
    EntryRow {
        entry: "meet",
        file: shader_file!("stereo/refine.wgsl"),
        buffers: &[CENSUS, BEFORE, AFTER],
    },
    EntryRow {
        entry: "lay_on_planes",
        file: shader_file!("stereo/refine.wgsl"),
        buffers: &[BEFORE, AFTER],
    },
    EntryRow {
        entry: "median",
        file: shader_file!("stereo/median.wgsl"),
        buffers: &[BEFORE, AFTER],
    },
];

/// Passes that every pair may need, whatever gathers its costs.
const OF_ALL: [Pass; 6] = [
    Pass::Census,
    Pass::FindWinners,
    Pass::Choose,
    Pass::Meet,
    Pass::LayOnPlanes,
    Pass::Median,
];

/// From pixel to pixel of the eight paths.
pub(super) const PATH_STEPS: [[i32; 2]; 8] = [[1, 0], [-1, 0], [0, 1], [0, -1], [1, 1], [-1, -1], [1, -1], [-1, 1]];

/// All of them.
pub(in crate::render::gpu) const SHADER: ComputeShader = ComputeShader {
    label: "stereo",
    rows: &ROWS,
    given: &[("generated/stereo", constants::of_stereo)],
    uniform: ("matching", &StereoMatching::LAYOUT),
    buffers: &BUFFERS,
};

/// All programs.
#[derive(Debug)]
pub(super) struct Programs(ComputePrograms);

impl Programs {
    pub(super) fn new(context: &Context) -> Self {
        Self(ComputePrograms::new(context, SHADER))
    }

    /// Creates the bind group that a pass reads and writes; `buffer` returns the buffer for each binding.
    pub(super) fn group<'a>(
        &self,
        context: &Context,
        which: Pass,
        buffer: impl Fn(u32) -> &'a wgpu::Buffer,
    ) -> wgpu::BindGroup {
        self.0.group(context, which as usize, buffer)
    }

    /// Records a pass whose uniform is at an offset. Precondition: the adapter [`has_groups`].
    pub(super) fn dispatch(
        &self,
        pass: &mut wgpu::ComputePass<'_>,
        which: Pass,
        bound: Bound<'_>,
        uniform: &StereoMatching,
    ) {
        self.0.dispatch(pass, which as usize, bound, groups(which, uniform));
    }
}

/// Returns true if the adapter's dispatch limits allow all passes of such a pair; `is_local` selects the summation of
/// squares.
pub(super) fn has_groups(context: &Context, uniform: &StereoMatching, is_local: bool) -> bool {
    let max = context.limits.max_compute_workgroups_per_dimension;
    let fit = |which, uniform: &StereoMatching| groups(which, uniform).iter().all(|&count| count <= max);
    let are_gathered = if is_local {
        fit(Pass::SumColumns, uniform) && fit(Pass::SumSquares, uniform)
    } else {
        PATH_STEPS.into_iter().all(|path_step| {
            let uniform = StereoMatching { path_step, ..*uniform };
            fit(Pass::AlongPath, &uniform)
        })
    };
    are_gathered && OF_ALL.iter().all(|&which| fit(which, uniform))
}

/// Workgroups across and down.
fn groups(which: Pass, uniform: &StereoMatching) -> [u32; 2] {
    let [width, height] = uniform.size_px;
    let lanes_of_line = |pixels: u32| (pixels.saturating_mul(uniform.count / 2)).div_ceil(STEREO_LANES);
    match which {
        Pass::Census => [width, height.saturating_mul(2)].map(|edge| edge.div_ceil(STEREO_TILE_PX)),
        Pass::AlongPath => {
            let [across, down] = uniform.path_step;
            let paths = match (across != 0, down != 0) {
                (true, true) => width.saturating_add(height) - 1,
                (true, false) => height,
                (false, _) => width,
            };
            [paths, 1]
        }
        Pass::SumColumns => [lanes_of_line(width), height.div_ceil(STEREO_STRIP_PX)],
        Pass::SumSquares => [lanes_of_line(height), width.div_ceil(STEREO_STRIP_PX)],
        Pass::FindWinners => [width, height],
        Pass::Choose | Pass::Meet | Pass::LayOnPlanes | Pass::Median => {
            [width, height].map(|edge| edge.div_ceil(STEREO_TILE_PX))
        }
    }
}
