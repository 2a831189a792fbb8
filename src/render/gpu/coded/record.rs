//! The order of the passes, and the dispatch size of each.

use super::passes::{CODE, DRAWN_POINTS, DRAWN_SHAPES, NEXT_QUEUE, Pass, QUEUE, TABLES};
use super::scratch::{DISPATCH_BYTES, Scratch};
use crate::render::gpu::compute::{Bound, ComputePrograms, UNIFORM};
use crate::render::gpu::constants::GROUP_RECORDS;
use crate::render::gpu::context::Context;
use crate::render::gpu::gpu_data::Expanding;
use crate::render::gpu::recording::Recording;

/// Names of the passes in timings.
const EXPAND_PASS: &str = "traverse byte code";
const WRITE_PASS: &str = "decode byte code";

/// State for recording the passes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Expanded<'a> {
    pub(super) programs: &'a ComputePrograms,
    pub(super) scratch: &'a Scratch,
    pub(super) code: &'a wgpu::Buffer,
    pub(super) tables: &'a wgpu::Buffer,
}

/// Buffers for the records of a chunk.
#[derive(Debug, Clone, Copy)]
pub(super) struct Output<'a> {
    pub(super) records: u32,
    pub(super) points: &'a wgpu::Buffer,
    pub(super) shapes: &'a wgpu::Buffer,
}

/// Lists the drawn nodes. `uniforms` has one for each level from the root on.
pub(super) fn expand(recording: &mut Recording<'_>, expanded: &Expanded<'_>, uniforms: &[Expanding]) {
    let Expanded { programs, scratch, .. } = *expanded;
    let context = recording.context;
    let uniforms: Vec<wgpu::Buffer> = uniforms.iter().map(|uniform| buffer_of(context, uniform)).collect();
    let mut pass = recording.begin_compute(EXPAND_PASS);
    for (level, uniform) in (0..).zip(&uniforms) {
        let group = |which: Pass| {
            programs.group(context, which as usize, |binding| match binding {
                UNIFORM => uniform,
                CODE => expanded.code,
                TABLES => expanded.tables,
                QUEUE => scratch.queue(level),
                // The first queue has been written by no level.
                NEXT_QUEUE if matches!(which, Pass::Begin) => scratch.queue(0),
                NEXT_QUEUE => scratch.queue(level + 1),
                own => scratch.buffer(own),
            })
        };
        if level == 0 {
            programs.dispatch(
                &mut pass,
                Pass::Begin as usize,
                Bound::whole(&group(Pass::Begin)),
                [1, 1],
            );
        }
        let groups = scratch.buffer(super::passes::GROUPS);
        let size_at = u64::from(level % 2) * DISPATCH_BYTES;
        for which in [Pass::Classify, Pass::Scan, Pass::Divide] {
            let (group, row) = (group(which), which as usize);
            match which {
                Pass::Scan => programs.dispatch(&mut pass, row, Bound::whole(&group), [1, 1]),
                _ => programs.dispatch_indirect(&mut pass, row, Bound::whole(&group), groups, size_at),
            }
        }
    }
}

/// Writes the records of the drawn nodes into these buffers, one after the other.
pub(super) fn write<'a>(
    recording: &mut Recording<'_>,
    expanded: &Expanded<'_>,
    uniform: &Expanding,
    outputs: impl Iterator<Item = Output<'a>>,
) {
    let Expanded { programs, scratch, .. } = *expanded;
    let context = recording.context;
    let mut pass = recording.begin_compute(WRITE_PASS);
    let mut first = 0;
    for output in outputs {
        let count = output.records;
        let uniform = buffer_of(
            context,
            &Expanding {
                first,
                count,
                ..*uniform
            },
        );
        let group = programs.group(context, Pass::Write as usize, |binding| match binding {
            UNIFORM => &uniform,
            CODE => expanded.code,
            TABLES => expanded.tables,
            DRAWN_POINTS => output.points,
            DRAWN_SHAPES => output.shapes,
            own => scratch.buffer(own),
        });
        let groups = [count.div_ceil(GROUP_RECORDS), 1];
        programs.dispatch(&mut pass, Pass::Write as usize, Bound::whole(&group), groups);
        first += count;
    }
}

fn buffer_of(context: &Context, uniform: &Expanding) -> wgpu::Buffer {
    let bytes = bytemuck::bytes_of(uniform);
    context.filled_buffer("byte code view", wgpu::BufferUsages::UNIFORM, bytes, bytes.len())
}
