//! Triangles of polygons and strips, and points spread evenly over the faces of a mesh.
//!
//! The faces are put in the order of a curve that fills space (Morton's), so that neighbours on the surface are mostly
//! neighbours in the order, and their areas are added up along it. Sample `i` of `n` lies at `(i + 1/2) / n` of the
//! whole area: every face, and every patch of neighbouring faces, gets the number of points due to its area, give or
//! take one. Within a face the place is the `i`th of the triangular van der Corput sequence (Basu and Owen, 2015),
//! which cuts a triangle into four again and again and visits the parts in turn: consecutive samples keep their
//! distance, whether a face has one of them or all.
//!
//! Only additions, multiplications, divisions and square roots are used, which every machine rounds alike, and nothing
//! is random: the same mesh gives the same bits everywhere. The positions on the surface are found separately from the
//! points there ([`Places::apply`]), so that an animated mesh is sampled once and point `i` is the same position on the
//! surface in every frame.

use crate::cloud::{Attributes, Positions, RawCloud};
use crate::io::error::Fault;
use crate::io::options::ReadOptions;
use glam::DVec3;
use std::num::NonZeroUsize;

/// Adds the triangles of a polygon around its first corner; points and lines have none.
pub(in crate::io) fn fan(polygon: &[u32], triangles: &mut Vec<[u32; 3]>) {
    if let Some((&first, others)) = polygon.split_first() {
        let sides = others.windows(2);
        triangles.extend(sides.map(|side| [first, side[0], side[1]]));
    }
}

/// Adds the triangles of a strip: every second one is turned, so that all show the same side. Those without an area
/// only lead from one part of a strip to the next.
pub(in crate::io) fn strip(corners: &[u32], triangles: &mut Vec<[u32; 3]>) {
    let turned = |(index, corner): (usize, &[u32])| match index % 2 {
        0 => [corner[0], corner[1], corner[2]],
        _ => [corner[1], corner[0], corner[2]],
    };
    let all = corners.windows(3).enumerate().map(turned);
    triangles.extend(all.filter(|[a, b, c]| a != b && b != c && c != a));
}

/// A place on a mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::io) struct MeshSample {
    /// Index of the face.
    pub(in crate::io) face: u32,
    /// Weight of each of the face's corners; they add up to one.
    pub(in crate::io) weights: [f32; 3],
}

/// Places spread evenly over a mesh.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::io) struct Places(pub(in crate::io) Vec<MeshSample>);

/// Replaces the vertices of `cloud` by `count` points spread evenly over its faces. A mesh whose faces have no area
/// keeps its vertices.
pub(in crate::io) fn sample(cloud: &mut RawCloud, count: NonZeroUsize, options: &ReadOptions) -> Result<(), Fault> {
    if let Some(places) = Places::spread(&cloud.positions, &cloud.faces, count, options)? {
        check_memory(cloud, count, options)?;
        *cloud = places.apply(cloud);
    }
    cloud.faces = Vec::new();
    cloud.texturing = None;
    Ok(())
}

/// Fails where `count` points with the attributes of `cloud` are more than the options allow.
pub(in crate::io) fn check_memory(cloud: &RawCloud, count: NonZeroUsize, options: &ReadOptions) -> Result<(), Fault> {
    let mut point_bytes = cloud.positions.point_bytes() + cloud.attributes.point_bytes();
    if cloud.attributes.normals.is_none() {
        // Normals are computed even if the mesh had none.
        point_bytes += size_of::<[f32; 3]>();
    }
    check_bytes(count, point_bytes + size_of::<MeshSample>(), options)
}

fn check_bytes(count: NonZeroUsize, point_bytes: usize, options: &ReadOptions) -> Result<(), Fault> {
    let needed = (count.get() as u64).saturating_mul(point_bytes as u64);
    options.claim(&format!("a mesh sampled with {count} points"), needed)
}

