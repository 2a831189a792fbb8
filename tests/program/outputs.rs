//! Nothing is written or lost in silence: outputs of `convert` and `render` that are refused, resuming, data that a
//! target cannot hold.

use pointreel::cloud::Positions;
use pointreel::io;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn run_in(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_pointreel"))
        .args(arguments)
        .current_dir(folder)
        .env("RUST_BACKTRACE", "0")
        .output()
        .unwrap()
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn stdout(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// It ends with exit code 1 and prints all of `expected` on stderr.
fn refused(folder: &Path, arguments: &[&str], expected: &[&str]) {
    let output = run_in(folder, arguments);
    let said = stderr(&output);
    assert_eq!(
        output.status.code(),
        Some(1),
        "{arguments:?}: {said}{}",
        stdout(&output)
    );
    for expected in expected {
        assert!(said.contains(expected), "{arguments:?} lacks {expected}: {said}");
    }
}

/// It succeeds; its stdout and stderr.
fn done(folder: &Path, arguments: &[&str]) -> (String, String) {
    let output = run_in(folder, arguments);
    assert!(output.status.success(), "{arguments:?}: {}", stderr(&output));
    (stdout(&output), stderr(&output))
}

/// Every file below `folder` with its bytes, hidden ones too.
fn contents(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut all = BTreeMap::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() && !path.is_symlink() {
            all.insert(path.clone(), Vec::new());
            all.extend(contents(&path));
        } else {
            let bytes = fs::read(&path).unwrap_or_default();
            all.insert(path, bytes);
        }
    }
    all
}

fn visible(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let names = entries.map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned());
    let mut names: Vec<String> = names.filter(|name| !name.starts_with('.')).collect();
    names.sort();
    names
}

/// `gt` with five frames of three points, `mesh_00003.ply` and on.
fn scans() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("gt")).unwrap();
    for frame in 3..8 {
        let rows = format!("{frame} 0 0 255 0 0\n{frame}.5 1 0 0 255 0\n{frame} 0.1 1 0 0 255\n");
        let file = folder.path().join(format!("gt/mesh_{frame:05}.ply"));
        fs::write(file, format!("{PLY_HEADER}{rows}")).unwrap();
    }
    folder
}

const PLY_HEADER: &str = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float \
                          z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n";

#[test]
fn an_output_that_is_the_input_is_rejected_by_any_name() {
    let folder = scans();
    let root = folder.path();
    fs::create_dir(root.join("links")).unwrap();
    fs::create_dir(root.join("elsewhere")).unwrap();
    done(root, &["convert", "gt", "walk.reel"]);
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(root.join("gt"), root.join("same")).unwrap();
        for name in visible(&root.join("gt")) {
            std::os::unix::fs::symlink(root.join("gt").join(&name), root.join("links").join(&name)).unwrap();
        }
        std::os::unix::fs::symlink(root.join("walk.reel"), root.join("link.reel")).unwrap();
    }
    let absolute = root.join("gt");
    let absolute = absolute.to_str().unwrap();
    let before = contents(root);
    let mut cases = vec![
        ["gt", "gt"],
        ["gt", "gt/"],
        ["gt", "./gt"],
        ["gt", "elsewhere/../gt"],
        ["gt", absolute],
        [absolute, "gt"],
        ["gt/*.ply", "gt"],
        ["gt/mesh_0000?.ply", "gt"],
        ["gt/mesh_00003.ply", "gt"],
        ["gt/mesh_00003.ply", "gt/mesh_00003.ply"],
        ["gt/mesh_00003.ply", "./gt/../gt/mesh_00003.ply"],
        ["walk.reel", "walk.reel"],
        ["walk.reel", "."],
    ];
    if cfg!(unix) {
        cases.extend([
            ["gt", "same"],
            ["same", "gt"],
            ["same/*.ply", "gt"],
            ["links", "gt"],
            ["links", "links"],
            ["links/mesh_00004.ply", "gt/mesh_00004.ply"],
            ["link.reel", "walk.reel"],
            ["walk.reel", "link.reel"],
        ]);
    }
    for [input, output] in cases {
        for more in [&[][..], &["--overwrite"], &["--format", "pcd"]] {
            // A single file determines its own format.
            let is_file = Path::new(output).extension().is_some();
            if is_file && more.contains(&"--format") {
                continue;
            }
            let arguments = [&["convert", input, output][..], more].concat();
            refused(root, &arguments, &["is where the input", "nothing was written"]);
            assert_eq!(contents(root), before, "{arguments:?}");
        }
    }
    refused(&root.join("gt"), &["convert", ".", "."], &["is where the input"]);
    refused(
        root,
        &["convert", "--join", "walk.reel", "walk.reel"],
        &["one of the parts"],
    );
    assert_eq!(contents(root), before);
    // A folder inside the input folder is a different one.
    done(root, &["convert", "gt", "gt/out"]);
    assert_eq!(visible(&root.join("gt/out")).len(), 5);
}

