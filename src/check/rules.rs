//! The rules: from facts to findings.

use super::{Finding, FindingKind, FrameFacts};
use crate::cloud::MissingPoints;
use crate::messages::{frame_by_index, frame_with_index};
use crate::photos::ViewSet;
use crate::scene::UpAxis;
use crate::sequence::{FrameError, NumberGap, Sequence, number_gaps as gaps_between};
use glam::DVec3;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Facts of each frame, or why there are none.
type Facts = [Result<FrameFacts, FrameError>];

/// Jump threshold as a fraction of the diagonal: a cloud whose centre moves further from one frame to the next has
/// jumped.
const JUMP_IN_DIAGONALS: f64 = 0.5;

/// The diagonal that grows or shrinks by more than this factor has jumped.
const DIAGONAL_FACTOR: f64 = 2.0;

/// Plausible diagonals of scans, in metres: from a grain of pollen to a country.
const PLAUSIBLE_DIAGONAL: std::ops::RangeInclusive<f64> = 1e-5..=2e6;

/// A step of single precision above this share of the diagonal can be seen as stripes.
const COARSE_STEP: f64 = 1e-5;

/// Median spacings after which a pause was made.
const PAUSE_IN_SPACINGS: f64 = 8.0;

/// Reprojection error of an image above which its camera is wrong: calibrations end well below a pixel. As a fraction
/// of its longer edge, and in pixels.
const LOOSE_SHARE: f64 = 1e-3;
const LOOSE_PX: f64 = 2.0;

/// All findings, rule after rule.
pub(super) fn findings(sequence: &Sequence, facts: &Facts) -> Vec<Finding> {
    let mut findings = number_gaps(sequence);
    findings.extend(time_jumps(sequence));
    findings.extend(loose_cameras(sequence));
    findings.extend(super::cameras::changed_camera(sequence, facts));
    findings.extend(unreadable(facts));
    findings.extend(unreadable_parts(facts));
    findings.extend(damaged_file(sequence));
    findings.extend(damaged_inputs(sequence));
    findings.extend(unread_properties(facts));
    let attributes = facts.iter().enumerate();
    findings.extend(changed_attributes(attributes.filter_map(|(index, facts)| {
        Some((index, facts.as_ref().ok()?.attributes.as_slice()))
    })));
    findings.extend(bounds_jumps(facts));
    findings.extend(changed_up_axes(facts));
    findings.extend(counted(
        facts,
        FindingKind::EmptyFrame,
        |facts| usize::from(facts.finite_count == 0),
        |_, frames| format!("{frames} without a single point: nothing is shown there"),
    ));
    findings.extend(counted(
        facts,
        FindingKind::NonFinitePoints,
        |facts| facts.point_count - facts.finite_count,
        |count, frames| {
            format!("{count} points in {frames} have coordinates that are NaN or infinite: they are skipped")
        },
    ));
    findings.extend(no_data_points(facts));
    findings.extend(counted(
        facts,
        FindingKind::DuplicatePoints,
        |facts| facts.duplicate_count,
        |count, frames| {
            format!(
                "{count} points in {frames} lie exactly where another point does: `pointreel convert --voxel` \
                joins them"
            )
        },
    ));
    findings.extend(counted(
        facts,
        FindingKind::ZeroNormals,
        |facts| facts.zero_normal_count,
        |count, frames| {
            format!(
                "{count} normals in {frames} have no length: they are estimated for the picture, `pointreel \
                convert --estimate-normals` writes them"
            )
        },
    ));
    findings.extend(counted(
        facts,
        FindingKind::AbsurdRadii,
        |facts| facts.absurd_radius_count,
        |count, frames| {
            format!(
                "{count} radii in {frames} are not finite or a thousand times as large as the cloud: they are taken \
                 for \
                 missing"
            )
        },
    ));
    findings.extend(counted(
        facts,
        FindingKind::NarrowColors,
        |facts| usize::from(facts.has_narrow_colors),
        |_, frames| {
            format!(
                "colours of {frames} are 0 to 255 in fields of 16 bits: they are read as 8 bits, other programs \
                may show them black"
            )
        },
    ));
    findings.extend(suspicious_scales(facts));
    findings
}

/// The axis that is probably up in most frames.
pub(super) fn max_common_up(facts: &Facts) -> Option<UpAxis> {
    let mut counts: Vec<(UpAxis, usize)> = Vec::new();
    for up in facts.iter().flatten().filter_map(|facts| facts.probable_up) {
        match counts.iter_mut().find(|(known, _)| *known == up) {
            Some((_, count)) => *count += 1,
            None => counts.push((up, 1)),
        }
    }
    let most = counts.iter().map(|(_, count)| *count).max()?;
    counts.into_iter().find(|(_, count)| *count == most).map(|(up, _)| up)
}

