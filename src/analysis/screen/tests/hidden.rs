//! Hidden points, by all pairs of points.

use super::*;
use glam::DMat3;
use std::collections::BTreeMap;

/// A difference that rounding might flip: the result is unknown then.
const UNCERTAIN: f64 = 1e-4;

/// `a < b`, where that is certain; `unit` is how large both are.
fn is_less(a: f64, b: f64, unit: f64) -> Option<bool> {
    let is_certain = (a - b).abs() > UNCERTAIN * unit;
    is_certain.then_some(a < b)
}

fn not(known: Option<bool>) -> Option<bool> {
    known.map(|known| !known)
}

/// Disjunction of statements that may be unknown.
fn any(statements: impl IntoIterator<Item = Option<bool>>) -> Option<bool> {
    let mut known = Some(false);
    for statement in statements {
        match statement {
            Some(true) => return Some(true),
            Some(false) => {}
            None => known = None,
        }
    }
    known
}

fn all(statements: impl IntoIterator<Item = Option<bool>>) -> Option<bool> {
    not(any(statements.into_iter().map(not)))
}

/// A point in an image: its depth, its pixel, and the place in this.
type InPicture = (f64, [i64; 2], [f64; 2]);

/// Points in an image.
struct Picture {
    points: Vec<Option<InPicture>>,
    /// The least depth of each pixel.
    nearest: BTreeMap<[i64; 2], f64>,
    px_per_slope: f64,
    spacing: f64,
}

impl Picture {
    fn new(view: &ScreenView, points: &[PointRecord], spacing: f32) -> Self {
        let mut nearest = BTreeMap::new();
        let points = points.iter().map(|point| {
            let seen = view.see(point.position)?;
            let pixel = seen.place_px.map(|px| px.floor() as i64);
            let within = [0, 1].map(|axis| f64::from(seen.place_px[axis]) - pixel[axis] as f64 - 0.5);
            let depth = f64::from(seen.depth);
            let min = nearest.entry(pixel).or_insert(depth);
            *min = depth.min(*min);
            Some((depth, pixel, within))
        });
        Self {
            points: points.collect(),
            nearest,
            px_per_slope: f64::from(view.px_per_slope[0]),
            spacing: f64::from(spacing),
        }
    }

    /// True if another point is nearer in the same pixel and this one smaller than that; or another one covers its
    /// pixel and is nearer by more than the radius, and this one is not on the plane of those before it.
    fn hides(&self, slot: usize) -> Option<bool> {
        let Some((depth, pixel, within)) = self.points[slot] else {
            return Some(true);
        };
        let half_width_px = |depth: f64| self.spacing * std::f64::consts::FRAC_1_SQRT_2 * self.px_per_slope / depth;
        let is_behind_another = self.nearest[&pixel] < depth;
        let is_small = is_less(half_width_px(depth), 0.5, 1.0);
        let covered = self.points.iter().flatten().map(|&(other_depth, other, _)| {
            // At most three pixels to each side.
            let steps = (0..2).map(|axis| pixel[axis].abs_diff(other[axis])).max()?;
            let covers = match steps {
                0 => Some(true),
                1..=3 => is_less(steps as f64 - 0.5, half_width_px(other_depth), 1.0),
                _ => Some(false),
            };
            all([covers, is_less(other_depth, depth - 3.0 * self.spacing, depth)])
        });
        any([
            all([Some(is_behind_another), is_small]),
            all([any(covered), not(self.meets_plane_of_nearer(depth, pixel, within))]),
        ])
    }

    /// True if a point lies on the plane through the nearest points of the surrounding pixels that are nearer than it.
    fn meets_plane_of_nearer(&self, depth: f64, pixel: [i64; 2], within: [f64; 2]) -> Option<bool> {
        let [x, y] = pixel;
        let around = |dx: i64, dy: i64| self.nearest.get(&[x + dx, y + dy]).copied();
        let directions = [(-3, -3), (0, -3), (3, -3), (-3, 0), (3, 0), (-3, 3), (0, 3), (3, 3)];
        let enclosed = all(directions.map(|(dx, dy)| match around(dx, dy) {
            Some(other) => is_less(other, depth - 3.0 * self.spacing, depth),
            None => Some(false),
        }));
        let (mut squares, mut products, mut count, mut is_known) = (DMat3::ZERO, DVec3::ZERO, 0, true);
        // Where there are few, a wider window is used.
        for reach in [3, 7] {
            (squares, products, count) = (DMat3::ZERO, DVec3::ZERO, 0);
            for (dx, dy) in (-reach..=reach).flat_map(|dy| (-reach..=reach).map(move |dx| (dx, dy))) {
                let Some(other) = around(dx, dy) else { continue };
                match is_less(other, depth - self.spacing, depth) {
                    Some(true) => {
                        let row = DVec3::new(dx as f64, dy as f64, 1.0);
                        squares += DMat3::from_cols(row * row.x, row * row.y, row);
                        products += row * (depth / other - 1.0);
                        count += 1;
                    }
                    Some(false) => {}
                    None => is_known = false,
                }
            }
            if count >= 4 {
                break;
            }
        }
        let meets = if !is_known {
            None
        } else if count < 4 || squares.determinant().abs() < 0.5 / f64::from(count) {
            Some(false)
        } else {
            let plane = squares.inverse() * products;
            let slopes = plane.x.abs() + plane.y.abs();
            let before = plane.dot(DVec3::new(within[0], within[1], 1.0));
            // Where depths differ greatly, sums in f32 lose more digits.
            let unit = 10.0 * (products.abs().max_element() + slopes);
            not(is_less(3.0 * self.spacing / depth, before - 0.5 * slopes, unit))
        };
        all([not(enclosed), meets])
    }
}

proptest! {
    #[test]
    fn a_hidden_point_never_survives_and_a_visible_one_always_does(
        places in prop::collection::vec(
            (-0.9f32..0.9, -0.7f32..0.7, prop_oneof![0.3f32..4.0, 0.9f32..1.1, Just(0.0)]), 1..300,
        ),
        // A plane that some of them lie on: inverse depths, right and down.
        slopes in (-1f32..1.0, -1f32..1.0),
        spacing in 0.001f32..0.2,
        px_per_slope in 20f32..90.0,
    ) {
        // At their own depths, all over the image.
        let points = records(places.iter().map(|&(x, y, depth)| {
            let on_plane = 1.0 / (2.0 + slopes.0 * x + slopes.1 * y);
            (if depth > 0.0 { depth } else { on_plane }) * Vec3::new(x, y, -1.0)
        }));
        let view = view([64, 48], px_per_slope);
        let retained = estimate(&view, &points, spacing, Search::Fixed).visible.slots;
        prop_assert!(retained.is_sorted_by(|a, b| a < b), "in their order");
        let picture = Picture::new(&view, &points, spacing);
        for (slot, point) in points.iter().enumerate() {
            let [x, y] = view.see(point.position).unwrap().place_px;
            if !((0.0..64.0).contains(&x) && (0.0..48.0).contains(&y)) {
                continue;
            }
            let is_retained = retained.binary_search(&(slot as u32)).is_ok();
            if let Some(is_hidden) = picture.hides(slot) {
                prop_assert_eq!(is_retained, !is_hidden, "{}", slot);
            }
        }
    }
}
