//! Cells, holes and attributes of frames made from raw clouds.

use super::*;

#[test]
fn holes_are_dropped_from_every_array() {
    let mut raw = RawCloud::from_positions(Positions::F32(vec![
        [1.0, 2.0, 3.0],
        [f32::NAN, 0.0, 0.0],
        [4.0, 5.0, f32::INFINITY],
        [7.0, 8.0, 9.0],
    ]));
    raw.attributes.colors = Some(vec![[1; 4], [2; 4], [3; 4], [4; 4]]);
    raw.attributes.normals = Some(vec![[0.0, 0.0, 2.0], [1.0; 3], [1.0; 3], [f32::NAN; 3]]);
    raw.attributes.radii = Some(vec![0.5, 1.0, 1.0, f32::NAN]);
    let frame = Frame::from_raw(raw, DVec3::ZERO).unwrap();
    assert_eq!(frame.positions(), [Vec3::new(1.0, 2.0, 3.0), Vec3::new(7.0, 8.0, 9.0)]);
    assert_eq!(frame.colors(), Some([[1; 4], [4; 4]].as_slice()));
    assert_eq!(frame.normals(), Some([Vec3::Z, Vec3::ZERO].as_slice()));
    assert_eq!(frame.radii(), Some([0.5, 0.0].as_slice()));
    assert_eq!(frame.file_index(), [0, 3]);
    assert_eq!(frame.dropped_points(), 2);
    assert_eq!((frame.all_normals(), frame.all_radii()), (None, None));
}

#[test]
fn normals_and_radii_are_all_there_unless_a_single_point_lacks_one() {
    let frame = |lacking: Option<usize>| {
        let place = |index: usize| [index as f32, 0.0, 0.0];
        let mut raw = RawCloud::from_positions(Positions::F32((0..200).map(place).collect()));
        let given = |index: usize| f32::from(u8::from(lacking != Some(index)));
        raw.attributes.normals = Some((0..200).map(|index| [0.0, given(index), 0.0]).collect());
        raw.attributes.radii = Some((0..200).map(given).collect());
        Frame::from_raw(raw, DVec3::ZERO).unwrap()
    };
    let whole = frame(None);
    assert_eq!(
        (whole.all_normals(), whole.all_radii()),
        (whole.normals(), whole.radii())
    );
    for lacking in [0, 63, 64, 199] {
        let frame = frame(Some(lacking));
        assert_eq!((frame.all_normals(), frame.all_radii()), (None, None), "{lacking}");
    }
}

#[test]
fn points_are_in_morton_order_and_know_their_file_index() {
    let corner = |octant: u32| [0, 1, 2].map(|axis| (octant >> axis & 1) as f32);
    // All corners in reverse, then a duplicate of the first octant, and a hole in between.
    let mut positions: Vec<[f32; 3]> = (0..8).rev().map(corner).collect();
    positions.insert(3, [f32::NAN; 3]);
    positions.push(corner(0));
    let mut raw = RawCloud::from_positions(Positions::F32(positions.clone()));
    let values = (0..10).map(|index| index as f32).collect();
    raw.attributes.scalars = vec![ScalarField::new("scalar", values)];
    let frame = Frame::from_raw(raw, DVec3::ZERO).unwrap();
    assert_eq!(frame.file_index(), [8, 9, 7, 6, 5, 4, 2, 1, 0]);
    for ((&index, position), &scalar) in frame
        .file_index()
        .iter()
        .zip(frame.positions())
        .zip(frame.scalars().unwrap())
    {
        assert_eq!(position.to_array(), positions[index as usize]);
        assert_eq!(scalar, index as f32);
    }
}

/// An image in which a place tells its column and row, one pixel without a point.
fn image(width: u32, height: u32) -> RawCloud {
    let place = |index: u32| [(index % width) as f32, (index / width) as f32, 1.0];
    let mut places: Vec<[f32; 3]> = (0..width * height).map(place).collect();
    places[7] = [f32::NAN; 3];
    RawCloud {
        grid: ImageGrid::of(width, height, places.len()),
        ..RawCloud::from_positions(Positions::F32(places))
    }
}

#[test]
fn points_of_an_organised_cloud_know_their_grid_cells() {
    let whole = Frame::from_raw(image(16, 9), DVec3::ZERO).unwrap();
    let (of_memory, _) = whole.sample(40).unwrap();
    let part = whole.part_without_splats(&[70, 3, 11]).unwrap();
    let of_file = Frame::from_raw_sample(image(16, 9), DVec3::ZERO, 30).unwrap();
    for (frame, count) in [(whole, 144), (of_memory, 40), (part, 3), (of_file, 30)] {
        let grid = frame.grid().unwrap();
        assert_eq!(frame.len() + frame.dropped_points(), count);
        for (&index, at) in frame.file_index().iter().zip(frame.positions()) {
            let [column, row] = grid.cell(index);
            assert_eq!(*at, Vec3::new(column as f32, row as f32, 1.0));
        }
    }
    let mut few = image(16, 9);
    few.keep(&[0, 1, 2]);
    assert_eq!(few.grid, None, "indices are no cells any more");
}

#[test]
fn millimetres_are_preserved_at_ten_thousand_kilometres() {
    let raw = RawCloud::from_positions(Positions::F64(vec![[1e7 + 0.001, -1e7, 3e6 + 0.002]]));
    let frame = Frame::from_raw(raw, DVec3::new(1e7, -1e7, 3e6)).unwrap();
    assert!((frame.positions()[0] - Vec3::new(0.001, 0.0, 0.002)).length() < 1e-8);
}

#[test]
fn an_attribute_array_that_is_too_short_is_rejected() {
    let mut raw = RawCloud::from_positions(Positions::F32(vec![[0.0; 3]; 2]));
    raw.attributes.scalars = vec![ScalarField::new("scalar", vec![1.0])];
    assert_eq!(
        Frame::from_raw(raw, DVec3::ZERO),
        Err(CloudError::LengthMismatch {
            attribute: "scalar".to_owned(),
            expected: 2,
            found: 1
        })
    );
}