/// One finding for all frames of which `count` is not zero.
fn counted(
    facts: &Facts,
    kind: FindingKind,
    count: impl Fn(&FrameFacts) -> usize,
    message: impl Fn(usize, &str) -> String,
) -> Option<Finding> {
    let counts = facts.iter().enumerate().filter_map(|(index, facts)| {
        let count = facts.as_ref().map_or(0, &count);
        (count > 0).then_some((index, count))
    });
    let (frames, counts): (Vec<usize>, Vec<usize>) = counts.unzip();
    (!frames.is_empty()).then(|| Finding {
        kind,
        severity: kind.severity(),
        message: message(counts.iter().sum(), &named(&frames)),
        frames,
    })
}

/// No-data points, with value and count of the first frame that has some.
fn no_data_points(facts: &Facts) -> Option<Finding> {
    let missing = facts.iter().enumerate().filter_map(|(index, facts)| {
        let missing = &facts.as_ref().ok()?.missing;
        (!missing.is_empty()).then_some((index, missing))
    });
    let (frames, missing): (Vec<usize>, Vec<&MissingPoints>) = missing.unzip();
    let first = missing.first()?;
    let count: usize = missing.iter().map(|missing| missing.indices.len()).sum();
    Some(Finding {
        kind: FindingKind::NoDataPoints,
        severity: FindingKind::NoDataPoints.severity(),
        message: format!(
            "{count} points in {} stand for no measurement ({}{}): they are neither drawn nor framed, --no-data none \
             draws them",
            named(&frames),
            first.in_words(),
            if frames.len() > 1 { " in the first" } else { "" }
        ),
        frames,
    })
}

/// Frames in words: `frame 4 (index 3)`, `frames 4 and 6 (indices 3 and 5)`, `12 frames (4, 6, 8, …; indices 3, 5, 7,
/// …)`.
fn named(frames: &[usize]) -> String {
    match frames {
        [] => "no frame".to_owned(),
        [only] => frame_by_index(*only),
        [first, second] => format!("frames {} and {} (indices {first} and {second})", first + 1, second + 1),
        [first, second, third, ..] => {
            let more = if frames.len() > 3 { ", …" } else { "" };
            let [a, b, c] = [first, second, third].map(|index| index + 1);
            format!(
                "{} frames ({a}, {b}, {c}{more}; indices {first}, {second}, {third}{more})",
                frames.len()
            )
        }
    }
}

/// Finds images with a large reprojection error: their points are far from where their cameras show them. Each set is
/// checked once.
fn loose_cameras(sequence: &Sequence) -> Vec<Finding> {
    let mut findings = Vec::new();
    let mut before: Option<Arc<ViewSet>> = None;
    for frame in 0..sequence.len() {
        let Some(set) = sequence.source().posed_images(frame) else {
            continue;
        };
        if before.as_ref().is_none_or(|before| !Arc::ptr_eq(before, &set)) {
            findings.extend(loose_cameras_of(&set, frame));
        }
        before = Some(set);
    }
    findings
}

fn loose_cameras_of(set: &ViewSet, frame: usize) -> Vec<Finding> {
    let errors = set.photos.iter().zip(set.reprojection_errors());
    let loose = errors.filter_map(|(photo, error)| {
        let [width, height] = photo.camera.size_px();
        let max_px = LOOSE_PX.max(LOOSE_SHARE * f64::from(width.max(height)));
        let error = error.filter(|error| error.rms_px > max_px)?;
        Some(Finding {
            kind: FindingKind::LooseCamera,
            severity: FindingKind::LooseCamera.severity(),
            frames: vec![frame],
            message: format!(
                "the {} points of {} are {:.1} pixels from where its camera shows them: its picture will not meet \
                 the surface, calibrate it again or leave it out",
                error.count, photo.name, error.rms_px
            ),
        })
    });
    loose.collect()
}

fn number_gaps(sequence: &Sequence) -> Vec<Finding> {
    let entries = sequence.entries();
    let gaps = gaps_between(&entries).into_iter();
    gaps.map(|NumberGap { after, count, numbers }| Finding {
        kind: FindingKind::NumberGap,
        severity: FindingKind::NumberGap.severity(),
        frames: vec![after, after + 1],
        message: format!(
            "{count} {} missing between {} and {} ({} to {}): the frames play one after the other",
            if count == 1 { "number is" } else { "numbers are" },
            entries[after].name,
            entries[after + 1].name,
            numbers.start(),
            numbers.end()
        ),
    })
    .collect()
}

