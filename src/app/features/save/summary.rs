//! An estimate in words: a quantity and its value per line.

use super::plan::Savable;
use crate::app::widgets::numbers::{bytes, rounded_to};
use crate::convert::{Estimate, EstimatedErrors};
use crate::messages::grouped;

/// A line: quantity, value, and explanation.
pub(super) type Line = (&'static str, String, &'static str);

/// Returns the estimated size lines of files of `frames` frames, compared with a source of `source_bytes` bytes.
pub(super) fn lines(estimate: &Estimate, frames: usize, source_bytes: Option<u64>, of: &Savable) -> Vec<Line> {
    let whole = estimate.frame_bytes * frames as f64;
    let mut lines = vec![(
        "Size",
        format!("about {}{}", bytes(whole as u64), compared(whole, source_bytes)),
        "Of all frames, by those that were encoded",
    )];
    let retained = 100.0 * estimate.retained_points / estimate.points.max(1.0);
    let [points, retained_points] =
        [estimate.points, estimate.retained_points].map(|points| grouped(points.round() as u64));
    let of_points = if points == retained_points {
        format!("{points} per frame, all of them")
    } else {
        format!("{retained_points} of {points} per frame ({retained:.0} %)")
    };
    lines.push(("Points", of_points, "Points in one cell become one"));
    lines.push((
        "Bits per point",
        rounded_to(estimate.bits_per_point(), 3),
        "All bytes of a frame, divided by its remaining points",
    ));
    lines.extend(streams(estimate).map(|streams| ("By stream", streams, "Bits per point of each stream of the file")));
    if let Some(errors) = &estimate.errors {
        lines.extend(error_lines(errors, of));
    }
    lines
}

/// Computes the price of merging the points of cells, in costs and savings, by an estimate of a file that is merged or
/// not; `None` where only one of both is known.
pub(super) fn merge_price(estimate: &Estimate, is_merged: bool, frames: usize) -> Option<String> {
    let other = estimate.other_way?;
    let size = |frame_bytes: f64| bytes((frame_bytes * frames as f64) as u64);
    let (left, merged_size, size) = if is_merged {
        (estimate.retained_points, size(estimate.frame_bytes), size(other.bytes))
    } else {
        (other.points, size(other.bytes), size(estimate.frame_bytes))
    };
    let merged = (estimate.points - left).max(0.0);
    let percent = 100.0 * merged / estimate.points.max(1.0);
    let [merged, points] = [merged, estimate.points].map(|points| grouped(points.round() as u64));
    Some(format!(
        "Merges {merged} of {points} points per frame ({percent:.0} %): about {merged_size} instead of {size}"
    ))
}

/// Returns a warning before much is lost: points of a scan that is not a surface are merged where they are dense.
pub(super) fn warning(estimate: &Estimate) -> Option<String> {
    const MUCH: f64 = 0.2;
    let lost = 1.0 - estimate.retained_points / estimate.points.max(1.0);
    (estimate.points > 0.0 && lost > MUCH).then(|| {
        let lost = 100.0 * lost;
        format!(
            "{lost:.0} % of the points are merged with others. Point spacing without merging, a length or lossless \
             keep each of them"
        )
    })
}

/// Bits of each stream, the largest first.
fn streams(estimate: &Estimate) -> Option<String> {
    let mut streams = estimate.bits_by_stream();
    streams.sort_by(|a, b| b.1.total_cmp(&a.1));
    let words = streams.iter().map(|(kind, bits)| format!("{} {bits:.2}", kind.name()));
    (!streams.is_empty()).then(|| words.collect::<Vec<_>>().join(", "))
}

fn compared(whole: f64, source_bytes: Option<u64>) -> String {
    let Some(source) = source_bytes.filter(|&source| source > 0) else {
        return String::new();
    };
    let times = source as f64 / whole.max(1.0);
    let share = if times >= 1.0 {
        format!("1/{}", rounded_to(times, 2))
    } else {
        format!("{} times as much", rounded_to(1.0 / times, 2))
    };
    format!(", the source has {} ({share})", bytes(source))
}

fn error_lines(errors: &EstimatedErrors, of: &Savable) -> Vec<Line> {
    let length = |length: f64| format!("{} {}", rounded_to(length, 3), of.unit).trim_end().to_owned();
    let mut lines = vec![(
        "Position error",
        if errors.largest == 0.0 {
            "none".to_owned()
        } else {
            format!("largest {}, RMS {}", length(errors.largest), length(errors.rms))
        },
        "Distance of a point to the nearest one of the other cloud, in both directions",
    )];
    lines.extend(errors.d1_psnr_db.map(|psnr| {
        let what = "PSNR from point to point, in relation to the longest edge of the cloud's box";
        ("D1", decibels(psnr), what)
    }));
    lines.extend(errors.color_psnr_db.map(|psnr| {
        let what = "PSNR of red, green and blue of nearest points";
        ("Colours", decibels(psnr), what)
    }));
    lines.extend(errors.normals_deg.map(|[mean, largest]| {
        let text = if largest < 1e-3 {
            "none".to_owned()
        } else {
            format!("mean {mean:.2}°, largest {largest:.1}°")
        };
        ("Angle of normals", text, "To the normals of nearest points")
    }));
    lines
}

