//! Every shader permutation, validated and written for every back end without a GPU; and every layout that Rust and
//! WGSL share, by reflection.

mod back_ends;
mod languages;

use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use pointreel::render::gpu::gpu_data::{
    LAYOUTS, NodeBounds, PointRecord, ShapeRecord, TexturePlace, TriangleRecord, VertexRecord,
};
use pointreel::render::gpu::shaders::{Permutation, uniform_layouts};
use std::collections::{BTreeMap, BTreeSet};
use std::mem::offset_of;
use std::path::{Path, PathBuf};

fn parse(permutation: Permutation) -> Result<(naga::Module, ModuleInfo), String> {
    parse_with(permutation, false)
}

/// For adapters with and without early fragment rejection.
fn parse_with(permutation: Permutation, tests_depths_early: bool) -> Result<(naga::Module, ModuleInfo), String> {
    let source = permutation
        .source(tests_depths_early)
        .map_err(|error| error.to_string())?;
    let capabilities = if tests_depths_early {
        Capabilities::EARLY_DEPTH_TEST
    } else {
        Capabilities::empty()
    };
    let module = naga::front::wgsl::parse_str(&source)
        .map_err(|error| format!("{}: {}", permutation.label(), error.emit_to_string(&source)))?;
    let info = Validator::new(ValidationFlags::all(), capabilities)
        .validate(&module)
        .map_err(|error| format!("{}: {}", permutation.label(), error.emit_to_string(&source)))?;
    Ok((module, info))
}

#[test]
fn every_permutation_validates() {
    let all = Permutation::all();
    assert!(all.len() > 30, "{} permutations", all.len());
    let failures: Vec<String> = all
        .into_iter()
        .filter_map(|permutation| parse(permutation).err())
        .collect();
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// Files of `shaders/` by their paths in it, with their text.
fn shader_files() -> BTreeMap<String, String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("shaders");
    let folders = std::fs::read_dir(&root).unwrap().map(|entry| entry.unwrap().path());
    let files = folders.flat_map(|folder| std::fs::read_dir(folder).unwrap());
    let named = |path: PathBuf| {
        let name = path.strip_prefix(&root).unwrap().to_str().unwrap().replace('\\', "/");
        (name, std::fs::read_to_string(&path).unwrap())
    };
    files.map(|entry| named(entry.unwrap().path())).collect()
}

/// Numbers that Rust has too are generated from Rust. Constants of the files themselves are defined in one file alone,
/// so there is nothing that they could differ from.
#[test]
fn shader_files_define_no_constants() {
    let files = shader_files();
    let lines = files.values().flat_map(|text| text.lines());
    let found: Vec<&str> = lines.filter(|line| line.starts_with("const ")).collect();
    assert_eq!(found, Vec::<&str>::new());
}

#[test]
fn every_shader_file_is_used() {
    let sources = Permutation::all()
        .into_iter()
        .map(|permutation| permutation.source(false).unwrap());
    let used: BTreeSet<String> = sources
        .flat_map(|source| source.lines().map(str::to_owned).collect::<Vec<_>>())
        .filter_map(|line| line.strip_prefix("// ").map(str::to_owned))
        .collect();
    let files = shader_files();
    let unused: Vec<&String> = files.keys().filter(|name| !used.contains(*name)).collect();
    assert!(
        unused.is_empty() && files.len() > 80,
        "{} files, unused: {unused:?}",
        files.len()
    );
}

#[test]
fn shader_files_name_bind_groups_as_rust_does() {
    let groups = Permutation::all().into_iter().flat_map(|permutation| {
        let source = permutation.source(false).unwrap();
        let groups = source.split("@group(").skip(1);
        groups
            .map(|group| group.split(')').next().unwrap().to_owned())
            .collect::<Vec<_>>()
    });
    let groups: BTreeSet<String> = groups.collect();
    assert!(groups.contains("VIEW_GROUP"), "{groups:?}");
    assert!(groups.iter().all(|group| group.ends_with("_GROUP")), "{groups:?}");
}

/// Offsets of the members of a structure by name, and its size.
type MemberOffsets = (Vec<(String, u32)>, u32);

/// The structures of all shaders by their names. Two of one name are the same.
fn wgsl_layouts() -> BTreeMap<String, MemberOffsets> {
    let mut layouts: BTreeMap<String, MemberOffsets> = BTreeMap::new();
    for permutation in Permutation::all() {
        let (module, _) = parse(permutation).unwrap();
        for (_, ty) in module.types.iter() {
            if let (Some(name), naga::TypeInner::Struct { members, span }) = (&ty.name, &ty.inner) {
                let offsets = members
                    .iter()
                    .map(|member| (member.name.clone().unwrap(), member.offset));
                layouts.insert(name.clone(), (offsets.collect(), *span));
            }
        }
    }
    layouts
}

macro_rules! assert_layout {
    ($layouts:ident, $rust:ident, $($field:ident),+) => {
        let name = stringify!($rust);
        let expected = vec![$((stringify!($field).to_owned(), offset_of!($rust, $field) as u32)),+];
        assert_eq!($layouts[name], (expected, size_of::<$rust>() as u32), "{name}");
    };
}

#[test]
fn rust_and_wgsl_agree_on_record_layouts() {
    let layouts = wgsl_layouts();
    assert_layout!(layouts, PointRecord, position, color);
    assert_layout!(layouts, ShapeRecord, normal, radius, ellipse, scalar);
    assert_layout!(layouts, TriangleRecord, corners, normal);
    assert_layout!(layouts, VertexRecord, position, color, texture_place, normal, texture);
    assert_layout!(layouts, TexturePlace, first, width, height, unused);
    assert_layout!(
        layouts,
        NodeBounds,
        center,
        sphere_radius,
        axis,
        cone_cosine,
        radius,
        level,
        parent,
        unused
    );
}

/// WGSL has rules of its own for where members are.
#[test]
fn generated_wgsl_structures_have_the_rust_layout() {
    let layouts = wgsl_layouts();
    let mut names = BTreeSet::new();
    for layout in LAYOUTS.into_iter().chain(uniform_layouts()) {
        let members = layout.members.iter();
        let members = members.map(|member| (member.name.to_owned(), member.offset as u32));
        let expected = (members.collect(), layout.size as u32);
        assert_eq!(layouts[layout.name], expected, "{}", layout.name);
        names.insert(layout.name);
    }
    assert!(names.len() > 14, "{names:?}");
}

#[test]
fn the_view_uniform_has_little_more_than_a_camera() {
    let layouts = wgsl_layouts();
    let (members, _) = &layouts["View"];
    assert!(members.len() <= 25, "{members:?}");
}
