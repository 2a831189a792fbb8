//! From a reader's draft to sets and rigs: images that can be shown, and their sizes. Knows no format of
//! reconstructions.

pub(super) mod calibration;
pub(super) mod draft;
pub(super) mod files;
pub(super) mod picture_file;
pub(super) mod rig;
