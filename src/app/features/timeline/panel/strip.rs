//! The strip of thumbnails over the bar.

use super::bar::frame_tooltip;
use super::context::TimelineContext;
use crate::app::features::thumbnails::{MAX_CELLS, PICTURE_PX, ThumbnailState, strip_frames};
use crate::app::theme::{ACCENT, BAD};
use egui::{Color32, Painter, Rect, Role, Sense, Stroke, StrokeKind, TextureId, Ui, WidgetInfo, pos2, vec2};

/// Height of the strip, points.
const HEIGHT: f32 = 45.0;

/// Width of a thumbnail at the strip's height, plus the space between two, points.
const CELL_WIDTH: f32 = HEIGHT * PICTURE_PX[0] as f32 / PICTURE_PX[1] as f32 + 2.0;

/// Shows the thumbnails that fit, each of the frame at its position; a click goes there. Returns the frame whose
/// tooltip is shown.
pub(super) fn strip_ui(ui: &mut Ui, context: &mut TimelineContext<'_>) -> Option<usize> {
    let player = context.player.as_deref().filter(|_| context.thumbnails.is_on)?;
    let count = player.sequence().len();
    let playhead = player.waiting_for().unwrap_or(player.clock().frame());
    let size = vec2(ui.available_width(), HEIGHT);
    let (strip, _) = ui.allocate_exact_size(size, Sense::hover());
    let cells = (strip.width() / CELL_WIDTH).max(1.0) as usize;
    let visible = context.timeline.visible.of(count);
    let frames = strip_frames(visible.len(), cells.min(MAX_CELLS));
    let frames: Vec<usize> = frames.into_iter().map(|frame| visible.start + frame).collect();
    context.thumbnails.want(frames.clone());
    ui.painter().rect_filled(strip, 4.0, ui.visuals().extreme_bg_color);
    let nearest = frames.iter().min_by_key(|frame| frame.abs_diff(playhead));
    let nearest = nearest.copied();
    let mut hovered = None;
    let mut clicked = None;
    for (number, &frame) in frames.iter().enumerate() {
        let x = |edge: usize| strip.left() + strip.width() * edge as f32 / frames.len() as f32;
        let cell = Rect::from_x_y_ranges(x(number)..=x(number + 1), strip.y_range());
        let response = ui.interact(cell, ui.scope_id().with(("thumbnail", frame)), Sense::click());
        let look = context.thumbnails.look(ui.ctx(), frame);
        let name = match look {
            ThumbnailState::Picture(_) => format!("Thumbnail of frame {}", frame + 1),
            ThumbnailState::Broken => format!("Frame {} cannot be read", frame + 1),
            ThumbnailState::Unknown => format!("Frame {} has no thumbnail yet", frame + 1),
        };
        response.widget_info(|| WidgetInfo::labeled(Role::Button, true, &name));
        paint(ui, cell, look);
        if nearest == Some(frame) {
            let stroke = Stroke::new(1.5, ACCENT);
            ui.painter()
                .rect_stroke(picture_rect(cell), 2.0, stroke, StrokeKind::Inside);
        }
        if response.clicked() {
            clicked = Some(frame);
        }
        if response.hovered() {
            hovered = Some(frame);
            frame_tooltip(player, context.thumbnails, &context.needs, response, frame);
        }
    }
    if let Some(frame) = clicked {
        context.seek(frame);
    }
    hovered
}

/// Returns the rectangle of the thumbnail, centred in its cell.
fn picture_rect(cell: Rect) -> Rect {
    let height = cell.height();
    let width = (CELL_WIDTH - 2.0).min(cell.width());
    Rect::from_center_size(cell.center(), vec2(width, height))
}

fn paint(ui: &Ui, cell: Rect, look: ThumbnailState) {
    let rect = picture_rect(cell);
    let painter = &ui.painter_at(cell);
    match look {
        ThumbnailState::Picture(texture) => paint_picture(painter, rect, texture),
        ThumbnailState::Broken => {
            painter.rect_filled(rect, 2.0, BAD.gamma_multiply(0.18));
            let [left, right] = [-7.0, 7.0].map(|x| rect.center() + vec2(x, -7.0));
            let stroke = Stroke::new(2.0, BAD);
            painter.line_segment([left, left + vec2(14.0, 14.0)], stroke);
            painter.line_segment([right, right + vec2(-14.0, 14.0)], stroke);
        }
        // A white cell in a light window would look like an image.
        ThumbnailState::Unknown => _ = painter.rect_filled(rect, 2.0, ui.visuals().faint_bg_color),
    }
}

/// Paints the full height, cropped to the available width.
fn paint_picture(painter: &Painter, rect: Rect, texture: TextureId) {
    let share = rect.width() / (CELL_WIDTH - 2.0);
    let uv = Rect::from_min_max(pos2(0.5 - 0.5 * share, 0.0), pos2(0.5 + 0.5 * share, 1.0));
    painter.image(texture, rect, uv, Color32::WHITE);
}
