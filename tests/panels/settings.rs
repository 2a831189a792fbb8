//! The settings: every control changes the setting that it names.

use super::{click, options, sequence, window, window_on};
use egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use pointreel::app::{State, StateOptions};
use pointreel::cloud::{Positions, RawCloud, ScalarField};
use pointreel::levels::Lod;
use pointreel::levels::octree::StopCriterion;
use pointreel::scene::{
    BackFaces, Background, EyeDome, Footprint, Lighting, NormalBits, OffsetBits, PointShape, PointSizing, Primitive,
    RendererChoice, Settings, SplatFilter, Splatting, Strategy, UpAxis, VoxelLight,
};
use pointreel::sequence::{ColorSource, FrameEntry, Sequence};
use std::sync::Arc;

/// Opens the list called `list` and chooses `entry`.
pub(super) fn choose(harness: &mut Harness<'_, State>, list: &str, entry: &str) {
    // The panel is longer than the window is tall.
    harness.get_by_role_and_label(Role::ComboBox, list).scroll_to_me();
    harness.run();
    harness.get_by_role_and_label(Role::ComboBox, list).click();
    harness.run();
    harness.get_by_role_and_label(Role::Button, entry).click();
    harness.run();
}

/// Clicks a button, wherever it is in the panel.
pub(super) fn tap(harness: &mut Harness<'_, State>, label: &str) {
    harness.get_by_role_and_label(Role::Button, label).scroll_to_me();
    harness.run();
    click(harness, label);
}

pub(super) fn slide(harness: &mut Harness<'_, State>, label: &str, value: f64) {
    harness
        .get_by_role_and_label(Role::Slider, label)
        .set_value_accesskit(value);
    harness.run();
}

/// Reasons and names from files are longer than the panel is wide.
#[test]
fn long_texts_do_not_widen_the_panel() {
    let before_camera = Sequence::with_decoder(vec![FrameEntry::file("camera.pcd")], |_| {
        let points = (0..10_000).map(|index| {
            let [x, y] = [index % 100, index / 100].map(|place| place as f32 / 50.0 - 1.0);
            [x, y, 2.5 + 0.2 * x]
        });
        let mut raw = RawCloud::from_positions(Positions::F32(points.collect()));
        raw.attributes.scalars = vec![ScalarField {
            name: "scalar of a name as other programs give them, from several words".to_owned(),
            values: (0..10_000).map(|index| index as f32).collect(),
            offset: 0.0,
        }];
        Ok(raw)
    });
    let mut harness = window_on(Arc::new(before_camera), options());
    harness.run();
    let look = harness.state().first_look().unwrap();
    assert!(look.up_why.len() > 50, "{}", look.up_why);
    let panel_width = 1280.0 - harness.state().viewport.rect.right();
    assert!(panel_width < 340.0, "{panel_width}");
}

#[test]
fn meshes_are_offered_where_triangles_exist_and_otherwise_a_reason_is_shown() {
    let square = |faces: &'static [[u32; 3]]| {
        let sequence = Sequence::with_decoder(vec![FrameEntry::file("square.ply")], move |_| {
            let corners = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]];
            let mut raw = RawCloud::from_positions(Positions::F32(corners));
            raw.faces = faces.to_vec();
            Ok(raw)
        });
        let mut harness = window_on(Arc::new(sequence), options());
        harness.run();
        harness
    };
    let mut with_faces = square(&[[0, 1, 2], [2, 1, 3]]);
    click(&mut with_faces, "Mesh");
    assert_eq!(with_faces.state().style.primitive, Primitive::Mesh);
    assert_eq!(with_faces.state().drawn_style().primitive, Primitive::Mesh);

    let mut without = square(&[]);
    let button = without.get_by_role_and_label(Role::Button, "Mesh");
    assert!(button.accesskit_node().is_disabled());
    // It may already be chosen: carried over from the settings of another sequence.
    without.state_mut().style.primitive = Primitive::Mesh.into();
    without.run();
    assert_ne!(without.state().drawn_style().primitive, Primitive::Mesh);
    assert!(without.query_by_label_contains("no triangles").is_some());
}

