//! When the image is drawn, and its size.

use super::{load_all, window};
use egui::{pos2, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use pointreel::app::{Command, State};
use pointreel::scene::{Primitive, ScaleBar};
use std::time::Duration;

#[test]
fn the_image_follows_the_scale_factor() {
    let mut harness = window();
    let [width, height] = harness.state().viewport.size_px;
    assert!(harness.state_mut().next_packet().is_some());
    for (scale, factor) in [(2.0, 2.0), (1.5, 1.5), (1.0, 1.0)] {
        let root = harness.input_mut().viewports.entry(egui::ViewportId::ROOT);
        root.or_default().native_pixels_per_point = Some(scale);
        harness.run();
        let size_px = harness.state().viewport.size_px;
        // The same number of window points, but more pixels.
        for (edge, before) in size_px.iter().zip([width, height]) {
            let expected = f64::from(before) * factor;
            assert!((f64::from(*edge) - expected).abs() <= 2.0, "{scale}: {size_px:?}");
        }
        let packet = harness.state_mut().next_packet();
        assert_eq!(packet.unwrap().viewport_px, size_px);
        harness.run();
        assert!(harness.state_mut().next_packet().is_none(), "once");
    }
}

#[test]
fn a_window_without_space_draws_nothing() {
    let mut harness = window();
    assert!(harness.state_mut().next_packet().is_some());
    let pictures = harness.state().shared.counters.pictures;
    for size in [vec2(0.0, 0.0), vec2(1.0, 1.0), vec2(300.0, 0.0)] {
        harness.set_size(size);
        harness.run_ok();
        let has_space = !harness.state().viewport.size_px.contains(&0);
        assert_eq!(harness.state_mut().next_packet().is_some(), has_space, "{size}");
    }
    assert!(harness.state().shared.counters.pictures <= pictures + 1);
    harness.set_size(vec2(1280.0, 800.0));
    harness.run();
    assert!(!harness.state().viewport.size_px.contains(&0));
}

#[test]
fn a_paused_untouched_window_does_nothing() {
    let mut harness = window();
    harness.state_mut().style.primitive = Primitive::Voxel.into();
    load_all(harness.state_mut());
    harness.run();
    assert!(harness.state_mut().next_packet().is_some());
    let (counters, scene) = (harness.state().shared.counters, harness.state().scene_stats());
    assert_eq!(scene.traversals, 1);
    for second in 1..100 {
        let state = harness.state_mut();
        assert!(!state.update(Duration::from_secs(second)).is_visible());
        assert_eq!(state.next_deadline(), None);
        assert!(state.next_packet().is_none());
    }
    assert_eq!(
        (harness.state().shared.counters, harness.state().scene_stats()),
        (counters, scene)
    );
    assert!(!harness.ctx.has_requested_repaint());
    // Running a panel again, as for a moved mouse, does not make a new image.
    harness.hover_at(pos2(100.0, 100.0));
    harness.run();
    assert!(harness.state_mut().next_packet().is_none());
    harness.state_mut().camera.orbit(5.0, 0.0);
    assert!(harness.state_mut().next_packet().is_some());
    assert_eq!(harness.state().scene_stats().traversals, 2);
}

#[test]
fn the_old_image_stays_until_the_new_primitive_is_ready() {
    let mut harness = window();
    assert_eq!(
        harness.state_mut().next_packet().unwrap().style.primitive,
        Primitive::Surfel
    );
    harness.state_mut().style.primitive = Primitive::Voxel.into();
    harness.state_mut().style.surfels.splat_scale = 2.0;
    // No update yet: the frame has no octree.
    assert_eq!(
        harness.state_mut().next_packet().unwrap().style.primitive,
        Primitive::Surfel
    );
    load_all(harness.state_mut());
    let packet = harness.state_mut().next_packet().unwrap();
    assert_eq!(packet.style.primitive, Primitive::Voxel);
    assert!(packet.content.voxels().is_some());
}

#[test]
fn the_image_has_a_scale_bar_that_follows_the_camera() {
    let mut harness = window();
    let expected = |harness: &Harness<'_, State>| {
        let state = harness.state();
        let height = f64::from(state.viewport.rect.height());
        let bar = ScaleBar::of(&state.camera, height, 1.0, None).unwrap();
        format!("Scale bar: {}", bar.text())
    };
    let before = expected(&harness);
    assert!(before.ends_with("units") || before.ends_with("unit"), "{before}");
    harness.get_by_label(&before);
    harness.state_mut().camera.zoom(10.0);
    harness.run();
    let after = expected(&harness);
    assert_ne!(before, after);
    harness.get_by_label(&after);
    harness.state_mut().run(Command::TOGGLE_SCALE_BAR);
    harness.run();
    assert!(harness.query_by_label(&after).is_none());
    assert!(!harness.state().preferences().scale_bar);
}
