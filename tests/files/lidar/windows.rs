//! Sensors that measure in a window of azimuths.

use super::captures::{Container, Files, Link, SENDER, Writer, clouds};
use super::velodyne::{MODELS, Scan};

/// A VLP-16 that measures for `window` degrees from `begin` on, over and over: each sweep is a packet for 12 degrees.
fn sweeps(begin: usize, window: usize, count: usize) -> Vec<Vec<u8>> {
    let mut packets = Vec::new();
    for _ in 0..count {
        for part in 0..window / 12 {
            let scan = Scan {
                model: &MODELS[0],
                is_dual: false,
                step: 100,
                begin: (begin + part * 12) % 360 * 100,
            };
            packets.push(scan.packet(0));
        }
    }
    packets
}

#[test]
fn frames_are_complete_azimuth_windows() {
    for (begin, window) in [
        (270, 180),
        (300, 120),
        (180, 300),
        (10, 60),
        (345, 36),
        (90, 120),
        (0, 180),
        (200, 156),
    ] {
        let mut writer = Writer::new(Container::Pcap, Link::Ethernet);
        for (index, packet) in sweeps(begin, window, 6).iter().enumerate() {
            writer.datagram(index as u64 * 3000, SENDER, packet);
        }
        let files = Files::new();
        let path = files.write("window.pcap", &writer.bytes);
        let clouds = clouds(&path);
        assert_eq!(clouds.len(), 6, "{begin} {window}");
        for cloud in &clouds {
            assert_eq!(cloud.positions.len(), clouds[0].positions.len(), "{begin} {window}");
        }
    }
}
