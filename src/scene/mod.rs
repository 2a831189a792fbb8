//! Plain data between the sequence and a renderer: where the camera is, how the picture is asked for, and the
//! [`ScenePacket`] that holds everything one picture needs. Nothing here knows a graphics API.

mod camera;
mod lod;
mod packet;
mod path;
mod settings;

pub use camera::{Camera, UpAxis, ViewPreset, ViewTransform};
pub use lod::Lod;
pub use packet::{CodedCells, Scene, ScenePacket, SceneStats, Voxels};
pub use path::{CameraPath, Keyframe, PathError, PathFileError};
pub use settings::{
    Background, Footprint, Lighting, NormalBits, OffsetBits, ParseChoiceError, Primitive,
    RendererChoice, Settings, Splatting, Strategy,
};
