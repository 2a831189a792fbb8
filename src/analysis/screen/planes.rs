//! Planes through the neighbours of points in an image.
//!
//! **How it works.** With the offsets d = (q − p)/R of the n neighbours q within the radius R of a point p, one per
//! cell of its window, and their mean m, the covariance is C = Σddᵀ/n − mmᵀ, and the normal its eigenvector of the
//! smallest eigenvalue (Hofer et al. 2018 §3.5). Offsets are at most 1 and relative to the point itself, so sums of
//! eight cells side by side in f32 lose nothing. Four points are solved together.
//!
//! Where n is below six, or the neighbours are collinear, like those of far rows of a depth image, all is summed up
//! again for 2R, and so on up to 8R, in finer cells: on a surface at a grazing angle, cells in its direction are far
//! apart.
//!
//! Where none of these is a plane, the normal comes from the nearest neighbour that has one, up to 32R away: on a floor
//! at a grazing angle, cells are higher than the spacing of rows of points, so the neighbours are one row. Only a point
//! without such a neighbour faces the eye, which on a floor is a light spot.
//!
//! The radius of a splat is R·√(π/N), where N counts all points in those cells: πR²/N is the area of one. That closes
//! grids, such as those of depth images; where points are at random, it is larger, R at most. Points that are smaller
//! than a pixel are one per pixel; at a grazing angle, their splats would be thinner than the rows of pixels are apart.
//! So those are larger, up to twice their neighbourhood.

use super::cells::{CellLevel, Cells, Window};
use super::constants::{
    CELLS_OF_WINDOW, CLOSING_ROWS_PX, MAX_DOUBLINGS, MAX_DOUBLINGS_OF_LENDING, MIN_NEIGHBOURS, MIN_OF_PLANE,
    MIN_RADIUS_PX, MIN_SPREAD, RADIUS_SPACINGS,
};
use super::lanes::total;
use super::view::{ScreenPoint, ScreenView};
use crate::analysis::surface::four_matrices::{FOUR, FourMatrices};
use crate::cloud::{ShapeRecord, oct_decode, oct_encode};
use fearless_simd::{Level, Simd, SimdBase, SimdFloat, dispatch, f32x8, f64x4};
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use std::f32::consts::{FRAC_1_SQRT_2, PI};

/// Points that are worth handing to another thread.
const POINTS_PER_TASK: usize = 1 << 9;

/// Inputs of plane fitting.
#[derive(Debug)]
pub(super) struct Planes<'a> {
    pub(super) view: &'a ScreenView,
    pub(super) cells: &'a Cells,
    /// Neighbourhood radius, scene units.
    pub(super) radius: f32,
    pub(super) spacing: f32,
    /// Factor on radii.
    pub(super) closing: f32,
    /// From the eye.
    pub(super) sensor: Option<Vec3>,
}

/// The neighbours of a point within a radius.
#[derive(Debug, Clone, Copy)]
pub(super) struct Neighbourhood {
    pub(super) radius: f32,
    /// Number of cells that have a neighbour.
    pub(super) found: f32,
    /// Number of points.
    pub(super) points: f32,
    /// Sums of offsets in radii.
    sums: [f32; 3],
    /// Sums of their products: xx, yy, zz, xy, yz, zx.
    products: [f32; 6],
}

