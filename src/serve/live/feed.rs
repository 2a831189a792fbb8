//! Frames of a source → bodies of messages.

use super::outgoing::Body;
use super::surfels::{WholeFrame, origin_of, spacing_of};
use crate::cloud::RawCloud;
use crate::messages::frame_by_index;
use crate::progress::Progress;
use crate::scene::PointSpacing;
use crate::source::{Decoder, Source};
use crate::wire::{ImageCoding, Kind, MAX_PAYLOAD_BYTES, images_body, points_body};
use std::collections::{BTreeMap, BTreeSet};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

/// Bytes of bodies that are cached: a short sequence that is played over and over is made once.
const MAX_BUFFERED_BYTES: usize = 256 << 20;

/// Number of frames after which the point spacing is measured again.
const SPACING_FRAMES: usize = 100;

/// Makes bodies of the frames of a source.
pub(super) struct Feed {
    source: Arc<dyn Source>,
    decoder: Box<dyn Decoder>,
    coding: ImageCoding,
    max_bytes: u64,
    buffered: BTreeMap<usize, Body>,
    buffered_bytes: usize,
    /// Unreadable frames, already reported.
    broken: BTreeSet<usize>,
    /// Frames whose colours cannot be sent, already reported.
    said: BTreeSet<usize>,
    /// Point spacing, and the number of frames since it was measured.
    spacing: Option<(PointSpacing, usize)>,
}

impl Feed {
    pub(super) fn new(source: Arc<dyn Source>, coding: ImageCoding, max_bytes: u64) -> Self {
        Self {
            decoder: source.decoder(),
            source,
            coding,
            max_bytes,
            buffered: BTreeMap::new(),
            buffered_bytes: 0,
            broken: BTreeSet::new(),
            said: BTreeSet::new(),
            spacing: None,
        }
    }

    /// All points of frame `index`, for clients that are sent visible points; `None` if it cannot be read, which was
    /// reported when its body was made.
    pub(super) fn whole(&mut self, index: usize) -> Option<Arc<WholeFrame>> {
        self.without_panic(|feed| feed.made_whole(index)).ok()
    }

    fn made_whole(&mut self, index: usize) -> Result<Arc<WholeFrame>, String> {
        let cloud = self.decoded(index)?;
        let origin = origin_of(&cloud);
        // From whole frames: the visible points of a distant view are farther apart, and would be sent ever more
        // coarsely.
        let known = self.spacing.filter(|(_, frames)| *frames < SPACING_FRAMES);
        let (spacing, frames) = match known {
            Some(known) => known,
            None => (spacing_of(&cloud, origin).ok_or("it is not a point cloud")?, 0),
        };
        self.spacing = Some((spacing, frames + 1));
        Ok(Arc::new(WholeFrame::new(cloud, origin, spacing)))
    }

    /// The answer of `work`; a sentence if the program fails in it: one frame that it cannot make ends no stream.
    fn without_panic<T>(&mut self, work: impl FnOnce(&mut Self) -> Result<T, String>) -> Result<T, String> {
        catch_unwind(AssertUnwindSafe(|| work(self))).unwrap_or_else(|_| {
            // A decoder that failed halfway may be in any state.
            self.decoder = self.source.decoder();
            Err("the program failed on this frame: please report it with the file".to_owned())
        })
    }

    fn decoded(&mut self, index: usize) -> Result<RawCloud, String> {
        let entry = self.source.entry(index);
        let decoded = self.decoder.decode(index, &entry, usize::MAX, &Progress::default());
        decoded.map(|decoded| decoded.cloud).map_err(|error| error.to_string())
    }

    /// The body of frame `index`; `None` if it cannot be read, which is logged once.
    pub(super) fn body(&mut self, index: usize) -> Option<Body> {
        if let Some(body) = self.buffered.get(&index) {
            return Some(body.clone());
        }
        if self.broken.contains(&index) {
            return None;
        }
        let body = match self.without_panic(|feed| feed.made(index)) {
            Ok(body) => body,
            Err(problem) => {
                log::warn!("{} is skipped: {problem}", frame_by_index(index));
                // A live source delivers each frame only once.
                if !self.source.is_live() {
                    self.broken.insert(index);
                }
                return None;
            }
        };
        if !self.source.is_live() && self.buffered_bytes + body.bytes.len() <= MAX_BUFFERED_BYTES {
            self.buffered_bytes += body.bytes.len();
            self.buffered.insert(index, body.clone());
        }
        Some(body)
    }

    fn made(&mut self, index: usize) -> Result<Body, String> {
        // Unfiltered images, not points: nothing is lost that a filter may need later, and the client uses the decoder
        // for files.
        let (kind, bytes) = if let Some(images) = self.source.raw_images(index) {
            let images = images.map_err(|error| error.to_string())?;
            let (body, problem) = images_body(&images, self.coding, self.max_bytes)?;
            if let Some(problem) = problem
                && (self.source.is_live() || self.said.insert(index))
            {
                log::warn!("{} is sent without colours: {problem}", frame_by_index(index));
            }
            (Kind::Images, body)
        } else {
            (Kind::Points, points_body(&self.decoded(index)?))
        };
        if bytes.len() as u64 + 1024 > MAX_PAYLOAD_BYTES {
            return Err(format!(
                "it is {} bytes, and {MAX_PAYLOAD_BYTES} are sent at most: thin it out by pointreel convert",
                bytes.len()
            ));
        }
        Ok(Body::new(kind, bytes))
    }
}
