//! Frame facts: the summary of a frame after inspection.

use crate::cloud::{Frame, MissingPoints, NoData, Positions, RawCloud, make_holes, usable_radii};
use crate::scene::{FirstLook, UpAxis};
use glam::DVec3;

/// Facts of one frame, in file coordinates.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameFacts {
    /// Points, holes included.
    pub point_count: usize,
    /// Points with three finite coordinates.
    pub finite_count: usize,
    /// Finite no-data points.
    pub missing: MissingPoints,
    /// Corners of the box around the other finite points.
    pub bounds: Option<(DVec3, DVec3)>,
    /// Names of the point attributes.
    pub attributes: Vec<String>,
    /// Points that lie exactly where an earlier one does.
    pub duplicate_count: usize,
    /// Normals of no length or not finite, of finite points.
    pub zero_normal_count: usize,
    /// Radii that are infinite, not a number, or far larger than the cloud.
    pub absurd_radius_count: usize,
    /// True if 8-bit colours were found in wider fields.
    pub has_narrow_colors: bool,
    /// True if the file has single-precision coordinates.
    pub is_single_precision: bool,
    /// Probable up axis; `None` without a point.
    pub probable_up: Option<UpAxis>,
    /// Size of the image whose pixels the points are.
    pub image_px: Option<[u32; 2]>,
    /// Parts of the file that are not read, as nothing uses them.
    pub dropped: Vec<String>,
    /// Warnings about parts of the file that could not be read although its points could.
    pub warnings: Vec<String>,
}

impl FrameFacts {
    /// Looks at every point of `raw`.
    pub fn of(mut raw: RawCloud, no_data: NoData) -> Self {
        let missing = MissingPoints::of(&raw, no_data);
        let bounds = missing.bounds;
        let zero_normals = raw.attributes.normals.iter().flatten().enumerate();
        let facts = Self {
            point_count: raw.positions.len(),
            finite_count: missing.present_count + missing.indices.len(),
            bounds,
            attributes: raw.point_names(),
            duplicate_count: duplicates(&raw.positions),
            zero_normal_count: zero_normals
                .filter(|(index, normal)| {
                    let length = glam::Vec3::from_array(**normal).length();
                    (length == 0.0 || !length.is_finite()) && raw.positions.get(*index).is_finite()
                })
                .count(),
            absurd_radius_count: absurd_radii(&raw),
            has_narrow_colors: raw.has_narrow_colors,
            is_single_precision: matches!(raw.positions, Positions::F32(_)),
            probable_up: None,
            image_px: raw.grid.map(|grid| [grid.width(), grid.height()]),
            dropped: noted(&raw),
            warnings: raw.warnings.clone(),
            missing,
        };
        make_holes(&mut raw.positions, &facts.missing.indices);
        Self {
            probable_up: probable_up(raw, bounds),
            ..facts
        }
    }
}

/// Returns the unread parts of interest to viewers of the file.
fn noted(raw: &RawCloud) -> Vec<String> {
    let noted = raw.dropped.iter().filter(|entry| entry.is_noted);
    noted.map(|entry| entry.what.clone()).collect()
}

/// Counts the radii that cannot be drawn.
fn absurd_radii(raw: &RawCloud) -> usize {
    let Some(radii) = &raw.attributes.radii else { return 0 };
    let usable = usable_radii(raw.positions.len(), |index| raw.positions.get(index));
    // 0 and less stand for none.
    let is_absurd = |radius: &&f32| !radius.is_finite() || **radius > 0.0 && !usable.contains(*radius);
    radii.iter().filter(is_absurd).count()
}

/// Counts duplicates: finite points at exactly the position of an earlier one.
fn duplicates(positions: &Positions) -> usize {
    // Adding zero turns negative zero into positive zero.
    let bits = |value: f64| (value + 0.0).to_bits();
    let mut keys: Vec<[u64; 3]> = (0..positions.len())
        .map(|index| positions.get(index))
        .filter(|position| position.is_finite())
        .map(|position| position.to_array().map(bits))
        .collect();
    let finite_count = keys.len();
    keys.sort_unstable();
    keys.dedup();
    finite_count - keys.len()
}

/// Returns the up axis that a window would guess.
fn probable_up(raw: RawCloud, bounds: Option<(DVec3, DVec3)>) -> Option<UpAxis> {
    const SAMPLE_POINTS: usize = 1 << 17;
    let (min, max) = bounds?;
    let origin = min * 0.5 + max * 0.5;
    let frame = Frame::from_raw_sample(raw, origin, SAMPLE_POINTS).ok()?;
    Some(FirstLook::of(&[&frame], origin).up)
}
