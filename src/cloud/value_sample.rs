//! Some points of the first frame of a sequence: they decide the settings common to all of its frames.
//!
//! How it works: points are taken evenly from the order of the file, so the sample does not read the rest of them, and
//! equal files have equal samples. Each frame of a sequence shares the one of the first frame that can be read
//! ([`super::Frame::value_sample`]), so its results are the same for all frames, whichever of them was seen first.
//! Values are sorted when they are first needed.

use super::{RawCloud, ScalarField, even_places};
use crate::locks::lock;
use crate::math::Aabb;
use glam::{DVec3, Vec3};
use std::sync::{Arc, Mutex, OnceLock};

/// Most points of a sample: enough that a percentile is a tenth of a percent off.
pub(crate) const MAX_SAMPLE: usize = 1 << 15;

/// Max number of sorted value kinds that are cached.
const MAX_RETAINED: usize = 32;

/// A number of each point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ValueKind {
    /// A scalar field, by its place in [`ValueSample::scalars`]; [`ScalarField::offset`] is not added.
    Field(usize),
    /// Signed distance of the point along this vector from the origin of the sequence.
    Along(Vec3),
    /// The distance from here, relative to the origin of the sequence.
    From(Vec3),
}

/// Points of a frame with their attributes.
#[derive(Debug, Default)]
pub struct ValueSample {
    /// Finite positions relative to `origin`.
    pub positions: Vec<Vec3>,
    /// Their colours in the file.
    pub colors: Option<Vec<[u8; 4]>>,
    /// Their scalar fields; NaN and infinite where the file has that.
    pub scalars: Vec<ScalarField>,
    /// Values of the same fields in other frames of the sequence.
    further: Vec<Vec<f32>>,
    /// Sensor position, relative to `origin`.
    pub sensor: Option<Vec3>,
    /// The origin of the sequence in file coordinates.
    pub origin: DVec3,
    has_telling_colors: OnceLock<bool>,
    /// Ascending finite values, as requested.
    sorted: Mutex<Vec<(ValueKind, Arc<[f32]>)>>,
}

impl ValueSample {
    /// A sample of `raw` without the points at the indices `missing`, which ascend. Attributes of another length are
    /// skipped.
    pub(crate) fn of_raw(raw: &RawCloud, missing: &[u32], origin: DVec3) -> Self {
        let count = raw.positions.len();
        let position = |index: usize| (raw.positions.get(index) - origin).as_vec3();
        let mut places = even_places(count, MAX_SAMPLE);
        let is_missing = |index: usize| missing.binary_search(&(index as u32)).is_ok();
        places.retain(|&index| position(index).is_finite() && !is_missing(index));
        let colors = raw.attributes.colors.as_ref().filter(|colors| colors.len() == count);
        let fields = raw.attributes.scalars.iter();
        let fields = fields.filter(|field| field.values.len() == count);
        let at_places = |values: &[f32]| places.iter().map(|&place| values[place]).collect();
        let sampled = |field: &ScalarField| field.with_values(at_places(&field.values));
        Self {
            positions: places.iter().map(|&place| position(place)).collect(),
            colors: colors.map(|colors| places.iter().map(|&place| colors[place]).collect()),
            scalars: fields.map(sampled).collect(),
            further: Vec::new(),
            sensor: raw.sensor.map(|sensor| (sensor - origin).as_vec3()),
            origin,
            has_telling_colors: OnceLock::new(),
            sorted: Mutex::default(),
        }
    }

    /// Adds values of the scalar fields of another frame, with the weight of the existing ones: a field has one range
    /// for all frames.
    pub(crate) fn add_scalars_of(&mut self, raw: &RawCloud) {
        self.further.resize(self.scalars.len(), Vec::new());
        for (field, further) in self.scalars.iter().zip(&mut self.further) {
            let mut others = raw.attributes.scalars.iter();
            let Some(other) = others.find(|other| other.name == field.name && !other.values.is_empty()) else {
                continue;
            };
            let places = even_places(other.values.len(), field.values.len().max(1));
            let shift = other.offset - field.offset;
            let moved = places
                .iter()
                .map(|&place| (f64::from(other.values[place]) + shift) as f32);
            let moved: Vec<f32> = moved.collect();
            for _ in 0..(field.values.len() / moved.len()).max(1) {
                further.extend_from_slice(&moved);
            }
        }
    }

    /// A sample of a frame that belongs to no sequence.
    pub(super) fn of_arrays(
        positions: &[Vec3],
        colors: Option<&[[u8; 4]]>,
        scalars: &[ScalarField],
        sensor: Option<Vec3>,
    ) -> Self {
        let places = even_places(positions.len(), MAX_SAMPLE);
        let at_places = |values: &[f32]| places.iter().map(|&place| values[place]).collect();
        let sampled = |field: &ScalarField| field.with_values(at_places(&field.values));
        Self {
            positions: places.iter().map(|&place| positions[place]).collect(),
            colors: colors.map(|colors| places.iter().map(|&place| colors[place]).collect()),
            scalars: scalars.iter().map(sampled).collect(),
            further: Vec::new(),
            sensor,
            origin: DVec3::ZERO,
            has_telling_colors: OnceLock::new(),
            sorted: Mutex::default(),
        }
    }

