//! Notices, and frames that cannot be read.

use super::{FRAMES, click, options, sequence, window, window_on};
use egui::pos2;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use pointreel::app::{Command, Severity, State};
use pointreel::cloud::{Positions, RawCloud};
use pointreel::playback::Mark;
use pointreel::progress::Progress;
use pointreel::sequence::{FrameEntry, Sequence};
use pointreel::serve::live::{LiveOptions, LiveServer, Schedule};
use pointreel::source::{LiveStream, OpenOptions};
use pointreel::wire::ImageCoding;
use std::net::SocketAddr;
use std::sync::Arc;
use std::thread;
use std::time::{Duration, Instant};

#[test]
fn frames_with_fewer_attributes_are_reported_once() {
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
        harness.state_mut().step_frames(1);
        harness.state_mut().update(Duration::ZERO);
    }
    let text = told(&harness);
    assert_eq!(text.len(), 1);
    let expected = "Frame 1 has colors, frame 6 has none of colors, normals and radii";
    assert!(text[0].starts_with(expected), "{text:?}");
    for _ in 0..FRAMES {
        harness.state_mut().step_frames(1);
        harness.state_mut().update(Duration::ZERO);
    }
    assert_eq!(told(&harness), text);
}

#[test]
fn a_broken_frame_is_marked_reported_once_and_skipped() {
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
        notices[0].text.starts_with("Frame 6 of 24 is skipped. "),
        "{}",
        notices[0].text
    );

    let state = harness.state_mut();
    state.player.as_mut().unwrap().seek(4, Duration::ZERO);
    state.run(Command::TOGGLE_PLAY);
    let mut shown = Vec::new();
    for step in 0..4 {
        state.update(Duration::from_millis(step * 42));
        let player = state.player.as_ref().unwrap();
        shown.push(player.shown().unwrap().index);
    }
    assert_eq!(shown, [4, 4, 6, 7]);
}

#[test]
fn notices_can_be_copied_and_dismissed() {
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

/// Serves a sequence as a live stream until it is dropped.
struct Serving {
    server: Arc<LiveServer>,
    thread: Option<thread::JoinHandle<()>>,
}

impl Serving {
    fn at(address: SocketAddr) -> Self {
        let options = LiveOptions {
            coding: ImageCoding::default(),
            repeats: true,
            max_bytes: 1 << 28,
        };
        let begin = Instant::now();
        // A port that was just released may be busy for a while.
        let server = loop {
            let source = Arc::clone(sequence(&[]).source());
            let schedule = Schedule::new(FRAMES, 50.0, |_| 1.0);
            match LiveServer::bind(source, schedule, address, options, |_| ()) {
                Ok(server) => break Arc::new(server),
                Err(error) => assert!(begin.elapsed() < Duration::from_mins(1), "{error}"),
            }
            thread::sleep(Duration::from_millis(20));
        };
        let runs = Arc::clone(&server);
        let thread = thread::Builder::new().name("server".to_owned());
        let thread = thread.spawn(move || runs.run().unwrap()).unwrap();
        Self {
            server,
            thread: Some(thread),
        }
    }
}

impl Drop for Serving {
    fn drop(&mut self) {
        self.server.stop();
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

#[test]
fn an_interrupted_stream_is_reported_until_it_is_back() {
    let serving = Serving::at("127.0.0.1:0".parse().unwrap());
    let url = serving.server.url().unwrap();
    let address = url.trim_start_matches("tcp://").parse().unwrap();
    let stream = LiveStream::open(url.as_ref(), &OpenOptions::default(), &Progress::default()).unwrap();
    let mut state = State::new(options());
    state.open(Arc::new(Sequence::of(stream)));
    let begin = Instant::now();
    let mut wait_for = |what: &str| loop {
        state.update(begin.elapsed());
        let notices = state.notices.list();
        if let Some(notice) = notices.iter().find(|notice| notice.text.contains(what)) {
            return (notice.clone(), notices.len());
        }
        assert!(begin.elapsed() < Duration::from_mins(2), "waited in vain for: {what}");
        thread::sleep(Duration::from_millis(5));
    };
    drop(serving);
    let (notice, _) = wait_for("the connection has broken");
    assert_eq!(notice.severity, Severity::Warning);
    assert!(notice.text.starts_with(&url), "{}", notice.text);
    let _serving = Serving::at(address);
    let (notice, shown) = wait_for("connected again, after");
    // The notice about the broken connection is gone.
    assert_eq!((notice.severity, shown), (Severity::Info, 1));
}
