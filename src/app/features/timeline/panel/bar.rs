//! The bar: what is in memory and what failed, the range that plays, the playhead.

use super::context::TimelineContext;
use crate::app::features::thumbnails::{PICTURE_PX, ThumbnailState, Thumbnails};
use crate::app::theme::{ACCENT, BAD, COARSE, PENDING, RESIDENT};
use crate::app::widgets::numbers::grouped;
use crate::playback::{Mark, MarkRun, Player};
use crate::sequence::{Needs, Slot};
use crate::timeline::PlayRange;
use egui::{Color32, Painter, Rect, Response, Sense, Stroke, Ui, WidgetInfo, pos2, vec2};

/// Height of the bar, points.
const BAR_HEIGHT: f32 = 24.0;

/// Frames narrower than this have no line between them, points.
const MIN_TICK_WIDTH: f32 = 7.0;

/// A broken frame is seen however long the sequence is, points.
const MIN_FAILED_WIDTH: f32 = 3.0;

/// The bar with its playhead, to scrub on; returns the frame whose tooltip is shown.
pub(super) fn scrub_bar(ui: &mut Ui, context: &mut TimelineContext<'_>) -> Option<usize> {
    let size = vec2(ui.available_width(), BAR_HEIGHT);
    let (rect, response) = ui.allocate_exact_size(size, Sense::click_and_drag());
    context.timeline.bar_rect = rect;
    let Some(player) = context.player.as_deref() else {
        ui.painter().rect_filled(rect, 4.0, ui.visuals().extreme_bg_color);
        return None;
    };
    let count = player.sequence().len();
    let playhead = player.waiting_for().unwrap_or(player.clock().frame());
    response.widget_info(|| WidgetInfo::slider(true, (playhead + 1) as f64, "Timeline"));
    paint_bar(ui, rect, player.runs(), count, playhead);
    paint_range(ui, rect, player.clock().range(), count);
    let under_pointer = |response: &Response| {
        response
            .interact_pointer_pos()
            .or(response.hover_pos())
            .map(|pos| frame_at(rect, pos.x, count))
    };
    let frame = under_pointer(&response);
    let hovered = frame.filter(|_| response.hovered() && !response.dragged());
    if let Some(frame) = hovered {
        frame_tooltip(player, context.thumbnails, &context.needs, (response.clone(), frame));
    }
    scrub(context, &response, frame);
    hovered
}

/// The playhead follows the pointer; playing goes on when it is let go.
fn scrub(context: &mut TimelineContext<'_>, response: &Response, frame: Option<usize>) {
    let (Some(frame), Some(player)) = (frame, context.player.as_deref_mut()) else {
        return;
    };
    let now = context.now;
    if response.drag_started() {
        context.timeline.take_playhead(player, now);
    }
    if (response.dragged() || response.clicked()) && player.clock().frame() != frame {
        player.seek(frame, now);
    }
    if response.drag_stopped() {
        context.timeline.let_playhead_go(player, now);
    }
}

/// The frame whose cell is at `x`.
pub(super) fn frame_at(rect: Rect, x: f32, count: usize) -> usize {
    let part = ((x - rect.left()) / rect.width().max(1.0)).clamp(0.0, 1.0);
    ((part * count as f32) as usize).min(count.saturating_sub(1))
}

