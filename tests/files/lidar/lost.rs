//! Packets that arrived in fragments, truncated or not at all, and packets of other makers.

use super::captures::{Container, Files, Link, SENDER, Sender, Writer, check, clouds, time};
use super::velodyne::{MODELS, Scan};
use crate::data::shared;
use pointreel::io::{self, ReadOptions};

fn scan() -> Scan<'static> {
    Scan {
        model: &MODELS[0],
        is_dual: false,
        step: 40,
        begin: 0,
    }
}

fn notes(path: &std::path::Path) -> String {
    io::contents(path, None, &ReadOptions::default())
        .unwrap()
        .notes
        .join("; ")
}

#[test]
fn fragmented_velodyne_packets_give_the_same_points() {
    for mtu in [68, 576, 700, 1000] {
        for is_mixed in [false, true] {
            let mut writer = Writer::new(Container::Pcap, Link::Ethernet);
            writer.mtu = mtu;
            for index in 0..155 {
                let mut pieces = writer.packets_of(SENDER, &scan().packet(index));
                assert!(pieces.len() > 1);
                if is_mixed && index % 3 == 1 {
                    pieces.reverse();
                }
                for piece in pieces {
                    writer.packet(time(index as u64 * 1327), &piece);
                }
            }
            let files = Files::new();
            let path = files.write("drive.pcap", &writer.bytes);
            let clouds = clouds(&path);
            assert_eq!(clouds.len(), 2, "{mtu} {is_mixed}");
            check(&clouds[0], &scan().points(0..900), 2e-5);
            check(&clouds[1], &scan().points(900..1800), 2e-5);
        }
    }
}

#[test]
fn a_missing_fragment_loses_its_packet_and_is_reported() {
    let mut writer = Writer::new(Container::Pcap, Link::Ethernet);
    writer.mtu = 576;
    for index in 0..150 {
        let mut pieces = writer.packets_of(SENDER, &scan().packet(index));
        if index % 50 == 20 {
            pieces.remove(index % 3);
        }
        for piece in pieces {
            writer.packet(time(index as u64 * 1327), &piece);
        }
    }
    let files = Files::new();
    let path = files.write("drive.pcap", &writer.bytes);
    let notes = notes(&path);
    assert!(notes.contains("fragments of 3 datagrams are missing"), "{notes}");
    let count: usize = clouds(&path).iter().map(|cloud| cloud.positions.len()).sum();
    let whole = scan().points(0..1800).len();
    assert!(count < whole && count > whole * 9 / 10, "{count} of {whole}");
}

#[test]
fn truncated_packets_are_counted() {
    for container in [Container::Pcap, Container::PcapNg] {
        for all in [true, false] {
            let mut writer = Writer::new(container, Link::Ethernet);
            for index in 0..150 {
                let packets = writer.packets_of(SENDER, &scan().packet(index));
                let is_cut = all || index % 10 == 3;
                let length = if is_cut { 96 } else { packets[0].len() };
                let at = time(index as u64 * 1327);
                writer.packet_of_length(at, &packets[0][..length], packets[0].len());
            }
            let files = Files::new();
            let path = files.write("drive.pcap", &writer.bytes);
            if all {
                let error = io::read(&path).unwrap_err().to_string();
                assert!(
                    error.contains("150 packets are cut after 96 bytes") && error.contains("tcpdump -s 0"),
                    "{error}"
                );
            } else {
                let notes = notes(&path);
                assert!(notes.contains("15 packets are cut after 96 bytes"), "{notes}");
                assert_eq!(clouds(&path).len(), 2);
            }
        }
    }
}

#[test]
fn packets_of_other_manufacturers_are_named() {
    let begin = |begin: &[u8], length: usize| {
        let mut bytes = begin.to_vec();
        bytes.resize(length, 0x11);
        bytes
    };
    let mid_360 = begin(&[0, 0x64, 0x05], 1380);
    for (port, payload, words) in [
        (2368, begin(&[0xee, 0xff, 0x01, 0x04], 893), "Hesai packets"),
        (2368, begin(&[0xee, 0xff, 0x06, 0x01], 1080), "Hesai packets"),
        (2368, begin(&[0xff, 0xee], 1262), "Hesai packets"),
        (
            6699,
            begin(&[0x55, 0xaa, 0x05, 0x0a, 0x5a, 0xa5, 0x50, 0xa0], 1248),
            "RoboSense packets",
        ),
        (6699, begin(&[0x55, 0xaa, 0x5a, 0xa5], 1210), "RoboSense packets"),
        (56_301, mid_360, "Livox packets (Mid-360"),
        (57_000, begin(&[0, 0, 0], 1362), "Livox packets (Mid-360"),
        (60_001, begin(&[5, 1, 1], 1318), "Livox packets (Mid-40"),
        (8010, begin(&[0x6a, 0x17], 1200), "Seyond"),
        (2115, begin(&[2, 2, 2, 2], 900), "SICK"),
        (5004, begin(&[0x80, 0x60], 1400), "of 1400 bytes to port 5004"),
    ] {
        let mut writer = Writer::new(Container::Pcap, Link::Ethernet);
        for index in 0..20 {
            writer.datagram(index, Sender { host: 9, port }, &payload);
        }
        let files = Files::new();
        let path = files.write("other.pcap", &writer.bytes);
        let error = io::read(&path).unwrap_err().to_string();
        let length = payload.len();
        assert!(error.contains(words), "{words}: {error}");
        assert!(
            error.contains(&format!("20 of {length} bytes to port {port}")),
            "{error}"
        );
        // In addition to a sensor that is read.
        scan().write(&mut writer, 150);
        let path = files.write("both.pcap", &writer.bytes);
        assert_eq!(clouds(&path).len(), 2);
        assert_eq!(notes(&path).contains(words), port != 5004, "{}", notes(&path));
    }
}

#[test]
fn fragments_in_the_capture_of_a_bug_report_are_joined() {
    let Some(path) = shared("meaning/V03e_fragments.pcap") else {
        return;
    };
    let clouds = clouds(&path);
    assert!((3..8).contains(&clouds.len()), "{}", clouds.len());
    assert!(clouds.iter().all(|cloud| cloud.positions.len() > 10_000));
}

#[test]
fn a_capture_truncated_within_a_record_is_detected() {
    for container in [Container::Pcap, Container::PcapNg] {
        let mut writer = Writer::new(container, Link::Ethernet);
        let mut ends = Vec::new();
        for index in 0..160 {
            writer.datagram(index * 1327, SENDER, &scan().packet(index as usize));
            ends.push(writer.bytes.len());
        }
        let files = Files::new();
        let damage = |bytes: &[u8]| {
            let path = files.write("cut.pcap", bytes);
            io::contents(&path, None, &ReadOptions::default()).unwrap().damage
        };
        assert_eq!(damage(&writer.bytes), [""; 0], "{container:?}");
        for end in [ends[120], ends[159]] {
            for cut in [1, 7, 100, 1000] {
                let [damage] = &damage(&writer.bytes[..end - cut])[..] else {
                    panic!("{container:?}: {cut} bytes before byte {end} are missing unseen");
                };
                assert!(damage.contains("the record of a packet is cut there"), "{damage}");
            }
        }
    }
}
