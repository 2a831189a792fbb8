//! Ground truth of a frame: its kind, and its image from a viewpoint.

use super::variants::BACKGROUND;
use crate::bench::truth_cache::TruthCache;
use crate::render::truth::{Disks, RayTraced, TracedMesh, Truth, TruthKey, TruthView};
use crate::scene::{Background, Camera, Lighting, PhysicalLight, Primitive, Scene, Style};
use crate::sequence::{PrepareCounters, PreparedFrame, Shape, complete};
use glam::DVec3;
use std::cell::OnceCell;

/// Share of the vertices of a mesh that belong to a triangle, from which its triangles are the surface of all points.
const MIN_MESHED_SHARE: f64 = 0.9;

/// Source of a ground truth, from the most to the least independent of the points that are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::bench::suites) enum TruthKind {
    /// The shape that the points were sampled from.
    Formula,
    /// The triangles of the file.
    Mesh,
    /// The ellipses of the file: Gaussian splats.
    FileEllipses,
    /// Disks of all points, where only a part is drawn.
    DenseTwin,
    /// Disks of the drawn points: the last resort, as they share the deficiencies of the points.
    OwnDisks,
}

/// Light on a ground truth: the light of the modes compared with it.
#[derive(Debug, Clone)]
pub(in crate::bench::suites) struct TruthLight {
    /// Evaluated at each pixel.
    pub(in crate::bench::suites) lighting: Lighting,
    /// The material and the environment, where that is physical.
    pub(in crate::bench::suites) physical: Option<PhysicalLight>,
}

/// Ground truth of a frame.
pub(in crate::bench::suites) struct FrameTruth {
    kind: TruthKind,
    shape: Option<Shape>,
    /// All points, with their triangles or ellipses.
    frame: PreparedFrame,
    /// Made for the first view that is not in the cache.
    mesh: OnceCell<TracedMesh>,
    /// Scene units; of disks each has its own.
    tolerance: f64,
}

impl TruthKind {
    /// Its name in reports.
    pub(in crate::bench::suites) fn name(self) -> &'static str {
        match self {
            Self::Formula => "formula",
            Self::Mesh => "mesh",
            Self::FileEllipses => "ellipses of the file",
            Self::DenseTwin => "dense twin",
            Self::OwnDisks => "own disks",
        }
    }

    /// Description for the notes of a report.
    pub(super) fn described(self) -> &'static str {
        match self {
            Self::Formula => "the shape that the points were sampled from (formula)",
            Self::Mesh => "the triangles of the file, seen from both sides (mesh)",
            Self::FileEllipses => "the splats of the file (ellipses of the file)",
            Self::DenseTwin => "disks of all points, of which a part is drawn (dense twin)",
            Self::OwnDisks => {
                "the disks of the same points (own disks): errors are distances from the program's own idea of the \
                 surface; a mesh, or --subsample, is a truth from outside"
            }
        }
    }
}

impl FrameTruth {
    /// The best known truth of `whole`; `drawn` is all of it or a part. Estimated ellipses are not a truth: they follow
    /// from the points.
    pub(in crate::bench::suites) fn new(shape: Option<Shape>, whole: &PreparedFrame, drawn: &PreparedFrame) -> Self {
        let kind = if shape.is_some() {
            TruthKind::Formula
        } else if is_meshed(whole) {
            TruthKind::Mesh
        } else if whole.frame.ellipses().is_some() {
            TruthKind::FileEllipses
        } else if drawn.points.len() < whole.points.len() {
            TruthKind::DenseTwin
        } else {
            TruthKind::OwnDisks
        };
        let frame = match kind {
            TruthKind::FileEllipses => {
                let of_ellipses = Style::default().with(|style| style.primitive = Primitive::Ellipse);
                complete(whole, &Scene::needs(&of_ellipses), &PrepareCounters::default())
            }
            _ => whole.clone(),
        };
        let shapes = drawn.shapes.as_deref().map_or(&[][..], Vec::as_slice);
        let radii = shapes.iter().map(|shape| f64::from(shape.radius));
        Self {
            kind,
            shape,
            frame,
            mesh: OnceCell::new(),
            tolerance: 2.0 * radii.sum::<f64>() / shapes.len().max(1) as f64,
        }
    }

    pub(in crate::bench::suites) fn kind(&self) -> TruthKind {
        self.kind
    }

    /// The truth from `camera`, lit at each sample.
    pub(in crate::bench::suites) fn seen(
        &self,
        cache: &TruthCache,
        origin: DVec3,
        camera: &Camera,
        size_px: [u32; 2],
        light: &TruthLight,
    ) -> Truth {
        let view = TruthView::new(camera, origin, size_px, light.lighting, Background::solid(BACKGROUND));
        let view = match &light.physical {
            Some(physical) => view.with_physical_light(physical.clone()),
            None => view,
        };
        let tolerance = self.tolerance;
        if let Some(shape) = self.shape {
            let traced = RayTraced {
                shape,
                cull_back_faces: true,
            };
            let key = TruthKey::of_shape(traced, &view, tolerance);
            return cache.get(&key, || Truth::of_shape(traced, &view, tolerance));
        }
        let records = self.frame.triangles().filter(|_| self.kind == TruthKind::Mesh);
        if let Some(records) = records {
            let traced = || self.mesh.get_or_init(|| TracedMesh::new(records.clone()));
            let key = TruthKey::of_mesh(records, &view, tolerance);
            return cache.get(&key, || Truth::of_mesh(traced(), &view, tolerance));
        }
        let disks = Disks {
            points: &self.frame.points,
            shapes: self.frame.shapes.as_deref().map_or(&[][..], Vec::as_slice),
            are_ellipses: self.frame.has_ellipses,
            cull_back_faces: true,
        };
        cache.get(&TruthKey::of_disks(disks, &view), || Truth::of_disks(&disks, &view))
    }
}

/// Returns true if nearly all vertices belong to triangles. The few others lie on the surface, as those that the
/// makers of a mesh removed faces from, or are outliers.
fn is_meshed(frame: &PreparedFrame) -> bool {
    let Some(records) = frame.triangles() else {
        return false;
    };
    let lone = records.triangles.iter().filter(|record| record.is_point()).count();
    lone as f64 <= (1.0 - MIN_MESHED_SHARE) * records.vertices.len() as f64
}
