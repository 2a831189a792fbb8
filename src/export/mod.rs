//! Images of any size, and videos of camera paths, as files.
//!
//! **How it works.** An image larger than a texture is drawn part by part and written row by row (`picture.rs`). A
//! video is a [`CameraPath`](crate::scene::CameraPath) drawn image by image (`video.rs`), while earlier images are
//! encoded on another thread by a [`FrameSink`]: PNG files, GIF, WebP, or MP4 by `ffmpeg`. Everything is written under
//! a hidden name until it is complete, so a cancelled or failed export leaves nothing that looks finished. Equal input
//! makes equal bytes, except for MP4, whose bytes depend on the installed `ffmpeg`.

mod changes;
mod error;
mod format;
mod gif;
mod limits;
mod mp4;
mod open;
mod overlay;
mod picture;
mod picture_format;
mod picture_name;
mod png_files;
mod scale_bar;
mod sink;
mod strokes;
mod video;
mod webp;

pub use error::ExportError;
pub use format::VideoFormat;
pub use limits::MAX_EDGE_PX;
pub use mp4::has_ffmpeg;
pub use open::open_sink;
pub use overlay::draw_labels;
pub use picture::{Picture, PictureSize, check_size, draw_picture, write_picture, write_picture_observed, write_png};
pub use picture_format::{PictureFormat, encode_picture};
pub use png_files::{FRAME_PLACEHOLDER, has_placeholder, numbered, picture_names};
pub use sink::{FrameSink, VideoStream};
pub use video::{PictureDone, Video, export_video, render_path};
