//! Save settings of the user.

use super::estimates::Estimates;
use crate::convert::{Place, RateGoal, Target};
use crate::io::WriteFormat;
use crate::reel::{Coding, Precision, ReelOptions};
use std::path::PathBuf;

/// Format in which the sequence is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SaveFormat {
    /// One sequence file.
    Reel,
    /// Folder with one file per frame.
    Files(WriteFormat),
}

/// Precision of positions in a sequence file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PrecisionKind {
    /// Every point, within a part of how far apart points are around it.
    PointSpacing,
    /// Cells about as large as points are far apart; the points in one become one.
    SamplingDensity,
    /// Cells of a given number of bits.
    Bits,
    /// No coordinate is off by more than a length.
    Length,
    /// The precision that gives a file of a size.
    FileSize,
    /// The precision that gives points a root mean square error.
    RmsError,
    /// Every bit.
    Lossless,
}

impl PrecisionKind {
    /// Returns true if points are stored one by one, so that their order and exact numbers can be retained.
    pub(super) fn keeps_points(self) -> bool {
        matches!(
            self,
            Self::PointSpacing | Self::Length | Self::FileSize | Self::RmsError | Self::Lossless
        )
    }

    /// Returns this precision with the points of each cell merged or not, where that is a separate choice.
    pub(super) fn merged(self, merges: bool) -> Self {
        match (self, merges) {
            (Self::PointSpacing, true) => Self::SamplingDensity,
            (Self::SamplingDensity, false) => Self::PointSpacing,
            _ => self,
        }
    }
}

/// Save settings of the user.
#[derive(Debug)]
#[expect(clippy::struct_excessive_bools, reason = "each is a choice of its own")]
pub struct Save {
    /// Format of the output.
    pub format: SaveFormat,
    /// Precision of positions.
    pub precision: PrecisionKind,
    /// For [`PrecisionKind::Bits`].
    pub bits: u8,
    /// For [`PrecisionKind::Length`] and [`PrecisionKind::RmsError`], in the unit of the file.
    pub length: f64,
    /// For [`PrecisionKind::FileSize`], in MB.
    pub size_mb: f64,
    /// Time against bits.
    pub coding: Coding,
    /// Normals are estimated where the files have none and points that are merged sample a surface.
    pub estimates_normals: bool,
    /// Bits of a normal; 0 retains the exact numbers, where points are stored one by one.
    pub normal_bits: u8,
    /// Most that a channel of a colour is off by.
    pub color_error: u8,
    /// Points retain the order of the file, where they are stored one by one.
    pub keeps_order: bool,
    /// Only frames from in to out point are written.
    pub is_of_range: bool,
    /// Only the points that the clip of the image keeps are written, if there is one.
    pub crops: bool,
    /// The folder of the file, or of the folder.
    pub folder: String,
    /// Its name without extension; made from the sequence if `None`.
    pub name: Option<String>,
    /// Points of the open sequence sample a surface.
    pub(in crate::app) samples_surface: bool,
    /// Target state found at the last check of a destination, cropped or not.
    pub(in crate::app) found: Option<(PathBuf, Target, bool, Place)>,
    /// Size and quality estimates for the settings.
    pub estimates: Estimates,
}

impl Default for Save {
    fn default() -> Self {
        let options = ReelOptions::default();
        Self {
            format: SaveFormat::Reel,
            precision: PrecisionKind::PointSpacing,
            bits: 10,
            length: 0.0,
            size_mb: 10.0,
            coding: options.coding,
            estimates_normals: true,
            normal_bits: options.normal_bits,
            color_error: options.color_error,
            keeps_order: false,
            is_of_range: false,
            crops: false,
            folder: String::new(),
            name: None,
            samples_surface: false,
            found: None,
            estimates: Estimates::default(),
        }
    }
}

impl Save {
    /// Chooses the precision of positions. A lossless choice makes everything lossless at first.
    pub fn choose_precision(&mut self, precision: PrecisionKind) {
        let options = match precision {
            PrecisionKind::Lossless => ReelOptions::lossless(),
            _ => ReelOptions::default(),
        };
        let was_lossless = self.precision == PrecisionKind::Lossless;
        if was_lossless != (precision == PrecisionKind::Lossless) {
            (self.normal_bits, self.color_error) = (options.normal_bits, options.color_error);
        }
        if self.normal_bits == 0 && !precision.keeps_points() {
            self.normal_bits = options.normal_bits;
        }
        self.precision = precision;
    }

