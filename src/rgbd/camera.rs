//! A camera: where a direction is in its image, and which direction a place in the image is.

use super::distortion::Distortion;
use glam::{DVec2, DVec3};

/// A pinhole with a lens, by its intrinsics. Centres of pixels are at integers: the image reaches from −½ to its size −
/// ½.
#[derive(Debug, Clone, PartialEq)]
pub struct Camera {
    size_px: [u32; 2],
    focal_px: DVec2,
    principal_px: DVec2,
    distortion: Distortion,
    /// See [`Distortion::reach`].
    reach: f64,
}

/// Reasons why some numbers are not a camera.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CameraError {
    /// An image without pixels.
    #[error("an image of {0} × {1} pixels has no camera: expected a width and a height above 0")]
    NoPixels(u32, u32),
    /// An invalid focal length.
    #[error("focal lengths of {0} and {1} pixels: expected finite numbers above 0")]
    NoFocalLength(f64, f64),
    /// A principal point that is nowhere.
    #[error("a principal point at {0}, {1}: expected finite numbers of pixels")]
    NoPrincipalPoint(f64, f64),
    /// A lens of numbers that are none.
    #[error("coefficients of the distortion have to be finite numbers")]
    NoDistortion,
}

impl Camera {
    /// A camera of an image of `size_px` pixels. `principal_px` is the pixel that looks straight ahead.
    ///
    /// # Errors
    /// [`CameraError`].
    pub fn new(
        size_px: [u32; 2],
        focal_px: DVec2,
        principal_px: DVec2,
        distortion: Distortion,
    ) -> Result<Self, CameraError> {
        let [width, height] = size_px;
        if width == 0 || height == 0 {
            return Err(CameraError::NoPixels(width, height));
        }
        if !focal_px.is_finite() || focal_px.min_element() <= 0.0 {
            return Err(CameraError::NoFocalLength(focal_px.x, focal_px.y));
        }
        if !principal_px.is_finite() {
            return Err(CameraError::NoPrincipalPoint(principal_px.x, principal_px.y));
        }
        if !distortion.coefficients().iter().all(|k| k.is_finite()) {
            return Err(CameraError::NoDistortion);
        }
        let reach = distortion.reach();
        Ok(Self {
            size_px,
            focal_px,
            principal_px,
            distortion,
            reach,
        })
    }

    /// Width and height of its image.
    pub fn size_px(&self) -> [u32; 2] {
        self.size_px
    }

    /// Focal lengths along x and y.
    pub fn focal_px(&self) -> DVec2 {
        self.focal_px
    }

    /// The pixel that looks straight ahead.
    pub fn principal_px(&self) -> DVec2 {
        self.principal_px
    }

    /// Its lens.
    pub fn distortion(&self) -> &Distortion {
        &self.distortion
    }

    /// Projects `point` to the image, whether or not it is within its bounds; `None` behind the camera, and so far
    /// off-axis that the lens would fold it back.
    pub fn pixel(&self, point: DVec3) -> Option<DVec2> {
        if point.z <= 0.0 || point.z.is_nan() {
            return None;
        }
        let at = point.truncate() / point.z;
        // Polynomials fold back outside the image that they were fitted to: without this limit a colour camera would
        // show a point far off to the side in the centre.
        let is_within = at.length_squared() <= self.reach * self.reach;
        is_within.then(|| self.focal_px * self.distortion.distort(at) + self.principal_px)
    }

    /// The direction that `pixel` looks to, of length 1 along z; `None` where the lens shows nothing.
    pub fn ray(&self, pixel: DVec2) -> Option<DVec3> {
        let distorted = (pixel - self.principal_px) / self.focal_px;
        let at = self.distortion.undistort(distorted, self.reach)?;
        Some(at.extend(1.0))
    }

