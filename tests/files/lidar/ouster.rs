//! The profiles of Ouster, whole and in fragments, with metadata of several generations.

use super::captures::{Container, Expected, Files, Link, Sender, Writer, check, clouds, scalar, time};
use pointreel::io::{self, ReadOptions};
use serde_json::{Value, json};
use std::f64::consts::TAU;

pub(crate) const SENDER: Sender = Sender { host: 30, port: 7502 };

/// A sensor.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sensor {
    pub(crate) profile: &'static str,
    pub(crate) pixels: usize,
    /// Columns of a revolution.
    pub(crate) columns: usize,
    pub(crate) serial: u64,
}

/// Columns of a packet.
const COLUMNS: usize = 16;

pub(crate) const PROFILES: [&str; 11] = [
    "LEGACY",
    "RNG19_RFL8_SIG16_NIR16",
    "RNG19_RFL8_SIG16_NIR16_DUAL",
    "RNG15_RFL8_NIR8",
    FUSA,
    "RNG15_RFL8_NIR8_DUAL",
    "FIVE_WORD_PIXEL",
    "RNG15_RFL8_WIN8",
    "RNG15_RFL8_NIR8_ZONE16",
    "RNG19_RFL8_SIG16_NIR16_ZONE16",
    "RNG19_RFL8_SIG16_ZONE16_DUAL",
];

const FUSA: &str = "FUSA_RNG15_RFL8_NIR8_DUAL";

pub(crate) const SMALL: Sensor = Sensor {
    profile: PROFILES[1],
    pixels: 32,
    columns: 512,
    serial: 122_201_000_998,
};

/// Position of the LiDAR in the sensor, rotated by 180°; values of a real one.
const TO_SENSOR: [f64; 16] = [
    -1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 36.18, 0.0, 0.0, 0.0, 1.0,
];

impl Sensor {
    fn altitude(&self, beam: usize) -> f64 {
        22.5 - 45.0 * beam as f64 / (self.pixels - 1) as f64
    }

    fn azimuth(beam: usize) -> f64 {
        [4.23, 1.41, -1.4, -4.19][beam % 4]
    }

    fn altitudes(&self) -> Vec<f64> {
        (0..self.pixels).map(|beam| self.altitude(beam)).collect()
    }

    fn azimuths(&self) -> Vec<f64> {
        (0..self.pixels).map(Self::azimuth).collect()
    }

    fn format(&self) -> Value {
        json!({
            "pixels_per_column": self.pixels,
            "columns_per_packet": COLUMNS,
            "columns_per_frame": self.columns,
            "udp_profile_lidar": self.profile,
            "pixel_shift_by_row": vec![0; self.pixels],
        })
    }

    /// As firmware 1 and 2.0 have it.
    pub(crate) fn flat(&self) -> Value {
        json!({
            "prod_line": "OS-1-32",
            "prod_sn": self.serial.to_string(),
            "lidar_mode": format!("{}x10", self.columns),
            "beam_altitude_angles": self.altitudes(),
            "beam_azimuth_angles": self.azimuths(),
            "lidar_origin_to_beam_origin_mm": 15.806,
            "lidar_to_sensor_transform": TO_SENSOR,
            "data_format": self.format(),
        })
    }

    /// As later firmware has it.
    pub(crate) fn sections(&self) -> Value {
        json!({
            "sensor_info": { "prod_line": "OS-1-32", "prod_sn": self.serial.to_string() },
            "beam_intrinsics": {
                "beam_altitude_angles": self.altitudes(),
                "beam_azimuth_angles": self.azimuths(),
                "lidar_origin_to_beam_origin_mm": 15.806,
                "beam_to_lidar_transform": [1, 0, 0, 15.806, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1],
            },
            "lidar_intrinsics": { "lidar_to_sensor_transform": TO_SENSOR },
            "lidar_data_format": self.format(),
            "config_params": {
                "lidar_mode": format!("{}x10", self.columns),
                "udp_port_lidar": SENDER.port,
                "udp_profile_lidar": self.profile,
                "header_type": if self.profile == FUSA { "FUSA" } else { "STANDARD" },
            },
            "user_data": "",
        })
    }

