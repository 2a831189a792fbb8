//! Imports go one way; exceptions are listed, and the lists may only shrink.
//!
//! - A module of the root never names one to its right; see the table in `src/lib.rs`. Comments and
//!   tests count as well.
//! - A part of a module (a folder) imports only those before it, where the list `PARTS` has the module.
//! - `wgpu` and `egui` are named only where a list allows it, and a build without their features has neither.
//! - Files that import one another are a *knot*. A name counts for the file that defines it, whatever re-exports it is
//!   reached through; so a parent that only declares or re-exports a child does not import it, and a child that uses a
//!   re-export of its parent imports the sibling. Comments, tests, and items reached without being named (methods and
//!   fields) do not count.
//! - A feature of the window is imported by files of its folder and by the table of features; other files that do are
//!   listed.
//! - Words that `docs/glossary.md` replaces are counted; their numbers may only shrink.
//! - No function takes several arguments as a tuple, but for those of a list.
//! - Files have at most 600 lines of at most 120 columns.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

#[path = "architecture/features.rs"]
mod features;
#[path = "architecture/knots.rs"]
mod knots;
#[path = "architecture/known.rs"]
mod known;
#[path = "architecture/parameters.rs"]
mod parameters;
#[path = "architecture/reader.rs"]
mod reader;
#[path = "architecture/sources.rs"]
mod sources;
#[path = "architecture/words.rs"]
mod words;

use known::{FEATURES_NAMED_ELSEWHERE, KNOTS, TUPLES_IN_PARAMETERS};
use sources::Sources;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

/// Modules that may import those of earlier rows, and nothing of each other within a row that holds whole programs.
const ORDER: &[&[&str]] = &[
    &["printable", "regular_file", "temporary"],
    &[
        "binary",
        "assumption",
        "deadlines",
        "math",
        "memory",
        "persist",
        "locks",
        "messages",
        "natural",
        "spelling",
        "priority",
        "progress",
        "signals",
        "stopwatch",
    ],
    &["waiting", "raster"],
    &["cloud"],
    &["rgbd"],
    &["photos", "wire"],
    &["stereo"],
    &["io", "analysis"],
    &["measure"],
    &["levels"],
    &["reel"],
    &["source"],
    &["timeline"],
    &["sequence"],
    &["scene"],
    &["composition"],
    &["document"],
    &["playback"],
    &["render"],
    &["headless"],
    &["export", "bench", "check", "convert", "serve", "fuzzing"],
    &["app"],
    &["cli"],
];

/// Parts of modules, which are folders: they may import those of earlier rows, as their headers say. Only the parts
/// listed here are checked; files of a module that are in none of its parts may import all of them.
const PARTS: &[(&str, &[&[&str]])] = &[
    ("photos", &[&["parts"], &["sets"], &["found"], &["images", "readers"]]),
    ("stereo", &[&["matching"], &["views"], &["dense"]]),
    ("analysis", &[&["search"], &["surface"], &["screen", "color"]]),
    (
        "io",
        &[
            &["files"],
            &["columns"],
            &["meshes"],
            &["formats", "refused"],
            &["recordings"],
        ],
    ),
    (
        "scene",
        &[
            &["environment"],
            &["style"],
            &["view"],
            &["light", "effects", "visible"],
            &["annotations", "photos"],
        ],
    ),
    ("cli", &[&["terminal"], &["options"], &["info_parts"], &["commands"]]),
];

/// Files and folders that may name `wgpu`. This list may shrink, never grow.
const MAY_NAME_WGPU: &[(&str, &str)] = &[
    ("render/gpu/", "the renderer of graphics cards"),
    (
        "app/present/surface.rs",
        "the surface of the window is none of the renderer's",
    ),
    (
        "app/present/gpu.rs",
        "panels and picture are painted in one pass on that surface",
    ),
    (
        "app/present/gpu_picture.rs",
        "the picture that the renderer has drawn is shown as a texture",
    ),
    (
        "app/present/software.rs",
        "the picture that the processor has drawn is uploaded",
    ),
];

/// Files and folders in which settings are decided: below the window, they alone may name an open choice.
const MAY_LEAVE_OPEN: &[&str] = &["scene/style/", "scene/first_look/"];

/// Modules that draw, and that make packets.
const DRAWS: &[&str] = &["scene/", "playback/", "render/", "headless", "export/"];

/// Files and folders that may name `egui` or one of its companions.
const MAY_NAME_EGUI: &[(&str, &str)] = &[("app/", "panels, and the window that they are in")];

