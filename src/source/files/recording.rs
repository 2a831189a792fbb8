//! Recordings with several topics of point clouds, one of which is the sequence.

use crate::io::Topic;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// A recording that was opened.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Recording {
    /// Its file.
    pub path: PathBuf,
    /// Its topics with point clouds, in the order of their names.
    pub topics: Vec<Topic>,
}

/// The topics of all `recordings` together, in the order of their names: a long recording is several files.
pub(in crate::source) fn topics_of(recordings: &[Recording]) -> Vec<Topic> {
    let mut by_name: BTreeMap<&str, Topic> = BTreeMap::new();
    for topic in recordings.iter().flat_map(|recording| &recording.topics) {
        by_name
            .entry(&topic.name)
            .and_modify(|sum| {
                sum.cloud_count += topic.cloud_count;
                sum.is_read |= topic.is_read;
            })
            .or_insert_with(|| topic.clone());
    }
    by_name.into_values().collect()
}

/// Warns about the point clouds that are skipped because none was chosen.
pub(super) fn warn_of_unread(recordings: &[Recording]) {
    for Recording { path, topics } in recordings {
        let names = |is_read: bool| -> Vec<&str> {
            let such = topics
                .iter()
                .filter(|topic| topic.cloud_count > 0 && topic.is_read == is_read);
            such.map(|topic| topic.name.as_str()).collect()
        };
        let unread = names(false);
        if !unread.is_empty() {
            log::warn!(
                "{}: the point clouds of topic {} are read, which has the most; others are read with --topic: {}",
                path.display(),
                names(true).join(", "),
                unread.join(", ")
            );
        }
    }
}
