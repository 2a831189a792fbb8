//! Several sensors in one capture.

use super::captures::{Container, Files, Link, Sender, Writer, check};
use super::ouster;
use super::velodyne::{MODELS, Scan};
use pointreel::io::{self, ReadOptions, Topic};

/// A VLP-16 with few packets, an HDL-32E with most of them, and an Ouster.
fn write(with_metadata: bool) -> (Files, std::path::PathBuf) {
    let sender = |host| Sender { host, port: 2368 };
    let scan = |model: usize| Scan {
        model: &MODELS[model],
        is_dual: false,
        step: 100,
        begin: 0,
    };
    let mut writer = Writer::new(Container::Pcap, Link::Ethernet);
    for index in 0..90 {
        writer.datagram(index as u64 * 1327, sender(7), &scan(2).packet(index));
        if index < 60 {
            writer.datagram(index as u64 * 1327, sender(201), &scan(0).packet(index));
        }
        if index < 32 {
            let packet = ouster::SMALL.packet(1, index);
            writer.datagram(index as u64 * 1327, ouster::SENDER, &packet);
        }
    }
    let files = Files::new();
    if with_metadata {
        files.write("three.json", ouster::SMALL.flat().to_string().as_bytes());
    }
    let path = files.write("three.pcap", &writer.bytes);
    (files, path)
}

fn topics(read: &str) -> Vec<Topic> {
    let counts = [
        ("192.168.1.201:2368", 2),
        ("192.168.1.30:7502", 1),
        ("192.168.1.7:2368", 3),
    ];
    let topic = |(name, cloud_count): (&str, usize)| Topic {
        name: name.to_owned(),
        cloud_count,
        is_read: name == read,
    };
    counts.map(topic).to_vec()
}

#[test]
fn the_sensor_with_most_packets_is_read_by_default_and_others_by_name() {
    let (_files, path) = write(true);
    let options = ReadOptions::default();
    let max = io::contents(&path, None, &options).unwrap();
    assert_eq!(max.topics, topics("192.168.1.7:2368"));
    assert_eq!(max.entries.len(), 3);
    let ouster = io::contents(&path, Some("192.168.1.30:7502"), &options).unwrap();
    assert_eq!(ouster.topics, topics("192.168.1.30:7502"));
    let cloud = io::read_part(&path, &ouster.entries[0].part, &options).unwrap();
    check(&cloud, &ouster::SMALL.points(1), 2e-5);
    let puck = io::contents(&path, Some("192.168.1.201:2368"), &options).unwrap();
    let scan = Scan {
        model: &MODELS[0],
        is_dual: false,
        step: 100,
        begin: 0,
    };
    let cloud = io::read_part(&path, &puck.entries[1].part, &options).unwrap();
    check(&cloud, &scan.points(360..720), 2e-5);
    let none = io::contents(&path, Some("10.0.0.1:2368"), &options).unwrap();
    assert_eq!((none.entries.len(), none.topics), (0, topics("nothing")));
}

#[test]
fn an_unreadable_sensor_does_not_affect_the_others() {
    let (_files, path) = write(false);
    let contents = io::contents(&path, None, &ReadOptions::default()).unwrap();
    let names: Vec<&str> = contents.topics.iter().map(|topic| topic.name.as_str()).collect();
    assert_eq!(names, ["192.168.1.201:2368", "192.168.1.7:2368"]);
}
