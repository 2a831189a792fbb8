use super::*;

fn paths(names: &[&str]) -> Vec<PathBuf> {
    names.iter().map(PathBuf::from).collect()
}

fn names(files: &[PathBuf]) -> Vec<String> {
    let mut names: Vec<String> = files.iter().map(|file| file.display().to_string()).collect();
    names.sort();
    names
}

fn chosen(files: &[&str]) -> (Vec<String>, Vec<String>) {
    let chosen = choose(paths(files)).unwrap();
    assert!(chosen.assumption.is_some() || chosen.skipped.is_empty());
    (names(&chosen.frames), names(&chosen.skipped))
}

fn options(files: &[&str]) -> Vec<String> {
    let choices = choose(paths(files)).unwrap_err();
    choices.into_iter().map(|choice| choice.option.unwrap()).collect()
}

#[test]
fn text_next_to_clouds_is_skipped() {
    for text in [
        &["timestamps.txt"][..],
        &["times.txt", "poses.txt", "calib.txt"],
        &["f_0.txt", "f_1.txt", "f_2.txt"],
        &["labels.csv", "README.txt"],
        &["poses.npy", "all.zip"],
    ] {
        for cloud in ["ply", "pcd", "las", "bin", "xyz"] {
            let clouds = [0, 1, 2].map(|number| format!("f_{number}.{cloud}"));
            let files: Vec<&str> = clouds.iter().map(String::as_str).chain(text.iter().copied()).collect();
            let (frames, skipped) = chosen(&files);
            assert_eq!(frames, clouds, "{files:?}");
            assert_eq!(skipped.len(), text.len(), "{files:?}");
        }
    }
}

#[test]
fn text_files_are_frames_where_they_are_the_numbered_majority() {
    let text = ["s_0.txt", "s_1.txt", "s_2.txt", "s_3.txt"];
    assert_eq!(chosen(&text).0, text);
    let with = |others: &[&'static str]| chosen(&[&text[..], others].concat());
    assert_eq!(with(&["timestamps.txt"]).1, ["timestamps.txt"]);
    assert_eq!(with(&["times.txt", "poses.txt"]).1.len(), 2);
    assert_eq!(
        with(&["mesh.ply"]),
        (text.map(str::to_owned).to_vec(), vec!["mesh.ply".to_owned()])
    );
    assert_eq!(chosen(&["poses.txt"]).0, ["poses.txt"], "what there is");
    assert_eq!(chosen(&["scan.txt", "calib.txt"]).0, ["scan.txt"]);
}

#[test]
fn two_prefixes_need_a_choice() {
    let both = |one: &str, other: &str| {
        let names: Vec<String> = (0..4)
            .flat_map(|number| [one, other].map(|name| name.replace('#', &format!("{number:03}"))))
            .collect();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        options(&names)
    };
    assert_eq!(both("body_#.ply", "head_#.ply"), ["--only 'body_*'", "--only 'head_*'"]);
    assert_eq!(
        both("#_left.pcd", "#_right.pcd"),
        ["--only '*_left.pcd'", "--only '*_right.pcd'"]
    );
    assert_eq!(both("cam0_#.ply", "cam1_#.ply"), ["--only 'cam0_*'", "--only 'cam1_*'"]);
    assert_eq!(
        both("f#_cam1.las", "f#_cam2.las"),
        ["--only '*_cam1.las'", "--only '*_cam2.las'"]
    );
    assert_eq!(both("#.ply", "mask#.ply"), ["--only '[0-9]*.ply'", "--only 'mask*'"]);
    assert_eq!(
        both("lidar_#.bin", "radar_#.pcd"),
        ["--only 'lidar_*'", "--only 'radar_*'"]
    );
}

#[test]
fn patterns_choose_one_series_alone() {
    for (one, other) in [
        (["000.ply", "001.ply"], ["000_gt.ply", "001_gt.ply"]),
        (
            ["cloud_00.ply", "cloud_01.ply"],
            ["cloud_00_filtered.ply", "cloud_01_filtered.ply"],
        ),
        (["1.ply", "10.ply"], ["1_clean.ply", "10_clean.ply"]),
    ] {
        let files = [one, other].concat();
        for option in options(&files) {
            let pattern = option.trim_start_matches("--only '").trim_end_matches('\'');
            let pattern = glob::Pattern::new(pattern).unwrap();
            let matched: Vec<&str> = files.iter().copied().filter(|name| pattern.matches(name)).collect();
            assert!(matched == one || matched == other, "{option}: {matched:?}");
        }
    }
}

#[test]
fn different_things_need_a_choice() {
    for files in [
        &["cloudCorner.pcd", "cloudGlobal.pcd", "cloudSurf.pcd"][..],
        &["after.ply", "before.ply"],
        &["cloud_lod0.ply", "cloud_lod1.ply", "cloud_lod2.ply"],
    ] {
        let expected: Vec<String> = files.iter().map(|file| format!("--only '{file}'")).collect();
        assert_eq!(options(files), expected);
    }
    assert_eq!(chosen(&["scan.las", "scan.ply"]).0.len(), 1, "one scan in two formats");
    assert_eq!(chosen(&["faces.npy", "vertices.npy"]).0, ["vertices.npy"]);
    let named = choose(paths(&["alice.ply", "bob.ply", "carol.ply"])).unwrap();
    assert_eq!(named.assumption.unwrap().evidence, Evidence::Fallback);
}

#[test]
fn numbering_styles_are_one_series_and_odd_files_are_skipped() {
    for files in [
        &["frame_9.ply", "frame_10.ply", "Frame_011.PLY"][..],
        &["scan1.ply", "scan01.ply", "scan-2.ply"],
        &["scan.ply", "scan 1.ply", "scan 2.ply"],
        &["t_03-30.xyz", "t_04-02.ply", "t_04-03.ply"],
        &["c_-1.ply", "c_1e-05.ply", "c_0.5.ply"],
        &["scan1_v2.ply", "scan2_v2.ply", "scan5_v2.ply"],
        &["tile_0_0.las", "tile_0_1.las", "tile_1_0.las", "tile_1_1.las"],
        &["bunny.ply", "dragon.ply", "armadillo.ply"],
    ] {
        assert_eq!(chosen(files).1, [""; 0], "{files:?}");
    }
    for odd in ["mesh.ply", "map_2.pcd", "background.xyz"] {
        let files = ["f_000.ply", "f_001.ply", "f_002.ply", odd];
        assert_eq!(chosen(&files).1, [odd]);
    }
    // Models with different names, two of them of one kind, are not a sequence with odd files.
    assert_eq!(chosen(&["a_1.ply", "a_2.ply", "bunny.ply", "dragon.ply"]).0.len(), 4);
}

#[test]
fn one_of_two_formats_of_the_same_frames_is_taken() {
    let (frames, skipped) = chosen(&["0.ply", "1.ply", "2.ply", "0.bin", "1.bin", "2.bin"]);
    assert_eq!(frames, ["0.ply", "1.ply", "2.ply"]);
    assert_eq!(skipped.len(), 3);
}

#[test]
fn skipped_files_are_reported_in_one_sentence() {
    assert_eq!(note_of_skipped(&[]), None);
    assert_eq!(
        note_of_skipped(&paths(&["a/mesh.ply"])).unwrap(),
        "mesh.ply next to the frames is skipped: it is not one of them"
    );
    let many = note_of_skipped(&paths(&["a.txt", "b.txt", "c.txt", "d.txt", "e.txt"])).unwrap();
    assert!(many.ends_with("(a.txt, b.txt, c.txt, d.txt, …)"), "{many}");
}
