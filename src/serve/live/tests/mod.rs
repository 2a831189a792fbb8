//! Servers and clients in one process, over the loopback. Waits are long, as machines are busy; conditions are polled
//! every few milliseconds.

mod hostile;
mod surfels;

use super::*;
use crate::cloud::{Positions, RawCloud};
use crate::deadlines::ServerDeadlines;
use crate::progress::Progress;
use crate::source::{
    self, DepthImages as _, FrameEntry, FrameList, Groups as _, Growth as _, Live as _, LiveState, LiveStream,
    OpenOptions, SequenceError, Source, StreamRecording,
};
use crate::wire::{
    ColorCoding, Content, DepthCoding, Frame, Got, ImageCoding, Kind, Message, StreamHead, read_message,
};
use std::io::{Read as _, Write as _};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

const LONG: Duration = Duration::from_mins(1);

const RAW: ImageCoding = ImageCoding {
    depth: DepthCoding::Raw,
    color: ColorCoding::Raw,
};

const EXACT: ImageCoding = ImageCoding {
    depth: DepthCoding::Rvl,
    color: ColorCoding::Raw,
};

fn wait_for(what: &str, mut is_so: impl FnMut() -> bool) {
    let begun = Instant::now();
    while !is_so() {
        assert!(begun.elapsed() < LONG, "waited in vain for {what}");
        thread::sleep(Duration::from_millis(3));
    }
}

/// A server on a thread, which ends with it.
struct Running {
    server: Arc<LiveServer>,
    thread: Option<JoinHandle<()>>,
    events: Arc<Mutex<Vec<LiveEvent>>>,
}

impl Running {
    fn new(source: impl Source + 'static, fps: f64, coding: ImageCoding) -> Self {
        Self::at(
            &(Arc::new(source) as Arc<dyn Source>),
            fps,
            coding,
            "127.0.0.1:0".parse().unwrap(),
        )
    }

    /// A server of raw points, with these deadlines.
    fn within(source: impl Source + 'static, deadlines: ServerDeadlines) -> Self {
        let address = "127.0.0.1:0".parse().unwrap();
        Self::bound(&(Arc::new(source) as Arc<dyn Source>), 20.0, RAW, address, deadlines)
    }

    fn at(source: &Arc<dyn Source>, fps: f64, coding: ImageCoding, address: SocketAddr) -> Self {
        Self::bound(source, fps, coding, address, ServerDeadlines::default())
    }

    fn bound(
        source: &Arc<dyn Source>,
        fps: f64,
        coding: ImageCoding,
        address: SocketAddr,
        deadlines: ServerDeadlines,
    ) -> Self {
        let schedule = Schedule::new(source.frames().len(), fps, |_| 1.0);
        let options = LiveOptions {
            coding,
            repeats: true,
            max_bytes: 1 << 28,
        };
        let events = Arc::<Mutex<Vec<LiveEvent>>>::default();
        let told = Arc::clone(&events);
        let tell = move |event| told.lock().unwrap().push(event);
        let mut tell = Some(tell);
        let begun = Instant::now();
        // A port that was just released may be busy for a while.
        let server = loop {
            let hear = tell.clone().unwrap();
            match LiveServer::bind(Arc::clone(source), schedule.clone(), address, options, hear) {
                Ok(server) => break server,
                Err(error) if begun.elapsed() < LONG => {
                    assert_eq!(error.kind(), std::io::ErrorKind::AddrInUse);
                    thread::sleep(Duration::from_millis(20));
                }
                Err(error) => panic!("{error}"),
            }
        };
        tell.take();
        let server = Arc::new(server.with_deadlines(deadlines));
        let runs = Arc::clone(&server);
        let thread = thread::Builder::new().name("server".to_owned());
        let thread = thread.spawn(move || runs.run().unwrap()).unwrap();
        Self {
            server,
            thread: Some(thread),
            events,
        }
    }

    fn url(&self) -> PathBuf {
        self.server.url().unwrap().into()
    }

    fn address(&self) -> SocketAddr {
        self.server.url().unwrap().trim_start_matches("tcp://").parse().unwrap()
    }

    fn left(&self) -> Vec<ClientReport> {
        let events = self.events.lock().unwrap();
        let left = events.iter().filter_map(|event| match event {
            LiveEvent::Left(report) => Some(report.clone()),
            _ => None,
        });
        left.collect()
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        self.server.stop();
        if let Some(thread) = self.thread.take() {
            thread.join().unwrap();
        }
    }
}

