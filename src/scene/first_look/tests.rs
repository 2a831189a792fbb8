//! Guarantees of the first view, for points anywhere.

use super::*;
use crate::cloud::{Ellipse, ImageGrid, Positions, RawCloud};
use crate::rgbd::Distortion;
use crate::scene::{BackFaces, Background, Lighting, PhotoRelight, Projection, Settings};
use crate::sequence::{ColorSource, Coloring, HeightAxis};
use glam::{DVec2, UVec2};
use proptest::prelude::*;

/// The largest distance of a point from the centre of an image, as a share of half its edge; `None` if one is behind
/// the eye.
fn farthest_out(camera: &Camera, points: &[Vec3], origin: DVec3, size_px: [u32; 2]) -> Option<f64> {
    let half = UVec2::from_array(size_px).as_dvec2() / 2.0;
    points.iter().try_fold(0f64, |largest, point| {
        let place = camera.to_px(origin + point.as_dvec3(), size_px)?;
        Some(largest.max(((place - half) / half).abs().max_element()))
    })
}

proptest! {
    /// Every point is within the image, and from a little closer one is not.
    #[test]
    fn points_just_fit_the_image(
        points in prop::collection::vec(prop::array::uniform3(-1f32..1.0), 2..50),
        stretch in prop::array::uniform3(0.01f32..3.0),
        far in -1e6f64..1e6,
        (azimuth_deg, elevation_deg) in (-180f64..180.0, -90f64..90.0),
        aspect in 0.3f64..3.0,
        is_orthographic: bool,
    ) {
        const FRAMED: f64 = 0.95;
        let origin = DVec3::new(far, 0.5 * far, -far);
        let points: Vec<Vec3> =
            points.into_iter().map(|point| Vec3::from_array(point) * Vec3::from_array(stretch)).collect();
        let bounds = Aabb::from_points(&points);
        let mut camera = Camera {
            azimuth_deg,
            elevation_deg,
            projection: if is_orthographic { Projection::Orthographic } else { Projection::Perspective },
            ..Camera::framing(&bounds, origin, UpAxis::Z)
        };
        camera.frame_points(&points, origin, aspect);
        let size_px = [(1000.0 * aspect) as u32, 1000];
        let out = farthest_out(&camera, &points, origin, size_px);
        // An image has whole pixels, so its aspect ratio differs by a thousandth.
        prop_assert!(out.is_some_and(|out| out <= FRAMED + 0.01), "{out:?}");
        // A cloud that extends along the view direction has no width that could fill the image.
        let view = camera.view_from_world_rotation();
        let center = bounds.center().as_dvec3();
        let is_wide = |point: &Vec3|
            (view * (point.as_dvec3() - center)).truncate().length() > f64::from(0.02 * bounds.radius());
        prop_assume!(points.iter().any(is_wide));
        camera.zoom(0.9);
        let out = farthest_out(&camera, &points, origin, size_px);
        prop_assert!(out.is_none_or(|out| out > FRAMED), "{out:?}");
    }
}

/// Through the telephoto lens of orthographic views a deep cloud is wider in front.
#[test]
fn a_deep_cloud_fits_an_orthographic_image() {
    let points =
        [[0.178_f32, -0.004, 0.711], [0.311, -0.004, -0.783]].map(|[x, y, z]| Vec3::new(2.67 * x, y, 1.575 * z));
    let mut camera = Camera {
        azimuth_deg: -79.0303,
        elevation_deg: 81.4539,
        projection: Projection::Orthographic,
        ..Camera::framing(&Aabb::from_points(&points), DVec3::ZERO, UpAxis::Z)
    };
    camera.frame_points(&points, DVec3::ZERO, 1.0);
    let out = farthest_out(&camera, &points, DVec3::ZERO, [1000, 1000]);
    assert!(out.is_some_and(|out| (0.9..=0.951).contains(&out)), "{out:?}");
}

