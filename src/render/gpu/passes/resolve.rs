//! Resolve, and the grey picture of the visibility pass: both lay one texture over the background.

use super::{COLOR_FORMAT, PassState, over, target};

pub(super) fn state() -> PassState {
    PassState {
        color: Some(target(COLOR_FORMAT, Some(over()))),
        depth: None,
    }
}
