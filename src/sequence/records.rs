//! Frames → the records that are drawn, each array written in one pass into memory of the right size.

use super::Paint;
use super::coloring::UNIFORM_RGB;
use super::scaled::{field, points_in_class_colors, points_on_scale};
use crate::analysis::{Orientation, Surface, fake_color, splat_ellipses, splat_radii};
use crate::cloud::{Frame, PointRecord, ShapeRecord, encode_ellipse, oct_decode, oct_encode};
use glam::Vec3;
use rayon::prelude::*;
use std::borrow::Cow;

/// Points that are worth handing to another thread.
const POINTS_PER_TASK: usize = 1 << 15;

/// Normals and radii of every point of a frame, borrowed where the file has them.
pub(super) struct CompleteSurface<'a> {
    normals: Cow<'a, [Vec3]>,
    radii: Cow<'a, [f32]>,
    /// The criterion that decided the signs of most normals.
    pub(super) orientation: Orientation,
}

/// Work needed to complete a surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum SurfaceWork {
    /// The file has everything.
    None,
    /// The file has normals.
    Radii,
    /// Normals were missing, some or all.
    Surface,
}

/// Returns true if normals or radii have to be estimated for surfels, which takes longest.
pub(super) fn lacks_surface(frame: &Frame) -> bool {
    frame.all_normals().is_none() || frame.all_radii().is_none()
}

/// Takes the attributes of the file and estimates the rest: a zero normal and a zero radius count as missing. Where
/// normals are missing, `estimate` is given the positions and the place of the sensor.
pub(super) fn complete_surface(
    frame: &Frame,
    estimate: impl FnOnce(&[Vec3], Option<Vec3>) -> Surface,
) -> (CompleteSurface<'_>, SurfaceWork) {
    let positions = frame.positions();
    match (frame.all_normals(), frame.all_radii()) {
        (Some(normals), Some(radii)) => (
            CompleteSurface {
                normals: normals.into(),
                radii: radii.into(),
                orientation: Orientation::File,
            },
            SurfaceWork::None,
        ),
        (Some(normals), None) => {
            let mut estimated = splat_radii(positions, normals);
            keep_given(&mut estimated, frame.radii(), |&radius| radius > 0.0);
            (
                CompleteSurface {
                    normals: normals.into(),
                    radii: estimated.into(),
                    orientation: Orientation::File,
                },
                SurfaceWork::Radii,
            )
        }
        (None, _) => {
            let mut surface = estimate(positions, frame.sensor());
            keep_given(&mut surface.normals, frame.normals(), |&normal| normal != Vec3::ZERO);
            keep_given(&mut surface.radii, frame.radii(), |&radius| radius > 0.0);
            (
                CompleteSurface {
                    normals: surface.normals.into(),
                    radii: surface.radii.into(),
                    orientation: surface.orientation,
                },
                SurfaceWork::Surface,
            )
        }
    }
}

/// Overwrites `estimated` with the file's values, where usable.
fn keep_given<T: Copy>(estimated: &mut [T], given: Option<&[T]>, usable: impl Fn(&T) -> bool) {
    for (estimated, given) in estimated.iter_mut().zip(given.unwrap_or_default()) {
        if usable(given) {
            *estimated = *given;
        }
    }
}

/// One record per point, all disks; a scalar that is missing in the file, or not a number, is 0.
///
/// Written where they stay, part by part: a closure for each, handed to an iterator of many threads, is a call with the
/// record in memory, which is then read as a whole and waits for all parts. That was 14 % of preparing a frame.
pub(super) fn shape_records(frame: &Frame, surface: &CompleteSurface<'_>) -> Vec<ShapeRecord> {
    let mut shapes: Vec<ShapeRecord> = bytemuck::zeroed_vec(frame.len());
    let tasks = shapes.par_chunks_mut(POINTS_PER_TASK).enumerate();
    tasks.for_each(|(task, shapes)| {
        let points = task * POINTS_PER_TASK..task * POINTS_PER_TASK + shapes.len();
        let surface = surface.normals[points.clone()]
            .iter()
            .zip(&surface.radii[points.clone()]);
        for (shape, (&normal, &radius)) in shapes.iter_mut().zip(surface) {
            shape.normal = oct_encode(normal);
            shape.radius = radius;
        }
        let scalars = frame.scalars().map_or(&[][..], |scalars| &scalars[points]);
        for (shape, &scalar) in shapes.iter_mut().zip(scalars) {
            shape.scalar = if scalar.is_nan() { 0.0 } else { scalar };
        }
    });
    shapes
}

