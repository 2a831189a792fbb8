//! The order of the passes, and the dispatch size of each.

use super::passes::{DRAWN_POINTS, DRAWN_SHAPES, POINTS, Pass, Programs, Work};
use super::scratch::{Scratch, Sizes};
use crate::analysis::screen::constants::MAX_LEVELS;
use crate::render::gpu::recording::Recording;

/// Names of the passes in timings.
pub(in crate::render::gpu) const CULL_PASS: &str = "cull";
pub(in crate::render::gpu) const NORMALS_PASS: &str = "normals";

/// Points, and their shapes.
pub(super) const STREAMS: usize = 2;

/// State for recording the passes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Screened<'a> {
    pub(super) programs: &'a Programs,
    pub(super) scratch: &'a Scratch,
    /// All points.
    pub(super) points: &'a wgpu::Buffer,
    pub(super) sizes: &'a Sizes,
}

/// Separates visible points from hidden ones, and lists them.
pub(super) fn find_visible(recording: &mut Recording<'_>, screened: &Screened<'_>) {
    let Screened {
        programs,
        scratch,
        points,
        sizes,
    } = *screened;
    scratch.clear(recording, sizes);
    let context = recording.context;
    let mut pass = recording.begin_compute(CULL_PASS);
    let works = [
        (Pass::Draw, sizes.points),
        (Pass::Frame, sizes.bordered()),
        (Pass::Cull, sizes.points),
        (Pass::Scan, 1),
        (Pass::Compact, sizes.points),
    ];
    for (which, invocations) in works {
        let group = programs.group(context, which, |binding| match binding {
            POINTS => points,
            own => scratch.buffer(own),
        });
        let work = Work {
            uniform_offset: 0,
            invocations,
        };
        programs.dispatch(&mut pass, which, &group, work);
    }
}

/// Puts visible points into cells, fits planes and writes the records of each chunk into its buffers. Precondition:
/// `counts` belong to the chunks whose uniforms follow those of levels.
pub(super) fn write_surfels(
    recording: &mut Recording<'_>,
    screened: &Screened<'_>,
    record_buffers: &[[&wgpu::Buffer; STREAMS]],
    counts: &[u32],
) {
    let Screened {
        programs,
        scratch,
        points,
        sizes,
    } = *screened;
    let context = recording.context;
    let mut pass = recording.begin_compute(NORMALS_PASS);
    let choose = programs.group(context, Pass::Choose, |binding| scratch.buffer(binding));
    let work = Work {
        uniform_offset: 0,
        invocations: sizes.points,
    };
    programs.dispatch(&mut pass, Pass::Choose, &choose, work);
    let coarsen = programs.group(context, Pass::Coarsen, |binding| scratch.buffer(binding));
    for level in 0..=MAX_LEVELS {
        let work = Work {
            uniform_offset: scratch.uniform_offset(level),
            invocations: sizes.cells_of(level),
        };
        programs.dispatch(&mut pass, Pass::Coarsen, &coarsen, work);
    }
    for which in [Pass::Surface, Pass::Lend] {
        for (chunk, ([drawn_points, drawn_shapes], &count)) in (MAX_LEVELS + 1..).zip(record_buffers.iter().zip(counts))
        {
            let group = programs.group(context, which, |binding| match binding {
                POINTS => points,
                DRAWN_POINTS => drawn_points,
                DRAWN_SHAPES => drawn_shapes,
                own => scratch.buffer(own),
            });
            let work = Work {
                uniform_offset: scratch.uniform_offset(chunk),
                invocations: count,
            };
            programs.dispatch(&mut pass, which, &group, work);
        }
    }
}