fn paint_bar(ui: &Ui, rect: Rect, runs: &[MarkRun], count: usize, playhead: usize) {
    let painter = ui.painter_at(rect.expand(2.0));
    painter.rect_filled(rect, 4.0, ui.visuals().extreme_bg_color);
    let count = count.max(1) as f32;
    let x = |frame: usize| rect.left() + rect.width() * frame as f32 / count;
    for run in runs {
        let (color, min_width) = match run.mark {
            Mark::Absent => continue,
            Mark::Pending => (PENDING, 0.0),
            Mark::Coarse => (COARSE, 0.0),
            Mark::Resident => (RESIDENT, 0.0),
            Mark::Failed => (BAD, MIN_FAILED_WIDTH),
        };
        let right = x(run.end).max(x(run.start) + min_width);
        let span = Rect::from_min_max(pos2(x(run.start), rect.top()), pos2(right, rect.bottom()));
        painter.rect_filled(span, 0.0, color);
    }
    let width = rect.width() / count;
    if width >= MIN_TICK_WIDTH {
        let stroke = Stroke::new(1.0, Color32::from_black_alpha(90));
        for frame in 1..count as usize {
            painter.vline(x(frame), rect.y_range(), stroke);
        }
    }
    paint_playhead(&painter, rect, x(playhead), x(playhead + 1));
}

/// What does not play is dark, with a line at either point.
fn paint_range(ui: &Ui, rect: Rect, range: PlayRange, count: usize) {
    let painter = ui.painter_at(rect.expand(2.0));
    let frames = range.of(count);
    let x = |frame: usize| rect.left() + rect.width() * frame as f32 / count.max(1) as f32;
    let shade = |left: f32, right: f32, point: f32| {
        let idle = Rect::from_x_y_ranges(left..=right, rect.y_range());
        painter.rect_filled(idle, 0.0, Color32::from_black_alpha(150));
        painter.vline(point, rect.y_range(), Stroke::new(2.0, ACCENT));
    };
    if range.first().is_some() {
        shade(rect.left(), x(frames.start), x(frames.start));
    }
    if range.last().is_some() {
        shade(x(frames.end), rect.right(), x(frames.end));
    }
}

fn paint_playhead(painter: &Painter, rect: Rect, left: f32, right: f32) {
    let right = right.max(left + 2.0);
    let cell = Rect::from_min_max(pos2(left, rect.top() - 2.0), pos2(right, rect.bottom() + 2.0));
    painter.rect_filled(cell, 2.0, ACCENT.gamma_multiply(0.55));
    let middle = 0.5 * (left + right);
    painter.rect_filled(
        Rect::from_center_size(pos2(middle, rect.center().y), vec2(3.0, rect.height() + 4.0)),
        1.5,
        Color32::WHITE,
    );
}

/// Which frame it is, how it looks, and whether it is in memory.
pub(super) fn frame_tooltip(
    player: &Player,
    thumbnails: &mut Thumbnails,
    needs: &Needs,
    (response, frame): (Response, usize),
) {
    let text = tooltip(player, needs, frame);
    let look = thumbnails.look(&response.ctx, frame);
    response.on_hover_ui_at_pointer(|ui| {
        if let ThumbnailState::Picture(texture) = look {
            ui.image((texture, PICTURE_PX.map(|edge| edge as f32).into()));
        }
        ui.label(text);
    });
}

fn tooltip(player: &Player, needs: &Needs, frame: usize) -> String {
    let sequence = player.sequence();
    let head = format!(
        "Frame {} of {}, {:.2} s\n{}",
        frame + 1,
        sequence.len(),
        player.time_s(frame),
        sequence.entry(frame).name
    );
    let rest = match player.loader().get(frame, needs) {
        Slot::Ready(prepared) => format!("in memory, {} points", grouped(prepared.points.len() as u64)),
        Slot::Coarse(prepared) => format!(
            "in memory, {} of {} points",
            grouped(prepared.points.len() as u64),
            grouped(prepared.frame.points_in_file() as u64)
        ),
        Slot::Partial(prepared) => format!(
            "{} of {} points in memory, being made ready for these settings",
            grouped(prepared.points.len() as u64),
            grouped(prepared.frame.points_in_file() as u64)
        ),
        Slot::Stale(_) => "in memory, being made ready for these settings".to_owned(),
        Slot::Pending => "not in memory".to_owned(),
        Slot::Failed(error) => error.to_string(),
    };
    format!("{head}\n{rest}")
}
