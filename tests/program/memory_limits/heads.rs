//! First bytes of files, with arbitrary claims.

use std::fmt::Write as _;

pub(super) fn text_line(line: &str, length: u64) -> Vec<u8> {
    line.as_bytes().repeat(length as usize / line.len())
}

pub(super) fn ply(format: &str, vertices: u64, more: &str) -> Vec<u8> {
    let header = format!(
        "ply\nformat {format} 1.0\nelement vertex {vertices}\nproperty float x\nproperty float y\nproperty float \
         z\n{more}end_header\n"
    );
    header.into_bytes()
}

pub(super) fn pcd(points: u64, data: &str) -> Vec<u8> {
    let header = format!(
        "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH {points}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 \
         0 0\nPOINTS {points}\nDATA {data}\n"
    );
    header.into_bytes()
}

/// LAS 1.4, point format 0, with `records` behind the header.
pub(super) fn las(points: u64, is_compressed: bool, records: &[(&str, u16, Vec<u8>)]) -> Vec<u8> {
    let mut head = vec![0; 375];
    head[..4].copy_from_slice(b"LASF");
    head[24..26].copy_from_slice(&[1, 4]);
    head[94..96].copy_from_slice(&375u16.to_le_bytes());
    head[100..104].copy_from_slice(&(records.len() as u32).to_le_bytes());
    head[104] = if is_compressed { 0x80 } else { 0 };
    head[105..107].copy_from_slice(&20u16.to_le_bytes());
    for axis in 0..3 {
        head[131 + 8 * axis..139 + 8 * axis].copy_from_slice(&0.001f64.to_le_bytes());
    }
    head[247..255].copy_from_slice(&points.to_le_bytes());
    for (user, id, data) in records {
        let mut record = vec![0; 54];
        record[2..2 + user.len()].copy_from_slice(user.as_bytes());
        record[18..20].copy_from_slice(&id.to_le_bytes());
        record[20..22].copy_from_slice(&(data.len() as u16).to_le_bytes());
        head.extend(record);
        head.extend(data);
    }
    let start = head.len() as u32;
    head[96..100].copy_from_slice(&start.to_le_bytes());
    head
}

/// The record of `LASzip`: chunks of points of 20 bytes.
pub(super) fn laszip(chunk_points: u32) -> Vec<u8> {
    let mut record = vec![2, 0, 0, 0, 2, 2, 0, 0, 0, 0, 0, 0];
    record.extend(chunk_points.to_le_bytes());
    record.extend([0xff; 16]);
    record.extend([1, 0]);
    // Point10, 20 bytes, version 2.
    record.extend([6, 0, 20, 0, 2, 0]);
    record
}

pub(super) fn npy(descr: &str, shape: &str) -> Vec<u8> {
    let mut header = format!("{{'descr': {descr}, 'fortran_order': False, 'shape': ({shape}), }}");
    while !(header.len() + 11).is_multiple_of(64) {
        header.push(' ');
    }
    header.push('\n');
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    bytes
}

/// Pieces, each repeated by its count, by gzip.
pub(super) fn gzip(pieces: &[(&[u8], u64)]) -> Vec<u8> {
    use std::io::Write as _;
    let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    for (piece, times) in pieces {
        for _ in 0..*times {
            packed.write_all(piece).unwrap();
        }
    }
    packed.finish().unwrap()
}

/// A glTF of points whose accessors are `accessors`, over a buffer of 16 bytes.
pub(super) fn gltf(mode: u32, indices: Option<usize>, accessors: &str) -> Vec<u8> {
    let indices = indices.map_or_else(String::new, |index| format!("\"indices\": {index}, "));
    let document = format!(
        "{{\"asset\": {{\"version\": \"2.0\"}}, \"scene\": 0, \"scenes\": [{{\"nodes\": [0]}}], \"nodes\": \
         [{{\"mesh\": 0}}], \"meshes\": [{{\"primitives\": [{{\"mode\": {mode}, {indices}\"attributes\": \
         {{\"POSITION\": 0}}}}]}}], \"buffers\": [{{\"byteLength\": 16, \"uri\": \
         \"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAAAAAA==\"}}], \"bufferViews\": [{{\"buffer\": 0, \
         \"byteLength\": 16}}], \"accessors\": [{accessors}]}}"
    );
    document.into_bytes()
}

pub(super) fn accessor(count: u64, kind: &str, component_type: u32, more: &str) -> String {
    format!("{{\"count\": {count}, \"type\": \"{kind}\", \"componentType\": {component_type}{more}}}")
}

pub(super) fn mcap(records: &[(u8, Vec<u8>)]) -> Vec<u8> {
    let mut bytes = b"\x89MCAP0\r\n".to_vec();
    for (kind, body) in records {
        bytes.push(*kind);
        bytes.extend((body.len() as u64).to_le_bytes());
        bytes.extend(body);
    }
    bytes
}

fn mcap_text(bytes: &mut Vec<u8>, text: &str) {
    bytes.extend((text.len() as u32).to_le_bytes());
    bytes.extend(text.as_bytes());
}

