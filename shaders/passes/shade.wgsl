// Deferred shading (Hofer et al. 2018 §3.6): lights the blended surface once per pixel. Writes sums of lit colours and
// weights, like the attribute pass when there is no shading. Lighting: `blinn_phong.wgsl`, `physical.wgsl`. Colours and
// normals: `own_colors.wgsl`, `textured.wgsl`.

#import common/blended_surface.wgsl
#import common/fullscreen.wgsl
#import common/linear.wgsl
#import effects/ambient_occlusion.wgsl

// The surface to be lit.
struct Surface {
    // Display-referred.
    color: vec3f,
    // A factor on its opacity.
    opacity: f32,
    // Towards the eye, unit length; zero where unknown: it is then left unlit.
    normal: vec3f,
}

@fragment
fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let blended = blended_surface(position.xy);
    if (blended.weight == 0.0) {
        return vec4f(0.0);
    }
    let pixel = vec2u(position.xy);
    let surface = surface_at(blended, pixel);
    if (surface.opacity == 0.0 || all(surface.normal == vec3f(0.0))) {
        return vec4f(surface.color, 1.0) * (blended.weight * surface.opacity);
    }
    let open = openness(depths, vec2i(pixel), surface.normal);
    let light = lit(to_linear(surface.color), blended.place, surface.normal, blended.to_eye, open);
    // Encoded again, and as a sum again: blending with the background stays display-referred, so edges do not depend on
    // the lighting, and resolve, eye-dome lighting and transparent backgrounds work as they do without shading.
    return vec4f(to_display(min(light, vec3f(1.0))), 1.0) * (blended.weight * surface.opacity);
}
