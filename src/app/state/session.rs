//! Sessions: saved with all that a person has made around the open sequence, and taken up again.

use super::State;
use super::dialogs::DialogKind;
use super::opened::{Opened, SavedSession};
use crate::app::features::beside::Layout;
use crate::app::features::camera_path::Draft;
use crate::app::features::inspection::Anchor;
use crate::app::features::inspection::measuring::Measurement;
use crate::app::features::quality::MeasuredWay;
use crate::app::side::Side;
use crate::app::work::tasks::TaskFailed;
use crate::document::{
    Compared, ComparedBy, ComparedLayout, Document, EXTENSION, History, Measured, MeasuredPoint, ReadSession, Reading,
    ShownTrails,
};
use crate::playback::{PairBy, Player};
use crate::scene::OfSequence;
use crate::sequence::{OpenOptions, Sequence};
use crate::source::SessionReach;
use std::path::{Path, PathBuf};
use std::sync::Arc;

impl State {
    /// Takes notice of what the open sequence was named by, and how it was opened.
    pub(in crate::app) fn note_opened(&mut self, inputs: Vec<PathBuf>, options: Option<OpenOptions>) {
        self.opened.inputs = inputs;
        self.opened.options = options;
    }

    /// The open sequence is another one, of which nobody has said what it is named by.
    pub(super) fn note_unnamed(&mut self) {
        self.opened = Opened::default();
    }

    /// The file of the session that is open.
    pub fn session_file(&self) -> Option<&PathBuf> {
        self.opened.file.as_ref()
    }

    /// What a session of the open sequence holds now. `Err` is a text for a notice.
    pub fn session(&self) -> Result<Document, String> {
        let Some(player) = &self.player else {
            return Err("There is nothing to save yet: open a sequence first".to_owned());
        };
        let mut reading = Reading::of(self.opened_with());
        if let Some(topic) = chosen_topic(player.sequence()) {
            reading.topic = Some(topic);
        }
        let style = self.style_of_a();
        let shown = player.waiting_for().unwrap_or(player.clock().frame());
        Ok(Document {
            inputs: self.named_inputs(player)?,
            reading,
            frame: shown,
            view: Some(self.camera),
            settings: style.with(|style| style.of_sequence = OfSequence::default()),
            clip: style.of_sequence.clip,
            range: player.clock().range(),
            markers: self.timeline.markers.list().to_vec(),
            measurements: self.inspection.measurements.iter().filter_map(measured).collect(),
            labels: self.labels.list.to_vec(),
            up: self.timeline.chosen.up,
            trails: ShownTrails::default(),
            notes: String::new(),
            path: self.path.draft.path().cloned(),
            compare: self.compared().or_else(|| self.opened.compared.clone()),
            unknown: self.opened.unknown.clone(),
        })
    }

    pub(super) fn named_inputs(&self, player: &Player) -> Result<Vec<PathBuf>, String> {
        if !self.opened.inputs.is_empty() {
            return Ok(self.opened.inputs.clone());
        }
        inputs_of(player.sequence())
            .ok_or_else(|| "What is open is no file: a session of it could not be opened again".to_owned())
    }