impl Places {
    /// `count` places on `faces`; `None` where these have no area. Faces with a corner that is not finite have none.
    pub(in crate::io) fn spread(
        positions: &Positions,
        faces: &[[u32; 3]],
        count: NonZeroUsize,
        options: &ReadOptions,
    ) -> Result<Option<Self>, Fault> {
        check_bytes(count, size_of::<MeshSample>(), options)?;
        let ordered = along_curve(positions, faces);
        let total: f64 = ordered.iter().map(|&(_, area)| area).sum();
        if !(total > 0.0 && total.is_finite()) {
            return Ok(None);
        }
        let mut places = Vec::with_capacity(count.get());
        let mut faces = ordered.into_iter().peekable();
        let mut end = 0.0;
        let mut face = 0;
        for index in 0..count.get() {
            let target = total * ((index as f64 + 0.5) / count.get() as f64);
            while end <= target
                && let Some((next, area)) = faces.next()
            {
                face = next;
                end += area;
            }
            places.push(MeshSample {
                face,
                weights: weights(index),
            });
        }
        Ok(Some(Self(places)))
    }

    /// The points of `mesh` at these places. Precondition: the mesh has the faces that the places were found on.
    pub(in crate::io) fn apply(&self, mesh: &RawCloud) -> RawCloud {
        let corners = |place: &MeshSample| mesh.faces[place.face as usize].map(|corner| corner as usize);
        let position = |place: &MeshSample| {
            let [a, b, c] = corners(place).map(|corner| mesh.positions.get(corner));
            let [_, second, third] = place.weights.map(f64::from);
            // Relative to the first corner: large coordinates retain the digits that small faces need.
            a + (b - a) * second + (c - a) * third
        };
        let positions = match mesh.positions {
            Positions::F32(_) => Positions::F32(self.map(|place| position(place).as_vec3().to_array())),
            Positions::F64(_) => Positions::F64(self.map(|place| position(place).to_array())),
        };
        let mut cloud = RawCloud::from_positions(positions);
        // With textures the colour is sampled at the position, not interpolated between the corners: textures are
        // finer.
        let picture_color = |place: &MeshSample| {
            let texturing = mesh.texturing.as_ref()?;
            let corners = corners(place);
            let texture = texturing.texture_of_vertex[corners[0]]?;
            let coordinate = |axis: usize| blend(corners.map(|corner| texturing.places[corner][axis]), place.weights);
            let color = texturing
                .textures
                .color(texture as usize, [coordinate(0), coordinate(1)]);
            let [red, green, blue] = color.map(|channel| (channel * 255.0).round() as u8);
            Some([red, green, blue, 255])
        };
        let colors = |colors: &[[u8; 4]]| {
            let channel = |place: &MeshSample, channel: usize| {
                let values = corners(place).map(|corner| f32::from(colors[corner][channel]));
                blend(values, place.weights).round() as u8
            };
            let between = |place: &MeshSample| [0, 1, 2, 3].map(|index| channel(place, index));
            self.map(|place| picture_color(place).unwrap_or_else(|| between(place)))
        };
        let blended =
            |values: &[f32]| self.map(|place| blend(corners(place).map(|corner| values[corner]), place.weights));
        let scalars = mesh.attributes.scalars.iter();
        cloud.attributes = Attributes {
            colors: mesh.attributes.colors.as_deref().map(colors),
            normals: Some(self.map(|place| normal(mesh, corners(place), place.weights))),
            radii: mesh.attributes.radii.as_deref().map(blended),
            // Directions cannot be interpolated.
            ellipses: None,
            scalars: scalars.map(|field| field.with_values(blended(&field.values))).collect(),
        };
        cloud.skipped_faces = mesh.faces.len();
        cloud.sensor = mesh.sensor;
        cloud.warnings.clone_from(&mesh.warnings);
        cloud
    }

    fn map<T>(&self, each: impl Fn(&MeshSample) -> T) -> Vec<T> {
        self.0.iter().map(each).collect()
    }
}

/// The faces with an area, and their areas, in the order of the curve.
fn along_curve(positions: &Positions, faces: &[[u32; 3]]) -> Vec<(u32, f64)> {
    let (_, bounds) = positions.finite_bounds();
    let Some((min, max)) = bounds else {
        return Vec::new();
    };
    let extent = (max - min).max_element().max(f64::MIN_POSITIVE);
    let mut ordered: Vec<(u64, u32, f64)> = faces
        .iter()
        .zip(0u32..)
        .filter_map(|(face, index)| {
            let [a, b, c] = face.map(|corner| positions.get(corner as usize));
            let area = (b - a).cross(c - a).length() / 2.0;
            let centre = ((a - min) + (b - min) + (c - min)) / (3.0 * extent);
            (area > 0.0 && area.is_finite()).then(|| (morton(centre), index, area))
        })
        .collect();
    // The index decides between faces of one cell, so the order is the same in every run.
    ordered.sort_unstable_by_key(|&(cell, index, _)| (cell, index));
    ordered.into_iter().map(|(_, index, area)| (index, area)).collect()
}

