//! Surface for view-dependent texturing, which posed images are projected onto.
//!
//! Points reconstructed from images are few, and some of them are wrong: mismatched features of two images are
//! somewhere in the air. The disk of a point that is far from all others is as large as the surface it hides. With
//! images projected onto it, it shows the surface behind it at a wrong position. So [outliers](stray_points) shrink to
//! dots, and normals and radii are estimated without them, for they had turned the disks around them.
//!
//! The points of the frame stay: they are the file's, and without posed images they are drawn.
//!
//! A disk of few points reaches beyond an outline, and takes the images from the surface behind it. So [splats are
//! curved](bent_disks): smaller ones on the curved surface are drawn, and images are occluded by these.

use crate::analysis::{Disk, Surface, SurfaceOptions, curved_splats, estimate_surface_observed, outliers, splat_radii};
use crate::cloud::{Frame, PointRecord, ShapeRecord, oct_decode, oct_encode};
use crate::photos::PhotoSurface;
use crate::progress::Progress;
use glam::Vec3;
use std::sync::Arc;

/// Clouds of more points are dense: the disks of stray ones are small there.
const MAX_POINTS: usize = 1 << 18;

/// Disks of more points are too small to be seen as such; the curved ones would be up to 19 times as many.
const MAX_CURVED: usize = 1 << 15;

/// Scale of an outlier's disk, as a factor on its radius.
const SHRUNK: f32 = 1e-3;

/// Returns the outlier flag of each point: none is set if the file defines how large disks are, or there are too many
/// points.
pub(super) fn is_outlier(frame: &Frame) -> Vec<bool> {
    if frame.len() > MAX_POINTS || frame.radii().is_some() {
        return vec![false; frame.len()];
    }
    // Textured, the large disk of an outlier shows a shifted background, the largest error of sparse sets. With
    // outliers as dots: 21.80 → 26.88 dB (ball and ring, 3,500 points), 27.58 → 30.87 dB (room, 1,500 points).
    outliers(frame.positions())
}

/// Returns the shapes of a frame without its outliers, estimated with `options`; `None` if there are none of these.
/// Precondition: a shape for each point.
pub(super) fn without_outliers(
    frame: &Frame,
    shapes: &[ShapeRecord],
    options: SurfaceOptions,
    is_outlier: &[bool],
) -> Option<Vec<ShapeRecord>> {
    let cached: Vec<usize> = (0..is_outlier.len()).filter(|&at| !is_outlier[at]).collect();
    if cached.len() == is_outlier.len() {
        return None;
    }
    let surface = surface_of(frame, shapes, options, &cached);
    let mut shapes = shapes.to_vec();
    for (shape, _) in shapes.iter_mut().zip(is_outlier).filter(|(_, is_outlier)| **is_outlier) {
        shape.radius *= SHRUNK;
    }
    for (&at, (normal, radius)) in cached.iter().zip(surface) {
        shapes[at].normal = normal;
        shapes[at].radius = radius;
    }
    Some(shapes)
}

/// The disks of a frame, bent with the surface; `None` where all are flat, the file has their radii, or they are many.
/// Precondition: a record of each kind for each point.
pub(super) fn curved_surface(
    frame: &Frame,
    points: &[PointRecord],
    shapes: &[ShapeRecord],
    is_outlier: &[bool],
) -> Option<PhotoSurface> {
    if points.len() > MAX_CURVED || frame.radii().is_some() {
        return None;
    }
    let disks = points.iter().zip(shapes).map(|(point, shape)| Disk {
        position: point.position.into(),
        normal: oct_decode(shape.normal),
        radius: shape.radius,
    });
    // Held-out views of 3,517 points, 48,427 disks: 28.5, 36.3, 35.1, 32.9 → 37.3, 39.3, 40.1, 40.7 dB. Points moved
    // inwards instead: 29.1, 32.0, 32.0, 30.6 (pale outlines); disks of 0.85 of their radius: 27.7 to 30.6.
    let curved = curved_splats(&disks.collect::<Vec<_>>(), |at| !is_outlier[at])?;
    let point = |&(at, disk): &(usize, Disk)| PointRecord {
        position: disk.position.to_array(),
        ..points[at]
    };
    let shape = |&(at, disk): &(usize, Disk)| ShapeRecord {
        normal: oct_encode(disk.normal),
        radius: disk.radius,
        ..shapes[at]
    };
    Some(PhotoSurface {
        points: Arc::new(curved.iter().map(point).collect()),
        shapes: Arc::new(curved.iter().map(shape).collect()),
    })
}

