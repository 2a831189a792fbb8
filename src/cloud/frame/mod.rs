//! A validated frame: finite f32 positions relative to the sequence origin, in Morton order.
//!
//! Points that are close in space are close in memory: reads of the points around a point, or of the texels under it,
//! hit the cache. [`Frame::file_index`] leads back to the file.

use super::attributes::{gather, usable_radii};
use super::error::MAX_POINTS;
use super::value_sample::{SharedSample, ValueSample};
use super::{
    Attributes, AxisConvention, CloudError, Ellipse, ImageGrid, LengthUnit, MadeFrom, Positions, RawCloud, ScalarField,
    Space, even_places, radius_factor,
};
use crate::math::{Aabb, Cube, Lattice, order_of_codes};
use glam::{DVec3, Vec3};
use std::sync::Arc;

/// One frame: a structure of arrays, all of one length.
///
/// Invariants, ensured by [`Frame::from_raw`]: every position and scalar is finite; normals are of unit length, or zero
/// where the file gave none that can be used; radii are finite and not negative; ellipses are present only together
/// with normals and radii; points are in the order of their Morton codes in [`Frame::cube`], those in one finest cell
/// in the order of the file.
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    positions: Vec<Vec3>,
    /// The index in the file of every point.
    file_index: Vec<u32>,
    attributes: Attributes,
    has_all_normals: bool,
    has_all_radii: bool,
    grid: Option<ImageGrid>,
    made_from: Option<MadeFrom>,
    sensor: Option<Vec3>,
    convention: Option<AxisConvention>,
    unit: Option<LengthUnit>,
    bounds: Aabb,
    cube: Cube,
    lattice: Option<Lattice>,
    dropped_points: usize,
    has_faces: bool,
    /// Points of the file that this one was not made from, as it is a sample.
    skipped: usize,
    /// Points of the next finer level, if this is a level of the frame that is not its finest.
    points_of_finer: Option<usize>,
    warnings: Vec<String>,
    sample: SharedSample,
}

impl Frame {
    /// Most points a frame can hold.
    pub const MAX_POINTS: usize = MAX_POINTS;

    /// Validates `raw`, moves it to the origin of `space` (in f64), drops points without finite coordinates and puts
    /// the others in Morton order.
    pub fn from_raw(raw: RawCloud, space: impl Into<Space>) -> Result<Self, CloudError> {
        let Space { origin, lattice } = space.into();
        let point_count = raw.positions.len();
        check_lengths(&raw)?;
        let moved = move_to_origin(raw.positions, origin);
        // 100,000 points with attributes are sorted in 3 to 4 ms on one thread, a tenth of the preparation of a frame
        // with normals; octrees are then built without sorting.
        let (bounds, cube, file_index) = finite_in_morton_order(&moved, lattice);
        let positions = gather(&moved, &file_index);
        drop(moved);
        let mut attributes = raw.attributes;
        attributes.keep(&file_index);
        // After all are at their places: a CPU that waits for roots fetches little from memory meanwhile.
        let usable_radii = if attributes.radii.is_some() {
            usable_radii(positions.len(), |index| positions[index].as_dvec3())
        } else {
            0.0..=f32::MAX
        };
        attributes.make_usable(&usable_radii);
        Ok(Self {
            bounds,
            cube,
            lattice,
            dropped_points: point_count - file_index.len(),
            positions,
            has_all_normals: hold_for_all(attributes.normals.as_deref(), |&normal| normal != [0.0; 3]),
            has_all_radii: hold_for_all(attributes.radii.as_deref(), |&radius| radius > 0.0),
            attributes,
            grid: raw.grid,
            made_from: raw.made_from,
            sensor: raw.sensor.map(|sensor| (sensor - origin).as_vec3()),
            convention: raw.convention,
            unit: raw.unit,
            has_faces: raw.skipped_faces + raw.faces.len() > 0,
            file_index,
            skipped: 0,
            points_of_finer: None,
            warnings: raw.warnings,
            sample: SharedSample::default(),
        })
    }

    /// [`Frame::from_raw`] of at most `max_points` points, taken evenly from the order of the file. Radii grow to cover
    /// the surface of all points.
    pub fn from_raw_sample(mut raw: RawCloud, space: impl Into<Space>, max_points: usize) -> Result<Self, CloudError> {
        let point_count = raw.positions.len();
        if point_count <= max_points {
            return Self::from_raw(raw, space);
        }
        check_lengths(&raw)?;
        let grid = raw.grid;
        raw.keep(&even_slots(point_count, max_points));
        raw.grid = grid;
        Self::from_sampled(raw, space, point_count)
    }

