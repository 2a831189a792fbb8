//! Trails of points: buttons and numbers next to a point's values, and painting over the image.

use super::{TrailField, Trails, field_place, pieces};
use crate::analysis::ColorMap;
use crate::app::features::inspection::Anchor;
use crate::app::theme::ODD;
use crate::app::widgets::frames::frames_slider;
use crate::app::widgets::overlay::PictureOverlay;
use crate::messages::frame_place;
use crate::playback::Player;
use egui::{Button, Checkbox, Color32, RichText, Slider, Stroke, Ui};

use crate::app::widgets::rows::{row, rows};

/// Most reasons why trails end that are listed.
const MAX_REASONS: usize = 3;

/// Brightness of the part of a trail that is still to come.
const TO_COME: f32 = 0.6;

/// Below the values of a point.
pub(in crate::app) fn trail_ui(ui: &mut Ui, trails: &mut Trails, anchor: Anchor) {
    ui.horizontal(|ui| {
        let trail = Button::selectable(trails.is_on, "Trail");
        let tooltip = "Trajectory of the point of this index from in to out point, and of pinned and measured \
            points. It is bright before the current frame (Shift+T)";
        if ui.add(trail).on_hover_text(tooltip).clicked() {
            trails.is_on ^= true;
        }
        if !trails.is_on {
            return;
        }
        let mut pinned = trails.pinned.iter();
        let is_pinned = pinned.any(|pinned| pinned.index_in_file == anchor.index_in_file);
        let keep = Button::selectable(is_pinned, "Keep trail");
        let tooltip = "The trail stays when another point is picked";
        if ui.add(keep).on_hover_text(tooltip).clicked() {
            trails.toggle_pinned(anchor);
        }
        let forget = Button::new("Forget kept trails");
        let has_pinned = !trails.pinned.is_empty();
        if has_pinned
            && ui
                .add(forget)
                .on_hover_text("Keeps only the trail of the picked point")
                .clicked()
        {
            trails.pinned.clear();
        }
    });
    if trails.is_on {
        status_ui(ui, trails);
    }
}

/// Shows the progress of the trail search, or where the trails end and why.
fn status_ui(ui: &mut Ui, trails: &mut Trails) {
    if let Some((done, all)) = trails.progress() {
        ui.horizontal(|ui| {
            ui.weak(format!(
                "Looking at {}…",
                frame_place(done.min(all.saturating_sub(1)), all)
            ));
            let cancel = ui.add(Button::new("Cancel trails").small());
            if cancel.on_hover_text("Stop looking for trails").clicked() {
                trails.cancel();
            }
        });
        return;
    }
    let Some(trails) = trails.found() else {
        return;
    };
    let breaks = trails.breaks();
    for broken in breaks.iter().take(MAX_REASONS) {
        let mut text = broken.text(|frame| format!("frame {}", frame + 1));
        if let Some(first) = text.get_mut(..1) {
            first.make_ascii_uppercase();
        }
        let text = RichText::new(text).color(ui.visuals().warn_fg_color);
        ui.label(text).on_hover_text(
            "Trails break here. Points are followed by their index in the file, which means nothing where frames have \
             other numbers of points or seem to have them in another order",
        );
    }
    if breaks.len() > MAX_REASONS {
        ui.weak(format!("and {} more breaks", breaks.len() - MAX_REASONS));
    }
    let is_nowhere = |trail| {
        let mut frames = trails.frames();
        frames.all(|frame| trails.place(trail, frame).is_none())
    };
    if (0..trails.trail_count()).all(is_nowhere) {
        ui.label("No trail between in and out point");
    }
}

/// The rows about trails of other points.
pub(in crate::app) fn field_ui(ui: &mut Ui, trails: &mut Trails) {
    let TrailField { is_on, points, length } = &mut trails.field;
    rows(ui, "trails", |ui| {
        row(
            ui,
            "Trails",
            "Trajectories over the last frames, of points spread evenly over the file; needs frames with the same \
                number of points",
            Checkbox::new(is_on, "Shown"),
        );
        if !*is_on {
            return;
        }
        row(
            ui,
            "Trail points",
            "Number of points with trails",
            Slider::new(points, 1..=TrailField::MAX_POINTS).logarithmic(true),
        );
        row(
            ui,
            "Trail length",
            "Number of frames before the current one",
            frames_slider(Slider::new(length, 1..=TrailField::MAX_LENGTH).logarithmic(true)),
        );
    });
    if *is_on {
        status_ui(ui, trails);
    }
}

/// Paints all trails.
pub(in crate::app) fn paint_trails(canvas: &PictureOverlay<'_>, of: &Trails, player: &Player) {
    let Some(trails) = of.found() else {
        return;
    };
    let Some(shown) = player.shown().map(|frame| frame.index) else {
        return;
    };
    let origin = player.sequence().origin();
    let [picked, others] = of.parts();
    let recent = (shown + 1).saturating_sub(of.field.length + 1)..shown + 1;
    let count = others.len();
    for (number, trail) in others.enumerate() {
        let [red, green, blue, _] = ColorMap::Viridis.color(field_place(number, count));
        let stroke = Stroke::new(1.2, Color32::from_rgb(red, green, blue));
        for piece in pieces(trails, trail, recent.clone(), origin) {
            canvas.polyline(&piece, stroke);
            if let Some(head) = piece.last() {
                canvas.dot(*head, stroke.color);
            }
        }
    }
    for trail in picked {
        let frames = trails.frames();
        let shadow = Stroke::new(4.0, Color32::from_black_alpha(130));
        for piece in pieces(trails, trail, frames.clone(), origin) {
            canvas.polyline(&piece, shadow);
        }
        let to_come = Stroke::new(1.5, ODD.gamma_multiply(TO_COME));
        for piece in pieces(trails, trail, shown.max(frames.start)..frames.end, origin) {
            canvas.polyline(&piece, to_come);
        }
        let past = Stroke::new(2.0, ODD);
        for piece in pieces(trails, trail, frames.start..(shown + 1).min(frames.end), origin) {
            canvas.polyline(&piece, past);
        }
        if let Some(place) = trails.place(trail, shown) {
            canvas.ring(origin + place.as_dvec3(), ODD);
        }
    }
}
