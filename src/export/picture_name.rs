//! The format by the name of a still image, and its limits.

use super::error::ExportError;
use super::picture::check_size;
use super::picture_format::{FORMATS, PictureFormat, Row};
use std::path::Path;

impl PictureFormat {
    /// The format by the extension of `path`.
    ///
    /// # Errors
    /// [`ExportError::UnknownPicture`] for another extension, none, and an existing folder.
    pub fn of_name(path: &Path) -> Result<Self, ExportError> {
        let extension = path
            .extension()
            .map(|extension| extension.to_string_lossy().to_ascii_lowercase());
        let has_it = |row: &&Row| {
            extension
                .as_deref()
                .is_some_and(|found| row.extensions.contains(&found))
        };
        let found = FORMATS.iter().find(has_it).filter(|_| !path.is_dir());
        found
            .map(|row| row.format)
            .ok_or_else(|| ExportError::UnknownPicture { path: path.to_owned() })
    }

    /// Checks the image size and transparency against the limits of the format before anything is drawn.
    ///
    /// # Errors
    /// [`ExportError::OpaquePicture`], [`ExportError::LargePicture`]; [`ExportError::PictureSize`] where no format can.
    pub fn check(self, [width, height]: [u32; 2], is_transparent: bool) -> Result<(), ExportError> {
        check_size([width, height])?;
        if is_transparent && !self.has_alpha() {
            return Err(ExportError::OpaquePicture { format: self });
        }
        let max_px = self.row().max_edge_px;
        if width.max(height) > max_px {
            return Err(ExportError::LargePicture {
                format: self,
                width,
                height,
                max_px,
            });
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn file_names_determine_the_format() {
        for (name, format) in [
            ("a.png", PictureFormat::Png),
            ("a.b.JPG", PictureFormat::Jpeg),
            ("p{frame}.jpeg", PictureFormat::Jpeg),
            ("a.webp", PictureFormat::Webp),
            ("a.tif", PictureFormat::Tiff),
            ("a.TIFF", PictureFormat::Tiff),
        ] {
            assert_eq!(PictureFormat::of_name(Path::new(name)).unwrap(), format, "{name}");
        }
        for name in [
            "a.exr", "a.gif", "a.bmp", "a.mp4", "a.svg", "a", "png", ".png", "a.png~", "/tmp",
        ] {
            let refused = PictureFormat::of_name(Path::new(name)).unwrap_err().to_string();
            assert!(refused.contains(".png, .jpg, .jpeg, .webp, .tif"), "{refused}");
        }
    }

    #[test]
    fn content_a_format_cannot_hold_is_rejected() {
        assert!(
            PictureFormat::Jpeg
                .check([64, 48], true)
                .unwrap_err()
                .to_string()
                .contains(".png")
        );
        let refused = |format: PictureFormat, size_px| format.check(size_px, false).unwrap_err().to_string();
        assert!(refused(PictureFormat::Webp, [16_384, 10]).contains("choose .png"));
        for format in [PictureFormat::Png, PictureFormat::Webp] {
            let said = refused(format, [1_000_000, 8]);
            assert!(said.contains("from 1 to 65536 pixels"), "{said}");
        }
        PictureFormat::Png
            .check([crate::export::MAX_EDGE_PX, 10], true)
            .unwrap();
        PictureFormat::Jpeg.check([64, 48], false).unwrap();
    }
}