#[test]
fn names_of_unwritable_formats_are_rejected() {
    let folder = scans();
    let root = folder.path();
    let before = contents(root);
    let names = [
        "g.glb", "g.gltf", "g.usd", "g.obj", "g.npz", "g.csv", "g.e57", "g.png", "g.stl", "g.bin", "g.PLY2", "g.v2",
    ];
    for name in names {
        for more in [&[][..], &["--frames", "0"], &["--format", "ply"]] {
            let arguments = [&["convert", "gt", name][..], more].concat();
            refused(
                root,
                &arguments,
                &["ply, ply-ascii, pcd, las, laz, xyz, npy", ".reel", "slash"],
            );
        }
    }
    refused(
        root,
        &["convert", "gt", "a.pcd", "--frames", "0", "--format", "las"],
        &[".las", "--format"],
    );
    refused(root, &["convert", "gt", "all.ply"], &["one file, but 5 frames"]);
    fs::write(root.join("file"), "mine").unwrap();
    refused(root, &["convert", "gt", "file"], &["file is an existing file"]);
    fs::remove_file(root.join("file")).unwrap();
    assert_eq!(contents(root), before);
    // A folder: without extension, with a trailing slash, or existing already.
    fs::create_dir(root.join("there.v1")).unwrap();
    for output in ["plain", "g.glb/", "there.v1"] {
        done(root, &["convert", "gt", output]);
        assert_eq!(visible(&root.join(output)).len(), 5, "{output}");
    }
}

