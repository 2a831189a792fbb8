//! `pointreel compare`: errors of an image compared with another one of the same size.

use crate::cli::terminal::output::{answer, say};
use crate::export::{PictureFormat, encode_picture};
use crate::measure::{PixelDifference, SSIM_WINDOW_PX, SsimError, flip, mean_squared_error, psnr_db, ssim};
use crate::messages::grouped;
use crate::persist::write_whole;
use crate::regular_file;
use anyhow::{Context as _, anyhow, bail};
use clap::Args;
use image::{DynamicImage, ImageDecoder as _, ImageError, ImageFormat, ImageReader, Limits, RgbaImage};
use serde::Serialize;
use std::fs;
use std::io::{BufReader, Cursor, ErrorKind};
use std::path::{Path, PathBuf};

/// Max pixels that an image may claim. 8K (7680×4320) fits; measuring takes a hundred bytes for each.
const MAX_PIXELS: u64 = 1 << 25;

/// Bytes that the decoder may use for one image: 16-bit channels of [`MAX_PIXELS`], and the same amount for its own
/// needs.
const MAX_DECODER_BYTES: u64 = 16 * MAX_PIXELS;

/// Arguments of `pointreel compare`.
#[derive(Debug, Args)]
pub(in crate::cli) struct CompareArgs {
    /// Reference PNG (differences do not affect the exit code)
    #[arg(value_name = "REFERENCE.png")]
    reference: PathBuf,

    /// PNG of the same size to compare with it; both are read as 8-bit RGBA, and alpha is ignored
    #[arg(value_name = "TEST.png")]
    test: PathBuf,

    /// Print JSON; `psnr_db` is null for equal images, `ssim` for images below 11x11
    #[arg(long)]
    json: bool,

    /// Write the FLIP error of each pixel to this image (.png, .jpg, .webp or .tif), black (0) to pale yellow (1)
    #[arg(long, value_name = "OUT.png")]
    heatmap: Option<PathBuf>,
}

#[derive(Serialize)]
struct Comparison {
    reference: String,
    test: String,
    size_px: [u32; 2],
    /// Null for equal images.
    psnr_db: Option<f64>,
    flip_mean: f64,
    flip_max: f64,
    /// Null for images smaller than the SSIM window.
    ssim: Option<f64>,
    different_pixels: u64,
    different_share: f64,
    largest_difference: u8,
}

pub(in crate::cli) fn run(arguments: &CompareArgs) -> anyhow::Result<()> {
    let CompareArgs {
        reference: reference_path,
        test: test_path,
        ..
    } = arguments;
    if let Some(heatmap) = &arguments.heatmap {
        check_target(heatmap, [reference_path, test_path])?;
    }
    let reference = read(reference_path)?;
    let test = read(test_path)?;
    if reference.dimensions() != test.dimensions() {
        bail!(
            "{} has {}x{} pixels and {} has {}x{}: only images of one size can be compared",
            reference_path.display(),
            reference.width(),
            reference.height(),
            test_path.display(),
            test.width(),
            test.height()
        );
    }
    let errors = flip(&reference, &test)?;
    let difference = PixelDifference::of(&reference, &test)?;
    let psnr = psnr_db(mean_squared_error(&reference, &test)?);
    let comparison = Comparison {
        reference: reference_path.display().to_string(),
        test: test_path.display().to_string(),
        size_px: errors.size_px,
        psnr_db: psnr.is_finite().then_some(psnr),
        flip_mean: errors.mean(),
        flip_max: f64::from(errors.max()),
        ssim: match ssim(&reference, &test) {
            Ok(similarity) => Some(similarity),
            Err(SsimError::TooSmall { .. }) => None,
            Err(error) => return Err(error.into()),
        },
        different_pixels: difference.different_count,
        different_share: difference.share(),
        largest_difference: difference.largest,
    };
    if let Some(heatmap) = &arguments.heatmap {
        write_picture(heatmap, &errors.to_heatmap())?;
    }
    if arguments.json {
        let json = serde_json::to_string_pretty(&comparison).context("the answer cannot be written as JSON")?;
        answer(&json);
    } else {
        answer(&table(&comparison, difference.pixel_count));
    }
    if let Some(heatmap) = &arguments.heatmap {
        say(&format!("wrote {}", heatmap.display()));
    }
    Ok(())
}

