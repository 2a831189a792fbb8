//! The statistics.

use super::{click, load_all, press, window};
use egui::accesskit::Role;
use egui::{Key, Modifiers};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use pointreel::app::{PanelId, State};
use pointreel::render::RenderStats;
use pointreel::scene::RendererChoice;
use std::time::Duration;

#[test]
fn statistics_show_points_octree_and_budget() {
    let mut harness = window();
    press(&mut harness, Modifiers::NONE, Key::F3);
    assert!(harness.query_by_label("Leaves").is_none());
    click(&mut harness, "Voxels");
    load_all(harness.state_mut());
    harness.run();
    for label in [
        "Points",
        "Depth",
        "Nodes",
        "Leaves",
        "Loss",
        "Visited",
        "Uploads",
        "Passes",
        "Draw calls",
    ] {
        assert!(harness.query_all_by_label(label).next().is_some(), "{label}");
    }
    harness
        .get_by_role_and_label(Role::SpinButton, "Budget")
        .set_value_accesskit(64.0);
    harness.run();
    let stats = harness.state().player.as_ref().unwrap().loader().stats();
    assert_eq!(stats.budget_bytes, 64 << 20);
    harness
        .get_by_role_and_label(Role::SpinButton, "GPU budget")
        .set_value_accesskit(32.0);
    harness.run();
    assert_eq!(harness.state().graphics.budget_bytes, 32 << 20);
}

/// The value next to a name.
fn has_row(harness: &Harness<'_, State>, name: &str, value: &str) -> bool {
    harness.query_all_by_label(name).next().is_some() && harness.query_all_by_label(value).next().is_some()
}

#[test]
fn parts_of_a_redraw_do_not_exceed_the_total_and_unknown_times_are_hidden() {
    let mut harness = window();
    let state = harness.state_mut();
    // The settings panel contains the same words.
    state.panels.set(PanelId::SETTINGS, false);
    state.style.drawing.renderer = RendererChoice::Cpu.into();
    state.graphics.frame_ms = 3.03;
    state.graphics.redraw.panels = Duration::from_micros(2030);
    state.graphics.redraw.painting = Duration::from_millis(1);
    state.graphics.render = RenderStats {
        frames: 7,
        encode_ms: 8.67,
        drawn_instances: 30_208,
        records: 8334,
        ..RenderStats::default()
    };
    press(&mut harness, Modifiers::NONE, Key::F3);
    assert!(has_row(&harness, "CPU", "3.03 ms") && has_row(&harness, "  panels", "2.03 ms"));
    // An image that took longer than the redraw belongs to an earlier one: it is not part of this one.
    assert!(harness.query_by_label("Time of the last render").is_some());
    assert!(has_row(&harness, "Drawing", "8.67 ms"));
    assert!(harness.query_by_label("  encoding").is_none());
    assert!(has_row(&harness, "Drawn", "8,334") && has_row(&harness, "In tiles", "30,208"));
    for unknown in ["GPU", "not supported", "not yet", "On the GPU", "Draw calls"] {
        assert!(harness.query_by_label(unknown).is_none(), "{unknown}");
    }

    let state = harness.state_mut();
    state.style.drawing.renderer = RendererChoice::Gpu.into();
    state.graphics.render.gpu_ms = Some(1.25);
    harness.run();
    assert!(has_row(&harness, "GPU", "1.25 ms") && has_row(&harness, "Encoding", "8.67 ms"));
    assert!(has_row(&harness, "In passes", "30,208"));
    assert!(harness.query_by_label("Drawing").is_none());
}
