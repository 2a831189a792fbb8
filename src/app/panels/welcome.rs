//! Welcome screen instead of the image while nothing is open: failures to open with their reasons, recently opened
//! inputs, the demo, examples, and the keys to know.

use crate::app::command::Command;
use crate::app::commands::keys_of;
use crate::app::commands::opens_example;
use crate::app::recent::entry_name;
use crate::app::theme::ACCENT;
use crate::app::{FailedOpening, PanelId, State};
use crate::source::{Example, OpeningChoice};
use egui::{
    Align, Button, Color32, ColorImage, Frame, Grid, Layout, Rect, RichText, Role, ScrollArea, Sense, Stroke,
    StrokeKind, TextWrapMode, TextureHandle, TextureOptions, Ui, UiBuilder, WidgetInfo, WidgetText, pos2, vec2,
};
use std::path::PathBuf;

/// Width of the central content, points.
const WIDTH: f32 = 640.0;

/// Longer reasons scroll, points.
const MAX_REASON_HEIGHT: f32 = 110.0;

/// Size of the image of a recently opened input, points.
const PICTURE: [f32; 2] = [140.0, 105.0];

/// Essential keys and mouse actions before the list of all.
const KEYS: [(&str, &str); 5] = [
    ("Space", "play or pause"),
    ("Left drag", "orbit; with Shift pan, scroll to zoom"),
    ("F", "focus on the point under the pointer"),
    ("Ctrl+P", "find anything by its name"),
    ("F1", "all keys"),
];

/// The view over all of `rect`.
pub(super) fn welcome_ui(ui: &mut Ui, rect: Rect, state: &mut State) {
    // Text in a light theme is dark.
    ui.painter_at(rect).rect_filled(rect, 0.0, ui.visuals().panel_fill);
    let width = WIDTH.min(rect.width() - 24.0).max(0.0);
    let center = Rect::from_center_size(rect.center(), vec2(width, (rect.height() - 24.0).max(0.0)));
    ui.scope_builder(UiBuilder::new().max_rect(center), |ui| {
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            match &state.opening.failed {
                Some(failed) => {
                    failed_ui(ui, failed);
                    let chosen = choices_ui(ui, &failed.choices);
                    if let Some(input) = chosen {
                        state.open_paths(vec![input]);
                    }
                }
                None => _ = ui.heading("No sequence is open"),
            }
            ui.add_space(8.0);
            actions_ui(ui, state);
            recent_ui(ui, state);
            examples_ui(ui, state);
            ui.add_space(12.0);
            keys_ui(ui);
        });
    });
}

fn actions_ui(ui: &mut Ui, state: &mut State) {
    ui.label("Drop files or a folder of point clouds here, or");
    ui.horizontal_wrapped(|ui| {
        for (text, command) in [
            ("Open files", Command::OPEN_FILES),
            ("Open folder", Command::OPEN_FOLDER),
            ("Play the demo", Command::OPEN_DEMO),
            ("About pointreel", Command::panel(PanelId::ABOUT)),
        ] {
            let button = Button::new(text).min_size(vec2(140.0, 28.0));
            if ui.add(button.shortcut_text(keys_of(command))).clicked() {
                state.run(command);
            }
        }
    });
}

/// Shows the input that could not be opened, with the reason in full.
fn failed_ui(ui: &mut Ui, failed: &FailedOpening) {
    let color = ui.visuals().error_fg_color;
    let frame = Frame::window(ui.style()).stroke(Stroke::new(1.0, color.gamma_multiply(0.7)));
    frame.show(ui, |ui| {
        ui.horizontal(|ui| {
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                if ui.small_button("Copy").on_hover_text("Copy the full text").clicked() {
                    ui.copy_text(failed.reason.clone());
                }
                ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                    let title = format!("{} cannot be shown", failed.name);
                    let title = RichText::new(title).strong().color(color);
                    ui.add(egui::Label::new(title).truncate());
                });
            });
        });
        ScrollArea::vertical()
            .id_salt("reason")
            .max_height(MAX_REASON_HEIGHT)
            .show(ui, |ui| ui.label(&failed.reason));
    });
}

/// A button for each of the sequences that could be meant; the input of the one that was clicked.
fn choices_ui(ui: &mut Ui, choices: &[OpeningChoice]) -> Option<PathBuf> {
    let mut chosen = None;
    ui.horizontal_wrapped(|ui| {
        for choice in choices {
            let name = choice.label.split(':').next().unwrap_or_default();
            if ui.button(format!("Open {name}")).on_hover_text(&choice.label).clicked() {
                chosen = Some(choice.input.clone());
            }
        }
    });
    chosen
}

