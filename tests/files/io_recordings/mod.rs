//! Recordings written here, with clouds whose points are known, in every container, packing and byte order.

mod cut;
mod foxglove;
mod livox;
mod topics;
mod unread;

use pointreel::cloud::{ImageGrid, RawCloud};
use pointreel::io::{self, Entry, IoError, Part, ReadOptions};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Encoding of a message.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    Ros1,
    CdrLittle,
    CdrBig,
}

/// Writes fields of a message.
struct Writer {
    kind: Kind,
    bytes: Vec<u8>,
}

impl Writer {
    fn number(&mut self, value: u32, size: usize) {
        if self.kind != Kind::Ros1 {
            while !self.bytes.len().is_multiple_of(size) {
                self.bytes.push(0);
            }
        }
        if self.kind == Kind::CdrBig {
            self.bytes.extend(&value.to_be_bytes()[4 - size..]);
        } else {
            self.bytes.extend(&value.to_le_bytes()[..size]);
        }
    }

    fn u32(&mut self, value: u32) {
        self.number(value, 4);
    }

    fn text(&mut self, text: &str) {
        let zero: &[u8] = if self.kind == Kind::Ros1 { b"" } else { b"\0" };
        self.u32((text.len() + zero.len()) as u32);
        self.bytes.extend(text.as_bytes());
        self.bytes.extend(zero);
    }
}

/// A cloud of 2 × 3 points with a row of padding, colours in the bits of a float, and rings.
fn message(kind: Kind, (seconds, nanos): (u32, u32), first: f32, big_endian: bool) -> Vec<u8> {
    const POINT_STEP: u32 = 20;
    const ROW_STEP: u32 = 3 * POINT_STEP + 5;
    let mut writer = Writer {
        kind,
        bytes: Vec::new(),
    };
    if kind == Kind::Ros1 {
        writer.u32(99);
    }
    writer.u32(seconds);
    writer.u32(nanos);
    writer.text("lidar");
    writer.u32(2);
    writer.u32(3);
    writer.u32(5);
    for (name, offset, datatype) in [("x", 0, 7), ("y", 4, 7), ("z", 8, 7), ("rgb", 12, 7), ("ring", 16, 4)] {
        writer.text(name);
        writer.u32(offset);
        writer.number(datatype, 1);
        writer.u32(1);
    }
    writer.number(u32::from(big_endian), 1);
    writer.u32(POINT_STEP);
    writer.u32(ROW_STEP);
    writer.u32(2 * ROW_STEP);
    for row in 0..2 {
        for column in 0..3 {
            let number = row * 3 + column;
            let floats = [
                first + number as f32,
                -1.5,
                f32::from_bits(0x4000_0000 + number),
                f32::from_bits(0x0010_2030),
            ];
            for float in floats {
                writer.bytes.extend(if big_endian {
                    float.to_be_bytes()
                } else {
                    float.to_le_bytes()
                });
            }
            let ring = 300 + number as u16;
            writer.bytes.extend(if big_endian {
                ring.to_be_bytes()
            } else {
                ring.to_le_bytes()
            });
            writer.bytes.extend([0xee; 2]);
        }
        writer.bytes.extend([0xee; 5]);
    }
    writer.number(1, 1);
    match kind {
        Kind::Ros1 => writer.bytes,
        Kind::CdrLittle => [vec![0, 1, 0, 0], writer.bytes].concat(),
        Kind::CdrBig => [vec![0, 0, 0, 0], writer.bytes].concat(),
    }
}

fn check(cloud: &RawCloud, first: f32) {
    assert_eq!(cloud.positions.len(), 6);
    assert_eq!(cloud.grid, ImageGrid::of(3, 2, 6));
    for index in 0..6 {
        let z = f32::from_bits(0x4000_0000 + index as u32);
        let expected = [first + index as f32, -1.5, z].map(f64::from);
        assert_eq!(cloud.positions.get(index).to_array(), expected, "point {index}");
    }
    assert_eq!(cloud.attributes.colors, Some(vec![[0x10, 0x20, 0x30, 255]; 6]));
    assert_eq!(cloud.attributes.scalars[0].name, "ring");
    assert_eq!(
        cloud.attributes.scalars[0].values,
        [300.0, 301.0, 302.0, 303.0, 304.0, 305.0]
    );
}

