//! Plain points: the cheapest picture of a cloud.

use super::{PassState, solid};

pub(super) fn state() -> PassState {
    solid::state()
}