fn src() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("src")
}

/// Read once for all tests.
static SOURCES: LazyLock<Sources> = LazyLock::new(|| Sources::read(&|file| fs::read_to_string(src().join(file)).ok()));

static IMPORTS: LazyLock<knots::Imports> = LazyLock::new(|| knots::imports(&SOURCES));

/// By their names below `src`.
fn rust_files() -> BTreeMap<String, String> {
    let mut files = BTreeMap::new();
    let mut folders = vec![src()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                let names: Vec<_> = path
                    .strip_prefix(src())
                    .unwrap()
                    .iter()
                    .map(|name| name.to_str().unwrap())
                    .collect();
                files.insert(names.join("/"), fs::read_to_string(&path).unwrap());
            }
        }
    }
    files
}

fn row(room: &str) -> Option<usize> {
    ORDER.iter().position(|row| row.contains(&room))
}

#[test]
fn every_file_is_read() {
    let sources = &*SOURCES;
    let read: BTreeSet<&str> = sources.modules.values().map(|module| module.file.as_str()).collect();
    let unread: Vec<String> = rust_files()
        .into_keys()
        .filter(|file| file != "main.rs" && !read.contains(file.as_str()))
        .collect();
    assert!(unread.is_empty(), "no module declares {}", unread.join(", "));
}

#[test]
fn imports_go_one_way() {
    let mut violations = BTreeSet::new();
    let mut imports = 0;
    for (path, module) in &SOURCES.modules {
        let Some(own) = path.first() else { continue };
        let own_row = row(own).unwrap_or_else(|| panic!("room {own} has no place in the order"));
        for mention in &module.mentions {
            let Some(named) = mention.absolute(path) else {
                continue;
            };
            let Some((room, named_row)) = named.first().and_then(|room| Some((room, row(room)?))) else {
                continue;
            };
            imports += 1;
            if named_row > own_row || (named_row == own_row && room != own) {
                violations.insert(format!("{} names {}", module.file, mention.path.join("::")));
            }
        }
    }
    assert!(
        imports > 1000,
        "only {imports} imports were found: the test reads the sources wrongly"
    );
    let violations = Vec::from_iter(violations);
    assert!(violations.is_empty(), "{}", violations.join("\n"));
}

