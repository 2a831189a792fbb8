//! Points that a user has clicked on, and their positions in the shown frame.

mod anchor;
mod in_window;
pub(in crate::app) mod marks;
pub(in crate::app) mod measuring;
pub(in crate::app) mod measuring_panel;
pub(in crate::app) mod point_panel;

pub use anchor::Anchor;

use crate::app::side::Side;
use crate::document::Measured;
use crate::scene::{MeasurementKind, Pick};
use crate::sequence::PreparedFrame;
use glam::DVec3;
use measuring::Measurement;

/// Tool: the action of a click on the image.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Tool {
    /// Nothing: the mouse moves the camera alone.
    #[default]
    Camera,
    /// Shows the values of the point.
    Point,
    /// Takes the point for a measurement.
    Measure,
    /// Puts a label at the point.
    Label,
}

/// A point whose values are shown.
#[derive(Debug, Clone, PartialEq)]
pub struct Inspected {
    /// Anchor of the inspected point.
    pub anchor: Anchor,
    /// Its values in the last frame that has it.
    pub values: Pick,
}

/// Inspection state: clicked points and measurements.
#[derive(Debug, Clone, Default)]
pub struct Inspection {
    /// Tool of the next click.
    pub tool: Tool,
    /// The point whose values are shown.
    pub point: Option<Inspected>,
    /// Kind of the next measurement.
    pub kind: MeasurementKind,
    /// Points of a measurement that has not enough of them yet.
    pub begun: Vec<Anchor>,
    /// Finished measurements, oldest first.
    pub measurements: Vec<Measurement>,
    /// The content of A and of B that points were last looked up in, as [`PreparedFrame::id`].
    followed: [Option<u64>; 2],
}

impl Inspection {
    /// Chooses a tool, or puts the chosen one away.
    pub fn toggle(&mut self, tool: Tool) {
        self.begun.clear();
        self.tool = if self.tool == tool { Tool::Camera } else { tool };
    }

    /// Returns true if clicks on the image are for a tool.
    pub(in crate::app) fn takes_clicks(&self) -> bool {
        self.tool != Tool::Camera
    }

    /// Returns true if each click of a double click counts.
    pub(in crate::app) fn takes_double_clicks(&self) -> bool {
        matches!(self.tool, Tool::Measure | Tool::Label)
    }

    /// Returns the number of measurements that belong to no document, as they have points of B.
    pub(in crate::app) fn undocumented(&self) -> usize {
        let of_b = |measurement: &&Measurement| measurement.measured().is_none();
        self.measurements.iter().filter(of_b).count()
    }

    /// Every point that was clicked on: the one whose values are shown, and the points of measurements.
    pub(in crate::app) fn picked(&self) -> impl Iterator<Item = Anchor> {
        let point = self.point.iter().map(|point| point.anchor);
        let measured = self.measurements.iter().flat_map(|one| &one.points);
        point.chain(self.begun.iter().chain(measured).copied())
    }

    /// The points of the last angle that was measured.
    pub(in crate::app) fn last_angle(&self) -> Option<[DVec3; 3]> {
        let mut angles = self.measurements.iter().rev();
        let angle = angles.find(|measurement| measurement.kind == MeasurementKind::Angle)?;
        let places: Vec<DVec3> = angle.points.iter().map(|point| point.place).collect();
        places.try_into().ok()
    }

    /// Chooses the measurement tool.
    pub fn measure(&mut self, kind: MeasurementKind) {
        self.begun.clear();
        self.kind = kind;
    }

    /// Forgets the clicked points; the tool stays.
    pub(in crate::app) fn forget_points(&mut self) {
        *self = Self {
            tool: self.tool,
            kind: self.kind,
            ..Self::default()
        };
    }

    /// Forgets the points of B, which is closed.
    pub(in crate::app) fn forget_points_of_b(&mut self) {
        let is_of_b = |anchor: &Anchor| anchor.side == Side::B;
        self.point.take_if(|point| is_of_b(&point.anchor));
        self.begun.retain(|anchor| !is_of_b(anchor));
        self.measurements
            .retain(|measurement| !measurement.points.iter().any(is_of_b));
        self.followed[Side::B as usize] = None;
    }

