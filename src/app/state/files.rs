//! Dialogs and the files that are chosen with them.

use super::dialogs::{DialogAnswer, DialogKind};
use super::{State, WindowRequest};
use crate::app::features::benchmark::{Benchmark, ReportFormat};
use crate::app::work::files::{PicturePlace, picture_folder, save_bytes, save_picture, with_extension};
use crate::session::EXTENSION;
use std::path::PathBuf;

impl State {
    /// Asks the person. Nothing happens while another dialog is open.
    pub(super) fn ask(&mut self, dialog: DialogKind, file_name: Option<String>) {
        self.dialogs.ask(dialog, file_name, &self.tasks);
    }

    /// Takes the answer to a dialog.
    pub(super) fn take_answer(&mut self, answer: DialogAnswer) {
        self.dialogs.note_answer();
        match answer {
            DialogAnswer::Chosen { dialog, paths } => self.chosen(dialog, paths),
            DialogAnswer::Cancelled => {}
            DialogAnswer::NoDialog(dialog) => self.notices.error(format!(
                "No file dialog could be opened: on Linux one needs xdg-desktop-portal or zenity. {}",
                dialog.without_dialogs()
            )),
        }
    }

    fn chosen(&mut self, dialog: DialogKind, paths: Vec<PathBuf>) {
        let first = paths[0].clone();
        match dialog {
            DialogKind::OpenFiles | DialogKind::OpenFolder => {
                self.open_paths(paths);
            }
            DialogKind::CompareFiles | DialogKind::CompareFolder => self.compare_paths(paths),
            DialogKind::SavePicture => {
                self.requests
                    .push(WindowRequest::Screenshot(Some(with_extension(first, "png"))));
            }
            DialogKind::RecordTo => self.record_to(&with_extension(first, "pointreel-stream")),
            DialogKind::OpenPath => self.open_path(first),
            DialogKind::SavePath => self.save_path_to(with_extension(first, "json")),
            DialogKind::SaveSession => self.save_session_to(with_extension(first, EXTENSION)),
            DialogKind::ExportTo(_) | DialogKind::ExportFolder => {
                let is_folder = dialog == DialogKind::ExportFolder;
                self.export.take_place(is_folder, &first);
            }
            DialogKind::SaveReel | DialogKind::SaveFolder => self.save.take_place(&first),
            DialogKind::SaveReport(format) => {
                let Benchmark::Done(table) = &self.benchmark else {
                    return;
                };
                let text = table.text_as(format).to_owned();
                let file = with_extension(first, format.extension());
                self.tasks
                    .try_start("save file", move || save_bytes(file, text.as_bytes()));
            }
        }
    }

    /// Asks where to write the benchmark's result.
    pub(in crate::app) fn ask_for_report(&mut self, format: ReportFormat) {
        if let Benchmark::Done(table) = &self.benchmark {
            let name = format!("pointreel-{}.{}", table.suite, format.extension());
            self.ask(DialogKind::SaveReport(format), Some(name));
        }
    }

    /// Writes `image` to `path`, or to a new file in the folder of pictures.
    pub fn save_picture(&mut self, image: image::RgbaImage, path: Option<PathBuf>) {
        let place = match path {
            Some(path) => PicturePlace::File(path),
            None => PicturePlace::New {
                folder: picture_folder(),
                stem: self.picture_stem(),
            },
        };
        self.tasks
            .try_start("save picture", move || save_picture(&image, place));
    }
}
