//! In and out point on the bar: the part outside of them is dark, and both lines can be dragged.

use super::cells::Cells;
use super::context::TimelineContext;
use crate::app::theme::ACCENT;
use crate::timeline::PlayRange;
use egui::{Color32, CursorIcon, Rect, Sense, Stroke, Ui, WidgetInfo, pos2};

/// Half the width of a line's grab area, points.
const GRAB: f32 = 5.0;

/// Size of the grip at the head of a line, points.
const GRIP: [f32; 2] = [6.0, 8.0];

/// Paints the points that are set over the bar, and lets them be dragged. True if one was let go elsewhere.
pub(super) fn range_ui(ui: &mut Ui, context: &mut TimelineContext<'_>) -> bool {
    let rect = context.timeline.bar_rect;
    let Some(player) = context.player.as_deref_mut() else {
        return false;
    };
    let count = player.sequence().len();
    let range = player.clock().range();
    let cells = Cells {
        rect,
        frames: context.timeline.visible.of(count),
    };
    paint(ui, &cells, range, count);
    let frames = range.of(count);
    let mut is_let_go = false;
    for is_in in [true, false] {
        let (name, point, edge) = if is_in {
            ("In point", range.first(), frames.start)
        } else {
            ("Out point", range.last(), frames.end)
        };
        if point.is_none() || !(cells.frames.start..=cells.frames.end).contains(&edge) {
            continue;
        }
        let x = cells.x(edge);
        let grab = Rect::from_x_y_ranges(x - GRAB..=x + GRAB, rect.y_range());
        let handle = ui
            .interact(grab, ui.scope_id().with(name), Sense::drag())
            .on_hover_and_drag_cursor(CursorIcon::ResizeHorizontal);
        let shown = if is_in { edge + 1 } else { edge };
        handle.widget_info(|| WidgetInfo::slider(true, shown as f64, name));
        if let Some(pointer) = handle.interact_pointer_pos().filter(|_| handle.dragged()) {
            // At least one frame stays between the in and out points.
            let edge = cells.edge_at(pointer.x);
            let moved = if is_in {
                range.beginning_at(edge.min(frames.end.saturating_sub(1)))
            } else {
                range.ending_at(edge.max(frames.start + 1) - 1)
            };
            if moved != range {
                player.set_range(moved, context.now);
            }
        }
        is_let_go |= handle.drag_stopped();
        handle.on_hover_text(format!("{name}, frame {shown}: drag it (Shift+X clears both)"));
    }
    is_let_go
}

/// Paints the play range: the part outside is dark, with a line at either point.
fn paint(ui: &Ui, cells: &Cells, range: PlayRange, count: usize) {
    let rect = cells.rect;
    let painter = ui.painter_at(rect.expand(4.0));
    let frames = range.of(count);
    let shade = |left: f32, right: f32, edge: usize| {
        let idle = Rect::from_x_y_ranges(left..=right, rect.y_range());
        painter.rect_filled(idle, 0.0, Color32::from_black_alpha(150));
        if (cells.frames.start..=cells.frames.end).contains(&edge) {
            let point = cells.x(edge);
            painter.vline(point, rect.y_range(), Stroke::new(2.0, ACCENT));
            let grip = Rect::from_center_size(pos2(point, rect.top() + 2.0), GRIP.into());
            painter.rect_filled(grip, 1.5, ACCENT);
        }
    };
    if range.first().is_some() {
        shade(rect.left(), cells.x_within(frames.start), frames.start);
    }
    if range.last().is_some() {
        shade(cells.x_within(frames.end), rect.right(), frames.end);
    }
}
