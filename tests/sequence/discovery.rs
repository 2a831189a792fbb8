//! Names → ordered sources.

use super::*;
use std::fs;

/// A folder with empty files of these names.
fn folder(names: &[&str]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for name in names {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, "").unwrap();
    }
    folder
}

fn names(sequence: &Sequence) -> Vec<String> {
    sequence.entries().iter().map(|source| source.name.clone()).collect()
}

fn found_in(files: &[&str]) -> Vec<String> {
    let folder = folder(files);
    let sequence = Sequence::discover(&[folder.path().to_path_buf()]).unwrap();
    names(&sequence)
}

#[test]
fn unpadded_numbers_with_gaps_and_any_start_are_sorted() {
    assert_eq!(
        found_in(&["f12.ply", "f7.ply", "f100.ply", "f9.ply"]),
        ["f7.ply", "f9.ply", "f12.ply", "f100.ply"]
    );
}

#[test]
fn digits_elsewhere_and_dates_are_sorted_correctly() {
    assert_eq!(
        found_in(&["vox10_9_s3d.ply", "vox10_10_s3d.ply", "vox10_1051_s3d.ply"]),
        ["vox10_9_s3d.ply", "vox10_10_s3d.ply", "vox10_1051_s3d.ply"]
    );
    assert_eq!(
        found_in(&["t_03-10.ply", "t_03-05.xyz", "t_03-08.ply", "t_03-06.xyz"]),
        ["t_03-05.xyz", "t_03-06.xyz", "t_03-08.ply", "t_03-10.ply"]
    );
    let stamps = [
        "frame_20121214T142255.814212.pcd",
        "frame_20121214T142256.068683.pcd",
        "frame_20121214T142256.332395.pcd",
    ];
    assert_eq!(found_in(&[stamps[2], stamps[0], stamps[1]]), stamps);
}

#[test]
fn only_visible_point_clouds_are_taken_from_a_folder() {
    assert_eq!(
        found_in(&[
            "b.PLY",
            "a.Pcd",
            ".hidden.ply",
            "LICENSE",
            "notes.md",
            "deeper/c.ply",
            "folder.ply/x.txt.gz"
        ]),
        ["a.Pcd", "b.PLY"]
    );
}

#[test]
fn one_file_is_one_frame_whatever_its_name() {
    let folder = folder(&["f1.ply", "f2.ply", "data.bin", ".hidden"]);
    for name in ["f1.ply", "data.bin", ".hidden"] {
        let sequence = Sequence::discover(&[folder.path().join(name)]).unwrap();
        assert_eq!(names(&sequence), [name]);
    }
}

#[test]
fn a_list_expanded_by_a_shell_is_sorted() {
    let folder = folder(&["f1.ply", "f2.ply", "f10.ply"]);
    let list = ["f1.ply", "f10.ply", "f2.ply"].map(|name| folder.path().join(name));
    let sequence = Sequence::discover(&list).unwrap();
    assert_eq!(names(&sequence), ["f1.ply", "f2.ply", "f10.ply"]);
    let numbers: Vec<_> = sequence.entries().iter().map(|s| s.number).collect();
    assert_eq!(numbers, [Some(1), Some(2), Some(10)]);
}

#[test]
fn patterns_match_the_intended_files() {
    let folder = folder(&["a1.ply", "a10.ply", "a2.pcd", "a3.md", "b1.bin", ".a4.ply"]);
    let discover = |pattern: &str| {
        Sequence::discover(&[folder.path().join(pattern)])
            .map(|sequence| names(&sequence).iter().map(ToString::to_string).collect::<Vec<_>>())
    };
    assert_eq!(discover("a*").unwrap(), ["a1.ply", "a2.pcd", "a10.ply"]);
    assert_eq!(discover("a?.p*").unwrap(), ["a1.ply", "a2.pcd"]);
    assert_eq!(discover("*.bin").unwrap(), ["b1.bin"]);
    assert!(matches!(discover("c*.ply"), Err(SequenceError::NoMatch { .. })));
    assert!(matches!(discover("a[.ply"), Err(SequenceError::BadPattern { .. })));
}

