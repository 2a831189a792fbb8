//! One numbered PNG file per image.

use super::error::ExportError;
use super::sink::{FrameSink, VideoStream};
use crate::persist::Partial;
use crate::temporary::Temporary;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder as _, RgbaImage};
use std::fs;
use std::io::{self, BufWriter, Write as _};
use std::path::{Path, PathBuf};

/// Placeholder for the frame number in a file name, with one file per image.
pub const FRAME_PLACEHOLDER: &str = "{frame}";

/// Start of the placeholder with the number of digits, as in format strings of other languages: `{frame:04}`.
const PADDED_PLACEHOLDER: &str = "{frame:0";

/// The place of the number in a name: its first byte, its length, and its number of digits if that is said.
fn placeholder(name: &str) -> Option<(usize, usize, Option<usize>)> {
    if let Some(start) = name.find(FRAME_PLACEHOLDER) {
        return Some((start, FRAME_PLACEHOLDER.len(), None));
    }
    let start = name.find(PADDED_PLACEHOLDER)?;
    let after = &name[start + PADDED_PLACEHOLDER.len()..];
    let digits = after.split('}').next().filter(|digits| digits.len() < after.len())?;
    let length = PADDED_PLACEHOLDER.len() + digits.len() + 1;
    let digits = digits.strip_suffix('d').unwrap_or(digits);
    Some((start, length, Some(digits.parse().ok().filter(|digits| *digits <= 20)?)))
}

/// True if a name has a place for the number of a frame.
pub fn has_placeholder(name: &Path) -> bool {
    placeholder(&name.to_string_lossy()).is_some()
}

/// A name with [`FRAME_PLACEHOLDER`] replaced by a number, padded so that the names of `count` files sort.
pub fn numbered(name: &Path, index: usize, count: usize) -> PathBuf {
    let default_digits = count.saturating_sub(1).to_string().len().max(4);
    let mut name = name.to_string_lossy().into_owned();
    while let Some((start, length, digits)) = placeholder(&name) {
        let digits = digits.unwrap_or(default_digits);
        name.replace_range(start..start + length, &format!("{index:0digits$}"));
    }
    PathBuf::from(name)
}

/// The name, with a placeholder for the number, of the images of a video to `output`: a folder, or such a name.
pub fn picture_names(output: &Path) -> PathBuf {
    if !output.is_dir() && has_placeholder(output) {
        output.to_owned()
    } else {
        output.join("{frame}.png")
    }
}

/// Files that get their names when all of them are complete.
pub(super) struct PngFiles {
    name: PathBuf,
    partials: Vec<Partial>,
    stream: VideoStream,
    /// The folder, if it was made for them; it goes after them, unless something is in it.
    _new_folder: Option<Temporary>,
}

impl PngFiles {
    /// `output` is a folder, or a name with a place for the number.
    pub(super) fn create(output: &Path, stream: &VideoStream) -> Result<Self, ExportError> {
        let name = picture_names(output);
        let folder = numbered(&name, 0, stream.count);
        let folder = folder
            .parent()
            .filter(|folder| !folder.as_os_str().is_empty() && !folder.exists())
            .map(Path::to_owned);
        let new_folder = folder.as_deref().map(Temporary::folder);
        if let Some(folder) = &folder {
            fs::create_dir_all(folder).map_err(|reason| failed(folder, reason))?;
        }
        Ok(Self {
            name,
            partials: Vec::new(),
            stream: *stream,
            _new_folder: new_folder,
        })
    }
}

impl FrameSink for PngFiles {
    fn push(&mut self, picture: &RgbaImage) -> Result<(), ExportError> {
        let file = numbered(&self.name, self.partials.len(), self.stream.count);
        let write = || {
            let (partial, new) = Partial::create(&file)?;
            let mut new = BufWriter::new(new);
            let (width, height) = picture.dimensions();
            PngEncoder::new_with_quality(&mut new, CompressionType::Fast, FilterType::Adaptive)
                .write_image(picture, width, height, ExtendedColorType::Rgba8)
                .map_err(io::Error::other)?;
            new.flush()?;
            new.get_ref().sync_data()?;
            Ok(partial)
        };
        let partial = write().map_err(|reason| failed(&file, reason))?;
        self.partials.push(partial);
        Ok(())
    }

    fn finish(mut self: Box<Self>) -> Result<(), ExportError> {
        for partial in self.partials.drain(..) {
            partial.finish().map_err(|reason| failed(&self.name, reason))?;
        }
        Ok(())
    }
}

fn failed(path: &Path, reason: io::Error) -> ExportError {
    ExportError::Write {
        path: path.to_owned(),
        reason,
    }
}
