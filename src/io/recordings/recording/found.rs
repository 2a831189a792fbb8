//! Results of the walk over a recording: topics, and the locations of their messages.

use super::camera::{CameraMessage, CameraTopic, CameraTopics};
use super::encoding::{Encoding, encoding_of};
use super::message::{Message, MessagePlace};
use super::serialisation::Serialisation;
use super::unread::{self, UnreadTopic};
use crate::io::contents::{Contents, Entry, Part, Topic};
use std::collections::{BTreeMap, HashMap};
use std::time::Duration;

/// Kind of messages that are looked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Wanted {
    /// Those with point clouds.
    Clouds,
    /// Camera messages.
    Cameras {
        /// Also where the recording has point clouds; else it is one of these, and is not looked into.
        with_clouds: bool,
    },
}

/// A topic with messages that are looked for.
#[derive(Debug)]
struct FoundTopic {
    name: String,
    encoding: Encoding,
    /// Kind of camera message on the topic; `None` for point clouds.
    camera: Option<CameraMessage>,
}

/// Messages found in a recording.
#[derive(Debug)]
pub(super) struct FoundMessages {
    wanted: Wanted,
    /// Topics by the number that messages call them by; `None` for those that are not looked for.
    topics: HashMap<u32, Option<FoundTopic>>,
    /// The name and type of every topic.
    all: HashMap<u32, (String, String)>,
    /// Messages of every topic, as far as they were met or the recording counts them.
    counts: HashMap<u32, u64>,
    messages: Vec<(u32, Duration, Message)>,
    has_clouds: bool,
    skipped: Skipped,
}

/// Parts of a recording that cannot be read.
#[derive(Debug, Default)]
struct Skipped {
    count: usize,
    /// The first of them, a sentence.
    first: String,
}

impl FoundMessages {
    pub(super) fn new(wanted: Wanted) -> Self {
        Self {
            wanted,
            topics: HashMap::new(),
            all: HashMap::new(),
            counts: HashMap::new(),
            messages: Vec::new(),
            has_clouds: false,
            skipped: Skipped::default(),
        }
    }

    /// Notes that a part of the recording is skipped: a sentence with its place and the reason.
    pub(super) fn skip(&mut self, part: String) {
        if self.skipped.count == 0 {
            self.skipped.first = part;
        }
        self.skipped.count += 1;
    }

    /// Counts messages of a topic, whether they are looked for or not.
    pub(super) fn count(&mut self, topic: u32, messages: u64) {
        let count = self.counts.entry(topic).or_default();
        *count = count.saturating_add(messages);
    }

    /// Parts of the recording that are skipped, a sentence each.
    pub(super) fn damage(&self) -> Vec<String> {
        let Skipped { count, first } = &self.skipped;
        match count {
            0 => Vec::new(),
            1 => vec![first.clone()],
            more => vec![format!("{first}; as {} more parts of it", more - 1)],
        }
    }

    /// The content of a recording without point clouds.
    fn describe(&self) -> String {
        let mut by_name: BTreeMap<(&str, &str), u64> = BTreeMap::new();
        for (id, (name, kind)) in &self.all {
            *by_name.entry((name.as_str(), kind.as_str())).or_default() += self.counts.get(id).copied().unwrap_or(0);
        }
        let topics = by_name.into_iter().map(|((name, kind), count)| UnreadTopic {
            name: name.to_owned(),
            kind: kind.to_owned(),
            count,
        });
        let skipped = self.damage().join("; ");
        let described = unread::describe(&mut topics.collect::<Vec<_>>());
        if skipped.is_empty() {
            described
        } else {
            format!("{described}; {skipped}")
        }
    }

    /// Notes that messages with the number `id` are of topic `name`, and their type `kind`.
    pub(super) fn add_topic(&mut self, id: u32, name: &str, kind: &str, encoding: &str) {
        let of_clouds = encoding_of(kind, encoding);
        self.has_clouds |= of_clouds.is_some();
        let name = name.to_owned();
        self.all.insert(id, (name.clone(), kind.to_owned()));
        let topic = match self.wanted {
            Wanted::Clouds => of_clouds.map(|encoding| FoundTopic {
                name,
                encoding,
                camera: None,
            }),
            Wanted::Cameras { .. } => {
                let of_cameras = CameraMessage::of(kind, &name).zip(Serialisation::of(encoding));
                of_cameras.map(|(camera, serialisation)| FoundTopic {
                    name,
                    encoding: Encoding::Ros(serialisation),
                    camera: Some(camera),
                })
            }
        };
        self.topics.insert(id, topic);
    }

