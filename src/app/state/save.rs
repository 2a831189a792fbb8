//! The open sequence is written anew: the choices, the beginning and the end.

use super::State;
use super::dialogs::DialogKind;
use crate::app::features::save::{Savable, SaveEnded, SaveFormat, job};
use crate::app::open_panels::PanelId;
use crate::app::work::files::document_folder;
use crate::app::work::works::WorkKind;
use crate::convert::{Converted, Output, Place, Target};
use crate::playback::Player;
use crate::reel::ReelOptions;
use crate::scene::FirstLook;
use crate::sequence::Sequence;
use crate::source::AsReel;
use std::path::PathBuf;
use std::sync::Arc;

/// Frames that could not be written are named one by one up to here.
const NAMED_FAILURES: usize = 3;

impl State {
    /// Shows the choices, or closes them.
    pub(super) fn toggle_save(&mut self) {
        let is_open = !self.panels.has(PanelId::SAVE);
        self.panels.set(PanelId::SAVE, is_open);
        if is_open {
            let of = self.savable();
            let beside = self.player.as_ref().and_then(|player| folder_of(player.sequence()));
            self.save.begin(|| beside.unwrap_or_else(document_folder), &of);
        }
    }

    /// What there is to write.
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
            is_busy: self.works.has(WorkKind::Save),
        }
    }

    /// The file, or the folder, that is written.
    pub fn save_output(&self) -> PathBuf {
        self.save.output(&self.sequence_stem())
    }

    /// Has the choices judged while they are made.
    pub(super) fn follow_save(&mut self) {
        if self.panels.has(PanelId::SAVE) {
            let of = self.savable();
            self.save.fit(&of);
            self.estimates.follow(&self.save, &of, &self.tasks, self.now);
        } else {
            self.estimates.stop();
        }
    }

    /// Asks for the place of the file, or of the folder.
    pub(in crate::app) fn ask_for_save_place(&mut self) {
        let name = self.save.file_stem(&self.sequence_stem()) + self.save.suffix();
        let dialog = match self.save.format {
            SaveFormat::Reel => DialogKind::SaveReel,
            SaveFormat::Files(_) => DialogKind::SaveFolder,
        };
        self.ask(dialog, Some(name));
    }

    /// Begins to write on threads, with everything as it is now.
    pub fn start_save(&mut self) {
        let of = self.savable();
        if let Some(problem) = self.save.problem(&of) {
            return self.notices.error(problem);
        }
        let Some((mut conversion, sequence)) = self.save.conversion(&of).zip(of.sequence.clone()) else {
            return;
        };
        // What the person was told of is what may be replaced.
        let told = self.save.place(&of);
        self.save.found = None;
        if self.save.place(&of) != told {
            let text = "Nothing was saved: another file has come to this place meanwhile, look again";
            return self.notices.error(text);
        }
        conversion.overwrites = told == Place::Taken;
        let output = self.save_output();
        let name = format!("Saving {}", output.file_name().unwrap_or_default().to_string_lossy());
        let progress = self.works.begin(WorkKind::Save, name, self.now);
        self.panels.set(PanelId::SAVE, false);
        self.tasks
            .start("save", move || job::run(&sequence, conversion, &progress));
    }

    /// Shows what a sequence file with the present choices would give beside what is open.
    pub(in crate::app) fn compare_with_saved(&mut self) {
        if let Some(player) = &self.player
            && let Target::Reel(options) = self.save.target(player.sequence().fps())
        {
            self.compare_with_kept(options, "as it would be saved");
        }
    }

    /// Shows what a sequence file with `options`, which are told as `words`, would give beside what is open.
    pub fn compare_with_kept(&mut self, options: ReelOptions, words: &str) {
        if let Err(problem) = options.check() {
            return self.notices.error(problem.to_string());
        }
        let Some(player) = &self.player else { return };
        let sequence = player.sequence();
        let kept = AsReel::new(Arc::clone(sequence.source()), options);
        let kept = Sequence::of(kept).with_fps(sequence.fps());
        self.compare_with(Arc::new(kept));
        if let Some(beside) = &mut self.beside {
            beside.name = format!("{}, {words}", beside.name);
        }
    }

    /// Says what came of it.
    pub(super) fn save_has_ended(&mut self, SaveEnded { conversion, result }: SaveEnded) {
        self.save.found = None;
        let (Output::File(path) | Output::Folder(path) | Output::Reel(path, _)) = &conversion.output;
        let place = path.display();
        match result {
            Ok(converted) if converted.is_cancelled => self.notices.info(format!(
                "Saving was cancelled after {} frames: the same choices go on from there",
                converted.written + converted.left
            )),
            Ok(converted) => {
                let frames = converted.written + converted.left;
                self.notices.info(format!("Saved {frames} frames: {place}"));
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
            let place = frame + 1;
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
            self.notices.warn(format!("Frame {}: {warning}", frame + 1));
        }
    }
}

/// Where a person looks for what was made of a sequence: beside it.
pub(super) fn folder_of(sequence: &Sequence) -> Option<PathBuf> {
    let input = sequence.source().inputs().first()?;
    let folder = std::path::absolute(input).ok()?.parent()?.to_owned();
    let can_be_written = |folder: &PathBuf| folder.metadata().is_ok_and(|folder| !folder.permissions().readonly());
    Some(folder).filter(|folder| folder.is_dir() && can_be_written(folder))
}
