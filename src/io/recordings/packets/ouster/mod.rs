//! LiDAR sensors of Ouster: from packets and metadata to points.
//!
//! **Positions** are in the frame of the sensor (X forward, away from the connector, Z up), by the formulas of the
//! firmware user manual, "Lidar range to XYZ". The head is at θ = 2π (1 − column / columns); a beam is offset from it
//! by its own azimuth and begins at a distance n from the axis:
//!
//! - `x = (r − n) cos(θ + a) cos φ + b cos θ`
//! - `y = (r − n) sin(θ + a) cos φ + b sin θ`
//! - `z = (r − n) sin φ + h`
//!
//! where b and h are the distances in front of and above the origin at which beams begin, and n is the length of both.
//! Then follows the transform from the lidar to the sensor.

mod metadata;
mod profile;
mod sensor;

pub(super) use sensor::MAKER;

use super::part::FrameId;
use super::points::{Measured, Points};
use glam::DVec3;
use metadata::Metadata;
use profile::Column;
use std::f64::consts::TAU;

/// Scanner with precomputed beam directions.
#[derive(Debug)]
struct Scanner {
    metadata: Metadata,
    beams: Vec<Beam>,
}

/// A beam while the head is at 0.
#[derive(Debug, Clone, Copy)]
struct Beam {
    /// From the place where beams begin.
    direction: DVec3,
    ring: u16,
}

/// Decodes the packets of a revolution into points, in any order.
#[derive(Debug)]
struct Unpacking<'a> {
    scanner: &'a Scanner,
    frame: FrameId,
    /// Received flags of the columns: a packet may be captured twice.
    has: Vec<bool>,
    first_ns: Option<u64>,
}

impl Scanner {
    fn new(metadata: Metadata) -> Self {
        let angles = metadata.altitudes_deg.iter().zip(&metadata.azimuths_deg);
        let altitudes = &metadata.altitudes_deg;
        let is_lower = |index: usize, than: usize| (altitudes[index], than) < (altitudes[than], index);
        let ring = |beam: usize| (0..altitudes.len()).filter(|&other| is_lower(other, beam)).count() as u16;
        let beams = angles.enumerate().map(|(index, (altitude_deg, azimuth_deg))| {
            let (rise, run) = altitude_deg.to_radians().sin_cos();
            // Beam azimuths are clockwise seen from above.
            let (sin, cos) = (-azimuth_deg).to_radians().sin_cos();
            Beam {
                direction: DVec3::new(run * cos, run * sin, rise),
                ring: ring(index),
            }
        });
        Self {
            beams: beams.collect(),
            metadata,
        }
    }

    /// Returns the names of the attributes of a point in addition to its position.
    fn value_names(&self) -> &'static [&'static str] {
        self.metadata.shape.profile.value_names()
    }
}

impl<'a> Unpacking<'a> {
    fn new(scanner: &'a Scanner, frame: FrameId) -> Self {
        Self {
            scanner,
            frame,
            has: vec![false; scanner.metadata.columns],
            first_ns: None,
        }
    }

    /// Appends the points of the part of a packet in the revolution. Ignores packets of other senders.
    fn packet(&mut self, packet: &[u8], points: &mut Points) {
        let shape = self.scanner.metadata.shape;
        if packet.len() != shape.packet_bytes() {
            return;
        }
        let frame = self.frame;
        for column in shape.columns(packet).filter(|column| shape.is_of(column, frame)) {
            let has = self.has.get_mut(usize::from(column.measurement));
            if has.is_some_and(|has| !std::mem::replace(has, true)) {
                self.column(&column, points);
            }
        }
    }

    fn column(&mut self, column: &Column<'_>, points: &mut Points) {
        let metadata = &self.scanner.metadata;
        let head = TAU * (1.0 - f64::from(column.measurement) / metadata.columns as f64);
        let (sin, cos) = head.sin_cos();
        let [along, up] = metadata.beam_origin_mm;
        let begins = DVec3::new(along * cos, along * sin, up);
        let begins_at = along.hypot(up);
        let first_ns = *self.first_ns.get_or_insert(column.time_ns);
        let time_s = (i128::from(column.time_ns) - i128::from(first_ns)) as f64 * 1e-9;
        let shape = metadata.shape;
        let pixels = column.pixels.chunks_exact(shape.pixel_bytes());
        for (beam, pixel) in self.scanner.beams.iter().zip(pixels) {
            let direction = DVec3::new(
                beam.direction.x * cos - beam.direction.y * sin,
                beam.direction.x * sin + beam.direction.y * cos,
                beam.direction.z,
            );
            let echoes = shape.profile.echoes(pixel).into_iter().flatten();
            for (number, echo) in echoes.enumerate().filter(|(_, echo)| echo.range_mm > 0) {
                let in_lidar = direction * (f64::from(echo.range_mm) - begins_at) + begins;
                let in_sensor = metadata.sensor_from_lidar.transform_point3(in_lidar) / 1000.0;
                points.push(&Measured {
                    position: in_sensor.to_array(),
                    ring: beam.ring,
                    time_s,
                    return_number: number as u8 + 1,
                    values: echo.values,
                });
            }
        }
    }
}
