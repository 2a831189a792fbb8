//! Gaps in the numbering of frame names: a notch on the bar.

use super::cells::Cells;
use super::context::TimelineContext;
use crate::app::theme::ODD;
use egui::{Rect, Role, Sense, Shape, Stroke, Ui, WidgetInfo, pos2};

/// Half the width of a notch, points.
const HALF_WIDTH: f32 = 5.0;

/// More notches than this are painted, but tell nothing.
const MAX_TOLD: usize = 500;

/// Notches of the visible gaps, each with its missing numbers.
pub(super) fn gaps_ui(ui: &Ui, context: &mut TimelineContext<'_>) {
    let Some(player) = context.player.as_deref() else {
        return;
    };
    let sequence = player.sequence();
    let timeline = &mut *context.timeline;
    let cells = Cells {
        rect: timeline.bar_rect,
        frames: timeline.visible.of(sequence.len()),
    };
    let painter = ui.painter_at(cells.rect.expand(2.0));
    let inner = cells.frames.start + 1..cells.frames.end;
    let gaps = timeline.gaps(sequence).iter();
    for (index, gap) in gaps.filter(|gap| inner.contains(&(gap.after + 1))).enumerate() {
        let x = cells.x(gap.after + 1);
        let top = cells.rect.top();
        let notch = vec![
            pos2(x - HALF_WIDTH, top),
            pos2(x + HALF_WIDTH, top),
            pos2(x, top + 1.4 * HALF_WIDTH),
        ];
        painter.add(Shape::convex_polygon(notch, ODD, Stroke::NONE));
        painter.vline(x, cells.rect.y_range(), Stroke::new(1.0, ODD));
        if index >= MAX_TOLD {
            continue;
        }
        let (first, last) = (gap.numbers.start(), gap.numbers.end());
        let text = if gap.count == 1 {
            format!("File {first} is missing here")
        } else {
            format!("{} files are missing here: {first} to {last}", gap.count)
        };
        let place = Rect::from_x_y_ranges(x - HALF_WIDTH..=x + HALF_WIDTH, cells.rect.y_range());
        let response = ui.interact(place, ui.scope_id().with(("gap", gap.after)), Sense::hover());
        response.widget_info(|| WidgetInfo::labeled(Role::Image, true, &text));
        response.on_hover_text(format!("{text}. The frames play one after the other"));
    }
}
