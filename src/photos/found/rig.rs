//! Calibrated rig of a multi-view video: each time step has one image of each camera.
//!
//! *How it works.* A rig is a calibration without the images. A time step names a file for each camera, and becomes a
//! [`ViewSet`] of its own. Cameras keep their numbers: one without a file in a time step is in its set too, as an image
//! without a file ([`Photo::has_file`]), which is never drawn.
//!
//! Points of the calibration are of the time step that was calibrated. They indicate how far away things are, so some
//! of them are in each set; their tracks, by which cameras are judged, are in the first alone.

use crate::photos::error::PhotosError;
use crate::photos::found::draft::{Draft, Drafts, notes_of_wrong, reason_of_nothing};
use crate::photos::found::files::Files;
use crate::photos::found::picture_file::size_px;
use crate::photos::sets::lens::Lens;
use crate::photos::sets::photo::Photo;
use crate::photos::sets::points::{Observation, SparsePoints};
use crate::photos::sets::view_set::ViewSet;
use glam::DAffine3;
use rayon::prelude::*;
use std::path::{Path, PathBuf};

/// Points that give distances, in each set of a rig.
const MAX_POINTS: usize = 4096;

/// Cameras of one world.
#[derive(Debug, Clone)]
pub struct Rig {
    path: PathBuf,
    cameras: Vec<RigCamera>,
    /// Their tracks name cameras.
    points: SparsePoints,
    some_points: SparsePoints,
    mask_folders: Vec<PathBuf>,
    notes: Vec<String>,
}

#[derive(Debug, Clone)]
struct RigCamera {
    name: String,
    lens: Lens,
    camera_from_world: DAffine3,
    depth_range: Option<[f64; 2]>,
    /// Index in the list of the file.
    index: usize,
}

impl Rig {
    pub(in crate::photos) fn of(drafts: Drafts) -> Result<Self, PhotosError> {
        let (mut cameras, mut wrong, mut retained) = (Vec::new(), Vec::new(), Vec::new());
        for (index, draft) in drafts.photos.iter().enumerate() {
            retained.push(draft.placed().is_ok().then_some(cameras.len() as u32));
            match draft.placed() {
                Ok((lens, camera_from_world)) => cameras.push(RigCamera {
                    name: name_of_camera(draft),
                    lens: lens.clone(),
                    camera_from_world,
                    depth_range: draft.depth_range,
                    index,
                }),
                Err(reason) => wrong.push((draft.name.as_str(), reason)),
            }
        }
        let mut notes = drafts.notes;
        notes.extend(notes_of_wrong(&wrong));
        if cameras.is_empty() {
            return Err(PhotosError::NoPhotos {
                path: drafts.path,
                count: drafts.photos.len(),
                reason: reason_of_nothing(&notes),
            });
        }
        let points = drafts.points.with_observations(|seen| {
            let photo = (*retained.get(seen.photo as usize)?)?;
            Some(Observation { photo, ..seen })
        });
        Ok(Self {
            some_points: points.some(MAX_POINTS),
            mask_folders: Files::mask_folders(&drafts.folders),
            path: drafts.path,
            cameras,
            points,
            notes,
        })
    }

    /// Returns the index of each camera in the list of the calibration, excluding those that have no lens or no pose.
    pub fn listed(&self) -> impl ExactSizeIterator<Item = usize> {
        self.cameras.iter().map(|camera| camera.index)
    }

    /// Names of the cameras, for people.
    pub fn names(&self) -> impl ExactSizeIterator<Item = &str> {
        self.cameras.iter().map(|camera| camera.name.as_str())
    }

    /// Gives each camera the name that `name` has for its place in the list of the calibration, if it has one.
    pub fn name_cameras(&mut self, name: impl Fn(usize) -> Option<String>) {
        for camera in &mut self.cameras {
            if let Some(name) = name(camera.index) {
                camera.name = name;
            }
        }
    }

