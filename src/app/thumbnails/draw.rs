//! One picture of a frame, by the software renderer, from some of its points.

use super::PICTURE_PX;
use crate::cloud::{PointRecord, even_places};
use crate::math::Aabb;
use crate::progress::Progress;
use crate::render::cpu::CpuRenderer;
use crate::render::{RenderError, Renderer as _};
use crate::scene::{Background, Camera, Primitive, ScenePacket, Settings, UpAxis};
use crate::sequence::{
    ColorHints, Coloring, Detail, FrameError, Needs, PrepareCounters, PreparedFrame, Sequence,
    prepare,
};
use egui::ColorImage;
use glam::{DVec3, Vec3};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

/// Points that a picture is drawn from, at most: about one a pixel.
const MAX_POINTS: usize = 1 << 14;

/// Behind the points.
const BACKGROUND: Background = Background {
    top: [24, 27, 34],
    bottom: [24, 27, 34],
};

/// How much of the picture the box of the sequence fills.
const FILLED: f64 = 0.94;

/// From where pictures are made.
#[derive(Debug)]
pub(super) enum Material {
    /// A frame in memory, in full or not.
    Resident(Arc<PreparedFrame>),
    /// The file of this frame.
    File(usize),
}

/// What is made of it.
#[derive(Debug, Clone, Copy)]
pub(super) enum Task {
    /// What holds the points.
    Survey,
    /// The picture from here.
    Draw(Camera),
}

/// One piece of work.
#[derive(Debug)]
pub(super) struct Job {
    pub(super) material: Material,
    pub(super) task: Task,
    pub(super) colors: (Coloring, ColorHints),
    pub(super) sequence: Arc<Sequence>,
}

/// What came of it.
#[derive(Debug)]
pub(super) enum Made {
    /// What holds the points, relative to the sequence's origin.
    Bounds(Aabb),
    /// The picture.
    Picture(ColorImage),
    /// The frame cannot be read or drawn.
    Broken,
}

impl Job {
    /// Does it. Whatever goes wrong is told of by whoever shows the frame; here it is a mark.
    pub(super) fn run(self) -> Made {
        let made = catch_unwind(AssertUnwindSafe(|| self.made()));
        made.ok().flatten().unwrap_or(Made::Broken)
    }

    fn made(&self) -> Option<Made> {
        let frame = match &self.material {
            Material::Resident(frame) => Arc::clone(frame),
            Material::File(index) => Arc::new(self.read(*index).ok()?),
        };
        Some(match &self.task {
            Task::Survey => Made::Bounds(frame.frame.bounds()),
            Task::Draw(camera) => Made::Picture(draw(&frame, camera, self.sequence.origin()).ok()?),
        })
    }

