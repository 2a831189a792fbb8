//! The default primitive of a sequence.
//!
//! **How it works.** Triangles are a surface already. Disks show a surface where the points sample one: most places lie
//! in planes with their neighbours, the points are about equally far apart, and no disk is so wide that it hides the
//! rest. All else is points: turns of a LiDAR, aerial strips, sparse reconstructions, a handful of corners.

use super::CaptureKind;
use super::sample::{CloudSample, quantile};
use crate::math::Aabb;
use crate::scene::Primitive;
use glam::Vec3;

/// Points are drawn as surfels if this share of them lies in planes with their neighbours: for objects, and for ground,
/// which includes plants and gaps.
const SURFACE_SHARE: f32 = 0.4;
const GROUND_SHARE: f32 = 0.75;
/// Largest spacing spread of a surface: where sparse points are this many times as far apart as most, they would be
/// drawn as large disks that show no surface.
const MAX_SPREAD: f32 = 3.5;
/// Typical distance between points, as a share of the radius of the cloud, up to which disks look like a surface: the
/// fourth neighbour on a sphere of 3,300 points; on ground of 2,800, which has more detail.
const MAX_SPACING: f32 = 0.07;
const MAX_GROUND_SPACING: f32 = 0.03;
/// Widest distance of nearly all points: wider disks hide surfaces behind them.
const MAX_WIDE_SPACING: f32 = 0.3;
/// Disks of points that are this many times as far apart as most count as wide, and cover at most this share of all.
const WIDE: f32 = 3.0;
const MAX_WIDE_AREA: f32 = 0.2;

/// Minimum outlier count of a sparse reconstruction from images. Outliers have the widest disks of all. This many, in a
/// cloud with few enough points per outlier, indicate such a reconstruction.
const MANY_OUTLIERS: usize = 20;
const FEW_TO_EACH: usize = 50;

/// A cloud, and how it was captured.
pub(super) struct Captured<'a> {
    pub(super) kind: CaptureKind,
    pub(super) sample: &'a CloudSample,
    /// Number of sample points excluded as outliers.
    pub(super) outliers: usize,
    /// Without outliers.
    pub(super) trimmed: &'a Aabb,
    /// The place of the sensor.
    pub(super) eye: Vec3,
    pub(super) has_faces: bool,
    pub(super) are_splats: bool,
}

/// The primitive that shows the most, with the reason.
pub(super) fn choose(captured: &Captured<'_>) -> (Primitive, &'static str) {
    if captured.has_faces {
        return (Primitive::Mesh, "the file has triangles");
    }
    if let Some(why) = why_no_surface(captured) {
        return (Primitive::Point, why);
    }
    if captured.are_splats {
        (Primitive::Ellipse, "the file has the ellipses of splats")
    } else {
        (Primitive::Surfel, "the points sample a surface")
    }
}

/// The reason why disks would not look like a surface.
fn why_no_surface(captured: &Captured<'_>) -> Option<&'static str> {
    let Captured {
        kind, sample, trimmed, ..
    } = captured;
    let min_share = match kind {
        CaptureKind::Terrain => GROUND_SHARE,
        _ => SURFACE_SHARE,
    };
    if sample.planar_share < min_share || is_needle(trimmed) {
        return Some("the points are too sparse for a surface, or lie in lines or in a volume");
    }
    if *kind == CaptureKind::Sweep && !is_dense(sample, captured.eye) {
        return Some("the lines of the scanner are far apart");
    }
    // The ellipses of a file have their proper size.
    if captured.are_splats {
        return None;
    }
    let radius = trimmed.radius();
    let max_spacing = match kind {
        CaptureKind::Terrain => MAX_GROUND_SPACING,
        _ => MAX_SPACING,
    };
    let is_wide = |share: f64, max: f32| quantile(&mut sample.spacing.clone(), share) > max * radius;
    if is_wide(0.5, max_spacing) || is_wide(0.99, MAX_WIDE_SPACING) {
        return Some("there are too few points for a surface");
    }
    if captured.outliers >= MANY_OUTLIERS && captured.outliers * FEW_TO_EACH >= sample.positions.len() {
        return Some("the disks of many isolated points would hide the rest");
    }
    // Around a scanner the distant ones are naturally wide, and dense as seen from there.
    if sample.spread() > MAX_SPREAD || (*kind != CaptureKind::Sweep && wide_area(sample) > MAX_WIDE_AREA) {
        return Some("some points are so far apart that their disks would hide the rest");
    }
    None
}

/// Share of wide disks in the area of all disks.
fn wide_area(sample: &CloudSample) -> f32 {
    let wide_from = WIDE * sample.median_spacing();
    let area = |is_taken: &dyn Fn(f32) -> bool| -> f32 {
        let taken = sample.spacing.iter().filter(|spacing| is_taken(**spacing));
        taken.map(|spacing| spacing * spacing).sum()
    };
    let all = area(&|_| true);
    if all > 0.0 {
        area(&|spacing| spacing > wide_from) / all
    } else {
        0.0
    }
}

/// Edge of points on screen: few are to be seen as well, and many are not to hide one another.
pub(super) fn point_size_px(point_count: usize) -> f32 {
    const SIZES: [(usize, f32); 4] = [(100, 10.0), (2_000, 6.0), (20_000, 4.0), (200_000, 3.0)];
    let size = SIZES.iter().find(|(below, _)| point_count < *below);
    size.map_or(2.0, |&(_, size_px)| size_px)
}

/// True where points are so near to a line that its surface would be less than a pixel wide, as where degrees and
/// metres are mixed.
fn is_needle(bounds: &Aabb) -> bool {
    const THIN: f32 = 0.01;
    let mut edges = bounds.extent().to_array();
    edges.sort_unstable_by(f32::total_cmp);
    edges[1] < THIN * edges[2]
}

/// Returns true if a scanner saw its surroundings as a surface: neighbours are separated by a small angle only.
/// Scanners that revolve once for a survey have a tenth of a degree or less from line to line; those that revolve ten
/// times per second have lines with nothing in between.
fn is_dense(sample: &CloudSample, eye: Vec3) -> bool {
    const DENSE: f32 = 0.003;
    let places = sample.positions.iter().zip(&sample.spacing);
    let mut angles: Vec<f32> = places
        .map(|(position, spacing)| spacing / position.distance(eye).max(f32::MIN_POSITIVE))
        .collect();
    quantile(&mut angles, 0.5) <= DENSE
}
