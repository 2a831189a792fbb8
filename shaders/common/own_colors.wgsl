// Surfaces have the colours and normals of their points.

fn surface_at(own: vec3f, place: vec3f, normal: vec3f) -> Surface {
    return Surface(own, 1.0, normal);
}
