//! View frusta as inward-facing planes, and the sphere test of frustum culling (the 4D media paper §VI-B).

use glam::{Mat4, Vec3, Vec4};

/// Position of a volume relative to a [`Frustum`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Containment {
    /// No part can be seen.
    Outside,
    /// Some part may be seen.
    Crossing,
    /// All of it is inside every plane: nothing within needs another test.
    Inside,
}

/// The five planes (left, right, bottom, top, near) of a perspective view whose far plane is at infinity.
///
/// A plane is `(normal, offset)` with unit normal pointing inwards: `dot(normal, p) + offset >= 0` inside.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frustum {
    planes: [Vec4; Self::PLANES],
}

impl Frustum {
    /// Number of planes.
    pub const PLANES: usize = 5;

    /// The frustum of a reverse-Z, infinite-far `clip_from_space` matrix, in that space.
    ///
    /// Planes are read off the matrix rows (Gribb and Hartmann): inside is
    /// `-w <= x <= w`, `-w <= y <= w` and `z <= w` (the near plane, where reversed depth is 1).
    pub fn from_clip_matrix(clip_from_space: &Mat4) -> Self {
        let [row_x, row_y, row_z, row_w] = [0, 1, 2, 3].map(|i| clip_from_space.row(i));
        let planes = [
            row_w + row_x,
            row_w - row_x,
            row_w + row_y,
            row_w - row_y,
            row_w - row_z,
        ];
        Self {
            planes: planes.map(|plane| plane / plane.truncate().length()),
        }
    }

    /// The planes as `(normal, offset)`.
    pub fn planes(&self) -> &[Vec4; Self::PLANES] {
        &self.planes
    }

    /// Conservative test of a sphere: never [`Containment::Outside`] when a part can be seen.
    pub fn sphere(&self, center: Vec3, radius: f32) -> Containment {
        let mut containment = Containment::Inside;
        for plane in &self.planes {
            let distance = plane.truncate().dot(center) + plane.w;
            if distance < -radius {
                return Containment::Outside;
            }
            if distance < radius {
                containment = Containment::Crossing;
            }
        }
        containment
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frustum() -> Frustum {
        // 90° square view from the origin along -Z, near plane at 1.
        Frustum::from_clip_matrix(&Mat4::from_cols(Vec4::X, Vec4::Y, Vec4::NEG_W, Vec4::Z))
    }

    #[test]
    fn spheres_are_classified_correctly() {
        let cases = [
            (Vec3::new(0.0, 0.0, -5.0), 0.5, Containment::Inside),
            (Vec3::new(0.0, 0.0, -1e6), 0.5, Containment::Inside),
            (Vec3::new(0.0, 0.0, 5.0), 0.5, Containment::Outside),
            (Vec3::new(0.0, 0.0, -1.0), 0.5, Containment::Crossing),
            (Vec3::new(5.0, 0.0, -5.0), 0.5, Containment::Crossing),
            (Vec3::new(7.0, 0.0, -5.0), 0.5, Containment::Outside),
            (Vec3::new(0.0, -7.0, -5.0), 0.5, Containment::Outside),
        ];
        for (center, radius, expected) in cases {
            assert_eq!(frustum().sphere(center, radius), expected, "{center}");
        }
    }
}