#[test]
fn every_setting_can_be_changed_and_reset() {
    let mut harness = window();
    choose(&mut harness, "Splatting", "Visibility");
    assert_eq!(harness.state().style.surfels.splatting, Splatting::Visibility);
    assert!(
        harness.query_by_label("Enlargement").is_none(),
        "this mode has no enlargement"
    );
    choose(&mut harness, "Splatting", "Enlarged");
    slide(&mut harness, "Enlargement", 3.0);
    assert_eq!(harness.state().style.surfels.enlargement, 3.0);
    choose(&mut harness, "Renderer", "CPU");
    assert_eq!(harness.state().style.drawing.renderer, RendererChoice::Cpu);
    choose(&mut harness, "Instancing", "Compute");
    assert_eq!(harness.state().style.drawing.strategy, Strategy::Compute);
    slide(&mut harness, "Resolution", 0.5);
    assert_eq!(harness.state().style.drawing.resolution, 0.5);
    slide(&mut harness, "Splat scale", 2.5);
    assert_eq!(harness.state().style.surfels.splat_scale, 2.5);
    choose(&mut harness, "Back faces", "Drawn");
    assert_eq!(harness.state().style.surfels.back_faces, BackFaces::Drawn);
    choose(&mut harness, "Eye-dome lighting", "On");
    assert_eq!(harness.state().style.light.eye_dome, EyeDome::On);
    slide(&mut harness, "Strength", 1.5);
    assert_eq!(harness.state().style.light.eye_dome_strength, 1.5);
    choose(&mut harness, "Lighting", "Per vertex");
    assert_eq!(harness.state().style.light.lighting, Lighting::PerVertex);
    choose(&mut harness, "Colours", "One colour");
    assert_eq!(harness.state().style.colors.source, ColorSource::Uniform);
    choose(&mut harness, "Preset", "White");
    assert_eq!(harness.state().style.backdrop.background, Background::solid([255; 3]));
    choose(&mut harness, "Up axis", "+Z");
    assert_eq!(harness.state().camera.up, UpAxis::Z);
    slide(&mut harness, "Field of view", 60.0);
    assert_eq!(harness.state().camera.fov_deg, 60.0);

    tap(&mut harness, "Voxels");
    assert_eq!(harness.state().style.primitive, Primitive::Voxel);
    choose(&mut harness, "Light on", "Faces");
    assert_eq!(harness.state().style.voxels.light, VoxelLight::Faces);
    choose(&mut harness, "Divide", "By loss");
    assert_eq!(harness.state().style.levels.stop, StopCriterion::PAPER);
    slide(&mut harness, "Detail lost (δ)", 20.0);
    assert_eq!(harness.state().style.levels.stop, StopCriterion::Loss(0.2));
    choose(&mut harness, "Divide", "To a level");
    slide(&mut harness, "Leaf level", 9.0);
    assert_eq!(harness.state().style.levels.stop, StopCriterion::Depth(9));
    choose(&mut harness, "Divide", "By points");
    slide(&mut harness, "Points per leaf", 16.0);
    assert_eq!(harness.state().style.levels.stop, StopCriterion::PointsPerOctant(16));
    choose(&mut harness, "Divide", "By spacing");
    assert_eq!(harness.state().style.levels.stop, StopCriterion::Spacing);
    slide(&mut harness, "Smallest cell (τ)", 8.0);
    assert_eq!(harness.state().style.levels.lod, Lod::ThresholdPx(8.0));
    choose(&mut harness, "Level of detail", "Fixed level");
    slide(&mut harness, "Level", 7.0);
    assert_eq!(harness.state().style.levels.lod, Lod::Level(7));
    choose(&mut harness, "Level of detail", "Budget");
    slide(&mut harness, "Voxels", 2000.0);
    assert_eq!(harness.state().style.levels.lod, Lod::Budget(2000));
    choose(&mut harness, "Level of detail", "Frame time");
    slide(&mut harness, "Time", 20.0);
    assert_eq!(harness.state().style.levels.lod, Lod::FrameTimeMs(20.0));
    tap(&mut harness, "Points");
    slide(&mut harness, "Point size", 4.0);
    assert_eq!(harness.state().style.points.size_px, 4.0);
    choose(&mut harness, "Shape", "Disk");
    assert_eq!(harness.state().style.points.shape, PointShape::Disk);
    choose(&mut harness, "Shape", "Gaussian");
    choose(&mut harness, "Size", "Adaptive");
    assert_eq!(harness.state().style.points.sizing, PointSizing::Adaptive);
    slide(&mut harness, "Point scale", 2.0);
    assert_eq!(harness.state().style.points.scale, 2.0);
    choose(&mut harness, "Light on", "Normals");
    assert!(harness.state().style.decided().lights_points());
    tap(&mut harness, "Surfels");
    assert_eq!(harness.state().style.primitive, Primitive::Surfel);
    // A shorthand for surfels with a filter: nothing else is chosen, and nothing of it remains.
    for (word, primitive, filter) in [
        ("EWA", Primitive::Surfel, SplatFilter::Ewa),
        ("Surfels", Primitive::Surfel, SplatFilter::Off),
        ("EWA", Primitive::Surfel, SplatFilter::Ewa),
        ("Ellipses", Primitive::Ellipse, SplatFilter::Ewa),
        ("Surfels", Primitive::Surfel, SplatFilter::Off),
    ] {
        tap(&mut harness, word);
        let style = harness.state().style;
        assert_eq!(
            (style.primitive, style.surfels.filter),
            (primitive.into(), filter),
            "{word}"
        );
    }

    tap(&mut harness, "Reset to defaults");
    assert_eq!(harness.state().style, Settings::default());
    assert_eq!(harness.state().camera.up, UpAxis::Z);
}

