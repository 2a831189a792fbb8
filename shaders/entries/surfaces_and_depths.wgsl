// Fragments write the inputs of deferred shading and their own depth.

#import common/fragments.wgsl

@vertex
fn vertex(instance: Instance) -> Varyings {
    return varyings(instance);
}

struct SurfaceAtDepth {
    @location(0) color: vec4f,
    @location(1) normal: vec4f,
    @location(2) nearness: vec4f,
    @builtin(frag_depth) depth: f32,
}

@fragment
fn fragment(in: Varyings) -> SurfaceAtDepth {
    let surface = left(in);
    return SurfaceAtDepth(surface.color, surface.normal, surface.nearness, depth_of(in));
}
