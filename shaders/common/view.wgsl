// The global bind group: the camera and the settings of one pass. Declared in render/gpu/gpu_data.rs, `ViewUniform`;
// constants shared with Rust are in render/gpu/constants.rs: both are turned into WGSL that is imported.

#import generated/constants
#import generated/view

@group(VIEW_GROUP) @binding(0) var<uniform> view: View;

// From the eye to a point of the frame, in the frame's axes. Subtracting the rounded eye first is exact near the eye.
fn offset_from_eye(position: vec3f) -> vec3f {
    return (position - view.eye_high) - view.eye_low;
}

// Rotates an offset from the eye into view space.
fn rotate_to_view(offset: vec3f) -> vec3f {
    return view.rotation_x.xyz * offset.x + view.rotation_y.xyz * offset.y + view.rotation_z.xyz * offset.z;
}

// The ray through a pixel, in view space, scaled to depth 1. `pixel` is @builtin(position).xy.
fn ray_through(pixel: vec2f) -> vec3f {
    let ndc = vec2f(2.0, -2.0) * pixel / view.viewport_px + vec2f(-1.0, 1.0) - view.center_ndc;
    return vec3f(ndc / view.focal, -1.0);
}

// Reverse-Z with the far plane at infinity: depth = near / distance.
fn project(position_in_view: vec3f) -> vec4f {
    let distance = -position_in_view.z;
    return vec4f(position_in_view.xy * view.focal + view.center_ndc * distance, view.near, distance);
}
