//! Lines on the ground, laid over the picture where nothing is before them.

use super::{COLOR_FORMAT, DepthUse, PassState, over, target};

pub(super) fn state() -> PassState {
    PassState {
        color: Some(target(COLOR_FORMAT, Some(over()))),
        depth: Some(DepthUse::TestOnly),
    }
}
