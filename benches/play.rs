//! Playing files from disk by the clock, as the window does: `pointreel bench play` on sequences that are written
//! first.
//!
//! Measured: the rate held, the fraction of points shown, late and skipped frames and memory, at 1280×720: 100 frames
//! of 100,000 coloured points with normals at 60 fps; 30 frames of 1,000,000 without normals at 30 fps. With the
//! argument `soak`: 10,000 frames of the former in 256 MiB, so that each is read repeatedly, and memory at the
//! beginning, most and at the end.

use pointreel::bench::{BenchOptions, Input, Step, run, suites};
use pointreel::cloud::{Positions, RawCloud};
use pointreel::io::{WriteFormat, write};
use pointreel::progress::Progress;
use pointreel::sequence::Sequence;
use std::fs::File;
use std::path::Path;
use std::sync::Arc;

mod shapes;

/// A sequence to write and to play.
struct MultiviewVideo {
    name: &'static str,
    frames: usize,
    points: usize,
    has_normals: bool,
    fps: f64,
}

const MULTIVIEW_VIDEOS: [MultiviewVideo; 2] = [
    MultiviewVideo {
        name: "100 frames of 100,000 points, normals in the files",
        frames: 100,
        points: 100_000,
        has_normals: true,
        fps: 60.0,
    },
    MultiviewVideo {
        name: "30 frames of 1,000,000 points, no normals",
        frames: 30,
        points: 1_000_000,
        has_normals: false,
        fps: 30.0,
    },
];

#[expect(clippy::print_stdout, reason = "the report is what this program is for")]
fn main() {
    pointreel::memory::keep_freed_pages();
    let is_soak = std::env::args().any(|argument| argument == "soak");
    let multiview_videos = if is_soak {
        &MULTIVIEW_VIDEOS[..1]
    } else {
        &MULTIVIEW_VIDEOS[..]
    };
    for multiview_video in multiview_videos {
        let folder = tempfile::tempdir().expect("a folder for the frames");
        multiview_video.write(folder.path());
        let sequence = Sequence::discover(&[folder.path().to_owned()]).expect("the frames");
        let inputs = [Input {
            name: multiview_video.name.to_owned(),
            sequence: Arc::new(sequence.with_fps(multiview_video.fps)),
            shape: None,
        }];
        let default = BenchOptions::new(suites::PLAY);
        let options = if is_soak {
            BenchOptions {
                frames: 10_000,
                budget_bytes: Some(256 << 20),
                ..default
            }
        } else {
            default
        };
        let quiet = |_: Step| {};
        let report = run(&inputs, &options, None, &quiet, &Progress::default());
        println!("{}", report.expect("it plays").to_table());
    }
}

impl MultiviewVideo {
    /// A bumpy torus that rotates.
    fn write(&self, folder: &Path) {
        let (positions, colors) = shapes::bumpy_torus(self.points);
        let normals = shapes::bumpy_torus_normals(self.points);
        for frame in 0..self.frames {
            let turn = glam::Quat::from_rotation_y(0.02 * frame as f32);
            let at = |position: &glam::Vec3| (turn * *position).to_array();
            let mut cloud = RawCloud::from_positions(Positions::F32(positions.iter().map(at).collect()));
            cloud.attributes.colors = Some(colors.clone());
            cloud.attributes.normals = self.has_normals.then(|| normals.iter().map(at).collect());
            let file = File::create(folder.join(format!("{frame:04}.ply"))).expect("a file");
            write(file, WriteFormat::default(), &cloud).expect("a frame");
        }
    }
}
