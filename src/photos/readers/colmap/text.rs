//! `cameras.txt`, `images.txt` and `points3D.txt`: one row per line, `#` before remarks. An image has two lines, the
//! second of which may be empty.

use super::models::{Model, refusal};
use super::records::{Cameras, Features, Image, feature, push};
use crate::photos::error::{PhotosError, read_file};
use crate::photos::parts::text::{Text, quoted};
use crate::photos::sets::points::SparsePoints;
use glam::{DVec3, Vec2};
use std::path::Path;

pub(super) fn cameras(path: &Path) -> Result<Cameras, PhotosError> {
    let file = read_file(path)?;
    let file = String::from_utf8_lossy(&file);
    let mut text = Text::new(path, &file);
    let mut cameras = Cameras::new();
    text.skip_comments();
    while !text.is_at_end() {
        let id = text.number("the number of a camera")?;
        let name = text.word("the model of a camera")?;
        let size = [text.number("a width in pixels")?, text.number("a height in pixels")?];
        let words = text.rest_of_line().split_whitespace();
        let numbers: Result<Vec<f64>, String> = words
            .map(|word| {
                word.parse()
                    .map_err(|_| format!("its camera has {} for a number", quoted(word)))
            })
            .collect();
        let model = Model::of_name(name).ok_or_else(|| refusal(name));
        let lens = model.and_then(|model| model.lens(size, &numbers?));
        cameras.insert(id, lens);
        text.skip_comments();
    }
    Ok(cameras)
}

pub(super) fn images(path: &Path) -> Result<Vec<Image>, PhotosError> {
    let file = read_file(path)?;
    let file = String::from_utf8_lossy(&file);
    let mut text = Text::new(path, &file);
    let mut images = Vec::new();
    text.skip_comments();
    while !text.is_at_end() {
        let id = text.number("the number of an image")?;
        let quaternion = text.numbers("the rotation of an image (QW QX QY QZ)")?;
        let shift = DVec3::from_array(text.numbers("the translation of an image (TX TY TZ)")?);
        let camera = text.number("the number of a camera")?;
        let name = text.rest_of_line().to_owned();
        if name.is_empty() {
            return Err(text.error("the line before has no image name"));
        }
        let features = features(text.rest_of_line()).ok_or_else(|| {
            text.error(format!(
                "the line before has to list the features of {name} as X Y POINT3D_ID, or be empty"
            ))
        })?;
        images.push(Image {
            id,
            quaternion,
            shift,
            camera,
            name,
            features,
        });
        text.skip_comments();
    }
    Ok(images)
}

/// Triples of x, y and the number of a point.
fn features(line: &str) -> Option<Vec<Vec2>> {
    let mut words = line.split_whitespace();
    let mut features = Vec::new();
    while let Some(x) = words.next() {
        let (y, _point) = (words.next()?, words.next()?);
        features.push(feature([x.parse().ok()?, y.parse().ok()?]));
    }
    Some(features)
}

pub(super) fn points(path: &Path, features: &Features<'_>) -> Result<SparsePoints, PhotosError> {
    let file = read_file(path)?;
    let file = String::from_utf8_lossy(&file);
    let mut text = Text::new(path, &file);
    let mut points = SparsePoints::default();
    text.skip_comments();
    while !text.is_at_end() {
        text.word("the number of a point")?;
        let position = text.numbers("a position")?;
        let color: [f64; 3] = text.numbers("a colour")?;
        text.number::<f64>("an error in pixels")?;
        let mut track = Vec::new();
        let mut words = text.rest_of_line().split_whitespace();
        while let Some(image) = words.next() {
            let pair = || Some((image.parse().ok()?, words.next()?.parse().ok()?));
            let Some((image, index)) = { pair }() else {
                return Err(text.error("the line before has to end with pairs of IMAGE_ID POINT2D_IDX"));
            };
            track.extend(features.seen(image, index));
        }
        push(&mut points, position, color.map(|value| value as u8), track.into_iter());
        text.skip_comments();
    }
    Ok(points)
}