/// Frames of `count` points, each of which encodes its frame.
fn points(frames: usize, count: usize) -> FrameList {
    let entries = (0..frames)
        .map(|frame| FrameEntry::embedded(frame.to_string(), &[]))
        .collect();
    FrameList::new(entries, move |entry, _| {
        let frame: f32 = entry.name.parse()?;
        Ok(cloud(frame, count))
    })
}

fn cloud(frame: f32, count: usize) -> RawCloud {
    let mut cloud = RawCloud::from_positions(Positions::F32((0..count).map(|at| [frame, at as f32, 0.5]).collect()));
    cloud.attributes.colors = Some((0..count).map(|at| [at as u8, frame as u8, 7, 255]).collect());
    cloud
}

fn opened(url: &Path) -> LiveStream {
    LiveStream::open(url, &OpenOptions::default(), &Progress::default()).unwrap()
}

fn decoded(source: &dyn Source, index: usize) -> RawCloud {
    let entry = source.entry(index);
    let decoded = source.decoder().decode(index, &entry, usize::MAX, &Progress::default());
    decoded.unwrap().cloud
}

fn number(source: &dyn Source, index: usize) -> u64 {
    source.entry(index).number.unwrap()
}

#[test]
fn known_points_arrive_unchanged() {
    let server = Running::new(points(5, 40), 200.0, RAW);
    let stream = opened(&server.url());
    wait_for("frames", || stream.look_again().is_ok() && stream.frames().end >= 12);
    let mut last = None;
    for index in stream.frames() {
        let number = number(&stream, index);
        assert_eq!(
            decoded(&stream, index),
            cloud((number % 5) as f32, 40),
            "frame {number}"
        );
        let time = stream.entry(index).time;
        assert!(time > last, "{time:?} after {last:?}");
        last = time;
    }
    assert!(stream.is_live() && stream.may_grow() && stream.sensor(0).is_none());
    assert_eq!(stream.about().fps, Some(200.0));
}

/// A folder as Open3D lays it out: two frames with colours, holes, a camera.
fn recording(folder: &Path) {
    for kind in ["depth", "color"] {
        std::fs::create_dir_all(folder.join(kind)).unwrap();
    }
    let camera = r#"{"width": 64, "height": 48, "intrinsic_matrix": [60, 0, 0, 0, 61, 0, 31.5, 23.5, 1]}"#;
    std::fs::write(folder.join("camera_intrinsic.json"), camera).unwrap();
    for frame in 0..2u16 {
        let depth = |x: u32, y: u32| {
            image::Luma([if (x + y).is_multiple_of(11) {
                0
            } else {
                900 + 3 * x as u16 + 50 * frame
            }])
        };
        let depth = image::ImageBuffer::<image::Luma<u16>, _>::from_fn(64, 48, depth);
        depth.save(folder.join(format!("depth/{frame:05}.png"))).unwrap();
        let color = |x: u32, y: u32| image::Rgb([x as u8, y as u8, 40 * frame as u8]);
        let color = image::ImageBuffer::<image::Rgb<u8>, _>::from_fn(64, 48, color);
        color.save(folder.join(format!("color/{frame:05}.png"))).unwrap();
    }
}

fn text(cloud: &RawCloud) -> String {
    format!("{:?} {:?} {:?}", cloud.positions, cloud.attributes, cloud.grid)
}

#[test]
fn images_arrive_raw_and_give_the_same_clouds_as_files_with_any_filters() {
    let folder = tempfile::tempdir().unwrap();
    recording(folder.path());
    for (coding, filters) in [
        (RAW, "none"),
        (EXACT, "near,median,bilateral,flying"),
        (ImageCoding::default(), "median"),
    ] {
        let mut options = OpenOptions::default();
        let inputs = [folder.path().to_owned()];
        let files = source::open(&inputs, &options, &Progress::default()).unwrap();
        let server = Running::at(&files, 100.0, coding, "127.0.0.1:0".parse().unwrap());
        options.rgbd.filters = filters.parse().unwrap();
        let filtered = source::open(&inputs, &options, &Progress::default()).unwrap();
        let stream = LiveStream::open(&server.url(), &options, &Progress::default()).unwrap();
        wait_for("frames", || stream.look_again().is_ok() && stream.frames().end >= 3);
        for index in stream.frames() {
            let file = (number(&stream, index) % 2) as usize;
            let (mut came, mut expected) = (decoded(&stream, index), decoded(&*filtered, file));
            assert_eq!(
                stream.sensor(index).map(|sensor| sensor.rig),
                filtered.sensor(file).map(|sensor| sensor.rig)
            );
            let [came_colors, expected_colors] =
                [&mut came, &mut expected].map(|cloud| cloud.attributes.colors.take().unwrap());
            let pairs = came_colors.as_flattened().iter().zip(expected_colors.as_flattened());
            let max = pairs.map(|(a, b)| a.abs_diff(*b)).max().unwrap();
            let allowed = if coding.color == ColorCoding::Raw { 0 } else { 16 };
            assert!(max <= allowed, "colours differ by {max} with {coding:?}");
            assert_eq!(text(&came), text(&expected), "{coding:?} {filters}");
        }
    }
}

