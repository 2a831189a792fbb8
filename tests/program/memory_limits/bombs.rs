//! Small files that claim to be, or unpack to, gigabytes.

use super::heads::{
    accessor, bag, gltf, gzip, las, laszip, mcap, mcap_chunk, mcap_topic, npy, pcd, ply, png, tar_header, text_line,
    zip, zlib_of_zeros,
};
use super::{Case, MIB};
use draco_core::{
    DataType, EncoderBuffer, EncoderOptions, GeometryAttributeType, PointAttribute, PointCloud, PointCloudEncoder,
};
use e57::{E57Writer, Record, RecordDataType, RecordName, RecordValue};
use std::io::{Cursor, Write as _};
use std::process::Command;

const GIB: u64 = 1 << 30;

pub(super) fn cases() -> Vec<Case> {
    [packed(), claims(), models(), recordings(), pictures()]
        .into_iter()
        .flatten()
        .collect()
}

/// Output of the program for a small cloud.
pub(super) fn made_by_program(extension: &str) -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    let input = folder.path().join("a.xyz");
    let rows: Vec<String> = (0..2000)
        .map(|index| format!("{} {} {index}\n", index % 13, index % 7))
        .collect();
    std::fs::write(&input, rows.concat()).unwrap();
    let output = folder.path().join("a").with_extension(extension);
    let mut program = Command::new(env!("CARGO_BIN_EXE_pointreel"));
    let made = program.arg("convert").arg(&input).arg(&output).output().unwrap();
    assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
    std::fs::read(output).unwrap()
}

/// A cloud of nine points whose header claims `points`, if any.
pub(super) fn draco(points: Option<u32>) -> Vec<u8> {
    /// Offset of the number of points in the header.
    const COUNT_AT: usize = 11;
    let mut cloud = PointCloud::new();
    cloud.set_num_points(9);
    let mut positions = PointAttribute::new();
    positions.init(GeometryAttributeType::Position, 3, DataType::Float32, false, 9);
    cloud.add_attribute(positions);
    let mut buffer = EncoderBuffer::new();
    let mut encoder = PointCloudEncoder::new();
    encoder.set_point_cloud(cloud);
    encoder.encode(&EncoderOptions::new(), &mut buffer).unwrap();
    let mut bytes = buffer.data().to_vec();
    if let Some(points) = points {
        bytes[COUNT_AT..COUNT_AT + 4].copy_from_slice(&points.to_le_bytes());
    }
    bytes
}

/// A scan of `points` that are all alike: its columns take no bits. `claim` replaces their number.
pub(super) fn e57(points: usize, claim: &str) -> Vec<u8> {
    // The crate cannot write zero-bit columns.
    let constant = RecordDataType::Integer { min: 0, max: 1 };
    let names = [RecordName::CartesianX, RecordName::CartesianY, RecordName::CartesianZ];
    let names_of_axes = 0..names.len();
    let prototype = names.map(|name| Record {
        name,
        data_type: constant.clone(),
    });
    let mut file = Cursor::new(Vec::new());
    let mut writer = E57Writer::new(&mut file, "file").unwrap();
    let mut scan = writer.add_pointcloud("scan", prototype.to_vec()).unwrap();
    for _ in 0..points {
        scan.add_point(vec![RecordValue::Integer(0); 3]).unwrap();
    }
    scan.finalize().unwrap();
    writer.finalize().unwrap();
    drop(writer);
    let text = |count: &str| format!("recordCount=\"{count}\"").into_bytes();
    let mut bytes = replaced_in_pages(&file.into_inner(), &text(&points.to_string()), &text(claim));
    for _ in names_of_axes {
        bytes = replaced_in_pages(&bytes, b"maximum=\"1\"", b"maximum=\"0\"");
    }
    bytes
}

/// The file with `new` instead of `old` and correspondingly fewer spaces behind the description, with the sums of its
/// pages.
fn replaced_in_pages(bytes: &[u8], old: &[u8], new: &[u8]) -> Vec<u8> {
    const PAGE_BYTES: usize = 1024;
    const SUM_BYTES: usize = 4;
    let data_bytes = PAGE_BYTES - SUM_BYTES;
    let pages = bytes.chunks_exact(PAGE_BYTES);
    let mut data: Vec<u8> = pages.flat_map(|page| &page[..data_bytes]).copied().collect();
    let at = data.windows(old.len()).position(|window| window == old).unwrap();
    data.splice(at..at + old.len(), new.iter().copied());
    let more = new.len() as i64 - old.len() as i64;
    let number = |at: usize| u64::from_le_bytes(data[at..at + 8].try_into().unwrap());
    // Length of the XML description.
    let length = number(32).checked_add_signed(more).unwrap();
    data.resize(data.len().next_multiple_of(data_bytes), 0);
    let file_bytes = (data.len() / data_bytes * PAGE_BYTES) as u64;
    data[32..40].copy_from_slice(&length.to_le_bytes());
    data[16..24].copy_from_slice(&file_bytes.to_le_bytes());
    let page = |data: &[u8]| [data, &crc32c(data).to_be_bytes()].concat();
    data.chunks_exact(data_bytes).flat_map(page).collect()
}