/// Returns the Morton code of a point of the unit cube, with 2^21 cells per side.
fn morton(point: DVec3) -> u64 {
    const CELLS: f64 = (1u64 << 21) as f64;
    let spread = |coordinate: f64| {
        let mut bits = (coordinate * CELLS).clamp(0.0, CELLS - 1.0) as u64;
        bits = (bits | bits << 32) & 0x001f_0000_0000_ffff;
        bits = (bits | bits << 16) & 0x001f_0000_ff00_00ff;
        bits = (bits | bits << 8) & 0x100f_00f0_0f00_f00f;
        bits = (bits | bits << 4) & 0x10c3_0c30_c30c_30c3;
        (bits | bits << 2) & 0x1249_2492_4924_9249
    };
    spread(point.x) | spread(point.y) << 1 | spread(point.z) << 2
}

/// Returns the barycentric weights of the corners at index `index` of the triangular sequence: each digit to base four
/// chooses one of the four triangles that the lines between the midpoints of the sides cut the last one into, the
/// lowest digit first, and the position is the centre of the smallest.
fn weights(index: usize) -> [f32; 3] {
    const THIRD: f64 = 1.0 / 3.0;
    let mut weights = [THIRD; 3];
    // Size of the triangle; the central one inside another is rotated by half a turn.
    let mut size = 1.0;
    let mut digits = index;
    while digits > 0 {
        size /= 2.0;
        match digits % 4 {
            0 => size = -size,
            corner => {
                for (at, weight) in weights.iter_mut().enumerate() {
                    *weight += size * (f64::from(u8::from(at + 1 == corner)) - THIRD);
                }
            }
        }
        digits /= 4;
    }
    weights.map(|weight| weight as f32)
}

fn blend(values: [f32; 3], weights: [f32; 3]) -> f32 {
    values[0] * weights[0] + values[1] * weights[1] + values[2] * weights[2]
}

