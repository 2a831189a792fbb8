//! Bytes that are known, frames that come back, and bytes of enemies.

use super::*;
use crate::cloud::{AxisConvention, ImageGrid, LengthUnit, Positions, RawCloud, ScalarField};
use crate::raster::{Raster, Samples};
use crate::rgbd::{Camera, ColorCamera, Distortion, Rig};
use glam::{DAffine3, DQuat, DVec2, DVec3};
use proptest::prelude::*;
use std::sync::Arc;

const MAX: u64 = 1 << 24;

fn head() -> FrameHead {
    FrameHead {
        index: 3,
        number: 1003,
        time_ns: 33_433_333_333,
        served_ns: 77,
    }
}

fn frame_message(kind: Kind, body: &[u8]) -> Message {
    Message::new(kind, [&head().encode(), body].concat())
}

/// A camera with a lens, colours of another one, and a pose.
fn images(depth: Samples, color: Option<RawColor>) -> RawImages {
    let camera = |size, focal: f64, distortion| {
        Camera::new(size, DVec2::new(focal, focal + 0.5), DVec2::new(3.5, 2.25), distortion).unwrap()
    };
    let lens = Distortion::Rational {
        k: [0.1, 0.2, 0.03, 0.4, 0.05, 0.06],
        p: [-8.1e-5, -3.6e-5],
    };
    let apart = DAffine3::from_rotation_translation(DQuat::from_rotation_y(0.01), DVec3::new(0.05, 0.0, -0.002));
    RawImages {
        rig: Arc::new(Rig {
            depth: camera([8, 6], 50.0, lens),
            color: Some(ColorCamera {
                camera: camera(
                    [10, 4],
                    60.0,
                    Distortion::Fisheye {
                        k: [0.1, 0.2, 0.3, 0.4],
                    },
                ),
                color_from_depth: apart,
            }),
        }),
        world_from_camera: Some(DAffine3::from_translation(DVec3::new(1.0, 2.0, 3.0))),
        units_per_metre: 5000.0,
        depth: Raster {
            size_px: [8, 6],
            samples: depth,
        },
        color,
    }
}

fn depths() -> Vec<u16> {
    (0..48).map(|at| if at % 7 == 0 { 0 } else { 5000 + at * at }).collect()
}

fn colors() -> Raster {
    // As smooth as most natural images.
    let pixel = |at: u8| [100 + at, 120 + at / 2, 200 - at];
    Raster {
        size_px: [10, 4],
        samples: Samples::Rgb8((0..40).map(pixel).collect()),
    }
}

fn received(images: &RawImages, coding: ImageCoding) -> ReceivedImages {
    let (body, problem) = images_body(images, coding, MAX).unwrap();
    assert_eq!(problem, None);
    let bytes = frame_message(Kind::Images, &body).encode();
    let message = read_message(&mut bytes.as_slice(), MAX).unwrap();
    let frame = Frame::of(message).unwrap().unwrap();
    assert_eq!(frame.head, head());
    match frame.content {
        Content::Images(images) => *images,
        Content::Points(_) => panic!("images became points"),
    }
}

#[test]
fn images_round_trip() {
    let raw = ImageCoding {
        depth: DepthCoding::Raw,
        color: ColorCoding::Raw,
    };
    let floats: Vec<f32> = depths().iter().map(|&depth| f32::from(depth) * 1e-3).collect();
    for depth in [Samples::Gray16(depths()), Samples::GrayF32(floats)] {
        for coding in [
            raw,
            ImageCoding {
                depth: DepthCoding::Rvl,
                ..raw
            },
        ] {
            let sent = images(depth.clone(), Some(RawColor::Pixels(colors())));
            let came = received(&sent, coding);
            assert_eq!(came.rig, *sent.rig);
            assert_eq!(came.world_from_camera, sent.world_from_camera);
            assert_eq!(came.units_per_metre, 5000.0);
            assert_eq!(came.depth.raster(MAX), Ok(sent.depth.clone()));
            assert_eq!(came.color.unwrap().raster(MAX), Ok(colors()));
        }
    }
}

