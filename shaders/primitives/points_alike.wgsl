// Nothing else is known of a point.

fn point_shape(instance: Instance) -> ShapeRecord {
    return ShapeRecord(0u, 0.0, 0u, 0.0);
}
