//! Plain data between the sequence and a renderer: where the camera is, how the picture is asked for, and the
//! [`ScenePacket`] that holds everything one picture needs. Nothing here knows a graphics API.

mod camera;
mod clip;
mod lod;
mod on_screen;
mod packet;
mod path;
mod pick;
mod settings;
mod view_text;

pub use camera::{Camera, UpAxis, ViewPreset, ViewTransform};
pub use clip::{Clip, ClipShape};
pub use lod::Lod;
pub use packet::{CodedCells, Scene, ScenePacket, SceneStats, Voxels};
pub use path::{CameraPath, Keyframe, PathError, PathFileError};
pub use pick::{Pick, PickedNormal, pick};
pub(crate) use settings::choices;
pub use settings::{
    Background, Footprint, Lighting, NormalBits, OffsetBits, ParseChoiceError, Primitive,
    Projection, RendererChoice, Settings, Splatting, Strategy,
};
pub use view_text::ParseViewError;
