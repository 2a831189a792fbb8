//! Lens distortion: the mapping from directions to positions on the image plane, at a focal length of 1.
//!
//! *How it works.* Models are polynomials of the distance from the axis (Brown 1971, as OpenCV orders the coefficients)
//! or of the angle from it (Kannala and Brandt 2006). They are fitted to the image, and mean nothing beyond the radius
//! at which they turn back: `reach` is that radius. Within it the inverse is found by Newton steps, which are halved
//! until they come nearer.

mod fisheye;
mod radial;
mod turn;

use glam::DVec2;
use radial::Radial;
use turn::WIDEST;

/// The lens of a camera.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Distortion {
    /// None: a pinhole.
    #[default]
    None,
    /// Radial k₁ k₂ k₃ and tangential p₁ p₂ (Brown 1971).
    Brown {
        /// k₁, k₂, k₃.
        k: [f64; 3],
        /// p₁, p₂.
        p: [f64; 2],
    },
    /// Polynomial distortion divided by another one, of k₄ k₅ k₆.
    Rational {
        /// k₁ to k₆.
        k: [f64; 6],
        /// p₁, p₂.
        p: [f64; 2],
    },
    /// A polynomial of the angle from the axis (Kannala and Brandt 2006).
    Fisheye {
        /// Coefficients of θ³, θ⁵, θ⁷ and θ⁹.
        k: [f64; 4],
    },
}

impl Distortion {
    /// Its model in a word.
    pub fn name(&self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Brown { .. } => "brown",
            Self::Rational { .. } => "rational",
            Self::Fisheye { .. } => "fisheye",
        }
    }

    /// Its coefficients, in the order of OpenCV: k₁ k₂ p₁ p₂ k₃ to k₆, or the coefficients of the angle.
    pub fn coefficients(&self) -> Vec<f64> {
        match *self {
            Self::None => Vec::new(),
            Self::Brown {
                k: [k1, k2, k3],
                p: [p1, p2],
            } => vec![k1, k2, p1, p2, k3],
            Self::Rational { k, p: [p1, p2] } => vec![k[0], k[1], p1, p2, k[2], k[3], k[4], k[5]],
            Self::Fisheye { k } => k.to_vec(),
        }
    }

    /// The polynomials of the distance, if it is of those.
    fn radial(&self) -> Option<Radial> {
        match *self {
            Self::None | Self::Fisheye { .. } => None,
            Self::Brown { k: [k1, k2, k3], p } => Some(Radial {
                k: [k1, k2, k3, 0.0, 0.0, 0.0],
                p,
            }),
            Self::Rational { k, p } => Some(Radial { k, p }),
        }
    }

    /// Distance from the axis, on the plane at 1, up to which directions stay in order.
    pub(super) fn reach(&self) -> f64 {
        match self {
            Self::None => WIDEST,
            Self::Fisheye { k } => fisheye::widest_angle(k).tan(),
            Self::Brown { .. } | Self::Rational { .. } => self.radial().map_or(WIDEST, |radial| radial.reach()),
        }
    }

    /// Returns the distorted position of the direction through `at` on the plane at 1. Precondition: it is within
    /// reach.
    pub(super) fn distort(&self, at: DVec2) -> DVec2 {
        match self {
            Self::None => at,
            Self::Fisheye { k } => fisheye::distort(k, at),
            Self::Brown { .. } | Self::Rational { .. } => self.radial().map_or(at, |radial| radial.distort(at)),
        }
    }

    /// The inverse of [`Self::distort`] within `reach`; `None` for places where no such direction is shown.
    pub(super) fn undistort(&self, distorted: DVec2, reach: f64) -> Option<DVec2> {
        let found = match self {
            Self::None => Some(distorted),
            Self::Fisheye { k } => fisheye::undistort(k, distorted, reach.atan()),
            Self::Brown { .. } | Self::Rational { .. } => self.radial()?.undistort(distorted, reach),
        };
        found.filter(|at| at.length_squared() <= reach * reach)
    }

    /// Returns true if the distortion stays regular: the tangential part keeps directions around `at` in order too.
    #[cfg(test)]
    pub(super) fn is_regular(&self, at: DVec2) -> bool {
        self.radial().is_none_or(|radial| radial.stays_regular_to(at))
    }
}
