//! A file of three gigabytes for each format: a valid head that claims as much as it can, and zeros.

use super::Case;
use super::bombs::made_by_program;
use super::heads::{
    bag, gltf, las, laszip, mcap, mcap_topic, npy, pcap, pcapng, pcd, ply, png, tar_header, zip, zlib_of_zeros,
};
use pointreel::wire::StreamHead;

/// Points that no file has.
const CLAIM: u64 = 1 << 40;

/// Points of 12 bytes that fit a sparse file.
const POINTS: u64 = (3 << 30) / 12 - 100;

pub(super) fn cases() -> Vec<Case> {
    let all = [clouds(), meshes(), arrays(), text(), containers(), others()];
    all.into_iter().flatten().collect()
}

fn clouds() -> Vec<Case> {
    let copc = las(POINTS, false, &[("copc", 1, vec![0; 160])]);
    let mut copc_of_laz = las(
        1 << 20,
        true,
        &[("copc", 1, vec![0; 160]), ("laszip encoded", 22204, laszip(50_000))],
    );
    // A page of the hierarchy at a distant offset.
    let info = 375 + 54;
    copc_of_laz[info + 40..info + 48].copy_from_slice(&(1u64 << 31).to_le_bytes());
    copc_of_laz[info + 48..info + 56].copy_from_slice(&(1u64 << 30).to_le_bytes());
    vec![
        Case::sparse("PLY, binary", "a.ply", ply("binary_little_endian", POINTS, "")),
        Case::sparse("PLY, a claim", "a.ply", ply("binary_little_endian", CLAIM, "")),
        Case::sparse("PLY, text", "a.ply", ply("ascii", CLAIM, "")),
        Case::sparse(
            "PLY, lists",
            "a.ply",
            ply("binary_little_endian", 1 << 30, "property list int float l\n"),
        ),
        Case::sparse("PCD, binary", "a.pcd", pcd(POINTS, "binary")),
        Case::sparse("PCD, text", "a.pcd", pcd(POINTS, "ascii")),
        Case::sparse(
            "PCD, compressed",
            "a.pcd",
            [pcd(POINTS, "binary_compressed"), vec![0xff; 8]].concat(),
        ),
        Case::sparse("LAS", "a.las", las(POINTS / 2, false, &[])),
        Case::sparse("LAS, a claim", "a.las", las(CLAIM, false, &[])),
        Case::sparse("LAS without a count", "a.las", las(0, false, &[])),
        Case::sparse(
            "LAZ",
            "a.laz",
            las(CLAIM, true, &[("laszip encoded", 22204, laszip(50_000))]),
        ),
        Case::sparse("COPC", "a.copc.laz", copc),
        Case::sparse("COPC, a far page", "a.copc.laz", copc_of_laz),
        Case::sparse("E57", "a.e57", super::bombs::e57(1, "1")),
        Case::sparse("Draco", "a.drc", super::bombs::draco(None)),
        Case::sparse("SPLAT", "a.splat", Vec::new()),
        Case::sparse("SPZ", "a.spz", super::bombs::spz_head(u32::MAX)),
        Case::sparse("bin of floats", "a.bin", vec![0, 0, 0x80, 0x3f]),
    ]
}

fn meshes() -> Vec<Case> {
    let triangles = ((3u64 << 30) - 84) / 50;
    let stl = [vec![0; 80], (triangles as u32).to_le_bytes().to_vec()].concat();
    let glb = [
        b"glTF\x02\0\0\0".as_slice(),
        &u32::MAX.to_le_bytes(),
        &(1u32 << 31).to_le_bytes(),
        b"JSON{",
    ]
    .concat();
    vec![
        Case::sparse("OBJ", "a.obj", b"v 0 0 0\nv 1 0 0\n".to_vec()),
        Case::sparse("OFF", "a.off", b"OFF\n1000000000 1000000000 0\n".to_vec()),
        Case::sparse("STL", "a.stl", stl),
        Case::sparse(
            "STL, text",
            "a.stl",
            b"solid a\nfacet normal 0 0 1\nouter loop\n".to_vec(),
        ),
        Case::sparse("glTF", "a.gltf", gltf(0, None, "")),
        Case::sparse("GLB", "a.glb", glb),
    ]
}

