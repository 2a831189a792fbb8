//! Contents of a file that a cloud does not store: reported when the file is converted, which would lose them.

/// Something that was not read, or with fewer digits.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Dropped {
    /// A clause, such as `lists of points are not read: neighbours`.
    pub what: String,
    /// True if it matters to viewers of the file, too, and not only for conversions.
    pub is_noted: bool,
}

impl Dropped {
    /// Something of the file that is shown nowhere.
    pub fn noted(what: impl Into<String>) -> Self {
        Self {
            what: what.into(),
            is_noted: true,
        }
    }

    /// A loss that makes no difference to the image.
    pub fn quiet(what: impl Into<String>) -> Self {
        Self {
            what: what.into(),
            is_noted: false,
        }
    }
}
