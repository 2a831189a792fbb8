//! Image file lookup, from the names that a reconstruction has for its input images.
//!
//! *How it works.* Names are often paths of another machine: absolute, with the separators of another system, with
//! another extension after undistortion or without any, or in another case. A name is tried unchanged below each folder
//! in which images usually are, with its own and then with other extensions; then its remainder without the folders in
//! front (`cam0/1.jpg`); then its last part alone is looked up in lists of these folders, without regard to case, and
//! then without its extension. The remainder has to be unique to one name: `left/1.jpg` and `right/1.jpg` are never the
//! same image.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// Folders below that of a reconstruction in which input images usually are. The first that has one wins.
const FOLDERS: &[&str] = &[
    "images",
    "",
    "image",
    "undistorted/images",
    "undistorted",
    "dense/images",
    "dense/0/images",
    "photos",
    "rgb",
    "imgs",
    "input",
    "visualize",
    "images_2",
    "images_4",
    "images_8",
    "resized_images",
    "blended_images",
];

/// Folders of masks.
const MASK_FOLDERS: &[&str] = &["masks", "mask", "images/masks", "silhouettes"];

/// File extensions that the image decoder reads.
const EXTENSIONS: &[&str] = &["png", "jpg", "jpeg", "webp", "ppm", "pgm", "pnm", "gif", "hdr"];

/// Image formats that programs calibrate but the decoder does not read: converted copies stand in for them.
const NOT_READ: &[&str] = &["avif", "bmp", "dng", "exr", "heic", "heif", "jxl", "tga", "tif", "tiff"];

/// Maximum number of entries of a folder that are visited: a folder of more is not one of images alone.
const MAX_ENTRIES: usize = 200_000;

/// Lists of the folders in which input images and masks may be.
#[derive(Debug)]
pub(in crate::photos) struct Files {
    photos: Vec<Listing>,
    masks: Vec<Listing>,
    /// Number of names with the same last component, and with the same last two.
    endings: HashMap<String, usize>,
}

/// The images in a folder.
#[derive(Debug)]
struct Listing {
    folder: PathBuf,
    /// Paths by name in lower case.
    by_name: HashMap<String, PathBuf>,
    /// Paths by name in lower case, without the extension.
    by_stem: HashMap<String, PathBuf>,
}

