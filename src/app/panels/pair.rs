//! Two images: side by side or on both sides of a line, with their names; or their difference.

use crate::app::widgets::picture::picture;
use crate::app::{Side, State};
use crate::playback::PairBy;
use egui::{
    Align2, Color32, ColorImage, CursorIcon, FontId, Frame, Id, Label, Margin, Pos2, Rect, RichText, Role, Sense,
    Stroke, TextWrapMode, TextureHandle, TextureId, TextureOptions, Ui, UiBuilder, WidgetInfo, pos2,
};
use image::RgbaImage;
use std::sync::Arc;

/// Background where there is no image.
const NOTHING: Color32 = Color32::from_gray(16);

/// Half the width of the line's grab area, points.
const GRAB: f32 = 6.0;

/// Half the size of the cross where the pointer is in the other half, points.
const CROSS: f32 = 7.0;

/// Lays out the images within `rect`, whose corners are on physical pixels.
pub(super) fn lay_out(state: &mut State, rect: Rect, scale: f32) {
    let places = match &state.features.split_view {
        Some(split_view) => split_view.places(rect, line(rect, split_view.pictures.split, scale)),
        None => [rect; 2],
    };
    let max_edge_px = state.viewport.max_edge_px.unwrap_or(u32::MAX);
    let size_px = |place: Rect| {
        [place.width(), place.height()].map(|edge| ((edge * scale).round().max(0.0) as u32).min(max_edge_px))
    };
    let viewport = &mut state.viewport;
    [viewport.rect, viewport.other_rect] = places;
    [viewport.size_px, viewport.other_size_px] = places.map(size_px);
}

/// The place of the line, on a border of pixels.
fn line(rect: Rect, split: f32, scale: f32) -> f32 {
    ((rect.left() + split * rect.width()) * scale).round() / scale
}

/// Both images of a comparison, or their difference.
pub(super) fn pair_ui(ui: &mut Ui, rect: Rect, state: &mut State) {
    let viewport = state.viewport;
    let is_b_edited = state
        .features
        .comparison
        .as_ref()
        .is_some_and(|comparison| comparison.edited == Side::B);
    let mut textures = [viewport.texture, viewport.other_texture];
    if is_b_edited {
        textures.reverse();
    }
    let names = names(state);
    let is_side_by_side = is_side_by_side(state);
    let range = match &state.features.split_view {
        Some(split_view) => split_view.line_range(),
        None => 0.0..=1.0,
    };
    if state
        .features
        .split_view
        .as_ref()
        .is_some_and(|split_view| split_view.companion.shown().is_none())
    {
        textures[1] = None;
    }
    let Some(pictures) = state.pictures_mut() else {
        return;
    };
    if let (true, false, Some(difference)) = (pictures.shows_difference, is_side_by_side, &pictures.difference) {
        picture(ui, rect, Some(error_map(ui, &difference.map)), rect);
        return;
    }
    let x = line(rect, pictures.split, ui.ctx().pixels_per_point());
    let parts = [rect.with_max_x(x), rect.with_min_x(x)];
    let places = if is_side_by_side {
        [viewport.rect, viewport.other_rect]
    } else {
        [rect; 2]
    };
    for ((part, place), texture) in parts.into_iter().zip(places).zip(textures) {
        if texture.is_none() {
            ui.painter_at(part).rect_filled(part, 0.0, NOTHING);
        }
        picture(ui, place, texture, part);
    }
    let grab = Rect::from_x_y_ranges(x - GRAB..=x + GRAB, rect.y_range());
    let handle = ui
        .interact(grab, ui.scope_id().with("split"), Sense::drag())
        .on_hover_and_drag_cursor(CursorIcon::ResizeHorizontal);
    handle.widget_info(|| WidgetInfo::labeled(Role::Slider, true, "Line between A and B"));
    if let Some(pointer) = handle.interact_pointer_pos().filter(|_| handle.dragged()) {
        let split = (pointer.x - rect.left()) / rect.width().max(1.0);
        pictures.split = split.clamp(*range.start(), *range.end());
    }
    ui.painter_at(rect)
        .vline(x, rect.y_range(), Stroke::new(1.5, Color32::WHITE));
    if is_side_by_side && let Some(pointer) = viewport.pointer {
        same_place(ui, pointer, places);
    }
    match names {
        Some([a, b]) => {
            name_ui(ui, parts[0], Align2::LEFT_TOP, &a);
            name_ui(ui, parts[1], Align2::RIGHT_TOP, &b);
        }
        None => letters(ui, rect, x),
    }
}

