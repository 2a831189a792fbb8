//! Transform from the space of a frame to homogeneous pixels, by additions (Botsch et al. 2002 §4).
//!
//! How it works: pixels times distance, `(u, v, w) = M·(p − eye)`, are linear in a point. The centre of a child is its
//! parent's plus one of eight vectors `±h/2`, so its projection is its parent's plus the projection of the vector,
//! computed once per frame for all octants of all levels; the vectors of one level are half of those above it, exactly.
//! With four children per node that is 4/3 additions of three numbers per leaf, and no product.

use crate::math::Cube;
use crate::math::morton::LEVELS;
use crate::render::cpu::view::PixelView;
use glam::{Vec3, Vec4};

/// The image of an octree under one camera. The fourth component of all vectors is 0: they are whole registers.
#[derive(Debug)]
pub(super) struct Transform {
    /// Projected centre of the root.
    pub(super) root: Vec4,
    /// Vectors from the centre of a node to its child's on a level, by octant; level 0 is not used.
    pub(super) to_child: [[Vec4; 8]; LEVELS as usize + 1],
    /// Half the edges of the boxes around the images of the root, and half their distances.
    root_extent: Vec3,
}

impl Transform {
    pub(super) fn new(view: &PixelView, cube: &Cube) -> Self {
        let root_center = cube.cell_center(0, [0; 3]);
        let offset = view.offset_from_eye(root_center.to_array());
        let root = homogeneous(view, view.rotate(offset)).extend(0.0);
        let axes = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| {
            let half_edge = view.rotate(axis * (0.5 * cube.edge));
            homogeneous(view, half_edge)
        });
        let mut to_child = [[Vec4::ZERO; 8]; LEVELS as usize + 1];
        for (level, steps) in to_child.iter_mut().enumerate().skip(1) {
            let scale = 0.5f32.powi(level as i32);
            for (octant, step) in steps.iter_mut().enumerate() {
                let along = |axis: usize| {
                    let sign = if octant >> axis & 1 == 0 { -1.0 } else { 1.0 };
                    axes[axis] * sign
                };
                *step = ((along(0) + along(1) + along(2)) * scale).extend(0.0);
            }
        }
        let root_extent = axes[0].abs() + axes[1].abs() + axes[2].abs();
        Self {
            root,
            to_child,
            root_extent,
        }
    }

    /// Returns half the depth of a cell of a level: the distance of its nearest point is its centre's less this.
    pub(super) fn half_depth(&self, level: u32) -> f32 {
        self.root_extent.z * 0.5f32.powi(level as i32)
    }

    /// Octants from the nearest to the farthest.
    pub(super) fn front_to_back(&self) -> [usize; 8] {
        let mut octants = [0, 1, 2, 3, 4, 5, 6, 7];
        octants.sort_by(|&a, &b| self.to_child[1][a].z.total_cmp(&self.to_child[1][b].z));
        octants
    }
}

/// A vector in view space as pixels times distance.
pub(super) fn homogeneous(view: &PixelView, vector: Vec3) -> Vec3 {
    let distance = -vector.z;
    let [x, y] = [0, 1].map(|axis| view.px_per_slope[axis] * vector[axis] + view.center_px[axis] * distance);
    Vec3::new(x, y, distance)
}

/// The vector in view space that is these pixels times distance.
pub(super) fn in_view(view: &PixelView, pixels: Vec4) -> Vec3 {
    let [x, y] = [0, 1].map(|axis| (pixels[axis] - view.center_px[axis] * pixels.z) / view.px_per_slope[axis]);
    Vec3::new(x, y, -pixels.z)
}
