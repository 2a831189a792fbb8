//! The compute programs that gather records: one binding a buffer, and a group of bindings for each chunk.

use super::constants::{GATHER_GROUP, GROUP_RECORDS};
use super::context::Context;

/// A compute pass and its bindings: a uniform, then storage buffers, of which the fourth binding is written.
#[derive(Debug)]
pub(super) struct Program {
    pub(super) label: &'static str,
    source: fn() -> String,
    layout: wgpu::BindGroupLayout,
    pipeline: Option<wgpu::ComputePipeline>,
}

impl Program {
    pub(super) fn new(context: &Context, label: &'static str, source: fn() -> String, storage_buffers: u32) -> Self {
        let entry = |binding| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::COMPUTE,
            ty: wgpu::BindingType::Buffer {
                ty: match binding {
                    0 => wgpu::BufferBindingType::Uniform,
                    _ => wgpu::BufferBindingType::Storage {
                        read_only: binding != 3,
                    },
                },
                has_dynamic_offset: false,
                min_binding_size: None,
            },
            count: None,
        };
        let entries: Vec<_> = (0..=storage_buffers).map(entry).collect();
        Self {
            label,
            source,
            layout: context
                .device
                .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                    label: Some(label),
                    entries: &entries,
                }),
            pipeline: None,
        }
    }

    pub(super) fn ensure_pipeline(&mut self, context: &Context) {
        if self.pipeline.is_some() {
            return;
        }
        let label = Some(self.label);
        let module = context.device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label,
            source: wgpu::ShaderSource::Wgsl((self.source)().into()),
        });
        let layout = context.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label,
            bind_group_layouts: &[Some(&self.layout)],
            immediate_size: 0,
        });
        let pipeline = context
            .device
            .create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label,
                layout: Some(&layout),
                module: &module,
                entry_point: Some("gather"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                cache: None,
            });
        self.pipeline = Some(pipeline);
    }

    /// A uniform, and storage buffers in the order of their bindings.
    pub(super) fn bind_group(&self, context: &Context, uniform: &[u8], buffers: &[&wgpu::Buffer]) -> wgpu::BindGroup {
        let uniform = context.filled_buffer(self.label, wgpu::BufferUsages::UNIFORM, uniform, uniform.len());
        let buffers = std::iter::once(&uniform).chain(buffers.iter().copied());
        let entries: Vec<_> = (0..)
            .zip(buffers)
            .map(|(binding, buffer)| wgpu::BindGroupEntry {
                binding,
                resource: buffer.as_entire_binding(),
            })
            .collect();
        context.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(self.label),
            layout: &self.layout,
            entries: &entries,
        })
    }

    /// Precondition: [`Program::ensure_pipeline`].
    pub(super) fn dispatch(
        &self,
        context: &Context,
        pass: &mut wgpu::ComputePass<'_>,
        group: &wgpu::BindGroup,
        record_count: u32,
    ) {
        if let Some(pipeline) = &self.pipeline {
            pass.set_pipeline(pipeline);
            pass.set_bind_group(GATHER_GROUP, group, &[]);
            let most = context.limits.max_compute_workgroups_per_dimension;
            pass.dispatch_workgroups(record_count.div_ceil(GROUP_RECORDS).min(most), 1, 1);
        }
    }
}
