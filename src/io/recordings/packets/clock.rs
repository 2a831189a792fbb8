//! The unit of the times of a capture, where it differs from its header.
//!
//! **How it works.** Recorders have written nanoseconds into captures of microseconds. Two forms are known: the part of
//! a second is in nanoseconds (a million or more, which microseconds never are), or the whole time is nanoseconds split
//! by a million, which makes the capture pass a thousand times more slowly than the sensor's own clock ([`Samples`]).
//! Such times never cut frames, and are corrected as far as possible.

use std::time::Duration;

/// The unit of times.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) enum Clock {
    /// As in the header.
    #[default]
    Stated,
    /// The parts of seconds are nanoseconds, and not microseconds.
    NanosecondParts,
    /// All of a time is nanoseconds, and not microseconds.
    Nanoseconds,
    /// The parts of seconds are microseconds, and not nanoseconds.
    MicrosecondParts,
}

/// Upper bound of a part of a second in microseconds.
pub(super) const MICROS_PER_SECOND: u32 = 1_000_000;

const SCALE: f64 = 1000.0;
/// Clocks of networks and sensors differ by less, even over the bursts in which packets come.
const SCALE_TOLERANCE: f64 = 0.1;

/// Packets between which times are compared, at least.
const MIN_SAMPLES: u32 = 8;

const HOUR: Duration = Duration::from_hours(1);

/// Microseconds never stay below a thousandth of a second for this long.
const MIN_SPAN_S: f64 = 0.1;

impl Clock {
    /// For people: the assumption, as a sentence without its file; `None` where there is none.
    pub(super) fn note(self) -> Option<&'static str> {
        match self {
            Self::Stated => None,
            Self::NanosecondParts => Some(
                "the capture says that its times are in microseconds, but parts of seconds are a million and more: \
                 they \
                 are read as nanoseconds",
            ),
            Self::Nanoseconds => Some(
                "the times of the capture pass 1000 times faster than the clock of the sensor: they are read as \
                 nanoseconds, not as microseconds. Frames are cut by azimuth; the date is lost",
            ),
            Self::MicrosecondParts => Some(
                "the capture says that its times are in nanoseconds, but no part of a second is a million or more: \
                 they \
                 are read as microseconds",
            ),
        }
    }

    /// The time of a packet whose time is `stated` in the units of the header.
    pub(super) fn time(self, stated: Duration) -> Duration {
        match self {
            Self::Nanoseconds => stated / SCALE as u32,
            Self::Stated | Self::NanosecondParts | Self::MicrosecondParts => stated,
        }
    }
}

/// Times of the packets of one sensor: of the capture, and of the sensor's own clock.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Samples {
    first: Option<(Duration, Duration)>,
    last: (Duration, Duration),
    count: u32,
}

impl Samples {
    /// Adds a clock sample of a packet; the sensor's clock counts from an arbitrary epoch, or from the hour.
    pub(super) fn add(&mut self, captured: Duration, mut measured: Duration) {
        if self.first.is_some() && measured + HOUR / 2 < self.last.1 {
            measured += HOUR;
        }
        self.first.get_or_insert((captured, measured));
        self.last = (captured, measured);
        self.count += 1;
    }

    /// Seconds between the first and the last packet, by either clock; `None` of too few packets, or of clocks that ran
    /// backwards.
    fn spans_s(&self) -> Option<(f64, f64)> {
        let (captured, measured) = self.first?;
        let captured = self.last.0.checked_sub(captured)?.as_secs_f64();
        let measured = self.last.1.checked_sub(measured)?.as_secs_f64();
        (self.count >= MIN_SAMPLES && measured > 0.0).then_some((captured, measured))
    }
}

/// Statistics of the examined records of a capture.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Fractions {
    /// True if the header specifies nanoseconds; `None` for captures that specify the unit of each interface.
    pub(super) is_nanoseconds: Option<bool>,
    /// The largest part of a second, in the unit of the header.
    pub(super) largest: u32,
}

/// The clock of a capture.
pub(super) fn of(fractions: Fractions, samples: &[Samples]) -> Clock {
    let is_large = fractions.largest >= MICROS_PER_SECOND;
    let spans = || samples.iter().filter_map(Samples::spans_s);
    let is_slow = |(captured, measured): (f64, f64)| (captured / measured / SCALE - 1.0).abs() < SCALE_TOLERANCE;
    match fractions.is_nanoseconds {
        Some(false) if is_large => Clock::NanosecondParts,
        Some(false) | None if spans().any(is_slow) => Clock::Nanoseconds,
        Some(true) if !is_large && spans().any(|(_, measured)| measured >= MIN_SPAN_S) => Clock::MicrosecondParts,
        _ => Clock::Stated,
    }
}
