//! Recordings that are cut at any byte: reading reports it, and `check` finds it.

use super::{Kind, TOPICS, bag, bare_header, db3, folder, mcap as mcap_of, record};
use pointreel::check::{FindingKind, Severity, check};
use pointreel::sequence::Sequence;
use std::fs;
use std::path::Path;

/// The result of `check`: that the file is damaged, or why it cannot be read; `None` where it finds neither.
fn found(path: &Path) -> Option<String> {
    let sequence = match Sequence::open(&[path.to_owned()], &pointreel::sequence::OpenOptions::default()) {
        Ok(sequence) => sequence,
        Err(error) => return Some(error.to_string()),
    };
    let findings = check(&sequence, &|_| {}).findings;
    let is_meant = |kind| matches!(kind, FindingKind::DamagedFile | FindingKind::UnreadableFrame);
    let finding = findings.into_iter().find(|finding| is_meant(finding.kind))?;
    assert_eq!(finding.severity, Severity::Error);
    Some(finding.message)
}

fn every_cut_is_found(name: &str, whole: &[u8]) {
    let folder = folder();
    let path = folder.path().join(name);
    fs::write(&path, whole).unwrap();
    assert_eq!(found(&path), None, "{name} is whole");
    let cuts = (0..whole.len())
        .step_by(61)
        .chain(whole.len().saturating_sub(40)..whole.len());
    for cut in cuts {
        fs::write(&path, &whole[..cut]).unwrap();
        let found = found(&path);
        assert!(
            found.is_some(),
            "{name}, cut at {cut} of {}, passes as whole",
            whole.len()
        );
    }
}

#[test]
fn truncated_mcap_files_are_detected() {
    for (name, options) in [
        ("chunks.mcap", mcap::WriteOptions::new().chunk_size(Some(300))),
        ("loose.mcap", mcap::WriteOptions::new().use_chunks(false)),
        (
            "bare.mcap",
            mcap::WriteOptions::new()
                .emit_summary_records(false)
                .emit_summary_offsets(false)
                .emit_message_indexes(false),
        ),
    ] {
        every_cut_is_found(name, &mcap_of(Kind::CdrLittle, options));
    }
}

/// A bag whose header says where its index is, as `rosbag` writes it when it closes one.
fn closed_bag() -> Vec<u8> {
    let open = bag("none", <[u8]>::to_vec, true);
    let header = |index_at: u64, chunks: u32| {
        let fields: [(&str, &[u8]); 4] = [
            ("op", &[3]),
            ("index_pos", &index_at.to_le_bytes()),
            ("conn_count", &(TOPICS.len() as u32).to_le_bytes()),
            ("chunk_count", &chunks.to_le_bytes()),
        ];
        record(&fields, &[b' '; 64])
    };
    let magic = b"#ROSBAG V2.0\n";
    let old = record(&[("op", &[3]), ("index_pos", &[0; 8])], &[b' '; 64]);
    let body = &open[magic.len() + old.len()..];
    let connections: usize = TOPICS
        .iter()
        .enumerate()
        .map(|(id, (topic, is_cloud))| {
            let kind: &[u8] = if *is_cloud {
                b"sensor_msgs/PointCloud2"
            } else {
                b"std_msgs/String"
            };
            let fields: [(&str, &[u8]); 3] = [
                ("op", &[7]),
                ("conn", &(id as u32).to_le_bytes()),
                ("topic", topic.as_bytes()),
            ];
            record(&fields, &bare_header(&[("topic", topic.as_bytes()), ("type", kind)])).len()
        })
        .sum();
    let chunks = super::messages(Kind::Ros1).len() as u32;
    let index_at = magic.len() + header(0, 0).len() + body.len() - connections;
    [&magic[..], &header(index_at as u64, chunks), body].concat()
}

#[test]
fn truncated_bags_are_detected() {
    every_cut_is_found("closed.bag", &closed_bag());
}

#[test]
fn an_unclosed_bag_is_detected() {
    let folder = folder();
    let path = folder.path().join("open.bag");
    let mut open = bag("none", <[u8]>::to_vec, false);
    let fields: [(&str, &[u8]); 3] = [("op", &[3]), ("index_pos", &[0; 8]), ("chunk_count", &[0; 4])];
    let old = record(&[("op", &[3]), ("index_pos", &[0; 8])], &[b' '; 64]);
    open.splice(13..13 + old.len(), record(&fields, &[b' '; 64]));
    fs::write(&path, open).unwrap();
    let message = found(&path).unwrap();
    assert!(
        message.contains("was not closed") && message.contains("rosbag reindex"),
        "{message}"
    );
}

#[test]
fn truncated_databases_and_journals_are_detected() {
    let folder = folder();
    let path = folder.path().join("a.db3");
    db3(&path, Kind::CdrLittle, <[u8]>::to_vec);
    assert_eq!(found(&path), None);
    let whole = fs::read(&path).unwrap();
    for cut in [whole.len() - 1, whole.len() - 4096, whole.len() / 2, 4096, 100, 1] {
        let path = folder.path().join("cut.db3");
        fs::write(&path, &whole[..cut]).unwrap();
        assert!(found(&path).is_some(), "cut at {cut} of {}", whole.len());
    }
    fs::write(folder.path().join("a.db3-journal"), b"no journal, but there").unwrap();
    let message = found(&path).unwrap();
    assert!(message.contains("a.db3-journal"), "{message}");
}
