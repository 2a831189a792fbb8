//! Scenes whose change from image to image is known.

use crate::bench::BenchError;
use crate::bench::run::Run;
use crate::bench::subject::Subject;
use crate::bench::suites::error::truths::{FrameTruth, TruthLight};
use crate::bench::suites::error::with_triangles;
use crate::bench::truth_cache::TruthCache;
use crate::cloud::{CloudError, Frame, Positions, RawCloud};
use crate::scene::{Camera, Lighting, Scene, Style};
use crate::sequence::{Needs, PrepareCounters, PreparedFrame, Shape, prepare};
use glam::DVec3;
use image::RgbaImage;
use std::sync::Arc;

/// Steps from image to image in each scene.
const STEPS: usize = 4;

/// Turn of the camera from image to image, degrees.
const TURN_DEG: f64 = 0.5;

/// Motion of a shape from image to image, in spacings of its points along each axis: parts of a cell of any octree, and
/// in no direction that an axis has.
const MOTION_IN_SPACINGS: DVec3 = DVec3::new(0.31, 0.23, -0.17);

/// Share of the points that playback falls back on when there is no time for more.
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
    /// Consecutive frames of a sequence, of which no truth is known.
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

/// The images of a scene from each viewpoint, or why there are none.
pub(super) fn pictures(
    run: &mut Run<'_>,
    cache: &TruthCache,
    subject: &Subject<'_>,
    kind: SceneKind,
) -> Result<Result<Pictures, String>, BenchError> {
    let first = subject.chosen[0];
    let needs = Scene::needs(&Style::default());
    let frame = match run.load(subject, first, 1, &needs)? {
        Ok(frame) => with_triangles(run, subject, frame)?,
        Err(reason) => return Ok(Err(reason)),
    };
    let cameras = subject.views(&frame, run.options.viewpoints, 1.0);
    let builder = Builder {
        cache,
        subject,
        frame: &frame,
        truth: FrameTruth::new(subject.shape, &frame, &frame),
        needs: &needs,
        viewport_px: run.options.viewport_px,
    };
    let mut views = Vec::new();
    for camera in cameras {
        run.check_cancelled()?;
        views.push(match (kind, subject.shape) {
            (SceneKind::NextFrames, _) => match builder.next_frames(run, first, camera)? {
                Ok(pictures) => pictures,
                Err(reason) => return Ok(Err(reason)),
            },
            (SceneKind::CameraTurns, _) | (_, None) => builder.turns(camera),
            (SceneKind::ShapeMoves, Some(shape)) => builder.moves(shape, camera)?,
            (SceneKind::OnePointMoves, Some(shape)) => {
                builder.at_rest(camera, |step| one_moves(shape, &frame, step))?
            }
            (SceneKind::SampledAgain, Some(shape)) => {
                builder.at_rest(camera, |step| shape.scan(frame.points.len(), step))?
            }
            (SceneKind::SampledAgainByFewer, Some(shape)) => {
                let mut pictures = builder.at_rest(camera, |step| shape.scan(frame.points.len(), step))?;
                for picture in &mut pictures {
                    let (sample, _) = picture.frame.frame.sample(frame.points.len() / FALLBACK_SHARE)?;
                    picture.frame = builder.prepared(sample);
                }
                pictures
            }
        });
    }
    Ok(Ok(Pictures {
        truth: kind.truth(&builder.truth),
        views,
    }))
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

struct Builder<'a> {
    cache: &'a TruthCache,
    subject: &'a Subject<'a>,
    frame: &'a PreparedFrame,
    truth: FrameTruth,
    needs: &'a Needs,
    viewport_px: [u32; 2],
}

impl Builder<'_> {
    fn prepared(&self, frame: Frame) -> PreparedFrame {
        let counters = PrepareCounters::default();
        prepare(self.frame.index, Arc::new(frame), 0.0, self.needs, &counters)
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

    /// The camera and the shape at rest.
    fn at_rest(&self, camera: Camera, cloud: impl Fn(u32) -> RawCloud) -> Result<Vec<Picture>, CloudError> {
        let picture = |step| {
            let frame = Frame::from_raw(without_normals(cloud(step)), self.subject.sequence.origin())?;
            Ok(Picture {
                frame: self.prepared(frame),
                camera,
                truth: None,
            })
        };
        (0..=STEPS as u32).map(picture).collect()
    }

    /// The camera at rest: the truth is that of a camera that moves the other way.
    fn moves(&self, shape: Shape, camera: Camera) -> Result<Vec<Picture>, CloudError> {
        let count = self.frame.points.len();
        let step_in_scene = MOTION_IN_SPACINGS * f64::from(shape.spacing(count));
        let picture = |step| {
            let moved = step_in_scene * step as f64;
            // Subtracted in f64, before positions become f32.
            let frame = Frame::from_raw(without_normals(shape.scan(count, 0)), -moved)?;
            let seen_from = Camera {
                target_in_world: camera.target_in_world - moved,
                ..camera
            };
            Ok(Picture {
                frame: self.prepared(frame),
                camera,
                truth: Some(self.truth(seen_from)),
            })
        };
        (0..=STEPS).map(picture).collect()
    }

    fn turns(&self, camera: Camera) -> Vec<Picture> {
        let picture = |step| {
            let camera = Camera {
                azimuth_deg: camera.azimuth_deg + TURN_DEG * step as f64,
                ..camera
            };
            Picture {
                frame: self.frame.clone(),
                camera,
                truth: Some(self.truth(camera)),
            }
        };
        (0..=STEPS).map(picture).collect()
    }

    /// Frames from `first` on.
    fn next_frames(
        &self,
        run: &mut Run<'_>,
        first: usize,
        camera: Camera,
    ) -> Result<Result<Vec<Picture>, String>, BenchError> {
        let mut pictures = Vec::new();
        for index in (first..self.subject.sequence.len()).take(STEPS + 1) {
            match run.load(self.subject, index, 1, self.needs)? {
                Ok(frame) => pictures.push(Picture {
                    frame,
                    camera,
                    truth: None,
                }),
                Err(reason) => return Ok(Err(reason)),
            }
        }
        Ok(Ok(pictures))
    }
}

/// A scan: normals have to be estimated, as most files have none.
fn without_normals(mut cloud: RawCloud) -> RawCloud {
    cloud.attributes.normals = None;
    cloud
}
