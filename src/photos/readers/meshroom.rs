//! Meshroom's scenes as JSON: `sfm.json`, `cameras.sfm`.
//!
//! *How it works.* `views` name an intrinsic and a pose; `poses` hold a rotation and a centre; `structure` holds
//! points. Numbers are text. A rotation takes the world to the camera and is written column by column, so by rows it
//! holds the axes of the camera (x right, y down, z forward) in the world: its columns, read as rows, from camera to
//! world.
//!
//! *Versions* (`version`): up to 1.1 one focal length in pixels (`pxFocalLength`), from 1.2.0 two, from 1.2.2 one in
//! millimetres of a sensor (`focalLength`, `sensorWidth`) with `pixelRatio`, which before 1.2.5 is the ratio of the
//! focal lengths and from then on that of the sides of a pixel; the focal length is that along x, from 1.2.11 on that
//! along y. The principal point is from the corner before 1.2.1 and from then on from half of the width and height.
//!
//! *Half a pixel.* AliceVision finds features, and undistorts images, at pixels whose centres are at integers (its SIFT
//! features and its undistortion); half of the width is therefore half a pixel right of the centre. The numbers are
//! read here with the meaning that it gives them.

use super::probe::{Folder, names_in};
use super::reader::{Claim, Reader};
use crate::photos::error::PhotosError;
use crate::photos::found::draft::{Draft, Drafts};
use crate::photos::parts::json::{array_at, key_at, number, number_at, numbers, numbers_at, read as read_json, side};
use crate::photos::sets::lens::{Focal, Lens, Origin};
use crate::photos::sets::points::Observation;
use crate::rgbd::Distortion;
use glam::{DMat3, DVec2, DVec3, Vec2};
use serde_json::Value;
use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};

/// The folder of a project that holds the output of its nodes.
pub(in crate::photos) const CACHE: &str = "MeshroomCache";

/// Width of a sensor that the file does not give, in millimetres, as AliceVision takes it.
const USUAL_SENSOR_MM: f64 = 36.0;

/// Advice on lenses that are not known.
const UNDISTORT_FIRST: &str = "undistort the images first (ExportImages of Meshroom)";

/// Returns true if a file that begins with `head` is a scene.
fn is_scene(head: &str) -> bool {
    head.contains("\"version\"") && (head.contains("\"views\"") || head.contains("\"intrinsics\""))
        || head.contains("\"featuresFolders\"")
}

/// Pose of a camera.
type Pose = (DMat3, DVec3);

/// Names of scenes: those with points first.
const SCENES: &[&str] = &["sfm.json", "sfm.sfm", "cameras.sfm"];

/// Folders of a project that hold scenes, each run in a folder of its own.
const NODES: &[&str] = &[
    "MeshroomCache/ConvertSfMFormat",
    "MeshroomCache/StructureFromMotion",
    "ConvertSfMFormat",
    "StructureFromMotion",
];

/// Meshroom (AliceVision).
pub(super) const READER: Reader = Reader {
    name: "Meshroom",
    in_folder: |folder| {
        let scene = folder.first(SCENES).or_else(|| folder.by_ending(".sfm"));
        scene.or_else(|| in_cache(folder))
    },
    of_file: |file| {
        Ok(match file.extension() {
            "sfm" => Some(Claim::certain(file.path)),
            "json" if is_scene(&file.head()?) => Some(Claim::likely(file.path)),
            _ => None,
        })
    },
    read,
};

/// The scene that was written last by a project.
fn in_cache(folder: &Folder<'_>) -> Option<PathBuf> {
    let scenes = NODES.iter().flat_map(|node| {
        let node = folder.path.join(node);
        let runs = names_in(&node);
        runs.into_iter().flat_map(move |run| {
            let run = node.join(run);
            SCENES.iter().map(move |scene| run.join(scene))
        })
    });
    let written = |path: PathBuf| Some((fs::metadata(&path).ok()?.modified().ok()?, path));
    scenes.filter_map(written).max().map(|(_, path)| path)
}