#[test]
fn a_file_whose_name_looks_like_a_pattern_is_a_file() {
    let folder = folder(&["a[1].ply", "a1.ply"]);
    let sequence = Sequence::discover(&[folder.path().join("a[1].ply")]).unwrap();
    assert_eq!(names(&sequence), ["a[1].ply"]);
}

#[test]
fn mixed_inputs_retain_their_order_without_duplicates() {
    let folder = folder(&["one/f2.ply", "one/f1.ply", "two/g1.ply", "still.xyz"]);
    let inputs = ["two", "still.xyz", "one", "one/f1.ply", "two/*.ply"].map(|name| folder.path().join(name));
    let sequence = Sequence::discover(&inputs).unwrap();
    assert_eq!(names(&sequence), ["g1.ply", "still.xyz", "f1.ply", "f2.ply"]);
}

#[test]
fn errors_are_one_sentence() {
    let folder = folder(&["takes/one/y.ply", "takes/two/x.ply", "empty/readme.md"]);
    let error = |path: &Path| {
        Sequence::discover(&[path.to_path_buf()])
            .expect_err("nothing to open")
            .to_string()
    };
    let missing = error(&folder.path().join("gone.ply"));
    assert!(missing.contains("gone.ply does not exist"), "{missing}");
    let parent = error(&folder.path().join("takes"));
    assert!(parent.contains("takes holds 2 sequences"), "{parent}");
    let empty = error(&folder.path().join("empty"));
    assert!(empty.contains("*.ply") && empty.contains("*.pcd"), "{empty}");
    assert!(matches!(Sequence::discover(&[]), Err(SequenceError::NoInput)));
    for message in [missing, empty] {
        assert!(!message.contains('\n'));
    }
}

#[cfg(unix)]
#[test]
fn links_are_followed() {
    let folder = folder(&["real/f1.ply", "linked/f2.ply"]);
    let link = folder.path().join("linked/f3.ply");
    std::os::unix::fs::symlink(folder.path().join("real/f1.ply"), link).unwrap();
    std::os::unix::fs::symlink(folder.path().join("real"), folder.path().join("linked/d.ply")).unwrap();
    let sequence = Sequence::discover(&[folder.path().join("linked")]).unwrap();
    assert_eq!(names(&sequence), ["f2.ply", "f3.ply"]);
}

#[test]
fn a_hundred_thousand_names_are_sorted_without_opening_them() {
    // Files that do not exist: opening any of them would fail.
    let paths: Vec<PathBuf> = (0..100_000u64)
        .map(|i| format!("scan_{}.ply", i.wrapping_mul(7_919) % 100_003).into())
        .collect();
    let mut sorted = paths;
    let start = Instant::now();
    sorted.sort_by(|left, right| pointreel::sequence::natural_order(left, right));
    assert!(sorted.is_sorted_by_key(|path| {
        let name = path.to_string_lossy();
        name["scan_".len()..name.len() - ".ply".len()].parse::<u64>().unwrap()
    }));
    // O(n²) comparisons would take minutes.
    assert!(start.elapsed() < PATIENCE);
}

#[test]
fn new_frames_are_found_and_do_not_shift_others() {
    let folder = folder(&["f1.ply", "f3.ply"]);
    let sequence = Sequence::discover(&[folder.path().to_path_buf()]).unwrap();
    assert!(sequence.source().may_grow());
    assert_eq!(sequence.source().look_again().unwrap(), 0);
    fs::write(folder.path().join("f2.ply"), "").unwrap();
    fs::write(folder.path().join("f4.ply"), "").unwrap();
    fs::write(folder.path().join("f10.ply"), "").unwrap();
    // They may still be being written.
    assert_eq!(sequence.source().look_again().unwrap(), 0);
    std::thread::sleep(Duration::from_millis(600));
    assert_eq!(sequence.source().look_again().unwrap(), 2);
    assert_eq!(names(&sequence), ["f1.ply", "f3.ply", "f4.ply", "f10.ply"]);
    assert_eq!(sequence.source().look_again().unwrap(), 0);
    let one = Sequence::discover(&[folder.path().join("f1.ply")]).unwrap();
    assert!(!one.source().may_grow());
}

