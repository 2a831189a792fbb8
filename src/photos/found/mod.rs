//! What a reader found, made into a set: which images can be shown, of which size. Knows no format of reconstructions.

pub(super) mod depth_file;
pub(super) mod draft;
pub(super) mod files;
pub(super) mod picture_file;
pub(super) mod unread;