#[test]
fn jpeg_is_close_and_existing_jpegs_are_unchanged() {
    let sent = images(Samples::Gray16(depths()), Some(RawColor::Pixels(colors())));
    let came = received(&sent, ImageCoding::default());
    let jpeg = came.color.unwrap();
    let (Samples::Rgb8(before), Samples::Rgb8(after)) = (colors().samples, jpeg.raster(MAX).unwrap().samples) else {
        panic!("colours are colours");
    };
    let errors = before
        .as_flattened()
        .iter()
        .zip(after.as_flattened())
        .map(|(a, b)| a.abs_diff(*b));
    let (sum, max) = errors.fold((0, 0), |(sum, max), error| (sum + u32::from(error), max.max(error)));
    assert!(sum <= 3 * 120 && max <= 12, "sum {sum}, most {max}");
    let bytes = jpeg.jpeg().unwrap().to_vec();
    let passed_on = images(Samples::Gray16(depths()), Some(RawColor::Jpeg([10, 4], bytes.clone())));
    let came = received(&passed_on, ImageCoding::default());
    assert_eq!(came.color.unwrap().jpeg(), Some(bytes.as_slice()));
}

#[test]
fn an_image_without_colors_pose_or_second_camera_says_so() {
    let mut sent = images(Samples::Gray16(depths()), None);
    sent.world_from_camera = None;
    let rig = Rig {
        color: None,
        ..(*sent.rig).clone()
    };
    sent.rig = Arc::new(rig);
    let came = received(&sent, ImageCoding::default());
    assert!(came.color.is_none() && came.world_from_camera.is_none() && came.rig.color.is_none());
}

fn cloud(count: usize, positions: impl Fn(usize) -> [f64; 3], is_double: bool) -> RawCloud {
    let positions = (0..count).map(positions);
    let mut cloud = RawCloud::from_positions(if is_double {
        Positions::F64(positions.collect())
    } else {
        Positions::F32(positions.map(|at| at.map(|x| x as f32)).collect())
    });
    cloud.attributes.colors = Some((0..count).map(|at| [at as u8, 1, 2, 255]).collect());
    cloud.attributes.normals = Some((0..count).map(|at| [0.0, at as f32, -1.5]).collect());
    cloud.attributes.radii = Some((0..count).map(|at| at as f32 * 0.125).collect());
    cloud.attributes.scalars = vec![
        ScalarField::new("intensity", (0..count).map(|at| at as f32).collect()),
        ScalarField {
            offset: 1.5e9,
            ..ScalarField::new("zeit ä", vec![f32::NAN; count])
        },
    ];
    cloud.sensor = Some(DVec3::new(1.0, -2.0, 3.5));
    cloud.convention = Some(AxisConvention::UsuallyZUp);
    cloud.unit = Some(LengthUnit::SurveyFoot);
    cloud.grid = ImageGrid::of(2, (count / 2) as u32, count);
    cloud
}

fn received_points(cloud: &RawCloud) -> RawCloud {
    let message = frame_message(Kind::Points, &points_body(cloud));
    match Frame::of(message).unwrap().unwrap().content {
        Content::Points(points) => points.cloud().unwrap(),
        Content::Images(_) => panic!("points became images"),
    }
}

/// NaN is not equal to itself, but its text is.
fn text(cloud: &RawCloud) -> String {
    format!("{cloud:?}")
}

#[test]
fn points_round_trip() {
    let single = cloud(6, |at| [at as f64, 0.5, f64::NAN], false);
    assert_eq!(text(&received_points(&single)), text(&single));
    let empty = RawCloud::from_positions(Positions::F32(Vec::new()));
    assert_eq!(received_points(&empty), empty);
}

#[test]
fn large_coordinates_retain_their_detail() {
    let utm = cloud(
        100,
        |at| [4.5e5 + at as f64 * 1e-3, 5.4e6 + at as f64 * 0.01, 300.0],
        true,
    );
    let came = received_points(&utm);
    assert!(matches!(came.positions, Positions::F64(_)));
    for index in 0..100 {
        let apart = came.positions.get(index).distance(utm.positions.get(index));
        assert!(apart < 1e-7, "{apart} m at {index}");
    }
    assert_eq!(
        text(&RawCloud {
            positions: Positions::F64(vec![]),
            ..came
        }),
        text(&RawCloud {
            positions: Positions::F64(vec![]),
            ..utm
        })
    );
}

