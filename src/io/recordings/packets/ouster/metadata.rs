//! The metadata of an Ouster sensor: a JSON companion file of the capture, required to read its packets.
//!
//! Generations of it differ in their structure. Firmware 1 and 2.0 write one flat object with `data_format` in it;
//! later ones have sections (`sensor_info`, `beam_intrinsics`, `lidar_intrinsics`, `lidar_data_format`,
//! `config_params`). Each name is searched in its section, then at the root, so that mixtures of both are read too.
//!
//! Ouster firmware user manual, "Sensor metadata"; missing entries default to the properties of sensors from before the
//! entries existed.

use super::profile::{FUSA, LEGACY, PacketShape, Profile};
use crate::io::error::Fault;
use glam::{DMat4, DVec3};
use serde_json::Value;

/// Angles of 128 beams and 128 pixel shifts take some kilobytes.
pub(super) const MAX_BYTES: u64 = 4 << 20;

/// Max beams of a sensor, columns of a revolution and of a packet: twice those of any existing one.
const MAX_BEAMS: u64 = 256;
const MAX_COLUMNS: u64 = 8192;
const MAX_PACKET_COLUMNS: u64 = 64;

/// Height of the lidar above the foot of the sensor if the metadata does not specify it.
const HEIGHT_MM: f64 = 36.18;

/// Metadata of a sensor.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Metadata {
    /// For people: the product, or the maker.
    pub(super) product: String,
    pub(super) shape: PacketShape,
    /// The port that its packets are sent to.
    pub(super) port: Option<u16>,
    pub(super) serial: Option<u64>,
    /// Columns of a revolution.
    pub(super) columns: usize,
    /// Altitude angle of each beam, degrees.
    pub(super) altitudes_deg: Vec<f64>,
    pub(super) azimuths_deg: Vec<f64>,
    /// From the axis to where beams begin: along the head, and up.
    pub(super) beam_origin_mm: [f64; 2],
    /// Lengths in millimetres.
    pub(super) sensor_from_lidar: DMat4,
}

/// Returns true if `text` is metadata, or was meant as such.
pub(super) fn is_metadata(text: &str) -> bool {
    text.contains("beam_altitude_angles")
}

/// The metadata in `text`.
///
/// # Errors
/// Its fault.
pub(super) fn parse(text: &str) -> Result<Metadata, Fault> {
    let root: Value = serde_json::from_str(text).map_err(|error| {
        Fault::header(format!(
            "it is not JSON ({error}), expected the metadata of an Ouster sensor"
        ))
    })?;
    let sections = Sections { root: &root };
    let beams = |name: &str| sections.find(&["beam_intrinsics"], name);
    let info = |name: &str| sections.find(&["sensor_info"], name);

    let altitudes_deg = angles(beams("beam_altitude_angles"), "beam_altitude_angles")?;
    let azimuths_deg = angles(beams("beam_azimuth_angles"), "beam_azimuth_angles")?;
    let pixels = match sections.format("pixels_per_column") {
        Some(value) => count(value, "pixels_per_column", MAX_BEAMS)?,
        None => altitudes_deg.len(),
    };
    for (name, list) in [
        ("beam_altitude_angles", &altitudes_deg),
        ("beam_azimuth_angles", &azimuths_deg),
    ] {
        if list.len() != pixels {
            return Err(Fault::header(format!(
                "{name} has {} angles, expected {pixels}",
                list.len()
            )));
        }
    }
    let port = sections
        .config("udp_port_lidar")
        .or_else(|| sections.find(&["udp_config"], "udp_port_lidar"));
    Ok(Metadata {
        product: info("prod_line").and_then(Value::as_str).unwrap_or("Ouster").to_owned(),
        shape: PacketShape {
            profile: sections.profile()?,
            is_fusa: sections.has_fusa_header()?,
            pixels,
            columns: match sections.format("columns_per_packet") {
                Some(value) => count(value, "columns_per_packet", MAX_PACKET_COLUMNS)?,
                None => 16,
            },
        },
        port: port.and_then(Value::as_u64).and_then(|port| u16::try_from(port).ok()),
        serial: info("prod_sn").and_then(number_of_text),
        columns: sections.columns_of_turn()?,
        altitudes_deg,
        azimuths_deg,
        beam_origin_mm: beam_origin(
            beams("beam_to_lidar_transform"),
            beams("lidar_origin_to_beam_origin_mm"),
        )?,
        sensor_from_lidar: match sections.find(&["lidar_intrinsics"], "lidar_to_sensor_transform") {
            Some(value) => matrix(value, "lidar_to_sensor_transform")?,
            None => DMat4::from_translation(DVec3::Z * HEIGHT_MM) * DMat4::from_scale(DVec3::new(-1.0, -1.0, 1.0)),
        },
    })
}

/// Metadata as newer firmware writes it, in sections, or as older does, without any.
#[derive(Clone, Copy)]
struct Sections<'a> {
    root: &'a Value,
}

