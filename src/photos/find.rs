//! What a folder holds: the model of a reconstruction, by the names that programs give to their files.
//!
//! Every folder that somebody opens is asked, so the usual names are looked up one by one, and the folder is listed
//! once for names that vary. Formats with points come first: many folders hold a copy of the same cameras without.

use super::calibration::Calibration;
use super::error::PhotosError;
use super::view_set::ViewSet;
use super::{bundler, colmap, llff, meshroom, middlebury, middlebury_stereo, mvsnet, nvm, transforms};
use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};

/// Folders of a scene in which COLMAP's models are, or folders of them by their numbers.
const COLMAP_FOLDERS: &[&str] = &[
    "",
    "sparse",
    "colmap/sparse",
    "colmap_sparse",
    "colmap_text",
    "dense/0/sparse",
    "dense/sparse",
    "undistorted/sparse",
    "dslr_calibration_undistorted",
    "rig_calibration_undistorted",
    "dslr/colmap",
    // Lenses that are not shown, mostly: who opens the scene is told so.
    "distorted/sparse",
    "dslr_calibration_jpg",
    "rig_calibration",
];

/// Models of one scene whose numbers are tried: COLMAP makes one of each group of photographs that hangs together.
const MOST_MODELS: u32 = 50;

/// Bundles, the usual one first.
const BUNDLES: &[&str] = &[
    "bundle.out",
    "bundle/bundle.out",
    "bundle.rd.out",
    "bundler/bundle.out",
    "pmvs/bundle.rd.out",
];

/// Names of scenes of Meshroom: those with points first.
const SCENES: &[&str] = &["sfm.json", "sfm.sfm", "cameras.sfm"];

/// Folders of a project of Meshroom that hold scenes, each run in a folder of its own.
const MESHROOM_NODES: &[&str] = &[
    "MeshroomCache/ConvertSfMFormat",
    "MeshroomCache/StructureFromMotion",
    "ConvertSfMFormat",
    "StructureFromMotion",
];

/// Photographs to learn from first: others of the same scene are in files beside.
const TRANSFORMS: &[&str] = &[
    "transforms.json",
    "transforms_train.json",
    "transforms_test.json",
    "transforms_val.json",
];

/// Entries of a folder that are listed: a folder of more is one of frames.
const MOST_ENTRIES: usize = 10_000;

/// Bytes of a JSON file that tell what it is.
const HEAD: u64 = 1 << 16;

/// The format of a reconstruction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Format {
    /// COLMAP, text or binary.
    Colmap,
    /// Bundler v0.3.
    Bundler,
    /// VisualSFM.
    Nvm,
    /// Meshroom (AliceVision).
    Meshroom,
    /// Par files of Middlebury.
    Middlebury,
    /// instant-ngp, nerfstudio and NeRF.
    Transforms,
    /// Poses and bounds of LLFF.
    Llff,
    /// A camera a file, of `MVSNet`.
    Mvsnet,
    /// A rectified pair of Middlebury.
    MiddleburyStereo,
}

/// A reconstruction that was found.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FoundSet {
    /// Its format.
    pub format: Format,
    /// Its file; of COLMAP and `MVSNet` the folder of its files.
    pub path: PathBuf,
}

impl Format {
    /// Its name for people.
    pub fn name(self) -> &'static str {
        match self {
            Self::Colmap => "COLMAP",
            Self::Bundler => "Bundler",
            Self::Nvm => "NVM (VisualSFM)",
            Self::Meshroom => "Meshroom",
            Self::Middlebury => "Middlebury par",
            Self::Transforms => "transforms.json",
            Self::Llff => "LLFF (poses_bounds.npy)",
            Self::Mvsnet => "MVSNet (cams)",
            Self::MiddleburyStereo => "Middlebury stereo (calib.txt)",
        }
    }
}

