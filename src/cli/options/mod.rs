//! Options that several commands share, and the settings that they make.

pub(super) mod arguments;
pub(super) mod camera_arguments;
pub(super) mod colors;
pub(super) mod device_select;
pub(super) mod known_values;
pub(super) mod poses;
pub(super) mod reel_arguments;
pub(super) mod render_arguments;
pub(super) mod rgbd_arguments;
pub(super) mod size_arguments;
pub(super) mod sources;
pub(super) mod style_arguments;
pub(super) mod usage;
pub(super) mod values;
pub(super) mod video_arguments;