/// The bytes of ARCHITECTURE.md, "Live streams over TCP".
#[test]
fn the_documented_test_vector_matches() {
    let stream_head = StreamHead {
        session: 1,
        clock_ns: 2,
        fps: 30.0,
        wall_ns: 3,
    };
    let frame = FrameHead {
        index: 0,
        number: 7,
        time_ns: 233_333_333,
        served_ns: 5,
    };
    let mut point = RawCloud::from_positions(Positions::F32(vec![[1.0, 2.0, -0.5]]));
    point.attributes.colors = Some(vec![[255, 128, 0, 255]]);
    point.unit = Some(LengthUnit::Metre);
    let payload = [frame.encode(), points_body(&point)].concat();
    let stream = [stream_head.encode(), Message::new(Kind::Points, payload).encode()].concat();
    let digits: String = include_str!("test_vector.txt").split_whitespace().collect();
    let bytes = digits
        .as_bytes()
        .chunks(2)
        .map(|pair| std::str::from_utf8(pair).unwrap());
    let expected: Vec<u8> = bytes.map(|pair| u8::from_str_radix(pair, 16).unwrap()).collect();
    assert_eq!(stream, expected);
    let mut reader = stream.as_slice();
    assert_eq!(StreamHead::read(&mut reader).unwrap(), stream_head);
    let read = Frame::of(read_message(&mut reader, MAX).unwrap()).unwrap().unwrap();
    assert_eq!(read.head, frame);
    assert!(matches!(read_message(&mut reader, MAX), Err(WireError::Ended)));
}

#[test]
fn small_messages_round_trip() {
    let now = Now {
        clock_ns: 5,
        newest: None,
    };
    assert_eq!(Now::parse(&now.message().payload).unwrap(), now);
    let now = Now {
        clock_ns: 5,
        newest: Some(0),
    };
    assert_eq!(Now::parse(&now.message().payload).unwrap(), now);
    let pong = Pong {
        client_ns: 1,
        received_ns: 2,
        sent_ns: 3,
    };
    assert_eq!(Pong::parse(&pong.message().payload).unwrap(), pong);
    assert!(Pong::parse(&pong.message().payload[..23]).is_err());
    for number in 0..40 {
        assert_eq!(Kind::of(number).number(), number);
    }
}

#[test]
fn other_data_is_distinguished_from_a_truncated_stream() {
    let head = |bytes: &[u8]| StreamHead::read(&mut &bytes[..]).unwrap_err();
    let http = head(b"HTTP/1.1 400 Bad Request\r\n");
    assert!(http.is_final() && http.to_string().contains("`HTTP/1.1`"), "{http}");
    assert!(head(b"S").is_final());
    assert!(matches!(head(b""), WireError::Ended));
    let stream = StreamHead {
        session: 1,
        clock_ns: 2,
        fps: 30.0,
        wall_ns: 3,
    }
    .encode();
    for end in 1..stream.len() {
        assert!(
            matches!(head(&stream[..end]), WireError::IsTruncated { .. }),
            "{end} bytes"
        );
    }
    let mut newer = stream.clone();
    newer[8] = 2;
    let newer = head(&newer);
    assert!(newer.is_final() && newer.to_string().contains("version 2"), "{newer}");
    let mut long = stream.clone();
    long[12..16].copy_from_slice(&u32::MAX.to_le_bytes());
    assert!(matches!(head(&long), WireError::TooLong { .. }));
    let mut still = stream;
    still[32..40].copy_from_slice(&0.0f64.to_le_bytes());
    assert!(matches!(head(&still), WireError::Malformed { .. }));
}

#[test]
fn a_declared_length_alone_takes_no_memory() {
    let mut bytes = frame_message(Kind::Points, &[0; 80]).encode();
    bytes[4..8].copy_from_slice(&u32::MAX.to_le_bytes());
    let error = read_message(&mut bytes.as_slice(), u64::MAX).unwrap_err();
    assert!(matches!(error, WireError::TooLong { .. }), "{error}");
    bytes[4..8].copy_from_slice(&(1u32 << 30).to_le_bytes());
    let error = read_message(&mut bytes.as_slice(), u64::MAX).unwrap_err();
    assert!(matches!(error, WireError::IsTruncated { .. }), "{error}");
    let mut changed = frame_message(Kind::Points, &[0; 80]).encode();
    changed[60] ^= 1;
    let error = read_message(&mut changed.as_slice(), MAX).unwrap_err();
    assert!(matches!(error, WireError::Checksum { bytes: 112 }), "{error}");
}

