//! Archives written here: listing, reading, and refusals.

use pointreel::io::{self, ReadOptions};
use std::io::{Cursor, Write as _};
use std::path::Path;
use std::time::{Duration, Instant};
use zip::CompressionMethod;
use zip::write::SimpleFileOptions;

/// Contents of every archive: files that are not frames, and clouds of 2, 1 and 3 points, out of order.
const FILES: [(&str, &str); 8] = [
    ("run/frame_10.xyz", "1 2 3\n4 5 6\n7 8 9\n"),
    ("run/frame_2.XYZ", "1 2 3\n"),
    ("../../frame_1.xyz", "1 2 3\n4 5 6\n"),
    ("run/.hidden.xyz", "1 2 3\n"),
    ("__MACOSX/run/frame_2.xyz", "\0\0"),
    ("run/inner.zip", "PK"),
    ("run/notes.md", "# notes"),
    ("run/raw.bag", "#ROSBAG V2.0\n"),
];

fn zipped(files: &[(&str, &str)], method: CompressionMethod) -> Vec<u8> {
    let mut writer = zip::ZipWriter::new(Cursor::new(Vec::new()));
    let options = SimpleFileOptions::default().compression_method(method);
    writer.add_directory("run/", options).unwrap();
    for (index, (name, text)) in files.iter().enumerate() {
        writer.start_file(*name, options.large_file(index == 0)).unwrap();
        writer.write_all(text.as_bytes()).unwrap();
    }
    writer.finish().unwrap().into_inner()
}

fn tarred(files: &[(&str, &str)]) -> Vec<u8> {
    let mut writer = tar::Builder::new(Vec::new());
    for (name, text) in files {
        let mut header = tar::Header::new_gnu();
        // The crate's own setter refuses names that lead out of a folder.
        header.as_old_mut().name[..name.len()].copy_from_slice(name.as_bytes());
        header.set_size(text.len() as u64);
        header.set_mode(0o644);
        header.set_cksum();
        writer.append(&header, text.as_bytes()).unwrap();
    }
    writer.into_inner().unwrap()
}

fn gzipped(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

fn check(path: &Path) {
    let options = ReadOptions::default();
    let entries = io::list(path, &options).unwrap();
    let names: Vec<&str> = entries.iter().map(|entry| entry.name.as_str()).collect();
    assert_eq!(
        names,
        ["frame_1.xyz", "run/frame_2.XYZ", "run/frame_10.xyz"],
        "{}",
        path.display()
    );
    for (entry, points) in entries.iter().zip([2, 1, 3]) {
        let cloud = io::read_part(path, &entry.part, &options).unwrap();
        assert_eq!(cloud.positions.len(), points);
    }
    assert_eq!(io::read(path).unwrap().positions.len(), 2);
}

#[test]
fn archives_of_every_compression_list_their_frames() {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in [
        ("store.zip", zipped(&FILES, CompressionMethod::Stored)),
        ("deflate.zip", zipped(&FILES, CompressionMethod::Deflated)),
        ("zstd.zip", zipped(&FILES, CompressionMethod::Zstd)),
        ("plain.tar", tarred(&FILES)),
        ("packed.tar.gz", gzipped(&tarred(&FILES))),
        ("packed.tgz", gzipped(&tarred(&FILES))),
        // The first bytes take precedence over the name.
        ("zip.tar", zipped(&FILES, CompressionMethod::Deflated)),
    ] {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        check(&path);
    }
    assert_eq!(
        std::fs::read_dir(folder.path()).unwrap().count(),
        7,
        "something was unpacked to disk"
    );
    let path = folder.path().join("frame.xyz.gz");
    std::fs::write(&path, gzipped(b"1 2 3\n4 5 6\n")).unwrap();
    assert_eq!(io::read(&path).unwrap().positions.len(), 2);
    assert_eq!(io::list(&path, &ReadOptions::default()).unwrap().len(), 1);
}

#[test]
fn text_files_next_to_clouds_are_not_frames() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.zip");
    let ply = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float \
        z\nend_header\n1 2 3\n";
    let files = [("README.txt", "see the web"), ("a.ply", ply)];
    std::fs::write(&path, zipped(&files, CompressionMethod::Stored)).unwrap();
    let entries = io::list(&path, &ReadOptions::default()).unwrap();
    assert_eq!(entries.len(), 1);
    assert_eq!(entries[0].name, "a.ply");
}

#[test]
fn members_without_an_extension_are_recognised_by_their_first_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.zip");
    let ply = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float \
        z\nend_header\n1 2 3\n";
    let files = [("cloud", ply), ("Makefile", "all:")];
    for bytes in [zipped(&files, CompressionMethod::Deflated), gzipped(&tarred(&files))] {
        std::fs::write(&path, bytes).unwrap();
        let entries = io::list(&path, &ReadOptions::default()).unwrap();
        assert_eq!(entries.len(), 1);
        assert_eq!(entries[0].name, "cloud");
        assert_eq!(io::read(&path).unwrap().positions.len(), 1);
    }
}