    /// Returns true if the file's colours carry information: they are not all the same, nor all black or white, as
    /// programs without colours write.
    pub fn has_telling_colors(&self) -> bool {
        *self.has_telling_colors.get_or_init(|| {
            let colors = self.colors.as_deref().unwrap_or_default();
            let opaque = |[red, green, blue, _]: [u8; 4]| [red, green, blue];
            let mut colors = colors.iter().map(|&color| opaque(color));
            let Some(first) = colors.next() else {
                return false;
            };
            let is_plain = |color: [u8; 3]| color == [0; 3] || color == [255; 3];
            let (mut differs, mut is_colored) = (false, !is_plain(first));
            colors.any(|color| {
                differs |= color != first;
                is_colored |= !is_plain(color);
                differs && is_colored
            })
        })
    }

    /// The box around the points.
    pub fn bounds(&self) -> Aabb {
        Aabb::from_points(&self.positions)
    }

    /// The finite values of the points, ascending.
    pub fn sorted(&self, kind: ValueKind) -> Arc<[f32]> {
        let mut retained = lock(&self.sorted);
        if let Some((_, values)) = retained.iter().find(|(known, _)| *known == kind) {
            return Arc::clone(values);
        }
        let positions = self.positions.iter();
        let mut values: Vec<f32> = match kind {
            ValueKind::Field(place) => {
                let own = self.scalars.get(place).map(|field| &field.values);
                let values = own.into_iter().chain(self.further.get(place)).flatten();
                values.copied().collect()
            }
            ValueKind::Along(up) => positions.map(|position| position.dot(up)).collect(),
            ValueKind::From(place) => positions.map(|position| position.distance(place)).collect(),
        };
        values.retain(|value| value.is_finite());
        values.sort_unstable_by(f32::total_cmp);
        let values: Arc<[f32]> = values.into();
        if retained.len() == MAX_RETAINED {
            retained.remove(0);
        }
        retained.push((kind, Arc::clone(&values)));
        values
    }
}

/// The sample of a frame, ignored when frames are compared.
#[derive(Debug, Clone, Default)]
pub(super) struct SharedSample(pub(super) OnceLock<Arc<ValueSample>>);

impl PartialEq for SharedSample {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cloud::Positions;

    fn raw(count: usize) -> RawCloud {
        let position = |index: usize| [index as f64 + 1e6, 2.0, 0.0];
        let mut raw = RawCloud::from_positions(Positions::F64((0..count).map(position).collect()));
        let values = (0..count).map(|index| (count - index) as f32).collect();
        raw.attributes.scalars = vec![ScalarField::new("intensity", values)];
        raw
    }

    #[test]
    fn a_small_cloud_is_its_own_sample() {
        let mut raw = raw(4);
        raw.attributes.scalars[0].values[1] = f32::NAN;
        raw.attributes.scalars[0].values[2] = f32::INFINITY;
        raw.attributes.scalars.push(ScalarField::new("short", vec![1.0]));
        let sample = ValueSample::of_raw(&raw, &[], DVec3::new(1e6, 0.0, 0.0));
        assert_eq!(sample.positions[3], Vec3::new(3.0, 2.0, 0.0));
        assert_eq!(sample.scalars.len(), 1);
        assert_eq!(sample.sorted(ValueKind::Field(0))[..], [1.0, 4.0]);
        assert_eq!(
            sample.sorted(ValueKind::Along(Vec3::NEG_X))[..],
            [-3.0, -2.0, -1.0, -0.0]
        );
        assert_eq!(sample.sorted(ValueKind::From(Vec3::ZERO))[0], 2.0);
        assert!(sample.sorted(ValueKind::Field(7)).is_empty());
    }

    #[test]
    fn all_frames_have_equal_weight() {
        let mut sample = ValueSample::of_raw(&raw(4), &[], DVec3::ZERO);
        let mut other = raw(2);
        other.attributes.scalars[0].values = vec![100.0, 200.0];
        sample.add_scalars_of(&other);
        let expected = [1.0, 2.0, 3.0, 4.0, 100.0, 100.0, 200.0, 200.0];
        assert_eq!(sample.sorted(ValueKind::Field(0))[..], expected);
    }

    #[test]
    fn a_large_cloud_has_a_bounded_sample_with_similar_percentiles() {
        let sample = ValueSample::of_raw(&raw(200_000), &[], DVec3::ZERO);
        assert_eq!(sample.positions.len(), MAX_SAMPLE);
        let sorted = sample.sorted(ValueKind::Field(0));
        for share in [0.01, 0.5, 0.99] {
            let found = sorted[(share * sorted.len() as f64) as usize];
            assert!((f64::from(found) - share * 200_000.0).abs() < 200.0, "{share}: {found}");
        }
    }
}
