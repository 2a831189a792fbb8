// Shared by the passes that sample input images and those that read the results.

#import generated/constants

// Row 0 of `photo_table`: number of images, how many are blended, 1/σ², and PHOTO_* flags, which set how surfaces that
// no image shows are drawn. The first component of its next texel: the width of the gaps that are closed, in pixels.
// Then one row per image.

// The images' result at a position.
struct PhotoAnswer {
    // Display-referred; blended from the images alone.
    color: vec3f,
    // ANSWER_*.
    kind: f32,
    // In view space, unit length, if it replaces the points' own normal; else zero.
    normal: vec3f,
}

fn photo_flags() -> u32 {
    return u32(textureLoad(photo_table, vec2u(0u, 0u), 0).w);
}
