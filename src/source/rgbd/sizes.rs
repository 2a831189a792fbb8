//! Sizes of images before they are decoded.

use super::calibration::Calibration;
use super::layouts::FoundRecording;
use super::stored_image::StoredImage;
use crate::io::ReadOptions;
use std::sync::Arc;

/// Sizes of the first images, as far as they can be read; what cannot is said when it is decoded.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sizes {
    pub(super) depth_px: Option<[u32; 2]>,
    pub(super) color_px: Option<[u32; 2]>,
}

impl Sizes {
    /// Of images that are not there yet.
    pub(super) const UNKNOWN: Self = Self {
        depth_px: None,
        color_px: None,
    };

    /// Looks at the first images of `found`. Cameras that do not say for which size they are get these.
    pub(super) fn learn(found: &mut FoundRecording, options: &ReadOptions) -> Self {
        let size_of = |image: &StoredImage| image.size_px(options);
        let first = Arc::clone(&found.frames[0].calibration);
        let color = found.frames.iter().find_map(|frame| frame.color.as_ref());
        let sizes = Self {
            // Text does not say it.
            depth_px: size_of(&found.frames[0].depth).or(first.depth.for_size_px),
            color_px: color.filter(|_| first.color.is_some()).and_then(size_of),
        };
        let mut learned = Calibration::clone(&first);
        learned.depth.for_size_px = learned.depth.for_size_px.or(sizes.depth_px);
        if let Some((color, _)) = &mut learned.color {
            color.for_size_px = color.for_size_px.or(sizes.color_px);
        }
        let learned = Arc::new(learned);
        for frame in &mut found.frames {
            if Arc::ptr_eq(&frame.calibration, &first) {
                frame.calibration = Arc::clone(&learned);
            }
        }
        sizes
    }
}
