//! Surfaces that are seen from the side: none of them hides itself, and all hide the points behind them.

use super::*;
use std::collections::{BTreeMap, BTreeSet};

/// Distance of the objects: rays are all but parallel.
const AWAY: f64 = 20.0;

const SPACING: f64 = 0.01;

/// A flat object: its centre, and two axes as long as its width and height.
#[derive(Clone, Copy)]
struct Flat {
    center: DVec3,
    along: [DVec3; 2],
}

impl Flat {
    /// A square two metres wide, whose normal is `degrees` from the direction to the eye; its upper edge is the far
    /// one.
    fn tilted(degrees: f64) -> Self {
        let (sine, cosine) = degrees.to_radians().sin_cos();
        Self {
            center: DVec3::new(0.0, 0.0, -AWAY),
            along: [2.0 * DVec3::X, 2.0 * DVec3::new(0.0, cosine, -sine)],
        }
    }

    fn normal(&self) -> DVec3 {
        self.along[0].cross(self.along[1]).normalize()
    }

    fn moved(self, by: DVec3) -> Self {
        Self {
            center: self.center + by,
            ..self
        }
    }

    /// Points on a grid that is turned against the edges.
    fn grid(&self, turned_degrees: f64) -> Vec<DVec3> {
        let (sine, cosine) = turned_degrees.to_radians().sin_cos();
        let [width, height] = self.along.map(DVec3::length);
        let steps = ((width + height) / SPACING) as i32;
        let places = (-steps..=steps).flat_map(|row| (-steps..=steps).map(move |column| (column, row)));
        let places = places.filter_map(|(column, row)| {
            let [x, y] = [f64::from(column) + 0.31, f64::from(row) - 0.17].map(|step| step * SPACING);
            let (x, y) = ((cosine * x - sine * y) / width, (sine * x + cosine * y) / height);
            (x.abs() <= 0.5 && y.abs() <= 0.5).then(|| self.center + x * self.along[0] + y * self.along[1])
        });
        places.collect()
    }

    /// Random points, the same number as in a grid.
    fn at_random(&self) -> Vec<DVec3> {
        let [width, height] = self.along.map(DVec3::length);
        let count = (width * height / (SPACING * SPACING)) as u32;
        let places = (0..count).map(|index| {
            let [x, y] = [2 * index, 2 * index + 1].map(|seed| random(seed) - 0.5);
            self.center + x * self.along[0] + y * self.along[1]
        });
        places.collect()
    }
}

/// Between 0 and 1, another one for each seed.
fn random(seed: u32) -> f64 {
    let mut state = seed.wrapping_mul(0x9E37_79B9) ^ 0x5bd1_e995;
    for _ in 0..3 {
        state ^= state >> 15;
        state = state.wrapping_mul(0x2c1b_3c6d);
        state ^= state >> 13;
    }
    f64::from(state) / f64::from(u32::MAX)
}

/// A view with this spacing of points, in pixels.
fn view_of(px_per_spacing: f64) -> ScreenView {
    view([1280, 960], (px_per_spacing * AWAY / SPACING) as f32)
}

fn cloud_of(places: impl IntoIterator<Item = DVec3>) -> Vec<PointRecord> {
    records(places.into_iter().map(DVec3::as_vec3))
}

/// The pixel of a point, if it is in the image.
fn pixel_of(view: &ScreenView, point: &PointRecord) -> Option<[u32; 2]> {
    let place = view.see(point.position)?.place_px;
    let is_inside = place[0] >= 0.0 && place[1] >= 0.0 && place[0] < 1280.0 && place[1] < 960.0;
    is_inside.then(|| place.map(|px| px as u32))
}

#[test]
fn a_plane_does_not_hide_itself_from_any_side() {
    for degrees in [0.0, 60.0, 77.0, 80.0, 85.0, 88.0] {
        let flat = Flat::tilted(degrees);
        for (kind, places) in [
            ("grid", flat.grid(0.0)),
            ("turned", flat.grid(34.0)),
            ("random", flat.at_random()),
        ] {
            let points = cloud_of(places);
            for px_per_spacing in [0.8, 1.3, 2.0, 3.1, 5.0, 9.0] {
                let view = view_of(px_per_spacing);
                let visible = estimate(&view, &points, SPACING as f32, Search::Fixed).visible;
                // Its nearest row of pixels has nothing else in front of it: a line, not a plane.
                let inside = |point: &PointRecord| {
                    let place = Vec3::from_array(point.position).as_dvec3() - flat.center;
                    let along = flat.along.map(|axis| place.dot(axis) / axis.length_squared());
                    along.iter().all(|along| along.abs() < 0.4) && pixel_of(&view, point).is_some()
                };
                let retained = visible.slots.iter().filter(|&&slot| inside(&points[slot as usize]));
                let (retained, all) = (retained.count(), points.iter().filter(|point| inside(point)).count());
                // At steeper angles some rows of pixels have a larger depth range than half a pixel's slope plus the
                // radius.
                let min = if degrees < 81.0 { 0.98 } else { 0.8 };
                assert!(
                    retained as f64 >= min * all as f64,
                    "{degrees} degrees, {kind}, {px_per_spacing} pixels: {retained} of {all}"
                );
            }
        }
    }
}

