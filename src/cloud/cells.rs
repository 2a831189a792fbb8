//! Voxel downsampling: points that lie in one cell become one, the mean of all that they have, of categories the most
//! frequent.

use super::cell_scalars::CellScalars;
use super::{Attributes, Positions, RawCloud};
use glam::{DVec3, I64Vec3, Vec3};
use std::collections::HashMap;

/// Cells from zero on that double precision tells apart.
const MAX_FROM_ZERO: f64 = 9e15;

/// Cells along the edge of a block. Points that follow each other are mostly in the same one, so its cells are found
/// without asking the table again.
// With one table entry per cell, the look-ups took longer than everything else.
const BLOCK_EDGE: i64 = 1 << BLOCK_BITS;
const BLOCK_BITS: i64 = 2;
const BLOCK_CELLS: usize = 1 << (3 * BLOCK_BITS);

/// Index of a cell without points.
const NOWHERE: u32 = u32::MAX;

/// Cells that a cloud has too many of.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error(
    "cells of {edge} cannot be counted at coordinates of {farthest:.3e}: choose an edge above {:.0e}",
    farthest / MAX_FROM_ZERO
)]
pub struct TooManyCells {
    /// Edge of the cells.
    pub edge: f64,
    /// Largest coordinate.
    pub farthest: f64,
}

/// Cells at multiples of an edge, the same in every cloud, with the points in them; ordered by their first points.
#[derive(Debug)]
pub struct Cells {
    edge: f64,
    /// Origin of positions, so that sums of many stay small.
    origin: DVec3,
    /// Index of each block in `places`, by its numbers along the axes.
    blocks: HashMap<I64Vec3, u32>,
    last_block: Option<(I64Vec3, u32)>,
    /// Indices in `sums` of the cells of each block.
    places: Vec<[u32; BLOCK_CELLS]>,
    sums: Vec<CellSums>,
    /// Cell values of each scalar field that the first cloud had.
    scalars: Vec<CellScalars>,
    kinds: Option<Kinds>,
}

/// Sums over the points of a cell.
#[derive(Debug, Clone, Copy, Default)]
struct CellSums {
    count: u32,
    color: [u64; 4],
    normal: Vec3,
    radius: f64,
    position: DVec3,
}

/// Attributes that all of the points have.
#[derive(Debug, Clone, Copy)]
struct Kinds {
    colors: bool,
    normals: bool,
    radii: bool,
}

impl Cells {
    /// Empty ones. Precondition: `edge > 0.0`.
    pub fn new(edge: f64) -> Self {
        Self {
            edge,
            origin: DVec3::ZERO,
            blocks: HashMap::new(),
            last_block: None,
            places: Vec::new(),
            sums: Vec::new(),
            scalars: Vec::new(),
            kinds: None,
        }
    }

    /// Returns the number of cells with points.
    pub fn len(&self) -> usize {
        self.sums.len()
    }

    /// True when no points were added.
    pub fn is_empty(&self) -> bool {
        self.sums.is_empty()
    }

    /// Edge of a cell, in the unit of positions.
    pub fn edge(&self) -> f64 {
        self.edge
    }

    /// Adds the points of `cloud` that are finite. Attributes that one of several clouds lacks are missing in the
    /// merged points. Precondition: `cloud` has the scalar fields of those before it.
    ///
    /// # Errors
    /// [`TooManyCells`] if some lie too far from zero for this edge; then nothing is added.
    pub fn add(&mut self, cloud: &RawCloud) -> Result<(), TooManyCells> {
        let (_, Some((min, max))) = cloud.positions.finite_bounds() else {
            return Ok(());
        };
        let farthest = min.abs().max(max.abs()).max_element();
        if farthest / self.edge > MAX_FROM_ZERO {
            return Err(TooManyCells {
                edge: self.edge,
                farthest,
            });
        }
        let attributes = &cloud.attributes;
        if self.kinds.is_none() {
            self.origin = min;
            self.scalars = attributes.scalars.iter().map(CellScalars::new).collect();
        }
        let all = self.kinds.unwrap_or(Kinds {
            colors: true,
            normals: true,
            radii: true,
        });
        self.kinds = Some(Kinds {
            colors: all.colors && attributes.colors.is_some(),
            normals: all.normals && attributes.normals.is_some(),
            radii: all.radii && attributes.radii.is_some(),
        });
        for index in 0..cloud.positions.len() {
            let position = cloud.positions.get(index);
            if position.is_finite() {
                self.add_point(cloud, index, position);
            }
        }
        Ok(())
    }

