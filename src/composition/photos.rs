//! View-dependent texturing of a frame from posed images: its splats are curved, outliers occlude no image, and the
//! depth maps of the images are rendered ahead where rendering is not to wait for them.

use super::composed::{Composed, Problem};
use super::depths_ahead::DepthsAhead;
use super::inputs::Inputs;
use super::options::ComposeOptions;
use super::step::{Lane, Stage, Step, same_stage};
use crate::cloud::CloudError;
use crate::photos::{PosedImages, ViewSet};
use crate::progress::Progress;
use crate::scene::Style;
use crate::sequence::Sequence;
use crate::stereo::photo_surface;
use std::sync::Arc;

/// Maximum number of bytes for the texels of all images together, including their mip levels.
pub const PHOTO_BYTES: u64 = 1 << 30;

/// The row of the list.
pub(super) const STAGE: Stage = Stage {
    name: "images",
    lane: Lane::Photos,
    step,
};

/// Returns true if view-dependent texturing applies to the frames, which it does not over the colours of a change map.
pub fn photos_apply(options: &ComposeOptions, style: &Style) -> bool {
    options.change.is_none() && style.draws_photos()
}

/// Returns `posed_images` with the surface reconstructed from them if they are of one static scene; in multi-view
/// video, each frame has a point cloud of its own.
#[must_use]
pub fn on_surface(
    posed_images: Arc<PosedImages>,
    set: &ViewSet,
    sequence: &Sequence,
    progress: &Progress,
) -> Arc<PosedImages> {
    if sequence.len() > 1 {
        return posed_images;
    }
    let surface = photo_surface(set, &posed_images, sequence.origin(), progress);
    Arc::new(posed_images.with_surface(surface))
}

/// View-dependent texturing of a frame from its input images.
#[derive(Debug)]
struct PhotosStep {
    posed_images: Arc<PosedImages>,
    ahead: Option<DepthsAhead>,
}

fn step(inputs: &Inputs<'_>, problems: &mut Vec<Problem>) -> Option<Arc<dyn Step>> {
    if !photos_apply(inputs.options, inputs.style) {
        return None;
    }
    let skipped = &inputs.options.skipped_photos;
    let loaded = inputs.frames.posed_images(inputs.pose.index, skipped)?;
    problems.extend(loaded.notes.into_iter().map(Problem::Note));
    let posed_images = Some(loaded.posed_images).filter(|posed_images| !posed_images.all().is_empty())?;
    Some(Arc::new(PhotosStep {
        posed_images,
        ahead: inputs.frames.depths_ahead(),
    }))
}

impl Step for PhotosStep {
    fn is_same(&self, other: &dyn Step) -> bool {
        let surfels = |step: &Self| step.ahead.map(|ahead| ahead.style.surfels);
        same_stage(other).is_some_and(|other: &Self| {
            Arc::ptr_eq(&self.posed_images, &other.posed_images) && surfels(self) == surfels(other)
        })
    }

    fn run(&self, composed: &mut Composed, _progress: &Progress) -> Result<(), CloudError> {
        let posed_images = Arc::clone(&self.posed_images);
        composed.frame = Arc::new(composed.frame.with_photos(posed_images));
        composed.depths = self.ahead.map(|ahead| Arc::new(ahead.drawn(composed)));
        Ok(())
    }
}
