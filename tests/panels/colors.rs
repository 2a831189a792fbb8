//! Colours: the available ones are listed, and the chosen one is drawn and explained.

use super::settings::choose;
use super::walk::{FRAMES, load_all, options};
use super::window_on;
use egui::accesskit::Role;
use egui::{Shape, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use pointreel::analysis::ColorMap;
use pointreel::app::{PanelId, State};
use pointreel::cloud::{Positions, RawCloud, ScalarField};
use pointreel::scene::{Legend, LegendBody};
use pointreel::sequence::{ColorRange, ColorSource, FrameEntry, Sequence};
use std::sync::Arc;

/// Rows of points with the field `scalar_Heat` of 0 to 99 and the classes 2 and 6; `bare` without colours of the file.
fn window(is_bare: bool) -> Harness<'static, State> {
    let sources = (0..FRAMES).map(|frame| FrameEntry::file(format!("/scans/heat_{frame}.ply")));
    let sequence = Sequence::with_decoder(sources.collect(), move |_| {
        let position = |index: usize| [(index % 10) as f32, (index / 10) as f32, 0.1 * index as f32];
        let mut cloud = RawCloud::from_positions(Positions::F32((0..100).map(position).collect()));
        cloud.attributes.colors = (!is_bare).then(|| (0..100).map(|index| [index, 9, 9, 255]).collect());
        cloud.attributes.scalars = vec![
            ScalarField::new("scalar_Heat", (0..100).map(|index| index as f32).collect()),
            ScalarField::new("classification", (0..100).map(|index| [2.0, 6.0][index % 2]).collect()),
        ];
        Ok(cloud)
    });
    window_on(Arc::new(sequence), options())
}

fn settle(harness: &mut Harness<'_, State>) {
    load_all(harness.state_mut());
    harness.run();
}

fn legend(harness: &Harness<'_, State>) -> Option<Legend> {
    let player = harness.state().player.as_ref().unwrap();
    Legend::of(player.shown().unwrap())
}

fn color_of(harness: &Harness<'_, State>, index_in_file: u32) -> [u8; 4] {
    let shown = harness.state().player.as_ref().unwrap().shown().unwrap();
    let mut slots = shown.frame.file_index().iter();
    let slot = slots.position(|&index| index == index_in_file).unwrap();
    shown.points[slot].color
}

#[test]
fn a_field_is_shown_with_a_color_map_over_a_range() {
    let mut harness = window(false);
    assert_eq!(color_of(&harness, 50), [50, 9, 9, 255]);
    assert!(
        harness.query_by_label("Colour map").is_none(),
        "colours of the file need none"
    );
    choose(&mut harness, "Colours", "Heat");
    settle(&mut harness);
    assert_eq!(color_of(&harness, 98), ColorMap::Viridis.color(1.0));
    choose(&mut harness, "Colour map", "Turbo");
    settle(&mut harness);
    assert_eq!(color_of(&harness, 1), ColorMap::Turbo.color(0.0));
    choose(&mut harness, "Colour range", "Fixed");
    let fixed = ColorRange::Fixed { low: 1.0, high: 98.0 };
    assert_eq!(harness.state().style.colors.range, fixed, "as it was");
    let field = harness.get_by_role_and_label(Role::SpinButton, "Last colour");
    field.scroll_to_me();
    harness.run();
    harness
        .get_by_role_and_label(Role::SpinButton, "Last colour")
        .set_value_accesskit(21.0);
    harness.run();
    settle(&mut harness);
    assert_eq!(color_of(&harness, 11), ColorMap::Turbo.color(0.5));
    let shown = legend(&harness).unwrap();
    assert_eq!(shown.title, "Heat");
    let LegendBody::Ramp { map, ticks } = shown.body else {
        panic!("a field has a ramp");
    };
    assert_eq!((map, ticks[0].1.as_str()), (ColorMap::Turbo, "5"));
    // Numbers of one source have no meaning for another.
    choose(&mut harness, "Colours", "Height");
    assert_eq!(harness.state().style.colors.range, ColorRange::USUAL);
    choose(&mut harness, "Along", "-Z");
    settle(&mut harness);
    assert_eq!(color_of(&harness, 0), ColorMap::Turbo.color(1.0));
}

