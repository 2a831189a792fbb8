//! Files and links that packets are captured in.

use super::captures::{ALL_CONTAINERS, Container, Files, Link, SENDER, Writer, check, clouds, time};
use super::velodyne::{MODELS, Scan};
use pointreel::io::{self, Format, ReadOptions};
use std::path::Path;

fn scan() -> Scan<'static> {
    Scan {
        model: &MODELS[0],
        is_dual: false,
        step: 100,
        begin: 0,
    }
}

#[test]
fn every_container_and_link_type_gives_the_same_points() {
    for container in ALL_CONTAINERS {
        for link in [Link::Ethernet, Link::Vlan, Link::Cooked, Link::Cooked2, Link::Raw] {
            let mut writer = Writer::new(container, link);
            scan().write(&mut writer, 60);
            let files = Files::new();
            // The first bytes determine the format, whatever the name.
            let path = files.write("capture.dump", &writer.bytes);
            let entries = io::list(&path, &ReadOptions::default()).unwrap();
            assert_eq!(entries[0].time, Some(time(0)), "{container:?} {link:?}");
            let clouds = clouds(&path);
            assert_eq!(clouds.len(), 2, "{container:?} {link:?}");
            check(&clouds[0], &scan().points(0..360), 2e-5);
        }
    }
}

#[test]
fn captures_are_recognised_by_extension_and_by_first_bytes() {
    for name in ["a.pcap", "a.pcapng"] {
        let format = Format::of_extension(Path::new(name)).unwrap();
        assert!(format.is_container() && format.holds_many());
        assert_eq!(format.to_string(), "packet capture");
    }
    for container in ALL_CONTAINERS {
        let writer = Writer::new(container, Link::Ethernet);
        assert_eq!(
            Format::detect(Path::new("a.ply"), &writer.bytes),
            Format::of_extension(Path::new("a.pcap"))
        );
    }
}

#[test]
fn other_traffic_and_blocks_are_skipped() {
    let mut writer = Writer::new(Container::PcapNg, Link::Ethernet);
    let other = super::captures::Sender { host: 201, port: 8308 };
    for index in 0..60 {
        writer.packet(time(0), &[0xff; 60]);
        writer.packet(time(0), b"");
        // Positions of the sensor, and a long datagram from an unrelated sender.
        writer.datagram(0, other, &[0x55; 512]);
        writer.datagram(0, other, &[0x55; 9000]);
        writer.block(5, &[7; 20]);
        writer.block(0xabcd, &[7; 40]);
        let packet = scan().packet(index);
        writer.datagram(index as u64 * 1327, SENDER, &packet);
    }
    // Longer than any packet.
    writer.block(10, &vec![1; 2 << 20]);
    let packet = scan().packet(60);
    writer.datagram(60 * 1327, SENDER, &packet);
    let files = Files::new();
    let path = files.write("mixed.pcapng", &writer.bytes);
    let options = ReadOptions::default();
    let contents = io::contents(&path, None, &options).unwrap();
    assert_eq!(contents.topics.len(), 1);
    let clouds = clouds(&path);
    check(&clouds[0], &scan().points(0..360), 2e-5);
    check(&clouds[1], &scan().points(360..720), 2e-5);
    // The capture ends with a packet of the third revolution.
    assert_eq!(clouds.len(), 2);
}

#[test]
fn consecutive_sections_are_one_capture() {
    let (mut little, mut big) = (
        Writer::new(Container::PcapNg, Link::Ethernet),
        Writer::new(Container::PcapNgBig, Link::Raw),
    );
    for index in 0..60 {
        let packet = scan().packet(index);
        let writer = if index < 45 { &mut little } else { &mut big };
        writer.datagram(index as u64 * 1327, SENDER, &packet);
    }
    let files = Files::new();
    let path = files.write("joined.pcapng", &[little.bytes, big.bytes].concat());
    let clouds = clouds(&path);
    assert_eq!(clouds.len(), 2);
    // The second revolution starts in one section and ends in the other.
    check(&clouds[1], &scan().points(360..720), 2e-5);
}

#[test]
fn a_truncated_capture_gives_what_is_there() {
    for container in ALL_CONTAINERS {
        let mut writer = Writer::new(container, Link::Ethernet);
        scan().write(&mut writer, 60);
        let length = writer.bytes.len() - 700;
        let files = Files::new();
        let path = files.write("cut.pcap", &writer.bytes[..length]);
        let clouds = clouds(&path);
        assert_eq!(clouds.len(), 2, "{container:?}");
        check(&clouds[1], &scan().points(360..708), 2e-5);
    }
}

#[test]
fn captures_without_lidar_packets_have_no_cloud() {
    for container in ALL_CONTAINERS {
        let mut writer = Writer::new(container, Link::Ethernet);
        writer.datagram(0, SENDER, &[0; 100]);
        let files = Files::new();
        let path = files.write("web.pcap", &writer.bytes);
        let error = io::read(&path).unwrap_err().to_string();
        assert!(error.contains("holds no point cloud (packet capture file)"), "{error}");
    }
    let files = Files::new();
    let path = files.write("text.pcap", b"this is a text and no capture of packets");
    let error = io::read(&path).unwrap_err().to_string();
    assert!(error.contains("this is not a packet capture"), "{error}");
}
