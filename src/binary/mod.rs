//! Binary numbers as files hold them: their types, the header of arrays of numpy, hexadecimal digits.

mod hex;
mod npy;
mod scalar;

pub(crate) use hex::hex;
pub(crate) use npy::{Header, Layout, Number, half};
pub(crate) use scalar::Scalar;
