//! Visible points (surfels) of a frame in a client's view, with normals and radii, sent instead of the whole frame
//! (Hofer et al. 2018: the renderer sends a view, the computer with the sensor answers with visible splats).
//!
//! **How it works.** A frame is decoded once for all clients that have sent a view, with the filters of the server.
//! Each of their senders separates visible points from hidden ones and fits planes around them
//! ([`crate::analysis::screen`]), using the newest view that it knows when the frame is sent. The message is an
//! ordinary one of points, so clients need no extra support.
//!
//! **When it wins.** Bytes and client work depend on the visible part, not on the whole: this pays for clouds that are
//! larger than a rendered image, such as merged frames. A single depth image is smaller when sent as an image.

use crate::analysis::screen::{ScreenCloud, ScreenEstimator, ScreenView, Search};
use crate::cloud::{Frame, PointRecord, Positions, RawCloud, oct_decode};
use crate::scene::{PointSpacing, typical_spacing};
use crate::wire::View;
use glam::{DVec3, Vec3};

/// Returns the point spacing of `cloud`; `None` if it is not a valid cloud.
pub(super) fn spacing_of(cloud: &RawCloud, origin: DVec3) -> Option<PointSpacing> {
    let frame = Frame::from_raw(cloud.clone(), origin).ok()?;
    Some(typical_spacing(&frame))
}

/// A decoded frame, for those who have sent a view.
#[derive(Debug)]
pub(super) struct WholeFrame {
    cloud: RawCloud,
    /// Origin that the positions of `records` are relative to.
    origin: DVec3,
    records: Vec<PointRecord>,
    screen: ScreenCloud,
}

/// Returns an origin near which the coordinates of `cloud` are small: zero for single-precision floats, otherwise the
/// centre of the bounding box.
pub(super) fn origin_of(cloud: &RawCloud) -> DVec3 {
    match (&cloud.positions, cloud.positions.finite_bounds()) {
        (Positions::F64(_), (_, Some((min, max)))) => (0.5 * (min + max)).round(),
        _ => DVec3::ZERO,
    }
}

impl WholeFrame {
    /// The points of `cloud`, which are `spacing` apart.
    pub(super) fn new(cloud: RawCloud, origin: DVec3, spacing: PointSpacing) -> Self {
        let record = |position: Vec3| PointRecord {
            position: position.to_array(),
            color: [255; 4],
        };
        let records = match &cloud.positions {
            Positions::F32(positions) => positions.iter().map(|&position| record(position.into())).collect(),
            Positions::F64(positions) => {
                let relative = |&position: &[f64; 3]| (DVec3::from_array(position) - origin).as_vec3();
                positions.iter().map(relative).map(record).collect()
            }
        };
        Self {
            screen: ScreenCloud {
                spacing: spacing.typical,
                closing: spacing.closing,
                sensor: cloud.sensor.map(|sensor| (sensor - origin).as_vec3()),
            },
            origin,
            records,
            cloud,
        }
    }

    /// Returns the points visible in `view`. Normals and radii from the file are unchanged.
    pub(super) fn seen(&self, view: &View, estimator: &mut ScreenEstimator) -> RawCloud {
        let eye = view.eye - self.origin;
        let eye_high = eye.as_vec3();
        let view = ScreenView {
            rotation: view.rotation,
            eye_high,
            eye_low: (eye - eye_high.as_dvec3()).as_vec3(),
            near: view.near,
            size_px: view.size_px,
            px_per_slope: view.px_per_slope,
            center_px: view.center_px,
        };
        let visible = estimator.cull(&view, &self.records, &self.screen);
        let mut attributes = self.cloud.attributes.gathered(&visible.slots);
        if attributes.normals.is_none() || attributes.radii.is_none() {
            // Bisecting the radius of each point takes three to four times as long.
            let shapes = estimator.surface(&visible, &self.screen, Search::Fixed);
            let normals = shapes.iter().map(|shape| oct_decode(shape.normal).to_array());
            attributes.normals.get_or_insert_with(|| normals.collect());
            let radii = shapes.iter().map(|shape| shape.radius);
            attributes.radii.get_or_insert_with(|| radii.collect());
        }
        let places = visible.slots.iter().map(|&slot| slot as usize);
        let positions = match &self.cloud.positions {
            Positions::F32(positions) => Positions::F32(places.map(|place| positions[place]).collect()),
            Positions::F64(positions) => Positions::F64(places.map(|place| positions[place]).collect()),
        };
        let mut seen = RawCloud::from_positions(positions);
        seen.attributes = attributes;
        (seen.sensor, seen.convention, seen.unit) = (self.cloud.sensor, self.cloud.convention, self.cloud.unit);
        seen
    }
}