/// Records of a topic of point clouds, or another type: its schema and its channel.
pub(super) fn mcap_topic(number: u16, name: &str, kind: &str) -> [(u8, Vec<u8>); 2] {
    let mut schema = number.to_le_bytes().to_vec();
    mcap_text(&mut schema, kind);
    mcap_text(&mut schema, "ros2msg");
    mcap_text(&mut schema, "");
    let mut channel = [number.to_le_bytes(), number.to_le_bytes()].concat();
    mcap_text(&mut channel, name);
    mcap_text(&mut channel, "cdr");
    channel.extend(0u32.to_le_bytes());
    [(3, schema), (4, channel)]
}

/// A chunk that claims to unpack to `unpacked_bytes`.
pub(super) fn mcap_chunk(compression: &str, unpacked_bytes: u64, packed: &[u8]) -> (u8, Vec<u8>) {
    let mut body = vec![0; 16];
    body.extend(unpacked_bytes.to_le_bytes());
    body.extend(0u32.to_le_bytes());
    mcap_text(&mut body, compression);
    body.extend((packed.len() as u64).to_le_bytes());
    body.extend(packed);
    (6, body)
}

fn bag_header(fields: &[(&str, &[u8])]) -> Vec<u8> {
    let mut header = Vec::new();
    for (name, value) in fields {
        header.extend((name.len() as u32 + 1 + value.len() as u32).to_le_bytes());
        header.extend(name.as_bytes());
        header.push(b'=');
        header.extend(*value);
    }
    let mut counted = (header.len() as u32).to_le_bytes().to_vec();
    counted.extend(header);
    counted
}

/// A bag of one chunk that claims to unpack to `unpacked_bytes`.
pub(super) fn bag(compression: &str, unpacked_bytes: u32, packed: &[u8]) -> Vec<u8> {
    let mut bytes = b"#ROSBAG V2.0\n".to_vec();
    bytes.extend(bag_header(&[
        ("op", &[5]),
        ("compression", compression.as_bytes()),
        ("size", &unpacked_bytes.to_le_bytes()),
    ]));
    bytes.extend((packed.len() as u32).to_le_bytes());
    bytes.extend(packed);
    bytes
}

pub(super) fn pcap() -> Vec<u8> {
    let mut bytes = b"\xd4\xc3\xb2\xa1\x02\x00\x04\x00".to_vec();
    bytes.extend([0; 8]);
    bytes.extend(0xffff_u32.to_le_bytes());
    bytes.extend(1u32.to_le_bytes());
    bytes
}

pub(super) fn pcapng() -> Vec<u8> {
    let mut bytes = 0x0a0d_0d0a_u32.to_le_bytes().to_vec();
    bytes.extend(28u32.to_le_bytes());
    bytes.extend(0x1a2b_3c4d_u32.to_le_bytes());
    bytes.extend([1, 0, 0, 0]);
    bytes.extend([0xff; 8]);
    bytes.extend(28u32.to_le_bytes());
    bytes
}

/// The header of a member of a tar archive.
pub(super) fn tar_header(name: &str, size: u64) -> Vec<u8> {
    let mut header = vec![0; 512];
    header[..name.len()].copy_from_slice(name.as_bytes());
    header[100..108].copy_from_slice(b"0000644\0");
    header[124..136].copy_from_slice(format!("{size:011o}\0").as_bytes());
    header[156] = b'0';
    header[257..263].copy_from_slice(b"ustar\0");
    header[148..156].fill(b' ');
    let sum: u32 = header.iter().copied().map(u32::from).sum();
    let mut text = String::new();
    write!(text, "{sum:06o}\0 ").unwrap();
    header[148..156].copy_from_slice(text.as_bytes());
    header
}

/// An archive with a member whose bytes are `pieces`, each repeated by its count.
pub(super) fn zip(name: &str, pieces: &[(&[u8], u64)]) -> Vec<u8> {
    use std::io::Write as _;
    let mut writer = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    let options = zip::write::SimpleFileOptions::default().compression_level(Some(1));
    writer.start_file(name, options.large_file(true)).unwrap();
    for (piece, times) in pieces {
        for _ in 0..*times {
            writer.write_all(piece).unwrap();
        }
    }
    writer.finish().unwrap().into_inner()
}

/// A PNG that claims these pixels and has the compressed rows `data`.
pub(super) fn png(size_px: [u32; 2], bits: u8, color: u8, data: &[u8]) -> Vec<u8> {
    let mut header = size_px.map(u32::to_be_bytes).concat();
    header.extend([bits, color, 0, 0, 0]);
    let mut bytes = b"\x89PNG\r\n\x1a\n".to_vec();
    for (kind, body) in [(b"IHDR", header.as_slice()), (b"IDAT", data), (b"IEND", &[])] {
        bytes.extend((body.len() as u32).to_be_bytes());
        let start = bytes.len();
        bytes.extend(kind);
        bytes.extend(body);
        let sum = crc32fast::hash(&bytes[start..]);
        bytes.extend(sum.to_be_bytes());
    }
    bytes
}

/// Zeros by zlib, this many bytes.
pub(super) fn zlib_of_zeros(length: u64) -> Vec<u8> {
    use std::io::Write as _;
    let mut packed = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::fast());
    let piece = vec![0; 1 << 20];
    for _ in 0..length >> 20 {
        packed.write_all(&piece).unwrap();
    }
    packed.finish().unwrap()
}
