//! Surface errors, i.e. pixels of an image with no surface, another surface, or one too many: holes and wrong-surface
//! pixels.
//!
//! How it works: two images of one view are compared pixel by pixel by the *geometry* that they show, not by colour:
//! the depth of the surface along the view axis. A splat is an approximation as thick as its radius, so depths that
//! differ by no more are the same surface; beyond it something shines through that should be hidden, or hides what
//! should be seen.
//!
//! When it wins: over errors of colours, where a hole shows a background of nearly the colour of the surface, or a far
//! surface of the same colour shines through.

/// The depth of the surface in each pixel of a view.
#[derive(Debug, Clone, PartialEq)]
pub struct DepthImage {
    /// Width and height.
    pub size_px: [u32; 2],
    /// Distances from the eye along the view axis in scene units, 0 and above; infinite where the background shows. Row
    /// by row from the top left.
    pub depth: Vec<f32>,
}

/// Tolerance for the difference of two depths of one surface, scene units; 0 and above.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum DepthTolerance<'a> {
    /// Uniform tolerance for all pixels.
    Everywhere(f32),
    /// For each pixel, such as the radius of the splat that it shows; infinite where any surface is right.
    PerPixel(&'a [f32]),
}

impl DepthTolerance<'_> {
    fn at(self, pixel: usize) -> f32 {
        match self {
            Self::Everywhere(tolerance) => tolerance,
            Self::PerPixel(tolerances) => tolerances[pixel],
        }
    }
}

/// Reasons why the surfaces of two images cannot be compared.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum SurfaceMismatch {
    /// The images differ in size.
    #[error(transparent)]
    Size(#[from] super::SizeMismatch),
    /// There is not one depth, or one tolerance, for each pixel.
    #[error("{found} values do not belong to a picture of {}x{} pixels", size_px[0], size_px[1])]
    Count {
        /// Width and height.
        size_px: [u32; 2],
        /// Number of values found.
        found: usize,
    },
    /// A depth is negative or no number.
    #[error("{depth} is not a depth: expected 0 or more (pixel {pixel})")]
    Depth {
        /// The place in [`DepthImage::depth`].
        pixel: usize,
        /// Depth value found there.
        depth: f32,
    },
    /// A tolerance is negative or no number.
    #[error("{0} is not a tolerance: expected 0 or more")]
    Tolerance(f32),
}

/// Pixels that show the wrong thing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct SurfaceError {
    /// Pixels of each image.
    pub pixel_count: u64,
    /// Pixels that show a surface in the truth.
    pub surface_count: u64,
    /// Number of surface pixels that show the background in the test (holes).
    pub hole_count: u64,
    /// Number of surface pixels that show a surface at another depth in the test.
    pub wrong_surface_count: u64,
    /// Number of background pixels that are covered in the test.
    pub extra_count: u64,
}

impl std::ops::AddAssign for SurfaceError {
    /// The counts of several images.
    fn add_assign(&mut self, other: Self) {
        self.pixel_count += other.pixel_count;
        self.surface_count += other.surface_count;
        self.hole_count += other.hole_count;
        self.wrong_surface_count += other.wrong_surface_count;
        self.extra_count += other.extra_count;
    }
}

impl SurfaceError {
    /// Compares the surfaces in `test` with those in `truth`, of the same view.
    pub fn of(truth: &DepthImage, test: &DepthImage, tolerance: DepthTolerance<'_>) -> Result<Self, SurfaceMismatch> {
        super::check_sizes(truth.size_px, test.size_px)?;
        check_depths(truth)?;
        check_depths(test)?;
        check_tolerance(truth.size_px, tolerance)?;
        let mut error = Self {
            pixel_count: truth.depth.len() as u64,
            ..Self::default()
        };
        for (pixel, (&truth, &test)) in truth.depth.iter().zip(&test.depth).enumerate() {
            error.surface_count += u64::from(truth.is_finite());
            match (truth.is_finite(), test.is_finite()) {
                (true, false) => error.hole_count += 1,
                (false, true) => error.extra_count += 1,
                (true, true) => {
                    // In f64, so that the rounding of the difference does not decide.
                    let apart = (f64::from(truth) - f64::from(test)).abs();
                    // By depth, not by colour; a splat is as thick as it is wide, so its diameter is the tolerance.
                    let is_wrong = apart > f64::from(tolerance.at(pixel));
                    error.wrong_surface_count += u64::from(is_wrong);
                }
                (false, false) => {}
            }
        }
        Ok(error)
    }

    /// Part of the true surface that is missing, 0 to 1; 0 if there is none.
    pub fn hole_share(&self) -> f64 {
        share(self.hole_count, self.surface_count)
    }

    /// Part of the true surface that is replaced by another one, 0 to 1; 0 if there is none.
    pub fn wrong_surface_share(&self) -> f64 {
        share(self.wrong_surface_count, self.surface_count)
    }

    /// Part of the true background that is covered, 0 to 1; 0 if there is none.
    pub fn extra_share(&self) -> f64 {
        share(self.extra_count, self.pixel_count - self.surface_count)
    }
}

fn share(part: u64, whole: u64) -> f64 {
    part as f64 / whole.max(1) as f64
}

fn check_count(size_px: [u32; 2], found: usize) -> Result<(), SurfaceMismatch> {
    let expected = u64::from(size_px[0]) * u64::from(size_px[1]);
    if found as u64 == expected {
        return Ok(());
    }
    Err(SurfaceMismatch::Count { size_px, found })
}

