//! Encoder options of sequence files.

use super::arguments::byte_count;
use crate::cloud::LengthUnit;
use crate::convert::RateGoal;
use crate::reel::{Coding, Precision, ReelOptions};
use crate::scene::FirstLook;
use crate::sequence::Sequence;
use clap::{Args, ValueEnum};

/// Options of sequence files.
#[derive(Debug, Clone, Default, Args)]
#[command(next_help_heading = "Sequence files (.reel)")]
pub(in crate::cli) struct ReelArgs {
    /// Maximum error of a coordinate, such as 0.001 (file units) or 1mm, or `lossless` [default: an eighth of the local
    /// point spacing]
    #[arg(long, value_name = "LENGTH|lossless", conflicts_with_all = ["bits", "merge"])]
    precision: Option<ReelPrecision>,

    /// Voxel-downsample to about the point spacing: fewer points, a smaller file; cost and savings are printed first
    #[arg(long, conflicts_with = "bits")]
    merge: bool,

    /// Voxel-downsample to 2^N cells along the longest side; --merge chooses the cell size itself
    #[arg(long, value_name = "1..21", value_parser = clap::value_parser!(u8).range(1..=21))]
    bits: Option<u8>,

    /// Choose the precision for a file of at most this size, such as 10MB, by a few frames
    #[arg(long, value_name = "SIZE", value_parser = byte_count, conflicts_with_all = ["precision", "bits", "merge"])]
    target_size: Option<u64>,

    /// Choose the precision for this root mean square error of positions, such as 0.001 (file units) or 1mm
    #[arg(
        long,
        value_name = "LENGTH",
        value_parser = target_error,
        conflicts_with_all = ["precision", "bits", "merge", "target_size"],
    )]
    target_error: Option<Length>,

    /// Bits per normal: 13, 15 or 17; 0 stores them as in the file, with --precision
    #[arg(long, value_name = "BITS", hide_short_help = true)]
    normal_bits: Option<u8>,

    /// With --merge: do not estimate missing normals
    #[arg(long, hide_short_help = true)]
    no_normals: bool,

    /// Maximum error per colour channel (0–255); 0 is lossless [default: 2]
    #[arg(long, value_name = "0..100", value_parser = clap::value_parser!(u8).range(0..=100))]
    color_error: Option<u8>,

    /// Frames per group: they share a bounding cube and may be predicted from each other [default: 10]
    #[arg(long, value_name = "N", hide_short_help = true, value_parser = clap::value_parser!(u32).range(1..))]
    keyframes: Option<u32>,

    /// Encode compactly, or for fast decoding: at least six times as fast at 1.1 to 1.5 times the size [default:
    /// compact]
    #[arg(long, value_name = "compact|fast")]
    coding: Option<ReelCoding>,

    /// Preserve the order of the points, for trajectories; not with --merge or --bits
    #[arg(long)]
    keep_order: bool,
}

impl ReelArgs {
    /// Returns true if any of them is given.
    pub(in crate::cli) fn is_given(&self) -> bool {
        self.precision.is_some()
            || self.merge
            || self.bits.is_some()
            || self.target_size.is_some()
            || self.target_error.is_some()
            || self.normal_bits.is_some()
            || self.no_normals
            || self.color_error.is_some()
            || self.keyframes.is_some()
            || self.coding.is_some()
            || self.keep_order
    }

    /// The options for a file of `sequence`, and a note on the assumptions behind them.
    pub(in crate::cli) fn options(&self, sequence: &Sequence) -> (ReelOptions, Option<String>) {
        let mut assumed = None;
        let (precision, default) = match (self.precision, self.bits) {
            (Some(ReelPrecision::Lossless), _) => (Precision::Lossless, ReelOptions::lossless()),
            (Some(ReelPrecision::Length(length)), _) => {
                let (length, note) = length.in_units_of(sequence);
                assumed = note;
                (Precision::Length(length), ReelOptions::default())
            }
            (None, Some(bits)) => (Precision::Bits(bits), ReelOptions::default()),
            (None, None) if self.merge => (Precision::SamplingDensity, ReelOptions::merged()),
            (None, None) => (Precision::PointSpacing, ReelOptions::default()),
        };
        let options = ReelOptions {
            precision,
            coding: self.coding.map_or(default.coding, Coding::from),
            normal_bits: self.normal_bits.unwrap_or(default.normal_bits),
            estimates_normals: !self.no_normals && precision == Precision::SamplingDensity && is_surface(sequence),
            color_error: self.color_error.unwrap_or(default.color_error),
            keyframes: self.keyframes.unwrap_or(default.keyframes),
            keep_order: self.keep_order,
            fps: Some(sequence.fps()),
            ..default
        };
        (options, assumed)
    }

