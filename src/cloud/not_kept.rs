//! What of a file a cloud does not hold: said when the file is converted, where it would be lost.

/// Something that was not read, or with fewer digits.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct NotKept {
    /// A clause, such as `lists of points are not read: neighbours`.
    pub what: String,
    /// Whether somebody who looks at the file wants to know it, too, and not only who converts it.
    pub is_noted: bool,
}

impl NotKept {
    /// Something of the file that is shown nowhere.
    pub fn noted(what: impl Into<String>) -> Self {
        Self {
            what: what.into(),
            is_noted: true,
        }
    }

    /// Something that makes no difference to a picture.
    pub fn quiet(what: impl Into<String>) -> Self {
        Self {
            what: what.into(),
            is_noted: false,
        }
    }
}
