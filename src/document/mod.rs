//! The document: the open inputs, and everything that a user made around them.
//!
//! **How it works.** A [`Document`] is plain data and has one text: JSON, as settings, presets and camera paths are
//! (`text.rs`). A session file (`.pointreel`) is that text next to the data: paths relative to its folder, reading
//! options, the frame, the view as the line that the window copies, all settings in the words of the command line,
//! clip, range, markers, measurements, labels, trails, notes, the camera path, and the second sequence. The same folder
//! on another machine opens in the same state, in a window and by `render`. The window stores the same text for each
//! sequence automatically ([`DocumentFolder`]), as well as unsaved changes of sessions (`unsaved.rs`). [`History`] has
//! the undoable changes, with names. The properties of each part (comparison, undo, name) are a row of `parts.rs`.
//!
//! **What a session may open.** A session is untrusted, and names its inputs. Files in its folder are opened; addresses
//! and files elsewhere only after a question, or with an option ([`Beyond`]).
//!
//! **What outlives versions.** A session of a later version of the format is refused, as the same word may mean
//! something else there. Unknown fields are retained and written again; unreadable settings get their defaults, with a
//! warning. Any other fault is an error with its line: a session without its view is not the one that was saved. Files
//! of marks, which were stored per sequence before there were documents, are still read (`timeline_file.rs`).

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
