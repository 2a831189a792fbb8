//! Servers that are none, and clients that talk nonsense.

use super::*;
use crate::serve::live::audience::MOST_CLIENTS;

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

fn refused(url: &Path) -> String {
    let begun = Instant::now();
    let error = LiveStream::open(url, &OpenOptions::default(), &Progress::default())
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
fn servers_of_other_kinds_are_told_apart() {
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
            (b"SSH-2.0-OpenSSH_9.6\r\n".to_vec(), "no live stream"),
            (newer, "version 9"),
            (huge, "claims 4294967295 bytes"),
            (damaged, "the head of a frame"),
            (Vec::new(), "has said nothing for 5 seconds"),
            (head.encode(), "has said nothing for 5 seconds"),
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
fn nobody_listening_is_said_with_what_to_do() {
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
fn clients_that_talk_nonsense_are_left() {
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
    let before = quick.live().unwrap().status().received_frames;
    wait_for("frames", || {
        quick.live().unwrap().status().received_frames > before + 10
    });
}

#[test]
fn clients_that_never_read_keep_nobody_out() {
    // Larger than what sockets hold, so that a sender waits for its client.
    let server = Running::new(points(2, 400_000), 20.0, RAW);
    let stuck: Vec<TcpStream> = (0..MOST_CLIENTS)
        .map(|_| TcpStream::connect(server.address()).unwrap())
        .collect();
    wait_for("clients", || server.server.report().clients == stuck.len());
    let begun = Instant::now();
    let good = loop {
        match LiveStream::open(&server.url(), &OpenOptions::default(), &Progress::default()) {
            Ok(good) => break good,
            // There is no place before the others have been stuck for a while.
            Err(error) => assert!(begun.elapsed() < LONG, "{error}"),
        }
        thread::sleep(Duration::from_millis(50));
    };
    let before = good.live().unwrap().status().received_frames;
    wait_for("frames", || good.live().unwrap().status().received_frames > before + 2);
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
fn a_frame_that_the_program_fails_on_ends_no_stream() {
    let server = Running::new(failing(), 100.0, RAW);
    let client = opened(&server.url());
    wait_for("frames of several rounds", || {
        client.live().unwrap().status().received_frames > 10
    });
    assert!(server.server.report().missed_frames > 0);
}
