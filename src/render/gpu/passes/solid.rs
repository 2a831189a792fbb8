//! Opaque faces of voxels (paper 000 §VI-B).

use super::{COLOR_FORMAT, DepthUse, PassState, target};

pub(super) fn state() -> PassState {
    PassState {
        color: Some(target(COLOR_FORMAT, None)),
        depth: Some(DepthUse::TestAndWrite),
    }
}