impl Files {
    /// Collects the image files around `folders`, the first with a match winning, for input images of these `names`.
    pub(in crate::photos) fn around<'a>(folders: &[PathBuf], names: impl IntoIterator<Item = &'a str>) -> Self {
        let mut endings = HashMap::new();
        for name in names {
            let name = relative(name).to_lowercase();
            for ending in [Some(last_part(&name)), last_two_parts(&name)].into_iter().flatten() {
                *endings.entry(ending.to_owned()).or_insert(0) += 1;
            }
        }
        let listings = |below: &[&str]| {
            let all = folders
                .iter()
                .flat_map(|folder| below.iter().map(move |&below| joined(folder, below)));
            let mut listings: Vec<Listing> = Vec::new();
            for folder in all {
                if listings.iter().all(|listing| listing.folder != folder) {
                    listings.extend(Listing::of(folder));
                }
            }
            listings
        };
        Self {
            photos: listings(FOLDERS),
            masks: listings(MASK_FOLDERS),
            endings,
        }
    }

    /// Returns the file of the input image `name`.
    pub(in crate::photos) fn photo(&self, name: &str) -> Option<PathBuf> {
        let name = relative(name);
        if name.is_empty() {
            return None;
        }
        let mut as_written = self.photos.iter().map(|listing| listing.folder.join(&name));
        let as_written = as_written.find(|path| path.is_file());
        // If it cannot be decoded, a converted copy may exist.
        if as_written.as_deref().is_some_and(is_picture) {
            return as_written;
        }
        self.with_extension(&name)
            .or_else(|| self.without_folders_in_front(&name))
            .or_else(|| self.by_last_part(&self.photos, &name))
            .or(as_written)
    }

    /// The file of the name with another extension than it has, or with one.
    fn with_extension(&self, name: &str) -> Option<PathBuf> {
        let stem = match name.rsplit_once('.') {
            Some((stem, extension)) if !stem.is_empty() && is_extension(extension) => stem,
            _ => name,
        };
        let both = EXTENSIONS
            .iter()
            .flat_map(|extension| [(*extension).to_owned(), extension.to_uppercase()]);
        let names: Vec<String> = both.map(|extension| format!("{stem}.{extension}")).collect();
        let mut all = self
            .photos
            .iter()
            .flat_map(|listing| names.iter().map(|name| listing.folder.join(name)));
        all.find(|path| path.is_file())
    }

    /// The file of the remainder of a name without its first folders, if no other name ends in it.
    fn without_folders_in_front(&self, name: &str) -> Option<PathBuf> {
        let last_two = last_two_parts(name)?;
        if self
            .endings
            .get(&last_two.to_lowercase())
            .is_some_and(|&count| count > 1)
        {
            return None;
        }
        let mut rest = name;
        while let Some((_, shorter)) = rest.split_once('/')
            && shorter.contains('/')
        {
            rest = shorter;
            let mut all = self.photos.iter().map(|listing| listing.folder.join(rest));
            let found = all.find(|path| path.is_file()).or_else(|| self.with_extension(rest));
            if found.is_some() {
                return found;
            }
        }
        None
    }

    /// Returns the mask of the input image `name`: as COLMAP names them, `photo.jpg.png`, or by the same stem.
    pub(in crate::photos) fn mask(&self, name: &str) -> Option<PathBuf> {
        if self.masks.is_empty() {
            return None;
        }
        let relative = name.replace('\\', "/");
        let named = format!("{relative}.png");
        let as_written = self.masks.iter().map(|listing| listing.folder.join(&named));
        as_written
            .into_iter()
            .find(|path| path.is_file())
            .or_else(|| self.by_last_part(&self.masks, &relative))
    }

    /// The folders of masks around `folders` that exist.
    pub(in crate::photos) fn mask_folders(folders: &[PathBuf]) -> Vec<PathBuf> {
        let all = folders
            .iter()
            .flat_map(|folder| MASK_FOLDERS.iter().map(move |below| folder.join(below)));
        all.filter(|folder| folder.is_dir()).collect()
    }

    /// The mask of `relative` that lies in the same place below one of `mask_folders`: `cam0/7.jpg.png`, `cam0/7.png`.
    pub(in crate::photos) fn mask_below(mask_folders: &[PathBuf], relative: &Path) -> Option<PathBuf> {
        let mut named = relative.as_os_str().to_owned();
        named.push(".png");
        let names = [PathBuf::from(named), relative.with_extension("png")];
        let all = mask_folders
            .iter()
            .flat_map(|folder| names.iter().map(move |name| folder.join(name)));
        all.into_iter().find(|path| path.is_file())
    }

    /// Returns the sidecar mask of the image at `path`, named after it.
    pub(in crate::photos) fn mask_sidecar(path: &Path) -> Option<PathBuf> {
        let name = path.file_name()?.to_str()?;
        let stem = path.file_stem()?.to_str()?;
        let names = [
            // The namings of COLMAP, RealityCapture and OpenDroneMap.
            format!("{name}.png"),
            format!("{name}.mask.png"),
            format!("{stem}_mask.png"),
        ];
        let sidecar = names.map(|name| path.with_file_name(name));
        sidecar.into_iter().find(|path| path.is_file())
    }

    /// The folders that were looked through.
    pub(in crate::photos) fn folders(&self) -> impl Iterator<Item = &Path> {
        self.photos.iter().map(|listing| listing.folder.as_path())
    }

    fn by_last_part(&self, listings: &[Listing], name: &str) -> Option<PathBuf> {
        // Only a name that is listed once: `left/1.jpg` must never be mistaken for `right/1.jpg`.
        let last = last_part(name).to_lowercase();
        if self.endings.get(&last).is_some_and(|&count| count > 1) {
            return None;
        }
        let exact = listings.iter().find_map(|listing| listing.by_name.get(&last));
        let stem = || {
            let stem = stem_of_picture(&last).unwrap_or(&last);
            listings.iter().find_map(|listing| listing.by_stem.get(stem))
        };
        exact.or_else(stem).cloned()
    }
}

