//! Planes through all windows of one size.

use super::pixels::Pixels;
use glam::Vec3;
use std::ops::Range;

/// Sums over pixels with a depth, whose ray is (x, y) and inverse depth w: their number, and the sums of x, y, w, x²,
/// xy, y², xw, yw and w².
type Sums = [f64; 10];

/// Minimum number of pixels that distinguishes a plane from noise.
const MIN_PIXELS: f64 = 8.0;

/// Rays in one line determine no plane: the determinant of their covariance is this share of the product of its
/// diagonal.
const MIN_DETERMINANT: f64 = 1e-6;

/// Pixels are on the plane of their window within this many times the limit of their root mean square.
const PIXEL_ON_PLANE: f32 = 1.5;

/// Inverse depths `w = a·x + b·y + c`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Plane {
    /// a, b and c.
    pub(super) factors: Vec3,
    /// Root mean square of the errors of the pixels of the window, per metre; infinite if they determine no plane.
    pub(super) error: f32,
}

impl Plane {
    /// No plane.
    pub(super) const NONE: Self = Self {
        factors: Vec3::ZERO,
        error: f32::INFINITY,
    };

    fn of(sums: &Sums) -> Self {
        let &[count, x, y, w, xx, xy, yy, xw, yw, ww] = sums;
        if count < MIN_PIXELS {
            return Self::NONE;
        }
        let [mean_x, mean_y, mean_w] = [x, y, w].map(|sum| sum / count);
        let [xx, xy, yy] = [xx - x * mean_x, xy - x * mean_y, yy - y * mean_y];
        let [xw, yw, ww] = [xw - x * mean_w, yw - y * mean_w, ww - w * mean_w];
        let determinant = xx * yy - xy * xy;
        if determinant <= MIN_DETERMINANT * xx * yy {
            return Self::NONE;
        }
        let a = (xw * yy - yw * xy) / determinant;
        let b = (yw * xx - xw * xy) / determinant;
        let c = mean_w - a * mean_x - b * mean_y;
        let square = (ww - a * xw - b * yw).max(0.0) / (count - 3.0);
        Self {
            factors: Vec3::new(a as f32, b as f32, c as f32),
            error: square.sqrt() as f32,
        }
    }

    pub(super) fn inverse_depth(&self, &[x, y, _]: &[f32; 3]) -> f32 {
        self.factors.dot(Vec3::new(x, y, 1.0))
    }

    /// Returns true if the window is a plane except for noise up to `limit`, and the pixel is on it.
    pub(super) fn fits(&self, limit: f32, ray: &[f32; 3]) -> bool {
        self.error < limit && (ray[2] - self.inverse_depth(ray)).abs() < PIXEL_ON_PLANE * limit
    }

    /// Towards the camera as the pixel is seen. (No plane through the camera has inverse depths.)
    pub(super) fn normal_towards_camera(&self, &[x, y, _]: &[f32; 3]) -> Vec3 {
        let ray = Vec3::new(x, y, 1.0);
        let normal = self.factors.normalize_or(-ray.normalize());
        if normal.dot(ray) > 0.0 { -normal } else { normal }
    }
}

/// A summed-area table of some lines of an image.
pub(super) struct Windows {
    lines: Range<usize>,
    width: usize,
    /// Summed-area table: the sums of all that is above and to the left of each corner of the pixels.
    corners: Vec<Sums>,
}

impl Windows {
    pub(super) fn of(pixels: &Pixels, lines: Range<usize>) -> Self {
        let width = pixels.width;
        let stride = width + 1;
        let mut corners = vec![[0.0; 10]; stride * (lines.len() + 1)];
        for (row, line) in lines.clone().enumerate() {
            let (above, below) = corners[stride * row..].split_at_mut(stride);
            let mut of_line = [0.0; 10];
            let rays = &pixels.rays[width * line..][..width];
            for ((ray, above), below) in rays.iter().zip(&above[1..]).zip(&mut below[1..]) {
                of_line = plus(&of_line, &sums_of(ray));
                *below = plus(above, &of_line);
            }
        }
        Self { lines, width, corners }
    }

    /// The planes of windows of `half` pixels around each pixel of `centers`. There are no depths outside the image.
    /// Precondition: the table has the lines of all these windows that the image has.
    pub(super) fn planes(&self, half: usize, centers: Range<usize>) -> PlanesOfWindows {
        let corner_row = |line: usize| {
            let row = line.clamp(self.lines.start, self.lines.end) - self.lines.start;
            &self.corners[(self.width + 1) * row..][..=self.width]
        };
        let mut planes = Vec::with_capacity(self.width * centers.len());
        for line in centers.clone() {
            let top = corner_row(line.saturating_sub(half));
            let bottom = corner_row(line + half + 1);
            planes.extend((0..self.width).map(|column| {
                let left = column.saturating_sub(half);
                let right = (column + half + 1).min(self.width);
                let right = minus(&bottom[right], &top[right]);
                Plane::of(&minus(&right, &minus(&bottom[left], &top[left])))
            }));
        }
        PlanesOfWindows {
            half,
            centers,
            width: self.width,
            planes,
        }
    }
}

/// The planes of windows of one size around each pixel of some lines.
pub(super) struct PlanesOfWindows {
    half: usize,
    centers: Range<usize>,
    width: usize,
    pub(super) planes: Vec<Plane>,
}

impl PlanesOfWindows {
    /// Entry of the window the given number of half widths to the right and down of the one around a pixel; `None`
    /// outside.
    pub(super) fn at(&self, [column, line]: [usize; 2], [right, down]: [isize; 2]) -> Option<Plane> {
        let half = self.half as isize;
        let column = column.checked_add_signed(right * half)?;
        let line = line.checked_add_signed(down * half)?;
        let is_there = column < self.width && self.centers.contains(&line);
        is_there.then(|| self.planes[(line - self.centers.start) * self.width + column])
    }

    /// Returns the planes of the neighbouring windows that have a pixel at their border.
    pub(super) fn neighbor(&self, pixel: [usize; 2]) -> impl Iterator<Item = Plane> {
        let offsets = (-1..=1).flat_map(|down| (-1..=1).map(move |right| [right, down]));
        offsets.filter_map(move |way| self.at(pixel, way))
    }
}

/// The plane of a single window.
pub(super) fn plane_around(pixels: &Pixels, half: usize, [column, line]: [usize; 2]) -> Plane {
    let mut sums = [0.0; 10];
    let columns = column.saturating_sub(half)..(column + half + 1).min(pixels.width);
    for line in line.saturating_sub(half)..(line + half + 1).min(pixels.height) {
        for ray in &pixels.rays[pixels.width * line..][columns.clone()] {
            sums = plus(&sums, &sums_of(ray));
        }
    }
    Plane::of(&sums)
}

#[inline(always)]
fn sums_of(&ray: &[f32; 3]) -> Sums {
    let [x, y, w] = ray.map(f64::from);
    let is_there = f64::from(u8::from(w != 0.0));
    [is_there, x, y, w, x * x, x * y, y * y, x * w, y * w, w * w]
}

#[inline(always)]
fn plus(first: &Sums, second: &Sums) -> Sums {
    std::array::from_fn(|sum| first[sum] + second[sum])
}

#[inline(always)]
fn minus(first: &Sums, second: &Sums) -> Sums {
    std::array::from_fn(|sum| first[sum] - second[sum])
}
