//! Triangles with known images, and compared with the formula of a sphere.

use super::*;
use crate::cloud::{MeshRecords, Textures, TriangleRecord, VertexRecord, oct_encode};
use crate::measure::flip;
use crate::scene::{Background, Camera, Lighting, PicturePlane, Projection, UpAxis};
use crate::sequence::Shape;
use glam::{DVec3, Vec3};
use image::{Rgba, RgbaImage};
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

/// Few pixels: a truth takes 64 samples of each.
const SIDE_PX: u32 = 40;

const GREY: Background = Background::solid([119; 3]);

/// A slope of 1 over 20 of 40×40 pixels.
fn seen_from(azimuth_deg: f64, distance: f64, lighting: Lighting) -> TruthView {
    let camera = Camera {
        target_in_world: DVec3::ZERO,
        distance,
        azimuth_deg,
        elevation_deg: 0.0,
        fov_deg: 90.0,
        up: UpAxis::Y,
        projection: Projection::Perspective,
        plane: PicturePlane::CENTERED,
    };
    TruthView::new(&camera, DVec3::ZERO, [SIDE_PX; 2], lighting, GREY)
}

fn vertex(position: [f32; 3], color: [u8; 3]) -> VertexRecord {
    let [red, green, blue] = color;
    VertexRecord {
        position,
        color: [red, green, blue, 255],
        texture_place: [0.0; 2],
        normal: VertexRecord::NO_NORMAL,
        texture: VertexRecord::NO_TEXTURE,
    }
}

fn mesh(vertices: Vec<VertexRecord>, triangles: &[[u32; 3]]) -> MeshRecords {
    let record = |&corners: &[u32; 3]| TriangleRecord {
        corners,
        normal: [0; 2],
    };
    MeshRecords::new(Arc::new(vertices), Arc::new(triangles.iter().map(record).collect()))
}

fn truth(records: &MeshRecords, view: &TruthView) -> Truth {
    Truth::of_mesh(&TracedMesh::new(Arc::new(records.clone())), view, 0.5)
}

/// A square of two triangles, in the plane `z = slope·x`, red from left to right and green from bottom to top.
fn square(slope: f32) -> MeshRecords {
    let corner = |x: f32, y: f32| {
        vertex(
            [x, y, slope * x],
            [if x > 0.0 { 200 } else { 0 }, if y > 0.0 { 200 } else { 0 }, 40],
        )
    };
    let corners = vec![
        corner(-1.0, -1.0),
        corner(1.0, -1.0),
        corner(1.0, 1.0),
        corner(-1.0, 1.0),
    ];
    mesh(corners, &[[0, 1, 2], [0, 2, 3]])
}

#[test]
fn a_square_has_its_area_colors_and_depths() {
    // At distance 2, a unit is 10 pixels: the square ends within no pixel.
    let truth = truth(&square(0.0), &seen_from(0.0, 2.0, Lighting::Unlit));
    let is_within = |pixel: u32| (10..30).contains(&pixel);
    for (x, y, pixel) in truth.image.enumerate_pixels() {
        let place = (y * SIDE_PX + x) as usize;
        if !is_within(x) || !is_within(y) {
            assert_eq!(pixel.0, [119, 119, 119, 255], "{x} {y}");
            assert!(truth.depth.depth[place].is_infinite() && truth.tolerance[place].is_infinite());
            continue;
        }
        // Colours are linear on the plane, so that the mean of a pixel is that at its centre.
        let share = |offset: f64| (200.0 * offset / 20.0 + 0.5) as u8;
        let expected = [share(f64::from(x) - 9.5), share(29.5 - f64::from(y)), 40, 255];
        let is_near = pixel
            .0
            .iter()
            .zip(expected)
            .all(|(&found, expected)| found.abs_diff(expected) <= 1);
        assert!(is_near, "{x} {y}: {:?}, not {expected:?}", pixel.0);
        assert_eq!((truth.depth.depth[place], truth.tolerance[place]), (2.0, 0.5));
    }
}

