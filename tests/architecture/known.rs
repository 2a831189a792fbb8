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

/// Files that import a feature of the window beyond its folder, and which. This list may shrink, never grow.
pub(crate) const FEATURES_NAMED_ELSEWHERE: &[(&str, &[&str])] = &[
    ("app/commands/window.rs", &["camera_path"]),
    ("app/features/beside/mod.rs", &["comparison"]),
    ("app/features/beside/panel.rs", &["comparison"]),
    ("app/features/inspection/in_window.rs", &["trails"]),
    ("app/features/labels/in_window.rs", &["inspection"]),
    ("app/features/palette/in_window.rs", &["benchmark"]),
    ("app/features/thumbnails/in_window.rs", &["benchmark"]),
    ("app/features/timeline/panel/bar.rs", &["thumbnails"]),
    ("app/features/timeline/panel/context.rs", &["thumbnails"]),
    ("app/features/timeline/panel/strip.rs", &["thumbnails"]),
    ("app/features/trails/mod.rs", &["inspection"]),
    ("app/features/trails/panel.rs", &["inspection"]),
    ("app/panels/clip.rs", &["clipping"]),
    ("app/panels/menu.rs", &["assumptions", "benchmark"]),
    ("app/panels/notices.rs", &["benchmark"]),
    ("app/panels/pair.rs", &["beside"]),
    ("app/panels/quality.rs", &["quality"]),
    ("app/panels/question.rs", &["camera_path"]),
    (
        "app/panels/settings.rs",
        &["clipping", "quality", "temporal", "thumbnails", "trails"],
    ),
    ("app/panels/viewport.rs", &["inspection"]),
    ("app/state/dialogs.rs", &["benchmark"]),
    ("app/state/first_look.rs", &["photos"]),
    ("app/state/keeper.rs", &["quality"]),
    ("app/state/keeping.rs", &["quality"]),
    ("app/state/opening_facts.rs", &["quality"]),
    ("app/state/outcome.rs", &["assumptions"]),
    ("app/state/pictures.rs", &["photos"]),
    ("app/state/session.rs", &["beside", "inspection", "quality"]),
];

/// Functions with parameters that are tuples, and how many: a pair that is made as one and handed on as one. This list
/// may shrink, never grow.
pub(crate) const TUPLES_IN_PARAMETERS: &[(&str, usize)] = &[
    ("io/formats/las/tests/fields.rs: rows", 2),
    ("io/recordings/packets/found.rs: entries", 1),
    ("io/recordings/packets/found.rs: name", 1),
    ("io/recordings/packets/traffic.rs: cut_of", 1),
    ("levels/spheres/tests.rs: tree_of", 1),
    ("reel/coder/symbols.rs: code", 1),
];