    /// Returns true if messages of a topic are looked for, as far as is known.
    pub(super) fn has_topic(&self, id: u32) -> bool {
        matches!(self.topics.get(&id), Some(Some(_)))
    }

    /// Records a message of a wanted topic; `start` has its first bytes.
    pub(super) fn add(&mut self, topic: u32, log_time: Duration, start: &[u8], place: MessagePlace) {
        if let Some(Some(FoundTopic { encoding, camera, .. })) = self.topics.get(&topic) {
            let encoding = *encoding;
            let has_header = camera.is_none_or(CameraMessage::has_header);
            let stamp = encoding.stamp(start).filter(|_| has_header);
            let time = stamp.unwrap_or(log_time);
            self.messages.push((topic, time, Message { place, encoding }));
        }
    }

    /// True when nothing within chunks is looked for.
    pub(super) fn is_complete(&self) -> bool {
        // A recording with clouds is opened as clouds: its chunks are not unpacked to search for images.
        self.has_clouds && self.wanted == Wanted::Cameras { with_clouds: false }
    }

    /// True if a chunk with messages of these topics may hold wanted messages.
    pub(super) fn may_be_in_chunk(&self, topics: &[u32]) -> bool {
        topics.is_empty()
            || topics
                .iter()
                .any(|topic| self.topics.get(topic).is_none_or(Option::is_some))
    }

    /// Returns the camera topics, each with its messages in time order.
    pub(super) fn cameras(self) -> CameraTopics {
        let damage = self.damage();
        let mut by_name: BTreeMap<&str, CameraTopic> = BTreeMap::new();
        for topic in self.topics.values().flatten() {
            if let Some(kind) = topic.camera {
                by_name
                    .entry(&topic.name)
                    .or_insert_with(|| CameraTopic::new(&topic.name, kind));
            }
        }
        for (topic, time, message) in self.messages {
            let topic = self.topics.get(&topic).and_then(Option::as_ref);
            if let Some(topic) = topic.and_then(|topic| by_name.get_mut(topic.name.as_str())) {
                topic.messages.push((time, message));
            }
        }
        let mut topics: Vec<CameraTopic> = by_name.into_values().collect();
        for topic in &mut topics {
            topic.messages.sort_by_key(|(time, _)| *time);
        }
        CameraTopics { topics, damage }
    }

    /// All topics with point clouds, and the messages of `wanted` in the order of time; of the topic that has the most
    /// if `None`.
    pub(super) fn contents(self, wanted: Option<&str>) -> Contents {
        let damage = self.damage();
        let described = self.describe();
        // The same topic may have several ids, one for each of its publishers.
        let mut by_name: BTreeMap<&str, Vec<(Duration, Message)>> = BTreeMap::new();
        for topic in self.topics.values().flatten() {
            by_name.entry(&topic.name).or_default();
        }
        for (topic, time, message) in self.messages {
            if let Some(Some(topic)) = self.topics.get(&topic) {
                by_name.entry(&topic.name).or_default().push((time, message));
            }
        }
        let max = by_name.values().map(Vec::len).max().unwrap_or(0);
        let read = by_name.iter().find_map(|(&name, messages)| {
            let is_read = match wanted {
                Some(wanted) => name == wanted,
                None => messages.len() == max,
            };
            is_read.then_some(name)
        });
        let topics = by_name.iter().map(|(&name, messages)| Topic {
            name: name.to_owned(),
            cloud_count: messages.len(),
            is_read: Some(name) == read,
        });
        let topics = topics.collect();
        let mut messages = read.and_then(|name| by_name.remove(name)).unwrap_or_default();
        messages.sort_by_key(|(time, _)| *time);
        let entries = messages.into_iter().enumerate();
        let entries = entries.map(|(index, (time, message))| Entry {
            name: format!("{} {index}", read.unwrap_or_default()),
            time: Some(time),
            part: Part::Message(message),
        });
        let entries: Vec<Entry> = entries.collect();
        let without_frames = if entries.is_empty() { described } else { String::new() };
        Contents {
            entries,
            topics,
            notes: Vec::new(),
            damage,
            without_frames,
        }
    }
}
