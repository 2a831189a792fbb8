//! The programs that draw from byte codes: entry points of one shader, each with its bindings.

use crate::cloud::oct_encode;
use crate::levels::octree::coded::{CodeView, LARGEST_OFFSET, NORMAL_MASK, OFFSET_SHIFT, RADIUS_SHIFT, RANK_MASKS};
use crate::render::gpu::compute::{BufferRow, ComputeShader, EntryRow};
use crate::render::gpu::constants::declaration;
use crate::render::gpu::gpu_data::Expanding;
use crate::render::gpu::layout::Shared;
use crate::render::gpu::wgsl::shader_file;

/// The byte code: masks, the numbers of bits before some of these, and attributes.
pub(super) const CODE: u32 = 1;
/// Values of the codes of attributes, then the normals ([`tables`]).
pub(super) const TABLES: u32 = 2;
/// The nodes of a level that may be seen.
pub(super) const QUEUE: u32 = 3;
/// The nodes of the next level.
pub(super) const NEXT_QUEUE: u32 = 4;
/// Number of drawn nodes and of children of each node of the queue, and of those before it in the workgroup.
pub(super) const PLACES: u32 = 5;
/// Drawn nodes and children of each workgroup, then those of all workgroups before it.
pub(super) const SUMS: u32 = 6;
/// Results over all nodes (`Found`).
pub(super) const FOUND: u32 = 7;
/// Sizes of the dispatches over a queue, by turns.
pub(super) const GROUPS: u32 = 8;
/// The drawn nodes.
pub(super) const DRAWN_NODES: u32 = 9;
/// Output points to draw.
pub(super) const DRAWN_POINTS: u32 = 10;
/// Output shapes to draw.
pub(super) const DRAWN_SHAPES: u32 = 11;

const BUFFERS: [BufferRow; 11] = [
    BufferRow::read(CODE, "code", "array<u32>"),
    BufferRow::read(TABLES, "tables", "array<vec4u>"),
    BufferRow::read(QUEUE, "queue", "array<vec4u>"),
    BufferRow::read_write(NEXT_QUEUE, "next_queue", "array<vec4u>"),
    BufferRow::read_write(PLACES, "places", "array<vec2u>"),
    BufferRow::read_write(SUMS, "sums", "array<vec2u>"),
    BufferRow::read_write(FOUND, "found", "Found"),
    BufferRow::read_write(GROUPS, "groups", "array<DispatchIndirect, 2>"),
    BufferRow::read_write(DRAWN_NODES, "drawn_nodes", "array<vec4u>"),
    BufferRow::read_write(DRAWN_POINTS, "drawn_points", "array<PointRecord>"),
    BufferRow::read_write(DRAWN_SHAPES, "drawn_shapes", "array<ShapeRecord>"),
];

/// An entry point.
#[derive(Debug, Clone, Copy)]
pub(super) enum Pass {
    Begin,
    Classify,
    Scan,
    Divide,
    Write,
}

/// In the order of [`Pass`].
const ROWS: [EntryRow; 5] = [
    EntryRow {
        entry: "begin",
        file: shader_file!("coded/expand.wgsl"),
        buffers: &[NEXT_QUEUE, FOUND, GROUPS],
    },
    EntryRow {
        entry: "classify",
        file: shader_file!("coded/expand.wgsl"),
        buffers: &[CODE, TABLES, QUEUE, PLACES, SUMS, FOUND],
    },
    EntryRow {
        entry: "scan",
        file: shader_file!("coded/expand.wgsl"),
        buffers: &[SUMS, FOUND, GROUPS],
    },
    EntryRow {
        entry: "divide",
        file: shader_file!("coded/expand.wgsl"),
        buffers: &[CODE, QUEUE, NEXT_QUEUE, PLACES, SUMS, FOUND, DRAWN_NODES],
    },
    EntryRow {
        entry: "write",
        file: shader_file!("coded/write.wgsl"),
        buffers: &[CODE, TABLES, FOUND, DRAWN_NODES, DRAWN_POINTS, DRAWN_SHAPES],
    },
];

/// All of them.
pub(in crate::render::gpu) const SHADER: ComputeShader = ComputeShader {
    label: "byte code",
    rows: &ROWS,
    given: &[("generated/coded", constants)],
    uniform: ("expanding", &Expanding::LAYOUT),
    buffers: &BUFFERS,
};

/// Codes of radii and of cones, which have one table.
const TABLE_CODES: u32 = 256;

/// Bits of a coordinate of a cell, more than the deepest level has: the level is above them.
const CELL_BITS: u32 = 24;

fn constants() -> String {
    [
        declaration("CELL_BITS", CELL_BITS),
        declaration("LARGEST_OFFSET", LARGEST_OFFSET),
        declaration("NORMAL_MASK", NORMAL_MASK),
        declaration("OFFSET_SHIFT", OFFSET_SHIFT),
        declaration("RADIUS_SHIFT", RADIUS_SHIFT),
        declaration("RANK_MASKS", RANK_MASKS as u32),
        declaration("TABLE_CODES", TABLE_CODES),
    ]
    .join("\n")
}

/// Words of the tables: radius, sine and cosine of the cone with its slack, by code; then normals, as vectors and as
/// records have them, by index. A GPU's own functions of angles are off by 2⁻¹¹.
pub(super) fn tables(view: &CodeView) -> Vec<[u32; 4]> {
    let codes = view.code_values();
    let of_code = codes.map(|[radius, sine, cosine]| [radius, sine, cosine, 0.0].map(f32::to_bits));
    let normals = view.normals().iter().map(|&normal| {
        let [x, y, z] = normal.to_array().map(f32::to_bits);
        [x, y, z, bytemuck::cast(oct_encode(normal))]
    });
    of_code.chain(normals).collect()
}
