//! One pose of a sequence: what a decoder read, the validated frame, and the records a renderer draws.

mod ellipse;
mod frame;
mod raw;
mod record;

pub use ellipse::{Ellipse, decode_ellipse, encode_ellipse};
pub use frame::{CloudError, Frame};
pub use raw::{Positions, RawCloud};
pub use record::{PointRecord, ShapeRecord, VoxelRecord, oct_decode, oct_encode};
