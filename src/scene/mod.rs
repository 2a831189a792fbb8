//! Plain data between the sequence and a renderer: where the camera is, how the picture is asked for, and the
//! [`ScenePacket`] that holds everything one picture needs. Nothing here knows a graphics API.

mod albedo_curve;
mod ambient_occlusion;
mod camera;
mod clip;
mod compose;
mod content;
mod environment;
mod eye_dome;
mod first_look;
mod followed;
mod gaps;
mod gauge;
mod ground;
mod halo;
mod labels;
mod legend;
mod lights;
mod on_screen;
mod packet;
mod path;
mod photo_depths;
mod photographs;
mod photographs_in_frame;
mod physical_light;
mod pick;
mod picture_plane;
mod pinhole_view;
mod point_size;
mod rims;
mod scale_bar;
mod screen_surfels;
mod shadow;
mod style;
mod view_text;
mod visible_points;

pub use albedo_curve::AlbedoCurve;
pub(crate) use albedo_curve::DIELECTRIC;
pub use ambient_occlusion::AmbientOcclusion;
pub use camera::{Camera, Projection, UpAxis, ViewPreset, ViewTransform};
pub use clip::{Clip, ClipShape};
pub use compose::{Scene, SceneStats};
pub use content::{CodedCells, Content, Selected, Surfels, Voxels};
pub use environment::{Environment, EnvironmentError, EnvironmentFile, EnvironmentMap, EnvironmentWord, Harmonics};
pub use eye_dome::EyeDomeLight;
pub use first_look::{CaptureKind, ColorGuess, FirstLook, Standpoint};
pub(crate) use first_look::{PointSpacing, typical_spacing};
pub use followed::FollowedPoint;
pub use gaps::gap_px;
pub(crate) use gaps::{GAP_ONE_SURFACE, GAP_SOLID, GAPS_PER_SLIT, GAPS_PER_SPECK, PIXEL_LINES, speck_px};
pub use gauge::Gauge;
pub use ground::{GroundPlane, SeenGround};
pub use halo::halo_px;
pub use labels::{Label, LabelOnPicture, MAX_LABEL_CHARS, labels_on_picture};
pub use legend::{Legend, LegendBody, field_title};
pub use lights::{Lamp, Lights};
pub use packet::{PacketParams, ScenePacket};
pub use path::{CameraPath, Keyframe, PathError, PathFileError};
pub use photo_depths::PhotoDepths;
pub(crate) use photo_depths::{DepthMap, DepthRelation};
pub use photographs::{PhotoView, PhotoViews, seen_by_photograph};
pub use photographs_in_frame::PhotographsInFrame;
pub use physical_light::{PhysicalLight, PhysicalTables};
pub use pick::{Pick, PickedNormal, hidden, pick};
pub use picture_plane::PicturePlane;
pub use pinhole_view::sensor_target_distance;
pub use point_size::PointSize;
pub use rims::rim_px;
pub(crate) use rims::{RIM_OPAQUE, RIM_OPEN};
pub use scale_bar::ScaleBar;
pub use screen_surfels::screen_view;
pub use shadow::Shadow;
pub(crate) use style::choices;
pub use style::{
    Antialiasing, Automatic, BackFaces, Backdrop, Background, Choice, CodeStyle, DrawSettings, DrawingSettings,
    DrawingStyle, EyeDome, Footprint, Kernel, LevelStructure, LevelStyle, LightRig, LightSettings, LightStyle,
    Lighting, NormalBits, NormalSource, OfSequence, OffsetBits, OnOff, Painted, ParseChoiceError, PhotoClipping,
    PhotoGains, PhotoHoles, PhotoMode, PhotoRelight, PhotoStyle, PointLight, PointShape, PointSizing, PointStyle,
    Primitive, RendererChoice, Settings, SplatFilter, SplatGeometry, Splatting, Strategy, Style, SurfelColors,
    SurfelSettings, SurfelStyle, VoxelLight, VoxelStyle, coloring, describe,
};
pub use view_text::ParseViewError;
pub use visible_points::{PointImages, ScreenStats, VisiblePoints, VisibleSurfels};
