// Pixels of less than full confidence take the rest from the interpolated next coarser level (Gortler et al. 1996,
// §3.5): blending adds exactly the missing fraction. The centre of a pixel is a quarter of a coarser pixel away from
// the centre of the coarser pixel that contains it, towards one neighbour on each axis.

#import common/fullscreen.wgsl

@fragment
fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let pixel = vec2i(position.xy);
    let last = vec2i(textureDimensions(coarser)) - 1;
    let own = pixel / 2;
    let neighbor = clamp(own + 2 * (pixel & vec2i(1)) - 1, vec2i(0), last);
    let across = 0.75 * textureLoad(coarser, own, 0) + 0.25 * textureLoad(coarser, vec2i(neighbor.x, own.y), 0);
    let across_neighbor = 0.75 * textureLoad(coarser, vec2i(own.x, neighbor.y), 0)
        + 0.25 * textureLoad(coarser, neighbor, 0);
    return 0.75 * across + 0.25 * across_neighbor;
}
