//! The HDL-64E, each of which has a calibration of its own.

use super::captures::{Container, Files, Link, SENDER, Writer, clouds, scalar};
use pointreel::io;
use std::fmt::Write as _;

/// Numbers of laser `laser` in degrees and centimetres: rotation, elevation, far, near X, near Y, height, aside.
fn corrections(laser: usize) -> [f64; 7] {
    let laser = laser as f64;
    [
        laser / 7.0 - 4.0,
        2.0 - laser * 0.4,
        110.0 + laser,
        115.0 - laser,
        108.0 + laser / 2.0,
        20.0 - laser / 4.0,
        2.6,
    ]
}

/// A calibration as it comes with a sensor.
pub(crate) fn db_xml() -> String {
    const NAMES: [&str; 7] = [
        "rotCorrection_",
        "vertCorrection_",
        "distCorrection_",
        "distCorrectionX_",
        "distCorrectionY_",
        "vertOffsetCorrection_",
        "horizOffsetCorrection_",
    ];
    let mut text = "<?xml version=\"1.0\" encoding=\"UTF-8\" standalone=\"yes\" ?>\n<!DOCTYPE boost_serialization>\n\
                    <boost_serialization signature=\"serialization::archive\" version=\"4\">\n<DB class_id=\"0\">\
                    <distLSB_>0.2</distLSB_><points_><count>64</count>\n"
        .to_owned();
    for laser in 0..64 {
        write!(text, "<item><px class_id=\"8\"><id_>{laser}</id_>").unwrap();
        for (name, value) in NAMES.iter().zip(corrections(laser)) {
            write!(text, "<{name}>{value}</{name}>").unwrap();
        }
        text += "</px></item>\n";
    }
    text + "</points_></DB></boost_serialization>\n"
}

/// Packets of an HDL-64E: both banks at a time, in dual mode twice.
pub(crate) fn hdl_64_packet(index: usize, is_dual: bool) -> Vec<u8> {
    let mut bytes = Vec::new();
    for block in 0..12 {
        let firing = index * if is_dual { 3 } else { 6 } + block / if is_dual { 4 } else { 2 };
        bytes.extend([0xff, if block % 2 == 0 { 0xee } else { 0xdd }]);
        bytes.extend((hdl_64_azimuth(firing) as u16).to_le_bytes());
        for shot in 0..32 {
            let laser = block % 2 * 32 + shot;
            let echo = if is_dual { block % 4 / 2 } else { 0 };
            bytes.extend(hdl_64_distance(firing, laser, echo).to_le_bytes());
            bytes.push(laser as u8);
        }
    }
    bytes.extend((index as u32 * 288).to_le_bytes());
    // Any status.
    bytes.extend([b'V', 0x22]);
    bytes
}

fn hdl_64_azimuth(firing: usize) -> usize {
    (firing * 150) % 36_000
}

fn hdl_64_distance(firing: usize, laser: usize, echo: usize) -> u16 {
    (1000 + firing * 37 % 20_000 + laser * 11 + echo * 500) as u16
}

/// The manual's appendix F, in centimetres as there.
fn hdl_64_position(firing: usize, laser: usize, echo: usize) -> [f64; 3] {
    let [rotation, elevation, far, near_x, near_y, height, aside] = corrections(laser);
    let raw = f64::from(hdl_64_distance(firing, laser, echo)) * 0.2;
    let angle = (hdl_64_azimuth(firing) as f64 / 100.0 - rotation).to_radians();
    let (sin, cos) = (angle.sin(), angle.cos());
    let (rise, run) = (elevation.to_radians().sin(), elevation.to_radians().cos());
    let flat = (raw + far) * run;
    let x = (flat * sin - aside * cos).abs();
    let y = (flat * cos + aside * sin).abs();
    let (add_x, add_y) = if raw > 2500.0 {
        (far, far)
    } else {
        (
            (far - near_x) * (x - 240.0) / (2504.0 - 240.0) + near_x,
            (far - near_y) * (y - 193.0) / (2504.0 - 193.0) + near_y,
        )
    };
    [
        (raw + add_x) * run * sin - aside * cos,
        (raw + add_y) * run * cos + aside * sin,
        (raw + add_y) * rise + height,
    ]
    .map(|cm| cm / 100.0)
}

#[test]
fn the_hdl_64e_is_read_using_its_calibration() {
    for is_dual in [false, true] {
        let mut writer = Writer::new(Container::Pcap, Link::Ethernet);
        let packets = if is_dual { 200 } else { 100 };
        for index in 0..packets {
            writer.datagram(index as u64 * 288, SENDER, &hdl_64_packet(index, is_dual));
        }
        let files = Files::new();
        files.write("db.xml", db_xml().as_bytes());
        files.write("another.xml", b"<settings/>");
        let path = files.write("old.pcap", &writer.bytes);
        let clouds = clouds(&path);
        // 240 firings per revolution.
        assert_eq!(clouds.len(), 3);
        let mut expected = Vec::new();
        for firing in 0..240 {
            for echo in 0..=usize::from(is_dual) {
                expected.extend((0..64).map(|laser| hdl_64_position(firing, laser, echo)));
            }
        }
        assert_eq!(clouds[0].positions.len(), expected.len());
        for (index, expected) in expected.iter().enumerate() {
            let found = clouds[0].positions.get(index).to_array();
            let is_near = |axis: usize| (found[axis] - expected[axis]).abs() < 1e-5;
            assert!((0..3).all(is_near), "point {index}: {found:?}, expected {expected:?}");
        }
        // The higher the number, the lower the laser points.
        assert_eq!(scalar(&clouds[0], "ring")[..3], [63.0, 62.0, 61.0]);
        let has_returns = clouds[0]
            .attributes
            .scalars
            .iter()
            .any(|field| field.name == "return_number");
        assert_eq!(has_returns, is_dual);
    }
}

#[test]
fn an_hdl_64e_without_calibration_is_rejected_naming_the_missing_file() {
    let mut writer = Writer::new(Container::Pcap, Link::Ethernet);
    for index in 0..50 {
        writer.datagram(index as u64 * 288, SENDER, &hdl_64_packet(index, false));
    }
    let files = Files::new();
    let path = files.write("old.pcap", &writer.bytes);
    let error = io::read(&path).unwrap_err().to_string();
    assert!(
        error.contains("HDL-64E") && error.contains("db.xml") && error.contains("old.xml"),
        "{error}"
    );
    let cut = db_xml().replace("<id_>9</id_>", "<id_>99</id_>");
    files.write("db.xml", cut.as_bytes());
    let error = io::read(&path).unwrap_err().to_string();
    assert!(error.contains("db.xml, laser 9"), "{error}");
}