#[test]
fn images_with_invalid_dimensions_are_rejected() {
    let sent = images(Samples::Gray16(depths()), Some(RawColor::Pixels(colors())));
    let (body, _) = images_body(&sent, ImageCoding::default(), MAX).unwrap();
    // Width and height of the depth camera come after layout, codes, flags, units and pose.
    for (size, field) in [
        ([30_000u32, 30_000], "30000 × 30000"),
        ([0, 6], "0 × 6"),
        ([40_000, 1], "40000 × 1"),
    ] {
        let mut body = body.clone();
        body[128..132].copy_from_slice(&size[0].to_le_bytes());
        body[132..136].copy_from_slice(&size[1].to_le_bytes());
        let error = Frame::of(frame_message(Kind::Images, &body)).unwrap_err().to_string();
        assert!(error.contains(field), "{error}");
    }
    // RVL with a different size from the camera's.
    let mut body = body;
    body[448..452].copy_from_slice(&4096u32.to_le_bytes());
    body[452..456].copy_from_slice(&4096u32.to_le_bytes());
    let frame = Frame::of(frame_message(Kind::Images, &body)).unwrap().unwrap();
    let Content::Images(images) = frame.content else {
        panic!("images are images")
    };
    assert!(images.depth.raster(MAX).is_err());
}

/// Any input gives an error or a frame. Unpacked data is bounded.
fn take(mut bytes: &[u8]) {
    if StreamHead::read(&mut bytes).is_err() {
        return;
    }
    while let Ok(message) = read_message(&mut bytes, MAX) {
        if let Ok(Some(frame)) = Frame::of(message) {
            match frame.content {
                Content::Images(images) => {
                    let _ = images.depth.raster(MAX);
                    let _ = images.color.map(|color| color.raster(MAX));
                }
                Content::Points(points) => {
                    if let Ok(cloud) = points.cloud() {
                        assert_eq!(cloud.attributes.other_length(cloud.positions.len()), None);
                    }
                }
            }
        }
    }
}

fn stream_of(messages: &[Message]) -> Vec<u8> {
    let head = StreamHead {
        session: 1,
        clock_ns: 2,
        fps: 30.0,
        wall_ns: 3,
    }
    .encode();
    messages.iter().fold(head, |mut bytes, message| {
        bytes.extend(message.encode());
        bytes
    })
}

proptest! {
    #[test]
    fn any_depths_round_trip(depths in prop::collection::vec(any::<u16>(), 48..49)) {
        let sent = images(Samples::Gray16(depths), None);
        prop_assert_eq!(received(&sent, ImageCoding::default()).depth.raster(MAX), Ok(sent.depth));
    }

    #[test]
    fn any_bytes_give_a_stream_or_an_error(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        take(&bytes);
        take(&[stream_of(&[]), bytes.clone()].concat());
        for kind in [Kind::Images, Kind::Points] {
            take(&stream_of(&[Message::new(kind, bytes.clone()), frame_message(kind, &bytes)]));
        }
    }

    /// Single fields that are changed, with checksums that are right all the same; and streams that are cut.
    #[test]
    fn changed_frames_give_frames_or_errors(
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
        cut in any::<prop::sample::Index>(),
        has_points: bool,
    ) {
        let (kind, mut body) = if has_points {
            (Kind::Points, points_body(&cloud(6, |at| [at as f64, 0.5, 2.0], true)))
        } else {
            let sent = images(Samples::Gray16(depths()), Some(RawColor::Pixels(colors())));
            (Kind::Images, images_body(&sent, ImageCoding::default(), MAX).unwrap().0)
        };
        for (at, value) in changes {
            let at = at.index(body.len());
            body[at] = value;
        }
        let stream = stream_of(&[frame_message(kind, &body)]);
        take(&stream);
        take(&stream[..cut.index(stream.len())]);
    }
}