impl FoundSet {
    /// Its photographs.
    ///
    /// # Errors
    /// Where the files break the rules of their format, and where none of the photographs can be shown. What is wrong
    /// with some of them alone is a note of the set.
    pub fn read(&self) -> Result<ViewSet, PhotosError> {
        self.calibration()?.photographs()
    }

    /// What it lists, before any photograph is looked for.
    ///
    /// # Errors
    /// Where the files break the rules of their format.
    pub fn calibration(&self) -> Result<Calibration, PhotosError> {
        let drafts = match self.format {
            Format::Colmap => colmap::read(&self.path),
            Format::Bundler => bundler::read(&self.path),
            Format::Nvm => nvm::read(&self.path),
            Format::Meshroom => meshroom::read(&self.path),
            Format::Middlebury => middlebury::read(&self.path),
            Format::Transforms => transforms::read(&self.path),
            Format::Llff => llff::read(&self.path),
            Format::Mvsnet => mvsnet::read(&self.path),
            Format::MiddleburyStereo => middlebury_stereo::read(&self.path),
        };
        Ok(Calibration::new(drafts?))
    }
}

/// The reconstruction in a folder, or the one that a file is of; `None` where there is none.
///
/// # Errors
/// Where a file that has the name of one cannot be read.
pub fn find(path: &Path) -> Result<Option<FoundSet>, PhotosError> {
    if path.is_dir() {
        Ok(in_folder(path))
    } else if path.is_file() {
        of_file(path)
    } else {
        Ok(None)
    }
}

fn in_folder(folder: &Path) -> Option<FoundSet> {
    let first = |names: &[&str]| names.iter().map(|name| folder.join(name)).find(|path| path.is_file());
    let found = |format: Format| move |path: PathBuf| FoundSet { format, path };
    let model = COLMAP_FOLDERS.iter().find_map(|name| model_in(&folder.join(name)));
    let known = model.map(found(Format::Colmap)).or_else(|| {
        first(BUNDLES)
            .filter(|path| begins_with(path, bundler::MAGIC))
            .map(found(Format::Bundler))
    });
    if known.is_some() {
        return known;
    }
    let names = names_in(folder);
    let by_ending = |ending: &str| {
        let name = names.iter().find(|name| name.to_lowercase().ends_with(ending))?;
        Some(folder.join(name))
    };
    by_ending(".nvm")
        .filter(|path| begins_with(path, nvm::MAGIC))
        .map(found(Format::Nvm))
        .or_else(|| first(SCENES).or_else(|| by_ending(".sfm")).map(found(Format::Meshroom)))
        .or_else(|| in_meshroom_cache(folder).map(found(Format::Meshroom)))
        .or_else(|| first(TRANSFORMS).map(found(Format::Transforms)))
        .or_else(|| first(&[llff::FILE]).map(found(Format::Llff)))
        .or_else(|| largest_par_file(folder, &names).map(found(Format::Middlebury)))
        .or_else(|| mvsnet::cameras_in(folder).map(found(Format::Mvsnet)))
        .or_else(|| {
            first(&[middlebury_stereo::FILE])
                .filter(|path| begins_with(path, middlebury_stereo::MAGIC))
                .map(found(Format::MiddleburyStereo))
        })
}

/// The folder itself, or the largest of the models that it has by their numbers.
fn model_in(folder: &Path) -> Option<PathBuf> {
    if colmap::is_in(folder) {
        return Some(folder.to_owned());
    }
    let numbered = (0..MOST_MODELS).map(|number| folder.join(number.to_string()));
    let size_of = |model: &PathBuf| {
        let size = |name: &str| fs::metadata(model.join(name)).map_or(0, |file| file.len());
        size("images.bin").max(size("images.txt"))
    };
    // From the last on, as the last of equals would be taken. A number may be missing; folders without 0 have none.
    let first = folder.join("0").is_dir();
    let models: Vec<PathBuf> = numbered
        .take_while(|_| first)
        .filter(|model| colmap::is_in(model))
        .collect();
    models.into_iter().rev().max_by_key(size_of)
}