    fn add_point(&mut self, cloud: &RawCloud, index: usize, position: DVec3) {
        let place = self.place((position / self.edge).floor().as_i64vec3());
        let sums = &mut self.sums[place];
        sums.count += 1;
        sums.position += position - self.origin;
        let attributes = &cloud.attributes;
        if let Some(colors) = &attributes.colors {
            for (sum, channel) in sums.color.iter_mut().zip(colors[index]) {
                *sum += u64::from(channel);
            }
        }
        if let Some(normals) = &attributes.normals {
            sums.normal += Vec3::from_array(normals[index]);
        }
        if let Some(radii) = &attributes.radii {
            sums.radius += f64::from(radii[index]);
        }
        for (of_cells, field) in self.scalars.iter_mut().zip(&attributes.scalars) {
            of_cells.add(place, field.values[index]);
        }
    }

    /// Returns the index of the cell with these numbers along the axes.
    fn place(&mut self, cell: I64Vec3) -> usize {
        let block = cell >> BLOCK_BITS;
        let at = match self.last_block {
            Some((last, at)) if last == block => at,
            _ => *self.blocks.entry(block).or_insert_with(|| {
                self.places.push([NOWHERE; BLOCK_CELLS]);
                (self.places.len() - 1) as u32
            }),
        };
        self.last_block = Some((block, at));
        let place = &mut self.places[at as usize][index_in_block(cell)];
        if *place == NOWHERE {
            *place = self.sums.len() as u32;
            self.sums.push(CellSums::default());
            for of_cells in &mut self.scalars {
                of_cells.push_cell();
            }
        }
        *place as usize
    }

    /// Merges the cells into cells of twice the edge, with the same points.
    pub fn coarsen(&mut self) {
        let mut cells = vec![I64Vec3::ZERO; self.sums.len()];
        for (block, at) in self.blocks.drain() {
            for (index, &place) in self.places[at as usize].iter().enumerate() {
                if place != NOWHERE {
                    cells[place as usize] = BLOCK_EDGE * block + cell_in_block(index);
                }
            }
        }
        self.places.clear();
        self.last_block = None;
        self.edge *= 2.0;
        let fine = std::mem::take(&mut self.sums);
        let fine_scalars: Vec<CellScalars> = self.scalars.iter_mut().map(CellScalars::take).collect();
        for (index, (cell, fine)) in cells.into_iter().zip(fine).enumerate() {
            let place = self.place(cell >> 1);
            self.sums[place].add(&fine);
            for (of_cells, fine) in self.scalars.iter_mut().zip(&fine_scalars) {
                of_cells.add_cell(place, fine, index);
            }
        }
    }

    /// One point per cell, with the attributes common to all points. Merged splats of several directions have no
    /// ellipse.
    pub fn into_points(self) -> (Positions, Attributes) {
        let sums = &self.sums;
        let kinds = self.kinds.filter(|_| !sums.is_empty());
        let has = |kind: fn(Kinds) -> bool| kinds.is_some_and(kind);
        let position = |sums: &CellSums| (self.origin + sums.position / f64::from(sums.count)).to_array();
        let counts = || sums.iter().map(|sums| sums.count);
        let attributes = Attributes {
            colors: has(|kinds| kinds.colors).then(|| sums.iter().map(CellSums::mean_color).collect()),
            normals: has(|kinds| kinds.normals).then(|| sums.iter().map(CellSums::mean_normal).collect()),
            radii: has(|kinds| kinds.radii).then(|| sums.iter().map(|sums| sums.joined_radius(self.edge)).collect()),
            ellipses: None,
            scalars: self
                .scalars
                .into_iter()
                .map(|field| field.into_field(counts()))
                .collect(),
        };
        (Positions::F64(sums.iter().map(position).collect()), attributes)
    }
}

fn index_in_block(cell: I64Vec3) -> usize {
    let [x, y, z] = (cell & (BLOCK_EDGE - 1)).to_array();
    (x + BLOCK_EDGE * (y + BLOCK_EDGE * z)) as usize
}

fn cell_in_block(index: usize) -> I64Vec3 {
    let index = index as i64;
    I64Vec3::new(index, index >> BLOCK_BITS, index >> (2 * BLOCK_BITS)) & (BLOCK_EDGE - 1)
}

impl CellSums {
    fn add(&mut self, other: &Self) {
        self.count += other.count;
        self.position += other.position;
        for (sum, channel) in self.color.iter_mut().zip(other.color) {
            *sum += channel;
        }
        self.normal += other.normal;
        self.radius += other.radius;
    }

    fn mean_color(&self) -> [u8; 4] {
        self.color.map(|sum| (sum as f64 / f64::from(self.count)).round() as u8)
    }

    fn mean_normal(&self) -> [f32; 3] {
        self.normal.normalize_or_zero().to_array()
    }

