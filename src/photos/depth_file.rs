//! Files of the depths of a photograph.

use super::colmap::colmap_depth;
use super::error::PhotosError;
use super::picture_file::decode;
use crate::rgbd::DepthImage;
use image::DynamicImage;
use std::path::{Path, PathBuf};

/// A file of the depths of a photograph. Its image may be smaller than the photograph.
#[derive(Debug, Clone, PartialEq)]
pub struct DepthFile {
    /// The file.
    pub path: PathBuf,
    /// What its numbers mean.
    pub kind: DepthKind,
}

/// How a file holds depths.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum DepthKind {
    /// An image of COLMAP's dense stage: `W&H&C&`, then floats in the unit of the world. See [`colmap_depth`].
    Colmap,
    /// A grey picture whose values are depths along the axis in the unit of the world, once multiplied by this.
    Scaled(f64),
}

impl DepthFile {
    /// Depths along the axis of the camera, in the unit of the world whatever `metres` says; 0 where there is none.
    ///
    /// # Errors
    /// Where the file cannot be read, or is of another shape.
    pub fn read(&self) -> Result<DepthImage, PhotosError> {
        match self.kind {
            DepthKind::Colmap => colmap_depth(&self.path),
            DepthKind::Scaled(scale) => scaled(&self.path, scale),
        }
    }
}

fn scaled(path: &Path, scale: f64) -> Result<DepthImage, PhotosError> {
    let picture = decode(path)?;
    let size_px = [picture.width(), picture.height()];
    let depth = |value: u16| (f64::from(value) * scale) as f32;
    let depths: Vec<f32> = match picture {
        DynamicImage::ImageLuma16(image) => image.into_raw().into_iter().map(depth).collect(),
        DynamicImage::ImageLuma8(image) => image.into_raw().into_iter().map(|value| depth(value.into())).collect(),
        other => {
            let problem = format!("expected grey values of 16 or 8 bits, found {:?}", other.color());
            return Err(PhotosError::invalid(path, "the picture", problem));
        }
    };
    DepthImage::new(size_px, depths).ok_or_else(|| PhotosError::invalid(path, "the picture", "it has no pixels"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::{GrayImage, ImageBuffer, Luma, RgbImage};

    #[test]
    fn grey_values_are_scaled() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("depth.png");
        let file = DepthFile {
            path: path.clone(),
            kind: DepthKind::Scaled(1e-3),
        };
        let wide: ImageBuffer<Luma<u16>, _> = ImageBuffer::from_raw(2, 1, vec![1500_u16, 0]).unwrap();
        wide.save(&path).unwrap();
        assert_eq!(file.read().unwrap().metres(), [1.5, 0.0]);
        GrayImage::from_raw(1, 1, vec![200]).unwrap().save(&path).unwrap();
        assert_eq!(file.read().unwrap().metres(), [0.2]);
        RgbImage::new(1, 1).save(&path).unwrap();
        assert!(
            file.read()
                .unwrap_err()
                .to_string()
                .contains("expected grey values of 16 or 8 bits, found Rgb8")
        );
    }
}
