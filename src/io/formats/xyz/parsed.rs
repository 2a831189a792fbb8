//! A table before it is divided into frames.

use super::counted::Counted;
use super::naming::Naming;
use super::rows::ParsedRows;

/// Rows, known properties of their columns, and their positions in the file.
pub(super) struct Parsed {
    pub(super) rows: ParsedRows,
    pub(super) names: Vec<String>,
    /// As the file has them; empty where it has none.
    pub(super) raw_names: Vec<String>,
    /// The comment or title before the first row; empty where it is the line of names or there is none.
    pub(super) title: String,
    pub(super) naming: Naming,
    pub(super) counted: Option<Counted>,
    /// True if all points of a file of several counts are one cloud.
    pub(super) is_one_cloud: bool,
}
