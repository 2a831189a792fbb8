//! The reader itself, on sources whose imports are known.

use super::knots::{self, Imports};
use super::sources::{Mention, Place, Sources};

/// The crate of these files, the first of which is `lib.rs`.
fn read(files: &[(&str, &str)]) -> Sources {
    Sources::read(&|file| {
        let (_, text) = files.iter().find(|(name, _)| *name == file)?;
        Some((*text).to_string())
    })
}

/// The names from the root in the module `a::b`, if `text` is its whole file.
fn named(text: &str) -> Vec<String> {
    let sources = read(&[("lib.rs", "mod a;"), ("a/mod.rs", "mod b;"), ("a/b.rs", text)]);
    let module = ["a".to_string(), "b".to_string()];
    let mut named: Vec<String> = sources.modules[module.as_slice()]
        .mentions
        .iter()
        .filter_map(|mention| Some(mention.absolute(&module)?.join("::")))
        .filter(|path| !path.is_empty())
        .collect();
    named.sort();
    named
}

fn imports(files: &[(&str, &str)]) -> Vec<String> {
    knots::imports(&read(files))
        .iter()
        .flat_map(|(from, imported)| imported.keys().map(move |to| format!("{from} → {to}")))
        .collect()
}

#[test]
fn nested_braces_are_read_to_their_end() {
    assert_eq!(
        named("use crate::{cloud::Frame, math::{Aabb, morton::{code, order}}, app::State};"),
        [
            "app::State",
            "cloud::Frame",
            "math::Aabb",
            "math::morton::code",
            "math::morton::order"
        ]
    );
}

#[test]
fn use_trees_may_span_lines_with_globs_self_and_renames() {
    let text = "
        pub(crate) use crate::{
            cloud::{self, Frame as Cloud}, // a comment, with a brace }
            math::*,
            io::read as _,
        };";
    assert_eq!(named(text), ["cloud", "cloud::Frame", "io::read", "math"], "{text}");
}

#[test]
fn a_renamed_import_is_known_by_its_new_name() {
    let sources = read(&[(
        "lib.rs",
        "use x::{y::{self as z}, Frame as Cloud, w}; pub use v; pub(super) use u; use t::*;",
    )]);
    let uses: Vec<(String, Option<&str>, bool)> = sources.modules[[].as_slice()]
        .mentions
        .iter()
        .filter_map(|mention| match &mention.place {
            Place::Use { name, is_export } => Some((mention.path.join("::"), name.as_deref(), *is_export)),
            Place::Code | Place::Comment => None,
        })
        .collect();
    assert_eq!(
        uses,
        [
            ("t".into(), None, false),
            ("u".into(), Some("u"), true),
            ("v".into(), Some("v"), true),
            ("x::Frame".into(), Some("Cloud"), false),
            ("x::w".into(), Some("w"), false),
            ("x::y".into(), Some("z"), false),
        ]
    );
}

#[test]
fn paths_are_found_in_expressions_types_and_macros() {
    let text = r#"
        fn f<'a>(cloud: &'a crate::cloud::Frame) -> impl Fn(crate::math::Aabb) + use<'a> {
            let sum = 2.0 * crate::math::PI as f32;
            println!("{}", crate::io::read::<u8>(&[crate::octree::Octree::new()]));
            <Frame as crate::scene::Seen>::seen(sum)
        }"#;
    assert_eq!(
        named(text),
        [
            "cloud::Frame",
            "io::read",
            "math::Aabb",
            "math::PI",
            "octree::Octree::new",
            "scene::Seen"
        ]
    );
}

#[test]
fn comments_link_to_modules_as_code_does() {
    let text = "
        //! See [`crate::scene::Camera`] and [what](super::c::d) isn't `crate`.
        // Plain ones as well: crate::render::Renderer.
        //! ```
        //! use pointreel::{io::{read, write}, cloud};
        //! ```";
    assert_eq!(
        named(text),
        [
            "a::c::d",
            "cloud",
            "io::read",
            "io::write",
            "render::Renderer",
            "scene::Camera"
        ]
    );
}

