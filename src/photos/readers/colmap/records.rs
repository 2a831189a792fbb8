//! Rows of COLMAP's files, text or binary.

use crate::photos::sets::lens::Lens;
use crate::photos::sets::points::{Observation, SparsePoints};
use glam::{DVec2, DVec3, Vec2};
use std::collections::HashMap;

/// A camera, or why it is none that can be shown.
pub(super) type Cameras = HashMap<u32, Result<Lens, String>>;

/// A row of `images`.
#[derive(Debug)]
pub(super) struct Image {
    pub(super) id: u32,
    /// w x y z.
    pub(super) quaternion: [f64; 4],
    pub(super) shift: DVec3,
    pub(super) camera: u32,
    pub(super) name: String,
    /// Positions of the features; the centre of the first pixel is at (½, ½).
    pub(super) features: Vec<Vec2>,
}

/// Feature lookup, by which rows of points find the images that they name.
pub(super) struct Features<'a> {
    pub(super) images: HashMap<u32, (u32, &'a [Vec2])>,
}

impl Features<'_> {
    /// The pixel of feature `feature` of image `image`.
    pub(super) fn seen(&self, image: u32, feature: u32) -> Option<Observation> {
        let &(photo, features) = self.images.get(&image)?;
        let pixel = *features.get(feature as usize)?;
        Some(Observation { photo, pixel })
    }
}

/// A point.
pub(super) fn push(
    points: &mut SparsePoints,
    position: [f64; 3],
    color: [u8; 3],
    track: impl Iterator<Item = Observation>,
) {
    points.push(DVec3::from_array(position), color, track);
}

/// A feature of a text or binary row.
pub(super) fn feature([x, y]: [f64; 2]) -> Vec2 {
    DVec2::new(x, y).as_vec2()
}
