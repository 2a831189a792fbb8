// Gathers the candidates of a sequential point tree and marks those that are not drawn in a view. The rule is in
// levels/spheres/rule.rs. It is evaluated in single precision with an error bound, and where that is inconclusive, in
// emulated double precision, so that GPU and CPU select the same nodes (Shewchuk 1997).

#import common/f64.wgsl
#import generated/bindings
#import generated/constants

// Mirrors levels/spheres/filter.rs. Floats that are needed bit for bit.
struct NodeBounds {
    center: vec3u,
    sphere_radius: u32,
    axis: vec3u,
    cone_cosine: u32,
    radius: u32,
    level: u32,
    parent: u32,
    unused: u32,
}

@compute @workgroup_size(GROUP_RECORDS)
fn gather(@builtin(global_invocation_id) invocation: vec3u, @builtin(num_workgroups) groups: vec3u) {
    for (var place = invocation.x; place < filtering.count; place += groups.x * GROUP_RECORDS) {
        let candidate = filtering.first + place;
        let is_leaf = candidate >= filtering.inner_candidates;
        var name = candidate + 1u;
        if (is_leaf) {
            name = filtering.inners + (candidate - filtering.inner_candidates);
        }
        var record = nodes[name];
        if (filtering.marks == 1u && !is_drawn(name, is_leaf)) {
            record.y = bitcast<u32>(RADIUS_OF_NOTHING);
        }
        gathered[place] = record;
    }
}

fn is_drawn(name: u32, is_leaf: bool) -> bool {
    var parent = 0u;
    if (is_leaf) {
        parent = parents[name - filtering.inners];
    } else {
        if (node_class(bounds[name]) != NODE_CLASS_SMALL) {
            return false;
        }
        parent = bounds[name].parent;
    }
    return parent == 0u || node_class(bounds[parent]) == NODE_CLASS_DIVIDED;
}

fn node_class(node: NodeBounds) -> u32 {
    let rough = rough_node_class(node);
    if (rough != NODE_CLASS_OPEN) {
        return rough;
    }
    return exact_node_class(node);
}

fn has_cone(node: NodeBounds) -> bool {
    return bitcast<f32>(node.cone_cosine) != -1.0 && (filtering.is_oriented == 1u || filtering.culls_back_faces == 1u);
}

// The class as far as single precision determines it with certainty. Errors are a few units in the last place (6e-8) of
// the summed terms; square roots of numbers near 0 turn 6e-8 into 2.5e-4.
fn rough_node_class(node: NodeBounds) -> u32 {
    let center = bitcast<vec3f>(node.center);
    let radius = bitcast<f32>(node.sphere_radius);
    let to_eye = filtering.eye - center;
    let extent = max(max(abs(to_eye.x), max(abs(to_eye.y), abs(to_eye.z))), radius);
    if (!(extent > 1e-15 && extent < 1e15)) {
        return NODE_CLASS_OPEN;
    }
    var is_open = false;
    for (var side = 0u; side < 5u; side++) {
        let plane = filtering.planes[side];
        let terms = plane.xyz * center;
        let inside = terms.x + terms.y + terms.z + plane.w + radius;
        let error = 1e-5 * (abs(terms.x) + abs(terms.y) + abs(terms.z) + abs(plane.w) + radius);
        if (inside < -error) {
            return NODE_CLASS_DROPPED;
        }
        is_open = is_open || inside <= error;
    }
    let distance = length(to_eye);
    var seen_share = 1.0;
    var share_error = 0.0;
    if (has_cone(node) && distance > radius * 0.9999) {
        let cosine = dot(bitcast<vec3f>(node.axis), to_eye) / distance;
        let gamma = clamp(select(abs(cosine), cosine, filtering.culls_back_faces == 1u), -1.0, 1.0);
        let theta = bitcast<f32>(node.cone_cosine);
        let sine_of_beta = min(radius / distance, 1.0);
        let beta = sqrt(1.0 - sine_of_beta * sine_of_beta);
        let sine_of_theta = sqrt(max(1.0 - theta * theta, 0.0));
        let allowed = theta * beta - sine_of_theta * sine_of_beta;
        let sine_of_allowed = sine_of_theta * beta + theta * sine_of_beta;
        share_error = 0.005;
        if (gamma < allowed) {
            seen_share = gamma * allowed + sqrt(max(1.0 - gamma * gamma, 0.0)) * sine_of_allowed;
        }
        if (distance < radius * 1.0001) {
            return NODE_CLASS_OPEN;
        }
    }
    if (filtering.culls_back_faces == 1u && seen_share < share_error) {
        if (seen_share < -share_error) {
            return NODE_CLASS_DROPPED;
        }
        is_open = true;
    }
    if (is_open) {
        return NODE_CLASS_OPEN;
    }
    if (node.level >= filtering.deepest_level) {
        return NODE_CLASS_SMALL;
    }
    let from_sphere = distance - radius;
    if (!(from_sphere > 1e-3 * distance)) {
        return NODE_CLASS_OPEN;
    }
    let ratio = bitcast<f32>(node.radius) / from_sphere;
    let whole_px2 = filtering.rough_area_px2 * ratio * ratio;
    var size_px2 = whole_px2;
    var error = (2e-5 + 4e-6 * distance / from_sphere) * whole_px2;
    if (filtering.is_oriented == 1u) {
        size_px2 = max(seen_share, 0.0) * whole_px2;
        error += share_error * whole_px2;
    }
    if (!(whole_px2 < 1e30) || abs(size_px2 - filtering.rough_small_px2) <= error) {
        return NODE_CLASS_OPEN;
    }
    return select(NODE_CLASS_DIVIDED, NODE_CLASS_SMALL, size_px2 < filtering.rough_small_px2);
}

