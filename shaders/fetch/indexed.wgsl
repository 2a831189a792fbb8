// Meshes, for all strategies: the vertex stage pulls triangles by index, and the vertices that they refer to.

#import generated/amplification
#import generated/constants

// Mirrors cloud/record.rs.
struct TriangleRecord {
    // Three times the same vertex means a point.
    corners: vec3u,
    // Octahedral unit normal of the face, snorm16 x 2.
    normal: u32,
}

struct VertexRecord {
    position: vec3f,
    // 8-bit red, green, blue, alpha.
    color: u32,
    texture_place: vec2f,
    // Octahedral unit normal, or NO_NORMAL.
    normal: u32,
    // Index of its texture, or NO_TEXTURE.
    texture: u32,
}

// Mirrors cloud/textures.rs.
struct TexturePlace {
    first: u32,
    width: u32,
    height: u32,
    unused: u32,
}

@group(STREAM_GROUP) @binding(0) var<storage, read> triangles: array<TriangleRecord>;
@group(STREAM_GROUP) @binding(1) var<storage, read> vertices: array<VertexRecord>;
// 8-bit red, green, blue, alpha.
@group(STREAM_GROUP) @binding(2) var<storage, read> texels: array<u32>;
@group(STREAM_GROUP) @binding(3) var<storage, read> texture_places: array<TexturePlace>;

struct Instance {
    @builtin(vertex_index) vertex: u32,
}

fn fetch_triangle(instance: Instance) -> TriangleRecord {
    return triangles[instance.vertex / VERTICES_PER_RECORD];
}

fn vertex_of_record(instance: Instance) -> u32 {
    return instance.vertex % VERTICES_PER_RECORD;
}
