//! The outlines of a box and of a plane, as lines between places in the coordinates of the file.

use glam::DVec3;

/// Margin by which the visible part of a plane exceeds the box around the cloud.
const MARGIN: f64 = 0.1;

/// The twelve edges between two corners.
pub(super) fn edges([min, max]: [DVec3; 2]) -> Vec<[DVec3; 2]> {
    let corner = |bits: usize| DVec3::from_array([0, 1, 2].map(|axis| [min, max][bits >> axis & 1][axis]));
    let along = |axis: usize| {
        let starts = (0..8).filter(move |bits| bits >> axis & 1 == 0);
        starts.map(move |bits| [corner(bits), corner(bits | 1 << axis)])
    };
    (0..3).flat_map(along).collect()
}

/// The outline of the part of a plane (`normal · place = offset`) that is in a box slightly larger than that between
/// `corners`, closed; where the plane passes by, a square as large as the box. `normal` has a length of 1.
pub(super) fn plane(normal: DVec3, offset: f64, [min, max]: [DVec3; 2]) -> Vec<DVec3> {
    let margin = DVec3::splat(MARGIN * (max - min).max_element());
    let signed = |place: DVec3| normal.dot(place) - offset;
    let crossings = edges([min - margin, max + margin]).into_iter().filter_map(|[a, b]| {
        let [at_a, at_b] = [signed(a), signed(b)];
        (at_a * at_b <= 0.0 && at_a != at_b).then(|| a.lerp(b, at_a / (at_a - at_b)))
    });
    let mut corners: Vec<DVec3> = crossings.collect();
    let (u, v) = normal.any_orthonormal_pair();
    if corners.len() < 3 {
        let center = foot(normal, offset, [min, max]);
        let half = 0.5 * (max - min).max_element() + margin.x;
        corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
            .map(|(along_u, along_v)| center + (u * along_u + v * along_v) * half)
            .into();
    }
    let center = corners.iter().sum::<DVec3>() / corners.len() as f64;
    let angle = |place: &DVec3| (*place - center).dot(v).atan2((*place - center).dot(u));
    corners.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
    corners.extend(corners.first().copied());
    corners
}

/// Returns the point of a plane that is nearest to the centre of a box.
pub(super) fn foot(normal: DVec3, offset: f64, [min, max]: [DVec3; 2]) -> DVec3 {
    let center = min.midpoint(max);
    center + normal * (offset - normal.dot(center))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const CORNERS: [DVec3; 2] = [DVec3::ZERO, DVec3::new(1.0, 2.0, 3.0)];

    #[test]
    fn a_box_has_twelve_edges_each_along_one_axis() {
        let edges = edges(CORNERS);
        assert_eq!(edges.len(), 12);
        let lengths = |length: f64| edges.iter().filter(|[a, b]| a.distance(*b) == length).count();
        assert_eq!([1.0, 2.0, 3.0].map(lengths), [4, 4, 4]);
    }

    #[test]
    fn a_plane_across_an_axis_is_a_rectangle_with_a_margin() {
        let outline = plane(DVec3::Y, 0.5, CORNERS);
        assert_eq!(outline.len(), 5);
        assert_eq!(outline[0], outline[4]);
        let lengths = outline.windows(2).map(|pair| pair[0].distance(pair[1]));
        let around: f64 = lengths.sum();
        assert!((around - 2.0 * (1.6 + 3.6)).abs() < 1e-12, "{around}");
    }

    proptest! {
        #[test]
        fn every_corner_is_on_the_plane(
            normal in prop::array::uniform3(-1f64..1.0), offset in -9f64..9.0,
        ) {
            let normal = DVec3::from_array(normal);
            prop_assume!(normal.length() > 0.1);
            let normal = normal.normalize();
            let outline = plane(normal, offset, CORNERS);
            prop_assert!(outline.len() >= 4);
            for corner in outline {
                prop_assert!((normal.dot(corner) - offset).abs() < 1e-9);
            }
            prop_assert!((normal.dot(foot(normal, offset, CORNERS)) - offset).abs() < 1e-9);
        }
    }
}
