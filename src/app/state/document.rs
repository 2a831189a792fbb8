//! The document of the window, collected from the features that hold its parts and given back to them. What no feature
//! holds is here: inputs, reading, settings, view, frame and range.

use super::State;
use super::opened::Opened;
use crate::app::features::Features;
use crate::document::{Document, Reading};
use crate::scene::Settings;
use crate::sequence::Sequence;
use crate::source::DEMO_INPUT;
use std::path::PathBuf;

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
            frame: player.waiting_for().unwrap_or(player.clock().frame()),
            view: if self.opening.looked.is_empty() {
                self.shared.options.view
            } else {
                (!is_untouched).then_some(self.camera)
            },
            settings: style.with(|style| style.clip = None),
            clip: style.clip,
            range: player.clock().range(),
            compare: self.opening.opened.compared.clone(),
            unknown: self.opening.opened.unknown.clone(),
            ..Document::default()
        };
        for feature in Features::rows::<Self>() {
            (feature.save)(self, &mut document);
        }
        document
    }

    /// Gives each part of `document` to what holds it. Its inputs are open already.
    pub fn apply_document(&mut self, document: Document) {
        self.style = document.style();
        let view = self.shared.options.view.take().or(document.view);
        if view.is_some() {
            self.motion.turntable.is_on = false;
        }
        self.shared.options.view = view;
        for feature in Features::rows::<Self>() {
            (feature.load)(self, &document);
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

    /// The document of a sequence of which nothing is kept.
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

/// Inputs of a sequence; `None` of what is no file.
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