fn check_depths(image: &DepthImage) -> Result<(), SurfaceMismatch> {
    check_count(image.size_px, image.depth.len())?;
    let is_wrong = |&(_, depth): &(usize, f32)| depth.is_nan() || depth < 0.0;
    let mut depths = image.depth.iter().copied().enumerate();
    match depths.find(is_wrong) {
        Some((pixel, depth)) => Err(SurfaceMismatch::Depth { pixel, depth }),
        None => Ok(()),
    }
}

fn check_tolerance(size_px: [u32; 2], tolerance: DepthTolerance<'_>) -> Result<(), SurfaceMismatch> {
    let tolerances = match &tolerance {
        DepthTolerance::Everywhere(one) => std::slice::from_ref(one),
        DepthTolerance::PerPixel(tolerances) => {
            check_count(size_px, tolerances.len())?;
            tolerances
        }
    };
    let mut tolerances = tolerances.iter().copied();
    match tolerances.find(|tolerance| tolerance.is_nan() || *tolerance < 0.0) {
        Some(wrong) => Err(SurfaceMismatch::Tolerance(wrong)),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NONE: f32 = f32::INFINITY;

    fn row(depth: &[f32]) -> DepthImage {
        DepthImage {
            size_px: [depth.len() as u32, 1],
            depth: depth.to_vec(),
        }
    }

    #[test]
    fn each_kind_of_pixel_is_counted() {
        let truth = row(&[1.0, 2.0, 3.0, 4.0, 5.0, NONE, NONE, NONE]);
        let test = row(&[1.0, NONE, 3.5, 4.6, 1.0, 7.0, NONE, NONE]);
        let error = SurfaceError::of(&truth, &test, DepthTolerance::Everywhere(0.5)).unwrap();
        let expected = SurfaceError {
            pixel_count: 8,
            surface_count: 5,
            hole_count: 1,
            // 0.6 behind and 4 in front; half a unit still counts as the surface.
            wrong_surface_count: 2,
            extra_count: 1,
        };
        assert_eq!(error, expected);
        assert_eq!(error.hole_share(), 0.2);
        assert_eq!(error.wrong_surface_share(), 0.4);
        assert_eq!(error.extra_share(), 1.0 / 3.0);
    }

    #[test]
    fn a_tolerance_may_differ_from_pixel_to_pixel() {
        let [truth, test] = [row(&[10.0; 4]), row(&[11.0; 4])];
        let tolerances = [0.0, 0.99, 1.0, f32::INFINITY];
        let error = SurfaceError::of(&truth, &test, DepthTolerance::PerPixel(&tolerances)).unwrap();
        assert_eq!(error.wrong_surface_count, 2);
    }

    #[test]
    fn a_shifted_square_leaves_a_hole_and_covers_as_much_background() {
        // 6×6 pixels at depth 2 in 16×16, shifted by two to the right.
        let square = |left: usize| DepthImage {
            size_px: [16, 16],
            depth: (0..256)
                .map(|pixel| match (pixel % 16, pixel / 16) {
                    (x, 5..11) if (left..left + 6).contains(&x) => 2.0,
                    _ => NONE,
                })
                .collect(),
        };
        let compare = |test: &DepthImage| SurfaceError::of(&square(4), test, DepthTolerance::Everywhere(0.0)).unwrap();
        let moved = compare(&square(6));
        assert_eq!((moved.hole_count, moved.extra_count), (12, 12));
        assert_eq!(moved.wrong_surface_count, 0);
        assert_eq!(moved.hole_share(), 12.0 / 36.0);
        assert_eq!(moved.extra_share(), 12.0 / 220.0);
        let equal = compare(&square(4));
        assert_eq!(equal.hole_count + equal.extra_count, 0);
    }

    #[test]
    fn empty_images_have_no_error() {
        for size_px in [[0, 0], [3, 2]] {
            let nothing = DepthImage {
                size_px,
                depth: vec![NONE; (size_px[0] * size_px[1]) as usize],
            };
            let error = SurfaceError::of(&nothing, &nothing, DepthTolerance::Everywhere(0.1)).unwrap();
            let shares = [error.hole_share(), error.wrong_surface_share(), error.extra_share()];
            assert_eq!(shares, [0.0; 3]);
        }
    }

    #[test]
    fn incomparable_images_are_reported() {
        let good = row(&[1.0, 2.0]);
        let short = DepthImage {
            size_px: [2, 2],
            depth: vec![1.0; 3],
        };
        let everywhere = DepthTolerance::Everywhere;
        let cases = [
            (
                &good,
                &row(&[1.0]),
                everywhere(0.0),
                "a picture of 1x1 pixels cannot be compared with one of 2x1",
            ),
            (
                &short,
                &short,
                everywhere(0.0),
                "3 values do not belong to a picture of 2x2 pixels",
            ),
            (
                &good,
                &row(&[1.0, f32::NAN]),
                everywhere(0.0),
                "NaN is not a depth: expected 0 or more (pixel 1)",
            ),
            (
                &row(&[-1.0, 2.0]),
                &good,
                everywhere(0.0),
                "-1 is not a depth: expected 0 or more (pixel 0)",
            ),
            (
                &good,
                &good,
                everywhere(-0.5),
                "-0.5 is not a tolerance: expected 0 or more",
            ),
            (
                &good,
                &good,
                DepthTolerance::PerPixel(&[0.0, f32::NAN]),
                "NaN is not a tolerance: expected 0 or more",
            ),
            (
                &good,
                &good,
                DepthTolerance::PerPixel(&[0.0]),
                "1 values do not belong to a picture of 2x1 pixels",
            ),
        ];
        for (truth, test, tolerance, expected) in cases {
            let error = SurfaceError::of(truth, test, tolerance).unwrap_err();
            assert_eq!(error.to_string(), expected);
        }
    }
}
