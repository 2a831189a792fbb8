//! Progress of reading, and its end when it is no longer needed.

use e57::{E57Writer, Record, RecordValue};
use pointreel::cloud::{Positions, RawCloud};
use pointreel::io::{self, IoError, Part, ReadOptions, WriteFormat};
use pointreel::progress::Progress;
use std::fmt::Write as _;
use std::io::{Cursor, Write as _};
use std::path::{Path, PathBuf};

/// More than any reader takes at once.
const POINTS: usize = 120_000;

fn cloud() -> RawCloud {
    let place = |index: usize| [index as f32, (index % 97) as f32, 0.5];
    let mut cloud = RawCloud::from_positions(Positions::F32((0..POINTS).map(place).collect()));
    cloud.attributes.colors = Some(vec![[1, 2, 3, 255]; POINTS]);
    cloud
}

fn written(format: &str) -> Vec<u8> {
    let mut file = Cursor::new(Vec::new());
    let format: WriteFormat = format.parse().unwrap();
    io::write(&mut file, format, &cloud()).unwrap();
    file.into_inner()
}

fn e57() -> Vec<u8> {
    const COUNT: usize = 1000;
    let mut bytes = Cursor::new(Vec::new());
    let mut writer = E57Writer::new(&mut bytes, "file").unwrap();
    let prototype = vec![
        Record::CARTESIAN_X_F64,
        Record::CARTESIAN_Y_F64,
        Record::CARTESIAN_Z_F64,
    ];
    let mut scan = writer.add_pointcloud("scan", prototype).unwrap();
    for index in 0..COUNT {
        scan.add_point(vec![RecordValue::Double(index as f64); 3]).unwrap();
    }
    scan.finalize().unwrap();
    drop(scan);
    writer.finalize().unwrap();
    drop(writer);
    bytes.into_inner()
}

fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    packed.write_all(bytes).unwrap();
    packed.finish().unwrap()
}

/// One file for every method by which readers report progress.
fn files(folder: &Path) -> Vec<PathBuf> {
    let ascii_pcd = (0..POINTS).fold(
        format!(
            "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH {POINTS}\nHEIGHT 1\nPOINTS \
             {POINTS}\nDATA ascii\n"
        ),
        |mut text, index| {
            writeln!(text, "{index} 1 2").unwrap();
            text
        },
    );
    let obj = (0..POINTS).fold(String::new(), |mut text, index| {
        writeln!(text, "v {index} 1 2").unwrap();
        text
    });
    let xyz = written("xyz");
    let files = [
        ("rows.ply", written("ply")),
        ("rows.pcd", written("pcd")),
        ("text.ply", written("ply-ascii")),
        ("text.pcd", ascii_pcd.into_bytes()),
        ("chunks.laz", written("laz")),
        ("fields.e57", e57()),
        ("lines.obj", obj.into_bytes()),
        ("packed.xyz.gz", gzip(&xyz)),
        ("lines.xyz", xyz),
    ];
    let write = |(name, bytes): (&str, Vec<u8>)| {
        let path = folder.join(name);
        std::fs::write(&path, bytes).unwrap();
        path
    };
    files.into_iter().map(write).collect()
}

#[test]
fn progress_is_complete_at_the_end() {
    let folder = tempfile::tempdir().unwrap();
    for path in files(folder.path()) {
        let part = io::list(&path, &ReadOptions::default()).unwrap()[0].part.clone();
        let progress = Progress::default();
        assert!(!progress.has_begun());
        let cloud = io::read_part_observed(&path, &part, &ReadOptions::default(), &progress);
        assert_eq!(cloud.unwrap(), io::read(&path).unwrap(), "the same cloud");
        assert!(progress.has_begun());
        let (done, of) = (progress.done(), progress.of().unwrap());
        assert_eq!(done, of, "{}", path.display());
    }
}

#[test]
fn cancelled_reads_end_as_cancelled_and_decode_nothing() {
    let folder = tempfile::tempdir().unwrap();
    for path in files(folder.path()) {
        let part = io::list(&path, &ReadOptions::default()).unwrap()[0].part.clone();
        let progress = Progress::default();
        progress.cancel();
        let error = io::read_part_observed(&path, &part, &ReadOptions::default(), &progress);
        let error = error.unwrap_err();
        assert!(matches!(&error, IoError::Cancelled { path: of } if *of == path));
        assert!(error.to_string().contains("open it again"), "{error}");
        assert_eq!(progress.done(), 0, "{}", path.display());
        // A whole file can still be read when requested.
        assert!(io::read_part(&path, &Part::Whole, &ReadOptions::default()).is_ok());
    }
}
