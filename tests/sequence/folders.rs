//! Folders whose files are not all frames, and data sets that have their frames somewhere below.

use super::*;
use pointreel::assumption::{Assumption, Evidence, Subject};
use pointreel::cloud::ColorDepth;
use std::fmt::Write as _;
use std::fs;

/// Text of a PLY with one point at `x`.
fn ply(x: f64) -> String {
    format!(
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty double x\nproperty double y\nproperty double z\n\
         end_header\n{x} 0 0\n"
    )
}

/// A folder with these files: a cloud of one point, whose x is the number of the file in the list, or the text.
fn folder_of(files: &[(&str, &str)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (number, (name, text)) in files.iter().enumerate() {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        let content = match *text {
            "" if extension_of(name) == "pcd" => format!(
                "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 1\nHEIGHT 1\n\
                 POINTS 1\nDATA ascii\n{number} 0 0\n"
            )
            .into_bytes(),
            "" if extension_of(name) == "bin" => [number as f32, 0.0, 0.0, 0.5, 1.0, 2.0, 3.0, 0.5]
                .iter()
                .flat_map(|value| value.to_le_bytes())
                .collect(),
            "" if extension_of(name) == "txt" => format!("{number} 0 0\n").into_bytes(),
            "" => ply(number as f64).into_bytes(),
            text => text.as_bytes().to_vec(),
        };
        fs::write(path, content).unwrap();
    }
    folder
}

fn extension_of(name: &str) -> &str {
    name.rsplit_once('.').map_or("", |(_, extension)| extension)
}

fn clouds<'a>(names: &[&'a str]) -> Vec<(&'a str, &'static str)> {
    names.iter().map(|name| (*name, "")).collect()
}

fn names(sequence: &Sequence) -> Vec<String> {
    sequence.entries().iter().map(|entry| entry.name.clone()).collect()
}

fn times(sequence: &Sequence) -> Option<Vec<f64>> {
    let entries = sequence.entries();
    entries.iter().map(|entry| Some(entry.time?.as_secs_f64())).collect()
}

fn assumption(sequence: &Sequence, subject: Subject) -> Option<Assumption> {
    let mut all = sequence.source().assumptions().iter();
    all.rfind(|assumption| assumption.subject == subject).cloned()
}

fn open(folder: &Path) -> Sequence {
    Sequence::discover(&[folder.to_path_buf()]).unwrap()
}

fn first_points(sequence: &Sequence) -> Vec<[f64; 3]> {
    let first = |index| sequence.decode(index).unwrap().positions.get(0).to_array();
    (0..sequence.len()).map(first).collect()
}

#[test]
fn text_next_to_frames_is_used_or_reported_in_one_sentence() {
    if let Some(folder) = data::shared("meaning/W3c_sizes_txt_beside") {
        let sequence = open(&folder);
        assert_eq!(names(&sequence), ["f_000.ply", "f_001.ply", "f_002.ply", "f_003.ply"]);
        assert_eq!(sequence.source().notes(), [""; 0], "all three lists are used");
        assert_eq!(times(&sequence).unwrap().len(), 4);
        for subject in [Subject::FrameTimes, Subject::Poses] {
            assert_eq!(assumption(&sequence, subject).unwrap().evidence, Evidence::File);
        }
        assert!(sequence.entries().iter().all(|entry| entry.pose.is_some()));
    }
    let frames = ["f_0.ply", "f_1.ply", "f_2.ply"];
    for text in ["sizes.txt", "README.txt", "labels.csv", "times.txt", "poses.txt"] {
        let folder = folder_of(&[&clouds(&frames)[..], &[(text, "a b\n")]].concat());
        let sequence = open(folder.path());
        assert_eq!(names(&sequence), frames, "{text}");
        let [note] = sequence.source().notes() else {
            panic!("{text}: {:?}", sequence.source().notes())
        };
        assert!(note.contains(text), "{note}");
    }
    let text = ["0.txt", "1.txt", "2.txt"];
    let folder = folder_of(&[&clouds(&text)[..], &[("timestamps.txt", "0\n0.5\n1\n")]].concat());
    let sequence = open(folder.path());
    assert_eq!(names(&sequence), text);
    assert_eq!(times(&sequence), Some(vec![0.0, 0.5, 1.0]));
}

