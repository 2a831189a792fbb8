//! What the window does with each feature.
//!
//! **How it works.** A feature is a folder: its model, which knows neither the window's state nor other features, its
//! work on threads, its panel, and `in_window.rs`, where all of that meets the state `S` of the window. There the model
//! is a [`Feature`]: what it does when the playhead moves, what is painted, which panels and commands it has. Only the
//! table (`table.rs`) names features; it reaches `in_window.rs` through this trait, and the trait knows `S` by no name,
//! so that no file imports in a circle.

use crate::app::command::CommandRow;
use crate::app::panel_row::PanelRow;
use crate::app::widgets::overlay::PictureOverlay;
use crate::app::work::outcome::Outcome;
use crate::document::Document;
use egui::Ui;
use std::time::Duration;

/// A feature of a window with the state `S`. What is not written does nothing.
pub(in crate::app) trait Feature<S: 'static> {
    /// Moves on with the time, before the playhead does. True if something can be seen to change.
    fn update(_state: &mut S) -> bool {
        false
    }

    /// Begins what it makes of the frame that is shown. True if something can be seen to change.
    fn follow_frame(_state: &mut S) -> bool {
        false
    }

    /// Follows all else that has changed, once it is known what the shown frame is looked at as.
    fn follow(_state: &mut S) {}

    /// Takes in at once what the panels have changed.
    fn follow_panels(_state: &mut S) {}

    /// When [`Feature::update`] or [`Feature::follow_frame`] has something to do by itself.
    fn next_deadline(_state: &S) -> Option<Duration> {
        None
    }

    /// Whether panels show more of the playing frame because of it than its place on the timeline.
    fn shows_frame(_state: &S) -> bool {
        false
    }

    /// Whether something that is not the picture may have changed: marks, progress.
    fn has_news(_state: &S) -> bool {
        false
    }

    /// Takes what a task came to; gives back what is not of a type of its own.
    fn take(_state: &mut S, outcome: Outcome) -> Result<(), Outcome> {
        Err(outcome)
    }

    /// Forgets frame `index`, which is read anew.
    fn forget_frame(_state: &mut S, _index: usize) {}

    /// Forgets what belongs to the sequence that was open before.
    fn forget_sequence(_state: &mut S) {}

    /// Brings up to date what the document has of it, where it works on more than that: once a pass.
    fn save(_state: &S, _document: &mut Document) {}

    /// Takes what was kept of it with the sequence that was opened.
    fn load(_state: &mut S, _document: &Document) {}

    /// Takes what undo or redo has put back in the document, which may be what it has already.
    fn put_back(state: &mut S, document: &Document) {
        Self::load(state, document);
    }

    /// Closes what it has over all else: Escape. False if there is nothing.
    fn escape(_state: &mut S) -> bool {
        false
    }

    /// What would be lost by the end of the program: a sentence.
    fn loss(_state: &S) -> Option<&'static str> {
        None
    }

    /// Paints its marks over a picture; `is_first` of that of the open sequence.
    fn paint(_state: &S, _canvas: &PictureOverlay<'_>, _is_first: bool) {}

    /// Shows what can be taken hold of over the picture of the open sequence.
    fn handles(_ui: &Ui, _state: &mut S) {}

    /// Its panels.
    fn panels() -> &'static [PanelRow<S>] {
        &[]
    }

    /// Its commands.
    fn commands() -> &'static [CommandRow<S>] {
        &[]
    }
}

/// The functions of a feature, as the window calls them.
pub(in crate::app) struct FeatureRow<S: 'static> {
    pub(in crate::app) update: fn(&mut S) -> bool,
    pub(in crate::app) follow_frame: fn(&mut S) -> bool,
    pub(in crate::app) follow: fn(&mut S),
    pub(in crate::app) follow_panels: fn(&mut S),
    pub(in crate::app) next_deadline: fn(&S) -> Option<Duration>,
    pub(in crate::app) shows_frame: fn(&S) -> bool,
    pub(in crate::app) has_news: fn(&S) -> bool,
    pub(in crate::app) take: fn(&mut S, Outcome) -> Result<(), Outcome>,
    pub(in crate::app) forget_frame: fn(&mut S, usize),
    pub(in crate::app) forget_sequence: fn(&mut S),
    pub(in crate::app) save: fn(&S, &mut Document),
    pub(in crate::app) load: fn(&mut S, &Document),
    pub(in crate::app) put_back: fn(&mut S, &Document),
    pub(in crate::app) escape: fn(&mut S) -> bool,
    pub(in crate::app) loss: fn(&S) -> Option<&'static str>,
    pub(in crate::app) paint: fn(&S, &PictureOverlay<'_>, bool),
    pub(in crate::app) handles: fn(&Ui, &mut S),
    pub(in crate::app) panels: fn() -> &'static [PanelRow<S>],
    pub(in crate::app) commands: fn() -> &'static [CommandRow<S>],
}

impl<S: 'static> FeatureRow<S> {
    /// The row of `F`.
    pub(super) const fn of<F: Feature<S>>() -> Self {
        Self {
            update: F::update,
            follow_frame: F::follow_frame,
            follow: F::follow,
            follow_panels: F::follow_panels,
            next_deadline: F::next_deadline,
            shows_frame: F::shows_frame,
            has_news: F::has_news,
            take: F::take,
            forget_frame: F::forget_frame,
            forget_sequence: F::forget_sequence,
            save: F::save,
            load: F::load,
            put_back: F::put_back,
            escape: F::escape,
            loss: F::loss,
            paint: F::paint,
            handles: F::handles,
            panels: F::panels,
            commands: F::commands,
        }
    }
}
