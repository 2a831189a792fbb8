// A headlight: it shines from the eye, so that every visible surface is lit (the 4D media paper §V-B: per instance, per
// vertex or per fragment).

#import common/view.wgsl
#import generated/constants

// The exponent computed by the multiplications below.
const_assert HEADLIGHT_SHININESS == 3u * 8u;

// x: factor on the colour; y: white added by the highlight. `to_eye` need not have unit length.
fn headlight(normal: vec3f, to_eye: vec3f) -> vec2f {
    // Light and eye share a direction, so the half vector is that direction too.
    let facing = abs(dot(normal, normalize(to_eye)));
    let facing2 = facing * facing;
    let facing4 = facing2 * facing2;
    let facing8 = facing4 * facing4;
    return vec2f(
        HEADLIGHT_AMBIENT + (1.0 - HEADLIGHT_AMBIENT) * facing,
        HEADLIGHT_SPECULAR * facing8 * facing8 * facing8,
    );
}

// All vectors are in the same axes.
fn light_at_vertex(normal: vec3f, center_from_eye: vec3f, corner_from_eye: vec3f) -> vec2f {
    switch view.lighting {
        case LIGHTING_PER_SURFEL: { return headlight(normal, -center_from_eye); }
        case LIGHTING_PER_VERTEX: { return headlight(normal, -corner_from_eye); }
        default: { return vec2f(1.0, 0.0); }
    }
}

// The colour of a pixel. `normal` is in view space; `pixel` is @builtin(position).xy.
fn shade(color: vec3f, normal: vec3f, light: vec2f, pixel: vec2f) -> vec3f {
    var factors = light;
    if (view.lighting == LIGHTING_PER_FRAGMENT) {
        factors = headlight(normal, -ray_through(pixel));
    }
    return min(color * factors.x + factors.y, vec3f(1.0));
}
