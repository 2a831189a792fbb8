//! Drafts of input images, from the listing of a file to images that can be shown: files are found, sizes checked,
//! poses validated.
//!
//! A problem with one image affects only that image: it is skipped, along with its tracks, and a note reports it. If
//! nothing of a set is left, that is an error with the reason.

use super::files::Files;
use super::picture_file::size_px;
use crate::natural::natural_order;
use crate::photos::depth_file::DepthFile;
use crate::photos::error::PhotosError;
use crate::photos::sets::lens::Lens;
use crate::photos::sets::photo::Photo;
use crate::photos::sets::points::{Observation, SparsePoints};
use crate::photos::sets::view_set::ViewSet;
use glam::{DAffine3, DMat3, DQuat, DVec3};
use rayon::prelude::*;
use std::path::{Path, PathBuf};

/// An input image as a file lists it.
#[derive(Debug, Clone)]
pub(in crate::photos) struct Draft {
    pub(in crate::photos) name: String,
    /// Or why it has none.
    pub(in crate::photos) lens: Result<Lens, String>,
    /// Turns directions of the world into those of the camera (x right, y down, z forward).
    pub(in crate::photos) turn: DMat3,
    /// Position of the world origin in the camera frame.
    pub(in crate::photos) shift: DVec3,
    pub(in crate::photos) mask: Option<PathBuf>,
    pub(in crate::photos) depth: Option<DepthFile>,
    /// Depths between which all that it shows lies, in the unit of the world.
    pub(in crate::photos) depth_range: Option<[f64; 2]>,
    /// A copy that was made for this list: it is taken before any file of the name, if it is there.
    pub(in crate::photos) copy: Option<PathBuf>,
    /// Capture time, in any unit, if the format has one.
    pub(in crate::photos) time: Option<f64>,
}

/// All that a file lists.
#[derive(Debug, Clone)]
pub(in crate::photos) struct Drafts {
    /// The file.
    pub(in crate::photos) path: PathBuf,
    /// Folders around which input images are looked for, the nearest first.
    pub(in crate::photos) folders: Vec<PathBuf>,
    pub(in crate::photos) photos: Vec<Draft>,
    /// Sparse points, whose observed pixels are counted as defined by the lens of their image.
    pub(in crate::photos) points: SparsePoints,
    pub(in crate::photos) points_file: Option<PathBuf>,
    pub(in crate::photos) notes: Vec<String>,
}

/// Tolerance of the products of the axes of a rotation from 0 and 1: files are written with as few as four digits.
const MAX_SKEW: f64 = 0.01;

/// Names that a note lists before it gives the number of others.
const MAX_NAMES: usize = 3;

/// Maximum number of reasons reported: damage can produce one for every input image, and a hundred suffice for the
/// reader.
const MAX_REASONS: usize = 100;

impl Draft {
    /// Creates the draft of an image at `center` in the world, whose axes (x right, y down, z forward) are the columns
    /// of `world_from_camera`.
    pub(in crate::photos) fn at(
        name: String,
        lens: Result<Lens, String>,
        world_from_camera: DMat3,
        center: DVec3,
    ) -> Self {
        let turn = world_from_camera.transpose();
        Self::new(name, lens, turn, -(turn * center))
    }

    /// Creates the draft of an image for which points of the camera are `turn` · x + `shift`.
    pub(in crate::photos) fn new(name: String, lens: Result<Lens, String>, turn: DMat3, shift: DVec3) -> Self {
        Self {
            name,
            lens,
            turn,
            shift,
            mask: None,
            depth: None,
            depth_range: None,
            copy: None,
            time: None,
        }
    }

    /// The lens and the pose, or why one of them is none.
    pub(in crate::photos) fn placed(&self) -> Result<(&Lens, DAffine3), String> {
        let lens = self.lens.as_ref().map_err(String::clone)?;
        Ok((lens, pose(self.turn, self.shift)?))
    }