fn arrays() -> Vec<Case> {
    let frames = format!("{}, 100, 3", POINTS / 100);
    vec![
        Case::sparse("NPY", "a.npy", npy("'<f4'", &format!("{POINTS}, 3"))),
        Case::sparse("NPY of frames", "a.npy", npy("'<f4'", &frames)),
        Case::sparse("NPY, a claim", "a.npy", npy("'<f4'", &format!("{CLAIM}, 3"))),
        Case::sparse(
            "NPY of records",
            "a.npy",
            npy("[('x', '<f4'), ('y', '<f4'), ('z', '<f4')]", &format!("{POINTS},")),
        ),
        Case::sparse(
            "NPZ",
            "a.npz",
            zip("points.npy", &[(&npy("'<f4'", "2, 3"), 1), (&[0; 24], 1)]),
        ),
    ]
}

fn text() -> Vec<Case> {
    let ptx = "100000\n1000\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n0 0 0 0.5\n";
    vec![
        Case::sparse("text", "a.xyz", b"0 0 0\n1 1 1\n".to_vec()),
        Case::sparse("CSV", "a.csv", b"x,y,z\n0,0,0\n1,1,1\n".to_vec()),
        Case::sparse("text of frames", "a.csv", b"frame,x,y,z\n0,0,0,0\n1,1,1,1\n".to_vec()),
        Case::sparse("a line without an end", "a.txt", b"1 2 3".to_vec()),
        Case::sparse("PTX", "a.ptx", ptx.as_bytes().to_vec()),
        Case::sparse(
            "ESRI grid",
            "a.asc",
            b"ncols 30000\nnrows 30000\nxllcorner 0\nyllcorner 0\ncellsize 1\n".to_vec(),
        ),
        Case::sparse("Surfer grid", "a.grd", b"DSAA\n30000 30000\n0 1\n0 1\n0 1\n".to_vec()),
    ]
}

fn containers() -> Vec<Case> {
    let topic = mcap_topic(1, "/points", "sensor_msgs/msg/PointCloud2");
    let mut message = vec![1, 0];
    message.extend([0; 20]);
    let mut one_message = mcap(&topic);
    one_message.push(5);
    one_message.extend(((3u64 << 30) - one_message.len() as u64 - 8).to_le_bytes());
    one_message.extend(message);
    vec![
        Case::sparse("MCAP", "a.mcap", mcap(&topic)),
        Case::sparse("MCAP, one message", "a.mcap", one_message),
        Case::sparse("bag", "a.bag", b"#ROSBAG V2.0\n".to_vec()),
        Case::sparse("bag, a chunk", "a.bag", bag("none", u32::MAX, &[])),
        Case::sparse(
            "ROS 2 bag",
            "a.db3",
            b"SQLite format 3\0\x10\0\x01\x01\0\x40\x20\x20".to_vec(),
        ),
        Case::sparse("pcap", "a.pcap", pcap()),
        Case::sparse("pcapng", "a.pcapng", pcapng()),
        Case::sparse(
            "ZIP",
            "a.zip",
            zip("a.ply", &[(&ply("ascii", 1, ""), 1), (b"0 0 0\n", 1)]),
        ),
        Case::sparse("TAR", "a.tar", tar_header("a.ply", (3 << 30) - 1024)),
        Case::sparse("TAR, a claim", "a.tar", tar_header("a.ply", (8 << 30) - 1)),
        Case::sparse("gzip", "a.ply.gz", vec![0x1f, 0x8b, 8, 0, 0, 0, 0, 0, 0, 3]),
        Case::sparse(
            "Matroska",
            "a.mkv",
            vec![0x1a, 0x45, 0xdf, 0xa3, 0x01, 0, 0, 0, 0x80, 0, 0, 0],
        ),
    ]
}

fn others() -> Vec<Case> {
    let stream = StreamHead {
        session: 1,
        clock_ns: 0,
        fps: 10.0,
        wall_ns: 0,
    };
    let depth = png([30_000, 30_000], 16, 0, &zlib_of_zeros(1 << 20));
    vec![
        Case::sparse("sequence file", "a.reel", made_by_program("reel")),
        Case::sparse("recorded stream", "a.pointreel-stream", stream.encode()),
        Case::sparse(
            "session",
            "a.pointreel",
            b"{\"format\": \"pointreel session\", \"version\": 1, ".to_vec(),
        ),
        Case::sparse("a picture", "a.png", depth),
        Case::sparse("zeros", "a.dat", Vec::new()),
    ]
}

#[test]
fn walks_over_a_terabyte_of_zeros_end_at_the_first_zero() {
    let lengthened = |case: Case| case.with_length(1 << 40);
    let walked = containers().into_iter().chain(others()).chain(text()).map(lengthened);
    super::check(walked.collect());
}
