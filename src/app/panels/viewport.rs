//! The 3-D image and the mouse on it. The panels are other widgets, so that nothing done to them moves the camera.

use super::legend::legend_ui;
use super::marks::marks_ui;
use super::pair::{lay_out, pair_ui};
use super::scale_bar::scale_bar_ui;
use super::welcome::welcome_ui;
use crate::app::State;
use crate::app::features::Features;
use crate::app::grip::{Grip, Pull};
use crate::app::theme::{ACCENT, AXIS_COLORS, ODD};
use crate::app::widgets::picture::picture;
use crate::scene::Camera;
use egui::{
    Align2, Color32, CursorIcon, FontId, PointerButton, Pos2, Rect, Response, Role, Sense, Stroke, Ui, WidgetInfo,
    pos2, vec2,
};
use glam::Vec3;
use std::time::Duration;

/// Degrees of orbit for a drag over the height of the image.
const ORBIT_DEG_PER_HEIGHT: f64 = 270.0;

/// Degrees of looking around for the same drag.
const LOOK_DEG_PER_HEIGHT: f64 = 90.0;

/// One notch of a wheel scrolls about 50 points: 8 % of the distance.
const ZOOM_PER_POINT: f64 = 0.0016;

/// Update interval of the progress of pending work.
const PROGRESS_EVERY: Duration = Duration::from_millis(250);

/// Length of the axes in the corner.
const AXIS_LENGTH: f32 = 24.0;

/// The image over all of `ui`, and the camera by mouse.
pub(super) fn viewport_ui(ui: &mut Ui, state: &mut State) {
    let scale = ui.ctx().pixels_per_point();
    let rect = on_pixels(ui.available_rect_before_wrap(), scale);
    let response = ui.allocate_rect(rect, Sense::click_and_drag());
    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, "3-D picture"));
    lay_out(state, rect, scale);
    state.fit_first_view();
    state.viewport.pointer = response.hover_pos();
    move_camera(ui, &response, state);
    click(&response, state);
    if state.pictures().is_some() {
        pair_ui(ui, rect, state);
    } else if state.player.is_some() {
        picture(ui, rect, state.viewport.texture, rect);
    }
    overlays(ui, rect, state);
}

/// `rect` with corners on physical pixels: the image is then copied pixel by pixel.
fn on_pixels(rect: Rect, scale: f32) -> Rect {
    let snap = |edge: f32| (edge * scale).round() / scale;
    Rect::from_min_max(
        pos2(snap(rect.min.x), snap(rect.min.y)),
        pos2(snap(rect.max.x), snap(rect.max.y)),
    )
}

fn move_camera(ui: &Ui, response: &Response, state: &mut State) {
    let pulls = pulls(ui, response, &mut state.motion.grip);
    let height = f64::from(response.rect.height().max(1.0));
    let camera = &mut state.camera;
    for pull in &pulls {
        let (dx, dy) = (f64::from(pull.by.x), f64::from(pull.by.y));
        match drag_of(pull) {
            Drag::Orbit => camera.orbit(-dx / height * ORBIT_DEG_PER_HEIGHT, dy / height * ORBIT_DEG_PER_HEIGHT),
            Drag::Look => camera.look_around(-dx / height * LOOK_DEG_PER_HEIGHT, dy / height * LOOK_DEG_PER_HEIGHT),
            Drag::Pan => camera.pan_px(dx, dy, height),
        }
    }
    if response.hovered() || response.contains_pointer() {
        let (scroll, pinch) = ui.input(|input| (input.smooth_scroll_delta().y, input.zoom_delta()));
        let factor = (-f64::from(scroll) * ZOOM_PER_POINT).exp() / f64::from(pinch.max(0.01));
        if factor != 1.0 {
            let halves = [state.viewport.rect, state.viewport.other_rect];
            zoom(camera, factor, response.hover_pos(), halves);
        }
    }
    if !pulls.is_empty() {
        state.motion.turntable.is_on = false;
    }
    if response.clicked() || !pulls.is_empty() {
        // A text field that lost focus by a click elsewhere must release the keyboard.
        ui.memory_mut(|memory| {
            if let Some(focused) = memory.focused() {
                memory.surrender_focus(focused);
            }
        });
    }
}

/// Zooms toward the position of the pointer, in its half where there are two images.
fn zoom(camera: &mut Camera, factor: f64, pointer: Option<Pos2>, halves: [Rect; 2]) {
    let under = pointer.and_then(|pointer| Some((pointer, halves.into_iter().find(|half| half.contains(pointer))?)));
    let Some((pointer, half)) = under else {
        return camera.zoom(factor);
    };
    let aside = pointer - half.center();
    camera.zoom_toward(factor, aside.x.into(), aside.y.into(), half.height().into());
}

/// Clicks pick points for the chosen tool; double clicks focus, but where each click counts for a measurement.
fn click(response: &Response, state: &mut State) {
    if state.features.inspection.takes_clicks() {
        response.clone().on_hover_cursor(CursorIcon::Crosshair);
    }
    let Some(place) = response.interact_pointer_pos() else {
        return;
    };
    if response.double_clicked() && !state.features.inspection.takes_double_clicks() {
        if !state.focus_at(place) {
            state.frame_all();
        }
    } else if response.clicked() {
        state.click_at(place);
    }
}