fn time_jumps(sequence: &Sequence) -> Vec<Finding> {
    let entries = sequence.entries();
    let times: Option<Vec<f64>> = entries
        .iter()
        .map(|entry| entry.time.map(|time| time.as_secs_f64()))
        .collect();
    let times = times.unwrap_or_default();
    let spacings: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let mut sorted = spacings.clone();
    sorted.sort_by(f64::total_cmp);
    let Some(&median) = sorted.get(sorted.len() / 2) else {
        return Vec::new();
    };
    let odd = spacings
        .iter()
        .enumerate()
        .filter(|&(_, &spacing)| spacing <= 0.0 || (median > 0.0 && spacing > PAUSE_IN_SPACINGS * median));
    odd.map(|(index, spacing)| Finding {
        kind: FindingKind::TimeJump,
        severity: FindingKind::TimeJump.severity(),
        frames: vec![index, index + 1],
        message: if *spacing > 0.0 {
            format!(
                "{spacing:.3} s lie between {} and the next where {median:.3} s are usual: a pause, which is played \
                 shortened",
                frame_with_index(index, entries.len())
            )
        } else {
            format!(
                "{} has a time stamp that is not after that of the frame before: stamps are not used, --fps says how \
                 fast it plays",
                frame_with_index(index + 1, entries.len())
            )
        },
    })
    .collect()
}

fn unreadable(facts: &Facts) -> Vec<Finding> {
    let failed = facts.iter().enumerate().filter_map(|(index, facts)| {
        let error = facts.as_ref().err()?;
        Some(Finding {
            kind: FindingKind::UnreadableFrame,
            severity: FindingKind::UnreadableFrame.severity(),
            frames: vec![index],
            message: error.to_string(),
        })
    });
    failed.collect()
}

fn unreadable_parts(facts: &Facts) -> Vec<Finding> {
    let readable = facts.iter().zip(0..);
    let warnings = readable.flat_map(|(facts, index)| {
        let warnings = facts.iter().flat_map(|facts| &facts.warnings);
        warnings.map(move |warning| Finding {
            kind: FindingKind::UnreadablePart,
            severity: FindingKind::UnreadablePart.severity(),
            frames: vec![index],
            message: warning.clone(),
        })
    });
    warnings.collect()
}

/// Finds the missing parts of a sequence file.
fn damaged_file(sequence: &Sequence) -> Option<Finding> {
    let file = sequence.source().reel()?;
    let damage = file.damage().join("; ");
    if damage.is_empty() {
        return None;
    }
    Some(Finding {
        kind: FindingKind::DamagedFile,
        severity: FindingKind::DamagedFile.severity(),
        message: format!(
            "{damage}: {} frames are there; convert the original again, or copy the file again",
            sequence.len()
        ),
        frames: Vec::new(),
    })
}

/// Finds truncated recordings, captures and archives.
fn damaged_inputs(sequence: &Sequence) -> Vec<Finding> {
    let damage = sequence.source().damage().iter();
    damage
        .map(|damage| Finding {
            kind: FindingKind::DamagedFile,
            severity: FindingKind::DamagedFile.severity(),
            message: damage.clone(),
            frames: Vec::new(),
        })
        .collect()
}

/// Finds properties of files that nothing uses, once for all frames.
fn unread_properties(facts: &Facts) -> Vec<Finding> {
    let mut frames_of: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
    for (index, facts) in facts.iter().enumerate() {
        for what in facts.iter().flat_map(|facts| &facts.dropped) {
            frames_of.entry(what).or_default().push(index);
        }
    }
    let finding = |(what, frames): (&str, Vec<usize>)| Finding {
        kind: FindingKind::UnreadProperties,
        severity: FindingKind::UnreadProperties.severity(),
        message: format!("{}: {what}", named(&frames)),
        frames,
    };
    frames_of.into_iter().map(finding).collect()
}

/// Frames whose attributes differ from those of most frames; `attributes` has an entry for each readable frame.
pub(crate) fn changed_attributes<'a>(attributes: impl IntoIterator<Item = (usize, &'a [String])>) -> Vec<Finding> {
    let mut kinds: BTreeMap<&[String], Vec<usize>> = BTreeMap::new();
    for (index, attributes) in attributes {
        kinds.entry(attributes).or_default().push(index);
    }
    let most = kinds.values().map(Vec::len).max().unwrap_or(0);
    let Some(usual) = kinds
        .iter()
        .find(|(_, frames)| frames.len() == most)
        .map(|(attributes, _)| *attributes)
    else {
        return Vec::new();
    };
    kinds
        .into_iter()
        .filter(|(attributes, _)| *attributes != usual)
        .map(|(attributes, frames)| Finding {
            kind: FindingKind::ChangedAttributes,
            severity: FindingKind::ChangedAttributes.severity(),
            message: format!(
                "{} has {} where the others have {}: what is missing is estimated, so the picture may change there",
                named(&frames),
                attributes.join(", "),
                usual.join(", ")
            ),
            frames,
        })
        .collect()
}

