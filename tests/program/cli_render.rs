//! Images that `pointreel render` draws for a person: every mode and strategy, odd clouds, boxes and trails.

use crate::cli::{pointreel, small_sequence, stderr, text};
use serde_json::Value;
use std::fs;

#[test]
fn render_draws_every_primitive_mode_and_strategy() {
    let folder = tempfile::tempdir().unwrap();
    let picture = folder.path().join("out.png");
    let stats = folder.path().join("stats.json");
    let base = [
        "render",
        "demo:",
        "-o",
        text(&picture),
        "--size",
        "96x64",
        "--stats",
        text(&stats),
    ];
    let with = |more: &[&str]| {
        let output = pointreel(&[base.as_slice(), more].concat());
        assert!(output.status.success(), "{more:?}: {}", stderr(&output));
        let image = image::open(&picture).unwrap().to_rgba8();
        assert_eq!(image.dimensions(), (96, 64));
        let stats: Value = serde_json::from_str(&fs::read_to_string(&stats).unwrap()).unwrap();
        (image, stats)
    };
    for mode in [
        "regular",
        "no-depth",
        "visibility",
        "two-pass",
        "enlarged",
        "two-pass-enlarged",
        "sorted",
    ] {
        let (_, stats) = with(&["--splatting", mode]);
        assert_eq!(stats["splatting"], mode);
        assert!(stats["frames"][0]["render"]["drawn_instances"].as_u64().unwrap() >= 1000);
    }
    for primitive in ["surfel", "voxel", "point"] {
        let arguments = ["--primitive", primitive, "--instancing", "storage"];
        let (reference, _) = with(&arguments);
        for strategy in ["uniform", "texture", "vertex", "compute"] {
            let (image, _) = with(&["--primitive", primitive, "--instancing", strategy]);
            assert!(image == reference, "{primitive}: {strategy} draws another picture");
        }
    }
    let (_, stats) = with(&["--primitive", "voxel", "--delta", "0.5", "--lod", "2"]);
    let octree = &stats["frames"][0]["octree"];
    assert!(octree["loss"].as_f64().unwrap() <= 0.5);
    assert!(octree["emitted_voxels"].as_u64().unwrap() <= octree["leaves"].as_u64().unwrap());
    for (flags, depth, max) in [
        (["--depth", "5", "--lod", "0"], Some(5), u64::MAX),
        (["--octant-points", "8", "--lod", "0"], None, u64::MAX),
        (["--delta", "0.02", "--lod-budget", "500"], None, 500),
        (["--depth", "6", "--lod-level", "2"], Some(6), 64),
        (["--depth", "6", "--lod-time", "20"], Some(6), u64::MAX),
    ] {
        let mut arguments = vec!["--primitive", "voxel"];
        arguments.extend(flags);
        let (_, stats) = with(&arguments);
        let octree = &stats["frames"][0]["octree"];
        let emitted = octree["emitted_voxels"].as_u64().unwrap();
        assert!(emitted > 0 && emitted <= max, "{flags:?}: {emitted}");
        assert!(depth.is_none_or(|depth| octree["depth"] == depth), "{flags:?}");
    }
    let points = |shape| with(&["--primitive", "point", "--point-size", "5", "--point-shape", shape]).0;
    assert!(points("disk") != points("square"));
    let (disks, _) = with(&["--renderer", "cpu"]);
    for footprint in ["masks", "pixels"] {
        let coded = ["--renderer", "cpu", "--footprint", footprint];
        let (image, stats) = with(&[&coded[..], &["--lod", "0"]].concat());
        assert!(image != disks, "{footprint}");
        let leaves = &stats["frames"][0]["octree"]["leaves"];
        let drawn = &stats["frames"][0]["render"]["drawn_instances"];
        assert!(drawn.as_u64().unwrap() > 0 && drawn.as_u64() <= leaves.as_u64());
        let (coarse, stats) = with(&[&coded[..], &["--lod-level", "3", "--normal-bits", "15"]].concat());
        assert!(coarse != image, "{footprint}");
        let drawn = &stats["frames"][0]["render"]["drawn_instances"];
        assert!((1..=512).contains(&drawn.as_u64().unwrap()), "{footprint}: {drawn}");
        let (without, _) = with(&[&coded[..], &["--lod", "0", "--offset-bits", "0"]].concat());
        assert!(without != image, "{footprint}");
        let (gpu, _) = with(&["--renderer", "gpu", "--footprint", footprint]);
        assert!(gpu != with(&["--renderer", "gpu"]).0, "{footprint} on the GPU");
    }
    let (black, _) = with(&[
        "--background",
        "#000000",
        "--frame",
        "7",
        "--azimuth",
        "-90",
        "--elevation",
        "10",
        "--distance",
        "1e6",
        "--fov",
        "30",
    ]);
    assert!(
        black.pixels().filter(|pixel| pixel.0[..3] != [0, 0, 0]).count() <= 4,
        "a speck in the distance"
    );
}

