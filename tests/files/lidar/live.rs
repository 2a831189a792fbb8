//! Sensors that send to this machine: packets on the loopback, as a live source.

use super::captures::{Files, check};
use super::ouster;
use super::velodyne::{MODELS, Scan};
use pointreel::deadlines::ClientDeadlines;
use pointreel::io::ReadOptions;
use pointreel::progress::Progress;
use pointreel::source::{self, Growth as _, LiveScanner, OpenOptions, Source};
use std::net::UdpSocket;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

/// Sends packets to a port of this machine, one after the other, until it is dropped.
struct Sending {
    port: u16,
    is_over: Arc<AtomicBool>,
    thread: Option<thread::JoinHandle<()>>,
}

impl Sending {
    fn new(packet: impl Fn(usize) -> Vec<u8> + Send + 'static, pause: Duration) -> Self {
        // An unused port.
        let port = UdpSocket::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
        let is_over = Arc::new(AtomicBool::new(false));
        let ends = Arc::clone(&is_over);
        let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
        let send = move || {
            for index in 0.. {
                if ends.load(Ordering::Relaxed) {
                    break;
                }
                // At first there is no listener.
                let _ = socket.send_to(&packet(index), ("127.0.0.1", port));
                thread::sleep(pause);
            }
        };
        let thread = thread::Builder::new().name("sensor".to_owned()).spawn(send);
        Self {
            port,
            is_over,
            thread: Some(thread.unwrap()),
        }
    }

    fn open(&self, companion: &str) -> Result<Arc<dyn Source>, String> {
        let input = PathBuf::from(format!("udp://127.0.0.1:{}{companion}", self.port));
        let opened = source::open(&[input], &OpenOptions::default(), &Progress::default());
        opened.map_err(|error| error.to_string())
    }
}

