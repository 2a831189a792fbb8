//! Known answers, and properties of any path.

use super::*;
use crate::scene::{Projection, UpAxis};
use proptest::prelude::*;
use std::path::Path;

fn camera() -> Camera {
    Camera {
        target_in_world: DVec3::new(4e6, -2.0, 0.5),
        distance: 2.0,
        azimuth_deg: 30.0,
        elevation_deg: 10.0,
        fov_deg: 45.0,
        up: UpAxis::Z,
        projection: Projection::Perspective,
        plane: PicturePlane::CENTERED,
    }
}

fn key(time_s: f64, frame: f64) -> Keyframe {
    Keyframe {
        time_s,
        camera: camera(),
        frame,
    }
}

fn frames_at(path: &CameraPath, times: &[f64]) -> Vec<usize> {
    times.iter().map(|&time| path.at(time).1).collect()
}

#[test]
fn frames_can_be_held_slowed_down_and_reversed() {
    let keys = vec![
        key(0.0, 0.0),
        // 24 frames per second.
        key(1.0, 24.0),
        // Paused.
        key(2.0, 24.0),
        // Slow motion: four frames per second.
        key(3.0, 28.0),
        // Backwards.
        key(4.0, 4.0),
    ];
    let path = CameraPath::new(keys, true).unwrap();
    let each: Vec<f64> = (0..24).map(|frame| f64::from(frame) / 24.0).collect();
    assert_eq!(frames_at(&path, &each), (0..24).collect::<Vec<_>>());
    assert_eq!(frames_at(&path, &[1.0, 1.3, 1.999, 2.0]), [24; 4]);
    assert_eq!(frames_at(&path, &[2.2, 2.25, 2.5, 2.75]), [25, 25, 26, 27]);
    let back: Vec<f64> = each.iter().map(|time| time + 3.0).collect();
    assert_eq!(frames_at(&path, &back), (5..=28).rev().collect::<Vec<usize>>());
    assert_eq!(frames_at(&path, &[-1.0, 9.0]), [0, 4]);
    assert_eq!(path.duration_s(), 4.0);
    assert_eq!(path.picture_count(24.0), 97);
}

#[test]
fn a_turntable_turns_at_constant_speed_and_closes_the_loop() {
    let path = CameraPath::turntable(camera(), 1.0, [36.0, 12.0], [3.0, 0.5]).unwrap();
    assert_eq!(path.picture_count(12.0), 36);
    for picture in 0..36 {
        let (seen, frame) = path.at(f64::from(picture) / 12.0);
        let expected = wrapped(30.0 + 10.0 * f64::from(picture));
        assert!(wrapped(seen.azimuth_deg - expected).abs() < 1e-9, "{picture}: {seen:?}");
        assert!((seen.distance - 2.0).abs() < 1e-12);
        assert_eq!(seen.target_in_world, camera().target_in_world);
        assert_eq!(frame, (3.0 + 0.5 * f64::from(picture)).round() as usize);
    }
    let backwards = CameraPath::turntable(camera(), -2.0, [36.0, 12.0], [0.0, 0.0]).unwrap();
    assert!((backwards.at(1.0 / 12.0).0.azimuth_deg - 10.0).abs() < 1e-9);
    let one = CameraPath::turntable(camera(), 1.0, [1.0, 12.0], [0.0, 1.0]).unwrap();
    assert_eq!(one.picture_count(12.0), 1);
    assert!(CameraPath::turntable(camera(), 1e6, [36.0, 12.0], [0.0, 0.0]).is_err());
}

#[test]
fn the_camera_goes_the_short_way_round_and_zooms_evenly() {
    let at = |azimuth_deg: f64, distance: f64, time_s: f64| Keyframe {
        camera: Camera {
            distance,
            azimuth_deg,
            ..camera()
        },
        ..key(time_s, 0.0)
    };
    let path = CameraPath::new(vec![at(170.0, 1.0, 0.0), at(-170.0, 4.0, 2.0)], false).unwrap();
    let (center, _) = path.at(1.0);
    assert!((center.azimuth_deg.abs() - 180.0).abs() < 1e-9, "{center:?}");
    assert!((center.distance - 2.0).abs() < 1e-9, "{center:?}");
}

