//! A cloud that images are generated from, and renderings of it compared with the ground truth.

use super::backgrounds::is_covered;
use super::columns::row;
use crate::bench::report::{Cell, Row};
use crate::bench::run::{COVERAGE_BACKGROUNDS, Run};
use crate::bench::runner::Runner;
use crate::bench::statistics::mean;
use crate::bench::truth_cache::TruthCache;
use crate::bench::{BenchError, Quantiles};
use crate::cloud::CloudError;
use crate::composition::{PictureView, packet};
use crate::measure::{flip, mean_squared_error, psnr_db};
use crate::render::truth::{Disks, Truth, TruthKey, TruthView};
use crate::scene::{Background, Camera, FirstLook, Lighting, Scene, ScenePacket, Style};
use crate::sequence::{PrepareCounters, PreparedFrame, prepare};
use glam::DVec3;
use image::RgbaImage;
use std::sync::Arc;

/// A cloud without images, and its render style.
pub(super) struct MultiView<'a> {
    pub(super) name: &'a str,
    /// All of its points.
    pub(super) frame: &'a PreparedFrame,
    pub(super) origin: DVec3,
    pub(super) look: &'a FirstLook,
    pub(super) style: Style,
}

/// A frame of a cloud, and how it is drawn.
#[derive(Clone, Copy)]
pub(super) struct StyledFrame<'a> {
    pub(super) frame: &'a PreparedFrame,
    pub(super) style: &'a Style,
}

impl MultiView<'_> {
    /// At most `max_points` of its points, evenly sampled.
    pub(super) fn few(&self, max_points: usize) -> Result<PreparedFrame, CloudError> {
        let (few, _) = self.frame.frame.sample(max_points)?;
        let needs = Scene::needs(&self.style);
        Ok(prepare(
            self.frame.index,
            Arc::new(few),
            0.0,
            &needs,
            &PrepareCounters::default(),
        ))
    }

    /// Builds the scene packet of one of its frames.
    pub(super) fn packet(
        &self,
        drawn: StyledFrame<'_>,
        camera: &Camera,
        background: [u8; 3],
        size_px: [u32; 2],
    ) -> ScenePacket {
        let StyledFrame { frame, style } = drawn;
        let style = style.with(|style| style.backdrop.background = Background::solid(background));
        let view = PictureView {
            camera,
            origin: self.origin,
            size_px,
        };
        packet(&mut Scene::default(), frame, &view, &style)
    }
}

/// A view with known truth.
pub(super) struct TrueView {
    camera: Camera,
    picture: RgbaImage,
    /// Mask of the pixels where the image shows the object.
    is_object: Vec<bool>,
}

/// Errors of the rendered images of several views against the ground truth.
#[derive(Default)]
pub(super) struct Errors {
    squared: Vec<f64>,
    flip: Vec<f64>,
    extra: Vec<f64>,
    holes: Vec<f64>,
}

impl TrueView {
    /// Renders the ground truth from all points, as unlit disks: see [`Truth`].
    pub(super) fn new(cache: &TruthCache, multiview: &MultiView<'_>, camera: Camera, size_px: [u32; 2]) -> Self {
        let background = Background::solid(COVERAGE_BACKGROUNDS[0]);
        let view = TruthView::new(&camera, multiview.origin, size_px, Lighting::Unlit, background);
        let frame = multiview.frame;
        let disks = Disks {
            points: &frame.points,
            shapes: frame.shapes.as_deref().map_or(&[][..], Vec::as_slice),
            are_ellipses: frame.has_ellipses,
            cull_back_faces: true,
        };
        let truth = cache.get(&TruthKey::of_disks(disks, &view), || Truth::of_disks(&disks, &view));
        Self {
            camera,
            picture: truth.image,
            is_object: truth.depth.depth.iter().map(|depth| depth.is_finite()).collect(),
        }
    }

