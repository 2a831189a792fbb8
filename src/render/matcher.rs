//! Stereo matcher of this machine.

use super::gpu::{CardMatcher, Context, ContextOptions, may_have_gpu};
use crate::stereo::{DisparityMap, DisparityRange, GrayImage, Matching, PairMatcher, SharedMatcher, StereoError};
use std::sync::{Arc, LazyLock, OnceLock};

/// Returns the stereo matcher of this machine: a GPU if there is one, else the CPU. The choice is made when the first
/// pair is to be matched, since most sequences have none. The GPU has a device of its own for it: rendering does not
/// wait for pairs.
pub fn matcher_of_machine() -> SharedMatcher {
    static OF_MACHINE: LazyLock<Arc<OfMachine>> = LazyLock::new(Arc::default);
    SharedMatcher(Arc::<OfMachine>::clone(&OF_MACHINE))
}

#[derive(Debug, Default)]
struct OfMachine {
    found: OnceLock<SharedMatcher>,
}

impl OfMachine {
    fn find() -> SharedMatcher {
        if !may_have_gpu() {
            return SharedMatcher::default();
        }
        match Context::headless(&ContextOptions::default()) {
            Ok(context) => CardMatcher::shared(&context),
            Err(error) => {
                log::info!("{error}");
                SharedMatcher::default()
            }
        }
    }
}

impl PairMatcher for OfMachine {
    fn disparities(
        &self,
        matching: &Matching,
        left: &GrayImage,
        right: &GrayImage,
        range: DisparityRange,
    ) -> Result<DisparityMap, StereoError> {
        let matcher = self.found.get_or_init(Self::find);
        matcher.0.disparities(matching, left, right, range)
    }
}