#[test]
fn invalid_keyframes_are_rejected_by_number() {
    let of = |keys: Vec<Keyframe>| CameraPath::new(keys, false).unwrap_err().to_string();
    assert_eq!(of(Vec::new()), "a path has at least one keyframe");
    assert!(of(vec![key(0.0, 0.0), key(f64::NAN, 0.0)]).starts_with("keyframe 2: time_s is NaN"));
    assert!(of(vec![key(0.0, -1.0)]).starts_with("keyframe 1: frame is -1"));
    assert!(of(vec![key(1.0, 0.0), key(1.0, 0.0)]).starts_with("keyframe 2 is at 1 s"));
    let mut over_the_pole = key(0.0, 0.0);
    over_the_pole.camera.elevation_deg = 91.0;
    assert!(of(vec![over_the_pole]).contains("elevation_deg is 91"));
    let mut other_axis = key(1.0, 0.0);
    other_axis.camera.up = UpAxis::Y;
    assert!(of(vec![key(0.0, 0.0), other_axis]).contains("keyframe 2 has the up axis y"));
    let many = (0..=CameraPath::MAX_KEYFRAMES).map(|index| key(index as f64, 0.0));
    assert!(of(many.collect()).starts_with("100001 keyframes"));
}

#[test]
fn invalid_files_are_rejected_by_line() {
    let good = CameraPath::new(vec![key(0.0, 0.0), key(1.0, 2.0)], true)
        .unwrap()
        .to_json();
    let of = |text: &str| {
        CameraPath::of_json(text.as_bytes(), Path::new("p.json"))
            .unwrap_err()
            .to_string()
    };
    let changed = |from: &str, to: &str| {
        assert!(good.contains(from), "{good}");
        of(&good.replacen(from, to, 1))
    };
    assert!(of("[1, 2").starts_with("p.json is not a camera path: "));
    assert!(of("{}").contains("missing field `pointreel_path`"));
    assert!(changed("path\": 1", "path\": 2").contains("of version 2"));
    let odd = changed("\"z\"", "\"w\"");
    assert!(odd.contains("unknown up axis `w`") && odd.contains("line 4"), "{odd}");
    let unknown = changed("fov_deg", "fov_rad");
    assert!(
        unknown.contains("unknown field `fov_rad`") && unknown.contains("line 7"),
        "{unknown}"
    );
    assert!(changed("0.5]", "1e999]").contains("out of range"));
    assert!(changed("\"time_s\":1.0", "\"time_s\":0.0").contains("keyframe 2 is at 0 s"));
}

prop_compose! {
    fn any_key()(
        step_s in 0.01f64..10.0,
        target in prop::array::uniform3(-1e7f64..1e7),
        log_distance in -8f64..8.0,
        azimuth_deg in -400f64..400.0,
        elevation_deg in -90f64..=90.0,
        fov_deg in 1f64..170.0,
        frame in 0f64..500.0,
    ) -> Keyframe {
        Keyframe {
            time_s: step_s,
            frame,
            camera: Camera {
                target_in_world: DVec3::from_array(target),
                distance: log_distance.exp(),
                azimuth_deg,
                elevation_deg,
                fov_deg,
                up: UpAxis::Y,
                projection: Projection::Perspective,
                plane: PicturePlane::CENTERED,
            },
        }
    }
}

prop_compose! {
    fn any_path()(mut keys in prop::collection::vec(any_key(), 1..8), eases in any::<bool>()) -> CameraPath {
        let mut time_s = 0.0;
        for key in &mut keys {
            time_s += key.time_s;
            key.time_s = time_s;
        }
        CameraPath::new(keys, eases).unwrap()
    }
}

/// Moving values, as they are interpolated.
fn moving(camera: &Camera) -> [f64; 6] {
    let [x, y, z] = camera.target_in_world.to_array();
    let distance = camera.distance.ln();
    [x, y, z, distance, camera.elevation_deg, camera.fov_deg.ln()]
}