#[test]
fn decimals_in_names_are_sorted_by_value_and_are_times() {
    if let Some(folder) = data::shared("meaning/W2h_percent_g_times") {
        let sequence = open(&folder);
        assert_eq!(times(&sequence), Some(vec![0.0, 0.25, 0.5, 0.75, 1.0, 1.25]));
        assert_eq!(
            assumption(&sequence, Subject::FrameTimes).unwrap().evidence,
            Evidence::Statistics
        );
        assert_eq!(sequence.fps(), 4.0);
    }
    let folder = folder_of(&clouds(&["t_-1.ply", "t_-0.5.ply", "t_0.ply", "t_10.ply", "t_9.5.ply"]));
    let expected = ["t_-1.ply", "t_-0.5.ply", "t_0.ply", "t_9.5.ply", "t_10.ply"];
    assert_eq!(names(&open(folder.path())), expected);
    // Versions are not times.
    let folder = folder_of(&clouds(&["v1.9.ply", "v1.10.ply", "v1.11.ply"]));
    let sequence = open(folder.path());
    assert_eq!(names(&sequence), ["v1.9.ply", "v1.10.ply", "v1.11.ply"]);
    assert_eq!(times(&sequence), None);
}

#[test]
fn two_prefixes_are_rejected_with_the_choices() {
    let generated = folder_of(&clouds(&["cam0_0.ply", "cam0_1.ply", "cam1_0.ply", "cam1_1.ply"]));
    let given = data::shared("meaning/W3_two_prefixes");
    let cases = given.iter().map(|folder| (folder.as_path(), "body_*", "head_*", 4));
    for (folder, one, other, count) in cases.chain([(generated.path(), "cam0_*", "cam1_*", 2)]) {
        let Err(error) = Sequence::discover(&[folder.to_path_buf()]) else {
            panic!("{folder:?} is opened")
        };
        let text = error.to_string();
        let expected = [
            format!("--only '{one}'"),
            format!("--only '{other}'"),
            format!("({count} files)"),
        ];
        assert!(expected.iter().all(|expected| text.contains(expected)), "{text}");
        let SequenceError::Several { choices, .. } = error else {
            panic!("{text}")
        };
        for (choice, pattern) in choices.iter().zip([one, other]) {
            let options = OpenOptions {
                only: Some(pattern.into()),
                ..OpenOptions::default()
            };
            let by_option = Sequence::open(&[folder.to_path_buf()], &options).unwrap();
            let by_input = Sequence::discover(std::slice::from_ref(&choice.input)).unwrap();
            assert_eq!(by_option.len(), count);
            assert_eq!(names(&by_option), names(&by_input));
        }
    }
    let nothing = OpenOptions {
        only: Some("arm_*".into()),
        ..OpenOptions::default()
    };
    let Err(error) = Sequence::open(&[generated.path().to_path_buf()], &nothing) else {
        panic!("nothing is opened")
    };
    assert!(error.to_string().contains("cam0_0.ply"), "{error}");
}

#[test]
fn a_folder_per_frame_is_a_sequence() {
    let folder = folder_of(&clouds(&["000/cloud.ply", "001/cloud.ply", "010/cloud.ply"]));
    let sequence = open(folder.path());
    assert_eq!(names(&sequence), ["000/cloud.ply", "001/cloud.ply", "010/cloud.ply"]);
    let numbers: Vec<_> = sequence.entries().iter().map(|entry| entry.number).collect();
    assert_eq!(numbers, [Some(0), Some(1), Some(10)]);
    // Key frames of hdl_graph_slam.
    let data = |x: f64| format!("stamp 1 0\nestimate\n1 0 0 {x}\n0 1 0 0\n0 0 1 0\n0 0 0 1\nodom\n");
    let (one, other) = (data(100.0), data(200.0));
    let folder = folder_of(&[
        ("000000/cloud.pcd", ""),
        ("000001/cloud.pcd", ""),
        ("000000/data", &one),
        ("000001/data", &other),
    ]);
    assert_eq!(
        first_points(&open(folder.path())),
        [[100.0, 0.0, 0.0], [201.0, 0.0, 0.0]]
    );
    let two = folder_of(&clouds(&["0/body.ply", "0/head.ply", "1/body.ply", "1/head.ply"]));
    let Err(error) = Sequence::discover(&[two.path().to_path_buf()]) else {
        panic!("two clouds per folder are opened")
    };
    assert!(error.to_string().contains("--only 'body"), "{error}");
}