#[test]
fn a_temporal_filter_sees_the_previous_frames() {
    let folder = tempfile::tempdir().unwrap();
    recording(folder.path());
    let mut options = OpenOptions::default();
    let inputs = [folder.path().to_owned()];
    let files = source::open(&inputs, &options, &Progress::default()).unwrap();
    let server = Running::at(&files, 100.0, EXACT, "127.0.0.1:0".parse().unwrap());
    options.rgbd.filters = "temporal".parse().unwrap();
    options.live_seconds = Some(3600.0);
    let stream = LiveStream::open(&server.url(), &options, &Progress::default()).unwrap();
    wait_for("frames", || stream.look_again().is_ok() && stream.frames().end >= 4);
    assert!(stream.group(2).len() > 2);
    let (alone, mut in_order) = (text(&decoded(&stream, 3)), stream.decoder());
    let all = (0..4).map(|index| {
        let entry = stream.entry(index);
        in_order
            .decode(index, &entry, usize::MAX, &Progress::default())
            .unwrap()
            .cloud
    });
    assert_eq!(text(&all.last().unwrap()), alone);
}

/// Reads as another program would, acknowledging received frames, or not.
struct Reader {
    stream: TcpStream,
    says: bool,
}

impl Reader {
    fn new(address: SocketAddr, says: bool) -> Self {
        let mut stream = TcpStream::connect(address).unwrap();
        stream.set_read_timeout(Some(LONG)).unwrap();
        StreamHead::read(&mut stream).unwrap();
        Self { stream, says }
    }

    fn frame(&mut self) -> Frame {
        loop {
            let message = read_message(&mut self.stream, 1 << 28).unwrap();
            if let Some(frame) = Frame::of(message).unwrap() {
                if self.says {
                    let got = Got {
                        number: frame.head.number,
                    };
                    self.stream.write_all(&got.message().encode()).unwrap();
                }
                return frame;
            }
        }
    }
}

#[test]
fn a_slow_reader_gets_the_newest_frame_and_does_not_delay_others() {
    let server = Running::new(points(4, 100), 100.0, RAW);
    let mut slow = Reader::new(server.address(), true);
    let quick = opened(&server.url());
    // Frames that were queued before it acknowledged any.
    for _ in 0..4 {
        slow.frame();
    }
    let mut late = Vec::new();
    for _ in 0..8 {
        thread::sleep(Duration::from_millis(150));
        let served = server.server.report().served_frames;
        late.push(served.saturating_sub(slow.frame().head.number));
    }
    // Two were in transit while it slept, of 15 frames each, and two in the mailbox: not hundreds in buffers.
    late.sort_unstable();
    assert!(late[4] <= 45, "frames late: {late:?}");
    quick.look_again().unwrap();
    let status = quick.status();
    let share = status.lost_frames as f64 / (status.received_frames + status.lost_frames) as f64;
    assert!(share < 0.3 && status.received_frames > 60, "{status:?}");
    drop(slow);
    wait_for("the slow one to leave", || !server.left().is_empty());
    let report = &server.left()[0];
    assert!(report.dropped_frames > 60 && report.sent_frames < 60, "{report:?}");
}

#[test]
fn a_reader_that_takes_nothing_does_not_delay_others() {
    let server = Running::new(points(4, 20_000), 100.0, RAW);
    // Its frames fill up the network buffers.
    let stuck = TcpStream::connect(server.address()).unwrap();
    let quick = opened(&server.url());
    let before = quick.status().received_frames;
    wait_for("frames", || quick.status().received_frames > before + 300);
    wait_for("drops", || server.server.report().dropped_frames > 10);
    drop(stuck);
}