/// Normals, as records have them, and radii of some points alone. Normals of the file stay.
fn surface_of(
    frame: &Frame,
    shapes: &[ShapeRecord],
    options: SurfaceOptions,
    cached: &[usize],
) -> Vec<([i16; 2], f32)> {
    let places: Vec<Vec3> = cached.iter().map(|&at| frame.positions()[at]).collect();
    if frame.normals().is_some() {
        let records: Vec<[i16; 2]> = cached.iter().map(|&at| shapes[at].normal).collect();
        let normals: Vec<Vec3> = records.iter().map(|&normal| oct_decode(normal)).collect();
        return records.into_iter().zip(splat_radii(&places, &normals)).collect();
    }
    let surface = estimate_surface_observed(&places, frame.sensor(), options, &Progress::default());
    let Surface { normals, radii, .. } = surface;
    normals.into_iter().map(oct_encode).zip(radii).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cloud::{Attributes, Positions, RawCloud};
    use crate::photos::PosedImages;
    use crate::sequence::{Needs, PrepareCounters, PreparedFrame, prepare};
    use glam::DVec3;
    use std::sync::Arc;

    fn prepared(places: Vec<[f32; 3]>, attributes: Attributes) -> PreparedFrame {
        let raw = RawCloud {
            attributes,
            ..RawCloud::from_positions(Positions::F32(places))
        };
        let frame = Frame::from_raw(raw, DVec3::ZERO).unwrap();
        let needs = Needs {
            shapes: true,
            ..Needs::default()
        };
        prepare(0, Arc::new(frame), 0.0, &needs, &PrepareCounters::default())
    }

    fn textured(frame: &PreparedFrame) -> PreparedFrame {
        frame.with_photos(Arc::new(PosedImages::new(Vec::new(), None)))
    }

    /// A wall of 400 points that are 1 apart.
    fn wall() -> Vec<[f32; 3]> {
        (0..400).map(|at| [(at % 20) as f32, (at / 20) as f32, 0.0]).collect()
    }

    fn is_in_the_air(frame: &PreparedFrame, at: usize) -> bool {
        frame.points[at].position[2] != 0.0
    }

    #[test]
    fn outliers_are_dots_and_do_not_tilt_disks() {
        let mut places = wall();
        places.push([8.5, 8.5, 1.6]);
        let frame = prepared(places, Attributes::default());
        let textured = textured(&frame);
        let shapes = textured.shapes.as_ref().unwrap();
        for (at, shape) in shapes.iter().enumerate() {
            if is_in_the_air(&frame, at) {
                assert!(shape.radius < 0.01 && shape.radius > 0.0, "{}", shape.radius);
            } else {
                assert!(oct_decode(shape.normal).z.abs() > 0.999, "{at}");
                assert!(shape.radius < 2.0, "{}", shape.radius);
            }
        }
        assert!(Arc::ptr_eq(&frame.points, &textured.points));
    }

    /// A tube of 20 points around, 0.3 apart, and its normals.
    fn tube() -> (Vec<[f32; 3]>, Vec<[f32; 3]>) {
        let at = |at: usize| {
            let (sin, cos) = (std::f32::consts::TAU * (at % 20) as f32 / 20.0).sin_cos();
            ([cos, sin, 0.3 * (at / 20) as f32], [cos, sin, 0.0])
        };
        (0..600).map(at).unzip()
    }

    #[test]
    fn disks_of_a_round_object_are_curved_and_its_points_unchanged() {
        let (places, normals) = tube();
        let with_normals = Attributes {
            normals: Some(normals),
            colors: Some((0..600).map(|at| [at as u8, 1, 2, 255]).collect()),
            ..Attributes::default()
        };
        let frame = prepared(places.clone(), with_normals.clone());
        assert!(frame.curved.is_none());
        let with = textured(&frame);
        let curved = with.curved.as_ref().unwrap();
        assert!(curved.points.len() > 6 * with.points.len() && curved.points.len() == curved.shapes.len());
        assert!(with.byte_size() > frame.byte_size());
        assert!(Arc::ptr_eq(&frame.points, &with.points));
        let radius = |at: usize| curved.shapes[at].radius;
        assert!((0..curved.shapes.len()).all(|at| radius(at) < frame.shapes.as_ref().unwrap()[0].radius));
        for point in curved.points.iter() {
            let [x, y, _] = point.position;
            assert!((x.hypot(y) - 1.0).abs() < 0.02, "{point:?}");
        }
        // Radii in a file were chosen deliberately.
        let with_radii = Attributes {
            radii: Some(vec![0.3; 600]),
            ..with_normals
        };
        assert!(textured(&prepared(places, with_radii)).curved.is_none());
    }

    #[test]
    fn images_are_projected_onto_their_own_surface_and_points_unchanged() {
        let frame = prepared(wall(), Attributes::default());
        let surface = PhotoSurface {
            points: Arc::new(frame.points[..3].to_vec()),
            shapes: Arc::new(frame.shapes.as_ref().unwrap()[..3].to_vec()),
        };
        let posed_images = PosedImages::new(Vec::new(), None).with_surface(Some(surface.clone()));
        let with = frame.with_photos(Arc::new(posed_images));
        assert!(Arc::ptr_eq(&with.curved.as_ref().unwrap().points, &surface.points));
        assert!(Arc::ptr_eq(&with.points, &frame.points));
        assert!(Arc::ptr_eq(
            with.shapes.as_ref().unwrap(),
            frame.shapes.as_ref().unwrap()
        ));
    }

    #[test]
    fn a_surface_without_outliers_reuses_its_allocation() {
        let frame = prepared(wall(), Attributes::default());
        let textured = textured(&frame);
        assert!(Arc::ptr_eq(
            frame.shapes.as_ref().unwrap(),
            textured.shapes.as_ref().unwrap()
        ));
    }

    #[test]
    fn normals_and_radii_of_a_file_are_unchanged() {
        let mut places = wall();
        places.push([8.5, 8.5, 6.0]);
        let normal = Vec3::new(0.6, 0.0, 0.8);
        let with_normals = Attributes {
            normals: Some(vec![normal.to_array(); places.len()]),
            ..Attributes::default()
        };
        let frame = textured(&prepared(places.clone(), with_normals.clone()));
        let shapes = frame.shapes.as_ref().unwrap();
        assert!(
            shapes
                .iter()
                .all(|shape| oct_decode(shape.normal).distance(normal) < 1e-3)
        );
        let dots = shapes.iter().filter(|shape| shape.radius < 0.01).count();
        assert_eq!(dots, 1);
        let with_radii = Attributes {
            radii: Some(vec![0.7; places.len()]),
            ..with_normals
        };
        let frame = textured(&prepared(places, with_radii));
        assert!(frame.shapes.as_ref().unwrap().iter().all(|shape| shape.radius == 0.7));
    }
}
