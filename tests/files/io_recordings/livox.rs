//! `CustomMsg` of Livox, in the recordings of ROS 1 and ROS 2 and under the names of every driver.

use super::{Kind, Writer, bare_header, folder, record};
use crate::data::shared;
use pointreel::cloud::RawCloud;
use pointreel::io::{self, ReadOptions};
use std::collections::BTreeMap;
use std::path::Path;
use std::time::Duration;

const POINTS: u32 = 7;

/// A message of seven points, as the driver writes it.
fn message(kind: Kind, seconds: u32) -> Vec<u8> {
    let mut writer = Writer {
        kind,
        bytes: Vec::new(),
    };
    if kind == Kind::Ros1 {
        writer.u32(5);
    }
    writer.u32(seconds);
    writer.u32(250_000_000);
    writer.text("livox_frame");
    if kind != Kind::Ros1 {
        while !writer.bytes.len().is_multiple_of(8) {
            writer.bytes.push(0);
        }
    }
    writer.bytes.extend(if kind == Kind::CdrBig {
        77u64.to_be_bytes()
    } else {
        77u64.to_le_bytes()
    });
    writer.u32(POINTS);
    writer.bytes.extend([1, 0, 0, 0]);
    writer.u32(POINTS);
    for point in 0..POINTS {
        writer.u32(point * 10_000_000);
        for axis in 0..3 {
            writer.u32((point as f32 + axis as f32 * 100.0).to_bits());
        }
        for value in [point * 30, 0x10 + point, point % 6] {
            writer.number(value, 1);
        }
    }
    match kind {
        Kind::Ros1 => writer.bytes,
        Kind::CdrLittle => [vec![0, 1, 0, 0], writer.bytes].concat(),
        Kind::CdrBig => [vec![0, 0, 0, 0], writer.bytes].concat(),
    }
}

fn check(cloud: &RawCloud) {
    assert_eq!(cloud.positions.len(), POINTS as usize);
    for point in 0..POINTS {
        let x = f64::from(point);
        let expected = [x, x + 100.0, x + 200.0];
        assert_eq!(cloud.positions.get(point as usize).to_array(), expected);
    }
    let scalar = |name: &str| {
        let mut fields = cloud.attributes.scalars.iter();
        &fields.find(|field| field.name == name).unwrap().values
    };
    for point in 0..POINTS {
        let at = point as usize;
        assert_eq!(scalar("reflectivity")[at], point as f32 * 30.0);
        assert_eq!(scalar("tag")[at], 16.0 + point as f32);
        assert_eq!(scalar("line")[at], (point % 6) as f32);
        assert!((scalar("time")[at] - point as f32 * 0.01).abs() < 1e-7);
    }
}

fn check_recording(path: &Path) {
    let options = ReadOptions::default();
    let contents = io::contents(path, None, &options).unwrap();
    let times: Vec<_> = contents.entries.iter().map(|entry| entry.time.unwrap()).collect();
    assert_eq!(
        times,
        [100, 101].map(|seconds| Duration::new(seconds, 250_000_000)),
        "{}",
        path.display()
    );
    assert_eq!(contents.topics[0].name, "/livox/lidar");
    for entry in &contents.entries {
        check(&io::read_part(path, &entry.part, &options).unwrap());
    }
}

fn bag(kind: &str, messages: &[Vec<u8>]) -> Vec<u8> {
    let connection = record(
        &[("op", &[7]), ("conn", &[0; 4]), ("topic", b"/livox/lidar")],
        &bare_header(&[("type", kind.as_bytes())]),
    );
    let mut file = [b"#ROSBAG V2.0\n".to_vec(), connection].concat();
    for message in messages {
        file.extend(record(&[("op", &[2]), ("conn", &[0; 4]), ("time", &[1; 8])], message));
    }
    file
}

#[test]
fn messages_of_every_driver_are_read_as_clouds() {
    let folder = folder();
    let messages = |kind| [message(kind, 100), message(kind, 101)];
    for kind in ["livox_ros_driver/CustomMsg", "livox_ros_driver2/CustomMsg"] {
        let path = folder.path().join("a.bag");
        std::fs::write(&path, bag(kind, &messages(Kind::Ros1))).unwrap();
        check_recording(&path);
    }
    for schema in ["livox_ros_driver2/msg/CustomMsg", "livox_interfaces/msg/CustomMsg"] {
        for (kind, encoding) in [(Kind::CdrLittle, "cdr"), (Kind::CdrBig, "cdr"), (Kind::Ros1, "ros1")] {
            let mut file = std::io::Cursor::new(Vec::new());
            let mut writer = mcap::WriteOptions::new().create(&mut file).unwrap();
            let schema = writer.add_schema(schema, "ros2msg", b"").unwrap();
            let channel_id = writer
                .add_channel(schema, "/livox/lidar", encoding, &BTreeMap::new())
                .unwrap();
            for (sequence, data) in messages(kind).into_iter().enumerate() {
                let header = mcap::records::MessageHeader {
                    channel_id,
                    sequence: sequence as u32,
                    log_time: 1,
                    publish_time: 1,
                };
                writer.write_to_known_channel(&header, &data).unwrap();
            }
            writer.finish().unwrap();
            drop(writer);
            let path = folder.path().join("a.mcap");
            std::fs::write(&path, file.into_inner()).unwrap();
            check_recording(&path);
        }
    }
}

#[test]
fn a_truncated_message_only_affects_itself() {
    let folder = folder();
    let path = folder.path().join("a.bag");
    let mut messages = [message(Kind::Ros1, 100), message(Kind::Ros1, 101)];
    messages[0].truncate(120);
    std::fs::write(&path, bag("livox_ros_driver/CustomMsg", &messages)).unwrap();
    let options = ReadOptions::default();
    let entries = io::list(&path, &options).unwrap();
    assert_eq!(entries.len(), 2);
    let error = io::read_part(&path, &entries[0].part, &options)
        .unwrap_err()
        .to_string();
    assert!(error.contains("truncated or damaged"), "{error}");
    check(&io::read_part(&path, &entries[1].part, &options).unwrap());
}

#[test]
fn the_bag_of_a_bug_report_is_read() {
    let Some(path) = shared("meaning/B01_livox_custom.bag") else {
        return;
    };
    let entries = io::list(&path, &ReadOptions::default()).unwrap();
    assert!(!entries.is_empty());
    let cloud = io::read(&path).unwrap();
    assert!(cloud.positions.len() > 100, "{}", cloud.positions.len());
    let names: Vec<&str> = cloud
        .attributes
        .scalars
        .iter()
        .map(|field| field.name.as_str())
        .collect();
    assert_eq!(names, ["reflectivity", "time", "line", "tag"]);
}
