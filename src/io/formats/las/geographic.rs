//! Coordinates in degrees: detection of geographic coordinate reference systems.
//!
//! `GeoTIFF` keys have it as the type of the model, or as a geographic system without a projected one; well-known text
//! as a geographic system without an enclosing projection. Files with such a record and coordinates that are not
//! degrees are common, as programs reproject points and leave the record: those are left as they are.

use super::header::Record;
use super::reference_system::{self, GeoKeys, metres_of_unit};
use crate::assumption::{Assumption, Evidence, Subject};
use crate::cloud::{LengthUnit, Positions, RawCloud};
use crate::io::files::utm::Zone;

/// Keys of `GeoTIFF` (OGC 19-008): the type of the model, systems of angles and of projections, units of angles and of
/// heights.
const MODEL_KEY: u16 = 1024;
const GEOGRAPHIC_KEY: u16 = 2048;
const ANGLE_UNITS_KEY: u16 = 2054;
const PROJECTED_KEY: u16 = 3072;
const HEIGHT_UNITS_KEY: u16 = 4099;

const PROJECTED_MODEL: u16 = 1;
const GEOGRAPHIC_MODEL: u16 = 2;
/// The axes of longitude and latitude: as LAS has them, and as some programs write them, in the order of EPSG.
const ORDERS: [[usize; 2]; 2] = [[0, 1], [1, 0]];

/// EPSG's code of the degree.
const DEGREE: u16 = 9102;

/// A system that a record names.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum System {
    /// Longitude, latitude and height.
    Geographic {
        /// The unit of heights, if it is said.
        height: Option<LengthUnit>,
    },
    /// A projected or geocentric one, or one of other angles.
    Other,
}

/// The first system that `records` name.
fn system<'a>(records: impl Iterator<Item = Record<'a>>) -> Option<System> {
    reference_system::find(records, of_geo_keys, of_text)
}

fn of_geo_keys(keys: &GeoKeys<'_>) -> Option<System> {
    let value = |key: u16| keys.value(key);
    let model = value(MODEL_KEY);
    let has_angles = value(GEOGRAPHIC_KEY).is_some() && value(PROJECTED_KEY).is_none();
    let is_geographic = model == Some(GEOGRAPHIC_MODEL) || (model != Some(PROJECTED_MODEL) && has_angles);
    if model.is_none() && !has_angles && value(PROJECTED_KEY).is_none() {
        return None;
    }
    let are_degrees = value(ANGLE_UNITS_KEY).is_none_or(|unit| unit == DEGREE);
    if !is_geographic || !are_degrees {
        return Some(System::Other);
    }
    let height = value(HEIGHT_UNITS_KEY).and_then(LengthUnit::of_epsg);
    Some(System::Geographic { height })
}

/// `GEOGCS["…", …]`, perhaps in a `COMPD_CS` with a `VERT_CS["…", UNIT["metre", 1]]`; or `GEOGCRS`.
fn of_text(text: &str) -> Option<System> {
    const PROJECTED: [&str; 3] = ["PROJCS[", "PROJCRS[", "PROJECTEDCRS["];
    const GEOGRAPHIC: [&str; 4] = ["GEOGCS[", "GEOGCRS[", "GEOGRAPHICCRS[", "GEODCRS["];
    let has = |words: &[&str]| words.iter().any(|word| text.contains(word));
    if has(&PROJECTED) {
        return Some(System::Other);
    }
    if !has(&GEOGRAPHIC) || text.contains("CS[Cartesian") || text.contains("GEOCCS[") {
        return None;
    }
    let vertical = ["VERT_CS[", "VERTCRS[", "VERTICALCRS["]
        .iter()
        .find_map(|word| text.find(word));
    let height = vertical.and_then(|at| {
        let unit = text.get(at..)?.split("UNIT[").nth(1)?;
        LengthUnit::of_metres(metres_of_unit(unit)?)
    });
    Some(System::Geographic { height })
}

