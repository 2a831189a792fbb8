//! Folders that a scanner writes into. Looks are taken by hand, so that no test waits for a clock.

use super::*;
use std::fs::{self, File};
use std::io::Write as _;

/// A PLY of `count` points.
fn ply(count: usize) -> Vec<u8> {
    let rows = (0..count)
        .map(|index| format!("{index} 0 0\n"))
        .collect::<Vec<_>>()
        .concat();
    let properties = "property float x\nproperty float y\nproperty float z\n";
    format!("ply\nformat ascii 1.0\nelement vertex {count}\n{properties}end_header\n{rows}").into_bytes()
}

fn pcd(count: usize) -> Vec<u8> {
    let rows = (0..count)
        .map(|index| format!("{index} 0 0\n"))
        .collect::<Vec<_>>()
        .concat();
    format!(
        "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH {count}\nHEIGHT 1\n\
         POINTS {count}\nDATA ascii\n{rows}"
    )
    .into_bytes()
}

fn look(sequence: &Sequence) -> usize {
    sequence.source().look_again().unwrap()
}

#[test]
fn a_file_that_was_read_too_early_is_read_again() {
    let las = data::shared("meaning/sparse_aerial.las").map(|path| fs::read(path).unwrap());
    let formats = [("ply", ply(900)), ("pcd", pcd(900))];
    for (extension, bytes) in formats.into_iter().chain(las.map(|bytes| ("las", bytes))) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(format!("f1.{extension}"));
        fs::write(&path, &bytes[..bytes.len() / 2]).unwrap();
        let sequence = Arc::new(Sequence::discover(&[folder.path().to_path_buf()]).unwrap());
        let mut player =
            pointreel::playback::Player::new(Arc::clone(&sequence), LoaderOptions::default(), false).unwrap();
        let style = pointreel::scene::Style::default();
        let update = |player: &mut pointreel::playback::Player| player.update(Duration::ZERO, &style);
        let start = Instant::now();
        while player.failure().is_none() {
            update(&mut player);
            assert!(start.elapsed() < PATIENCE, "{extension}: half of a file is a frame");
            std::thread::sleep(Duration::from_millis(2));
        }
        fs::write(&path, &bytes).unwrap();
        assert_eq!(look(&sequence), 0);
        assert_eq!(
            sequence.source().changed_since(0),
            [0; 0],
            "it may still be being written"
        );
        look(&sequence);
        assert_eq!(sequence.source().changed_since(0), [0]);
        let start = Instant::now();
        while player.shown().is_none() {
            update(&mut player);
            assert!(start.elapsed() < PATIENCE, "{extension}: it stays red");
            std::thread::sleep(Duration::from_millis(2));
        }
        assert!(player.failure().is_none());
        assert!(player.shown().unwrap().frame.points_in_file() >= 900);
    }
}

#[test]
fn no_frame_of_a_slow_writer_is_lost() {
    let folder = tempfile::tempdir().unwrap();
    let path = |number: usize| folder.path().join(format!("f{number}.ply"));
    fs::write(path(0), ply(10)).unwrap();
    let sequence = Sequence::discover(&[folder.path().to_path_buf()]).unwrap();
    for number in 1..5 {
        let bytes = ply(10 + number);
        let mut file = File::create(path(number)).unwrap();
        for piece in bytes.chunks(bytes.len() / 3 + 1) {
            file.write_all(piece).unwrap();
            file.flush().unwrap();
            assert_eq!(look(&sequence), 0, "it grows from look to look");
        }
        drop(file);
        assert_eq!(look(&sequence), 1);
    }
    let points = |index| sequence.frame(index).unwrap().len();
    assert_eq!((0..5).map(points).collect::<Vec<_>>(), [10, 11, 12, 13, 14]);
}

#[test]
fn files_renamed_when_complete_are_found() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    fs::write(path("f0.ply"), ply(10)).unwrap();
    let sequence = Sequence::discover(&[folder.path().to_path_buf()]).unwrap();
    for (number, temporary) in [(1, "f1.ply.part"), (2, ".f2.ply"), (3, "f3.ply.tmp"), (4, "f4.tmp.ply")] {
        fs::write(path(temporary), &ply(10 + number)[..90]).unwrap();
        look(&sequence);
        fs::write(path(temporary), ply(10 + number)).unwrap();
        fs::rename(path(temporary), path(&format!("f{number}.ply"))).unwrap();
        look(&sequence);
        look(&sequence);
        assert_eq!(sequence.len(), 1 + number, "{temporary}");
        assert_eq!(sequence.frame(number).unwrap().len(), 10 + number, "{temporary}");
    }
}

#[test]
fn a_missing_number_is_waited_for() {
    let folder = tempfile::tempdir().unwrap();
    let write = |number: usize| fs::write(folder.path().join(format!("f{number}.ply")), ply(5)).unwrap();
    (0..4).for_each(write);
    let sequence = Sequence::discover(&[folder.path().to_path_buf()]).unwrap();
    write(5);
    assert_eq!(
        [look(&sequence), look(&sequence)],
        [0, 0],
        "the frame before it is late"
    );
    write(4);
    look(&sequence);
    assert_eq!(look(&sequence), 2);
}

#[test]
fn an_empty_folder_is_waited_for_if_it_is_followed() {
    let folder = tempfile::tempdir().unwrap();
    let inputs = [folder.path().to_path_buf()];
    assert!(matches!(
        Sequence::discover(&inputs),
        Err(SequenceError::EmptyFolder { .. })
    ));
    let options = OpenOptions {
        waits_for_first: true,
        ..OpenOptions::default()
    };
    let opening = std::thread::Builder::new().name("opening".to_owned());
    let opened = opening.spawn(move || Sequence::open(&inputs, &options).map(|sequence| sequence.len()));
    fs::write(folder.path().join("f0.ply"), ply(3)).unwrap();
    assert_eq!(opened.unwrap().join().unwrap().unwrap(), 1);
}
