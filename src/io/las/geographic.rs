//! Coordinates in degrees: where the coordinate reference system is a geographic one, longitudes and latitudes become
//! metres, as those of text do ([`crate::io::utm`]).
//!
//! The keys of `GeoTIFF` say it by the type of the model, or by a geographic system without a projected one; well-known
//! text says it by a geographic system that no projection is around. Files with such a record and coordinates that are
//! no degrees are common, as programs reproject points and leave the record: those are left as they are.

use super::header::{Record, take};
use super::unit::{GEO_KEYS_ID, PROJECTION_USER, WELL_KNOWN_TEXT_ID};
use crate::assumption::{Assumption, Evidence, Subject};
use crate::cloud::{LengthUnit, Positions, RawCloud};
use crate::io::error::Fault;
use crate::io::utm::Zone;

/// Keys of `GeoTIFF` (OGC 19-008): the type of the model, systems of angles and of projections, the unit of angles and
/// that of heights.
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
fn system<'a>(mut records: impl Iterator<Item = Record<'a>>) -> Option<System> {
    records.find_map(|record| {
        if record.is(PROJECTION_USER, GEO_KEYS_ID) {
            of_geo_keys(record.data)
        } else if record.is(PROJECTION_USER, WELL_KNOWN_TEXT_ID) {
            of_text(&String::from_utf8_lossy(record.data))
        } else {
            None
        }
    })
}

fn of_geo_keys(data: &[u8]) -> Option<System> {
    let (keys, _) = data.as_chunks::<8>();
    // The first four numbers count the keys; a value is in its key where the second number is 0.
    let value = |wanted: u16| {
        let number = |key: &[u8; 8], index: usize| u16::from_le_bytes(take(key, 2 * index));
        let mut keys = keys.iter().skip(1);
        let key = keys.find(|key| number(key, 0) == wanted && number(key, 1) == 0)?;
        Some(number(key, 3))
    };
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
        // Behind the name, which may have brackets.
        let factor = unit.split('"').nth(2)?.split([',', ']']).nth(1)?;
        LengthUnit::of_metres(factor.trim().parse().ok()?)
    });
    Some(System::Geographic { height })
}

/// `cloud`, in metres of a zone where `records` say that its coordinates are longitude, latitude and height.
pub(super) fn project<'a>(mut cloud: RawCloud, records: impl Iterator<Item = Record<'a>>) -> Result<RawCloud, Fault> {
    let Some(System::Geographic { height }) = system(records) else {
        return Ok(cloud);
    };
    let Positions::F64(points) = &mut cloud.positions else {
        return Ok(cloud);
    };
    let are_degrees = |order: [usize; 2]| {
        let [longitude, latitude] = order;
        points
            .iter()
            .all(|point| Zone::are_degrees(point[longitude], point[latitude]))
    };
    let Some([longitude, latitude]) = ORDERS.into_iter().find(|&order| are_degrees(order)) else {
        log::warn!(
            "the coordinate reference system is one of degrees, and the coordinates are none: they are left as they are"
        );
        return Ok(cloud);
    };
    let Some(zone) = Zone::of_middle(points.iter().map(|point| [point[longitude], point[latitude]])) else {
        return Ok(cloud);
    };
    let height_m = height.map_or(1.0, LengthUnit::metres);
    for (index, point) in points.iter_mut().enumerate() {
        let [x, y] = zone
            .project_near(point[longitude], point[latitude])
            .map_err(|problem| Fault::entry("point", index, problem))?;
        *point = [x, y, point[2] * height_m];
    }
    cloud.unit = Some(LengthUnit::Metre);
    let heights = match height {
        Some(unit) => format!("heights are in {}", unit.symbol()),
        None => "heights are taken as metres".to_owned(),
    };
    let (order, evidence) = if longitude == 0 {
        ("X as longitude", Evidence::File)
    } else {
        ("X as latitude, since Y goes beyond 90", Evidence::Statistics)
    };
    let why = format!("the coordinate reference system is one of degrees, taken as WGS 84, {order}; {heights}");
    let projection = Assumption::new(Subject::Projection, format!("UTM zone {zone}, metres"), why, evidence);
    cloud.assumptions.push(projection.with_option(None));
    Ok(cloud)
}

#[cfg(test)]
mod tests {
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
    fn keys_and_text_say_degrees() {
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
    fn degrees_become_metres_and_others_stay() {
        let data = keys(&[(1024, 2), (4099, 9002)]);
        let records = || [record(GEO_KEYS_ID, &data)].into_iter();
        let of = |points: Vec<[f64; 3]>| project(RawCloud::from_positions(Positions::F64(points)), records()).unwrap();
        let cloud = of(vec![[9.0, 45.0, 100.0], [9.0, 45.0, 0.0]]);
        let Positions::F64(points) = &cloud.positions else {
            panic!("narrow positions")
        };
        let [x, y, z] = points[0];
        assert!(
            (x - 500_000.0).abs() < 1e-6 && (y - 0.9996 * 4_984_944.378).abs() < 0.002,
            "{x} {y}"
        );
        assert!((z - 30.48).abs() < 1e-9, "{z}");
        assert_eq!(cloud.unit, Some(LengthUnit::Metre));
        let [assumption] = &cloud.assumptions[..] else {
            panic!("{:?}", cloud.assumptions)
        };
        assert_eq!(assumption.subject, Subject::Projection);
        assert_eq!(assumption.evidence, Evidence::File);
        assert!(assumption.value.contains("32N") && assumption.option.is_none());
        // Latitude first, which can only be told beyond 90 degrees.
        let turned = of(vec![[45.0, -93.0, 0.0]]);
        let Positions::F64(points) = &turned.positions else {
            panic!("narrow positions")
        };
        assert!((points[0][0] - 500_000.0).abs() < 1e-6, "{:?}", points[0]);
        assert_eq!(turned.assumptions[0].evidence, Evidence::Statistics);
        // The record was left behind by a program that projected the points.
        let projected = of(vec![[637_000.0, 849_000.0, 1.0]]);
        assert!(projected.assumptions.is_empty() && projected.unit.is_none());
        let far = vec![[9.0, 45.0, 0.0], [9.0, 45.0, 0.0], [150.0, 0.0, 0.0]];
        let fault = project(RawCloud::from_positions(Positions::F64(far)), records()).unwrap_err();
        assert!(fault.problem.contains("150"), "{}", fault.problem);
    }
}
