//! Unsupported image folders: a folder that holds images but no set that can be read is reported by name, with advice.
//!
//! To a point cloud reader, a folder of images without points looks like an empty one, or, if it also contains a list
//! file, like a damaged cloud. Neither error states the missing data.

use super::meshroom;
use crate::photos::error::PhotosError;
use crate::photos::found::files::is_picture;
use std::collections::HashSet;
use std::fs;
use std::path::Path;

/// Entries of a folder that are looked at.
const MAX_ENTRIES: usize = 10_000;

/// Sidecar files of image sets that have the extension of a point cloud.
const SIDECAR: &[&str] = &[
    "bbox.txt",
    "calib.txt",
    "cameras.npz",
    "cameras_sphere.npz",
    "database.db",
    "intrinsics.txt",
    "list.txt",
    "near_and_far.txt",
    "pair.txt",
    "test_traj.txt",
    "testsplit.txt",
    "trainsplit.txt",
];

/// File name prefixes of remarks such as readme and licence files.
const REMARKS: &[&str] = &["readme", "license", "licence", "copyright"];

/// Folders that hold input images before calibration.
const PICTURES: &[&str] = &["", "images", "input", "image", "rgb", "photos", "imgs"];

/// The names in a folder.
struct Names<'a> {
    folder: &'a Path,
    /// In lower case.
    files: HashSet<String>,
    folders: HashSet<String>,
}

/// Something that is not read.
struct Unread {
    is_there: fn(&Names<'_>) -> bool,
    found: &'static str,
    advice: &'static str,
}

/// The first that is there is named.
const TABLE: &[Unread] = &[
    Unread {
        is_there: |names| names.has_file_of("abc") || names.has_below("structurefrommotion", "sfm.abc"),
        found: "a scene of Meshroom in Alembic (sfm.abc), which is not read",
        advice: "add a node ConvertSfMFormat with the file type sfm or json behind StructureFromMotion and compute it",
    },
    Unread {
        is_there: |names| names.folders.contains(&meshroom::CACHE.to_lowercase()),
        found: "a project of Meshroom without a result of StructureFromMotion (cameras.sfm)",
        advice: "compute the node StructureFromMotion, or open the folder in which its cache is",
    },
    Unread {
        is_there: |names| names.folders.contains("keyframes"),
        found: "raw data of Polycam (keyframes), which is not read",
        advice: "convert it by `ns-process-data polycam` of nerfstudio, and open the folder of its transforms.json",
    },
    Unread {
        is_there: |names| names.files.contains("sfm_data.json") || names.files.contains("sfm_data.bin"),
        found: "a scene of OpenMVG, which is not read",
        advice: "write it by openMVG_main_openMVG2Colmap, and open that folder",
    },
    Unread {
        is_there: |names| names.files.contains("cameras_sphere.npz") || names.files.contains("cameras.npz"),
        found: "cameras of IDR or NeuS in an NPZ, which are not read",
        advice: "convert them to a transforms.json or to the files of COLMAP",
    },
    Unread {
        is_there: |names| names.folders.contains("pose") && names.files.contains("intrinsics.txt"),
        found: "cameras of NSVF (a file of poses each, intrinsics.txt), which are not read",
        advice: "convert them to a transforms.json or to the files of COLMAP",
    },
    Unread {
        is_there: |names| names.files.contains("im2.png") && names.files.contains("im6.png"),
        found: "a pair of Middlebury without a calibration (2001 to 2006)",
        advice: "pairs from 2014 on have a calib.txt, which is read",
    },
    Unread {
        is_there: |names| names.files.contains("view1.png") && names.files.contains("view5.png"),
        found: "a pair of Middlebury without a calibration (2001 to 2006)",
        advice: "pairs from 2014 on have a calib.txt, which is read",
    },
    Unread {
        is_there: |names| names.files.contains("trainsplit.txt") || names.files.contains("testsplit.txt"),
        found: "sequences of 7-Scenes",
        advice: "open one of them (seq-01)",
    },
    Unread {
        is_there: |names| names.has_file_of("log") && names.has_pictures(),
        found: "images with a trajectory (.log), which has no camera intrinsics",
        advice: "calibrate them, by COLMAP for instance, and open the folder with its sparse/0",
    },
    Unread {
        is_there: |names| names.files.contains("database.db") && names.has_pictures(),
        found: "images and a COLMAP database, but no model",
        advice: "reconstruct them (`colmap mapper`, or automatic_reconstructor), so that there is a sparse/0",
    },
    Unread {
        is_there: |names| names.has_pictures(),
        found: "images without camera poses",
        advice: "calibrate them, by COLMAP, Meshroom or nerfstudio for instance, and open the folder of the result, \
                 which is recognised by its files (sparse/0, cameras.sfm, transforms.json)",
    },
];

/// Returns true if a file is a sidecar of an image set, even if its extension suggests otherwise.
pub fn is_outside_photos(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy().to_lowercase();
    SIDECAR.contains(&name.as_str()) || REMARKS.iter().any(|remark| name.starts_with(remark))
}

/// Returns the error for a folder that holds no image set ([`find`](fn@crate::photos::find)) and nothing else that can
/// be shown.
pub fn unread(folder: &Path) -> Option<PhotosError> {
    let names = Names::of(folder)?;
    let row = TABLE.iter().find(|row| (row.is_there)(&names))?;
    Some(PhotosError::NoSet {
        path: folder.into(),
        found: row.found.to_owned(),
        advice: row.advice.to_owned(),
    })
}

impl<'a> Names<'a> {
    fn of(folder: &'a Path) -> Option<Self> {
        let mut names = Self {
            folder,
            files: HashSet::new(),
            folders: HashSet::new(),
        };
        for entry in fs::read_dir(folder).ok()?.take(MAX_ENTRIES).flatten() {
            let name = entry.file_name().to_string_lossy().to_lowercase();
            if entry.path().is_dir() {
                names.folders.insert(name);
            } else {
                names.files.insert(name);
            }
        }
        Some(names)
    }