/// The normal within a face: interpolated between its corners, or its own where they have none or cancel out.
fn normal(mesh: &RawCloud, corners: [usize; 3], weights: [f32; 3]) -> [f32; 3] {
    let unit = |vector: DVec3| vector.try_normalize().map(|unit| unit.as_vec3().to_array());
    let between = mesh.attributes.normals.as_ref().and_then(|normals| {
        let axis = |axis: usize| blend(corners.map(|corner| normals[corner][axis]), weights);
        unit(DVec3::from([0, 1, 2].map(|index| f64::from(axis(index)))))
    });
    between
        .or_else(|| {
            let [a, b, c] = corners.map(|corner| mesh.positions.get(corner));
            unit((b - a).cross(c - a))
        })
        .unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cloud::ScalarField;

    fn quad(width: f32, height: f32) -> RawCloud {
        let corners = [
            [0.0, 0.0, 0.0],
            [width, 0.0, 0.0],
            [width, height, 0.0],
            [0.0, height, 0.0],
        ];
        let mut mesh = RawCloud::from_positions(Positions::F32(corners.to_vec()));
        mesh.faces = vec![[0, 1, 2], [0, 2, 3]];
        mesh
    }

    fn sampled(mesh: &RawCloud, count: usize) -> RawCloud {
        let mut cloud = mesh.clone();
        let count = NonZeroUsize::new(count).unwrap();
        sample(&mut cloud, count, &ReadOptions::default()).unwrap();
        cloud
    }

    fn points(cloud: &RawCloud) -> Vec<DVec3> {
        (0..cloud.positions.len())
            .map(|index| cloud.positions.get(index))
            .collect()
    }

    #[test]
    fn sampled_points_are_evenly_spaced() {
        const COUNT: usize = 4096;
        const CELLS: usize = 8;
        let cloud = sampled(&quad(1.0, 1.0), COUNT);
        let points = points(&cloud);
        assert_eq!(points.len(), COUNT);
        let mut cells = [0; CELLS * CELLS];
        for point in &points {
            cells[(point.y * CELLS as f64) as usize * CELLS + (point.x * CELLS as f64) as usize] += 1;
        }
        let expected = COUNT / (CELLS * CELLS);
        for count in cells {
            // Random points would differ by the square root of their number, 8, in two thirds of the cells, and by 24
            // in some.
            assert!(count > expected - 16 && count < expected + 16, "{count} of {expected}");
        }
        let nearest = |point: &DVec3| {
            let others = points.iter().filter(|other| *other != point);
            others.map(|other| other.distance(*point)).fold(f64::INFINITY, f64::min)
        };
        let spacing = (1.0 / COUNT as f64).sqrt();
        let mean = points.iter().map(nearest).sum::<f64>() / COUNT as f64;
        // For random points the mean is half of the spacing.
        assert!(mean > 0.6 * spacing, "{mean} of {spacing}");
    }

    #[test]
    fn faces_are_sampled_in_proportion_to_their_area() {
        let mut mesh = quad(3.0, 1.0);
        let Positions::F32(positions) = &mut mesh.positions else {
            panic!()
        };
        positions.extend([[10.0, 0.0, 0.0], [10.0, 3.0, 0.0], [10.0, 0.0, 4.0], [f32::NAN; 3]]);
        // Six units of area after three, a line, a point and a face with an invalid index.
        mesh.faces.extend([[4, 5, 6], [0, 1, 1], [2, 2, 2], [0, 1, 7]]);
        let cloud = sampled(&mesh, 900);
        let far = points(&cloud).into_iter().filter(|point| point.x > 9.0).count();
        assert_eq!((cloud.positions.len(), far), (900, 600));
        assert!(points(&cloud).iter().all(|point| point.is_finite()));
        let normals = cloud.attributes.normals.unwrap();
        for (point, normal) in points(&sampled(&mesh, 900)).iter().zip(normals) {
            let expected = if point.x > 9.0 {
                [1.0, 0.0, 0.0]
            } else {
                [0.0, 0.0, 1.0]
            };
            assert_eq!(normal, expected);
        }
        assert_eq!(cloud.faces, Vec::<[u32; 3]>::new());
    }

    #[test]
    fn attributes_are_interpolated_between_corners() {
        let mut mesh = quad(1.0, 1.0);
        mesh.attributes.colors = Some(vec![
            [0, 0, 7, 255],
            [255, 0, 7, 255],
            [255, 255, 7, 255],
            [0, 255, 7, 255],
        ]);
        mesh.attributes.scalars = vec![ScalarField {
            name: "t".to_owned(),
            values: vec![0.0, 1.0, 1.0, 0.0],
            offset: 5.0,
        }];
        mesh.attributes.normals = Some(vec![[0.0, 0.0, -2.0]; 4]);
        let cloud = sampled(&mesh, 500);
        for (index, point) in points(&cloud).into_iter().enumerate() {
            let [red, green, blue, alpha] = cloud.attributes.colors.as_ref().unwrap()[index];
            assert!((f64::from(red) - point.x * 255.0).abs() < 0.51);
            assert!((f64::from(green) - point.y * 255.0).abs() < 0.51);
            assert_eq!((blue, alpha), (7, 255));
            assert!((f64::from(cloud.attributes.scalars[0].values[index]) - point.x).abs() < 1e-6);
            assert_eq!(cloud.attributes.normals.as_ref().unwrap()[index], [0.0, 0.0, -1.0]);
        }
        assert_eq!(cloud.attributes.scalars[0].offset, 5.0);
    }

    #[test]
    fn sampling_is_bit_identical_on_every_machine() {
        let cloud = sampled(&quad(3.0, 1.0), 1000);
        let Positions::F32(positions) = &cloud.positions else {
            panic!()
        };
        let bits = positions.iter().flatten().fold(0u64, |hash, value| {
            hash.rotate_left(5)
                .wrapping_add(u64::from(value.to_bits()))
                .wrapping_mul(0x9e37_79b9_7f4a_7c15)
        });
        assert_eq!(bits, 124_712_037_475_622_585, "{:?}", &positions[..2]);
    }

    #[test]
    fn too_many_points_and_zero_area_are_handled() {
        let mut cloud = quad(1.0, 1.0);
        let options = ReadOptions::default().with_max_memory(1 << 20);
        let many = NonZeroUsize::new(usize::MAX).unwrap();
        let fault = sample(&mut cloud, many, &options).unwrap_err();
        assert!(fault.problem.contains("--max-memory"), "{}", fault.problem);
        let flat = sampled(&quad(1.0, 0.0), 10);
        assert_eq!((flat.positions.len(), flat.faces.len()), (4, 0));
    }
}
