//! Messages of ROS, and recordings of them, as their programs write them.

use glam::DAffine3;
use std::collections::BTreeMap;
use std::io::Cursor;
use std::path::Path;

/// Encoding of a message.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Kind {
    Ros1,
    CdrLittle,
    CdrBig,
    /// Plain CDR of the second version.
    Cdr2,
}

impl Kind {
    pub(crate) const ALL: [Self; 4] = [Self::Ros1, Self::CdrLittle, Self::CdrBig, Self::Cdr2];

    /// A type by the name that this ROS gives it.
    fn named(self, kind: &str) -> String {
        match self {
            Self::Ros1 => kind.to_owned(),
            _ => kind.replace('/', "/msg/"),
        }
    }
}

/// Writes fields of a message.
pub(crate) struct Writer {
    kind: Kind,
    bytes: Vec<u8>,
}

impl Writer {
    pub(crate) fn new(kind: Kind) -> Self {
        Self {
            kind,
            bytes: Vec::new(),
        }
    }

    fn number(&mut self, little: &[u8]) -> &mut Self {
        let alignment = match self.kind {
            Kind::Ros1 => 1,
            Kind::CdrLittle | Kind::CdrBig => little.len(),
            Kind::Cdr2 => little.len().min(4),
        };
        while !self.bytes.len().is_multiple_of(alignment) {
            self.bytes.push(0);
        }
        if self.kind == Kind::CdrBig {
            self.bytes.extend(little.iter().rev());
        } else {
            self.bytes.extend(little);
        }
        self
    }

    pub(crate) fn u8(&mut self, value: u8) -> &mut Self {
        self.number(&[value])
    }

    pub(crate) fn u32(&mut self, value: u32) -> &mut Self {
        self.number(&value.to_le_bytes())
    }

    pub(crate) fn f32(&mut self, value: f32) -> &mut Self {
        self.number(&value.to_le_bytes())
    }

    pub(crate) fn f64s(&mut self, values: &[f64]) -> &mut Self {
        for value in values {
            self.number(&value.to_le_bytes());
        }
        self
    }

    pub(crate) fn text(&mut self, text: &str) -> &mut Self {
        let zero: &[u8] = if self.kind == Kind::Ros1 { b"" } else { b"\0" };
        self.u32((text.len() + zero.len()) as u32);
        self.bytes.extend(text.as_bytes());
        self.bytes.extend(zero);
        self
    }

    pub(crate) fn counted(&mut self, bytes: &[u8]) -> &mut Self {
        self.u32(bytes.len() as u32);
        self.bytes.extend(bytes);
        self
    }

    pub(crate) fn header(&mut self, time_us: u64, frame_id: &str) -> &mut Self {
        if self.kind == Kind::Ros1 {
            self.u32(99);
        }
        self.u32((time_us / 1_000_000) as u32)
            .u32((time_us % 1_000_000) as u32 * 1000)
            .text(frame_id)
    }

    pub(crate) fn transform(&mut self, transform: &DAffine3) -> &mut Self {
        let (_, turn, at) = transform.to_scale_rotation_translation();
        self.f64s(&at.to_array()).f64s(&turn.to_array())
    }

    pub(crate) fn message(&mut self) -> Vec<u8> {
        let body = std::mem::take(&mut self.bytes);
        match self.kind {
            Kind::Ros1 => body,
            Kind::CdrLittle => [vec![0, 1, 0, 0], body].concat(),
            Kind::CdrBig => [vec![0, 0, 0, 0], body].concat(),
            Kind::Cdr2 => [vec![0, 7, 0, 0], body].concat(),
        }
    }
}

/// A message to be recorded.
#[derive(Clone)]
pub(crate) struct Recorded {
    pub(crate) topic: String,
    /// By the name of ROS 1.
    pub(crate) kind: &'static str,
    pub(crate) time_us: u64,
    pub(crate) bytes: Vec<u8>,
}

/// The names of topics with the types of their messages, in the order of the names.
fn topics(messages: &[Recorded]) -> BTreeMap<&str, &'static str> {
    messages
        .iter()
        .map(|message| (message.topic.as_str(), message.kind))
        .collect()
}

