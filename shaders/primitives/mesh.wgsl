// A triangle is half a quad: the fourth corner repeats the third. A vertex that belongs to no triangle is the square of
// a point. So both are drawn by one call, in their order.

#import common/light.wgsl
#import common/linear.wgsl
#import common/quads.wgsl
#import common/records.wgsl
#import common/view.wgsl
#import fetch/indexed.wgsl
#import generated/constants

struct Varyings {
    @builtin(position) position: vec4f,
    // -1 to 1 across the square of a point.
    @location(0) quad: vec2f,
    @location(1) light: vec2f,
    @location(2) color: vec3f,
    // In view space, of any length; zero for points, which are unlit.
    @location(3) normal: vec3f,
    @location(4) texture_place: vec2f,
    @location(5) @interpolate(flat) texture: u32,
}

fn varyings(instance: Instance) -> Varyings {
    let triangle = fetch_triangle(instance);
    let corner = vertex_of_record(instance);
    let vertex = vertices[triangle.corners[min(corner, 2u)]];
    let offset = offset_from_eye(vertex.position);
    let color = unpack4x8unorm(vertex.color).rgb;
    var clip = project(rotate_to_view(offset));
    if (all(triangle.corners == triangle.corners.xxx)) {
        let quad = quad_corner(corner);
        clip += vec4f(quad * view.point_min_px / view.viewport_px * clip.w, 0.0, 0.0);
        return Varyings(clip, quad, vec2f(1.0, 0.0), color, vec3f(0.0), vec2f(0.0), NO_TEXTURE);
    }
    let face = oct_decode(triangle.normal);
    var normal = face;
    if (vertex.normal != NO_NORMAL) {
        normal = oct_decode(vertex.normal);
    }
    var lit_normal = normal;
    var center = offset;
    if (view.lighting == LIGHTING_PER_SURFEL) {
        lit_normal = face;
        center = center_from_eye(triangle.corners);
    }
    let light = light_at_vertex(lit_normal, center, offset);
    // The texture of the first corner: the others have the same.
    let texture = vertices[triangle.corners.x].texture;
    return Varyings(clip, vec2f(0.0), light, color, rotate_to_view(normal), vertex.texture_place, texture);
}

fn center_from_eye(corners: vec3u) -> vec3f {
    let a = offset_from_eye(vertices[corners.x].position);
    let b = offset_from_eye(vertices[corners.y].position);
    let c = offset_from_eye(vertices[corners.z].position);
    return (a + b + c) / 3.0;
}

// The texels along an axis on both sides of a coordinate, and the interpolation weight between them. A coordinate of 1
// is the size of the texture, beyond which it repeats.
fn between_texels(coordinate: f32, size: u32) -> vec3f {
    let last = f32(size) - 1.0;
    let at = fract(coordinate) * f32(size) - 0.5;
    let before = floor(at);
    let first = select(min(before, last), last, before < 0.0);
    return vec3f(first, select(0.0, first + 1.0, first < last), at - before);
}

fn texel(picture: TexturePlace, column: f32, row: f32) -> vec3f {
    return unpack4x8unorm(texels[picture.first + u32(row) * picture.width + u32(column)]).rgb;
}

// Display-referred, bilinear between the four texels around a position. Not a sampler: both renderers interpolate with
// the same arithmetic (`cloud/textures.rs`), without mip levels.
fn texture_color(picture: TexturePlace, place: vec2f) -> vec3f {
    let x = between_texels(place.x, picture.width);
    let y = between_texels(place.y, picture.height);
    let upper = mix(texel(picture, x.x, y.x), texel(picture, x.y, y.x), x.z);
    let lower = mix(texel(picture, x.x, y.y), texel(picture, x.y, y.y), x.z);
    return mix(upper, lower, y.z);
}

// Meshes contain no splats.
fn place_on_splat(in: Varyings) -> vec2f {
    return in.quad;
}

// Reversed.
fn depth_of(in: Varyings) -> f32 {
    return in.position.z;
}

fn albedo(in: Varyings) -> vec3f {
    if (in.texture == NO_TEXTURE) {
        return in.color;
    }
    let color = texture_color(texture_places[in.texture], in.texture_place);
    // Multiplied in linear light.
    return to_display(to_linear(color) * to_linear(in.color));
}

fn shaded(in: Varyings) -> vec3f {
    if (all(in.normal == vec3f(0.0))) {
        return albedo(in);
    }
    return shade(albedo(in), normalize(in.normal), in.light, in.position.xy);
}
