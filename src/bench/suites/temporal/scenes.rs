//! Scenes whose change from image to image is known.

use crate::bench::BenchError;
use crate::bench::run::Run;
use crate::bench::subject::Subject;
use crate::bench::suites::error::truths::{FrameTruth, TruthLight};
use crate::bench::suites::error::{turned, with_triangles};
use crate::bench::truth_cache::TruthCache;
use crate::cloud::{CloudError, Frame, Positions, RawCloud, Space};
use crate::scene::{Camera, Lighting, Scene, Style};
use crate::sequence::{Needs, PrepareCounters, PreparedFrame, Shape, prepare};
use glam::DVec3;
use image::RgbaImage;
use std::sync::Arc;

/// Steps from image to image in each scene.
const STEPS: usize = 4;

/// Motion of a shape from image to image, in spacings of its points along each axis: parts of a cell of any octree, and
/// in no direction that an axis has.
const MOTION_IN_SPACINGS: DVec3 = DVec3::new(0.31, 0.23, -0.17);

/// Share of the points that playback falls back to when time is short.
const FALLBACK_SHARE: usize = 4;

/// Distance of the moving point from the centre of the shape, in radii: outside of every image of the shape.
const FAR_IN_RADII: f32 = 6.0;

/// Kind of scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum SceneKind {
    /// A shape at rest, and one point far from it, outside of the image, that moves.
    OnePointMoves,
    /// A shape at rest that is scanned again for every frame.
    SampledAgain,
    /// [`SceneKind::SampledAgain`] in the sample that playback falls back on.
    SampledAgainByFewer,
    /// A shape that moves with its points.
    ShapeMoves,
    /// A frame around which the camera turns.
    CameraTurns,
    /// Consecutive frames of a sequence, without a known truth.
    NextFrames,
}

/// The images of a scene.
pub(super) struct Pictures {
    /// Source of the ground truth.
    pub(super) truth: &'static str,
    /// In the order of time, from each viewpoint.
    pub(super) views: Vec<Vec<Picture>>,
}

/// One image of a scene, and the truth of it where it is not at rest.
pub(super) struct Picture {
    pub(super) frame: PreparedFrame,
    pub(super) camera: Camera,
    pub(super) truth: Option<RgbaImage>,
}

impl SceneKind {
    /// Kinds of scene that a subject has.
    pub(super) fn of(subject: &Subject<'_>) -> Vec<Self> {
        let of_shapes = [
            Self::OnePointMoves,
            Self::SampledAgain,
            Self::SampledAgainByFewer,
            Self::ShapeMoves,
        ];
        let mut kinds = Vec::new();
        kinds.extend(of_shapes.into_iter().filter(|_| subject.shape.is_some()));
        kinds.push(Self::CameraTurns);
        kinds.extend(Some(Self::NextFrames).filter(|_| subject.sequence.len() > 1));
        kinds
    }

    /// Name in the report.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::OnePointMoves => "one point moves",
            Self::SampledAgain => "sampled again",
            Self::SampledAgainByFewer => "sampled again, a quarter of the points",
            Self::ShapeMoves => "shape moves",
            Self::CameraTurns => "camera turns",
            Self::NextFrames => "next frames, motion included",
        }
    }

    /// Source of the ground truth, in reports.
    fn truth(self, of_frame: &FrameTruth) -> &'static str {
        match self {
            Self::OnePointMoves | Self::SampledAgain | Self::SampledAgainByFewer => "at rest",
            Self::ShapeMoves | Self::CameraTurns => of_frame.kind().name(),
            Self::NextFrames => "none",
        }
    }
}

/// Scenes of one sequence.
pub(super) struct Scenes<'a> {
    cache: &'a TruthCache,
    subject: &'a Subject<'a>,
    /// The first frame, with the triangles of its file.
    frame: PreparedFrame,
    truth: FrameTruth,
    cameras: Vec<Camera>,
    needs: Needs,
    viewport_px: [u32; 2],
}

impl<'a> Scenes<'a> {
    /// Loads the first frame, or gives the reason why it cannot be measured.
    pub(super) fn new(
        run: &mut Run<'_>,
        cache: &'a TruthCache,
        subject: &'a Subject<'a>,
    ) -> Result<Result<Self, String>, BenchError> {
        let needs = Scene::needs(&Style::default());
        let frame = match run.load(subject, subject.chosen[0], 1, &needs)? {
            Ok(frame) => with_triangles(run, subject, frame)?,
            Err(reason) => return Ok(Err(reason)),
        };
        Ok(Ok(Self {
            cache,
            subject,
            truth: FrameTruth::new(subject.shape, &frame, &frame),
            cameras: subject.views(&frame, run.options.viewpoints, 1.0),
            frame,
            needs,
            viewport_px: run.options.viewport_px,
        }))
    }

    /// Points of the first frame.
    pub(super) fn point_count(&self) -> usize {
        self.frame.points.len()
    }

