//! Captures that lie, end early or are noise: always an answer, never a panic.

use super::captures::{ALL_CONTAINERS, Container, Files, Link, SENDER, Sender, Writer};
use super::hdl_64::{db_xml, hdl_64_packet};
use super::ouster;
use super::velodyne::{MODELS, Scan};
use pointreel::io::{self, ReadOptions};
use proptest::prelude::*;
use std::path::{Path, PathBuf};

/// A few packets of everything.
fn capture(container: Container) -> Vec<u8> {
    let mut writer = Writer::new(container, Link::Ethernet);
    for (number, model) in MODELS.iter().enumerate() {
        let sender = Sender {
            host: number as u8,
            port: 2368,
        };
        let scan = Scan {
            model,
            is_dual: number % 2 == 0,
            step: 3000,
            begin: 0,
        };
        for index in 0..5 {
            writer.datagram(index as u64, sender, &scan.packet(index));
        }
    }
    for index in 0..5 {
        writer.datagram(index as u64, SENDER, &hdl_64_packet(index * 40, false));
    }
    for frame in 0..2 {
        let packet = ouster::SMALL.packet(frame, 0);
        writer.datagram(u64::from(frame), ouster::SENDER, &packet);
    }
    writer.bytes
}

fn folder() -> Files {
    let files = Files::new();
    files.write("db.xml", db_xml().as_bytes());
    files.write("any.json", ouster::SMALL.sections().to_string().as_bytes());
    files
}

/// Lists and reads everything; returns the number of clouds.
fn read(path: &Path) -> usize {
    let options = ReadOptions::default().with_max_memory(1 << 28);
    let Ok(contents) = io::contents(path, None, &options) else {
        return 0;
    };
    let mut count = 0;
    for topic in &contents.topics {
        let contents = io::contents(path, Some(&topic.name), &options).unwrap();
        assert_eq!(contents.entries.len(), topic.cloud_count);
        for entry in contents.entries {
            if let Ok(cloud) = io::read_part(path, &entry.part, &options) {
                assert_eq!(cloud.attributes.other_length(cloud.positions.len()), None);
                count += 1;
            }
        }
    }
    count
}

#[test]
fn undamaged_captures_are_read_completely() {
    for container in ALL_CONTAINERS {
        let files = folder();
        let path = files.write("all.pcap", &capture(container));
        let contents = io::contents(&path, None, &ReadOptions::default()).unwrap();
        assert_eq!(contents.topics.len(), MODELS.len() + 2);
        assert!(read(&path) >= MODELS.len() + 3);
    }
}

#[test]
fn declared_lengths_take_no_memory() {
    for (container, at) in [(Container::Pcap, 24 + 8), (Container::PcapNg, 28 + 32 + 4)] {
        for claim in [0xffff_ffff_u32, 0x7fff_fffc, 1 << 21, 0] {
            let mut bytes = capture(container);
            bytes[at..at + 4].copy_from_slice(&claim.to_le_bytes());
            let files = folder();
            let path = files.write("claim.pcap", &bytes);
            read(&path);
        }
    }
}

/// A capture of one revolution of 600 packets, and its expected points.
fn one_large_turn() -> (Files, PathBuf, Vec<io::Entry>) {
    let scan = Scan {
        model: &MODELS[0],
        is_dual: false,
        step: 1,
        begin: 0,
    };
    let mut writer = Writer::new(Container::Pcap, Link::Ethernet);
    scan.write(&mut writer, 600);
    let files = Files::new();
    let path = files.write("slow.pcap", &writer.bytes);
    let entries = io::list(&path, &ReadOptions::default()).unwrap();
    (files, path, entries)
}

#[test]
fn scans_beyond_the_memory_limit_are_rejected() {
    let (_files, path, entries) = one_large_turn();
    let options = ReadOptions::default();
    assert_eq!(entries.len(), 1);
    assert!(io::read_part(&path, &entries[0].part, &options).is_ok());
    let error = io::read_part(&path, &entries[0].part, &options.with_max_memory(1 << 20));
    let error = error.unwrap_err().to_string();
    assert!(error.contains("--max-memory"), "{error}");
}