    /// The size or error that the precision is chosen for.
    pub fn goal(&self) -> Option<RateGoal> {
        if self.format != SaveFormat::Reel {
            return None;
        }
        match self.precision {
            PrecisionKind::FileSize => Some(RateGoal::Bytes((self.size_mb * 1e6) as u64)),
            PrecisionKind::RmsError => Some(RateGoal::RmsError(self.length)),
            PrecisionKind::PointSpacing
            | PrecisionKind::SamplingDensity
            | PrecisionKind::Bits
            | PrecisionKind::Length
            | PrecisionKind::Lossless => None,
        }
    }

    /// Returns the write target of the frames, for a sequence of `fps` frames per second.
    pub fn target(&self, fps: f64) -> Target {
        match self.format {
            SaveFormat::Reel => Target::Reel(self.reel_options(fps)),
            SaveFormat::Files(format) => Target::Files(format),
        }
    }

    fn reel_options(&self, fps: f64) -> ReelOptions {
        let (precision, usual) = match self.precision {
            // Precisions of goals are chosen when frames are known.
            PrecisionKind::PointSpacing | PrecisionKind::FileSize | PrecisionKind::RmsError => {
                (Precision::PointSpacing, ReelOptions::default())
            }
            PrecisionKind::SamplingDensity => (Precision::SamplingDensity, ReelOptions::merged()),
            PrecisionKind::Bits => (Precision::Bits(self.bits), ReelOptions::default()),
            PrecisionKind::Length => (Precision::Length(self.length), ReelOptions::default()),
            PrecisionKind::Lossless => (Precision::Lossless, ReelOptions::lossless()),
        };
        ReelOptions {
            precision,
            coding: self.coding,
            estimates_normals: self.estimates_normals
                && self.samples_surface
                && self.precision == PrecisionKind::SamplingDensity,
            normal_bits: self.normal_bits,
            color_error: self.color_error,
            keep_order: self.keeps_order && self.precision.keeps_points(),
            fps: Some(fps),
            ..usual
        }
    }
}

/// A round length that is about a ten-thousandth of `extent`: 1, 2 or 5 times a power of ten.
pub(super) fn usual_length(extent: f64) -> f64 {
    let wanted = extent * 1e-4;
    if !(wanted > 0.0 && wanted.is_finite()) {
        return 0.001;
    }
    let power = 10f64.powi(wanted.log10().floor() as i32);
    let steps = [5.0, 2.0, 1.0].map(|step| step * power);
    steps.into_iter().find(|step| *step <= wanted).unwrap_or(power)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn options(save: &Save) -> ReelOptions {
        match save.target(24.0) {
            Target::Reel(options) => options,
            Target::Files(format) => panic!("{format}"),
        }
    }

    #[test]
    fn lossless_applies_to_every_attribute_until_changed() {
        let mut save = Save::default();
        let usual = ReelOptions {
            fps: Some(24.0),
            ..ReelOptions::default()
        };
        assert_eq!(options(&save), usual);
        save.choose_precision(PrecisionKind::Lossless);
        let lossless = ReelOptions {
            fps: Some(24.0),
            ..ReelOptions::lossless()
        };
        assert_eq!(options(&save), lossless);
        save.color_error = 4;
        save.choose_precision(PrecisionKind::Lossless);
        assert_eq!(options(&save).color_error, 4, "what was chosen stays");
        save.choose_precision(PrecisionKind::Bits);
        assert_eq!((save.normal_bits, save.color_error), (13, 2));
        assert_eq!(options(&save).precision, Precision::Bits(10));
    }

    #[test]
    fn every_choice_can_be_written() {
        for precision in [
            PrecisionKind::PointSpacing,
            PrecisionKind::SamplingDensity,
            PrecisionKind::Bits,
            PrecisionKind::Length,
            PrecisionKind::FileSize,
            PrecisionKind::RmsError,
            PrecisionKind::Lossless,
        ] {
            let mut save = Save {
                length: 0.01,
                keeps_order: true,
                ..Save::default()
            };
            save.choose_precision(PrecisionKind::Length);
            save.normal_bits = 0;
            save.choose_precision(precision);
            options(&save).check().unwrap();
            assert_eq!(options(&save).keep_order, precision.keeps_points());
            let has_goal = matches!(precision, PrecisionKind::FileSize | PrecisionKind::RmsError);
            assert_eq!(save.goal().is_some(), has_goal);
        }
    }

    #[test]
    fn default_lengths_are_round() {
        for (extent, length) in [(1.0, 1e-4), (3.0, 2e-4), (0.9, 5e-5), (70_000.0, 5.0), (0.0, 0.001)] {
            assert!((usual_length(extent) / length - 1.0).abs() < 1e-9, "{extent}");
        }
        assert_eq!(usual_length(f64::NAN), 0.001);
    }
}
