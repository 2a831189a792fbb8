//! Passes over records. `primitives` assigns them to primitives.

use super::state::{ADDED, ColorUse, DepthUse, GeometryPass, OVER, PREMULTIPLIED};
use crate::render::gpu::targets::Target;
use crate::render::gpu::wgsl::shader_file;

/// Depths of the disks and nothing else (the 4D media paper §V-B, first pass).
pub(in crate::render::gpu) const VISIBILITY: GeometryPass = GeometryPass {
    name: "visibility",
    file: shader_file!("passes/visibility.wgsl"),
    color: None,
    depth: Some(DepthUse::TestAndWrite),
};

/// Depths of faces and nothing else: the output of cells in a shadow map.
pub(in crate::render::gpu) const DEPTH: GeometryPass = GeometryPass {
    name: "depth",
    file: shader_file!("passes/depth.wgsl"),
    ..VISIBILITY
};

/// [`VISIBILITY`] with the squares around the disks.
pub(in crate::render::gpu) const VISIBILITY_SQUARE: GeometryPass = GeometryPass {
    name: "visibility of squares",
    file: shader_file!("passes/visibility_square.wgsl"),
    ..VISIBILITY
};

/// Sums colours and weights of fragments that pass the depth test against the visibility pass (the 4D media paper §V-B,
/// second pass; normalised sums instead of ordered blending, as in Sainz and Pajarola 2004, so that no order is
/// needed).
pub(in crate::render::gpu) const ATTRIBUTE: GeometryPass = GeometryPass {
    name: "attribute",
    file: shader_file!("passes/attribute.wgsl"),
    color: Some(ColorUse {
        target: Target::Sums,
        blend: Some(ADDED),
    }),
    depth: Some(DepthUse::TestOnly),
};

/// One-pass splatting: blended in the order of the cloud, with depth (Fig. 3a).
pub(in crate::render::gpu) const REGULAR: GeometryPass = GeometryPass {
    name: "splat",
    file: shader_file!("passes/splat.wgsl"),
    color: Some(ColorUse {
        target: Target::Picture,
        blend: Some(OVER),
    }),
    depth: Some(DepthUse::TestAndWrite),
};

/// One-pass splatting without depth (Fig. 3b).
pub(in crate::render::gpu) const NO_DEPTH: GeometryPass = GeometryPass {
    name: "splat without depth",
    depth: None,
    ..REGULAR
};

/// Hard disks: the nearest is seen (Sainz and Pajarola 2004, Fig. 5).
pub(in crate::render::gpu) const OPAQUE: GeometryPass = GeometryPass {
    name: "opaque",
    file: shader_file!("passes/opaque.wgsl"),
    ..SOLID
};

/// Opaque faces in their light (the 4D media paper §VI-B), and triangles.
pub(in crate::render::gpu) const SOLID: GeometryPass = GeometryPass {
    name: "solid",
    file: shader_file!("passes/solid.wgsl"),
    color: Some(ColorUse::replacing(Target::Picture)),
    depth: Some(DepthUse::TestAndWrite),
};

/// Opaque pass with round points.
pub(in crate::render::gpu) const ROUND_SOLID: GeometryPass = GeometryPass {
    name: "round solid",
    file: shader_file!("passes/round_solid.wgsl"),
    ..SOLID
};

/// Plain points without light: the cheapest rendering of a cloud.
pub(in crate::render::gpu) const POINT: GeometryPass = GeometryPass {
    name: "point",
    file: shader_file!("passes/point.wgsl"),
    ..SOLID
};

/// Plain points without light, drawn round: the disks in the squares.
pub(in crate::render::gpu) const ROUND_POINT: GeometryPass = GeometryPass {
    name: "round point",
    file: shader_file!("passes/round_point.wgsl"),
    ..POINT
};

/// Attribute pass for deferred shading, which accumulates normals as well.
pub(in crate::render::gpu) const SURFACE_ATTRIBUTE: GeometryPass = GeometryPass {
    name: "surface attribute",
    file: shader_file!("passes/surface_splat.wgsl"),
    color: Some(ColorUse {
        target: Target::Surfaces,
        blend: Some(ADDED),
    }),
    depth: Some(DepthUse::TestOnly),
};

/// One-pass splatting for deferred shading, with depth.
pub(in crate::render::gpu) const SURFACE_REGULAR: GeometryPass = GeometryPass {
    name: "surface splat",
    color: Some(ColorUse {
        target: Target::Surfaces,
        blend: Some(PREMULTIPLIED),
    }),
    depth: Some(DepthUse::TestAndWrite),
    ..SURFACE_ATTRIBUTE
};

/// And without.
pub(in crate::render::gpu) const SURFACE_NO_DEPTH: GeometryPass = GeometryPass {
    name: "surface splat without depth",
    depth: None,
    ..SURFACE_REGULAR
};

/// Opaque faces and triangles for deferred shading.
pub(in crate::render::gpu) const SURFACE_SOLID: GeometryPass = GeometryPass {
    name: "surface solid",
    file: shader_file!("passes/surface_solid.wgsl"),
    color: Some(ColorUse::replacing(Target::Surfaces)),
    depth: Some(DepthUse::TestAndWrite),
};

/// Opaque pass for deferred shading, with round points.
pub(in crate::render::gpu) const SURFACE_ROUND_SOLID: GeometryPass = GeometryPass {
    name: "surface round solid",
    file: shader_file!("passes/surface_round_solid.wgsl"),
    ..SURFACE_SOLID
};

/// Hard disks for deferred shading.
pub(in crate::render::gpu) const SURFACE_OPAQUE: GeometryPass = GeometryPass {
    name: "surface opaque",
    file: shader_file!("passes/surface_opaque.wgsl"),
    ..SURFACE_SOLID
};