    /// Returns the radius of the merged point, which covers the area that its points covered in part.
    fn joined_radius(&self, edge: f64) -> f32 {
        (self.radius / f64::from(self.count)).max(0.5 * edge) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cloud::ScalarField;
    use proptest::prelude::*;

    fn cloud(positions: &[[f64; 3]]) -> RawCloud {
        let mut cloud = RawCloud::from_positions(Positions::F64(positions.to_vec()));
        let (mut colors, mut normals, mut radii) = (Vec::new(), Vec::new(), Vec::new());
        let mut values = Vec::new();
        for position in positions {
            // Each point has different numbers, which do not depend on its position in the list.
            let number = position.iter().sum::<f64>();
            colors.push([(number.abs() * 37.0 % 256.0) as u8, 9, 200, 255]);
            normals.push([1.0, 0.0, number as f32 % 2.0]);
            radii.push(number.abs() as f32);
            values.push(number as f32);
        }
        cloud.attributes = Attributes {
            colors: Some(colors),
            normals: Some(normals),
            radii: Some(radii),
            ellipses: None,
            scalars: vec![ScalarField::new("number", values)],
        };
        cloud
    }

    fn joined(clouds: &[RawCloud], edge: f64, doubled: u32) -> (Vec<[f64; 3]>, Attributes) {
        let mut cells = Cells::new(edge);
        for cloud in clouds {
            cells.add(cloud).unwrap();
        }
        for _ in 0..doubled {
            cells.coarsen();
        }
        let (Positions::F64(positions), attributes) = cells.into_points() else {
            panic!("positions lost their precision");
        };
        (positions, attributes)
    }

    #[test]
    fn points_of_a_cell_become_their_mean_on_both_sides_of_zero() {
        let (positions, attributes) = joined(&[cloud(&[[0.5, 0.0, 0.0], [-0.5, 0.0, 0.0], [0.0, 0.5, 0.5]])], 1.0, 0);
        assert_eq!(positions, [[0.25, 0.25, 0.25], [-0.5, 0.0, 0.0]]);
        assert_eq!(attributes.scalars[0].values, [0.75, -0.5]);
        // Cells are at least covered.
        assert_eq!(attributes.radii, Some(vec![0.75, 0.5]));
    }

    #[test]
    fn categories_of_a_cell_become_the_most_frequent_of_them() {
        let mut cloud = cloud(&[
            [0.1, 0.0, 0.0],
            [0.2, 0.0, 0.0],
            [0.3, 0.0, 0.0],
            [1.5, 0.0, 0.0],
            [1.6, 0.0, 0.0],
        ]);
        cloud.attributes.scalars = vec![
            ScalarField::new("Classification", vec![2.0, 6.0, 6.0, 9.0, 5.0]),
            ScalarField::new("intensity", vec![1.0, 2.0, 6.0, 4.0, 4.0]),
        ];
        for (doubled, classes, intensities) in [(0, vec![6.0, 5.0], vec![3.0, 4.0]), (1, vec![6.0], vec![3.4])] {
            let (_, attributes) = joined(std::slice::from_ref(&cloud), 1.0, doubled);
            assert_eq!(attributes.scalars[0].values, classes, "doubled {doubled} times");
            assert_eq!(attributes.scalars[1].values, intensities, "doubled {doubled} times");
        }
    }

    #[test]
    fn merged_points_lack_what_the_cloud_lacks() {
        let mut bare = cloud(&[[3.0; 3]]);
        bare.attributes.colors = None;
        let (positions, attributes) = joined(&[cloud(&[[1.0; 3]]), bare], 1.0, 0);
        assert_eq!(positions.len(), 2);
        assert!(attributes.colors.is_none() && attributes.normals.is_some());
        let (positions, attributes) = joined(&[], 1.0, 0);
        assert!(positions.is_empty() && attributes == Attributes::default());
    }

    #[test]
    fn uncountable_cells_are_rejected() {
        let mut cells = Cells::new(1e-9);
        let error = cells.add(&cloud(&[[1e9, 0.0, 0.0]])).unwrap_err();
        assert!(error.to_string().contains("above 1e-7"), "{error}");
        assert!(cells.is_empty());
    }

    proptest! {
        /// The result is the same if points reach their cells at once or through finer ones, in one cloud or several.
        #[test]
        fn doubling_the_edge_matches_cells_of_that_edge(
            positions in prop::collection::vec(prop::array::uniform3(-4.0_f64..4.0), 1..60),
            split in 0_usize..60,
        ) {
            let split = split.min(positions.len());
            let (first, second) = positions.split_at(split);
            let (at_once, expected) = joined(&[cloud(&positions)], 1.0, 0);
            let (by_halves, attributes) = joined(&[cloud(first), cloud(second)], 0.25, 2);
            prop_assert_eq!(at_once.len(), by_halves.len());
            for (one, other) in at_once.iter().zip(&by_halves) {
                prop_assert!(DVec3::from(*one).abs_diff_eq(DVec3::from(*other), 1e-12));
            }
            prop_assert_eq!(expected.colors, attributes.colors);
            for (one, other) in expected.normals.unwrap().into_iter().zip(attributes.normals.unwrap()) {
                prop_assert!(Vec3::from(one).abs_diff_eq(Vec3::from(other), 1e-5));
            }
        }
    }
}