    /// [`Frame::from_raw_sample`] of a file of `point_count` points, where `raw` has only the sampled ones.
    ///
    /// # Panics
    /// Precondition: no more points than in the file.
    pub fn from_sampled(mut raw: RawCloud, space: impl Into<Space>, point_count: usize) -> Result<Self, CloudError> {
        let places = even_slots(point_count, raw.positions.len());
        assert_eq!(places.len(), raw.positions.len(), "points of a larger file");
        raw.attributes.scale_splats(radius_factor(point_count, places.len()));
        Self::from_raw(raw, space).map(|frame| frame.with_places(&places, point_count))
    }

    /// [`Frame::from_raw`] of a coarse level of a frame of `point_count` points, whose next finer level has
    /// `points_of_finer`. Each of its points stands for several; the index that it gets is near theirs where the file
    /// is in Morton order.
    ///
    /// # Panics
    /// Precondition: no more points than in the file.
    pub fn from_level(
        raw: RawCloud,
        space: impl Into<Space>,
        point_count: usize,
        points_of_finer: usize,
    ) -> Result<Self, CloudError> {
        let places = even_slots(point_count, raw.positions.len());
        assert_eq!(places.len(), raw.positions.len(), "points of a larger file");
        let mut frame = Self::from_raw(raw, space)?.with_places(&places, point_count);
        frame.points_of_finer = Some(points_of_finer);
        Ok(frame)
    }

    /// Sets the indices `places` of its points in a file of `point_count` points.
    fn with_places(mut self, places: &[u32], point_count: usize) -> Self {
        for index in &mut self.file_index {
            *index = places[*index as usize];
        }
        self.skipped = point_count - places.len();
        self
    }

    /// At most `max_points` of the points, and the index of each of them here: those that [`Frame::from_raw_sample`]
    /// takes from the file. Radii of the file grow to cover the surface of all points.
    pub fn sample(&self, max_points: usize) -> Result<(Self, Vec<u32>), CloudError> {
        let (taken, dropped_points) = self.slots_of_sample(max_points);
        let mut attributes = self.attributes.gathered(&taken);
        attributes.scale_splats(radius_factor(self.len(), taken.len()));
        let (mut part, slots) = self.with_points(&taken, attributes)?;
        part.skipped -= dropped_points;
        part.dropped_points = dropped_points;
        Ok((part, slots))
    }

    /// The slots of the points that are taken evenly in the order of the file, and how many of those taken were
    /// dropped.
    // Not in Morton order, in which one point that moves shifts all after it: points at rest would come and go from
    // frame to frame, and a sample of the file would be another one.
    fn slots_of_sample(&self, max_points: usize) -> (Vec<u32>, usize) {
        if self.len() <= max_points {
            return ((0..self.len() as u32).collect(), 0);
        }
        let wanted = if self.is_sample() {
            let mut indices = self.file_index.clone();
            indices.sort_unstable();
            gather(&indices, &even_slots(indices.len(), max_points))
        } else {
            even_slots(self.points_in_file(), max_points)
        };
        let mut is_wanted = vec![false; self.points_in_file()];
        for &index in &wanted {
            is_wanted[index as usize] = true;
        }
        let indices = self.file_index.iter().zip(0..);
        let taken: Vec<u32> = indices
            .filter_map(|(&index, slot)| is_wanted[index as usize].then_some(slot))
            .collect();
        let dropped_points = wanted.len() - taken.len();
        (taken, dropped_points)
    }

    /// The points at these slots without radii and ellipses.
    pub(crate) fn part_without_splats(&self, taken: &[u32]) -> Result<Self, CloudError> {
        let attributes = Attributes {
            radii: None,
            ellipses: None,
            ..self.attributes.gathered(taken)
        };
        self.with_points(taken, attributes).map(|(part, _)| part)
    }

    /// Copies the frame with its points at other `positions`, and with a `warning` that says so.
    ///
    /// # Panics
    /// Precondition: as many positions as points.
    pub(crate) fn moved(&self, positions: &[Vec3], warning: String) -> Result<Self, CloudError> {
        assert_eq!(positions.len(), self.len(), "one position for each point");
        let raw = RawCloud {
            attributes: self.attributes.clone(),
            grid: self.grid,
            sensor: self.sensor.map(Vec3::as_dvec3),
            convention: self.convention,
            unit: self.unit,
            warnings: self.warnings.iter().cloned().chain([warning]).collect(),
            ..RawCloud::from_positions(Positions::F32(positions.iter().map(Vec3::to_array).collect()))
        };
        let mut moved = Self::from_raw(raw, self.space())?;
        moved.file_index = gather(&self.file_index, &moved.file_index);
        (moved.dropped_points, moved.skipped) = (self.dropped_points, self.skipped);
        (moved.points_of_finer, moved.has_faces) = (self.points_of_finer, self.has_faces);
        moved.share_sample(Arc::clone(self.value_sample()));
        Ok(moved)
    }