/// Castagnoli's.
fn crc32c(bytes: &[u8]) -> u32 {
    let step = |sum: u32, _| (sum >> 1) ^ (0x82f6_3b78 & 0u32.wrapping_sub(sum & 1));
    let byte = |sum: u32, &byte: &u8| (0..8).fold(sum ^ u32::from(byte), step);
    !bytes.iter().fold(u32::MAX, byte)
}

/// The header of an SPZ file of version 4.
pub(super) fn spz_head(count: u32) -> Vec<u8> {
    let mut head = b"NGSP\x04\0\0\0".to_vec();
    head.extend(count.to_le_bytes());
    head.extend([0, 12, 0, 5, 32, 0, 0, 0]);
    head.resize(32, 0);
    head
}

fn packed() -> Vec<Case> {
    let piece = vec![0; 1 << 20];
    let points = GIB / 12;
    let cloud = ply("binary_little_endian", points, "");
    let lines = text_line("0 0 0\n", 6 * 100_000);
    let spz = [
        b"NGSP\x02\0\0\0".as_slice(),
        &50_000_000u32.to_le_bytes(),
        &[0, 12, 0, 0],
    ]
    .concat();
    let mut bombs = vec![
        Case::whole("gzip of zeros", "a.ply.gz", gzip(&[(&cloud, 1), (&piece, 1025)])),
        Case::whole(
            "gzip that just fits",
            "a.ply.gz",
            gzip(&[(&ply("binary_little_endian", 440 * MIB / 12, ""), 1), (&piece, 440)]),
        ),
        Case::whole("gzip of text", "a.xyz.gz", gzip(&[(&lines, 400)])),
        Case::whole("gzip without a name", "a.gz", gzip(&[(&piece, 1025)])),
        Case::whole(
            "TAR in gzip",
            "a.tgz",
            gzip(&[(&tar_header("a.ply", GIB), 1), (&cloud, 1), (&piece, 1025)]),
        ),
        Case::whole("ZIP", "a.zip", zip("a.ply", &[(&cloud, 1), (&piece, 1025)])),
        Case::whole("ZIP of text", "a.zip", zip("a.xyz", &[(&lines, 400)])),
        Case::whole(
            "NPZ",
            "a.npz",
            zip(
                "points.npy",
                &[(&npy("'|u1'", &format!("{}, 3", GIB / 3)), 1), (&piece, 1025)],
            ),
        ),
        Case::whole(
            "NPZ that just fits",
            "a.npz",
            zip(
                "points.npy",
                &[(&npy("'|u1'", &format!("{}, 3", 400 * MIB / 3)), 1), (&piece, 400)],
            ),
        ),
        Case::whole(
            "NPZ of other arrays",
            "a.npz",
            zip("other.npy", &[(&npy("'|u1'", &format!("{GIB},")), 1), (&piece, 1025)]),
        ),
        Case::whole("SPZ", "a.spz", gzip(&[(&spz, 1), (&piece, 1025)])),
        Case::whole(
            "SPZ that just fits",
            "a.spz",
            gzip(&[(&spz, 1), (&piece[..1000], 450_000)]),
        ),
        Case::whole("SPZ of streams", "a.spz", spz_of_streams(40_000_000)),
    ];
    // A directory with a false size for its member.
    let mut lie = zip("a.ply", &[(&cloud, 1), (&piece, 1025)]);
    let directory = lie.windows(4).rposition(|four| four == b"PK\x01\x02").unwrap();
    lie[directory + 24..directory + 28].copy_from_slice(&1000u32.to_le_bytes());
    bombs.push(Case::whole("ZIP, a lie", "a.zip", lie));
    bombs
}

