//! `foxglove.PointCloud` in MCAP, as Protocol Buffers and as JSON.

use base64::Engine as _;
use pointreel::cloud::{Positions, RawCloud};
use pointreel::io::{self, ReadOptions};
use std::collections::BTreeMap;
use std::path::Path;
use std::time::Duration;

/// Name, offset and type of the fields of a point of 17 bytes.
const FIELDS: [(&str, u32, u8); 7] = [
    ("x", 0, 7),
    ("y", 4, 7),
    ("z", 8, 7),
    ("red", 12, 1),
    ("green", 13, 1),
    ("blue", 14, 1),
    ("ring", 15, 4),
];
const STRIDE: u32 = 17;

/// A quarter turn about z, not of length one, then a step.
const POSE: ([f64; 3], [f64; 4]) = ([100.0, 200.0, 1e7], [0.0, 0.0, 2.0, 2.0]);

fn data(count: u8) -> Vec<u8> {
    let point = |index: u8| {
        let mut point = Vec::new();
        for float in [f32::from(index), 2.0, -3.5] {
            point.extend(float.to_le_bytes());
        }
        point.extend([index, 20, 30]);
        point.extend((i16::from(index) - 1).to_le_bytes());
        point
    };
    (0..count).flat_map(point).collect()
}

/// A field of Protocol Buffers: bytes, a message or text.
fn bytes(number: u8, value: &[u8]) -> Vec<u8> {
    let mut length = value.len();
    let mut field = vec![number << 3 | 2];
    while length >= 0x80 {
        field.push((length & 0x7f) as u8 | 0x80);
        length >>= 7;
    }
    field.push(length as u8);
    [field, value.to_vec()].concat()
}

fn fixed32(number: u8, value: u32) -> Vec<u8> {
    [&[number << 3 | 5][..], &value.to_le_bytes()].concat()
}

fn doubles(values: &[f64]) -> Vec<u8> {
    (1..)
        .zip(values)
        .flat_map(|(number, value)| [&[number << 3 | 1][..], &value.to_le_bytes()].concat())
        .collect()
}

fn protobuf(seconds: u8, has_pose: bool, stride: u32, data: &[u8]) -> Vec<u8> {
    let mut message = Vec::new();
    if seconds > 0 {
        // 300 nanoseconds.
        message.extend(bytes(1, &[0x08, seconds, 0x10, 0xac, 0x02]));
    }
    message.extend(bytes(2, b"lidar"));
    if has_pose {
        let (position, orientation) = POSE;
        let pose = [bytes(1, &doubles(&position)), bytes(2, &doubles(&orientation))];
        message.extend(bytes(3, &pose.concat()));
    }
    message.extend(fixed32(4, stride));
    for (name, offset, kind) in FIELDS {
        let field = [bytes(1, name.as_bytes()), fixed32(2, offset), vec![3 << 3, kind]];
        message.extend(bytes(5, &field.concat()));
    }
    message.extend(bytes(6, data));
    message
}

fn json(seconds: u8, has_pose: bool, stride: u32, data: &[u8]) -> Vec<u8> {
    let fields: Vec<_> = FIELDS
        .iter()
        .map(|(name, offset, kind)| serde_json::json!({"name": name, "offset": offset, "type": kind}))
        .collect();
    let mut message = serde_json::json!({
        "frame_id": "lidar",
        "point_stride": stride,
        "fields": fields,
        "data": base64::engine::general_purpose::STANDARD.encode(data),
    });
    if seconds > 0 {
        message["timestamp"] = serde_json::json!({"sec": seconds, "nsec": 300});
    }
    if has_pose {
        let ([px, py, pz], [x, y, z, w]) = POSE;
        message["pose"] = serde_json::json!({
            "position": {"x": px, "y": py, "z": pz},
            "orientation": {"x": x, "y": y, "z": z, "w": w},
        });
    }
    serde_json::to_vec(&message).unwrap()
}

type Writer = fn(u8, bool, u32, &[u8]) -> Vec<u8>;

const WRITERS: [(&str, Writer); 2] = [("protobuf", protobuf), ("json", json)];

fn write(path: &Path, encoding: &str, messages: &[Vec<u8>], options: mcap::WriteOptions) {
    let mut file = std::fs::File::create(path).unwrap();
    let mut writer = options.create(&mut file).unwrap();
    let schema_encoding = if encoding == "json" { "jsonschema" } else { encoding };
    let schema = writer.add_schema("foxglove.PointCloud", schema_encoding, b"").unwrap();
    let channel = writer
        .add_channel(schema, "/lidar", encoding, &BTreeMap::new())
        .unwrap();
    for (sequence, message) in (0..).zip(messages) {
        let header = mcap::records::MessageHeader {
            channel_id: channel,
            sequence,
            log_time: 7_000_000_000,
            publish_time: 0,
        };
        writer.write_to_known_channel(&header, message).unwrap();
    }
    writer.finish().unwrap();
}

fn check_attributes(cloud: &RawCloud) {
    let colors = (0..5).map(|index| [index, 20, 30, 255]).collect();
    assert_eq!(cloud.attributes.colors, Some(colors));
    assert_eq!(cloud.attributes.scalars[0].name, "ring");
    assert_eq!(cloud.attributes.scalars[0].values, [-1.0, 0.0, 1.0, 2.0, 3.0]);
}

