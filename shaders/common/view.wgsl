// The global bind group: the camera and the settings of one pass. Mirror: render/gpu/gpu_data.rs, `ViewUniform`.
// Constants that Rust knows too are not written in WGSL, but before it: render/gpu/constants.rs.

// A light beside that from the eye; black ones are none.
struct Lamp {
    // In view space: where it is (the fourth is 1), or from which direction it shines (0).
    place: vec4f,
    // Linear.
    color: vec4f,
}

struct View {
    // Columns of the rotation from the frame's space into view space (right, up, backward).
    rotation_x: vec4f,
    rotation_y: vec4f,
    rotation_z: vec4f,
    // The eye in the frame's space is `eye_high + eye_low`.
    eye_high: vec3f,
    // Factor on the splat radius in this pass.
    splat_scale: f32,
    eye_low: vec3f,
    // Distance to the near plane.
    near: f32,
    // Cotangents of half the field of view, horizontal and vertical.
    focal: vec2f,
    viewport_px: vec2f,
    background_top: vec3f,
    // Summed weight from which a pixel hides the background.
    opaque_weight: f32,
    background_bottom: vec3f,
    // How wide rims are at most through which others shine; 0: none.
    rim_px: f32,
    // View distances drawn white and black in the picture of the visibility pass.
    depth_range: vec2f,
    // Edge of a drawn point at least.
    point_least_px: f32,
    // Half the edge of the octree's cube.
    cube_half_edge: f32,
    // How far the visibility pass and the shadow map are pushed back, in splat radii.
    depth_slack: f32,
    // LIGHTING_*, or without light.
    lighting: u32,
    // BACK_FACES_*, or drawn as fronts are.
    back_faces: u32,
    // Between two lines on the ground, scene units.
    ground_spacing: f32,
    // Where the view axis meets the picture: 0, but for a part of a larger one.
    center_ndc: vec2f,
    // How far the neighbours of eye-dome lighting are, straight and on diagonals.
    eye_dome_reach_px: vec2i,
    // Its gains straight and on diagonals, what a step adds at most, and the darkness of edges.
    eye_dome: vec4f,
    // The plane with lines, in view space: its normal, and how far along that it is from the eye.
    ground_normal: vec4f,
    // Two directions across the lines, and how far along each the point is where two of them cross.
    ground_right: vec4f,
    ground_forward: vec4f,
    // Of lines; the fourth: how far from that point they are seen, scene units.
    ground_color: vec4f,
    // Of deferred shading: light from all sides and from the eye, and how white highlights are.
    ambient: f32,
    head_light: f32,
    specular: f32,
    // How far away the middle of the cloud is: the unit of distances that half floats hold.
    usual_distance: f32,
    // How far it is pushed back beyond that, for splats that are filtered to the pixels.
    depth_slack_px: f32,
    // Radius of the splat that a point becomes by that filter; 0 where there is none.
    filter_radius_px: f32,
    // KERNEL_*, or Gaussian.
    kernel: u32,
    // Pixels that are drawn for one that is shown, along both edges of the picture.
    samples_per_edge: f32,
    // Of ambient occlusion: the radius of the ball at the near plane, the largest one, and how much it darkens, 0 where
    // there is none.
    occlusion_near_radius_px: f32,
    occlusion_most_radius_px: f32,
    occlusion_strength: f32,
    // Edge of a texel of the shadow map in the middle of the cloud, scene units; 0 where there are no shadows.
    shadow_texel: f32,
    // Pixels for a slope of 1, to the right and upwards.
    px_per_slope: vec2f,
    // Edge of a drawn point, scene units, and what is added for each unit of its radius.
    point_edge: f32,
    point_edge_per_radius: f32,
    lamps: array<Lamp, MOST_LAMPS>,
    // Rows of the matrix from view space into that of the first lamp, which the shadow map is drawn in.
    lamp_from_view_x: vec4f,
    lamp_from_view_y: vec4f,
    lamp_from_view_z: vec4f,
    // Cotangent of half the field of view of that lamp, and its distance to the near plane.
    shadow_focal: f32,
    shadow_near: f32,
    // Of physical shading: how much of a metal surfaces are, the square of their roughness, and means of the curve of
    // what is lost and let in.
    metallic: f32,
    alpha: f32,
    mean_loss: f32,
    mean_let_in: f32,
    // Factor on the texels of the environment.
    environment_light: f32,
    // Radius of the least splat that sprites are, in pixels; 0 where there is none.
    clamp_radius_px: f32,
    // Columns of the rotation from view space into the axes of the environment.
    environment_from_view_x: vec4f,
    environment_from_view_y: vec4f,
    environment_from_view_z: vec4f,
    // What matt surfaces send back of it, as a polynomial of their normal.
    harmonics: array<vec4f, 9>,
}

@group(VIEW_GROUP) @binding(0) var<uniform> view: View;

// From the eye to a point of the frame, in the frame's axes. Subtracting the rounded eye first is exact near the eye.
fn offset_from_eye(position: vec3f) -> vec3f {
    return (position - view.eye_high) - view.eye_low;
}

// Rotates an offset from the eye into view space.
fn rotate_to_view(offset: vec3f) -> vec3f {
    return view.rotation_x.xyz * offset.x + view.rotation_y.xyz * offset.y + view.rotation_z.xyz * offset.z;
}

// The ray through a pixel, in view space: as long as makes its depth 1. `pixel` is @builtin(position).xy.
fn ray_through(pixel: vec2f) -> vec3f {
    let ndc = vec2f(2.0, -2.0) * pixel / view.viewport_px + vec2f(-1.0, 1.0) - view.center_ndc;
    return vec3f(ndc / view.focal, -1.0);
}

// Reverse-Z with the far plane at infinity: depth = near / distance.
fn project(position_in_view: vec3f) -> vec4f {
    let distance = -position_in_view.z;
    return vec4f(position_in_view.xy * view.focal + view.center_ndc * distance, view.near, distance);
}