/// Three clouds out of order on `/points`, one without a time; two on `/other`; text on `/talk`.
fn messages(kind: Kind) -> Vec<(u16, u64, Vec<u8>)> {
    let cloud = |stamp, first| message(kind, stamp, first, first > 15.0);
    vec![
        (1, 5_000_000_000, cloud((30, 500), 30.0)),
        (0, 5_500_000_000, b"hello".to_vec()),
        (1, 6_000_000_000, cloud((10, 500_000_000), 10.0)),
        (2, 6_000_000_000, cloud((11, 0), 0.0)),
        (2, 6_000_000_000, cloud((12, 0), 0.0)),
        (1, 20_000_000_000, cloud((0, 0), 20.0)),
    ]
}

const TOPICS: [(&str, bool); 3] = [("/talk", false), ("/points", true), ("/other", true)];

fn check_recording(path: &Path) {
    let entries = io::list(path, &ReadOptions::default()).unwrap();
    let times: Vec<_> = entries.iter().map(|entry| entry.time.unwrap()).collect();
    let expected = [(10, 500_000_000), (20, 0), (30, 500)].map(|(s, n)| Duration::new(s, n));
    assert_eq!(times, expected, "{}", path.display());
    for (entry, first) in entries.iter().zip([10.0, 20.0, 30.0]) {
        check(
            &io::read_part(path, &entry.part, &ReadOptions::default()).unwrap(),
            first,
        );
    }
    check(&io::read(path).unwrap(), 10.0);
}

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().unwrap()
}

fn mcap(kind: Kind, options: mcap::WriteOptions) -> Vec<u8> {
    let mut file = std::io::Cursor::new(Vec::new());
    let mut writer = options.create(&mut file).unwrap();
    let (schema, encoding) = match kind {
        Kind::Ros1 => ("sensor_msgs/PointCloud2", "ros1"),
        _ => ("sensor_msgs/msg/PointCloud2", "cdr"),
    };
    let channels = TOPICS.map(|(topic, is_cloud)| {
        let schema = if is_cloud { schema } else { "std_msgs/String" };
        let schema = writer.add_schema(schema, "text", b"").unwrap();
        writer.add_channel(schema, topic, encoding, &BTreeMap::new()).unwrap()
    });
    for (sequence, (topic, time, data)) in messages(kind).into_iter().enumerate() {
        let header = mcap::records::MessageHeader {
            channel_id: channels[usize::from(topic)],
            sequence: sequence as u32,
            log_time: time,
            publish_time: time,
        };
        writer.write_to_known_channel(&header, &data).unwrap();
    }
    writer.finish().unwrap();
    drop(writer);
    file.into_inner()
}

#[test]
fn mcap_is_read_in_every_compression_and_serialisation() {
    let folder = folder();
    for kind in [Kind::Ros1, Kind::CdrLittle, Kind::CdrBig] {
        for (name, options) in [
            ("none", mcap::WriteOptions::new().compression(None)),
            (
                "lz4",
                mcap::WriteOptions::new()
                    .compression(Some(mcap::Compression::Lz4))
                    .chunk_size(Some(300)),
            ),
            (
                "zstd",
                mcap::WriteOptions::new().compression(Some(mcap::Compression::Zstd)),
            ),
            ("loose", mcap::WriteOptions::new().use_chunks(false)),
            (
                "bare",
                mcap::WriteOptions::new()
                    .emit_summary_records(false)
                    .emit_summary_offsets(false)
                    .emit_message_indexes(false),
            ),
        ] {
            let path = folder.path().join(format!("{name}_{kind:?}.mcap"));
            std::fs::write(&path, mcap(kind, options)).unwrap();
            check_recording(&path);
        }
    }
}

/// A record of a bag.
fn record(fields: &[(&str, &[u8])], data: &[u8]) -> Vec<u8> {
    [
        header(fields),
        (data.len() as u32).to_le_bytes().to_vec(),
        data.to_vec(),
    ]
    .concat()
}

fn header(fields: &[(&str, &[u8])]) -> Vec<u8> {
    let fields = bare_header(fields);
    [(fields.len() as u32).to_le_bytes().to_vec(), fields].concat()
}