    fn is_low(&self) -> bool {
        self.profile.contains("RNG15")
    }

    /// Echoes of a shot.
    fn echoes(&self) -> usize {
        let is_dual = self.profile.ends_with("DUAL") || self.profile == "FIVE_WORD_PIXEL";
        if is_dual { 2 } else { 1 }
    }

    /// Range in millimetres, reflectivity, signal and light of the sun, of a shot.
    fn measured(&self, frame: u16, column: usize, beam: usize, echo: usize) -> (u32, u8, u16, u16) {
        let number = usize::from(frame) * 7 + column * 13 + beam * 101;
        if number.is_multiple_of(7) || (echo == 1 && number.is_multiple_of(2)) {
            return (0, 0, 0, 0);
        }
        let range = 800 + (number * 37 % 200_000) as u32 + echo as u32 * 1600;
        let (reflectivity, signal, near) = ((number % 256) as u8, (number % 60_000) as u16, (number % 4000) as u16);
        if self.is_low() {
            (range / 8 * 8, reflectivity, 0, near / 16 * 16)
        } else {
            (range, reflectivity, signal, near)
        }
    }

    fn pixel(&self, frame: u16, column: usize, beam: usize) -> Vec<u8> {
        let (range, reflectivity, signal, near) = self.measured(frame, column, beam, 0);
        let mut bytes = Vec::new();
        match self.profile {
            "LEGACY" | "RNG19_RFL8_SIG16_NIR16" | "RNG19_RFL8_SIG16_NIR16_ZONE16" => {
                // Flags above the range.
                let flags = if self.profile == "LEGACY" {
                    0x5000_0000
                } else {
                    0xf800_0000
                };
                bytes.extend((range | flags).to_le_bytes());
                bytes.extend([reflectivity, 0]);
                bytes.extend(signal.to_le_bytes());
                bytes.extend(near.to_le_bytes());
                bytes.extend(zone(column, beam).to_le_bytes());
            }
            "RNG19_RFL8_SIG16_NIR16_DUAL" | "FIVE_WORD_PIXEL" | "RNG19_RFL8_SIG16_ZONE16_DUAL" => {
                let second = self.measured(frame, column, beam, 1);
                bytes.extend(&range.to_le_bytes()[..3]);
                bytes.push(reflectivity);
                bytes.extend(&second.0.to_le_bytes()[..3]);
                bytes.push(second.1);
                bytes.extend(signal.to_le_bytes());
                bytes.extend(second.2.to_le_bytes());
                let is_zone = self.profile.contains("ZONE16");
                bytes.extend(if is_zone { zone(column, beam) } else { near }.to_le_bytes());
                bytes.extend([0, 0]);
                if self.profile == "FIVE_WORD_PIXEL" {
                    bytes.extend([0xaa; 4]);
                }
            }
            _ => {
                bytes.extend(((range / 8) as u16 | 0x8000).to_le_bytes());
                bytes.extend([reflectivity, (near / 16) as u8]);
                if self.echoes() == 2 {
                    let second = self.measured(frame, column, beam, 1);
                    bytes.extend(((second.0 / 8) as u16 | 0x8000).to_le_bytes());
                    bytes.extend([second.1, 0xaa]);
                } else if self.profile.contains("ZONE16") {
                    bytes.extend(zone(column, beam).to_le_bytes());
                    bytes.extend([0xaa, 0]);
                }
            }
        }
        bytes
    }

    fn is_whole(column: usize) -> bool {
        column % 100 != 57
    }

    fn time_ns(&self, frame: u16, column: usize) -> u64 {
        1_000_000_000_000 + (u64::from(frame) * self.columns as u64 + column as u64) * 97_657
    }