    /// Returns true if `pixel` is within the image bounds, the outer half of its border pixels included.
    pub fn contains(&self, pixel: DVec2) -> bool {
        let size = DVec2::new(f64::from(self.size_px[0]), f64::from(self.size_px[1]));
        pixel.cmpge(DVec2::splat(-0.5)).all() && pixel.cmple(size - 0.5).all()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Real lenses, as their makers and data sets give them.
    fn cameras() -> Vec<Camera> {
        let camera = |size, focal: [f64; 2], center: [f64; 2], distortion| {
            Camera::new(size, focal.into(), center.into(), distortion).unwrap()
        };
        vec![
            camera([640, 480], [525.0, 525.0], [319.5, 239.5], Distortion::None),
            // The colour camera of a Kinect.
            camera(
                [640, 480],
                [518.857_9, 519.469_6],
                [325.582_4, 253.736_2],
                Distortion::Brown {
                    k: [0.207_966_15, -0.586_138_25, 0.498_569_87],
                    p: [7.223_136e-4, 1.047_962_7e-3],
                },
            ),
            // A wide lens that pulls its corners in.
            camera(
                [752, 480],
                [458.654, 457.296],
                [367.215, 248.375],
                Distortion::Brown {
                    k: [-0.283_408_11, 0.073_959_07, 0.0],
                    p: [1.935_9e-4, 1.761_87e-5],
                },
            ),
            // An Azure Kinect's depth camera.
            camera(
                [640, 576],
                [504.6, 504.7],
                [321.8, 330.6],
                Distortion::Rational {
                    k: [5.257, 3.447, 0.181, 5.588, 5.157, 0.926],
                    p: [-8.1e-5, -3.6e-5],
                },
            ),
            // A fisheye of 160 degrees from corner to corner.
            camera(
                [848, 800],
                [420.0, 420.1],
                [422.1, 399.7],
                Distortion::Fisheye {
                    k: [-0.006_6, 0.042_8, -0.040_8, 0.007_6],
                },
            ),
        ]
    }

    #[test]
    fn pixels_come_back_from_their_rays() {
        for camera in cameras() {
            let [width, height] = camera.size_px();
            let mut seen = 0;
            for pixel in (0..height)
                .step_by(7)
                .flat_map(|v| (0..width).step_by(7).map(move |u| [u, v]))
            {
                let pixel = DVec2::new(f64::from(pixel[0]), f64::from(pixel[1]));
                let Some(ray) = camera.ray(pixel) else { continue };
                seen += 1;
                let back = camera.pixel(2.5 * ray).unwrap();
                assert!(back.distance(pixel) <= 1e-6, "{pixel} became {back} by {camera:?}");
            }
            let all = height.div_ceil(7) * width.div_ceil(7);
            assert!(seen * 10 >= all * 9, "{seen} of {all} pixels have rays: {camera:?}");
        }
    }

    #[test]
    fn pinhole_projection_is_a_division() {
        let camera = &cameras()[0];
        assert_eq!(camera.pixel(DVec3::new(0.0, 0.0, 2.0)), Some(DVec2::new(319.5, 239.5)));
        assert_eq!(
            camera.pixel(DVec3::new(1.0, -0.5, 2.0)),
            Some(DVec2::new(582.0, 108.25))
        );
        assert_eq!(camera.ray(DVec2::new(319.5, 764.5)), Some(DVec3::new(0.0, 1.0, 1.0)));
        for behind in [DVec3::new(0.0, 0.0, -2.0), DVec3::ZERO, DVec3::NAN] {
            assert_eq!(camera.pixel(behind), None);
        }
        assert!(camera.contains(DVec2::new(-0.5, 479.5)) && !camera.contains(DVec2::new(639.6, 0.0)));
    }

    /// Beyond the turn of its polynomial, a lens of negative k₁ would show the same pixel twice.
    #[test]
    fn rays_beyond_the_fold_of_a_lens_are_not_projected() {
        let lens = Distortion::Brown {
            k: [-0.3, 0.0, 0.0],
            p: [0.0; 2],
        };
        let camera = Camera::new([640, 480], DVec2::splat(450.0), DVec2::new(319.5, 239.5), lens).unwrap();
        let widest = camera.reach;
        // 1 = 3 · 0.3 · r².
        assert!((1.052..1.055).contains(&widest), "{widest}");
        assert!(camera.pixel(DVec3::new(0.99 * widest, 0.0, 1.0)).is_some());
        assert_eq!(camera.pixel(DVec3::new(1.01 * widest, 0.0, 1.0)), None);
        let rim = camera.pixel(DVec3::new(widest, 0.0, 1.0)).unwrap();
        assert_eq!(camera.ray(rim + DVec2::new(2.0, 0.0)), None);
    }

    #[test]
    fn invalid_camera_parameters_are_rejected() {
        let of = |size, focal: f64, center: f64, distortion| {
            Camera::new(size, DVec2::splat(focal), DVec2::splat(center), distortion).unwrap_err()
        };
        let none = || Distortion::None;
        assert_eq!(of([0, 480], 525.0, 0.0, none()), CameraError::NoPixels(0, 480));
        assert_eq!(of([4, 4], 0.0, 0.0, none()), CameraError::NoFocalLength(0.0, 0.0));
        assert!(matches!(
            of([4, 4], f64::NAN, 0.0, none()),
            CameraError::NoFocalLength(..)
        ));
        assert!(matches!(
            of([4, 4], 1.0, f64::INFINITY, none()),
            CameraError::NoPrincipalPoint(..)
        ));
        let curved = Distortion::Fisheye {
            k: [f64::NAN, 0.0, 0.0, 0.0],
        };
        assert_eq!(of([4, 4], 1.0, 0.0, curved), CameraError::NoDistortion);
    }

    fn distortions() -> impl Strategy<Value = Distortion> {
        let p = || [-0.003..0.003, -0.003..0.003];
        prop_oneof![
            ([-0.4..0.4, -0.6..0.6, -0.5..0.5], p()).prop_map(|(k, p)| Distortion::Brown { k, p }),
            ([-1.0..6.0, -1.0..4.0, -0.3..0.5, -1.0..6.0, -1.0..6.0, -0.3..1.0], p())
                .prop_map(|(k, p)| Distortion::Rational { k, p }),
            [-0.2..0.2, -0.1..0.1, -0.05..0.05, -0.02..0.02].prop_map(|k| Distortion::Fisheye { k }),
        ]
    }

    proptest! {
        /// For any lens, directions within its reach come back, up to where its tangential part turns.
        #[test]
        fn directions_and_pixels_round_trip(
            distortion in distortions(),
            share in 0.0..0.9_f64,
            angle in 0.0..std::f64::consts::TAU,
        ) {
            let camera =
                Camera::new([640, 480], DVec2::splat(525.0), DVec2::new(319.5, 239.5), distortion).unwrap();
            let at: DVec2 = DVec2::from_angle(angle) * (share * camera.reach.min(1.5));
            let pixel = camera.pixel(at.extend(1.0)).unwrap();
            if let Some(ray) = camera.ray(pixel) {
                let again = camera.pixel(ray).unwrap();
                prop_assert!(again.distance(pixel) <= 1e-6, "{pixel} became {again}");
            } else {
                prop_assert!(!camera.distortion.is_regular(at), "{at} has no ray at {pixel}");
            }
        }
    }
}
