//! Clipping controls for the part of the cloud that is drawn: a box or one side of a plane, in the coordinates of the
//! file.

use super::{ClipFit, ClippedFrames, Clipping};
use crate::app::widgets::rows::{choice, row, rows};
use crate::messages::grouped;
use crate::scene::{Clip, ClipShape};
use egui::{Button, Checkbox, DragValue, Ui};
use glam::DVec3;

/// Dragging distance that moves an edge over the whole cloud, points of the screen.
const DRAG_POINTS: f64 = 300.0;

const AXES: [(&str, DVec3); 3] = [("X", DVec3::X), ("Y", DVec3::Y), ("Z", DVec3::Z)];

#[derive(Clone, Copy, PartialEq)]
enum ClipKind {
    Off,
    Box,
    Plane,
}

fn kind_of(clip: Option<Clip>) -> ClipKind {
    match clip {
        Some(Clip { is_on: true, shape, .. }) => match shape {
            ClipShape::Box { .. } => ClipKind::Box,
            ClipShape::Plane { .. } => ClipKind::Plane,
        },
        _ => ClipKind::Off,
    }
}

/// Context that the section shows and changes.
pub(super) struct ClipContext<'a> {
    pub(super) clip: &'a mut Option<Clip>,
    pub(super) clipping: &'a mut Clipping,
    /// `None` while nothing is shown.
    pub(super) frames: Option<ClippedFrames>,
    /// The points of the last angle that was measured.
    pub(super) angle: Option<[DVec3; 3]>,
}

/// The section of the settings.
pub(super) fn clip_ui(ui: &mut Ui, context: &mut ClipContext<'_>) {
    let Some(frames) = context.frames else {
        ui.weak("Nothing is shown yet");
        return;
    };
    let ClipContext { clip, clipping, .. } = context;
    rows(ui, "clip", |ui| {
        kind(ui, clip, clipping, &frames);
        if let Some(clip) = clip.as_mut().filter(|clip| clip.is_on) {
            sides(ui, clip);
            let speed = frames.extent() / DRAG_POINTS;
            match &mut clip.shape {
                ClipShape::Box { min, max } => edges(ui, [min, max], speed),
                ClipShape::Plane { .. } => plane(ui, &mut clip.shape, &frames, speed),
            }
            let tooltip = "Shows the box or the plane over the view, with handles to drag; never exported";
            row(
                ui,
                "Outline",
                tooltip,
                Checkbox::new(&mut clipping.shows_outline, "Shown"),
            );
        }
    });
    if let Some(clip) = clip.as_mut().filter(|clip| clip.is_on) {
        fits(ui, clip, clipping, &frames);
        if matches!(clip.shape, ClipShape::Plane { .. }) {
            through_three(ui, clip, context.angle);
        }
    }
}

/// Puts the shape around one frame or all.
fn fits(ui: &mut Ui, clip: &mut Clip, clipping: &mut Clipping, frames: &ClippedFrames) {
    ui.horizontal(|ui| {
        ui.label("Fit to");
        for (fit, text, tooltip) in [
            (
                ClipFit::ThisFrame,
                "This frame",
                "Fits the box to the current frame, or puts the plane through its centre; other frames may be cut \
                    off",
            ),
            (
                ClipFit::AllFrames,
                "All frames",
                "Fits the box to all frames, or puts the plane through their centre; a box grows with frames that \
                    are read later, until it is changed",
            ),
        ] {
            if ui.button(text).on_hover_text(tooltip).clicked() {
                clipping.fit(&mut clip.shape, frames, fit);
            }
        }
    });
    let all = frames.all;
    if clipping.is_around_all(clip) && all.known < all.count {
        ui.weak(format!(
            "Around the {} of {} frames that were read",
            grouped(all.known),
            grouped(all.count)
        ));
    }
}