#[test]
fn times_in_names_determine_frame_durations() {
    let names = [
        "frame_20121214T142255.814212.pcd",
        "frame_20121214T142256.068683.pcd",
        "frame_20121214T142256.332395.pcd",
    ];
    let folder = folder(&names);
    let open = |fps: Option<f64>| {
        let options = OpenOptions {
            fps,
            ..OpenOptions::default()
        };
        Sequence::open(&[folder.path().to_path_buf()], &options).unwrap()
    };
    let stamped = open(None);
    assert!(!stamped.pace().is_even());
    assert!((stamped.fps() - 1.0 / 0.263_712).abs() < 0.01, "{}", stamped.fps());
    let chosen = open(Some(10.0));
    assert!(chosen.pace().is_even());
    assert_eq!(chosen.fps(), 10.0);
}

#[test]
fn kitti_times_are_read_from_next_to_its_scans() {
    let folder = tempfile::tempdir().unwrap();
    let scans = |part: &str, names: &[&str]| {
        let scans = folder.path().join(part);
        fs::create_dir_all(&scans).unwrap();
        for name in names {
            fs::write(scans.join(name), "").unwrap();
        }
        scans
    };
    let times = |input: &Path| -> Option<Vec<f64>> {
        let sequence = Sequence::discover(&[input.to_path_buf()]).unwrap();
        let sources = sequence.entries();
        sources.iter().map(|source| Some(source.time?.as_secs_f64())).collect()
    };
    let odometry = scans("00/velodyne", &["000000.bin", "000001.bin", "000002.bin"]);
    assert_eq!(times(&odometry), None, "no list");
    let list = folder.path().join("00/times.txt");
    fs::write(&list, "0.000000e+00\n1.000000e-01\n3.000000e-01\n").unwrap();
    assert_eq!(times(&odometry), Some(vec![0.0, 0.1, 0.3]));
    // Some of the scans, with the lines of their numbers.
    assert_eq!(times(&odometry.join("*[12].bin")), Some(vec![0.1, 0.3]));
    fs::write(&list, "0.0\n0.1\n").unwrap();
    assert_eq!(times(&odometry), None, "a line is missing");
    fs::write(&list, "0.0\n0.1\nlast\n").unwrap();
    assert_eq!(times(&odometry), None, "a line is no time");

    // The second scan is missing, as in some raw recordings.
    let raw = scans("velodyne_points/data", &["0000000000.bin", "0000000002.bin"]);
    let list = folder.path().join("velodyne_points/timestamps.txt");
    let day = "2011-09-26 13:02:25";
    fs::write(&list, format!("{day}.25\n{day}.35\n{day}.45\n")).unwrap();
    let first = 1_317_042_145.25;
    assert_eq!(times(&raw), Some(vec![first, first + 0.2]));

    // Numbers starting at 1: one line for each, in order.
    let odd = scans("odd/velodyne", &["1.bin", "2.bin"]);
    fs::write(folder.path().join("odd/times.txt"), "5\n6").unwrap();
    assert_eq!(times(&odd), Some(vec![5.0, 6.0]));
    // Clouds of other formats have times if they are in a folder for frames.
    let other = scans("odd/clouds", &["0.ply", "1.ply"]);
    assert_eq!(times(&other), Some(vec![5.0, 6.0]));
    let other = scans("odd/takes", &["0.ply", "1.ply"]);
    assert_eq!(times(&other), None);
}

