//! The temporal filter of depth images: frames are filtered with those before them, from the beginning of their group.

use crate::progress::Progress;
use crate::rgbd::{DepthImage, DepthSamples, FilterReport, Temporal, TemporalFilter};
use std::sync::Arc;

/// Frames that are decoded one after the other where each is filtered with those before it.
// A running mean without groups would depend on all earlier frames. With eight frames of lead a seek costs at most 40
// images.
pub(in crate::source) const GROUP_FRAMES: usize = 32;

/// A depth image after the filters that look at it alone, and before them.
#[derive(Debug)]
pub(in crate::source) struct FilteredDepth {
    pub(super) image: DepthImage,
    pub(super) samples: Arc<DepthSamples>,
    /// Filter report.
    pub(super) report: FilterReport,
}

/// A depth image after all filters, and the images that the last of them began with.
#[derive(Debug)]
pub(super) struct DepthInTime {
    pub(super) image: DepthImage,
    pub(super) samples: Arc<DepthSamples>,
    pub(super) before: Vec<Arc<DepthSamples>>,
    pub(super) report: FilterReport,
}

/// The temporal filter of one thread: after which frame, and its state.
#[derive(Debug, Default)]
pub(in crate::source) struct FramesBefore {
    last: Option<AfterFrame>,
}

/// The filter after the frame of this index.
#[derive(Debug)]
struct AfterFrame {
    index: usize,
    filter: TemporalFilter,
    /// Images that the filter has seen.
    images: Vec<Arc<DepthSamples>>,
}

impl FramesBefore {
    /// `depth` of frame `index`, with the frames before it, from `before`. Broken and expired ones among these are
    /// skipped.
    pub(super) fn filtered(
        &mut self,
        temporal: Option<Temporal>,
        index: usize,
        depth: FilteredDepth,
        before: impl Fn(usize) -> Option<FilteredDepth>,
        progress: &Progress,
    ) -> DepthInTime {
        let FilteredDepth { image, samples, report } = depth;
        let alone = |image, samples, report| DepthInTime {
            image,
            samples,
            before: Vec::new(),
            report,
        };
        let Some(temporal) = temporal else {
            return alone(image, samples, report);
        };
        let begin = temporal_begin(temporal, index);
        // The frames of a group build on each other; each group starts afresh.
        let known = self
            .last
            .take()
            // The state of another group is never continued: a frame decoded on its own must be byte for byte the same
            // as when decoded after its predecessors.
            .filter(|last| last.index < index && temporal_begin(temporal, last.index) == begin);
        let (first, mut filter, mut images) = known.map_or_else(
            || (begin, TemporalFilter::new(temporal), Vec::new()),
            |last| (last.index + 1, last.filter, last.images),
        );
        for index in first..index {
            if progress.is_cancelled() {
                return alone(image, samples, report);
            }
            if let Some(before) = before(index) {
                filter.next(before.image);
                images.push(before.samples);
            }
        }
        let filtered = filter.next(image);
        let before = images.clone();
        images.push(Arc::clone(&samples));
        self.last = Some(AfterFrame { index, filter, images });
        DepthInTime {
            image: filtered,
            samples,
            before,
            report,
        }
    }
}

/// The frame from which the filter of frame `index` begins: so far before its group that earlier ones make no
/// difference.
fn temporal_begin(temporal: Temporal, index: usize) -> usize {
    (index / GROUP_FRAMES * GROUP_FRAMES).saturating_sub(temporal.lead_frames())
}
