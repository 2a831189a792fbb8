//! Camera position, on the command line.

use super::arguments::{VIEW, elevation, field_of_view, finite, positive_f64};
use crate::headless::CameraChoice;
use crate::messages::frame_with_index;
use crate::scene::{Camera, FirstLook, Projection, UpAxis};
use crate::sequence::Sequence;
use anyhow::Context as _;
use clap::Args;

/// Camera position; options not given frame the cloud.
#[derive(Debug, Clone, Default, Args)]
#[command(next_help_heading = VIEW)]
pub(in crate::cli) struct CameraArgs {
    /// Start from a camera view copied in the window (Ctrl+C); the other options change parts of it
    #[arg(long, alias = "camera", value_name = "TEXT")]
    view: Option<Camera>,

    /// Up axis: x, y, z, -x, -y or -z [default: estimated]
    #[arg(long, value_name = "AXIS", allow_hyphen_values = true)]
    up: Option<UpAxis>,

    /// Orbit about the up axis, in degrees; 0 is the front
    #[arg(long, value_name = "DEG", allow_negative_numbers = true, value_parser = finite)]
    azimuth: Option<f64>,

    /// Elevation above the horizon, in degrees
    #[arg(long, value_name = "-90..90", allow_negative_numbers = true, value_parser = elevation)]
    elevation: Option<f64>,

    /// Distance from the centre of the cloud to the camera, in scene units
    #[arg(long, value_name = "LENGTH", hide_short_help = true, value_parser = positive_f64)]
    distance: Option<f64>,

    /// Vertical field of view, in degrees
    #[arg(long, value_name = "1..170", value_parser = field_of_view, hide_short_help = true)]
    fov: Option<f64>,

    /// Orthographic projection
    #[arg(long, hide_short_help = true)]
    orthographic: bool,

    /// Fit all points into the image, outliers included
    #[arg(long, alias = "fit-all", conflicts_with = "view", hide_short_help = true)]
    frame_all: bool,

    /// Render from the pose of the depth camera; at its image size, pixels coincide
    #[arg(
        long,
        hide_short_help = true,
        conflicts_with_all = ["view", "azimuth", "elevation", "distance", "fov", "orthographic", "frame_all"],
    )]
    from_sensor: bool,

    /// Render from the pose of input image N, counted from 0; at its image size, pixels coincide
    #[arg(
        long,
        alias = "image-camera",
        hide_short_help = true,
        value_name = "N",
        conflicts_with_all = [
            "from_sensor", "view", "azimuth", "elevation", "distance", "fov", "orthographic", "frame_all",
        ]
    )]
    photo_camera: Option<usize>,
}

impl CameraArgs {
    /// Takes the view of a session unless another one is requested; options change parts of it. Without a view, takes
    /// the chosen up axis.
    pub(in crate::cli) fn take_view(&mut self, view: Option<Camera>, up: Option<UpAxis>) {
        if !self.frame_all {
            self.view = self.view.or(view);
        }
        if self.view.is_none() {
            self.up = self.up.or(up);
        }
    }

    /// Returns true if the up axis is set by an option, be it a whole view.
    pub(in crate::cli) fn sets_up(&self) -> bool {
        self.up.is_some() || self.view.is_some()
    }

    /// The camera for an image of frame `index`.
    pub(in crate::cli) fn camera(
        &self,
        look: &FirstLook,
        sequence: &Sequence,
        index: usize,
        size_px: [u32; 2],
    ) -> anyhow::Result<Camera> {
        let origin = sequence.origin();
        let upright = || self.up.map_or_else(|| look.clone(), |up| look.clone().with_up(up));
        if let Some(number) = self.photo_camera {
            let set = sequence.source().posed_images(index);
            let set = set.with_context(|| {
                let advice = match sequence.source().sensor(index) {
                    Some(_) => {
                        ": colour images of depth cameras are used if frames are merged, as by --merge-frames 0..4"
                    }
                    None => "",
                };
                format!("--photo-camera needs calibrated images, and the input has none{advice}")
            })?;
            let count = set.photos.len();
            let photo = set
                .photos
                .get(number)
                .with_context(|| format!("image {number} does not exist: the input has {count}, counted from 0"))?;
            return Ok(upright().camera_of_photo(photo, origin));
        }
        if !self.from_sensor {
            return Ok(self.choice().camera(look, origin, size_px));
        }
        let sensor = sequence.source().sensor(index).with_context(|| {
            format!(
                "nothing says which camera took {}: --from-sensor is for recordings of depth images",
                frame_with_index(index, sequence.len())
            )
        })?;
        Ok(upright().camera_of_sensor(&sensor, origin))
    }

    fn choice(&self) -> CameraChoice {
        CameraChoice {
            view: self.view,
            projection: self.orthographic.then_some(Projection::Orthographic),
            up: self.up,
            azimuth_deg: self.azimuth,
            elevation_deg: self.elevation,
            distance: self.distance,
            fov_deg: self.fov,
            frames_all: self.frame_all,
        }
    }
}