/// Lower edge of a text, if it is painted.
fn bottom_of(harness: &Harness<'_, State>, text: &str) -> Option<f32> {
    fn find(shape: &Shape, text: &str) -> Option<f32> {
        match shape {
            Shape::Vec(shapes) => shapes.iter().find_map(|shape| find(shape, text)),
            Shape::Text(painted) if painted.galley.text() == text => Some(painted.pos.y + painted.galley.size().y),
            _ => None,
        }
    }
    let picture = harness.state().viewport.rect;
    let shapes = harness.output().shapes.iter();
    shapes
        .filter(|clipped| picture.intersects(clipped.clip_rect))
        .find_map(|clipped| find(&clipped.shape, text))
}

#[test]
fn the_legend_of_a_small_window_does_not_cover_the_axes() {
    let mut harness = window(false);
    choose(&mut harness, "Colours", "Heat");
    settle(&mut harness);
    harness.set_size(vec2(640.0, 480.0));
    harness.run();
    let LegendBody::Ramp { ticks, .. } = legend(&harness).unwrap().body else {
        panic!("a field has a ramp");
    };
    let lowest = ticks.iter().filter_map(|(_, tick)| bottom_of(&harness, tick));
    let lowest = lowest.fold(0.0, f32::max);
    let axes = harness.state().viewport.rect.bottom() - 77.0;
    assert!(lowest > 0.0 && lowest < axes, "{lowest} {axes}");
}

#[test]
fn classes_are_listed_in_a_legend_that_can_be_hidden() {
    let mut harness = window(true);
    choose(&mut harness, "Colours", "Class");
    settle(&mut harness);
    let LegendBody::Classes(classes) = legend(&harness).unwrap().body else {
        panic!("classes are listed");
    };
    let names: Vec<&str> = classes.iter().map(|(_, name)| name.as_str()).collect();
    assert_eq!(names, ["2  Ground", "6  Building"]);
    assert_eq!(color_of(&harness, 0), classes[0].0);
    assert!(harness.state().panels.has(PanelId::LEGEND));
    harness.get_by_role_and_label(Role::CheckBox, "Legend").scroll_to_me();
    harness.run();
    harness.get_by_role_and_label(Role::CheckBox, "Legend").click();
    harness.run();
    assert!(!harness.state().panels.has(PanelId::LEGEND));
    assert!(!harness.state().preferences().panels.legend, "kept");
    assert!(harness.query_by_role_and_label(Role::ComboBox, "Colour map").is_none());
}

#[test]
fn the_list_has_the_fields_of_the_file() {
    let mut harness = window(true);
    harness.get_by_role_and_label(Role::ComboBox, "Colours").scroll_to_me();
    harness.run();
    harness.get_by_role_and_label(Role::ComboBox, "Colours").click();
    harness.run();
    for (entry, can_be_chosen) in [
        ("Heat", true),
        ("Classification", true),
        ("Class", true),
        ("Time", false),
        ("From the file", false),
    ] {
        let found = harness.get_by_role_and_label(Role::Button, entry);
        assert_eq!(!found.accesskit_node().is_disabled(), can_be_chosen, "{entry}");
    }
    assert!(
        harness.query_by_role_and_label(Role::Button, "Scalar").is_none(),
        "they have names"
    );
}

#[test]
fn a_missing_scalar_is_gray_with_a_reason() {
    let mut harness = super::window();
    harness.get_by_role_and_label(Role::ComboBox, "Colours").scroll_to_me();
    harness.run();
    harness.get_by_role_and_label(Role::ComboBox, "Colours").click();
    harness.run();
    let entry = harness.get_by_role_and_label(Role::Button, "Scalar");
    assert!(entry.accesskit_node().is_disabled());
    let place = entry.rect().center();
    harness.hover_at(place);
    harness.run_steps(60);
    assert!(harness.query_by_label_contains("The file has no scalar").is_some());
    // If it was chosen for another file before, it is not ignored in silence.
    let mut harness = super::window();
    harness.state_mut().style.colors.source = ColorSource::Scalar(None);
    settle(&mut harness);
    assert!(
        harness
            .query_by_label_contains("The file has no scalar. Shown instead: ")
            .is_some()
    );
}
