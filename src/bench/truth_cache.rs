//! Disk cache of ground-truth images, by their content: they take seconds, and the same view is measured repeatedly.
//!
//! How it works: the name of a truth is the SHA-256 of everything that it depends on. Image, depths and tolerances are
//! three PNG files, the latter with the bytes of an f32 in the channels of a pixel. Unreadable truths are regenerated.
//! The oldest files are removed when the cache is too large.

use crate::binary::hex;
use crate::measure::DepthImage;
use crate::persist;
use crate::render::truth::{Truth, TruthKey};
use image::{ImageFormat, RgbaImage};
use sha2::{Digest, Sha256};
use std::fs;
use std::io::Cursor;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// Max bytes of the cache.
const MAX_BYTES: u64 = 256 << 20;

/// Incremented whenever truths are computed differently.
const VERSION: u32 = 2;

/// A folder of truths.
#[derive(Debug, Clone)]
pub(super) struct TruthCache {
    folder: Option<PathBuf>,
    max_bytes: u64,
}

impl TruthCache {
    /// A cache in `folder`, or no caching.
    pub(super) fn new(folder: Option<PathBuf>) -> Self {
        Self {
            folder,
            max_bytes: MAX_BYTES,
        }
    }

    /// The truth of `key`: from the disk, or generated and stored there.
    pub(super) fn get(&self, key: &TruthKey<'_>, make: impl FnOnce() -> Truth) -> Truth {
        let Some(folder) = &self.folder else {
            return make();
        };
        // SHA-256: a 32-bit checksum would confuse different clouds.
        let mut hash = Sha256::new();
        // All inputs, not a name: a ground truth takes seconds to compute, so it is reused wherever the inputs are the
        // same.
        hash.update(VERSION.to_le_bytes());
        key.for_each_bytes(&mut |bytes| {
            hash.update((bytes.len() as u64).to_le_bytes());
            hash.update(bytes);
        });
        let name = hex(&hash.finalize());
        let files = ["picture", "depth", "tolerance"].map(|part| folder.join(format!("{name}-{part}.png")));
        if let Some(truth) = read(&files, key.size_px()) {
            return truth;
        }
        let truth = make();
        if let Err(reason) = write(&files, &truth) {
            log::warn!("the truth of a view is not kept in {}: {reason}", folder.display());
        }
        drop_oldest(folder, self.max_bytes);
        truth
    }
}

fn read([picture, depth, tolerance]: &[PathBuf; 3], size_px: [u32; 2]) -> Option<Truth> {
    let image = |file: &Path| {
        let bytes = fs::read(file).ok()?;
        let image = image::load_from_memory_with_format(&bytes, ImageFormat::Png).ok()?;
        let image = image.into_rgba8();
        (image.dimensions() == (size_px[0], size_px[1])).then_some(image)
    };
    let numbers = |image: &RgbaImage| -> Vec<f32> { image.pixels().map(|pixel| f32::from_le_bytes(pixel.0)).collect() };
    let depth = DepthImage {
        size_px,
        depth: numbers(&image(depth)?),
    };
    let tolerance = numbers(&image(tolerance)?);
    let is_sound = |number: &f32| *number >= 0.0;
    let are_sound = depth.depth.iter().all(is_sound) && tolerance.iter().all(is_sound);
    are_sound.then_some(Truth {
        image: image(picture)?,
        depth,
        tolerance,
    })
}

fn write(files: &[PathBuf; 3], truth: &Truth) -> Result<(), Box<dyn std::error::Error>> {
    let [width, height] = truth.depth.size_px;
    let numbers = |numbers: &[f32]| {
        RgbaImage::from_fn(width, height, |x, y| {
            image::Rgba(numbers[(y * width + x) as usize].to_le_bytes())
        })
    };
    let images = [
        truth.image.clone(),
        numbers(&truth.depth.depth),
        numbers(&truth.tolerance),
    ];
    for (file, image) in files.iter().zip(images) {
        let mut png = Cursor::new(Vec::new());
        image.write_to(&mut png, ImageFormat::Png)?;
        persist::replace(file, png.get_ref())?;
    }
    Ok(())
}

