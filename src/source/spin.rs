//! A turning shape without an end, which is live: frames come by the clock, and old ones are gone for good.
//!
//! It stands in for a sensor: display, measurement and recording of streams can be tried on it.

use super::opener::Made;
use super::shapes::counted;
use super::{
    About, Capabilities, DecodeFailure, DecodedFrame, Decoder, FrameEntry, Growth, SequenceError, Shape, Source,
};
use crate::cloud::{Positions, RawCloud};
use crate::locks::lock;
use crate::progress::Progress;
use glam::{Quat, Vec3};
use std::f32::consts::TAU;
use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::{Duration, Instant};

/// The word before the shape.
const WORD: &str = "spin";

/// A shape that turns: `spin:torus` or `spin:torus:20000`.
pub(super) const SPIN: Made = Made {
    has_word: |word| word == WORD,
    said: || format!("a turning one, {WORD}:torus:100000"),
    make: |_, shape| {
        let (name, count) = shape.split_once(':').unwrap_or((shape, ""));
        let (shape, points) = counted(name, count)?;
        Some(Arc::new(Spin::new(shape, points)))
    },
};

/// Frame rate, in frames per second.
const RATE: f64 = 24.0;

/// Frames of one turn.
const FRAMES_PER_TURN: usize = 96;

/// Number of newest frames that can be decoded: two seconds.
const RING_LENGTH: usize = 48;

/// `spin:torus:100000`: a shape that turns once in four seconds, of this many points.
#[derive(Debug)]
pub struct Spin {
    shape: Shape,
    points: usize,
    begun: Instant,
    ring: Arc<Ring>,
}

/// State shared between the decoders and the source.
#[derive(Debug)]
struct Ring {
    /// Frames that have come.
    count: AtomicUsize,
    /// The shape at rest, once the first frame is decoded.
    at_rest: Mutex<Option<Arc<RawCloud>>>,
}

impl Ring {
    fn frames(&self) -> Range<usize> {
        let end = self.count.load(Ordering::Relaxed);
        end.saturating_sub(RING_LENGTH)..end
    }
}

impl Spin {
    /// The first frame comes now.
    pub fn new(shape: Shape, points: usize) -> Self {
        Self {
            shape,
            points,
            begun: Instant::now(),
            ring: Arc::new(Ring {
                count: AtomicUsize::new(1),
                at_rest: Mutex::default(),
            }),
        }
    }

    /// Time at which a frame comes, since the first.
    fn time_of(index: usize) -> Duration {
        Duration::from_secs_f64(index as f64 / RATE)
    }
}

impl Source for Spin {
    fn frames(&self) -> Range<usize> {
        self.ring.frames()
    }

    fn entry(&self, index: usize) -> Arc<FrameEntry> {
        let path = format!("{WORD}:{}:{}", self.shape.name(), self.points);
        Arc::new(FrameEntry {
            name: format!("{} {index}", self.shape.name()),
            number: Some(index as u64),
            time: Some(Self::time_of(index)),
            ..FrameEntry::embedded(path, &[])
        })
    }

    fn decoder(&self) -> Box<dyn Decoder> {
        Box::new(SpinDecoder {
            shape: self.shape,
            points: self.points,
            ring: Arc::clone(&self.ring),
        })
    }

    fn about(&self) -> About<'_> {
        About::default()
    }

    fn capabilities(&self) -> Capabilities<'_> {
        Capabilities {
            growth: Some(self),
            ..Capabilities::default()
        }
    }
}

impl Growth for Spin {
    fn is_live(&self) -> bool {
        true
    }

    fn may_grow(&self) -> bool {
        true
    }

    fn look_again(&self) -> Result<usize, SequenceError> {
        let count = (self.begun.elapsed().as_secs_f64() * RATE) as usize + 1;
        let before = self.ring.count.fetch_max(count, Ordering::Relaxed);
        Ok(count.saturating_sub(before))
    }

    fn wait_for_more(&self, at_most: Duration) -> Result<usize, SequenceError> {
        let next = Self::time_of(self.ring.frames().end);
        thread::sleep(next.saturating_sub(self.begun.elapsed()).min(at_most));
        self.look_again()
    }
}

struct SpinDecoder {
    shape: Shape,
    points: usize,
    ring: Arc<Ring>,
}

impl Decoder for SpinDecoder {
    fn decode(
        &mut self,
        index: usize,
        _entry: &FrameEntry,
        _max_points: usize,
        _progress: &Progress,
    ) -> Result<DecodedFrame, DecodeFailure> {
        let at_rest =
            Arc::clone(lock(&self.ring.at_rest).get_or_insert_with(|| Arc::new(self.shape.cloud(self.points))));
        let turns = (index % FRAMES_PER_TURN) as f32 / FRAMES_PER_TURN as f32;
        let turn = Quat::from_rotation_y(TAU * turns);
        let turned = |at: &[f32; 3]| (turn * Vec3::from_array(*at)).to_array();
        let positions = match &at_rest.positions {
            Positions::F32(positions) => positions.iter().map(turned).collect(),
            // Shapes are sampled in single precision.
            Positions::F64(_) => Vec::new(),
        };
        let mut cloud = RawCloud::from_positions(Positions::F32(positions));
        cloud.attributes.clone_from(&at_rest.attributes);
        for normal in cloud.attributes.normals.iter_mut().flatten() {
            *normal = turned(normal);
        }
        Ok(cloud.into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn decoded(spin: &Spin, index: usize) -> RawCloud {
        let progress = Progress::default();
        let entry = spin.entry(index);
        let decoded = spin.decoder().decode(index, &entry, usize::MAX, &progress);
        decoded.unwrap().cloud
    }

    #[test]
    fn frames_arrive_by_the_clock_and_the_oldest_expire() {
        let mut spin = Spin::new(Shape::Torus, 10);
        assert_eq!(spin.frames(), 0..1);
        spin.begun -= Duration::from_secs(1);
        assert!(spin.look_again().unwrap() >= 24);
        assert_eq!(spin.frames().start, 0);
        spin.begun -= Duration::from_secs(9);
        spin.look_again().unwrap();
        let frames = spin.frames();
        assert!((240..300).contains(&frames.end), "{frames:?}");
        assert_eq!(frames.len(), RING_LENGTH);
        assert_eq!(spin.entry(240).time, Some(Duration::from_secs(10)));
        assert!(spin.wait_for_more(Duration::from_mins(1)).unwrap() >= 1);
    }

    #[test]
    fn the_shape_turns_about_the_up_axis_back_to_its_start() {
        let spin = Spin::new(Shape::Torus, 500);
        let [begin, quarter, turn] = [0, 24, 96].map(|index| decoded(&spin, index));
        let positions = |cloud: &RawCloud| -> Vec<Vec3> {
            let all = 0..cloud.positions.len();
            all.map(|index| cloud.positions.get(index).as_vec3()).collect()
        };
        assert_eq!(positions(&begin), positions(&turn));
        for (before, after) in positions(&begin).iter().zip(positions(&quarter)) {
            // A quarter turn about Y: z goes to x.
            assert!(after.abs_diff_eq(Vec3::new(before.z, before.y, -before.x), 1e-5));
        }
        assert_eq!(begin.attributes.colors, quarter.attributes.colors);
        assert_eq!(begin.positions.len(), 500);
    }
}
