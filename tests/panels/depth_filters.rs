//! Filters of depth images in the settings.

use super::options;
use egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use pointreel::app::panels::window_ui;
use pointreel::app::{State, apply_theme};
use pointreel::rgbd::Filters;
use pointreel::sequence::Sequence;
use std::path::Path;
use std::sync::Arc;
use std::thread;
use std::time::{Duration, Instant};

/// A folder as Open3D lays it out: two frames.
fn recording(folder: &Path) {
    std::fs::create_dir_all(folder.join("depth")).unwrap();
    let camera = r#"{"width": 64, "height": 48, "intrinsic_matrix": [60, 0, 0, 0, 61, 0, 31.5, 23.5, 1]}"#;
    std::fs::write(folder.join("camera_intrinsic.json"), camera).unwrap();
    for frame in 0..2u16 {
        let depth = |x: u32, y: u32| image::Luma([900 + 3 * x as u16 + 2 * y as u16 + 50 * frame]);
        let depth = image::ImageBuffer::<image::Luma<u16>, _>::from_fn(64, 48, depth);
        depth.save(folder.join(format!("depth/{frame:05}.png"))).unwrap();
    }
}

fn wait_until_shown(state: &mut State) {
    let begin = Instant::now();
    loop {
        state.update(state.now());
        let is_shown = state.player.as_ref().is_some_and(|player| player.shown().is_some());
        if is_shown && state.has_looked() {
            return;
        }
        assert!(begin.elapsed() < Duration::from_mins(1), "nothing is shown");
        thread::sleep(Duration::from_millis(2));
    }
}

fn filters(harness: &Harness<'_, State>) -> String {
    let player = harness.state().player.as_ref().unwrap();
    player.sequence().source().filters().unwrap().to_string()
}

fn points(harness: &Harness<'_, State>) -> usize {
    let player = harness.state().player.as_ref().unwrap();
    player.shown().unwrap().frame.len()
}

#[test]
fn changing_filters_decodes_the_frames_again_and_changes_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    recording(folder.path());
    let sequence = Sequence::discover(&[folder.path().to_owned()]).unwrap();
    let mut state = State::new(options());
    state.open(Arc::new(sequence));
    wait_until_shown(&mut state);
    state.player.as_mut().unwrap().seek(1, Duration::ZERO);
    wait_until_shown(&mut state);
    state.camera.azimuth_deg += 21.0;
    let camera = state.camera;
    let mut harness = Harness::builder()
        .with_size([1280.0, 2400.0])
        .with_max_steps(20)
        .with_context_setup(apply_theme)
        .build_ui_state(|ui, state: &mut State| window_ui(ui, state), state);
    harness.run();
    assert_eq!(filters(&harness), Filters::NONE.to_string());
    assert!(
        harness.query_by_label("Nearest depth").is_none(),
        "numbers of a filter that is left out"
    );
    let all = points(&harness);

    let click = |harness: &mut Harness<'_, State>, label: &str| {
        harness.get_by_role_and_label(Role::CheckBox, label).click();
        harness.run();
        wait_until_shown(harness.state_mut());
        harness.run();
    };
    click(&mut harness, "Depth median");
    assert_eq!(filters(&harness), "median");
    click(&mut harness, "Depth range");
    assert_eq!(filters(&harness), "near,median");
    assert_eq!(points(&harness), all);
    harness
        .get_by_role_and_label(Role::SpinButton, "Farthest depth")
        .set_value_accesskit(1.0);
    harness.run();
    wait_until_shown(harness.state_mut());
    harness.run();
    assert_eq!(filters(&harness), "near:to=1,median");
    assert!((1..all).contains(&points(&harness)), "{} of {all}", points(&harness));

    let state = harness.state();
    let player = state.player.as_ref().unwrap();
    assert_eq!((player.clock().frame(), state.camera), (1, camera));
    assert!(!player.is_playing());
    let session = state.session().unwrap();
    assert_eq!(session.reading.rgbd_filters.unwrap().to_string(), "near:to=1,median");
}
