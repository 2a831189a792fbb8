//! The document of the window, updated from the owners of its parts, and given back to them. Parts of no feature are
//! here: inputs, reading, settings, view, frame and range.

use super::State;
use super::opened::Opened;
use crate::app::features::Features;
use crate::document::{Document, Reading};
use crate::playback::Player;
use crate::scene::Settings;
use crate::sequence::Sequence;
use crate::source::DEMO_INPUT;
use std::path::PathBuf;

impl State {
    /// The document as it is now: [`State::document`] is as of the last pass.
    pub fn current_document(&self) -> Document {
        let mut document = self.document.clone();
        self.gather_into(&mut document);
        document
    }

    /// Updates the document. Unchanged parts are not copied.
    pub(super) fn gather_document(&mut self) {
        let mut document = std::mem::take(&mut self.document);
        self.gather_into(&mut document);
        self.document = document;
    }

    fn gather_into(&self, document: &mut Document) {
        document.set_style(self.style_of_a());
        if let Some(player) = &self.player {
            self.gather_of_player(player, document);
        }
        for feature in Features::rows::<Self>() {
            feature.save(self, document);
        }
    }

    /// The view is `None` until the user has moved the camera.
    fn gather_of_player(&self, player: &Player, document: &mut Document) {
        let named = &self.opening.opened.inputs;
        if named.is_empty() {
            document.inputs = inputs_of(player.sequence()).unwrap_or_default();
        } else if document.inputs != *named {
            document.inputs.clone_from(named);
        }
        document.reading = Reading::of(self.opened_with());
        if let Some(topic) = chosen_topic(player.sequence()) {
            document.reading.topic = Some(topic);
        }
        document.frame = player.waiting_for().unwrap_or(player.clock().frame());
        document.view = if self.opening.looked.is_empty() {
            self.shared.options.view
        } else {
            let is_untouched = self.opening.looked.untouched(&self.camera).is_some();
            (!is_untouched).then_some(self.camera)
        };
        document.range = player.clock().range();
    }

    /// Gives each part of `document` to its owner. Its inputs are open already.
    pub fn apply_document(&mut self, document: Document) {
        self.style = document.style();
        let view = self.shared.options.view.take().or(document.view);
        if view.is_some() {
            self.motion.turntable.is_on = false;
        }
        self.shared.options.view = view;
        self.document = document.clone();
        for feature in Features::rows::<Self>() {
            feature.load(self, &document);
        }
        let (range, frame) = (document.range, document.frame);
        self.play_with(|player, now| {
            player.set_range(range, now);
            // Frames of a live source are gone; a followed folder shows its newest frame.
            let has_frame = !player.sequence().source().is_live() && !player.follows_newest();
            if has_frame && frame != player.clock().frame() {
                player.seek(frame, now);
            }
        });
        self.opening.opened = Opened {
            inputs: document.inputs,
            options: Some(document.reading.over(&self.shared.options.open)),
            compared: document.compare,
            ..Opened::default()
        };
        self.open_companion();
    }

    /// Applies the document after undo or redo.
    pub(in crate::app) fn take_undone(&mut self, undone: Option<Document>) {
        let Some(undone) = undone else { return };
        self.gather_document();
        self.document.put_back(&undone);
        self.style = undone.style();
        let document = self.document.clone();
        for feature in Features::rows::<Self>() {
            feature.put_back(self, &document);
        }
        self.play_with(|player, now| player.set_range(document.range, now));
        self.keep_document();
    }

    /// The document of a sequence without a stored one.
    pub(super) fn new_document(&self) -> Document {
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

/// Inputs of a sequence; `None` if it does not come from files.
pub(in crate::app) fn inputs_of(sequence: &Sequence) -> Option<Vec<PathBuf>> {
    let inputs = sequence.source().inputs();
    if !inputs.is_empty() {
        return Some(inputs.to_vec());
    }
    let is_demo = !sequence.is_empty() && sequence.entry(0).path.starts_with("demo");
    is_demo.then(|| vec![DEMO_INPUT.into()])
}

/// The topic of a recording that has several.
pub(in crate::app) fn chosen_topic(sequence: &Sequence) -> Option<String> {
    let topics = sequence.source().topics();
    let has_choice = topics.len() > 1;
    let chosen = topics.into_iter().find(|topic| topic.is_read && has_choice);
    chosen.map(|topic| topic.name)
}
