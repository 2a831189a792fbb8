//! Plain data between the sequence and a renderer: the camera, the settings of the image, and the [`ScenePacket`] that
//! holds everything one image needs. Nothing here knows a graphics API.

mod annotations;
mod clip;
mod compose;
mod content;
mod effects;
mod environment;
mod first_look;
mod light;
mod packet;
mod photos;
mod remade;
mod sorting;
mod style;
mod view;
mod visible;

pub use annotations::followed::FollowedPoint;
pub use annotations::labels::{Label, LabelOnPicture, MAX_LABEL_CHARS, labels_on_picture};
pub use annotations::legend::{Legend, LegendBody, field_title};
pub use annotations::measurement_kind::MeasurementKind;
pub use annotations::scale_bar::ScaleBar;
pub use clip::{Clip, ClipShape};
pub use compose::{Scene, SceneStats};
pub use content::{CodedCells, Content, Selected, Surfels, Voxels};
pub use effects::ambient_occlusion::AmbientOcclusion;
pub use effects::eye_dome::EyeDomeLight;
pub use effects::gaps::gap_px;
pub(crate) use effects::gaps::{GAP_ONE_SURFACE, GAP_SOLID, GAPS_PER_SLIT, GAPS_PER_SPECK, PIXEL_LINES, speck_px};
pub use effects::halo::halo_px;
pub use effects::rims::rim_px;
pub(crate) use effects::rims::{RIM_OPAQUE, RIM_OPEN};
pub use environment::{Environment, EnvironmentError, EnvironmentFile, EnvironmentMap, EnvironmentWord, Harmonics};
pub use first_look::{CaptureKind, ColorGuess, FirstLook, Standpoint};
pub(crate) use first_look::{PointSpacing, typical_spacing};
pub use light::albedo_curve::AlbedoCurve;
pub(crate) use light::albedo_curve::DIELECTRIC;
pub use light::lights::{Lamp, Lights};
pub use light::physical_light::{PhysicalLight, PhysicalTables};
pub use light::shadow::Shadow;
pub use packet::{PacketParams, ScenePacket};
pub use photos::photo_depths::PhotoDepths;
pub(crate) use photos::photo_depths::{DepthMap, DepthRelation};
pub use photos::photo_views::{PhotoView, PhotoViews, seen_by_photo};
pub use photos::photos_in_frame::PhotosInFrame;
pub(crate) use style::choices;
pub use style::{
    Antialiasing, Automatic, BackFaces, Backdrop, Background, Choice, CodeStyle, DrawSettings, DrawingSettings,
    DrawingStyle, EstimationStyle, EyeDome, Footprint, Kernel, LevelStructure, LevelStyle, LightRig, LightSettings,
    LightStyle, Lighting, NormalBits, NormalFit, NormalSource, OfSequence, OffsetBits, OnOff, Painted,
    ParseChoiceError, PhotoClipping, PhotoGains, PhotoHoles, PhotoMode, PhotoRelight, PhotoStyle, PointLight,
    PointShape, PointSizing, PointStyle, Primitive, RendererChoice, Settings, SplatFilter, SplatGeometry, Splatting,
    Strategy, Style, SurfelColors, SurfelSettings, SurfelStyle, VisibilityShape, VoxelLight, VoxelStyle, coloring,
    describe,
};
pub use view::camera::{Camera, Projection, UpAxis, ViewPreset, ViewTransform};
pub use view::ground::{GroundPlane, SeenGround};
pub use view::path::{CameraPath, Keyframe, PathError, PathFileError};
pub use view::picture_plane::PicturePlane;
pub use view::pinhole_view::sensor_target_distance;
pub use view::view_text::ParseViewError;
pub use visible::pick::{Pick, PickedNormal, hidden, pick};
pub use visible::point_size::PointSize;
pub use visible::screen_surfels::screen_view;
pub use visible::visible_points::{PointImages, ScreenStats, VisiblePoints, VisibleSurfels};
