//! Compute passes: entry points of one shader, each with the storage buffers that it binds in addition to one uniform.
//! A pass is a row, and the WGSL of its bindings is generated from the rows. Passes that bind more than that, such as
//! the strategy `compute`, get their buffers ([`BufferGroup`]) and pipelines from here.

use super::constants::declared;
use super::context::Context;
use super::layout::Layout;
use super::shader_file::GeneratedRow;
use super::wgsl::{ImportError, ShaderFile, assembled, source_or_nothing};
use std::fmt::Write;

/// Binding of the uniform of every pass; the bindings of storage buffers follow it.
pub(super) const UNIFORM: u32 = 0;

/// Bind group of everything that is bound.
const COMPUTE_GROUP: u32 = 0;

/// An entry point.
#[derive(Debug)]
pub(super) struct EntryRow {
    pub(super) entry: &'static str,
    /// The file that has it.
    pub(super) file: ShaderFile,
    /// Storage buffers bound in addition to the uniform: eight at most, which every adapter supports.
    pub(super) buffers: &'static [u32],
}

/// A storage buffer.
#[derive(Debug)]
pub(super) struct BufferRow {
    pub(super) binding: u32,
    /// Name of the WGSL variable.
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

/// Access mode of a buffer in the passes.
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
    /// Generated WGSL that its files import from Rust: texts by the names that they are imported by.
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

    /// Returns the WGSL declarations of the bindings.
    fn declarations(&self) -> String {
        let (name, layout) = self.uniform;
        let mut text = declared![COMPUTE_GROUP] + "\n" + &layout.declaration();
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "@group(COMPUTE_GROUP) @binding({UNIFORM}) var<uniform> {name}: {};",
            layout.name
        );
        text + &declarations_of("COMPUTE_GROUP", self.buffers)
    }

    fn buffer(&self, binding: u32) -> Option<&BufferRow> {
        self.buffers.iter().find(|buffer| buffer.binding == binding)
    }
}

/// The WGSL of buffers in a group that WGSL knows by this name.
pub(super) fn declarations_of(group: &str, buffers: &[BufferRow]) -> String {
    let mut text = String::new();
    for row in buffers {
        let BufferRow {
            binding, name, holds, ..
        } = row;
        let access = match row.access {
            Access::Read => "read",
            Access::ReadWrite => "read_write",
        };
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "@group({group}) @binding({binding}) var<storage, {access}> {name}: {holds};"
        );
    }
    text
}

/// Buffers that are bound together, in a group of their own.
#[derive(Debug)]
pub(super) struct BufferGroup {
    label: &'static str,
    rows: &'static [BufferRow],
    pub(super) layout: wgpu::BindGroupLayout,
}

impl BufferGroup {
    pub(super) fn new(context: &Context, label: &'static str, rows: &'static [BufferRow]) -> Self {
        let entries = rows.iter().map(|row| layout_entry(row.binding, Some(row)));
        Self {
            label,
            rows,
            layout: group_layout(context, label, entries),
        }
    }

    /// `buffer` returns the buffer of each binding.
    pub(super) fn bound<'a>(&self, context: &Context, buffer: impl Fn(u32) -> &'a wgpu::Buffer) -> wgpu::BindGroup {
        let entries: Vec<_> = self
            .rows
            .iter()
            .map(|row| whole(row.binding, buffer(row.binding)))
            .collect();
        context.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(self.label),
            layout: &self.layout,
            entries: &entries,
        })
    }
}

/// The entry of a buffer in a bind group.
fn whole(binding: u32, buffer: &wgpu::Buffer) -> wgpu::BindGroupEntry<'_> {
    wgpu::BindGroupEntry {
        binding,
        resource: buffer.as_entire_binding(),
    }
}

/// The entry of a buffer in a layout; without a row, the entry of a uniform at a dynamic offset.
fn layout_entry(binding: u32, row: Option<&BufferRow>) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::COMPUTE,
        ty: wgpu::BindingType::Buffer {
            ty: match row {
                None => wgpu::BufferBindingType::Uniform,
                Some(row) => wgpu::BufferBindingType::Storage {
                    read_only: row.access == Access::Read,
                },
            },
            has_dynamic_offset: row.is_none(),
            min_binding_size: None,
        },
        count: None,
    }
}

fn group_layout(
    context: &Context,
    label: &str,
    entries: impl Iterator<Item = wgpu::BindGroupLayoutEntry>,
) -> wgpu::BindGroupLayout {
    let entries: Vec<_> = entries.collect();
    context
        .device
        .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some(label),
            entries: &entries,
        })
}

/// The module of an assembled shader.
pub(super) fn shader_module(context: &Context, label: &str, source: Result<String, ImportError>) -> wgpu::ShaderModule {
    context.device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some(label),
        source: wgpu::ShaderSource::Wgsl(source_or_nothing(source).into()),
    })
}

/// The pipeline of an entry point that binds groups of these layouts.
pub(super) fn pipeline(
    context: &Context,
    label: &str,
    module: &wgpu::ShaderModule,
    entry: &str,
    groups: &[Option<&wgpu::BindGroupLayout>],
) -> wgpu::ComputePipeline {
    let layout = context.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some(label),
        bind_group_layouts: groups,
        immediate_size: 0,
    });
    context
        .device
        .create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(label),
            layout: Some(&layout),
            module,
            entry_point: Some(entry),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            cache: None,
        })
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
        let module = shader_module(context, shader.label, shader.source());
        let program = |row| Program::new(context, &module, row, shader);
        Self {
            shader,
            programs: shader.rows.iter().map(program).collect(),
        }
    }

    /// Creates the bind group that a pass reads and writes; `buffer` returns the buffer for each binding.
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
        let others = buffers.iter().map(|&binding| whole(binding, buffer(binding)));
        let entries: Vec<_> = std::iter::once(uniform).chain(others).collect();
        context.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(entry),
            layout: &self.programs[row].layout,
            entries: &entries,
        })
    }

    /// Precondition: the adapter can dispatch this many workgroups at once.
    pub(super) fn dispatch(
        &self,
        pass: &mut wgpu::ComputePass<'_>,
        row: usize,
        bound: Bound<'_>,
        [across, down]: [u32; 2],
    ) {
        self.bind(pass, row, bound);
        pass.dispatch_workgroups(across, down, 1);
    }

    /// The number of workgroups is that which an earlier pass has written into a buffer, at this offset in bytes.
    pub(super) fn dispatch_indirect(
        &self,
        pass: &mut wgpu::ComputePass<'_>,
        row: usize,
        bound: Bound<'_>,
        groups: &wgpu::Buffer,
        groups_at: u64,
    ) {
        self.bind(pass, row, bound);
        pass.dispatch_workgroups_indirect(groups, groups_at);
    }

    fn bind(&self, pass: &mut wgpu::ComputePass<'_>, row: usize, bound: Bound<'_>) {
        pass.set_pipeline(&self.programs[row].pipeline);
        pass.set_bind_group(COMPUTE_GROUP, bound.group, &[bound.uniform_offset]);
    }
}

impl Program {
    fn new(context: &Context, module: &wgpu::ShaderModule, row: &EntryRow, shader: ComputeShader) -> Self {
        let bindings = std::iter::once(UNIFORM).chain(row.buffers.iter().copied());
        let entries = bindings.map(|binding| layout_entry(binding, shader.buffer(binding)));
        let layout = group_layout(context, row.entry, entries);
        let pipeline = pipeline(context, row.entry, module, row.entry, &[Some(&layout)]);
        Self { layout, pipeline }
    }
}
