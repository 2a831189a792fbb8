//! Depth map files of an input image, which another camera next to it may have taken.

use crate::photos::error::{PhotosError, read_file};
use crate::photos::found::picture_file::decode;
use crate::photos::parts::npy_table::NpyTable;
use crate::photos::readers::colmap::colmap_depth;
use crate::rgbd::{Camera, DepthImage, is_measured};
use glam::DAffine3;
use image::DynamicImage;
use std::path::{Path, PathBuf};

/// A depth map file of an input image. Its resolution may be smaller than that of the input image.
#[derive(Debug, Clone, PartialEq)]
pub struct DepthFile {
    /// The file.
    pub path: PathBuf,
    /// Meaning of its depth values.
    pub kind: DepthKind,
    /// The camera of the depth map; `None` if it is that of the input image.
    pub taken_by: Option<DepthCamera>,
}

/// A depth camera next to the camera of an input image.
#[derive(Debug, Clone, PartialEq)]
pub struct DepthCamera {
    /// Its image.
    pub camera: Camera,
    /// From its frame to the frame of the input image's camera.
    pub photo_from_depth: DAffine3,
}

/// Depth encoding of a file.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum DepthKind {
    /// An image of COLMAP's dense stage: `W&H&C&`, then floats in the unit of the world. See [`colmap_depth`].
    Colmap,
    /// A grey image, or a table of numpy (`.npy`) of rows of pixels, whose values are depths along the axis in the unit
    /// of the world, once multiplied by this. 0 means no depth, and so does 65535 in 16-bit images.
    Scaled(f64),
}

impl DepthFile {
    /// Depths along the axis of the camera that took them, in the unit of the world regardless of `metres`; 0 if there
    /// is none.
    ///
    /// # Errors
    /// An error if the file cannot be read, or has another shape.
    pub fn read(&self) -> Result<DepthImage, PhotosError> {
        match self.kind {
            DepthKind::Colmap => colmap_depth(&self.path),
            DepthKind::Scaled(scale) => scaled(&self.path, scale),
        }
    }
}

fn scaled(path: &Path, scale: f64) -> Result<DepthImage, PhotosError> {
    if path
        .extension()
        .is_some_and(|extension| extension.eq_ignore_ascii_case("npy"))
    {
        return scaled_table(path, scale);
    }
    let picture = decode(path)?;
    let size_px = [picture.width(), picture.height()];
    let depth = |value: u16| (f64::from(value) * scale) as f32;
    let measured = |value: u16| if is_measured(value) { depth(value) } else { 0.0 };
    let depths: Vec<f32> = match picture {
        DynamicImage::ImageLuma16(image) => image.into_raw().into_iter().map(measured).collect(),
        DynamicImage::ImageLuma8(image) => image.into_raw().into_iter().map(|value| depth(value.into())).collect(),
        other => {
            let problem = format!("expected grey values of 16 or 8 bits, found {:?}", other.color());
            return Err(PhotosError::invalid(path, "the picture", problem));
        }
    };
    DepthImage::new(size_px, depths).ok_or_else(|| PhotosError::invalid(path, "the picture", "it has no pixels"))
}

fn scaled_table(path: &Path, scale: f64) -> Result<DepthImage, PhotosError> {
    let table = NpyTable::parse(path, &read_file(path)?)?;
    let rows = table.numbers.len() / table.columns.max(1);
    let depths = table.numbers.iter().map(|&number| (number * scale) as f32);
    let size_px = Option::zip(u32::try_from(table.columns).ok(), u32::try_from(rows).ok());
    size_px
        .and_then(|(width, height)| DepthImage::new([width, height], depths.collect()))
        .ok_or_else(|| PhotosError::invalid(path, "the table", "it has no pixels"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::{GrayImage, ImageBuffer, Luma, RgbImage};

    #[test]
    fn gray_values_are_scaled() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("depth.png");
        let file = DepthFile {
            path: path.clone(),
            kind: DepthKind::Scaled(1e-3),
            taken_by: None,
        };
        let wide: ImageBuffer<Luma<u16>, _> = ImageBuffer::from_raw(3, 1, vec![1500_u16, 0, 65535]).unwrap();
        wide.save(&path).unwrap();
        assert_eq!(file.read().unwrap().metres(), [1.5, 0.0, 0.0]);
        GrayImage::from_raw(1, 1, vec![200]).unwrap().save(&path).unwrap();
        assert_eq!(file.read().unwrap().metres(), [0.2]);
        let table = DepthFile {
            path: folder.path().join("depth.npy"),
            ..file.clone()
        };
        let header = b"{'descr': '<f4', 'fortran_order': False, 'shape': (1, 3)}";
        let numbers = [1500.0_f32, 0.0, f32::NAN].map(f32::to_le_bytes).concat();
        let all = [b"\x93NUMPY\x01\x00", &[header.len() as u8, 0][..], header, &numbers].concat();
        std::fs::write(&table.path, all).unwrap();
        let read = table.read().unwrap();
        assert_eq!((read.size_px(), read.metres()), ([3, 1], &[1.5, 0.0, 0.0][..]));
        RgbImage::new(1, 1).save(&path).unwrap();
        assert!(
            file.read()
                .unwrap_err()
                .to_string()
                .contains("expected grey values of 16 or 8 bits, found Rgb8")
        );
    }
}
