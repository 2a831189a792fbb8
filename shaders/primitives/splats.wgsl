// Surfels in their planes, independent of how they are drawn on the screen.

#import common/records.wgsl
#import common/view.wgsl
#import generated/constants
#import primitives/filtered_by_ewa.wgsl

// A surfel in its plane.
struct Splat {
    // Half axes, to be multiplied by the radius of the surfel.
    axes: mat2x3f,
    scale: f32,
    // Quadratic mean of the half axes: nothing of the ellipse is farther away than √2 times that, whether the axes are
    // orthogonal or not.
    reach: f32,
    // Factor on the mask.
    weight: f32,
}

fn splat_of(n: vec3f, shape: ShapeRecord, center: vec3f) -> Splat {
    let radius = shape.radius * view.splat_scale;
    let splat = Splat(half_axes(n, shape.ellipse), radius, radius, 1.0);
    if (view.filter_radius_px > 0.0) {
        return filtered(splat, center);
    }
    return splat;
}

// ε-z: the divisor of the reversed depths of a splat. Only depths move away along the ray, the footprint stays (with
// one factor per surfel it stays planar).
fn slack_of(splat: Splat, center: vec3f) -> f32 {
    let length_of_px = -rotate_to_view(center).z / view.px_per_slope.x;
    let slack = view.depth_slack * splat.scale + view.depth_slack_px * length_of_px;
    return 1.0 + slack / max(length(center), view.near);
}

// The colour of the visible side of a surfel: the back where the normal points away.
fn side_color(color: u32, away: f32) -> u32 {
    if (view.back_faces == BACK_FACES_DARKER && away > 0.0) {
        return pack4x8unorm(unpack4x8unorm(color) * vec4f(vec3f(BACK_SIDE), 1.0));
    }
    return color;
}
