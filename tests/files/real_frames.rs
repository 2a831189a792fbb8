//! The per-frame engine on real scans: an animated body, an RGB-D camera with holes, a laser scanner, and the demo.

#![allow(clippy::print_stdout, reason = "what was measured, for `--nocapture`")]

use crate::data::shared;
use glam::{DVec3, Vec3};
use pointreel::{
    analysis::{Neighbours, Surface, estimate_surface, nearest_neighbours},
    cloud::{Frame, RawCloud},
    io,
    levels::octree::{Octree, StopCriterion},
};
use std::{
    collections::BTreeSet,
    path::{Path, PathBuf},
};

/// The first frame of each sequence there is.
fn frames() -> Vec<(PathBuf, Frame)> {
    let demo = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/demo");
    let scans = [
        "sequences/cesiumman_24fps",
        "sequences/pcl_openni_3frames/pcd",
        "sequences/ouster_os1_128_3scans",
        "sequences/ouster_8beam_10scans",
    ];
    let scans = scans.into_iter().filter_map(shared);
    [demo]
        .into_iter()
        .chain(scans)
        .map(|folder| {
            let mut files: Vec<PathBuf> = std::fs::read_dir(folder)
                .expect("the folder is there")
                .map(|entry| entry.expect("folders can be listed").path())
                .filter(|path| {
                    let extension = path.extension().unwrap_or_default();
                    extension == "ply" || extension == "pcd"
                })
                .collect();
            files.sort();
            let path = files.into_iter().next().expect("a folder of frames");
            let raw: RawCloud = io::read(&path).expect("real frames can be read");
            let frame = Frame::from_raw(raw, DVec3::ZERO).expect("attributes are complete");
            (path, frame)
        })
        .collect()
}

#[test]
fn octrees_contain_the_cells_of_their_points() {
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
                    let share = (position.as_dvec3() - cube.min) / f64::from(cube.edge);
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
            // No frame here has too many duplicates for δ to be met.
            assert!(tree.loss() <= delta, "{}", path.display());
        }
    }
}

#[test]
fn surfaces_are_defined_and_gapless() {
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
            assert!(*radius > 0.0 && *radius < largest, "{radius} in {}", path.display());
        }
    }
}

/// Points are close if they are among each other's nearest points, this many.
const CLOSE: usize = 6;

/// Points whose disks may cover a triangle; leaving out those farther away can only make more holes.
const AROUND: usize = 24;

/// Rays that may find a hole: of a scanner's few beams all close points are on one beam, which is curved and has no
/// plane.
const OPEN: f64 = 0.002;

/// Rays that must find one when disks have a quarter of their radius, or the test would see none at all.
const OPEN_AT_A_QUARTER: f64 = 0.05;

/// Fraction of rays that hit the surface but no disk of `scale` times its radius.
///
/// The surface of a scan is known only between points; so it is taken to be the triangles whose corners are all close
/// to each other. A ray goes through the centre of each, along the mean of the normals of its corners. It hits a disk
/// around it no farther from the triangle than the disk's radius, unless the disk is seen edge-on.
fn open_share(positions: &[Vec3], surface: &Surface, lists: &Neighbours, scale: f32) -> f64 {
    let knows = |point: u32, other: u32| lists.of(point as usize)[..CLOSE].contains(&other);
    let know_each_other = |a, b| knows(a, b) && knows(b, a);
    let (mut rays, mut holes) = (0u32, 0u32);
    for point in 0..positions.len() as u32 {
        let near = &lists.of(point as usize)[..CLOSE];
        for (place, &a) in near.iter().enumerate() {
            for &b in &near[place + 1..] {
                // Each triangle is counted at its first corner.
                let is_first = point < a && point < b;
                let is_surface = know_each_other(point, a) && know_each_other(point, b) && know_each_other(a, b);
                if !(is_first && is_surface) {
                    continue;
                }
                let [p, q, r] = [point, a, b].map(|corner| positions[corner as usize]);
                // Normals may have either sign if there is no sensor and no closed surface.
                let first = surface.normals[point as usize];
                let direction = [a, b].into_iter().fold(first, |sum, corner| {
                    let normal = surface.normals[corner as usize];
                    sum + normal * normal.dot(first).signum()
                });
                let direction = direction.normalize();
                rays += 1;
                let center = (p + q + r) / 3.0;
                let around = lists.of(point as usize).iter().copied().chain([point]);
                let is_covered = around.into_iter().any(|disk| {
                    let disk = disk as usize;
                    let (normal, radius) = (surface.normals[disk], scale * surface.radii[disk]);
                    let offset = positions[disk] - center;
                    let slope = normal.dot(direction);
                    let along = normal.dot(offset) / slope;
                    let hit = direction * along;
                    slope.abs() > 0.2 && along.abs() <= radius && (hit - offset).length_squared() <= radius * radius
                });
                holes += u32::from(!is_covered);
            }
        }
    }
    assert!(rays > 1000, "{rays} rays prove nothing");
    f64::from(holes) / f64::from(rays)
}

#[test]
fn disks_close_the_surfaces_of_real_frames() {
    for (path, frame) in frames() {
        let positions = frame.positions();
        let surface = estimate_surface(positions, frame.sensor());
        let lists = nearest_neighbours(positions, AROUND);
        let [open, at_a_quarter] = [1.0, 0.25].map(|scale| open_share(positions, &surface, &lists, scale));
        println!(
            "{}: {:.4} % of the rays find a hole, {:.1} % at a quarter of the radius",
            path.display(),
            100.0 * open,
            100.0 * at_a_quarter
        );
        assert!(open <= OPEN, "{open} of {} is open", path.display());
        assert!(
            at_a_quarter >= OPEN_AT_A_QUARTER,
            "a quarter of the radius would do for {}: {at_a_quarter}",
            path.display()
        );
    }
}
