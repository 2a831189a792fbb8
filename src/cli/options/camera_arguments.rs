//! Where the camera stands, on the command line.

use super::arguments::{VIEW, elevation, field_of_view, finite, positive_f64};
use crate::headless::CameraChoice;
use crate::messages::frame_with_index;
use crate::scene::{Camera, FirstLook, Projection, UpAxis};
use crate::sequence::Sequence;
use anyhow::Context as _;
use clap::Args;

/// Where the camera stands; what is not given frames the cloud.
#[derive(Debug, Clone, Default, Args)]
#[command(next_help_heading = VIEW)]
pub(in crate::cli) struct CameraArgs {
    /// A view as the window copies it (Ctrl+C), of which other options change parts
    #[arg(long, value_name = "TEXT")]
    view: Option<Camera>,

    /// Which axis is up: x, y, z, -x, -y or -z; guessed when not given
    #[arg(long, value_name = "AXIS", allow_hyphen_values = true)]
    up: Option<UpAxis>,

    /// Turn about the up axis in degrees; 0 is the front
    #[arg(long, value_name = "DEG", allow_negative_numbers = true, value_parser = finite)]
    azimuth: Option<f64>,

    /// Height above the horizon in degrees, -90 to 90
    #[arg(long, value_name = "DEG", allow_negative_numbers = true, value_parser = elevation)]
    elevation: Option<f64>,

    /// From the middle of the cloud to the eye in scene units
    #[arg(long, value_name = "D", value_parser = positive_f64)]
    distance: Option<f64>,

    /// Vertical field of view in degrees, 1 to 170
    #[arg(long, value_name = "DEG", value_parser = field_of_view)]
    fov: Option<f64>,

    /// Draw by parallel rays: what is farther away is as large
    #[arg(long)]
    orthographic: bool,

    /// Show all points, outliers and what is far away as well
    #[arg(long, conflicts_with = "view")]
    frame_all: bool,

    /// Look from the depth camera; its image has the pixels of a picture of its size
    #[arg(long, conflicts_with_all = ["view", "azimuth", "elevation", "distance", "fov", "orthographic", "frame_all"])]
    from_sensor: bool,

    /// Look from photograph N, counted from 0; its image has the pixels of a picture of its size
    #[arg(
        long,
        value_name = "N",
        conflicts_with_all = [
            "from_sensor", "view", "azimuth", "elevation", "distance", "fov", "orthographic", "frame_all",
        ]
    )]
    photo_camera: Option<usize>,
}

impl CameraArgs {
    /// Takes the view of a session where another one is not asked for; options change parts of it.
    pub(in crate::cli) fn take_view(&mut self, view: Option<Camera>) {
        if !self.frame_all {
            self.view = self.view.or(view);
        }
    }

    /// Whether the up axis is that of an option, be it a whole view.
    pub(in crate::cli) fn sets_up(&self) -> bool {
        self.up.is_some() || self.view.is_some()
    }

    /// The camera for a picture of frame `index`.
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
            let set = sequence.source().photographs(index);
            let set = set.with_context(|| {
                let advice = match sequence.source().sensor(index) {
                    Some(_) => {
                        ": colour images of depth cameras are, where frames are merged, as by --merge-frames 0..4"
                    }
                    None => "",
                };
                format!("--photo-camera is for calibrated photographs, and the input is none{advice}")
            })?;
            let count = set.photos.len();
            let photo = set
                .photos
                .get(number)
                .with_context(|| format!("there is no photograph {number}: the input has {count}, counted from 0"))?;
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
