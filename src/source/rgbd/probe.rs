//! A few depth images of a recording, looked at before any is shown: which units they have, and which of the usual
//! filters would drop most of them. So a sequence decides once.

use super::decoder::Recorded;
use super::depth_scale::{DepthScale, Units};
use super::folder::{has_extension, name_of};
use super::layouts::FoundRecording;
use super::stored_image::StoredImage;
use crate::assumption::{Assumption, Evidence, Subject};
use crate::io::ReadOptions;
use crate::raster::Samples;
use crate::rgbd::Filters;

/// Number of images whose values determine the units.
const IMAGES: usize = 5;

/// Images that filters are tried on.
const FILTERED_IMAGES: usize = 3;

/// Numbers of an image that are looked at, about.
const NUMBERS: usize = 20_000;

/// Finds the units of depth images by their numbers, where no file states them.
pub(super) fn settle_units(found: &mut FoundRecording, options: &ReadOptions) {
    let (mut numbers, mut floats) = (Vec::new(), Vec::new());
    for index in spread(found.frames.len(), IMAGES) {
        let StoredImage::File(path) = &found.frames[index].depth else {
            return;
        };
        // Text files contain lengths in metres.
        if has_extension(name_of(path), &["depth"]) {
            return;
        }
        // Errors in an image are reported when it is shown.
        let Ok(raster) = found.frames[index].depth.raster(options) else {
            continue;
        };
        match raster.samples {
            Samples::Gray16(samples) => numbers.extend(some(&samples)),
            Samples::GrayF32(samples) => floats.extend(some(&samples)),
            Samples::Gray8(_) | Samples::Rgb8(_) => {}
        }
    }
    if let Some(usual) = found.code.units_per_metre().filter(|_| found.units != Units::Certain)
        && let Some(scale) = DepthScale::of_numbers(&numbers, usual, found.units)
    {
        found.code = found.code.with_units(scale.units_per_metre);
        found.assumptions.push(scale.assumption());
    }
    if let Some(scale) = DepthScale::of_floats(&floats) {
        if scale.units_per_metre != 1.0 {
            found.code = found.code.told(scale.units_per_metre);
        }
        found.assumptions.push(scale.assumption());
    }
}

/// The filters of `recorded` without those that would drop most of its images, and the notes on these.
pub(super) fn usual_filters(recorded: &Recorded, count: usize) -> (Filters, Vec<Assumption>) {
    let tried = spread(count, FILTERED_IMAGES);
    let reports: Vec<_> = tried.filter_map(|index| recorded.filter_report(index)).collect();
    let mut filters = recorded.filters;
    let mut assumptions = Vec::new();
    for kind in Filters::kinds() {
        let skipped =
            |report: &&crate::rgbd::FilterReport| report.skipped.iter().any(|skipped| skipped.filter.name == kind.name);
        if 2 * reports.iter().filter(skipped).count() > reports.len() {
            (kind.set_on)(&mut filters, false);
            assumptions.push(Assumption::new(
                Subject::FilteredPoints,
                format!("the depth filter `{}` is not applied", kind.name),
                "it is a default of pictures, and would drop more than half of the measured pixels of most frames",
                Evidence::Statistics,
            ));
        }
    }
    (filters, assumptions)
}

/// At most `max` of `count` indices, evenly spread.
fn spread(count: usize, max: usize) -> impl Iterator<Item = usize> {
    let taken = count.min(max);
    (0..taken).map(move |at| at * count / taken)
}

fn some<T: Copy>(samples: &[T]) -> impl Iterator<Item = T> {
    // A step coprime to the usual widths, so that columns differ.
    let step = (samples.len() / NUMBERS).max(1) | 1;
    samples.iter().copied().step_by(step)
}