/// Removes the oldest files of `folder` until at most `max_bytes` are left.
fn drop_oldest(folder: &Path, max_bytes: u64) {
    let Ok(entries) = fs::read_dir(folder) else {
        return;
    };
    let mut files: Vec<(SystemTime, u64, PathBuf)> = entries
        .flatten()
        .filter_map(|entry| {
            let metadata = entry.metadata().ok()?;
            Some((metadata.modified().ok()?, metadata.len(), entry.path()))
        })
        .collect();
    files.sort();
    let mut bytes: u64 = files.iter().map(|(_, bytes, _)| bytes).sum();
    for (_, size, file) in files {
        if bytes <= max_bytes {
            break;
        }
        // Another run of the program may have got there first.
        let _ = fs::remove_file(file);
        bytes -= size;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::truth::{RayTraced, TruthView};
    use crate::scene::{Background, Camera, Lighting, UpAxis};
    use crate::sequence::Shape;
    use glam::DVec3;

    fn view(size_px: [u32; 2]) -> TruthView {
        let bounds = crate::math::Aabb {
            min: glam::Vec3::NEG_ONE,
            max: glam::Vec3::ONE,
        };
        let camera = Camera::framing(&bounds, DVec3::ZERO, UpAxis::Y);
        let background = Background::solid([119; 3]);
        TruthView::new(&camera, DVec3::ZERO, size_px, Lighting::PerFragment, background)
    }

    #[test]
    fn a_ground_truth_is_rendered_once_and_read_back_equal() {
        let folder = tempfile::tempdir().unwrap();
        let cache = TruthCache::new(Some(folder.path().join("truth")));
        let sphere = RayTraced {
            shape: Shape::Sphere,
            cull_back_faces: true,
        };
        let made = std::cell::Cell::new(0);
        let get = |size_px: [u32; 2], shape: RayTraced| {
            let view = view(size_px);
            cache.get(&TruthKey::of_shape(shape, &view, 0.01), || {
                made.set(made.get() + 1);
                Truth::of_shape(shape, &view, 0.01)
            })
        };
        let first = get([40, 30], sphere);
        assert_eq!(get([40, 30], sphere), first);
        assert_eq!(made.get(), 1);
        // A different size or shape needs a different ground truth.
        get([41, 30], sphere);
        let cube = RayTraced {
            shape: Shape::Cube,
            ..sphere
        };
        get([40, 30], cube);
        assert_eq!(made.get(), 3);
        // Damaged files are recomputed.
        let file = fs::read_dir(folder.path().join("truth"))
            .unwrap()
            .next()
            .unwrap()
            .unwrap();
        for entry in fs::read_dir(folder.path().join("truth")).unwrap() {
            fs::write(entry.unwrap().path(), b"no picture").unwrap();
        }
        assert!(file.path().exists());
        assert_eq!(get([40, 30], sphere), first);
        assert_eq!(made.get(), 4);
    }

    #[test]
    fn the_oldest_entries_are_evicted_first() {
        let folder = tempfile::tempdir().unwrap();
        for (age, name) in ["c", "b", "a"].iter().enumerate() {
            let file = folder.path().join(name);
            fs::write(&file, [0; 100]).unwrap();
            let modified = SystemTime::UNIX_EPOCH + std::time::Duration::from_secs(1000 + age as u64);
            fs::File::options()
                .write(true)
                .open(&file)
                .unwrap()
                .set_modified(modified)
                .unwrap();
        }
        drop_oldest(folder.path(), 250);
        assert!(!folder.path().join("c").exists());
        assert!(folder.path().join("b").exists() && folder.path().join("a").exists());
    }
}
