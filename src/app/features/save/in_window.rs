//! Re-encoding of the open sequence: the settings, the start and the end.

use super::panel::{SaveRequest, save_ui};
use super::{Estimated, Save};
use crate::app::command::{Chord, Command};
use crate::app::commands::common::{Row, group, needs_sequence};
use crate::app::features::feature::{Feature, FeatureOf};
use crate::app::features::save::{Savable, SaveEnded, SaveFormat, job};
use crate::app::open_panels::PanelId;
use crate::app::panel_row::PanelRow;
use crate::app::state::{Dialog, State, folder_of};
use crate::app::work::files::document_folder;
use crate::app::work::outcome::Outcome;
use crate::app::work::works::WorkKind;
use crate::convert::{Converted, Output, Place, Target};
use crate::messages::{counted, grouped};
use crate::playback::Player;
use crate::reel::ReelOptions;
use crate::scene::FirstLook;
use crate::sequence::Sequence;
use crate::source::AsReel;
use egui::Key;
use egui::Ui;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

/// Frames that could not be written are named one by one up to here.
const NAMED_FAILURES: usize = 3;

impl State {
    /// Shows the choices, or closes them.
    pub(in crate::app) fn toggle_save(&mut self) {
        let is_open = !self.panels.has(PanelId::SAVE);
        self.panels.set(PanelId::SAVE, is_open);
        if is_open {
            let of = self.savable();
            let split_view = self.player.as_ref().and_then(|player| folder_of(player.sequence()));
            self.features
                .save
                .begin(|| split_view.unwrap_or_else(document_folder), &of);
        }
    }

    /// Returns the content available for writing.
    pub(in crate::app) fn savable(&self) -> Savable {
        let player = self.player.as_ref();
        let shown = player.and_then(Player::shown);
        let frame = shown.map(|shown| &shown.frame);
        let count = player.map_or(0, |player| player.sequence().len());
        Savable {
            sequence: player.map(|player| Arc::clone(player.sequence())),
            stem: self.sequence_stem(),
            range: player.map_or(0..0, |player| player.clock().range().of(count)),
            shown: shown.map_or(0, |shown| shown.index),
            is_playing: player.is_some_and(Player::is_playing),
            extent: frame.map_or(0.0, |frame| f64::from(frame.bounds().extent().max_element())),
            unit: frame.and_then(|frame| frame.unit()).map_or("", |unit| unit.symbol()),
            has_colors: frame.is_some_and(|frame| frame.colors().is_some()),
            has_normals: frame.is_some_and(|frame| frame.normals().is_some()),
            samples_surface: self.first_look().is_some_and(FirstLook::has_surface),
            clip: self.style.clip.filter(|clip| clip.is_on),
            is_busy: self.shared.works.has(WorkKind::Save),
        }
    }

    /// The file, or the folder, that is written.
    pub fn save_output(&self) -> PathBuf {
        self.features.save.output(&self.sequence_stem())
    }

    /// Estimates the choices while they are edited.
    pub(in crate::app) fn follow_save(&mut self) {
        if self.panels.has(PanelId::SAVE) {
            let of = self.savable();
            self.features.save.fit(&of);
            self.features.save.estimate(&of, &self.shared.tasks, self.shared.now);
        } else {
            self.features.save.estimates.stop();
        }
    }

    /// Asks for the place of the file, or of the folder.
    pub(in crate::app) fn ask_for_save_place(&mut self) {
        let name = self.features.save.file_stem(&self.sequence_stem()) + self.features.save.suffix();
        let take = |state: &mut Self, place: PathBuf| state.features.save.take_place(&place);
        let dialog = match self.features.save.format {
            SaveFormat::Reel => Dialog::new_file("Save the sequence", name, take).filter("Sequence file", ["reel"]),
            SaveFormat::Files(_) => Dialog::folder("Folder of the frames", take).named(name),
        };
        self.ask(dialog.without("Write folder and name into the fields"));
    }

    /// Begins to write on threads, with everything as it is now.
    pub fn start_save(&mut self) {
        let of = self.savable();
        if let Some(problem) = self.features.save.problem(&of) {
            return self.notices.error(problem);
        }
        let Some((mut conversion, sequence)) = self.features.save.conversion(&of).zip(of.sequence.clone()) else {
            return;
        };
        // Only files that the user was warned about may be replaced.
        let told = self.features.save.place(&of);
        self.features.save.found = None;
        if self.features.save.place(&of) != told {
            let text = "Nothing was saved: another file has come to this place meanwhile, look again";
            return self.notices.error(text);
        }
        conversion.overwrites = told == Place::Taken;
        let output = self.save_output();
        let name = format!("Saving {}", output.file_name().unwrap_or_default().to_string_lossy());
        let progress = self.shared.works.begin(WorkKind::Save, name, self.shared.now);
        self.panels.set(PanelId::SAVE, false);
        self.shared
            .tasks
            .start("save", move || job::run(&sequence, conversion, &progress));
    }

    /// Compares the open sequence with the result of a sequence file with the present settings.
    pub(in crate::app) fn compare_with_saved(&mut self) {
        if let Some(player) = &self.player
            && let Target::Reel(options) = self.features.save.target(player.sequence().fps())
        {
            self.compare_with_retained(options, "as it would be saved");
        }
    }

