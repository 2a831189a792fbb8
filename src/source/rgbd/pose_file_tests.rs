use super::*;
use std::fs;
use std::time::Duration;

fn written(name: &str, text: &str) -> Result<Trajectory, RgbdError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    fs::write(&path, text).unwrap();
    Trajectory::read(&path)
}

/// A quarter turn around z and a translation.
fn pose() -> DAffine3 {
    DAffine3::from_rotation_translation(
        DQuat::from_rotation_z(std::f64::consts::FRAC_PI_2),
        DVec3::new(1.0, 2.0, 3.0),
    )
}

#[test]
fn every_format_gives_the_same_pose() {
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let rows = "0 -1 0 1\n1 0 0 2\n0 0 1 3\n";
    let open3d = "[0,-1,0,0, 1,0,0,0, 0,0,1,0, -2,1,-3,1]";
    for (name, text) in [
        ("a.log", format!("0 0 1\n{rows}0 0 0 1\n")),
        ("rows.txt", format!("{rows}0 0 0 1\n{rows}0 0 0 1\n")),
        ("short.txt", rows.to_owned()),
        (
            "rows_of_columns.txt",
            "0 1 0 0\n-1 0 0 0\n0 0 1 0\n1 2 3 1\n".to_owned(),
        ),
        ("line.txt", format!("{}\n", rows.replace('\n', " "))),
        ("columns.txt", "0 1 0 0 -1 0 0 0 0 0 1 0 1 2 3 1\n".to_owned()),
        ("places.txt", format!("1 2 3 0 0 {half} {half}\n")),
        ("line16.txt", format!("{} 0 0 0 1", rows.replace('\n', ","))),
        (
            "a.json",
            format!(r#"{{"class_name":"PinholeCameraTrajectory","parameters":[{{"extrinsic":{open3d}}}]}}"#),
        ),
        (
            "graph.json",
            r#"{"nodes":[{"pose":[0,1,0,0, -1,0,0,0, 0,0,1,0, 1,2,3,1]}]}"#.to_owned(),
        ),
    ] {
        let found = written(name, &text).unwrap().pose(0, None).unwrap();
        assert!(found.abs_diff_eq(pose(), 1e-12), "{name}: {found}");
    }
    let tum = format!("# a comment\n5.0 9 9 9 0 0 0 1\n1305031102.16 1 2 3 0 0 {half} {half}\n");
    let tum = written("groundtruth.txt", &tum).unwrap();
    let at = |millis: u64| tum.pose(7, Some(Duration::from_millis(1_305_031_102_000 + millis)));
    assert!(at(171).unwrap().abs_diff_eq(pose(), 1e-12));
    assert_eq!((at(181), tum.pose(0, None)), (None, None));
}

#[test]
fn poses_find_their_frames_by_time_order_or_number() {
    let places = |count: usize| {
        let lines: Vec<String> = (0..count).map(|at| format!("{at} 0 0 0 0 0 1\n")).collect();
        let text = lines.concat();
        written("places.txt", &text).unwrap()
    };
    let found = |trajectory: &Trajectory, times: &[Option<Duration>], numbers: &[usize]| {
        let numbers: Vec<Option<usize>> = numbers.iter().copied().map(Some).collect();
        let names = vec![String::new(); times.len()];
        let poses = trajectory.poses_of(times, &numbers, &names).into_iter();
        poses
            .map(|pose| pose.map(|pose| pose.translation.x))
            .collect::<Vec<_>>()
    };
    let untimed = [None; 2];
    // The same number: images are counted from 1.
    assert_eq!(found(&places(2), &untimed, &[1, 2]), [Some(0.0), Some(1.0)]);
    // Every tenth image.
    assert_eq!(found(&places(20), &untimed, &[0, 10]), [Some(0.0), Some(10.0)]);
    // Numbers that mean something else.
    assert_eq!(found(&places(3), &untimed, &[100, 200]), [Some(0.0), Some(1.0)]);
    let stamped = written("tum.txt", "0 5 0 0 0 0 0 1\n1 6 0 0 0 0 0 1\n4 7 0 0 0 0 0 1\n").unwrap();
    assert_eq!(found(&stamped, &untimed, &[1, 3]), [Some(6.0), None]);
    let times = [Some(Duration::from_secs(4)), None];
    assert_eq!(found(&stamped, &times, &[0, 1]), [Some(7.0), None]);
}

#[test]
fn a_lost_camera_has_no_pose() {
    for lost in [
        "-inf -inf -inf -inf\n-inf -inf -inf -inf\n-inf -inf -inf -inf\n0 0 0 1\n",
        "1 0 0 0\n0 1 0 0\n0 0 -1 0\n0 0 0 1\n",
        "0 0 0 0\n0 0 0 0\n0 0 0 0\n0 0 0 1\n",
        "0 0 0 0\n0 0 0 0\n0 0 0 0\n0 0 0 0\n",
        "nan nan nan nan\nnan nan nan nan\nnan nan nan nan\nnan nan nan nan\n",
        "-inf -inf -inf -inf\n-inf -inf -inf -inf\n-inf -inf -inf -inf\n-inf -inf -inf -inf\n",
    ] {
        assert_eq!(written("pose.txt", lost).unwrap().pose(0, None), None, "{lost}");
    }
}

#[test]
fn invalid_trajectories_are_rejected() {
    for (text, expected) in [
        ("", "no numbers"),
        ("1 2\n", "2 numbers"),
        ("1 0 0 0\n0 1 0\n", "3 numbers"),
        ("0 0 1\n1 0 0 0\n", "line 1"),
        ("1 0 0 x\n", "`x` is not a number"),
        ("1 2 3 4 5 6 7 8\n1 2\n", "line 2"),
        ("1 0 0 0 3 4 5\n", "line 1: its rotation comes first"),
        ("-1 2 3 4 5 6 7 8\n", "the time"),
        ("{\"a\": 1}", "neither"),
        ("{", "EOF"),
    ] {
        let error = written("bad.txt", text).unwrap_err().to_string();
        assert!(error.contains("bad.txt") && error.contains(expected), "{text}: {error}");
    }
}
