// Planes fitted to the neighbours of points on the screen, and the records that are drawn. Twin of
// analysis/screen/planes.rs.

#import common/oct_encode.wgsl
#import common/smallest_eigenvector.wgsl
#import screen_normals/cells.wgsl
#import screen_normals/view.wgsl

// The neighbours of a point within a radius.
struct Neighbourhood {
    radius: f32,
    // How many cells contain a neighbour.
    found: f32,
    // The total number of points.
    points: f32,
    covariance: Symmetric,
}

// Writes the records of a range of visible points, and empty records after the last one.
@compute @workgroup_size(GROUP_RECORDS)
fn surface(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= screening.count) {
        return;
    }
    let place = screening.first + id.x;
    if (place >= found.visible) {
        drawn_points[id.x] = PointRecord(vec3f(0.0), 0u);
        drawn_shapes[id.x] = ShapeRecord(0u, RADIUS_OF_NOTHING, 0u, 0.0);
        return;
    }
    let seen = seen_from_eye(seen_points[place].xyz);
    var radius = radius_px_at(seen.depth) * seen.depth / px_per_unit();
    var around = neighbourhood(seen, radius, 1u);
    for (var doubling = 0u; doubling < MAX_DOUBLINGS; doubling++) {
        if (around.found >= MIN_NEIGHBOURS && is_plane(around)) {
            break;
        }
        radius *= 2.0;
        around = neighbourhood(seen, radius, WIDE_WINDOW);
    }
    drawn_points[id.x] = points[places[screening.point_count + place]];
    let shape = shape_of(seen, around);
    drawn_shapes[id.x] = shape;
    normals[place] = select(NO_NORMAL, shape.normal, is_plane(around));
}

// Gives points without a plane the normal of the nearest neighbour that has one, in the smallest neighbourhood with
// such a neighbour.
@compute @workgroup_size(GROUP_RECORDS)
fn lend(@builtin(global_invocation_id) id: vec3u) {
    let place = screening.first + id.x;
    if (id.x >= screening.count || place >= found.visible || normals[place] != NO_NORMAL) {
        return;
    }
    let seen = seen_from_eye(seen_points[place].xyz);
    let usual_radius = radius_px_at(seen.depth) * seen.depth / px_per_unit();
    for (var doubling = 0u; doubling <= MAX_DOUBLINGS_OF_LENDING; doubling++) {
        let radius = usual_radius * f32(1u << doubling);
        let window = window_of(seen, radius, select(WIDE_WINDOW, 1u, doubling == 0u));
        var nearest_squared = radius * radius;
        var normal = NO_NORMAL;
        for (var row = window.first.y; row < window.last.y; row++) {
            for (var column = window.first.x; column < window.last.x; column++) {
                let cell = window.start + u32(row * window.width + column);
                let d = cells[cell].xyz - seen.offset;
                if (cells[cell].w > 0.0 && dot(d, d) <= nearest_squared) {
                    let lent = normals[~cell_keys_found[3u * cell + 1u]];
                    if (lent != NO_NORMAL && (normal == NO_NORMAL || dot(d, d) < nearest_squared)) {
                        normal = lent;
                        nearest_squared = dot(d, d);
                    }
                }
            }
        }
        if (normal != NO_NORMAL) {
            let own_radius = drawn_shapes[id.x].radius;
            drawn_shapes[id.x] = shape_with_normal(seen, oct_decode(normal), own_radius, radius);
            return;
        }
    }
}

// A window of cells in a level.
struct Window {
    // The first cell of the level.
    start: u32,
    // Cells per row of the level.
    width: i32,
    first: vec2i,
    last: vec2i,
    // The radius that it covers.
    radius: f32,
}

