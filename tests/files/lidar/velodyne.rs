//! Each model of Velodyne, with one echo and with two.

use super::captures::{Container, Expected, Files, Link, SENDER, Writer, check, clouds, time};
use pointreel::io::{self, ReadOptions};

/// A model, as its manual describes it.
pub(crate) struct Model {
    pub(crate) name: &'static str,
    pub(crate) product: u8,
    pub(crate) lasers: usize,
    unit_m: f64,
    pub(super) cycle_us: f64,
    /// Elevation and azimuth in degrees, and height in metres, of a laser.
    laser: fn(usize) -> [f64; 3],
    /// When shot `index` of a cycle is fired, in microseconds.
    shot_us: fn(usize) -> f64,
}

fn pair(index: usize) -> f64 {
    (index / 2) as f64
}

/// As the manuals print angles.
fn hundredths(angle_deg: f64) -> f64 {
    (angle_deg * 100.0).round() / 100.0
}

/// As the manual prints them in millimetres, from the lowest laser to the horizon.
const HI_RES_HEIGHTS: [f64; 8] = [7.4, 6.5, 5.5, 4.6, 3.7, 2.7, 1.8, 0.9];

/// Height of beams that meet `focus_mm` before the axis.
fn height(focus_mm: f64, elevation_deg: f64) -> f64 {
    -(elevation_deg.to_radians().tan() * focus_mm) / 1000.0
}

/// The manual's heights are where beams that meet 42 mm before the axis cross it, in tenths of a millimetre.
fn puck_height(elevation_deg: f64) -> f64 {
    let tan = elevation_deg.to_radians().tan();
    -(41.91 * tan * 10.0).round() / 10_000.0
}

pub(crate) const MODELS: [Model; 5] = [
    Model {
        name: "VLP-16",
        product: 0x22,
        lasers: 16,
        unit_m: 0.002,
        cycle_us: 110.592,
        laser: |laser| {
            let elevation = if laser % 2 == 0 {
                laser as f64 - 15.0
            } else {
                laser as f64
            };
            [elevation, 0.0, puck_height(elevation)]
        },
        shot_us: |shot| (shot / 16) as f64 * 55.296 + (shot % 16) as f64 * 2.304,
    },
    Model {
        name: "Puck Hi-Res",
        product: 0x24,
        lasers: 16,
        unit_m: 0.002,
        cycle_us: 110.592,
        laser: |laser| {
            let steps = if laser % 2 == 0 {
                laser as f64 - 15.0
            } else {
                laser as f64
            };
            let elevation = steps * 2.0 / 3.0;
            let height = HI_RES_HEIGHTS[if laser % 2 == 0 { laser / 2 } else { 7 - laser / 2 }] / 1000.0;
            [
                hundredths(elevation),
                0.0,
                if laser % 2 == 0 { height } else { -height },
            ]
        },
        shot_us: |shot| (shot / 16) as f64 * 55.296 + (shot % 16) as f64 * 2.304,
    },
    Model {
        name: "HDL-32E",
        product: 0x21,
        lasers: 32,
        unit_m: 0.002,
        cycle_us: 46.08,
        laser: |laser| {
            let low = if laser % 2 == 0 { -92.0 } else { -28.0 };
            let elevation = hundredths((low + pair(laser) * 4.0) / 3.0);
            [elevation, 0.0, height(28.83, elevation)]
        },
        shot_us: |shot| shot as f64 * 1.152,
    },
    Model {
        name: "VLP-32C",
        product: 0x28,
        lasers: 32,
        unit_m: 0.004,
        cycle_us: 55.296,
        laser: |laser| {
            let (elevation, azimuth) = VLP_32C[laser];
            [elevation, azimuth, height(42.4, elevation)]
        },
        shot_us: |shot| pair(shot) * 2.304,
    },
    Model {
        name: "VLS-128",
        product: 0xa1,
        lasers: 128,
        unit_m: 0.004,
        cycle_us: 53.3,
        laser: |laser| {
            let elevation = vls_elevation(laser);
            [elevation, 6.354 - VLS_AZIMUTHS[laser % 8], height(58.63, elevation)]
        },
        shot_us: |shot| {
            let group = shot / 8;
            2.665 * if group < 8 { group as f64 } else { group as f64 + 1.0 }
        },
    },
];

