// The two 16-byte streams of a cloud. Mirrors cloud/record.rs.

struct PointRecord {
    position: vec3f,
    // Points: 8-bit red, green, blue, alpha. Voxels: red, green, blue, octree level.
    color: u32,
}

struct ShapeRecord {
    // Octahedral unit normal, snorm16 x 2.
    normal: u32,
    radius: f32,
    ellipse: u32,
    scalar: f32,
}

// Unfolds the octahedron (Meyer et al. 2010).
fn oct_decode(packed: u32) -> vec3f {
    let folded = unpack2x16snorm(packed);
    var unit = vec3f(folded, 1.0 - abs(folded.x) - abs(folded.y));
    if (unit.z < 0.0) {
        let sign = select(vec2f(-1.0), vec2f(1.0), folded >= vec2f(0.0));
        unit = vec3f((1.0 - abs(folded.yx)) * sign, unit.z);
    }
    return normalize(unit);
}
