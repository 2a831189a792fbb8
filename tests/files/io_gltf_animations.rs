//! glTF models that move: known poses of files written here, damaged animations, and a walking man against a sequence
//! that was sampled from him.

#![allow(clippy::print_stdout, reason = "what was compared is for who runs the test")]

use crate::data::shared;
use crate::io_gltf::{Model, moving, positions, square};
use glam::DVec3;
use pointreel::cloud::RawCloud;
use pointreel::io::{self, Part, ReadOptions, SharedFile};
use pointreel::progress::Progress;
use pointreel::sequence::{OpenOptions, Sequence};
use serde_json::json;
use std::num::NonZeroUsize;
use std::time::Duration;

#[test]
fn animations_interpolate_nodes_between_keyframes() {
    let options = ReadOptions::default();
    let place = |model: &Model, seconds: f64| positions(&model.pose(seconds, &options))[0][0];
    let linear = moving("LINEAR", &[[2.0, 0.0, 0.0], [6.0, 0.0, 0.0]]);
    let step = moving("STEP", &[[2.0, 0.0, 0.0], [6.0, 0.0, 0.0]]);
    // Starts with a speed of 8 per second and arrives with none: 2 + 4 * 0.5 + 2 * 8 * 0.125 halfway.
    let cubic = moving(
        "CUBICSPLINE",
        &[
            [0.0; 3],
            [2.0, 0.0, 0.0],
            [8.0, 0.0, 0.0],
            [0.0; 3],
            [6.0, 0.0, 0.0],
            [0.0; 3],
        ],
    );
    for (seconds, expected) in [
        (0.0, [2.0; 3]),
        (1.0, [2.0; 3]),
        (2.0, [4.0, 2.0, 6.0]),
        (3.0, [6.0; 3]),
        (9.0, [6.0; 3]),
    ] {
        assert_eq!(
            [&linear, &step, &cubic].map(|model| place(model, seconds)),
            expected,
            "{seconds} s"
        );
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.gltf");
    std::fs::write(&path, linear.file()).unwrap();
    let entries = io::list(&path, &options).unwrap();
    assert_eq!(entries.len(), 3 * 24 + 1);
    assert_eq!(entries[1].name, "t=0.042 s");
    assert_eq!(entries[72].time, Some(Duration::from_secs(3)));
    assert_eq!(entries[72].part, Part::TimeStep(Duration::from_secs(3)));
    assert_eq!(
        io::read(&path).unwrap(),
        io::read_part(&path, &entries[0].part, &options).unwrap()
    );
    std::fs::write(&path, square().file()).unwrap();
    assert_eq!(io::list(&path, &options).unwrap().len(), 1);
    let mut long = moving("STEP", &[[0.0; 3], [0.0; 3]]);
    let times = long.floats("SCALAR", &[[1.0], [3e30]]);
    long.json["animations"][0]["samplers"][0]["input"] = json!(times);
    std::fs::write(&path, long.file()).unwrap();
    assert_eq!(io::list(&path, &options).unwrap().len(), 100_000);
    let short = moving("CUBICSPLINE", &[[0.0; 3], [2.0, 0.0, 0.0]]);
    assert!(
        short.refused().contains("expected 3 for each of 2 keyframes"),
        "{}",
        short.refused()
    );
}

#[test]
fn data_shared_by_frames_is_read_once() {
    let options = ReadOptions::default();
    let model = moving("LINEAR", &[[2.0, 0.0, 0.0], [6.0, 0.0, 0.0]]);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.glb");
    std::fs::write(&path, model.glb()).unwrap();
    let shared = SharedFile::default();
    let read = |part: &Part| shared.read_part(&path, part, &options, &Progress::default());
    let alone: Vec<(Part, RawCloud)> = io::list(&path, &options)
        .unwrap()
        .into_iter()
        .map(|entry| {
            let cloud = io::read_part(&path, &entry.part, &options).unwrap();
            (entry.part, cloud)
        })
        .collect();
    assert_eq!(read(&alone[0].0).unwrap(), alone[0].1);
    // The file is no longer needed.
    std::fs::remove_file(&path).unwrap();
    for (part, cloud) in &alone {
        assert_eq!(read(part).unwrap(), *cloud);
    }
}

#[test]
fn a_damaged_animation_fails_once() {
    let options = ReadOptions::default();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.gltf");
    // 100,000 poses, and an array that is too short for each of them.
    let mut damaged = moving("CUBICSPLINE", &[[0.0; 3], [2.0, 0.0, 0.0]]);
    let times = damaged.floats("SCALAR", &[[1.0], [3e30]]);
    damaged.json["animations"][0]["samplers"][0]["input"] = json!(times);
    std::fs::write(&path, damaged.file()).unwrap();
    let listed = io::list(&path, &options).unwrap_err().to_string();
    assert!(listed.contains("expected 3 for each"), "{listed}");
    let sequence = Sequence::open(std::slice::from_ref(&path), &OpenOptions::default()).unwrap();
    assert_eq!(sequence.len(), 1);
    let error = sequence.frame(0).unwrap_err().to_string();
    assert!(error.contains("expected 3 for each"), "{error}");
    // A reader that listed it before it was damaged gets the same error for each frame, without waiting.
    let shared = SharedFile::default();
    let time_step = |seconds| Part::TimeStep(Duration::from_secs(seconds));
    let read = |seconds| {
        let progress = Progress::default();
        let read = shared.read_part(&path, &time_step(seconds), &options, &progress);
        read.unwrap_err()
    };
    let first = read(0);
    std::fs::remove_file(&path).unwrap();
    assert!(std::sync::Arc::ptr_eq(&first, &read(1)));
}

#[test]
fn rotations_take_the_short_way_and_morphs_add_up() {
    let options = ReadOptions::default();
    let mut model = square();
    let half = 0.5f32.sqrt();
    let times = model.floats("SCALAR", &[[0.0], [1.0]]);
    // No rotation, then a quarter turn about z with the opposite sign of the same quaternion.
    let values = model.floats("VEC4", &[[0.0, 0.0, 0.0, 1.0], [0.0, 0.0, -half, -half]]);
    let deltas = model.floats("VEC3", &[[0.0, 0.0, 4.0]; 4]);
    let weights = model.floats("SCALAR", &[[0.0], [0.5], [1.0], [0.5]]);
    model.primitive()["targets"] = json!([{"POSITION": deltas}, {"POSITION": deltas}]);
    model.json["animations"] = json!([{
        "channels": [{"sampler": 0, "target": {"node": 0, "path": "rotation"}},
            {"sampler": 1, "target": {"node": 0, "path": "weights"}}],
        "samplers": [{"input": times, "output": values}, {"input": times, "output": weights}]
    }]);
    let turned = |seconds: f64| positions(&model.pose(seconds, &options))[1];
    let near = |a: [f64; 3], b: [f64; 3]| {
        assert!(DVec3::from(a).distance(DVec3::from(b)) < 1e-6, "{a:?} {b:?}");
    };
    near(turned(0.0), [1.0, 0.0, 2.0]);
    near(turned(0.5), [f64::from(half), f64::from(half), 4.0]);
    near(turned(1.0), [0.0, 1.0, 6.0]);
    model.json["animations"] = json!([]);
    model.json["meshes"][0]["weights"] = json!([0.25, 0.0]);
    near(positions(&model.read())[0], [0.0, 0.0, 1.0]);
    model.json["nodes"][0]["weights"] = json!([0.0, 1.0]);
    near(positions(&model.read())[0], [0.0, 0.0, 4.0]);
}

#[test]
fn skins_follow_their_bones() {
    let mut model = square();
    let joints = model.accessor("VEC4", 5121, 4, &[0, 1, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 9, 0, 0, 0]);
    model.primitive()["attributes"]["JOINTS_0"] = json!(joints);
    model.attribute(
        "WEIGHTS_0",
        "VEC4",
        &[
            [0.5, 0.5, 0.0, 0.0],
            [1.0, 0.0, 0.0, 0.0],
            [1.0, 1.0, 0.0, 0.0],
            [0.0; 4],
        ],
    );
    let identity: [f32; 16] = std::array::from_fn(|index| f32::from(u8::from(index % 5 == 0)));
    let mut back = identity;
    back[12] = -1.0;
    let bound = model.floats("MAT4", &[identity, back]);
    // The node of a skinned mesh does not move it; a vertex without bone weights stays with it.
    model.json["nodes"] = json!([{"mesh": 0, "skin": 0, "translation": [100.0, 0.0, 0.0]},
        {"translation": [0.0, 2.0, 0.0]}, {"translation": [5.0, 0.0, 0.0]}]);
    model.json["skins"] = json!([{"joints": [1, 2], "inverseBindMatrices": bound}]);
    assert_eq!(
        positions(&model.read()),
        [[2.0, 1.0, 0.0], [5.0, 0.0, 0.0], [2.0, 2.0, 0.0], [101.0, 1.0, 0.0]]
    );
    model.attribute("WEIGHTS_0", "VEC4", &[[1.0, 0.0, 0.0, 0.0]; 4]);
    assert!(model.refused().contains("joint 9"), "{}", model.refused());
    model.attribute("WEIGHTS_0", "VEC4", &[[1.0, 0.0, 0.0, 0.0]; 3]);
    assert!(model.refused().contains("4 positions but 3"), "{}", model.refused());
}

#[test]
fn a_sampled_point_is_the_same_surface_point_in_every_frame() {
    let model = moving("LINEAR", &[[2.0, 0.0, 0.0], [6.0, 8.0, 0.0]]);
    let options = ReadOptions::default().with_sample_count(NonZeroUsize::new(500));
    let [first, last] = [0.0, 3.0].map(|seconds| model.pose(seconds, &options));
    assert_eq!((first.positions.len(), first.faces.len()), (500, 0));
    for (from, to) in positions(&first).into_iter().zip(positions(&last)) {
        assert!((DVec3::from(to) - DVec3::from(from)).distance(DVec3::new(4.0, 8.0, 0.0)) < 1e-6);
    }
}

/// The point of a triangle that is nearest to `point`, and its distance.
fn nearest(point: DVec3, [a, b, c]: [DVec3; 3]) -> (DVec3, f64) {
    let normal = (b - a).cross(c - a);
    let within = [(a, b), (b, c), (c, a)]
        .iter()
        .all(|&(from, to)| (to - from).cross(point - from).dot(normal) >= 0.0);
    let on_edge = |(from, to): (DVec3, DVec3)| {
        let along = to - from;
        let length = along.length_squared();
        let fraction = if length > 0.0 {
            ((point - from).dot(along) / length).clamp(0.0, 1.0)
        } else {
            0.0
        };
        from + along * fraction
    };
    let place = if within && normal.length_squared() > 0.0 {
        point - normal * ((point - a).dot(normal) / normal.length_squared())
    } else {
        [(a, b), (b, c), (c, a)]
            .map(on_edge)
            .into_iter()
            .min_by(|p, q| p.distance(point).total_cmp(&q.distance(point)))
            .unwrap()
    };
    (place, place.distance(point))
}

/// Points that another program put on the surface of each pose lie on it as this one poses the model, all of them.
#[test]
fn a_walking_man_has_the_pose_of_another_program() {
    /// One in this many points of a frame.
    const STEP: usize = 50;
    const FRAMES: [usize; 5] = [0, 5, 11, 17, 23];
    /// The man is 1.5 high: single precision rounds a position by up to 6e-8 along each axis, 1.03e-7 in all, and both
    /// a point of the sequence and the surface are rounded. The farthest of all was measured 1.3e-7 away.
    const TOLERANCE: f64 = 2.1e-7;
    let (Some(model), Some(sequence)) = (shared("models/CesiumMan.glb"), shared("sequences/cesiumman_24fps")) else {
        return;
    };
    let options = ReadOptions::default();
    let sampling = options.with_sample_count(NonZeroUsize::new(1000));
    let entries = io::list(&model, &options).unwrap();
    assert_eq!(entries.len(), 49, "two seconds");
    let mut poses: Vec<Vec<(DVec3, f64)>> = Vec::new();
    for frame in FRAMES {
        let mesh = io::read_part(&model, &entries[frame].part, &options).unwrap();
        let triangle = |face: &[u32; 3]| face.map(|corner| mesh.positions.get(corner as usize));
        let triangles: Vec<[DVec3; 3]> = mesh.faces.iter().map(triangle).collect();
        let distance = |point: DVec3| {
            let distances = triangles.iter().map(|&corners| nearest(point, corners).1);
            distances.fold(f64::INFINITY, f64::min)
        };
        let path = sequence.join(format!("frame_{frame:04}.ply"));
        let points = positions(&io::read(&path).unwrap());
        let points = points.into_iter().step_by(STEP).map(DVec3::from);
        poses.push(points.map(|point| (point, distance(point))).collect());
        // And our own samples lie on it, with texture and normals.
        let sampled = io::read_part(&model, &entries[frame].part, &sampling).unwrap();
        assert!(sampled.attributes.normals.is_some() && sampled.attributes.colors.is_some());
        for point in positions(&sampled) {
            assert!(distance(DVec3::from(point)) < TOLERANCE, "{point:?}");
        }
    }
    let farthest = poses.iter().flatten().map(|point| point.1);
    let farthest = farthest.fold(0.0, f64::max);
    let moved = poses[2].iter().zip(&poses[0]);
    let moved = moved.map(|(then, first)| then.0.distance(first.0));
    let moved = moved.fold(0.0, f64::max);
    println!(
        "{} points lie within {farthest} of the posed surface in {} frames; they moved by up to {moved}",
        poses[0].len(),
        FRAMES.len()
    );
    assert_eq!(poses[0].len(), 1000);
    assert!(farthest < TOLERANCE, "{farthest}");
    // Not moving at all would not pass.
    assert!(moved > 0.2, "{moved}");
}
