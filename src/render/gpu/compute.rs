//! Compute passes that are entry points of one shader, each with the storage buffers that it binds beside one uniform.

use super::context::Context;

/// Of the uniform of every pass; storage buffers have the bindings behind it.
pub(super) const UNIFORM: u32 = 0;

/// An entry point.
#[derive(Debug)]
pub(super) struct EntryRow {
    pub(super) entry: &'static str,
    /// What it binds beside the uniform: eight buffers at most, which every adapter has.
    pub(super) buffers: &'static [u32],
}

/// A shader and its entry points.
#[derive(Debug, Clone, Copy)]
pub(super) struct ComputeShader {
    pub(super) label: &'static str,
    pub(super) source: fn() -> String,
    pub(super) rows: &'static [EntryRow],
    /// Bindings that are only read.
    pub(super) read_only: &'static [u32],
    pub(super) uniform_bytes: u64,
    /// Of everything that is bound.
    pub(super) group: u32,
}

/// The programs of a shader, in the order of its rows.
#[derive(Debug)]
pub(super) struct ComputePrograms {
    shader: ComputeShader,
    programs: Vec<Program>,
}

#[derive(Debug)]
struct Program {
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::ComputePipeline,
}

impl ComputePrograms {
    pub(super) fn new(context: &Context, shader: ComputeShader) -> Self {
        let module = context.device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(shader.label),
            source: wgpu::ShaderSource::Wgsl((shader.source)().into()),
        });
        let program = |row| Program::new(context, &module, row, shader.read_only);
        Self {
            shader,
            programs: shader.rows.iter().map(program).collect(),
        }
    }

    /// What a pass reads and writes; `buffer` knows what is bound to each binding.
    pub(super) fn group<'a>(
        &self,
        context: &Context,
        row: usize,
        buffer: impl Fn(u32) -> &'a wgpu::Buffer,
    ) -> wgpu::BindGroup {
        let EntryRow { entry, buffers } = &self.shader.rows[row];
        let uniform = wgpu::BindGroupEntry {
            binding: UNIFORM,
            resource: wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                buffer: buffer(UNIFORM),
                offset: 0,
                size: wgpu::BufferSize::new(self.shader.uniform_bytes),
            }),
        };
        let others = buffers.iter().map(|&binding| wgpu::BindGroupEntry {
            binding,
            resource: buffer(binding).as_entire_binding(),
        });
        let entries: Vec<_> = std::iter::once(uniform).chain(others).collect();
        context.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(entry),
            layout: &self.programs[row].layout,
            entries: &entries,
        })
    }

    /// Precondition: so many workgroups are one dispatch of the adapter.
    pub(super) fn dispatch(
        &self,
        pass: &mut wgpu::ComputePass<'_>,
        row: usize,
        (group, uniform_offset): (&wgpu::BindGroup, u32),
        [across, down]: [u32; 2],
    ) {
        pass.set_pipeline(&self.programs[row].pipeline);
        pass.set_bind_group(self.shader.group, group, &[uniform_offset]);
        pass.dispatch_workgroups(across, down, 1);
    }
}

impl Program {
    fn new(context: &Context, module: &wgpu::ShaderModule, row: &EntryRow, read_only: &[u32]) -> Self {
        let entry = |binding| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::COMPUTE,
            ty: wgpu::BindingType::Buffer {
                ty: match binding {
                    UNIFORM => wgpu::BufferBindingType::Uniform,
                    _ => wgpu::BufferBindingType::Storage {
                        read_only: read_only.contains(&binding),
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
