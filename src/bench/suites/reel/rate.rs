//! Rate and distortion: the bits and the loss of the options of sequence files.
//!
//! How it works: a frame is encoded with one choice of options after the other, and compared with the original
//! ([`judge`]). One option is swept at a time, the others are defaults: precision of positions, bits of normals, error
//! of colours. Bits count all bytes, over the points of the original, so that merging points costs no rate: curves of
//! several clouds and of other coders can be laid over one another.
//!
//! [`judge`]: super::judge

use super::judge::{Distortion, Judge};
use super::original::{Original, consecutive};
use super::samples::RetainedSamples;
use crate::bench::BenchError;
use crate::bench::rate::{RatePoint, Sweep};
use crate::bench::report::{Cell, Column, Row};
use crate::bench::run::Run;
use crate::bench::small_picture::small;
use crate::bench::subject::Subject;
use crate::bench::suite::{Defaults, OptionGroup, Suite};
use crate::cloud::RawCloud;
use crate::reel::{Precision, ReelOptions};

/// Columns, in the order in which [`row`] fills them.
const COLUMNS: &[Column] = &[
    Column::text("sequence", "sequence"),
    Column::text("sweep", "what is changed"),
    Column::text("options", "options"),
    Column::number("frame", "frame", 0).hidden(),
    Column::number("points", "points", 0),
    Column::number("kept_points", "points kept", 0),
    Column::number("bits_per_point", "bits per point", 3),
    Column::number("d1_psnr", "D1 dB", 2),
    Column::number("d2_psnr", "D2 dB", 2),
    Column::number("color_psnr", "colour dB", 2),
    Column::number("normal_error_deg", "normal °", 2),
    Column::number("flip", "FLIP", 4),
    Column::number("bytes", "bytes", 0).hidden(),
];

/// Rate and distortion of one frame.
pub const RATE: &Suite = &Suite {
    name: "rate",
    brief: "bits and errors of sequence files by option",
    title: "Rate × distortion",
    hint: "Bits per point and errors of the shown frame for the options of sequence files; a click on a point shows it",
    description: "bits per point and errors of a frame, for the options of sequence files",
    measured: "bits of all bytes of a file of this frame alone, over its points; PSNR from point to point (D1) and \
        along normals (D2), both ways, with 3 p², and of colours; mean angle of normals; FLIP of the image against \
        that of the original, over the pixels that show either",
    not_measured: "times; what frames gain from one another",
    covered_by: "points",
    defaults: Defaults {
        viewport_px: [960, 540],
        viewpoints: 2,
        frames: 1,
    },
    takes: &[OptionGroup::FirstFrame],
    is_of_paper: false,
    has_paper_layout: false,
    columns: COLUMNS,
    headline: "bits_per_point",
    bars_title: "Bits per point",
    bar_labels: 3,
};

/// Bits of positions that are compared.
const POSITION_BITS: std::ops::RangeInclusive<u8> = 6..=12;

/// Lengths that are compared: the longest edge over two to the power of these.
const LENGTH_POWERS: [i32; 3] = [11, 13, 15];

/// Bits of normals that are compared.
const NORMAL_BITS: [u8; 3] = [13, 15, 17];

/// Errors of colours that are compared.
const COLOR_ERRORS: [u8; 7] = [0, 1, 2, 4, 8, 16, 32];

/// Comparison made for a frame.
struct Choice {
    sweep: Sweep,
    label: String,
    options: ReelOptions,
}

impl Choice {
    fn positions(label: String, precision: Precision) -> Self {
        Self {
            sweep: Sweep::Positions,
            label,
            options: ReelOptions {
                precision,
                ..ReelOptions::default()
            },
        }
    }
}