fn bounds_jumps(facts: &Facts) -> Vec<Finding> {
    let boxes: Vec<(usize, DVec3, DVec3)> = facts
        .iter()
        .enumerate()
        .filter_map(|(index, facts)| {
            let (min, max) = facts.as_ref().ok()?.bounds?;
            Some((index, min, max))
        })
        .collect();
    let mut findings = Vec::new();
    for pair in boxes.windows(2) {
        let (before, min_before, max_before) = pair[0];
        let (after, min_after, max_after) = pair[1];
        let diagonals = [(max_before - min_before).length(), (max_after - min_after).length()];
        let larger = diagonals[0].max(diagonals[1]);
        let moved = (min_after * 0.5 + max_after * 0.5).distance(min_before * 0.5 + max_before * 0.5);
        let has_grown = larger > DIAGONAL_FACTOR * diagonals[0].min(diagonals[1]);
        if moved > JUMP_IN_DIAGONALS * larger || has_grown {
            findings.push(Finding {
                kind: FindingKind::BoundsJump,
                severity: FindingKind::BoundsJump.severity(),
                frames: vec![before, after],
                message: format!(
                    "from {} to {} the centre moves by {moved:.4} and the diagonal goes from {:.4} to {:.4}: an \
                     outlier, another unit or another scene",
                    frame_by_index(before),
                    frame_by_index(after),
                    diagonals[0],
                    diagonals[1]
                ),
            });
        }
    }
    findings
}

fn changed_up_axes(facts: &Facts) -> Option<Finding> {
    let usual = max_common_up(facts)?;
    let ups = facts.iter().enumerate();
    let frames: Vec<usize> = ups
        .filter(|(_, facts)| {
            let up = facts.as_ref().ok().and_then(|facts| facts.probable_up);
            up.is_some_and(|up| up != usual)
        })
        .map(|(index, _)| index)
        .collect();
    // Guesses vary; a few that differ mean nothing.
    (frames.len() * 4 > facts.len()).then(|| Finding {
        kind: FindingKind::ChangedUpAxis,
        severity: FindingKind::ChangedUpAxis.severity(),
        message: format!(
            "{} looks as if another axis than {} was up: --up says which it is",
            named(&frames),
            usual.name()
        ),
        frames,
    })
}

fn suspicious_scales(facts: &Facts) -> Vec<Finding> {
    let mut unit = Vec::new();
    let mut coarse = Vec::new();
    for (index, facts) in facts.iter().enumerate() {
        let Ok(facts) = facts else { continue };
        let Some((min, max)) = facts.bounds else {
            continue;
        };
        let diagonal = (max - min).length();
        if diagonal > 0.0 && !PLAUSIBLE_DIAGONAL.contains(&diagonal) {
            unit.push((index, diagonal));
        }
        let farthest = min.abs().max(max.abs()).max_element() as f32;
        let step = f64::from(farthest.next_up() - farthest);
        if facts.is_single_precision && step > COARSE_STEP * diagonal && diagonal > 0.0 {
            coarse.push((index, step));
        }
    }
    let mut findings = Vec::new();
    if let Some(&(_, diagonal)) = unit.first() {
        let frames: Vec<usize> = unit.iter().map(|&(index, _)| index).collect();
        findings.push(Finding {
            kind: FindingKind::SuspiciousScale,
            severity: FindingKind::SuspiciousScale.severity(),
            message: format!(
                "{} is {diagonal:.3e} across, which no scan in metres is: another unit, or an outlier",
                named(&frames)
            ),
            frames,
        });
    }
    if let Some(&(_, step)) = coarse.first() {
        let frames: Vec<usize> = coarse.iter().map(|&(index, _)| index).collect();
        findings.push(Finding {
            kind: FindingKind::SuspiciousScale,
            severity: FindingKind::SuspiciousScale.severity(),
            message: format!(
                "coordinates of {} are of single precision so far from zero that they can only be multiples of \
                 {step:.3e}: write them in double precision, or nearer to zero",
                named(&frames)
            ),
            frames,
        });
    }
    findings
}
