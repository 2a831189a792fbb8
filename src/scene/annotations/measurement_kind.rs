//! Lengths, angles and heights between places, in f64.

use glam::DVec3;

/// Measured quantity.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum MeasurementKind {
    /// The straight distance of two points, scene units.
    #[default]
    Distance,
    /// The angle at the second of three points, degrees.
    Angle,
    /// Height difference of the second of two points relative to the first, along the up axis, scene units.
    Height,
}

impl MeasurementKind {
    /// Every measurement kind, its name and description.
    pub const ALL: [(Self, &'static str, &'static str); 3] = [
        (
            Self::Distance,
            "Distance",
            "The straight distance of two points, scene units",
        ),
        (Self::Angle, "Angle", "The angle at the second of three points, degrees"),
        (
            Self::Height,
            "Height",
            "How much higher the second point is than the first, along the up axis, scene units",
        ),
    ];

    /// Its name.
    pub fn name(self) -> &'static str {
        let known = Self::ALL.iter().find(|(kind, ..)| *kind == self);
        known.map_or("", |&(_, name, _)| name)
    }

    /// Points that it takes.
    pub fn point_count(self) -> usize {
        match self {
            Self::Distance | Self::Height => 2,
            Self::Angle => 3,
        }
    }

    /// The value for this number of places; `None` if there are fewer, or without an angle. `up` has a length of 1.
    pub fn value(self, places: &[DVec3], up: DVec3) -> Option<f64> {
        match (self, places) {
            (Self::Distance, &[a, b, ..]) => Some(a.distance(b)),
            (Self::Height, &[a, b, ..]) => Some((b - a).dot(up)),
            (Self::Angle, &[a, corner, b, ..]) => angle_deg(a - corner, b - corner),
            _ => None,
        }
    }
}

/// Between two directions, as exact for small and for flat angles as for others (Kahan 2006); `None` where one has no
/// length.
fn angle_deg(a: DVec3, b: DVec3) -> Option<f64> {
    let (a, b) = (a.try_normalize()?, b.try_normalize()?);
    Some(2.0 * (a - b).length().atan2((a + b).length()).to_degrees())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A corner of a survey far from zero.
    const FAR: DVec3 = DVec3::new(4.5e6, -3.9e6, 2.2e6);

    #[test]
    fn known_triangles_have_known_values() {
        let places = [DVec3::new(3.0, 0.0, 0.0), DVec3::ZERO, DVec3::new(0.0, 4.0, 0.0)];
        for origin in [DVec3::ZERO, FAR] {
            let places = places.map(|place| place + origin);
            let value = |kind: MeasurementKind, places: &[DVec3]| kind.value(places, DVec3::Y).unwrap();
            assert_eq!(value(MeasurementKind::Distance, &[places[0], places[2]]), 5.0);
            assert!((value(MeasurementKind::Angle, &places) - 90.0).abs() < 1e-12);
            assert_eq!(value(MeasurementKind::Height, &[places[0], places[2]]), 4.0);
            assert_eq!(value(MeasurementKind::Height, &[places[2], places[0]]), -4.0);
        }
        let down = MeasurementKind::Height.value(&places[1..], DVec3::NEG_Y);
        assert_eq!(down, Some(-4.0));
    }

    #[test]
    fn small_and_flat_angles_keep_their_digits() {
        for angle in [1e-9f64, 0.5, 90.0, 179.0, 180.0 - 1e-7] {
            let b = DVec3::new(angle.to_radians().cos(), angle.to_radians().sin(), 0.0);
            let found = MeasurementKind::Angle.value(&[7.0 * DVec3::X, DVec3::ZERO, b], DVec3::Y);
            let found = found.unwrap();
            assert!((found - angle).abs() < 1e-13 * angle.max(1.0), "{found} for {angle}");
        }
    }

    #[test]
    fn unmeasurable_points_have_no_value() {
        let up = DVec3::Y;
        assert_eq!(MeasurementKind::Distance.value(&[DVec3::X], up), None);
        assert_eq!(MeasurementKind::Angle.value(&[DVec3::X, DVec3::X, DVec3::Y], up), None);
        assert_eq!(MeasurementKind::Distance.value(&[DVec3::X; 2], up), Some(0.0));
        for (kind, name, _) in MeasurementKind::ALL {
            assert_eq!(kind.name(), name);
        }
    }
}