#[test]
fn only_files_written_by_the_conversion_are_resumed() {
    let folder = scans();
    let root = folder.path();
    fs::create_dir(root.join("out")).unwrap();
    fs::write(root.join("out/mesh_00005.pcd"), "mine").unwrap();
    let convert = ["convert", "gt", "out", "--format", "pcd"];
    let before = contents(root);
    refused(
        root,
        &convert,
        &["mesh_00005.pcd", "--overwrite", "nothing was written"],
    );
    assert_eq!(contents(root), before, "nothing is written next to it");
    let with = |more: &[&'static str]| [&convert[..], more].concat();
    assert!(done(root, &with(&["--overwrite"])).0.starts_with("5 frames written"));
    // Its own frames are left unchanged.
    assert!(
        done(root, &convert)
            .0
            .starts_with("0 frames written to out, 5 were there already")
    );
    fs::remove_file(root.join("out/mesh_00004.pcd")).unwrap();
    assert!(
        done(root, &convert)
            .0
            .starts_with("1 frames written to out, 4 were there already")
    );
    // A source that has changed is converted again.
    let changed = fs::read_to_string(root.join("gt/mesh_00006.ply")).unwrap();
    fs::write(root.join("gt/mesh_00006.ply"), changed.replace("6.5 1 0", "6.25 1 0")).unwrap();
    assert!(
        done(root, &convert)
            .0
            .starts_with("1 frames written to out, 4 were there already")
    );
    let read = io::read(&root.join("out/mesh_00006.pcd")).unwrap();
    assert_eq!(read.positions.get(1).x, 6.25);
    // A file that was edited since no longer belongs to the conversion, nor does one of another conversion.
    fs::write(root.join("out/mesh_00007.pcd"), "edited").unwrap();
    refused(root, &convert, &["mesh_00007.pcd", "--overwrite"]);
    done(root, &with(&["--overwrite"]));
    fs::create_dir(root.join("other")).unwrap();
    fs::copy(root.join("gt/mesh_00003.ply"), root.join("other/mesh_00003.ply")).unwrap();
    let before = contents(root);
    refused(
        root,
        &["convert", "other", "out", "--format", "pcd"],
        &["another conversion", "/gt there", "/other now"],
    );
    refused(
        root,
        &["convert", "gt", "out", "--format", "ply"],
        &["another conversion", "pcd there, ply now"],
    );
    refused(
        root,
        &with(&["--voxel", "3"]),
        &["another conversion", "cells of 3 now"],
    );
    refused(
        root,
        &["convert", "gt/*.ply", "out", "--format", "pcd", "--merge-scans"],
        &["--merge-scans now"],
    );
    assert_eq!(contents(root), before);
    assert!(
        done(root, &["convert", "gt/*.ply", "out", "--format", "pcd"])
            .0
            .contains("5 were there already")
    );
}

#[test]
fn a_file_is_not_replaced_unless_requested() {
    let folder = scans();
    let root = folder.path();
    fs::write(root.join("one.ply"), "mine").unwrap();
    let convert = ["convert", "gt", "one.ply", "--frames", "1"];
    refused(root, &convert, &["one.ply is there already", "--overwrite"]);
    assert_eq!(fs::read(root.join("one.ply")).unwrap(), b"mine");
    done(root, &[&convert[..], &["--overwrite"]].concat());
    assert_eq!(io::read(&root.join("one.ply")).unwrap().positions.get(0).x, 4.0);
}

#[test]
fn missing_frames_are_rejected_by_every_command() {
    let folder = scans();
    let root = folder.path();
    let before = contents(root);
    let missing = ["the sequence has 5 frames, 0..4"];
    let partly = ["the sequence has 5 frames, 0..4", "it has 3..4"];
    for (arguments, expected) in [
        (&["convert", "gt", "out", "--frames", "20..30"][..], &missing[..]),
        (&["convert", "gt", "out", "--frames", "3..5"], &partly),
        (&["convert", "gt", "out.ply", "--frames", "5"], &missing),
        (&["convert", "gt", "out.reel", "--frames", "5..9"], &missing),
        (&["convert", "gt", "out.reel", "--frames", "3..9"], &partly),
        (&["render", "gt", "-o", "a.png", "--frame", "5"], &missing),
        (&["render", "gt", "-o", "a{frame}.png", "--frame", "3..7"], &partly),
        (&["render", "gt", "--video", "a.gif", "--frame", "3..7"], &partly),
        (&["compare-frames", "gt", "--from", "0", "--to", "5"], &missing),
        (&["compare-frames", "gt", "--from", "9", "--to", "0"], &missing),
        (&["bench", "rate", "gt", "--first-frame", "5"], &missing),
    ] {
        refused(root, arguments, expected);
        assert_eq!(contents(root), before, "{arguments:?}");
    }
}

#[test]
fn type_stem_and_numbers_match_the_source() {
    let folder = scans();
    let root = folder.path();
    done(root, &["convert", "gt", "out"]);
    let names: Vec<String> = (3..8).map(|frame| format!("mesh_{frame:05}.ply")).collect();
    assert_eq!(visible(&root.join("out")), names);
    let written = fs::read(root.join("out/mesh_00003.ply")).unwrap();
    let header_end = written.windows(11).position(|bytes| bytes == b"end_header\n").unwrap() + 11;
    assert_eq!(
        written.len() - header_end,
        3 * 15,
        "three floats and three bytes per point"
    );
    let cloud = io::read(&root.join("out/mesh_00003.ply")).unwrap();
    assert!(matches!(cloud.positions, Positions::F32(_)));
    // And so they are after a lossless round trip through a sequence file.
    done(root, &["convert", "out", "walk.reel", "--precision", "lossless"]);
    done(root, &["convert", "walk.reel", "again"]);
    assert_eq!(visible(&root.join("again")), names);
    assert!(matches!(
        io::read(&root.join("again/mesh_00003.ply")).unwrap().positions,
        Positions::F32(_)
    ));
    // Digits beyond single precision are retained.
    fs::create_dir(root.join("utm")).unwrap();
    fs::write(
        root.join("utm/a.ply"),
        format!("{PLY_HEADER}691234.56 5334567.12 1 0 0 0\n1 2 3 0 0 0\n4 5 6 0 0 0\n"),
    )
    .unwrap();
    done(root, &["convert", "utm", "utm_out"]);
    let wide = io::read(&root.join("utm_out/a.ply")).unwrap();
    assert_eq!(wide.positions.get(0).to_array(), [691_234.56, 5_334_567.12, 1.0]);
    // Colliding names are numbered, and this is reported.
    done(root, &["convert", "gt", "more", "--frames", "0"]);
    let (_, said) = done(root, &["convert", "gt/mesh_00003.ply", "more/mesh_00003.ply", "both"]);
    assert_eq!(visible(&root.join("both")), ["frame_000000.ply", "frame_000001.ply"]);
    assert!(said.contains("frames are numbered"), "{said}");
}

#[test]
fn broken_frames_are_reported_and_leave_nothing_behind() {
    let folder = scans();
    let root = folder.path();
    fs::write(
        root.join("gt/mesh_00005.ply"),
        format!("{PLY_HEADER}5 0 0 255 0 0\nno\n"),
    )
    .unwrap();
    let output = run_in(root, &["convert", "gt", "out"]);
    assert_eq!(output.status.code(), Some(1));
    let said = stderr(&output);
    assert!(
        said.contains("mesh_00005.ply") && said.contains("1 frames could not be converted"),
        "{said}"
    );
    let names = ["mesh_00003.ply", "mesh_00004.ply", "mesh_00006.ply", "mesh_00007.ply"];
    assert_eq!(visible(&root.join("out")), names);
    let hidden = contents(&root.join("out"))
        .into_keys()
        .filter(|path| path.to_string_lossy().contains(".partial"));
    assert_eq!(hidden.count(), 0);
}

#[test]
fn content_a_target_cannot_store_is_reported() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    let header = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float \
                  z\nproperty float nx\nproperty float ny\nproperty float nz\nelement face 1\nproperty list uchar int \
                  vertex_indices\nend_header\n";
    fs::write(
        root.join("a.ply"),
        format!("{header}0 0 0 0 0 1\n1 0 0 0 0 1\nnan 1 0 0 0 1\n3 0 1 2\n"),
    )
    .unwrap();
    for (target, expected, unexpected) in [
        (
            "a.las",
            &[
                "las cannot hold normals",
                "las cannot hold faces: 1",
                "points without coordinates: 1",
            ][..],
            "pcd",
        ),
        ("a.pcd", &["pcd cannot hold faces: 1"], "normals"),
        ("a.xyz", &["xyz cannot hold faces: 1"], "normals"),
        ("b.ply", &[], "cannot hold"),
    ] {
        let (_, said) = done(root, &["convert", "a.ply", target]);
        for expected in expected {
            assert!(said.contains(expected), "{target}: {said}");
        }
        assert!(!said.contains(unexpected), "{target}: {said}");
    }
    let (_, said) = done(root, &["convert", "a.ply", "a.reel"]);
    assert!(said.contains("reel cannot hold faces: 1"), "{said}");
    let (_, said) = done(root, &["convert", "a.ply", "voxels.ply", "--voxel", "0.5"]);
    assert!(said.contains("1 faces are not written"), "{said}");
}

