//! The range of colours of a sequence, decided once for all of its frames.
//!
//! **How it works.** Fields of 16 bits and floats may hold 0 to 255, 0 to 65535 or 0 to 1, and the largest value of a
//! frame decides. A dark frame has no large value: read alone, it is as bright as the others. So a frame that looks
//! like a narrower range queries the sequence. The first one that does has a few frames read, evenly spread from first
//! to last; the widest range among them holds for all frames, whichever was read first.

use super::decode::read_frame;
use crate::assumption::{Assumption, Evidence, Subject};
use crate::cloud::{ColorDepth, RawCloud};
use crate::io::{ReadOptions, SharedFile};
use crate::locks::read;
use crate::progress::Progress;
use crate::source::FrameEntry;
use std::fs;
use std::sync::{Arc, OnceLock, RwLock};

/// Frames that are read to decide.
const SAMPLED_FRAMES: usize = 8;

/// Frames that are read of a sequence of large files.
const SAMPLED_LARGE_FRAMES: usize = 3;

/// Size of a large file.
const LARGE_BYTES: u64 = 64 << 20;

/// Frames that share a range of colours.
#[derive(Debug, Default)]
pub(super) struct SharedDepth {
    entries: Arc<RwLock<Vec<Arc<FrameEntry>>>>,
    decided: OnceLock<Option<ColorDepth>>,
    /// The minimum range, if it was chosen.
    chosen: Option<ColorDepth>,
}

impl SharedDepth {
    pub(super) fn of(entries: Arc<RwLock<Vec<Arc<FrameEntry>>>>, chosen: Option<ColorDepth>) -> Self {
        Self {
            entries,
            decided: OnceLock::new(),
            chosen,
        }
    }

    /// Gives `cloud` colours in the range of the sequence.
    pub(super) fn apply(&self, cloud: &mut RawCloud, options: &ReadOptions, shared: &SharedFile) {
        let Some(own) = cloud.color_depth.filter(|own| *own < ColorDepth::Bits16) else {
            return;
        };
        if let Some(chosen) = self.chosen.filter(|chosen| *chosen >= own) {
            if chosen > own {
                cloud.widen_colors(chosen);
            }
            return;
        }
        let widest = *self.decided.get_or_init(|| self.decide(options, shared));
        if let Some(widest) = widest.filter(|widest| *widest > own) {
            cloud.widen_colors(widest);
            let why = "other frames of the sequence have larger values";
            let value = format!("0 to {}", widest.full_scale());
            let assumption = Assumption::new(Subject::ColorDepth, value, why, Evidence::Statistics);
            cloud.assumptions.push(assumption);
        } else if cloud.has_narrow_colors {
            let why = "no value in the fields of 16 bits is larger";
            let assumption = Assumption::new(Subject::ColorDepth, "0 to 255", why, Evidence::Statistics);
            cloud.assumptions.push(assumption);
        }
    }

    /// The widest range among some frames.
    fn decide(&self, options: &ReadOptions, shared: &SharedFile) -> Option<ColorDepth> {
        let entries = read(&self.entries).clone();
        if entries.len() < 2 {
            return None;
        }
        let is_large = |entry: &Arc<FrameEntry>| fs::metadata(&entry.path).is_ok_and(|file| file.len() > LARGE_BYTES);
        let max = if is_large(&entries[0]) {
            SAMPLED_LARGE_FRAMES
        } else {
            SAMPLED_FRAMES
        };
        let last = entries.len() - 1;
        let steps = (max - 1).min(last);
        let depths = (0..=steps).filter_map(|step| {
            let place = step * last / steps;
            let cloud = read_frame(&entries[place], options, shared, &Progress::default());
            cloud.ok()?.color_depth
        });
        depths.max()
    }
}
