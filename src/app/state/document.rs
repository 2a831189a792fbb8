//! The document of the window, collected from the parts that hold it and given back to them.

use super::State;
use super::opened::Opened;
use crate::app::features::Features;
use crate::app::features::beside::Layout;
use crate::app::features::camera_path::Draft;
use crate::app::features::inspection::Anchor;
use crate::app::features::inspection::measuring::Measurement;
use crate::app::features::trails::TrailField;
use crate::app::side::Side;
use crate::document::{
    Compared, ComparedBy, ComparedLayout, Document, Measured, MeasuredPoint, Reading, ShownTrails, SpreadTrails,
};
use crate::playback::PairBy;
use crate::scene::Settings;
use crate::sequence::Sequence;
use std::path::PathBuf;
use std::sync::Arc;

impl State {
    /// What is open, and all that was made around it. The view is `None` while nobody has moved the camera.
    pub fn document(&self) -> Document {
        let style = self.style_of_a();
        let Some(player) = &self.player else {
            return Document::new(style);
        };
        let mut reading = Reading::of(self.opened_with());
        if let Some(topic) = chosen_topic(player.sequence()) {
            reading.topic = Some(topic);
        }
        let is_untouched = self.opening.looked.untouched(&self.camera).is_some();
        let mut document = Document {
            inputs: self.named_inputs(player).unwrap_or_default(),
            reading,
            up: self.features.timeline.chosen_up,
            frame: player.waiting_for().unwrap_or(player.clock().frame()),
            view: if self.opening.looked.is_empty() {
                self.shared.options.view
            } else {
                (!is_untouched).then_some(self.camera)
            },
            settings: style.with(|style| style.clip = None),
            clip: style.clip,
            range: player.clock().range(),
            markers: self.features.timeline.markers.list().to_vec(),
            measurements: self
                .features
                .inspection
                .measurements
                .iter()
                .filter_map(measured)
                .collect(),
            labels: self.features.labels.list.to_vec(),
            trails: self.shown_trails(),
            path: self.features.path.draft.path().cloned(),
            compare: self.compared().or_else(|| self.opening.opened.compared.clone()),
            notes: String::new(),
            unknown: self.opening.opened.unknown.clone(),
        };
        for feature in Features::rows::<Self>() {
            (feature.save)(self, &mut document);
        }
        document
    }

    /// Gives each part of `document` to what holds it. Its inputs are open already.
    pub fn apply_document(&mut self, document: Document) {
        self.style = document.style();
        for feature in Features::rows::<Self>() {
            (feature.load)(self, &document);
        }
        let view = self.shared.options.view.take().or(document.view);
        if view.is_some() {
            self.motion.turntable.is_on = false;
        }
        self.shared.options.view = view;
        self.features.timeline.chosen_up = document.up;
        if let Some(problem) = self.features.timeline.take_markers(document.markers) {
            self.notices.warn(problem);
        }
        self.features.inspection.measurements = document.measurements.iter().map(measurement).collect();
        self.features.labels.take(Arc::new(document.labels));
        self.show_trails(&document.trails);
        if let Some(path) = document.path {
            self.stop_preview();
            self.features.path.take(Arc::new(Draft::of(path)), None);
        }
        let (range, frame) = (document.range, document.frame);
        self.play_with(|player, now| {
            player.set_range(range, now);
            // Frames of a live source are gone; who follows a folder has asked for its newest.
            let has_frame = !player.sequence().source().is_live() && !player.follows_newest();
            if has_frame && frame != player.clock().frame() {
                player.seek(frame, now);
            }
        });
        self.opening.opened = Opened {
            inputs: document.inputs,
            options: Some(document.reading.over(&self.shared.options.open)),
            compared: document.compare,
            unknown: document.unknown,
            ..Opened::default()
        };
        self.open_companion();
    }

