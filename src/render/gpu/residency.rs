//! GPU residency of record streams: looping over a sequence, moving the camera and switching modes upload nothing that
//! is there already.
//!
//! Streams are identified by the allocation of their records. A weak reference is held with each, so that the address
//! of a cloud that is gone cannot be taken for that of a new one; streams whose cloud is gone are evicted first, then
//! the least recently drawn, down to the budget.

use super::instancing::Stream;
use crate::cloud::{MeshRecords, PointRecord};
use crate::levels::octree::CodedCloud;
use crate::scene::PointImages;
use bytemuck::NoUninit;
use std::any::Any;
use std::collections::HashMap;
use std::sync::{Arc, Weak};

/// A least-recently-drawn cache of streams.
#[derive(Debug)]
pub(super) struct Residency {
    streams: HashMap<StreamKey, Resident>,
    budget_bytes: u64,
    resident_bytes: u64,
    clock: u64,
}

#[derive(Debug)]
struct Resident {
    owner: Weak<dyn Any + Send + Sync>,
    stream: Stream,
    last_drawn: u64,
}

/// Names a resident stream.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) struct StreamKey {
    address: usize,
    use_of: StreamUse,
}

/// Usage of resident records, which determines their layout.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
enum StreamUse {
    /// They are drawn.
    Drawn,
    /// Some of them are gathered.
    Gathered,
    /// They are points of images, in one colour or in the images' colours.
    OfImages(Option<[u8; 4]>),
}

impl StreamKey {
    fn of<T>(records: &Arc<T>) -> Self {
        Self {
            address: Arc::as_ptr(records) as usize,
            use_of: StreamUse::Drawn,
        }
    }
}

/// Records that are to be drawn.
#[derive(Debug)]
pub(super) struct RecordSource<'a> {
    key: StreamKey,
    contents: StreamContents<'a>,
    owner: Weak<dyn Any + Send + Sync>,
}

