//! One thumbnail of a frame, by the software renderer, from some of its points.

use super::store::PICTURE_PX;
use crate::cloud::{PointRecord, even_places};
use crate::composition::{Drawn, PictureView, packet};
use crate::persist;
use crate::progress::Progress;
use crate::render::cpu::CpuRenderer;
use crate::render::{RenderError, Renderer as _};
use crate::scene::{Background, Camera, Content, Primitive, Scene, Style};
use crate::sequence::{
    ColorHints, Coloring, Detail, FrameError, Needs, PrepareCounters, PreparedFrame, Sequence, prepare,
};
use egui::ColorImage;
use glam::DVec3;
use image::{ImageFormat, RgbaImage};
use std::io::Cursor;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::Arc;

/// Max points of a thumbnail: about one per pixel.
const MAX_POINTS: usize = 1 << 14;

/// Behind the points.
const BACKGROUND: Background = Background {
    top: [24, 27, 34],
    bottom: [24, 27, 34],
};

/// Viewpoint of thumbnails.
#[derive(Debug)]
pub(super) enum Material {
    /// A frame in memory, in full or not.
    Resident(Arc<PreparedFrame>),
    /// The file of this frame.
    File(usize),
}

/// One piece of work.
#[derive(Debug)]
pub(super) struct ThumbnailJob {
    pub(super) material: Material,
    /// From where it is seen.
    pub(super) view: Camera,
    pub(super) colors: (Coloring, ColorHints),
    pub(super) sequence: Arc<Sequence>,
}

/// Outcome of a thumbnail job.
#[derive(Debug)]
pub(super) enum Thumbnail {
    /// The thumbnail.
    Picture(ColorImage),
    /// The frame cannot be read or drawn.
    Broken,
}

impl Thumbnail {
    /// Writes the thumbnail to a file; one that cannot be written is reported in the log.
    pub(super) fn keep(&self, file: &Path) {
        let Self::Picture(picture) = self else {
            return;
        };
        let [width, height] = picture.size.map(|edge| edge as u32);
        let bytes = picture.pixels.iter().flat_map(egui::Color32::to_srgba_unmultiplied);
        let Some(image) = RgbaImage::from_raw(width, height, bytes.collect()) else {
            return;
        };
        let mut png = Cursor::new(Vec::new());
        let written = image
            .write_to(&mut png, ImageFormat::Png)
            .map_err(std::io::Error::other)
            .and_then(|()| persist::replace(file, png.get_ref()));
        if let Err(reason) = written {
            log::warn!("the thumbnail {} could not be written ({reason})", file.display());
        }
    }
}

impl ThumbnailJob {
    /// Runs the job. Errors are reported by the viewport that shows the frame; here they are a mark.
    pub(super) fn run(self) -> Thumbnail {
        let made = catch_unwind(AssertUnwindSafe(|| self.made()));
        made.ok().flatten().unwrap_or(Thumbnail::Broken)
    }

    fn made(&self) -> Option<Thumbnail> {
        let frame = match &self.material {
            Material::Resident(frame) => Arc::clone(frame),
            Material::File(index) => Arc::new(self.read(*index).ok()?),
        };
        let picture = draw(&frame, &self.view, self.sequence.origin()).ok()?;
        Some(Thumbnail::Picture(picture))
    }

    /// Reads the number of points that a thumbnail needs.
    fn read(&self, index: usize) -> Result<PreparedFrame, FrameError> {
        let loaded = self
            .sequence
            .load(index, Detail::at_most(MAX_POINTS as u32), &Progress::default())?;
        let needs = Needs {
            colors: self.colors.0,
            hints: self.colors.1,
            ..Needs::default()
        };
        let frame = Arc::new(loaded.frame);
        Ok(prepare(
            index,
            frame,
            loaded.decode_ms,
            &needs,
            &PrepareCounters::default(),
        ))
    }
}