    fn shown_trails(&self) -> ShownTrails {
        let field = &self.features.trails.field;
        ShownTrails {
            of_picked: self.features.trails.is_on,
            kept: self.features.trails.kept.iter().filter_map(measured_point).collect(),
            spread: field.is_on.then_some(SpreadTrails {
                points: field.points,
                frames: field.length,
            }),
        }
    }

    fn show_trails(&mut self, trails: &ShownTrails) {
        self.features.trails.is_on = trails.of_picked;
        self.features.trails.kept = trails.kept.iter().map(anchor).collect();
        self.features.trails.field.is_on = trails.spread.is_some();
        if let Some(SpreadTrails { points, frames }) = trails.spread {
            self.features.trails.field.points = points.clamp(1, TrailField::MAX_POINTS);
            self.features.trails.field.length = frames.clamp(1, TrailField::MAX_LENGTH);
        }
    }

    /// What is next to the open sequence; `None` if nothing is that could be opened again.
    fn compared(&self) -> Option<Compared> {
        let beside = self.features.beside.as_ref()?;
        let companion = &beside.companion;
        // Where there was no choice, the user made none.
        let has_choice = companion.times().is_some() || companion.numbers().is_some();
        Some(Compared {
            inputs: inputs_of(companion.sequence())?,
            topic: chosen_topic(companion.sequence()),
            by: has_choice.then(|| match companion.paired_by() {
                PairBy::Index => ComparedBy::Index,
                PairBy::Number => ComparedBy::Number,
                PairBy::Time => ComparedBy::Time,
            }),
            offset_frames: companion.offset_frames(),
            layout: match beside.layout {
                Layout::SideBySide => ComparedLayout::SideBySide,
                Layout::Wipe => ComparedLayout::Line,
            },
            line: (1e4 * f64::from(beside.pictures.split)).round() / 1e4,
        })
    }

    /// The document of a sequence of which nothing is kept.
    pub(in crate::app) fn new_document(&self) -> Document {
        Document::new(self.new_style())
    }

    /// Settings of a new document: the user's defaults, drawn by whom all documents are.
    pub(in crate::app) fn new_style(&self) -> Settings {
        Settings {
            drawing: self.usual_style(self.style_of_a()).drawing,
            ..self.shared.options.preferences.settings
        }
    }
}

/// Inputs of a sequence; `None` of what is no file.
pub(in crate::app) fn inputs_of(sequence: &Sequence) -> Option<Vec<PathBuf>> {
    let inputs = sequence.source().inputs();
    if !inputs.is_empty() {
        return Some(inputs.to_vec());
    }
    let is_demo = !sequence.is_empty() && sequence.entry(0).path.starts_with("demo");
    is_demo.then(|| vec!["demo:".into()])
}

/// The topic of a recording that has several.
fn chosen_topic(sequence: &Sequence) -> Option<String> {
    let topics = sequence.source().topics();
    let has_choice = topics.len() > 1;
    let chosen = topics.into_iter().find(|topic| topic.is_read && has_choice);
    chosen.map(|topic| topic.name)
}

/// A measurement of the open sequence alone.
pub(in crate::app) fn measured(measurement: &Measurement) -> Option<Measured> {
    Some(Measured {
        gauge: measurement.gauge,
        points: measurement.points.iter().map(measured_point).collect::<Option<_>>()?,
    })
}

fn measured_point(anchor: &Anchor) -> Option<MeasuredPoint> {
    (anchor.side == Side::A).then(|| MeasuredPoint {
        frame: anchor.frame,
        point: anchor.point(),
        place: anchor.place,
    })
}

fn measurement(measured: &Measured) -> Measurement {
    Measurement {
        gauge: measured.gauge,
        points: measured.points.iter().map(anchor).collect(),
    }
}

fn anchor(point: &MeasuredPoint) -> Anchor {
    Anchor {
        side: Side::A,
        index_in_file: point.point.index_in_file,
        frame: point.frame,
        place: point.place,
        clicked_in: point.frame,
        // No file has so many: such a point stays where it is.
        points_in_file: point.point.points_in_file.unwrap_or(usize::MAX),
    }
}
