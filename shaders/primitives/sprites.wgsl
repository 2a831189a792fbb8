// A surfel is a screen-aligned square around its projection (Sainz and Pajarola 2004 §5.1). The position on its disk
// and the depth are computed per fragment: exact in every pixel, without interpolation between vertices on the disk.

#import common/facet.wgsl
#import common/fragments.wgsl
#import common/light.wgsl
#import common/quads.wgsl
#import common/records.wgsl
#import common/view.wgsl
#import generated/constants
#import primitives/splats.wgsl

struct Varyings {
    @builtin(position) position: vec4f,
    // The functions of the facet; the fourth component of W is the depth per unit of it.
    @location(0) @interpolate(flat) p: vec3f,
    @location(1) @interpolate(flat) q: vec3f,
    @location(2) @interpolate(flat) w: vec4f,
    @location(3) @interpolate(flat) light: vec2f,
    @location(4) @interpolate(flat) color: u32,
    // In view space.
    @location(5) @interpolate(flat) normal: vec3f,
    // Factor on the mask.
    @location(6) @interpolate(flat) weight: f32,
    // The pixel that contains the centre, and its reversed depth; 0 where it is not in front of the eye.
    @location(7) @interpolate(flat) midpoint: vec3f,
}

fn varyings(instance: Instance) -> Varyings {
    let point = fetch_point(instance);
    let shape = fetch_shape(instance);
    if (shape.radius == RADIUS_OF_NOTHING) {
        var nothing = Varyings();
        nothing.position = nowhere().clip;
        return nothing;
    }
    let n = oct_decode(shape.normal);
    let center = offset_from_eye(point.position);
    let splat = splat_of(n, shape, center);
    let seen = patch_of(
        rotate_to_view(center),
        rotate_to_view(splat.axes[0] * splat.scale),
        rotate_to_view(splat.axes[1] * splat.scale),
    );
    let facet = facet_of(seen);
    let slack = slack_of(splat, center);
    let clip = sprite_corner(seen, facet, slack, quad_corner(vertex_of_record(instance)));
    // The centre is the only vertex on the disk.
    let light = light_at_vertex(n, center, center);
    let color = side_color(point.color, dot(n, center));
    let w = vec4f(facet.w, facet.depth_per_w / slack);
    return Varyings(
        clip, facet.p, facet.q, w, light, color, rotate_to_view(n), splat.weight, center_of(seen),
    );
}

fn center_of(seen: Patch) -> vec3f {
    if (-seen.c.z < seen.near) {
        return vec3f(0.0);
    }
    let ndc = seen.c.xy / -seen.c.z * view.focal + view.center_ndc;
    return vec3f((0.5 + vec2f(0.5, -0.5) * ndc) * view.viewport_px, seen.near / -seen.c.z);
}

// A corner of the square at the nearest depth of the disk: no fragment is nearer, so that sprites behind other splats
// are rejected before shading.
fn sprite_corner(seen: Patch, facet: Facet, slack: f32, corner: vec2f) -> vec4f {
    let outline = outline_of(seen);
    let is_culled = view.back_faces == BACK_FACES_CULLED && faces_away(seen);
    let half_depth = -seen.c.z - outline.nearest;
    if (facet.depth_per_w == 0.0 || is_culled || half_depth - seen.c.z < seen.near) {
        // No area.
        return vec4f(0.0, 0.0, 0.0, 1.0);
    }
    var place = corner;
    if (!outline.is_around_eye) {
        let margin = 2.0 * SPRITE_MARGIN_PX / view.viewport_px;
        let min_value = view.clamp_radius_px / view.px_per_slope;
        let midpoint = seen.c.xy / -seen.c.z;
        let low = min(outline.low, midpoint - min_value);
        let high = max(outline.high, midpoint + min_value);
        let end = select(low, high, corner > vec2f(0.0));
        place = end * view.focal + view.center_ndc + corner * margin;
    }
    // Rounded towards the eye.
    let depth = SPRITE_NEARER * seen.near / (max(outline.nearest, 0.25 * seen.near) * slack);
    return vec4f(place, min(depth, 1.0), 1.0);
}

// The position of a fragment on its disk, in units of the half axes; outside it where the disk is nearer than the near
// plane, or behind the eye.
fn place_on_disk(in: Varyings) -> vec2f {
    let ray = ray_through(in.position.xy);
    let w = dot(in.w.xyz, ray);
    if (w <= 0.0 || w * in.w.w > 1.0) {
        return vec2f(2.0);
    }
    return vec2f(dot(in.p, ray), dot(in.q, ray)) / w;
}

// The position of a fragment on the minimum splat, whose radius is in pixels.
fn place_on_min_splat(in: Varyings) -> vec2f {
    if (view.clamp_radius_px == 0.0 || in.midpoint.z == 0.0) {
        return vec2f(2.0);
    }
    return (in.position.xy - in.midpoint.xy) / view.clamp_radius_px;
}

// Whether the minimum splat has more weight there than the disk.
fn is_on_min_splat(in: Varyings) -> bool {
    let on_disk = place_on_disk(in);
    let on_min = place_on_min_splat(in);
    return dot(on_min, on_min) < dot(on_disk, on_disk);
}

fn place_on_splat(in: Varyings) -> vec2f {
    return select(place_on_disk(in), place_on_min_splat(in), is_on_min_splat(in));
}

// Only the disk within the square is on the surface.
fn is_outside_surface(in: Varyings) -> bool {
    return is_outside_splat(in);
}

// Reversed. At most that of the square: the early depth test relies on no fragment being nearer.
fn depth_of(in: Varyings) -> f32 {
    let on_plane = dot(in.w.xyz, ray_through(in.position.xy)) * in.w.w;
    return min(select(on_plane, in.midpoint.z, is_on_min_splat(in)), in.position.z);
}

fn albedo(in: Varyings) -> vec3f {
    return unpack4x8unorm(in.color).rgb;
}

fn shaded(in: Varyings) -> vec3f {
    return shade(albedo(in), in.normal, in.light, in.position.xy);
}