/// Says of `cloud` that its coordinates are longitude, latitude and height, where `records` say so. They stay as they
/// are: other readers have the same numbers.
pub(super) fn note<'a>(cloud: &mut RawCloud, records: impl Iterator<Item = Record<'a>>) {
    let Some(System::Geographic { height }) = system(records) else {
        return;
    };
    let Positions::F64(points) = &cloud.positions else {
        return;
    };
    let are_degrees = |[longitude, latitude]: [usize; 2]| {
        let mut places = points.iter().map(|point| (point[longitude], point[latitude]));
        places.all(|(longitude, latitude)| Zone::are_degrees(longitude, latitude))
    };
    // Some programs reproject points but leave the record unchanged.
    let Some([longitude, latitude]) = ORDERS.into_iter().find(|&order| are_degrees(order)) else {
        return;
    };
    let Some(zone) = Zone::of_center(points.iter().map(|point| [point[longitude], point[latitude]])) else {
        return;
    };
    let unit = height.unwrap_or(LengthUnit::Metre).symbol();
    cloud.unit = None;
    cloud.warnings.push(format!(
        "the coordinates are degrees, and heights are {unit}: pictures and distances are wrong; project it to metres \
         first, such as with PDAL (pdal translate IN OUT reprojection --filters.reprojection.out_srs=EPSG:{})",
        zone.epsg()
    ));
    let why = "the coordinate reference system of the file is one of degrees";
    let assumption = Assumption::new(Subject::Projection, "none: degrees as they are", why, Evidence::File);
    cloud.assumptions.push(assumption.with_option(None));
}

#[cfg(test)]
mod tests {
    use super::super::reference_system::{GEO_KEYS_ID, PROJECTION_USER, WELL_KNOWN_TEXT_ID};
    use super::*;

    fn record(id: u16, data: &[u8]) -> Record<'_> {
        Record {
            user: PROJECTION_USER,
            id,
            data,
        }
    }

    fn keys(values: &[(u16, u16)]) -> Vec<u8> {
        let head = [1, 1, 0, values.len() as u16];
        let rows = values.iter().flat_map(|&(key, value)| [key, 0, 1, value]);
        head.into_iter().chain(rows).flat_map(u16::to_le_bytes).collect()
    }

    #[test]
    fn geo_keys_and_wkt_declare_degrees() {
        let metres = Some(System::Geographic { height: None });
        let other = Some(System::Other);
        let feet = Some(System::Geographic {
            height: Some(LengthUnit::SurveyFoot),
        });
        for (values, expected) in [
            (&[(1024, 2), (2048, 4326)][..], metres),
            (&[(2048, 4326)], metres),
            (&[(1024, 2), (2048, 4269), (4099, 9003)], feet),
            (&[(1024, 1), (2048, 4269), (3072, 26910)], other),
            (&[(2048, 4269), (3072, 26910)], other),
            (&[(1024, 3)], other),
            (&[(1024, 2), (2054, 9101)], other),
            (&[], None),
        ] {
            let data = keys(values);
            assert_eq!(system([record(GEO_KEYS_ID, &data)].into_iter()), expected, "{values:?}");
        }
        let angles = r#"GEOGCS["WGS 84",DATUM["D",SPHEROID["S",6378137,298.25]],UNIT["degree",0.0174532925199433]]"#;
        let vertical = r#"VERT_CS["NAVD88",VERT_DATUM["V",2005],UNIT["US survey foot [x]",0.304800609601219]]"#;
        for (text, expected) in [
            (angles.to_owned(), metres),
            (format!(r#"COMPD_CS["c",{angles},{vertical}]"#), feet),
            (format!(r#"PROJCS["p",{angles},UNIT["metre",1]]"#), other),
            (
                r#"GEOGCRS["WGS 84",DATUM["D",ELLIPSOID["e",6378137,298.25]],CS[ellipsoidal,2]]"#.to_owned(),
                metres,
            ),
            (r#"GEODCRS["WGS 84",CS[Cartesian,3]]"#.to_owned(), None),
            (String::new(), None),
        ] {
            let found = system([record(WELL_KNOWN_TEXT_ID, text.as_bytes())].into_iter());
            assert_eq!(found, expected, "{text}");
        }
    }

    #[test]
    fn degrees_are_unchanged_and_reported() {
        let data = keys(&[(1024, 2), (4099, 9002)]);
        let noted = |points: Vec<[f64; 3]>| {
            let mut cloud = RawCloud::from_positions(Positions::F64(points));
            cloud.unit = Some(LengthUnit::Metre);
            note(&mut cloud, [record(GEO_KEYS_ID, &data)].into_iter());
            cloud
        };
        let points = vec![[9.0, 45.0, 100.0], [9.0, 45.0, 0.0]];
        let cloud = noted(points.clone());
        assert_eq!((cloud.positions, cloud.unit), (Positions::F64(points), None));
        assert!(cloud.warnings[0].contains("heights are ft") && cloud.warnings[0].contains("EPSG:32632"));
        assert_eq!(cloud.assumptions[0].subject, Subject::Projection);
        let projected = noted(vec![[500_000.0, 4_900_000.0, 10.0]]);
        assert!(projected.warnings.is_empty() && projected.unit.is_some());
    }
}