#[test]
fn roots_of_recordings_have_times_and_poses() {
    let scans = ["velodyne/000000.bin", "velodyne/000001.bin"];
    // The camera looks along x of the LiDAR: a metre along its z is a metre along x.
    let calib = "P0: 1 0 0 0 0 1 0 0 0 0 1 0\nTr: 0 -1 0 0 0 0 -1 0 1 0 0 0\n";
    let poses = "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 1 0 0 0 0 1 7\n";
    let lists = [("times.txt", "0\n0.1\n"), ("calib.txt", calib), ("poses.txt", poses)];
    let kitti = folder_of(&[&clouds(&scans)[..], &lists].concat());
    for input in [kitti.path().to_path_buf(), kitti.path().join("velodyne")] {
        let sequence = open(&input);
        assert_eq!(times(&sequence), Some(vec![0.0, 0.1]));
        assert_eq!(first_points(&sequence), [[0.0, 0.0, 0.0], [8.0, 0.0, 0.0]]);
        assert_eq!(sequence.decode(1).unwrap().sensor, Some(DVec3::new(7.0, 0.0, 0.0)));
        assert_eq!(sequence.source().notes(), [""; 0]);
    }
    // In the layout of the benchmark they are elsewhere.
    let scans = ["sequences/00/velodyne/000000.bin", "sequences/00/velodyne/000001.bin"];
    let lists = [
        ("sequences/00/calib.txt", calib),
        ("sequences/00/times.txt", "0\n0.1\n"),
        ("poses/00.txt", poses),
    ];
    let dataset = folder_of(&[&clouds(&scans)[..], &lists].concat());
    for input in ["", "sequences", "sequences/00", "sequences/00/velodyne"] {
        let sequence = open(&dataset.path().join(input));
        assert_eq!(first_points(&sequence)[1], [8.0, 0.0, 0.0], "{input}");
    }
    // Raw recordings: a millionth of a degree of latitude is 11 cm.
    let oxts = |latitude: f64| format!("{latitude} 0 100 0 0 0 0 0\n");
    let (one, other) = (oxts(0.0), oxts(1e-4));
    let raw = folder_of(&[
        ("drive/velodyne_points/data/0000000000.bin", ""),
        ("drive/velodyne_points/data/0000000001.bin", ""),
        (
            "drive/velodyne_points/timestamps.txt",
            "2011-09-26 13:02:25.25\n2011-09-26 13:02:25.35\n",
        ),
        ("drive/oxts/data/0000000000.txt", &one),
        ("drive/oxts/data/0000000001.txt", &other),
    ]);
    for input in [raw.path().to_path_buf(), raw.path().join("drive")] {
        let sequence = open(&input);
        assert!(times(&sequence).is_some());
        let moved = first_points(&sequence)[1];
        assert!(
            (moved[0] - 1.0).abs() < 1e-6 && (moved[1] - 11.13).abs() < 0.01,
            "{moved:?}"
        );
    }
    // SLAM programs.
    let moved = [[0.0, 0.0, 0.0], [1.0, 5.0, 0.0]];
    for (list, text) in [
        ("pose.json", "0 0 0 1 0 0 0\n0 5 0 1 0 0 0\n"),
        ("poses.txt", "0 0 0 0 0 0 1\n0 5 0 0 0 0 1\n"),
        (
            "optimized_poses.txt",
            "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 1 0 5 0 0 1 0\n",
        ),
        ("poses_tum.txt", "10.0 0 0 0 0 0 0 1\n10.1 0 5 0 0 0 0 1\n"),
        ("traj.txt", "0 1 0 0 0 0 1 0 0 0 0 1 0\n1 1 0 0 0 0 1 0 5 0 0 1 0\n"),
        (
            "registered_poses.csv",
            "#sec,nsec,x,y,z,qw,qx,qy,qz\n10,0,0,0,0,1,0,0,0\n10,100000000,0,5,0,1,0,0,0\n",
        ),
        (
            "graph.g2o",
            "VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\nVERTEX_SE3:QUAT 1 0 5 0 0 0 0 1\n",
        ),
        (
            "velodyne_poses.json",
            r#"{"0.pcd": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1], "1.pcd": [1,0,0,0, 0,1,0,5, 0,0,1,0, 0,0,0,1]}"#,
        ),
    ] {
        let slam = folder_of(&[("Scans/0.pcd", ""), ("Scans/1.pcd", ""), (list, text)]);
        let sequence = open(slam.path());
        assert_eq!(
            first_points(&sequence),
            moved,
            "{list}: {:?}",
            sequence.source().notes()
        );
        let options = |poses: &str| OpenOptions {
            rgbd: pointreel::source::RgbdOptions {
                poses: Some(poses.into()),
                ..Default::default()
            },
            ..OpenOptions::default()
        };
        let still = Sequence::open(&[slam.path().to_path_buf()], &options("none")).unwrap();
        assert_eq!(first_points(&still), [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]], "{list}");
        let wrong = slam.path().join("Scans/0.pcd");
        assert!(Sequence::open(&[slam.path().to_path_buf()], &options(wrong.to_str().unwrap())).is_err());
    }
}