#[test]
fn odd_clouds_are_drawn() {
    let folder = tempfile::tempdir().unwrap();
    let many = "1 1 1\n".repeat(50);
    let clouds = [
        (
            "empty.ply",
            "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\nproperty float \
             z\nend_header\n",
        ),
        ("one.xyz", "1 2 3\n"),
        ("equal.xyz", many.as_str()),
        ("holes.xyz", "nan nan nan\n1 2 3\ninf 0 0\n2 2 3\n2 3 3\n"),
        ("nothing.xyz", "nan nan nan\n"),
        ("line.xyz", "0 0 0\n1 1 1\n2 2 2\n3 3 3\n"),
        ("far.xyz", "10000000.001 0 0\n10000000.002 0 0\n10000000.001 0.001 0\n"),
        ("huge.xyz", "-1e11 0 0\n1e11 1e11 0\n0 1e11 1e11\n"),
        ("tiny.xyz", "-1e-11 0 0\n1e-11 1e-11 0\n0 1e-11 1e-11\n"),
    ];
    let picture = folder.path().join("o.png");
    for (name, content) in clouds {
        let path = folder.path().join(name);
        fs::write(&path, content).unwrap();
        for primitive in ["surfel", "voxel", "point"] {
            let output = pointreel(&[
                "render",
                text(&path),
                "-o",
                text(&picture),
                "--size",
                "48x48",
                "--primitive",
                primitive,
            ]);
            assert!(output.status.success(), "{name} as {primitive}: {}", stderr(&output));
        }
    }
}

#[test]
fn clouds_of_extreme_scale_are_refused_with_a_remedy() {
    let folder = tempfile::tempdir().unwrap();
    for (scale, remedy) in [("1e30", "1e-30 times as large"), ("1e-30", "times as large")] {
        let path = folder.path().join(format!("{scale}.xyz"));
        fs::write(&path, format!("-{scale} 0 0\n{scale} {scale} 0\n0 {scale} {scale}\n")).unwrap();
        let output = pointreel(&["render", text(&path), "-o", text(&folder.path().join("o.png"))]);
        assert_eq!(output.status.code(), Some(1), "{scale}");
        assert!(stderr(&output).contains(remedy), "{scale}: {}", stderr(&output));
    }
}

#[test]
fn a_clipped_image_only_shows_what_is_in_the_box() {
    let folder = tempfile::tempdir().unwrap();
    let render = |name: &str, more: &[&str]| {
        let file = folder.path().join(name);
        let base = ["render", "demo:", "-o", text(&file), "--size", "64x64"];
        let output = pointreel(&[&base[..], &["--renderer", "cpu"], more].concat());
        assert!(output.status.success(), "{}", stderr(&output));
        image::open(&file).unwrap().to_rgba8()
    };
    let all = "--clip-box=-1e9,-1e9,-1e9,1e9,1e9,1e9";
    let none = "--clip-box=1e8,1e8,1e8,1e9,1e9,1e9";
    for primitive in ["surfel", "voxel", "point"] {
        let picture = |more: &[&str]| {
            let more = [&["--primitive", primitive], more].concat();
            render("clipped.png", &more)
        };
        let [whole, empty] = [picture(&[]), picture(&[none])];
        assert_ne!(whole, empty, "{primitive}");
        assert_eq!(picture(&[all]), whole, "{primitive}");
        assert_eq!(picture(&[all, "--clip-outside"]), empty, "{primitive}");
        assert_eq!(picture(&[none, "--clip-outside"]), whole, "{primitive}");
    }
    let output = pointreel(&["render", "demo:", "-o", "x.png", "--clip-box", "1,2,3"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("expected six numbers"));
}

#[test]
fn trails_are_drawn_and_their_breaks_reported() {
    let folder = small_sequence();
    let picture = folder.path().join("way.png");
    let render = |more: &[&str]| {
        let input = ["render", text(folder.path()), "-o", text(&picture), "--frame", "1"];
        let how = [
            "--primitive",
            "point",
            "--renderer",
            "cpu",
            "--size",
            "200x200",
            "--distance",
            "6",
            "--eye-dome",
            "off",
            "--up",
            "y",
        ];
        pointreel(&[&input[..], &how[..], more].concat())
    };
    // Only trails are orange.
    let orange = || {
        let image = image::open(&picture).unwrap().to_rgba8();
        let is_orange = |pixel: &&image::Rgba<u8>| pixel.0 == [255, 190, 60, 255];
        image.pixels().filter(is_orange).count()
    };
    assert!(render(&[]).status.success());
    assert_eq!(orange(), 0);
    let output = render(&["--trail", "0,2"]);
    assert!(output.status.success(), "{}", stderr(&output));
    assert_eq!(stderr(&output), "");
    assert!(orange() > 20, "{}", orange());

    let output = render(&["--trail", "3"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(
        stderr(&output).contains("point 3 does not exist: frame 2 of 3 (index 1) has 3 points"),
        "{}",
        stderr(&output)
    );
    fs::write(folder.path().join("f11.xyz"), "0 0 0\n1 1 1\n").unwrap();
    let output = render(&["--trail", "1"]);
    assert!(output.status.success());
    assert!(
        stderr(&output).contains("frame 4 of 4 (index 3) has 2 points, frame 3 of 4 (index 2) has 3"),
        "{}",
        stderr(&output)
    );
}
