//! Stages in which a frame at rest arrives, by a clock that the test turns.

use super::*;
use crate::cloud::{Positions, RawCloud, even_places};
use crate::scene::Primitive;
use crate::sequence::simulation::{Cost, Simulation};
use crate::sequence::{FrameEntry, Reading, ReadingStage};
use crate::source::FrameList;

/// More than come at once, and are sampled first.
const LARGE: usize = 600_000;
/// More than come at once, fewer than are sampled.
const CENTER: usize = 150_000;
const SMALL: usize = 100_000;

const SAMPLE: usize = 1 << 17;

fn position(index: usize) -> [f32; 3] {
    [(index % 1000) as f32, (index / 1000) as f32, 0.0]
}

/// Flat sheets without normals, a part of whose points can be read alone.
fn sequence(frames: usize, points: usize) -> Arc<Sequence> {
    let sources = (0..frames).map(|number| FrameEntry::file(format!("{number}.ply")));
    let cloud = |places: Vec<usize>| {
        let positions = places.into_iter().map(position).collect();
        RawCloud::from_positions(Positions::F32(positions))
    };
    let frames = FrameList::new(sources.collect(), move |_, _| Ok(cloud((0..points).collect())));
    Arc::new(Sequence::of(frames.with_sample(move |_, max, min| {
        Ok((points >= min).then(|| (cloud(even_places(points, max)).into(), points)))
    })))
}

struct Stage {
    player: Player,
    workers: Simulation,
    style: Style,
    now: Duration,
}

/// Points drawn, whether they are surfels, and whether more is to come.
type ShownFrame = (usize, bool, bool);

impl Stage {
    fn new(sequence: &Arc<Sequence>, play: bool, options: LoaderOptions) -> Self {
        let cost = Cost {
            decode_ms: 10.0,
            ns_per_point: 10.0,
        };
        let options = LoaderOptions {
            workers: 2,
            shows_stages: true,
            ..options
        };
        let (loader, workers) = Simulation::new(sequence, options, LARGE, move |_| cost);
        Self {
            player: Player::with_loader(loader, play),
            workers,
            style: Style::default(),
            now: Duration::ZERO,
        }
    }

    /// Collects the frames that are seen, one after the other, until nothing more is to come.
    fn watch(&mut self) -> Vec<ShownFrame> {
        let mut seen: Vec<ShownFrame> = Vec::new();
        for _ in 0..50 {
            self.player.update(self.now, &self.style);
            if let Some(frame) = self.player.shown() {
                let (points, is_surfel) = (frame.points.len(), frame.shapes.is_some());
                let picture = (points, is_surfel, self.player.is_partial());
                if seen.last() != Some(&picture) {
                    seen.push(picture);
                }
            }
            self.workers.advance(&self.player.loader, self.now);
            let Some(next) = self.workers.next_event() else {
                self.player.update(self.now, &self.style);
                break;
            };
            self.now = next;
            self.workers.advance(&self.player.loader, self.now);
        }
        seen
    }
}

fn seen_of(points: usize) -> Vec<ShownFrame> {
    Stage::new(&sequence(1, points), true, LoaderOptions::default()).watch()
}

#[test]
fn a_large_frame_arrives_as_sample_then_all_points_then_surfels() {
    let expected = [(SAMPLE, false, true), (LARGE, false, true), (LARGE, true, false)];
    assert_eq!(seen_of(LARGE), expected);
}

#[test]
fn frames_that_are_read_fast_have_no_sample_and_small_ones_no_stages() {
    assert_eq!(seen_of(CENTER), [(CENTER, false, true), (CENTER, true, false)]);
    assert_eq!(seen_of(SMALL), [(SMALL, true, false)]);
}

#[test]
fn nothing_is_read_or_estimated_twice() {
    let sequence = sequence(1, LARGE);
    let mut stage = Stage::new(&sequence, false, LoaderOptions::default());
    stage.watch();
    // The simulation determines the origin, for which the frame is decoded and cached.
    let stats = stage.player.loader().stats();
    assert_eq!((stats.decoded, stats.surfaces_estimated), (1, 1));
    // Records for the points of the sample and of all points, and for their surfels: heights, which are the colours
    // here, need no normals.
    assert_eq!(stats.records_written, (SAMPLE + 2 * LARGE) as u64);
}

#[test]
fn point_rendering_has_two_stages() {
    let mut stage = Stage::new(&sequence(1, LARGE), true, LoaderOptions::default());
    stage.style.primitive = Primitive::Point;
    stage.style.colors = crate::sequence::ColorSource::Uniform.into();
    assert_eq!(stage.watch(), [(SAMPLE, false, true), (LARGE, false, false)]);
}

#[test]
fn other_frames_wait_until_the_shown_one_is_complete() {
    let mut stage = Stage::new(&sequence(3, LARGE), false, LoaderOptions::default());
    let seen = stage.watch();
    assert_eq!(seen.len(), 3, "{seen:?}");
    // All are complete in the end, and those that were not being viewed became so at once.
    let needs = Scene::needs(&stage.style);
    for frame in 0..3 {
        assert!(matches!(stage.player.loader().get(frame, &needs), Slot::Ready(_)));
    }
    assert_eq!(stage.player.loader().stats().coarse_frames, 1);
}

