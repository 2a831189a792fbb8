//! Servers that are none, and clients that talk nonsense.

use super::*;
use crate::deadlines::{ClientDeadlines, MinRate, ServerDeadlines};
use crate::serve::live::audience::MAX_CLIENTS;
use crate::wire::{Ping, View};
use glam::{DVec3, Mat3};
use std::net::Shutdown;

/// Answers each connection by `bytes`, and then keeps silent for as long as it is there.
fn hostile(bytes: Vec<u8>) -> (PathBuf, SocketAddr) {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap();
    let thread = thread::Builder::new().name("hostile".to_owned());
    thread
        .spawn(move || {
            let mut open = Vec::new();
            for stream in listener.incoming() {
                let mut stream = stream.unwrap();
                let _ = stream.write_all(&bytes);
                open.push(stream);
            }
        })
        .unwrap();
    (format!("tcp://{address}").into(), address)
}

fn impatient() -> ClientDeadlines {
    ClientDeadlines {
        silence: Duration::from_millis(500),
        transfer: MinRate {
            grace: Duration::from_millis(500),
            bytes_per_s: 1e5,
        },
        first_frame: Duration::from_millis(500),
        ..ClientDeadlines::default()
    }
}

fn refused(url: &Path) -> String {
    let begun = Instant::now();
    let error = LiveStream::open_within(url, &OpenOptions::default(), &Progress::default(), impatient())
        .err()
        .unwrap();
    assert!(begun.elapsed() < Duration::from_secs(30));
    let text = error.to_string();
    assert!(
        matches!(error, SequenceError::Stream { .. }) && text.contains(url.to_str().unwrap()),
        "{text}"
    );
    text
}

#[test]
fn other_kinds_of_servers_are_distinguished() {
    let head = StreamHead {
        session: 1,
        clock_ns: 0,
        fps: 30.0,
        wall_ns: 0,
    };
    let mut newer = head.encode();
    newer[8] = 9;
    let mut huge = head.encode();
    huge.extend([1, 0, 0, 0, 0xff, 0xff, 0xff, 0xff, 0, 0, 0, 0]);
    let mut damaged = head.encode();
    damaged.extend(Message::new(Kind::Points, vec![7; 20]).encode());
    let cases = thread::scope(|scope| {
        let cases = [
            (b"SSH-2.0-OpenSSH_9.6\r\n".to_vec(), "not a live stream"),
            (newer, "version 9"),
            (huge, "claims 4294967295 bytes"),
            (damaged, "the head of a frame"),
            (Vec::new(), "has said nothing for 0.5 seconds"),
            (head.encode(), "has said nothing for 0.5 seconds"),
        ];
        let cases = cases.map(|(bytes, expected)| {
            let (url, _) = hostile(bytes);
            (scope.spawn(move || refused(&url)), expected)
        });
        cases.map(|(refused, expected)| (refused.join().unwrap(), expected))
    });
    for (text, expected) in cases {
        assert!(text.contains(expected), "{text}");
    }
}

#[test]
fn a_refused_connection_is_reported_with_advice() {
    let free = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap();
    let text = refused(Path::new(&format!("tcp://{free}")));
    assert!(text.contains("pointreel serve INPUT --live"), "{text}");
    assert!(refused(Path::new("tcp://nowhere")).contains("tcp://127.0.0.1:9000"));
}

#[test]
fn opening_can_be_cancelled() {
    let (url, _) = hostile(Vec::new());
    let progress = Progress::default();
    progress.cancel();
    let error = LiveStream::open(&url, &OpenOptions::default(), &progress)
        .err()
        .unwrap();
    assert!(matches!(error, SequenceError::Cancelled), "{error}");
}

#[test]
fn clients_that_send_garbage_are_disconnected() {
    let server = Running::new(points(3, 10), 100.0, RAW);
    let quick = opened(&server.url());
    let nonsense: [&[u8]; 3] = [
        b"GET / HTTP/1.1\r\n\r\n",
        &[0xff; 64],
        &[16, 0, 0, 0, 255, 0, 0, 0, 1, 2, 3, 4],
    ];
    for bytes in nonsense {
        let mut client = TcpStream::connect(server.address()).unwrap();
        client.write_all(bytes).unwrap();
        let _ = client.shutdown(std::net::Shutdown::Write);
    }
    wait_for("their end", || server.left().len() == nonsense.len());
    let before = quick.status().received_frames;
    wait_for("frames", || quick.status().received_frames > before + 10);
}

/// Connects as a good client does, and gets frames without being sent away.
fn assert_served_at_once(server: &Running) {
    let good = LiveStream::open(&server.url(), &OpenOptions::default(), &Progress::default()).unwrap();
    let before = good.status().received_frames;
    wait_for("frames", || good.status().received_frames > before + 2);
    assert_eq!(good.status().reconnects, 0);
}

fn crowd(server: &Running) -> Vec<TcpStream> {
    let crowd: Vec<TcpStream> = (0..MAX_CLIENTS)
        .map(|_| TcpStream::connect(server.address()).unwrap())
        .collect();
    wait_for("clients", || server.server.report().clients == crowd.len());
    crowd
}

#[test]
fn clients_that_never_read_do_not_block_others() {
    // Larger than socket buffers, so that a sender waits for its client.
    let server = Running::new(points(2, 400_000), 20.0, RAW);
    let stuck = crowd(&server);
    assert_served_at_once(&server);
    drop(stuck);
}

#[test]
fn silent_clients_do_not_block_others_although_buffers_hold_their_frames() {
    let server = Running::new(points(2, 10), 20.0, RAW);
    let silent = crowd(&server);
    assert_served_at_once(&server);
    drop(silent);
}

