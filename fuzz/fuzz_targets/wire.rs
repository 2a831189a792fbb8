//! Any bytes as a live stream: as they are, behind a head that is right, and as frames whose checksums are right. A
//! refusal is as good as a frame.

#![no_main]

use libfuzzer_sys::fuzz_target;
use pointreel::fuzzing::unpacked_size_px;
use pointreel::wire::{Content, Frame, FrameHead, Kind, Message, StreamHead, View, read_message};

/// Bytes that a payload, and its unpacked contents, may take.
const MAX_BYTES: u64 = 1 << 26;

fn take(mut stream: &[u8]) {
    if StreamHead::read(&mut stream).is_err() {
        return;
    }
    while let Ok(message) = read_message(&mut stream, MAX_BYTES) {
        take_message(message);
    }
}

fn take_message(message: Message) {
    match Frame::of(message).map(|frame| frame.map(|frame| frame.content)) {
        Ok(Some(Content::Images(images))) => {
            let size_px = images.depth.size_px();
            assert_eq!(size_px, images.rig.depth.size_px());
            if let Some(unpacked_px) = unpacked_size_px(&images.depth, MAX_BYTES) {
                assert_eq!(unpacked_px, size_px);
            }
            let _ = images.color.map(|color| unpacked_size_px(&color, MAX_BYTES));
        }
        Ok(Some(Content::Points(points))) => {
            if let Ok(cloud) = points.cloud() {
                assert_eq!(cloud.attributes.other_length(cloud.positions.len()), None);
            }
        }
        _ => {}
    }
}

fuzz_target!(|data: &[u8]| {
    take(data);
    if let Ok(view) = View::parse(data) {
        assert_eq!(View::parse(&view.message().payload).ok(), Some(view));
    }
    let head = StreamHead {
        session: 1,
        clock_ns: 2,
        fps: 30.0,
        wall_ns: 3,
    };
    take(&[head.encode(), data.to_vec()].concat());
    let frame = FrameHead {
        index: 0,
        number: 1,
        time_ns: 2,
        served_ns: 3,
    };
    for kind in [Kind::Images, Kind::Points] {
        take_message(Message::new(kind, data.to_vec()));
        take_message(Message::new(kind, [&frame.encode(), data].concat()));
    }
});