/// Angles of the manual, lasers 0 to 31.
const VLP_32C: [(f64, f64); 32] = [
    (-25.0, 1.4),
    (-1.0, -4.2),
    (-1.667, 1.4),
    (-15.639, -1.4),
    (-11.31, 1.4),
    (0.0, -1.4),
    (-0.667, 4.2),
    (-8.843, -1.4),
    (-7.254, 1.4),
    (0.333, -4.2),
    (-0.333, 1.4),
    (-6.148, -1.4),
    (-5.333, 4.2),
    (1.333, -1.4),
    (0.667, 4.2),
    (-4.0, -1.4),
    (-4.667, 1.4),
    (1.667, -4.2),
    (1.0, 1.4),
    (-3.667, -4.2),
    (-3.333, 4.2),
    (3.333, -1.4),
    (2.333, 1.4),
    (-2.667, -1.4),
    (-3.0, 1.4),
    (7.0, -1.4),
    (4.667, 1.4),
    (-2.333, -4.2),
    (-2.0, 4.2),
    (15.0, -1.4),
    (10.333, 1.4),
    (-1.333, -1.4),
];

/// Lasers of a group are aside of one another by as much.
const VLS_AZIMUTHS: [f64; 8] = [0.0, 1.806, 3.622, 5.443, 7.265, 9.086, 10.902, 12.708];

/// Most lasers are in rows of 0.11 degrees; these are all others.
fn vls_elevation(laser: usize) -> f64 {
    const OTHERS: [(usize, f64); 24] = [
        (0, -11.742),
        (8, -6.5),
        (13, 6.48),
        (18, -9.244),
        (31, 7.58),
        (33, 5.18),
        (36, -25.0),
        (41, 9.7),
        (44, -7.65),
        (51, 5.73),
        (54, -16.042),
        (59, 15.0),
        (62, -6.85),
        (66, 5.43),
        (69, -19.582),
        (74, 11.75),
        (77, -7.15),
        (87, -13.565),
        (92, 6.08),
        (95, -6.65),
        (97, -10.346),
        (110, 6.98),
        (115, -8.352),
        (120, 8.43),
    ];
    if let Some((_, elevation)) = OTHERS.iter().find(|(other, _)| *other == laser) {
        return *elevation;
    }
    if laser == 112 {
        return 4.98;
    }
    // In firing order, the rows rise in steps of 0.11 degrees from this one on.
    VLS_ROWS
        .iter()
        .position(|row| *row == laser)
        .map_or(f64::NAN, |row| -6.39 + 0.11 * row as f64)
}

/// Lasers of the rows of 0.11 degrees, the lowest first.
const VLS_ROWS: [usize; 103] = [
    105, 26, 123, 100, 21, 118, 39, 64, 49, 82, 3, 108, 29, 126, 47, 72, 57, 90, 11, 52, 85, 6, 103, 16, 113, 34, 67,
    60, 93, 14, 111, 24, 121, 42, 75, 116, 37, 70, 55, 80, 1, 98, 19, 124, 45, 78, 63, 88, 9, 106, 27, 4, 101, 22, 119,
    32, 65, 50, 83, 12, 109, 30, 127, 40, 73, 58, 91, 68, 53, 86, 7, 96, 17, 114, 35, 76, 61, 94, 15, 104, 25, 122, 43,
    20, 117, 38, 71, 48, 81, 2, 99, 28, 125, 46, 79, 56, 89, 10, 107, 84, 5, 102, 23,
];

/// A head that rotates evenly.
pub(crate) struct Scan<'a> {
    pub(crate) model: &'a Model,
    pub(crate) is_dual: bool,
    /// Hundredths of a degree between cycles.
    pub(crate) step: usize,
    /// Of the first cycle.
    pub(crate) begin: usize,
}

