//! Detection of the source type of a set of images: one time step, or multi-view video.
//!
//! *A folder above.* `scene` may have no frames of its own and hold `scene/nerf/transforms.json`, or be a data set of
//! one sequence. Its one sub-folder is opened instead of it ([`open_below`]); of several the message names those that
//! are possible. This is tried last, and only for a folder that has no cloud files; files that merely accompany images
//! do not count as such.

use super::multiview_video::MultiviewVideo;
use super::opener::Asked;
use super::photos::PhotoScene;
use super::{Files, OpenOptions, SequenceError, Source, rgbd};
use crate::io::Format;
use crate::io::refused::foreign::by_members;
use crate::natural::natural_order;
use crate::photos::{self, PhotosError};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Entries of a folder that are looked at.
const MAX_ENTRIES: usize = 10_000;

/// Maximum number of sub-folders examined: a folder with more is not a data set of a few scenes.
const MAX_FOLDERS: usize = 64;

/// Sub-folders that a message names.
const MAX_NAMES: usize = 6;

/// Opens calibrated images, if those are the one input.
///
/// # Errors
/// If the files break the rules of their format, or none of the images can be shown.
fn open(inputs: &[PathBuf], options: &OpenOptions) -> Result<Option<Arc<dyn Source>>, SequenceError> {
    let [input] = inputs else { return Ok(None) };
    let Some(found) = photos::find(input).map_err(wrong)? else {
        let sets = MultiviewVideo::of_sets(inputs, options);
        return Ok(sets.map(|sets| Arc::new(sets) as Arc<dyn Source>));
    };
    let calibration = found.calibration().map_err(wrong)?;
    let model = found.path;
    Ok(Some(
        match MultiviewVideo::of(calibration, inputs, options).map_err(wrong)? {
            Ok(video) => Arc::new(video),
            Err(calibration) => Arc::new(PhotoScene::of(
                calibration.posed_images().map_err(wrong)?,
                &model,
                input,
                options,
            )),
        },
    ))
}

/// [`open`] if the inputs are not a recording, whose depth images count more.
pub(super) fn open_unless_depth(asked: Asked<'_>) -> Result<Option<Arc<dyn Source>>, SequenceError> {
    if rgbd::comes_before_photos(asked.inputs, asked.options) {
        return Ok(None);
    }
    open(asked.inputs, asked.options)
}

/// [`open_below`] the one folder, unless it is a recording of clouds.
pub(super) fn open_one_below(asked: Asked<'_>) -> Result<Option<Arc<dyn Source>>, SequenceError> {
    let [input] = asked.inputs else { return Ok(None) };
    if !input.is_dir() {
        return Ok(None);
    }
    let error = match open_below(input, asked.options) {
        Ok(below) => return Ok(below),
        Err(error) => error,
    };
    // Images in a folder of a cloud recording are not a reason to refuse it.
    match Files::open(asked.inputs, asked.options, asked.progress) {
        // Lists of numbers next to images are not a cloud recording.
        Ok(files) if !files.are_texts() => Ok(Some(Arc::new(files))),
        Err(several @ SequenceError::Several { .. }) => Err(several),
        _ => Err(error),
    }
}

/// Opens the one sub-folder of `input` that can be opened; `None` if `input` has frames of its own, or it is unknown.
///
/// # Errors
/// If several could be opened, if the one cannot, or if the folder holds images that are not read.
fn open_below(input: &Path, options: &OpenOptions) -> Result<Option<Arc<dyn Source>>, SequenceError> {
    let Some(folders) = folders_of_no_frames(input) else {
        return Ok(None);
    };
    let holds_set = |folder: &PathBuf| matches!(photos::find(folder), Ok(Some(_))) || rgbd::is_likely(folder);
    let found: Vec<PathBuf> = folders.into_iter().take(MAX_FOLDERS).filter(holds_set).collect();
    match found.as_slice() {
        [] => match photos::unread(input) {
            // Images are found next to the parts of many things, which the refusal of the files names.
            Some(error) if !is_foreign(input) => Err(wrong(error)),
            _ => Ok(None),
        },
        [one] => {
            let inputs = [one.clone()];
            if let Some(posed_images) = open(&inputs, options)? {
                return Ok(Some(posed_images));
            }
            rgbd::open(&inputs, options)
        }
        several => Err(wrong(PhotosError::NoSet {
            path: input.to_owned(),
            found: format!("{} folders that can be opened", several.len()),
            advice: format!("open one of them ({})", names(several)),
        })),
    }
}

