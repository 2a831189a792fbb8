//! The document: what is open, and all that a user made around it.
//!
//! **How it works.** A [`Document`] is plain data and has one text: JSON, as settings, presets and camera paths are
//! (`text.rs`). A session file (`.pointreel`) is that text next to the data: paths from its folder, how inputs are
//! read, the frame, the view as the line that the window copies, all settings by the words of the command line, clip,
//! range, markers, measurements, labels, trails, notes, the camera path, and the second sequence. The same folder on
//! another machine opens as it was left, in a window and by `render`. The window keeps the same text for each sequence
//! without being asked ([`DocumentFolder`]), and so unsaved changes
//! of sessions (`unsaved.rs`). [`History`] is what can be undone, with names. What is
//! asked of each part (is it the same, does undo take it back, what is it called) is a row of `parts.rs`.
//!
//! **What a session may open.** A session comes from anybody, and says what is opened. The files in its folder are;
//! addresses and files elsewhere only after a question, or with an option ([`Beyond`]).
//!
//! **What outlives versions.** A session of a later version of the format is refused, as the same word may mean
//! something else there. Fields that are not known are kept and written again; settings that cannot be read are as by
//! default, and said. All else that is wrong is an error with its line: a session that lacks its view is not the one
//! that was saved. Files of marks, which were kept per sequence before there were documents, are still read
//! (`timeline_file.rs`).

mod beyond;
mod draft;
mod error;
mod file;
mod folder;
mod history;
mod model;
mod names;
mod parts;
mod paths;
mod reach;
mod reading;
#[cfg(test)]
mod tests;
mod text;
mod text_hash;
mod timeline_file;
mod unsaved;
mod written;

pub use draft::Draft;
pub use error::SessionError;
pub use file::{EXTENSION, ReadSession, Unsaved, is_session, session_of};
pub use folder::{DocumentFolder, StoredDocument};
pub use history::History;
pub use model::{
    Compared, ComparedBy, ComparedLayout, Document, Marker, Measured, MeasuredPoint, ShownTrails, SpreadTrails, Unknown,
};
pub use reach::Beyond;
pub use reading::Reading;
pub use text_hash::TextHash;
pub use unsaved::UnsavedPlace;
