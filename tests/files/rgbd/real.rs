//! Recordings that other programs made.

use super::{open, open_with, points};
use crate::data::shared;
use glam::DVec3;
use pointreel::io;
use pointreel::sequence::Sequence;
use pointreel::source::RgbdOptions;
use std::path::Path;

/// Depths and colours of PCL's grabber are its own clouds.
#[test]
fn pcl_depth_images_match_its_clouds() {
    let Some(folder) = shared("sequences/pcl_openni_3frames") else {
        return;
    };
    let sequence = open(&folder.join("tiff"));
    assert_eq!(sequence.len(), 3);
    for (frame, valid) in [271_575, 271_395, 271_328].into_iter().enumerate() {
        let cloud = sequence.decode(frame).unwrap();
        let entry = sequence.entry(frame);
        let name = entry.name.replace("_depth.tiff", ".pcd");
        let expected = io::read(&folder.join("pcd").join(name)).unwrap();
        assert_eq!(cloud.positions.finite_bounds().0, valid);
        assert_eq!(cloud.grid, expected.grid);
        let mut furthest: f64 = 0.0;
        for (found, expected) in points(&cloud).into_iter().zip(points(&expected)) {
            assert_eq!(found.is_finite(), expected.is_finite());
            if expected.is_finite() {
                furthest = furthest.max((found - expected).abs().max_element());
            }
        }
        assert!(furthest <= 1e-6, "frame {frame} is off by {furthest}");
        assert_eq!(cloud.attributes.colors, expected.attributes.colors);
        assert!(entry.time.is_some());
    }
}

fn redwood(options: RgbdOptions) -> Option<Sequence> {
    let folder = shared("rgbd/open3d_redwood_5frames")?;
    Some(open_with(&folder, options).unwrap())
}

#[test]
fn frames_of_redwood_have_the_points_that_open3d_finds() {
    let Some(sequence) = redwood(RgbdOptions::default()) else {
        return;
    };
    let counts: Vec<usize> = (0..sequence.len())
        .map(|frame| sequence.decode(frame).unwrap().positions.finite_bounds().0)
        .collect();
    assert_eq!(counts, [267_129, 267_728, 268_183, 268_620, 269_051]);
}

/// Frame 4 seen by the camera of frame 0: a few millimetres, if the trajectory leads from the camera to the world.
#[test]
fn the_trajectory_of_redwood_leads_from_the_camera_to_the_world() {
    let Some(sequence) = redwood(RgbdOptions::default()) else {
        return;
    };
    let clouds = [0, 4].map(|frame| points(&sequence.decode(frame).unwrap()));
    let sensors = [0, 4].map(|frame| sequence.source().sensor(frame).unwrap());
    let camera = &sensors[0].rig.depth;
    let [first, last] = sensors.clone().map(|sensor| sensor.world_from_camera.unwrap());
    let median_difference = |first_from_last: glam::DAffine3| {
        let mut differences: Vec<f64> = clouds[1]
            .iter()
            .filter(|point| point.is_finite())
            .filter_map(|&point| {
                let point = first_from_last.transform_point3(point);
                let pixel = camera.pixel(point).filter(|&pixel| camera.contains(pixel))?.round();
                let there: DVec3 = clouds[0][pixel.y as usize * 640 + pixel.x as usize];
                there.is_finite().then(|| (there.z - point.z).abs())
            })
            .collect();
        assert!(differences.len() > 200_000);
        differences.sort_by(f64::total_cmp);
        differences[differences.len() / 2]
    };
    let right = median_difference(first.inverse() * last);
    let inverted = median_difference(first * last.inverse());
    assert!((0.0055..0.0059).contains(&right), "{right}");
    assert!(inverted > 0.1, "{inverted}");
}

/// The recording that is written again as folders of a cloud a frame has the same points: it is an ordinary source.
#[test]
fn merged_frames_of_redwood_have_all_points() {
    let merged = RgbdOptions {
        merge: Some((0, 4)),
        ..RgbdOptions::default()
    };
    let Some(sequence) = redwood(merged) else { return };
    let cloud = sequence.decode(0).unwrap();
    assert_eq!(cloud.positions.len(), 267_129 + 267_728 + 268_183 + 268_620 + 269_051);
    assert_eq!(cloud.positions.finite_bounds().0, cloud.positions.len());
}

/// The first of the merged frames compared with the same frame alone. Filtered, its points are on planes.
#[test]
fn merged_frames_of_redwood_have_normals_facing_their_cameras() {
    let of = |filters, merge| {
        redwood(RgbdOptions {
            filters,
            merge,
            ..RgbdOptions::default()
        })
    };
    for filters in [pointreel::rgbd::Filters::default(), pointreel::rgbd::Filters::USUAL] {
        let Some(recording) = of(filters, None) else { return };
        let merged = of(filters, Some((0, 1))).unwrap().decode(0).unwrap();
        let normals = merged.attributes.normals.as_ref().unwrap();
        assert_eq!(normals.len(), merged.positions.len());
        let world_from_camera = recording.source().sensor(0).unwrap().world_from_camera.unwrap();
        let alone = points(&recording.decode(0).unwrap());
        let alone = alone.into_iter().filter(|point| point.is_finite());
        let (mut count, mut moved) = (0, 0);
        for (at, alone) in alone.enumerate() {
            let point = world_from_camera.inverse().transform_point3(merged.positions.get(at));
            let turned = world_from_camera.matrix3.inverse() * glam::Vec3::from(normals[at]).as_dvec3();
            assert!((turned.length() - 1.0).abs() < 1e-5, "{turned}");
            assert!(turned.dot(point) < 1e-5, "{turned} at {point}");
            assert!(
                (point / point.z - alone / alone.z).length() < 1e-5,
                "{point} and {alone}"
            );
            assert!((point.z / alone.z - 1.0).abs() < 0.05, "{point} and {alone}");
            count += 1;
            moved += usize::from((point - alone).length() > 1e-4);
        }
        let is_filtered = filters.bilateral.is_some();
        assert!(
            if is_filtered { 2 * moved > count } else { moved == 0 },
            "{moved} of {count}"
        );
    }
}

#[test]
fn filters_on_real_frames_retain_what_they_should() {
    let Some(sequence) = redwood(RgbdOptions {
        filters: "median,bilateral".parse().unwrap(),
        ..RgbdOptions::default()
    }) else {
        return;
    };
    // Neither fills nor makes holes.
    assert_eq!(sequence.decode(0).unwrap().positions.finite_bounds().0, 267_129);
    let usual = RgbdOptions {
        filters: pointreel::rgbd::Filters::USUAL,
        ..RgbdOptions::default()
    };
    let retained = redwood(usual).unwrap().decode(0).unwrap().positions.finite_bounds().0;
    assert!((260_000..267_129).contains(&retained), "{retained}");
}

#[test]
fn a_folder_of_clouds_is_still_a_cloud_sequence() {
    let Some(folder) = shared("sequences/pcl_openni_3frames/pcd") else {
        return;
    };
    let sequence = open(&folder);
    assert!(sequence.source().sensor(0).is_none());
    assert_eq!(sequence.entry(0).path.extension(), Path::new("a.pcd").extension());
}
