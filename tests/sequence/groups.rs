//! Frames that are made from one another, and frames that are stored by levels.

use super::*;
use pointreel::progress::Progress;
use pointreel::source::{About, Capabilities, DecodedFrame, DecodedLevel, Decoder, Groups, Source};
use std::ops::Range;

const FRAMES: usize = 24;
const GROUP: usize = 6;

/// Points of the levels of a frame.
const LEVELS: [usize; 4] = [1600, 6400, 25_600, 102_400];

/// Frames, each made from the previous one in its group, all in levels.
struct Chained {
    entries: Vec<Arc<FrameEntry>>,
    /// Number of times that each frame was made.
    made: Arc<[AtomicUsize; FRAMES]>,
    /// Groups that a decoder is on, and whether two were ever on one.
    busy: Arc<[AtomicUsize; FRAMES / GROUP]>,
    met: Arc<AtomicUsize>,
}

impl Chained {
    fn new() -> Self {
        Self {
            entries: fake_sources(FRAMES).into_iter().map(Arc::new).collect(),
            made: Arc::new(std::array::from_fn(|_| AtomicUsize::new(0))),
            busy: Arc::new(std::array::from_fn(|_| AtomicUsize::new(0))),
            met: Arc::default(),
        }
    }
}

fn group_of(index: usize) -> Range<usize> {
    let start = index / GROUP * GROUP;
    start..start + GROUP
}

impl Source for Chained {
    fn frames(&self) -> Range<usize> {
        0..FRAMES
    }

    fn entry(&self, index: usize) -> Arc<FrameEntry> {
        Arc::clone(&self.entries[index])
    }

    fn decoder(&self) -> Box<dyn Decoder> {
        Box::new(ChainedDecoder {
            last: None,
            made: Arc::clone(&self.made),
            busy: Arc::clone(&self.busy),
            met: Arc::clone(&self.met),
        })
    }

    fn about(&self) -> About<'_> {
        About::default()
    }

    fn capabilities(&self) -> Capabilities<'_> {
        Capabilities {
            groups: Some(self),
            ..Capabilities::default()
        }
    }
}

impl Groups for Chained {
    fn group(&self, index: usize) -> Range<usize> {
        group_of(index)
    }
}

struct ChainedDecoder {
    last: Option<usize>,
    made: Arc<[AtomicUsize; FRAMES]>,
    busy: Arc<[AtomicUsize; FRAMES / GROUP]>,
    met: Arc<AtomicUsize>,
}

impl Decoder for ChainedDecoder {
    fn decode(
        &mut self,
        index: usize,
        _entry: &FrameEntry,
        max_points: usize,
        _progress: &Progress,
    ) -> Result<DecodedFrame, DecodeFailure> {
        let group = group_of(index);
        let others = self.busy[index / GROUP].fetch_add(1, Ordering::SeqCst);
        self.met.fetch_add(others, Ordering::SeqCst);
        let known = self.last.filter(|last| group.contains(last) && *last < index);
        for pose in known.map_or(group.start, |last| last + 1)..=index {
            self.made[pose].fetch_add(1, Ordering::SeqCst);
            std::thread::sleep(Duration::from_millis(1));
        }
        self.last = Some(index);
        self.busy[index / GROUP].fetch_sub(1, Ordering::SeqCst);
        let level = LEVELS.iter().rposition(|&points| points <= max_points).unwrap_or(0);
        let edge = LEVELS[level].isqrt();
        Ok(DecodedFrame {
            cloud: complete_sheet(edge, index),
            level: Some(DecodedLevel {
                points_in_frame: LEVELS[LEVELS.len() - 1],
                points_of_finer: LEVELS.get(level + 1).copied().unwrap_or(usize::MAX),
            }),
        })
    }
}

/// Number of times that each frame is made by a loader with `workers` that prepares all frames, and the number of
/// decoders that met.
fn made(direction: Direction, playhead: usize, workers: usize) -> (Vec<usize>, usize) {
    let source = Chained::new();
    let (made, met) = (Arc::clone(&source.made), Arc::clone(&source.met));
    let sequence = Arc::new(Sequence::of(source));
    sequence.origin();
    let loader = loader(&sequence, workers, usize::MAX);
    loader.request(playhead, direction, &SURFELS);
    until("all frames", || {
        (0..FRAMES).all(|index| ready(&loader, index, &SURFELS))
    });
    let made = made.iter().map(|count| count.load(Ordering::SeqCst)).collect();
    (made, met.load(Ordering::SeqCst))
}

fn ready(loader: &Loader, index: usize, needs: &Needs) -> bool {
    matches!(loader.get(index, needs), Slot::Ready(_))
}

#[test]
fn a_group_is_decoded_in_order_by_one_worker_at_a_time() {
    for workers in [1, 2, 4] {
        let (made, met) = made(Direction::Forward, 0, workers);
        // Frame 0 determined the origin and was cached, along with its decoder.
        assert_eq!(made, [1; FRAMES], "{workers} workers");
        assert_eq!(met, 0, "{workers} workers");
    }
}

#[test]
fn playing_backwards_decodes_each_pose_once_except_in_the_playhead_group() {
    for workers in [1, 2, 4] {
        let (made, met) = made(Direction::Backward, FRAMES - 1, workers);
        let (others, own) = made.split_at(FRAMES - GROUP);
        // The decoder that determined the origin may be needed elsewhere in the meantime.
        assert!(
            others[0] <= 2 && others[1..].iter().all(|&count| count == 1),
            "{workers} workers: {made:?}"
        );
        // Its frame is waited for, so it is made first; then the others of its group, starting with the first.
        assert!(own.iter().all(|&count| count <= 2), "{workers} workers: {made:?}");
        assert_eq!(met, 0, "{workers} workers");
    }
}

#[test]
fn a_requested_frame_is_decoded_by_the_worker_in_its_group() {
    let source = Chained::new();
    let met = Arc::clone(&source.met);
    let sequence = Arc::new(Sequence::of(source));
    let loader = loader(&sequence, 4, usize::MAX);
    loader.request(6, Direction::Forward, &SURFELS);
    std::thread::scope(|scope| {
        for index in [11, 7, 9, 3] {
            let loader = &loader;
            scope.spawn(move || assert_eq!(loader.wait(index, &SURFELS).unwrap().index, index));
        }
    });
    assert_eq!(met.load(Ordering::SeqCst), 0);
}

#[test]
fn a_coarser_level_is_decoded_once_where_time_is_short() {
    let sequence = Arc::new(Sequence::of(Chained::new()));
    sequence.origin();
    let loader = loader(&sequence, 1, usize::MAX);
    // Playback starts with 16,384 points, which is more than the second level has.
    loader.set_interval(Some(Duration::from_millis(10)));
    loader.request(0, Direction::Forward, &SURFELS);
    // Frame 0 was decoded in full for the origin.
    let coarse = || {
        (1..FRAMES).find_map(|index| match loader.get(index, &SURFELS) {
            Slot::Coarse(frame) => Some(frame),
            _ => None,
        })
    };
    until("a coarse frame", || coarse().is_some());
    let coarse = coarse().unwrap().frame.clone();
    assert_eq!((coarse.len(), coarse.points_of_finer()), (6400, Some(25_600)));
    assert_eq!(coarse.points_in_file(), 102_400);
    assert_eq!(coarse.radii().unwrap()[0], 0.5, "as its decoder says");
    until_idle(&loader);
    let decoded = loader.stats().decoded;
    assert!(
        decoded <= 2 * FRAMES as u64,
        "{decoded} decoded: each once by a level, once whole"
    );
}