/// Contents of a stream.
#[derive(Debug, Clone, Copy)]
pub(super) enum StreamContents<'a> {
    /// Records of 16 bytes.
    Records(&'a [u8]),
    /// Records of 16 bytes of all nodes of a structure.
    Nodes(&'a [u8]),
    /// Triangles and their vertices.
    Mesh(&'a MeshRecords),
    /// A point of every pixel.
    Images(&'a PointImages),
    /// Nodes of an octree, some of which are decoded.
    Code(&'a CodedCloud),
}

impl<'a> RecordSource<'a> {
    pub(super) fn of<T: NoUninit + Send + Sync>(records: &'a Arc<Vec<T>>) -> Self {
        Self::owned_by(records, StreamContents::Records(bytemuck::cast_slice(records)))
    }

    /// Converts to a source with the same records, some of which are gathered.
    pub(super) fn into_nodes(self) -> Self {
        Self {
            key: StreamKey {
                use_of: StreamUse::Gathered,
                ..self.key
            },
            contents: match self.contents {
                StreamContents::Records(bytes) => StreamContents::Nodes(bytes),
                contents => contents,
            },
            owner: self.owner,
        }
    }

    /// Returns the size of the records in bytes, or of the byte code; 0 for meshes.
    pub(super) fn record_bytes(&self) -> usize {
        match self.contents {
            StreamContents::Records(bytes) | StreamContents::Nodes(bytes) => bytes.len(),
            StreamContents::Mesh(_) => 0,
            StreamContents::Images(images) => images.frame.pixels() * size_of::<PointRecord>(),
            StreamContents::Code(cloud) => cloud.word_starts()[2] * size_of::<u32>(),
        }
    }

    pub(super) fn of_mesh(mesh: &'a Arc<MeshRecords>) -> Self {
        Self::owned_by(mesh, StreamContents::Mesh(mesh))
    }

    /// The nodes of a byte code.
    pub(super) fn of_code(cloud: &'a Arc<CodedCloud>) -> Self {
        Self::owned_by(cloud, StreamContents::Code(cloud))
    }

    /// The points of images, of which some are drawn.
    pub(super) fn of_images(images: &'a PointImages) -> Self {
        let source = Self::owned_by(&images.frame, StreamContents::Images(images));
        Self {
            key: StreamKey {
                use_of: StreamUse::OfImages(images.one_color),
                ..source.key
            },
            ..source
        }
    }

    fn owned_by<T: Send + Sync + 'static>(owner: &Arc<T>, contents: StreamContents<'a>) -> Self {
        let shared: Arc<dyn Any + Send + Sync> = Arc::clone(owner) as _;
        Self {
            key: StreamKey::of(owner),
            contents,
            owner: Arc::downgrade(&shared),
        }
    }

    /// Returns the key that identifies the stream.
    pub(super) fn key(&self) -> StreamKey {
        self.key
    }
}

impl Residency {
    pub(super) fn new(budget_bytes: u64) -> Self {
        Self {
            streams: HashMap::new(),
            budget_bytes,
            resident_bytes: 0,
            clock: 0,
        }
    }

    /// Sets the number of bytes that stay; any excess is dropped when the next image is prepared.
    pub(super) fn set_budget_bytes(&mut self, budget_bytes: u64) {
        self.budget_bytes = budget_bytes;
    }

    /// Makes sure that `records` are resident. Returns the bytes uploaded, 0 when they were.
    pub(super) fn ensure(
        &mut self,
        records: &RecordSource<'_>,
        upload: impl FnOnce(StreamContents<'_>) -> Stream,
    ) -> u64 {
        self.clock += 1;
        let key = records.key;
        if let Some(resident) = self.streams.get_mut(&key) {
            // The weak reference prevents the address from being reused, so it is the same cloud.
            resident.last_drawn = self.clock;
            return 0;
        }
        let stream = upload(records.contents);
        let bytes = stream.byte_size;
        self.resident_bytes += bytes;
        self.streams.insert(
            key,
            Resident {
                owner: Weak::clone(&records.owner),
                stream,
                last_drawn: self.clock,
            },
        );
        bytes
    }

    /// The stream, if it is resident.
    pub(super) fn get(&self, key: StreamKey) -> Option<&Stream> {
        self.streams.get(&key).map(|resident| &resident.stream)
    }

    /// Drops streams whose cloud is gone, then the least recently drawn, but never `keep`.
    pub(super) fn trim(&mut self, keep: &[StreamKey]) {
        let is_cached = |key: &StreamKey| keep.contains(key);
        self.streams
            .retain(|key, resident| is_cached(key) || resident.owner.strong_count() > 0);
        self.resident_bytes = self.streams.values().map(|resident| resident.stream.byte_size).sum();
        while self.resident_bytes > self.budget_bytes {
            let oldest = self
                .streams
                .iter()
                .filter(|(key, _)| !is_cached(key))
                .min_by_key(|(_, resident)| resident.last_drawn)
                .map(|(&key, _)| key);
            let Some(resident) = oldest.and_then(|key| self.streams.remove(&key)) else {
                break;
            };
            self.resident_bytes -= resident.stream.byte_size;
        }
    }

    /// Drops everything: another strategy lays records out otherwise, or nothing more fits.
    pub(super) fn clear(&mut self) {
        self.streams.clear();
        self.resident_bytes = 0;
    }

    pub(super) fn budget_bytes(&self) -> u64 {
        self.budget_bytes
    }

    pub(super) fn resident_bytes(&self) -> u64 {
        self.resident_bytes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stream_of(contents: StreamContents<'_>) -> Stream {
        let StreamContents::Records(records) = contents else {
            panic!("{contents:?}")
        };
        Stream {
            chunks: Vec::new(),
            byte_size: records.len() as u64,
        }
    }

    #[test]
    fn the_same_cloud_is_uploaded_once() {
        let mut residency = Residency::new(100);
        let cloud = Arc::new(vec![0u8; 40]);
        assert_eq!(residency.ensure(&RecordSource::of(&cloud), stream_of), 40);
        assert_eq!(residency.ensure(&RecordSource::of(&Arc::clone(&cloud)), stream_of), 0);
        assert_eq!(
            residency.ensure(&RecordSource::of(&Arc::new(vec![0u8; 40])), stream_of),
            40,
            "equal content, another cloud"
        );
    }

    #[test]
    fn dropped_clouds_are_evicted_first_then_the_oldest_but_never_those_in_use() {
        let mut residency = Residency::new(100);
        let mut clouds: Vec<_> = (0..4).map(|_| Arc::new(vec![0u8; 40])).collect();
        for cloud in &clouds[..3] {
            residency.ensure(&RecordSource::of(cloud), stream_of);
        }
        residency.ensure(&RecordSource::of(&clouds[0]), stream_of);
        residency.trim(&[StreamKey::of(&clouds[1])]);
        assert_eq!(residency.resident_bytes(), 80);
        assert!(
            residency.get(StreamKey::of(&clouds[2])).is_none(),
            "drawn least recently"
        );

        residency.ensure(&RecordSource::of(&clouds[3]), stream_of);
        let cached = [StreamKey::of(&clouds[1])];
        clouds = vec![Arc::clone(&clouds[1])];
        residency.trim(&cached);
        assert_eq!(residency.resident_bytes(), 40, "clouds that are gone leave at once");
        assert!(residency.get(StreamKey::of(&clouds[0])).is_some());
    }

    #[test]
    fn data_being_drawn_stays_resident_whatever_the_budget() {
        let mut residency = Residency::new(10);
        let cloud = Arc::new(vec![0u8; 40]);
        residency.ensure(&RecordSource::of(&cloud), stream_of);
        residency.trim(&[StreamKey::of(&cloud)]);
        assert!(residency.get(StreamKey::of(&cloud)).is_some());
    }
}
