//! Table 2 of Yang et al. 2006 with the data available here: bytes compared with errors and times, for a few points
//! with view-dependent texturing and for many without.
//!
//! How it works: points are counted as a sequence file of them, images as JPEG files, as in the paper. The ground truth
//! shows all points as disks in f64; images were generated from the same points by the software renderer, and the
//! images of the compared views are held out.

use super::columns::SIZES;
use super::multiview::{Errors, MultiView, StyledFrame, TrueView, times_ms};
use crate::bench::BenchError;
use crate::bench::report::{Cell, Row};
use crate::bench::run::Run;
use crate::bench::runner::Runner;
use crate::cloud::{Attributes, Frame, Positions, RawCloud};
use crate::photos::{PhotoImage, PosedImages};
use crate::reel::{NewFrame, ReelOptions, write_to_memory};
use crate::scene::PhotoMode;
use crate::sequence::PreparedFrame;
use glam::Vec3;
use image::ExtendedColorType;
use image::codecs::jpeg::JpegEncoder;
use std::sync::Arc;

/// Maximum number of splats without images, as in the paper.
const MAX_SPLATS: usize = 1_000_000;

/// The paper says "high".
const JPEG_QUALITY: u8 = 90;

/// Rows of [`measure`], each a step.
pub(super) const STEPS: usize = 4;

/// Measures a few points without images, the same with them, and many points.
pub(super) fn measure(
    run: &mut Run<'_>,
    runner: &mut Runner,
    multiview: &MultiView<'_>,
    few: &PreparedFrame,
    used: &Arc<PosedImages>,
    views: &[TrueView],
) -> Result<Vec<Row>, BenchError> {
    let point_bytes = bytes_of_points(&few.frame)?;
    let pictures = used.all().iter().map(|posed_image| &posed_image.texture.levels()[0]);
    let photo_bytes: Option<usize> = pictures.map(bytes_of_picture).sum();
    let textured = few.with_photos(Arc::clone(used));
    let mut rows = Vec::new();
    for mode in [PhotoMode::Vdts, PhotoMode::Single, PhotoMode::Colored] {
        run.begin_step(format!("{}: {mode} by size", multiview.name))?;
        let has_photos = mode != PhotoMode::Colored;
        let (posed_images, photo_bytes) = if has_photos {
            (used.all().len(), photo_bytes)
        } else {
            (0, Some(0))
        };
        let style = multiview.style.with(|style| style.photos.mode = mode);
        let bytes = photo_bytes.map(|photos| (point_bytes + photos) as f64);
        let cells = cells(multiview.name, mode.name(), few, posed_images, bytes);
        let textured = StyledFrame {
            frame: &textured,
            style: &style,
        };
        rows.push(ViewSamples::of(run, runner, multiview, textured, views)?.row(cells));
    }
    run.begin_step(format!("{}: splats by size", multiview.name))?;
    let splats = multiview.few(MAX_SPLATS)?;
    let bytes = Some(bytes_of_points(&splats.frame)? as f64);
    let cells = cells(multiview.name, "splats", &splats, 0, bytes);
    let splats = StyledFrame {
        frame: &splats,
        style: &multiview.style,
    };
    rows.push(ViewSamples::of(run, runner, multiview, splats, views)?.row(cells));
    Ok(rows)
}

struct ViewSamples {
    errors: Errors,
    times_ms: Vec<f64>,
}

impl ViewSamples {
    fn of(
        run: &Run<'_>,
        runner: &mut Runner,
        multiview: &MultiView<'_>,
        drawn: StyledFrame<'_>,
        views: &[TrueView],
    ) -> Result<Self, BenchError> {
        Ok(Self {
            errors: Errors::of(run, runner, multiview, drawn, views)?,
            times_ms: times_ms(run, runner, multiview, drawn, views)?,
        })
    }

    fn row(&self, cells: Vec<(&'static str, Cell)>) -> Row {
        self.errors.row(SIZES, cells, &self.times_ms)
    }
}

fn cells(
    name: &str,
    mode: &str,
    frame: &PreparedFrame,
    posed_images: usize,
    bytes: Option<f64>,
) -> Vec<(&'static str, Cell)> {
    vec![
        ("sequence", Cell::Text(name.to_owned())),
        ("mode", Cell::Text(mode.to_owned())),
        ("points", Cell::Number(frame.frame.len() as f64)),
        ("photographs", Cell::Number(posed_images as f64)),
        ("bytes", Cell::maybe(bytes)),
    ]
}

/// As a sequence file with the points of each cell merged.
fn bytes_of_points(frame: &Frame) -> Result<usize, BenchError> {
    let positions = frame.positions().iter().map(Vec3::to_array).collect();
    let cloud = RawCloud {
        attributes: Attributes {
            colors: frame.colors().map(<[_]>::to_vec),
            normals: frame
                .normals()
                .map(|normals| normals.iter().map(Vec3::to_array).collect()),
            ..Attributes::default()
        },
        ..RawCloud::from_positions(Positions::F32(positions))
    };
    let frame = NewFrame {
        cloud: &cloud,
        name: "",
        time: None,
    };
    Ok(write_to_memory(&[frame], &ReelOptions::merged())?.len())
}

/// As a JPEG file; `None` where none can be written.
fn bytes_of_picture(picture: &PhotoImage) -> Option<usize> {
    let [width, height] = picture.size_px();
    let pixels = picture
        .pixels()
        .iter()
        .flat_map(|&[red, green, blue, _]| [red, green, blue]);
    let pixels: Vec<u8> = pixels.collect();
    let mut bytes = Vec::new();
    let mut encoder = JpegEncoder::new_with_quality(&mut bytes, JPEG_QUALITY);
    encoder.encode(&pixels, width, height, ExtendedColorType::Rgb8).ok()?;
    Some(bytes.len())
}
