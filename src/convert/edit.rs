//! What becomes of a frame on its way: moved, joined in cells, thinned out, given normals; in this order.

use crate::analysis::FileSurface;
use crate::cloud::{Attributes, Ellipse, Positions, RawCloud, ScalarField};
use crate::math::{Cube, order_of_codes};
use glam::{DMat3, DMat4, DVec3, Vec3};
use std::collections::HashMap;
use std::fmt;
use std::num::NonZeroUsize;

/// Changes to a frame.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Edit {
    /// Applied to positions in double precision, to normals, radii and ellipses accordingly.
    pub transform: Option<DMat4>,
    /// Edge of cells, in file units after the transform: the points of each become one, the mean of all they have.
    pub voxel_edge: Option<f64>,
    /// Most points that are left, spread evenly over the cloud. Meshes are sampled from their faces when they are read.
    pub sample_count: Option<NonZeroUsize>,
    /// Normals and radii are estimated where the frame has none.
    pub estimates_normals: bool,
}

/// Why a frame cannot be changed so.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum EditError {
    /// A transform without an inverse has no normals.
    #[error("the transform squeezes the cloud flat: its upper left 3 x 3 numbers must have an inverse")]
    FlatTransform,
    /// Cells that a cloud has too many of.
    #[error(
        "cells of {edge} cannot be counted at coordinates of {farthest:.3e}: choose an edge above {:.0e}",
        farthest / MOST_CELLS
    )]
    TooManyCells {
        /// Edge that was asked for.
        edge: f64,
        /// Largest coordinate.
        farthest: f64,
    },
    /// The points cannot become a frame.
    #[error(transparent)]
    Cloud(#[from] crate::cloud::CloudError),
}

/// Cells from zero on that double precision tells apart.
const MOST_CELLS: f64 = 9e15;

impl Edit {
    /// Changes `cloud`.
    pub fn apply(&self, cloud: &mut RawCloud) -> Result<(), EditError> {
        if let Some(transform) = &self.transform {
            move_by(cloud, transform)?;
        }
        if let Some(edge) = self.voxel_edge {
            join_in_cells(cloud, edge)?;
        }
        if let Some(count) = self.sample_count {
            thin_out(cloud, count.get());
        }
        if self.estimates_normals && cloud.attributes.normals.is_none() {
            estimate_normals(cloud)?;
        }
        Ok(())
    }
}

impl fmt::Display for Edit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut words = Vec::new();
        if let Some(transform) = &self.transform {
            words.push(format!("transform {:?}", transform.transpose().to_cols_array()));
        }
        if let Some(edge) = self.voxel_edge {
            words.push(format!("cells of {edge}"));
        }
        if let Some(count) = self.sample_count {
            words.push(format!("{count} points"));
        }
        if self.estimates_normals {
            words.push("normals estimated".to_owned());
        }
        if words.is_empty() {
            words.push("as it is".to_owned());
        }
        f.write_str(&words.join(", "))
    }
}

fn move_by(cloud: &mut RawCloud, transform: &DMat4) -> Result<(), EditError> {
    let linear = DMat3::from_mat4(*transform);
    let determinant = linear.determinant();
    if determinant == 0.0 || !determinant.is_finite() {
        return Err(EditError::FlatTransform);
    }
    let moved = (0..cloud.positions.len()).map(|index| {
        let position = cloud.positions.get(index);
        transform.transform_point3(position).to_array()
    });
    cloud.positions = Positions::F64(moved.collect());
    cloud.made_from = None;
    let of_normals = linear.inverse().transpose();
    let attributes = &mut cloud.attributes;
    let normals = attributes.normals.iter().flatten();
    for (ellipse, normal) in attributes.ellipses.iter_mut().flatten().zip(normals) {
        let across = Vec3::from_array(*normal).normalize_or_zero().cross(ellipse.axis);
        let [p, q] = [ellipse.axis, ellipse.ratio * across].map(|half| (linear * half.as_dvec3()).as_vec3());
        *ellipse = Ellipse::of_conjugate_diameters(p, q);
    }
    for normal in attributes.normals.iter_mut().flatten() {
        let turned = of_normals * Vec3::from_array(*normal).as_dvec3();
        *normal = turned.normalize_or_zero().as_vec3().to_array();
    }
    // Of a scale that differs by axis, the mean that keeps volumes.
    let scale = determinant.abs().cbrt() as f32;
    for radius in attributes.radii.iter_mut().flatten() {
        *radius *= scale;
    }
    cloud.sensor = cloud.sensor.map(|sensor| transform.transform_point3(sensor));
    if determinant < 0.0 {
        // A mirror turns faces inside out.
        for face in &mut cloud.faces {
            face.swap(1, 2);
        }
    }
    Ok(())
}

