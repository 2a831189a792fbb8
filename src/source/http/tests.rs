//! Servers that never answer, drip, lie and break, over the loopback. Deadlines are short.

use super::HttpFile;
use crate::deadlines::{ClientDeadlines, MinRate};
use crate::reel::ReadAt as _;
use std::io::{Read as _, Write as _};
use std::net::{TcpListener, TcpStream};
use std::thread;
use std::time::{Duration, Instant};

/// Behaviour of a server on a connection.
type AnswerOf = fn(&mut TcpStream);

const LONG: Duration = Duration::from_secs(30);

fn deadlines() -> ClientDeadlines {
    ClientDeadlines {
        silence: Duration::from_millis(200),
        transfer: MinRate {
            grace: Duration::from_millis(500),
            bytes_per_s: 1e5,
        },
        ..ClientDeadlines::default()
    }
}

/// Answers each request as `answer` does, which is given the stream, the requested range and the number of the request;
/// returns its address.
fn hostile(answer: impl Fn(&mut TcpStream, &str, usize) + Send + Sync + 'static) -> String {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let url = format!("http://{}/a.reel", listener.local_addr().unwrap());
    let serving = move || {
        for (number, stream) in listener.incoming().enumerate() {
            let mut stream = stream.unwrap();
            let mut request = Vec::new();
            while !request.ends_with(b"\r\n\r\n") {
                let mut byte = [0];
                if stream.read(&mut byte).unwrap_or(0) == 0 {
                    break;
                }
                request.push(byte[0]);
            }
            let request = String::from_utf8_lossy(&request).to_lowercase();
            let range = request
                .split("range: bytes=")
                .nth(1)
                .and_then(|rest| rest.lines().next());
            answer(&mut stream, range.unwrap_or_default(), number);
        }
    };
    thread::Builder::new()
        .name("hostile".to_owned())
        .spawn(serving)
        .unwrap();
    url
}

/// Sends `bytes` and then nothing, for as long as the client is there.
fn say_and_wait(stream: &mut TcpStream, bytes: &[u8]) {
    let _ = stream.write_all(bytes);
    let _ = stream.set_read_timeout(Some(LONG));
    while let Ok(1..) = stream.read(&mut [0; 64]) {}
}

/// A byte now and then, for as long as the client is there.
fn drip(stream: &mut TcpStream) {
    while stream.write_all(b"x").is_ok() {
        thread::sleep(Duration::from_millis(10));
    }
}

/// The requested part of a file of `whole` bytes, with its head.
fn head(range: &str, whole: u64) -> String {
    let (first, last) = range.split_once('-').unwrap();
    let count = last.parse::<u64>().unwrap() - first.parse::<u64>().unwrap() + 1;
    format!("HTTP/1.1 206 Partial Content\r\nContent-Length: {count}\r\nContent-Range: bytes {range}/{whole}\r\n\r\n")
}

fn refused(url: &str) -> String {
    let begun = Instant::now();
    let error = HttpFile::open(url, None, deadlines()).unwrap_err().to_string();
    assert!(begun.elapsed() < LONG, "{error}");
    error
}

#[test]
fn servers_that_never_finish_a_response_are_abandoned_with_an_error() {
    let silent = |stream: &mut TcpStream| say_and_wait(stream, b"");
    let begins = |stream: &mut TcpStream| say_and_wait(stream, b"HTTP/1.1 206 Par");
    let fields = |stream: &mut TcpStream| {
        let _ = stream.write_all(b"HTTP/1.1 206 Partial Content\r\nX: ");
        drip(stream);
    };
    let interim = |stream: &mut TcpStream| while stream.write_all(b"HTTP/1.1 100 Continue\r\n\r\n").is_ok() {};
    let redirected = |stream: &mut TcpStream| {
        let _ = stream.write_all(b"HTTP/1.1 302 Found\r\nLocation: /b\r\nContent-Length: 100000000\r\n\r\n");
        drip(stream);
    };
    let closes = |_: &mut TcpStream| ();
    let answers: [(AnswerOf, &str); 6] = [
        (silent, "seconds for the size of the file"),
        (begins, "seconds for the size of the file"),
        (fields, "seconds for the size of the file"),
        (interim, ""),
        (redirected, "seconds for the size of the file"),
        (closes, "seconds for the size of the file"),
    ];
    thread::scope(|scope| {
        for (answer, expected) in answers {
            scope.spawn(move || {
                let error = refused(&hostile(move |stream, _, _| answer(stream)));
                assert!(error.contains(expected), "{error}");
            });
        }
    });
}