fn spz_of_streams(count: u32) -> Vec<u8> {
    let mut bytes = spz_head(count);
    let streams: Vec<(Vec<u8>, u64)> = [9u64, 1, 3, 3, 4]
        .map(|width| {
            let whole = width * u64::from(count);
            let mut packed = zstd::Encoder::new(Vec::new(), 1).unwrap();
            std::io::copy(&mut std::io::Read::take(std::io::repeat(0), whole), &mut packed).unwrap();
            (packed.finish().unwrap(), whole)
        })
        .into();
    for (packed, whole) in &streams {
        bytes.extend((packed.len() as u64).to_le_bytes());
        bytes.extend(whole.to_le_bytes());
    }
    bytes.extend(streams.iter().flat_map(|(packed, _)| packed));
    bytes
}

fn claims() -> Vec<Case> {
    let laz = made_by_program("laz");
    let mut laz_that_lies = laz.clone();
    laz_that_lies[107..111].copy_from_slice(&u32::MAX.to_le_bytes());
    laz_that_lies[247..255].copy_from_slice(&(1u64 << 32).to_le_bytes());
    let lists = ply("binary_little_endian", 1, "property list uint float l\n");
    let faces = "element face 1\nproperty list uint uint vertex_indices\n";
    let many = |bytes: Vec<u8>| [bytes, vec![0; 12], u32::MAX.to_le_bytes().to_vec(), vec![0; 40]].concat();
    vec![
        Case::whole("PLY, a list of everything", "a.ply", many(lists)),
        Case::whole(
            "PLY, a face of everything",
            "a.ply",
            many(ply("binary_little_endian", 1, faces)),
        ),
        Case::whole(
            "PLY, points of nothing",
            "a.ply",
            ply("binary_little_endian", 1 << 40, ""),
        ),
        Case::whole(
            "PCD, compressed",
            "a.pcd",
            [
                pcd(u64::from(u32::MAX) / 12, "binary_compressed"),
                vec![0, 1, 0, 0, 0xfc, 0xff, 0xff, 0xff],
                vec![0xff; 256],
            ]
            .concat(),
        ),
        Case::whole("LAS", "a.las", las(1 << 40, false, &[])),
        Case::whole("LAZ", "a.laz", laz_that_lies),
        Case::whole(
            "LAZ, chunks of everything",
            "a.laz",
            [
                las(1 << 24, true, &[("laszip encoded", 22204, laszip(u32::MAX - 1))]),
                vec![0xff; 100_000],
            ]
            .concat(),
        ),
        Case::whole("E57", "a.e57", e57(10, "1099511627776")),
        Case::whole("E57 that just fits", "a.e57", e57(10, "17000000")),
        Case::whole("Draco", "a.drc", draco(Some(i32::MAX as u32))),
        Case::whole("Draco that just fits", "a.drc", draco(Some(8_000_000))),
    ]
}

fn models() -> Vec<Case> {
    let point = accessor(1, "VEC3", 5126, ", \"bufferView\": 0");
    let zeros = |count: u64| accessor(count, "VEC3", 5126, "");
    let sparse = ", \"sparse\": {\"count\": 1, \"indices\": {\"bufferView\": 0, \"componentType\": 5125}, \"values\": \
                  {\"bufferView\": 0}}";
    let polygon = |corners: u64| {
        [
            b"v 0 0 0\nv 1 0 0\nv 1 1 0\nf".to_vec(),
            text_line(" 1 2 3", corners * 2),
        ]
        .concat()
    };
    vec![
        Case::whole(
            "glTF, points without a buffer",
            "a.gltf",
            gltf(0, None, &zeros(1 << 31)),
        ),
        Case::whole(
            "glTF, points that just fit",
            "a.gltf",
            gltf(0, None, &zeros(40_000_000)),
        ),
        Case::whole(
            "glTF, triangles that just fit",
            "a.gltf",
            gltf(4, None, &zeros(40_000_000)),
        ),
        Case::whole(
            "glTF, sparse points",
            "a.gltf",
            gltf(0, None, &accessor(1 << 31, "VEC3", 5126, sparse)),
        ),
        Case::whole(
            "glTF, indices without a buffer",
            "a.gltf",
            gltf(
                4,
                Some(1),
                &format!("{point}, {}", accessor(1 << 31, "SCALAR", 5125, "")),
            ),
        ),
        Case::whole(
            "glTF, indices that just fit",
            "a.gltf",
            gltf(
                5,
                Some(1),
                &format!("{point}, {}", accessor(120_000_000, "SCALAR", 5125, "")),
            ),
        ),
        Case::whole("OBJ, a polygon of millions", "a.obj", polygon(10_000_000)).with_limit(64 * MIB),
    ]
}

