//! Schema of a cloud: the attributes it has, and how options have them written.

use super::floats::Lattice;
use super::schema::{Retained, ScalarSchema, Schema, Values};
use crate::cloud::{Positions, RawCloud};
use crate::reel::options::{Coding, Precision, ReelOptions};
use crate::reel::parent_level::ParentValue;
use glam::Vec3;

/// The schema of a cloud of a group; scalars of a group share their steps.
pub(super) fn schema(
    cloud: &RawCloud,
    group: &[&RawCloud],
    retained: Retained,
    lattice: Option<Lattice>,
    options: &ReelOptions,
) -> Schema {
    let attributes = &cloud.attributes;
    let is_merged = retained == Retained::Merged;
    let has_normals = attributes.normals.is_some();
    let is_exact = options.normal_bits == 0 && !is_merged;
    let normal_bits = match options.normal_bits {
        _ if !has_normals => 0,
        0 if is_merged => 17,
        0 => 13,
        bits => bits,
    };
    let unusable = |normal: &[f32; 3]| !is_usable(*normal);
    let exact_scalars = options.scalar_bits == 0 && !is_merged;
    let scalar_bits = match options.scalar_bits {
        0 if is_merged => 16,
        0 => 8,
        bits => bits,
    };
    let is_sampled = options.precision == Precision::SamplingDensity;
    Schema {
        coding: options.coding,
        is_flat: options.coding == Coding::Fast,
        color_of_parents: ParentValue::Mean,
        is_double: matches!(cloud.positions, Positions::F64(_)),
        retained,
        has_cell_bits: options.precision == Precision::PointSpacing,
        lattice,
        has_order: options.keep_order,
        color_step: if attributes.colors.is_some() {
            2 * options.color_error + 1
        } else {
            0
        },
        has_alpha: attributes.colors.iter().flatten().any(|color| color[3] != 255),
        normal_bits,
        has_exact_normals: has_normals && is_exact,
        normals_may_miss: attributes.normals.iter().flatten().any(unusable),
        offset_bits: if has_normals && is_sampled {
            options.offset_bits
        } else {
            0
        },
        radii: match (attributes.radii.is_some(), exact_scalars) {
            (false, _) => Values::None,
            (true, true) => Values::Exact,
            (true, false) => Values::Stepped,
        },
        has_ellipses: attributes.ellipses.is_some() && !is_merged,
        scalars: (0..attributes.scalars.len())
            .map(|place| scalar_schema(cloud, group, place, scalar_bits))
            .collect(),
        has_exact_scalars: exact_scalars && !attributes.scalars.is_empty(),
    }
}

/// Maximum range of whole numbers that may be labels, which have no mean.
const WIDEST_LABELS: f64 = 255.0;

/// Bits that keep labels as they are.
const LABEL_BITS: u8 = 9;

/// The steps of scalar `place` of a cloud, between the extremes of all fields of that name in the group.
fn scalar_schema(cloud: &RawCloud, group: &[&RawCloud], place: usize, bits: u8) -> ScalarSchema {
    let field = &cloud.attributes.scalars[place];
    let fields = group.iter().filter_map(|cloud| cloud.attributes.scalars.get(place));
    let alike = fields.filter(|other| other.name == field.name && other.offset == field.offset);
    let finite = |value: &f32| value.is_finite();
    let values = || alike.clone().flat_map(|field| &field.values).copied().filter(finite);
    let min = values().fold(f32::INFINITY, f32::min);
    let max = values().fold(f32::NEG_INFINITY, f32::max);
    let (min, max) = if min <= max { (min, max) } else { (0.0, 0.0) };
    let steps = |bits: u8| f64::from((1u32 << bits) - 2);
    let width = f64::from(max) - f64::from(min);
    let is_label = width <= WIDEST_LABELS && values().all(|value| value.fract() == 0.0);
    let bits = if is_label && width > steps(bits) {
        LABEL_BITS
    } else {
        bits
    };
    ScalarSchema {
        name: field.name.clone(),
        bits,
        min,
        // Labels have a step of 1.
        max: if is_label {
            (f64::from(min) + steps(bits)) as f32
        } else {
            max
        },
        is_label,
    }
}

fn is_usable(normal: [f32; 3]) -> bool {
    Vec3::from_array(normal).try_normalize().is_some()
}
