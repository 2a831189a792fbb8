//! A generated sequence, opened in the window's state: the start of panel tests.

use pointreel::app::{Preferences, State, StateOptions};
use pointreel::cloud::{Positions, RawCloud};
use pointreel::scene::{Primitive, Scene, Settings};
use pointreel::sequence::{FrameEntry, Sequence};
use std::sync::Arc;
use std::time::Duration;

pub(crate) const FRAMES: usize = 24;

/// A cube of points that grows with the frame; frames in `broken` cannot be read.
pub(crate) fn sequence(broken: &'static [u64]) -> Arc<Sequence> {
    let sources = (0..FRAMES as u64)
        .map(|number| FrameEntry {
            number: Some(number),
            ..FrameEntry::file(format!("/scans/walk/frame_{number:04}.ply"))
        })
        .collect();
    Arc::new(Sequence::with_decoder(sources, move |source| {
        let number = source.number.unwrap_or(0);
        if broken.contains(&number) {
            return Err(format!("{}: line 3: expected an element", source.name).into());
        }
        let size = 1.0 + number as f32 / 100.0;
        let corners = (0..8).map(|corner| [0, 1, 2].map(|axis| size * (corner >> axis & 1) as f32 - 0.5 * size));
        Ok(RawCloud::from_positions(Positions::F32(corners.collect())))
    }))
}

/// Without thumbnails, which are made when there is time: so only the test's own changes show.
pub(crate) fn options() -> StateOptions {
    StateOptions {
        preferences: Preferences {
            thumbnails: false,
            advanced: true,
            // The automatic choice for a handful of points is not the subject of these tests.
            settings: Settings {
                primitive: Primitive::Surfel.into(),
                ..Settings::default()
            },
            ..Preferences::default()
        },
        paused: true,
        ..StateOptions::default()
    }
}

/// The state with `sequence` open, all frames loaded, at time zero.
pub(crate) fn state_on(sequence: Arc<Sequence>, options: StateOptions) -> State {
    let mut state = State::new(options);
    state.open(sequence);
    load_all(&mut state);
    state.update(Duration::ZERO);
    // From now on the view does not change by itself.
    let is_shown = |state: &State| state.player.as_ref().is_some_and(|player| player.shown().is_some());
    let begin = std::time::Instant::now();
    while is_shown(&state) && !state.has_looked() && begin.elapsed() < Duration::from_secs(20) {
        std::thread::sleep(Duration::from_millis(1));
        state.update(Duration::ZERO);
    }
    state
}

/// Waits until the loader has every frame as the settings need it.
pub(crate) fn load_all(state: &mut State) {
    state.update(state.now());
    let needs = Scene::needs(&state.style.decided());
    let loader = state.player.as_ref().unwrap().loader();
    for index in 0..FRAMES {
        // A broken frame counts as well.
        let _ = loader.wait(index, &needs);
    }
    state.update(state.now());
}
