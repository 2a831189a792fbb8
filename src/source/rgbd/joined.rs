//! Accumulation of a point cloud: merging of points from several frames into one cloud.
//!
//! How it works: a depth camera sees the same wall in hundreds of frames. All points are retained as long as there are
//! few enough to be rendered quickly; after that they are voxel-downsampled, with cells that grow whenever there are
//! too many of them. The mean of many measurements is more accurate than each of them.

use crate::assumption::{Assumption, Evidence, Subject};
use crate::cloud::{Cells, LengthUnit, Positions, RawCloud, TooManyCells};
use crate::messages::frame_by_index;
use glam::{DAffine3, Vec3};
use std::fmt;

/// Number of points up to which all are retained: 27 images of 640×480. The software renderer draws them in a second.
// View-dependent texturing looks the same on downsampled points (Redwood: 36.85 dB on 1,339,364 points, 36.88 dB in
// cells of 2 mm, 36.85 dB on 121,008 in cells of 8 mm); colours of the points do not (35.40, 34.93 and 30.35 dB).
const MAX_POINTS: usize = 1 << 23;

/// Edges of the finest cells, if none was requested: the distance between pixels on the surfaces, so that few points of
/// one frame are merged.
const EDGES_PER_PIXEL: f64 = 2.0;

/// Edge below which none are, metres: no depth camera measures as finely.
const FINEST_EDGE_M: f64 = 0.000_1;

/// Bytes that a cell takes while there is one, with its place in the table.
const CELL_BYTES: u64 = 128;

/// The points of frames that were taken so far, in the frame of the world.
#[derive(Debug)]
pub(super) struct Merged {
    points: RawCloud,
    /// Voxel cells of the points, once they are downsampled.
    cells: Option<Cells>,
    /// Number of points merged into cells.
    joined: usize,
    /// The requested edge of the cells, metres.
    edge_m: Option<f64>,
    max_points: usize,
    has_colors: bool,
    lacks_colors: bool,
    warnings: Vec<String>,
}