    /// Packet `index` of a frame.
    pub(crate) fn packet(&self, frame: u16, index: usize) -> Vec<u8> {
        let is_legacy = self.profile == "LEGACY";
        let mut bytes = Vec::new();
        if self.profile == FUSA {
            bytes.extend([1, 1, 2, 3]);
            bytes.extend(u32::from(frame).to_le_bytes());
            bytes.extend([0; 3]);
            bytes.extend(&self.serial.to_le_bytes()[..5]);
            bytes.resize(32, 0);
        } else if !is_legacy {
            bytes.extend(1u16.to_le_bytes());
            bytes.extend(frame.to_le_bytes());
            bytes.extend([1, 2, 3]);
            bytes.extend(&self.serial.to_le_bytes()[..5]);
            bytes.resize(32, 0);
        }
        for column in index * COLUMNS..(index + 1) * COLUMNS {
            bytes.extend(self.time_ns(frame, column).to_le_bytes());
            bytes.extend((column as u16).to_le_bytes());
            if is_legacy {
                bytes.extend(frame.to_le_bytes());
                bytes.extend(((column * 90_112 / self.columns) as u32).to_le_bytes());
            } else {
                bytes.extend(u16::from(Self::is_whole(column)).to_le_bytes());
            }
            for beam in 0..self.pixels {
                bytes.extend(self.pixel(frame, column, beam));
            }
            if is_legacy {
                bytes.extend(if Self::is_whole(column) { [0xff; 4] } else { [0; 4] });
            }
        }
        if !is_legacy {
            bytes.extend([0; 32]);
        }
        bytes
    }

    pub(crate) fn packets(&self) -> usize {
        self.columns / COLUMNS
    }

    /// The points of a frame, by the formulas of the manual.
    pub(crate) fn points(&self, frame: u16) -> Vec<Expected> {
        let mut points = Vec::new();
        let echoes = self.echoes();
        for column in (0..self.columns).filter(|&column| Self::is_whole(column)) {
            for beam in 0..self.pixels {
                for echo in 0..echoes {
                    let (range, reflectivity, signal, _) = self.measured(frame, column, beam, echo);
                    let near = self.measured(frame, column, beam, 0).3;
                    if range == 0 {
                        continue;
                    }
                    let (r, n) = (f64::from(range), 15.806);
                    let encoder = TAU * (1.0 - column as f64 / self.columns as f64);
                    let azimuth = -TAU * Self::azimuth(beam) / 360.0;
                    let phi = TAU * self.altitude(beam) / 360.0;
                    let x = (r - n) * (encoder + azimuth).cos() * phi.cos() + n * encoder.cos();
                    let y = (r - n) * (encoder + azimuth).sin() * phi.cos() + n * encoder.sin();
                    let z = (r - n) * phi.sin();
                    let mut values = vec![("reflectivity", f32::from(reflectivity))];
                    if self.profile.contains("WIN8") {
                        values.push(("window", f32::from(near / 16)));
                    } else if self.profile != "RNG19_RFL8_SIG16_ZONE16_DUAL" {
                        values.push(("near_ir", f32::from(near)));
                    }
                    if !self.is_low() {
                        values.push(("intensity", f32::from(signal)));
                    }
                    if self.profile.contains("ZONE16") {
                        values.push(("zone_mask", f32::from(zone(column, beam))));
                    }
                    points.push(Expected {
                        position: [-x / 1000.0, -y / 1000.0, (z + 36.18) / 1000.0],
                        ring: (self.pixels - 1 - beam) as f32,
                        time_s: (self.time_ns(frame, column) - 1_000_000_000_000) as f64 * 1e-9,
                        return_number: echo as f32 + 1.0,
                        values,
                    });
                }
            }
        }
        points
    }

    /// Frames one after the other, each packet a millisecond.
    pub(crate) fn write(&self, writer: &mut Writer, frames: std::ops::Range<u16>) {
        let begin = frames.start;
        for frame in frames {
            for index in 0..self.packets() {
                let after = usize::from(frame - begin) * self.packets() + index;
                writer.datagram(after as u64 * 1000, SENDER, &self.packet(frame, index));
            }
        }
    }
}

/// The zones that a pixel is in, of those that the sensor watches.
fn zone(column: usize, beam: usize) -> u16 {
    (column * 7 + beam * 3) as u16
}