#[test]
fn a_damaged_member_is_a_failing_frame() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.zip");
    let mut bytes = zipped(&[("a.xyz", "1 2 3\n"), ("b.xyz", "4 5 6\n")], CompressionMethod::Stored);
    let at = bytes.windows(5).position(|five| five == b"4 5 6").unwrap();
    bytes[at] = b'9';
    std::fs::write(&path, bytes).unwrap();
    let entries = io::list(&path, &ReadOptions::default()).unwrap();
    let read = |index: usize| io::read_part(&path, &entries[index].part, &ReadOptions::default());
    assert_eq!(read(0).unwrap().positions.len(), 1);
    let error = read(1).unwrap_err().to_string();
    assert!(error.contains("checksum") && error.contains("b.xyz"), "{error}");
}

#[test]
fn bombs_and_encrypted_members_are_rejected() {
    let folder = tempfile::tempdir().unwrap();
    let options = ReadOptions::default().with_max_memory(1 << 20);
    let zeros = vec![b'0'; 8 << 20];
    let text = std::str::from_utf8(&zeros).unwrap();
    for (name, bytes) in [
        ("a.zip", zipped(&[("a.xyz", text)], CompressionMethod::Deflated)),
        ("a.xyz.gz", gzipped(&zeros)),
        ("a.tgz", gzipped(&tarred(&[("a.xyz", text)]))),
    ] {
        assert!(bytes.len() < 1 << 16);
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        let error = io::list(&path, &options)
            .and_then(|entries| io::read_part(&path, &entries[0].part, &options))
            .unwrap_err()
            .to_string();
        assert!(error.contains("of memory"), "{name}: {error}");
    }
    // The claim is false: one byte is claimed, eight million are unpacked.
    let mut bytes = zipped(&[("a.xyz", text)], CompressionMethod::Deflated);
    let size = (8u32 << 20).to_le_bytes();
    while let Some(at) = bytes.windows(4).position(|four| four == size) {
        bytes[at..at + 4].copy_from_slice(&1u32.to_le_bytes());
    }
    let path = folder.path().join("lie.zip");
    std::fs::write(&path, bytes).unwrap();
    let error = io::read(&path).unwrap_err().to_string();
    assert!(
        error.contains("more than 1 bytes") || error.contains("not understood"),
        "{error}"
    );
    // The bit for encryption, in both headers.
    let mut bytes = zipped(&[("a.xyz", "1 2 3\n")], CompressionMethod::Stored);
    for (signature, flags) in [(b"PK\x03\x04", 6), (b"PK\x01\x02", 8)] {
        let starts: Vec<usize> = (0..bytes.len() - 4)
            .filter(|&at| &bytes[at..at + 4] == signature)
            .collect();
        for at in starts {
            bytes[at + flags] |= 1;
        }
    }
    let path = folder.path().join("secret.zip");
    std::fs::write(&path, bytes).unwrap();
    let error = io::read(&path).unwrap_err().to_string();
    assert!(error.contains("encrypted"), "{error}");
}

#[test]
fn damage_at_any_byte_is_handled() {
    let folder = tempfile::tempdir().unwrap();
    let files = &FILES[..3];
    for (name, bytes) in [
        ("a.zip", zipped(files, CompressionMethod::Deflated)),
        ("b.zip", zipped(files, CompressionMethod::Zstd)),
        ("a.tar", tarred(files)),
        ("a.tgz", gzipped(&tarred(files))),
    ] {
        let path = folder.path().join(name);
        let options = ReadOptions::default().with_max_memory(1 << 20);
        let answer = |bytes: &[u8]| {
            std::fs::write(&path, bytes).unwrap();
            for entry in io::list(&path, &options).unwrap_or_default() {
                let _ = io::read_part(&path, &entry.part, &options);
            }
        };
        for at in 0..bytes.len() {
            answer(&bytes[..at]);
            let mut bytes = bytes.clone();
            bytes[at] ^= 0xff;
            answer(&bytes);
        }
    }
}

#[test]
fn ten_thousand_members_are_listed_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let names: Vec<String> = (0..10_000).map(|index| format!("f{index}.xyz")).collect();
    let files: Vec<(&str, &str)> = names.iter().map(|name| (name.as_str(), "1 2 3\n")).collect();
    for (name, bytes) in [
        ("a.zip", zipped(&files, CompressionMethod::Stored)),
        ("a.tar", tarred(&files)),
    ] {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        let start = Instant::now();
        let entries = io::list(&path, &ReadOptions::default()).unwrap();
        assert!(
            start.elapsed() < Duration::from_secs(3),
            "{name}: {:?}",
            start.elapsed()
        );
        assert_eq!(entries.len(), 10_000);
        assert_eq!(entries[9_999].name, "f9999.xyz");
    }
}

#[test]
fn truncated_tar_archives_are_detected_at_any_byte() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scans.tar");
    let files: Vec<(String, &str)> = (0..4)
        .map(|index| (format!("f{index}.xyz"), "1 2 3\n4 5 6\n"))
        .collect();
    let files: Vec<(&str, &str)> = files.iter().map(|(name, text)| (name.as_str(), *text)).collect();
    let whole = tarred(&files);
    // Four headers and four contents of one block each, then the end mark.
    let mark = 8 * 512;
    for cut in (513..whole.len()).step_by(128).chain([mark - 1, mark, mark + 511]) {
        std::fs::write(&path, &whole[..cut]).unwrap();
        let damage = io::contents(&path, None, &ReadOptions::default()).map(|contents| contents.damage);
        let is_found = damage.as_ref().map_or(true, |damage| !damage.is_empty());
        assert_eq!(is_found, cut < mark + 512, "{cut} of {}: {damage:?}", whole.len());
    }
}
