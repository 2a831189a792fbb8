//! `cameras.bin`, `images.bin` and `points3D.bin`: a count, then that number of rows, little-endian.

use super::models::Model;
use super::records::{Cameras, Features, Image, feature, push};
use crate::photos::error::{PhotosError, read_file};
use crate::photos::parts::bytes::Bytes;
use crate::photos::sets::points::SparsePoints;
use glam::DVec3;
use std::path::Path;

/// Bytes that the shortest row of each file takes.
const MIN_CAMERA: usize = 4 + 4 + 16 + 2 * 8;
const MIN_IMAGE: usize = 4 + 7 * 8 + 4 + 1 + 8;
const MIN_POINT: usize = 8 + 24 + 3 + 8 + 8;
const FEATURE: usize = 24;
const TRACK_ENTRY: usize = 8;

pub(super) fn cameras(path: &Path) -> Result<Cameras, PhotosError> {
    let file = read_file(path)?;
    let mut bytes = Bytes::new(path, &file);
    let mut cameras = Cameras::new();
    for _ in 0..bytes.count("cameras", MIN_CAMERA)? {
        let id = bytes.u32()?;
        let number = bytes.u32()?.cast_signed();
        let size = [bytes.u64()?, bytes.u64()?];
        let Some(model) = Model::of_number(number) else {
            // The length of its row is unknown, so that the rest cannot be read.
            return Err(bytes.error(format!(
                "camera {id} has model number {number}, expected 0 to 6: undistort the images first"
            )));
        };
        let mut numbers = Vec::with_capacity(model.count);
        for _ in 0..model.count {
            let [number] = bytes.f64s()?;
            numbers.push(number);
        }
        cameras.insert(id, model.lens(size, &numbers));
    }
    Ok(cameras)
}

pub(super) fn images(path: &Path) -> Result<Vec<Image>, PhotosError> {
    let file = read_file(path)?;
    let mut bytes = Bytes::new(path, &file);
    let mut images = Vec::new();
    for _ in 0..bytes.count("images", MIN_IMAGE)? {
        let id = bytes.u32()?;
        let quaternion = bytes.f64s()?;
        let shift = DVec3::from_array(bytes.f64s()?);
        let camera = bytes.u32()?;
        let name = bytes.name()?;
        let count = bytes.count("features of an image", FEATURE)?;
        let mut features = Vec::with_capacity(count as usize);
        for _ in 0..count {
            features.push(feature(bytes.f64s()?));
            bytes.u64()?;
        }
        images.push(Image {
            id,
            quaternion,
            shift,
            camera,
            name,
            features,
        });
    }
    Ok(images)
}

pub(super) fn points(path: &Path, features: &Features<'_>) -> Result<SparsePoints, PhotosError> {
    let file = read_file(path)?;
    let mut bytes = Bytes::new(path, &file);
    let mut points = SparsePoints::default();
    let mut track = Vec::new();
    for _ in 0..bytes.count("points", MIN_POINT)? {
        bytes.u64()?;
        let position = bytes.f64s()?;
        let color = [bytes.u8()?, bytes.u8()?, bytes.u8()?];
        bytes.f64s::<1>()?;
        track.clear();
        for _ in 0..bytes.count("observations of a point", TRACK_ENTRY)? {
            let (image, index) = (bytes.u32()?, bytes.u32()?);
            track.extend(features.seen(image, index));
        }
        push(&mut points, position, color, track.drain(..));
    }
    Ok(points)
}
