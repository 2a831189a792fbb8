//! Seeds of mutations: the project's fixtures, files made of them in other formats, and small files of folders
//! that are named.

mod by_hand;
mod written;

use crate::cases::Case;
use crate::kinds::{KINDS, extension_of};
use by_hand::{by_hand, one};
use std::fs;
use std::path::{Path, PathBuf};

/// Larger files make slow seeds; small ones have the same contents.
const MAX_BYTES: u64 = 64 << 10;

/// Seeds of one kind from one folder that is named.
const MAX_OF_KIND: usize = 40;

fn project() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Writes `case` into `folder` as `cases::retained_in` reads it.
pub(crate) fn keep(case: &Case, folder: &Path) -> PathBuf {
    let of_set = folder.join(&case.set);
    let is_alone = case.files.len() == 1;
    let place = match case.files.as_slice() {
        // It is identified by its extension.
        [(file, _)] if *file != case.name => of_set.join(format!("{}-{file}", case.name)),
        _ => of_set.join(&case.name),
    };
    for (name, bytes) in &case.files {
        let path = if is_alone { place.clone() } else { place.join(name) };
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, bytes).unwrap();
    }
    place
}

/// Writes all seeds into `folder`; `named` are folders of further ones.
pub(crate) fn gather(folder: &Path, named: &[PathBuf]) {
    for case in by_hand() {
        keep(&case, folder);
    }
    for name in ["tests/data", "src/reel/tests"] {
        gather_files(&project().join(name), folder, usize::MAX);
    }
    gather_converted(folder);
    for named in named {
        gather_files(named, folder, MAX_OF_KIND);
    }
    copy_all(&project().join("fuzz/seeds/mutations"), folder);
}

/// Adds earlier findings: similar files are likely to fail too.
pub(crate) fn gather_corpus(folder: &Path) {
    copy_all(&project().join("tests/data/hostile"), folder);
}

fn copy_all(from: &Path, to: &Path) {
    let Ok(entries) = fs::read_dir(from) else { return };
    for entry in entries {
        let path = entry.unwrap().path();
        let to = to.join(path.file_name().unwrap());
        if path.is_dir() {
            copy_all(&path, &to);
        } else {
            fs::create_dir_all(to.parent().unwrap()).unwrap();
            fs::copy(&path, &to).unwrap();
        }
    }
}

/// Files below `from` with the extension of a kind.
fn gather_files(from: &Path, folder: &Path, max_of_kind: usize) {
    let mut counts = std::collections::BTreeMap::new();
    let mut folders = vec![from.to_owned()];
    while let Some(next) = folders.pop() {
        let Ok(entries) = fs::read_dir(&next) else { continue };
        let mut paths: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
        paths.sort();
        for path in paths {
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            let extension = extension_of(&name);
            let kind = KINDS.iter().find(|kind| kind.extension == extension);
            if path.is_dir() {
                // The corpus is not a fixture: it has its own seeds (`gather_corpus`).
                folders.extend((!path.ends_with("hostile")).then_some(path));
            } else if let Some(kind) = kind
                && extension != "json"
                && path.metadata().unwrap().len() <= MAX_BYTES
            {
                let count: &mut usize = counts.entry(kind.extension).or_default();
                *count += 1;
                if *count <= max_of_kind {
                    let name = format!("{count}-{name}");
                    keep(&one(kind.set, &name, fs::read(&path).unwrap()), folder);
                }
            }
        }
    }
}

/// A small cloud with everything, moved from frame to frame, in the formats that are written.
fn gather_converted(folder: &Path) {
    let scratch = tempfile::tempdir().unwrap();
    let frames = scratch.path().join("frames");
    fs::create_dir_all(&frames).unwrap();
    for frame in 0..3 {
        let rows = (0..300).map(|point| {
            let (turn, height) = (point as f32 * 0.37, point as f32 / 150.0);
            let (x, y) = (turn.cos() + 0.02 * frame as f32, turn.sin());
            format!(
                "{x},{height},{y},{x},0,{y},{},{},90,{}\n",
                point % 256,
                200 - point % 100,
                point % 7
            )
        });
        let text = format!("x,y,z,nx,ny,nz,red,green,blue,intensity\n{}", rows.collect::<String>());
        fs::write(frames.join(format!("f_{frame}.csv")), text).unwrap();
    }
    let convert = |output: &Path, options: &[&str]| {
        let line = ["pointreel", "convert"].into_iter().chain(options.iter().copied());
        let line = line.map(std::ffi::OsString::from);
        let _ = pointreel::cli::run(line.chain([frames.as_os_str().to_owned(), output.as_os_str().to_owned()]));
    };
    let reel = folder.join("reel");
    fs::create_dir_all(&reel).unwrap();
    for (name, options) in [
        ("usual.reel", &[][..]),
        ("merged.reel", &["--merge"]),
        ("lossless.reel", &["--precision", "lossless"]),
        ("fast.reel", &["--coding", "fast"]),
        ("fast_merged.reel", &["--coding", "fast", "--merge"]),
    ] {
        convert(&reel.join(name), options);
    }
    for format in ["ply", "ply-ascii", "pcd", "las", "laz", "npy"] {
        let output = scratch.path().join(format);
        convert(&output, &["--frames", "0..0", "--format", format]);
        gather_files(&output, folder, 1);
    }
}