fn exact_node_class(node: NodeBounds) -> u32 {
    let one = vec2u(0u, 0x3ff00000u);
    let zero = vec2u(0u);
    let center = doubles(node.center);
    let radius = f64_of_f32(node.sphere_radius);
    let eye = doubles(bitcast<vec3u>(filtering.eye));
    let to_eye = array(difference(eye[0], center[0]), difference(eye[1], center[1]), difference(eye[2], center[2]));
    let distance = root(sum_of_products(to_eye, to_eye));
    var seen_share = one;
    if (has_cone(node) && !is_at_most(distance, radius)) {
        var gamma = quotient(sum_of_products(doubles(node.axis), to_eye), distance);
        if (filtering.culls_back_faces != 1u) {
            gamma = magnitude(gamma);
        }
        let theta = f64_of_f32(node.cone_cosine);
        let sine_of_beta = quotient(radius, distance);
        let beta = root(difference(one, product(sine_of_beta, sine_of_beta)));
        let sine_of_theta = root(difference(one, product(theta, theta)));
        let allowed = difference(product(theta, beta), product(sine_of_theta, sine_of_beta));
        let sine_of_allowed = sum(product(sine_of_theta, beta), product(theta, sine_of_beta));
        if (!is_at_most(allowed, gamma)) {
            var sine_squared = difference(one, product(gamma, gamma));
            if (is_negative(sine_squared)) {
                sine_squared = zero;
            }
            seen_share = sum(product(gamma, allowed), product(root(sine_squared), sine_of_allowed));
        }
    }
    if (filtering.culls_back_faces == 1u && is_at_most(seen_share, zero)) {
        return NODE_CLASS_DROPPED;
    }
    for (var side = 0u; side < 5u; side++) {
        let plane = bitcast<vec4u>(filtering.planes[side]);
        let inside = sum(sum_of_products(doubles(plane.xyz), center), f64_of_f32(plane.w));
        if (is_negative(sum(inside, radius))) {
            return NODE_CLASS_DROPPED;
        }
    }
    if (node.level >= filtering.deepest_level) {
        return NODE_CLASS_SMALL;
    }
    let from_sphere = difference(distance, radius);
    if (is_at_most(from_sphere, zero) || is_at_most(filtering.small_px2, zero)) {
        return NODE_CLASS_DIVIDED;
    }
    if (filtering.is_oriented != 1u) {
        seen_share = one;
    }
    if (is_negative(seen_share)) {
        seen_share = zero;
    }
    let ratio = quotient(f64_of_f32(node.radius), from_sphere);
    let size_px2 = product(product(seen_share, filtering.area_px2), product(ratio, ratio));
    return select(NODE_CLASS_DIVIDED, NODE_CLASS_SMALL, is_at_most(size_px2, filtering.small_px2));
}

fn doubles(bits: vec3u) -> array<vec2u, 3> {
    return array(f64_of_f32(bits.x), f64_of_f32(bits.y), f64_of_f32(bits.z));
}