    /// The size or error that the precision is chosen for, and a note on the assumptions behind it.
    pub(in crate::cli) fn goal(&self, sequence: &Sequence) -> (Option<RateGoal>, Option<String>) {
        match (self.target_size, self.target_error) {
            (Some(bytes), _) => (Some(RateGoal::Bytes(bytes)), None),
            (None, Some(length)) => {
                let (length, assumed) = length.in_units_of(sequence);
                (Some(RateGoal::RmsError(length)), assumed)
            }
            (None, None) => (None, None),
        }
    }
}

/// Returns true if the points of the first readable frame sample a surface, so that normals are meaningful.
fn is_surface(sequence: &Sequence) -> bool {
    let first = sequence.frames().find_map(|index| sequence.frame(index).ok());
    first.is_some_and(|frame| FirstLook::of(&[&frame], sequence.origin()).has_surface())
}

/// The unit of the first frame that can be read.
fn unit_of(sequence: &Sequence) -> Option<LengthUnit> {
    sequence.frames().find_map(|index| sequence.decode(index).ok())?.unit
}

/// Coding objective for files: small, or fast.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum ReelCoding {
    Compact,
    Fast,
}

impl From<ReelCoding> for Coding {
    fn from(coding: ReelCoding) -> Self {
        match coding {
            ReelCoding::Compact => Self::Compact,
            ReelCoding::Fast => Self::Fast,
        }
    }
}

/// Precision of coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
enum ReelPrecision {
    Lossless,
    Length(Length),
}

/// A length in units of the file, or in a unit of so many metres if given so.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Length {
    length: f64,
    metres: Option<f64>,
}

impl Length {
    /// The length in units of the files, and a note if their unit is assumed.
    fn in_units_of(self, sequence: &Sequence) -> (f64, Option<String>) {
        let Some(metres) = self.metres else {
            return (self.length, None);
        };
        let unit = unit_of(sequence);
        let note = || "no file says its unit of length: metres are assumed".to_owned();
        let assumed = unit.is_none().then(note);
        (
            self.length * metres / unit.unwrap_or(LengthUnit::Metre).metres(),
            assumed,
        )
    }
}

fn target_error(text: &str) -> Result<Length, String> {
    match text.parse() {
        Ok(ReelPrecision::Length(length)) => Ok(length),
        _ => Err("expected a length above 0 such as 0.001 or 1mm".to_owned()),
    }
}

impl std::str::FromStr for ReelPrecision {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        /// Longer ones first: mm ends with m.
        const UNITS: [(&str, f64); 5] = [("um", 1e-6), ("mm", 1e-3), ("cm", 1e-2), ("m", 1.0), ("ft", 0.3048)];
        if text == "lossless" {
            return Ok(Self::Lossless);
        }
        let unit = UNITS.iter().find(|(symbol, _)| text.ends_with(symbol));
        let (number, metres) = match unit {
            Some((symbol, metres)) => (&text[..text.len() - symbol.len()], Some(*metres)),
            None => (text, None),
        };
        let length: Option<f64> = number.trim().parse().ok();
        length
            .filter(|length| length.is_finite() && *length > 0.0)
            .map(|length| Self::Length(Length { length, metres }))
            .ok_or_else(|| "expected lossless, or a length above 0 such as 0.001 or 1mm".to_owned())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_use_the_unit_of_the_file_unless_given_one() {
        let length = |text: &str| text.parse::<ReelPrecision>();
        assert_eq!(length("lossless"), Ok(ReelPrecision::Lossless));
        let of = |length, metres| Ok(ReelPrecision::Length(Length { length, metres }));
        assert_eq!(length("0.001"), of(0.001, None));
        assert_eq!(length("1mm"), of(1.0, Some(1e-3)));
        assert_eq!(length("2 cm"), of(2.0, Some(1e-2)));
        assert_eq!(length("1.5m"), of(1.5, Some(1.0)));
        for wrong in ["", "mm", "0", "-1mm", "nan", "1km", "lossy"] {
            assert!(length(wrong).is_err(), "{wrong}");
        }
    }
}
