//! Any bytes as a capture of packets: its sensors are found, and the first revolutions of each read. Metadata of Ouster
//! and a calibration of an HDL-64E lie next to it, so that their packets are reached too.

#![no_main]

use libfuzzer_sys::fuzz_target;
use pointreel::io::{self, ReadOptions};
use std::path::Path;

/// Number of revolutions read per sensor.
const READ: usize = 3;

/// Sixteen beams, small packets.
const METADATA: &str = r#"{
    "lidar_mode": "512x10",
    "beam_altitude_angles": [15, 13, 11, 9, 7, 5, 3, 1, -1, -3, -5, -7, -9, -11, -13, -15],
    "beam_azimuth_angles": [4, 2, -2, -4, 4, 2, -2, -4, 4, 2, -2, -4, 4, 2, -2, -4],
    "data_format": { "udp_profile_lidar": "RNG15_RFL8_NIR8", "columns_per_packet": 16 }
}"#;

/// All lasers alike.
fn calibration() -> String {
    let laser = |id: usize| {
        format!("<px><id_>{id}</id_><rotCorrection_>1</rotCorrection_><vertCorrection_>-9</vertCorrection_></px>")
    };
    let lasers: String = (0..64).map(laser).collect();
    format!("<boost_serialization><DB>{lasers}</DB></boost_serialization>")
}

/// Writes the sidecar files of captures, in a folder of their own.
fn folder() -> std::io::Result<std::path::PathBuf> {
    let memory = Path::new("/dev/shm");
    let folder = if memory.is_dir() { memory.to_owned() } else { std::env::temp_dir() };
    let folder = folder.join(format!("pointreel-fuzz-packets-{}", std::process::id()));
    if !folder.is_dir() {
        std::fs::create_dir_all(&folder)?;
        std::fs::write(folder.join("any.json"), METADATA)?;
        std::fs::write(folder.join("db.xml"), calibration())?;
    }
    Ok(folder)
}

fuzz_target!(|data: &[u8]| {
    let Ok(folder) = folder() else {
        return;
    };
    let path = folder.join("fuzz.pcap");
    if std::fs::write(&path, data).is_err() {
        return;
    }
    let options = ReadOptions::default();
    let Ok(contents) = io::contents(&path, None, &options) else {
        return;
    };
    for topic in &contents.topics {
        let Ok(contents) = io::contents(&path, Some(&topic.name), &options) else {
            continue;
        };
        assert_eq!(contents.entries.len(), topic.cloud_count);
        for entry in contents.entries.iter().take(READ) {
            // A refusal is as good as a cloud.
            if let Ok(cloud) = io::read_part(&path, &entry.part, &options) {
                assert_eq!(cloud.attributes.other_length(cloud.positions.len()), None);
            }
        }
    }
});