impl Listing {
    /// `None` where the folder cannot be listed, or does not exist.
    fn of(folder: PathBuf) -> Option<Self> {
        let mut paths: Vec<PathBuf> = std::fs::read_dir(&folder)
            .ok()?
            .take(MAX_ENTRIES)
            .filter_map(|entry| Some(entry.ok()?.path()))
            .collect();
        // Of names that differ only by case or extension, the choice is deterministic.
        paths.sort_unstable();
        let (mut by_name, mut by_stem) = (HashMap::new(), HashMap::new());
        for path in paths {
            let Some(name) = path.file_name().map(|name| name.to_string_lossy().to_lowercase()) else {
                continue;
            };
            let Some(stem) = stem_of_picture(&name) else { continue };
            by_stem.entry(stem.to_owned()).or_insert_with(|| path.clone());
            by_name.entry(name).or_insert(path);
        }
        Some(Self {
            folder,
            by_name,
            by_stem,
        })
    }
}

/// Returns true if a file is an image according to its name.
pub fn is_picture(path: &Path) -> bool {
    let extension = path
        .extension()
        .map(|extension| extension.to_string_lossy().to_lowercase());
    extension.is_some_and(|extension| EXTENSIONS.contains(&extension.as_str()))
}

/// Returns true if the part of a name behind the last dot is an image file extension, be it one that is read or not.
fn is_extension(ending: &str) -> bool {
    let ending = ending.to_lowercase();
    EXTENSIONS.iter().chain(NOT_READ).any(|&extension| extension == ending)
}

/// A folder below another, or that one itself, without a separator at its end.
fn joined(folder: &Path, below: &str) -> PathBuf {
    if below.is_empty() {
        folder.to_owned()
    } else {
        folder.join(below)
    }
}

/// A name with the separators of this system, relative to a folder.
fn relative(name: &str) -> String {
    let name = name.replace('\\', "/");
    name.trim_start_matches("./").to_owned()
}

/// The last folder and the name in it, of a path with this system's separators.
fn last_two_parts(name: &str) -> Option<&str> {
    let (folders, _) = name.rsplit_once('/')?;
    let start = folders.rfind('/').map_or(0, |at| at + 1);
    Some(&name[start..])
}

/// The part of a path behind its last separator, of whichever system.
pub(super) fn last_part(name: &str) -> &str {
    name.rsplit(['/', '\\']).next().unwrap_or(name)
}

