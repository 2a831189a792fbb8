//! Feature interface of the window.
//!
//! **How it works.** A feature is a folder: its model, which knows neither the window's state nor other features, its
//! work on threads, its panel, and `in_window.rs`, which connects all of that to the state `S` of the window. There its
//! row [`FeatureOf`] the model is a [`Feature`]: its reaction to a moved playhead, its painting, its panels and
//! commands. Only the table (`table.rs`) names features; it reaches `in_window.rs` through this trait, and the trait
//! does not name `S`, so that no file imports in a circle.

use crate::app::command::CommandRow;
use crate::app::panel_row::PanelRow;
use crate::app::settings_row::SettingsRow;
use crate::app::widgets::overlay::PictureOverlay;
use crate::app::work::outcome::Outcome;
use crate::document::Document;
use egui::Ui;
use std::marker::PhantomData;
use std::time::Duration;

/// A feature of a window with the state `S`. Default methods do nothing.
pub(in crate::app) trait Feature<S: 'static> {
    /// Moves on with the time, before the playhead does. True if something can be seen to change.
    fn update(&self, _state: &mut S) -> bool {
        false
    }

    /// Starts its work on the shown frame. True if there is a visible change.
    fn follow_frame(&self, _state: &mut S) -> bool {
        false
    }

    /// Follows all other changes, once the style of the shown frame is known.
    fn follow(&self, _state: &mut S) {}

    /// Applies changes by the panels at once.
    fn follow_panels(&self, _state: &mut S) {}

    /// Time at which [`Feature::update`] or [`Feature::follow_frame`] has something to do without input.
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

    /// Takes the result of a task; returns results of other types.
    fn take(&self, _state: &mut S, outcome: Outcome) -> Result<(), Outcome> {
        Err(outcome)
    }

    /// Forgets frame `index`, which is read again.
    fn forget_frame(&self, _state: &mut S, _index: usize) {}

    /// Forgets the data of the sequence that was open before.
    fn forget_sequence(&self, _state: &mut S) {}

    /// Updates its part of the document, where its working data has more than that: once per pass.
    fn save(&self, _state: &S, _document: &mut Document) {}

    /// Restores its stored data of the opened sequence.
    fn load(&self, _state: &mut S, _document: &Document) {}

    /// Takes its part of the document after undo or redo, which may be unchanged.
    fn put_back(&self, state: &mut S, document: &Document) {
        self.load(state, document);
    }

    /// Closes its topmost panel or tool: Escape. False if there is none.
    fn escape(&self, _state: &mut S) -> bool {
        false
    }

    /// Returns a sentence about unsaved data that would be lost by quitting the program.
    fn loss(&self, _state: &S) -> Option<&'static str> {
        None
    }

    /// Paints its marks over an image; `is_first` for the image of the open sequence.
    fn paint(&self, _state: &S, _canvas: &PictureOverlay<'_>, _is_first: bool) {}

    /// Shows its handles over the image of the open sequence.
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
