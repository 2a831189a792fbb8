//! The unit of coordinates, as far as the coordinate reference system states it explicitly: a key of `GeoTIFF`, or the
//! unit of a projection in well-known text. Codes of the EPSG registry are not looked up.

use super::header::Record;
use super::reference_system::{self, GeoKeys, metres_of_unit};
use crate::cloud::LengthUnit;

/// The key of `GeoTIFF` with the unit of projected coordinates (OGC 19-008, `ProjLinearUnitsGeoKey`).
const LINEAR_UNITS_KEY: u16 = 3076;

/// The unit that `records` say; of several the first.
pub(super) fn unit<'a>(records: impl Iterator<Item = Record<'a>>) -> Option<LengthUnit> {
    reference_system::find(records, of_geo_keys, of_text)
}

fn of_geo_keys(keys: &GeoKeys<'_>) -> Option<LengthUnit> {
    LengthUnit::of_epsg(keys.value(LINEAR_UNITS_KEY)?)
}

/// Returns the unit in `PROJCS["…", GEOGCS[…], …, UNIT["metre",1], …]`, or `PROJCRS[…, LENGTHUNIT["metre",1]]`: the one
/// that belongs to the projection itself, or to its first axis.
fn of_text(text: &str) -> Option<LengthUnit> {
    let start = ["PROJCS[", "PROJCRS["]
        .iter()
        .find_map(|word| text.find(word).map(|at| at + word.len()))?;
    // The geographic system that is projected has a unit as well, an angular one.
    let (mut depth, mut is_quoted) = (1, false);
    for (place, character) in text[start..].char_indices() {
        match character {
            '"' => is_quoted = !is_quoted,
            '[' if !is_quoted => depth += 1,
            ']' if !is_quoted => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            return None;
        }
        let rest = &text[start + place..];
        let is_word = !is_quoted && depth <= 2;
        if is_word
            && let Some(unit) = rest.strip_prefix("LENGTHUNIT[").or_else(|| {
                let has_place = depth == 1 && rest.starts_with("UNIT[");
                rest.strip_prefix("UNIT[").filter(|_| has_place)
            })
        {
            return LengthUnit::of_metres(metres_of_unit(unit)?);
        }
    }
    None
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

    #[test]
    fn geo_keys_and_wkt_declare_units() {
        let keys = |unit: u16| -> Vec<u8> {
            let numbers = [1, 1, 0, 2, 1024, 0, 1, 1, 3076, 0, 1, unit];
            numbers.iter().flat_map(|number| number.to_le_bytes()).collect()
        };
        for (code, expected) in [
            (9001, Some(LengthUnit::Metre)),
            (9002, Some(LengthUnit::Foot)),
            (9003, Some(LengthUnit::SurveyFoot)),
            (9102, None),
        ] {
            let data = keys(code);
            assert_eq!(unit([record(GEO_KEYS_ID, &data)].into_iter()), expected);
            let cut = &data[..data.len() - 3];
            assert_eq!(unit([record(GEO_KEYS_ID, cut)].into_iter()), None);
        }
        let texts = [
            (
                concat!(
                    r#"PROJCS["UTM",GEOGCS["WGS 84",DATUM["D",SPHEROID["S",6378137,298.25]],UNIT["degree","#,
                    r#"0.0174532925199433]],PROJECTION["P"],UNIT["metre",1,AUTHORITY["EPSG","9001"]],AXIS["E",EAST]]"#,
                ),
                Some(LengthUnit::Metre),
            ),
            (
                concat!(
                    r#"COMPD_CS["c",PROJCS["CA",GEOGCS["g",UNIT["degree",0.017]],UNIT["US survey foot [x]","#,
                    r#"0.304800609601219]],VERT_CS["v",UNIT["metre",1]]]"#,
                ),
                Some(LengthUnit::SurveyFoot),
            ),
            (
                concat!(
                    r#"PROJCRS["p",BASEGEOGCRS["b",DATUM["d",ELLIPSOID["e",6378137,298.25,LENGTHUNIT["metre",1]]]],"#,
                    r#"CS[Cartesian,2],AXIS["E",east],LENGTHUNIT["foot",0.3048]]"#,
                ),
                Some(LengthUnit::Foot),
            ),
            (r#"GEOGCS["WGS 84",UNIT["degree",0.0174532925199433]]"#, None),
            (r#"PROJCS["cut",UNIT["metre""#, None),
            ("", None),
        ];
        for (text, expected) in texts {
            let found = unit([record(WELL_KNOWN_TEXT_ID, text.as_bytes())].into_iter());
            assert_eq!(found, expected, "{text}");
        }
    }
}