#[test]
fn points_of_every_profile_match_the_manual() {
    for profile in PROFILES {
        for pixels in [16, 64] {
            let sensor = Sensor {
                profile,
                pixels,
                ..SMALL
            };
            let mut writer = Writer::new(Container::Pcap, Link::Ethernet);
            sensor.write(&mut writer, 65_534..65_535);
            sensor.write(&mut writer, 3..5);
            let files = Files::new();
            files.write("drive.json", sensor.sections().to_string().as_bytes());
            let path = files.write("drive.pcap", &writer.bytes);
            let clouds = clouds(&path);
            assert_eq!(clouds.len(), 3, "{profile}");
            for (cloud, frame) in clouds.iter().zip([65_534, 3, 4]) {
                check(cloud, &sensor.points(frame), 2e-5);
            }
            let first = &clouds[0].attributes.scalars[0].name;
            assert_eq!(first, if sensor.is_low() { "reflectivity" } else { "intensity" });
        }
    }
}

#[test]
fn packets_have_the_sizes_given_in_the_manual() {
    let sizes = [PROFILES[0], PROFILES[1], PROFILES[2], PROFILES[3], FUSA].map(|profile| {
        Sensor {
            profile,
            pixels: 128,
            ..SMALL
        }
        .packet(0, 0)
        .len()
    });
    assert_eq!(sizes, [24_896, 24_832, 33_024, 8_448, 16_640]);
}

#[test]
fn metadata_of_every_generation_gives_the_same_sensor() {
    let sensor = SMALL;
    let mut writer = Writer::new(Container::PcapNg, Link::Ethernet);
    sensor.write(&mut writer, 0..1);
    let mut mixed = sensor.sections();
    mixed["beam_to_lidar_transform"] = Value::Null;
    mixed["lidar_intrinsics"] = Value::Null;
    mixed["beam_intrinsics"]
        .as_object_mut()
        .unwrap()
        .remove("beam_to_lidar_transform");
    mixed["lidar_data_format"]
        .as_object_mut()
        .unwrap()
        .remove("udp_profile_lidar");
    mixed["lidar_data_format"]
        .as_object_mut()
        .unwrap()
        .remove("columns_per_frame");
    for metadata in [sensor.flat(), sensor.sections(), mixed] {
        let files = Files::new();
        files.write("walk.json", metadata.to_string().as_bytes());
        let path = files.write("walk.pcapng", &writer.bytes);
        check(&clouds(&path)[0], &sensor.points(0), 2e-5);
    }
}

#[test]
fn beams_may_start_offset_from_the_axis() {
    let sensor = SMALL;
    let mut metadata = sensor.sections();
    metadata["beam_intrinsics"]["beam_to_lidar_transform"][3] = json!(30.0);
    metadata["beam_intrinsics"]["beam_to_lidar_transform"][11] = json!(40.0);
    let mut writer = Writer::new(Container::Pcap, Link::Ethernet);
    sensor.write(&mut writer, 0..1);
    let files = Files::new();
    files.write("drive.json", metadata.to_string().as_bytes());
    let path = files.write("drive.pcap", &writer.bytes);
    let cloud = &clouds(&path)[0];
    // The first shot with a return in the first column, whose head is at 0.
    let beam = (0..32).find(|&beam| sensor.measured(0, 0, beam, 0).0 > 0).unwrap();
    let range = f64::from(sensor.measured(0, 0, beam, 0).0) - 50.0;
    let (azimuth, phi) = (-Sensor::azimuth(beam).to_radians(), sensor.altitude(beam).to_radians());
    let expected = [
        -(range * azimuth.cos() * phi.cos() + 30.0),
        -(range * azimuth.sin() * phi.cos()),
        range * phi.sin() + 40.0 + 36.18,
    ];
    let found = cloud.positions.get(0).to_array();
    for axis in 0..3 {
        assert!(
            (found[axis] - expected[axis] / 1000.0).abs() < 1e-5,
            "{found:?}, expected {expected:?} mm"
        );
    }
}