    /// The points at these slots with their `attributes`, and the index of each of them here.
    fn with_points(&self, taken: &[u32], attributes: Attributes) -> Result<(Self, Vec<u32>), CloudError> {
        let raw = RawCloud {
            attributes,
            grid: self.grid,
            sensor: self.sensor.map(Vec3::as_dvec3),
            convention: self.convention,
            unit: self.unit,
            warnings: self.warnings.clone(),
            ..RawCloud::from_positions(Positions::F32(bytemuck::cast_vec(gather(&self.positions, taken))))
        };
        let mut part = Self::from_raw(raw, self.space())?;
        let slots = gather(taken, &part.file_index);
        part.file_index = gather(&self.file_index, &slots);
        part.skipped = self.points_in_file() - slots.len();
        part.has_faces = self.has_faces;
        part.share_sample(Arc::clone(self.value_sample()));
        Ok((part, slots))
    }

    /// Number of points; may be 0.
    pub fn len(&self) -> usize {
        self.positions.len()
    }

    /// True when no point is left.
    pub fn is_empty(&self) -> bool {
        self.positions.is_empty()
    }

    /// The index of every point in the file, dropped points counted.
    pub fn file_index(&self) -> &[u32] {
        &self.file_index
    }

    /// Finite positions relative to the sequence origin.
    pub fn positions(&self) -> &[Vec3] {
        &self.positions
    }

    /// 8-bit colours of the file.
    pub fn colors(&self) -> Option<&[[u8; 4]]> {
        self.attributes.colors.as_deref()
    }

    /// Unit normals of the file, zero where it gave none that can be used.
    pub fn normals(&self) -> Option<&[Vec3]> {
        self.attributes.normals.as_deref().map(bytemuck::cast_slice)
    }

    /// [`Frame::normals`] if every point has one.
    pub fn all_normals(&self) -> Option<&[Vec3]> {
        self.normals().filter(|_| self.has_all_normals)
    }

    /// [`Frame::radii`] if every point has one.
    pub fn all_radii(&self) -> Option<&[f32]> {
        self.radii().filter(|_| self.has_all_radii)
    }

    /// Splat radii of the file, 0 where it gave none that can be used.
    pub fn radii(&self) -> Option<&[f32]> {
        self.attributes.radii.as_deref()
    }

    /// Shapes of the splats of the file, each in the plane across its normal and with the area of a disk of its radius.
    pub fn ellipses(&self) -> Option<&[Ellipse]> {
        self.attributes.ellipses.as_deref()
    }

    /// The image that the points of the file are: `grid.cell(file_index)` is the cell of a point.
    pub fn grid(&self) -> Option<ImageGrid> {
        self.grid
    }

    /// Returns the source of positions and colours, where they have not been changed since they were made from it.
    pub fn made_from(&self) -> Option<&MadeFrom> {
        self.made_from.as_ref()
    }

    /// Some points of the first frame of the sequence, which decide the settings common to all frames; points of this
    /// frame where it belongs to no sequence.
    pub fn value_sample(&self) -> &Arc<ValueSample> {
        self.sample.0.get_or_init(|| {
            let (positions, colors) = (self.positions(), self.colors());
            Arc::new(ValueSample::of_arrays(
                positions,
                colors,
                self.scalar_fields(),
                self.sensor,
            ))
        })
    }

    /// Takes the sample of its sequence. Has no effect once the sample was used.
    pub(crate) fn share_sample(&self, sample: Arc<ValueSample>) {
        _ = self.sample.0.set(sample);
    }

    /// The values of the first scalar field (intensity and the like), the best to colour by; NaN where the file has no
    /// finite number.
    pub fn scalars(&self) -> Option<&[f32]> {
        self.scalar_fields().first().map(|field| field.values.as_slice())
    }

    /// All scalar fields of the file; NaN where it has no finite number.
    pub fn scalar_fields(&self) -> &[ScalarField] {
        &self.attributes.scalars
    }

    /// Returns the sensor position, relative to the sequence origin.
    pub fn sensor(&self) -> Option<Vec3> {
        self.sensor
    }

    /// Returns the axis convention stated by the file.
    pub fn convention(&self) -> Option<AxisConvention> {
        self.convention
    }

    /// The unit of positions, if the file has it.
    pub fn unit(&self) -> Option<LengthUnit> {
        self.unit
    }

    /// The box around all positions.
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// The cube in whose Morton order the points are, and that octrees of them divide: around all positions, of the
    /// cells that the frames of a sequence share.
    pub fn cube(&self) -> Cube {
        self.cube
    }

    /// The space of the positions.
    pub(crate) fn space(&self) -> Space {
        Space {
            origin: DVec3::ZERO,
            lattice: self.lattice,
        }
    }

