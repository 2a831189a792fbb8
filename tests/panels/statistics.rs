//! The statistics.

use super::{click, load_all, press, window};
use egui::accesskit::Role;
use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable as _;

#[test]
fn statistics_tell_points_octree_and_budget() {
    let mut harness = window();
    press(&mut harness, Modifiers::NONE, Key::F3);
    assert!(harness.query_by_label("not supported").is_some());
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
