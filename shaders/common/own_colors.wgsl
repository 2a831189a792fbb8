// Surfaces have the colours of their points.

fn surface_color(own: vec3f, place: vec3f, normal: vec3f) -> vec4f {
    return vec4f(own, 1.0);
}
