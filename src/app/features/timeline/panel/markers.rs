//! Flags above the bar, one a marker.

use super::cells::Cells;
use super::context::TimelineContext;
use crate::app::features::timeline::Timeline;
use crate::app::theme::ODD;
use crate::messages::frame_place;
use egui::{Key, Painter, Rect, Role, Sense, Shape, Stroke, TextEdit, Ui, WidgetInfo, Window, pos2, vec2};

/// Size of a flag, points.
const FLAG: [f32; 2] = [10.0, 11.0];

/// Action requested on a marker.
#[derive(Clone, Copy)]
enum Wish {
    GoTo,
    Rename,
    Remove,
}

/// A row of flags, if there are any; a window for the name of one while it is written. True if there are other marks.
pub(super) fn markers_ui(ui: &mut Ui, context: &mut TimelineContext<'_>) -> bool {
    let Some(player) = &context.player else {
        return false;
    };
    let count = player.sequence().len();
    if context.timeline.markers.list().is_empty() {
        return false;
    }
    let size = vec2(ui.available_width(), FLAG[1]);
    let (row, _) = ui.allocate_exact_size(size, Sense::hover());
    let cells = Cells {
        rect: row,
        frames: context.timeline.visible.of(count),
    };
    let mut wish = None;
    for marker in context.timeline.markers.list() {
        let frame = marker.frame;
        if frame >= count {
            break;
        }
        if !cells.frames.contains(&frame) {
            continue;
        }
        let x = cells.x(frame) + 0.5 * cells.width();
        let flag = Rect::from_center_size(pos2(x, row.center().y), FLAG.into());
        let response = ui.interact(flag, ui.scope_id().with(("marker", frame)), Sense::click());
        let name = match marker.name.as_str() {
            "" => format!("Marker at frame {}", frame + 1),
            name => format!("Marker {name}"),
        };
        response.widget_info(|| WidgetInfo::labeled(Role::Button, true, &name));
        paint_flag(ui.painter(), flag, response.hovered());
        if response.double_clicked() {
            wish = Some((frame, Wish::Rename));
        } else if response.clicked() {
            wish = wish.or(Some((frame, Wish::GoTo)));
        }
        response.context_menu(|ui| {
            for (text, chosen) in [("Rename", Wish::Rename), ("Remove", Wish::Remove)] {
                if ui.button(text).clicked() {
                    wish = Some((frame, chosen));
                    ui.close();
                }
            }
        });
        response.on_hover_text(format!(
            "{name}, {}\nClick: go there. Double click: name it. Right click: more",
            frame_place(frame, count)
        ));
    }
    match wish {
        Some((frame, Wish::GoTo)) => context.seek(frame),
        Some((frame, Wish::Rename)) => context.timeline.begin_renaming(frame),
        Some((frame, Wish::Remove)) => context.timeline.toggle_marker(frame),
        None => {}
    }
    let is_named = name_ui(ui, context.timeline);
    is_named || matches!(wish, Some((_, Wish::Remove)))
}

/// Asks for a name; Enter or a click elsewhere takes it, Esc leaves the old one. True if there is another one.
fn name_ui(ui: &Ui, timeline: &mut Timeline) -> bool {
    let Some((frame, name)) = &mut timeline.renaming else {
        return false;
    };
    let screen = ui.ctx().content_rect();
    let mut is_done = false;
    Window::new(format!("Marker at frame {}", *frame + 1))
        .collapsible(false)
        .resizable(false)
        .pivot(egui::Align2::CENTER_CENTER)
        .default_pos(screen.center())
        .show(ui.ctx(), |ui| {
            let edit = ui.add(TextEdit::singleline(name).hint_text("Name").desired_width(240.0));
            ui.ctx()
                .accesskit_node_builder(edit.id, |node| node.set_label("Name of the marker"));
            is_done = edit.lost_focus();
            if !is_done && !edit.has_focus() {
                edit.request_focus();
            }
            edit.on_hover_text("Name of the marker; Enter accepts, Esc cancels");
        });
    if ui.input(|input| input.key_pressed(Key::Escape)) {
        timeline.renaming = None;
        return false;
    }
    if is_done {
        timeline.finish_renaming();
    }
    is_done
}

/// A pennant that points down to its frame.
fn paint_flag(painter: &Painter, flag: Rect, is_hovered: bool) {
    let color = if is_hovered { ODD } else { ODD.gamma_multiply(0.8) };
    let shoulder = flag.top() + 0.5 * flag.height();
    let outline = vec![
        flag.left_top(),
        flag.right_top(),
        pos2(flag.right(), shoulder),
        flag.center_bottom(),
        pos2(flag.left(), shoulder),
    ];
    painter.add(Shape::convex_polygon(outline, color, Stroke::NONE));
}
