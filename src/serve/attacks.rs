//! Attacks on the HTTP server, over the loopback. Deadlines are short; waits are long, as machines are busy.

use super::{FileServer, FileServerOptions, MAX_CONNECTIONS, MAX_HEAD_BYTES};
use crate::deadlines::{MinRate, ServerDeadlines};
use std::io::{Read as _, Write as _};
use std::net::{Shutdown, SocketAddr, TcpStream};
use std::sync::Arc;
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

const LONG: Duration = Duration::from_mins(1);

/// Maximum response time for a well-formed request, with any other clients: two seconds, on a busy machine.
const SOON: Duration = Duration::from_secs(15);

const FILE: &[u8] = b"0123456789";

/// A server on a thread, which ends with it.
struct Running {
    server: Arc<FileServer>,
    thread: Option<JoinHandle<()>>,
    _folder: tempfile::TempDir,
}

impl Running {
    fn new(content: &[u8]) -> Self {
        let deadlines = ServerDeadlines {
            idle: Duration::from_millis(1500),
            head: Duration::from_millis(300),
            answer: MinRate {
                grace: Duration::from_millis(300),
                bytes_per_s: 1e6,
            },
            ..ServerDeadlines::default()
        };
        Self::within(content, deadlines)
    }

    fn within(content: &[u8], deadlines: ServerDeadlines) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.reel");
        std::fs::write(&path, content).unwrap();
        let options = FileServerOptions {
            deadlines,
            ..FileServerOptions::default()
        };
        let server = FileServer::bind(&path, "127.0.0.1:0".parse().unwrap(), options).unwrap();
        let server = Arc::new(server);
        let runs = Arc::clone(&server);
        let thread = thread::Builder::new().name("server".to_owned());
        Self {
            server,
            thread: Some(thread.spawn(move || runs.run().unwrap()).unwrap()),
            _folder: folder,
        }
    }

    fn address(&self) -> SocketAddr {
        let url = self.server.url().unwrap();
        let address = url.trim_start_matches("http://").split('/').next().unwrap();
        address.parse().unwrap()
    }

    fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect(self.address()).unwrap();
        stream.set_read_timeout(Some(LONG)).unwrap();
        stream
    }

    /// The answer to `request`, up to the end of the connection.
    fn answer(&self, request: &[u8]) -> String {
        let mut stream = self.connect();
        // It may have been refused before it was complete.
        let _ = stream.write_all(request);
        rest_of(stream)
    }

    fn assert_good(&self) {
        let begun = Instant::now();
        let answer = self.answer(b"GET /a.reel HTTP/1.1\r\nHost: x\r\nRange: bytes=0-9\r\nConnection: close\r\n\r\n");
        assert!(
            answer.starts_with("HTTP/1.1 206") && answer.ends_with("0123456789"),
            "{answer}"
        );
        assert!(begun.elapsed() < SOON, "served after {:?}", begun.elapsed());
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.server.stop();
        if let Some(thread) = self.thread.take() {
            thread.join().unwrap();
        }
    }
}

/// All received bytes; after a reset, those before it.
fn rest_of(mut stream: TcpStream) -> String {
    let (mut all, mut piece) = (Vec::new(), [0; 4096]);
    while let Ok(count @ 1..) = stream.read(&mut piece) {
        all.extend(&piece[..count]);
    }
    String::from_utf8_lossy(&all).into_owned()
}

/// Waits until the server hangs up; received data is dropped.
fn assert_left(mut stream: TcpStream) {
    let begun = Instant::now();
    let mut piece = [0; 4096];
    while let Ok(1..) = stream.read(&mut piece) {}
    assert!(begun.elapsed() < LONG, "it is still there");
}

#[test]
fn slow_clients_do_not_block_others() {
    let server = Running::new(FILE);
    let slow: Vec<TcpStream> = (0..MAX_CONNECTIONS + 8)
        .map(|number| {
            let mut stream = server.connect();
            // Some send nothing, some start and never finish.
            if number % 2 == 0 {
                let _ = stream.write_all(b"GET /a.reel HTTP/1.1\r\nX: ");
            }
            stream
        })
        .collect();
    server.assert_good();
    drop(slow);
}

#[test]
fn clients_that_never_read_do_not_block_others() {
    // More than network buffers hold.
    let server = Running::within(&[FILE, &vec![7; 64 << 20]].concat(), ServerDeadlines::default());
    let stuck: Vec<TcpStream> = (0..MAX_CONNECTIONS)
        .map(|_| {
            let mut stream = server.connect();
            stream.write_all(b"GET /a.reel HTTP/1.1\r\nHost: x\r\n\r\n").unwrap();
            stream
        })
        .collect();
    server.assert_good();
    drop(stuck);
}

#[test]
fn clients_that_send_too_slowly_are_disconnected() {
    let server = Running::new(FILE);
    let silent = server.connect();
    let mut head = server.connect();
    let dripping = thread::Builder::new().name("dripping".to_owned()).spawn(move || {
        let begun = Instant::now();
        // Sending a byte from time to time is not silence; the whole head has a time limit.
        while head.write_all(b"X").is_ok() {
            assert!(begun.elapsed() < LONG, "it may go on for ever");
            thread::sleep(Duration::from_millis(20));
        }
    });
    assert_left(silent);
    dripping.unwrap().join().unwrap();
    server.assert_good();
}