fn bare_header(fields: &[(&str, &[u8])]) -> Vec<u8> {
    fields
        .iter()
        .flat_map(|(name, value)| {
            let field = [name.as_bytes(), b"=", value].concat();
            [(field.len() as u32).to_le_bytes().to_vec(), field].concat()
        })
        .collect()
}

fn bag(compression: &str, pack: impl Fn(&[u8]) -> Vec<u8>, has_index: bool) -> Vec<u8> {
    let mut connections = Vec::new();
    for (id, (topic, is_cloud)) in TOPICS.into_iter().enumerate() {
        let kind: &[u8] = if is_cloud {
            b"sensor_msgs/PointCloud2"
        } else {
            b"std_msgs/String"
        };
        let fields: [(&str, &[u8]); 3] = [
            ("op", &[7]),
            ("conn", &(id as u32).to_le_bytes()),
            ("topic", topic.as_bytes()),
        ];
        connections.extend(record(
            &fields,
            &bare_header(&[("topic", topic.as_bytes()), ("type", kind)]),
        ));
    }
    let mut file = b"#ROSBAG V2.0\n".to_vec();
    file.extend(record(&[("op", &[3]), ("index_pos", &[0; 8])], &[b' '; 64]));
    // One chunk per message; connections are in the first one.
    for (index, (topic, time, data)) in messages(Kind::Ros1).into_iter().enumerate() {
        let id = u32::from(topic).to_le_bytes();
        let mut chunk = if index == 0 { connections.clone() } else { Vec::new() };
        let time = [
            ((time / 1_000_000_000) as u32).to_le_bytes(),
            ((time % 1_000_000_000) as u32).to_le_bytes(),
        ]
        .concat();
        chunk.extend(record(&[("op", &[2]), ("conn", &id), ("time", &time)], &data));
        let size = (chunk.len() as u32).to_le_bytes();
        let fields: [(&str, &[u8]); 3] = [("op", &[5]), ("compression", compression.as_bytes()), ("size", &size)];
        file.extend(record(&fields, &pack(&chunk)));
        if has_index {
            file.extend(record(
                &[
                    ("op", &[4]),
                    ("ver", &[1, 0, 0, 0]),
                    ("conn", &id),
                    ("count", &[1, 0, 0, 0]),
                ],
                &[0; 12],
            ));
        }
    }
    if has_index {
        file.extend(connections);
    }
    file
}