impl Drop for Sending {
    fn drop(&mut self) {
        self.is_over.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// Twenty packets per revolution, repeatedly.
fn velodyne() -> Sending {
    let packet = |index: usize| {
        let scan = Scan {
            model: &MODELS[0],
            is_dual: false,
            step: 150,
            begin: 0,
        };
        scan.packet(index % 20)
    };
    Sending::new(packet, Duration::from_micros(200))
}

#[test]
fn sensor_scans_arrive_as_frames_and_old_ones_expire() {
    let sending = velodyne();
    let source = sending.open("").unwrap();
    assert!(source.is_live() && source.may_grow());
    let first = source.frames();
    assert_eq!(first.start, 0);
    while source.frames().end < 60 {
        assert!(
            source.wait_for_more(Duration::from_secs(5)).unwrap() > 0,
            "nothing more comes"
        );
    }
    let frames = source.frames();
    assert!(frames.start > 0 && frames.len() <= 48, "{frames:?}");
    let index = frames.end - 1;
    let entry = source.entry(index);
    assert_eq!(entry.number, Some(index as u64));
    assert!(entry.time.unwrap() > Duration::from_secs(1_700_000_000));
    assert_eq!(source.entry(0).time, None);
    let progress = Progress::default();
    let mut decoder = source.decoder();
    let decoded = decoder.decode(index, &entry, usize::MAX, &progress).unwrap();
    let scan = Scan {
        model: &MODELS[0],
        is_dual: false,
        step: 150,
        begin: 0,
    };
    check(&decoded.cloud, &scan.points(0..240), 2e-5);
    let gone = decoder.decode(0, &source.entry(0), usize::MAX, &progress).unwrap_err();
    assert!(gone.to_string().contains("turn 0 is gone for good"), "{gone}");
}

#[test]
fn an_ouster_sensor_needs_the_metadata_file_after_the_address() {
    // A single loopback datagram holds it.
    let sensor = ouster::SMALL;
    let packet = move |index: usize| sensor.packet((index / 32) as u16, index % 32);
    let sending = Sending::new(packet, Duration::from_micros(500));
    let error = sending.open("").err().unwrap();
    assert!(
        error.contains("6400 bytes") && error.contains("udp://:7502?os1.json"),
        "{error}"
    );
    let files = Files::new();
    let path = files.write("os1.json", sensor.sections().to_string().as_bytes());
    let source = sending.open(&format!("?{}", path.display())).unwrap();
    let decoded = source
        .decoder()
        .decode(0, &source.entry(0), usize::MAX, &Progress::default())
        .unwrap();
    // The number of the frame depends on when listening started; most of it arrives.
    assert!(decoded.cloud.positions.len() > 10_000);
    let error = sending.open("?missing.json").err().unwrap();
    assert!(error.contains("missing.json cannot be read"), "{error}");
}

#[test]
fn silence_and_other_inputs_are_explained() {
    let open = |inputs: &[&str]| {
        let inputs: Vec<PathBuf> = inputs.iter().map(PathBuf::from).collect();
        let opened = source::open(&inputs, &OpenOptions::default(), &Progress::default());
        opened.err().unwrap().to_string()
    };
    let error = open(&["udp://127.0.0.1:0"]);
    assert!(
        error.contains("no turn of a laser scanner came within 5 seconds"),
        "{error}"
    );
    let error = open(&["udp://:2368", "drive.pcap"]);
    assert!(error.contains("without other inputs"), "{error}");
    let error = open(&["udp://sensor"]);
    assert!(error.contains("is no address to listen at"), "{error}");
    let progress = Progress::default();
    progress.cancel();
    let inputs = [PathBuf::from("udp://127.0.0.1:0")];
    let cancelled = source::open(&inputs, &OpenOptions::default(), &progress);
    assert!(matches!(cancelled, Err(source::SequenceError::Cancelled)));
}

/// A packet of a VLP-16, one of 20 per revolution.
fn packet(index: usize) -> Vec<u8> {
    let scan = Scan {
        model: &MODELS[0],
        is_dual: false,
        step: 150,
        begin: 0,
    };
    scan.packet(index % 20)
}

/// A sensor that sends to a port of this machine until it is dropped.
fn sensor(port: u16, is_over: &Arc<AtomicBool>) -> thread::JoinHandle<()> {
    let ends = Arc::clone(is_over);
    let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
    let send = move || {
        for index in 0.. {
            if ends.load(Ordering::Relaxed) {
                break;
            }
            let _ = socket.send_to(&packet(index), ("127.0.0.1", port));
            thread::sleep(Duration::from_micros(500));
        }
    };
    thread::Builder::new().name("sensor".to_owned()).spawn(send).unwrap()
}

fn free_port() -> u16 {
    UdpSocket::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port()
}

fn opened(port: u16) -> Result<LiveScanner, String> {
    let deadlines = ClientDeadlines {
        sensor_silence: Duration::from_millis(300),
        ..ClientDeadlines::default()
    };
    let input = PathBuf::from(format!("udp://127.0.0.1:{port}"));
    let opened = LiveScanner::open_within(&input, &ReadOptions::default(), &Progress::default(), deadlines);
    opened.map_err(|error| error.to_string())
}

fn wait_for_more(scanner: &LiveScanner) {
    let begun = Instant::now();
    let before = scanner.frames().end;
    while scanner.frames().end < before + 5 {
        scanner.wait_for_more(Duration::from_millis(50)).unwrap();
        assert!(begun.elapsed() < Duration::from_mins(1), "nothing more comes");
    }
}

#[test]
fn a_stray_packet_takes_no_slot_and_a_restarted_sensor_is_accepted() {
    let port = free_port();
    let (is_over, first_is_over) = (Arc::new(AtomicBool::new(false)), Arc::new(AtomicBool::new(false)));
    let ends = Arc::clone(&is_over);
    // Single packets in the format of a sensor from each of many ports, and packets of all other kinds.
    let outlying = thread::Builder::new().name("straying".to_owned()).spawn(move || {
        let ouster = vec![0; 6464];
        while !ends.load(Ordering::Relaxed) {
            let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
            for bytes in [&packet(0)[..], &ouster, b"\x55\xaa\x05\x5a", &[0xff; 1206], b""] {
                let _ = socket.send_to(bytes, ("127.0.0.1", port));
            }
            thread::sleep(Duration::from_millis(1));
        }
    });
    let first = sensor(port, &first_is_over);
    let scanner = opened(port).unwrap();
    wait_for_more(&scanner);
    first_is_over.store(true, Ordering::Relaxed);
    first.join().unwrap();
    // The same from another port.
    let second = sensor(port, &is_over);
    wait_for_more(&scanner);
    is_over.store(true, Ordering::Relaxed);
    second.join().unwrap();
    outlying.unwrap().join().unwrap();
}

#[test]
fn unknown_packets_are_reported_where_no_sensor_sends() {
    let port = free_port();
    let is_over = Arc::new(AtomicBool::new(false));
    let ends = Arc::clone(&is_over);
    let outlying = thread::Builder::new().name("straying".to_owned()).spawn(move || {
        let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
        while !ends.load(Ordering::Relaxed) {
            let _ = socket.send_to(&[7; 33], ("127.0.0.1", port));
            thread::sleep(Duration::from_millis(1));
        }
    });
    let error = opened(port).err().unwrap();
    is_over.store(true, Ordering::Relaxed);
    outlying.unwrap().join().unwrap();
    assert!(error.contains("the last of 33 bytes from 127.0.0.1"), "{error}");
}