#[test]
fn paths_in_strings_are_ignored() {
    let text = "const TEXT: &str = \"use crate::app;\"; const RAW: &str = r#\"\"crate::cli\"#;";
    assert_eq!(named(text), [""; 0]);
}

#[test]
fn super_is_the_parent_module_and_in_inline_modules_the_file_itself() {
    let text = "
        use super::c;
        use super::super::d::D;
        use self::below::E;
        mod below { use super::f; use super::super::g; }";
    assert_eq!(named(text), ["a::b::below::E", "a::c", "d::D"]);
    let sources = read(&[("lib.rs", "mod a { mod b { use super::super::c; } }")]);
    let (path, module) = sources.modules.last_key_value().unwrap();
    assert_eq!((path.join("::"), &*module.file), ("a::b".into(), "lib.rs"));
    let mention: &Mention = module.mentions.first().unwrap();
    assert_eq!(mention.absolute(path).unwrap(), ["c"]);
}

#[test]
fn tests_are_found_by_their_attribute_wherever_their_file_is() {
    let sources = read(&[
        ("lib.rs", "mod a;"),
        (
            "a.rs",
            "#[cfg(test)] #[path = \"a_tests.rs\"] mod tests; #[cfg(all(test, unix))] mod more { use b::c; } mod d;",
        ),
        ("a_tests.rs", "mod cases;"),
        ("cases.rs", ""),
        ("a/d.rs", ""),
    ]);
    let tests: Vec<(&str, bool)> = sources
        .modules
        .values()
        .map(|module| (module.file.as_str(), module.is_test))
        .collect();
    assert_eq!(
        tests,
        [
            ("lib.rs", false),
            ("a.rs", false),
            ("a/d.rs", false),
            ("a.rs", true),
            ("a_tests.rs", true),
            ("cases.rs", true)
        ]
    );
}

#[test]
fn re_exports_of_a_parent_count_for_the_defining_sibling() {
    let files = [
        ("lib.rs", "mod a;"),
        ("a/mod.rs", "mod b; mod c; mod d; pub use b::{B, deeper::*}; use d::d;"),
        ("a/b/mod.rs", "pub mod deeper; pub struct B;"),
        ("a/b/deeper.rs", "pub struct Deep;"),
        (
            "a/c.rs",
            "use super::B; fn c(deep: super::Deep) { super::d(); crate::a::d::other() }",
        ),
        ("a/d.rs", "pub fn d() {} pub fn other() {}"),
    ];
    assert_eq!(
        imports(&files),
        [
            "a/c.rs → a/b/deeper.rs",
            "a/c.rs → a/b/mod.rs",
            "a/c.rs → a/d.rs",
            "a/mod.rs → a/d.rs"
        ],
        "the parent imports what it does not export alone"
    );
}

#[test]
fn items_made_by_a_macro_are_where_their_path_leads() {
    let of = |text| {
        imports(&[
            ("lib.rs", "mod a; mod b;"),
            ("a.rs", "make! { A } use glam::Vec3;"),
            ("b.rs", text),
        ])
    };
    assert_eq!(of("use crate::a::A; use glam::DVec3;"), ["b.rs → a.rs"]);
    assert_eq!(of("use crate::a::Vec3;"), [""; 0]);
}

#[test]
fn a_parent_imports_its_re_exports_where_it_uses_them_itself() {
    let parent = |text| {
        imports(&[
            ("lib.rs", "mod a;"),
            ("a.rs", text),
            ("a/b.rs", "pub struct B; pub fn c() {}"),
        ])
    };
    assert_eq!(parent("mod b; pub use b::B;"), [""; 0]);
    assert_eq!(parent("mod b; pub use b::B; struct A(B);"), ["a.rs → a/b.rs"]);
    assert_eq!(parent("mod b; fn a() { b::c() }"), ["a.rs → a/b.rs"]);
    assert_eq!(parent("mod b; fn a(b: u8, x: X) { x.b; x.c() }"), [""; 0]);
}

