// A point has a radius and a normal.

fn point_shape(instance: Instance) -> ShapeRecord {
    return fetch_shape(instance);
}