/// Reads the input images of the scene `path`.
fn read(path: &Path) -> Result<Drafts, PhotosError> {
    let scene = read_json(path)?;
    let invalid = |place: &str, problem: &str| PhotosError::invalid(path, place, problem);
    let version = scene.get("version").and_then(numbers::<3>);
    let version = version.ok_or_else(|| invalid("version", "expected three numbers, such as [\"1\", \"2\", \"6\"]"))?;
    let lenses: HashMap<String, Result<Lens, String>> = array_at(&scene, "intrinsics")
        .iter()
        .filter_map(|intrinsic| Some((key_at(intrinsic, "intrinsicId")?, lens(intrinsic, version))))
        .collect();
    let poses: HashMap<String, Pose> = array_at(&scene, "poses").iter().filter_map(pose).collect();
    if poses.is_empty() {
        let problem = "expected `poses`, found none: open the result of StructureFromMotion, or of ConvertSfMFormat";
        return Err(invalid("the file", problem));
    }
    let mut drafts = Drafts::new(path, folders(path));
    let mut views = HashMap::new();
    let (mut unplaced, mut unnamed) = (0_usize, 0_usize);
    for view in array_at(&scene, "views") {
        let placed = key_at(view, "poseId").and_then(|pose| poses.get(&pose));
        let (Some(&(axes, center)), false) = (placed, is_of_rig(view)) else {
            unplaced += 1;
            continue;
        };
        let lens = key_at(view, "intrinsicId").and_then(|intrinsic| lenses.get(&intrinsic).cloned());
        let lens = lens.unwrap_or_else(|| Err("its intrinsicId is not among the intrinsics".into()));
        let Some(name) = view.get("path").and_then(Value::as_str).filter(|name| !name.is_empty()) else {
            unnamed += 1;
            continue;
        };
        if let Some(id) = key_at(view, "viewId") {
            views.insert(id, drafts.photos.len() as u32);
        }
        drafts.photos.push(Draft::at(name.to_owned(), lens, axes, center));
    }
    if unplaced > 0 {
        drafts.notes.push(if unplaced == 1 {
            "1 image has no pose of its own: it was skipped".to_owned()
        } else {
            format!("{unplaced} images have no pose of their own: they were skipped")
        });
    }
    if unnamed > 0 {
        let views = if unnamed == 1 {
            "1 view has"
        } else {
            &format!("{unnamed} views have")
        };
        drafts.notes.push(format!("{views} no `path` to an image: skipped"));
    }
    for landmark in array_at(&scene, "structure") {
        let Some(position) = landmark.get("X") else {
            continue;
        };
        // Non-finite positions are skipped and counted.
        let position = numbers(position).map_or(DVec3::NAN, DVec3::from_array);
        let color = numbers_at(landmark, "color")
            .unwrap_or([128.0; 3])
            .map(|value| value as u8);
        let track = array_at(landmark, "observations").iter().filter_map(|seen| {
            let photo = *views.get(&key_at(seen, "observationId")?)?;
            let [x, y] = numbers_at(seen, "x")?;
            Some(Observation {
                photo,
                pixel: Vec2::new(x as f32, y as f32),
            })
        });
        drafts.points.push(position, color, track);
    }
    Ok(drafts)
}

/// The folder of the scene and, if it is in the cache of a project, the project folder.
fn folders(path: &Path) -> Vec<PathBuf> {
    let own = path.parent().unwrap_or(Path::new(""));
    let cache = own
        .ancestors()
        .find(|folder| folder.file_name().is_some_and(|name| name == CACHE));
    let project = cache.and_then(Path::parent);
    [own].into_iter().chain(project).map(Path::to_owned).collect()
}

/// Returns true if a view has the pose of its rig, and not its own pose.
fn is_of_rig(view: &Value) -> bool {
    let is_independent = |value: &Value| value.as_bool().unwrap_or(value.as_str() != Some("false"));
    view.get("isPoseIndependant")
        .is_some_and(|value| !is_independent(value))
}

/// Parses the number of a pose, with the axes of its camera as columns, and its centre. Poses with a number that is not
/// finite are NaN, so that the image is named as one that cannot be shown.
fn pose(entry: &Value) -> Option<(String, Pose)> {
    let transform = entry.get("pose")?.get("transform")?;
    let by_columns = numbers::<9>(transform.get("rotation")?);
    let by_columns = by_columns.map_or(DMat3::NAN, |by_columns| DMat3::from_cols_array(&by_columns));
    let center = numbers(transform.get("center")?).map_or(DVec3::NAN, DVec3::from_array);
    Some((key_at(entry, "poseId")?, (by_columns.transpose(), center)))
}