    fn photo(&self, files: &Files) -> Result<Photo, Reason> {
        let (lens, camera_from_world) = self.placed().map_err(Reason::Wrong)?;
        let copy = self.copy.clone().filter(|path| path.is_file());
        let path = copy.or_else(|| files.photo(&self.name)).ok_or(Reason::Missing)?;
        // Half of the formats do not state the size of their images, and images are often distributed at a smaller size
        // than they were calibrated at.
        let image_px = size_px(&path).map_err(|error| Reason::Wrong(error.reason()))?;
        Ok(Photo {
            camera: lens.camera(image_px).map_err(Reason::Wrong)?,
            mask: self
                .mask
                .clone()
                .or_else(|| files.mask(&self.name))
                .or_else(|| Files::mask_sidecar(&path)),
            depth: self.depth.clone(),
            depth_range: self.depth_range,
            name: self.name.clone(),
            path,
            camera_from_world,
        })
    }
}

/// Reason why an input image is skipped.
enum Reason {
    Missing,
    Wrong(String),
}

impl Drafts {
    /// Creates an empty list of drafts for the file `path`. Input images are looked for around `folders`.
    pub(in crate::photos) fn new(path: &Path, folders: Vec<PathBuf>) -> Self {
        Self {
            path: path.into(),
            folders,
            photos: Vec::new(),
            points: SparsePoints::default(),
            points_file: None,
            notes: Vec::new(),
        }
    }

    /// Returns the input images that can be shown.
    pub(in crate::photos) fn into_view_set(self) -> Result<ViewSet, PhotosError> {
        let files = Files::around(&self.folders, self.photos.iter().map(|draft| draft.name.as_str()));
        let photos: Vec<Result<Photo, Reason>> = self.photos.par_iter().map(|draft| draft.photo(&files)).collect();
        let mut set = ViewSet {
            points_file: self.points_file,
            notes: self.notes,
            ..ViewSet::default()
        };
        let mut retained = vec![None; photos.len()];
        let (mut missing, mut wrong) = (Vec::new(), Vec::new());
        // Programs list images in the order of matching, or of a hash table: users count them in the order of their
        // names.
        let mut by_name: Vec<_> = self.photos.iter().zip(photos).enumerate().collect();
        by_name.sort_by(|(_, (one, _)), (_, (other, _))| natural_order(Path::new(&one.name), Path::new(&other.name)));
        for (listed, (draft, photo)) in by_name {
            match photo {
                Ok(photo) => {
                    retained[listed] = Some(set.photos.len() as u32);
                    set.photos.push(photo);
                }
                Err(Reason::Missing) => missing.push(draft.name.as_str()),
                Err(Reason::Wrong(reason)) => wrong.push((draft.name.as_str(), reason)),
            }
        }
        set.notes.extend(note_of_missing(&missing, &files));
        set.notes.extend(notes_of_wrong(&wrong));
        let skipped = self.points.skipped();
        if skipped > 0 {
            set.notes.push(format!(
                "{skipped} points have coordinates that are not finite: they are skipped"
            ));
        }
        if set.photos.is_empty() && (!self.points.is_empty() || set.points_file.is_some()) {
            set.notes.push(format!(
                "none of the {} images of {} can be shown: its points are shown without them",
                self.photos.len(),
                self.path.display()
            ));
            set.points = self.points.with_observations(|_| None);
            return Ok(set);
        }
        if set.photos.is_empty() {
            return Err(PhotosError::NoPhotos {
                path: self.path,
                count: self.photos.len(),
                reason: if wrong.is_empty() && !missing.is_empty() {
                    let folder = self.folders.last().map(|folder| folder.join("images"));
                    let folder = folder.unwrap_or_default();
                    format!("{}; put them into {}", reason_of_nothing(&set.notes), folder.display())
                } else {
                    reason_of_nothing(&set.notes)
                },
            });
        }
        set.points = self.points.with_observations(|seen| {
            let photo = (*retained.get(seen.photo as usize)?)?;
            let lens = self.photos[seen.photo as usize].lens.as_ref().ok()?;
            let image_px = set.photos[photo as usize].camera.size_px();
            let pixel = lens.pixel(seen.pixel.as_dvec2(), image_px).as_vec2();
            pixel.is_finite().then_some(Observation { photo, pixel })
        });
        Ok(set)
    }
}

