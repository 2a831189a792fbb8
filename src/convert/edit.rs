//! Edits of a frame during conversion: crop, transform, voxel downsampling, subsampling, smoothing, normal estimation;
//! in this order.

use crate::analysis::{FileSurface, PlaneFit, SurfaceOptions, smooth};
use crate::cloud::{Cells, Ellipse, Frame, Positions, RawCloud, TooManyCells};
use crate::math::{Cube, order_of_codes};
use crate::progress::Progress;
use crate::scene::{Clip, ClipShape};
use glam::{DMat3, DMat4, DVec3, Vec3};
use std::fmt;
use std::num::NonZeroUsize;

/// Changes to a frame.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Edit {
    /// Crop: only the points that this keeps are left, with the faces between them. In file coordinates, before the
    /// transform.
    pub crop: Option<Clip>,
    /// Applied to positions in double precision, to normals, radii and ellipses accordingly.
    pub transform: Option<DMat4>,
    /// Edge of cells, in file units after the transform: the points of each become one, the mean of all they have.
    pub voxel_edge: Option<f64>,
    /// Most points that are left, spread evenly over the cloud. Meshes are sampled from their faces when they are read.
    pub sample_count: Option<NonZeroUsize>,
    /// Radius in point spacings of the neighbourhoods by which points are moved onto the surface around them.
    pub smoothing: Option<f32>,
    /// Normals and radii are estimated where the frame has none.
    pub estimates_normals: bool,
    /// Options of that.
    pub surface: SurfaceOptions,
}

/// Why a frame cannot be changed so.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum EditError {
    /// A transform without an inverse has no normals.
    #[error("the transform squeezes the cloud flat: its upper left 3 x 3 numbers must have an inverse")]
    FlatTransform,
    /// The cells cannot be counted.
    #[error(transparent)]
    TooManyCells(#[from] TooManyCells),
    /// The points cannot become a frame.
    #[error(transparent)]
    Cloud(#[from] crate::cloud::CloudError),
}

impl Edit {
    /// Changes `cloud`.
    pub fn apply(&self, cloud: &mut RawCloud) -> Result<(), EditError> {
        if let Some(clip) = &self.crop {
            crop(cloud, clip);
        }
        if let Some(transform) = self
            .transform
            .as_ref()
            .filter(|transform| **transform != DMat4::IDENTITY)
        {
            move_by(cloud, transform)?;
        }
        let face_count = cloud.faces.len();
        if let Some(edge) = self.voxel_edge {
            join_in_cells(cloud, edge)?;
        }
        if let Some(count) = self.sample_count {
            subsample(cloud, count.get());
        }
        if cloud.faces.len() < face_count {
            let text = format!("its {face_count} faces are not written: --voxel and --sample leave points alone");
            cloud.warnings.push(text);
        }
        if let Some(radius_spacings) = self.smoothing {
            move_onto_surface(cloud, radius_spacings)?;
        }
        if self.estimates_normals && cloud.attributes.normals.is_none() {
            estimate_normals(cloud, self.surface)?;
        }
        Ok(())
    }
}

impl fmt::Display for Edit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut words = Vec::new();
        if let Some(clip) = &self.crop {
            words.push(crop_in_words(clip));
        }
        if let Some(transform) = &self.transform {
            words.push(format!("transform {:?}", transform.transpose().to_cols_array()));
        }
        if let Some(edge) = self.voxel_edge {
            words.push(format!("cells of {edge}"));
        }
        if let Some(count) = self.sample_count {
            words.push(format!("{count} points"));
        }
        if let Some(radius_spacings) = self.smoothing {
            words.push(format!("smoothed within {radius_spacings} point spacings"));
        }
        if self.estimates_normals {
            words.push("normals estimated".to_owned());
            let SurfaceOptions { neighbours, fit } = self.surface;
            words.extend(neighbours.map(|neighbours| format!("from {neighbours} neighbours")));
            words.extend((fit != PlaneFit::default()).then(|| format!("{} fit", fit.name())));
        }
        if words.is_empty() {
            words.push("as it is".to_owned());
        }
        f.write_str(&words.join(", "))
    }
}

fn crop_in_words(clip: &Clip) -> String {
    let side = if clip.keeps_outside { "outside" } else { "within" };
    match clip.shape {
        ClipShape::Box { min, max } => format!("{side} the box from {min} to {max}"),
        ClipShape::Plane { normal, offset } => format!("{side} the half-space {normal} · p ≥ {offset}"),
    }
}