#[test]
fn clouds_have_times_attributes_and_poses() {
    let folder = tempfile::tempdir().unwrap();
    let options = ReadOptions::default();
    for (encoding, message) in WRITERS {
        for is_chunked in [true, false] {
            let path = folder.path().join("a.mcap");
            // With a pose, without one, without a time.
            let messages = [
                message(9, true, STRIDE, &data(5)),
                message(8, false, STRIDE, &data(5)),
                message(0, false, STRIDE, &[]),
            ];
            let packing = mcap::WriteOptions::new().use_chunks(is_chunked);
            write(&path, encoding, &messages, packing);
            let entries = io::list(&path, &options).unwrap();
            let times: Vec<_> = entries.iter().map(|entry| entry.time.unwrap()).collect();
            let stamp = |seconds| Duration::new(seconds, 300);
            // This writer sorts keys alphabetically: the time is last, and only found if the whole message is
            // available.
            let is_found = encoding == "protobuf" || is_chunked;
            let expected = if is_found {
                [Duration::from_secs(7), stamp(8), stamp(9)]
            } else {
                [Duration::from_secs(7); 3]
            };
            assert_eq!(times, expected, "{encoding} {is_chunked}");
            let read = |index: usize| io::read_part(&path, &entries[index].part, &options).unwrap();
            let (empty, plain, posed) = if is_found { (0, 1, 2) } else { (2, 1, 0) };
            assert!(read(empty).positions.is_empty());

            let cloud = read(plain);
            let positions = (0..5).map(|index| [index as f32, 2.0, -3.5]).collect();
            assert_eq!(cloud.positions, Positions::F32(positions));
            check_attributes(&cloud);

            let cloud = read(posed);
            for index in 0..5 {
                let expected = glam::DVec3::new(98.0, 200.0 + index as f64, 9_999_996.5);
                let difference = cloud.positions.get(index) - expected;
                assert!(difference.length() < 1e-8, "{difference}");
            }
            check_attributes(&cloud);
        }
    }
}

#[test]
fn the_time_is_read_from_the_first_bytes_of_json() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mcap");
    // A field with that name is not the time of the message, and comes first here.
    let message = br#"{"fields":[{"name":"timestamp","offset":0,"type":7}],"timestamp" : {"sec":3,"nsec":4},"data":""#;
    let message = [&message[..], &b"AAAA".repeat(1000), b"\",\"point_stride\":4}"].concat();
    write(&path, "json", &[message], mcap::WriteOptions::new().use_chunks(false));
    let entries = io::list(&path, &ReadOptions::default()).unwrap();
    assert_eq!(entries[0].time, Some(Duration::new(3, 4)));
}

#[test]
fn inconsistent_messages_are_reported() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mcap");
    for (encoding, message) in WRITERS {
        for (bad, expected) in [
            (
                message(1, false, STRIDE, &data(5)[1..]),
                "84 bytes of points are there, expected a multiple of 17",
            ),
            (message(1, false, 0, &data(5)), "`point_stride` above 0"),
            (
                message(1, false, 5, &data(5)),
                "field `y` ends at byte 8 of a point, which has 5",
            ),
            (
                message(1, false, STRIDE, &data(5))[..40].to_vec(),
                if encoding == "json" { "EOF" } else { "truncated" },
            ),
        ] {
            write(&path, encoding, &[bad], mcap::WriteOptions::new());
            let error = io::read(&path).unwrap_err().to_string();
            assert!(error.contains(expected), "{encoding}: {error}");
        }
    }
    let typed = String::from_utf8(json(1, false, STRIDE, &data(1)))
        .unwrap()
        .replace("\"type\":4", "\"type\":0");
    write(&path, "json", &[typed.into_bytes()], mcap::WriteOptions::new());
    let error = io::read(&path).unwrap_err().to_string();
    assert!(error.contains("field `ring` is of type 0, expected 1 to 8"), "{error}");
    // Points of three bytes become three floats, in addition to the message: that memory is claimed before it is
    // allocated.
    let mut narrow = fixed32(4, 3);
    for (index, name) in [b"x", b"y", b"z"].into_iter().enumerate() {
        let field = [bytes(1, name), fixed32(2, index as u32), vec![3 << 3, 1]];
        narrow.extend(bytes(5, &field.concat()));
    }
    narrow.extend(bytes(6, &[9; 300]));
    let loose = mcap::WriteOptions::new().use_chunks(false);
    write(&path, "protobuf", &[narrow], loose);
    let entries = io::list(&path, &ReadOptions::default()).unwrap();
    let read = |max_bytes: u64| {
        let options = ReadOptions::default().with_max_memory(max_bytes);
        io::read_part(&path, &entries[0].part, &options)
    };
    assert_eq!(read(2400).unwrap().positions.len(), 100);
    let error = read(1500).unwrap_err().to_string();
    assert!(error.contains("--max-memory"), "{error}");
}

#[test]
fn damaged_messages_are_handled() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mcap");
    for (encoding, message) in WRITERS {
        let message = message(9, true, STRIDE, &data(2));
        let damaged = (0..message.len()).flat_map(|at| {
            let flipped = [0x01, 0x80, 0xff].map(|flip| {
                let mut damaged = message.clone();
                damaged[at] ^= flip;
                damaged
            });
            flipped.into_iter().chain([message[..at].to_vec()])
        });
        let damaged: Vec<_> = damaged.collect();
        write(&path, encoding, &damaged, mcap::WriteOptions::new().use_chunks(false));
        let entries = io::list(&path, &ReadOptions::default()).unwrap();
        assert_eq!(entries.len(), damaged.len());
        let options = ReadOptions::default().with_max_memory(1 << 20);
        let read = entries
            .iter()
            .filter(|entry| io::read_part(&path, &entry.part, &options).is_ok());
        // Most changes affect points and names and cannot be detected; most truncations can.
        let read = read.count();
        assert!((1..damaged.len()).contains(&read), "{read}");
    }
}
