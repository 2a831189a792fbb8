//! Records with the coordinate reference system: keys of `GeoTIFF`, or well-known text.

use super::header::{Record, take};

/// User ID of the records with coordinate reference systems.
pub(super) const PROJECTION_USER: &[u8] = b"LASF_Projection";
pub(super) const GEO_KEYS_ID: u16 = 34735;
pub(super) const WELL_KNOWN_TEXT_ID: u16 = 2112;

/// The first answer that `of_keys` or `of_text` has to one of `records`.
pub(super) fn find<'a, T>(
    mut records: impl Iterator<Item = Record<'a>>,
    of_keys: impl Fn(&GeoKeys<'_>) -> Option<T>,
    of_text: impl Fn(&str) -> Option<T>,
) -> Option<T> {
    records.find_map(|record| {
        if record.is(PROJECTION_USER, GEO_KEYS_ID) {
            of_keys(&GeoKeys(record.data))
        } else if record.is(PROJECTION_USER, WELL_KNOWN_TEXT_ID) {
            of_text(&String::from_utf8_lossy(record.data))
        } else {
            None
        }
    })
}

/// Keys of `GeoTIFF` (OGC 19-008), four numbers per key: which, where its value is (0: in the last number), how many
/// and which. The first four count the keys.
pub(super) struct GeoKeys<'a>(&'a [u8]);

impl GeoKeys<'_> {
    /// The value of the key `wanted`, if it is stored in the key itself.
    pub(super) fn value(&self, wanted: u16) -> Option<u16> {
        let (keys, _) = self.0.as_chunks::<8>();
        let number = |key: &[u8; 8], index: usize| u16::from_le_bytes(take(key, 2 * index));
        let mut keys = keys.iter().skip(1);
        let key = keys.find(|key| number(key, 0) == wanted && number(key, 1) == 0)?;
        Some(number(key, 3))
    }
}

/// The factor to metres of `"metre",1]`, the text behind `UNIT[`; the name may have brackets.
pub(super) fn metres_of_unit(unit: &str) -> Option<f64> {
    let factor = unit.split('"').nth(2)?.split([',', ']']).nth(1)?;
    factor.trim().parse().ok()
}
