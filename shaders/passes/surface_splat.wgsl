// Splats for deferred shading: their contributions at the surface are summed up, or blended, by the masks. As in
// `splat.wgsl`, corners are not discarded.

#import common/fragments.wgsl
#import common/view.wgsl

fn left(in: Varyings) -> Surface {
    if (is_outside_surface(in)) {
        discard;
    }
    // Surfaces are two-sided: normals that are summed up must not cancel each other.
    let towards_eye = select(1.0, -1.0, dot(in.normal, ray_through(in.position.xy)) > 0.0);
    return surface(in, in.normal * towards_eye, mask_weight(place_on_splat(in)) * in.weight);
}
