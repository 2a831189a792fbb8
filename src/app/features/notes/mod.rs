//! Notes: a text of the document.

mod in_window;
mod panel;

/// The notes of the open sequence; the document has them.
#[derive(Debug, Default)]
pub struct Notes;