#[test]
fn footprints_are_offered_for_modes_with_a_visibility_pass() {
    let mut harness = window();
    let is_offered = |harness: &Harness<'_, State>| {
        let list = harness.get_by_role_and_label(Role::ComboBox, "Footprint");
        !list.accesskit_node().is_disabled()
    };
    choose(&mut harness, "Renderer", "CPU");
    choose(&mut harness, "Splatting", "Regular");
    assert!(!is_offered(&harness), "this mode lays splats over each other");
    choose(&mut harness, "Splatting", "Two-pass");
    assert!(is_offered(&harness));
    assert!(harness.query_by_label("Offsets").is_none(), "disks are exact");
    choose(&mut harness, "Footprint", "Masks");
    choose(&mut harness, "Normals", "17 bits");
    choose(&mut harness, "Offsets", "None");
    let style = harness.state().style;
    assert_eq!(style.codes.footprint, Footprint::Masks);
    assert_eq!(style.codes.normal_bits, NormalBits::Seventeen);
    assert_eq!(style.codes.offset_bits, OffsetBits::None);
    assert!(style.decided().draws_codes());
    choose(&mut harness, "Renderer", "GPU");
    assert!(is_offered(&harness) && harness.state().style.decided().draws_codes());
    choose(&mut harness, "Renderer", "CPU");
    // The resolution of codes is a level-of-detail setting.
    slide(&mut harness, "Smallest cell (τ)", 8.0);
    assert_eq!(harness.state().style.levels.lod, Lod::ThresholdPx(8.0));
}

#[test]
fn an_untouched_slider_changes_no_setting() {
    let mut harness = window();
    for primitive in ["Voxels", "Points", "Surfels"] {
        click(&mut harness, primitive);
        harness.state_mut().style.primitive = Settings::default().primitive;
        assert_eq!(harness.state().style, Settings::default(), "{primitive}");
    }
}

#[test]
fn controls_show_their_term_and_unit() {
    let mut harness = window();
    let label = harness
        .get_by_role_and_label(Role::Label, "Splat scale")
        .rect()
        .center();
    harness.hover_at(label);
    harness.run_steps(60);
    assert!(
        harness
            .query_by_label_contains("Factor on every splat's radius")
            .is_some()
    );
}

#[test]
fn advanced_sections_start_closed_and_reopen_as_left() {
    let mut preferences = options().preferences;
    preferences.advanced = false;
    let begin = StateOptions {
        preferences,
        ..options()
    };
    let mut harness = window_on(sequence(&[]), begin);
    for label in ["Look", "Camera", "Time", "Clip"] {
        assert!(harness.query_all_by_label(label).next().is_some(), "{label}");
    }
    assert!(harness.query_by_label("Instancing").is_none());
    harness.get_by_label("Advanced").scroll_to_me();
    harness.run();
    harness.get_by_label("Advanced").click();
    harness.run_steps(30);
    assert!(harness.query_by_label("Instancing").is_some());
    assert!(harness.state().preferences().advanced, "kept");
}

/// The panel is as wide with trails and ghosts as without them.
#[test]
fn rows_that_appear_do_not_widen_the_panel() {
    let mut harness = window();
    harness.run();
    let width = harness.state().viewport.rect.width();
    harness.state_mut().features.trails.field.is_on = true;
    harness.state_mut().features.temporal.onion.is_on = true;
    harness.run_steps(5);
    assert_eq!(harness.state().viewport.rect.width(), width);
}
