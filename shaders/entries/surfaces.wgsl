// Fragments write the inputs of deferred shading.

#import common/fragments.wgsl

@vertex
fn vertex(instance: Instance) -> Varyings {
    return varyings(instance);
}

@fragment
fn fragment(in: Varyings) -> Surface {
    return left(in);
}