impl Planes<'_> {
    /// Neighbourhoods of a fixed radius.
    pub(super) fn fixed(&self, seen: &[ScreenPoint]) -> Vec<ShapeRecord> {
        let mut shapes = vec![NO_SHAPE; seen.len()];
        let level = Level::new();
        let tasks = shapes.par_chunks_mut(POINTS_PER_TASK);
        tasks.zip(seen.par_chunks(POINTS_PER_TASK)).for_each(|(shapes, seen)| {
            dispatch!(level, simd => self.fit(simd, seen, shapes));
        });
        // Points without a plane used to face the eye and were bright spots: 5.9 % of an exact floor 0.4 m below the
        // eye, 2,671 of 132,089 points of a raw Redwood frame seen from 0.1 to 0.2 m below the sensor's height; now
        // there are none.
        self.lend_normals(seen, &mut shapes);
        shapes
    }

    /// Gives points that have no plane the normals of neighbours that have one.
    pub(super) fn lend_normals(&self, seen: &[ScreenPoint], shapes: &mut [ShapeRecord]) {
        let lacking = shapes.par_iter().enumerate().filter(|(_, shape)| lacks_plane(shape));
        let lacking: Vec<usize> = lacking.map(|(place, _)| place).collect();
        let lent = lacking.par_iter().map(|&place| {
            let shape = ShapeRecord {
                radius: -shapes[place].radius,
                ..shapes[place]
            };
            let lender = self.nearest_with_plane(&seen[place], seen, shapes);
            lender.map_or(shape, |(lender, neighbourhood)| {
                let normal = oct_decode(shapes[lender].normal);
                self.shape_with_normal(&seen[place], normal, shape.radius, neighbourhood)
            })
        });
        let lent: Vec<ShapeRecord> = lent.collect();
        for (place, shape) in lacking.into_iter().zip(lent) {
            shapes[place] = shape;
        }
    }

    /// The nearest of the points around that have a plane, in the smallest neighbourhood that has such, and the radius
    /// of that.
    fn nearest_with_plane(
        &self,
        from: &ScreenPoint,
        seen: &[ScreenPoint],
        shapes: &[ShapeRecord],
    ) -> Option<(usize, f32)> {
        let px_per_unit = self.view.px_per_unit() / from.depth;
        (0..=MAX_DOUBLINGS_OF_LENDING).find_map(|doubling| {
            let radius = self.radius_at(from.depth) * (1_u32 << doubling) as f32;
            let radius_px = (radius * px_per_unit).min(self.cells.max_radius_px());
            let window = self.cells.window(from.place_px, radius_px, doubling > 0);
            let squared = |place: usize| seen[place].offset.distance_squared(from.offset);
            let with_plane = window.points().filter(|&place| !lacks_plane(&shapes[place]));
            let within = with_plane.filter(|&place| squared(place) <= radius * radius);
            let nearest = within.min_by(|&a, &b| squared(a).total_cmp(&squared(b)))?;
            Some((nearest, radius))
        })
    }

    #[inline(always)]
    fn fit<S: Simd>(&self, simd: S, seen: &[ScreenPoint], shapes: &mut [ShapeRecord]) {
        for (seen, shapes) in seen.chunks(FOUR).zip(shapes.chunks_mut(FOUR)) {
            let mut around = [Neighbourhood::NONE; FOUR];
            for (around, seen) in around.iter_mut().zip(seen) {
                let mut radius = self.radius_at(seen.depth);
                *around = self.around(simd, seen, radius, false);
                // Only where needed: a wider window for all points would cost time everywhere, and blur edges.
                for _ in 0..MAX_DOUBLINGS {
                    if around.found >= MIN_NEIGHBOURS && around.is_plane() {
                        break;
                    }
                    radius *= 2.0;
                    *around = self.around(simd, seen, radius, true);
                }
            }
            self.solve(simd, seen, &around, shapes);
        }
    }

    /// The radius in which neighbours of a point are looked for, scene units.
    pub(super) fn radius_at(&self, depth: f32) -> f32 {
        self.radius.max(MIN_RADIUS_PX * depth / self.view.px_per_unit())
    }

    /// The neighbours of a point within a radius, or within the largest one that there are cells for.
    #[inline(always)]
    pub(super) fn around<S: Simd>(&self, simd: S, seen: &ScreenPoint, radius: f32, is_wide: bool) -> Neighbourhood {
        let px_per_unit = self.view.px_per_unit() / seen.depth;
        let radius_px = (radius * px_per_unit).min(self.cells.max_radius_px());
        let radius = radius.min(radius_px / px_per_unit);
        let window = self.cells.window(seen.place_px, radius_px, is_wide);
        sum(simd, &window, seen.offset, radius)
    }

    /// The shapes of at most four points.
    #[inline(always)]
    pub(super) fn solve<S: Simd>(
        &self,
        simd: S,
        seen: &[ScreenPoint],
        around: &[Neighbourhood; FOUR],
        shapes: &mut [ShapeRecord],
    ) {
        let covariances = around.map(|around| around.covariance());
        let row = |entry: usize| f64x4::from_slice(simd, &[0, 1, 2, 3].map(|lane| covariances[lane][entry]));
        let matrices = FourMatrices {
            diagonal: [row(0), row(1), row(2)],
            neighbor: [row(3), row(4), row(5)],
        };
        let normals = matrices.smallest_eigenvectors(simd);
        for (lane, (seen, shape)) in seen.iter().zip(shapes).enumerate() {
            let around = &around[lane];
            *shape = self.shape(seen, around, around.is_plane().then_some(normals[lane]));
        }
    }

    fn shape(&self, seen: &ScreenPoint, around: &Neighbourhood, normal: Option<DVec3>) -> ShapeRecord {
        let Some(normal) = normal.map(DVec3::as_vec3).filter(|normal| normal.is_finite()) else {
            return ShapeRecord {
                normal: oct_encode((-seen.offset).normalize_or(Vec3::Z)),
                // Negative while it has no plane.
                radius: -self.closing * self.spacing.max(self.radius_at(seen.depth) / RADIUS_SPACINGS),
                ..NO_SHAPE
            };
        };
        // At silhouettes half of the neighbourhood is empty, so splats there are larger by √2.
        let radius = self.closing * around.radius * (PI / around.points.max(PI)).sqrt();
        // At edges the surroundings are empty, and splats would extend far beyond them.
        let radius = radius.min(self.radius_at(seen.depth));
        self.shape_with_normal(seen, normal, radius, around.radius)
    }

    /// A shape with a plane, whose normal is turned, and whose radius closes rows of pixels.
    fn shape_with_normal(&self, seen: &ScreenPoint, normal: Vec3, radius: f32, neighbourhood: f32) -> ShapeRecord {
        let to_eye = -seen.offset;
        let outwards = self.sensor.map_or(to_eye, |sensor| sensor - seen.offset);
        let faces_away = normal.dot(outwards) < 0.0;
        ShapeRecord {
            normal: oct_encode(if faces_away { -normal } else { normal }),
            // Seen edge-on at an edge, it would stick out.
            radius: radius.max(self.closing_rows(seen, normal).min(2.0 * neighbourhood)),
            ..NO_SHAPE
        }
    }

    /// The radius that closes rows of pixels, where one point a pixel is left.
    fn closing_rows(&self, seen: &ScreenPoint, normal: Vec3) -> f32 {
        let px = seen.depth / self.view.px_per_unit();
        if self.spacing * FRAC_1_SQRT_2 > 0.5 * px {
            return 0.0;
        }
        let cosine = (normal.dot(seen.offset) / seen.offset.length()).abs();
        CLOSING_ROWS_PX * px / cosine
    }
}

