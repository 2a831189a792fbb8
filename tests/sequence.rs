//! Sequences through their public interface: discovery of files, preparation, loading, with injected decoders that are
//! slow or broken, and on files.

#![allow(
    clippy::unwrap_used,
    reason = "a failed expectation of a test helper is a failed test"
)]

use glam::{DVec3, Vec3};
use pointreel::analysis::SurfaceOptions;
use pointreel::cloud::{Frame, Positions, RawCloud};
use pointreel::io::ReadOptions;
use pointreel::levels::octree::StopCriterion;
use pointreel::levels::{LevelsKey, LevelsKind};
use pointreel::sequence::{
    ColorHints, ColorSource, Coloring, DecodeFailure, FrameEntry, FrameError, FrameState, Loader, LoaderOptions, Needs,
    OpenOptions, PreparedFrame, Sequence, SequenceError, Slot,
};
use pointreel::timeline::{Direction, LoopMode, PlayRange};
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Condvar, Mutex};
use std::time::{Duration, Instant};

#[path = "common/data.rs"]
mod data;
#[path = "sequence/discovery.rs"]
mod discovery;
#[path = "sequence/folders.rs"]
mod folders;
#[path = "sequence/groups.rs"]
mod groups;
#[path = "sequence/live_folders.rs"]
mod live_folders;
#[path = "sequence/loading.rs"]
mod loading;
#[path = "sequence/meshes.rs"]
mod meshes;
#[path = "sequence/preparing.rs"]
mod preparing;
#[path = "sequence/shared_data.rs"]
mod shared_data;

/// Maximum wait for a frame before the test fails.
const PATIENCE: Duration = Duration::from_secs(20);

const SURFELS: Needs = Needs {
    shapes: true,
    ellipses: false,
    mesh: false,
    levels: None,
    colors: Coloring::of(ColorSource::Auto),
    surface: SurfaceOptions::AUTO,
    smoothing: 0.0,
    hints: ColorHints::NONE,
};

fn levels(kind: LevelsKind, delta: f32) -> LevelsKey {
    let stop = StopCriterion::Loss(delta);
    LevelsKey { kind, stop }
}

fn voxels(delta: f32) -> Needs {
    Needs {
        shapes: false,
        levels: Some(levels(LevelsKind::Cubes, delta)),
        ..SURFELS
    }
}

fn surfels_by_octree(delta: f32) -> Needs {
    Needs {
        levels: Some(levels(LevelsKind::Surfels, delta)),
        ..SURFELS
    }
}

/// `count` sources named `0.fake`, `1.fake`, …
fn fake_sources(count: usize) -> Vec<FrameEntry> {
    (0..count)
        .map(|index| FrameEntry::file(format!("{index}.fake")))
        .collect()
}

/// The index that [`fake_sources`] wrote into the name.
fn index_of(source: &FrameEntry) -> usize {
    Path::new(&source.name)
        .file_stem()
        .and_then(|stem| stem.to_str())
        .and_then(|stem| stem.parse().ok())
        .expect("a name made by fake_sources")
}

/// `values`, in the order of the frame, returned in the order of the file. Precondition: no point was dropped.
fn by_file<T: Copy>(frame: &Frame, values: &[T]) -> Vec<T> {
    let mut places: Vec<(u32, T)> = frame.file_index().iter().copied().zip(values.iter().copied()).collect();
    places.sort_by_key(|&(index, _)| index);
    places.into_iter().map(|(_, value)| value).collect()
}

/// `edge`² points on a wavy sheet that moves with `time`.
fn sheet(edge: usize, time: usize) -> RawCloud {
    let at = |i: usize| {
        let (x, z) = ((i % edge) as f32, (i / edge) as f32);
        [x, (0.3 * (x + time as f32)).sin(), z]
    };
    RawCloud::from_positions(Positions::F32((0..edge * edge).map(at).collect()))
}

/// A sheet that has colours, normals and radii, so that nothing has to be estimated.
fn complete_sheet(edge: usize, time: usize) -> RawCloud {
    let mut raw = sheet(edge, time);
    let count = raw.positions.len();
    raw.attributes.colors = Some((0..count).map(|i| [i as u8, time as u8, 7, 255]).collect());
    raw.attributes.normals = Some(vec![[0.0, 1.0, 0.0]; count]);
    raw.attributes.radii = Some(vec![0.5; count]);
    raw
}

/// A sequence of complete sheets.
fn sheets(count: usize, edge: usize) -> Arc<Sequence> {
    Arc::new(Sequence::with_decoder(fake_sources(count), move |source| {
        Ok(complete_sheet(edge, index_of(source)))
    }))
}

fn loader(sequence: &Arc<Sequence>, workers: usize, budget_bytes: usize) -> Loader {
    Loader::new(
        Arc::clone(sequence),
        LoaderOptions {
            workers,
            budget_bytes,
            ..LoaderOptions::default()
        },
    )
    .expect("threads start")
}

/// Polls until `condition` holds.
fn until(what: &str, condition: impl Fn() -> bool) {
    let start = Instant::now();
    while !condition() {
        assert!(start.elapsed() < PATIENCE, "waited in vain for {what}");
        std::thread::sleep(Duration::from_millis(1));
    }
}

/// Until nothing is in flight and nothing changes any more.
fn until_idle(loader: &Loader) {
    let mut before = (u64::MAX, 0);
    let mut still = 0;
    let start = Instant::now();
    while still < 15 {
        assert!(start.elapsed() < PATIENCE, "the loader never rests");
        std::thread::sleep(Duration::from_millis(2));
        let loading = loader.states().contains(&FrameState::Loading);
        let now = (loader.revision(), loader.stats().decoded);
        still = if now == before && !loading { still + 1 } else { 0 };
        before = now;
    }
}

/// Sources that decode only when the test opens the gate, and a record of its callers.
#[derive(Default)]
struct Gate {
    open: Mutex<bool>,
    opened: Condvar,
    arrived: Mutex<Vec<usize>>,
}

impl Gate {
    fn pass(&self, index: usize) {
        self.arrived.lock().unwrap().push(index);
        let mut open = self.open.lock().unwrap();
        while !*open {
            open = self.opened.wait(open).unwrap();
        }
    }

    fn open(&self) {
        *self.open.lock().unwrap() = true;
        self.opened.notify_all();
    }

    fn arrivals(&self) -> Vec<usize> {
        self.arrived.lock().unwrap().clone()
    }
}
