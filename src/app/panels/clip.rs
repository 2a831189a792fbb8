//! What of the cloud is drawn: a box or one side of a plane, in the coordinates of the file.

use super::settings::{choice, heading, row, rows};
use crate::math::Aabb;
use crate::scene::{Clip, ClipShape};
use egui::{DragValue, Ui};
use glam::DVec3;

/// Edges are dragged over the whole cloud in so many points of the screen.
const DRAG_POINTS: f64 = 300.0;

const AXES: [(&str, DVec3); 3] = [("X", DVec3::X), ("Y", DVec3::Y), ("Z", DVec3::Z)];

#[derive(Clone, Copy, PartialEq)]
enum ClipKind {
    Off,
    Box,
    Plane,
}

/// The shown frame: the box around it and the origin of its positions.
pub(super) struct ClippedFrame {
    pub(super) bounds: Aabb,
    pub(super) origin: DVec3,
}

impl ClippedFrame {
    fn shape(&self, kind: ClipKind) -> ClipShape {
        match kind {
            ClipKind::Plane => self.plane(DVec3::X),
            ClipKind::Box | ClipKind::Off => ClipShape::around(&self.bounds, self.origin),
        }
    }

    /// Through the middle.
    fn plane(&self, normal: DVec3) -> ClipShape {
        let middle = self.origin + self.bounds.center().as_dvec3();
        ClipShape::Plane {
            normal,
            offset: normal.dot(middle),
        }
    }

    /// Scene units a point of the screen.
    fn drag_speed(&self) -> f64 {
        f64::from(self.bounds.extent().max_element()).max(f64::from(f32::MIN_POSITIVE)) / DRAG_POINTS
    }
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

/// The section of the settings. `angle` are the points of the last angle that was measured.
pub(super) fn clip_ui(ui: &mut Ui, clip: &mut Option<Clip>, shown: Option<ClippedFrame>, angle: Option<[DVec3; 3]>) {
    heading(ui, "Clip");
    let Some(shown) = shown else {
        ui.weak("Nothing is shown yet");
        return;
    };
    rows(ui, "clip", |ui| {
        kind(ui, clip, &shown);
        if let Some(clip) = clip.as_mut().filter(|clip| clip.is_on) {
            sides(ui, clip);
            match &mut clip.shape {
                ClipShape::Box { min, max } => edges(ui, [min, max], shown.drag_speed()),
                ClipShape::Plane { .. } => plane(ui, &mut clip.shape, &shown),
            }
        }
    });
    let Some(clip) = clip.as_mut().filter(|clip| clip.is_on) else {
        return;
    };
    ui.horizontal(|ui| {
        let fit = ui.button("Fit to frame");
        let tooltip = "The box around the frame that is shown; of a plane, the one through its middle";
        if fit.on_hover_text(tooltip).clicked() {
            clip.shape = match clip.shape {
                ClipShape::Box { .. } => shown.shape(ClipKind::Box),
                ClipShape::Plane { normal, .. } => shown.plane(normal),
            };
        }
        if matches!(clip.shape, ClipShape::Plane { .. }) {
            let through = angle.and_then(ClipShape::through);
            let button = egui::Button::new("Through three points");
            let tooltip = "The plane through the three points of the last angle that was measured (M, Angle)";
            let button = ui
                .add_enabled(through.is_some(), button)
                .on_hover_text(tooltip)
                .on_disabled_hover_text(tooltip);
            if let Some(through) = through.filter(|_| button.clicked()) {
                clip.shape = through;
            }
        }
    });
}

fn kind(ui: &mut Ui, clip: &mut Option<Clip>, shown: &ClippedFrame) {
    let before = kind_of(*clip);
    let mut chosen = before;
    choice(
        ui,
        "Clipping",
        "Draws a part of the cloud: a point, splat or voxel stays where its middle is inside. Byte codes cannot be \
         cut: their surfels are drawn as disks meanwhile",
        &mut chosen,
        &[
            ("Off", ClipKind::Off, "All is drawn"),
            ("To a box", ClipKind::Box, "What is between two corners"),
            ("At a plane", ClipKind::Plane, "What is on one side of a plane"),
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
            let clip = known.unwrap_or_else(|| Clip::to(shown.shape(kind)));
            Some(Clip { is_on: true, ..clip })
        }
    };
}

fn sides(ui: &mut Ui, clip: &mut Clip) {
    choice(
        ui,
        "Keeps",
        "Which part of the cloud is drawn",
        &mut clip.keeps_outside,
        &[
            (
                "Inside",
                false,
                "What is in the box, or on the side to which the plane's normal points",
            ),
            ("Outside", true, "All but that"),
        ],
    );
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

fn plane(ui: &mut Ui, shape: &mut ClipShape, shown: &ClippedFrame) {
    let ClipShape::Plane { normal, offset } = shape else {
        return;
    };
    let before = *normal;
    let axes = AXES.map(|(name, axis)| (name, axis, "The plane stands across this axis of the file"));
    choice(
        ui,
        "Plane across",
        "The axis of the file to which the plane is perpendicular",
        normal,
        &axes,
    );
    let tooltip = "Where the plane is along the axis (or its normal) in the coordinates of the file, scene units";
    let place = DragValue::new(offset).speed(shown.drag_speed()).max_decimals(6);
    row(ui, "Plane at", tooltip, place);
    if *normal != before {
        *shape = shown.plane(*normal);
    }
}
