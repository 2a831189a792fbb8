//! The points of a revolution as they are decoded, and their cloud.

use crate::cloud::{Positions, RawCloud, ScalarField};
use crate::io::error::Fault;
use crate::io::options::ReadOptions;
use glam::DVec3;

/// A single laser measurement.
#[derive(Debug, Clone, Copy)]
pub(super) struct Measured {
    /// In the frame of the sensor, metres.
    pub(super) position: [f64; 3],
    /// Index of the laser (ring), counted from the lowest.
    pub(super) ring: u16,
    /// Timestamp in seconds, relative to the same epoch as the other points of the revolution.
    pub(super) time_s: f64,
    /// Return number among several echoes of a shot, counted from 1 in the order of the packets.
    pub(super) return_number: u8,
    /// One number for each of the names that the sensor has.
    pub(super) values: [f32; MAX_VALUES],
}

/// Maximum number of additional values per point that any sensor provides.
pub(super) const MAX_VALUES: usize = 4;

/// The points of a revolution.
#[derive(Debug)]
pub(super) struct Points {
    /// Names of [`Measured::values`], the default one for colouring first.
    names: &'static [&'static str],
    positions: Vec<[f32; 3]>,
    values: Vec<[f32; MAX_VALUES]>,
    rings: Vec<f32>,
    times_s: Vec<f64>,
    returns: Vec<f32>,
}

impl Points {
    /// No points yet, of a sensor that has `names` of each. Precondition: no more than [`MAX_VALUES`].
    pub(super) fn new(names: &'static [&'static str]) -> Self {
        Self {
            names,
            positions: Vec::new(),
            values: Vec::new(),
            rings: Vec::new(),
            times_s: Vec::new(),
            returns: Vec::new(),
        }
    }

    const POINT_BYTES: u64 =
        (size_of::<[f32; 3]>() + size_of::<[f32; MAX_VALUES]>() + 2 * size_of::<f32>() + size_of::<f64>()) as u64;

    pub(super) fn push(&mut self, point: &Measured) {
        self.positions.push(point.position.map(|coordinate| coordinate as f32));
        self.values.push(point.values);
        self.rings.push(f32::from(point.ring));
        self.times_s.push(point.time_s);
        self.returns.push(f32::from(point.return_number));
    }

    /// Fails where the points take more memory than `options` allow.
    pub(super) fn check(&self, options: &ReadOptions) -> Result<(), Fault> {
        let needed = self.positions.len() as u64 * Self::POINT_BYTES;
        options.claim("the turn", needed)
    }

    /// The cloud, with times since its first point.
    pub(super) fn finish(self) -> RawCloud {
        let first = self.times_s.iter().copied().reduce(f64::min).unwrap_or(0.0);
        let mut scalars: Vec<ScalarField> = self
            .names
            .iter()
            .enumerate()
            .map(|(index, name)| ScalarField::new(*name, self.values.iter().map(|values| values[index]).collect()))
            .collect();
        let times = self.times_s.iter().map(|time| (time - first) as f32);
        scalars.push(ScalarField::new("time", times.collect()));
        scalars.push(ScalarField::new("ring", self.rings));
        if self.returns.iter().any(|&number| number > 1.0) {
            scalars.push(ScalarField::new("return_number", self.returns));
        }
        let mut cloud = RawCloud::from_positions(Positions::F32(self.positions));
        cloud.attributes.scalars = scalars;
        cloud.sensor = Some(DVec3::ZERO);
        cloud
    }
}
