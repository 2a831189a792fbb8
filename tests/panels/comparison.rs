//! Two render modes side by side.

use super::{click, drag, window};
use egui_kittest::kittest::Queryable as _;
use image::{Rgba, RgbaImage};
use pointreel::app::{Command, Side, WindowRequest};
use pointreel::scene::{Primitive, Splatting};
use std::time::{Duration, Instant};

#[test]
fn each_side_has_its_own_settings_and_image() {
    let mut harness = window();
    assert!(harness.state_mut().next_packet().is_some());
    assert!(harness.state_mut().next_other_packet().is_none(), "one picture");
    harness.state_mut().run(Command::TOGGLE_COMPARISON);
    harness.run();
    // The right side is edited first; the left one does not change.
    harness.state_mut().style.primitive = Primitive::Point.into();
    let other = harness.state_mut().next_other_packet().unwrap();
    assert_eq!(other.style.primitive, Primitive::Surfel);
    assert!(harness.state_mut().next_other_packet().is_none(), "once");
    assert_eq!(
        harness.state_mut().next_packet().unwrap().style.primitive,
        Primitive::Point
    );
    click(&mut harness, "A (left)");
    assert_eq!(harness.state().style.primitive, Primitive::Surfel);
    let comparison = harness.state().features.comparison.as_ref().unwrap();
    assert_eq!(
        (comparison.edited, comparison.other.primitive),
        (Side::A, Primitive::Point.into())
    );
    // Data of the frame that only one side needs is there for it.
    harness
        .state_mut()
        .features
        .comparison
        .as_mut()
        .unwrap()
        .other
        .primitive = Primitive::Voxel.into();
    let packet = harness.state_mut().next_other_packet().unwrap();
    assert!(!packet.content.voxels().unwrap().records.is_empty());
    // Both are viewed with the same camera.
    harness.state_mut().camera.azimuth_deg += 10.0;
    let packets = [
        harness.state_mut().next_packet(),
        harness.state_mut().next_other_packet(),
    ];
    let [view, other_view] = packets.map(|packet| packet.unwrap().view);
    assert_eq!(view, other_view);
    click(&mut harness, "Close");
    assert!(harness.state().features.comparison.is_none());
}

#[test]
fn closing_retains_a_by_default_and_b_by_choice() {
    for (button, retained) in [("Close", Primitive::Surfel), ("Use B", Primitive::Point)] {
        for edited in ["A (left)", "B (right)"] {
            let mut harness = window();
            harness.state_mut().run(Command::TOGGLE_COMPARISON);
            harness.state_mut().style.primitive = Primitive::Point.into();
            harness.run();
            click(&mut harness, edited);
            assert_eq!(harness.state().preferences().settings.primitive, Primitive::Surfel);
            click(&mut harness, button);
            assert_eq!(harness.state().style.primitive, retained, "{button} with {edited}");
        }
    }
    // The key also closes it.
    let mut harness = window();
    harness.state_mut().run(Command::TOGGLE_COMPARISON);
    harness.state_mut().style.surfels.splat_scale = 3.0;
    harness.run();
    assert_eq!(
        harness.state().preferences().settings.surfels.splat_scale,
        1.0,
        "that of A"
    );
    harness.state_mut().run(Command::TOGGLE_COMPARISON);
    assert_eq!(harness.state().style.surfels.splat_scale, 1.0);
}

#[test]
fn images_at_rest_are_compared() {
    let mut harness = window();
    harness.state_mut().run(Command::TOGGLE_COMPARISON);
    harness.state_mut().style.surfels.splatting = Splatting::TwoPass;
    harness.run();
    harness.state_mut().next_packet();
    harness.state_mut().next_other_packet();
    assert!(harness.query_by_label("Compared when the view is still").is_some());
    let at = |millis| Duration::from_millis(millis);
    harness.state_mut().update(at(100));
    assert_eq!(harness.state_mut().take_requests(), []);
    harness.state_mut().update(at(400));
    assert_eq!(harness.state_mut().take_requests(), [WindowRequest::Compare]);
    // The response of the window.
    let [edited, other] = [40, 90].map(|level| RgbaImage::from_pixel(32, 24, Rgba([level, level, level, 255])));
    harness.state_mut().compare_pictures(edited, other);
    let begin = Instant::now();
    while harness.state().pictures().unwrap().difference.is_none() {
        assert!(begin.elapsed() < Duration::from_secs(20), "no answer");
        harness.state_mut().update(at(400));
        std::thread::sleep(Duration::from_millis(2));
    }
    harness.run();
    assert!(
        harness.query_by_label_contains("PSNR 14.2 dB").is_some(),
        "20 log10(255 / 50)"
    );
    harness.get_by_label("Error map").click();
    harness.run();
    assert!(harness.state().pictures().unwrap().shows_difference);
    // The next change makes the numbers outdated.
    harness.state_mut().style.surfels.splat_scale = 2.0;
    assert!(harness.state_mut().next_packet().is_some());
    harness.run();
    assert!(harness.query_by_label("Compared when the view is still").is_some());
}

#[test]
fn dragging_the_line_does_not_move_the_camera() {
    let mut harness = window();
    harness.state_mut().run(Command::TOGGLE_COMPARISON);
    harness.run();
    let camera = harness.state().camera;
    let rect = harness.state().viewport.rect;
    let (from, to) = (
        rect.center(),
        egui::pos2(rect.left() + 0.25 * rect.width(), rect.center().y),
    );
    drag(&mut harness, from, to);
    let split = harness.state().pictures().unwrap().split;
    assert!((split - 0.25).abs() < 0.01, "{split}");
    assert_eq!(harness.state().camera, camera);
}
