//! Distortion of stored frames against the original: points, colours, normals, and the rendered image.
//!
//! How it works: points are compared by [`ReferenceCloud`]. The image is drawn by the software renderer as surfels with
//! the default settings, from views around the frame, of both clouds as a sequence would prepare them. FLIP is the mean
//! over the pixels that show one or the other. A pixel shows something unless it is the background colour on each of
//! two backgrounds.

use crate::bench::runner::Runner;
use crate::bench::subject::Subject;
use crate::bench::{BenchError, BenchOptions};
use crate::cloud::{Frame, RawCloud};
use crate::composition::{PictureView, packet};
use crate::measure::{CloudError, ErrorMap, PIXELS_PER_DEGREE, Perceived, ReferenceCloud};
use crate::render::AnyRenderer;
use crate::scene::{Background, Camera, Primitive, RendererChoice, Scene, Style};
use crate::sequence::{PrepareCounters, PreparedFrame, prepare};
use glam::DVec3;
use image::RgbaImage;
use std::sync::Arc;

/// Backgrounds that distinguish the pixels that show something: a grey of medium lightness, on which images are
/// compared, and white.
const BACKGROUNDS: [[u8; 3]; 2] = [[119; 3], [255; 3]];

/// The original, and its viewpoints.
pub(super) struct Judge {
    reference: ReferenceCloud,
    views: Vec<OriginalView>,
    runner: Runner,
    origin: DVec3,
    index: usize,
    size_px: [u32; 2],
}

/// The original from one side.
struct OriginalView {
    camera: Camera,
    perceived: Perceived,
    shows: Vec<bool>,
}

/// Distortion of a frame against the original.
pub(super) struct Distortion {
    pub(super) error: CloudError,
    /// Mean over all views, 0 to 1.
    pub(super) flip: f64,
    /// The first view, and its error.
    pub(super) first: Option<(RgbaImage, ErrorMap)>,
}

impl Judge {
    /// `cloud` is frame `index` of the sequence.
    pub(super) fn new(
        options: &BenchOptions,
        subject: &Subject<'_>,
        index: usize,
        cloud: &RawCloud,
    ) -> Result<Self, BenchError> {
        let origin = subject.sequence.origin();
        let invalid = |reason: String| BenchError::NoFrame {
            sequence: subject.name.to_owned(),
            reason,
        };
        let reference = ReferenceCloud::new(cloud).map_err(|reason| invalid(reason.to_string()))?;
        let reference = reference.with_planes().map_err(|reason| invalid(reason.to_string()))?;
        let mut judge = Self {
            reference,
            views: Vec::new(),
            runner: Runner::new(AnyRenderer::cpu()),
            origin,
            index,
            size_px: options.viewport_px,
        };
        let frame = judge.prepared(cloud)?;
        for camera in subject.views(&frame, options.viewpoints, 1.0) {
            let (image, shows) = judge.drawn(&frame, &camera)?;
            judge.views.push(OriginalView {
                camera,
                perceived: Perceived::of(&image, PIXELS_PER_DEGREE),
                shows,
            });
        }
        Ok(judge)
    }

    /// Holds `cloud`, in the coordinates of the file, against the original.
    pub(super) fn judge(&mut self, cloud: &RawCloud) -> Result<Distortion, BenchError> {
        let error = self.reference.compare(cloud)?;
        let frame = self.prepared(cloud)?;
        let views = std::mem::take(&mut self.views);
        let mut flip = 0.0;
        let mut first = None;
        for view in &views {
            let (image, shows) = self.drawn(&frame, &view.camera)?;
            let map = view.perceived.flip(&Perceived::of(&image, PIXELS_PER_DEGREE))?;
            flip += map.mean_where(|pixel| shows[pixel] || view.shows[pixel]) / views.len() as f64;
            first.get_or_insert((image, map));
        }
        self.views = views;
        Ok(Distortion { error, flip, first })
    }

    fn prepared(&self, cloud: &RawCloud) -> Result<PreparedFrame, BenchError> {
        let frame = Frame::from_raw(cloud.clone(), self.origin)?;
        let needs = Scene::needs(&style(BACKGROUNDS[0]));
        let counters = PrepareCounters::default();
        Ok(prepare(self.index, Arc::new(frame), 0.0, &needs, &counters))
    }

    /// The image, and a mask of the pixels that show the cloud.
    fn drawn(&mut self, frame: &PreparedFrame, camera: &Camera) -> Result<(RgbaImage, Vec<bool>), BenchError> {
        let mut scene = Scene::default();
        let view = PictureView {
            camera,
            origin: self.origin,
            size_px: self.size_px,
        };
        let mut on = |background: [u8; 3]| {
            let packet = packet(&mut scene, frame, &view, &style(background));
            self.runner.image(&packet)
        };
        let [image, on_white] = [on(BACKGROUNDS[0])?, on(BACKGROUNDS[1])?];
        let is_free =
            |on_grey: [u8; 4], on_white: [u8; 4]| on_grey[..3] == BACKGROUNDS[0] && on_white[..3] == BACKGROUNDS[1];
        let pixels = image.pixels().zip(on_white.pixels());
        let shows = pixels
            .map(|(on_grey, on_white)| !is_free(on_grey.0, on_white.0))
            .collect();
        Ok((image, shows))
    }
}

fn style(background: [u8; 3]) -> Style {
    Style::default().with(|style| {
        style.primitive = Primitive::Surfel;
        style.backdrop.background = Background::solid(background);
        style.drawing.renderer = RendererChoice::Cpu;
    })
}
