//! The views of the tests of Sainz and Pajarola 2004 §6.1: three distances, at each of which the object turns by 2° per
//! image.

use crate::bench::subject::Subject;
use crate::scene::Camera;
use crate::sequence::PreparedFrame;

/// Rotation from image to image, degrees.
const STEP_DEG: f64 = 2.0;

/// Names, and distances as parts of the one that shows the whole object.
pub(super) const VIEWS: [(&str, f64); 3] = [("zoomed out", 4.0), ("full", 1.0), ("zoomed in", 0.3)];

/// `count` steps from a distance of [`VIEWS`].
pub(super) fn cameras(subject: &Subject<'_>, frame: &PreparedFrame, distance: f64, count: usize) -> Vec<Camera> {
    let framing = subject.framing(frame);
    let camera = |step| Camera {
        azimuth_deg: framing.azimuth_deg + STEP_DEG * step as f64,
        distance: distance * framing.distance,
        ..framing
    };
    (0..count).map(camera).collect()
}
