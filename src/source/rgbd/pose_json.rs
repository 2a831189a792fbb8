//! Poses in JSON: the trajectories and graphs of Open3D, lists of matrices, matrices by the names of frames, and frames
//! with a matrix each (`transforms.json`).

use super::trajectory::{Trajectory, key_of, matrix, of_backward, rigid};
use glam::{DAffine3, DMat4};
use serde_json::Value;
use std::collections::HashMap;

/// Direction and axis convention of the pose matrix stored under a key.
#[derive(Debug, Clone, Copy)]
enum Leads {
    ToWorld,
    /// The camera has y up and z backward.
    ToWorldBackward,
    FromWorld,
}

/// Keys of the pose of a frame, the better first.
const KEYS: [(&str, Leads); 17] = [
    ("aligned_pose", Leads::ToWorld),
    ("pose", Leads::ToWorld),
    ("camera_to_world", Leads::ToWorld),
    ("cam2world", Leads::ToWorld),
    ("cam_to_world", Leads::ToWorld),
    ("c2w", Leads::ToWorld),
    ("T_wc", Leads::ToWorld),
    ("T_WC", Leads::ToWorld),
    ("matrix", Leads::ToWorld),
    ("transform", Leads::ToWorld),
    ("transform_matrix", Leads::ToWorldBackward),
    ("extrinsic", Leads::FromWorld),
    ("extrinsics", Leads::FromWorld),
    ("world_to_camera", Leads::FromWorld),
    ("world2cam", Leads::FromWorld),
    ("w2c", Leads::FromWorld),
    ("T_cw", Leads::FromWorld),
];

/// Keys of the list of all poses.
const LISTS: [&str; 5] = ["poses", "frames", "camera_poses", "trajectory", "c2w"];

/// Keys of the names of a frame.
const NAMES: [&str; 6] = ["depth_file_path", "file_path", "name", "filename", "file_name", "image"];

/// The poses in `text`. A trajectory of Open3D has *extrinsics*, which lead from the world to the camera; a graph has
/// poses.
pub(super) fn of_json(text: &str) -> Result<Trajectory, String> {
    let json: Value = serde_json::from_str(text).map_err(|error| error.to_string())?;
    let of_columns = |value: &Value| {
        let numbers: Option<Vec<f64>> = value.as_array()?.iter().map(Value::as_f64).collect();
        let numbers: [f64; 16] = numbers?.try_into().ok()?;
        rigid(Some(DMat4::from_cols_array(&numbers)))
    };
    if let Some(parameters) = json.get("parameters").and_then(Value::as_array) {
        let poses = parameters.iter().map(|camera| {
            let camera_from_world = of_columns(camera.get("extrinsic")?)?;
            Some(camera_from_world.inverse())
        });
        return Ok(Trajectory::listed(poses));
    }
    if let Some(nodes) = json.get("nodes").and_then(Value::as_array) {
        return Ok(Trajectory::listed(
            nodes.iter().map(|node| of_columns(node.get("pose")?)),
        ));
    }
    let none = || {
        "its JSON has neither `parameters` nor `nodes` of Open3D, no list of matrices, and no matrix by the name of a \
         frame"
            .to_owned()
    };
    of_value(&json)
        .or_else(|| LISTS.iter().find_map(|key| of_value(json.get(key)?)))
        .ok_or_else(none)
}

/// A list of poses, or poses by names.
fn of_value(value: &Value) -> Option<Trajectory> {
    match value {
        Value::Array(list) => {
            let poses: Vec<Option<DAffine3>> = list.iter().map(pose).collect::<Option<_>>()?;
            let names: Option<Vec<String>> = list.iter().map(name).collect();
            if poses.is_empty() {
                return None;
            }
            Some(match names {
                Some(names) => Trajectory::Named(names.into_iter().zip(poses).collect()),
                None => Trajectory::listed(poses.into_iter()),
            })
        }
        Value::Object(named) => {
            let poses = named.iter().map(|(name, value)| Some((key_of(name), pose(value)?)));
            let poses: HashMap<String, Option<DAffine3>> = poses.collect::<Option<_>>()?;
            (!poses.is_empty()).then_some(Trajectory::Named(poses))
        }
        _ => None,
    }
}

fn name(frame: &Value) -> Option<String> {
    let name = NAMES.iter().find_map(|key| frame.get(key)?.as_str())?;
    Some(key_of(name))
}

/// The pose that `value` is or has; nothing for other things, no pose where the camera was lost.
#[expect(clippy::option_option, reason = "no pose is something else than a lost camera")]
pub(super) fn pose(value: &Value) -> Option<Option<DAffine3>> {
    if value.is_object() {
        let (found, leads) = KEYS
            .iter()
            .find_map(|&(key, leads)| Some((of_numbers(value.get(key)?)?, leads)))?;
        return Some(match leads {
            Leads::ToWorld => found,
            Leads::ToWorldBackward => found.map(of_backward),
            Leads::FromWorld => found.map(|pose| pose.inverse()),
        });
    }
    of_numbers(value)
}

/// A matrix in rows, or number by number.
#[expect(clippy::option_option, reason = "no pose is something else than a lost camera")]
fn of_numbers(value: &Value) -> Option<Option<DAffine3>> {
    let list = value.as_array()?;
    let flat = list.iter().flat_map(|row| match row.as_array() {
        Some(row) => row.iter().collect::<Vec<_>>(),
        None => vec![row],
    });
    // NaN means that tracking was lost.
    let numbers: Vec<f64> = flat
        .map(|number| match number {
            Value::Null => Some(f64::NAN),
            number => number.as_f64(),
        })
        .collect::<Option<_>>()?;
    matches!(numbers.len(), 12 | 16).then(|| rigid(matrix(&numbers)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    fn place(trajectory: &Trajectory, index: usize, name: &str) -> Option<DVec3> {
        let poses = trajectory.poses_of(&[None], &[Some(index)], &[name.to_owned()]);
        poses[0].map(|pose| pose.translation)
    }

    #[test]
    fn lists_and_names_are_read() {
        let at = |x: f64| format!("[[1,0,0,{x}],[0,1,0,2],[0,0,1,3],[0,0,0,1]]");
        let listed = of_json(&format!("[{},{}]", at(0.0), at(1.0))).unwrap();
        assert_eq!(place(&listed, 1, "b"), Some(DVec3::new(1.0, 2.0, 3.0)));
        let named = of_json(&format!(r#"{{"a.png": {}, "000007": {}}}"#, at(4.0), at(5.0))).unwrap();
        assert_eq!(place(&named, 0, "a.png"), Some(DVec3::new(4.0, 2.0, 3.0)));
        assert_eq!(place(&named, 7, "000007.png"), Some(DVec3::new(5.0, 2.0, 3.0)));
    }

    #[test]
    fn keys_state_the_direction_of_matrices() {
        let shifted = "[1,0,0,1, 0,1,0,0, 0,0,1,0, 0,0,0,1]";
        let x = |key: &str| {
            let text = format!(r#"{{"frames": [{{"file_path": "f/a.png", "{key}": {shifted}}}]}}"#);
            place(&of_json(&text).unwrap(), 0, "a.jpg").unwrap().x
        };
        assert_eq!([x("c2w"), x("w2c"), x("transform_matrix")], [1.0, -1.0, 1.0]);
        let backward = pose(&serde_json::json!({"transform_matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]}));
        let backward = backward.flatten().unwrap();
        assert_eq!(backward.transform_vector3(DVec3::Z), DVec3::NEG_Z);
        assert!(of_json(r#"{"a": 1}"#).unwrap_err().contains("neither"));
    }
}
