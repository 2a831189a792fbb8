//! Labels: placed by clicks, written, listed, undone, and painted where their points are.

use super::points::{click_on, corner, in_squares, in_window};
use super::{FRAMES, click, frame, press, window};
use egui::accesskit::Role;
use egui::{Key, Modifiers, Pos2, Shape};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use pointreel::app::{State, Tool};
use std::time::Duration;

const NONE: Modifiers = Modifiers::NONE;

/// A window on the cube that grows, with a label at the corner 6.
fn labelled(text: &str) -> Harness<'static, State> {
    let mut harness = in_squares(window());
    press(&mut harness, NONE, Key::N);
    let place = in_window(&harness, corner(6));
    click_on(&mut harness, place, 1);
    // The text is entered at once.
    harness
        .get_by_role_and_label(Role::TextInput, "Text of label 1")
        .type_text(text);
    harness.run();
    harness
}

fn texts(harness: &Harness<'_, State>) -> Vec<String> {
    let labels = harness.state().features.labels.list.iter();
    labels.map(|label| label.text.clone()).collect()
}

/// The upper left corner of a text, if it is painted.
fn painted(harness: &Harness<'_, State>, text: &str) -> Option<Pos2> {
    fn find(shape: &Shape, text: &str) -> Option<Pos2> {
        match shape {
            Shape::Vec(shapes) => shapes.iter().find_map(|shape| find(shape, text)),
            Shape::Text(painted) if painted.galley.text() == text => Some(painted.pos),
            _ => None,
        }
    }
    let shapes = harness.output().shapes.iter();
    // Text fields are in windows, labels on the image below all of them.
    let picture = harness.state().viewport.rect;
    shapes
        .filter(|clipped| clipped.clip_rect.width() > 0.9 * picture.width())
        .find_map(|clipped| find(&clipped.shape, text))
}

#[test]
fn a_click_adds_a_label_whose_text_is_edited_at_once() {
    let mut harness = in_squares(window());
    press(&mut harness, NONE, Key::N);
    assert_eq!(harness.state().features.inspection.tool, Tool::Label);
    assert!(harness.query_by_label_contains("Click on a point").is_some());
    assert_eq!(harness.unnamed_widgets(), Vec::<String>::new());

    let mut harness = labelled("left knee");
    assert_eq!(texts(&harness), ["left knee"]);
    let label = harness.state().features.labels.list[0].clone();
    let point = label.point.unwrap();
    assert_eq!(
        (point.index_in_file, point.points_in_file, label.frame),
        (6, Some(8), 0)
    );
    assert!((label.place.unwrap() - corner(6)).length() < 1e-6);
    assert_eq!(harness.unnamed_widgets(), Vec::<String>::new());
    // Esc leaves the field, closes the list, and ends label placement.
    for _ in 0..3 {
        press(&mut harness, NONE, Key::Escape);
    }
    assert_eq!(harness.state().features.inspection.tool, Tool::Camera);
    assert_eq!(texts(&harness), ["left knee"], "it stays");
}

#[test]
fn a_label_is_painted_at_its_point_and_follows_it() {
    let mut harness = labelled("knee");
    let expected = |harness: &Harness<'_, State>, scale: f64| in_window(harness, scale * corner(6));
    let offset = painted(&harness, "knee").unwrap() - expected(&harness, 1.0);
    assert!(
        (0.0..40.0).contains(&offset.x) && (-40.0..0.0).contains(&offset.y),
        "{offset:?}"
    );
    press(&mut harness, Modifiers::SHIFT, Key::ArrowRight);
    // Keys still go to the text field first: a click on the image below has to leave it.
    let aside = harness.state().viewport.rect.left_bottom() + egui::vec2(20.0, -20.0);
    click_on(&mut harness, aside, 1);
    press(&mut harness, Modifiers::SHIFT, Key::ArrowRight);
    harness.state_mut().update(Duration::ZERO);
    harness.run();
    assert_eq!(frame(&harness), 10);
    let moved = painted(&harness, "knee").unwrap() - expected(&harness, 1.1);
    assert!((moved - offset).length() < 0.6, "{moved:?} {offset:?}");
    harness.get_by_role_and_label(Role::CheckBox, "Show labels").click();
    harness.run();
    assert_eq!(painted(&harness, "knee"), None);
}

#[test]
fn saved_images_have_the_labels_of_the_window() {
    let mut harness = labelled("knee");
    let gray = image::Rgba([90, 90, 90, 255]);
    let saved = |harness: &Harness<'_, State>| {
        let picture = image::RgbaImage::from_pixel(640, 480, gray);
        harness.state().joined(picture, None)
    };
    let picture = saved(&harness);
    let place = harness.state().camera.to_px(corner(6), [640, 480]).unwrap();
    assert_ne!(picture.get_pixel(place.x as u32, place.y as u32), &gray, "the dot");
    // The text is to its upper right.
    let changed = picture.enumerate_pixels().filter(|(_, _, pixel)| **pixel != gray);
    let of_text = changed.filter(|(x, y, _)| f64::from(*x) > place.x + 8.0 && f64::from(*y) < place.y - 4.0);
    assert!(of_text.count() > 100);
    harness.get_by_role_and_label(Role::CheckBox, "Show labels").click();
    harness.run();
    assert!(saved(&harness).pixels().all(|pixel| *pixel == gray));
}

#[test]
fn labels_have_times_and_can_be_jumped_to_deleted_and_undone() {
    let mut harness = labelled("knee");
    let set = |harness: &mut Harness<'_, State>, label: &str, value: f64| {
        harness
            .get_by_role_and_label(Role::SpinButton, label)
            .set_value_accesskit(value);
        harness.run();
    };
    set(&mut harness, "First frame of label 1", 5.0);
    set(&mut harness, "Last frame of label 1", 9.0);
    let range = harness.state().features.labels.list[0].frames;
    assert_eq!((range.first(), range.last()), (Some(4), Some(8)));
    assert_eq!(painted(&harness, "knee"), None, "the first frame does not show it");
    click(&mut harness, "Go to label 1");
    harness.state_mut().update(Duration::from_secs(5));
    harness.run();
    assert_eq!(frame(&harness), 4);
    assert!(painted(&harness, "knee").is_some());
    let target = harness.state().camera.target_in_world;
    assert!((target - corner(6)).length() < 0.1, "{target}");
    set(&mut harness, "Last frame of label 1", FRAMES as f64);
    assert_eq!(
        harness.state().features.labels.list[0].frames.last(),
        None,
        "the sequence may grow"
    );

    // Changes in quick succession are one undo step.
    harness.run_steps(60);
    click(&mut harness, "Delete label 1");
    assert_eq!(texts(&harness), [""; 0]);
    press(&mut harness, Modifiers::COMMAND, Key::Z);
    assert_eq!(texts(&harness), ["knee"]);
    press(&mut harness, Modifiers::COMMAND, Key::Y);
    assert_eq!(texts(&harness), [""; 0]);
    press(&mut harness, Modifiers::COMMAND, Key::Z);
    // Another sequence has none of them, and undo does not bring them there.
    harness.state_mut().open(super::sequence(&[]));
    harness.run();
    assert_eq!(texts(&harness), [""; 0]);
    press(&mut harness, Modifiers::COMMAND, Key::Z);
    assert_eq!(texts(&harness), [""; 0]);
}