    /// As many points as a picture needs.
    fn read(&self, index: usize) -> Result<PreparedFrame, FrameError> {
        let loaded = self.sequence.load(
            index,
            Detail::at_most(MAX_POINTS as u32),
            &Progress::default(),
        )?;
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
    let packet = ScenePacket {
        viewport_px: PICTURE_PX,
        view: camera.transform(origin, PICTURE_PX),
        settings: Settings {
            primitive: Primitive::Point,
            point_size_px: point_size_px(points.len()),
            background: BACKGROUND,
            ..Settings::default()
        },
        points,
        shapes: None,
        voxels: None,
        coded: None,
        ground: None,
        bounds: frame.frame.bounds(),
    };
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

/// The view that all pictures of a sequence are seen from: all of `bounds`, as large as it gets.
pub(super) fn view_of(bounds: &Aabb, origin: DVec3, up: UpAxis) -> Camera {
    let mut camera = Camera::framing(bounds, origin, up);
    if bounds.radius() <= 0.0 {
        return camera;
    }
    // The bounding sphere is framed, so it is never to be seen from farther away. From nearer corners reach farther.
    let mut near = 0.01 * camera.distance;
    for _ in 0..20 {
        let distance = (near * camera.distance).sqrt();
        let nearer = Camera { distance, ..camera };
        if reach(&nearer, bounds, origin) <= FILLED {
            camera = nearer;
        } else {
            near = distance;
        }
    }
    camera
}

/// How far the corners of `bounds` are from the middle of the picture, 1 at its edges; infinite behind the eye.
fn reach(camera: &Camera, bounds: &Aabb, origin: DVec3) -> f64 {
    let half = glam::UVec2::from_array(PICTURE_PX).as_dvec2() / 2.0;
    let corners = (0..8).map(|corner| {
        let side = |axis: u32| (corner >> axis & 1) as f32;
        let place = Vec3::new(side(0), side(1), side(2));
        let place = bounds.min + place * bounds.extent();
        let px = camera.to_px(origin + place.as_dvec3(), PICTURE_PX);
        px.map_or(f64::INFINITY, |px| ((px - half) / half).abs().max_element())
    });
    corners.fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cloud::{Positions, RawCloud};
    use crate::sequence::{ColorSource, Source};
    use bytemuck::Zeroable as _;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_view_shows_the_whole_box_and_not_much_more(
            extent in prop::array::uniform3(0.0f32..50.0), far in -1e6f64..1e6, up in 0usize..6,
        ) {
            let extent = Vec3::from_array(extent);
            prop_assume!(extent.max_element() > 1e-3);
            let bounds = Aabb { min: -0.5 * extent, max: 0.5 * extent };
            let origin = DVec3::new(far, -far, 3.0);
            let camera = view_of(&bounds, origin, UpAxis::ALL[up].1);
            let reach = reach(&camera, &bounds, origin);
            prop_assert!((0.93..=0.96).contains(&reach), "{}", reach);
        }
    }

    fn job(material: Material, task: Task) -> Job {
        let decode = |source: &Source| match source.number {
            Some(0) => {
                let corners =
                    (0..8).map(|corner| [0, 1, 2].map(|axis| (corner >> axis & 1) as f32));
                let mut raw = RawCloud::from_positions(Positions::F32(corners.collect()));
                raw.colors = Some(vec![[255, 0, 0, 255]; 8]);
                Ok(raw)
            }
            Some(1) => Err("unread".into()),
            _ => panic!("a decoder that fails"),
        };
        let sources = (0..3).map(|number| Source {
            number: Some(number),
            ..Source::file(format!("{number}.ply"))
        });
        Job {
            material,
            task,
            colors: (Coloring::of(ColorSource::File), ColorHints::NONE),
            sequence: Arc::new(Sequence::with_decoder(sources.collect(), decode)),
        }
    }

    #[test]
    fn a_frame_is_drawn_from_its_file_and_broken_ones_are_marks() {
        let Made::Bounds(bounds) = job(Material::File(0), Task::Survey).run() else {
            panic!("no bounds");
        };
        assert_eq!((bounds.min, bounds.max), (Vec3::ZERO, Vec3::ONE));
        let camera = view_of(&bounds, DVec3::ZERO, UpAxis::Y);
        let Made::Picture(picture) = job(Material::File(0), Task::Draw(camera)).run() else {
            panic!("no picture");
        };
        let [red, behind] = [egui::Color32::RED, egui::Color32::from_rgb(24, 27, 34)];
        let count = |color| {
            picture
                .pixels
                .iter()
                .filter(|&&pixel| pixel == color)
                .count()
        };
        // Eight squares of nine pixels, those at the edge cut.
        assert!((300..=8 * 81).contains(&count(red)), "{}", count(red));
        assert_eq!(count(red) + count(behind), picture.pixels.len());
        for broken in [1, 2] {
            let made = job(Material::File(broken), Task::Draw(camera)).run();
            assert!(matches!(made, Made::Broken));
        }
    }

    #[test]
    fn of_many_points_some_are_drawn() {
        let points = Arc::new(vec![PointRecord::zeroed(); MAX_POINTS + 5]);
        assert_eq!(some_points(&points).len(), MAX_POINTS);
        let few = Arc::new(vec![PointRecord::zeroed(); 5]);
        assert!(Arc::ptr_eq(&some_points(&few), &few));
        assert_eq!(point_size_px(MAX_POINTS), 2.0);
    }
}
