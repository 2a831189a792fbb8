//! Files and folders that are not read: messages name them, the programs that write them, and converters.

use crate::data::shared;
use pointreel::io::{self, ReadOptions};
use pointreel::sequence::{OpenOptions, Sequence};
use std::io::Write as _;
use std::path::Path;

fn refusal(path: &Path) -> String {
    io::read(path).unwrap_err().to_string()
}

fn folder_refusal(path: &Path) -> String {
    let opened = Sequence::open(&[path.to_owned()], &OpenOptions::default());
    opened.err().unwrap().to_string()
}

fn expect(message: &str, words: &[&str]) {
    for words in words {
        assert!(message.contains(words), "`{words}` is not in: {message}");
    }
}

#[test]
fn files_of_bug_reports_are_recognised() {
    for (name, words) in [
        ("S03_scene.sog", &["SOG", "SuperSplat", "splat-transform"][..]),
        ("S03_a.splatv", &["SPLATV", "splaTV", "PLY"]),
        ("V05_mid40.lvx", &["LVX", "Livox Viewer", "livox_ros_driver"]),
        ("N04_pickled_dict.npy", &["pickled Python objects", "numpy.savez"]),
        ("B03_zstd_file/B03_zstd_file.db3.zstd", &["ROS 2 bag", "zstd -d"]),
    ] {
        if let Some(path) = shared(&format!("meaning/{name}")) {
            expect(&refusal(&path), words);
        }
    }
    if let Some(path) = shared("meaning/B03_zstd_file") {
        let message = folder_refusal(&path);
        expect(&message, &["B03_zstd_file.db3.zstd is a ROS 2 bag", "zstd -d"]);
        assert!(!message.contains("no point cloud is in the folder"), "{message}");
    }
}

#[test]
fn content_overrides_the_extension() {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes, words) in [
        (
            "a.bin",
            &b"CCB2\x00\x00\x00\x00\x01\x02\x03\x04\x05\x06\x07\x08"[..],
            "CloudCompare",
        ),
        ("a.las", b"~Version information\n VERS. 2.0:\n", "well log"),
        ("a.ply", b"<!DOCTYPE html><html></html>", "web page"),
        (
            "a.laz",
            b"version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 1\n",
            "git lfs pull",
        ),
        (
            "a.txt",
            b"HEADER    HYDROLASE\nATOM      1  N   MET\n",
            "Protein Data Bank",
        ),
        ("a.csv", b"PAR1\x15\x04\x15", "Parquet"),
        ("a.xyz", b"\x89HDF\r\n\x1a\n", "HDF5"),
        ("empty.pcap", b"", "is empty (0 bytes)"),
        ("empty.ply", b"", "is empty (0 bytes)"),
        ("a.e57", b"\x89PNG\r\n\x1a\n", "an image"),
    ] {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        expect(&refusal(&path), &[words]);
    }
}

/// A ZIP archive of files without content.
fn zip(path: &Path, names: &[&str]) {
    let mut writer = zip::ZipWriter::new(std::fs::File::create(path).unwrap());
    for name in names {
        writer
            .start_file(*name, zip::write::SimpleFileOptions::default())
            .unwrap();
        writer.write_all(b"text").unwrap();
    }
    writer.finish().unwrap();
}

#[test]
fn archives_are_recognised_by_their_files() {
    let folder = tempfile::tempdir().unwrap();
    for (name, members, words) in [
        ("a.sog", &["meta.json", "means_l.webp"][..], "SOG"),
        ("a.usdz", &["scene.usdc"], "USD"),
        ("a.pt", &["archive/data.pkl", "archive/version"], "PyTorch"),
        ("a.xlsx", &["[Content_Types].xml", "xl/workbook.xml"], "Excel"),
        ("a.kmz", &["doc.kml"], "KML"),
        (
            "scans.zip",
            &["a.fls", "b.fls"],
            "its 2 files are a.fls, b.fls; a.fls is a FARO scan",
        ),
        (
            "other.zip",
            &["a.q", "b.q"],
            "its 2 files are a.q, b.q; expected files of a format that is read",
        ),
        ("none.zip", &[], "no file is in it"),
    ] {
        let path = folder.path().join(name);
        zip(&path, members);
        expect(&refusal(&path), &[words]);
    }
}

#[test]
fn folders_are_recognised_by_their_files() {
    for (names, words) in [
        (&["metadata.json", "octree.bin", "hierarchy.bin"][..], &["Potree 2"][..]),
        (&["cloud.js", "sources.json"], &["Potree 1"]),
        (&["ept.json"], &["Entwine", "pdal"]),
        (&["tileset.json", "0.glb"], &["tileset"]),
        (&["scene.lcc", "data.bin", "index.bin"], &["LCC"]),
        (
            &["a.fls", "b.fls", "c.fls"],
            &["a.fls, as 2 others, is a FARO scan", "SCENE"],
        ),
        (&["scan.rcp", "photo.png"], &["ReCap"]),
        (&["a.png", "b.png"], &["images without camera poses", "COLMAP"]),
    ] {
        let folder = tempfile::tempdir().unwrap();
        for name in names {
            std::fs::write(folder.path().join(name), b"\x01\x02\x03\x04").unwrap();
        }
        expect(&folder_refusal(folder.path()), words);
    }
}

#[test]
fn folders_of_frames_next_to_other_files_open() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["tileset.json", "cloud.js", "a.rcp"] {
        std::fs::write(folder.path().join(name), b"{}").unwrap();
    }
    std::fs::write(folder.path().join("1.xyz"), b"0 0 0\n1 1 1\n").unwrap();
    let sequence = Sequence::open(&[folder.path().to_owned()], &OpenOptions::default()).unwrap();
    assert_eq!(sequence.len(), 1);
}

#[test]
fn readable_corpus_files_are_not_rejected_by_name() {
    let Some(root) = shared("corpus") else {
        return;
    };
    let mut folders = vec![root];
    let mut count = 0;
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap().flatten() {
            let path = entry.path();
            if path.is_dir() {
                folders.push(path);
            } else if entry.metadata().is_ok_and(|metadata| metadata.len() < 1 << 20)
                && io::supported_extensions().any(|known| path.extension().is_some_and(|found| found == known))
            {
                let listed = io::list(&path, &ReadOptions::default());
                let is_foreign = matches!(listed, Err(io::IoError::Foreign { .. }))
                    || matches!(io::read(&path), Err(io::IoError::Foreign { .. }));
                assert!(!is_foreign, "{}: {}", path.display(), refusal(&path));
                count += 1;
            }
        }
    }
    assert!(count > 0);
}