fn lz4(bytes: &[u8]) -> Vec<u8> {
    use std::io::Write as _;
    let mut encoder = lz4_flex::frame::FrameEncoder::new(Vec::new());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

#[test]
fn bags_are_read_with_and_without_an_index() {
    let folder = folder();
    for has_index in [true, false] {
        for (name, file) in [
            ("none", bag("none", <[u8]>::to_vec, has_index)),
            ("lz4", bag("lz4", lz4, has_index)),
        ] {
            let path = folder.path().join(format!("{name}_{has_index}.bag"));
            std::fs::write(&path, file).unwrap();
            check_recording(&path);
        }
    }
}

fn db3(path: &Path, kind: Kind, pack: impl Fn(&[u8]) -> Vec<u8>) {
    let database = rusqlite::Connection::open(path).unwrap();
    database
        .execute_batch(
            "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, \
             serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL); \
             CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL, \
             data BLOB NOT NULL); CREATE INDEX timestamp_idx ON messages (timestamp ASC);",
        )
        .unwrap();
    for (id, (topic, is_cloud)) in TOPICS.into_iter().enumerate() {
        let kind = if is_cloud {
            "sensor_msgs/msg/PointCloud2"
        } else {
            "std_msgs/msg/String"
        };
        database
            .execute(
                "INSERT INTO topics VALUES (?1, ?2, ?3, 'cdr', '')",
                (id as i64, topic, kind),
            )
            .unwrap();
    }
    for (topic, time, data) in messages(kind) {
        database
            .execute(
                "INSERT INTO messages(topic_id, timestamp, data) VALUES (?1, ?2, ?3)",
                (topic, time as i64, pack(&data)),
            )
            .unwrap();
    }
}

#[test]
fn ros_2_bags_are_read_from_sqlite() {
    let folder = folder();
    for kind in [Kind::CdrLittle, Kind::CdrBig] {
        let path = folder.path().join(format!("{kind:?}.db3"));
        db3(&path, kind, <[u8]>::to_vec);
        check_recording(&path);
    }
    let path = folder.path().join("zstd.db3");
    db3(&path, Kind::CdrLittle, |data| zstd::encode_all(data, 1).unwrap());
    let error = io::list(&path, &ReadOptions::default()).unwrap_err().to_string();
    assert!(error.contains("packed one by one with zstd"), "{error}");
}

/// Lists and reads all, with little memory: only that it ends matters.
fn answer(path: &Path) {
    let options = ReadOptions::default().with_max_memory(1 << 20);
    for entry in io::list(path, &options).unwrap_or_default() {
        let _ = io::read_part(path, &entry.part, &options);
    }
}

fn damaged(name: &str, file: &[u8]) {
    let folder = folder();
    let path: PathBuf = folder.path().join(name);
    for length in 0..file.len() {
        std::fs::write(&path, &file[..length]).unwrap();
        answer(&path);
    }
    for at in 0..file.len() {
        for flip in [0x01, 0xff] {
            let mut file = file.to_vec();
            file[at] ^= flip;
            std::fs::write(&path, &file).unwrap();
            answer(&path);
        }
    }
}

#[test]
fn damaged_recordings_are_handled() {
    let lz4_chunks = mcap::WriteOptions::new().compression(Some(mcap::Compression::Lz4));
    damaged("a.mcap", &mcap(Kind::CdrLittle, lz4_chunks));
    damaged(
        "b.mcap",
        &mcap(Kind::CdrBig, mcap::WriteOptions::new().use_chunks(false)),
    );
    damaged("a.bag", &bag("none", <[u8]>::to_vec, true));
    damaged("b.bag", &bag("lz4", lz4, false));
}

#[test]
fn damaged_databases_are_handled() {
    let folder = folder();
    let path = folder.path().join("a.db3");
    db3(&path, Kind::CdrLittle, <[u8]>::to_vec);
    let file = std::fs::read(&path).unwrap();
    for at in (0..file.len()).step_by(7) {
        std::fs::write(&path, &file[..at]).unwrap();
        answer(&path);
        let mut file = file.clone();
        file[at] ^= 0xff;
        std::fs::write(&path, &file).unwrap();
        answer(&path);
    }
}

#[test]
fn messages_that_are_not_clouds_are_reported() {
    let folder = folder();
    let path = folder.path().join("a.mcap");
    let mut file = std::io::Cursor::new(Vec::new());
    mcap::WriteOptions::new().create(&mut file).unwrap().finish().unwrap();
    std::fs::write(&path, file.into_inner()).unwrap();
    assert_eq!(io::list(&path, &ReadOptions::default()).unwrap(), Vec::<Entry>::new());
    assert!(matches!(io::read(&path), Err(IoError::NoFrame { .. })));
    // A cloud whose last point is truncated, according to the size claimed in its header.
    let mut short = message(Kind::Ros1, (1, 0), 1.0, false);
    let at = short.windows(4).position(|four| four == 65u32.to_le_bytes()).unwrap();
    short[at..at + 4].copy_from_slice(&71u32.to_le_bytes());
    let chunk = [
        record(
            &[("op", &[7]), ("conn", &[0; 4]), ("topic", b"/a")],
            &bare_header(&[("type", b"sensor_msgs/PointCloud2")]),
        ),
        record(&[("op", &[2]), ("conn", &[0; 4]), ("time", &[1; 8])], &short),
    ]
    .concat();
    let path = folder.path().join("a.bag");
    std::fs::write(&path, [b"#ROSBAG V2.0\n".to_vec(), chunk].concat()).unwrap();
    let entries = io::list(&path, &ReadOptions::default()).unwrap();
    assert!(matches!(entries[0].part, Part::Message(_)));
    let error = io::read_part(&path, &entries[0].part, &ReadOptions::default())
        .unwrap_err()
        .to_string();
    assert!(error.contains("need 131 bytes, 130 are there"), "{error}");
}