    fn size_px(&self) -> [u32; 2] {
        self.picture.dimensions().into()
    }
}

impl Errors {
    /// Measures the errors of a frame's rendered images in these views.
    pub(super) fn of(
        run: &Run<'_>,
        runner: &mut Runner,
        multiview: &MultiView<'_>,
        drawn: StyledFrame<'_>,
        views: &[TrueView],
    ) -> Result<Self, BenchError> {
        let mut errors = Self::default();
        for view in views {
            run.check_cancelled()?;
            let [dark, bright] = COVERAGE_BACKGROUNDS
                .map(|background| multiview.packet(drawn, &view.camera, background, view.size_px()));
            let (dark, bright) = (runner.image(&dark)?, runner.image(&bright)?);
            errors.add(view, &dark, &bright)?;
        }
        Ok(errors)
    }

    /// Adds the errors over the pixels that show something, in the truth or in the image. The others are black in both.
    fn add(&mut self, view: &TrueView, dark: &RgbaImage, bright: &RgbaImage) -> Result<(), BenchError> {
        let pixels = dark.pixels().zip(bright.pixels());
        let covered: Vec<bool> = pixels.map(|(dark, bright)| is_covered(*dark, *bright)).collect();
        let count = |is: &dyn Fn(usize) -> bool| (0..covered.len()).filter(|&pixel| is(pixel)).count() as f64;
        let is_object = &view.is_object;
        let shown = count(&|pixel| covered[pixel] || is_object[pixel]).max(1.0);
        let object = count(&|pixel| is_object[pixel]).max(1.0);
        let squared = mean_squared_error(&view.picture, dark)?;
        self.squared.push(squared * covered.len() as f64 / shown);
        let errors = flip(&view.picture, dark)?;
        self.flip
            .push(errors.mean_where(|pixel| covered[pixel] || is_object[pixel]));
        self.extra
            .push(count(&|pixel| covered[pixel] && !is_object[pixel]) / object);
        self.holes
            .push(count(&|pixel| !covered[pixel] && is_object[pixel]) / object);
        Ok(())
    }

    fn cells(&self) -> Vec<(&'static str, Cell)> {
        let psnr = psnr_db(mean(&self.squared));
        vec![
            ("extra_share", Cell::Number(mean(&self.extra))),
            ("hole_share", Cell::Number(mean(&self.holes))),
            ("psnr_db", Cell::maybe(psnr.is_finite().then_some(psnr))),
            ("flip", Cell::Number(mean(&self.flip))),
        ]
    }

    /// A row with these errors and times.
    pub(super) fn row(&self, table: &str, cells: Vec<(&'static str, Cell)>, times_ms: &[f64]) -> Row {
        let times = Quantiles::of(times_ms);
        let times = [
            ("ms", Cell::maybe(times.map(|times| times.median))),
            ("ms_q3", Cell::maybe(times.map(|times| times.q3))),
        ];
        let cells: Vec<_> = cells.into_iter().chain(self.cells()).chain(times).collect();
        row(table, &cells)
    }
}

/// Measures the draw times of a frame's images in these views, at the requested size.
pub(super) fn times_ms(
    run: &Run<'_>,
    runner: &mut Runner,
    multiview: &MultiView<'_>,
    drawn: StyledFrame<'_>,
    views: &[TrueView],
) -> Result<Vec<f64>, BenchError> {
    let size_px = run.options.viewport_px;
    let packets: Vec<ScenePacket> = views
        .iter()
        .map(|view| multiview.packet(drawn, &view.camera, COVERAGE_BACKGROUNDS[0], size_px))
        .collect();
    let mut times_ms = Vec::new();
    for round in 0..run.options.warmup + run.options.repeat {
        for packet in &packets {
            run.check_cancelled()?;
            let time = runner.draw(packet)?;
            if round >= run.options.warmup {
                times_ms.push(time.wall_ms);
            }
        }
    }
    Ok(times_ms)
}
