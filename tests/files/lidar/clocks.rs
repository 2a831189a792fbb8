//! Captures whose times are in a different unit from the one in their header.

use super::captures::{Container, Files, Link, SENDER, Writer, check};
use super::velodyne::{MODELS, Scan};
use crate::data::shared;
use pointreel::io::{self, ReadOptions};
use std::time::Duration;

const PACKETS: usize = 160;

fn scan() -> Scan<'static> {
    Scan {
        model: &MODELS[0],
        is_dual: false,
        step: 40,
        begin: 0,
    }
}

/// The time of a packet, by the sensor.
fn time(index: usize) -> Duration {
    Duration::from_micros(((index * scan().cycles()) as f64 * MODELS[0].cycle_us) as u64)
}

/// A capture whose packets have the times that `stated` makes of those since its beginning.
fn capture(container: Container, stated: impl Fn(Duration) -> Duration) -> Vec<u8> {
    let mut writer = Writer::new(container, Link::Ethernet);
    for index in 0..PACKETS {
        let packets = writer.packets_of(SENDER, &scan().packet(index));
        writer.packet(stated(time(index)), &packets[0]);
    }
    writer.bytes
}

/// Holds that frames are revolutions, and seconds between them.
fn check_frames(name: &str, bytes: &[u8], words: &str) {
    let files = Files::new();
    let path = files.write("drive.pcap", bytes);
    let contents = io::contents(&path, None, &ReadOptions::default()).unwrap();
    assert_eq!(contents.entries.len(), 2, "{name}");
    let notes = contents.notes.join("; ");
    assert!(notes.contains(words), "{name}: {notes}");
    let turns = scan().turns(PACKETS * scan().cycles());
    let expected = time(turns[1].start / scan().cycles()).as_secs_f64();
    let times: Vec<f64> = contents
        .entries
        .iter()
        .map(|entry| entry.time.unwrap().as_secs_f64())
        .collect();
    assert!(
        (times[1] - times[0] - expected).abs() < 1e-3,
        "{name}: {times:?}, expected {expected}"
    );
    let cloud = io::read_part(&path, &contents.entries[0].part, &ReadOptions::default()).unwrap();
    check(&cloud, &scan().points(turns[0].clone()), 2e-5);
}

#[test]
fn nanoseconds_in_a_microsecond_capture_are_detected_by_the_sensor_clock() {
    for begin_s in [0, 17, 1_700_000_000] {
        // There, seconds have 32 bits.
        let as_micros = |time: Duration| Duration::from_micros((begin_s * 1_000_000_000) + time.as_nanos() as u64);
        let bytes = capture(Container::Pcap, as_micros);
        check_frames("split by a million", &bytes, "1000 times faster");
    }
    let in_blocks = |time: Duration| Duration::from_secs(1000) + time * 1000;
    let bytes = capture(Container::PcapNg, in_blocks);
    check_frames("pcapng", &bytes, "1000 times faster");
}

#[test]
fn fractions_of_seconds_in_another_unit_are_detected_by_their_size() {
    let at = |time: Duration| Duration::from_secs(1_700_000_000) + time;
    // The same records after the header of the other unit.
    let mut nanos = capture(Container::PcapBigNanoseconds, at);
    nanos[..4].copy_from_slice(&0xa1b2_c3d4_u32.to_be_bytes());
    check_frames("nanoseconds", &nanos, "read as nanoseconds");
    let mut micros = capture(Container::Pcap, at);
    micros[..4].copy_from_slice(&0xa1b2_3c4d_u32.to_le_bytes());
    check_frames("microseconds", &micros, "read as microseconds");
    for container in [Container::Pcap, Container::PcapBigNanoseconds, Container::PcapNg] {
        let files = Files::new();
        let path = files.write("drive.pcap", &capture(container, at));
        let contents = io::contents(&path, None, &ReadOptions::default()).unwrap();
        let notes = contents.notes.join("; ");
        assert!(!notes.contains("seconds"), "{container:?}: {notes}");
    }
}

#[test]
fn the_capture_of_a_bug_report_is_split_into_revolutions() {
    let Some(path) = shared("meaning/V02_ns_as_us.pcap") else {
        return;
    };
    let contents = io::contents(&path, None, &ReadOptions::default()).unwrap();
    assert!((2..8).contains(&contents.entries.len()), "{}", contents.entries.len());
    assert!(
        contents.notes.iter().any(|note| note.contains("nanoseconds")),
        "{:?}",
        contents.notes
    );
    let times: Vec<f64> = contents
        .entries
        .iter()
        .map(|entry| entry.time.unwrap().as_secs_f64())
        .collect();
    assert!(
        times.windows(2).all(|pair| (0.04..0.25).contains(&(pair[1] - pair[0]))),
        "{times:?}"
    );
}
