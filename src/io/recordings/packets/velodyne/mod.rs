//! Velodyne LiDAR sensors: decoding of data packets into points.
//!
//! **How it works.** A packet has blocks of 32 measurements and an azimuth each. Blocks that all lasers fire in once
//! are a *cycle*; if two echoes are reported, the cycle has its blocks twice. The head rotates between the shots of a
//! cycle, so each shot has its own azimuth, interpolated between its cycle and the next one by its firing time (VLP-16
//! user manual §9.5, VLS-128 manual "Precision azimuth calculation").
//!
//! **Positions** are in the frame of the manuals: Z is up, Y is azimuth 0, X is azimuth 90 degrees, which is clockwise
//! from above:
//!
//! `x = r cos ω sin α`, `y = r cos ω cos α`, `z = r sin ω` and the height of the laser.

mod calibration;
mod model;
mod packet;
mod sensor;
mod tables;

pub(super) use sensor::MAKER;

use super::points::{MAX_VALUES, Measured, Points};
use super::seam::{Seam, TURN};
use calibration::Calibration;
use model::{Laser, Model};
use packet::{BLOCKS, DataPacket, SHOTS};
use std::ops::Range;

/// Names of the per-point attributes other than the position.
const NAMES: &[&str] = &["intensity"];

/// The azimuth grows by less between cycles, at 20 revolutions per second and with two echoes; more is a gap.
const MAX_STEP: i32 = 200;

/// Times of packets count from the hour.
const HOUR_US: i64 = 3_600_000_000;

/// A sensor whose lasers are known.
#[derive(Debug)]
struct Scanner {
    model: Model,
    lasers: Lasers,
    /// Ring of each laser: its index from the lowest.
    rings: Vec<u16>,
    unit_m: f64,
}

#[derive(Debug)]
enum Lasers {
    Of(Vec<Laser>),
    Calibrated(Calibration),
}

impl Scanner {
    /// A sensor of a model whose lasers all look alike, or one with its own calibration. Precondition: a HDL-64E has
    /// one.
    fn new(model: Model, calibration: Option<Calibration>) -> Self {
        let (lasers, unit_m) = match calibration {
            Some(calibration) if model == Model::Hdl64 => {
                let unit_m = calibration.unit_m;
                (Lasers::Calibrated(calibration), unit_m)
            }
            _ => (Lasers::Of(model.lasers()), model.unit_m()),
        };
        let elevations: Vec<f64> = match &lasers {
            Lasers::Of(lasers) => lasers.iter().map(|laser| laser.elevation_deg).collect(),
            Lasers::Calibrated(calibration) => calibration.lasers.iter().map(|laser| laser.elevation_deg).collect(),
        };
        let is_lower = |index: usize, than: usize| (elevations[index], index) < (elevations[than], than);
        let ring = |laser: usize| (0..elevations.len()).filter(|&other| is_lower(other, laser)).count() as u16;
        Self {
            rings: (0..elevations.len()).map(ring).collect(),
            model,
            lasers,
            unit_m,
        }
    }

    /// The place of a measurement; `None` of a laser that is not known.
    fn position(&self, laser: usize, distance_m: f64, azimuth_deg: f64) -> Option<[f64; 3]> {
        match &self.lasers {
            Lasers::Calibrated(calibration) => {
                let laser = calibration.lasers.get(laser)?;
                Some(laser.position(distance_m, azimuth_deg))
            }
            Lasers::Of(lasers) => {
                let laser = lasers.get(laser)?;
                let (sin, cos) = (azimuth_deg + laser.azimuth_deg).to_radians().sin_cos();
                let (rise, run) = laser.elevation_deg.to_radians().sin_cos();
                Some([
                    distance_m * run * sin,
                    distance_m * run * cos,
                    distance_m * rise + laser.height_m,
                ])
            }
        }
    }
}

/// Blocks of a cycle of `packet`, and how many cycles it has.
fn cycles(model: Model, packet: DataPacket<'_>) -> (usize, usize) {
    let blocks = model.banks() * model.returns(packet);
    (blocks, BLOCKS / blocks)
}

/// Finds the starts of revolutions, packet by packet.
#[derive(Debug)]
struct Turning {
    model: Model,
    seam: Seam,
    /// Azimuth of the previous cycle, relative to the seam.
    azimuth: Option<i32>,
}

impl Turning {
    fn new(model: Model) -> Self {
        Self {
            model,
            seam: Seam::default(),
            azimuth: None,
        }
    }

    /// Revolutions begin at `seam` from the next packet on.
    fn set_seam(&mut self, seam: Seam) {
        self.seam = seam;
        self.azimuth = None;
    }

