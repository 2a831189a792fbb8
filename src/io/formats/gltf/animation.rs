//! Animation playback: the node transforms at a point in time.
//!
//! A file may hold several animations: the longest one is played, and with it those that move other nodes, as programs
//! that give each object its own animation write them.

use super::accessor::AccessorSource;
use super::document::{Sampler, at};
use crate::io::error::Fault;
use glam::{DQuat, DVec3};
use std::collections::HashSet;

/// Animated properties of a node.
#[derive(Debug, Default, Clone)]
pub(super) struct NodePose {
    pub(super) translation: Option<DVec3>,
    pub(super) rotation: Option<DQuat>,
    pub(super) scale: Option<DVec3>,
    pub(super) weights: Option<Vec<f32>>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Interpolation {
    Step,
    Linear,
    Cubic,
}

/// The indices of the animations that are played, and how long the longest takes in seconds; none where nothing moves.
pub(super) fn played(source: &AccessorSource<'_>) -> Result<(Vec<usize>, f64), Fault> {
    let mut timed = Vec::new();
    for (index, animation) in source.document.animations.iter().enumerate() {
        let mut end = 0.0f64;
        let inputs: HashSet<usize> = animation.samplers.iter().map(|sampler| sampler.input).collect();
        for input in inputs {
            let times: Vec<[f32; 1]> = source.read(input)?;
            end = times
                .iter()
                .map(|&[time]| f64::from(time))
                .filter(|time| time.is_finite())
                .fold(end, f64::max);
        }
        timed.push((end, index, animation));
    }
    timed.sort_by(|(first, ..), (second, ..)| second.total_cmp(first));
    let longest = timed.first().map_or(0.0, |&(end, ..)| end);
    let mut moved = HashSet::new();
    let mut played = Vec::new();
    for (_, index, animation) in timed {
        let targets = || {
            animation
                .channels
                .iter()
                .map(|channel| (channel.target.node, channel.target.path.as_str()))
        };
        if targets().all(|target| !moved.contains(&target)) {
            moved.extend(targets());
            played.push(index);
        }
    }
    Ok((played, longest))
}

/// Evaluates the animations of these indices at `time` in seconds and returns the changed properties of each node.
pub(super) fn changes(source: &AccessorSource<'_>, animations: &[usize], time: f64) -> Result<Vec<NodePose>, Fault> {
    let mut changes = vec![NodePose::default(); source.document.nodes.len()];
    for &animation in animations {
        let animation = at(&source.document.animations, animation, "animation")?;
        for channel in &animation.channels {
            let Some(node) = channel.target.node else {
                continue;
            };
            at(&source.document.nodes, node, "node")?;
            let sampler = at(&animation.samplers, channel.sampler, "animation sampler")?;
            let change = &mut changes[node];
            match channel.target.path.as_str() {
                "translation" => change.translation = vector(source, sampler, time)?,
                "scale" => change.scale = vector(source, sampler, time)?,
                "rotation" => {
                    let keys: Vec<[f32; 4]> = source.read(sampler.output)?;
                    change.rotation = sample(source, sampler, time, &keys, |a, b, fraction| {
                        let [a, b] = [a, b].map(|key| DQuat::from_array(key.map(f64::from)));
                        a.slerp(b, f64::from(fraction)).to_array().map(|part| part as f32)
                    })?
                    .map(|key| unit(DQuat::from_array(key.map(f64::from))));
                }
                "weights" => change.weights = weights(source, sampler, time)?,
                // Extensions animate other properties, such as colours.
                _ => {}
            }
        }
    }
    Ok(changes)
}

/// A normalised rotation; the identity where it is undefined.
pub(super) fn unit(rotation: DQuat) -> DQuat {
    let length = rotation.length();
    if length > 0.0 && length.is_finite() {
        rotation / length
    } else {
        DQuat::IDENTITY
    }
}

fn vector(source: &AccessorSource<'_>, sampler: &Sampler, time: f64) -> Result<Option<DVec3>, Fault> {
    let keys: Vec<[f32; 3]> = source.read(sampler.output)?;
    let value = sample(source, sampler, time, &keys, lerp)?;
    Ok(value.map(|key| DVec3::from_array(key.map(f64::from))))
}

fn weights(source: &AccessorSource<'_>, sampler: &Sampler, time: f64) -> Result<Option<Vec<f32>>, Fault> {
    let numbers: Vec<[f32; 1]> = source.read(sampler.output)?;
    let key_count = source.count(sampler.input)?
        * if interpolation(sampler) == Interpolation::Cubic {
            3
        } else {
            1
        };
    let per_key = numbers.len().checked_div(key_count).unwrap_or(0);
    let mut weights = Vec::with_capacity(per_key);
    for target in 0..per_key {
        let keys: Vec<[f32; 1]> = numbers.iter().skip(target).step_by(per_key).copied().collect();
        weights.extend(sample(source, sampler, time, &keys, lerp)?.map(|[weight]| weight));
    }
    Ok((!weights.is_empty()).then_some(weights))
}

fn interpolation(sampler: &Sampler) -> Interpolation {
    match sampler.interpolation.as_deref() {
        Some("STEP") => Interpolation::Step,
        Some("CUBICSPLINE") => Interpolation::Cubic,
        _ => Interpolation::Linear,
    }
}

fn lerp<const N: usize>(a: [f32; N], b: [f32; N], fraction: f32) -> [f32; N] {
    std::array::from_fn(|index| a[index] + (b[index] - a[index]) * fraction)
}

/// Samples the value at `time`; before the first and after the last keyframe, that keyframe's value.
fn sample<const N: usize>(
    source: &AccessorSource<'_>,
    sampler: &Sampler,
    time: f64,
    keys: &[[f32; N]],
    linear: impl Fn([f32; N], [f32; N], f32) -> [f32; N],
) -> Result<Option<[f32; N]>, Fault> {
    let times: Vec<[f32; 1]> = source.read(sampler.input)?;
    let kind = interpolation(sampler);
    // An in-tangent, the value, an out-tangent.
    let per_time = if kind == Interpolation::Cubic { 3 } else { 1 };
    if times
        .len()
        .checked_mul(per_time)
        .is_none_or(|needed| needed > keys.len())
    {
        return Err(Fault::entry(
            "accessor",
            sampler.output,
            format!(
                "it has {} values, expected {per_time} for each of {} keyframes",
                keys.len(),
                times.len()
            ),
        ));
    }
    let key = |time_step: usize, part: usize| keys[time_step * per_time + part];
    let value = |time_step: usize| key(time_step, per_time / 2);
    let after = times.partition_point(|&[time_step]| f64::from(time_step) <= time);
    if times.is_empty() {
        return Ok(None);
    }
    if after == 0 || after == times.len() {
        return Ok(Some(value(after.saturating_sub(1))));
    }
    let (before, [start], [end]) = (after - 1, times[after - 1], times[after]);
    let step = end - start;
    let fraction = ((time - f64::from(start)) / f64::from(step)) as f32;
    Ok(Some(match kind {
        Interpolation::Step => value(before),
        Interpolation::Linear => linear(value(before), value(after), fraction),
        Interpolation::Cubic => {
            let (t, t2, t3) = (fraction, fraction * fraction, fraction * fraction * fraction);
            let [a, leave, reach, b] = [value(before), key(before, 2), key(after, 0), value(after)];
            std::array::from_fn(|index| {
                (2.0 * t3 - 3.0 * t2 + 1.0) * a[index]
                    + step * (t3 - 2.0 * t2 + t) * leave[index]
                    + (3.0 * t2 - 2.0 * t3) * b[index]
                    + step * (t3 - t2) * reach[index]
            })
        }
    }))
}