#[test]
fn a_slope_has_the_depths_of_its_plane_and_light_of_its_normal() {
    for azimuth_deg in [0.0, 180.0] {
        let truth = truth(&square(0.75), &seen_from(azimuth_deg, 3.0, Lighting::PerFragment));
        let mut seen = 0;
        for (place, &depth) in truth.depth.depth.iter().enumerate() {
            let slope = ((place % SIDE_PX as usize) as f64 + 0.5) / 20.0 - 1.0;
            // The depth is 3 - z, z = 0.75 x, and x = slope · depth; from behind, x points to the left and z away.
            let expected = 3.0 / (1.0 + 0.75 * slope);
            if depth.is_finite() {
                assert!((f64::from(depth) - expected).abs() < 1e-5, "{depth}, not {expected}");
                seen += 1;
            }
        }
        assert!(seen > 120, "{azimuth_deg}: {seen}");
        // A pixel to the right of and below the centre, where the normal is (-0.6, 0, 0.8), or its opposite.
        let slope = 0.025;
        let depth = 3.0 / (1.0 + 0.75 * slope);
        let facing = (0.6 * slope + 0.8) / (1.0f64 + 2.0 * slope * slope).sqrt();
        let lit = |channel: f64| channel * (0.25 + 0.75 * facing) + 255.0 * 0.15 * facing.powi(24);
        let found = truth.image.get_pixel(20, 20).0;
        let to_right = if azimuth_deg == 0.0 {
            slope * depth
        } else {
            -slope * depth
        };
        let channels = [100.0 * (1.0 + to_right), 100.0 * (1.0 - slope * depth), 40.0];
        for (found, channel) in found.into_iter().zip(channels) {
            assert!(
                (f64::from(found) - lit(channel)).abs() < 2.0,
                "{found} for {}",
                lit(channel)
            );
        }
    }
}

#[test]
fn normals_of_vertices_are_interpolated_and_those_of_faces_are_exact() {
    let view = seen_from(0.0, 2.0, Lighting::PerFragment);
    let flat = square(0.0);
    let tilted = |normal: Vec3| {
        let vertices = flat.vertices.iter().map(|&vertex| VertexRecord {
            normal: oct_encode(normal),
            ..vertex
        });
        MeshRecords::new(Arc::new(vertices.collect()), Arc::clone(&flat.triangles))
    };
    let blue = |records: &MeshRecords| truth(records, &view).image.get_pixel(20, 20).0[2];
    assert_eq!(blue(&flat), blue(&tilted(Vec3::Z)));
    // From either side, and edge on with the ambient light alone.
    assert_eq!(blue(&flat), blue(&tilted(Vec3::NEG_Z)));
    assert!(blue(&tilted(Vec3::X)).abs_diff(10) <= 1);
}

#[test]
fn a_texture_is_multiplied_with_vertex_colors_as_light_is() {
    let mut picture = RgbaImage::new(2, 2);
    picture.put_pixel(0, 0, Rgba([255, 0, 0, 255]));
    picture.put_pixel(1, 0, Rgba([0, 255, 0, 255]));
    picture.put_pixel(0, 1, Rgba([188, 188, 188, 255]));
    picture.put_pixel(1, 1, Rgba([255, 255, 255, 255]));
    let textures = Arc::new(Textures::of(vec![picture]));
    let square = square(0.0);
    let vertices = square.vertices.iter().map(|&vertex| VertexRecord {
        color: [188, 188, 188, 255],
        texture_place: [0.5 * vertex.position[0] + 0.5, 0.5 - 0.5 * vertex.position[1]],
        texture: 0,
        ..vertex
    });
    let records = MeshRecords::new(Arc::new(vertices.collect()), Arc::clone(&square.triangles))
        .with_textures(Arc::clone(&textures));
    let truth = truth(&records, &seen_from(0.0, 2.0, Lighting::Unlit));
    // 188 is half the light; samples are at the centres of 8×8 squares of each pixel.
    let half = |channel: f32| {
        let light = ((f64::from(channel) + 0.055) / 1.055).powf(2.4);
        255.0 * (1.055 * (0.5028 * light).powf(1.0 / 2.4) - 0.055).max(0.0)
    };
    for [x, y] in [[14, 14], [25, 14], [14, 25], [25, 25], [20, 15], [11, 20]] {
        let mut sums = [0.0; 3];
        for sample in 0..64 {
            let at = |pixel: u32, sample: u32| (pixel as f32 - 10.0 + (sample as f32 + 0.5) / 8.0) / 20.0;
            let texel = textures.color(0, [at(x, sample % 8), at(y, sample / 8)]);
            for (sum, channel) in sums.iter_mut().zip(texel) {
                *sum += half(channel) / 64.0;
            }
        }
        let found = truth.image.get_pixel(x, y).0;
        let is_near = found
            .iter()
            .zip(sums)
            .all(|(&found, expected)| (f64::from(found) - expected).abs() < 2.0);
        assert!(is_near, "{x} {y}: {found:?}, not {sums:?}");
    }
}