/// Leaves the points that `clip` keeps and the faces whose corners are all left.
fn crop(cloud: &mut RawCloud, clip: &Clip) {
    let inside: Vec<u32> = (0..cloud.positions.len() as u32)
        .filter(|&index| clip.keeps(cloud.positions.get(index as usize)))
        .collect();
    if inside.len() == cloud.positions.len() {
        return;
    }
    let mut new_index = vec![None; cloud.positions.len()];
    for (new, &old) in (0..).zip(&inside) {
        new_index[old as usize] = Some(new);
    }
    let moved = |&[a, b, c]: &[u32; 3]| {
        let corner = |index: u32| new_index[index as usize];
        Some([corner(a)?, corner(b)?, corner(c)?])
    };
    let faces: Vec<[u32; 3]> = cloud.faces.iter().filter_map(moved).collect();
    cloud.keep(&inside);
    cloud.skipped_faces -= faces.len();
    cloud.faces = faces;
    if inside.is_empty() {
        let text = format!("no point is {}: the frame is written without any", crop_in_words(clip));
        cloud.warnings.push(text);
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
    let moved = Positions::F64(moved.collect());
    cloud.positions = match cloud.positions {
        // A translation by whole numbers, or a permutation of the axes, needs no more digits.
        Positions::F32(_) => moved.narrowed(),
        Positions::F64(_) => moved,
    };
    cloud.made_from = None;
    cloud.integer_limits = None;
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
    // For a scale that differs between axes, the mean that preserves volumes.
    let scale = determinant.abs().cbrt() as f32;
    for radius in attributes.radii.iter_mut().flatten() {
        *radius *= scale;
    }
    cloud.sensor = cloud.sensor.map(|sensor| transform.transform_point3(sensor));
    if determinant < 0.0 {
        // A reflection turns faces inside out.
        for face in &mut cloud.faces {
            face.swap(1, 2);
        }
    }
    Ok(())
}

/// Voxel downsampling: the points of each cell become one.
fn join_in_cells(cloud: &mut RawCloud, edge: f64) -> Result<(), EditError> {
    let mut cells = Cells::new(edge);
    cells.add(cloud)?;
    if cells.is_empty() {
        return Ok(());
    }
    let is_single = matches!(cloud.positions, Positions::F32(_));
    (cloud.positions, cloud.attributes) = cells.into_points();
    if is_single {
        let joined = (0..cloud.positions.len()).map(|index| cloud.positions.get(index).as_vec3().to_array());
        cloud.positions = Positions::F32(joined.collect());
    }
    cloud.made_from = None;
    cloud.grid = None;
    cloud.faces.clear();
    Ok(())
}

/// Keeps `count` points, evenly spaced along the Morton order.
fn subsample(cloud: &mut RawCloud, count: usize) {
    let (finite_count, Some((min, max))) = cloud.positions.finite_bounds() else {
        return;
    };
    if finite_count <= count {
        return;
    }
    let finite: Vec<u32> = (0..cloud.positions.len() as u32)
        .filter(|&index| cloud.positions.get(index as usize).is_finite())
        .collect();
    let center = min * 0.5 + max * 0.5;
    let near: Vec<Vec3> = finite
        .iter()
        .map(|&index| (cloud.positions.get(index as usize) - center).as_vec3())
        .collect();
    let order = match Cube::around(&near) {
        Some(cube) => order_of_codes(&cube.codes(&near)),
        None => (0..near.len() as u32).collect(),
    };
    let mut retained: Vec<u32> = (0..count)
        .map(|place| finite[order[(2 * place + 1) * finite_count / (2 * count)] as usize])
        .collect();
    retained.sort_unstable();
    cloud.keep(&retained);
}

/// Moves the points onto the surface around them, and adds a warning. Normals stay.
fn move_onto_surface(cloud: &mut RawCloud, radius_spacings: f32) -> Result<(), EditError> {
    let (_, Some((min, max))) = cloud.positions.finite_bounds() else {
        return Ok(());
    };
    let points = RawCloud::from_positions(cloud.positions.clone());
    let frame = Frame::from_raw(points, min * 0.5 + max * 0.5)?;
    let smoothed = smooth(frame.positions(), radius_spacings, &Progress::default());
    let mut moved: Vec<[f64; 3]> = (0..cloud.positions.len())
        .map(|index| cloud.positions.get(index).to_array())
        .collect();
    let places = frame.positions().iter().zip(&smoothed.positions);
    for (&index, (&from, &to)) in frame.file_index().iter().zip(places) {
        // Points that did not move keep all digits of the file.
        let position = &mut moved[index as usize];
        *position = (DVec3::from_array(*position) + (to - from).as_dvec3()).to_array();
    }
    cloud.positions = match cloud.positions {
        Positions::F32(_) => {
            let singles = moved
                .into_iter()
                .map(|position| position.map(|coordinate| coordinate as f32));
            Positions::F32(singles.collect())
        }
        Positions::F64(_) => Positions::F64(moved),
    };
    cloud.made_from = None;
    cloud.integer_limits = None;
    cloud.warnings.push(smoothed.told(radius_spacings));
    Ok(())
}

/// Adds the normals that the window would estimate, and radii where there are none; points that are none get zeros.
fn estimate_normals(cloud: &mut RawCloud, options: SurfaceOptions) -> Result<(), EditError> {
    if let Some(FileSurface { normals, radii }) = FileSurface::of(cloud, options)? {
        cloud.attributes.normals = Some(normals);
        cloud.attributes.radii.get_or_insert(radii);
    }
    Ok(())
}
