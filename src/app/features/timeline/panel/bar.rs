//! The bar: frames in memory and failed ones, the play range, the playhead.

use super::cells::Cells;
use super::context::TimelineContext;
use crate::app::features::thumbnails::{PICTURE_PX, ThumbnailState, Thumbnails};
use crate::app::features::timeline::VisibleFrames;
use crate::app::theme::{ACCENT, BAD, COARSE, PENDING, RESIDENT};
use crate::messages::grouped;
use crate::playback::{Mark, MarkRun, Player};
use crate::sequence::{Needs, Sequence, Slot};
use egui::{Color32, Painter, Rect, Response, Sense, Stroke, Ui, WidgetInfo, pos2, vec2};

/// Height of the bar, points.
const BAR_HEIGHT: f32 = 24.0;

/// Frames narrower than this have no line between them, points.
const MIN_TICK_WIDTH: f32 = 7.0;

/// A notch of a wheel scrolls about 50 points.
const ZOOM_PER_POINT: f64 = 0.004;

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
    let visible = &mut context.timeline.visible;
    if player.is_playing() {
        visible.turn_to(playhead, count);
    }
    turn_wheel(ui, &response, visible, count);
    let cells = Cells {
        rect,
        frames: visible.of(count),
    };
    paint_bar(ui, &cells, player.runs(), playhead);
    let under_pointer = |response: &Response| {
        response
            .interact_pointer_pos()
            .or(response.hover_pos())
            .map(|pos| cells.frame_at(pos.x))
    };
    let frame = under_pointer(&response);
    let hovered = frame.filter(|_| response.hovered() && !response.dragged());
    if let Some(frame) = hovered {
        frame_tooltip(player, context.thumbnails, &context.needs, response.clone(), frame);
    }
    scrub(context, &response, frame);
    hovered
}

/// The playhead follows the pointer; playing continues when it is released.
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

/// The wheel shows fewer frames around the pointer, or more; sideways it scrolls.
fn turn_wheel(ui: &Ui, response: &Response, visible: &mut VisibleFrames, count: usize) {
    let Some(pointer) = response.hover_pos().filter(|_| response.hovered()) else {
        return;
    };
    let (scroll, pinch) = ui.input(|input| (input.smooth_scroll_delta(), input.zoom_delta()));
    let factor = (-f64::from(scroll.y) * ZOOM_PER_POINT).exp() / f64::from(pinch.max(0.01));
    if factor != 1.0 {
        let share = (pointer.x - response.rect.left()) / response.rect.width().max(1.0);
        visible.zoom(factor, f64::from(share.clamp(0.0, 1.0)), count);
    }
    if scroll.x != 0.0 {
        visible.pan(f64::from(-scroll.x / response.rect.width().max(1.0)), count);
    }
}

fn paint_bar(ui: &Ui, cells: &Cells, runs: &[MarkRun], playhead: usize) {
    let rect = cells.rect;
    let painter = ui.painter_at(rect.expand(2.0));
    painter.rect_filled(rect, 4.0, ui.visuals().extreme_bg_color);
    for run in runs {
        let (color, min_width) = match run.mark {
            Mark::Absent => continue,
            Mark::Pending => (PENDING, 0.0),
            Mark::Coarse => (COARSE, 0.0),
            Mark::Resident => (RESIDENT, 0.0),
            Mark::Failed => (BAD, MIN_FAILED_WIDTH),
        };
        if run.end <= cells.frames.start || run.start >= cells.frames.end {
            continue;
        }
        let left = cells.x_within(run.start);
        let right = cells.x_within(run.end).max(left + min_width);
        let span = Rect::from_min_max(pos2(left, rect.top()), pos2(right, rect.bottom()));
        painter.rect_filled(span, 0.0, color);
    }
    if cells.width() >= MIN_TICK_WIDTH {
        let stroke = Stroke::new(1.0, Color32::from_black_alpha(90));
        for frame in cells.frames.clone().skip(1) {
            painter.vline(cells.x(frame), rect.y_range(), stroke);
        }
    }
    if cells.frames.contains(&playhead) {
        paint_playhead(&painter, rect, cells.x(playhead), cells.x(playhead + 1));
    }
}

fn paint_playhead(painter: &Painter, rect: Rect, left: f32, right: f32) {
    let right = right.max(left + 2.0);
    let cell = Rect::from_min_max(pos2(left, rect.top() - 2.0), pos2(right, rect.bottom() + 2.0));
    painter.rect_filled(cell, 2.0, ACCENT.gamma_multiply(0.55));
    let center = 0.5 * (left + right);
    painter.rect_filled(
        Rect::from_center_size(pos2(center, rect.center().y), vec2(3.0, rect.height() + 4.0)),
        1.5,
        Color32::WHITE,
    );
}

/// Shows the tooltip of a frame: its number, thumbnail, and residency in memory.
pub(super) fn frame_tooltip(
    player: &Player,
    thumbnails: &mut Thumbnails,
    needs: &Needs,
    response: Response,
    frame: usize,
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

/// The number in the name of a frame, where it differs from its position. A single frame has none: its name has it
/// already.
pub(super) fn own_number(sequence: &Sequence, frame: usize) -> Option<u64> {
    let number = sequence.entry(frame).number.filter(|_| sequence.len() > 1)?;
    (number != frame as u64 + 1).then_some(number)
}

fn tooltip(player: &Player, needs: &Needs, frame: usize) -> String {
    let sequence = player.sequence();
    let head = format!(
        "Frame {} of {}{}, {:.2} s\n{}",
        grouped(frame + 1),
        grouped(sequence.len()),
        own_number(sequence, frame).map_or_else(String::new, |number| format!(" (file {number})")),
        player.time_s(frame),
        sequence.entry(frame).name
    );
    let rest = match player.loader().get(frame, needs) {
        Slot::Ready(prepared) => format!("in memory, {} points", grouped(prepared.points.len())),
        Slot::Coarse(prepared) => format!(
            "in memory, {} of {} points",
            grouped(prepared.points.len()),
            grouped(prepared.frame.points_in_file())
        ),
        Slot::Partial(prepared) => format!(
            "{} of {} points in memory, being made ready for these settings",
            grouped(prepared.points.len()),
            grouped(prepared.frame.points_in_file())
        ),
        Slot::Stale(_) => "in memory, being made ready for these settings".to_owned(),
        Slot::Pending => "not in memory".to_owned(),
        Slot::Failed(error) => error.to_string(),
    };
    format!("{head}\n{rest}")
}
