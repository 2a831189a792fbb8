//! Point attributes in addition to positions: one list, from which follows all that is done to every attribute alike.

use super::{Ellipse, ScalarField, even_places};
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use std::ops::RangeInclusive;

/// Points that are worth handing to another thread.
const POINTS_PER_TASK: usize = 1 << 15;

/// Defines [`Attributes`], and the visitors of all of its arrays, from one line per attribute: field, entry, display
/// name.
macro_rules! attributes {
    ($($(#[$doc:meta])* $field:ident: $entry:ty = $name:literal,)*) => {
        /// Point attributes in addition to positions. Every array that is present has one entry per point.
        #[derive(Debug, Clone, PartialEq, Default)]
        pub struct Attributes {
            $($(#[$doc])* pub $field: Option<Vec<$entry>>,)*
            /// Further numbers, the one to colour by first.
            pub scalars: Vec<ScalarField>,
        }

        impl Attributes {
            /// The present arrays, in the order of the list.
            fn arrays(&self) -> impl Iterator<Item = Array<'_>> {
                let listed = [$(self.$field.as_deref().map(|entries| Array::of($name, entries))),*];
                let scalars = self.scalars.iter().map(|field| Array::of(&field.name, &field.values));
                listed.into_iter().flatten().chain(scalars)
            }

            /// Leaves the entries at `indices`, in their order. One array after the other, so that no more than one is
            /// in memory twice. Precondition: each index is below the length of every array.
            pub(super) fn keep(&mut self, indices: &[u32]) {
                $(self.$field = self.$field.take().map(|entries| gather(&entries, indices));)*
                for field in &mut self.scalars {
                    field.values = gather(&field.values, indices);
                }
            }

            /// The entries at `indices`, in their order: [`Attributes::keep`] of a copy.
            pub(crate) fn gathered(&self, indices: &[u32]) -> Self {
                let scalar = |field: &ScalarField| field.with_values(gather(&field.values, indices));
                Self {
                    $($field: self.$field.as_deref().map(|entries| gather(entries, indices)),)*
                    scalars: self.scalars.iter().map(scalar).collect(),
                }
            }
        }
    };
}

attributes! {
    /// 8-bit red, green, blue, alpha.
    colors: [u8; 4] = "color",
    /// Normals, of any length in a file.
    normals: [f32; 3] = "normal",
    /// Radii of the disks that stand for splats, in the unit of positions.
    radii: f32 = "radius",
    /// Shapes of splats that are longer in one direction, each with the area of the disk of its radius.
    ellipses: Ellipse = "ellipse",
}

/// An array of attributes with entries of any type.
struct Array<'a> {
    name: &'a str,
    len: usize,
    entry_bytes: usize,
}

impl<'a> Array<'a> {
    fn of<T>(name: &'a str, entries: &[T]) -> Self {
        Self {
            name,
            len: entries.len(),
            entry_bytes: size_of::<T>(),
        }
    }
}

impl Attributes {
    /// Names of the present attributes.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.arrays().map(|array| array.name)
    }

    /// Bytes that a point takes in all arrays.
    pub fn point_bytes(&self) -> usize {
        self.arrays().map(|array| array.entry_bytes).sum()
    }

    /// Name and length of the first array that has not `expected` entries.
    pub fn other_length(&self, expected: usize) -> Option<(&str, usize)> {
        let other = self.arrays().find(|array| array.len != expected);
        other.map(|array| (array.name, array.len))
    }

    /// Splats cover `factor` times the length in every direction: ellipses have the area of their disks.
    pub(super) fn scale_splats(&mut self, factor: f32) {
        for radius in self.radii.iter_mut().flatten() {
            *radius *= factor;
        }
    }

    /// Sanitises attributes: normals become unit vectors, or zero where there is no direction; radii become drawable, 0
    /// where there is none; scalars finite or NaN. Ellipses are retained where there is a normal and a radius, and
    /// become circles otherwise. Radii outside of `usable_radii` are missing.
    pub(super) fn make_usable(&mut self, usable_radii: &RangeInclusive<f32>) {
        for_each(self.normals.as_deref_mut(), |normal| *normal = unit_or_zero(*normal));
        for_each(self.radii.as_deref_mut(), |radius| {
            *radius = usable_radius(*radius, usable_radii);
        });
        for field in &mut self.scalars {
            for_each(Some(&mut field.values), |scalar| {
                if !scalar.is_finite() {
                    *scalar = f32::NAN;
                }
            });
        }
        self.ellipses = match (self.ellipses.take(), &self.normals, &self.radii) {
            (Some(mut ellipses), Some(normals), Some(radii)) => {
                for ((ellipse, normal), &radius) in ellipses.iter_mut().zip(normals).zip(radii) {
                    // An estimated disk must not be stretched by the ellipse of another one.
                    let is_splat = *normal != [0.0; 3] && radius > 0.0;
                    *ellipse = if is_splat { ellipse.usable() } else { Ellipse::CIRCLE };
                }
                Some(ellipses)
            }
            _ => None,
        };
    }
}

/// The values at `indices`. Precondition: each is below the number of values.
pub(super) fn gather<T: Copy + Send + Sync>(values: &[T], indices: &[u32]) -> Vec<T> {
    indices
        .par_iter()
        .with_min_len(POINTS_PER_TASK)
        .map(|&index| values[index as usize])
        .collect()
}

fn for_each<T: Send>(entries: Option<&mut [T]>, change: impl Fn(&mut T) + Sync + Send) {
    let entries = entries.unwrap_or_default().par_iter_mut();
    entries.with_min_len(POINTS_PER_TASK).for_each(change);
}

/// Most files have unit normals, and roots are slow.
fn unit_or_zero(normal: [f32; 3]) -> [f32; 3] {
    let vector = Vec3::from_array(normal);
    if (vector.length_squared() - 1.0).abs() <= 1e-6 {
        normal
    } else {
        let largest = vector.abs().max_element();
        // The square of a length of 1e30 is infinite, that of 1e-30 is 0; the direction is known all the same.
        let is_square_finite = (1e-15..1e15).contains(&largest);
        let scale = if is_square_finite { 1.0 } else { largest };
        (vector / scale).normalize_or_zero().to_array()
    }
}

fn usable_radius(radius: f32, usable: &RangeInclusive<f32>) -> f32 {
    if usable.contains(&radius) { radius } else { 0.0 }
}

/// The radii that splats among `count` points can have. A disk a thousand times as wide as most of the cloud is a wrong
/// number, which would cover everything; one of a billionth of a thousandth of the width is another, which no image
/// shows. The few points far away do not count.
pub(crate) fn usable_radii(count: usize, position: impl Fn(usize) -> DVec3) -> RangeInclusive<f32> {
    const SAMPLE: usize = 1 << 12;
    const MIN: usize = 20;
    const MAX_EXTENTS: f64 = 1000.0;
    const MIN_EXTENTS: f64 = 1e-12;
    // Squares of these are normal numbers.
    const ANY: RangeInclusive<f32> = 1e-15..=1e15;
    let places = even_places(count, SAMPLE).into_iter().map(position);
    let sample: Vec<DVec3> = places.filter(|position| position.is_finite()).collect();
    if sample.len() < MIN {
        return ANY;
    }
    let extent = |axis: usize| {
        let mut values: Vec<f64> = sample.iter().map(|position| position[axis]).collect();
        values.sort_unstable_by(f64::total_cmp);
        values[values.len() * 19 / 20] - values[values.len() / 20]
    };
    let extent = DVec3::new(extent(0), extent(1), extent(2)).length();
    if extent > 0.0 {
        (MIN_EXTENTS * extent) as f32..=(MAX_EXTENTS * extent) as f32
    } else {
        ANY
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// `count` entries of every attribute that there is, no two alike.
    fn all(count: usize) -> Attributes {
        let numbers = |offset: f32| (0..count).map(move |index| index as f32 + offset);
        Attributes {
            colors: Some((0..count).map(|index| [index as u8, 1, 2, 3]).collect()),
            normals: Some(numbers(0.5).map(|number| [number; 3]).collect()),
            radii: Some(numbers(0.25).collect()),
            ellipses: Some(
                numbers(1.0)
                    .map(|number| Ellipse {
                        axis: Vec3::X,
                        ratio: 1.0 / number,
                    })
                    .collect(),
            ),
            scalars: vec![
                ScalarField::new("heat", numbers(0.125).collect()),
                ScalarField::new("t", vec![0.0; count]),
            ],
        }
    }

    proptest! {
        #[test]
        fn every_array_retains_the_requested_entries(indices in prop::collection::vec(0u32..50, 0..60)) {
            let of_all = all(50);
            let gathered = of_all.gathered(&indices);
            let mut retained = of_all.clone();
            retained.keep(&indices);
            prop_assert_eq!(&retained, &gathered);
            prop_assert_eq!(gathered.other_length(indices.len()), None);
            prop_assert!(gathered.names().eq(of_all.names()));
            for (place, &index) in indices.iter().enumerate() {
                let at = |attributes: &Attributes, index: usize| {
                    let mut one = attributes.clone();
                    one.keep(&[index as u32]);
                    one
                };
                prop_assert_eq!(at(&gathered, place), at(&of_all, index as usize));
                prop_assert_eq!(gathered.radii.as_ref().unwrap()[place], index as f32 + 0.25);
                prop_assert_eq!(gathered.scalars[0].values[place], index as f32 + 0.125);
            }
        }
    }

    #[test]
    fn every_array_is_listed() {
        let mut attributes = all(3);
        let names: Vec<&str> = attributes.names().collect();
        assert_eq!(names, ["color", "normal", "radius", "ellipse", "heat", "t"]);
        assert_eq!(attributes.point_bytes(), 4 + 12 + 4 + 16 + 4 + 4);
        assert_eq!(attributes.other_length(3), None);
        assert_eq!(attributes.other_length(4), Some(("color", 3)));
        attributes.ellipses.as_mut().unwrap().pop();
        assert_eq!(attributes.other_length(3), Some(("ellipse", 2)));
        assert_eq!(Attributes::default().names().count(), 0);
        assert_eq!(Attributes::default().point_bytes(), 0);
    }

    #[test]
    fn absurd_radii_count_as_missing() {
        let place = |index: usize| DVec3::new(index as f64, 1.0, if index == 7 { 1e30 } else { 0.0 });
        let usable = usable_radii(1001, place);
        assert!((500_000.0..1_100_000.0).contains(usable.end()), "{usable:?}");
        for radius in [1e20, 1e-12, 1e-30, f32::INFINITY, f32::NAN, -1.0, f32::NEG_INFINITY] {
            assert_eq!(usable_radius(radius, &usable), 0.0, "{radius}");
        }
        assert_eq!(usable_radius(3.5, &usable), 3.5);
        // For any extent, squares of radii are finite.
        for usable in [usable_radii(5, place), usable_radii(100, |_| DVec3::ONE)] {
            for radius in [1e30, 1e-30, f32::NAN] {
                assert_eq!(usable_radius(radius, &usable), 0.0, "{radius}");
            }
            assert_eq!(usable_radius(1e9, &usable), 1e9);
        }
    }

    #[test]
    fn the_direction_of_a_normal_of_any_length_is_known() {
        let direction = Vec3::new(0.6, 0.0, -0.8);
        for length in [1e-40, 1e-30, 1e-3, 0.5, 1.0, 7.0, 1e19, 1e30, 3e38] {
            let [x, y, z] = (direction * length).to_array();
            let normal = Vec3::from_array(unit_or_zero([x, y, z]));
            // Numbers below 1e-38 have fewer digits.
            assert!((normal - direction).length() < 1e-4, "{length}: {normal}");
            assert!((normal.length() - 1.0).abs() < 1e-6, "{length}: {normal}");
        }
        for bad in [0.0, f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            assert_eq!(unit_or_zero([bad, 0.0, 0.0]), [0.0; 3], "{bad}");
            assert_eq!(unit_or_zero([bad; 3]), [0.0; 3], "{bad}");
        }
    }

    #[test]
    fn ellipses_are_retained_where_a_normal_and_a_radius_exist() {
        let mut attributes = all(4);
        let ellipse = Ellipse {
            axis: Vec3::Y,
            ratio: 0.5,
        };
        attributes.ellipses = Some(vec![ellipse; 4]);
        attributes.normals.as_mut().unwrap()[1] = [f32::NAN; 3];
        attributes.radii.as_mut().unwrap()[2] = -1.0;
        let mut bare = Attributes {
            radii: None,
            ..attributes.clone()
        };
        attributes.make_usable(&(0.0..=f32::MAX));
        let expected = [ellipse, Ellipse::CIRCLE, Ellipse::CIRCLE, ellipse];
        assert_eq!(attributes.ellipses.unwrap(), expected);
        bare.make_usable(&(0.0..=f32::MAX));
        assert_eq!(bare.ellipses, None);
    }
}
