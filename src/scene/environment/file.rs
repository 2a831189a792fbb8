//! Environment map files captured by a person: equirectangular images.
//!
//! Styles name a file by a number, so that they stay plain values: files are remembered for as long as the program
//! runs, and each is read once. Left and right are as from the centre of the scene; the centre of the image is behind
//! the cloud when that is seen from the front.

use super::map::EnvironmentMap;
use glam::Vec3;
use image::{DynamicImage, ImageError, ImageReader, Limits, Rgb32FImage};
use std::f32::consts::{PI, TAU};
use std::io::{self, BufReader};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};

/// Maximum pixels along an edge of a file's image, and maximum memory that its decoder may take.
const MAX_EDGE_PX: u32 = 1 << 13;
const MAX_BYTES: u64 = 1 << 29;

/// Width that images are reduced to: a column is about as wide as a texel of the map.
const WIDTH: u32 = 2 * EnvironmentMap::EDGE as u32;

/// Reasons why an image cannot be an environment.
#[derive(Debug, thiserror::Error)]
pub enum EnvironmentError {
    /// The file cannot be opened.
    #[error("cannot open the environment {}", path.display())]
    Open {
        /// Path of the file.
        path: PathBuf,
        /// The reason.
        source: io::Error,
    },
    /// Its contents are not an image, or too many pixels.
    #[error("the environment {} is not a readable image", path.display())]
    Picture {
        /// Path of the file.
        path: PathBuf,
        /// The reason.
        source: ImageError,
    },
    /// An image without pixels.
    #[error("the environment {} has no pixels", path.display())]
    Empty {
        /// Path of the file.
        path: PathBuf,
    },
}

/// An image in a file that lights the scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct EnvironmentFile(usize);

/// A file, and its contents once requested; none if it cannot be read.
#[derive(Debug)]
struct Known {
    path: PathBuf,
    map: Arc<OnceLock<Option<Arc<EnvironmentMap>>>>,
}

static KNOWN: Mutex<Vec<Known>> = Mutex::new(Vec::new());

fn known() -> MutexGuard<'static, Vec<Known>> {
    // Entries are added as a whole.
    KNOWN.lock().unwrap_or_else(PoisonError::into_inner)
}

impl EnvironmentFile {
    /// The file of this path, which is read when it is needed first.
    pub fn named(path: &Path) -> Self {
        let mut known = known();
        let place = known.iter().position(|known| known.path == path);
        Self(place.unwrap_or_else(|| {
            known.push(Known {
                path: path.to_owned(),
                map: Arc::default(),
            });
            known.len() - 1
        }))
    }

    /// Opens the environment file at `path`, and reads it now.
    pub fn open(path: &Path) -> Result<Self, EnvironmentError> {
        let map = read(path)?;
        let file = Self::named(path);
        // An earlier call has read the same file.
        let _ = file.of_known(|known| Arc::clone(&known.map)).set(Some(map));
        Ok(file)
    }

    /// Returns the path of the file.
    pub fn path(self) -> PathBuf {
        self.of_known(|known| known.path.clone())
    }

    /// Returns the environment map of the file; `None` if it cannot be read, which is logged once.
    pub(super) fn map(self) -> Option<Arc<EnvironmentMap>> {
        let (path, map) = self.of_known(|known| (known.path.clone(), Arc::clone(&known.map)));
        let read_now = || {
            let read = read(&path).inspect_err(|error| {
                let cause = std::error::Error::source(error).map_or_else(String::new, |cause| format!(": {cause}"));
                log::warn!("{error}{cause}");
            });
            read.ok()
        };
        map.get_or_init(read_now).clone()
    }

    fn of_known<T>(self, value: impl FnOnce(&Known) -> T) -> T {
        value(&known()[self.0])
    }
}

fn read(path: &Path) -> Result<Arc<EnvironmentMap>, EnvironmentError> {
    let opened = crate::regular_file::open(path)
        .map(|file| ImageReader::new(BufReader::new(file)))
        .and_then(ImageReader::with_guessed_format);
    let mut reader = opened.map_err(|source| EnvironmentError::Open {
        path: path.to_owned(),
        source,
    })?;
    let mut limits = Limits::default();
    limits.max_image_width = Some(MAX_EDGE_PX);
    limits.max_image_height = Some(MAX_EDGE_PX);
    limits.max_alloc = Some(MAX_BYTES);
    reader.limits(limits);
    let picture = reader.decode().map_err(|source| EnvironmentError::Picture {
        path: path.to_owned(),
        source,
    })?;
    let picture = Equirectangular::of(&picture);
    if picture.texels.is_empty() {
        return Err(EnvironmentError::Empty { path: path.to_owned() });
    }
    Ok(Arc::new(EnvironmentMap::new(|direction| picture.at(direction))))
}

/// Linear light by longitude, from the left, and latitude, from above.
#[derive(Debug)]
struct Equirectangular {
    size: [usize; 2],
    texels: Vec<Vec3>,
}

impl Equirectangular {
    /// Converts an image of bytes, which are display-referred, or of floats, which are linear light.
    fn of(picture: &DynamicImage) -> Self {
        let is_linear = matches!(picture, DynamicImage::ImageRgb32F(_) | DynamicImage::ImageRgba32F(_));
        let light: fn(f32) -> f32 = if is_linear { |value| value } else { to_linear };
        Self::reduced(&picture.to_rgb32f(), light)
    }