#[test]
fn a_full_server_of_active_clients_turns_others_away() {
    let deadlines = ServerDeadlines {
        stuck: Duration::from_hours(1),
        place: Duration::from_millis(100),
        ..ServerDeadlines::default()
    };
    let server = Running::within(points(2, 10), deadlines);
    let mut crowd = crowd(&server);
    for client in &mut crowd {
        client.write_all(&Ping { client_ns: 1 }.message().encode()).unwrap();
    }
    wait_for("pings", || server.server.all_have_spoken());
    let error = LiveStream::open(&server.url(), &OpenOptions::default(), &Progress::default()).err();
    assert!(error.unwrap().to_string().contains("the maximum number of clients"));
    assert_eq!(server.server.report().clients, MAX_CLIENTS);
}

#[test]
fn a_client_that_reads_a_frame_too_slowly_is_disconnected() {
    let deadlines = ServerDeadlines {
        message: MinRate {
            grace: Duration::from_millis(200),
            bytes_per_s: 1e9,
        },
        ..ServerDeadlines::default()
    };
    let server = Running::within(points(2, 400_000), deadlines);
    let mut slow = TcpStream::connect(server.address()).unwrap();
    let dripping = thread::Builder::new().name("dripping".to_owned()).spawn(move || {
        let begun = Instant::now();
        while let Ok(1..) = slow.read(&mut [0; 512]) {
            assert!(begun.elapsed() < LONG, "it may go on for ever");
            thread::sleep(Duration::from_millis(1));
        }
    });
    wait_for("the slow one to be left", || !server.left().is_empty());
    let reason = &server.left()[0].reason;
    assert!(reason.contains("expected 1000000000 per second"), "{reason}");
    drop(server);
    dripping.unwrap().join().unwrap();
}

#[test]
fn floods_resets_and_half_closed_clients_do_not_harm_the_server() {
    let server = Running::new(points(3, 10), 100.0, RAW);
    let view = View {
        eye: DVec3::ZERO,
        rotation: Mat3::IDENTITY,
        near: 0.1,
        size_px: [64, 48],
        px_per_slope: [50.0, 50.0],
        center_px: [32.0, 24.0],
    };
    let mut nan = view;
    nan.eye.x = f64::NAN;
    let mut infinite = view;
    infinite.center_px[0] = f32::INFINITY;
    let mut far = view;
    far.eye = DVec3::splat(1e300);
    let mut huge = view;
    huge.size_px = [u32::MAX, u32::MAX];
    let mut claims = vec![18, 0, 0, 0, 0xff, 0xff, 0xff, 0xff, 0, 0, 0, 0];
    claims.extend([7; 64]);
    let whole = view.message().encode();
    let mut damaged = whole.clone();
    damaged[20] ^= 1;
    let said: Vec<Vec<u8>> = vec![
        nan.message().encode(),
        infinite.message().encode(),
        far.message().encode(),
        huge.message().encode(),
        claims,
        whole[..whole.len() - 9].to_vec(),
        damaged,
        Ping { client_ns: u64::MAX }.message().encode().repeat(2000),
        Got { number: u64::MAX }.message().encode().repeat(2000),
        (0..4000_u32)
            .flat_map(|at| at.wrapping_mul(2_654_435_761).to_le_bytes())
            .collect(),
        Vec::new(),
    ];
    for round in 0..8 * said.len() {
        let mut client = TcpStream::connect(server.address()).unwrap();
        // The server may have closed the connection before the end.
        let _ = client.write_all(&said[round % said.len()]);
        if round % 2 == 0 {
            let _ = client.shutdown(Shutdown::Write);
            // Closing with unread data causes a reset.
            let _ = client.read(&mut [0; 64]);
        }
    }
    wait_for("their end", || server.server.report().clients == 0);
    assert_served_at_once(&server);
}

#[test]
fn a_dripping_server_is_abandoned_however_often_it_sends_a_byte() {
    let head = StreamHead {
        session: 1,
        clock_ns: 0,
        fps: 30.0,
        wall_ns: 0,
    };
    let claims = [head.encode(), vec![2, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0]].concat();
    let cases = [(head.encode()[..12].to_vec(), ""), (claims, "")];
    for (begin, expected) in cases {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let url = format!("tcp://{}", listener.local_addr().unwrap());
        let dripping = thread::Builder::new().name("dripping".to_owned()).spawn(move || {
            let (mut stream, _) = listener.accept().unwrap();
            let begun = Instant::now();
            let _ = stream.write_all(&begin);
            while stream.write_all(&[0]).is_ok() {
                assert!(begun.elapsed() < LONG, "it may go on for ever");
                thread::sleep(Duration::from_millis(10));
            }
        });
        let error = refused(Path::new(&url));
        assert!(error.contains(expected), "{error}");
        dripping.unwrap().join().unwrap();
    }
}

/// A source whose second frame is a defect of the program.
fn failing() -> FrameList {
    let entries = (0..3).map(|frame| FrameEntry::embedded(frame.to_string(), &[]));
    FrameList::new(entries.collect(), |entry, _| {
        assert_ne!(entry.name, "1", "a defect");
        Ok(cloud(entry.name.parse()?, 10))
    })
}

#[test]
fn a_failing_frame_does_not_end_the_stream() {
    let server = Running::new(failing(), 100.0, RAW);
    let client = opened(&server.url());
    wait_for("frames of several rounds", || client.status().received_frames > 10);
    assert!(server.server.report().missed_frames > 0);
}