#[test]
fn playing_frames_have_no_stages() {
    let mut stage = Stage::new(&sequence(3, LARGE), true, LoaderOptions::default());
    let seen = stage.watch();
    assert!(
        seen.iter().all(|&(_, is_surfel, is_partial)| is_surfel && !is_partial),
        "{seen:?}"
    );
}

#[test]
fn waiting_for_one_frame_returns_it_complete() {
    let options = LoaderOptions::default();
    let loader = Loader::new(sequence(1, LARGE), options).unwrap();
    let needs = Scene::needs(&Style::default());
    loader.request(0, Direction::Forward, &needs);
    let frame = loader.wait(0, &needs).unwrap();
    assert_eq!((frame.points.len(), frame.shapes.is_some()), (LARGE, true));
    assert_eq!(loader.stats().coarse_frames, 0);
}

/// Waits until a reading in this stage is under way on real threads, and cancels it.
fn cancel(player: &mut Player, style: &Style, stage: fn(ReadingStage) -> bool) {
    let begin = std::time::Instant::now();
    loop {
        player.update(begin.elapsed(), style);
        let readings: Vec<Reading> = player.loader().readings();
        if let Some(reading) = readings.iter().find(|reading| stage(reading.stage)) {
            return reading.progress.cancel();
        }
        assert!(begin.elapsed() < Duration::from_mins(1), "it does not come");
        std::thread::yield_now();
    }
}

#[test]
fn cancelled_normals_leave_the_points() {
    let options = LoaderOptions {
        shows_stages: true,
        ..LoaderOptions::default()
    };
    let mut player = Player::new(sequence(1, LARGE), options, true).unwrap();
    let mut style = Style::default();
    cancel(&mut player, &style, |stage| stage == ReadingStage::Normals);
    while player.loader().is_busy() {
        std::thread::yield_now();
    }
    let change = player.update(Duration::from_secs(100), &style);
    assert!(change.new_failure.is_none());
    let frame = player.shown().unwrap();
    assert_eq!((frame.points.len(), frame.shapes.is_some()), (LARGE, false));
    assert!(!player.is_partial(), "nothing more is to come");
    assert!(!player.loader().is_busy());
    // Other needs are a new start, and so are these when they are requested again.
    style.primitive = Primitive::Point;
    player.update(Duration::from_secs(101), &style);
    style.primitive = Primitive::Surfel;
    player.update(Duration::from_secs(102), &style);
    assert!(player.is_partial());
}

#[test]
fn normals_no_longer_needed_are_cancelled() {
    let options = LoaderOptions {
        shows_stages: true,
        ..LoaderOptions::default()
    };
    let mut player = Player::new(sequence(1, LARGE), options, true).unwrap();
    let mut style = Style::default();
    let begin = std::time::Instant::now();
    let is_estimated = |player: &Player| {
        let readings = player.loader().readings();
        readings.iter().any(|reading| reading.stage == ReadingStage::Normals)
    };
    while !is_estimated(&player) {
        player.update(begin.elapsed(), &style);
        assert!(begin.elapsed() < Duration::from_mins(1), "they are never estimated");
        std::thread::yield_now();
    }
    // As when the automatic settings find that the points do not form a surface.
    style.primitive = Primitive::Point;
    player.update(begin.elapsed(), &style);
    assert!(!is_estimated(&player));
    while player.loader().is_busy() {
        std::thread::yield_now();
    }
    let stats = player.loader().stats();
    assert_eq!((stats.cancelled, stats.failed_frames), (1, 0));
    assert!(!player.loader().was_cancelled(), "nobody has");
    player.update(Duration::from_secs(100), &style);
    assert!(!player.is_partial() && player.shown().unwrap().shapes.is_none());
    // Requesting them again provides them.
    let frame = player.loader().wait(0, &Scene::needs(&Style::default())).unwrap();
    assert!(frame.shapes.is_some());
}

#[test]
fn frames_without_memory_for_surfels_stay_points_with_a_warning() {
    let options = LoaderOptions {
        machine_bytes: 60 * LARGE as u64,
        ..LoaderOptions::default()
    };
    let mut stage = Stage::new(&sequence(1, LARGE), true, options.clone());
    let seen = stage.watch();
    assert_eq!(seen, [(SAMPLE, false, true), (LARGE, false, false)]);
    let frame = stage.player.shown().unwrap();
    let said = frame.frame.warnings().join(" ");
    assert!(said.contains("600000 points") && said.contains("GiB"), "{said}");
    // A request for surfels only reports that there are none.
    let loader = Loader::new(sequence(1, LARGE), options).unwrap();
    let error = loader.wait(0, &Scene::needs(&Style::default())).unwrap_err();
    assert!(matches!(error, FrameError::TooLarge { points: LARGE, .. }), "{error}");
}