#[test]
fn the_root_of_nuscenes_opens_the_lidar_with_its_poses() {
    let scan = |number: usize| {
        format!("samples/LIDAR_TOP/n015-2018-07-24-11-22-45+0800__LIDAR_TOP__153240292764795{number}.pcd.bin")
    };
    let (one, other) = (scan(1), scan(2));
    let sample = |token: usize, name: &str| {
        format!(
            r#"{{"token": "s", "filename": "{name}", "ego_pose_token": "{token}", "calibrated_sensor_token": "c"}}"#
        )
    };
    let pose = |token: &str, x: usize| {
        format!(r#"{{"token": "{token}", "translation": [{x}, 0, 0], "rotation": [1, 0, 0, 0]}}"#)
    };
    let samples = format!("[{}, {}]", sample(1, &one), sample(2, &other));
    let poses = format!("[{}, {}]", pose("1", 600), pose("2", 610));
    let mounting = format!("[{}]", pose("c", 1));
    let folder = folder_of(&[
        (&one, "\0\0\0\0\0\0\0\0\0\0\0\0\0\0@@\0\0\0\0"),
        (&other, "\0\0\0\0\0\0\0\0\0\0\0\0\0\0@@\0\0\0\0"),
        ("samples/RADAR_FRONT/a1.pcd", ""),
        ("samples/RADAR_FRONT/a2.pcd", ""),
        ("sweeps/LIDAR_TOP/x1.pcd.bin", ""),
        ("sweeps/LIDAR_TOP/x2.pcd.bin", ""),
        ("v1.0-mini/sample_data.json", &samples),
        ("v1.0-mini/ego_pose.json", &poses),
        ("v1.0-mini/calibrated_sensor.json", &mounting),
    ]);
    let sequence = open(folder.path());
    assert_eq!(sequence.len(), 2);
    assert_eq!(first_points(&sequence), [[601.0, 0.0, 0.0], [611.0, 0.0, 0.0]]);
    let times = times(&sequence).unwrap();
    assert!((times[1] - times[0] - 1e-6).abs() < 1e-6, "{times:?}");
}

#[test]
fn clouds_in_one_coordinate_system_are_not_transformed_again() {
    let wall = |shift: f64| {
        let mut text = String::from("# x y z\n");
        for index in 0..2000 {
            let (x, z) = ((index % 100) as f64 * 0.1 - shift, (index / 100) as f64 * 0.1);
            let y = (0.7 * (x + shift)).sin();
            writeln!(text, "{x} {y} {z}").unwrap();
        }
        text
    };
    let poses = "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 3 0 1 0 0 0 0 1 0\n";
    for (second, is_moved) in [(wall(3.0), true), (wall(0.0), false)] {
        let folder = folder_of(&[("0.xyz", &wall(0.0)), ("1.xyz", &second), ("poses.txt", poses)]);
        let sequence = open(folder.path());
        assert_eq!(sequence.entry(1).pose.is_some(), is_moved);
        assert_eq!(sequence.source().notes().len(), usize::from(!is_moved));
        assert_eq!(first_points(&sequence)[1][0], 0.0, "both are in the same place");
    }
}

#[test]
fn a_single_child_folder_is_opened_and_several_need_a_choice() {
    let one = folder_of(&[
        ("take/0.ply", ""),
        ("take/1.ply", ""),
        ("notes/README.md", "a"),
        ("calib.txt", "a"),
    ]);
    let sequence = open(one.path());
    assert_eq!(sequence.len(), 2);
    assert_eq!(
        assumption(&sequence, Subject::Frames).unwrap().evidence,
        Evidence::Convention
    );
    let several = folder_of(&clouds(&["run/0.ply", "run/1.ply", "walk/0.ply", "walk/1.ply"]));
    let Err(error) = Sequence::discover(&[several.path().to_path_buf()]) else {
        panic!("two sequences are opened")
    };
    let text = error.to_string();
    assert!(
        text.contains("run (2 files)") && text.contains("walk (2 files)"),
        "{text}"
    );
}

#[test]
fn one_dark_frame_stays_dark() {
    let brightest = |sequence: &Sequence, index: usize| {
        let colors = sequence.decode(index).unwrap().attributes.colors.unwrap();
        colors.iter().flat_map(|color| color[..3].to_vec()).max().unwrap()
    };
    if let Some(folder) = data::shared("meaning/L01s_dark_frame_16bit") {
        let sequence = open(&folder);
        let found: Vec<u8> = (0..sequence.len()).map(|index| brightest(&sequence, index)).collect();
        assert!(found.iter().filter(|&&channel| channel > 100).count() == 3, "{found:?}");
        assert!(found.iter().filter(|&&channel| channel <= 1).count() == 1, "{found:?}");
    }
    let colored = |value: u32| {
        format!(
            "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n\
             property ushort red\nproperty ushort green\nproperty ushort blue\nend_header\n0 0 0 {value} {value} 0\n"
        )
    };
    let (dark, bright) = (colored(255), colored(60_000));
    for dark_at in 0..4 {
        let names = ["0.ply", "1.ply", "2.ply", "3.ply"];
        let files: Vec<(&str, &str)> = (0..4)
            .map(|index| {
                (
                    names[index],
                    if index == dark_at {
                        dark.as_str()
                    } else {
                        bright.as_str()
                    },
                )
            })
            .collect();
        let folder = folder_of(&files);
        let sequence = open(folder.path());
        assert_eq!(brightest(&sequence, dark_at), 1, "{dark_at}");
        let said = sequence.assumptions();
        assert!(said.iter().any(|assumption| assumption.subject == Subject::ColorDepth));
    }
    // All frames are narrow: eight bits in sixteen-bit fields.
    let folder = folder_of(&[("0.ply", &dark), ("1.ply", &dark)]);
    assert_eq!(brightest(&open(folder.path()), 0), 255);
    // Unless the user knows better: then nothing is assumed.
    for (depth, expected) in [(ColorDepth::Bits16, 1), (ColorDepth::Bits8, 255)] {
        let options = OpenOptions {
            color_depth: Some(depth),
            ..OpenOptions::default()
        };
        let chosen = Sequence::open(&[folder.path().to_path_buf()], &options).unwrap();
        assert_eq!(brightest(&chosen, 0), expected);
        let said = chosen.assumptions();
        assert!(said.iter().all(|assumption| assumption.subject != Subject::ColorDepth));
    }
}

#[test]
fn one_broken_frame_only_affects_itself() {
    let folder = folder_of(&[("0.ply", ""), ("1.ply", "ply\nbroken"), ("2.ply", "")]);
    let sequence = Arc::new(open(folder.path()));
    let loader = loader(&sequence, 1, usize::MAX);
    loader.request(0, Direction::Forward, &SURFELS);
    until("the other frames", || {
        loader.stats().failed_frames == 1 && loader.stats().resident_frames == 2
    });
    assert_eq!(loader.states()[1], FrameState::Failed);
}
