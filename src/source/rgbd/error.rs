//! Errors of depth image recordings.

use crate::io::IoError;
use crate::messages::frames_with_indices;
use std::path::PathBuf;

/// Reasons why a recording of depth images, or a frame of it, cannot be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RgbdError {
    /// The system could not read a file or a folder.
    #[error("{} cannot be read ({reason}): check that it exists and its permissions", path.display())]
    Unreadable {
        /// The file or folder.
        path: PathBuf,
        /// The system's reason.
        reason: std::io::Error,
    },
    /// A file that is larger than a frame may be.
    #[error("{} has {bytes} bytes, and {max_bytes} are read: raise --max-memory if that is right", path.display())]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// Its size.
        bytes: u64,
        /// Maximum size that is read, in bytes.
        max_bytes: u64,
    },
    /// An image of more pixels than there is memory for.
    #[error(
        "{} has an image of {} × {} pixels, which would take {bytes} bytes of memory, and may take {max_bytes}: raise \
         --max-memory if the machine has it", path.display(), size_px[0], size_px[1]
    )]
    ManyPixels {
        /// The file that the image is in.
        path: PathBuf,
        /// Width and height.
        size_px: [u32; 2],
        /// Memory they would require, in bytes.
        bytes: u64,
        /// Memory limit, in bytes.
        max_bytes: u64,
    },
    /// An image that cannot be decoded.
    #[error(
        "{} is not a readable image: {reason}. Copy the file again, or remove it to continue without it",
        path.display()
    )]
    Image {
        /// The file.
        path: PathBuf,
        /// Reason for the error.
        reason: String,
    },
    /// A message of a recording whose image cannot be decoded.
    #[error("topic {topic}: {reason}")]
    Message {
        /// The topic.
        topic: String,
        /// Underlying error and its location.
        reason: IoError,
    },
    /// A Matroska file that is not a recording of a depth camera, or an unreadable one.
    #[error("{}: {problem}", path.display())]
    Matroska {
        /// The file.
        path: PathBuf,
        /// Description of the problem, its location and the remedy.
        problem: String,
    },
    /// An image in a Matroska file that cannot be decoded.
    #[error("{}, byte {offset}, track {track}: the image is damaged: {problem}", path.display())]
    Block {
        /// The file.
        path: PathBuf,
        /// The name of the track.
        track: String,
        /// Byte offset of the image.
        offset: u64,
        /// Description of the problem.
        problem: String,
    },
    /// An image of a live stream that cannot be decoded.
    #[error("{} has sent an image that cannot be read: {reason}. The other frames are read", input.display())]
    Received {
        /// The address, or the file of a recording.
        input: PathBuf,
        /// Reason for the error.
        reason: String,
    },
    /// An image of something else than depths.
    #[error(
        "{} holds {found}, and depths are grey of 16 bits or in single floats: check that it is the depth image, and \
         not a picture of it",
        path.display()
    )]
    NotDepth {
        /// The file.
        path: PathBuf,
        /// Content that was found.
        found: &'static str,
    },
    /// An image of another size than its camera's.
    #[error(
        "{} has {} × {} pixels, and its camera {} × {} ({because}): remove it, or name the camera by --intrinsics",
        path.display(), found[0], found[1], expected[0], expected[1]
    )]
    Size {
        /// The file.
        path: PathBuf,
        /// Its size.
        found: [u32; 2],
        /// The camera's size.
        expected: [u32; 2],
        /// Origin of the value.
        because: String,
    },
    /// A camera file without a camera.
    #[error(
        "{} does not tell a camera ({reason}): expected fx,fy,cx,cy, a matrix of 3 × 3 or 4 × 4 numbers, lines such as \
         `fx: 525.0`, the JSON of Open3D, Replica or `pointreel info --json`, or the XML of PCL",
        path.display()
    )]
    Calibration {
        /// The file, or the text as given.
        path: PathBuf,
        /// Reason for the error.
        reason: String,
    },
    /// A list or a trajectory with an invalid line.
    #[error("{}, line {line}: {reason}", path.display())]
    Line {
        /// The file.
        path: PathBuf,
        /// The line, from 1.
        line: usize,
        /// Reason for the error.
        reason: String,
    },
    /// An invalid trajectory.
    #[error(
        "{} is not a trajectory ({reason}): expected lines of TUM (time x y z qx qy qz qw, or no time), blocks of \
         Redwood (.log), columns that a header names (timestamp,tx,ty,tz,qw,qx,qy,qz), matrices of 3 × 4 or 4 × 4 \
         numbers, or JSON with such matrices",
        path.display()
    )]
    Trajectory {
        /// The file.
        path: PathBuf,
        /// Reason for the error.
        reason: String,
    },
    /// Options that do not fit the input.
    #[error("{reason}")]
    Options {
        /// Suggested remedy.
        reason: String,
    },
    /// A folder of depth images without one.
    #[error(
        "{} has no depth image ({looked_for}): name the folder of the recording, or --depth-images PATTERN",
        path.display()
    )]
    NoDepth {
        /// The folder.
        path: PathBuf,
        /// Names or patterns that were searched for.
        looked_for: String,
    },
    /// A recording of OpenNI.
    #[error(
        "{} is a recording of OpenNI, whose frames are packed by codecs that only OpenNI itself has: export it as \
         images with a tool of OpenNI, and open their folder",
        path.display()
    )]
    Oni {
        /// The file.
        path: PathBuf,
    },
    /// Frames to be merged without known poses.
    #[error("{} cannot be merged: {reason}", frames_with_indices(*first, *last))]
    NotMerged {
        /// The first.
        first: usize,
        /// The last.
        last: usize,
        /// The reason.
        reason: String,
    },
}