fn is_side_by_side(state: &State) -> bool {
    matches!(&state.features.split_view, Some(split_view) if split_view.is_side_by_side())
}

/// Marks the pointer's position in the other half: both have the same camera, with its axis at the centre of each.
fn same_place(ui: &Ui, pointer: Pos2, places: [Rect; 2]) {
    let here = usize::from(!places[0].contains(pointer));
    let [here, there] = [places[here], places[1 - here]];
    let place = there.center() + (pointer - here.center());
    let painter = ui.painter_at(there);
    for (width, color) in [(3.0, Color32::from_black_alpha(160)), (1.0, Color32::WHITE)] {
        let stroke = Stroke::new(width, color);
        painter.hline(place.x - CROSS..=place.x + CROSS, place.y, stroke);
        painter.vline(place.x, place.y - CROSS..=place.y + CROSS, stroke);
    }
}

/// Paints the letters of the sides of two render modes.
fn letters(ui: &Ui, rect: Rect, x: f32) {
    for (text, place, align) in [
        ("A", pos2(x - 8.0, rect.top() + 8.0), Align2::RIGHT_TOP),
        ("B", pos2(x + 8.0, rect.top() + 8.0), Align2::LEFT_TOP),
    ] {
        let font = FontId::proportional(18.0);
        ui.painter_at(rect).text(place, align, text, font, Color32::WHITE);
    }
}

/// Returns the names of both visible sequences.
fn names(state: &State) -> Option<[String; 2]> {
    let split_view = state.features.split_view.as_ref()?;
    let player = state.player.as_ref()?;
    let named = |side: &str, sequence: &str, frame: String| {
        // Names of frames in a multi-frame file already start with the name of the file.
        if frame.starts_with(sequence) {
            format!("{side}  {frame}")
        } else {
            format!("{side}  {sequence}: {frame}")
        }
    };
    let frame = player.shown().map_or_else(
        || "loading".to_owned(),
        |frame| player.sequence().entry(frame.index).name.clone(),
    );
    let a = named("A", &state.sequence_name().unwrap_or_default(), frame);
    let companion = &split_view.companion;
    let frame = match (companion.frame(), companion.waiting_for(), companion.failure()) {
        (None, ..) if companion.paired_by() == PairBy::Number => "no frame of this number".to_owned(),
        (None, ..) => "no frame at this time".to_owned(),
        (_, _, Some(failure)) => format!("frame {} cannot be shown", failure.index() + 1),
        (_, Some(frame), _) => format!("loading frame {}", frame + 1),
        (Some(frame), None, None) => companion.sequence().entry(frame).name.clone(),
    };
    Some([a, named("B", &split_view.name, frame)])
}

/// A name in a corner of its part of the image.
fn name_ui(ui: &mut Ui, part: Rect, align: Align2, name: &str) {
    let inner = part.shrink(8.0);
    if inner.width() < 24.0 {
        return;
    }
    let layout = if align == Align2::LEFT_TOP {
        egui::Layout::left_to_right(egui::Align::Min)
    } else {
        egui::Layout::right_to_left(egui::Align::Min)
    };
    ui.scope_builder(UiBuilder::new().max_rect(inner).layout(layout), |ui| {
        ui.shrink_clip_rect(part);
        Frame::new()
            .fill(Color32::from_black_alpha(170))
            .corner_radius(4.0)
            .inner_margin(Margin::symmetric(8, 3))
            .show(ui, |ui| {
                let text = RichText::new(name).color(Color32::WHITE);
                let label = Label::new(text).selectable(false);
                ui.add(label.wrap_mode(TextWrapMode::Truncate));
            });
    });
}

/// The texture of an error map, made when it is first shown; the last one goes then.
fn error_map(ui: &Ui, map: &Arc<RgbaImage>) -> TextureId {
    let id = Id::unique("error map");
    let known: Option<(Arc<RgbaImage>, TextureHandle)> = ui.data(|data| data.get_temp(id));
    if let Some((_, texture)) = known.filter(|(of, _)| Arc::ptr_eq(of, map)) {
        return texture.id();
    }
    let size = [map.width() as usize, map.height() as usize];
    let pixels = ColorImage::from_rgba_unmultiplied(size, map);
    let texture = ui.ctx().load_texture("error map", pixels, TextureOptions::NEAREST);
    let shown = texture.id();
    ui.data_mut(|data| data.insert_temp(id, (Arc::clone(map), texture)));
    shown
}
