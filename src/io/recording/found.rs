//! What the walk over a recording finds: topics, and where their point clouds are.

use super::super::contents::{Contents, Entry, Part, Topic};
use super::encoding::Encoding;
use super::message::{Message, MessagePlace};
use std::collections::{BTreeMap, HashMap};
use std::time::Duration;

/// What is found in a recording.
#[derive(Debug, Default)]
pub(super) struct Found {
    /// Topics by the number that messages call them by; `None` for those without point clouds.
    pub(super) topics: HashMap<u32, Option<(String, Encoding)>>,
    messages: Vec<(u32, Duration, Message)>,
}

impl Found {
    /// Notes a message of a topic with point clouds; `start` is what it begins with.
    pub(super) fn add(&mut self, topic: u32, log_time: Duration, start: &[u8], place: MessagePlace) {
        if let Some(Some((_, encoding))) = self.topics.get(&topic) {
            let encoding = *encoding;
            let time = encoding.stamp(start).unwrap_or(log_time);
            self.messages.push((topic, time, Message { place, encoding }));
        }
    }

    /// True when a chunk with messages of these topics may hold point clouds.
    pub(super) fn may_hold_clouds(&self, topics: &[u32]) -> bool {
        topics.is_empty()
            || topics
                .iter()
                .any(|topic| self.topics.get(topic).is_none_or(Option::is_some))
    }

    /// All topics with point clouds, and the messages of `wanted` in the order of time; of the topic that has the most
    /// if `None`.
    pub(super) fn contents(self, wanted: Option<&str>) -> Contents {
        // The same topic may have several numbers, one for each of its publishers.
        let mut by_name: BTreeMap<&str, Vec<(Duration, Message)>> = BTreeMap::new();
        for (name, _) in self.topics.values().flatten() {
            by_name.entry(name).or_default();
        }
        for (topic, time, message) in self.messages {
            if let Some(Some((name, _))) = self.topics.get(&topic) {
                by_name.entry(name).or_default().push((time, message));
            }
        }
        let most = by_name.values().map(Vec::len).max().unwrap_or(0);
        let read = by_name.iter().find_map(|(&name, messages)| {
            let is_read = match wanted {
                Some(wanted) => name == wanted,
                None => messages.len() == most,
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
        Contents {
            entries: entries.collect(),
            topics,
        }
    }
}