    /// The level of its own octree whose cells have the size of a level of the first frame's: settings count levels
    /// from there, so that one number means one size in all frames.
    pub(crate) fn own_level(&self, level_of_first: u32) -> u32 {
        level_of_first.saturating_add_signed(self.levels_above_first())
    }

    /// The inverse of [`Frame::own_level`].
    pub(crate) fn level_of_first(&self, own_level: u32) -> u32 {
        own_level.saturating_add_signed(-self.levels_above_first())
    }

    /// Doublings from the cube of the sequence's first frame to this one's.
    fn levels_above_first(&self) -> i32 {
        self.lattice.map_or(0, |lattice| lattice.level_of(&self.cube))
    }

    /// Returns the number of points of the file without finite coordinates.
    pub fn dropped_points(&self) -> usize {
        self.dropped_points
    }

    /// Returns true if the file has triangles, of which these are vertices, or points that were sampled on them: see
    /// [`Mesh`](super::Mesh).
    pub fn has_faces(&self) -> bool {
        self.has_faces
    }

    /// Points of the file, whether they are here or not.
    pub fn points_in_file(&self) -> usize {
        self.len() + self.dropped_points + self.skipped
    }

    /// Returns true if the frame is a sample: points of the file were skipped to save time.
    pub fn is_sample(&self) -> bool {
        self.skipped > 0
    }

    /// Points of the next finer level of the same frame, if this is one that is stored by levels, and not its finest.
    pub fn points_of_finer(&self) -> Option<usize> {
        self.points_of_finer
    }

    /// Returns the warnings about parts of the file that could not be read although its points could: see
    /// [`RawCloud::warnings`].
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// Adds to [`Frame::warnings`].
    pub(crate) fn warn(&mut self, warning: String) {
        self.warnings.push(warning);
    }

    /// Bytes of all arrays.
    pub fn byte_size(&self) -> usize {
        let per_point = size_of::<Vec3>() + size_of::<u32>() + self.attributes.point_bytes();
        self.len() * per_point + self.made_from.as_ref().map_or(0, MadeFrom::byte_size)
    }
}

/// Returns true if there are values and all of them meet the condition. Several are tested together: a branch for each
/// costs more.
fn hold_for_all<T>(values: Option<&[T]>, holds: impl Fn(&T) -> bool) -> bool {
    let together = |values: &[T]| values.iter().fold(true, |all, value| all & holds(value));
    values.is_some_and(|values| values.chunks(64).all(together))
}

/// Every attribute has one entry a point, and there are not too many points.
fn check_lengths(raw: &RawCloud) -> Result<(), CloudError> {
    let point_count = raw.positions.len();
    match raw.attributes.other_length(point_count) {
        Some((attribute, found)) => Err(CloudError::LengthMismatch {
            attribute: attribute.to_owned(),
            expected: point_count,
            found,
        }),
        None if point_count > Frame::MAX_POINTS => Err(CloudError::TooManyPoints { found: point_count }),
        None => Ok(()),
    }
}

/// [`even_places`] of no more points than a frame can hold.
fn even_slots(count: usize, max: usize) -> Vec<u32> {
    let places = even_places(count, max).into_iter();
    places.map(|place| place as u32).collect()
}

/// Positions relative to `origin`: subtracted in f64, narrowed after. Not yet free of NaN and infinities.
fn move_to_origin(positions: Positions, origin: DVec3) -> Vec<Vec3> {
    match positions {
        Positions::F32(positions) if origin == DVec3::ZERO => bytemuck::cast_vec(positions),
        positions => (0..positions.len())
            .map(|index| (positions.get(index) - origin).as_vec3())
            .collect(),
    }
}

/// The box and the cube around all finite positions, and their indices in Morton order.
fn finite_in_morton_order(positions: &[Vec3], lattice: Option<Lattice>) -> (Aabb, Cube, Vec<u32>) {
    if positions.iter().all(|position| position.is_finite()) {
        return in_morton_order(positions, lattice);
    }
    let (finite, index): (Vec<Vec3>, Vec<u32>) = positions
        .iter()
        .zip(0..)
        .filter(|(position, _)| position.is_finite())
        .unzip();
    let (bounds, cube, order) = in_morton_order(&finite, lattice);
    (bounds, cube, gather(&index, &order))
}

fn in_morton_order(positions: &[Vec3], lattice: Option<Lattice>) -> (Aabb, Cube, Vec<u32>) {
    let bounds = Aabb::from_points(positions);
    let cube = match lattice {
        Some(lattice) => lattice.cube_around(&bounds),
        None => Cube::around_box(&bounds),
    };
    let cube = cube.unwrap_or(Cube::EMPTY);
    (bounds, cube, order_of_codes(&cube.codes(positions)))
}

#[cfg(test)]
mod tests;