    /// Replaces the measurements of the open sequence by a document's. Existing ones keep their points in the shown
    /// frame, and so do measurements of B, which is in no document.
    pub(in crate::app) fn show_measured(&mut self, list: &[Measured]) {
        let before = std::mem::take(&mut self.measurements);
        let shown = |measured: &Measured| {
            let same = |other: &&Measurement| other.measured().is_some_and(|other| other.is_of_same(measured));
            let known = before.iter().find(same).cloned();
            known.unwrap_or_else(|| Measurement::of(measured))
        };
        self.measurements = list.iter().map(shown).collect();
        let of_b = before
            .into_iter()
            .filter(|measurement| measurement.measured().is_none());
        self.measurements.extend(of_b);
        self.followed[Side::A as usize] = None;
    }

    /// Takes a click on a point of `frame`, which is of the sequence `side`.
    pub(in crate::app) fn take(&mut self, side: Side, pick: Pick, frame: &PreparedFrame) {
        let anchor = Anchor::new(side, &pick, frame);
        // The clicked image may be of the frame before the one that is shown next.
        self.followed[side as usize] = Some(frame.id);
        match self.tool {
            // Labels are not measurements: they are stored elsewhere.
            Tool::Camera | Tool::Label => {}
            Tool::Point => {
                self.point = Some(Inspected { anchor, values: pick });
            }
            Tool::Measure => {
                self.begun.push(anchor);
                if self.begun.len() >= self.kind.point_count() {
                    self.measurements.push(Measurement {
                        kind: self.kind,
                        points: std::mem::take(&mut self.begun),
                    });
                }
            }
        }
    }

    /// Looks for the points of the sequence `side` in a frame of it, if it is another one. Costs a look at the indices
    /// of the frame for each.
    pub(in crate::app) fn follow(&mut self, side: Side, frame: &PreparedFrame, origin: DVec3) {
        if self.followed[side as usize].replace(frame.id) == Some(frame.id) {
            return;
        }
        if let Some(point) = self.point.as_mut().filter(|point| point.anchor.side == side) {
            let slot = point.anchor.follow(frame, origin);
            if let Some(values) = slot.and_then(|slot| Pick::of(frame, origin, slot)) {
                point.values = values;
            }
        }
        let measured = self.measurements.iter_mut();
        let measured = measured.flat_map(|measurement| &mut measurement.points);
        let all = self.begun.iter_mut().chain(measured);
        for anchor in all.filter(|anchor| anchor.side == side) {
            anchor.follow(frame, origin);
        }
    }

