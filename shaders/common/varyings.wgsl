// Varyings of geometry passes in which records become quads of one colour.

#import common/light.wgsl
#import common/quads.wgsl
#import common/records.wgsl
#import common/view.wgsl

struct Varyings {
    @builtin(position) position: vec4f,
    // -1 to 1 across the quad, or across the disk in the triangle.
    @location(0) quad: vec2f,
    @location(1) light: vec2f,
    @location(2) @interpolate(flat) color: u32,
    // In view space. Unpacked here: a splat has four vertices and hundreds of fragments.
    @location(3) @interpolate(flat) normal: vec3f,
    // Factor on the mask of splats.
    @location(4) @interpolate(flat) weight: f32,
}

fn varyings(instance: Instance) -> Varyings {
    let vertex = amplified_vertex(instance);
    let normal = rotate_to_view(oct_decode(vertex.normal));
    let quad = corner_of(instance.vertex);
    return Varyings(vertex.clip, quad, unpack2x16unorm(vertex.light), vertex.color, normal, vertex.weight);
}

// The position of a fragment on its splat, in units of the half axes.
fn place_on_splat(in: Varyings) -> vec2f {
    return in.quad;
}

// All of a quad is on its surface, including the corners.
fn is_outside_surface(in: Varyings) -> bool {
    return false;
}

// Reversed.
fn depth_of(in: Varyings) -> f32 {
    return in.position.z;
}

fn albedo(in: Varyings) -> vec3f {
    return unpack4x8unorm(in.color).rgb;
}

fn shaded(in: Varyings) -> vec3f {
    return shade(albedo(in), in.normal, in.light, in.position.xy);
}
