//! `Record3D`, an app of iPhones with a depth camera: `.r3d`, a ZIP archive of `metadata`, `rgbd/0.depth` and
//! `rgbd/0.jpg`.
//!
//! *Metadata* is JSON: `w h` of the colour images, their lens `K` (nine numbers by columns), `dw dh` of the depth
//! images, `fps`, `frameTimestamps`, and `poses`, each a quaternion x y z w and a place. Poses follow `ARKit`, whose
//! camera has x right, y up and z backward. *Depths* are metres in single floats, packed by Apple's LZFSE; where
//! nothing was measured they are NaN or 0. Older versions lack `dw dh`: their images are 192 × 256 (LiDAR) or 480 × 640
//! (`TrueDepth`), determined by the number of floats.

use super::calibration::{Calibration, Intrinsics};
use super::depth_code::DepthCode;
use super::depth_scale::Units;
use super::error::RgbdError;
use super::folder::{has_extension, name_of};
use super::layouts::{FoundRecording, FrameImages};
use super::member_image::{MemberImage, archive, member, pixels, unpacked};
use super::recorder::Recorder;
use super::stored_image::StoredImage;
use super::trajectory::{of_backward, pose_of};
use crate::io::ReadOptions;
use glam::{DAffine3, DQuat, DVec3};
use serde_json::Value;
use std::fs::File;
use std::io::BufReader;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;
use zip::ZipArchive;

/// Sizes of the depth images of versions that do not state it.
const KNOWN_SIZES: [[u32; 2]; 3] = [[192, 256], [480, 640], [360, 640]];

/// Metadata of an hour has fewer bytes.
const MAX_METADATA_BYTES: u64 = 64 << 20;

const EXTENSIONS: &[&str] = &["r3d"];

/// Recognised by their names.
pub(super) const RECORDER: Recorder = Recorder {
    extensions: EXTENSIONS,
    can_read: |path| has_extension(name_of(path), EXTENSIONS),
    find: |path, options| Ok(Some(("Record3D", find(path, &options.read)?))),
};

/// The recording in the archive at `path`.
fn find(path: &Path, options: &ReadOptions) -> Result<FoundRecording, RgbdError> {
    let mut archive = archive(path)?;
    let wrong = |reason: String| RgbdError::Calibration {
        path: path.join("metadata"),
        reason,
    };
    let text = member(&mut archive, path, "metadata", MAX_METADATA_BYTES)?;
    let json: Value = serde_json::from_slice(&text).map_err(|error| wrong(error.to_string()))?;
    let numbers: Vec<u64> = depth_numbers(&archive);
    let Some(first) = numbers.first() else {
        return Err(RgbdError::NoDepth {
            path: path.to_owned(),
            looked_for: "files rgbd/0.depth and so on in the archive".to_owned(),
        });
    };
    let first_depth = member(
        &mut archive,
        path,
        &format!("rgbd/{first}.depth"),
        options.max_memory_bytes,
    )?;
    let depth_px = depth_size(&json, &first_depth).map_err(wrong)?;
    let calibration = Arc::new(calibration(&json, path).map_err(wrong)?);
    let poses = poses(&json);
    let path: Arc<Path> = path.into();
    let image = |name: String, depth_px: Option<[u32; 2]>| {
        StoredImage::Member(MemberImage {
            path: Arc::clone(&path),
            name,
            depth_px,
        })
    };
    let frames = numbers.iter().map(|&number| {
        let color = format!("rgbd/{number}.jpg");
        FrameImages {
            color: archive.index_for_name(&color).map(|_| image(color, None)),
            depth: image(format!("rgbd/{number}.depth"), Some(depth_px)),
            time: time(&json, number),
            world_from_camera: poses.get(number as usize).copied().flatten(),
            calibration: Arc::clone(&calibration),
        }
    });
    let frames: Vec<FrameImages> = frames.collect();
    Ok(FoundRecording {
        frames,
        code: DepthCode::per_metre(1.0),
        units: Units::Certain,
        assumptions: Vec::new(),
        notes: Vec::new(),
        damage: Vec::new(),
    })
}

/// Numbers of the depth images, in their order.
fn depth_numbers(archive: &ZipArchive<BufReader<File>>) -> Vec<u64> {
    let names = (0..archive.len()).filter_map(|index| archive.name_for_index(index)?.ok());
    let number = |name: &str| name.strip_prefix("rgbd/")?.strip_suffix(".depth")?.parse().ok();
    let mut numbers: Vec<u64> = names.filter_map(|name| number(&name)).collect();
    numbers.sort_unstable();
    numbers
}

/// Returns the depth image size from the metadata, otherwise the known size that has the same number of pixels as the
/// first image.
fn depth_size(json: &Value, first_depth: &[u8]) -> Result<[u32; 2], String> {
    if let Some(size) = size(json, ["dw", "dh"]) {
        return Ok(size);
    }
    let max_bytes = KNOWN_SIZES.map(pixels).into_iter().max().unwrap_or_default() as u64 * 4 + 1;
    let count = unpacked(first_depth, max_bytes)?.len() / 4;
    let is_of_count = |size: &&[u32; 2]| pixels(**size) == count;
    let found = KNOWN_SIZES.iter().find(is_of_count);
    found
        .copied()
        .ok_or_else(|| format!("`dw` and `dh` are missing, and {count} depths are those of no known size"))
}

fn size(json: &Value, keys: [&str; 2]) -> Option<[u32; 2]> {
    let edge = |key: &str| {
        let edge = json.get(key)?.as_f64()?;
        (edge.fract() == 0.0 && (1.0..=32_768.0).contains(&edge)).then_some(edge as u32)
    };
    Some([edge(keys[0])?, edge(keys[1])?])
}

/// One camera has taken both images: the lens of the colour images, in their size.
fn calibration(json: &Value, path: &Path) -> Result<Calibration, String> {
    let numbers: Option<Vec<f64>> = json
        .get("K")
        .and_then(Value::as_array)
        .and_then(|list| list.iter().map(Value::as_f64).collect());
    let numbers = numbers.ok_or("`K` is missing")?;
    let lens = Intrinsics::pinhole_of(&numbers).ok_or("`K` has not nine numbers")?;
    let because = path.join("metadata").display().to_string();
    Ok(Calibration::of_depth(
        Intrinsics::pinhole(lens, size(json, ["w", "h"])),
        because,
    ))
}

fn poses(json: &Value) -> Vec<Option<DAffine3>> {
    let list = json
        .get("poses")
        .and_then(Value::as_array)
        .map_or(&[][..], Vec::as_slice);
    let pose = |value: &Value| {
        let numbers: Option<Vec<f64>> = value.as_array()?.iter().map(Value::as_f64).collect();
        let [qx, qy, qz, qw, x, y, z] = <[f64; 7]>::try_from(numbers?).ok()?;
        Some(of_backward(pose_of(
            DVec3::new(x, y, z),
            DQuat::from_xyzw(qx, qy, qz, qw),
        )?))
    };
    list.iter().map(pose).collect()
}

/// The stamp of a frame, else the time from its number and the frame rate.
fn time(json: &Value, number: u64) -> Option<Duration> {
    let stamp = json
        .get("frameTimestamps")
        .and_then(|stamps| stamps.get(number as usize)?.as_f64());
    let by_rate = || {
        let fps = json.get("fps")?.as_f64().filter(|fps| *fps > 0.0)?;
        Some(number as f64 / fps)
    };
    Duration::try_from_secs_f64(stamp.or_else(by_rate)?).ok()
}
