//! The two that are compared.

/// Left or right of the line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// Left.
    A,
    /// Right.
    B,
}