/// The name without its extension, if that is an image extension. `name` is in lower case.
fn stem_of_picture(name: &str) -> Option<&str> {
    let (stem, extension) = name.rsplit_once('.')?;
    (!stem.is_empty() && EXTENSIONS.contains(&extension)).then_some(stem)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    fn folder(files: &[&str]) -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        for file in files {
            let path = folder.path().join(file);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, b"").unwrap();
        }
        folder
    }

    #[test]
    fn images_are_found_by_paths_of_other_machines() {
        let folder = folder(&[
            "images/IMG_1.JPG",
            "images/b c.png",
            "beside.jpg",
            "undistorted/d.png",
            "notes.txt",
        ]);
        let names = [
            "img_1.jpg",
            "C:\\scan\\b c.png",
            "/home/them/beside.jpg",
            "./beside.jpg",
            "images/IMG_1.JPG",
            "d.jpg",
            "notes.txt",
            "b c",
            "",
        ];
        let files = Files::around(&[folder.path().into()], []);
        let found = names.map(|name| {
            let path = files.photo(name)?;
            Some(path.strip_prefix(folder.path()).unwrap().to_str().unwrap().to_owned())
        });
        let expected = [
            Some("images/IMG_1.JPG"),
            Some("images/b c.png"),
            Some("beside.jpg"),
            Some("beside.jpg"),
            Some("images/IMG_1.JPG"),
            Some("undistorted/d.png"),
            Some("notes.txt"),
            Some("images/b c.png"),
            None,
        ];
        assert_eq!(found.each_ref().map(Option::as_deref), expected);
    }

    #[test]
    fn images_of_two_cameras_are_not_confused() {
        let folder = folder(&["images/left/1.jpg", "images/1.jpg"]);
        let names = ["left/1.jpg", "right/1.jpg"];
        let files = Files::around(&[folder.path().into()], names);
        assert!(files.photo(names[0]).unwrap().ends_with("left/1.jpg"));
        assert_eq!(files.photo(names[1]), None);
        let alone = Files::around(&[folder.path().into()], [names[1]]);
        assert!(alone.photo(names[1]).unwrap().ends_with("images/1.jpg"));
    }

    #[test]
    fn names_without_extensions_are_found_in_their_folders() {
        let folder = folder(&[
            "train/r_0.png",
            "train/r_10.png",
            "test/r_0.png",
            "photos/b.heic",
            "photos/b.JPG",
            "masked.jpg.png",
        ]);
        let names = [
            "./train/r_0",
            "./train/r_10",
            "./test/r_0",
            "train/r_0.jpg",
            "train/r_1",
            "b.heic",
            "masked.jpg",
        ];
        let files = Files::around(&[folder.path().into()], names);
        let found = names.map(|name| {
            let path = files.photo(name)?;
            Some(path.strip_prefix(folder.path()).unwrap().to_str().unwrap().to_owned())
        });
        let expected = [
            Some("train/r_0.png"),
            Some("train/r_10.png"),
            Some("test/r_0.png"),
            Some("train/r_0.png"),
            None,
            Some("photos/b.JPG"),
            // This one is a mask.
            None,
        ];
        assert_eq!(found.each_ref().map(Option::as_deref), expected);
    }

    #[test]
    fn camera_folders_are_found_under_paths_of_another_machine() {
        let folder = folder(&["images_2/left/1.jpg", "images_2/right/1.png"]);
        let names = ["/home/them/scan/images/left/1.jpg", "C:\\scan\\images\\right\\1.jpg"];
        let files = Files::around(&[folder.path().into()], names);
        assert!(files.photo(names[0]).unwrap().ends_with("images_2/left/1.jpg"));
        assert!(files.photo(names[1]).unwrap().ends_with("images_2/right/1.png"));
        let names = ["a/left/1.jpg", "b/left/1.jpg"];
        let files = Files::around(&[folder.path().into()], names);
        assert_eq!(names.map(|name| files.photo(name)), [None, None]);
    }

    #[test]
    fn masks_are_named_after_their_images() {
        let folder = folder(&["masks/a.jpg.png", "masks/B.png", "images/a.jpg"]);
        let files = Files::around(&[folder.path().into()], []);
        assert!(files.mask("a.jpg").unwrap().ends_with("masks/a.jpg.png"));
        assert!(files.mask("b.jpg").unwrap().ends_with("masks/B.png"));
        assert_eq!(files.mask("c.jpg"), None);
    }

    #[test]
    fn masks_may_be_next_to_their_images() {
        let folder = folder(&[
            "a.jpg",
            "a.jpg.png",
            "b.jpg",
            "b_mask.png",
            "c.jpg",
            "c.jpg.mask.png",
            "d.jpg",
            "d.png",
        ]);
        let mask = |name: &str| {
            let path = Files::mask_sidecar(&folder.path().join(name))?;
            Some(path.file_name().unwrap().to_str().unwrap().to_owned())
        };
        assert_eq!(mask("a.jpg").as_deref(), Some("a.jpg.png"));
        assert_eq!(mask("b.jpg").as_deref(), Some("b_mask.png"));
        assert_eq!(mask("c.jpg").as_deref(), Some("c.jpg.mask.png"));
        // An image with the same stem is a different image.
        assert_eq!(mask("d.jpg"), None);
    }
}
