//! The knots that there were when they were first looked for. One that is smaller is made smaller here; none grows and
//! none is added.

pub(crate) const KNOTS: &[&[&str]] = &[
    &[
        "levels/octree/cached_levels.rs",
        "levels/octree/sorted_points.rs",
        "levels/octree/write.rs",
    ],
    &["levels/octree/small_subtrees.rs", "levels/octree/traversal.rs"],
];

/// Files that import a feature of the window beyond its folder, and which. This list may shrink, never grow.
pub(crate) const FEATURES_NAMED_ELSEWHERE: &[(&str, &[&str])] = &[
    ("app/features/split_view/mod.rs", &["comparison"]),
    ("app/features/split_view/panel.rs", &["comparison"]),
    ("app/features/inspection/in_window.rs", &["trails"]),
    ("app/features/labels/in_window.rs", &["inspection"]),
    ("app/features/timeline/panel/bar.rs", &["thumbnails"]),
    ("app/features/timeline/panel/context.rs", &["thumbnails"]),
    ("app/features/timeline/panel/strip.rs", &["thumbnails"]),
    ("app/features/trails/mod.rs", &["inspection"]),
    ("app/features/trails/panel.rs", &["inspection"]),
];

/// Functions with tuples as parameters, and their number: a pair that is made as one and handed on as one. This list
/// may shrink, never grow.
pub(crate) const TUPLES_IN_PARAMETERS: &[(&str, usize)] = &[
    ("io/formats/las/tests/fields.rs: rows", 2),
    ("io/recordings/packets/found.rs: entries", 1),
    ("io/recordings/packets/found.rs: name", 1),
    ("io/recordings/packets/traffic.rs: cut_of", 1),
    ("levels/spheres/tests.rs: tree_of", 1),
    ("reel/coder/symbols.rs: code", 1),
];
