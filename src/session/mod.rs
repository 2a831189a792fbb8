//! Session files: all that a person made around a sequence, in a readable text beside the data (`.pointreel`).
//!
//! **How it works.** A session is JSON, as settings, presets and camera paths are (`text.rs`): the files by their paths
//! from the folder of the session, how they are read, the frame, the view as the line that the window copies, all
//! settings by the words of the command line, clip, range, markers, measurements, labels, the camera path, and what is
//! beside it. The same folder on another machine opens as it was left, in a window and by `render`.
//!
//! **What it may open.** A session comes from anybody, and says what is opened. The files in its folder are; addresses
//! and files elsewhere only after a question, or with an option ([`Beyond`]).
//!
//! **What outlives versions.** A session of a later version of the format is refused, as the same word may mean
//! something else there. Fields that are not known are kept and written again; settings that cannot be read are as by
//! default, and said. All else that is wrong is an error with its line: a session that lacks its view is not the one
//! that was saved.

mod beyond;
mod error;
mod file;
mod model;
mod paths;
mod reach;
mod reading;
#[cfg(test)]
mod tests;
mod text;
mod written;

pub use error::SessionError;
pub use file::{EXTENSION, ReadSession, is_session, session_of};
pub use model::{Compared, ComparedBy, ComparedLayout, Marker, Measured, MeasuredPoint, Session, Unknown};
pub use reach::Beyond;
pub use reading::Reading;