/// A PLY of two points whose properties are these.
fn ply_of(properties: &[&str]) -> String {
    let lines = properties.iter().map(|name| format!("property float {name}\n"));
    let rows = [0, 1].map(|row| vec![row.to_string(); properties.len()].join(" "));
    format!(
        "ply\nformat ascii 1.0\nelement vertex 2\n{}end_header\n{}\n",
        lines.collect::<String>(),
        rows.join("\n")
    )
}

#[test]
fn points_and_normals_side_by_side_are_one_sequence() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, properties: &[&str]| {
        fs::write(folder.path().join(name), ply_of(properties)).unwrap();
    };
    for frame in 0..12 {
        write(&format!("{frame}.ply"), &["x", "y", "z"]);
        write(&format!("{frame}_normal.ply"), &["nx", "ny", "nz"]);
        write(&format!("{frame}_mask.ply"), &["label"]);
    }
    for inputs in [folder.path().to_path_buf(), folder.path().join("*.ply")] {
        let sequence = Sequence::discover(&[inputs]).unwrap();
        assert_eq!(sequence.len(), 12);
        for (index, source) in sequence.entries().iter().enumerate() {
            assert_eq!(source.name, format!("{index}.ply"));
            assert_eq!(source.number, Some(index as u64));
            let normals = folder.path().join(format!("{index}_normal.ply"));
            assert_eq!(source.normals, Some(normals));
            let frame = sequence.frame(index).unwrap();
            assert_eq!(frame.len(), 2);
            // The first normal is zero, the second one consists of three ones.
            let third = 1.0 / 3.0_f32.sqrt();
            assert!((frame.normals().unwrap()[1].x - third).abs() < 1e-6);
            assert!(frame.warnings().is_empty());
        }
        let [note] = sequence.source().notes() else {
            panic!("{:?}", sequence.source().notes())
        };
        assert_eq!(
            note,
            "12 files next to the frames hold no points (0_mask.ply, 1_mask.ply, 2_mask.ply, …): they are skipped"
        );
    }
    // As a shell expands *.ply: explicitly named files are used, normals go to their frames.
    let files = ["0.ply", "0_normal.ply", "0_mask.ply"].map(|name| folder.path().join(name));
    let sequence = Sequence::discover(&files).unwrap();
    assert_eq!(names(&sequence), ["0.ply", "0_mask.ply"]);
}

#[test]
fn normals_that_arrive_later_are_waited_for_and_joined() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, properties: &[&str]| {
        fs::write(folder.path().join(name), ply_of(properties)).unwrap();
    };
    let has_normals = |sequence: &Sequence| -> Vec<bool> {
        let sources = sequence.entries();
        sources.iter().map(|source| source.normals.is_some()).collect()
    };
    write("1.ply", &["x", "y", "z"]);
    let sequence = Sequence::discover(&[folder.path().to_path_buf()]).unwrap();
    assert_eq!(has_normals(&sequence), [false]);
    write("1_normal.ply", &["nx", "ny", "nz"]);
    write("2.ply", &["x", "y", "z"]);
    std::thread::sleep(Duration::from_millis(600));
    // By now the first frame has normals, so the second one waits for its own.
    assert_eq!(sequence.source().look_again().unwrap(), 0);
    assert_eq!(has_normals(&sequence), [true]);
    assert!(sequence.frame(0).unwrap().normals().is_some());
    write("2_normal.ply", &["nx", "ny", "nz"]);
    // Normals that precede their points are not a frame.
    write("3_normal.ply", &["nx", "ny", "nz"]);
    std::thread::sleep(Duration::from_millis(600));
    assert_eq!(sequence.source().look_again().unwrap(), 1);
    assert_eq!(has_normals(&sequence), [true, true]);
    assert_eq!(sequence.source().look_again().unwrap(), 0);
}
