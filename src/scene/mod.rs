//! Plain data between the sequence and a renderer: where the camera is, how the picture is asked for, and the
//! [`ScenePacket`] that holds everything one picture needs. Nothing here knows a graphics API.

mod background;
mod camera;
mod clip;
mod eye_dome;
mod first_look;
mod ground;
mod in_view;
mod legend;
mod lod;
mod on_screen;
mod packet;
mod path;
mod pick;
mod scale_bar;
mod settings;
mod view_text;

pub use background::Background;
pub use camera::{Camera, UpAxis, ViewPreset, ViewTransform};
pub use clip::{Clip, ClipShape};
pub use eye_dome::{EyeDome, EyeDomeLight};
pub use first_look::{FirstLook, Kind, Standpoint};
pub use ground::{GroundPlane, SeenGround};
pub use in_view::points_in_view;
pub use legend::{Legend, LegendBody, field_title};
pub use lod::Lod;
pub use packet::{CodedCells, Scene, ScenePacket, SceneStats, Voxels};
pub use path::{CameraPath, Keyframe, PathError, PathFileError};
pub use pick::{Pick, PickedNormal, pick};
pub use scale_bar::ScaleBar;
pub(crate) use settings::choices;
pub use settings::{
    BackFaces, Footprint, Lighting, NormalBits, OffsetBits, ParseChoiceError, Primitive,
    Projection, RendererChoice, Settings, Splatting, Strategy, VoxelLight,
};
pub use view_text::ParseViewError;