#[test]
fn a_client_connects_again_after_the_server_has_died() {
    let first = Running::new(points(3, 10), 100.0, RAW);
    let (url, address) = (first.url(), first.address());
    let stream = opened(&url);
    wait_for("frames", || stream.look_again().is_ok() && stream.frames().end >= 5);
    drop(first);
    let state = || stream.status().state;
    wait_for("the end", || matches!(state(), LiveState::Reconnecting(_)));
    stream.look_again().unwrap();
    let before = stream.frames().end;
    let second = Running::at(&(Arc::new(points(7, 20)) as Arc<dyn Source>), 100.0, RAW, address);
    wait_for("more frames", || {
        stream.look_again().is_ok() && stream.frames().end >= before + 5
    });
    assert_eq!(state(), LiveState::Connected);
    assert_eq!(stream.status().reconnects, 1);
    let last = stream.frames().end - 1;
    assert_eq!(decoded(&stream, last), cloud((number(&stream, last) % 7) as f32, 20));
    let times: Vec<_> = stream.frames().map(|index| stream.entry(index).time.unwrap()).collect();
    assert!(times.is_sorted_by(|a, b| a < b), "{times:?}");
    drop(second);
}

#[test]
fn clients_are_notified_of_the_end() {
    let server = Running::new(points(3, 10), 100.0, RAW);
    let mut reader = Reader::new(server.address(), false);
    reader.frame();
    let begun = Instant::now();
    drop(server);
    assert!(begun.elapsed() < Duration::from_secs(20));
    let end = loop {
        let message = read_message(&mut reader.stream, 1 << 20).unwrap();
        if message.kind == Kind::End {
            break message;
        }
    };
    assert_eq!(end.payload, b"the server was stopped");
    assert_eq!(reader.stream.read(&mut [0; 8]).unwrap(), 0);
}

#[test]
fn a_sequence_that_is_not_repeated_ends() {
    let source: Arc<dyn Source> = Arc::new(points(5, 10));
    let options = LiveOptions {
        coding: RAW,
        repeats: false,
        max_bytes: 1 << 20,
    };
    let schedule = Schedule::new(5, 50.0, |_| 1.0);
    let server = LiveServer::bind(source, schedule, "127.0.0.1:0".parse().unwrap(), options, |_| ()).unwrap();
    server.run().unwrap();
    assert_eq!(server.report().clients, 0);
}

#[test]
fn the_newest_seconds_are_retained() {
    let server = Running::new(points(3, 1000), 100.0, RAW);
    let options = OpenOptions {
        live_seconds: Some(0.3),
        ..OpenOptions::default()
    };
    let stream = LiveStream::open(&server.url(), &options, &Progress::default()).unwrap();
    wait_for("frames", || stream.look_again().is_ok() && stream.frames().end >= 80);
    let frames = stream.frames();
    assert!(frames.start > 0 && frames.len() >= 2, "{frames:?}");
    let status = stream.status();
    assert!(status.buffered_s < 2.0, "{status:?}");
    // Frames that are gone are an error.
    let entry = stream.entry(0);
    let gone = stream.decoder().decode(0, &entry, usize::MAX, &Progress::default());
    assert!(gone.unwrap_err().to_string().contains("gone for good"));
    assert!(stream.frames_behind(frames.end - 1).is_some());
    assert_eq!(stream.frames_behind(0), None);
}

#[test]
fn the_delay_is_known_to_the_accuracy_of_a_ping() {
    let server = Running::new(points(3, 10), 50.0, RAW);
    let stream = opened(&server.url());
    let delay = || stream.status().delay_s;
    wait_for("a ping", || delay().is_some());
    let (delay, wrong) = delay().unwrap();
    // One clock, one machine: a short delay, and the true value (above 0) is within the bound.
    assert!(
        delay + wrong >= 0.0 && delay < 10.0 && wrong < 10.0,
        "{delay} ± {wrong} s"
    );
}

