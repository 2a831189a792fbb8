//! The knots that there were when they were first looked for. One that is smaller is made smaller here; none grows and
//! none is added.

pub(crate) const KNOTS: &[&[&str]] = &[
    &[
        "levels/octree/kept_levels.rs",
        "levels/octree/sorted_points.rs",
        "levels/octree/write.rs",
    ],
    &["levels/octree/small_subtrees.rs", "levels/octree/traversal.rs"],
];
