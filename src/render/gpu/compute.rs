//! Compute passes: entry points of one shader, each with the storage buffers that it binds beside one uniform. A pass
//! is a row, and the WGSL of its bindings is made of the rows.

use super::constants::declared;
use super::context::Context;
use super::layout::Layout;
use super::shader_file::GeneratedRow;
use super::wgsl::{ImportError, ShaderFile, assembled, source_or_nothing};
use std::fmt::Write;

/// Of the uniform of every pass; storage buffers have the bindings behind it.
pub(super) const UNIFORM: u32 = 0;

/// Of everything that is bound.
const COMPUTE_GROUP: u32 = 0;

/// An entry point.
#[derive(Debug)]
pub(super) struct EntryRow {
    pub(super) entry: &'static str,
    /// The file that has it.
    pub(super) file: ShaderFile,
    /// What it binds beside the uniform: eight buffers at most, which every adapter has.
    pub(super) buffers: &'static [u32],
}

/// A storage buffer.
#[derive(Debug)]
pub(super) struct BufferRow {
    pub(super) binding: u32,
    /// Of the variable.
    pub(super) name: &'static str,
    /// Its type in WGSL.
    pub(super) holds: &'static str,
    pub(super) access: Access,
}

impl BufferRow {
    /// A buffer that passes read.
    pub(super) const fn read(binding: u32, name: &'static str, holds: &'static str) -> Self {
        Self {
            binding,
            name,
            holds,
            access: Access::Read,
        }
    }

    /// A buffer that passes read and write.
    pub(super) const fn read_write(binding: u32, name: &'static str, holds: &'static str) -> Self {
        Self {
            access: Access::ReadWrite,
            ..Self::read(binding, name, holds)
        }
    }
}

/// What passes do with a buffer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Access {
    Read,
    ReadWrite,
}

/// A shader and its entry points.
#[derive(Debug, Clone, Copy)]
pub(super) struct ComputeShader {
    pub(super) label: &'static str,
    pub(super) rows: &'static [EntryRow],
    /// What its files have from Rust: texts by the names that they are imported by.
    pub(super) given: &'static [GeneratedRow],
    /// The uniform by the name of its variable.
    pub(super) uniform: (&'static str, &'static Layout),
    pub(super) buffers: &'static [BufferRow],
}

impl ComputeShader {
    /// The WGSL of all passes.
    pub(super) fn source(&self) -> Result<String, ImportError> {
        let given = self.given.iter().map(|(name, text)| (*name, text()));
        let given: Vec<_> = given.chain([("generated/bindings", self.declarations())]).collect();
        let files: Vec<ShaderFile> = self.rows.iter().map(|row| row.file).collect();
        assembled(&given, &files)
    }

    /// What is bound.
    fn declarations(&self) -> String {
        let (name, layout) = self.uniform;
        let mut text = declared![COMPUTE_GROUP] + "\n" + &layout.declaration();
        // A string takes everything.
        let _ = writeln!(
            text,
            "@group(COMPUTE_GROUP) @binding({UNIFORM}) var<uniform> {name}: {};",
            layout.name
        );
        for BufferRow {
            binding,
            name,
            holds,
            access,
        } in self.buffers
        {
            let access = match access {
                Access::Read => "read",
                Access::ReadWrite => "read_write",
            };
            let _ = writeln!(
                text,
                "@group(COMPUTE_GROUP) @binding({binding}) var<storage, {access}> {name}: {holds};"
            );
        }
        text
    }

    fn is_only_read(&self, binding: u32) -> bool {
        let mut buffers = self.buffers.iter();
        buffers.any(|buffer| buffer.binding == binding && buffer.access == Access::Read)
    }
}

/// Everything that a pass binds.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bound<'a> {
    pub(super) group: &'a wgpu::BindGroup,
    /// Bytes.
    pub(super) uniform_offset: u32,
}

impl<'a> Bound<'a> {
    /// With the uniform at the start of its buffer.
    pub(super) fn whole(group: &'a wgpu::BindGroup) -> Self {
        Self {
            group,
            uniform_offset: 0,
        }
    }
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
            source: wgpu::ShaderSource::Wgsl(source_or_nothing(shader.source()).into()),
        });
        let program = |row| Program::new(context, &module, row, shader);
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
        let EntryRow { entry, buffers, .. } = &self.shader.rows[row];
        let uniform = wgpu::BindGroupEntry {
            binding: UNIFORM,
            resource: wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                buffer: buffer(UNIFORM),
                offset: 0,
                size: wgpu::BufferSize::new(self.shader.uniform.1.size as u64),
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
        bound: Bound<'_>,
        [across, down]: [u32; 2],
    ) {
        pass.set_pipeline(&self.programs[row].pipeline);
        pass.set_bind_group(COMPUTE_GROUP, bound.group, &[bound.uniform_offset]);
        pass.dispatch_workgroups(across, down, 1);
    }
}

impl Program {
    fn new(context: &Context, module: &wgpu::ShaderModule, row: &EntryRow, shader: ComputeShader) -> Self {
        let entry = |binding| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::COMPUTE,
            ty: wgpu::BindingType::Buffer {
                ty: match binding {
                    UNIFORM => wgpu::BufferBindingType::Uniform,
                    _ => wgpu::BufferBindingType::Storage {
                        read_only: shader.is_only_read(binding),
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
