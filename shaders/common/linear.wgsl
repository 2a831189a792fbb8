// Conversion between display-referred channels and linear light by the curves of sRGB (IEC 61966-2-1).

fn to_linear(channels: vec3f) -> vec3f {
    let powers = pow((channels + 0.055) / 1.055, vec3f(2.4));
    return select(powers, channels / 12.92, channels <= vec3f(0.04045));
}

fn to_display(light: vec3f) -> vec3f {
    let powers = 1.055 * pow(light, vec3f(1.0 / 2.4)) - 0.055;
    return select(powers, light * 12.92, light <= vec3f(0.0031308));
}