/// A point cloud of three coordinates of a byte each, in a message of about `bytes`.
pub(super) fn cloud_message(name: &'static str, bytes: u64) -> Case {
    let points = (bytes / 3 - 1000) as u32;
    let mut cdr = vec![0, 1, 0, 0];
    let align = |cdr: &mut Vec<u8>| cdr.resize((cdr.len() - 4).next_multiple_of(4) + 4, 0);
    let text = |cdr: &mut Vec<u8>, text: &str| {
        align(cdr);
        cdr.extend((text.len() as u32 + 1).to_le_bytes());
        cdr.extend(text.as_bytes());
        cdr.push(0);
    };
    let number = |cdr: &mut Vec<u8>, number: u32| {
        align(cdr);
        cdr.extend(number.to_le_bytes());
    };
    number(&mut cdr, 1);
    number(&mut cdr, 0);
    text(&mut cdr, "map");
    number(&mut cdr, 1);
    number(&mut cdr, points);
    number(&mut cdr, 3);
    for (offset, name) in ["x", "y", "z"].into_iter().enumerate() {
        text(&mut cdr, name);
        number(&mut cdr, offset as u32);
        // An unsigned byte.
        cdr.push(2);
        number(&mut cdr, 1);
    }
    cdr.push(0);
    number(&mut cdr, 3);
    number(&mut cdr, 3 * points);
    number(&mut cdr, 3 * points);
    let data = u64::from(3 * points) + 1;
    let mut file = mcap(&mcap_topic(1, "/points", "sensor_msgs/msg/PointCloud2"));
    file.push(5);
    file.extend((22 + cdr.len() as u64 + data).to_le_bytes());
    file.extend([1, 0]);
    file.extend([0; 20]);
    file.extend(cdr);
    let length = file.len() as u64 + data;
    Case::whole(name, "a.mcap", file).with_length(length)
}

fn recordings() -> Vec<Case> {
    let topic = mcap_topic(1, "/points", "sensor_msgs/msg/PointCloud2");
    let with_chunk = |compression: &str, claim: u64, packed: &[u8]| {
        let chunk = mcap_chunk(compression, claim, packed);
        mcap(&[topic.as_slice(), &[chunk]].concat())
    };
    let zstd = |bytes: u64| {
        let mut packed = zstd::Encoder::new(Vec::new(), 1).unwrap();
        std::io::copy(&mut std::io::Read::take(std::io::repeat(0), bytes), &mut packed).unwrap();
        packed.finish().unwrap()
    };
    let mut lz4 = lz4_flex::frame::FrameEncoder::new(Vec::new());
    let mut bzip2 = bzip2::write::BzEncoder::new(Vec::new(), bzip2::Compression::fast());
    let piece = vec![0; 1 << 20];
    for _ in 0..1024 {
        lz4.write_all(&piece).unwrap();
    }
    for _ in 0..64 {
        bzip2.write_all(&piece).unwrap();
    }
    let (lz4, bzip2) = (lz4.finish().unwrap(), bzip2.finish().unwrap());
    vec![
        Case::whole("MCAP, zstd", "a.mcap", with_chunk("zstd", GIB, &zstd(GIB))),
        Case::whole(
            "MCAP, zstd that lies",
            "a.mcap",
            with_chunk("zstd", 400 * MIB, &zstd(GIB)),
        ),
        Case::whole(
            "MCAP, zstd that just fits",
            "a.mcap",
            with_chunk("zstd", 400 * MIB, &zstd(400 * MIB)),
        ),
        Case::whole("MCAP, lz4", "a.mcap", with_chunk("lz4", GIB, &lz4)),
        Case::whole("MCAP, a chunk of nothing", "a.mcap", with_chunk("", u64::MAX, &[])),
        Case::whole("bag, lz4", "a.bag", bag("lz4", 1 << 30, &lz4)),
        Case::whole("bag, bzip2", "a.bag", bag("bz2", u32::MAX, &bzip2)),
        cloud_message("MCAP, a cloud of bytes", 400 * MIB),
    ]
}

/// Images of a folder as TUM has them.
fn depth_folder(name: &'static str, depth: (&'static str, Vec<u8>), list: &str) -> Case {
    let mut case = Case::whole(name, "rgbd/depth.txt", list.as_bytes().to_vec());
    let file = |name: &'static str, bytes: Vec<u8>| super::TestFile {
        name,
        bytes,
        length: None,
    };
    case.files.push(file(depth.0, depth.1));
    case.files.push(file("rgbd/rgb.txt", b"# color images\n".to_vec()));
    case.folder = Some("rgbd");
    case
}

