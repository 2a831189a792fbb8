//! Write plan under the present settings, and its availability.

use super::choices::{Save, SaveFormat, usual_length};
use super::estimates::{Asked, Estimated};
use crate::app::work::tasks::{TaskOutcome, Tasks};
use crate::convert::{Conversion, Edit, Output, Place, Shard, Target};
use crate::io::WriteFormat;
use crate::scene::Clip;
use crate::sequence::Sequence;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

/// Content available for writing.
#[derive(Debug, Clone)]
#[expect(clippy::struct_excessive_bools, reason = "each is known of what is open")]
pub(in crate::app) struct Savable {
    /// The open sequence, if there is one.
    pub(in crate::app) sequence: Option<Arc<Sequence>>,
    /// File stem of the open input, for names of files.
    pub(in crate::app) stem: String,
    /// Frames from in to out point.
    pub(in crate::app) range: std::ops::Range<usize>,
    /// The frame that is shown.
    pub(in crate::app) shown: usize,
    pub(in crate::app) is_playing: bool,
    /// Longest edge of its box, in the unit of the file.
    pub(in crate::app) extent: f64,
    /// The unit, empty if no file has it.
    pub(in crate::app) unit: &'static str,
    pub(in crate::app) has_colors: bool,
    pub(in crate::app) has_normals: bool,
    /// Its points sample a surface.
    pub(in crate::app) samples_surface: bool,
    /// The clip that the image is drawn with.
    pub(in crate::app) clip: Option<Clip>,
    /// Another sequence is being written.
    pub(in crate::app) is_busy: bool,
}

impl Save {
    /// Judges the choices, some frames at a time.
    pub(in crate::app) fn estimate<T: TaskOutcome + From<Box<Estimated>>>(
        &mut self,
        of: &Savable,
        tasks: &Tasks<T>,
        now: Duration,
    ) {
        let Some(sequence) = of.sequence.as_ref().filter(|sequence| !sequence.source().is_live()) else {
            return self.estimates.stop();
        };
        let asked = Asked {
            sequence,
            target: self.target(sequence.fps()),
            edit: self.edit(of),
            goal: self.goal(),
            frames: self.frames(of),
            shown: of.shown,
            is_playing: of.is_playing,
        };
        self.estimates.follow(asked, tasks, now);
    }

    /// Opens the save settings. Files are checked again.
    pub(in crate::app) fn begin(&mut self, folder: impl FnOnce() -> PathBuf, of: &Savable) {
        self.found = None;
        if self.folder.is_empty() {
            self.folder = folder().display().to_string();
        }
        self.fit(of);
    }

    /// Adopts defaults from the cloud: its kind, and a length for its extent, unless there is one.
    pub(in crate::app) fn fit(&mut self, of: &Savable) {
        self.samples_surface = of.samples_surface;
        if self.length == 0.0 && of.extent > 0.0 {
            self.length = usual_length(of.extent);
        }
    }

    /// Forgets choices for another sequence: lengths and names apply to only one.
    pub(in crate::app) fn forget_sequence(&mut self) {
        (self.length, self.name, self.found) = (0.0, None, None);
    }

    /// The name without extension, of a sequence that is known as `stem`.
    pub(in crate::app) fn file_stem(&self, stem: &str) -> String {
        self.name.clone().unwrap_or_else(|| stem.to_owned())
    }