/// The answer as text.
fn table(comparison: &Comparison, pixel_count: u64) -> String {
    let Comparison {
        reference,
        test,
        size_px: [width, height],
        ..
    } = comparison;
    let psnr = comparison
        .psnr_db
        .map_or("inf (equal)".to_owned(), |psnr| format!("{psnr:.2} dB"));
    let ssim = comparison.ssim.map_or(
        format!("none (below {SSIM_WINDOW_PX}x{SSIM_WINDOW_PX} pixels)"),
        |ssim| format!("{ssim:.5}"),
    );
    let flip = format!("{:.5} mean, {:.5} largest", comparison.flip_mean, comparison.flip_max);
    let different = format!(
        "{:.2} % ({} of {})",
        100.0 * comparison.different_share,
        grouped(comparison.different_pixels),
        grouped(pixel_count)
    );
    let rows = [
        ("reference", reference.clone()),
        ("test", test.clone()),
        ("size", format!("{width}x{height}")),
        ("PSNR", psnr),
        ("FLIP", flip),
        ("SSIM", ssim),
        ("different pixels", different),
        (
            "largest difference",
            format!("{} of 255", comparison.largest_difference),
        ),
    ];
    rows.map(|(name, value)| format!("{name:<20}{value}")).join("\n")
}

/// A PNG file as 8-bit RGBA; warns where that loses precision.
fn read(path: &Path) -> anyhow::Result<RgbaImage> {
    let name = path.display();
    match fs::metadata(path) {
        Ok(metadata) if metadata.is_file() => {}
        Ok(_) => bail!("{name} is not a file: expected a PNG image"),
        Err(reason) if reason.kind() == ErrorKind::NotFound => bail!("{name} does not exist"),
        Err(reason) => return Err(reason).with_context(|| format!("{name} cannot be read")),
    }
    let opened = fs::File::open(path).map(BufReader::new);
    // Detected by the first bytes, not by the name, as everywhere.
    let mut reader = opened
        .and_then(|file| ImageReader::new(file).with_guessed_format())
        .with_context(|| format!("{name} cannot be read"))?;
    if reader.format() != Some(ImageFormat::Png) {
        bail!("{name} is not a PNG image: convert it to PNG first");
    }
    let mut limits = Limits::default();
    limits.max_alloc = Some(MAX_DECODER_BYTES);
    reader.limits(limits);
    let unreadable = |reason| unreadable(path, &reason);
    let decoder = reader.into_decoder().map_err(unreadable)?;
    let (width, height) = decoder.dimensions();
    // Before anything is allocated: FLIP takes a hundred bytes per pixel. 2²⁵ pixels are an 8K image.
    if u64::from(width) * u64::from(height) > MAX_PIXELS {
        return Err(too_large(path, &format!("{width}x{height} pixels")));
    }
    let image = DynamicImage::from_decoder(decoder).map_err(unreadable)?;
    if image.color().bytes_per_pixel() > image.color().channel_count() {
        say(&format!(
            "warning: {name} has 16 bits a channel and is compared as if rounded to 8"
        ));
    }
    let image = image.into_rgba8();
    if image.pixels().any(|pixel| pixel[3] != 255) {
        say(&format!("warning: {name} is not opaque, and its alpha is ignored"));
    }
    Ok(image)
}

/// Returns the error for a file that the decoder rejects. In one sentence: the causes of its errors repeat the errors.
fn unreadable(path: &Path, reason: &ImageError) -> anyhow::Error {
    let name = path.display();
    match reason {
        ImageError::Limits(_) => too_large(path, "too many pixels"),
        ImageError::IoError(reason) if reason.kind() != ErrorKind::UnexpectedEof => {
            anyhow!("{name} cannot be read: {reason}")
        }
        reason => anyhow!("{name} is a broken PNG image, write it again: {reason}"),
    }
}

fn too_large(path: &Path, claimed: &str) -> anyhow::Error {
    anyhow!(
        "{} claims {claimed}: at most {MAX_PIXELS} pixels can be compared, cut out a part",
        path.display()
    )
}

/// A heatmap must not overwrite its inputs, nor anything that is not a file.
fn check_target(heatmap: &Path, inputs: [&Path; 2]) -> anyhow::Result<()> {
    let name = heatmap.display();
    let metadata = fs::metadata(heatmap).ok();
    if metadata.as_ref().is_some_and(|metadata| !metadata.is_file()) {
        bail!("{name} is not a file and cannot be replaced by a heatmap");
    }
    PictureFormat::of_name(heatmap)?;
    if metadata.is_none() {
        return Ok(());
    }
    if inputs.iter().any(|input| regular_file::are_same(input, heatmap)) {
        bail!("{name} is compared itself: give the heatmap another name");
    }
    Ok(())
}

/// Writes an image in the format of its name, as a whole or not at all.
fn write_picture(path: &Path, image: &RgbaImage) -> anyhow::Result<()> {
    let cannot = || format!("{} cannot be written", path.display());
    let format = PictureFormat::of_name(path)?;
    let mut bytes = Cursor::new(Vec::new());
    encode_picture(format, image, &mut bytes).with_context(cannot)?;
    write_whole(path, bytes.get_ref()).with_context(cannot)
}
