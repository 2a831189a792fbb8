//! Notices, and frames that cannot be read.

use super::{FRAMES, click, options, sequence, window, window_on};
use egui::pos2;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use pointreel::app::{Command, Severity, State};
use pointreel::cloud::{Positions, RawCloud};
use pointreel::playback::Mark;
use pointreel::sequence::{FrameEntry, Sequence};
use std::sync::Arc;
use std::time::Duration;

#[test]
fn frames_that_have_less_are_told_of_once() {
    let sources = (0..FRAMES).map(|index| FrameEntry::file(format!("/scans/{index}.ply")));
    let sequence = Sequence::with_decoder(sources.collect(), |source| {
        let mut cloud = RawCloud::from_positions(Positions::F32(vec![[0.0; 3], [1.0; 3]]));
        let is_bare = ["5.ply", "7.ply"].contains(&source.name.as_str());
        cloud.attributes.colors = (!is_bare).then(|| vec![[255; 4]; 2]);
        Ok(cloud)
    });
    let mut harness = window_on(Arc::new(sequence), options());
    let told = |harness: &Harness<'_, State>| {
        let notices = harness.state().notices.list();
        notices.iter().map(|notice| notice.text.clone()).collect::<Vec<_>>()
    };
    for frame in 0..5 {
        assert_eq!(told(&harness), Vec::<String>::new(), "{frame}");
        harness.state_mut().run(Command::Step(1));
        harness.state_mut().update(Duration::ZERO);
    }
    let text = told(&harness);
    assert_eq!(text.len(), 1);
    let expected = "Frame 1 has colors, frame 6 has none of colors, normals and radii";
    assert!(text[0].starts_with(expected), "{text:?}");
    for _ in 0..FRAMES {
        harness.state_mut().run(Command::Step(1));
        harness.state_mut().update(Duration::ZERO);
    }
    assert_eq!(told(&harness), text);
}

#[test]
fn a_broken_frame_is_marked_told_once_and_played_over() {
    let mut harness = window_on(sequence(&[5]), options());
    harness.run();
    let runs = harness.state().player.as_ref().unwrap().runs().to_vec();
    let marks: Vec<_> = runs.iter().map(|run| (run.start, run.end, run.mark)).collect();
    assert_eq!(
        marks,
        [(0, 5, Mark::Resident), (5, 6, Mark::Failed), (6, 24, Mark::Resident)]
    );
    assert!(harness.state().notices.list().is_empty());

    let bar = harness.get_by_label("Timeline").rect();
    harness.hover_at(pos2(bar.left() + bar.width() * 5.5 / 24.0, bar.center().y));
    harness.run_steps(60);
    assert!(
        harness
            .query_by_label_contains("frame_0005.ply: line 3: expected an element")
            .is_some()
    );
    harness.hover_at(pos2(640.0, 300.0));
    harness.run();

    for _ in 0..3 {
        harness.state_mut().player.as_mut().unwrap().seek(5, Duration::ZERO);
        harness.state_mut().update(Duration::ZERO);
        harness.state_mut().player.as_mut().unwrap().seek(6, Duration::ZERO);
        harness.state_mut().update(Duration::ZERO);
    }
    let notices = harness.state().notices.list();
    assert_eq!(notices.len(), 1);
    assert_eq!((notices[0].severity, notices[0].count), (Severity::Error, 1));
    assert!(
        notices[0].text.starts_with("Frame 6 of 24 is left out. "),
        "{}",
        notices[0].text
    );

    let state = harness.state_mut();
    state.player.as_mut().unwrap().seek(4, Duration::ZERO);
    state.run(Command::TogglePlay);
    let mut shown = Vec::new();
    for step in 0..4 {
        state.update(Duration::from_millis(step * 42));
        let player = state.player.as_ref().unwrap();
        shown.push(player.shown().unwrap().index);
    }
    assert_eq!(shown, [4, 4, 6, 7]);
}

#[test]
fn notices_are_copied_and_dismissed() {
    let mut harness = window();
    harness.state_mut().notices.error("the disk is gone");
    harness.run();
    assert!(harness.query_by_label("the disk is gone").is_some());
    harness.get_by_label("Copy").click();
    harness.step();
    harness.step();
    harness.run();
    click(&mut harness, "Dismiss");
    assert!(harness.query_by_label("the disk is gone").is_none());
    assert!(harness.state().notices.list().is_empty());
}
