//! Motion of the nodes of each level, as bits and back.
//!
//! How it works: a node moves as its parent does, corrected by the slope of the surrounding motion ([`super::slope`]),
//! and compensates for the deviations of its siblings, as the parent's step is their mean. Coarse levels are coded in
//! small steps, as everything below moves with them; finer ones in larger and larger ones, so that for a smooth motion
//! they need no code.

use super::followed::Followed;
use super::slope::Below;
use super::{MAX_CHANGE, MotionScale};
use crate::reel::coder::{BitCoder, MagnitudeModel, RestModels, divided};
use crate::reel::tree::{Known, NONE};

/// Classes of the errors of earlier axes and nodes.
const CLASSES: usize = 4;

/// Probability models of motion residuals.
struct MotionModels {
    models: Vec<MagnitudeModel>,
    rest: RestModels,
}

/// Codes the steps of all levels, `coders[places[level]]` those of a level.
pub(super) fn code_motion<C: BitCoder>(
    scale: MotionScale,
    coders: &mut [Option<C>],
    followed: &Followed,
    places: &[usize],
    levels: Vec<&mut Vec<[i32; 3]>>,
) {
    let mut models = MotionModels {
        models: vec![MagnitudeModel::default(); 2 * 3 * CLASSES * CLASSES],
        rest: RestModels::default(),
    };
    let mut parents: &[[i32; 3]] = &[[0; 3]];
    for (level, steps) in levels.into_iter().enumerate() {
        let of_level = &followed.levels[level];
        let differences = match level.checked_sub(1) {
            None => vec![[0; 3]; steps.len()],
            // Without this gradient, predicted in the same way as colours, the walking man (merged points) takes 2.4
            // bits per point instead of 1.2.
            Some(above) => Below {
                family: &followed.families[above],
                steps: parents,
                positions: &of_level.positions,
                edge: followed.edge_parts(above),
            }
            .differences(),
        };
        if let Some(coder) = &mut coders[places[level]] {
            // Independent of how many levels are decoded: a prefix of them moves as it does within all of them. With
            // one step size for all levels, every level encodes the rounding error of the level above again: 3.9 bits
            // per point for the walking man instead of 1.2.
            let step = scale.step(followed.depth.saturating_sub(level as u32));
            code_level(
                coder,
                &mut models,
                &Foreseen {
                    plan: &followed.plans[level],
                    parents,
                    differences: &differences,
                },
                steps,
                step,
            );
        }
        parents = steps;
    }
}

/// Prediction of the steps of a level, known before they are coded.
struct Foreseen<'a> {
    plan: &'a [Known],
    /// The steps of the level above.
    parents: &'a [[i32; 3]],
    /// Predicted difference of each node's motion from its parent's.
    differences: &'a [[i32; 3]],
}

fn code_level<C: BitCoder>(
    coder: &mut C,
    models: &mut MotionModels,
    foreseen: &Foreseen<'_>,
    steps: &mut [[i32; 3]],
    unit: i32,
) {
    let Foreseen {
        plan,
        parents,
        differences,
    } = *foreseen;
    let mut last_parent = NONE;
    // The prediction errors of the siblings, and of the preceding node.
    let mut others = [0i32; 3];
    let mut before = 0usize;
    for (node, known) in plan.iter().enumerate() {
        if known.parent != last_parent {
            last_parent = known.parent;
            others = [0; 3];
        }
        let parent = parents[known.parent as usize];
        let left = i32::from(known.left);
        let mut sum = 0u32;
        for axis in 0..3 {
            let made_up = divided(left - 2 * others[axis], 2 * left);
            // Using the displacements of the previous frame as a predictor made it worse, as they are rounded.
            let foreseen = parent[axis] + differences[node][axis];
            let predicted = (foreseen + made_up).clamp(-MAX_CHANGE, MAX_CHANGE);
            let context = usize::from(left == 1) * 3 + axis;
            let class = (32 - sum.leading_zeros() as usize).min(CLASSES - 1);
            let model = &mut models.models[(context * CLASSES + class) * CLASSES + before];
            let units = if C::DECODES {
                0
            } else {
                (steps[node][axis] - predicted + unit / 2).div_euclid(unit)
            };
            // Damaged bytes may give any number.
            let max = i64::from(MAX_CHANGE);
            let units = model
                .code_signed(coder, &mut models.rest, i64::from(units))
                .clamp(-max, max) as i32;
            let step = (predicted + units * unit).clamp(-MAX_CHANGE, MAX_CHANGE);
            steps[node][axis] = step;
            others[axis] = (others[axis] + step - foreseen).clamp(-MAX_CHANGE, MAX_CHANGE);
            sum += units.unsigned_abs();
        }
        before = (32 - sum.leading_zeros() as usize).min(CLASSES - 1);
    }
}
