//! The calibration of an HDL-64E: each sensor has its own, in the `db.xml` that comes with it.
//!
//! **The file** is a boost serialisation of the maker's own program: in `points_`, one `px` per laser with angles in
//! degrees and lengths in centimetres. **The geometry** follows the HDL-64E S2 manual, appendix F: the distance is
//! corrected by a number measured at 25.04 m and, nearer than that, by one interpolated to the measurement at 2.4 m
//! along X, and another for Y at 1.93 m.

use super::packet::SHOTS;
use crate::io::error::{Fault, mebibytes};
use roxmltree::{Document, Node, ParsingOptions};

/// Number of lasers of each such sensor.
pub(super) const LASERS: usize = 2 * SHOTS;

/// A calibration has some ten numbers a laser.
pub(super) const MAX_BYTES: u64 = 4 << 20;

/// Elements of a file; more are none of a calibration.
const MAX_NODES: u32 = 100_000;

/// Reference distance of a sensor's calibration.
const FAR_M: f64 = 25.04;
const NEAR_X_M: f64 = 2.4;
const NEAR_Y_M: f64 = 1.93;

/// Beyond it the correction of [`FAR_M`] applies to all distances.
const NO_NEARER_M: f64 = 25.0;

/// Calibration values of a laser.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Corrected {
    pub(super) elevation_deg: f64,
    /// To be taken from the azimuth of the head.
    pub(super) azimuth_deg: f64,
    /// Lengths that are added to the distance: at far, and near along X and Y.
    pub(super) far_m: f64,
    pub(super) near_m: Option<[f64; 2]>,
    /// Offset of the laser from the origin, vertical and horizontal.
    pub(super) height_m: f64,
    pub(super) aside_m: f64,
}

/// The lasers of a sensor, and metres of a unit of its distances.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Calibration {
    pub(super) lasers: Vec<Corrected>,
    pub(super) unit_m: f64,
}

/// Returns true if `text` is a calibration, or was meant as one.
pub(super) fn is_calibration(text: &str) -> bool {
    text.contains("boost_serialization") && text.contains("vertCorrection_")
}

/// The calibration in `text`.
///
/// # Errors
/// Its fault.
pub(super) fn parse(text: &str) -> Result<Calibration, Fault> {
    if text.len() as u64 > MAX_BYTES {
        return Err(Fault::header(format!(
            "it has {}, a calibration has less than {}",
            mebibytes(text.len() as u64),
            mebibytes(MAX_BYTES)
        )));
    }
    let options = ParsingOptions {
        // The files have a document type declaration, without entities.
        allow_dtd: true,
        nodes_limit: MAX_NODES,
        ..ParsingOptions::default()
    };
    let document = Document::parse_with_options(text, options)
        .map_err(|error| Fault::header(format!("it is not XML ({error}), expected a Velodyne calibration")))?;
    let unit_cm = document.descendants().find_map(|node| value(node, "distLSB_"));
    let mut lasers: Vec<Option<Corrected>> = vec![None; LASERS];
    for node in document.descendants().filter(|node| node.has_tag_name("px")) {
        let id = child(node, "id_").filter(|id| id.fract() == 0.0 && *id >= 0.0);
        if let Some(laser) = id.and_then(|id| lasers.get_mut(id as usize)) {
            *laser = corrected(node);
        }
    }
    let missing = lasers.iter().position(Option::is_none);
    if let Some(missing) = missing {
        return Err(Fault::entry(
            "laser",
            missing,
            format!("it has no angles there, expected rotCorrection_ and vertCorrection_ of {LASERS} lasers"),
        ));
    }
    Ok(Calibration {
        lasers: lasers.into_iter().flatten().collect(),
        // 2 mm if the file is for the first sensors, which do not state it.
        unit_m: unit_cm.filter(|cm| *cm > 0.0).unwrap_or(0.2) / 100.0,
    })
}

fn corrected(node: Node<'_, '_>) -> Option<Corrected> {
    let metres = |name| child(node, name).unwrap_or(0.0) / 100.0;
    let near_m = [metres("distCorrectionX_"), metres("distCorrectionY_")];
    Some(Corrected {
        elevation_deg: child(node, "vertCorrection_")?,
        azimuth_deg: child(node, "rotCorrection_")?,
        far_m: metres("distCorrection_"),
        // The first sensors were measured at only one distance.
        near_m: near_m.iter().any(|near| *near != 0.0).then_some(near_m),
        height_m: metres("vertOffsetCorrection_"),
        aside_m: metres("horizOffsetCorrection_"),
    })
}

fn child(node: Node<'_, '_>, name: &str) -> Option<f64> {
    node.children().find_map(|child| value(child, name))
}

fn value(node: Node<'_, '_>, name: &str) -> Option<f64> {
    let is_it = node.has_tag_name(name);
    let value: f64 = is_it.then(|| node.text()).flatten()?.trim().parse().ok()?;
    value.is_finite().then_some(value)
}

impl Corrected {
    /// The place that a measurement of `distance_m` is of, at `azimuth_deg` of the head.
    pub(super) fn position(&self, distance_m: f64, azimuth_deg: f64) -> [f64; 3] {
        let (sin, cos) = (azimuth_deg - self.azimuth_deg).to_radians().sin_cos();
        let (rise, run) = self.elevation_deg.to_radians().sin_cos();
        let along_x = |distance: f64| distance * run * sin - self.aside_m * cos;
        let along_y = |distance: f64| distance * run * cos + self.aside_m * sin;
        let far = distance_m + self.far_m;
        let [add_x, add_y] = match self.near_m {
            Some([near_x, near_y]) if distance_m <= NO_NEARER_M => {
                let between = |near: f64, at: f64, near_at: f64| {
                    near + (self.far_m - near) * (at.abs() - near_at) / (FAR_M - near_at)
                };
                [
                    between(near_x, along_x(far), NEAR_X_M),
                    between(near_y, along_y(far), NEAR_Y_M),
                ]
            }
            _ => [self.far_m; 2],
        };
        [
            along_x(distance_m + add_x),
            along_y(distance_m + add_y),
            (distance_m + add_y) * rise + self.height_m,
        ]
    }
}