    /// Clears one item per call: the unfinished measurement, the point, the tool. False if nothing was left.
    pub(in crate::app) fn escape(&mut self) -> bool {
        if !self.begun.is_empty() {
            self.begun.clear();
        } else if self.point.take().is_none() {
            return std::mem::take(&mut self.tool) != Tool::Camera;
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cloud::{Frame, Positions, RawCloud};
    use crate::sequence::{Needs, PrepareCounters, prepare};
    use std::sync::Arc;

    fn frame(index: usize, places: &[[f32; 3]], origin: DVec3) -> PreparedFrame {
        let positions = places.iter().map(|&place| {
            let [x, y, z] = place.map(f64::from);
            (origin + DVec3::new(x, y, z)).to_array()
        });
        let raw = RawCloud::from_positions(Positions::F64(positions.collect()));
        let frame = Arc::new(Frame::from_raw(raw, origin).unwrap());
        prepare(index, frame, 0.0, &Needs::default(), &PrepareCounters::default())
    }

    #[test]
    fn points_are_followed_in_frames_with_equal_point_counts() {
        let origin = DVec3::new(1e6, 0.0, 0.0);
        let first = frame(0, &[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], origin);
        let slot = first.frame.file_index().iter().position(|&index| index == 1);
        let pick = Pick::of(&first, origin, slot.unwrap()).unwrap();
        let mut inspection = Inspection {
            tool: Tool::Point,
            ..Inspection::default()
        };
        inspection.take(Side::A, pick, &first);
        // In a different order of positions, with a hole in the file.
        let moved = frame(1, &[[f32::NAN; 3], [-5.0, 2.0, 0.0], [9.0, 0.0, 0.0]], origin);
        inspection.follow(Side::A, &moved, origin);
        let point = inspection.point.clone().unwrap();
        assert_eq!(point.values.position, origin + DVec3::new(-5.0, 2.0, 0.0));
        assert_eq!((point.anchor.frame, point.values.index_in_file), (1, 1));
        // Fewer points: it is unknown which one it is.
        inspection.follow(Side::A, &frame(2, &[[3.0; 3]], origin), origin);
        assert_eq!(inspection.point.clone().unwrap(), point);
        // The point itself is a hole.
        let hole = frame(3, &[[0.0; 3], [f32::INFINITY; 3], [9.0, 0.0, 0.0]], origin);
        inspection.follow(Side::A, &hole, origin);
        assert_eq!(inspection.point.unwrap().anchor.place, point.anchor.place);
    }

    #[test]
    fn points_of_b_follow_frames_of_b_and_are_removed_with_them() {
        let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0]];
        let (a, b) = (frame(0, &corners, DVec3::ZERO), frame(0, &corners, DVec3::ZERO));
        let mut inspection = Inspection {
            tool: Tool::Measure,
            ..Inspection::default()
        };
        let pick = |frame: &PreparedFrame| Pick::of(frame, DVec3::ZERO, 0).unwrap();
        inspection.take(Side::A, pick(&a), &a);
        inspection.take(Side::B, pick(&b), &b);
        inspection.take(Side::A, pick(&a), &a);
        let line = inspection.measurements[0].line(DVec3::Y);
        assert!(
            line.starts_with("distance\t0\tframe 1 point 0 at 0 0 0\tframe 1 of B point 0"),
            "{line}"
        );
        let moved = frame(1, &[[0.0, 0.0, 7.0]; 3], DVec3::ZERO);
        inspection.follow(Side::B, &moved, DVec3::ZERO);
        assert_eq!(inspection.measurements[0].value(DVec3::Y), Some(7.0));
        inspection.forget_points_of_b();
        assert_eq!(inspection.measurements, [], "a half of it is gone");
        assert_eq!(inspection.begun.len(), 1);
    }

    #[test]
    fn points_make_measurements_and_escape_clears_in_order() {
        let shown = frame(0, &[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0]], DVec3::ZERO);
        let pick = |index: u32| {
            let slot = shown.frame.file_index().iter().position(|&known| known == index);
            Pick::of(&shown, DVec3::ZERO, slot.unwrap()).unwrap()
        };
        let mut inspection = Inspection::default();
        inspection.take(Side::A, pick(0), &shown);
        assert!(inspection.point.is_none(), "without a tool a click picks nothing");
        inspection.toggle(Tool::Measure);
        inspection.measure(MeasurementKind::Angle);
        for index in [1, 0, 2] {
            inspection.take(Side::A, pick(index), &shown);
        }
        assert_eq!(inspection.begun, []);
        assert_eq!(inspection.measurements[0].value(DVec3::Y), Some(90.0));
        let line = inspection.measurements[0].line(DVec3::Y);
        assert!(line.starts_with("angle\t90\tframe 1 point 1 at 1 0 0\t"), "{line}");
        inspection.take(Side::A, pick(1), &shown);
        assert!(inspection.escape());
        assert_eq!((inspection.begun.len(), inspection.tool), (0, Tool::Measure));
        assert!(inspection.escape());
        assert_eq!(inspection.tool, Tool::Camera);
        assert!(!inspection.escape());
        assert_eq!(inspection.measurements.len(), 1, "those are deleted by hand");
    }
}