#[test]
fn vertices_without_a_triangle_are_not_seen() {
    let lone = mesh(vec![vertex([0.0; 3], [255; 3])], &[[0, 0, 0]]);
    let truth = truth(&lone, &seen_from(0.0, 2.0, Lighting::Unlit));
    assert!(truth.depth.depth.iter().all(|depth| depth.is_infinite()));
}

/// A unit sphere of `rows` rows of twice as many columns, with the colours and normals of the shape.
fn tessellated_sphere(rows: u32) -> MeshRecords {
    let columns = 2 * rows;
    let place = |row: u32, column: u32| {
        let (polar, azimuth) = (
            PI * f64::from(row) / f64::from(rows),
            TAU * f64::from(column) / f64::from(columns),
        );
        DVec3::new(polar.sin() * azimuth.cos(), polar.cos(), polar.sin() * azimuth.sin())
    };
    let record = |place: DVec3| VertexRecord {
        normal: oct_encode(place.as_vec3()),
        ..vertex(place.as_vec3().to_array(), Shape::color_at(place))
    };
    let places = (0..=rows).flat_map(|row| (0..columns).map(move |column| place(row, column)));
    let mut triangles = Vec::new();
    for row in 0..rows {
        for column in 0..columns {
            let next = (column + 1) % columns;
            let at = |row: u32, column: u32| row * columns + column;
            let quad = [at(row, column), at(row, next), at(row + 1, next), at(row + 1, column)];
            triangles.extend([[quad[0], quad[1], quad[2]], [quad[0], quad[2], quad[3]]]);
        }
    }
    mesh(places.map(record).collect(), &triangles)
}

#[test]
fn a_finely_tessellated_sphere_is_the_sphere() {
    let view = seen_from(33.0, 1.8, Lighting::PerFragment);
    let traced = RayTraced {
        shape: Shape::Sphere,
        cull_back_faces: true,
    };
    let exact = Truth::of_shape(traced, &view, 0.5);
    let [coarse, fine] = [12, 96].map(|rows| {
        let truth = truth(&tessellated_sphere(rows), &view);
        let both = truth.depth.depth.iter().zip(&exact.depth.depth);
        let off = both
            .filter(|(found, exact)| found.is_finite() && exact.is_finite())
            .map(|(a, b)| (a - b).abs());
        let outline = truth.depth.depth.iter().zip(&exact.depth.depth);
        let differing = outline
            .filter(|(found, exact)| found.is_finite() != exact.is_finite())
            .count();
        (
            off.fold(0.0, f32::max),
            differing,
            flip(&exact.image, &truth.image).unwrap().mean(),
        )
    });
    // Chords of an eighth are a sixty-fourth as far from an arc; near the outline depths differ by the root of that.
    assert!(fine.0 < 0.05 && fine.1 < 8 && fine.2 < 0.012, "{fine:?}");
    assert!(
        fine.2 < 0.5 * coarse.2 && fine.1 <= coarse.1,
        "{coarse:?}, then {fine:?}"
    );
}
