//! Imports go one way: a module never names one to its right. See the table in `src/lib.rs`.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::fs;
use std::path::{Path, PathBuf};

/// Modules that may import those of earlier rows, and nothing of each other within a row that holds whole programs.
const ORDER: &[&[&str]] = &[
    &["math", "memory", "kept", "messages", "priority", "progress"],
    &["cloud"],
    &["io", "analysis"],
    &["measure"],
    &["octree"],
    &["source"],
    &["sequence"],
    &["scene"],
    &["playback"],
    &["render"],
    &["headless"],
    &["export", "bench", "check", "convert"],
    &["app"],
    &["cli"],
];

fn rank(module: &str) -> Option<usize> {
    ORDER.iter().position(|row| row.contains(&module))
}

fn rust_files(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            rust_files(&path, files);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
}

/// Modules that a source names as `crate::module`, comments and strings included: a wrong link is a wrong import too.
fn named_modules(source: &str) -> Vec<String> {
    let mut modules: Vec<String> = Vec::new();
    for rest in source.split("crate::").skip(1) {
        let names: Vec<&str> = match rest.strip_prefix('{') {
            // use crate::{a::…, b};
            Some(group) => group
                .split(['{', '}'])
                .next()
                .unwrap_or("")
                .split(',')
                .collect(),
            None => vec![rest],
        };
        modules.extend(names.into_iter().map(|name| {
            name.trim_start()
                .chars()
                .take_while(|c| c.is_ascii_lowercase() || *c == '_')
                .collect::<String>()
        }));
    }
    modules
}

#[test]
fn imports_go_one_way() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    rust_files(&src, &mut files);
    let mut violations = Vec::new();
    let mut imports = 0;
    for file in &files {
        let relative = file.strip_prefix(&src).unwrap();
        let first = relative
            .components()
            .next()
            .unwrap()
            .as_os_str()
            .to_string_lossy();
        let own = first.trim_end_matches(".rs");
        if own == "lib" || own == "main" {
            continue;
        }
        let own_rank =
            rank(own).unwrap_or_else(|| panic!("module {own} has no place in the order"));
        for module in named_modules(&fs::read_to_string(file).unwrap()) {
            let Some(imported_rank) = rank(&module) else {
                continue;
            };
            imports += 1;
            if imported_rank > own_rank || (imported_rank == own_rank && module != own) {
                violations.push(format!("{} names crate::{module}", relative.display()));
            }
        }
    }
    assert!(
        imports > 50,
        "only {imports} imports were found: the test reads the sources wrongly"
    );
    assert!(violations.is_empty(), "{}", violations.join("\n"));
}

#[test]
fn the_reader_of_imports_finds_what_is_there() {
    let source = "use crate::math::Aabb;\nuse crate::{cloud::Frame, octree};\n/// See [`crate::scene::Camera`].";
    assert_eq!(named_modules(source), ["math", "cloud", "octree", "scene"]);
}

#[test]
fn files_stay_readable() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut files = Vec::new();
    rust_files(&root.join("src"), &mut files);
    let long: Vec<String> = files
        .iter()
        .map(|file| (file, fs::read_to_string(file).unwrap().lines().count()))
        .filter(|(_, lines)| *lines > 600)
        .map(|(file, lines)| format!("{} has {lines} lines", file.display()))
        .collect();
    assert!(
        long.is_empty(),
        "split before 600 lines: {}",
        long.join(", ")
    );
}
