// A byte code in one buffer, and its decoding. Mirrors levels/octree/coded.

#import common/records.wgsl
#import generated/bindings
#import generated/constants
#import generated/coded

struct Found {
    // Nodes in the queue of a level, by turns.
    queued: array<u32, 2>,
    // Nodes that are drawn.
    drawn: u32,
    unused: u32,
}

struct DispatchIndirect {
    groups: vec3u,
    unused: u32,
}

// A node, packed: its number, and its cell, whose first coordinate has the level above its bits.
fn number_of(node: vec4u) -> u32 {
    return node.x;
}

fn level_of(node: vec4u) -> u32 {
    return node.y >> CELL_BITS;
}

fn cell_of(node: vec4u) -> vec3u {
    return vec3u(node.y & ((1u << CELL_BITS) - 1u), node.z, node.w);
}

fn child_of(node: vec4u, octant: u32, number: u32) -> vec4u {
    let cell = 2u * cell_of(node) + ((vec3u(octant) >> vec3u(0u, 1u, 2u)) & vec3u(1u));
    return vec4u(number, cell.x | ((level_of(node) + 1u) << CELL_BITS), cell.y, cell.z);
}

// Occupied octants of a node above the leaves.
fn mask_of(number: u32) -> u32 {
    return (code[number / 4u] >> (8u * (number % 4u))) & 0xffu;
}

// The number of its first child: one more than the bits before its mask.
fn first_child(number: u32) -> u32 {
    let group = number / RANK_MASKS;
    let last = number / 4u;
    var before = code[expanding.ranks_start + group];
    for (var word = group * (RANK_MASKS / 4u); word < last; word++) {
        before += countOneBits(code[word]);
    }
    before += countOneBits(code[last] & ((1u << (8u * (number % 4u))) - 1u));
    return 1u + before;
}

fn edge_of_level(level: u32) -> f32 {
    // An exact power of two.
    return expanding.cube_edge * bitcast<f32>((127u - level) << 23u);
}

fn center_of(node: vec4u) -> vec3f {
    return expanding.cube_min + (vec3f(cell_of(node)) + 0.5) * edge_of_level(level_of(node));
}

// Words of the attributes of a node: shape, then colour and cone.
fn attributes_of(number: u32) -> vec2u {
    let word = expanding.attributes_start + 2u * number;
    return vec2u(code[word], code[word + 1u]);
}

// In cell edges.
fn radius_edges(attributes: vec2u) -> f32 {
    return bitcast<f32>(tables[(attributes.x >> RADIUS_SHIFT) & 0xffu].x);
}

// Sine and cosine of the half angle of the normal cone, with its slack.
fn cone_of(attributes: vec2u) -> vec2f {
    return bitcast<vec2f>(tables[attributes.y >> 24u].yz);
}

// A normal, and the same as records have it.
fn normal_of(attributes: vec2u) -> vec4u {
    return tables[TABLE_CODES + ((attributes.x & NORMAL_MASK) >> expanding.normal_shift)];
}

// From the centre along the normal, in cell edges.
fn offset_edges(attributes: vec2u) -> f32 {
    let offset = (attributes.x >> OFFSET_SHIFT) & 7u;
    return expanding.offsets[offset / 4u][offset % 4u];
}