#[test]
fn the_spacing_of_a_grid_is_that_of_its_lines() {
    let frame_of = |positions: Vec<[f32; 3]>| {
        Frame::from_raw(RawCloud::from_positions(Positions::F32(positions)), DVec3::ZERO).unwrap()
    };
    let place = |index: u32| [0.25 * (index % 64) as f32, 0.25 * (index / 64) as f32, 1.0];
    let spacing = typical_spacing(&frame_of((0..4096).map(place).collect())).typical;
    // Neighbours across the borders of Morton cells are missed: instead, diagonal ones are found.
    assert!((0.25..=0.25 * 2f32.sqrt()).contains(&spacing), "{spacing}");
    assert_eq!(typical_spacing(&frame_of(vec![[1.0; 3]])).typical, 0.0);
    assert_eq!(typical_spacing(&frame_of(Vec::new())).typical, 0.0);
}

#[test]
fn angles_and_directions_round_trip() {
    for &(_, up) in UpAxis::ALL {
        for toward in [DVec3::X, DVec3::new(1.0, -2.0, 0.5), DVec3::new(-0.3, 0.2, -0.9)] {
            let toward = toward.normalize();
            let (azimuth_deg, elevation_deg) = up.angles_of(toward);
            let camera = Camera {
                azimuth_deg,
                elevation_deg,
                ..Camera::framing(&Aabb::EMPTY, DVec3::ZERO, up)
            };
            let eye = camera.eye_in_world().normalize();
            assert!((eye - toward).length() < 1e-9, "{up:?} {toward}: {eye}");
        }
    }
}

#[test]
fn other_frames_are_examined_while_they_are_small() {
    assert_eq!(others(1, 100), [] as [usize; 0]);
    assert_eq!(others(2, 100), [1]);
    assert_eq!(others(101, 100_000), [25, 50, 75, 100]);
    assert_eq!(others(101, 500_000), [50, 100]);
    assert_eq!(others(101, 2_000_000), [] as [usize; 0]);
}

#[test]
fn all_poses_of_a_walk_are_in_the_initial_view() {
    let at = |x: f32| {
        let points = (0..5_000).map(|i| {
            let turn = i as f32 * 2.4;
            [x + 0.3 * turn.cos(), i as f32 / 2_500.0, 0.3 * turn.sin()]
        });
        let raw = RawCloud::from_positions(Positions::F32(points.collect()));
        Frame::from_raw(raw, DVec3::ZERO).unwrap()
    };
    let frames = [at(-4.0), at(0.0), at(6.0)];
    let look = FirstLook::of(&frames.iter().collect::<Vec<_>>(), DVec3::ZERO);
    assert!(look.trimmed.min.x < -4.2 && look.trimmed.max.x > 6.2);
    assert_eq!((look.up, look.kind), (UpAxis::Y, CaptureKind::Object));
}

#[test]
fn gaussian_splats_are_double_sided_ellipses_with_y_down() {
    // A bowl far from zero: nothing indicates its orientation.
    let points = (0..3_000).map(|i| {
        let [x, z] = [(i % 50) as f32 - 25.0, (i / 50) as f32 - 30.0];
        [100.0 + x, 100.0 + 0.003 * (x * x + z * z), z]
    });
    let mut raw = RawCloud::from_positions(Positions::F32(points.collect()));
    raw.attributes.normals = Some(
        (0..3_000)
            .map(|i| [0.0, if i % 2 == 0 { 1.0 } else { -1.0 }, 0.0])
            .collect(),
    );
    raw.attributes.radii = Some(vec![0.7; 3_000]);
    let look_of = |raw: &RawCloud| FirstLook::of(&[&Frame::from_raw(raw.clone(), DVec3::ZERO).unwrap()], DVec3::ZERO);
    let disks = look_of(&raw);
    assert_eq!(disks.primitive, Primitive::Surfel);
    assert!(disks.knows_outside && disks.up == UpAxis::Y);

    let ellipse = Ellipse {
        axis: Vec3::X,
        ratio: 0.5,
    };
    raw.attributes.ellipses = Some(vec![ellipse; 3_000]);
    raw.convention = Some(AxisConvention::UsuallyYDown);
    let splats = look_of(&raw);
    assert_eq!((splats.primitive, splats.up), (Primitive::Ellipse, UpAxis::NegY));
    assert!(splats.has_surface() && !splats.knows_outside);
    let style = Settings::default().resolved(&splats);
    assert_eq!(style.surfels.back_faces, BackFaces::Drawn);
    assert_eq!(
        style.light.eye_dome,
        Settings::default().resolved(&disks).light.eye_dome
    );
}