/// Returns the comparisons for `cloud`: only of attributes that it has.
fn choices(cloud: &RawCloud) -> Vec<Choice> {
    let usual = ReelOptions::merged();
    let (_, bounds) = cloud.positions.finite_bounds();
    let extent = bounds.map_or(0.0, |(min, max)| (max - min).max_element());
    let mut choices = vec![
        Choice::positions("every point".to_owned(), Precision::PointSpacing),
        Choice::positions("sampling density".to_owned(), Precision::SamplingDensity),
    ];
    choices.extend(POSITION_BITS.map(|bits| Choice::positions(format!("{bits} bits"), Precision::Bits(bits))));
    let lengths = LENGTH_POWERS.map(|power| extent / 2f64.powi(power));
    choices.extend(lengths.into_iter().filter(|length| *length > 0.0).map(|length| {
        // Two digits are enough for a length.
        let label = format!("{length:.1e}");
        let length = label.parse().unwrap_or(length);
        Choice::positions(format!("within {length}"), Precision::Length(length))
    }));
    choices.push(Choice {
        sweep: Sweep::Positions,
        label: "lossless".to_owned(),
        options: ReelOptions::lossless(),
    });
    if cloud.attributes.normals.is_some() {
        choices.extend(NORMAL_BITS.map(|normal_bits| Choice {
            sweep: Sweep::Normals,
            label: format!("normals of {normal_bits} bits"),
            options: ReelOptions {
                normal_bits,
                ..usual.clone()
            },
        }));
    }
    if cloud.attributes.colors.is_some() {
        choices.extend(COLOR_ERRORS.map(|color_error| Choice {
            sweep: Sweep::Colors,
            label: format!("colours ± {color_error}"),
            options: ReelOptions {
                color_error,
                ..usual.clone()
            },
        }));
    }
    choices
}

pub(in crate::bench::suites) fn measure(run: &mut Run<'_>) -> Result<(), BenchError> {
    for subject in run.subjects(1)? {
        let frames = consecutive(&subject)?;
        for frame in &frames {
            measure_frame(run, &subject, frame)?;
        }
        let points: Vec<f64> = frames.iter().map(|frame| frame.cloud.positions.len() as f64).collect();
        run.finish(&subject, &points, &[], []);
    }
    Ok(())
}

fn measure_frame(run: &mut Run<'_>, subject: &Subject<'_>, frame: &Original) -> Result<(), BenchError> {
    let choices = choices(&frame.cloud);
    run.add_steps(choices.len());
    run.begin_step(format!("{}: the original", subject.name))?;
    let mut judge = Judge::new(run.options, subject, frame.index, &frame.cloud)?;
    for choice in choices {
        run.begin_step(format!("{}: {}", subject.name, choice.label))?;
        let retained = RetainedSamples::of_reel(std::slice::from_ref(frame), &choice.options, 1, run.progress)?;
        let distortion = judge.judge(&retained.decoded[0].cloud)?;
        let point = point(subject.name, choice, frame, &retained.samples, &distortion);
        run.add_rows([row(&point, frame, &retained.samples)]);
        run.say_measured(point.clone());
        run.add_rate(point);
    }
    Ok(())
}

fn point(
    sequence: &str,
    choice: Choice,
    frame: &Original,
    samples: &RetainedSamples,
    distortion: &Distortion,
) -> RatePoint {
    let [picture, error_map] = match &distortion.first {
        Some((picture, map)) => [small(picture), small(&map.to_heatmap())],
        None => Default::default(),
    };
    RatePoint {
        sequence: sequence.to_owned(),
        sweep: choice.sweep,
        label: choice.label,
        options: choice.options,
        bits_per_point: 8.0 * samples.bytes as f64 / frame.cloud.positions.len().max(1) as f64,
        error: distortion.error,
        flip: distortion.flip,
        picture,
        error_map,
    }
}

