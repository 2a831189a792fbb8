//! The per-frame engine on real scans: an animated body, an RGB-D camera with holes, a laser scanner, and the demo.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use glam::DVec3;
use pointreel::{
    analysis::estimate_surface,
    cloud::{Frame, RawCloud},
    io,
    octree::{Octree, StopCriterion},
};
use std::{
    collections::BTreeSet,
    path::{Path, PathBuf},
};

/// The first frame of each sequence there is.
fn frames() -> Vec<(PathBuf, Frame)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    [
        root.join("assets/demo"),
        root.join("../shared/data/sequences/cesiumman_24fps"),
        root.join("../shared/data/sequences/pcl_openni_3frames"),
        root.join("../shared/data/sequences/ouster_os1_128_3scans"),
        root.join("../shared/data/sequences/ouster_8beam_10scans"),
    ]
    .iter()
    .filter_map(|folder| {
        let mut files: Vec<PathBuf> = std::fs::read_dir(folder)
            .ok()?
            .map(|entry| entry.expect("folders can be listed").path())
            .filter(|path| {
                let extension = path.extension().unwrap_or_default();
                extension == "ply" || extension == "pcd"
            })
            .collect();
        files.sort();
        let path = files.into_iter().next()?;
        let raw: RawCloud = io::read(&path).expect("real frames can be read");
        let frame = Frame::from_raw(raw, DVec3::ZERO).expect("attributes are complete");
        Some((path, frame))
    })
    .collect()
}

#[test]
fn octrees_hold_the_cells_of_their_points() {
    let frames = frames();
    assert!(!frames.is_empty(), "the demo at least");
    for (path, frame) in frames {
        let positions = frame.positions();
        let colors = vec![[90; 4]; positions.len()];
        for delta in [0.02, 0.1, 0.5] {
            let tree = Octree::build(positions, &colors, StopCriterion::Loss(delta));
            let cube = tree.cube();
            let along = f64::from(1u32 << tree.depth());
            let expected: BTreeSet<[u32; 3]> = positions
                .iter()
                .map(|position| {
                    let share = (position.as_dvec3() - cube.min.as_dvec3()) / f64::from(cube.edge);
                    share
                        .to_array()
                        .map(|share| (share * along).floor().min(along - 1.0) as u32)
                })
                .collect();
            let cells = Octree::cells_from_masks(&tree.masks(), tree.depth()).unwrap();
            let count = cells.len();
            assert_eq!(
                cells.into_iter().collect::<BTreeSet<_>>(),
                expected,
                "{}",
                path.display()
            );
            assert_eq!(tree.leaf_count(), count);
            // No frame here has so many duplicates that δ could not be kept.
            assert!(tree.loss() <= delta, "{}", path.display());
        }
    }
}

#[test]
fn surfaces_are_defined_and_close_knit() {
    for (path, frame) in frames() {
        let surface = estimate_surface(frame.positions(), frame.sensor());
        assert!(
            surface.normals.iter().all(|normal| normal.is_normalized()),
            "{}",
            path.display()
        );
        // Positive, and no disk larger than a tenth of the scene.
        let largest = frame.bounds().extent().max_element() * 0.1;
        for radius in &surface.radii {
            assert!(
                *radius > 0.0 && *radius < largest,
                "{radius} in {}",
                path.display()
            );
        }
    }
}
