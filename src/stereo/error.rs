//! Stereo errors: reasons why images yield no depth.

/// Error in the images, cameras or settings of stereo.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StereoError {
    /// Images of one pair that differ in size.
    #[error(
        "the left image has {} × {} pixels and the right one {} × {}: expected images of one size; rectify them first",
        left[0], left[1], right[0], right[1]
    )]
    SizesDiffer {
        /// Width and height of the left image.
        left: [u32; 2],
        /// Width and height of the right image.
        right: [u32; 2],
    },
    /// An image that its camera does not have.
    #[error(
        "view {view} has an image of {} × {} pixels and a camera of {} × {}: expected one size; scale the camera with \
         the image",
        image[0], image[1], camera[0], camera[1]
    )]
    OtherCamera {
        /// View index, from 0.
        view: usize,
        /// Width and height of the image.
        image: [u32; 2],
        /// Width and height of the camera's image.
        camera: [u32; 2],
    },
    /// A lens that has to be taken out before.
    #[error("view {view} has lens distortion: expected a pinhole; undistort the image first")]
    NoPinhole {
        /// View index, from 0.
        view: usize,
    },
    /// An invalid pose.
    #[error("the pose of view {view} is not a rotation with a finite position: expected camera_from_world, no scale")]
    NoPose {
        /// View index, from 0.
        view: usize,
    },
    /// Two views from one place.
    #[error("both views stand at one place: expected two places, for depth is seen from where they differ")]
    NoBaseline,
    /// Views that look along the line between them, or away from each other.
    #[error("the views cannot be rectified: {0}; choose a pair that stands side by side and looks the same way")]
    NotSideBySide(&'static str),
    /// An invalid range of disparities.
    #[error("disparities from {min} to {max} px: expected the smaller first and at most {most} between them")]
    NoRange {
        /// Smallest disparity.
        min: i32,
        /// Largest disparity.
        max: i32,
        /// Maximum number of disparities tried.
        most: usize,
    },
    /// Images that show nothing of the same.
    #[error(
        "the images have too little in common to find their disparities: expected two images of one textured scene; \
         give the range if they are"
    )]
    NothingAlike,
    /// Distances that are none.
    #[error("depths from {near} to {far} m in {planes} planes: expected 0 < near < far, and 2 to {most} planes")]
    NoDepths {
        /// Nearest distance in metres.
        near: f64,
        /// Farthest distance in metres.
        far: f64,
        /// Number of planes.
        planes: usize,
        /// Maximum number of planes tried.
        most: usize,
    },
    /// Penalties that bytes cannot hold.
    #[error("penalties P1 = {p1} and P2 from {p2_min} to {p2}: expected P1 < least P2 ≤ P2 and P1 + P2 ≤ {most}")]
    NoPenalties {
        /// For a step of one disparity.
        p1: u8,
        /// For more, where brightness changes most.
        p2_min: u8,
        /// For more, where brightness is even.
        p2: u8,
        /// Maximum sum of P1 and P2.
        most: u8,
    },
    /// Memory beyond the limit of stereo.
    #[error(
        "stereo of these images takes {needed_mib} MiB: expected at most {max_mib}; scale the images down or narrow \
         the range"
    )]
    TooLarge {
        /// Memory required.
        needed_mib: u64,
        /// Memory limit.
        max_mib: u64,
    },
    /// Fewer views than a plane sweep has to have.
    #[error("{0} views: expected at least 2")]
    TooFewViews(usize),
    /// Numbers of depth maps and views that differ.
    #[error("{maps} depth maps of {views} views: expected one per view")]
    CountsDiffer {
        /// Number of depth maps.
        maps: usize,
        /// Number of views.
        views: usize,
    },
    /// Cancelled by the caller.
    #[error("depths were not made to the end: it was cancelled")]
    Cancelled,
}