/// Of several par files the longest: `temple_par.txt` has all photographs, `templeR_par.txt` those of a ring.
fn largest_par_file(folder: &Path, names: &[String]) -> Option<PathBuf> {
    let is_one = |name: &&String| name.to_lowercase().ends_with(middlebury::SUFFIX);
    let size = |path: &PathBuf| fs::metadata(path).map_or(0, |file| file.len());
    let files = names.iter().filter(is_one).map(|name| folder.join(name));
    files.max_by_key(size)
}

/// The scene that was written last by a project of Meshroom.
fn in_meshroom_cache(folder: &Path) -> Option<PathBuf> {
    let scenes = MESHROOM_NODES.iter().flat_map(|node| {
        let node = folder.join(node);
        let runs = names_in(&node);
        runs.into_iter().flat_map(move |run| {
            let run = node.join(run);
            SCENES.iter().map(move |scene| run.join(scene))
        })
    });
    let written = |path: PathBuf| Some((fs::metadata(&path).ok()?.modified().ok()?, path));
    scenes.filter_map(written).max().map(|(_, path)| path)
}

fn of_file(path: &Path) -> Result<Option<FoundSet>, PhotosError> {
    let name = path.file_name().unwrap_or_default().to_string_lossy().to_lowercase();
    let of = |format: Format| {
        Ok(Some(FoundSet {
            format,
            path: path.into(),
        }))
    };
    let (stem, extension) = name.rsplit_once('.').unwrap_or((&name, ""));
    match extension {
        "bin" | "txt" if ["cameras", "images", "points3d", "rigs", "frames"].contains(&stem) => {
            let folder = path.parent().unwrap_or(Path::new(""));
            Ok(colmap::is_in(folder).then(|| FoundSet {
                format: Format::Colmap,
                path: folder.into(),
            }))
        }
        "txt" if name.ends_with(middlebury::SUFFIX) => of(Format::Middlebury),
        "txt" if name == middlebury_stereo::FILE && begins_with(path, middlebury_stereo::MAGIC) => {
            of(Format::MiddleburyStereo)
        }
        "txt" if name.ends_with(mvsnet::SUFFIX) => Ok(path.parent().map(|folder| FoundSet {
            format: Format::Mvsnet,
            path: folder.into(),
        })),
        "out" if begins_with(path, bundler::MAGIC) => of(Format::Bundler),
        "nvm" => of(Format::Nvm),
        "npy" if name == llff::FILE => of(Format::Llff),
        "sfm" => of(Format::Meshroom),
        "json" => {
            let head = head_of(path, HEAD).map_err(|source| PhotosError::Io {
                path: path.into(),
                source,
            })?;
            let head = String::from_utf8_lossy(&head);
            if transforms::is_transforms(&head) {
                of(Format::Transforms)
            } else if meshroom::is_scene(&head) {
                of(Format::Meshroom)
            } else {
                Ok(None)
            }
        }
        _ => Ok(None),
    }
}

/// In order, so that the same one of several is taken each time.
fn names_in(folder: &Path) -> Vec<String> {
    let Ok(entries) = fs::read_dir(folder) else {
        return Vec::new();
    };
    let names = entries.take(MOST_ENTRIES).flatten();
    let mut names: Vec<String> = names.filter_map(|entry| entry.file_name().into_string().ok()).collect();
    names.sort_unstable();
    names
}

fn begins_with(path: &Path, magic: &[u8]) -> bool {
    head_of(path, magic.len() as u64).is_ok_and(|head| head == magic)
}

fn head_of(path: &Path, size: u64) -> std::io::Result<Vec<u8>> {
    let mut head = Vec::new();
    crate::regular_file::open(path)?.take(size).read_to_end(&mut head)?;
    Ok(head)
}
