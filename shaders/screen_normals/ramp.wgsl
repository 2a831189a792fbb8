// Surfaces seen at grazing angles: nearer points there occlude nothing, they belong to the same surface. Twin of
// analysis/screen/ramp.rs.

#import screen_normals/view.wgsl

// Sums over the nearer pixels of a window: their count, columns and rows and their products, the values and their
// products with these.
struct RampSums {
    count: f32,
    column: f32,
    row: f32,
    columns: f32,
    rows: f32,
    mixed: f32,
    value: f32,
    value_column: f32,
    value_row: f32,
}

// Whether an occluded point lies on the plane of the points that are nearer than itself by more than the spacing.
fn is_on_plane_of_nearer(center: u32, place_px: vec2f, depth: f32) -> bool {
    if (is_enclosed(center, depth - screening.radius)) {
        return false;
    }
    var sums = ramp_sums(center, depth, i32(MAX_REACH_PX));
    if (sums.count < MIN_OF_RAMP) {
        sums = ramp_sums(center, depth, i32(BORDER_PX));
    }
    if (sums.count < MIN_OF_RAMP) {
        return false;
    }
    let columns = sums.count * sums.columns - sums.column * sums.column;
    let rows = sums.count * sums.rows - sums.row * sums.row;
    let mixed = sums.count * sums.mixed - sums.column * sums.row;
    // Integer arithmetic, so a line has exactly zero spread.
    let spread = columns * rows - mixed * mixed;
    if (spread < 1.0) {
        return false;
    }
    let by_column = sums.count * sums.value_column - sums.column * sums.value;
    let by_row = sums.count * sums.value_row - sums.row * sums.value;
    let column_slope = (by_column * rows - by_row * mixed) / spread;
    let row_slope = (by_row * columns - by_column * mixed) / spread;
    let at_center = (sums.value - column_slope * sums.column - row_slope * sums.row) / sums.count;
    let before = at_center + column_slope * place_px.x + row_slope * place_px.y;
    return before - 0.5 * (abs(column_slope) + abs(row_slope)) <= screening.radius / depth;
}

// Whether a point is covered on all sides, as most hidden points are: decided without fitting a plane.
fn is_enclosed(center: u32, limit: f32) -> bool {
    let above = center - MAX_REACH_PX * stride();
    let under = center + MAX_REACH_PX * stride();
    let neighbor = max(depths[center - MAX_REACH_PX], depths[center + MAX_REACH_PX]);
    let before = max(max(depths[above - MAX_REACH_PX], depths[above]), depths[above + MAX_REACH_PX]);
    let after = max(max(depths[under - MAX_REACH_PX], depths[under]), depths[under + MAX_REACH_PX]);
    return max(max(before, after), neighbor) < limit;
}

// Sums of inverse depths, in units of the point's own, less one; in a window that extends `reach` pixels.
fn ramp_sums(center: u32, depth: f32, reach: i32) -> RampSums {
    let limit = depth - screening.spacing;
    var sums = RampSums();
    for (var row = -reach; row <= reach; row++) {
        let first = i32(center) + row * i32(stride());
        for (var column = -reach; column <= reach; column++) {
            let there = depths[first + column];
            if (there < limit) {
                let value = depth / there - 1.0;
                let place = vec2f(f32(column), f32(row));
                sums.count += 1.0;
                sums.column += place.x;
                sums.row += place.y;
                sums.columns += place.x * place.x;
                sums.rows += place.y * place.y;
                sums.mixed += place.x * place.y;
                sums.value += value;
                sums.value_column += value * place.x;
                sums.value_row += value * place.y;
            }
        }
    }
    return sums;
}