    /// Returns notes about anything that was skipped or assumed, one sentence each.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Returns the input images of one time step: for each camera the file at the same index in `files`, or none. The
    /// points have their tracks if `has_tracks`.
    ///
    /// # Errors
    /// [`PhotosError::NoPhotos`] if none of them can be shown. Problems with some of them alone are noted.
    pub fn time_step(&self, files: &[Option<PathBuf>], has_tracks: bool) -> Result<ViewSet, PhotosError> {
        let found: Vec<Option<Result<Photo, String>>> = self
            .cameras
            .par_iter()
            .enumerate()
            .map(|(camera, of)| Some(self.photo(of, files.get(camera)?.as_deref()?)))
            .collect();
        let usual_px = found.iter().flatten().flatten().map(|photo| photo.camera.size_px());
        let Some(usual_px) = usual_px.into_iter().next() else {
            let reasons = found.into_iter().flatten().filter_map(Result::err);
            let reasons: Vec<String> = reasons.collect();
            return Err(PhotosError::NoPhotos {
                path: self.path.clone(),
                count: self.cameras.len(),
                reason: if reasons.is_empty() {
                    "no camera has an image of this time step".to_owned()
                } else {
                    reasons.join("; ")
                },
            });
        };
        let mut set = ViewSet::default();
        let mut numbers = Vec::with_capacity(self.cameras.len());
        for (camera, photo) in self.cameras.iter().zip(found) {
            let photo = match photo {
                Some(Ok(photo)) => Some(photo),
                Some(Err(reason)) => {
                    set.notes.push(format!("{} is skipped: {reason}", camera.name));
                    camera.without_file(usual_px)
                }
                None => {
                    set.notes
                        .push(format!("{} has no image of this time step", camera.name));
                    // Cameras keep their numbers: `--leave-out 3` must mean the same camera in all frames.
                    camera.without_file(usual_px)
                }
            };
            numbers.push(photo.is_some().then_some(set.photos.len() as u32));
            set.photos.extend(photo);
        }
        set.points = if has_tracks {
            self.tracked(&set.photos, &numbers)
        } else {
            self.some_points.clone()
        };
        Ok(set)
    }

    fn photo(&self, camera: &RigCamera, path: &Path) -> Result<Photo, String> {
        // On demand: the headers of all time steps are not read when the folder is opened.
        let image_px = size_px(path).map_err(|error| error.to_string())?;
        let below = |count: usize| -> PathBuf {
            let parts: Vec<_> = path.components().collect();
            parts[parts.len().saturating_sub(count)..].iter().collect()
        };
        Ok(Photo {
            name: camera.name.clone(),
            path: path.to_owned(),
            camera: camera.lens.camera(image_px)?,
            camera_from_world: camera.camera_from_world,
            mask: Files::mask_below(&self.mask_folders, &below(2)).or_else(|| Files::mask_sidecar(path)),
            depth: None,
            depth_range: camera.depth_range,
        })
    }

    /// The points with observations in pixels of `photos`; `numbers` are the cameras' numbers.
    fn tracked(&self, photos: &[Photo], numbers: &[Option<u32>]) -> SparsePoints {
        self.points.clone().with_observations(|seen| {
            let photo = (*numbers.get(seen.photo as usize)?)?;
            let lens = &self.cameras.get(seen.photo as usize)?.lens;
            let image_px = photos.get(photo as usize)?.camera.size_px();
            let pixel = lens.pixel(seen.pixel.as_dvec2(), image_px).as_vec2();
            pixel.is_finite().then_some(Observation { photo, pixel })
        })
    }
}

impl RigCamera {
    /// Returns the camera as a posed image without a file, though there is no image of its view.
    fn without_file(&self, usual_px: [u32; 2]) -> Option<Photo> {
        let size_px = self.lens.size_px.unwrap_or(usual_px);
        Some(Photo {
            name: self.name.clone(),
            path: PathBuf::new(),
            camera: self.lens.camera(size_px).ok()?,
            camera_from_world: self.camera_from_world,
            mask: None,
            depth: None,
            depth_range: self.depth_range,
        })
    }
}

