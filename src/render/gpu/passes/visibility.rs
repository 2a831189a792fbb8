//! Visibility pass: depths of the disks and nothing else (paper 000 §V-B, first pass).

use super::{DepthUse, PassState};

pub(super) fn state() -> PassState {
    PassState {
        color: None,
        depth: Some(DepthUse::TestAndWrite),
    }
}
