//! Formats that one cloud is read from, a file or folder each, and what their table knows of them. A format knows `columns` and `files`, never another format's reader.

pub(super) mod bin;
pub(super) mod draco;
pub(super) mod e57;
pub(super) mod elevation_grid;
pub(super) mod gltf;
pub(super) mod las;
pub(super) mod npy;
pub(super) mod obj;
pub(super) mod off;
pub(super) mod pcd;
pub(super) mod ply;
pub(super) mod ptx;
pub(super) mod splats;
pub(super) mod stl;
pub(super) mod xyz;