/// Sums of the points in a cell.
#[derive(Default)]
struct CellSums {
    count: f64,
    position: DVec3,
    color: [f64; 4],
    normal: Vec3,
    radius: f64,
    scalars: Vec<f64>,
}

/// The points of each cell become one. Cells stand in the order of their first point in the file.
fn join_in_cells(cloud: &mut RawCloud, edge: f64) -> Result<(), EditError> {
    let (_, Some((min, max))) = cloud.positions.finite_bounds() else {
        return Ok(());
    };
    let farthest = min.abs().max(max.abs()).max_element();
    if farthest / edge > MOST_CELLS {
        return Err(EditError::TooManyCells { edge, farthest });
    }
    let mut places: HashMap<[i64; 3], usize> = HashMap::new();
    let mut cells: Vec<CellSums> = Vec::new();
    for index in 0..cloud.positions.len() {
        let position = cloud.positions.get(index);
        if !position.is_finite() {
            continue;
        }
        // Cells lie on multiples of the edge, in every frame the same.
        let key = (position / edge).floor().as_i64vec3().to_array();
        let place = *places.entry(key).or_insert_with(|| {
            cells.push(CellSums {
                scalars: vec![0.0; cloud.attributes.scalars.len()],
                ..CellSums::default()
            });
            cells.len() - 1
        });
        let cell = &mut cells[place];
        cell.count += 1.0;
        cell.position += position - min;
        if let Some(colors) = &cloud.attributes.colors {
            for (sum, channel) in cell.color.iter_mut().zip(colors[index]) {
                *sum += f64::from(channel);
            }
        }
        if let Some(normals) = &cloud.attributes.normals {
            cell.normal += Vec3::from_array(normals[index]);
        }
        if let Some(radii) = &cloud.attributes.radii {
            cell.radius += f64::from(radii[index]);
        }
        for (sum, field) in cell.scalars.iter_mut().zip(&cloud.attributes.scalars) {
            *sum += f64::from(field.values[index]);
        }
    }
    let means = cells.iter().map(|cell| min + cell.position / cell.count);
    cloud.positions = match cloud.positions {
        Positions::F32(_) => Positions::F32(means.map(|mean| mean.as_vec3().to_array()).collect()),
        Positions::F64(_) => Positions::F64(means.map(|mean| mean.to_array()).collect()),
    };
    cloud.made_from = None;
    let color = |cell: &CellSums| cell.color.map(|sum| (sum / cell.count).round() as u8);
    let normal = |cell: &CellSums| cell.normal.normalize_or_zero().to_array();
    // What one point covers, each of the joined ones covered in part.
    let radius = |cell: &CellSums| ((cell.radius / cell.count).max(0.5 * edge)) as f32;
    let scalar = |(place, field): (usize, &ScalarField)| {
        let mean = |cell: &CellSums| (cell.scalars[place] / cell.count) as f32;
        field.with_values(cells.iter().map(mean).collect())
    };
    let joined = &cloud.attributes;
    cloud.attributes = Attributes {
        colors: joined.colors.as_ref().map(|_| cells.iter().map(color).collect()),
        normals: joined.normals.as_ref().map(|_| cells.iter().map(normal).collect()),
        radii: joined.radii.as_ref().map(|_| cells.iter().map(radius).collect()),
        // Splats of several directions together have none.
        ellipses: None,
        scalars: joined.scalars.iter().enumerate().map(scalar).collect(),
    };
    cloud.grid = None;
    cloud.faces.clear();
    Ok(())
}

/// Leaves `count` points, evenly spread: every so many-th along the Morton order.
fn thin_out(cloud: &mut RawCloud, count: usize) {
    let (finite_count, Some((min, max))) = cloud.positions.finite_bounds() else {
        return;
    };
    if finite_count <= count {
        return;
    }
    let finite: Vec<u32> = (0..cloud.positions.len() as u32)
        .filter(|&index| cloud.positions.get(index as usize).is_finite())
        .collect();
    let middle = min * 0.5 + max * 0.5;
    let near: Vec<Vec3> = finite
        .iter()
        .map(|&index| (cloud.positions.get(index as usize) - middle).as_vec3())
        .collect();
    let order = match Cube::around(&near) {
        Some(cube) => order_of_codes(&cube.codes(&near)),
        None => (0..near.len() as u32).collect(),
    };
    let mut kept: Vec<u32> = (0..count)
        .map(|place| finite[order[(2 * place + 1) * finite_count / (2 * count)] as usize])
        .collect();
    kept.sort_unstable();
    cloud.keep(&kept);
}

/// Adds the normals that the window would estimate, and radii where there are none; points that are none get zeros.
fn estimate_normals(cloud: &mut RawCloud) -> Result<(), EditError> {
    if let Some(FileSurface { normals, radii }) = FileSurface::of(cloud)? {
        cloud.attributes.normals = Some(normals);
        cloud.attributes.radii.get_or_insert(radii);
    }
    Ok(())
}
