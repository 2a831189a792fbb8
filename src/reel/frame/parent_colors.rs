//! Choice of the colours of nodes that have children, by the bytes that both take.

use super::code::color_bytes;
use super::prepare::{GroupPlan, prepare};
use super::schema::{Schema, Values};
use crate::cloud::RawCloud;
use crate::reel::parent_level::ParentValue;
use std::ops::Range;

/// Colours of first children have to save this share of the bytes, and this number: coarse levels look better as means.
const MIN_SAVED_SHARE: f64 = 0.1;
const MIN_SAVED_BYTES: usize = 1 << 10;

/// Chooses for a group, by the first of its frames that has colours. Frames of a run may be encoded relative to its
/// first.
pub(in crate::reel) fn choose_parent_colors(plan: &mut GroupPlan, clouds: &[&RawCloud], runs: &[Range<usize>]) {
    let has_choice = |schema: &Schema| schema.color_step > 0;
    let Some(frame) = plan.schemas.iter().position(has_choice) else {
        return;
    };
    // Changes of moved frames are predicted as if those of parents were means.
    let colors = |index: usize| &clouds[index].attributes.colors;
    let changes = |run: &Range<usize>| (run.start + 1..run.end).any(|index| colors(index - 1) != colors(index));
    if runs.iter().any(changes) {
        return;
    }
    let own = plan.schemas[frame].clone();
    let mut bytes = |color_of_parents| {
        plan.schemas[frame] = Schema {
            color_of_parents,
            ..colors_alone(&own)
        };
        let mut pose = prepare(plan, frame, clouds[frame]);
        color_bytes(&plan.schemas[frame], &mut pose)
    };
    let [of_means, of_first] = [ParentValue::Mean, ParentValue::FirstChild].map(&mut bytes);
    plan.schemas[frame] = own;
    let saved = of_means.saturating_sub(of_first);
    if saved >= MIN_SAVED_BYTES && saved as f64 >= MIN_SAVED_SHARE * of_means as f64 {
        for schema in plan.schemas.iter_mut().filter(|schema| has_choice(schema)) {
            schema.color_of_parents = ParentValue::FirstChild;
        }
    }
}

/// A schema without attributes other than colours.
fn colors_alone(schema: &Schema) -> Schema {
    Schema {
        has_alpha: false,
        normal_bits: 0,
        has_exact_normals: false,
        offset_bits: 0,
        radii: Values::None,
        has_ellipses: false,
        scalars: Vec::new(),
        has_exact_scalars: false,
        ..schema.clone()
    }
}
