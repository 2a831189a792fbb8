//! Every shader permutation, validated and written for every back end without a GPU; and every layout that Rust and
//! WGSL share, by reflection.

mod back_ends;
mod languages;

use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use pointreel::render::gpu::gpu_data::{
    DepthImaging, Filtering, Gathering, LampUniform, NodeBounds, PointRecord, Screening, ShapeRecord, SplatVertex,
    StereoMatching, TexturePlace, TriangleRecord, VertexRecord, ViewUniform,
};
use pointreel::render::gpu::shaders::Permutation;
use std::collections::BTreeSet;
use std::mem::offset_of;

fn parse(permutation: Permutation) -> Result<(naga::Module, ModuleInfo), String> {
    parse_with(permutation, false)
}

/// For adapters that leave out fragments before they are drawn, or not.
fn parse_with(permutation: Permutation, tests_depths_early: bool) -> Result<(naga::Module, ModuleInfo), String> {
    let source = permutation.source(tests_depths_early);
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

/// Numbers that Rust knows too are written before the files of a shader. What the files themselves call a constant is
/// known to one of them alone, so there is nothing that it could differ from.
#[test]
fn files_of_shaders_have_no_constants_of_their_own() {
    let permutations = Permutation::all().into_iter();
    let found: BTreeSet<String> = permutations
        .flat_map(|permutation| {
            let source = permutation.source(false);
            let (_, files) = source.split_once("\n//").unwrap();
            let lines = files.lines().filter(|line| line.starts_with("const "));
            lines.map(str::to_owned).collect::<Vec<_>>()
        })
        .collect();
    assert_eq!(found, BTreeSet::new());
}

#[test]
fn files_of_shaders_call_bind_groups_by_the_names_that_rust_gives_them() {
    let groups = Permutation::all().into_iter().flat_map(|permutation| {
        let source = permutation.source(false);
        let groups = source.split("@group(").skip(1);
        groups
            .map(|group| group.split(')').next().unwrap().to_owned())
            .collect::<Vec<_>>()
    });
    let groups: BTreeSet<String> = groups.collect();
    assert!(groups.contains("VIEW_GROUP"), "{groups:?}");
    assert!(groups.iter().all(|group| group.ends_with("_GROUP")), "{groups:?}");
}

/// Offsets of the members of a WGSL struct by name, and its size.
fn wgsl_layout(name: &str) -> (Vec<(String, u32)>, u32) {
    // The compute stage of surfels has all but those of meshes.
    let has_them = |permutation: &Permutation| match permutation {
        Permutation::Amplify(amplification) => amplification.reads_shapes,
        Permutation::Geometry(_, amplification, _) => amplification.is_indexed,
        Permutation::Gather
        | Permutation::Filter
        | Permutation::Visible
        | Permutation::DepthImages
        | Permutation::Stereo => true,
        Permutation::Screen(_) => false,
    };
    let permutations = Permutation::all().into_iter().filter(has_them);
    let modules: Vec<naga::Module> = permutations.map(|permutation| parse(permutation).unwrap().0).collect();
    modules
        .iter()
        .flat_map(|module| module.types.iter())
        .find_map(|(_, ty)| match &ty.inner {
            naga::TypeInner::Struct { members, span } if ty.name.as_deref() == Some(name) => Some((
                members
                    .iter()
                    .map(|member| (member.name.clone().unwrap(), member.offset))
                    .collect(),
                *span,
            )),
            _ => None,
        })
        .unwrap_or_else(|| panic!("no WGSL struct {name}"))
}

macro_rules! assert_layout {
    ($rust:ty, $wgsl:literal, $($field:ident),+) => {
        let expected = vec![$((stringify!($field).to_owned(), offset_of!($rust, $field) as u32)),+];
        assert_eq!(wgsl_layout($wgsl), (expected, size_of::<$rust>() as u32), "{}", $wgsl);
    };
}

#[test]
fn rust_and_wgsl_agree_on_the_layouts_of_records_and_passes() {
    assert_layout!(PointRecord, "PointRecord", position, color);
    assert_layout!(ShapeRecord, "ShapeRecord", normal, radius, ellipse, scalar);
    assert_layout!(TriangleRecord, "TriangleRecord", corners, normal);
    assert_layout!(
        VertexRecord,
        "VertexRecord",
        position,
        color,
        texture_place,
        normal,
        texture
    );
    assert_layout!(TexturePlace, "TexturePlace", first, width, height, unused);
    assert_layout!(Gathering, "Gathering", first, count, step, radius_factor);
    assert_layout!(
        Filtering,
        "Filtering",
        first,
        count,
        inner_candidates,
        inners,
        eye,
        marks,
        area_px2,
        small_px2,
        rough_area_px2,
        rough_small_px2,
        is_oriented,
        culls_back_faces,
        deepest_level,
        unused_a,
        unused_b,
        unused_c,
        planes
    );
    assert_layout!(
        NodeBounds,
        "NodeBounds",
        center,
        sphere_radius,
        axis,
        cone_cosine,
        radius,
        level,
        parent,
        unused
    );
    assert_layout!(
        Screening,
        "Screening",
        rotation_x,
        near,
        rotation_y,
        radius,
        rotation_z,
        spacing,
        eye_high,
        closing,
        eye_low,
        has_sensor,
        sensor,
        point_count,
        px_per_slope,
        middle_px,
        size_px,
        first,
        count,
        level,
        has_holes,
        unused_a,
        unused_b
    );
    assert_layout!(
        DepthImaging,
        "DepthImaging",
        size_px,
        near_m,
        far_m,
        origin,
        is_coded,
        exponent_per_px2,
        sigma_m,
        noise_factor,
        flying_m,
        flying_share,
        least_neighbours,
        newest_share,
        same_m,
        fill_frames,
        has_colors,
        one_color,
        unused
    );
    assert_layout!(
        StereoMatching,
        "StereoMatching",
        size_px,
        count,
        min_px,
        path_step,
        is_first_path,
        radius_px,
        p1,
        p2_least,
        p2_above_least,
        half_change,
        unique_percent,
        by_parabola
    );
}

#[test]
fn rust_and_wgsl_agree_on_the_layout_of_a_view() {
    assert_layout!(LampUniform, "Lamp", place, color);
    assert_layout!(SplatVertex, "SplatVertex", clip, color, normal, light, weight);
    assert_layout!(
        ViewUniform,
        "View",
        rotation_x,
        rotation_y,
        rotation_z,
        eye_high,
        splat_scale,
        eye_low,
        near,
        focal,
        viewport_px,
        background_top,
        opaque_weight,
        background_bottom,
        rim_px,
        depth_range,
        point_least_px,
        cube_half_edge,
        depth_slack,
        lighting,
        back_faces,
        ground_spacing,
        center_ndc,
        eye_dome_reach_px,
        eye_dome,
        ground_normal,
        ground_right,
        ground_forward,
        ground_color,
        ambient,
        head_light,
        specular,
        usual_distance,
        depth_slack_px,
        filter_radius_px,
        kernel,
        samples_per_edge,
        occlusion_near_radius_px,
        occlusion_most_radius_px,
        occlusion_strength,
        shadow_texel,
        px_per_slope,
        point_edge,
        point_edge_per_radius,
        lamps,
        lamp_from_view_x,
        lamp_from_view_y,
        lamp_from_view_z,
        shadow_focal,
        shadow_near,
        metallic,
        alpha,
        mean_loss,
        mean_let_in,
        environment_light,
        clamp_radius_px,
        environment_from_view_x,
        environment_from_view_y,
        environment_from_view_z,
        harmonics
    );
}