#[test]
fn invalid_responses_are_distinguished() {
    let range =
        |range: &str| format!("HTTP/1.1 206 Partial Content\r\nContent-Length: 1\r\nContent-Range: {range}\r\n\r\nx");
    let cases = [
        (
            "HTTP/1.1 200 OK\r\nContent-Length: 10\r\n\r\n0123456789".to_owned(),
            "sends files whole",
        ),
        (
            "HTTP/1.1 302 Found\r\nLocation: /a.reel\r\nContent-Length: 0\r\n\r\n".to_owned(),
            "more than 5 times",
        ),
        ("HTTP/1.1 403 Forbidden\r\nContent-Length: 0\r\n\r\n".to_owned(), "403"),
        (
            "HTTP/1.1 416 Range Not Satisfiable\r\nContent-Length: 0\r\n\r\n".to_owned(),
            "is empty",
        ),
        (
            "HTTP/1.1 206 Partial Content\r\nContent-Length: 1\r\n\r\nx".to_owned(),
            "how long the file is",
        ),
        (range("bytes 0-0/*"), "how long the file is"),
        (range("bytes 0-0/0"), "how long the file is"),
        (range("bytes 7-7/100"), "another part"),
        (range("bytes 0-50/100"), "another part"),
        ("SSH-2.0-OpenSSH_9.6\r\n".to_owned(), ""),
    ];
    for (answer, expected) in cases {
        let error = refused(&hostile(move |stream, _, _| drop(stream.write_all(answer.as_bytes()))));
        assert!(error.contains(expected), "{error}");
    }
}

/// A file of known size, whose bytes come as `answer` sends them.
fn opened(answer: impl Fn(&mut TcpStream, &str, usize) + Send + Sync + 'static) -> HttpFile {
    let url = hostile(move |stream, range, number| match range {
        "0-0" => {
            let close = head(range, 100_000).replace("\r\n\r\n", "\r\nConnection: close\r\n\r\nx");
            let _ = stream.write_all(close.as_bytes());
        }
        _ => answer(stream, range, number),
    });
    HttpFile::open(&url, None, deadlines()).unwrap()
}

fn read(file: &HttpFile) -> Result<Vec<u8>, String> {
    let begun = Instant::now();
    let mut bytes = vec![0; 90_000];
    let read = file.read_at(5, &mut bytes).map_err(|error| error.to_string());
    assert!(begun.elapsed() < LONG, "{read:?}");
    read.map(|()| bytes)
}

#[test]
fn missing_bytes_are_an_error_however_they_fail_to_arrive() {
    let silent = |stream: &mut TcpStream, range: &str| say_and_wait(stream, head(range, 100_000).as_bytes());
    let dripping = |stream: &mut TcpStream, range: &str| {
        let _ = stream.write_all(head(range, 100_000).as_bytes());
        drip(stream);
    };
    // Each connection delivers one byte: that is progress, but too little.
    let one_each = |stream: &mut TcpStream, range: &str| {
        let _ = stream.write_all(format!("{}x", head(range, 100_000)).as_bytes());
        thread::sleep(Duration::from_millis(5));
    };
    let nothing = |_: &mut TcpStream, _: &str| ();
    let answers: [fn(&mut TcpStream, &str); 4] = [silent, dripping, one_each, nothing];
    thread::scope(|scope| {
        for answer in answers {
            scope.spawn(move || {
                let error = read(&opened(move |stream, range, _| answer(stream, range))).unwrap_err();
                assert!(error.contains("seconds for bytes 5 to 90005: "), "{error}");
            });
        }
    });
}

#[test]
fn a_changed_file_is_detected_and_a_broken_connection_is_resumed() {
    let other = opened(|stream, range, _| drop(stream.write_all(head(range, 99_999).as_bytes())));
    assert!(read(&other).unwrap_err().contains("has changed"));
    let moved = opened(|stream, _, _| {
        let _ = stream.write_all(b"HTTP/1.1 302 Found\r\nLocation: /b\r\nContent-Length: 0\r\n\r\n");
    });
    assert!(read(&moved).unwrap_err().contains("another address"));
    // A third of the rest, and then the end.
    let breaking = opened(|stream, range, _| {
        let (first, last) = range.split_once('-').unwrap();
        let (first, last): (u64, u64) = (first.parse().unwrap(), last.parse().unwrap());
        let bytes: Vec<u8> = (first..=first + (last - first) / 3).map(|at| at as u8).collect();
        let _ = stream.write_all(head(range, 100_000).as_bytes());
        let _ = stream.write_all(&bytes);
    });
    let expected: Vec<u8> = (5..90_005_u64).map(|at| at as u8).collect();
    assert_eq!(read(&breaking), Ok(expected));
}