#[test]
fn clients_that_read_too_slowly_are_disconnected() {
    // More than network buffers hold.
    let server = Running::new(&[FILE, &vec![7; 64 << 20]].concat());
    let streams: Vec<TcpStream> = (0..4)
        .map(|_| {
            let mut stream = server.connect();
            stream.write_all(b"GET /a.reel HTTP/1.1\r\nHost: x\r\n\r\n").unwrap();
            stream
        })
        .collect();
    let begun = Instant::now();
    while server.server.shared.places.taken() > 0 {
        assert!(begun.elapsed() < LONG, "never-readers hold their places");
        thread::sleep(Duration::from_millis(10));
    }
    assert!(server.server.sent_bytes() < 4 * (64 << 20), "they were sent all");
    drop(streams);
    server.assert_good();
}

#[test]
fn smuggled_requests_are_rejected_and_the_connection_closed() {
    let server = Running::new(FILE);
    let hidden = "GET /a.reel HTTP/1.1\r\nHost: x\r\n\r\n";
    for begin in [
        "GET /a.reel HTTP/1.1\r\nHost: x\r\nContent-Length: 37\r\n\r\n",
        "GET /a.reel HTTP/1.1\r\nHost: x\r\nContent-Length: 0\r\nContent-Length: 37\r\n\r\n",
        "GET /a.reel HTTP/1.1\r\nHost: x\r\nContent-Length: 0\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\n",
        "GET /a.reel HTTP/1.1\r\nHost: x\r\nTransfer-Encoding : chunked\r\n\r\n0\r\n\r\n",
        "GET /a.reel HTTP/1.1\r\nHost: x\r\nX: a\r\n b\r\n\r\n",
        "GET /a.reel HTTP/1.1\nHost: x\n\n",
        "GET /a.reel HTTP/1.1\r\nHost: x\r\nHost: y\r\n\r\n",
        "\0\0\0\0\r\n\r\n",
    ] {
        let answer = server.answer(format!("{begin}{hidden}").as_bytes());
        assert!(
            answer.starts_with("HTTP/1.1 400 ") && answer.contains("Connection: close"),
            "{begin:?}: {answer}"
        );
        assert_eq!(answer.matches("HTTP/1.1").count(), 1, "{begin:?}: {answer}");
        assert!(!answer.contains("0123456789"), "{begin:?}: {answer}");
    }
    let endless = vec![b'x'; 4 * MAX_HEAD_BYTES];
    let answer = server.answer(&[b"GET /".as_slice(), &endless].concat());
    assert!(answer.starts_with("HTTP/1.1 400 "), "{answer}");
}

#[test]
fn pipelined_requests_are_answered_in_order() {
    let server = Running::new(FILE);
    let one = "HEAD /a.reel HTTP/1.1\r\nHost: x\r\n\r\nGET /b HTTP/1.1\r\nHost: x\r\n\r\n";
    let last = "GET /a.reel HTTP/1.1\r\nHost: x\r\nRange: bytes=-1\r\nConnection: close\r\n\r\n";
    let answer = server.answer(format!("{one}{last}{one}").as_bytes());
    let found: Vec<&str> = answer.lines().filter(|line| line.starts_with("HTTP/1.1")).collect();
    let expected = [
        "HTTP/1.1 200 OK",
        "HTTP/1.1 404 Not Found",
        "HTTP/1.1 206 Partial Content",
    ];
    assert_eq!(found, expected, "{answer}");
    assert!(answer.ends_with("\r\n\r\n9"), "{answer}");
}

#[test]
fn floods_resets_and_half_closed_connections_do_not_harm_the_server() {
    let server = Running::new(FILE);
    for round in 0..300_u32 {
        let mut stream = server.connect();
        match round % 4 {
            // Closing with an unread answer causes a reset.
            0 => drop(stream.write_all(b"GET /a.reel HTTP/1.1\r\nHost: x\r\n\r\n")),
            1 => drop(stream.write_all(&round.to_le_bytes().repeat(99))),
            2 => drop(stream.shutdown(Shutdown::Both)),
            _ => {}
        }
    }
    server.assert_good();
    let mut half = server.connect();
    half.write_all(b"GET /a.reel HTTP/1.1\r\nHost: x\r\n\r\n").unwrap();
    half.shutdown(Shutdown::Write).unwrap();
    assert!(rest_of(half).ends_with("0123456789"));
    let begun = Instant::now();
    while server.server.shared.places.taken() > 0 {
        assert!(begun.elapsed() < LONG, "places are held for ever");
        thread::sleep(Duration::from_millis(10));
    }
}

#[test]
fn a_missing_file_is_reported_and_a_truncated_one_closes_the_connection() {
    let server = Running::new(FILE);
    std::fs::remove_file(&server.server.shared.path).unwrap();
    let answer = server.answer(b"GET /a.reel HTTP/1.1\r\nHost: x\r\n\r\n");
    assert!(
        answer.starts_with("HTTP/1.1 503 ") && answer.contains("Connection: close"),
        "{answer}"
    );
}