    /// Each pixel is the mean of a square of pixels of the file.
    fn reduced(picture: &Rgb32FImage, light: fn(f32) -> f32) -> Self {
        let [width, height] = [picture.width(), picture.height()];
        let factor = width.div_ceil(WIDTH).max(1);
        let size = [width, height].map(|edge| edge.div_ceil(factor));
        let squares = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| [x * factor, y * factor]));
        let mean = |[left, top]: [u32; 2]| {
            let [columns, rows] = [left..width.min(left + factor), top..height.min(top + factor)];
            let count = columns.len() * rows.len();
            let pixels = rows.flat_map(|y| columns.clone().map(move |x| picture.get_pixel(x, y)));
            pixels.map(|pixel| Vec3::from_array(pixel.0.map(light))).sum::<Vec3>() / count as f32
        };
        Self {
            size: size.map(|edge| edge as usize),
            texels: squares.map(mean).collect(),
        }
    }

    /// Blended between four pixels; left and right edge are neighbours.
    fn at(&self, direction: Vec3) -> Vec3 {
        let [width, height] = self.size;
        let longitude = direction.x.atan2(-direction.z);
        let latitude = direction.y.clamp(-1.0, 1.0).asin();
        let x = (longitude / TAU + 0.5) * width as f32 - 0.5;
        let y = (0.5 - latitude / PI) * height as f32 - 0.5;
        let texel = |column: f32, row: f32| {
            let column = (column as isize).rem_euclid(width as isize) as usize;
            let row = (row as isize).clamp(0, height as isize - 1) as usize;
            self.texels[width * row + column]
        };
        let (left, top) = (x.floor(), y.floor());
        let row = |row: f32| texel(left, row).lerp(texel(left + 1.0, row), x - left);
        row(top).lerp(row(top + 1.0), y - top)
    }
}

/// The light of a display-referred channel (sRGB, IEC 61966-2-1).
fn to_linear(channel: f32) -> f32 {
    if channel <= 0.040_45 {
        channel / 12.92
    } else {
        ((channel + 0.055) / 1.055).powf(2.4)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::{Rgb, RgbImage};

    /// An image whose halves have the colours of the six directions of its centre, edges and poles.
    fn picture() -> RgbImage {
        RgbImage::from_fn(64, 32, |x, y| match (x, y) {
            (_, 0..4) => Rgb([0, 0, 255]),
            (_, 28..) => Rgb([0, 255, 255]),
            (24..40, _) => Rgb([255, 0, 0]),
            (8..24, _) => Rgb([255, 255, 0]),
            (40..56, _) => Rgb([0, 255, 0]),
            _ => Rgb([0, 0, 0]),
        })
    }

    #[test]
    fn directions_map_to_their_place_in_the_image() {
        let equirectangular = Equirectangular::of(&DynamicImage::ImageRgb8(picture()));
        for (direction, color) in [
            (Vec3::NEG_Z, Vec3::X),
            (Vec3::X, Vec3::Y),
            (Vec3::NEG_X, Vec3::new(1.0, 1.0, 0.0)),
            (Vec3::Z, Vec3::ZERO),
            (Vec3::Y, Vec3::Z),
            (Vec3::NEG_Y, Vec3::new(0.0, 1.0, 1.0)),
        ] {
            assert_eq!(equirectangular.at(direction), color, "{direction}");
        }
    }

    #[test]
    fn floats_are_linear_light_and_bytes_are_display_referred() {
        let bytes = DynamicImage::ImageRgb8(RgbImage::from_pixel(8, 4, Rgb([188; 3])));
        let numbers = DynamicImage::ImageRgb32F(Rgb32FImage::from_pixel(2000, 1000, Rgb([7.5; 3])));
        let [bytes, numbers] = [bytes, numbers].map(|picture| Equirectangular::of(&picture));
        assert!((bytes.at(Vec3::X).x - 0.5029).abs() < 1e-3);
        assert_eq!(numbers.at(Vec3::X), Vec3::splat(7.5));
        assert_eq!(numbers.size, [500, 250]);
    }

    #[test]
    fn files_that_are_not_images_are_errors() {
        let folder = tempfile::tempdir().unwrap();
        let text = folder.path().join("text.hdr");
        std::fs::write(&text, "#?RADIANCE\nno picture").unwrap();
        let missing = folder.path().join("missing.hdr");
        assert!(matches!(
            EnvironmentFile::open(&text),
            Err(EnvironmentError::Picture { .. })
        ));
        assert!(matches!(
            EnvironmentFile::open(&missing),
            Err(EnvironmentError::Open { .. })
        ));
        assert!(EnvironmentFile::named(&missing).map().is_none());
        assert_eq!(EnvironmentFile::named(&missing), EnvironmentFile::named(&missing));
    }

    #[test]
    fn a_white_image_gives_white_light() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("white.png");
        RgbImage::from_pixel(16, 8, Rgb([255; 3])).save(&path).unwrap();
        let map = EnvironmentFile::open(&path).unwrap().map().unwrap();
        for normal in [Vec3::X, Vec3::NEG_Y, Vec3::new(0.6, 0.0, 0.8)] {
            assert!(map.harmonics().at(normal).distance(Vec3::ONE) < 1e-4);
        }
    }
}