fn row(point: &RatePoint, frame: &Original, samples: &RetainedSamples) -> Row {
    let error = &point.error;
    let finite = |number: Option<f64>| Cell::maybe(number.filter(|number| number.is_finite()));
    let mut cells = vec![
        Cell::Text(point.sequence.clone()),
        Cell::Text(point.sweep.name().to_owned()),
        Cell::Text(point.label.clone()),
        Cell::Number(frame.index as f64),
        Cell::Number(frame.cloud.positions.len() as f64),
        Cell::Number(samples.points as f64),
        Cell::Number(point.bits_per_point),
    ];
    cells.extend([error.d1_psnr_db(), error.d2_psnr_db(), error.color_psnr_db()].map(finite));
    cells.push(Cell::maybe(error.normals.map(|normals| normals.mean_deg)));
    cells.push(Cell::Number(point.flip));
    cells.push(Cell::Number(samples.bytes as f64));
    Row::new(cells)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::{BenchOptions, Input, run};
    use crate::cloud::{Attributes, Positions};
    use crate::progress::Progress;
    use crate::sequence::{FrameEntry, Sequence};
    use std::sync::Arc;

    fn sphere() -> RawCloud {
        let places: Vec<[f32; 3]> = (0..3000)
            .map(|index| {
                let z = (index as f32 + 0.5) / 1500.0 - 1.0;
                let angle = index as f32 * 2.399_963;
                let radius = (1.0 - z * z).sqrt();
                [radius * angle.cos(), radius * angle.sin(), z]
            })
            .collect();
        let color = |place: &[f32; 3]| {
            let [x, y, z] = place.map(|value| ((value + 1.0) * 100.0) as u8);
            [x, y, z, 255]
        };
        let attributes = Attributes {
            colors: Some(places.iter().map(color).collect()),
            normals: Some(places.clone()),
            ..Attributes::default()
        };
        RawCloud {
            attributes,
            ..RawCloud::from_positions(Positions::F32(places))
        }
    }

    #[test]
    fn sweeps_cover_exactly_the_attributes_of_a_frame() {
        let count = |cloud: &RawCloud, sweep| choices(cloud).iter().filter(|choice| choice.sweep == sweep).count();
        let bare = RawCloud::from_positions(sphere().positions);
        for (sweep, all, of_bare) in [
            (Sweep::Positions, 13, 13),
            (Sweep::Normals, 3, 0),
            (Sweep::Colors, 7, 0),
        ] {
            assert_eq!(
                (count(&sphere(), sweep), count(&bare, sweep)),
                (all, of_bare),
                "{sweep:?}"
            );
        }
        for choice in choices(&sphere()) {
            choice.options.check().unwrap();
        }
        let labels: Vec<String> = choices(&sphere()).into_iter().map(|choice| choice.label).collect();
        assert_eq!(labels[..2], ["every point", "sampling density"]);
        assert!(labels.contains(&"within 0.00098".to_owned()), "{labels:?}");
    }

    #[test]
    fn more_bits_mean_a_smaller_error() {
        let sequence = Sequence::with_decoder(vec![FrameEntry::file("sphere.ply")], |_| Ok(sphere()));
        let input = Input {
            name: "sphere".to_owned(),
            sequence: Arc::new(sequence),
            shape: None,
        };
        let options = BenchOptions {
            viewport_px: [160, 120],
            viewpoints: 1,
            ..BenchOptions::new(RATE)
        };
        let report = run(&[input], &options, None, &|_| {}, &Progress::default()).unwrap();
        let of = |sweep, label: &str| {
            let mut points = report.rates.iter();
            let point = points.find(|point| point.sweep == sweep && point.label == label);
            point.unwrap_or_else(|| panic!("{label}"))
        };
        let of_bits = |bits: u8| of(Sweep::Positions, &format!("{bits} bits"));
        for bits in 6..12 {
            let [coarse, fine] = [bits, bits + 1].map(of_bits);
            assert!(coarse.bits_per_point < fine.bits_per_point, "{bits}");
            assert!(coarse.error.d1_psnr_db() < fine.error.d1_psnr_db(), "{bits}");
        }
        assert!(
            of_bits(6).flip > of_bits(11).flip,
            "{} {}",
            of_bits(6).flip,
            of_bits(11).flip
        );
        let [exact, rough] = [0, 32].map(|error| of(Sweep::Colors, &format!("colours ± {error}")));
        assert!(exact.error.color_psnr_db() > rough.error.color_psnr_db());
        assert!(exact.bits_per_point > rough.bits_per_point);
        let lossless = of(Sweep::Positions, "lossless");
        assert_eq!((lossless.error.d1_psnr_db(), lossless.flip), (Some(f64::INFINITY), 0.0));
        assert_eq!(report.rows.len(), report.rates.len());
        assert_eq!(lossless.picture.dimensions(), (160, 120));
    }
}