#[test]
fn dark_scans_have_a_brighter_background() {
    let look = |level: u8| {
        let points = (0..3_000).map(|i| [i as f32 % 50.0, i as f32 / 50.0, 0.0]);
        let mut raw = RawCloud::from_positions(Positions::F32(points.collect()));
        raw.attributes.colors = Some(vec![[level, level, level, 255]; 3_000]);
        FirstLook::of(&[&Frame::from_raw(raw, DVec3::ZERO).unwrap()], DVec3::ZERO)
    };
    let chosen = Background::solid([1, 2, 3]);
    let drawn = |background, level| {
        let style = Settings::default().with(|style| style.backdrop.background = background);
        style.resolved(&look(level)).backdrop.background
    };
    assert_eq!(drawn(Background::default(), 10), Background::BEHIND_DARK);
    assert_eq!(drawn(Background::default(), 180), Background::default());
    assert_eq!(drawn(chosen, 10), chosen);
}

#[test]
fn camera_colors_are_not_lit_again() {
    let look = |is_image: bool, color: &dyn Fn(u8) -> [u8; 4]| {
        let points = (0..3_000).map(|i| [(i % 50) as f32, (i / 50) as f32, 0.0]);
        let mut raw = RawCloud::from_positions(Positions::F32(points.collect()));
        raw.attributes.colors = Some((0..3_000).map(|i| color((i % 200) as u8)).collect());
        raw.grid = ImageGrid::of(50, 60, 3_000).filter(|_| is_image);
        FirstLook::of(&[&Frame::from_raw(raw, DVec3::ZERO).unwrap()], DVec3::ZERO)
    };
    let grey = |level: u8| [level, level, level, 255];
    let image = look(true, &grey);
    let lighting = |look: &FirstLook, change: &dyn Fn(&mut Settings)| {
        let style = Settings::default().with(|style| {
            style.primitive = Primitive::Surfel.into();
            change(style);
        });
        style.resolved(look).light.lighting
    };
    assert_eq!(lighting(&image, &|_| ()), Lighting::Unlit);
    assert_eq!(
        lighting(&image, &|style| style.primitive = Primitive::Voxel.into()),
        Lighting::PerFragment
    );
    let by_height = Coloring::of(ColorSource::Height(HeightAxis::Auto));
    assert_eq!(
        lighting(&image, &|style| style.colors = by_height),
        Lighting::PerFragment
    );
    assert_eq!(
        lighting(&image, &|style| style.light.lighting = Lighting::Lambert.into()),
        Lighting::Lambert
    );
    // A cloud that is not known to come from cameras, and colours without information.
    assert_eq!(lighting(&look(false, &grey), &|_| ()), Lighting::PerFragment);
    assert_eq!(lighting(&look(true, &|_| [255; 4]), &|_| ()), Lighting::PerFragment);
    // Relit images need light; unlit, they already contain it.
    let camera = rgbd::Camera::new([4, 2], DVec2::splat(2.0), DVec2::new(1.5, 0.5), Distortion::None);
    let photo = Photo {
        name: String::new(),
        path: String::new().into(),
        camera: camera.unwrap(),
        camera_from_world: DAffine3::IDENTITY,
        mask: None,
        depth: None,
        depth_range: None,
    };
    let set = ViewSet {
        photos: vec![photo],
        ..ViewSet::default()
    };
    let textured = look(false, &grey).with_photos(&set);
    for (relight, expected) in [
        (PhotoRelight::Off, Lighting::Unlit),
        (PhotoRelight::Photos, Lighting::PerFragment),
    ] {
        assert_eq!(lighting(&textured, &|style| style.photos.relight = relight), expected);
    }
}