impl Scan<'_> {
    /// Cycles of a packet.
    pub(crate) fn cycles(&self) -> usize {
        let banks = (self.model.lasers / 32).max(1);
        12 / (banks * self.returns())
    }

    fn returns(&self) -> usize {
        if self.is_dual { 2 } else { 1 }
    }

    pub(crate) fn azimuth(&self, cycle: usize) -> usize {
        (self.begin + cycle * self.step) % 36_000
    }

    /// The measurement of laser `shot` of a cycle: distance in units and reflectivity. Some measure nothing; of two
    /// echoes some are one.
    fn measured(cycle: usize, shot: usize, echo: usize) -> (u16, u8) {
        let number = cycle * 131 + shot * 17;
        let is_one = number.is_multiple_of(3);
        let echo = if is_one { 0 } else { echo };
        if number.is_multiple_of(11) {
            return (0, 0);
        }
        ((1500 + number % 20_000 + echo * 777) as u16, (number % 256) as u8)
    }

    /// Packet `index`.
    pub(crate) fn packet(&self, index: usize) -> Vec<u8> {
        const BANKS: [u8; 4] = [0xee, 0xdd, 0xcc, 0xbb];
        let mut bytes = Vec::new();
        let banks = (self.model.lasers / 32).max(1);
        for cycle in index * self.cycles()..(index + 1) * self.cycles() {
            for (bank, flag) in BANKS.iter().enumerate().take(banks) {
                for echo in 0..self.returns() {
                    bytes.extend([0xff, *flag]);
                    bytes.extend((self.azimuth(cycle) as u16).to_le_bytes());
                    for shot in 0..32 {
                        let (distance, reflectivity) = Self::measured(cycle, bank * 32 + shot, echo);
                        bytes.extend(distance.to_le_bytes());
                        bytes.push(reflectivity);
                    }
                }
            }
        }
        // A VLS-128 leaves four blocks empty when it reports two echoes.
        bytes.resize(1200, 0);
        bytes.extend((self.time_us(index) as u32).to_le_bytes());
        bytes.extend([if self.is_dual { 0x39 } else { 0x37 }, self.model.product]);
        bytes
    }

    /// Of the first shot of packet `index`, in whole microseconds: shortly before the hour.
    pub(crate) fn time_us(&self, index: usize) -> u64 {
        let since = (index * self.cycles()) as f64 * self.model.cycle_us;
        (3_599_999_000 + since as u64) % 3_600_000_000
    }

    /// The points of `cycles`, by the formulas of the manuals.
    pub(crate) fn points(&self, cycles: std::ops::Range<usize>) -> Vec<Expected> {
        let elevations: Vec<f64> = (0..self.model.lasers)
            .map(|laser| (self.model.laser)(laser)[0])
            .collect();
        let mut points = Vec::new();
        for cycle in cycles.clone() {
            let packet = cycle / self.cycles();
            let since_us = (packet * self.cycles()) as f64 * self.model.cycle_us;
            let within = (cycle % self.cycles()) as f64 * self.model.cycle_us;
            // With one cycle per packet, the step of the first packet is unknown.
            let is_known = self.cycles() > 1 || cycle > cycles.start;
            let step = if is_known { self.step as f64 } else { 0.0 };
            let banks = (self.model.lasers / 32).max(1);
            for bank in 0..banks {
                for echo in 0..self.returns() {
                    for shot in bank * 32..(bank + 1) * 32 {
                        let (distance, reflectivity) = Self::measured(cycle, shot, echo);
                        let is_told = echo == 1 && Self::measured(cycle, shot, 0) == (distance, reflectivity);
                        if distance == 0 || is_told {
                            continue;
                        }
                        let laser = shot % self.model.lasers;
                        let [elevation, aside, height] = (self.model.laser)(laser);
                        let shot_us = (self.model.shot_us)(shot);
                        let turned = step * shot_us / self.model.cycle_us;
                        let azimuth = ((self.azimuth(cycle) as f64 + turned) / 100.0 + aside).to_radians();
                        let (range, elevation) = (f64::from(distance) * self.model.unit_m, elevation.to_radians());
                        points.push(Expected {
                            position: [
                                range * elevation.cos() * azimuth.sin(),
                                range * elevation.cos() * azimuth.cos(),
                                range * elevation.sin() + height,
                            ],
                            ring: elevations.iter().filter(|other| **other < elevations[laser]).count() as f32,
                            time_s: ((since_us as u64) as f64 + within + shot_us) * 1e-6,
                            return_number: echo as f32 + 1.0,
                            values: vec![("intensity", f32::from(reflectivity))],
                        });
                    }
                }
            }
        }
        points
    }

    /// Starts of revolutions, before cycle `end`.
    pub(crate) fn turns(&self, end: usize) -> Vec<std::ops::Range<usize>> {
        let begins = (1..end).filter(|&cycle| self.azimuth(cycle) < self.azimuth(cycle - 1));
        let mut places = vec![0];
        places.extend(begins);
        places.push(end);
        places.windows(2).map(|pair| pair[0]..pair[1]).collect()
    }

    /// [`Self::turns`] without the first and the last one where they have less than half of the packets of one.
    pub(crate) fn whole_turns(&self, end: usize) -> Vec<std::ops::Range<usize>> {
        let mut turns = self.turns(end);
        let packets = |turn: &std::ops::Range<usize>| (turn.end - 1) / self.cycles() - turn.start / self.cycles() + 1;
        let mut inner: Vec<usize> = turns[1..turns.len() - 1].iter().map(packets).collect();
        inner.sort_unstable();
        let whole = inner[inner.len() / 2];
        if packets(&turns[turns.len() - 1]) * 2 < whole {
            turns.pop();
        }
        if packets(&turns[0]) * 2 < whole {
            turns.remove(0);
        }
        turns
    }

    pub(crate) fn write(&self, writer: &mut Writer, packets: usize) {
        for index in 0..packets {
            let since = (index * self.cycles()) as f64 * self.model.cycle_us;
            writer.datagram(since as u64, SENDER, &self.packet(index));
        }
    }
}

fn model(name: &str) -> &'static Model {
    MODELS.iter().find(|model| model.name == name).unwrap()
}

