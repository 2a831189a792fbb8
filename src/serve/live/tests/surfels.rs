//! Clients that send their view.

use super::*;
use crate::wire::View;
use glam::{DVec3, Mat3};

/// Two walls of 60 × 60 points that are a centimetre apart, one and two metres before a camera at the origin that looks
/// along −z; `at` is added to all.
fn walls(at: DVec3) -> FrameList {
    let entries = (0..3).map(|frame| FrameEntry::embedded(frame.to_string(), &[]));
    FrameList::new(entries.collect(), move |_, _| {
        let wall = |depth: f64| {
            (0..3600).map(move |index| {
                let (column, row) = (f64::from(index % 60), f64::from(index / 60));
                (at + DVec3::new(0.01 * (column - 29.5), 0.01 * (row - 29.5), -depth)).to_array()
            })
        };
        // The rear one comes first.
        let mut cloud = RawCloud::from_positions(Positions::F64(wall(2.0).chain(wall(1.0)).collect()));
        cloud.attributes.colors = Some((0..7200).map(|index| [(index / 3600) as u8, 2, 3, 255]).collect());
        Ok(cloud)
    })
}

fn view(eye: DVec3) -> View {
    View {
        eye,
        rotation: Mat3::IDENTITY,
        near: 0.01,
        size_px: [320, 240],
        px_per_slope: [125.0, -125.0],
        center_px: [160.0, 120.0],
    }
}

fn surfels(url: &Path) -> LiveStream {
    let options = OpenOptions {
        live_surfels: true,
        ..OpenOptions::default()
    };
    LiveStream::open(url, &options, &Progress::default()).unwrap()
}

fn newest(stream: &LiveStream) -> RawCloud {
    stream.look_again().unwrap();
    decoded(stream, stream.frames().end - 1)
}

#[test]
fn a_client_with_a_view_is_sent_what_it_sees_and_others_everything() {
    for at in [DVec3::ZERO, DVec3::new(4e6, -3e5, 100.0)] {
        let server = Running::new(walls(at), 50.0, RAW);
        let (seeing, all) = (surfels(&server.url()), opened(&server.url()));
        let whole = newest(&seeing);
        assert_eq!(whole.positions.len(), 7200, "before it has said what it looks at");
        let before = seeing.status();
        seeing.look_from(view(at));
        wait_for("what is seen", || newest(&seeing).positions.len() < 7200);
        let seen = newest(&seeing);
        // The wall in front of the other one, all of it.
        assert_eq!(seen.positions.len(), 3600);
        let Positions::F64(places) = &seen.positions else {
            panic!("coordinates stay as exact as they were")
        };
        for place in places {
            let place = DVec3::from_array(*place) - at;
            assert!((place.z + 1.0).abs() < 1e-3, "{place}");
        }
        assert!(
            seen.attributes
                .colors
                .unwrap()
                .iter()
                .all(|color| *color == [1, 2, 3, 255])
        );
        let normals = seen.attributes.normals.unwrap();
        assert!(normals.iter().all(|normal| normal[2] > 0.99), "they face the eye");
        let radii = seen.attributes.radii.unwrap();
        assert!(radii.iter().all(|radius| (0.004..0.04).contains(radius)));
        // From behind it is the other one.
        let turned = View {
            rotation: Mat3::from_rotation_y(std::f32::consts::PI),
            ..view(at - 3.0 * DVec3::Z)
        };
        seeing.look_from(turned);
        wait_for("what is seen from behind", || {
            let colors = newest(&seeing).attributes.colors.unwrap();
            colors.len() == 3600 && colors.iter().all(|color| color[0] == 0)
        });
        assert_eq!(newest(&all).positions.len(), 7200);
        assert!(seeing.status().received_frames > before.received_frames);
        drop(seeing);
        wait_for("it to leave", || !server.left().is_empty());
        // Half of the points, each with twice as many bytes: normals and radii.
        let report = &server.left()[0];
        let share = report.sent_bytes as f64 / report.whole_bytes.unwrap() as f64;
        assert!((0.9..1.1).contains(&share), "{report:?}");
        drop(all);
        wait_for("the other one to leave", || server.left().len() == 2);
        assert_eq!(server.left()[1].whole_bytes, None);
    }
}

#[test]
fn a_restarted_server_is_sent_the_current_view() {
    let source: Arc<dyn Source> = Arc::new(walls(DVec3::ZERO));
    let first = Running::at(&source, 50.0, RAW, "127.0.0.1:0".parse().unwrap());
    let (url, address) = (first.url(), first.address());
    let seeing = surfels(&url);
    seeing.look_from(view(DVec3::ZERO));
    wait_for("what is seen", || newest(&seeing).positions.len() == 3600);
    drop(first);
    let _second = Running::at(&source, 50.0, RAW, address);
    let reconnects = || seeing.status().reconnects;
    wait_for("the second server", || reconnects() == 1);
    let came = seeing.status().received_frames;
    wait_for("what is seen there", || {
        let is_new = seeing.status().received_frames > came + 2;
        is_new && newest(&seeing).positions.len() == 3600
    });
}

#[test]
fn a_stream_of_frames_ignores_the_view() {
    let server = Running::new(walls(DVec3::ZERO), 50.0, RAW);
    let stream = opened(&server.url());
    stream.look_from(view(DVec3::ZERO));
    let before = stream.status().received_frames;
    wait_for("frames", || stream.status().received_frames > before + 5);
    assert_eq!(newest(&stream).positions.len(), 7200);
}

#[test]
fn a_client_with_an_impossible_view_is_disconnected() {
    let server = Running::new(walls(DVec3::ZERO), 50.0, RAW);
    let mut client = TcpStream::connect(server.address()).unwrap();
    let mut wrong = view(DVec3::ZERO);
    wrong.size_px = [u32::MAX; 2];
    client.write_all(&wrong.message().encode()).unwrap();
    wait_for("its end", || !server.left().is_empty());
}