#[test]
fn images_have_the_format_of_their_names() {
    let folder = scans();
    let root = folder.path();
    let render = |more: &[&str]| {
        let common = ["--renderer", "cpu", "--size", "48x32"];
        run_in(root, &[&["render", "gt"][..], more, &common].concat())
    };
    for (name, first) in [
        ("a.png", &b"\x89PNG"[..]),
        ("a.jpg", b"\xff\xd8\xff"),
        ("a.jpeg", b"\xff\xd8\xff"),
        ("a.webp", b"RIFF"),
        ("a.tif", b"II*\0"),
        ("a.TIFF", b"II*\0"),
    ] {
        let output = render(&["-o", name]);
        assert!(output.status.success(), "{name}: {}", stderr(&output));
        assert!(fs::read(root.join(name)).unwrap().starts_with(first), "{name}");
    }
    let piped = render(&["-o", "-"]);
    assert!(piped.status.success(), "{}", stderr(&piped));
    assert_eq!(
        piped.stdout,
        fs::read(root.join("a.png")).unwrap(),
        "nothing else is on stdout"
    );
    let before = contents(root);
    for name in ["a.exr", "a.gif", "a.bmp", "a.svg", "a.mp4", "a", "a.png.bak", "gt"] {
        let output = render(&["-o", name]);
        assert_eq!(output.status.code(), Some(1), "{name}");
        assert!(
            stderr(&output).contains(".png, .jpg, .jpeg, .webp, .tif"),
            "{name}: {}",
            stderr(&output)
        );
    }
    for (arguments, expected) in [
        (&["-o", "b.jpg", "--background", "transparent"][..], "no transparency"),
        (&["-o", "-", "--frame", "0..1"], "put {frame} into its name"),
        (&["--video", "-"], "is not a video"),
        (&["--video", "a.avi"], "is not a video"),
        (&["-o", "gt/mesh_00003.ply"], ".png"),
    ] {
        let output = render(arguments);
        assert_eq!(output.status.code(), Some(1), "{arguments:?}");
        assert!(stderr(&output).contains(expected), "{arguments:?}: {}", stderr(&output));
    }
    assert_eq!(contents(root), before);
    let soft = render(&["-o", "soft.tif", "--background", "transparent"]);
    assert!(soft.status.success(), "{}", stderr(&soft));
}