    /// The images of a scene from each viewpoint; none without frames that can be measured.
    pub(super) fn pictures(&self, run: &mut Run<'_>, kind: SceneKind) -> Result<Pictures, BenchError> {
        let count = self.frame.points.len();
        // Only for points that are the same from each viewpoint.
        let frames = match (kind, self.subject.shape) {
            (SceneKind::NextFrames, _) => self.next_frames(run)?,
            (SceneKind::CameraTurns, _) | (_, None) => vec![self.frame.clone(); STEPS + 1],
            (SceneKind::ShapeMoves, Some(shape)) => {
                // Subtracted in f64, before positions become f32.
                self.scans(|step| {
                    let space = Space {
                        origin: -self.moved(step),
                        ..self.subject.sequence.space()
                    };
                    Frame::from_raw(without_normals(shape.scan(count, 0)), space)
                })?
            }
            (SceneKind::OnePointMoves, Some(shape)) => {
                self.scans(|step| self.scanned(one_moves(shape, &self.frame, step)))?
            }
            (SceneKind::SampledAgain, Some(shape)) => self.scans(|step| self.scanned(shape.scan(count, step)))?,
            (SceneKind::SampledAgainByFewer, Some(shape)) => self.scans(|step| {
                let (sample, _) = self.scanned(shape.scan(count, step))?.sample(count / FALLBACK_SHARE)?;
                Ok(sample)
            })?,
        };
        let mut views = Vec::new();
        for &camera in &self.cameras {
            run.check_cancelled()?;
            let steps = frames.iter().zip(0..);
            views.push(
                steps
                    .map(|(frame, step)| self.picture(kind, frame, camera, step))
                    .collect(),
            );
        }
        Ok(Pictures {
            truth: kind.truth(&self.truth),
            views,
        })
    }

    /// Image `step` of a scene, by the camera of the first one.
    fn picture(&self, kind: SceneKind, frame: &PreparedFrame, camera: Camera, step: u32) -> Picture {
        let turned = turned(camera, step);
        // The truth of a moving shape equals that of a camera with the inverse motion.
        let followed = Camera {
            target_in_world: camera.target_in_world - self.moved(step),
            ..camera
        };
        let (camera, truth) = match kind {
            SceneKind::CameraTurns => (turned, Some(self.truth(turned))),
            SceneKind::ShapeMoves => (camera, Some(self.truth(followed))),
            SceneKind::OnePointMoves
            | SceneKind::SampledAgain
            | SceneKind::SampledAgainByFewer
            | SceneKind::NextFrames => (camera, None),
        };
        Picture {
            frame: frame.clone(),
            camera,
            truth,
        }
    }

    /// Offset of a shape that moves, scene units.
    fn moved(&self, step: u32) -> DVec3 {
        let spacing = self
            .subject
            .shape
            .map_or(0.0, |shape| shape.spacing(self.frame.points.len()));
        MOTION_IN_SPACINGS * f64::from(spacing) * f64::from(step)
    }

    /// A frame of points without normals, in the space of the sequence.
    fn scanned(&self, cloud: RawCloud) -> Result<Frame, CloudError> {
        Frame::from_raw(without_normals(cloud), self.subject.sequence.space())
    }

    fn scans(&self, scan: impl Fn(u32) -> Result<Frame, CloudError>) -> Result<Vec<PreparedFrame>, CloudError> {
        let counters = PrepareCounters::default();
        let prepared = |step| {
            let frame = Arc::new(scan(step)?);
            Ok(prepare(self.frame.index, frame, 0.0, &self.needs, &counters))
        };
        (0..=STEPS as u32).map(prepared).collect()
    }

    /// Consecutive frames from the first one on; none if one of them cannot be measured, which a note of the report
    /// names.
    fn next_frames(&self, run: &mut Run<'_>) -> Result<Vec<PreparedFrame>, BenchError> {
        let mut frames = vec![self.frame.clone()];
        let following = self.frame.index + 1..self.subject.sequence.len();
        for index in following.take(STEPS) {
            run.add_steps(1);
            match run.load(self.subject, index, 1, &self.needs)? {
                Ok(frame) => frames.push(frame),
                Err(_) => return Ok(Vec::new()),
            }
        }
        Ok(frames)
    }

    fn truth(&self, camera: Camera) -> RgbaImage {
        let light = TruthLight {
            lighting: Lighting::PerFragment,
            physical: None,
        };
        let origin = self.subject.sequence.origin();
        self.truth
            .seen(self.cache, origin, &camera, self.viewport_px, &light)
            .image
    }
}

/// The points of a shape, and one more on a circle around it.
fn one_moves(shape: Shape, frame: &PreparedFrame, step: u32) -> RawCloud {
    let mut cloud = shape.scan(frame.points.len(), 0);
    let (sin, cos) = (0.9 * step as f32).sin_cos();
    let radius = 0.5 * (frame.frame.bounds().max - frame.frame.bounds().min).length();
    let place = [cos, sin, 0.3 * cos].map(|along| FAR_IN_RADII * radius * along);
    if let Positions::F32(positions) = &mut cloud.positions {
        positions.push(place);
    }
    if let Some(colors) = &mut cloud.attributes.colors {
        colors.push([255; 4]);
    }
    if let Some(normals) = &mut cloud.attributes.normals {
        normals.push([0.0, 0.0, 1.0]);
    }
    cloud
}

/// A scan: normals have to be estimated, as most files have none.
fn without_normals(mut cloud: RawCloud) -> RawCloud {
    cloud.attributes.normals = None;
    cloud
}
