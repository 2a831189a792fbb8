//! The programs that make surfels of the screen: entry points of one shader, each with what it binds.

use crate::render::gpu::compute::{ComputePrograms, ComputeShader, EntryRow};
use crate::render::gpu::constants::{self, GROUP_RECORDS, SCREENING_GROUP};
use crate::render::gpu::context::Context;
use crate::render::gpu::gpu_data::Screening;

/// Bindings of `screen_normals/view.wgsl`.
pub(super) const POINTS: u32 = 1;
pub(super) const FOUND: u32 = 2;
pub(super) const NEAREST: u32 = 3;
pub(super) const NEAREST_DRAWN: u32 = 4;
pub(super) const DEPTHS: u32 = 5;
pub(super) const PLACES: u32 = 6;
pub(super) const SEEN_POINTS: u32 = 7;
pub(super) const CELL_KEYS: u32 = 8;
pub(super) const CELL_KEYS_FOUND: u32 = 9;
pub(super) const CELLS: u32 = 10;
pub(super) const DRAWN_POINTS: u32 = 11;
pub(super) const DRAWN_SHAPES: u32 = 12;
pub(super) const NORMALS: u32 = 13;

/// Those that are only read.
const READ_ONLY: [u32; 2] = [POINTS, NEAREST_DRAWN];

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
        buffers: &[POINTS, FOUND, NEAREST, PLACES],
    },
    EntryRow {
        entry: "frame",
        buffers: &[NEAREST_DRAWN, DEPTHS],
    },
    EntryRow {
        entry: "cull",
        buffers: &[POINTS, FOUND, DEPTHS, PLACES],
    },
    EntryRow {
        entry: "scan",
        buffers: &[FOUND, PLACES],
    },
    EntryRow {
        entry: "compact",
        buffers: &[POINTS, FOUND, PLACES, SEEN_POINTS, CELL_KEYS],
    },
    EntryRow {
        entry: "choose",
        buffers: &[FOUND, PLACES, SEEN_POINTS, CELL_KEYS],
    },
    EntryRow {
        entry: "coarsen",
        buffers: &[FOUND, SEEN_POINTS, CELL_KEYS_FOUND, CELLS],
    },
    EntryRow {
        entry: "surface",
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
        buffers: &[FOUND, SEEN_POINTS, CELL_KEYS_FOUND, CELLS, DRAWN_SHAPES, NORMALS],
    },
];

/// The WGSL of all of them.
pub(in crate::render::gpu) fn source() -> String {
    [
        constants::shared().as_str(),
        &constants::of_screen_normals(),
        include_str!("../../../../shaders/common/records.wgsl"),
        include_str!("../../../../shaders/common/oct_encode.wgsl"),
        include_str!("../../../../shaders/common/scan.wgsl"),
        include_str!("../../../../shaders/common/smallest_eigenvector.wgsl"),
        include_str!("../../../../shaders/screen_normals/view.wgsl"),
        include_str!("../../../../shaders/screen_normals/cells.wgsl"),
        include_str!("../../../../shaders/screen_normals/ramp.wgsl"),
        include_str!("../../../../shaders/screen_normals/cull.wgsl"),
        include_str!("../../../../shaders/screen_normals/planes.wgsl"),
    ]
    .join("\n")
}

/// All programs, in the order of [`Pass`].
#[derive(Debug)]
pub(super) struct Programs(ComputePrograms);

/// What is dispatched.
#[derive(Debug, Clone, Copy)]
pub(super) struct Work {
    /// Of the uniform, bytes.
    pub(super) uniform_offset: u32,
    /// So many at least.
    pub(super) invocations: u32,
}

impl Programs {
    pub(super) fn new(context: &Context) -> Self {
        let shader = ComputeShader {
            label: "screen normals",
            source,
            rows: &ROWS,
            read_only: &READ_ONLY,
            uniform_bytes: size_of::<Screening>() as u64,
            group: SCREENING_GROUP,
        };
        Self(ComputePrograms::new(context, shader))
    }

    /// What a pass reads and writes; `buffer` knows what is bound to each binding.
    pub(super) fn group<'a>(
        &self,
        context: &Context,
        which: Pass,
        buffer: impl Fn(u32) -> &'a wgpu::Buffer,
    ) -> wgpu::BindGroup {
        self.0.group(context, which as usize, buffer)
    }

    /// Precondition: so many workgroups are one dispatch of the adapter ([`Sizes::fit`](super::scratch::Sizes::fit)).
    pub(super) fn dispatch(&self, pass: &mut wgpu::ComputePass<'_>, which: Pass, group: &wgpu::BindGroup, work: Work) {
        let groups = [work.invocations.div_ceil(GROUP_RECORDS), 1];
        let bound = (group, work.uniform_offset);
        self.0.dispatch(pass, which as usize, bound, groups);
    }
}
