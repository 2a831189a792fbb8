//! Outline of the clip volume, over the image, with handles that are dragged and the numbers next to them.

use super::outline::{edges, foot, plane};
use super::{ClippedFrames, Clipping, Held};
use crate::app::theme::{ACCENT, AXIS_COLORS};
use crate::app::widgets::numbers::with_unit;
use crate::app::widgets::overlay::PictureOverlay;
use crate::cloud::LengthUnit;
use crate::scene::{Clip, ClipShape};
use egui::{Color32, CursorIcon, Pos2, Rect, Response, Sense, Stroke, Ui, Vec2, WidgetInfo, vec2};
use glam::DVec3;

/// Half the edge of a handle's grab area, points.
const GRAB: f32 = 10.0;

/// Radius of a handle, points.
const RADIUS: f32 = 5.0;

/// Height of a number above a handle, points.
const LABEL_HEIGHT: f32 = 30.0;

/// The axes, coloured like those in the corner of the image.
const AXES: [(&str, Color32); 3] = [("X", AXIS_COLORS[0]), ("Y", AXIS_COLORS[1]), ("Z", AXIS_COLORS[2])];

/// Handle that is dragged along a line.
struct Handle {
    name: String,
    /// Position in the coordinates of the file.
    place: DVec3,
    /// Direction of the line; a unit vector.
    direction: DVec3,
    /// Number next to the handle.
    value: f64,
    color: Color32,
}

/// Paints the outline, and has its handles dragged.
pub(in crate::app) fn handles_ui(
    ui: &Ui,
    canvas: &PictureOverlay<'_>,
    clipping: &mut Clipping,
    clip: &mut Clip,
    frames: &ClippedFrames,
    unit: Option<LengthUnit>,
) {
    paint_outline(canvas, clip.shape, frames);
    for (index, handle) in handles(clip.shape, frames).into_iter().enumerate() {
        let Some(center) = canvas.place(handle.place) else {
            continue;
        };
        let area = Rect::from_center_size(center, Vec2::splat(2.0 * GRAB));
        let response = ui
            .interact(area, ui.scope_id().with(("clip handle", index)), Sense::drag())
            .on_hover_and_drag_cursor(CursorIcon::Move);
        response.widget_info(|| WidgetInfo::slider(true, handle.value, &handle.name));
        if let Some(moved) = dragged(canvas, clipping, &handle, &response) {
            clip.shape = with_handle(clip.shape, index, handle.place + handle.direction * moved);
        }
        paint_handle(canvas, &handle, center, response.hovered() || response.dragged(), unit);
    }
}

/// Computes the displacement of a dragged handle from its position in this pass.
fn dragged(canvas: &PictureOverlay<'_>, clipping: &mut Clipping, handle: &Handle, response: &Response) -> Option<f64> {
    let pointer = response.interact_pointer_pos();
    if response.drag_started() {
        // The button rarely goes down exactly at the centre of the handle.
        let slack = pointer.and_then(|pointer| canvas.along_line(handle.place, handle.direction, pointer));
        let slack = slack.unwrap_or(0.0);
        let place = handle.place;
        clipping.held = Some(Held { place, slack });
    }
    let held = clipping.held.filter(|_| response.dragged())?;
    let along = canvas.along_line(held.place, handle.direction, pointer?)? - held.slack;
    Some(along - (handle.place - held.place).dot(handle.direction))
}

/// Creates the handles: one at the centre of each side of a box; the foot of a plane.
fn handles(shape: ClipShape, frames: &ClippedFrames) -> Vec<Handle> {
    match shape {
        ClipShape::Box { min, max } => {
            let side = |side: usize| {
                let (axis, is_max) = (side / 2, side % 2 == 1);
                let mut place = min.midpoint(max);
                let end = if is_max { max } else { min };
                place[axis] = end[axis];
                let (name, color) = AXES[axis];
                Handle {
                    name: format!("{name} {} in the view", if is_max { "to" } else { "from" }),
                    place,
                    direction: DVec3::AXES[axis],
                    value: end[axis],
                    color,
                }
            };
            (0..6).map(side).collect()
        }
        ClipShape::Plane { normal, offset } => {
            let Some(direction) = normal.try_normalize() else {
                return Vec::new();
            };
            let place = foot(direction, offset / normal.length(), frames.corners());
            let axis = DVec3::AXES.iter().position(|axis| *axis == direction);
            vec![Handle {
                name: "Plane in the view".to_owned(),
                place,
                direction,
                value: offset,
                color: axis.map_or(ACCENT, |axis| AXES[axis].1),
            }]
        }
    }
}

/// The shape whose handle is at another place; the corners of a box stay in order.
fn with_handle(shape: ClipShape, handle: usize, place: DVec3) -> ClipShape {
    match shape {
        ClipShape::Box { mut min, mut max } => {
            let axis = handle / 2;
            if handle % 2 == 1 {
                max[axis] = place[axis].max(min[axis]);
            } else {
                min[axis] = place[axis].min(max[axis]);
            }
            ClipShape::Box { min, max }
        }
        ClipShape::Plane { normal, .. } => {
            let offset = normal.dot(place);
            ClipShape::Plane { normal, offset }
        }
    }
}

fn paint_outline(canvas: &PictureOverlay<'_>, shape: ClipShape, frames: &ClippedFrames) {
    let stroke = Stroke::new(1.0, ACCENT);
    match shape {
        ClipShape::Box { min, max } => {
            for edge in edges([min, max]) {
                canvas.line(edge, stroke);
            }
        }
        ClipShape::Plane { normal, offset } => {
            let length = normal.length();
            if length > 0.0 {
                let outline = plane(normal / length, offset / length, frames.corners());
                canvas.polyline(&outline, stroke);
            }
        }
    }
}

fn paint_handle(canvas: &PictureOverlay<'_>, handle: &Handle, center: Pos2, is_held: bool, unit: Option<LengthUnit>) {
    let (fill, radius) = if is_held {
        (Color32::WHITE, RADIUS + 1.5)
    } else {
        (handle.color, RADIUS)
    };
    canvas.knob(center, radius, fill);
    // Above the handle, unless the image ends there.
    let above = if canvas.has_space_above(center, LABEL_HEIGHT) {
        -1.0
    } else {
        1.0
    };
    let place = center + vec2(0.0, above * (RADIUS + 12.0));
    canvas.label(place, &with_unit(handle.value, unit));
}