    /// Returns the suffix of the file name.
    pub(in crate::app) fn suffix(&self) -> &'static str {
        match self.format {
            SaveFormat::Reel => ".reel",
            SaveFormat::Files(_) => "",
        }
    }

    /// The file, or the folder.
    pub(in crate::app) fn output(&self, stem: &str) -> PathBuf {
        Path::new(&self.folder).join(self.file_stem(stem) + self.suffix())
    }

    /// The frames that are written, both ends included.
    pub(in crate::app) fn frames(&self, of: &Savable) -> RangeInclusive<usize> {
        let count = of.sequence.as_ref().map_or(0, |sequence| sequence.len());
        let frames = if self.is_of_range { of.range.clone() } else { 0..count };
        frames.start..=frames.end.saturating_sub(1)
    }

    /// The changes to each frame.
    pub(in crate::app) fn edit(&self, of: &Savable) -> Edit {
        Edit {
            crop: of.clip.filter(|_| self.crops),
            ..Edit::default()
        }
    }

    /// The conversion; `None` without a sequence.
    pub(in crate::app) fn conversion(&self, of: &Savable) -> Option<Conversion> {
        let output = self.output(&of.stem);
        let (output, format) = match self.target(of.sequence.as_ref()?.fps()) {
            Target::Reel(options) => (Output::Reel(output, options), WriteFormat::default()),
            Target::Files(format) => (Output::Folder(output), format),
        };
        Some(Conversion {
            frames: Some(self.frames(of)),
            shard: Shard::WHOLE,
            edit: self.edit(of),
            format,
            output,
            goal: self.goal(),
            overwrites: false,
            reading: String::new(),
        })
    }

    /// Returns the state of the destination. Checked when destination or settings change.
    pub(in crate::app) fn place(&mut self, of: &Savable) -> Place {
        let Some((sequence, conversion)) = of.sequence.as_ref().zip(self.conversion(of)) else {
            return Place::Free;
        };
        let (output, target) = (self.output(&of.stem), self.target(sequence.fps()));
        match &self.found {
            // Not again for each step of a clip that is dragged: all inputs are looked at. Saving looks again.
            Some((known, of_target, crops, place))
                if *known == output && *of_target == target && *crops == self.crops =>
            {
                *place
            }
            _ => {
                let place = match Place::of(&conversion, sequence) {
                    // Its precision is chosen again, so it may begin anew.
                    Place::Interrupted if self.goal().is_some() => Place::Taken,
                    place => place,
                };
                self.found = Some((output, target, self.crops, place));
                place
            }
        }
    }

    /// Why it cannot be written as it was chosen; `None` if it can.
    pub(in crate::app) fn problem(&mut self, of: &Savable) -> Option<String> {
        let name = self.file_stem(&of.stem);
        let Some(sequence) = &of.sequence else {
            return Some("No sequence is open".to_owned());
        };
        if sequence.source().is_live() || sequence.frames().start > 0 {
            return Some(
                "This sequence is live: its frames are gone before all of them could be read again. Record a stream by \
                 File, Record… and save what was recorded"
                    .to_owned(),
            );
        }
        if of.is_busy {
            return Some("Another sequence is being saved".to_owned());
        }
        if name.trim().is_empty() || name.contains(['/', '\\']) {
            return Some("The name is empty or has a / or \\".to_owned());
        }
        if let Target::Reel(options) = self.target(sequence.fps())
            && let Err(problem) = options.check()
        {
            return Some(problem.to_string());
        }
        match self.place(of) {
            Place::Source => Some("This is the open sequence: choose another name".to_owned()),
            Place::NoFolder => Some(format!("Folder {} does not exist", self.folder)),
            Place::Occupied => Some("There are other files in this folder: choose another name".to_owned()),
            Place::Free | Place::Interrupted | Place::Taken => None,
        }
    }

    /// Takes the folder, or the file, that was chosen with a dialog.
    pub(in crate::app) fn take_place(&mut self, place: &Path) {
        let name = match self.format {
            SaveFormat::Reel => place.file_stem(),
            SaveFormat::Files(_) => place.file_name(),
        };
        self.name = name.map(|name| name.to_string_lossy().into_owned());
        self.folder = place.parent().unwrap_or(place).display().to_string();
        self.found = None;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sequence::Shape;
    use crate::source::Spin;

    fn savable(sequence: Sequence) -> Savable {
        Savable {
            range: 1..4,
            shown: 0,
            is_playing: false,
            stem: "walk".to_owned(),
            extent: 2.0,
            unit: "",
            has_colors: true,
            has_normals: true,
            samples_surface: true,
            clip: None,
            is_busy: false,
            sequence: Some(Arc::new(sequence)),
        }
    }

    #[test]
    fn unwritable_combinations_are_reported() {
        let folder = tempfile::tempdir().unwrap();
        let mut of = savable(Sequence::demo());
        let mut save = Save::default();
        save.begin(|| folder.path().to_owned(), &of);
        assert_eq!(save.problem(&of), None);
        assert_eq!(save.output("walk"), folder.path().join("walk.reel"));
        save.name = Some("a/b".to_owned());
        assert!(save.problem(&of).unwrap().contains("has a /"));
        save.name = Some("walk".to_owned());
        save.precision = super::super::PrecisionKind::Length;
        save.length = 0.0;
        assert!(save.problem(&of).unwrap().contains("above zero"));
        save.length = 0.1;
        save.folder = folder.path().join("missing").display().to_string();
        assert!(save.problem(&of).unwrap().contains("does not exist"));
        of.is_busy = true;
        assert!(save.problem(&of).unwrap().contains("Another sequence"));
        let live = savable(Sequence::of(Spin::new(Shape::Torus, 100)));
        assert!(save.problem(&live).unwrap().contains("live"));
        of.sequence = None;
        assert!(save.problem(&of).unwrap().contains("No sequence"));
    }

    #[test]
    fn chosen_paths_are_split_into_folder_and_name() {
        let mut save = Save::default();
        save.take_place(Path::new("/scans/walk.v2.reel"));
        assert_eq!(
            (save.folder.as_str(), save.name.as_deref()),
            ("/scans", Some("walk.v2"))
        );
        assert_eq!(save.output("x"), Path::new("/scans/walk.v2.reel"));
        save.format = SaveFormat::Files(WriteFormat::default());
        save.take_place(Path::new("/scans/walk.v2"));
        assert_eq!(save.output("x"), Path::new("/scans/walk.v2"));
    }

    #[test]
    fn a_clip_crops_on_request() {
        use crate::scene::ClipShape;
        let mut of = savable(Sequence::demo());
        let mut save = Save {
            crops: true,
            ..Save::default()
        };
        assert_eq!(save.edit(&of), Edit::default(), "nothing is clipped");
        of.clip = Some(Clip::to(ClipShape::Plane {
            normal: glam::DVec3::X,
            offset: 0.0,
        }));
        assert_eq!(save.conversion(&of).unwrap().edit.crop, of.clip);
        save.crops = false;
        assert_eq!(save.conversion(&of).unwrap().edit.crop, None);
    }

    #[test]
    fn frames_are_all_or_those_between_the_in_and_out_points() {
        let of = savable(Sequence::demo());
        let mut save = Save::default();
        assert_eq!(save.frames(&of), 0..=23);
        save.is_of_range = true;
        assert_eq!(save.frames(&of), 1..=3);
        assert_eq!(save.conversion(&of).unwrap().frames, Some(1..=3));
    }
}