fn pictures() -> Vec<Case> {
    let list = "# depth maps\n# timestamp filename\n0.1 depth/0.1.png\n";
    let rows = zlib_of_zeros(600 * MIB);
    vec![
        depth_folder(
            "depth as PNG",
            ("rgbd/depth/0.1.png", png([30_000, 10_000], 16, 0, &rows)),
            list,
        ),
        depth_folder(
            "depth as PNG that just fits",
            ("rgbd/depth/0.1.png", png([20_000, 10_000], 16, 0, &rows)),
            list,
        ),
        depth_folder(
            "colours as PNG of 16 bits",
            ("rgbd/depth/0.1.png", png([8_000, 8_000], 16, 6, &rows)),
            list,
        ),
        super::bombs::compressed_depth("depth as RVL", [32_768, 8_000]),
        super::bombs::compressed_depth("depth as RVL that just fits", [20_000, 12_000]),
    ]
}

/// A recording with one image of few bytes, and its camera.
pub(super) fn compressed_depth(name: &'static str, size_px: [u32; 2]) -> Case {
    let mut image = Cdr::default();
    image.header().text("16UC1; compressedDepth rvl");
    let mut data = vec![0; 12];
    data.extend(size_px.into_iter().flat_map(u32::to_le_bytes));
    data.extend(run_of_holes(size_px[0] * size_px[1]));
    image.number(data.len() as u32);
    image.bytes.extend(data);
    let mut camera = Cdr::default();
    camera
        .header()
        .number(size_px[1])
        .number(size_px[0])
        .text("plumb_bob")
        .number(0);
    for number in [500.0, 0.0, 320.0, 0.0, 500.0, 240.0, 0.0, 0.0, 1.0] {
        camera.float(number);
    }
    for number in [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0] {
        camera.float(number);
    }
    for number in [500.0, 0.0, 320.0, 0.0, 0.0, 500.0, 240.0, 0.0, 0.0, 0.0, 1.0, 0.0] {
        camera.float(number);
    }
    camera.number(0).number(0).number(0).number(0).number(0).number(0);
    camera.bytes.push(0);
    let message = |channel: u16, body: Vec<u8>| {
        let mut message = channel.to_le_bytes().to_vec();
        message.extend([0; 20]);
        message.extend(body);
        (5, message)
    };
    let mut records = Vec::new();
    records.extend(mcap_topic(
        1,
        "/camera/depth/image_raw/compressedDepth",
        "sensor_msgs/msg/CompressedImage",
    ));
    records.extend(mcap_topic(2, "/camera/depth/camera_info", "sensor_msgs/msg/CameraInfo"));
    records.push(message(2, camera.bytes));
    records.push(message(1, image.bytes));
    Case::whole(name, "a.mcap", mcap(&records))
}

/// A message of ROS 2.
struct Cdr {
    bytes: Vec<u8>,
}

impl Default for Cdr {
    fn default() -> Self {
        Self {
            bytes: vec![0, 1, 0, 0],
        }
    }
}

impl Cdr {
    fn align(&mut self, to: usize) {
        self.bytes.resize((self.bytes.len() - 4).next_multiple_of(to) + 4, 0);
    }

    fn number(&mut self, number: u32) -> &mut Self {
        self.align(4);
        self.bytes.extend(number.to_le_bytes());
        self
    }

    fn float(&mut self, number: f64) {
        self.align(8);
        self.bytes.extend(number.to_le_bytes());
    }

    fn text(&mut self, text: &str) -> &mut Self {
        self.number(text.len() as u32 + 1);
        self.bytes.extend(text.as_bytes());
        self.bytes.push(0);
        self
    }

    fn header(&mut self) -> &mut Self {
        self.number(1).number(0).text("camera")
    }
}

/// This many holes in RVL: nibbles of three bits, the lowest first, and a run of no depths.
fn run_of_holes(mut count: u32) -> Vec<u8> {
    let mut nibbles = Vec::new();
    loop {
        let more = u32::from(count > 7) << 3;
        nibbles.push(count & 7 | more);
        count >>= 3;
        if more == 0 {
            break;
        }
    }
    nibbles.push(0);
    nibbles.resize(nibbles.len().next_multiple_of(8), 0);
    let words = nibbles
        .chunks(8)
        .map(|eight| eight.iter().fold(0, |word, nibble| word << 4 | nibble));
    words.flat_map(u32::to_le_bytes).collect()
}