/// True if the files of a folder are the parts of one thing that is not read, such as a project of `ReCap`.
fn is_foreign(folder: &Path) -> bool {
    let entries = fs::read_dir(folder).into_iter().flatten().take(MAX_ENTRIES).flatten();
    let names: Vec<String> = entries
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .collect();
    by_members(&names.iter().map(String::as_str)).is_some()
}

fn wrong(error: PhotosError) -> SequenceError {
    SequenceError::Photos(Box::new(error))
}

/// The sub-folders of a folder in which no file is a cloud by its extension.
fn folders_of_no_frames(input: &Path) -> Option<Vec<PathBuf>> {
    let mut folders = Vec::new();
    for entry in fs::read_dir(input).ok()?.take(MAX_ENTRIES).flatten() {
        let path = entry.path();
        if entry.file_name().to_string_lossy().starts_with('.') {
            continue;
        }
        if path.is_dir() {
            folders.push(path);
        } else if Format::of_extension(&path).is_some() && !photos::is_outside_photos(&path) {
            return None;
        }
    }
    folders.sort_by(|left, right| natural_order(left, right));
    Some(folders)
}

fn names(folders: &[PathBuf]) -> String {
    let names = folders.iter().take(MAX_NAMES).filter_map(|folder| folder.file_name());
    let names: Vec<String> = names.map(|name| name.to_string_lossy().into_owned()).collect();
    let more = if folders.len() > MAX_NAMES { ", …" } else { "" };
    format!("{}{more}", names.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder_with(files: &[&str]) -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        let transforms = r#"{"fl_x": 10, "frames": [{"file_path": "a.png",
            "transform_matrix": [[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]}]}"#;
        for file in files {
            let path = folder.path().join(file);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            match path.extension().and_then(|extension| extension.to_str()) {
                Some("json") => fs::write(path, transforms).unwrap(),
                Some("png") => image::RgbImage::new(8, 6).save(path).unwrap(),
                _ => fs::write(path, b"sequence1").unwrap(),
            }
        }
        folder
    }

    fn opened(files: &[&str]) -> Result<Option<usize>, String> {
        let folder = folder_with(files);
        let opened = open_below(folder.path(), &OpenOptions::default()).map_err(|error| error.to_string())?;
        Ok(opened.map(|source| source.posed_images(0).map_or(0, |set| set.photos.len())))
    }

    #[test]
    fn the_only_image_set_below_is_opened() {
        assert_eq!(
            opened(&["scene/transforms.json", "scene/a.png", "notes/b.md"]),
            Ok(Some(1))
        );
    }

    #[test]
    fn several_image_sets_are_named_in_the_error() {
        let several = ["one/transforms.json", "two/transforms.json", "README.txt"];
        let error = opened(&several).unwrap_err();
        assert!(
            error.contains("2 folders that can be opened: open one of them (one, two)"),
            "{error}"
        );
    }

    #[test]
    fn a_folder_of_clouds_is_not_an_image_set() {
        assert_eq!(opened(&["a.ply", "scene/transforms.json", "scene/a.png"]), Ok(None));
        assert_eq!(opened(&["notes.md"]), Ok(None));
        assert_eq!(opened(&["scan.rcp", "a.png"]), Ok(None));
    }

    #[test]
    fn sequences_of_a_data_set_are_listed() {
        let two = [
            "seq-01/frame-000000.depth.png",
            "seq-02/frame-000000.depth.png",
            "TestSplit.txt",
        ];
        let error = opened(&two).unwrap_err();
        assert!(error.contains("(seq-01, seq-02)"), "{error}");
    }

    #[test]
    fn images_without_cameras_are_reported() {
        let error = opened(&["images/a.png"]).unwrap_err();
        assert!(error.contains("images without camera poses"), "{error}");
    }
}
