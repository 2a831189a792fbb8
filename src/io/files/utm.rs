//! Longitude and latitude → metres: universal transverse Mercator on WGS 84.
//!
//! Krüger's series in the third flattening, to the third order (Karney, "Transverse Mercator with an accuracy of a few
//! nanometers", 2011, §2–4): below a millimetre within a zone. A zone serves all frames of a sequence alike, where a
//! projection around the centre of each would move them against each other.

/// Half of the Earth's longer axis and its flattening, WGS 84.
const SEMI_MAJOR_M: f64 = 6_378_137.0;
const FLATTENING: f64 = 1.0 / 298.257_223_563;
const CENTRAL_SCALE: f64 = 0.9996;
const FALSE_EASTING_M: f64 = 500_000.0;
const FALSE_NORTHING_M: f64 = 10_000_000.0;
const ZONE_DEGREES: f64 = 6.0;
const ZONES: f64 = 60.0;
/// Maximum distance from the central meridian of a zone in degrees: beyond it the projection is far too wide.
const MAX_DEGREES: f64 = 30.0;

/// A zone of six degrees, north or south of the equator.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::io) struct Zone {
    number: u8,
    is_south: bool,
}

impl Zone {
    /// The zone of a place.
    fn of(longitude: f64, latitude: f64) -> Self {
        let turned = (longitude + 180.0).rem_euclid(360.0);
        let number = (turned / ZONE_DEGREES).floor().min(ZONES - 1.0) as u8 + 1;
        Self {
            number,
            is_south: latitude < 0.0,
        }
    }

    /// Its code in the register of EPSG.
    pub(in crate::io) fn epsg(self) -> u32 {
        (if self.is_south { 32_700 } else { 32_600 }) + u32::from(self.number)
    }

    /// Longitude of its central meridian, degrees.
    fn meridian(self) -> f64 {
        f64::from(self.number) * ZONE_DEGREES - 183.0
    }

    /// Returns the zone of the centre of `places`, longitudes and latitudes in degrees; `None` if none of them is a
    /// number.
    pub(in crate::io) fn of_center(places: impl Iterator<Item = [f64; 2]>) -> Option<Self> {
        let (mut longitudes, mut latitudes): (Vec<f64>, Vec<f64>) = places
            .filter(|place| place.iter().all(|angle| angle.is_finite()))
            .map(|[longitude, latitude]| (longitude, latitude))
            .unzip();
        let center = longitudes.len() / 2;
        if longitudes.is_empty() {
            return None;
        }
        let [longitude, latitude] =
            [&mut longitudes, &mut latitudes].map(|angles| *angles.select_nth_unstable_by(center, f64::total_cmp).1);
        Some(Self::of(longitude, latitude))
    }

    /// Returns true if both are angles in degrees.
    pub(in crate::io) fn are_degrees(longitude: f64, latitude: f64) -> bool {
        (-90.0..=90.0).contains(&latitude) && (-180.0..=360.0).contains(&longitude)
    }

    /// [`Self::project`], or an error for a place too far from the zone.
    pub(in crate::io) fn project_near(self, longitude: f64, latitude: f64) -> Result<[f64; 2], String> {
        if self.degrees_from_meridian(longitude).abs() > MAX_DEGREES {
            return Err(format!(
                "longitude {longitude} is more than {MAX_DEGREES} degrees away from the other points (UTM zone \
                 {self}): points all around the Earth are not projected"
            ));
        }
        Ok(self.project(longitude, latitude))
    }

    /// Returns the degrees of `longitude` from the central meridian of the zone.
    fn degrees_from_meridian(self, longitude: f64) -> f64 {
        (longitude - self.meridian() + 180.0).rem_euclid(360.0) - 180.0
    }