pub(crate) fn mcap(kind: Kind, messages: &[Recorded]) -> Vec<u8> {
    let mut file = Cursor::new(Vec::new());
    let options = mcap::WriteOptions::new()
        .compression(Some(mcap::Compression::Zstd))
        .chunk_size(Some(20_000));
    let mut writer = options.create(&mut file).unwrap();
    let encoding = if kind == Kind::Ros1 { "ros1" } else { "cdr" };
    let channels: BTreeMap<&str, u16> = topics(messages)
        .into_iter()
        .map(|(topic, of)| {
            let schema = writer.add_schema(&kind.named(of), "text", b"").unwrap();
            let channel = writer.add_channel(schema, topic, encoding, &BTreeMap::new());
            (topic, channel.unwrap())
        })
        .collect();
    for (sequence, message) in messages.iter().enumerate() {
        let header = mcap::records::MessageHeader {
            channel_id: channels[message.topic.as_str()],
            sequence: sequence as u32,
            log_time: 1000 * message.time_us,
            publish_time: 1000 * message.time_us,
        };
        writer.write_to_known_channel(&header, &message.bytes).unwrap();
    }
    writer.finish().unwrap();
    drop(writer);
    file.into_inner()
}

/// A bag of ROS 2 in `SQLite`, as `rosbag2_storage_sqlite3` lays it out.
pub(crate) fn db3(path: &Path, kind: Kind, messages: &[Recorded]) {
    let database = rusqlite::Connection::open(path).unwrap();
    let tables = "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, \
                  serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL);
                  CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, \
                  timestamp INTEGER NOT NULL, data BLOB NOT NULL);";
    database.execute_batch(tables).unwrap();
    let ids: BTreeMap<&str, i64> = (1..)
        .zip(topics(messages))
        .map(|(id, (topic, _))| (topic, id))
        .collect();
    for (topic, of) in topics(messages) {
        let row = (ids[topic], topic, kind.named(of));
        let sql = "INSERT INTO topics VALUES (?1, ?2, ?3, 'cdr', '')";
        database.execute(sql, row).unwrap();
    }
    for message in messages {
        let row = (
            ids[message.topic.as_str()],
            1000 * message.time_us as i64,
            &message.bytes,
        );
        let sql = "INSERT INTO messages (topic_id, timestamp, data) VALUES (?1, ?2, ?3)";
        database.execute(sql, row).unwrap();
    }
}

fn fields(fields: &[(&str, &[u8])]) -> Vec<u8> {
    let field = |(name, value): &(&str, &[u8])| {
        let field = [name.as_bytes(), b"=", value].concat();
        [(field.len() as u32).to_le_bytes().to_vec(), field].concat()
    };
    fields.iter().flat_map(field).collect()
}

fn record(header: &[(&str, &[u8])], data: &[u8]) -> Vec<u8> {
    let header = fields(header);
    let length = |bytes: &[u8]| (bytes.len() as u32).to_le_bytes().to_vec();
    [length(&header), header.clone(), length(data), data.to_vec()].concat()
}

/// A bag of ROS 1, a chunk a message.
pub(crate) fn bag(messages: &[Recorded]) -> Vec<u8> {
    let ids: BTreeMap<&str, u32> = (0..)
        .zip(topics(messages))
        .map(|(id, (topic, _))| (topic, id))
        .collect();
    let mut connections = Vec::new();
    for (topic, of) in topics(messages) {
        let id = ids[topic].to_le_bytes();
        let head: [(&str, &[u8]); 3] = [("op", &[7]), ("conn", &id), ("topic", topic.as_bytes())];
        let data = fields(&[("topic", topic.as_bytes()), ("type", of.as_bytes())]);
        connections.extend(record(&head, &data));
    }
    let mut file = b"#ROSBAG V2.0\n".to_vec();
    file.extend(record(&[("op", &[3]), ("index_pos", &[0; 8])], &[b' '; 64]));
    for (index, message) in messages.iter().enumerate() {
        let id = ids[message.topic.as_str()].to_le_bytes();
        let time = [
            (message.time_us / 1_000_000) as u32,
            (message.time_us % 1_000_000) as u32 * 1000,
        ];
        let time = time.map(u32::to_le_bytes).concat();
        let mut chunk = if index == 0 { connections.clone() } else { Vec::new() };
        chunk.extend(record(&[("op", &[2]), ("conn", &id), ("time", &time)], &message.bytes));
        let size = (chunk.len() as u32).to_le_bytes();
        file.extend(record(
            &[("op", &[5]), ("compression", b"none"), ("size", &size)],
            &chunk,
        ));
        let index: [(&str, &[u8]); 4] = [
            ("op", &[4]),
            ("ver", &[1, 0, 0, 0]),
            ("conn", &id),
            ("count", &[1, 0, 0, 0]),
        ];
        file.extend(record(&index, &[0; 12]));
    }
    file.extend(connections);
    file
}
