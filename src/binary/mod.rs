//! Binary numbers as files hold them: their types, and what the header of an array of numpy says of them.

mod npy;
mod scalar;

pub(crate) use npy::{Header, Layout, Number, half};
pub(crate) use scalar::Scalar;