/// Puts a plane through the last angle.
fn through_three(ui: &mut Ui, clip: &mut Clip, angle: Option<[DVec3; 3]>) {
    let through = angle.and_then(ClipShape::through);
    let button = Button::new("Through three points");
    let tooltip = "The plane through the three points of the last angle that was measured (M, Angle)";
    let button = ui
        .add_enabled(through.is_some(), button)
        .on_hover_text(tooltip)
        .on_disabled_hover_text(tooltip);
    if let Some(through) = through.filter(|_| button.clicked()) {
        clip.shape = through;
    }
}

fn kind(ui: &mut Ui, clip: &mut Option<Clip>, clipping: &mut Clipping, frames: &ClippedFrames) {
    let before = kind_of(*clip);
    let mut chosen = before;
    choice(
        ui,
        "Clipping",
        "Draws a part of the cloud: points, splats and voxels whose centre is inside. Byte codes cannot be \
            clipped: their surfels are drawn as disks",
        &mut chosen,
        &[
            ("Off", ClipKind::Off, "All is drawn"),
            ("To a box", ClipKind::Box, "The inside of a box"),
            ("At a plane", ClipKind::Plane, "One side of a plane"),
        ],
    );
    if chosen == before {
        return;
    }
    let known = clip.filter(|clip| kind_of(Some(Clip { is_on: true, ..*clip })) == chosen);
    *clip = match (chosen, *clip) {
        (ClipKind::Off, Some(clip)) => Some(Clip { is_on: false, ..clip }),
        (ClipKind::Off, None) => None,
        (kind, _) => {
            let clip = known.unwrap_or_else(|| {
                let shape = match kind {
                    ClipKind::Plane => frames.through_center(DVec3::X, ClipFit::AllFrames),
                    ClipKind::Box | ClipKind::Off => frames.around(ClipFit::AllFrames),
                };
                clipping.note_fit(shape, ClipFit::AllFrames);
                Clip::to(shape)
            });
            Some(Clip { is_on: true, ..clip })
        }
    };
}

fn sides(ui: &mut Ui, clip: &mut Clip) {
    let [retained, other] = match clip.shape {
        ClipShape::Box { .. } => ["Inside".to_owned(), "Outside".to_owned()],
        ClipShape::Plane { normal, .. } => match AXES.iter().find(|(_, axis)| *axis == normal) {
            Some((name, _)) => [format!("+{name} side"), format!("\u{2212}{name} side")],
            None => ["Side of its normal".to_owned(), "Other side".to_owned()],
        },
    };
    let tooltip = "Which part of the cloud is drawn";
    let choices = [(retained.as_str(), false, tooltip), (other.as_str(), true, tooltip)];
    choice(ui, "Keep", tooltip, &mut clip.keeps_outside, &choices);
}

fn edges(ui: &mut Ui, [min, max]: [&mut DVec3; 2], speed: f64) {
    for (axis, (name, _)) in AXES.iter().enumerate() {
        let (least, most) = (min[axis], max[axis]);
        let edge = |value| DragValue::new(value).speed(speed).max_decimals(6);
        row(
            ui,
            &format!("{name} from"),
            "The smaller edge of the box along this axis of the file, scene units",
            edge(&mut min[axis]).range(f64::NEG_INFINITY..=most),
        );
        row(
            ui,
            &format!("{name} to"),
            "The larger edge of the box along this axis of the file, scene units",
            edge(&mut max[axis]).range(least..=f64::INFINITY),
        );
    }
}

fn plane(ui: &mut Ui, shape: &mut ClipShape, frames: &ClippedFrames, speed: f64) {
    let ClipShape::Plane { normal, offset } = shape else {
        return;
    };
    let before = *normal;
    let axes = AXES.map(|(name, axis)| (name, axis, "The plane is perpendicular to this axis of the file"));
    choice(
        ui,
        "Plane across",
        "The axis of the file to which the plane is perpendicular",
        normal,
        &axes,
    );
    let tooltip = "Where the plane is along the axis (or its normal) in the coordinates of the file, scene units";
    let place = DragValue::new(offset).speed(speed).max_decimals(6);
    row(ui, "Plane at", tooltip, place);
    if *normal != before {
        *shape = frames.through_center(*normal, ClipFit::AllFrames);
    }
}