#[test]
fn each_pixel_retains_its_nearest_subpixel_point() {
    for degrees in [60.0, 77.0, 85.0, 88.0] {
        let points = cloud_of(Flat::tilted(degrees).grid(20.0));
        for px_per_spacing in [0.2, 0.6] {
            let view = view_of(px_per_spacing);
            let mut nearest = BTreeMap::new();
            for point in &points {
                let depth = -point.position[2];
                let min = nearest.entry(pixel_of(&view, point)).or_insert(depth);
                *min = depth.min(*min);
            }
            let visible = estimate(&view, &points, SPACING as f32, Search::Fixed).visible;
            assert!(visible.len() >= nearest.len());
            for &slot in &visible.slots {
                let point = &points[slot as usize];
                assert_eq!(-point.position[2], nearest[&pixel_of(&view, point)]);
            }
        }
    }
}

/// Pixels whose rays meet a surface, well inside its edges, and no disk.
fn holes(view: &ScreenView, points: &[PointRecord], flat: &Flat, found: &Estimated) -> [usize; 2] {
    let mut covered = BTreeSet::new();
    let ray_of = |x: i32, y: i32| {
        let [x, y] = [f64::from(x), f64::from(y)].map(|px| px + 0.5);
        let right = (x - f64::from(view.center_px[0])) / f64::from(view.px_per_slope[0]);
        let up = (y - f64::from(view.center_px[1])) / f64::from(view.px_per_slope[1]);
        DVec3::new(right, up, -1.0)
    };
    for (&slot, shape) in found.visible.slots.iter().zip(&found.shapes) {
        let seen = view.see(points[slot as usize].position).unwrap();
        let (center, normal) = (seen.offset.as_dvec3(), oct_decode(shape.normal).as_dvec3());
        let reach = (shape.radius * view.px_per_unit() / seen.depth).ceil() as i32 + 1;
        let [x, y] = seen.place_px.map(|px| px.floor() as i32);
        for (x, y) in (y - reach..=y + reach).flat_map(|y| (x - reach..=x + reach).map(move |x| (x, y))) {
            let ray = ray_of(x, y);
            let hit = ray * (normal.dot(center) / normal.dot(ray));
            if hit.distance(center) <= f64::from(shape.radius) {
                covered.insert([x, y]);
            }
        }
    }
    let (mut inside, mut open) = (0, 0);
    for (x, y) in (0..960).flat_map(|y| (0..1280).map(move |x| (x, y))) {
        let ray = ray_of(x, y);
        let hit = ray * (flat.normal().dot(flat.center) / flat.normal().dot(ray)) - flat.center;
        let [across, along] = flat.along.map(|axis| hit.dot(axis) / axis.length_squared());
        if across.abs() < 0.45 && along.abs() < 0.45 {
            inside += 1;
            open += usize::from(!covered.contains(&[x, y]));
        }
    }
    [inside, open]
}

#[test]
fn planes_are_closed_from_any_side() {
    for degrees in [0.0, 60.0, 77.0, 80.0, 85.0] {
        let flat = Flat::tilted(degrees);
        let points = cloud_of(flat.grid(20.0));
        for px_per_spacing in [0.3, 0.6, 1.0, 1.6, 2.5, 4.0] {
            let view = view_of(px_per_spacing);
            let found = estimate(&view, &points, SPACING as f32, Search::Fixed);
            let [inside, open] = holes(&view, &points, &flat, &found);
            assert!(
                open * 50 <= inside,
                "{degrees} degrees, {px_per_spacing} pixels: {open} of {inside}"
            );
        }
    }
}

#[test]
fn points_five_centimetres_behind_a_surface_are_hidden() {
    for degrees in [0.0, 60.0, 77.0, 85.0] {
        let front = Flat::tilted(degrees);
        let apart = -0.05 * front.normal() * front.normal().z.signum();
        for turned in [0.0, 20.0] {
            let (front_places, behind) = (front.grid(turned), front.moved(apart).grid(turned + 7.0));
            let points = cloud_of(behind.iter().chain(&front_places).copied());
            for px_per_spacing in [0.4, 1.3, 2.0, 3.1, 4.5] {
                let view = view_of(px_per_spacing);
                let visible = estimate(&view, &points, SPACING as f32, Search::Fixed).visible;
                let is_behind = |slot: u32| (slot as usize) < behind.len();
                // Excludes points visible next to the edges of the surface in front.
                let is_inside = |slot: u32| {
                    let ray = behind[slot as usize];
                    let hit = ray * (front.normal().dot(front.center) / front.normal().dot(ray)) - front.center;
                    let along = front.along.map(|axis| hit.dot(axis) / axis.length_squared());
                    along.iter().all(|along| along.abs() < 0.48)
                };
                let leaked = visible.slots.iter().filter(|&&slot| is_behind(slot) && is_inside(slot));
                let all = (0..behind.len() as u32).filter(|&slot| is_inside(slot)).count();
                assert!(all > 1000, "{degrees}: {all}");
                let leaked = leaked.count();
                // At grazing angles, points that are almost as far apart as their squares are wide leave gaps.
                assert!(
                    leaked * 2000 <= all,
                    "{degrees} degrees, {px_per_spacing} pixels, {turned}: {leaked} of {all}"
                );
            }
        }
    }
}

