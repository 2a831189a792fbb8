//! Attribute changes of moved nodes, each predicted from its parent and from adjacent nodes that are known already; and
//! the definitions of normals and offsets.

mod channels;
mod normal_grid;
mod normals;
mod offsets;
mod value_coder;

pub(super) use channels::{channel_contexts, code_channels};
pub(super) use normal_grid::{MISSING, NormalGrid};
pub(super) use normals::{NORMAL_CONTEXTS, Turned, code_turned_normals};
pub(super) use offsets::{LARGEST_OFFSET, offset_edges, offset_of, offset_of_code, offset_parts};
pub(super) use value_coder::{ValueCoder, ValueModels};
