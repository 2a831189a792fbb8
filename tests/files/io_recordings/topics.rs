//! Recordings with several topics of point clouds: the one that is read, and the user's choice.

use super::{Kind, bag, db3, folder, mcap};
use pointreel::io::{self, ReadOptions, Topic};
use pointreel::sequence::{OpenOptions, Sequence, SequenceError};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// The same recording in each container.
fn recordings(folder: &Path) -> [PathBuf; 3] {
    let paths = ["a.mcap", "a.bag", "a.db3"].map(|name| folder.join(name));
    std::fs::write(&paths[0], mcap(Kind::CdrLittle, mcap::WriteOptions::new())).unwrap();
    std::fs::write(&paths[1], bag("none", <[u8]>::to_vec, true)).unwrap();
    db3(&paths[2], Kind::CdrBig, <[u8]>::to_vec);
    paths
}

fn topics(read: &str) -> Vec<Topic> {
    [("/other", 2), ("/points", 3)]
        .map(|(name, cloud_count)| Topic {
            name: name.to_owned(),
            cloud_count,
            is_read: name == read,
        })
        .to_vec()
}

fn open(paths: &[PathBuf], topic: Option<&str>) -> Result<Sequence, SequenceError> {
    let options = OpenOptions {
        topic: topic.map(Into::into),
        ..OpenOptions::default()
    };
    Sequence::open(paths, &options)
}

#[test]
fn the_named_topic_is_read() {
    let folder = folder();
    let options = ReadOptions::default();
    for path in recordings(folder.path()) {
        let max = io::contents(&path, None, &options).unwrap();
        assert_eq!(max.topics, topics("/points"), "{}", path.display());
        assert_eq!(max, io::contents(&path, Some("/points"), &options).unwrap());

        let other = io::contents(&path, Some("/other"), &options).unwrap();
        assert_eq!(other.topics, topics("/other"));
        let times: Vec<_> = other
            .entries
            .iter()
            .map(|entry| entry.time.unwrap().as_secs())
            .collect();
        assert_eq!(times, [11, 12], "{}", path.display());
        let cloud = io::read_part(&path, &other.entries[0].part, &options).unwrap();
        super::check(&cloud, 0.0);

        let none = io::contents(&path, Some("/talk"), &options).unwrap();
        assert!(none.entries.is_empty(), "no clouds are on /talk");
        assert_eq!(none.topics, topics("nothing"));
    }
}

#[test]
fn a_sequence_has_one_topic() {
    let folder = folder();
    let [first, second, _] = recordings(folder.path());
    let sequence = open(std::slice::from_ref(&first), Some("/other")).unwrap();
    assert_eq!(sequence.len(), 2);
    assert_eq!(sequence.source().topics(), topics("/other"));
    assert_eq!(sequence.source().inputs(), std::slice::from_ref(&first));
    assert_eq!(open(std::slice::from_ref(&first), None).unwrap().len(), 3);

    // A recording in several files: their topics are combined.
    let both = open(&[first.clone(), second], Some("/other")).unwrap();
    assert_eq!(both.len(), 4);
    let counts: Vec<usize> = both.source().topics().iter().map(|topic| topic.cloud_count).collect();
    assert_eq!(counts, [4, 6]);

    for wrong in ["/talk", "points", ""] {
        let error = open(std::slice::from_ref(&first), Some(wrong)).unwrap_err().to_string();
        assert!(error.contains("/other (2), /points (3)"), "{error}");
    }
    let cloud = folder.path().join("a.xyz");
    std::fs::write(&cloud, "1 2 3\n").unwrap();
    let error = open(&[cloud], Some("/points")).unwrap_err().to_string();
    assert!(error.contains("no input is a recording"), "{error}");
}

/// A recording without a cloud is a frame that reports it, not a sequence of none.
#[test]
fn a_recording_without_clouds_is_reported() {
    let folder = folder();
    let path = folder.path().join("a.mcap");
    let mut file = std::io::Cursor::new(Vec::new());
    mcap::WriteOptions::new().create(&mut file).unwrap().finish().unwrap();
    std::fs::write(&path, file.into_inner()).unwrap();
    let sequence = open(&[path], None).unwrap();
    assert_eq!(sequence.len(), 1);
    let error = sequence.decode(0).unwrap_err().to_string();
    assert!(error.contains("holds no point cloud"), "{error}");
}

fn pointreel(arguments: &[&str]) -> Output {
    let program = env!("CARGO_BIN_EXE_pointreel");
    Command::new(program).args(arguments).output().unwrap()
}

#[test]
fn commands_take_a_topic() {
    let folder = folder();
    let [path, ..] = recordings(folder.path());
    let path = path.to_str().unwrap();
    let info = pointreel(&["info", path, "--topic", "/other", "--json"]);
    let info: serde_json::Value = serde_json::from_slice(&info.stdout).unwrap();
    assert_eq!(info["frames"].as_array().unwrap().len(), 2);
    let expected = serde_json::json!([
        {"name": "/other", "clouds": 2, "read": true},
        {"name": "/points", "clouds": 3, "read": false},
    ]);
    assert_eq!(info["recordings"][0]["topics"], expected);

    let info = pointreel(&["info", path]);
    let table = String::from_utf8_lossy(&info.stdout).into_owned();
    assert!(
        table.contains("topics /other (2 clouds), /points (3 clouds, read)"),
        "{table}"
    );
    let warning = String::from_utf8_lossy(&info.stderr).into_owned();
    assert!(warning.contains("--topic: /other"), "{warning}");

    let unknown = pointreel(&["info", path, "--topic", "/lidar"]);
    assert_eq!(unknown.status.code(), Some(1));
    let error = String::from_utf8_lossy(&unknown.stderr).into_owned();
    assert!(error.contains("name one of /other (2), /points (3)"), "{error}");

    // Frames of two topics are not mixed in one folder.
    let output = folder.path().join("frames");
    let output = output.to_str().unwrap();
    assert!(pointreel(&["convert", path, output]).status.success());
    let mixed = pointreel(&["convert", path, output, "--topic", "/other"]);
    assert_eq!(mixed.status.code(), Some(1));
    let error = String::from_utf8_lossy(&mixed.stderr).into_owned();
    assert!(error.contains("topic /points there, topic /other now"), "{error}");
}