#[test]
fn tests_and_comments_do_not_count_for_import_cycles() {
    let files = [
        ("lib.rs", "mod a; mod b;"),
        (
            "a.rs",
            "//! [`crate::b::B`]\n #[cfg(test)] use crate::b::B; #[cfg(test)] mod tests { use crate::b::B; }",
        ),
        ("b.rs", "pub struct B;"),
    ];
    assert_eq!(imports(&files), [""; 0]);
}

/// Five files: `a` to `c` import each other in a circle, `d` imports them, `e` is alone.
fn circle() -> Imports {
    knots::imports(&read(&[
        ("lib.rs", "mod a; mod b; mod c; mod d; mod e;"),
        ("a.rs", "use crate::b::B; pub struct A;"),
        ("b.rs", "use crate::c::C; pub struct B;"),
        ("c.rs", "use crate::a::A; pub struct C;"),
        ("d.rs", "use crate::a::A; pub struct D;"),
        ("e.rs", ""),
    ]))
}

#[test]
fn an_import_cycle_is_the_files_reachable_from_each_other() {
    let knots: Vec<Vec<String>> = knots::knots(&circle()).into_iter().map(Vec::from_iter).collect();
    assert_eq!(knots, [["a.rs", "b.rs", "c.rs"]]);
    assert_eq!(
        knots::circle(&circle(), "b.rs"),
        "  b.rs imports c.rs: crate::c::C\n  c.rs imports a.rs: crate::a::A\n  a.rs imports b.rs: crate::b::B"
    );
}

#[test]
fn the_list_of_cycles_shows_added_and_removed_imports() {
    let wrong = |known: &[&[&str]]| knots::differences(&circle(), known);
    assert_eq!(wrong(&[&["a.rs", "b.rs", "c.rs"]]), [""; 0]);
    assert_eq!(wrong(&[]).len(), 3, "a new knot");
    let grown = wrong(&[&["a.rs", "b.rs"]]);
    assert!(
        grown[0].starts_with("c.rs is tied into a knot of 3 files by\n  c.rs imports a.rs: crate::a::A"),
        "{grown:?}"
    );
    assert_eq!(
        wrong(&[&["a.rs", "b.rs", "c.rs", "d.rs"]]),
        ["d.rs is tied no longer: take it off the list"]
    );
    assert_eq!(
        wrong(&[&["a.rs", "b.rs", "c.rs"], &["d.rs", "e.rs"]]),
        [
            "d.rs is tied no longer: take it off the list",
            "e.rs is tied no longer: take it off the list"
        ]
    );
}

#[test]
fn a_cycle_that_has_split_is_two_in_the_list() {
    let imports = knots::imports(&read(&[
        ("lib.rs", "mod a; mod b; mod c; mod d;"),
        ("a.rs", "use crate::b::B; pub struct A;"),
        ("b.rs", "use crate::a::A; use crate::c::C; pub struct B;"),
        ("c.rs", "use crate::d::D; pub struct C;"),
        ("d.rs", "use crate::c::C; pub struct D;"),
    ]));
    assert_eq!(
        knots::differences(&imports, &[&["a.rs", "b.rs", "c.rs", "d.rs"]]),
        ["the knot of a.rs is 2 knots now: take it apart in the list"]
    );
    assert_eq!(
        knots::differences(&imports, &[&["a.rs", "b.rs"], &["c.rs", "d.rs"]]),
        [""; 0]
    );
}

#[test]
fn a_replacement_for_a_module_is_read_by_its_own_name() {
    let sources = read(&[
        (
            "lib.rs",
            "#[cfg_attr(not(feature = \"gpu\"), path = \"no_gpu.rs\")]
            mod gpu;
            #[cfg_attr(unix, derive(Debug))]
            struct A;",
        ),
        ("gpu.rs", "use crate::cloud;"),
        ("no_gpu.rs", "use crate::app;"),
    ]);
    let files: Vec<_> = sources
        .modules
        .iter()
        .map(|(path, module)| (path.join("::"), &*module.file))
        .collect();
    assert_eq!(
        files,
        [
            (String::new(), "lib.rs"),
            ("gpu".into(), "gpu.rs"),
            ("no_gpu".into(), "no_gpu.rs")
        ]
    );
}