#[test]
fn a_thin_pole_hides_only_points_behind_it_or_next_to_those() {
    let pole = Flat {
        center: DVec3::new(0.0, 0.0, -AWAY),
        along: [0.035 * DVec3::X, 1.6 * DVec3::Y],
    };
    let wall = Flat {
        center: DVec3::new(0.0, 0.0, -AWAY - 1.0),
        along: [1.2 * DVec3::X, 2.0 * DVec3::Y],
    };
    let behind = wall.grid(11.0);
    let points = cloud_of(behind.iter().copied().chain(pole.grid(0.0)));
    for px_per_spacing in [1.3, 2.0, 3.1, 4.5] {
        let view = view_of(px_per_spacing);
        let visible = estimate(&view, &points, SPACING as f32, Search::Fixed).visible;
        for (slot, place) in behind.iter().enumerate() {
            if pixel_of(&view, &points[slot]).is_none() || place.y.abs() > 0.7 {
                continue;
            }
            // Intersection of its ray and the plane of the pole.
            let neighbor = (place.x * AWAY / (AWAY + 1.0)).abs();
            let is_retained = visible.slots.binary_search(&(slot as u32)).is_ok();
            assert!(
                !is_retained || neighbor > 0.014,
                "{px_per_spacing} pixels: {neighbor} is hidden"
            );
            assert!(
                is_retained || neighbor < 0.04,
                "{px_per_spacing} pixels: {neighbor} is visible"
            );
        }
    }
}

#[test]
fn the_sides_of_a_box_are_visible_up_to_their_edges_and_points_behind_are_hidden() {
    // The front faces the eye to within four degrees, so the left side is seen at 87 degrees; a wall is behind.
    let (sine, cosine) = 4f64.to_radians().sin_cos();
    let (right, back) = (DVec3::new(cosine, 0.0, -sine), DVec3::new(-sine, 0.0, -cosine));
    let center = DVec3::new(0.0, 0.0, -AWAY);
    let front = Flat {
        center,
        along: [right, DVec3::Y],
    };
    let side = Flat {
        center: center - 0.5 * right + 0.5 * back,
        along: [back, DVec3::Y],
    };
    let (left, right_side) = (side, side.moved(right));
    let wall = Flat {
        center: center - 3.0 * DVec3::Z,
        along: [3.0 * DVec3::X, 2.0 * DVec3::Y],
    };
    let faces_eye = |flat: &Flat| flat.normal().dot(flat.center).abs() / flat.center.length();
    assert!(faces_eye(&left) < 0.07, "{}", faces_eye(&left));
    let kinds = [front, left, right_side, wall].map(|flat| flat.grid(0.0));
    let ends: Vec<usize> = kinds.iter().map(Vec::len).collect();
    let points = cloud_of(kinds.iter().flatten().copied());
    for px_per_spacing in [1.3, 2.0, 3.1, 4.5] {
        let view = view_of(px_per_spacing);
        let visible = estimate(&view, &points, SPACING as f32, Search::Fixed).visible;
        let mut first = 0;
        let shares = [0, 1, 2, 3].map(|kind| {
            let slots = first..first + ends[kind];
            first = slots.end;
            // For the wall, only the part behind the box.
            let counts = |slot: usize| {
                let place = Vec3::from_array(points[slot].position);
                let is_behind = place.x.abs() < 0.4 && place.y.abs() < 0.4;
                pixel_of(&view, &points[slot]).is_some() && (kind < 3 || is_behind)
            };
            let retained = visible.slots.iter().map(|&slot| slot as usize);
            let retained = retained.filter(|&slot| slots.contains(&slot) && counts(slot)).count();
            retained as f64 / slots.clone().filter(|&slot| counts(slot)).count().max(1) as f64
        });
        let [front, one_side, other_side, wall] = shares;
        let (seen, unseen) = (one_side.max(other_side), one_side.min(other_side));
        // Next to the edge, the points in front of a point lie on two planes; the front one is not steep. A hidden side
        // shows through the gaps between points that are far apart.
        assert!(
            front > 0.99 && seen > 0.5 && unseen < 0.25 && wall == 0.0,
            "{px_per_spacing}: {shares:?}"
        );
    }
}