    /// The azimuths of the cycles of `packet` that measured.
    fn azimuths(&self, packet: DataPacket<'_>) -> impl Iterator<Item = i32> {
        let (blocks, count) = cycles(self.model, packet);
        let blocks = (0..count).map(move |cycle| packet.block(cycle * blocks));
        blocks.filter(|block| block.bank.is_some()).map(|block| block.azimuth)
    }

    /// The cycle of `packet` at which a revolution begins; `None` where it continues, 0 for the first packet.
    fn begins_at(&mut self, packet: DataPacket<'_>) -> Option<u8> {
        let (blocks, count) = cycles(self.model, packet);
        let mut found = None;
        for cycle in 0..count {
            let azimuth = self.seam.after_seam(packet.block(cycle * blocks).azimuth);
            let begins = self.azimuth.is_none_or(|before| before - azimuth > self.seam.min_fall);
            if begins && found.is_none() {
                found = Some(cycle as u8);
            }
            self.azimuth = Some(azimuth);
        }
        found
    }
}

/// Decodes the packets of a revolution into points, one after the other.
#[derive(Debug)]
struct Unpacking<'a> {
    scanner: &'a Scanner,
    /// The first azimuth of the cycle before, and the last step that was one.
    azimuth: Option<i32>,
    step: i32,
    /// Timestamp of the previous packet: the raw time that it reports, and that time since the first packet's hour.
    time_us: Option<(u32, i64)>,
}

impl<'a> Unpacking<'a> {
    fn new(scanner: &'a Scanner) -> Self {
        Self {
            scanner,
            azimuth: None,
            step: 0,
            time_us: None,
        }
    }

    /// Appends the points of the cycles `wanted` of `packet`.
    fn packet(&mut self, packet: DataPacket<'_>, wanted: Range<usize>, points: &mut Points) {
        let model = self.scanner.model;
        let (blocks, count) = cycles(model, packet);
        let time_us = self.time_us(packet.time_us()) as f64;
        for cycle in 0..count {
            let azimuth = packet.block(cycle * blocks).azimuth;
            let step = if cycle + 1 < count {
                packet.block((cycle + 1) * blocks).azimuth - azimuth
            } else {
                // For a packet with one cycle, the step before it is used instead of the one after it.
                self.azimuth.map_or(0, |before| azimuth - before)
            };
            let step = if step < -TURN / 2 { step + TURN } else { step };
            if (0..=MAX_STEP).contains(&step) {
                self.step = step;
            }
            self.azimuth = Some(azimuth);
            if wanted.contains(&cycle) {
                let begin = cycle * blocks;
                let cycle_us = time_us + cycle as f64 * model.cycle_us();
                self.cycle(packet, begin..begin + blocks, cycle_us, points);
            }
        }
    }

    fn cycle(&self, packet: DataPacket<'_>, blocks: Range<usize>, cycle_us: f64, points: &mut Points) {
        let model = self.scanner.model;
        let mut seen: [Option<usize>; 4] = [None; 4];
        for index in blocks {
            let block = packet.block(index);
            let Some(bank) = block.bank.filter(|&bank| bank < model.banks()) else {
                continue;
            };
            let first = seen[bank].map(|first| packet.block(first));
            seen[bank].get_or_insert(index);
            for shot in 0..SHOTS {
                let measured = block.shot(shot);
                // A single echo is reported twice.
                let is_told = first.is_some_and(|first| first.shot(shot) == measured);
                if measured.distance == 0 || is_told {
                    continue;
                }
                let laser = model.laser(bank, shot);
                let shot_us = model.shot_us(bank, shot);
                let turned = if model.turns_between_shots() {
                    f64::from(self.step) * shot_us / model.cycle_us()
                } else {
                    0.0
                };
                let azimuth_deg = (f64::from(block.azimuth) + turned) / 100.0;
                let distance_m = f64::from(measured.distance) * self.scanner.unit_m;
                let (Some(position), Some(&ring)) = (
                    self.scanner.position(laser, distance_m, azimuth_deg),
                    self.scanner.rings.get(laser),
                ) else {
                    continue;
                };
                let mut values = [0.0; MAX_VALUES];
                values[0] = f32::from(measured.reflectivity);
                points.push(&Measured {
                    position,
                    ring,
                    time_s: (cycle_us + shot_us) * 1e-6,
                    return_number: if first.is_some() { 2 } else { 1 },
                    values,
                });
            }
        }
    }

    /// The time of a packet since the hour of the first one, over the end of that hour.
    fn time_us(&mut self, told: u32) -> i64 {
        let now = match self.time_us {
            None => i64::from(told),
            Some((before, since)) => {
                let passed = i64::from(told) - i64::from(before);
                since
                    + if passed < -HOUR_US / 2 {
                        passed + HOUR_US
                    } else {
                        passed
                    }
            }
        };
        self.time_us = Some((told, now));
        now
    }
}
