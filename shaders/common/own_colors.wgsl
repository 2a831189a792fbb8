// Surfaces take the colours and normals of their points.

#import common/blended_surface.wgsl

fn surface_at(blended: BlendedSurface, pixel: vec2u) -> Surface {
    return Surface(blended.color, 1.0, blended.normal);
}