#[test]
fn late_and_duplicate_packets_count_once_in_their_frame() {
    let sensor = SMALL;
    let mut order: Vec<(u16, usize)> = (0..3)
        .flat_map(|frame| (0..32).map(move |index| (frame, index)))
        .collect();
    // The last packet of a frame arrives after the first ones of the next, and one is captured twice.
    let late = order.remove(31);
    order.insert(34, late);
    order.insert(50, order[50]);
    let mut writer = Writer::new(Container::Pcap, Link::Ethernet);
    for (after, (frame, index)) in order.into_iter().enumerate() {
        writer.datagram(after as u64 * 1000, SENDER, &sensor.packet(frame, index));
    }
    let files = Files::new();
    files.write("drive.json", sensor.flat().to_string().as_bytes());
    let path = files.write("drive.pcap", &writer.bytes);
    let clouds = clouds(&path);
    let counts: Vec<usize> = clouds.iter().map(|cloud| cloud.positions.len()).collect();
    assert_eq!(counts, [0, 1, 2].map(|frame| sensor.points(frame).len()));
    check(&clouds[0], &sensor.points(0), 2e-5);
}

#[test]
fn fragments_are_joined_in_any_order_and_lost_ones_only_lose_their_packet() {
    let sensor = Sensor { pixels: 128, ..SMALL };
    let mut writer = Writer::new(Container::Pcap, Link::Ethernet);
    let mut lost = 0;
    for frame in 0..2 {
        for index in 0..sensor.packets() {
            let mut pieces = writer.packets_of(SENDER, &sensor.packet(frame, index));
            assert_eq!(pieces.len(), 17);
            match index {
                5 => pieces[1..].reverse(),
                9 => pieces.swap(3, 7),
                // A duplicated fragment.
                11 => pieces.insert(4, pieces[4].clone()),
                13 => {
                    pieces.remove(8);
                    lost += usize::from(frame == 0);
                }
                _ => {}
            }
            for piece in pieces {
                writer.packet(time(index as u64), &piece);
            }
        }
    }
    let files = Files::new();
    files.write("drive.json", sensor.sections().to_string().as_bytes());
    let path = files.write("drive.pcap", &writer.bytes);
    let cloud = &clouds(&path)[0];
    assert_eq!(lost, 1);
    let column_s = 97_657e-9;
    let is_there = |point: &Expected| !(13 * 16..14 * 16).contains(&((point.time_s / column_s).round() as usize));
    let expected: Vec<Expected> = sensor.points(0).into_iter().filter(is_there).collect();
    check(cloud, &expected, 2e-5);
}

#[test]
fn missing_metadata_is_reported_and_wrong_metadata_located() {
    let sensor = SMALL;
    let mut writer = Writer::new(Container::Pcap, Link::Ethernet);
    sensor.write(&mut writer, 0..1);
    let files = Files::new();
    let path = files.write("drive.pcap", &writer.bytes);
    let error = || io::read(&path).unwrap_err().to_string();
    let message = error();
    for part in [
        "drive.pcap",
        "Ouster",
        "6400 bytes",
        "drive.json",
        "(packet capture file)",
    ] {
        assert!(message.contains(part), "{message}");
    }
    let changed = |change: &dyn Fn(&mut Value)| {
        let mut metadata = sensor.sections();
        change(&mut metadata);
        files.write("drive.json", metadata.to_string().as_bytes());
        error()
    };
    let profile = changed(&|metadata| metadata["lidar_data_format"]["udp_profile_lidar"] = json!("RNG99"));
    assert!(
        profile.contains("udp_profile_lidar is RNG99, which is not read, expected one of LEGACY"),
        "{profile}"
    );
    let angles = changed(&|metadata| metadata["beam_intrinsics"]["beam_azimuth_angles"] = json!([1.0, 2.0]));
    assert!(
        angles.contains("beam_azimuth_angles has 2 angles, expected 32"),
        "{angles}"
    );
    let angle = changed(&|metadata| metadata["beam_intrinsics"]["beam_azimuth_angles"][7] = json!("left"));
    assert!(angle.contains("beam_azimuth_angles 7"), "{angle}");
    let matrix = changed(&|metadata| metadata["lidar_intrinsics"]["lidar_to_sensor_transform"] = json!([1]));
    assert!(matrix.contains("lidar_to_sensor_transform is not a matrix"), "{matrix}");
    let columns = changed(&|metadata| metadata["lidar_data_format"]["columns_per_frame"] = json!(1_000_000_000));
    assert!(
        columns.contains("columns_per_frame is 1000000000, expected a number from 1 to 8192"),
        "{columns}"
    );
    files.write("drive.json", b"{ \"beam_altitude_angles\": [");
    assert!(error().contains("drive.json, header: it is not JSON"), "{}", error());
    let other = Sensor { pixels: 64, ..sensor };
    files.write("drive.json", other.flat().to_string().as_bytes());
    assert!(
        error().contains("what is there is of packets of 12544 bytes"),
        "{}",
        error()
    );
}