    /// What is beside the open sequence; `None` if nothing is that could be opened again.
    fn compared(&self) -> Option<Compared> {
        let beside = self.beside.as_ref()?;
        let companion = &beside.companion;
        // Where there was no choice, the person made none.
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

    /// Looks for what the session has beside the open sequence.
    fn compare_as_in_session(&mut self) {
        let Some(compared) = &self.opened.compared else {
            return;
        };
        let inputs = compared.inputs.clone();
        let open = OpenOptions {
            topic: compared.topic.as_deref().map(Arc::from),
            // Another session among them is asked about by itself.
            session_reach: SessionReach::default(),
            ..self.opened_with().clone()
        };
        self.find(inputs, open, Side::B);
    }

    /// Shows `sequence`, which was named as `inputs`, beside the open one: as the session says, if it is that of it.
    pub(super) fn compare_found(&mut self, sequence: Arc<Sequence>, inputs: &[PathBuf]) {
        let compared = self.opened.compared.take_if(|compared| compared.inputs == inputs);
        self.compare_with(sequence);
        let (Some(compared), Some(beside)) = (compared, &mut self.beside) else {
            return;
        };
        beside.companion.set_offset_frames(compared.offset_frames);
        if let Some(by) = compared.by {
            beside.companion.pair_by(match by {
                ComparedBy::Index => PairBy::Index,
                ComparedBy::Number => PairBy::Number,
                ComparedBy::Time => PairBy::Time,
            });
        }
        beside.pictures.split = compared.line as f32;
        beside.lay_out(match compared.layout {
            ComparedLayout::SideBySide => Layout::SideBySide,
            ComparedLayout::Line => Layout::Wipe,
        });
    }

    /// Saves the session to its file, or asks for one.
    pub(super) fn save_session(&mut self, asks: bool) {
        if let Err(reason) = self.session() {
            return self.notices.error(reason);
        }
        match &self.opened.file {
            Some(file) if !asks => self.save_session_to(file.clone()),
            _ => {
                let name = format!("{}.{EXTENSION}", self.sequence_stem());
                self.ask(DialogKind::SaveSession, Some(name));
            }
        }
    }

    /// Writes the session to a file on a thread.
    pub fn save_session_to(&mut self, file: PathBuf) {
        let session = match self.session() {
            Ok(session) => session,
            Err(reason) => return self.notices.error(reason),
        };
        let of_b = |measurement: &&Measurement| measured(measurement).is_none();
        if let left_out @ 1.. = self.inspection.measurements.iter().filter(of_b).count() {
            let text = format!("Not in the session: {left_out} measured with the sequence beside the open one");
            self.notices.warn(text);
        }
        let path = Arc::clone(&self.path.draft);
        let copies = self.opened.is_damaged && self.opened.file.as_ref() == Some(&file);
        self.tasks.try_start("save session", move || {
            if copies {
                copy_beside(&file).map_err(TaskFailed)?;
            }
            session.write(&file).map_err(|reason| TaskFailed(reason.to_string()))?;
            Ok(SavedSession { file, path })
        });
    }

    /// Takes notice that it is written.
    pub(super) fn session_was_saved(&mut self, SavedSession { file, path }: SavedSession) {
        self.notices.info(format!("Saved {}", file.display()));
        // What is in the session is not lost.
        self.path.note_kept(path);
        if let Err(problem) = self.recent.add(std::slice::from_ref(&file)) {
            self.notices.warn(problem);
        }
        self.opened.file = Some(file);
        self.opened.is_damaged = false;
    }

    /// Shows `sequence`, which is of a session, as that says.
    pub fn open_session(&mut self, sequence: Arc<Sequence>, read: ReadSession) {
        let ReadSession {
            file,
            document: session,
            warnings,
        } = read;
        let opened = Arc::clone(&sequence);
        // What is beside a session is what it says.
        self.close_beside();
        self.open(sequence);
        let is_open = self
            .player
            .as_ref()
            .is_some_and(|player| Arc::ptr_eq(player.sequence(), &opened));
        if !is_open {
            return;
        }
        let is_damaged = !warnings.is_empty();
        for warning in warnings {
            self.notices.warn(warning);
        }
        // They are of this sequence: the next is drawn as others are.
        let before = self.style;
        self.style = session.style();
        self.measured_way = Some(MeasuredWay {
            before,
            chosen: self.style,
        });
        self.looked.primitive = Some(self.style.primitive);
        self.options.view = session.view.or(self.options.view.take());
        self.motion.turntable.is_on = false;
        let measured = session.measurements.iter().map(measurement);
        self.inspection.measurements = measured.collect();
        self.labels.take(Arc::new(session.labels));
        self.history = History::default();
        if let Some(problem) = self.timeline.take_markers(session.markers) {
            self.notices.warn(problem);
        }
        if let Some(path) = session.path {
            self.stop_preview();
            self.path.take(Arc::new(Draft::of(path)), None);
        }
        let (range, frame) = (session.range, session.frame);
        self.play_with(|player, now| {
            player.set_range(range, now);
            // Frames of a live source are gone.
            if !player.sequence().source().is_live() {
                if player.is_playing() {
                    player.toggle(now);
                }
                player.seek(frame, now);
            }
        });
        self.opened = Opened {
            inputs: session.inputs,
            options: Some(session.reading.over(&self.options.open)),
            compared: session.compare,
            file: Some(file),
            unknown: session.unknown,
            is_damaged,
        };
        self.compare_as_in_session();
    }
}

/// What a sequence was named by; `None` of what is no file.
fn inputs_of(sequence: &Sequence) -> Option<Vec<PathBuf>> {
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
fn measured(measurement: &Measurement) -> Option<Measured> {
    let points = measurement.points.iter().map(|anchor| {
        (anchor.side == Side::A).then(|| MeasuredPoint {
            frame: anchor.frame,
            point: anchor.point(),
            place: anchor.place,
        })
    });
    Some(Measured {
        gauge: measurement.gauge,
        points: points.collect::<Option<_>>()?,
    })
}

fn measurement(measured: &Measured) -> Measurement {
    let points = measured.points.iter().map(|point| Anchor {
        side: Side::A,
        index_in_file: point.point.index_in_file,
        frame: point.frame,
        place: point.place,
        clicked_in: point.frame,
        // No file has so many: such a point stays where it is.
        points_in_file: point.point.points_in_file.unwrap_or(usize::MAX),
    });
    Measurement {
        gauge: measured.gauge,
        points: points.collect(),
    }
}

/// What could not be read of a session is not lost when it is saved.
fn copy_beside(file: &Path) -> Result<(), String> {
    match crate::kept::copy_beside(file) {
        Ok(_) => Ok(()),
        Err(reason) if reason.kind() == std::io::ErrorKind::NotFound => Ok(()),
        Err(reason) => Err(format!(
            "Not all of {} could be read, nor can it be copied ({reason}): save the session under another name",
            file.display()
        )),
    }
}
