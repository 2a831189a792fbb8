// Strategy `compute`: the corners were written by passes/amplify.wgsl; the vertex stage only passes them on.

#import common/quads.wgsl
#import generated/constants

@group(STREAM_GROUP) @binding(0) var<storage, read> amplified: array<SplatVertex>;

struct Instance {
    @builtin(vertex_index) vertex: u32,
}

fn amplified_vertex(instance: Instance) -> SplatVertex {
    return amplified[instance.vertex];
}
