//! One-pass splatting: blended in the order of the cloud, with depth (Fig. 3a) and without (Fig. 3b).

use super::{COLOR_FORMAT, DepthUse, PassState, over, target};

pub(super) fn regular_state() -> PassState {
    PassState {
        color: Some(target(COLOR_FORMAT, Some(over()))),
        depth: Some(DepthUse::TestAndWrite),
    }
}

pub(super) fn no_depth_state() -> PassState {
    PassState {
        color: Some(target(COLOR_FORMAT, Some(over()))),
        depth: None,
    }
}
