//! The 16-byte records that are the paper's "mirrored copy of the point cloud" (000 §IV): uploaded with one copy, drawn
//! with one call, never rewritten for a view. Their WGSL twins are checked against these layouts by a test.

use bytemuck::{Pod, Zeroable};
use glam::{Vec2, Vec2Swizzles, Vec3};

// These records live here and not in `render/gpu`: worker threads in modules below the renderer write them.
/// Point record with the data that every mode needs.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct PointRecord {
    /// Relative to the sequence origin.
    pub position: [f32; 3],
    /// 8-bit red, green, blue, alpha.
    pub color: [u8; 4],
}

/// Shape record with the data that surfels need beyond a [`PointRecord`].
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct ShapeRecord {
    /// Unit normal on the octahedron, see [`oct_encode`].
    pub normal: [i16; 2],
    /// Half edge length of the splat in scene units; of an ellipse the quadratic mean of its half axes, so that the
    /// corners of the rectangle around it are √2 radii away however thin it is.
    // The quadratic mean and not the geometric one of `Ellipse`: one bound on the extent serves blocks, culling and
    // picking of disks and ellipses alike, and estimated ellipses are drawn as disks by ignoring `ellipse`.
    pub radius: f32,
    /// Anisotropic extents, see [`super::encode_ellipse`]; 0 is a circle.
    pub ellipse: u32,
    /// The point's free scalar.
    pub scalar: f32,
}

/// One drawn octree cell: a cube with edge `octree cube edge / 2^level`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct VoxelRecord {
    /// Centre of the cell, relative to the sequence origin.
    pub center: [f32; 3],
    /// Mean 8-bit colour of the points inside.
    pub color: [u8; 3],
    /// Octree level of the cell; the root is 0.
    pub level: u8,
}

/// A corner of triangles.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct VertexRecord {
    /// Relative to the sequence origin.
    pub position: [f32; 3],
    /// 8-bit red, green, blue, alpha.
    pub color: [u8; 4],
    /// Texture coordinates: 0 to 1 from left to right and from top to bottom; beyond, the texture repeats.
    pub texture_place: [f32; 2],
    /// Unit normal on the octahedron, see [`oct_encode`], or [`VertexRecord::NO_NORMAL`].
    pub normal: [i16; 2],
    /// Index of its texture, or [`VertexRecord::NO_TEXTURE`].
    pub texture: u32,
}

impl VertexRecord {
    /// Light falls on the faces at this vertex. [`oct_encode`] never makes these numbers.
    pub const NO_NORMAL: [i16; 2] = [i16::MIN; 2];
    /// The vertex has no colour but its own.
    pub const NO_TEXTURE: u32 = u32::MAX;
}

/// A triangle of [`VertexRecord`]s; or a point, where all of its corners are the same vertex.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Pod, Zeroable)]
pub struct TriangleRecord {
    /// Indices of vertices, counter-clockwise as the file has them.
    pub corners: [u32; 3],
    /// Unit normal of the face on the octahedron.
    pub normal: [i16; 2],
}

impl TriangleRecord {
    /// Returns true if it is a vertex that belongs to no triangle.
    pub fn is_point(&self) -> bool {
        self.corners == [self.corners[0]; 3]
    }
}

/// Packs a unit vector into two snorm16 by folding the octahedron (Meyer et al. 2010).
///
/// Error: below 0.005 degrees. The zero vector becomes +Z.
pub fn oct_encode(unit: Vec3) -> [i16; 2] {
    let norm1 = unit.x.abs() + unit.y.abs() + unit.z.abs();
    if norm1 == 0.0 {
        return [0, 0];
    }
    let mut folded = Vec2::new(unit.x, unit.y) / norm1;
    if unit.z < 0.0 {
        folded = (Vec2::ONE - folded.yx().abs()) * sign_not_zero(folded);
    }
    // Rounds halves away from zero, like `round`, which is a function call on CPUs for which no features are assumed.
    let scaled = folded * f32::from(i16::MAX);
    (scaled + 0.5 * sign_not_zero(scaled))
        .to_array()
        .map(|component| component as i16)
}

/// The unit vector that [`oct_encode`] packed.
pub fn oct_decode(packed: [i16; 2]) -> Vec3 {
    let folded = Vec2::from_array(packed.map(f32::from)) / f32::from(i16::MAX);
    let z = 1.0 - folded.x.abs() - folded.y.abs();
    let xy = if z < 0.0 {
        (Vec2::ONE - folded.yx().abs()) * sign_not_zero(folded)
    } else {
        folded
    };
    xy.extend(z).normalize()
}

fn sign_not_zero(v: Vec2) -> Vec2 {
    Vec2::select(v.cmpge(Vec2::ZERO), Vec2::ONE, Vec2::NEG_ONE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn normals_round_trip_through_packing(x in -1.0f32..1.0, y in -1.0f32..1.0, z in -1.0f32..1.0) {
            let v = Vec3::new(x, y, z);
            prop_assume!(v.length() > 1e-3);
            let unit = v.normalize();
            let decoded = oct_decode(oct_encode(unit));
            // The chord is the angle for small angles, and unlike acos it is exact there.
            prop_assert!((decoded - unit).length().to_degrees() < 0.005, "{unit} became {decoded}");
        }
    }

    #[test]
    fn axes_are_exact() {
        for axis in [Vec3::X, Vec3::Y, Vec3::Z, Vec3::NEG_X, Vec3::NEG_Y, Vec3::NEG_Z] {
            assert_eq!(oct_decode(oct_encode(axis)), axis);
        }
    }
}