fn draw(frame: &PreparedFrame, camera: &Camera, origin: DVec3) -> Result<ColorImage, RenderError> {
    let points = some_points(&frame.points);
    let style = Style::default().with(|style| {
        style.primitive = Primitive::Point;
        style.points.size_px = point_size_px(points.len());
        style.backdrop.background = BACKGROUND;
        style.backdrop.grid = false;
    });
    let view = PictureView {
        camera,
        origin,
        size_px: PICTURE_PX,
    };
    let mut packet = packet(&mut Scene::default(), Drawn::from(frame), &view, &style);
    packet.content = Content::Points(points);
    let mut renderer = CpuRenderer::new();
    renderer.prepare(&packet)?;
    renderer.render()?;
    let size = PICTURE_PX.map(|edge| edge as usize);
    Ok(ColorImage::from_rgba_unmultiplied(size, renderer.image()))
}

fn some_points(points: &Arc<Vec<PointRecord>>) -> Arc<Vec<PointRecord>> {
    if points.len() <= MAX_POINTS {
        return Arc::clone(points);
    }
    let places = even_places(points.len(), MAX_POINTS);
    Arc::new(places.into_iter().map(|place| points[place]).collect())
}

/// Few points are larger, so that they are seen.
fn point_size_px(count: usize) -> f32 {
    let pixels = PICTURE_PX[0] * PICTURE_PX[1];
    (pixels as f32 / count.max(1) as f32).sqrt().clamp(2.0, 9.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cloud::{Positions, RawCloud};
    use crate::math::Aabb;
    use crate::scene::UpAxis;
    use crate::sequence::{ColorSource, FrameEntry};
    use bytemuck::Zeroable as _;
    use glam::Vec3;

    /// A job for a cube from zero to one, or an unreadable frame.
    fn job(index: usize) -> ThumbnailJob {
        let decode = |source: &FrameEntry| match source.number {
            Some(0) => {
                let corners = (0..8).map(|corner| [0, 1, 2].map(|axis| (corner >> axis & 1) as f32));
                let mut raw = RawCloud::from_positions(Positions::F32(corners.collect()));
                raw.attributes.colors = Some(vec![[255, 0, 0, 255]; 8]);
                Ok(raw)
            }
            Some(1) => Err("unread".into()),
            _ => panic!("a decoder that fails"),
        };
        let sources = (0..3).map(|number| FrameEntry {
            number: Some(number),
            ..FrameEntry::file(format!("{number}.ply"))
        });
        let cube = Aabb {
            min: Vec3::ZERO,
            max: Vec3::ONE,
        };
        ThumbnailJob {
            material: Material::File(index),
            view: Camera::framing(&cube, DVec3::ZERO, UpAxis::Y),
            colors: (Coloring::of(ColorSource::File), ColorHints::NONE),
            sequence: Arc::new(Sequence::with_decoder(sources.collect(), decode)),
        }
    }

    #[test]
    fn thumbnails_are_drawn_from_files_and_broken_frames_are_marked() {
        let Thumbnail::Picture(picture) = job(0).run() else {
            panic!("no picture");
        };
        let [red, behind] = [egui::Color32::RED, egui::Color32::from_rgb(24, 27, 34)];
        let count = |color| picture.pixels.iter().filter(|&&pixel| pixel == color).count();
        // Eight squares of nine pixels, those at the edge clipped.
        assert!((300..=8 * 81).contains(&count(red)), "{}", count(red));
        assert_eq!(count(red) + count(behind), picture.pixels.len());
        for broken in [1, 2] {
            assert!(matches!(job(broken).run(), Thumbnail::Broken));
        }
    }

    #[test]
    fn large_clouds_are_drawn_from_a_sample() {
        let points = Arc::new(vec![PointRecord::zeroed(); MAX_POINTS + 5]);
        assert_eq!(some_points(&points).len(), MAX_POINTS);
        let few = Arc::new(vec![PointRecord::zeroed(); 5]);
        assert!(Arc::ptr_eq(&some_points(&few), &few));
        assert_eq!(point_size_px(MAX_POINTS), 2.0);
    }
}