#[test]
fn points_of_every_model_match_the_manuals() {
    for model in &MODELS {
        for is_dual in [false, true] {
            let scan = Scan {
                model,
                is_dual,
                step: 180,
                begin: 18_010,
            };
            let packets = 520 / scan.cycles();
            let mut writer = Writer::new(Container::Pcap, Link::Ethernet);
            scan.write(&mut writer, packets);
            let files = Files::new();
            let path = files.write("drive.pcap", &writer.bytes);
            let clouds = clouds(&path);
            let turns = scan.whole_turns(packets * scan.cycles());
            assert_eq!(clouds.len(), turns.len(), "{} {is_dual}", model.name);
            assert!(turns.len() >= 2);
            for (cloud, turn) in clouds.iter().zip(turns) {
                check(cloud, &scan.points(turn), 2e-5);
                assert_eq!(cloud.sensor, Some(glam::DVec3::ZERO));
                assert_eq!(cloud.warnings, [""; 0]);
            }
        }
    }
}

#[test]
fn all_elevations_of_the_vls_128_are_present() {
    let mut elevations: Vec<f64> = (0..128).map(vls_elevation).collect();
    elevations.sort_by(f64::total_cmp);
    assert!(
        elevations.windows(2).all(|pair| pair[1] - pair[0] > 0.1),
        "{elevations:?}"
    );
}

#[test]
fn a_scan_starts_within_a_packet_and_no_point_is_lost_or_duplicated() {
    let scan = Scan {
        model: model("HDL-32E"),
        is_dual: false,
        step: 161,
        begin: 30_000,
    };
    let mut writer = Writer::new(Container::PcapNg, Link::Vlan);
    scan.write(&mut writer, 100);
    let files = Files::new();
    let path = files.write("drive.pcapng", &writer.bytes);
    let clouds = clouds(&path);
    let turns = scan.whole_turns(1200);
    // The capture starts and ends with less than half a revolution, which does not count as a frame.
    assert_eq!(turns.len(), scan.turns(1200).len() - 2);
    assert_eq!(clouds.len(), turns.len());
    assert!(turns.iter().any(|turn| turn.start % 12 != 0));
    for (cloud, turn) in clouds.iter().zip(&turns) {
        assert_eq!(cloud.positions.len(), scan.points(turn.clone()).len());
    }
    let contents = io::contents(&path, None, &ReadOptions::default()).unwrap();
    let note = contents.notes.join("\n");
    assert!(
        note.contains("the first and the last revolution are incomplete"),
        "{note}"
    );
}

#[test]
fn frames_have_the_times_of_their_first_packets() {
    let scan = Scan {
        model: model("VLP-16"),
        is_dual: false,
        step: 40,
        begin: 0,
    };
    let mut writer = Writer::new(Container::Pcap, Link::Ethernet);
    scan.write(&mut writer, 160);
    let files = Files::new();
    let path = files.write("drive.pcap", &writer.bytes);
    let entries = io::list(&path, &ReadOptions::default()).unwrap();
    assert_eq!(entries.len(), 2);
    for (entry, turn) in entries.iter().zip(scan.turns(1920)) {
        let packet = turn.start / 12;
        let since = (packet * 12) as f64 * 110.592;
        assert_eq!(entry.time, Some(time(since as u64)));
    }
    assert_eq!(entries[1].name, "192.168.1.201:2368 1");
}

#[test]
fn a_stationary_head_is_split_into_frames_by_time() {
    let scan = Scan {
        model: model("VLP-16"),
        is_dual: false,
        step: 0,
        begin: 7000,
    };
    let mut writer = Writer::new(Container::Pcap, Link::Ethernet);
    for index in 0..50 {
        writer.datagram(index * 100_000, SENDER, &scan.packet(index as usize));
    }
    let files = Files::new();
    let path = files.write("still.pcap", &writer.bytes);
    let clouds = clouds(&path);
    assert_eq!(clouds.len(), 3);
    let points: usize = clouds.iter().map(|cloud| cloud.positions.len()).sum();
    assert_eq!(points, scan.points(0..600).len());
}

#[test]
fn an_unknown_model_is_named() {
    let mut scan = Scan {
        model: model("VLP-16"),
        is_dual: false,
        step: 40,
        begin: 0,
    };
    let other = Model {
        product: 0x77,
        ..*scan.model
    };
    scan.model = &other;
    let mut writer = Writer::new(Container::Pcap, Link::Ethernet);
    scan.write(&mut writer, 10);
    let files = Files::new();
    let path = files.write("other.pcap", &writer.bytes);
    let error = io::read(&path).unwrap_err().to_string();
    assert!(error.contains("0x77") && error.contains("VLP-16 (0x22)"), "{error}");
}