#[test]
fn a_cancelled_scan_ends_soon() {
    let (_files, path, entries) = one_large_turn();
    let options = ReadOptions::default();
    let progress = pointreel::progress::Progress::default();
    progress.cancel();
    let error = io::read_part_observed(&path, &entries[0].part, &options, &progress);
    assert!(matches!(error, Err(io::IoError::Cancelled { .. })));
}

#[test]
fn fragments_never_completed_are_discarded() {
    let sensor = ouster::Sensor {
        pixels: 128,
        ..ouster::SMALL
    };
    let mut writer = Writer::new(Container::Pcap, Link::Ethernet);
    for frame in 0..100 {
        let pieces = writer.packets_of(ouster::SENDER, &sensor.packet(0, frame % 32));
        for piece in &pieces[..16] {
            writer.packet(super::captures::time(0), piece);
        }
    }
    let packet = sensor.packet(0, 0);
    writer.datagram(0, ouster::SENDER, &packet);
    let files = Files::new();
    files.write("drive.json", sensor.flat().to_string().as_bytes());
    let path = files.write("drive.pcap", &writer.bytes);
    let clouds = super::captures::clouds(&path);
    let column_s = 97_657e-9;
    let of_first = |point: &&super::captures::Expected| point.time_s < 15.5 * column_s;
    assert_eq!(
        clouds[0].positions.len(),
        sensor.points(0).iter().filter(of_first).count()
    );
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    #[test]
    fn flipped_bytes_never_panic(
        container in prop::sample::select(ALL_CONTAINERS.to_vec()),
        flips in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..40),
        near in any::<prop::sample::Index>(),
        is_near in any::<bool>(),
    ) {
        let mut bytes = capture(container);
        // Record headers are few bytes among many: some flips fall close together.
        let begin = near.index(bytes.len());
        for (place, value) in flips {
            let length = bytes.len();
            let at = if is_near { (begin + place.index(200)).min(length - 1) } else { place.index(length) };
            bytes[at] = value;
        }
        let files = folder();
        let path = files.write("flipped.pcap", &bytes);
        read(&path);
    }

    #[test]
    fn captures_truncated_anywhere_are_read_up_to_there(
        container in prop::sample::select(ALL_CONTAINERS.to_vec()),
        cut in any::<prop::sample::Index>(),
    ) {
        let bytes = capture(container);
        let files = folder();
        let whole = read(&files.write("whole.pcap", &bytes));
        let there = read(&files.write("cut.pcap", &bytes[..cut.index(bytes.len())]));
        prop_assert!(there <= whole);
    }

    #[test]
    fn noise_after_a_valid_start_never_panics(
        container in prop::sample::select(ALL_CONTAINERS.to_vec()),
        noise in prop::collection::vec(any::<u8>(), 0..2000),
    ) {
        let bytes = [Writer::new(container, Link::Ethernet).bytes, noise].concat();
        let files = folder();
        read(&files.write("noise.pcap", &bytes));
    }

    #[test]
    fn noise_as_metadata_or_calibration_never_panics(
        flips in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..20),
    ) {
        let files = Files::new();
        for (name, text) in [("db.xml", db_xml()), ("a.json", ouster::SMALL.sections().to_string())] {
            let mut bytes = text.into_bytes();
            for (place, value) in &flips {
                let at = place.index(bytes.len());
                bytes[at] = *value;
            }
            files.write(name, &bytes);
        }
        let mut writer = Writer::new(Container::Pcap, Link::Ethernet);
        writer.datagram(0, SENDER, &hdl_64_packet(0, false));
        let packet = ouster::SMALL.packet(0, 0);
        writer.datagram(0, ouster::SENDER, &packet);
        read(&files.write("all.pcap", &writer.bytes));
    }
}
