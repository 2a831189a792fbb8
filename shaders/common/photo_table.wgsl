// What is common to the passes that ask photographs, and to those that read what these have said.

#import generated/constants

// Row 0 of `photo_table`: number of photographs, how many are blended, 1/σ², and PHOTO_* flags: what becomes of what
// they do not show. And in the first of its next texel: how wide gaps are that are closed, in pixels.
// Then a row for each photograph.

// What photographs say of a place.
struct PhotoAnswer {
    // Display-referred; of what they show alone.
    color: vec3f,
    // ANSWER_*.
    kind: f32,
    // In view space, of length 1, if it is not to be the points' own; else zero.
    normal: vec3f,
}

fn photo_flags() -> u32 {
    return u32(textureLoad(photo_table, vec2u(0u, 0u), 0).w);
}
