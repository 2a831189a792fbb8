// Planes through the neighbours of points in a picture, and the records that are drawn. Twin of
// analysis/screen/planes.rs.

// The neighbours of a point within a radius.
struct Neighbourhood {
    radius: f32,
    // How many cells have one.
    found: f32,
    // How many points there are.
    points: f32,
    covariance: Symmetric,
}

// Writes the records of some visible points, and those of nothing where there are no more.
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
    for (var doubling = 0u; doubling < MOST_DOUBLINGS; doubling++) {
        if (around.found >= FEWEST_NEIGHBOURS && is_plane(around)) {
            break;
        }
        radius *= 2.0;
        around = neighbourhood(seen, radius, WIDE_WINDOW);
    }
    drawn_points[id.x] = points[places[screening.point_count + place]];
    drawn_shapes[id.x] = shape_of(seen, around);
}

// The neighbours within a radius, or within the largest one that there are cells for. Of equally wide levels the finer
// one is for windows of `eights` times eight cells.
fn neighbourhood(seen: Seen, wanted_radius: f32, eights: u32) -> Neighbourhood {
    let px = px_per_unit() / seen.depth;
    let radius_px = min(wanted_radius * px, MOST_REACH_CELLS * f32(1u << found.coarsest));
    let radius = min(wanted_radius, radius_px / px);
    let level = clamp(level_of(radius_px / f32(eights)), found.finest, found.coarsest);
    let per_px = 1.0 / f32(1u << level);
    let reach = min(radius_px * per_px, MOST_REACH_CELLS * f32(eights));
    let size = vec2i(level_size(level));
    let cells_px = seen.place_px * per_px;
    // Places are rounded towards zero, so all are made positive first.
    let before = f32(CELLS_BEFORE);
    let begin = vec2i(max(cells_px - reach + before, vec2f(0.0))) - i32(CELLS_BEFORE);
    let edge = i32(eights * CELLS_OF_WINDOW);
    let end = begin + vec2i(edge, min(i32(cells_px.y + reach) + 1 - begin.y, edge));
    let first = max(begin, vec2i(0));
    let last = min(end, size);
    let start = cell_at(level, vec2u(0u));

    let per_radius = 1.0 / max(radius, LEAST_POSITIVE);
    var count = 0.0;
    var point_count = 0.0;
    var sum = vec3f(0.0);
    var squares = vec3f(0.0);
    var products = vec3f(0.0);
    for (var row = first.y; row < last.y; row++) {
        for (var column = first.x; column < last.x; column++) {
            let cell = cells[start + u32(row * size.x + column)];
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
    let beside = products * per_count - mean * mean.yzx;
    let covariance = Symmetric(diagonal.x, diagonal.y, diagonal.z, beside.x, beside.y, beside.z);
    return Neighbourhood(radius, count, point_count, covariance);
}

// Whether the neighbours spread in two directions.
fn is_plane(around: Neighbourhood) -> bool {
    let m = around.covariance;
    let trace = m.xx + m.yy + m.zz;
    let pairs = (m.xx * m.yy - m.xy * m.xy) + (m.xx * m.zz - m.zx * m.zx) + (m.yy * m.zz - m.yz * m.yz);
    return around.found >= FEWEST_OF_PLANE && pairs > LEAST_SPREAD * trace * trace;
}

fn shape_of(seen: Seen, around: Neighbourhood) -> ShapeRecord {
    let px = seen.depth / px_per_unit();
    let usual_radius = radius_px_at(seen.depth) * px;
    if (!is_plane(around)) {
        let radius = screening.closing * max(screening.spacing, usual_radius / RADIUS_SPACINGS);
        return ShapeRecord(oct_encode(normalize(-seen.offset)), radius, 0u, 0.0);
    }
    var normal = normalize(smallest_eigenvector(around.covariance));
    let outwards = select(vec3f(0.0), screening.sensor, screening.has_sensor == 1u) - seen.offset;
    if (dot(normal, outwards) < 0.0) {
        normal = -normal;
    }
    var radius = screening.closing * around.radius * sqrt(PI / max(around.points, PI));
    radius = min(radius, usual_radius);
    if ((0.5 * sqrt(2.0)) * screening.spacing <= 0.5 * px) {
        // One point a pixel is left, and it closes its row.
        let cosine = max(abs(dot(normal, seen.offset)) / length(seen.offset), LEAST_POSITIVE);
        radius = max(radius, min(CLOSING_ROWS_PX * px / cosine, 2.0 * around.radius));
    }
    return ShapeRecord(oct_encode(normal), radius, 0u, 0.0);
}
