//! The command palette: finds commands, settings and panels by name.

use super::{Entry, Search, find};
use egui::{Align2, Button, Key, Modifiers, Response, ScrollArea, TextEdit, Ui, Window};

/// Size of the window, points.
const SIZE: [f32; 2] = [460.0, 320.0];

/// A search field and its results, while the palette is open. Enter runs, arrows choose, Esc closes. Returns the chosen
/// entry.
pub(in crate::app) fn palette_ui(
    ui: &Ui,
    open: &mut Option<Search>,
    all: Vec<Entry>,
    recent: &[String],
) -> Option<Entry> {
    let search = open.as_mut()?;
    let ctx = ui.ctx();
    // Consumed before the text field sees them: they would move its cursor or take its focus.
    let pressed = |key| ctx.input_mut(|input| input.consume_key(Modifiers::NONE, key));
    let (is_run, is_closed) = (pressed(Key::Enter), pressed(Key::Escape));
    let (up, down) = (pressed(Key::ArrowUp), pressed(Key::ArrowDown));
    let mut clicked = None;
    let mut chosen = None;
    let screen = ctx.content_rect();
    Window::new("Commands")
        .collapsible(false)
        .resizable(false)
        .title_bar(false)
        .pivot(Align2::CENTER_TOP)
        .fixed_pos([screen.center().x, screen.top() + 60.0])
        .show(ctx, |ui| {
            ui.set_width(SIZE[0]);
            let field = TextEdit::singleline(&mut search.query)
                .hint_text("Command")
                .desired_width(f32::INFINITY);
            let field = ui.add(field);
            let label = "Find a command";
            ctx.accesskit_node_builder(field.id, |node| node.set_label(label));
            field.request_focus();
            if field.changed() {
                search.chosen = 0;
            }
            field.on_hover_text(
                "Words of a command, a setting or its value, and numbers: frame 12, point size 4. Enter runs, arrows \
                 choose, Esc closes",
            );
            let found = find(&search.query, all, recent);
            let last = found.len().saturating_sub(1);
            let place = (search.chosen + usize::from(down)).saturating_sub(usize::from(up));
            search.chosen = place.min(last);
            let entry = found.get(search.chosen);
            chosen = entry.filter(|entry| entry.why_not.is_none()).cloned();
            if found.is_empty() {
                ui.weak("No matches");
            }
            ScrollArea::vertical().max_height(SIZE[1]).show(ui, |ui| {
                for (place, entry) in found.iter().enumerate() {
                    let is_chosen = place == search.chosen;
                    let response = row(ui, entry, is_chosen);
                    if is_chosen && (up || down) {
                        response.scroll_to_me(None);
                    }
                    if response.clicked() {
                        clicked = Some(entry.clone());
                    }
                }
            });
        });
    let entry = clicked.or(chosen.filter(|_| is_run));
    if is_closed || entry.is_some() {
        *open = None;
    }
    entry
}

/// One of those that are found.
fn row(ui: &mut Ui, entry: &Entry, is_chosen: bool) -> Response {
    let button = Button::selectable(is_chosen, entry.text.as_ref())
        .shortcut_text(entry.keys)
        .min_size([ui.available_width(), 0.0].into());
    let response = ui.add_enabled(entry.why_not.is_none(), button);
    let response = match entry.why_not {
        Some(reason) => response.on_disabled_hover_text(reason),
        None => response,
    };
    if entry.hint.is_empty() {
        response
    } else {
        response.on_hover_text(entry.hint)
    }
}