const NO_SHAPE: ShapeRecord = ShapeRecord {
    normal: [0; 2],
    radius: 0.0,
    ellipse: 0,
    scalar: 0.0,
};

/// Returns true if a point has no plane around it, and none of a neighbour yet.
fn lacks_plane(shape: &ShapeRecord) -> bool {
    shape.radius.is_sign_negative()
}

impl Neighbourhood {
    pub(super) const NONE: Self = Self {
        radius: 0.0,
        found: 0.0,
        points: 0.0,
        sums: [0.0; 3],
        products: [0.0; 6],
    };

    /// Returns true if the neighbours spread in two directions and so define a plane.
    fn is_plane(&self) -> bool {
        let [xx, yy, zz, xy, yz, zx] = self.covariance();
        let trace = xx + yy + zz;
        // The sum of the pairwise products of eigenvalues: the product of the two larger ones, up to noise.
        let products = (xx * yy - xy * xy) + (xx * zz - zx * zx) + (yy * zz - yz * yz);
        self.found >= MIN_OF_PLANE && products > MIN_SPREAD * trace * trace
    }

    /// xx, yy, zz, xy, yz, zx.
    fn covariance(&self) -> [f64; 6] {
        let per_count = 1.0 / f64::from(self.found.max(1.0));
        let mean = self.sums.map(|sum| f64::from(sum) * per_count);
        let pairs = [[0, 0], [1, 1], [2, 2], [0, 1], [1, 2], [2, 0]];
        let mut entries = [0.0; 6];
        for ((entry, product), [a, b]) in entries.iter_mut().zip(self.products).zip(pairs) {
            *entry = f64::from(product) * per_count - mean[a] * mean[b];
        }
        entries
    }
}

/// Adds up the cells within a radius of a place.
#[inline(always)]
fn sum<S: Simd>(simd: S, window: &Window<'_>, center: Vec3, radius: f32) -> Neighbourhood {
    let splat = |value: f32| f32x8::splat(simd, value);
    let (zero, one) = (splat(0.0), splat(1.0));
    let per_radius = splat(1.0 / radius.max(f32::MIN_POSITIVE));
    let center = [splat(center.x), splat(center.y), splat(center.z)];
    let (mut found, mut points) = (zero, zero);
    let (mut sums, mut products) = ([zero; 3], [zero; 6]);
    let CellLevel { places, counts, .. } = window.level;
    for eight in 0..window.rows * window.eights {
        let (row, column) = (eight / window.eights, eight % window.eights);
        let start = window.first + row * window.stride + column * CELLS_OF_WINDOW;
        let end = start + CELLS_OF_WINDOW;
        let mut d = [zero; 3];
        for axis in 0..3 {
            d[axis] = (f32x8::from_slice(simd, &places[axis][start..end]) - center[axis]) * per_radius;
        }
        let squared = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
        let is_within = squared.simd_le(one);
        for offset in &mut d {
            *offset = simd.select_f32x8(is_within, *offset, zero);
        }
        found += simd.select_f32x8(is_within, one, zero);
        let counted = f32x8::from_slice(simd, &counts[start..end]);
        points += simd.select_f32x8(is_within, counted, zero);
        for axis in 0..3 {
            sums[axis] += d[axis];
            products[axis] += d[axis] * d[axis];
            products[3 + axis] += d[axis] * d[(axis + 1) % 3];
        }
    }
    Neighbourhood {
        radius,
        found: total(simd, found),
        points: total(simd, points),
        sums: [total(simd, sums[0]), total(simd, sums[1]), total(simd, sums[2])],
        products: [
            total(simd, products[0]),
            total(simd, products[1]),
            total(simd, products[2]),
            total(simd, products[3]),
            total(simd, products[4]),
            total(simd, products[5]),
        ],
    }
}