pub(in crate::photos) fn reason_of_nothing(notes: &[String]) -> String {
    let nothing = "the list is empty, calibrate the images first";
    if notes.is_empty() {
        nothing.to_owned()
    } else {
        notes.join("; ")
    }
}

/// A rotation and a translation, or the reason why they are not. A matrix rounded in text is made a rotation again.
fn pose(turn: DMat3, shift: DVec3) -> Result<DAffine3, String> {
    if !turn.is_finite() || !shift.is_finite() {
        return Err("its pose has numbers that are not finite".into());
    }
    let products = turn.transpose() * turn;
    let difference = (products - DMat3::IDENTITY).to_cols_array();
    let skew = difference.into_iter().map(f64::abs).fold(0.0, f64::max);
    let determinant = turn.determinant();
    if skew > MAX_SKEW || determinant < 0.0 {
        return Err(format!(
            "its pose is not a rotation (determinant {determinant:.3}, expected 1): it is singular, mirrored or scaled"
        ));
    }
    let turn = DQuat::from_mat3(&turn).normalize();
    Ok(DAffine3::from_rotation_translation(turn, shift))
}

fn note_of_missing(names: &[&str], files: &Files) -> Option<String> {
    let folders: Vec<String> = files.folders().map(|folder| folder.display().to_string()).collect();
    (!names.is_empty()).then(|| {
        format!(
            "{} skipped, no such file was found in {}: {}",
            posed_images(names.len()),
            folders.join(", "),
            some_of(names)
        )
    })
}

/// A note for each reason, in the order in which they occurred first.
pub(in crate::photos) fn notes_of_wrong(wrong: &[(&str, String)]) -> Vec<String> {
    let mut reasons: Vec<(&str, Vec<&str>)> = Vec::new();
    for (name, reason) in wrong {
        if let Some((_, names)) = reasons.iter_mut().find(|(known, _)| known == reason) {
            names.push(name);
        } else if reasons.len() < MAX_REASONS {
            reasons.push((reason, vec![name]));
        }
    }
    let note = |(reason, names): (&str, Vec<&str>)| {
        format!("{} skipped: {}: {reason}", posed_images(names.len()), some_of(&names))
    };
    reasons.into_iter().map(note).collect()
}

fn posed_images(count: usize) -> String {
    if count == 1 {
        "1 image was".into()
    } else {
        format!("{count} images were")
    }
}

