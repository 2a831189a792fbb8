//! Images drawn in tiles and with alpha, and videos that other decoders read back.

mod labels;
mod pictures;
mod poses;
mod videos;

use pointreel::headless::{CameraChoice, Headless};
use pointreel::render::AnyRenderer;
use pointreel::scene::{Background, Camera, Style};
use pointreel::sequence::{Loader, LoaderOptions, PreparedFrame, Sequence};
use std::sync::Arc;

/// The demo, drawn by `renderer`.
fn headless(renderer: AnyRenderer) -> Headless {
    headless_of(Sequence::demo(), renderer)
}

fn headless_of(sequence: Sequence, renderer: AnyRenderer) -> Headless {
    let sequence = Arc::new(sequence);
    let loader = Loader::new(Arc::clone(&sequence), LoaderOptions::default()).unwrap();
    Headless::new(sequence, loader, renderer)
}

/// A gradient behind, so that parts that take it for theirs are seen.
fn style() -> Style {
    Style::default().with(|style| {
        style.backdrop.background = Background {
            top: [250, 10, 90],
            bottom: [0, 200, 30],
        }
    })
}

/// Frame 6 of the demo from near by: it reaches over the edges of the image.
fn near_by(headless: &Headless, style: &Style) -> (Arc<PreparedFrame>, Camera) {
    let frame = headless.frame(6, style).unwrap();
    let look = headless.first_look().unwrap();
    let origin = headless.sequence().origin();
    let mut camera = CameraChoice::default().camera(&look, origin, [1280, 720]);
    camera.distance *= 0.6;
    (frame, camera)
}
