// A surfel is one quad in its plane, or one triangle.

#import common/light.wgsl
#import common/quads.wgsl
#import common/records.wgsl
#import common/view.wgsl
#import generated/constants
#import primitives/splats.wgsl

fn amplified_vertex(instance: Instance) -> SplatVertex {
    return surfel_vertex(fetch_point(instance), fetch_shape(instance), vertex_of_record(instance));
}

fn may_be_seen(instance: Instance) -> bool {
    let point = fetch_point(instance);
    let shape = fetch_shape(instance);
    if (shape.radius == RADIUS_OF_NOTHING) {
        return false;
    }
    let splat = splat_of(oct_decode(shape.normal), shape, offset_from_eye(point.position));
    let reach = SQUARE_REACH_RADII * splat.reach;
    return surfel_may_face_eye(point, shape, reach) && sphere_may_be_seen(point.position, reach);
}

fn surfel_vertex(point: PointRecord, shape: ShapeRecord, corner: u32) -> SplatVertex {
    if (shape.radius == RADIUS_OF_NOTHING) {
        return nowhere();
    }
    let n = oct_decode(shape.normal);
    let q = corner_of(corner);
    let center = offset_from_eye(point.position);
    let splat = splat_of(n, shape, center);
    let offset = center + (splat.axes[0] * q.x + splat.axes[1] * q.y) * splat.scale;
    var clip = project(rotate_to_view(offset));
    clip.z /= slack_of(splat, center);
    let color = side_color(point.color, dot(n, center));
    let light = light_at_vertex(n, center, offset);
    return SplatVertex(clip, color, shape.normal, pack2x16unorm(light), splat.weight);
}

// Back-face culling: true unless the whole surfel faces away. Errs on the side of true: the rasteriser decides, and may
// flip a surfel of about one pixel that is seen nearly edge-on. It snaps corners to a grid, of 1/16 pixel on the
// coarsest adapters: half a cell along both axes changes the area of a triangle as if the disk were 0.08 pixels thicker
// or thinner.
fn surfel_may_face_eye(point: PointRecord, shape: ShapeRecord, reach: f32) -> bool {
    let to_eye = -offset_from_eye(point.position);
    let distance = length(to_eye);
    let facing = dot(oct_decode(shape.normal), to_eye);
    let px_per_slope = min(view.px_per_slope.x, view.px_per_slope.y);
    // The projected thickness of the disk at its farthest, compared with 1/8 pixel.
    let is_thin = -facing * reach * px_per_slope < 0.125 * SQUARE_REACH_RADII * distance * (distance + reach);
    return view.back_faces != BACK_FACES_CULLED || facing > -1e-3 * distance || is_thin;
}