#[test]
fn a_received_stream_can_be_recorded_and_reopened() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("kept.pointreel-stream");
    let server = Running::new(points(5, 40), 100.0, RAW);
    let stream = opened(&server.url());
    let live = &stream;
    assert_eq!(live.stop_recording(), Ok(None));
    assert!(
        live.start_recording(Path::new("/nowhere/at/all"))
            .unwrap_err()
            .contains("/nowhere/at/all")
    );
    live.start_recording(&path).unwrap();
    wait_for("frames", || {
        live.status().recording.is_some_and(|recording| recording.frames >= 8)
    });
    let StreamRecording { frames, bytes, .. } = live.stop_recording().unwrap().unwrap();
    assert_eq!(std::fs::metadata(&path).unwrap().len(), bytes);
    let open = |path: &Path| source::open(&[path.to_owned()], &OpenOptions::default(), &Progress::default());
    let recorded = open(&path).unwrap();
    assert_eq!(recorded.frames(), 0..frames as usize);
    assert!(!recorded.is_live() && recorded.notes().is_empty());
    let first = number(&*recorded, 0);
    for index in recorded.frames() {
        let number = number(&*recorded, index);
        assert!(number >= first + index as u64);
        assert_eq!(decoded(&*recorded, index), cloud((number % 5) as f32, 40));
    }
    // A truncated file has the complete frames, and reports its end.
    let whole = std::fs::read(&path).unwrap();
    let cut = folder.path().join("cut.pointreel-stream");
    std::fs::write(&cut, &whole[..whole.len() - 100]).unwrap();
    let broken = open(&cut).unwrap();
    assert_eq!(broken.frames().len(), frames as usize - 1);
    assert!(
        broken.notes()[0].contains("ends within a message"),
        "{:?}",
        broken.notes()
    );
    assert_eq!(broken.damage(), broken.notes(), "check tells of it");
    // A stream that sends nothing more does not replace a recording.
    live.start_recording(&cut).unwrap();
    drop(live.stop_recording().unwrap());
    assert!(open(&cut).is_ok_and(|cut| !cut.frames().is_empty()));
    // Modified bytes lose one frame.
    let mut changed = whole.clone();
    let at = changed.len() - 50;
    changed[at] ^= 1;
    std::fs::write(&cut, changed).unwrap();
    let damaged = open(&cut).unwrap();
    let last = damaged.frames().end - 1;
    let entry = damaged.entry(last);
    let error = damaged
        .decoder()
        .decode(last, &entry, usize::MAX, &Progress::default())
        .unwrap_err();
    assert!(error.to_string().contains("checksum"), "{error}");
    // A head alone is not a recording.
    std::fs::write(&cut, &whole[..60]).unwrap();
    assert!(open(&cut).err().unwrap().to_string().contains("no whole frame"));
    // And a recording can be served.
    let again = Running::at(&recorded, 100.0, RAW, "127.0.0.1:0".parse().unwrap());
    let stream = opened(&again.url());
    assert_eq!(decoded(&stream, 0).positions.len(), 40);
}

/// An hour of a stream of small frames, as fast as it goes.
#[test]
fn memory_stays_flat_over_thousands_of_frames() {
    const FRAMES: usize = 6000;
    let made = Arc::new(AtomicUsize::new(0));
    let counts = Arc::clone(&made);
    let entries = (0..100_000)
        .map(|frame| FrameEntry::embedded(frame.to_string(), &[]))
        .collect();
    let source = FrameList::new(entries, move |_, _| {
        counts.fetch_add(1, Ordering::Relaxed);
        Ok(cloud(1.0, 500))
    });
    let server = Running::new(source, 2000.0, RAW);
    let options = OpenOptions {
        live_seconds: Some(0.2),
        ..OpenOptions::default()
    };
    let stream = LiveStream::open(&server.url(), &options, &Progress::default()).unwrap();
    let received = || stream.status().received_frames as usize;
    wait_for("the first thousand", || received() > FRAMES / 6);
    let (memory, buffered) = (resident_bytes(), stream.status().buffered_bytes);
    wait_for("all frames", || {
        // A client that watches requests the newest.
        if stream.look_again().unwrap() > 0 {
            let newest = stream.frames().end - 1;
            let entry = stream.entry(newest);
            let _ = stream
                .decoder()
                .decode(newest, &entry, usize::MAX, &Progress::default());
        }
        received() > FRAMES
    });
    // A frame is 8 KB: 5,000 of them would be 40 MB; frames that the server itself retains are counted separately.
    let grown = resident_bytes().saturating_sub(memory);
    let buffered_by_server = made.load(Ordering::Relaxed) * 8200;
    assert!(
        grown < buffered_by_server + (24 << 20),
        "{grown} bytes more, {buffered_by_server} of them the server's"
    );
    let buffered_now = stream.status().buffered_bytes;
    assert!(
        buffered_now < buffered.max(1 << 20) * 8,
        "{buffered_now} bytes in the ring, {buffered} before"
    );
}

/// Memory of this process; none if the system does not report it in this form.
fn resident_bytes() -> usize {
    let pages = std::fs::read_to_string("/proc/self/statm").ok();
    let pages = pages.and_then(|text| text.split(' ').nth(1)?.parse::<usize>().ok());
    pages.map_or(0, |pages| pages * 4096)
}

#[test]
fn the_stream_sends_what_its_content_states() {
    let server = Running::new(points(1, 3), 50.0, RAW);
    let frame = Reader::new(server.address(), false).frame();
    assert_eq!(frame.head.index, 0);
    match frame.content {
        Content::Points(points) => assert_eq!(points.cloud().unwrap(), cloud(0.0, 3)),
        Content::Images(_) => panic!("points became images"),
    }
}
