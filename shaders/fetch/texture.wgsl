// Strategy `texture`: a record is one rgba32uint texel; rows are as wide as the texture.

#import common/records.wgsl
#import generated/amplification
#import generated/constants

@group(STREAM_GROUP) @binding(0) var points: texture_2d<u32>;
@group(SHAPE_GROUP) @binding(0) var shapes: texture_2d<u32>;

struct Instance {
    @builtin(vertex_index) vertex: u32,
}

fn texel(width: u32, index: u32) -> vec2u {
    return vec2u(index % width, index / width);
}

fn fetch_point(instance: Instance) -> PointRecord {
    let index = instance.vertex / VERTICES_PER_RECORD;
    let bits = textureLoad(points, texel(textureDimensions(points).x, index), 0);
    return PointRecord(bitcast<vec3f>(bits.xyz), bits.w);
}

fn fetch_shape(instance: Instance) -> ShapeRecord {
    let index = instance.vertex / VERTICES_PER_RECORD;
    let bits = textureLoad(shapes, texel(textureDimensions(shapes).x, index), 0);
    return ShapeRecord(bits.x, bitcast<f32>(bits.y), bits.z, bitcast<f32>(bits.w));
}

fn vertex_of_record(instance: Instance) -> u32 {
    return instance.vertex % VERTICES_PER_RECORD;
}
