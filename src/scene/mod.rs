//! Plain data between the sequence and a renderer: where the camera is, how the picture is asked for, and the
//! [`ScenePacket`] that holds everything one picture needs. Nothing here knows a graphics API.

mod ambient_occlusion;
mod camera;
mod clip;
mod compose;
mod content;
mod eye_dome;
mod first_look;
mod ground;
mod halo;
mod in_view;
mod legend;
mod lights;
mod on_screen;
mod packet;
mod path;
mod pick;
mod point_size;
mod scale_bar;
mod shadow;
mod style;
mod view_text;

pub use ambient_occlusion::AmbientOcclusion;
pub use camera::{Camera, Projection, UpAxis, ViewPreset, ViewTransform};
pub use clip::{Clip, ClipShape};
pub use compose::{Scene, SceneStats};
pub use content::{CodedCells, Content, Surfels, Voxels};
pub use eye_dome::EyeDomeLight;
pub use first_look::{CaptureKind, FirstLook, Standpoint};
pub use ground::{GroundPlane, SeenGround};
pub use halo::halo_px;
pub use in_view::points_in_view;
pub use legend::{Legend, LegendBody, field_title};
pub use lights::{Lamp, Lights};
pub use packet::ScenePacket;
pub use path::{CameraPath, Keyframe, PathError, PathFileError};
pub use pick::{Pick, PickedNormal, pick};
pub use point_size::PointSize;
pub use scale_bar::ScaleBar;
pub use shadow::Shadow;
pub(crate) use style::choices;
pub use style::{
    Antialiasing, BackFaces, Backdrop, Background, CodeStyle, DrawingStyle, EyeDome, Footprint, Kernel, LevelStructure,
    LevelStyle, LightRig, LightStyle, Lighting, NormalBits, OfSequence, OffsetBits, OnOff, ParseChoiceError,
    PointLight, PointShape, PointSizing, PointStyle, Primitive, RendererChoice, SplatFilter, SplatGeometry, Splatting,
    Strategy, Style, SurfelStyle, VoxelLight, VoxelStyle, coloring, describe,
};
pub use view_text::ParseViewError;