    fn has_file_of(&self, extension: &str) -> bool {
        let mut extensions = self.files.iter().filter_map(|name| name.rsplit_once('.'));
        extensions.any(|(_, found)| found == extension)
    }

    /// Returns true if a run of the Meshroom node has produced the file.
    fn has_below(&self, node: &str, file: &str) -> bool {
        let bases = [self.folder.join(meshroom::CACHE), self.folder.to_owned()];
        let nodes = bases
            .iter()
            .filter_map(|base| fs::read_dir(base).ok())
            .flatten()
            .flatten();
        let mut nodes = nodes.filter(|entry| entry.file_name().to_string_lossy().to_lowercase() == node);
        nodes.any(|node| {
            let runs = fs::read_dir(node.path())
                .into_iter()
                .flatten()
                .take(MAX_ENTRIES)
                .flatten();
            runs.into_iter().any(|run| run.path().join(file).is_file())
        })
    }

    fn has_pictures(&self) -> bool {
        PICTURES.iter().any(|below| {
            let entries = fs::read_dir(self.folder.join(below)).into_iter().flatten();
            entries
                .take(MAX_ENTRIES)
                .flatten()
                .any(|entry| is_picture(&entry.path()))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found_in(files: &[&str]) -> Option<String> {
        let folder = tempfile::tempdir().unwrap();
        for file in files {
            let path = folder.path().join(file);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, b"").unwrap();
        }
        unread(folder.path()).map(|error| error.to_string())
    }

    #[test]
    fn files_of_other_programs_are_named() {
        for (files, words) in [
            (
                &["images/a.jpg", "MeshroomCache/StructureFromMotion/0a/sfm.abc"][..],
                "ConvertSfMFormat",
            ),
            (&["sfm.abc"], "ConvertSfMFormat"),
            (
                &["images/a.jpg", "MeshroomCache/CameraInit/0a/cameraInit.sfm"],
                "compute the node StructureFromMotion",
            ),
            (&["keyframes/images/1.jpg", "mesh_info.json"], "ns-process-data polycam"),
            (&["sfm_data.json", "images/a.jpg"], "openMVG2Colmap"),
            (&["cameras_sphere.npz", "image/000.png"], "IDR or NeuS"),
            (&["intrinsics.txt", "pose/0.txt", "rgb/0.png"], "NSVF"),
            (&["im2.png", "im6.png", "disp2.png"], "pairs from 2014 on"),
            (&["view1.png", "view5.png", "disp1.png"], "pairs from 2014 on"),
            (
                &["seq-01/frame-000000.color.png", "TrainSplit.txt"],
                "open one of them (seq-01)",
            ),
            (&["0001.jpg", "Barn_COLMAP_SfM.log"], "no camera intrinsics"),
            (&["images/a.JPG", "database.db"], "colmap mapper"),
            (&["a.png", "b.png"], "without camera poses"),
        ] {
            let found = found_in(files).unwrap_or_default();
            assert!(found.contains(words), "{files:?}: {found}");
        }
    }

    #[test]
    fn unrelated_folders_are_not_reported() {
        assert_eq!(found_in(&[]), None);
        assert_eq!(found_in(&["notes.txt", "scans/a.ply"]), None);
        assert!(unread(Path::new("/no/such/folder")).is_none());
    }

    #[test]
    fn text_files_next_to_images_are_not_clouds() {
        for name in ["a/TrainSplit.txt", "calib.txt", "README_dataset.txt", "LICENSE.txt"] {
            assert!(is_outside_photos(Path::new(name)), "{name}");
        }
        for name in ["scan.txt", "calib.ply", "frame_0001.txt"] {
            assert!(!is_outside_photos(Path::new(name)), "{name}");
        }
    }
}