/// Shows recently opened inputs, each with an image where there is one.
fn recent_ui(ui: &mut Ui, state: &mut State) {
    if state.stored.recent.entries().is_empty() {
        return;
    }
    ui.add_space(12.0);
    ui.label(RichText::new("Recent").strong());
    let mut chosen = None;
    ui.horizontal_wrapped(|ui| {
        for inputs in state.stored.recent.entries() {
            let file = state.stored.recent.picture_of(inputs);
            let picture = file.and_then(|file| texture(ui, ("recent", &file), || image::open(&file)));
            let name = entry_name(inputs);
            let short = inputs.first().and_then(|path| path.file_name());
            let short = short.map_or_else(|| name.clone(), |short| short.to_string_lossy().into_owned());
            if card_ui(ui, [&name, &short, &name], picture) {
                chosen = Some(inputs.clone());
            }
        }
    });
    if let Some(inputs) = chosen {
        state.open_paths(inputs);
    }
}

/// Shows the bundled examples.
fn examples_ui(ui: &mut Ui, state: &mut State) {
    ui.add_space(12.0);
    ui.label(RichText::new("Examples").strong());
    let mut chosen = None;
    ui.horizontal_wrapped(|ui| {
        for example in Example::ALL {
            let picture = || image::load_from_memory(example.picture());
            let picture = texture(ui, ("example", example.name()), picture);
            let name = format!("Example: {}", example.title());
            if card_ui(ui, [&name, example.title(), example.credit()], picture) {
                chosen = Some(example);
            }
        }
    });
    if let Some(example) = chosen {
        state.run(opens_example(example));
    }
}

/// A thumbnail with a name below; true if it was clicked. The names are for screen readers, for display, and for the
/// tooltip.
fn card_ui(ui: &mut Ui, [name, short, hint]: [&str; 3], picture: Option<TextureHandle>) -> bool {
    let height = PICTURE[1] + 22.0;
    let (card, response) = ui.allocate_exact_size(vec2(PICTURE[0], height), Sense::click());
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, name));
    let place = Rect::from_min_size(card.min, PICTURE.into());
    ui.painter().rect_filled(place, 4.0, ui.visuals().extreme_bg_color);
    if let Some(texture) = picture {
        let all = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
        ui.painter().image(texture.id(), place, all, Color32::WHITE);
    }
    let stroke = if response.hovered() {
        Stroke::new(1.5, ACCENT)
    } else {
        ui.visuals().widgets.noninteractive.bg_stroke
    };
    ui.painter().rect_stroke(place, 4.0, stroke, StrokeKind::Inside);
    let font = egui::TextStyle::Body.resolve(ui.style());
    let text = WidgetText::from(short).into_galley(ui, Some(TextWrapMode::Truncate), PICTURE[0], font);
    let color = ui.visuals().text_color();
    ui.painter().galley(place.left_bottom() + vec2(2.0, 3.0), text, color);
    response.on_hover_text(hint).clicked()
}

/// The texture of this name, read when it is first shown; `None` where there is none.
fn texture(
    ui: &Ui,
    name: impl std::hash::Hash + std::fmt::Debug,
    read: impl FnOnce() -> image::ImageResult<image::DynamicImage>,
) -> Option<TextureHandle> {
    let id = egui::Id::unique(("picture of a card", name));
    if let Some(known) = ui.data(|data| data.get_temp::<Option<TextureHandle>>(id)) {
        return known;
    }
    let texture = read().ok().map(|picture| {
        let picture = picture.to_rgba8();
        let size = [picture.width() as usize, picture.height() as usize];
        let pixels = ColorImage::from_rgba_unmultiplied(size, &picture);
        ui.ctx()
            .load_texture("picture of a card", pixels, TextureOptions::LINEAR)
    });
    ui.data_mut(|data| data.insert_temp(id, texture.clone()));
    texture
}

fn keys_ui(ui: &mut Ui) {
    Grid::new("keys to know")
        .num_columns(2)
        .spacing([14.0, 4.0])
        .show(ui, |ui| {
            for (keys, text) in KEYS {
                ui.label(RichText::new(keys).color(ACCENT));
                ui.label(text);
                ui.end_row();
            }
        });
}