    /// Easting and northing, metres.
    fn project(self, longitude: f64, latitude: f64) -> [f64; 2] {
        let n = FLATTENING / (2.0 - FLATTENING);
        let rectifying_m = SEMI_MAJOR_M / (1.0 + n) * (1.0 + n.powi(2) / 4.0 + n.powi(4) / 64.0);
        let series = [
            n / 2.0 - 2.0 / 3.0 * n.powi(2) + 5.0 / 16.0 * n.powi(3),
            13.0 / 48.0 * n.powi(2) - 3.0 / 5.0 * n.powi(3),
            61.0 / 240.0 * n.powi(3),
        ];
        let phi = latitude.to_radians();
        let lambda = self.degrees_from_meridian(longitude).to_radians();
        let eccentricity = 2.0 * n.sqrt() / (1.0 + n);
        // Tangent of the conformal latitude.
        let conformal = (phi.sin().atanh() - eccentricity * (eccentricity * phi.sin()).atanh()).sinh();
        let xi = conformal.atan2(lambda.cos());
        let eta = (lambda.sin() / conformal.hypot(lambda.cos())).asinh();
        let mut easting = eta;
        let mut northing = xi;
        for (order, factor) in (1..).zip(series) {
            let angle = 2.0 * f64::from(order);
            northing += factor * (angle * xi).sin() * (angle * eta).cosh();
            easting += factor * (angle * xi).cos() * (angle * eta).sinh();
        }
        let false_northing_m = if self.is_south { FALSE_NORTHING_M } else { 0.0 };
        [
            FALSE_EASTING_M + CENTRAL_SCALE * rectifying_m * easting,
            false_northing_m + CENTRAL_SCALE * rectifying_m * northing,
        ]
    }
}

impl std::fmt::Display for Zone {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(formatter, "{}{}", self.number, if self.is_south { 'S' } else { 'N' })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_places_have_known_utm_coordinates() {
        // On the central meridian the northing is 0.9996 of the meridian arc: 4,984,944.378 m at 45°.
        let zone = Zone::of(9.0, 45.0);
        assert_eq!(zone.to_string(), "32N");
        let [easting, northing] = zone.project(9.0, 45.0);
        assert!((easting - 500_000.0).abs() < 1e-6, "{easting}");
        assert!((northing - 0.9996 * 4_984_944.378).abs() < 0.002, "{northing}");
        // The Eiffel Tower, according to maps.
        let [easting, northing] = Zone::of(2.294_5, 48.858_2).project(2.294_5, 48.858_2);
        assert!(
            (easting - 448_252.0).abs() < 20.0 && (northing - 5_411_943.0).abs() < 20.0,
            "{easting} {northing}"
        );
        // South of the equator northings count down from ten million.
        let south = Zone::of(-70.0, -33.0);
        assert_eq!(south.to_string(), "19S");
        let [_, here] = south.project(-69.0, -33.0);
        let [_, mirrored] = Zone {
            is_south: false,
            ..south
        }
        .project(-69.0, 33.0);
        assert!((here + mirrored - 10_000_000.0).abs() < 1e-6);
        assert_eq!(Zone::of(180.0, 0.0).number, 1);
    }

    #[test]
    fn the_zone_is_that_of_the_center() {
        let places = [[9.0, 45.0], [9.1, 45.1], [f64::NAN, 0.0], [150.0, -20.0]];
        let zone = Zone::of_center(places.into_iter()).unwrap();
        assert_eq!(zone.to_string(), "32N");
        assert!(zone.project_near(9.0, 45.0).is_ok());
        assert!(zone.project_near(150.0, -20.0).unwrap_err().contains("zone 32N"));
        assert_eq!(Zone::of_center([[f64::NAN, 1.0]].into_iter()), None);
        assert!(Zone::are_degrees(359.0, -90.0) && !Zone::are_degrees(500_000.0, 40.0));
    }

    #[test]
    fn projected_distances_match_ground_distances() {
        // An arc second of latitude is 30.9 m, one of longitude is that times the cosine, scaled by the scale factor of
        // the zone.
        let zone = Zone::of(-49.84, 69.33);
        let [x, y] = zone.project(-49.84, 69.33);
        let second = 1.0 / 3600.0;
        let [_, north] = zone.project(-49.84, 69.33 + second);
        let [east, _] = zone.project(-49.84 + second, 69.33);
        assert!((north - y - 31.0).abs() < 0.2, "{}", north - y);
        assert!((east - x - 10.95).abs() < 0.1, "{}", east - x);
    }
}
