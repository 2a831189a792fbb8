//! Files that are written on a thread: images and reports.

use super::tasks::TaskFailed;
use crate::export::{PictureFormat, encode_picture};
use crate::persist::{write_to, write_whole_with};
use crate::temporary::Temporary;
use std::fs;
use std::io::{BufWriter, Write as _};
use std::path::{Path, PathBuf};

/// A file was written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SavedFile(pub PathBuf);

/// Destination of an image.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::app) enum PicturePlace {
    /// This file, which is replaced if it exists: the user was asked.
    File(PathBuf),
    /// A new file.
    New {
        /// Its folder.
        folder: PathBuf,
        /// The beginning of its name.
        stem: String,
    },
}

/// Writes `bytes` to `path`.
pub(in crate::app) fn save_bytes(path: PathBuf, bytes: &[u8]) -> Result<SavedFile, TaskFailed> {
    match write_to(&path, bytes) {
        Ok(()) => Ok(SavedFile(path)),
        Err(reason) => Err(TaskFailed(cannot_write(&path, &reason))),
    }
}

/// Writes `image` to its place, or under a name made from the stem that no file has yet.
pub(in crate::app) fn save_picture(image: &image::RgbaImage, place: PicturePlace) -> Result<SavedFile, TaskFailed> {
    let saved = match place {
        PicturePlace::File(path) => save_image(image, &path).map(|()| path),
        PicturePlace::New { folder, stem } => save_new_png(image, &folder, &stem),
    };
    saved.map(SavedFile).map_err(TaskFailed)
}

fn cannot_write(path: &Path, reason: &dyn std::fmt::Display) -> String {
    format!(
        "{} could not be written ({reason}): choose another folder or free disk space",
        path.display()
    )
}

/// Writes an image in the format of its name, replacing the file as a whole.
pub(in crate::app) fn save_image(image: &image::RgbaImage, path: &Path) -> Result<(), String> {
    let format = PictureFormat::of_name(path).map_err(|refused| refused.to_string())?;
    let written = write_whole_with(path, |file| {
        let mut file = BufWriter::new(file);
        encode_picture(format, image, &mut file)?;
        file.flush()
    });
    written.map_err(|reason| cannot_write(path, &reason))
}

/// Names of new files that are tried.
const MAX_TRIED: usize = 9_999;

/// Writes a PNG to `folder/stem.png`, or `folder/stem-2.png` and so on; never replaces a file.
fn save_new_png(image: &image::RgbaImage, folder: &Path, stem: &str) -> Result<PathBuf, String> {
    let mut encoded = std::io::Cursor::new(Vec::new());
    image
        .write_to(&mut encoded, image::ImageFormat::Png)
        .map_err(|reason| cannot_write(folder, &reason))?;
    for path in numbered_files(folder, stem, "png").take(MAX_TRIED) {
        match fs::File::create_new(&path) {
            Ok(mut file) => {
                let unfinished = Temporary::file(&path);
                let written = file.write_all(encoded.get_ref()).and_then(|()| file.sync_data());
                written.map_err(|reason| cannot_write(&path, &reason))?;
                unfinished.keep();
                return Ok(path);
            }
            Err(reason) if reason.kind() == std::io::ErrorKind::AlreadyExists => {}
            Err(reason) => return Err(cannot_write(&path, &reason)),
        }
    }
    Err(cannot_write(folder, &"every name is taken"))
}

/// `folder/stem.extension`, `folder/stem-2.extension` and so on: the first that is not there is for a new file.
pub(in crate::app) fn numbered_files(folder: &Path, stem: &str, extension: &str) -> impl Iterator<Item = PathBuf> {
    (1_u32..).map(move |number| {
        folder.join(match number {
            1 => format!("{stem}.{extension}"),
            _ => format!("{stem}-{number}.{extension}"),
        })
    })
}

/// `path`, with this extension if it has none.
pub(in crate::app) fn with_extension(path: PathBuf, extension: &str) -> PathBuf {
    if path.extension().is_some() {
        path
    } else {
        path.with_extension(extension)
    }
}

/// The user's Pictures folder if the system has one, else the working directory.
pub(in crate::app) fn picture_folder() -> PathBuf {
    directories::UserDirs::new()
        .and_then(|folders| folders.picture_dir().map(PathBuf::from))
        .filter(|folder| folder.is_dir())
        .or_else(|| std::env::current_dir().ok())
        .unwrap_or_default()
}

/// The user's Documents folder if the system has one, else the working directory.
pub(in crate::app) fn document_folder() -> PathBuf {
    directories::UserDirs::new()
        .and_then(|folders| folders.document_dir().map(PathBuf::from))
        .filter(|folder| folder.is_dir())
        .or_else(|| std::env::current_dir().ok())
        .unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_new_image_replaces_no_file() {
        let folder = tempfile::tempdir().unwrap();
        let image = image::RgbaImage::from_pixel(3, 2, image::Rgba([1, 2, 3, 255]));
        let first = save_new_png(&image, folder.path(), "frame 7").unwrap();
        let second = save_new_png(&image, folder.path(), "frame 7").unwrap();
        assert_eq!(first, folder.path().join("frame 7.png"));
        assert_eq!(second, folder.path().join("frame 7-2.png"));
        assert_eq!(image::open(&second).unwrap().to_rgba8(), image);
    }

    #[test]
    fn images_are_written_in_the_format_of_their_name() {
        let folder = tempfile::tempdir().unwrap();
        let image = image::RgbaImage::from_pixel(3, 2, image::Rgba([1, 2, 3, 255]));
        for (name, first) in [
            ("a.jpg", &b"\xff\xd8"[..]),
            ("a.webp", b"RIFF"),
            ("a.tif", b"II*\0"),
            ("a.png", b"\x89PNG"),
        ] {
            let path = folder.path().join(name);
            save_image(&image, &path).unwrap();
            assert!(fs::read(&path).unwrap().starts_with(first), "{name}");
        }
        let refused = save_image(&image, &folder.path().join("a.exr")).unwrap_err();
        assert!(refused.contains(".webp"), "{refused}");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 4);
    }

    #[test]
    fn a_missing_folder_is_reported() {
        let folder = tempfile::tempdir().unwrap();
        let image = image::RgbaImage::new(1, 1);
        let path = folder.path().join("missing/picture.png");
        let error = save_image(&image, &path).unwrap_err();
        assert!(error.contains("picture.png"), "{error}");
        assert!(save_new_png(&image, &folder.path().join("missing"), "a").is_err());
    }
}