/// Returns the shapes with the ellipses of the file, or if it has none with those that close the surface: see
/// [`splat_ellipses`]. Radii are the quadratic means of half axes, as [`ShapeRecord`] has them.
pub(super) fn with_ellipses(frame: &Frame, shapes: &[ShapeRecord]) -> Vec<ShapeRecord> {
    let Some(ellipses) = frame.ellipses() else {
        let normals: Vec<Vec3> = shapes.par_iter().map(|shape| oct_decode(shape.normal)).collect();
        let closing = splat_ellipses(frame.positions(), &normals);
        let shapes = shapes.par_iter().zip(closing).with_min_len(POINTS_PER_TASK);
        return shapes
            .map(|(&shape, ellipse)| ShapeRecord {
                ellipse: ellipse.map_or(0, |ellipse| encode_ellipse(shape.normal, ellipse)),
                ..shape
            })
            .collect();
    };
    let shapes = shapes.par_iter().zip(ellipses).with_min_len(POINTS_PER_TASK);
    shapes
        .map(|(&shape, &ellipse)| ShapeRecord {
            ellipse: encode_ellipse(shape.normal, ellipse),
            radius: ellipse.quadratic_mean(shape.radius),
            ..shape
        })
        .collect()
}

/// Records in `paint`, which belongs to this frame. Precondition: `shapes` for fake colours of a frame that lacks
/// normals.
pub(super) fn painted_points(frame: &Frame, paint: &Paint, shapes: Option<&[ShapeRecord]>) -> Vec<PointRecord> {
    let in_one = |[red, green, blue]: [u8; 3]| {
        let color = [red, green, blue, 255];
        points(frame, rayon::iter::repeat_n(color, frame.len()))
    };
    match (paint, shapes) {
        (Paint::Uniform(color), _) => in_one(*color),
        (Paint::Normal, Some(shapes)) => points_in_shape_colors(frame, shapes),
        (Paint::Normal, None) => points_in_normal_colors(frame, frame.normals().unwrap_or_default()),
        (Paint::File, _) => match frame.colors() {
            Some(colors) => points(frame, colors.par_iter().copied()),
            None => in_one(UNIFORM_RGB),
        },
        (Paint::Classes(name), _) => match field(frame, name) {
            Some(field) => points_in_class_colors(frame, &field.values),
            None => in_one(UNIFORM_RGB),
        },
        (Paint::Scale { values, map, scale }, _) => {
            points_on_scale(frame, values, *map, scale).unwrap_or_else(|| in_one(UNIFORM_RGB))
        }
    }
}

/// Records in the fake colours of `shapes`.
fn points_in_shape_colors(frame: &Frame, shapes: &[ShapeRecord]) -> Vec<PointRecord> {
    points(
        frame,
        shapes.par_iter().map(|shape| fake_color(oct_decode(shape.normal))),
    )
}

/// Records in the fake colours of `normals`: the same bits as [`points_in_shape_colors`] for shapes with these normals.
fn points_in_normal_colors(frame: &Frame, normals: &[Vec3]) -> Vec<PointRecord> {
    points(
        frame,
        normals
            .par_iter()
            .map(|&normal| fake_color(oct_decode(oct_encode(normal)))),
    )
}

fn points(frame: &Frame, colors: impl IndexedParallelIterator<Item = [u8; 4]>) -> Vec<PointRecord> {
    frame
        .positions()
        .par_iter()
        .zip(colors)
        .with_min_len(POINTS_PER_TASK)
        .map(|(position, color)| PointRecord {
            position: position.to_array(),
            color,
        })
        .collect()
}