    /// Compares the open sequence with the result of a sequence file with `options`, which are described by `words`.
    pub fn compare_with_retained(&mut self, options: ReelOptions, words: &str) {
        if let Err(problem) = options.check() {
            return self.notices.error(problem.to_string());
        }
        let Some(player) = &self.player else { return };
        let sequence = player.sequence();
        let retained = AsReel::new(Arc::clone(sequence.source()), options);
        let retained = Sequence::of(retained).with_fps(sequence.fps());
        self.compare_with(Arc::new(retained));
        if let Some(split_view) = &mut self.features.split_view {
            split_view.name = format!("{}, {words}", split_view.name);
        }
    }

    /// Reports the result.
    pub(in crate::app) fn save_has_ended(&mut self, SaveEnded { conversion, result }: SaveEnded) {
        self.features.save.found = None;
        let (Output::File(path) | Output::Folder(path) | Output::Reel(path, _)) = &conversion.output;
        let place = path.display();
        match result {
            Ok(converted) if converted.is_cancelled => self.notices.info(format!(
                "Saving was cancelled after {}: the same choices go on from there",
                counted((converted.written + converted.left) as i64, "frame")
            )),
            Ok(converted) => {
                let frames = counted((converted.written + converted.left) as i64, "frame");
                self.notices.info(format!("Saved {frames}: {place}"));
                self.tell_lost(&converted);
                let losses = converted.losses.lines(&conversion.target_name(), converted.written);
                for text in converted.notes.iter().chain(&losses) {
                    self.notices.warn(text.clone());
                }
            }
            Err(error) => self.notices.error(format!("Nothing was saved: {error}")),
        }
    }

    fn tell_lost(&mut self, converted: &Converted) {
        for (frame, error) in converted.failed.iter().take(NAMED_FAILURES) {
            let place = grouped(frame + 1);
            self.notices.warn(format!("Frame {place} is not in it: {error}"));
        }
        if let Some(more) = converted
            .failed
            .len()
            .checked_sub(NAMED_FAILURES)
            .filter(|&more| more > 0)
        {
            self.notices.warn(format!("{more} more frames are not in it"));
        }
        for (frame, warning) in converted.warnings.iter().take(NAMED_FAILURES) {
            self.notices.warn(format!("Frame {}: {warning}", grouped(frame + 1)));
        }
    }
}

const COMMANDS: &[Row] = &[Row::new(Command::TOGGLE_SAVE, "Save as…", State::toggle_save)
    .what("Save as… (convert to another format)")
    .also(&[
        "convert",
        "transform",
        "downsample",
        "subsample",
        "voxel downsample",
        "decimate",
        "thin",
        "reduce points",
        "compress",
        "remove outliers",
        "save file",
        "write",
        "export point cloud",
        "export mesh",
        "ply",
        "las",
        "laz",
        "pcd",
        "xyz",
        "e57",
        "reel",
        "file format",
    ])
    .hint("One sequence file, or a folder of files; sizes and errors are shown before")
    .keys(group::FILE, "Ctrl+Shift+S", &[Chord::ctrl_shift(Key::S)])
    .applies(needs_sequence)];

impl Feature<State> for FeatureOf<Save> {
    fn update(&self, state: &mut State) -> bool {
        state.follow_save();
        false
    }

    fn take(&self, state: &mut State, outcome: Outcome) -> Result<(), Outcome> {
        outcome
            .give(|ended: SaveEnded| state.save_has_ended(ended))
            .or_else(|outcome| {
                outcome.give(|estimated: Box<Estimated>| state.features.save.estimates.take_in(*estimated))
            })
    }

    fn next_deadline(&self, state: &State) -> Option<Duration> {
        state.features.save.estimates.next_deadline()
    }

    fn forget_sequence(&self, state: &mut State) {
        state.features.save.forget_sequence();
        state.features.save.estimates.stop();
    }

    fn loss(&self, state: &State) -> Option<&'static str> {
        let is_under_way = state.shared.works.has(WorkKind::Save);
        is_under_way.then_some("The sequence is being saved: saving it again would go on from there.")
    }

    fn panels(&self) -> &'static [PanelRow<State>] {
        const PANELS: &[PanelRow<State>] = &[PanelRow::window(PanelId::SAVE, save)];
        PANELS
    }

    fn commands(&self) -> &'static [Row] {
        COMMANDS
    }
}

fn save(ui: &mut Ui, state: &mut State) {
    if !state.panels.has(PanelId::SAVE) {
        return;
    }
    let of = state.savable();
    let top = state.viewport.rect.center_top();
    let mut is_open = true;
    let request = save_ui(ui, &mut is_open, &mut state.features.save, &of, top);
    state.panels.set(PanelId::SAVE, is_open);
    match request {
        Some(SaveRequest::ChoosePlace) => state.ask_for_save_place(),
        Some(SaveRequest::Compare) => state.compare_with_saved(),
        Some(SaveRequest::Start) => state.start_save(),
        None => {}
    }
}