impl<'a> Sections<'a> {
    /// A value of the first of these sections that has it, else of none.
    fn find(self, sections: &[&str], name: &str) -> Option<&'a Value> {
        let sections = sections.iter().filter_map(|section| self.root.get(section));
        let mut found = sections.filter_map(|section| section.get(name));
        found
            .next()
            .or_else(|| self.root.get(name))
            .filter(|value| !value.is_null())
    }

    fn format(self, name: &str) -> Option<&'a Value> {
        self.find(&["lidar_data_format", "data_format"], name)
    }

    fn config(self, name: &str) -> Option<&'a Value> {
        self.find(&["config_params"], name)
    }

    fn columns_of_turn(self) -> Result<usize, Fault> {
        let mode = self.config("lidar_mode").and_then(Value::as_str);
        match (self.format("columns_per_frame"), mode.and_then(columns_of_mode)) {
            (Some(value), _) => count(value, "columns_per_frame", MAX_COLUMNS),
            (None, Some(columns)) => Ok(columns),
            (None, None) => Err(Fault::header(
                "neither columns_per_frame nor lidar_mode says how many columns a revolution has, expected one such as \
                 \"lidar_mode\": \"1024x10\"",
            )),
        }
    }

    fn profile_name(self) -> Option<&'a str> {
        let profile = self
            .format("udp_profile_lidar")
            .or_else(|| self.config("udp_profile_lidar"));
        profile.and_then(Value::as_str)
    }

    fn profile(self) -> Result<&'static Profile, Fault> {
        match self.profile_name() {
            // Firmware before 2.3 had no other profile.
            None => Ok(LEGACY),
            Some(name) => Profile::of(name).ok_or_else(|| {
                let names = Profile::names();
                let name = name.escape_default();
                Fault::header(format!(
                    "udp_profile_lidar is {name}, which is not read, expected one of {names}: set one of them on the \
                     sensor, or convert the capture to PCD with `ouster-cli source`"
                ))
            }),
        }
    }

    /// Returns true if packets have the header of functional safety. Packets of the first profile have none.
    fn has_fusa_header(self) -> Result<bool, Fault> {
        let header = self.config("header_type").or_else(|| self.format("header_type"));
        let profile = self.profile()?;
        match header.and_then(Value::as_str) {
            // Firmware that had this profile, and no other profile with that header, did not state it.
            None => Ok(self.profile_name() == Some(FUSA)),
            Some("STANDARD") => Ok(false),
            Some("FUSA") => Ok(profile != LEGACY),
            Some(header) => Err(Fault::header(format!(
                "header_type is {}, expected STANDARD or FUSA",
                header.escape_default()
            ))),
        }
    }
}

/// Serial numbers are text, at times numbers.
fn number_of_text(value: &Value) -> Option<u64> {
    value.as_u64().or_else(|| value.as_str()?.trim().parse().ok())
}

/// `1024x10` has 1024 columns.
fn columns_of_mode(mode: &str) -> Option<usize> {
    let columns = mode.split_once('x')?.0.parse().ok()?;
    (1..=MAX_COLUMNS as usize).contains(&columns).then_some(columns)
}

fn count(value: &Value, name: &str, max: u64) -> Result<usize, Fault> {
    let count = value.as_u64().filter(|count| (1..=max).contains(count));
    count
        .map(|count| count as usize)
        .ok_or_else(|| Fault::header(format!("{name} is {value}, expected a number from 1 to {max}")))
}

fn angles(value: Option<&Value>, name: &str) -> Result<Vec<f64>, Fault> {
    let list = value.and_then(Value::as_array);
    let list = list.ok_or_else(|| Fault::header(format!("it has no {name}, expected a list with an angle a beam")))?;
    let angle = |value: &Value| value.as_f64().filter(|angle| angle.abs() <= 360.0);
    list.iter()
        .enumerate()
        .map(|(index, value)| {
            angle(value)
                .ok_or_else(|| Fault::entry(name, index, format!("it is {value}, expected an angle in degrees")))
        })
        .collect()
}

/// Along the head, and up.
fn beam_origin(transform: Option<&Value>, distance: Option<&Value>) -> Result<[f64; 2], Fault> {
    if let Some(transform) = transform {
        let place = matrix(transform, "beam_to_lidar_transform")?.w_axis;
        return Ok([place.x, place.z]);
    }
    match distance {
        None => Ok([0.0; 2]),
        Some(value) => {
            let length = value.as_f64().filter(|length| length.abs() < 1e6);
            let length = length.ok_or_else(|| {
                Fault::header(format!(
                    "lidar_origin_to_beam_origin_mm is {value}, expected millimetres"
                ))
            })?;
            Ok([length, 0.0])
        }
    }
}

/// Sixteen numbers, row by row.
fn matrix(value: &Value, name: &str) -> Result<DMat4, Fault> {
    let numbers = value.as_array().and_then(|list| {
        let numbers: Option<Vec<f64>> = list.iter().map(Value::as_f64).collect();
        let numbers: [f64; 16] = numbers?.try_into().ok()?;
        numbers.iter().all(|number| number.abs() < 1e9).then_some(numbers)
    });
    let numbers =
        numbers.ok_or_else(|| Fault::header(format!("{name} is not a matrix, expected a list of 16 numbers")))?;
    Ok(DMat4::from_cols_array(&numbers).transpose())
}