#[test]
fn the_matching_metadata_is_used_of_several() {
    let (mut first, mut second) = (SMALL.sections(), SMALL.sections());
    first["sensor_info"]["prod_sn"] = json!("4711");
    first["beam_intrinsics"]["lidar_origin_to_beam_origin_mm"] = json!(500.0);
    second["config_params"]["udp_port_lidar"] = json!(7502);
    let mut writer = Writer::new(Container::Pcap, Link::Ethernet);
    SMALL.write(&mut writer, 0..1);
    let files = Files::new();
    let path = files.write("drive.pcap", &writer.bytes);
    // Closer by its name, but for another sensor.
    files.write("drive.json", first.to_string().as_bytes());
    files.write("other.json", second.to_string().as_bytes());
    files.write("settings.json", b"{}");
    check(&clouds(&path)[0], &SMALL.points(0), 2e-5);
}

#[test]
fn a_scan_is_read_without_the_rest_of_the_capture() {
    let sensor = SMALL;
    let mut writer = Writer::new(Container::Pcap, Link::Ethernet);
    sensor.write(&mut writer, 0..3);
    let files = Files::new();
    files.write("drive.json", sensor.sections().to_string().as_bytes());
    let path = files.write("drive.pcap", &writer.bytes);
    let options = ReadOptions::default();
    let entries = io::list(&path, &options).unwrap();
    // Noise instead of the first and the last frame.
    let third = writer.bytes.len() / 3;
    writer.bytes[24..third].fill(0xff);
    writer.bytes[2 * third + 24..].fill(0xff);
    files.write("drive.pcap", &writer.bytes);
    let cloud = io::read_part(&path, &entries[1].part, &options).unwrap();
    check(&cloud, &sensor.points(1), 2e-5);
    assert_eq!(scalar(&cloud, "ring").len(), cloud.positions.len());
    let error = io::read_part(&path, &entries[0].part, &options)
        .unwrap_err()
        .to_string();
    assert!(error.contains("damaged"), "{error}");
}

#[test]
fn a_window_across_the_first_measurement_is_not_cut() {
    let sensor = SMALL;
    // Measurements 384 to 511 and 0 to 127: the sensor increments the frame number mid-window.
    let mut writer = Writer::new(Container::Pcap, Link::Ethernet);
    let mut after = 0;
    for frame in 0..5 {
        for index in (0..8).chain(24..32) {
            writer.datagram(after, SENDER, &sensor.packet(frame, index));
            after += 1000;
        }
    }
    let files = Files::new();
    files.write("drive.json", sensor.sections().to_string().as_bytes());
    let path = files.write("drive.pcap", &writer.bytes);
    let clouds = clouds(&path);
    // Half a window at either end counts as half a frame.
    assert_eq!(clouds.len(), 6);
    for (index, cloud) in clouds.iter().enumerate().take(5).skip(1) {
        let of_column = |points: Vec<Expected>, frame: u16, columns: std::ops::Range<usize>| {
            let begin_s = (sensor.time_ns(frame, 0) - 1_000_000_000_000) as f64 * 1e-9;
            let column = move |point: &Expected| ((point.time_s - begin_s) / 97_657e-9).round() as usize;
            points.into_iter().filter(move |point| columns.contains(&column(point)))
        };
        let (before, now) = (index as u16 - 1, index as u16);
        let first = of_column(sensor.points(before), before, 384..512);
        let expected: Vec<Expected> = first.chain(of_column(sensor.points(now), now, 0..128)).collect();
        check(cloud, &expected, 2e-5);
    }
}
