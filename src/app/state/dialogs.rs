//! File dialogs of the system, one at a time.

use crate::app::work::outcome::Message;
use crate::app::work::tasks::{TaskOutcome, Tasks};
use std::fmt;
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// A dialog that is closed without an answer faster than this was never visible.
const SEEN_DIALOG: Duration = Duration::from_millis(400);

/// Selection kind of a dialog.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Picks {
    Files,
    File,
    Folder,
    NewFile,
}

/// Callback that receives the chosen paths.
type Answer<S> = Box<dyn FnOnce(&mut S, Vec<PathBuf>) + Send>;

/// A dialog of a window with the state `S`: its question, and the handling of the answer. Dialogs are created where
/// needed and listed nowhere else.
pub(in crate::app) struct Dialog<S> {
    title: &'static str,
    picks: Picks,
    filters: Vec<(String, Vec<&'static str>)>,
    file_name: Option<String>,
    without: &'static str,
    is_of_own_work: bool,
    answer: Answer<S>,
}

impl<S> fmt::Debug for Dialog<S> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_tuple("Dialog").field(&self.title).finish()
    }
}

impl<S> Dialog<S> {
    /// Asks for one or more existing files.
    pub(in crate::app) fn files(
        title: &'static str,
        answer: impl FnOnce(&mut S, Vec<PathBuf>) + Send + 'static,
    ) -> Self {
        Self {
            title,
            picks: Picks::Files,
            filters: Vec::new(),
            file_name: None,
            without: "Drop files or a folder on the window, or name them on the command line: pointreel view FOLDER",
            is_of_own_work: false,
            answer: Box::new(answer),
        }
    }

    fn one(picks: Picks, title: &'static str, answer: impl FnOnce(&mut S, PathBuf) + Send + 'static) -> Self {
        let answer = |state: &mut S, paths: Vec<PathBuf>| {
            if let Some(path) = paths.into_iter().next() {
                answer(state, path);
            }
        };
        Self {
            picks,
            ..Self::files(title, answer)
        }
    }

    /// Asks for an existing file.
    pub(in crate::app) fn file(title: &'static str, answer: impl FnOnce(&mut S, PathBuf) + Send + 'static) -> Self {
        Self::one(Picks::File, title, answer)
    }

    /// Asks for an existing folder.
    pub(in crate::app) fn folder(title: &'static str, answer: impl FnOnce(&mut S, PathBuf) + Send + 'static) -> Self {
        Self::one(Picks::Folder, title, answer)
    }

    /// Asks where to write a file, and proposes a name.
    pub(in crate::app) fn new_file(
        title: &'static str,
        name: String,
        answer: impl FnOnce(&mut S, PathBuf) + Send + 'static,
    ) -> Self {
        Self::one(Picks::NewFile, title, answer).named(name)
    }

    /// Sets a proposed file name.
    pub(in crate::app) fn named(mut self, name: String) -> Self {
        self.file_name = Some(name);
        self
    }

    /// Adds a file filter with these extensions, under a name.
    pub(in crate::app) fn filter(
        mut self,
        name: impl Into<String>,
        extensions: impl IntoIterator<Item = &'static str>,
    ) -> Self {
        self.filters.push((name.into(), extensions.into_iter().collect()));
        self
    }

    /// Sets the advice for systems without dialogs.
    pub(in crate::app) fn without(mut self, advice: &'static str) -> Self {
        self.without = advice;
        self
    }

    /// Marks the dialog as saving user-created work, which must not be lost for want of a dialog: it is then written
    /// under the proposed name.
    pub(in crate::app) fn of_own_work(mut self) -> Self {
        self.is_of_own_work = true;
        self.without("Install one of these for other places")
    }

    /// Returns the advice for systems without dialogs.
    pub(super) fn advice(&self) -> &'static str {
        self.without
    }

    /// The name under which it is written where the system has no dialogs; `None` if it is not then.
    pub(super) fn name_without_dialogs(&self) -> Option<&str> {
        self.file_name.as_deref().filter(|_| self.is_of_own_work)
    }

    /// Gives it the paths that were chosen.
    pub(super) fn answer(self, state: &mut S, paths: Vec<PathBuf>) {
        (self.answer)(state, paths);
    }

    /// Asks the user; `None` without an answer.
    fn show(&self) -> Option<Vec<PathBuf>> {
        let mut dialog = rfd::FileDialog::new().set_title(self.title);
        if let Some(file_name) = &self.file_name {
            dialog = dialog.set_file_name(file_name);
        }
        for (name, extensions) in &self.filters {
            dialog = dialog.add_filter(name, extensions);
        }
        let one = |path: Option<PathBuf>| path.map(|path| vec![path]);
        match self.picks {
            Picks::Files => dialog.pick_files(),
            Picks::File => one(dialog.pick_file()),
            Picks::Folder => one(dialog.pick_folder()),
            Picks::NewFile => one(dialog.save_file()),
        }
    }
}

/// Result of closing a dialog.
#[derive(Debug)]
pub(in crate::app) enum DialogAnswer<S> {
    /// With at least one path.
    Chosen(Dialog<S>, Vec<PathBuf>),
    /// Without any.
    Cancelled,
    /// The system has no dialogs.
    NoDialog(Dialog<S>),
}

impl<S: 'static> Message for DialogAnswer<S> {}

/// The dialog that is open, or none.
#[derive(Debug, Default)]
pub(in crate::app) struct Dialogs {
    is_open: bool,
}

impl Dialogs {
    /// Asks the user. Does nothing while another dialog is open.
    pub(in crate::app) fn ask<S: 'static, T: TaskOutcome + From<DialogAnswer<S>>>(
        &mut self,
        dialog: Dialog<S>,
        tasks: &Tasks<T>,
    ) {
        if std::mem::replace(&mut self.is_open, true) {
            return;
        }
        tasks.start("file dialog", move || {
            let opened = Instant::now();
            match dialog.show() {
                Some(paths) if !paths.is_empty() => DialogAnswer::Chosen(dialog, paths),
                _ if opened.elapsed() < SEEN_DIALOG => DialogAnswer::NoDialog(dialog),
                _ => DialogAnswer::Cancelled,
            }
        });
    }

    /// Takes notice that it was closed.
    pub(in crate::app) fn note_answer(&mut self) {
        self.is_open = false;
    }
}