/// Returns the drags since the last pass.
fn pulls(ui: &Ui, response: &Response, grip: &mut Option<Grip>) -> Vec<Pull> {
    let ctx = ui.ctx();
    if ctx.dragged_id().is_some_and(|id| id != response.id) {
        // The edge of a panel can also be grabbed from the image's side.
        *grip = None;
        return Vec::new();
    }
    let is_on_picture = |place: Pos2| {
        let layer = ctx.layer_id_at(place);
        response.rect.contains(place) && layer.is_none_or(|layer| layer == response.layer_id)
    };
    let (events, modifiers) = ui.input(|input| (input.raw.events.clone(), input.modifiers));
    Grip::follow(grip, &events, modifiers, is_on_picture)
}

enum Drag {
    Orbit,
    Look,
    Pan,
}

fn drag_of(pull: &Pull) -> Drag {
    if pull.button != PointerButton::Primary || pull.modifiers.shift {
        Drag::Pan
    } else if pull.modifiers.command || pull.modifiers.ctrl {
        Drag::Look
    } else {
        Drag::Orbit
    }
}

fn overlays(ui: &mut Ui, rect: Rect, state: &mut State) {
    let painter = ui.painter_at(rect);
    let dropping = ui.input(|input| !input.raw.hovered_files.is_empty());
    if dropping {
        painter.rect_filled(rect, 0.0, Color32::from_black_alpha(150));
        painter.rect_stroke(
            rect.shrink(12.0),
            8.0,
            Stroke::new(2.0, ACCENT),
            egui::StrokeKind::Inside,
        );
        painter.text(
            rect.center(),
            Align2::CENTER_CENTER,
            "Drop files or a folder to open, with Shift to compare",
            FontId::proportional(22.0),
            Color32::WHITE,
        );
    }
    let (dropped, is_compared) = ui.input(|input| {
        let files = input.raw.dropped_files.iter();
        let paths: Vec<_> = files.map(|file| file.path().to_path_buf()).collect();
        (paths, input.modifiers.shift)
    });
    if is_compared && state.player.is_some() {
        state.compare_paths(dropped);
    } else {
        state.open_paths(dropped);
    }

    match &state.player {
        None => welcome_ui(ui, rect, state),
        Some(player) => {
            // In a split view, A's rectangle.
            let place = state.viewport.rect;
            if let Some(failure) = player.failure() {
                let text = format!("Frame {} cannot be shown", failure.index() + 1);
                banner(&painter, place, &text, ODD);
            } else if player.shown().is_none() {
                banner(&painter, place, "Loading the first frame…", Color32::WHITE);
            } else if let Some(text) = state.surface_on_its_way() {
                banner(&painter, place, &text, Color32::WHITE);
                ui.ctx().request_repaint_after(PROGRESS_EVERY);
            }
            marks_ui(ui, state);
            for feature in Features::rows::<State>() {
                feature.handles(ui, state);
            }
            scale_bar_ui(ui, place, state);
            axes(&painter, rect, state);
            legend_ui(&painter, place, state);
        }
    }
}

fn banner(painter: &egui::Painter, rect: Rect, text: &str, color: Color32) {
    let galley = painter.layout_no_wrap(text.to_owned(), FontId::proportional(15.0), color);
    let size = galley.size() + vec2(24.0, 12.0);
    let place = Align2::CENTER_TOP.align_size_within_rect(size, rect.shrink(14.0));
    painter.rect_filled(place, 6.0, Color32::from_black_alpha(190));
    painter.galley(place.min + vec2(12.0, 6.0), galley, color);
}

/// The directions of the world's axes, at the lower right.
fn axes(painter: &egui::Painter, rect: Rect, state: &State) {
    let rotation = state
        .camera
        .transform(glam::DVec3::ZERO, [1, 1])
        .view_from_frame_rotation;
    let center = rect.right_bottom() - vec2(44.0, 44.0);
    let mut axes = [
        ("x", rotation * Vec3::X, AXIS_COLORS[0]),
        ("y", rotation * Vec3::Y, AXIS_COLORS[1]),
        ("z", rotation * Vec3::Z, AXIS_COLORS[2]),
    ];
    // Axes that point away are drawn first.
    axes.sort_by(|(_, a, _), (_, b, _)| a.z.total_cmp(&b.z));
    for (name, direction, color) in axes {
        let color = if direction.z < -0.2 {
            color.gamma_multiply(0.55)
        } else {
            color
        };
        let tip = |length: f32| center + vec2(direction.x, -direction.y) * length;
        painter.line_segment([center, tip(AXIS_LENGTH)], Stroke::new(2.0, color));
        painter.text(
            tip(AXIS_LENGTH + 9.0),
            Align2::CENTER_CENTER,
            name,
            FontId::proportional(12.0),
            color,
        );
    }
}
