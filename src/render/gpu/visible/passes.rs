//! The programs that make surfels of the screen: entry points of one shader, each with what it binds.

use crate::render::gpu::constants::{self, GROUP_RECORDS, SCREENING_GROUP};
use crate::render::gpu::context::Context;
use crate::render::gpu::gpu_data::Screening;

/// Bindings of `screen_normals/view.wgsl`.
pub(super) const UNIFORM: u32 = 0;
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

/// Its name, and what it binds beside the uniform: eight buffers at most, which every adapter has.
#[derive(Debug)]
struct PassRow {
    entry: &'static str,
    buffers: &'static [u32],
}

/// In the order of [`Pass`].
const ROWS: [PassRow; 9] = [
    PassRow {
        entry: "draw",
        buffers: &[POINTS, FOUND, NEAREST, PLACES],
    },
    PassRow {
        entry: "frame",
        buffers: &[NEAREST_DRAWN, DEPTHS],
    },
    PassRow {
        entry: "cull",
        buffers: &[POINTS, FOUND, DEPTHS, PLACES],
    },
    PassRow {
        entry: "scan",
        buffers: &[FOUND, PLACES],
    },
    PassRow {
        entry: "compact",
        buffers: &[POINTS, FOUND, PLACES, SEEN_POINTS, CELL_KEYS],
    },
    PassRow {
        entry: "choose",
        buffers: &[FOUND, PLACES, SEEN_POINTS, CELL_KEYS],
    },
    PassRow {
        entry: "coarsen",
        buffers: &[FOUND, SEEN_POINTS, CELL_KEYS_FOUND, CELLS],
    },
    PassRow {
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
    PassRow {
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
pub(super) struct Programs {
    programs: Vec<Program>,
}

#[derive(Debug)]
struct Program {
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::ComputePipeline,
}

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
        let module = context.device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("screen normals"),
            source: wgpu::ShaderSource::Wgsl(source().into()),
        });
        let program = |row: &PassRow| Program::new(context, &module, row);
        Self {
            programs: ROWS.iter().map(program).collect(),
        }
    }

    /// What a pass reads and writes; `buffer` knows what is bound to each binding.
    pub(super) fn group<'a>(
        &self,
        context: &Context,
        which: Pass,
        buffer: impl Fn(u32) -> &'a wgpu::Buffer,
    ) -> wgpu::BindGroup {
        let row = &ROWS[which as usize];
        let uniform = wgpu::BindGroupEntry {
            binding: UNIFORM,
            resource: wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                buffer: buffer(UNIFORM),
                offset: 0,
                size: wgpu::BufferSize::new(size_of::<Screening>() as u64),
            }),
        };
        let others = row.buffers.iter().map(|&binding| wgpu::BindGroupEntry {
            binding,
            resource: buffer(binding).as_entire_binding(),
        });
        let entries: Vec<_> = std::iter::once(uniform).chain(others).collect();
        context.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(row.entry),
            layout: &self.programs[which as usize].layout,
            entries: &entries,
        })
    }

    /// Precondition: so many workgroups are one dispatch of the adapter ([`Sizes::fit`](super::scratch::Sizes::fit)).
    pub(super) fn dispatch(&self, pass: &mut wgpu::ComputePass<'_>, which: Pass, group: &wgpu::BindGroup, work: Work) {
        pass.set_pipeline(&self.programs[which as usize].pipeline);
        pass.set_bind_group(SCREENING_GROUP, group, &[work.uniform_offset]);
        pass.dispatch_workgroups(work.invocations.div_ceil(GROUP_RECORDS), 1, 1);
    }
}

impl Program {
    fn new(context: &Context, module: &wgpu::ShaderModule, row: &PassRow) -> Self {
        let entry = |binding| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::COMPUTE,
            ty: wgpu::BindingType::Buffer {
                ty: match binding {
                    UNIFORM => wgpu::BufferBindingType::Uniform,
                    _ => wgpu::BufferBindingType::Storage {
                        read_only: READ_ONLY.contains(&binding),
                    },
                },
                has_dynamic_offset: binding == UNIFORM,
                min_binding_size: None,
            },
            count: None,
        };
        let bindings = std::iter::once(UNIFORM).chain(row.buffers.iter().copied());
        let entries: Vec<_> = bindings.map(entry).collect();
        let label = Some(row.entry);
        let layout = context
            .device
            .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                label,
                entries: &entries,
            });
        let pipeline_layout = context.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label,
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let pipeline = context
            .device
            .create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label,
                layout: Some(&pipeline_layout),
                module,
                entry_point: Some(row.entry),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                cache: None,
            });
        Self { layout, pipeline }
    }
}