// The cells within a radius, or within the largest one that the cells cover: a window of at most `eights` times eight
// cells, of the finest level that covers it.
fn window_of(seen: Seen, wanted_radius: f32, eights: u32) -> Window {
    let px = px_per_unit() / seen.depth;
    let radius_px = min(wanted_radius * px, MAX_REACH_CELLS * f32(1u << found.coarsest));
    let level = clamp(level_of(radius_px / f32(eights)), found.finest, found.coarsest);
    let per_px = 1.0 / f32(1u << level);
    let reach = min(radius_px * per_px, MAX_REACH_CELLS * f32(eights));
    let size = vec2i(level_size(level));
    let cells_px = seen.place_px * per_px;
    // Conversion to integers rounds towards zero, so all values are made positive first.
    let before = f32(CELLS_BEFORE);
    let begin = vec2i(max(cells_px - reach + before, vec2f(0.0))) - i32(CELLS_BEFORE);
    let edge = i32(eights * CELLS_OF_WINDOW);
    let end = begin + vec2i(edge, min(i32(cells_px.y + reach) + 1 - begin.y, edge));
    let radius = min(wanted_radius, radius_px / px);
    return Window(cell_at(level, vec2u(0u)), size.x, max(begin, vec2i(0)), min(end, size), radius);
}

// The neighbours within a radius.
fn neighbourhood(seen: Seen, wanted_radius: f32, eights: u32) -> Neighbourhood {
    let window = window_of(seen, wanted_radius, eights);
    let radius = window.radius;
    let per_radius = 1.0 / max(radius, MIN_POSITIVE);
    var count = 0.0;
    var point_count = 0.0;
    var sum = vec3f(0.0);
    var squares = vec3f(0.0);
    var products = vec3f(0.0);
    for (var row = window.first.y; row < window.last.y; row++) {
        for (var column = window.first.x; column < window.last.x; column++) {
            let cell = cells[window.start + u32(row * window.width + column)];
            let d = (cell.xyz - seen.offset) * per_radius;
            if (cell.w > 0.0 && dot(d, d) <= 1.0) {
                count += 1.0;
                point_count += cell.w;
                sum += d;
                squares += d * d;
                products += d * d.yzx;
            }
        }
    }
    let per_count = 1.0 / max(count, 1.0);
    let mean = sum * per_count;
    let diagonal = squares * per_count - mean * mean;
    let neighbor = products * per_count - mean * mean.yzx;
    let covariance = Symmetric(diagonal.x, diagonal.y, diagonal.z, neighbor.x, neighbor.y, neighbor.z);
    return Neighbourhood(radius, count, point_count, covariance);
}

// Whether the neighbours spread in two directions.
fn is_plane(around: Neighbourhood) -> bool {
    let m = around.covariance;
    let trace = m.xx + m.yy + m.zz;
    let pairs = (m.xx * m.yy - m.xy * m.xy) + (m.xx * m.zz - m.zx * m.zx) + (m.yy * m.zz - m.yz * m.yz);
    return around.found >= MIN_OF_PLANE && pairs > MIN_SPREAD * trace * trace;
}

fn shape_of(seen: Seen, around: Neighbourhood) -> ShapeRecord {
    let px = seen.depth / px_per_unit();
    let usual_radius = radius_px_at(seen.depth) * px;
    if (!is_plane(around)) {
        let radius = screening.closing * max(screening.spacing, usual_radius / RADIUS_SPACINGS);
        return ShapeRecord(oct_encode(normalize(-seen.offset)), radius, 0u, 0.0);
    }
    let normal = normalize(smallest_eigenvector(around.covariance));
    let radius = screening.closing * around.radius * sqrt(PI / max(around.points, PI));
    return shape_with_normal(seen, normal, min(radius, usual_radius), around.radius);
}

// A shape with a plane: its normal is oriented, and its radius closes rows of pixels.
fn shape_with_normal(seen: Seen, normal: vec3f, radius: f32, neighbourhood_radius: f32) -> ShapeRecord {
    let px = seen.depth / px_per_unit();
    let outwards = select(vec3f(0.0), screening.sensor, screening.has_sensor == 1u) - seen.offset;
    let turned = select(normal, -normal, dot(normal, outwards) < 0.0);
    if (0.5 * sqrt(2.0) * screening.spacing > 0.5 * px) {
        return ShapeRecord(oct_encode(turned), radius, 0u, 0.0);
    }
    // Only one point per pixel is left, and it closes its row.
    let cosine = max(abs(dot(normal, seen.offset)) / length(seen.offset), MIN_POSITIVE);
    let closing = min(CLOSING_ROWS_PX * px / cosine, 2.0 * neighbourhood_radius);
    return ShapeRecord(oct_encode(turned), max(radius, closing), 0u, 0.0);
}