fn decibels(psnr_db: f64) -> String {
    if psnr_db.is_finite() {
        format!("{psnr_db:.1} dB")
    } else {
        "no error".to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::convert::OtherWay;
    use crate::io::Losses;
    use crate::reel::StreamKind;

    fn savable(unit: &'static str) -> Savable {
        Savable {
            sequence: None,
            stem: String::new(),
            range: 0..1,
            shown: 0,
            is_playing: false,
            extent: 1.0,
            unit,
            has_colors: true,
            has_normals: true,
            samples_surface: true,
            clip: None,
            is_busy: false,
        }
    }

    fn estimate() -> Estimate {
        let mut bytes_by_stream = [0.0; StreamKind::ALL.len()];
        bytes_by_stream[0] = 500.0;
        bytes_by_stream[2] = 700.0;
        Estimate {
            frames: 5,
            points: 2000.0,
            retained_points: 1000.0,
            frame_bytes: 1250.0,
            bytes_by_stream: Some(bytes_by_stream),
            losses: Losses::default(),
            other_way: Some(OtherWay {
                points: 2000.0,
                bytes: 2500.0,
            }),
            errors: Some(EstimatedErrors {
                largest: 0.012_34,
                rms: 0.001,
                d1_psnr_db: Some(71.25),
                color_psnr_db: Some(f64::INFINITY),
                normals_deg: Some([0.5, 2.0]),
            }),
        }
    }

    fn texts(lines: Vec<Line>) -> Vec<String> {
        lines
            .into_iter()
            .map(|(what, text, _)| format!("{what}: {text}"))
            .collect()
    }

    #[test]
    fn estimates_are_shown_in_the_units_of_the_file() {
        let told = texts(lines(&estimate(), 1024, Some(25_600_000), &savable("mm")));
        assert_eq!(
            told,
            [
                "Size: about 1.2 MiB, the source has 24.4 MiB (1/20)",
                "Points: 1,000 of 2,000 per frame (50 %)",
                "Bits per point: 10",
                "By stream: color 5.60, geometry 4.00",
                "Position error: largest 0.0123 mm, RMS 0.001 mm",
                "D1: 71.2 dB",
                "Colours: no error",
                "Angle of normals: mean 0.50°, largest 2.0°",
            ]
        );
    }

    #[test]
    fn the_cost_of_merging_is_shown_before_and_after_choosing_it() {
        let expected = "Merges 1,000 of 2,000 points per frame (50 %): about 12.2 KiB instead of 24.4 KiB";
        assert_eq!(merge_price(&estimate(), true, 10).as_deref(), Some(expected));
        let unmerged = Estimate {
            retained_points: 2000.0,
            frame_bytes: 2500.0,
            other_way: Some(OtherWay {
                points: 1000.0,
                bytes: 1250.0,
            }),
            ..estimate()
        };
        assert_eq!(merge_price(&unmerged, false, 10).as_deref(), Some(expected));
        let alone = Estimate {
            other_way: None,
            ..estimate()
        };
        assert_eq!(merge_price(&alone, true, 10), None);
    }

    #[test]
    fn losing_a_fifth_of_the_points_is_a_warning() {
        let retained = |retained_points: f64| {
            warning(&Estimate {
                retained_points,
                ..estimate()
            })
        };
        assert_eq!([retained(2000.0), retained(1700.0)], [None, None]);
        assert!(retained(660.0).is_some_and(|text| text.starts_with("67 % of the points are merged")));
        let nothing = Estimate {
            points: 0.0,
            retained_points: 0.0,
            ..estimate()
        };
        assert_eq!(warning(&nothing), None);
    }

    #[test]
    fn unknown_values_are_not_shown() {
        let bare = Estimate {
            retained_points: 2000.0,
            bytes_by_stream: None,
            errors: None,
            ..estimate()
        };
        let told = texts(lines(&bare, 1, None, &savable("")));
        assert_eq!(
            told,
            [
                "Size: about 1.2 KiB",
                "Points: 2,000 per frame, all of them",
                "Bits per point: 5"
            ]
        );
        assert_eq!(streams(&bare), None);
        assert!(compared(100.0, Some(50)).contains("2 times as much"));
    }
}