/// Holds a list of files and folders against those that name a crate.
fn assert_named_only_in(allowed: &[(&str, &str)], is_the_crate: impl Fn(&str) -> bool) {
    let sources = &*SOURCES;
    let naming: BTreeSet<&str> = sources
        .modules
        .values()
        .filter(|module| module.names_in_code().any(&is_the_crate))
        .map(|module| module.file.as_str())
        .collect();
    let is_in = |file: &str, place: &str| file == place || (place.ends_with('/') && file.starts_with(place));
    let elsewhere = naming
        .iter()
        .filter(|file| !allowed.iter().any(|(place, _)| is_in(file, place)))
        .map(|file| format!("{file} names what only these may: {allowed:#?}"));
    let unused = allowed
        .iter()
        .filter(|(place, _)| !naming.iter().any(|file| is_in(file, place)))
        .map(|(place, _)| format!("{place} names it no longer: take it off the list"));
    let wrong: Vec<String> = elsewhere.chain(unused).collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn wgpu_is_only_named_by_the_renderer_and_the_window_graphics() {
    assert_named_only_in(MAY_NAME_WGPU, |name| name == "wgpu");
}

#[test]
fn drawing_code_does_not_name_automatic_choices() {
    let is_in = |file: &str, places: &[&str]| places.iter().any(|place| file.starts_with(place));
    let files = rust_files();
    let drawing: Vec<_> = files
        .iter()
        .filter(|(file, _)| is_in(file, DRAWS) && !is_in(file, MAY_LEAVE_OPEN))
        .collect();
    assert!(drawing.len() > 100, "{}", drawing.len());
    let naming: Vec<_> = drawing
        .iter()
        .filter(|(_, text)| text.contains("::Auto"))
        .map(|(file, _)| file)
        .collect();
    assert!(naming.is_empty(), "a style leaves nothing open: {naming:?}");
}

#[test]
fn egui_is_only_named_by_the_window() {
    assert_named_only_in(MAY_NAME_EGUI, |name| name == "egui" || name.starts_with("egui_"));
}

#[test]
fn parts_of_a_module_only_import_earlier_parts() {
    let imports = &*IMPORTS;
    let mut wrong = BTreeSet::new();
    for (room, rows) in PARTS {
        let part_of = |file: &str| -> Option<(usize, String)> {
            let (part, _) = file.strip_prefix(room)?.strip_prefix('/')?.split_once('/')?;
            let row = rows.iter().position(|row| row.contains(&part))?;
            Some((row, part.to_owned()))
        };
        let mut files = 0;
        for (file, imported) in imports {
            let Some((own_row, own)) = part_of(file) else { continue };
            files += 1;
            for (other, path) in imported {
                if part_of(other).is_some_and(|(row, part)| part != own && row >= own_row) {
                    wrong.insert(format!("{file} imports {other} by {path}"));
                }
            }
        }
        assert!(files > 5, "only {files} files of parts of {room} were found");
        let missing: Vec<_> = rows
            .iter()
            .copied()
            .flatten()
            .filter(|part| !src().join(room).join(part).is_dir())
            .collect();
        assert!(missing.is_empty(), "{room} has no {missing:?}");
    }
    assert!(wrong.is_empty(), "{}", Vec::from_iter(wrong).join("\n"));
}

#[test]
#[expect(clippy::print_stdout, reason = "sizes are asked for with --nocapture")]
fn no_import_cycle_grows() {
    let imports = &*IMPORTS;
    let mut sizes: BTreeMap<String, Vec<usize>> = BTreeMap::new();
    for knot in knots::knots(imports) {
        let room = knot.first().unwrap().split(['/', '.']).next().unwrap();
        sizes.entry(room.into()).or_default().push(knot.len());
    }
    println!("Files that import one another, a number for each knot:");
    for (room, sizes) in sizes {
        println!("{room:10} {sizes:?}");
    }
    let wrong = knots::differences(imports, KNOTS);
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// The features that `file` imports beyond its own, but for the table of features and what `app` offers to others.
fn foreign_features(imports: &knots::Imports) -> BTreeMap<&str, BTreeSet<&str>> {
    let feature_of = |file: &str| -> Option<String> {
        let (feature, _) = file.strip_prefix("app/features/")?.split_once('/')?;
        Some(feature.to_owned())
    };
    let mut foreign: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    let may = ["app/features/table.rs", "app/mod.rs"];
    for (file, imported) in imports.iter().filter(|(file, _)| !may.contains(&file.as_str())) {
        let own = feature_of(file);
        for other in imported.keys().filter(|other| feature_of(other) != own) {
            if let Some((feature, _)) = other
                .strip_prefix("app/features/")
                .and_then(|name| name.split_once('/'))
            {
                foreign.entry(file).or_default().insert(feature);
            }
        }
    }
    foreign
}

#[test]
fn features_are_only_named_in_their_folder_and_the_table() {
    let imports = &*IMPORTS;
    let foreign = foreign_features(imports);
    let known: BTreeMap<&str, BTreeSet<&str>> = FEATURES_NAMED_ELSEWHERE
        .iter()
        .map(|(file, features)| (*file, features.iter().copied().collect()))
        .collect();
    let wrong: Vec<String> = foreign
        .iter()
        .filter(|(file, features)| known.get(*file) != Some(*features))
        .map(|(file, features)| format!("{file:?}, &{features:?}: the list has {:?}", known.get(file)))
        .chain(
            known
                .keys()
                .filter(|file| !foreign.contains_key(*file))
                .map(|file| format!("{file} names no feature of others any more: take it off the list")),
        )
        .collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Rust files that are not tests.
fn spoken_files() -> BTreeMap<String, String> {
    let sources = &*SOURCES;
    let (mut tests, mut others) = (BTreeSet::new(), BTreeSet::new());
    for module in sources.modules.values() {
        let files = if module.is_test { &mut tests } else { &mut others };
        files.insert(module.file.clone());
    }
    let mut files = rust_files();
    files.retain(|file, _| others.contains(file) || !tests.contains(file));
    files
}

/// Counts of the words that `docs/glossary.md` replaces, as `words.tsv` has them. They may shrink, never grow: with
/// `POINTREEL_UPDATE_WORDS` set, smaller ones are written.
#[test]
fn uses_of_words_replaced_by_the_glossary_only_decrease() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let stored = root.join("tests/architecture/words.tsv");
    let glossary = words::Glossary::read(&fs::read_to_string(root.join("docs/glossary.md")).unwrap());
    assert!(glossary.number_of_rows() > 40, "the glossary is read wrongly");
    let mut found = glossary.empty_tally();
    for text in spoken_files().into_values() {
        glossary.count_rust(text.parse().unwrap(), &mut found);
    }
    for page in files_with(&["md"]) {
        if !page.ends_with("glossary.md") {
            glossary.count_page(&fs::read_to_string(page).unwrap(), &mut found);
        }
    }
    let known = words::read_tally(&fs::read_to_string(&stored).unwrap_or_default());
    let grown: Vec<String> = found
        .iter()
        .filter(|(key, counts)| known.get(*key).is_none_or(|known| !counts.is_within(known)))
        .map(|(key, counts)| format!("{key}: {counts:?}, before {:?}", known.get(key)))
        .collect();
    let updates = std::env::var_os("POINTREEL_UPDATE_WORDS").is_some();
    if updates && (grown.is_empty() || known.is_empty()) {
        fs::write(&stored, words::written(&found)).unwrap();
        return;
    }
    assert!(
        grown.is_empty(),
        "write the words of docs/glossary.md:\n{}",
        grown.join("\n")
    );
    assert!(
        known == found,
        "words have gone: run this test with POINTREEL_UPDATE_WORDS=1 and commit tests/architecture/words.tsv"
    );
}

#[test]
fn arguments_have_names() {
    let mut counts: BTreeMap<String, usize> = BTreeMap::new();
    for (file, text) in rust_files() {
        for (name, _) in parameters::tuples(&text) {
            *counts.entry(format!("{file}: {name}")).or_default() += 1;
        }
    }
    let known: BTreeMap<String, usize> = TUPLES_IN_PARAMETERS
        .iter()
        .map(|(function, count)| ((*function).to_owned(), *count))
        .collect();
    let functions: BTreeSet<&String> = counts.keys().chain(known.keys()).collect();
    let wrong: Vec<String> = functions
        .into_iter()
        .filter(|function| counts.get(*function) != known.get(*function))
        .map(|function| {
            format!(
                "{function} has {:?} parameters that are tuples: give their parts names. The list has {:?}",
                counts.get(function),
                known.get(function)
            )
        })
        .collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn files_stay_readable() {
    let long: Vec<String> = rust_files()
        .iter()
        .map(|(file, text)| (file, text.lines().count()))
        .filter(|(_, lines)| *lines > 600)
        .map(|(file, lines)| format!("{file} has {lines} lines"))
        .collect();
    assert!(long.is_empty(), "split before 600 lines: {}", long.join(", "));
}

/// Maximum width of text that people read side by side: sources, shaders, documents.
const MAX_COLUMNS: usize = 120;

/// Files of the repository by their extensions, without build outputs and hidden files.
fn files_with(extensions: &[&str]) -> Vec<PathBuf> {
    let mut files = Vec::new();
    let mut folders = vec![PathBuf::from(env!("CARGO_MANIFEST_DIR"))];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let name = path.file_name().unwrap().to_string_lossy();
            if name.starts_with('.') || name == "target" || path.is_symlink() {
                continue;
            }
            let extension = path.extension().and_then(|extension| extension.to_str());
            if path.is_dir() {
                folders.push(path);
            } else if extension.is_some_and(|extension| extensions.contains(&extension)) {
                files.push(path);
            }
        }
    }
    files
}

/// Rows of tables cannot be broken, neither in documents nor in comments.
fn is_row_of_table(line: &str) -> bool {
    let text = line.trim_start();
    let text = ["//!", "///", "//"]
        .iter()
        .find_map(|sign| text.strip_prefix(sign))
        .unwrap_or(text);
    text.trim_start().starts_with('|')
}

#[test]
fn no_line_is_wider_than_120_columns() {
    let files = files_with(&["rs", "wgsl", "md"]);
    assert!(files.len() > 500, "only {} files were found", files.len());
    let mut wide = Vec::new();
    for file in files {
        let text = fs::read_to_string(&file).unwrap();
        let is_document = file.extension().is_some_and(|extension| extension == "md");
        let mut is_code = false;
        for (line, number) in text.lines().zip(1..) {
            is_code ^= is_document && line.trim_start().starts_with("```");
            let may_be_wide = is_code || is_row_of_table(line);
            if line.chars().count() > MAX_COLUMNS && !may_be_wide {
                wide.push(format!("{}:{number}", file.display()));
            }
        }
    }
    assert!(wide.is_empty(), "wider than {MAX_COLUMNS} columns: {}", wide.join(", "));
}