fn lens(intrinsic: &Value, version: [f64; 3]) -> Result<Lens, String> {
    let missing = |what: &str| format!("its intrinsic has no {what}");
    let at = |key: &str| number_at(intrinsic, key);
    let length = |key: &str| at(key).and_then(side).ok_or_else(|| missing(key));
    let size_px = [length("width")?, length("height")?];
    let size = DVec2::new(f64::from(size_px[0]), f64::from(size_px[1]));
    let focal_px = if version < [1.0, 2.0, 0.0] {
        DVec2::splat(at("pxFocalLength").ok_or_else(|| missing("pxFocalLength"))?)
    } else if version < [1.0, 2.0, 2.0] {
        DVec2::from_array(numbers_at(intrinsic, "pxFocalLength").ok_or_else(|| missing("pxFocalLength"))?)
    } else {
        let focal_mm = at("focalLength").ok_or_else(|| missing("focalLength"))?;
        let sensor_mm = at("sensorWidth")
            .filter(|&width| width > 0.0)
            .unwrap_or(USUAL_SENSOR_MM);
        let ratio = at("pixelRatio").filter(|&ratio| ratio > 0.0).unwrap_or(1.0);
        let focal_px = focal_mm / sensor_mm * size.x;
        if version < [1.0, 2.0, 5.0] {
            DVec2::new(focal_px, focal_px / ratio)
        } else if version < [1.0, 2.0, 11.0] {
            DVec2::new(focal_px, focal_px * ratio)
        } else {
            DVec2::new(focal_px / ratio, focal_px)
        }
    };
    let principal =
        DVec2::from_array(numbers_at(intrinsic, "principalPoint").ok_or_else(|| missing("principalPoint"))?);
    let is_from_corner = version < [1.0, 2.0, 1.0];
    Ok(Lens {
        size_px: Some(size_px),
        focal: Focal::Pixels(focal_px),
        origin: Origin::FirstPixel,
        principal_px: if is_from_corner {
            principal
        } else {
            // Half of the size is half a pixel right of the centre: this follows AliceVision's behaviour, not the word
            // *centre*.
            0.5 * size + principal
        },
        distortion: distortion(intrinsic)?,
    })
}

/// The lens by the name of its model: `radial3` of old versions, `pinhole` with a `distortionType` of new ones.
fn distortion(intrinsic: &Value) -> Result<Distortion, String> {
    let word = |key: &str| intrinsic.get(key).and_then(Value::as_str).unwrap_or_default();
    let name = match word("distortionType") {
        "" => word("type"),
        name => name,
    };
    let k: Vec<f64> = array_at(intrinsic, "distortionParams")
        .iter()
        .filter_map(number)
        .collect();
    let undistortion = array_at(intrinsic, "undistortionParams").iter().filter_map(number);
    if undistortion.into_iter().any(|k| k != 0.0) {
        let model = word("undistortionType");
        return Err(format!(
            "its lens is undone by the model {model}, which is not known: {UNDISTORT_FIRST}"
        ));
    }
    if k.iter().all(|&k| k == 0.0) && word("type") != "equidistant" && !name.contains("fisheye") {
        return Ok(Distortion::None);
    }
    match (name, k.as_slice()) {
        ("none" | "pinhole", _) => Ok(Distortion::None),
        ("radial1" | "radialk1", &[k1]) => Ok(Distortion::Brown {
            k: [k1, 0.0, 0.0],
            p: [0.0; 2],
        }),
        ("radial3" | "radialk3", &[k1, k2, k3]) => Ok(Distortion::Brown {
            k: [k1, k2, k3],
            p: [0.0; 2],
        }),
        ("brown", &[k1, k2, k3, p1, p2]) => Ok(Distortion::Brown {
            k: [k1, k2, k3],
            p: [p1, p2],
        }),
        ("fisheye" | "fisheye4", &[k1, k2, k3, k4]) => Ok(Distortion::Fisheye { k: [k1, k2, k3, k4] }),
        _ => Err(format!(
            "its lens is of the model {name} with {} numbers, expected pinhole, radial1, radial3, brown or fisheye4: \
             {UNDISTORT_FIRST}",
            k.len()
        )),
    }
}