fn some_of(names: &[&str]) -> String {
    let shown = names.iter().take(MAX_NAMES).copied().collect::<Vec<_>>().join(", ");
    match names.len().saturating_sub(MAX_NAMES) {
        0 => shown,
        more => format!("{shown} and {more} more"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::photos::sets::lens::Origin;
    use glam::DVec2;

    fn draft(name: &str) -> Draft {
        let lens = Lens::pinhole(None, DVec2::splat(100.0), Origin::Center, DVec2::ZERO);
        Draft::new(name.into(), Ok(lens), DMat3::IDENTITY, DVec3::ZERO)
    }

    #[test]
    fn an_error_in_one_image_only_affects_that_image() {
        let folder = tempfile::tempdir().unwrap();
        image::RgbImage::new(8, 6).save(folder.path().join("a.png")).unwrap();
        std::fs::write(folder.path().join("broken.png"), b"no picture").unwrap();
        let mut drafts = Drafts::new(Path::new("list"), vec![folder.path().into()]);
        let singular = Draft {
            turn: DMat3::ZERO,
            ..draft("a.png")
        };
        let mirrored = Draft {
            turn: DMat3::from_diagonal(DVec3::new(-1.0, 1.0, 1.0)),
            ..draft("a.png")
        };
        let nowhere = Draft {
            shift: DVec3::NAN,
            ..draft("a.png")
        };
        let blind = Draft {
            lens: Err("of a model that is not known".into()),
            ..draft("a.png")
        };
        drafts.photos = vec![
            draft("gone.png"),
            singular,
            mirrored,
            nowhere,
            blind,
            draft("broken.png"),
            draft("a.png"),
        ];
        // The name is used more than once here, which is fine if the file is found under exactly that name.
        let set = drafts.into_view_set().unwrap();
        assert_eq!(set.photos.len(), 1);
        assert_eq!(set.photos[0].camera.size_px(), [8, 6]);
        let notes = set.notes.join("\n");
        for words in [
            "gone.png",
            "determinant 0.000",
            "determinant -1.000",
            "not finite",
            "of a model",
            "broken.png",
        ] {
            assert!(notes.contains(words), "{words} in {notes}");
        }
    }

    #[test]
    fn images_are_sorted_by_name_and_tracks_follow() {
        let folder = tempfile::tempdir().unwrap();
        for (name, width) in [("view_2.png", 10), ("view_10.png", 12), ("view_1.png", 8)] {
            image::RgbImage::new(width, 6).save(folder.path().join(name)).unwrap();
        }
        let mut drafts = Drafts::new(Path::new("list"), vec![folder.path().into()]);
        drafts.photos = ["view_10.png", "gone.png", "view_2.png", "view_1.png"]
            .map(draft)
            .into();
        let seen = |photo| Observation {
            photo,
            pixel: glam::Vec2::new(photo as f32, 0.0),
        };
        drafts.points.push(DVec3::ZERO, [0; 3], [0, 1, 2, 3].map(seen));
        let set = drafts.into_view_set().unwrap();
        let names: Vec<&str> = set.photos.iter().map(|photo| photo.name.as_str()).collect();
        assert_eq!(names, ["view_1.png", "view_2.png", "view_10.png"]);
        let track: Vec<u32> = set.points.track(0).iter().map(|seen| seen.photo).collect();
        assert_eq!(track, [2, 1, 0]);
    }

    #[test]
    fn an_empty_set_says_why() {
        let folder = tempfile::tempdir().unwrap();
        let mut drafts = Drafts::new(Path::new("list"), vec![folder.path().into()]);
        drafts.photos = (0..5).map(|index| draft(&format!("{index}.png"))).collect();
        let error = drafts.into_view_set().unwrap_err().to_string();
        assert!(
            error.starts_with("list lists 5 images, none of which can be shown"),
            "{error}"
        );
        assert!(error.contains("0.png, 1.png, 2.png and 2 more"), "{error}");
        let images = folder.path().join("images");
        assert!(
            error.ends_with(&format!("; put them into {}", images.display())),
            "{error}"
        );
        let error = Drafts::new(Path::new("list"), Vec::new())
            .into_view_set()
            .unwrap_err()
            .to_string();
        assert!(error.contains("the list is empty"), "{error}");
    }

    #[test]
    fn rounded_rotations_are_rotations_again() {
        let exact = DMat3::from_rotation_y(0.7) * DMat3::from_rotation_x(-0.3);
        let rounded = DMat3::from_cols_array(&exact.to_cols_array().map(|x| (x * 1e4).round() / 1e4));
        let pose = pose(rounded, DVec3::ONE).unwrap();
        let products = pose.matrix3.transpose() * pose.matrix3;
        assert!(products.abs_diff_eq(DMat3::IDENTITY, 1e-12) && pose.matrix3.abs_diff_eq(exact, 1e-4));
    }
}
