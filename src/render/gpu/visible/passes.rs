//! The programs that make surfels of the screen: entry points of one shader, each with its bindings.

use crate::render::gpu::compute::{Bound, BufferRow, ComputePrograms, ComputeShader, EntryRow};
use crate::render::gpu::constants::{self, GROUP_RECORDS};
use crate::render::gpu::context::Context;
use crate::render::gpu::gpu_data::Screening;
use crate::render::gpu::layout::Shared;
use crate::render::gpu::wgsl::shader_file;

/// Bindings of `screen_normals/view.wgsl`.
/// Of the cloud.
pub(super) const POINTS: u32 = 1;
/// Global results (`Found`) over all points.
pub(super) const FOUND: u32 = 2;
/// Inverted bits of the depth of the nearest point of each pixel; zero where there is none.
pub(super) const NEAREST: u32 = 3;
/// Nearest depths of the pixels, once all points are drawn.
pub(super) const NEAREST_DRAWN: u32 = 4;
/// Nearest depths of the pixels as floats, with a border of `BORDER_PX` pixels.
pub(super) const DEPTHS: u32 = 5;
/// Point data: for each point the bits of its depth, then its index among those of its workgroup that are visible, then
/// its cell. These are followed by the visible points, and these by the sums of workgroups.
pub(super) const PLACES: u32 = 6;
/// Visible points: from the eye, in the axes of the cloud, and depths.
pub(super) const SEEN_POINTS: u32 = 7;
/// Cell keys: for each cell the inverted bits of the nearest depth, the inverted index of the first such point among
/// the visible ones, and its number of points.
pub(super) const CELL_KEYS: u32 = 8;
/// Cell keys once all points are in.
pub(super) const CELL_KEYS_FOUND: u32 = 9;
/// Position of the nearest point of each cell, relative to the eye, and the number of points.
pub(super) const CELLS: u32 = 10;
/// Output points to draw.
pub(super) const DRAWN_POINTS: u32 = 11;
/// Output shapes to draw.
pub(super) const DRAWN_SHAPES: u32 = 12;
/// Normals of visible points, or `NO_NORMAL` where no plane fits.
pub(super) const NORMALS: u32 = 13;

/// Buffer bindings of the passes, by their names in WGSL.
const BUFFERS: [BufferRow; 13] = [
    BufferRow::read(POINTS, "points", "array<PointRecord>"),
    BufferRow::read_write(FOUND, "found", "Found"),
    BufferRow::read_write(NEAREST, "nearest", "array<atomic<u32>>"),
    BufferRow::read(NEAREST_DRAWN, "nearest_drawn", "array<u32>"),
    BufferRow::read_write(DEPTHS, "depths", "array<f32>"),
    BufferRow::read_write(PLACES, "places", "array<u32>"),
    BufferRow::read_write(SEEN_POINTS, "seen_points", "array<vec4f>"),
    BufferRow::read_write(CELL_KEYS, "cell_keys", "array<atomic<u32>>"),
    BufferRow::read_write(CELL_KEYS_FOUND, "cell_keys_found", "array<u32>"),
    BufferRow::read_write(CELLS, "cells", "array<vec4f>"),
    BufferRow::read_write(DRAWN_POINTS, "drawn_points", "array<PointRecord>"),
    BufferRow::read_write(DRAWN_SHAPES, "drawn_shapes", "array<ShapeRecord>"),
    BufferRow::read_write(NORMALS, "normals", "array<u32>"),
];

/// An entry point.
#[derive(Debug, Clone, Copy)]
pub(super) enum Pass {
    Draw,
    Frame,
    Cull,
    Scan,
    Compact,
    Choose,
    Coarsen,
    Surface,
    Lend,
}

/// In the order of [`Pass`].
const ROWS: [EntryRow; 9] = [
    EntryRow {
        entry: "draw",
        file: shader_file!("screen_normals/cull.wgsl"),
        buffers: &[POINTS, FOUND, NEAREST, PLACES],
    },
    EntryRow {
        entry: "frame",
        file: shader_file!("screen_normals/cull.wgsl"),
        buffers: &[NEAREST_DRAWN, DEPTHS],
    },
    EntryRow {
        entry: "cull",
        file: shader_file!("screen_normals/cull.wgsl"),
        buffers: &[POINTS, FOUND, DEPTHS, PLACES],
    },
    EntryRow {
        entry: "scan",
        file: shader_file!("screen_normals/cull.wgsl"),
        buffers: &[FOUND, PLACES],
    },
    EntryRow {
        entry: "compact",
        file: shader_file!("screen_normals/cull.wgsl"),
        buffers: &[POINTS, FOUND, PLACES, SEEN_POINTS, CELL_KEYS],
    },
    EntryRow {
        entry: "choose",
        file: shader_file!("screen_normals/cells.wgsl"),
        buffers: &[FOUND, PLACES, SEEN_POINTS, CELL_KEYS],
    },
    EntryRow {
        entry: "coarsen",
        file: shader_file!("screen_normals/cells.wgsl"),
        buffers: &[FOUND, SEEN_POINTS, CELL_KEYS_FOUND, CELLS],
    },
    EntryRow {
        entry: "surface",
        file: shader_file!("screen_normals/planes.wgsl"),
        buffers: &[
            POINTS,
            FOUND,
            PLACES,
            SEEN_POINTS,
            CELLS,
            DRAWN_POINTS,
            DRAWN_SHAPES,
            NORMALS,
        ],
    },
    EntryRow {
        entry: "lend",
        file: shader_file!("screen_normals/planes.wgsl"),
        buffers: &[FOUND, SEEN_POINTS, CELL_KEYS_FOUND, CELLS, DRAWN_SHAPES, NORMALS],
    },
];

/// All of them.
pub(in crate::render::gpu) const SHADER: ComputeShader = ComputeShader {
    label: "screen normals",
    rows: &ROWS,
    given: &[("generated/screen_normals", constants::of_screen_normals)],
    uniform: ("screening", &Screening::LAYOUT),
    buffers: &BUFFERS,
};

/// All programs, in the order of [`Pass`].
#[derive(Debug)]
pub(super) struct Programs(ComputePrograms);

/// Dispatch parameters of a pass.
#[derive(Debug, Clone, Copy)]
pub(super) struct Work {
    /// Byte offset of the uniform.
    pub(super) uniform_offset: u32,
    /// Minimum number of invocations.
    pub(super) invocations: u32,
}

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

    /// Precondition: the adapter can dispatch this many workgroups at once
    /// ([`Sizes::fit`](super::scratch::Sizes::fit)).
    pub(super) fn dispatch(&self, pass: &mut wgpu::ComputePass<'_>, which: Pass, group: &wgpu::BindGroup, work: Work) {
        let groups = [work.invocations.div_ceil(GROUP_RECORDS), 1];
        let bound = Bound {
            group,
            uniform_offset: work.uniform_offset,
        };
        self.0.dispatch(pass, which as usize, bound, groups);
    }
}
