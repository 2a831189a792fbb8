//! Feature interface of the window.
//!
//! **How it works.** A feature is a folder: its model, which knows neither the window's state nor other features, its
//! work on threads, its panel, and `in_window.rs`, where all of that meets the state `S` of the window. There its row
//! [`FeatureOf`] the model is a [`Feature`]: what it does when the playhead moves, what is painted, which panels and
//! commands it has. Only the table (`table.rs`) names features; it reaches `in_window.rs` through this trait, and the
//! trait does not name `S`, so that no file imports in a circle.

use crate::app::command::CommandRow;
use crate::app::panel_row::PanelRow;
use crate::app::settings_row::SettingsRow;
use crate::app::widgets::overlay::PictureOverlay;
use crate::app::work::outcome::Outcome;
use crate::document::Document;
use egui::Ui;
use std::marker::PhantomData;
use std::time::Duration;

/// A feature of a window with the state `S`. What is not written does nothing.
pub(in crate::app) trait Feature<S: 'static> {
    /// Moves on with the time, before the playhead does. True if something can be seen to change.
    fn update(&self, _state: &mut S) -> bool {
        false
    }

    /// Begins what it makes of the frame that is shown. True if something can be seen to change.
    fn follow_frame(&self, _state: &mut S) -> bool {
        false
    }

    /// Follows all else that has changed, once it is known what the shown frame is looked at as.
    fn follow(&self, _state: &mut S) {}

    /// Takes in at once what the panels have changed.
    fn follow_panels(&self, _state: &mut S) {}

    /// When [`Feature::update`] or [`Feature::follow_frame`] has something to do by itself.
    fn next_deadline(&self, _state: &S) -> Option<Duration> {
        None
    }

    /// Returns true if this feature makes panels show more of the playing frame than its position on the timeline.
    fn shows_frame(&self, _state: &S) -> bool {
        false
    }

    /// Returns true if anything other than the rendered image may have changed: marks, progress.
    fn has_news(&self, _state: &S) -> bool {
        false
    }

    /// Takes what a task came to; gives back what is not of a type of its own.
    fn take(&self, _state: &mut S, outcome: Outcome) -> Result<(), Outcome> {
        Err(outcome)
    }

    /// Forgets frame `index`, which is read again.
    fn forget_frame(&self, _state: &mut S, _index: usize) {}

    /// Forgets what belongs to the sequence that was open before.
    fn forget_sequence(&self, _state: &mut S) {}

    /// Brings up to date what the document has of it, where it works on more than that: once a pass.
    fn save(&self, _state: &S, _document: &mut Document) {}

    /// Takes what was kept of it with the sequence that was opened.
    fn load(&self, _state: &mut S, _document: &Document) {}

    /// Takes what undo or redo has put back in the document, which may be what it has already.
    fn put_back(&self, state: &mut S, document: &Document) {
        self.load(state, document);
    }

    /// Closes what it has over all else: Escape. False if there is nothing.
    fn escape(&self, _state: &mut S) -> bool {
        false
    }

    /// Returns a sentence about unsaved data that would be lost by quitting the program.
    fn loss(&self, _state: &S) -> Option<&'static str> {
        None
    }

    /// Paints its marks over a picture; `is_first` of that of the open sequence.
    fn paint(&self, _state: &S, _canvas: &PictureOverlay<'_>, _is_first: bool) {}

    /// Shows what can be taken hold of over the picture of the open sequence.
    fn handles(&self, _ui: &Ui, _state: &mut S) {}

    /// Its panels.
    fn panels(&self) -> &'static [PanelRow<S>] {
        &[]
    }

    /// Its sections of the panel of settings.
    fn settings(&self) -> &'static [SettingsRow<S>] {
        &[]
    }

    /// Its commands.
    fn commands(&self) -> &'static [CommandRow<S>] {
        &[]
    }
}

/// A row of the table: the feature whose model is `F`.
pub(in crate::app) struct FeatureOf<F>(pub(super) PhantomData<F>);
