//! What points have beside their positions: one list, from which follows all that is done to every attribute alike.

use super::{CloudError, Ellipse, ScalarField};
use glam::Vec3;
use rayon::prelude::*;

/// Points that are worth handing to another thread.
const POINTS_PER_TASK: usize = 1 << 15;

/// Defines [`Attributes`], and what visits all of its arrays, from a line an attribute: field, entry, name for people.
macro_rules! attributes {
    ($($(#[$doc:meta])* $field:ident: $entry:ty = $name:literal,)*) => {
        /// What points have beside their positions. Every array that is there has one entry a point.
        #[derive(Debug, Clone, PartialEq, Default)]
        pub struct Attributes {
            $($(#[$doc])* pub $field: Option<Vec<$entry>>,)*
            /// Further numbers, the one to colour by first.
            pub scalars: Vec<ScalarField>,
        }

        impl Attributes {
            /// The arrays that are there, in the order of the list.
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
            pub(super) fn gathered(&self, indices: &[u32]) -> Self {
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
    /// Shapes of splats that are longer in one direction, each with the area of the disk that its radius says.
    ellipses: Ellipse = "ellipse",
}

/// An array of attributes, whatever its entries are.
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
    /// Names of the attributes that are there.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.arrays().map(|array| array.name)
    }

    /// Bytes that a point takes in all arrays.
    pub fn point_bytes(&self) -> usize {
        self.arrays().map(|array| array.entry_bytes).sum()
    }

    /// Fails unless every array has `expected` entries.
    pub(super) fn check_lengths(&self, expected: usize) -> Result<(), CloudError> {
        match self.arrays().find(|array| array.len != expected) {
            Some(array) => Err(CloudError::LengthMismatch {
                attribute: array.name.to_owned(),
                expected,
                found: array.len,
            }),
            None => Ok(()),
        }
    }

    /// Splats cover `factor` times the length in every direction: ellipses have the area of their disks.
    pub(super) fn scale_splats(&mut self, factor: f32) {
        for radius in self.radii.iter_mut().flatten() {
            *radius *= factor;
        }
    }

    /// Normals become unit vectors, or zero where there is no direction; radii such that can be drawn, 0 where there is
    /// none; scalars finite or NaN. Ellipses stay beside a normal and a radius, and are circles otherwise.
    pub(super) fn make_usable(&mut self) {
        for_each(self.normals.as_deref_mut(), |normal| *normal = unit_or_zero(*normal));
        for_each(self.radii.as_deref_mut(), |radius| *radius = usable_radius(*radius));
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
        vector.normalize_or_zero().to_array()
    }
}

fn usable_radius(radius: f32) -> f32 {
    if radius.is_nan() {
        0.0
    } else {
        radius.clamp(0.0, f32::MAX)
    }
}