proptest! {
    #[test]
    fn paths_pass_through_their_keyframes(path in any_path()) {
        let first_s = path.keyframes()[0].time_s;
        for key in path.keyframes() {
            let (camera, frame) = path.at(key.time_s - first_s);
            for (value, expected) in moving(&camera).into_iter().zip(moving(&key.camera)) {
                prop_assert!((value - expected).abs() <= 1e-6 * expected.abs().max(1.0), "{value} {expected}");
            }
            prop_assert!(wrapped(camera.azimuth_deg - key.camera.azimuth_deg).abs() < 1e-6);
            prop_assert!((frame as f64 - key.frame).abs() <= 0.5 + 1e-6);
        }
    }

    #[test]
    fn values_between_keyframes_do_not_overshoot(path in any_path(), share in 0f64..1.0) {
        let seconds = share * path.duration_s();
        let (camera, frame) = path.at(seconds);
        let keys = path.keyframes();
        let time_s = keys[0].time_s + seconds;
        let index = keys.partition_point(|key| key.time_s <= time_s).max(1) - 1;
        let (from, to) = (&keys[index], &keys[(index + 1).min(keys.len() - 1)]);
        let ends = moving(&from.camera).into_iter().zip(moving(&to.camera));
        for (value, (a, b)) in moving(&camera).into_iter().zip(ends) {
            let slack = 1e-12 * a.abs().max(b.abs()).max(1.0);
            prop_assert!((a.min(b) - slack..=a.max(b) + slack).contains(&value), "{value} {a} {b}");
        }
        let frame = frame as f64;
        prop_assert!(from.frame.min(to.frame).round() <= frame && frame <= from.frame.max(to.frame).round());
        prop_assert!(camera.azimuth_deg.abs() <= 180.0);
    }

    /// No corners: the speeds just before and after a keyframe differ by no more than the adjacent curves can
    /// accelerate.
    #[test]
    fn the_camera_speed_is_continuous_at_keyframes(path in any_path()) {
        const AT_TIME_S: f64 = 1e-6;
        for keys in path.keyframes().windows(3) {
            let here_s = keys[1].time_s - path.keyframes()[0].time_s;
            let [before, here, after] =
                [-AT_TIME_S, 0.0, AT_TIME_S].map(|at_time| moving(&path.at(here_s + at_time).0));
            let [from, inner, to] = [0, 1, 2].map(|index| moving(&keys[index].camera));
            let spans = [1, 2].map(|index| keys[index].time_s - keys[index - 1].time_s);
            for axis in [3, 4, 5] {
                let speeds = [here[axis] - before[axis], after[axis] - here[axis]].map(|way| way / AT_TIME_S);
                // A cubic whose slopes are at most three times its secant.
                let acceleration = 24.0
                    * ((inner[axis] - from[axis]).abs() / spans[0].powi(2))
                        .max((to[axis] - inner[axis]).abs() / spans[1].powi(2));
                let rounding = 1e-6 * (1.0 + speeds[0].abs());
                prop_assert!((speeds[0] - speeds[1]).abs() <= acceleration * AT_TIME_S + rounding, "{speeds:?}");
            }
        }
    }

    #[test]
    fn increasing_frames_interpolate_monotonically(path in any_path(), shares in prop::collection::vec(0f64..1.0, 20)) {
        let mut keys = path.keyframes().to_vec();
        let mut frame = 0.0;
        for key in &mut keys {
            frame += key.frame;
            key.frame = frame;
        }
        let path = CameraPath::new(keys, path.eases()).unwrap();
        let mut times: Vec<f64> = shares.iter().map(|share| share * path.duration_s()).collect();
        times.sort_by(f64::total_cmp);
        prop_assert!(frames_at(&path, &times).is_sorted());
    }

    #[test]
    fn files_round_trip(path in any_path()) {
        let text = path.to_json();
        let back = CameraPath::of_json(text.as_bytes(), Path::new("")).unwrap();
        prop_assert_eq!(back.eases(), path.eases());
        prop_assert_eq!(back.keyframes().len(), path.keyframes().len());
        // Numbers are read back exactly or to the neighbouring float.
        let is_near = |a: f64, b: f64| (a - b).abs() <= f64::EPSILON * b.abs();
        for (back, key) in back.keyframes().iter().zip(path.keyframes()) {
            let (a, b) = (back.camera, key.camera);
            prop_assert!(is_near(back.time_s, key.time_s) && is_near(back.frame, key.frame));
            prop_assert!((0..3).all(|axis| is_near(a.target_in_world[axis], b.target_in_world[axis])));
            prop_assert!(is_near(a.distance, b.distance) && is_near(a.fov_deg, b.fov_deg));
            prop_assert!(is_near(a.azimuth_deg, b.azimuth_deg) && is_near(a.elevation_deg, b.elevation_deg));
            prop_assert_eq!(a.up, b.up);
        }
    }
}
