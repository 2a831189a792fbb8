//! The knots that there were when they were first looked for. One that is smaller is made smaller here; none grows and
//! none is added.

pub(crate) const KNOTS: &[&[&str]] = &[
    &[
        "levels/octree/kept_levels.rs",
        "levels/octree/sorted_points.rs",
        "levels/octree/write.rs",
    ],
    &[
        "levels/octree/small_subtrees.rs",
        "levels/octree/traversal.rs",
    ],
    &[
        "render/cpu/primitives/coded/blocks.rs",
        "render/cpu/primitives/coded/decode.rs",
        "render/cpu/primitives/coded/mod.rs",
        "render/cpu/finish.rs",
        "render/cpu/grid.rs",
        "render/cpu/mod.rs",
        "render/cpu/screen.rs",
    ],
    &[
        "render/gpu/instancing/compute.rs",
        "render/gpu/instancing/mod.rs",
        "render/gpu/instancing/storage.rs",
        "render/gpu/instancing/texture.rs",
        "render/gpu/instancing/uniform.rs",
        "render/gpu/instancing/vertex.rs",
    ],
    &[
        "render/gpu/passes/attribute.rs",
        "render/gpu/passes/eye_dome.rs",
        "render/gpu/passes/grid.rs",
        "render/gpu/passes/mod.rs",
        "render/gpu/passes/point.rs",
        "render/gpu/passes/resolve.rs",
        "render/gpu/passes/solid.rs",
        "render/gpu/passes/splat.rs",
        "render/gpu/passes/visibility.rs",
    ],
    &["render/gpu/picture.rs", "render/gpu/renderer.rs"],
    &[
        "render/truth/surfels.rs",
        "render/truth/mod.rs",
        "render/truth/shapes.rs",
    ],
];
