// A triangle is half a quad: the fourth corner is the third once more. A vertex that belongs to no triangle is the
// square of a point. So both are drawn by one call, in their order.

struct Varyings {
    @builtin(position) position: vec4f,
    // -1 to 1 across the square of a point.
    @location(0) quad: vec2f,
    @location(1) light: vec2f,
    @location(2) color: vec3f,
    // In view space, of any length; zero for points, which get no light.
    @location(3) normal: vec3f,
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
        clip += vec4f(quad * max(view.point_size_px, 1.0) / view.viewport_px * clip.w, 0.0, 0.0);
        return Varyings(clip, quad, vec2f(1.0, 0.0), color, vec3f(0.0));
    }
    let face = oct_decode(triangle.normal);
    var normal = face;
    if (vertex.normal != NO_NORMAL) {
        normal = oct_decode(vertex.normal);
    }
    var lit_normal = normal;
    var middle = offset;
    if (view.lighting == LIGHTING_PER_SURFEL) {
        lit_normal = face;
        middle = middle_from_eye(triangle.corners);
    }
    let light = light_at_vertex(lit_normal, middle, offset);
    return Varyings(clip, vec2f(0.0), light, color, rotate_to_view(normal));
}

fn middle_from_eye(corners: vec3u) -> vec3f {
    let a = offset_from_eye(vertices[corners.x].position);
    let b = offset_from_eye(vertices[corners.y].position);
    let c = offset_from_eye(vertices[corners.z].position);
    return (a + b + c) / 3.0;
}

fn albedo(in: Varyings) -> vec3f {
    return in.color;
}

fn shaded(in: Varyings) -> vec3f {
    if (all(in.normal == vec3f(0.0))) {
        return albedo(in);
    }
    return shade(albedo(in), normalize(in.normal), in.light, in.position.xy);
}