impl Merged {
    /// Creates an empty point set. Points are voxel-downsampled to cells of `edge_m`; not at all if that is 0; and if
    /// it is not given, to cells as fine as [`MAX_POINTS`] allow. Cells take no more than `max_bytes`.
    pub(super) fn new(edge_m: Option<f64>, max_bytes: u64) -> Self {
        let max_cells = usize::try_from(max_bytes / CELL_BYTES).unwrap_or(usize::MAX).max(1);
        let mut points = RawCloud::from_positions(Positions::F64(Vec::new()));
        points.attributes.colors = Some(Vec::new());
        points.attributes.normals = Some(Vec::new());
        points.unit = Some(LengthUnit::Metre);
        Self {
            points,
            cells: edge_m.filter(|&edge| edge > 0.0).map(Cells::new),
            joined: 0,
            edge_m,
            max_points: match edge_m {
                Some(0.0) => usize::MAX,
                Some(_) => max_cells,
                None => max_cells.min(MAX_POINTS),
            },
            has_colors: false,
            lacks_colors: false,
            warnings: Vec::new(),
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.points.positions.is_empty() && self.cells.as_ref().is_none_or(Cells::is_empty)
    }

    /// Reports that frame `index` is not among them.
    pub(super) fn warn_of(&mut self, index: usize, reason: &dyn fmt::Display) {
        self.warnings
            .push(format!("{} is skipped: {reason}", frame_by_index(index)));
    }

    /// Takes a frame with normals, in the frame of its camera.
    ///
    /// # Errors
    /// [`TooManyCells`] if it is too far away to be joined.
    pub(super) fn take(&mut self, mut cloud: RawCloud, world_from_camera: DAffine3) -> Result<(), TooManyCells> {
        let measured: Vec<u32> = (0..cloud.positions.len() as u32)
            .filter(|&index| cloud.positions.get(index as usize).is_finite())
            .collect();
        cloud.keep(&measured);
        let points = (0..measured.len()).map(|index| cloud.positions.get(index));
        let points = points.map(|point| world_from_camera.transform_point3(point).to_array());
        cloud.positions = Positions::F64(points.collect());
        let turn = world_from_camera.matrix3.as_mat3();
        for normal in cloud.attributes.normals.iter_mut().flatten() {
            *normal = (turn * Vec3::from(*normal)).to_array();
        }
        // Merged points have neither.
        cloud.attributes.scalars.clear();
        cloud.attributes.radii = None;
        self.has_colors |= cloud.attributes.colors.is_some();
        self.lacks_colors |= cloud.attributes.colors.is_none();
        self.warnings.append(&mut cloud.warnings);
        let count = cloud.positions.len();
        if self.cells.is_none() && self.points.positions.len() + count > self.max_points {
            let mut cells = Cells::new((spacing(&cloud.positions) / EDGES_PER_PIXEL).max(FINEST_EDGE_M));
            cells.add(&self.points)?;
            self.joined = self.points.positions.len();
            self.points.keep(&[]);
            self.cells = Some(cells);
        }
        let Some(cells) = &mut self.cells else {
            append(&mut self.points, cloud);
            return Ok(());
        };
        cells.add(&cloud)?;
        self.joined += count;
        while cells.len() > self.max_points {
            cells.coarsen();
        }
        Ok(())
    }

    /// All of them, without holes.
    pub(super) fn into_cloud(mut self) -> RawCloud {
        let mut cloud = self.points;
        if let Some(cells) = self.cells {
            let (edge_m, count) = (cells.edge(), cells.len());
            let edge_mm = 1e3 * edge_m;
            (cloud.positions, cloud.attributes) = cells.into_points();
            if self.edge_m.is_none_or(|asked| asked < edge_m) {
                let value = format!("{} points to {count}, in cells of {edge_mm:.1} mm", self.joined);
                let why = "the frames have more points than a picture needs";
                let assumption = Assumption::new(Subject::MergedPoints, value, why, Evidence::Statistics);
                cloud.assumptions.push(assumption);
            }
        }
        if self.lacks_colors {
            cloud.attributes.colors = None;
        }
        if self.lacks_colors && self.has_colors {
            self.warnings
                .push("some of the merged frames have no colours, so their cloud has none".to_owned());
        }
        cloud.warnings = self.warnings;
        cloud
    }
}

/// From a point of an image to the next one, mostly.
fn spacing(positions: &Positions) -> f64 {
    let distance = |index| positions.get(index).distance(positions.get(index - 1));
    let mut distances: Vec<f64> = (1..positions.len()).map(distance).collect();
    let center = distances.len() / 2;
    if distances.is_empty() {
        return 0.0;
    }
    *distances.select_nth_unstable_by(center, f64::total_cmp).1
}

/// Puts the points of one cloud behind those of another.
fn append(points: &mut RawCloud, cloud: RawCloud) {
    fn extend<T>(all: &mut Option<Vec<T>>, more: Option<Vec<T>>) {
        if let Some(all) = all {
            all.extend(more.into_iter().flatten());
        }
    }
    if let (Positions::F64(all), Positions::F64(more)) = (&mut points.positions, cloud.positions) {
        all.extend(more);
    }
    extend(&mut points.attributes.colors, cloud.attributes.colors);
    extend(&mut points.attributes.normals, cloud.attributes.normals);
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    /// A wall 1.01 m before the camera, of 100 × 100 points that are 2 mm apart, `off_m` nearer than it is.
    fn wall(off_m: f64) -> RawCloud {
        let point = |index: u32| {
            [
                0.002 * f64::from(index % 100),
                0.002 * f64::from(index / 100),
                1.01 - off_m,
            ]
        };
        let mut cloud = RawCloud::from_positions(Positions::F64((0..10_000).map(point).collect()));
        cloud.attributes.colors = Some(vec![[10, 20, 30, 255]; 10_000]);
        cloud.attributes.normals = Some(vec![[0.0, 0.0, -1.0]; 10_000]);
        cloud
    }

    /// The wall as cameras saw it that stand in a row, a centimetre apart, each off by a few millimetres.
    fn merged(edge_m: Option<f64>, max_cells: u64) -> RawCloud {
        let mut merged = Merged::new(edge_m, CELL_BYTES * max_cells);
        for (camera, off_m) in (0..).zip([0.001, -0.001, 0.003, -0.003]) {
            // Offset by half a millimetre: no point lies between two cells.
            let from = DVec3::new(0.01 * f64::from(camera) + 0.000_5, 0.000_5, 0.000_5);
            merged.take(wall(off_m), DAffine3::from_translation(from)).unwrap();
        }
        merged.into_cloud()
    }

    #[test]
    fn all_points_are_retained_where_there_are_few() {
        for cloud in [merged(None, 40_000), merged(Some(0.0), 1)] {
            assert_eq!(cloud.positions.len(), 40_000);
            let expected = DVec3::new(0.012_5, 0.000_5, 1.011_5);
            assert!(cloud.positions.get(10_001).abs_diff_eq(expected, 1e-12));
            assert!(cloud.warnings.is_empty(), "{:?}", cloud.warnings);
        }
    }

    #[test]
    fn many_points_are_merged_in_the_finest_affordable_cells() {
        let cloud = merged(None, 39_999);
        let count = cloud.positions.len();
        // Up to 2 mm, the distance between points, each has its own cell. At 4 mm, a cell contains four points of each
        // frame, including those of overlapping frames.
        assert!((7_000..8_000).contains(&count), "{count}");
        assert_eq!(cloud.attributes.colors, Some(vec![[10, 20, 30, 255]; count]));
        assert_eq!(cloud.attributes.normals, Some(vec![[0.0, 0.0, -1.0]; count]));
        let [assumption] = &cloud.assumptions[..] else {
            panic!("{:?}", cloud.assumptions)
        };
        assert_eq!(assumption.subject, Subject::MergedPoints);
        assert_eq!(assumption.value, format!("40000 points to {count}, in cells of 4.0 mm"));
    }

    #[test]
    fn requested_cells_hold_the_mean_over_all_cameras() {
        let cloud = merged(Some(0.02), 40_000);
        // The wall is 230 mm wide and 200 mm high.
        assert!(
            (11 * 10..=12 * 11).contains(&cloud.positions.len()),
            "{}",
            cloud.positions.len()
        );
        let farthest = (0..cloud.positions.len()).map(|index| (cloud.positions.get(index).z - 1.010_5).abs());
        let farthest = farthest.fold(0.0, f64::max);
        assert!(farthest <= 0.003 + 1e-12, "{farthest}");
        let of_all = (0..cloud.positions.len()).filter(|&index| (cloud.positions.get(index).z - 1.010_5).abs() < 1e-9);
        assert!(of_all.count() > 50, "errors of four cameras cancel out");
        assert!(cloud.warnings.is_empty(), "{:?}", cloud.warnings);
    }

    #[test]
    fn cells_that_do_not_fit_into_memory_grow_with_a_warning() {
        let cloud = merged(Some(0.001), 8_000);
        assert!(cloud.positions.len() <= 8_000);
        assert!(
            cloud.assumptions[0].value.contains("in cells of 4.0 mm"),
            "{:?}",
            cloud.assumptions
        );
    }

    #[test]
    fn a_frame_beyond_all_cells_is_rejected_and_others_retained() {
        let mut merged = Merged::new(Some(0.001), 1 << 20);
        merged.take(wall(0.0), DAffine3::IDENTITY).unwrap();
        let far = DAffine3::from_translation(DVec3::splat(1e15));
        assert!(merged.take(wall(0.0), far).is_err());
        assert!(merged.into_cloud().positions.len() > 1_000);
    }

    #[test]
    fn one_frame_without_colors_removes_the_colors_of_all() {
        for edge_m in [None, Some(0.01)] {
            let mut merged = Merged::new(edge_m, 1 << 30);
            merged.take(wall(0.0), DAffine3::IDENTITY).unwrap();
            let mut grey = wall(0.0);
            grey.attributes.colors = None;
            merged.take(grey, DAffine3::IDENTITY).unwrap();
            let cloud = merged.into_cloud();
            assert!(cloud.attributes.colors.is_none() && cloud.attributes.normals.is_some());
            assert_eq!(cloud.warnings.len(), 1, "{:?}", cloud.warnings);
        }
    }
}