/// The folder of the name, as a camera's, or the name without its extension.
fn name_of_camera(draft: &Draft) -> String {
    let name = draft.name.replace('\\', "/");
    let name = name.trim_start_matches("./");
    match name.rsplit_once('.') {
        Some((stem, extension)) if !stem.is_empty() && !extension.contains('/') => stem.to_owned(),
        _ => name.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::photos::sets::lens::Origin;
    use glam::{DMat3, DVec2, DVec3, Vec2};

    fn drafts() -> Drafts {
        let mut drafts = Drafts::new(Path::new("list"), Vec::new());
        let draft = |name: &str, size_px: Option<[u32; 2]>| {
            let lens = Lens::pinhole(size_px, DVec2::splat(10.0), Origin::Center, DVec2::ZERO);
            Draft::new(name.into(), Ok(lens), DMat3::IDENTITY, DVec3::ZERO)
        };
        let blind = Draft {
            lens: Err("of a model that is not known".into()),
            ..draft("b/1.png", None)
        };
        drafts.photos = vec![draft("./a/1.png", None), blind, draft("c.png", Some([16, 12]))];
        let seen = |photo: u32| Observation {
            photo,
            pixel: Vec2::new(1.0, 2.0),
        };
        drafts.points.push(DVec3::Z, [7; 3], [seen(0), seen(1), seen(2)]);
        drafts
    }

    fn saved(folder: &Path, name: &str, [width, height]: [u32; 2]) -> PathBuf {
        let path = folder.join(name);
        image::RgbImage::new(width, height).save(&path).unwrap();
        path
    }

    #[test]
    fn camera_numbers_are_unchanged_where_one_has_no_image() {
        let folder = tempfile::tempdir().unwrap();
        let rig = Rig::of(drafts()).unwrap();
        assert_eq!(rig.names().collect::<Vec<_>>(), ["a/1", "c"]);
        assert_eq!(rig.listed().collect::<Vec<_>>(), [0, 2]);
        assert!(rig.notes()[0].contains("of a model"), "{:?}", rig.notes());
        let second = Some(saved(folder.path(), "second.png", [8, 6]));
        let set = rig.time_step(&[None, second.clone()], true).unwrap();
        let has_file: Vec<bool> = set.photos.iter().map(Photo::has_file).collect();
        assert_eq!(has_file, [false, true]);
        assert_eq!(set.notes, ["a/1 has no image of this time step"]);
        // The second image is half as large as it was calibrated: (1, 2) from the centre is half as far from it.
        assert_eq!(set.photos[1].camera.size_px(), [8, 6]);
        let track = set.points.track(0);
        assert_eq!(track.len(), 2);
        assert_eq!(track[1].photo, 1);
        assert_eq!(track[1].pixel, Vec2::new(3.5 + 0.5, 2.5 + 1.0));
        let without_tracks = rig.time_step(&[None, second], false).unwrap();
        assert!(without_tracks.points.len() == 1 && without_tracks.points.observations().is_empty());
    }

    #[test]
    fn empty_time_steps_and_empty_rigs_say_why() {
        let folder = tempfile::tempdir().unwrap();
        let rig = Rig::of(drafts()).unwrap();
        let error = rig.time_step(&[None, None], false).unwrap_err().to_string();
        assert!(error.contains("no camera has an image of this time step"), "{error}");
        let broken = folder.path().join("broken.png");
        std::fs::write(&broken, b"no picture").unwrap();
        let error = rig.time_step(&[Some(broken.clone())], false).unwrap_err().to_string();
        assert!(error.contains("broken.png"), "{error}");
        let whole = Some(saved(folder.path(), "whole.png", [16, 12]));
        let set = rig.time_step(&[Some(broken), whole], false).unwrap();
        assert!(set.notes[0].starts_with("a/1 is skipped"), "{:?}", set.notes);
        let nothing = Rig::of(Drafts::new(Path::new("list"), Vec::new()))
            .unwrap_err()
            .to_string();
        assert!(nothing.contains("the list is empty"), "{nothing}");
    }

    #[test]
    fn masks_have_the_same_relative_path_below_their_folder() {
        let folder = tempfile::tempdir().unwrap();
        for below in ["cam0", "masks/cam0", "masks/cam1"] {
            std::fs::create_dir_all(folder.path().join(below)).unwrap();
        }
        let image = Some(saved(folder.path(), "cam0/7.png", [8, 6]));
        let mask = Some(saved(folder.path(), "masks/cam0/7.png", [8, 6]));
        saved(folder.path(), "masks/cam1/7.png", [8, 6]);
        let mut drafts = drafts();
        drafts.folders = vec![folder.path().to_owned()];
        let set = Rig::of(drafts).unwrap().time_step(&[image, None], false).unwrap();
        assert_eq!(set.photos[0].mask, mask);
    }
}
