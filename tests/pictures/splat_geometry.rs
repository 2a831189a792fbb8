//! The geometry of a splat does not show: images of all geometries equal those of quads, and splats are the disks that
//! rays meet.

use crate::common::{self, Surfel, camera_at, draw, draw_on_cpu, plain, sphere, surfels};
use glam::{DVec3, Vec3};
use image::RgbaImage;
use pointreel::cloud::{oct_decode, oct_encode};
use pointreel::scene::{
    BackFaces, Camera, Lighting, Primitive, ScenePacket, SplatFilter, SplatGeometry, Splatting, Style,
};

const EDGE_PX: u32 = 150;
const RED: [u8; 3] = [255, 0, 0];
const GREEN: [u8; 3] = [0, 255, 0];
const BLACK: [u8; 3] = [0; 3];

/// From above at an angle, so near that splats are cut by the near plane and the sides.
fn close_camera() -> Camera {
    Camera {
        azimuth_deg: 25.0,
        elevation_deg: -35.0,
        ..camera_at(1.2)
    }
}

/// Every mode of disks and ellipses, plain and filtered.
fn styles(lighting: Lighting) -> impl Iterator<Item = Style> {
    let kinds = [Primitive::Surfel, Primitive::Ellipse]
        .into_iter()
        .flat_map(|primitive| SplatFilter::ALL.iter().map(move |&filter| (primitive, filter)));
    kinds.flat_map(move |(primitive, filter)| {
        Splatting::ALL.iter().map(move |&splatting| {
            plain().with(|style| {
                style.primitive = primitive;
                style.surfels.filter = filter;
                style.surfels.splatting = splatting;
                style.surfels.back_faces = BackFaces::Drawn;
                style.light.lighting = lighting;
            })
        })
    })
}

fn with_geometry(packet: &ScenePacket, geometry: SplatGeometry) -> ScenePacket {
    let mut packet = packet.clone();
    packet.style.surfels.geometry = geometry;
    packet
}

/// Pixels with a channel that differs by more than `steps`.
fn differing(a: &RgbaImage, b: &RgbaImage, steps: u8) -> usize {
    let differs =
        |(a, b): &(&image::Rgba<u8>, &image::Rgba<u8>)| a.0.iter().zip(b.0).any(|(a, b)| a.abs_diff(b) > steps);
    a.pixels().zip(b.pixels()).filter(differs).count()
}

/// Corners are rounded to a 256th of a pixel, others by another geometry. So a pixel whose centre is that near to an
/// edge may be on either side of it, which shows where splats are opaque up to their edges.
fn assert_picture_of_quads(packet: &ScenePacket, steps: u8) {
    let quads = draw(&with_geometry(packet, SplatGeometry::Quad));
    for &geometry in SplatGeometry::ALL {
        let picture = draw(&with_geometry(packet, geometry));
        let count = differing(&quads, &picture, steps);
        let Style {
            primitive,
            surfels,
            light,
            ..
        } = packet.style;
        assert!(
            count <= 3,
            "{primitive} {geometry} {} {} {}: {count} pixels differ by more than {steps}",
            surfels.filter,
            surfels.splatting,
            light.lighting
        );
    }
}

#[test]
fn images_of_all_geometries_match_those_of_quads() {
    let cloud = sphere(1500, 1.0);
    for lighting in [Lighting::PerSurfel, Lighting::PerFragment, Lighting::Lambert] {
        for style in styles(lighting) {
            for camera in [camera_at(3.0), close_camera()] {
                assert_picture_of_quads(&surfels(&cloud, &camera, style, [EDGE_PX; 2]), 2);
            }
        }
    }
}

/// Light per vertex is computed farther from the splat's centre, the larger its geometry is.
#[test]
fn per_vertex_light_differs_little_where_splats_are_small() {
    let cloud = sphere(1500, 1.0);
    for style in styles(Lighting::PerVertex) {
        assert_picture_of_quads(&surfels(&cloud, &camera_at(3.0), style, [EDGE_PX; 2]), 4);
    }
}

/// Its squares are the image.
#[test]
fn regular_splatting_is_drawn_as_quads_whatever_is_chosen() {
    let style = plain().with(|style| style.surfels.splatting = Splatting::Regular);
    let packet = surfels(&sphere(1500, 1.0), &close_camera(), style, [EDGE_PX; 2]);
    let quads = draw(&packet);
    for &geometry in SplatGeometry::ALL {
        assert_eq!(
            common::difference(&quads, &draw(&with_geometry(&packet, geometry))),
            (0, 0),
            "{geometry}"
        );
    }
}

#[test]
fn the_software_renderer_draws_the_same_bytes_whatever_is_chosen() {
    let cloud = sphere(1500, 1.0);
    for style in styles(Lighting::PerVertex) {
        let packet = surfels(&cloud, &close_camera(), style, [EDGE_PX; 2]);
        let usual = draw_on_cpu(&packet);
        for &geometry in SplatGeometry::ALL {
            let picture = draw_on_cpu(&with_geometry(&packet, geometry));
            assert_eq!(
                common::difference(&usual, &picture),
                (0, 0),
                "{geometry}, {}",
                style.surfels.splatting
            );
        }
    }
}

/// Distance along its ray at which a position of the image meets a disk beyond the near plane, seen by [`camera_at`].
fn meets(disk: &Surfel, camera_distance: f64, place_px: [f64; 2]) -> Option<f64> {
    let half = f64::from(EDGE_PX) / 2.0;
    let ray = DVec3::new(place_px[0] / half - 1.0, 1.0 - place_px[1] / half, -1.0);
    let normal = oct_decode(oct_encode(disk.normal)).as_dvec3();
    let center = disk.position.as_dvec3() - DVec3::Z * camera_distance;
    let t = center.dot(normal) / ray.dot(normal);
    // The renderer's near plane is at 0.005 of the distance to the target.
    (t > 0.005 * camera_distance && (ray * t - center).length() <= f64::from(disk.radius)).then_some(t)
}

/// The colour of the nearest disk that a position of the image meets.
fn nearest(disks: &[Surfel], camera_distance: f64, place_px: [f64; 2]) -> [u8; 3] {
    let met = disks
        .iter()
        .filter_map(|disk| Some((meets(disk, camera_distance, place_px)?, disk.color)));
    met.min_by(|(a, _), (b, _)| a.total_cmp(b))
        .map_or(BLACK, |(_, color)| color)
}

/// The colour of a pixel, if it is the same a 64th of a pixel around its centre: beyond that, corners are not rounded.
fn certain_color(disks: &[Surfel], camera_distance: f64, [x, y]: [u32; 2]) -> Option<[u8; 3]> {
    let midpoint = [f64::from(x) + 0.5, f64::from(y) + 0.5];
    let colors = [[0.0; 2], [1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]].map(|[right, down]: [f64; 2]| {
        nearest(
            disks,
            camera_distance,
            [midpoint[0] + right / 64.0, midpoint[1] + down / 64.0],
        )
    });
    colors.iter().all(|color| *color == colors[0]).then_some(colors[0])
}

/// Draws hard disks as every geometry and compares with rays.
fn assert_met_by_rays(disks: &[Surfel], camera_distance: f64, what: &str) {
    for &geometry in SplatGeometry::ALL {
        let style = plain().with(|style| {
            style.surfels.splatting = Splatting::Opaque;
            style.surfels.geometry = geometry;
            style.surfels.back_faces = BackFaces::Drawn;
        });
        let picture = draw(&surfels(disks, &camera_at(camera_distance), style, [EDGE_PX; 2]));
        let mut seen = 0;
        let mut uncertain = 0;
        for (x, y, pixel) in picture.enumerate_pixels() {
            match certain_color(disks, camera_distance, [x, y]) {
                Some(color) => {
                    assert_eq!(pixel.0[..3], color, "{what} as {geometry} at {x}, {y}");
                    seen += usize::from(color != BLACK);
                }
                None => uncertain += 1,
            }
        }
        assert!(
            seen > 20 && uncertain < 30,
            "{what}: {seen} pixels are seen, {uncertain} uncertain"
        );
    }
}

fn disk(position: Vec3, normal: Vec3, radius: f32, color: [u8; 3]) -> Surfel {
    Surfel {
        position,
        normal: normal.normalize(),
        radius,
        color,
    }
}

#[test]
fn oblique_and_grazing_splats_match_ray_traced_disks() {
    for angle_deg in [0.0f32, 40.0, 75.0, 86.0, 89.0] {
        let (sin, cos) = angle_deg.to_radians().sin_cos();
        for across in [Vec3::new(sin, 0.0, cos), Vec3::new(0.3 * sin, 0.95 * sin, cos)] {
            let splat = disk(Vec3::new(0.21, -0.17, 0.0), across, 0.9, RED);
            assert_met_by_rays(&[splat], 1.5, &format!("at {angle_deg} degrees"));
        }
    }
}

#[test]
fn splats_reaching_behind_the_eye_match_ray_traced_disks() {
    for (what, splat) in [
        (
            "the ground below the eye",
            disk(Vec3::new(0.0, -0.2, 1.0), Vec3::Y, 1.5, RED),
        ),
        ("a wide ground", disk(Vec3::new(0.0, -0.01, 1.0), Vec3::Y, 50.0, RED)),
        (
            "a wall beside the eye",
            disk(Vec3::new(0.4, 0.1, 0.9), Vec3::new(-0.9, 0.2, 0.3), 0.7, RED),
        ),
        (
            "across the near plane",
            disk(Vec3::new(0.0, 0.0, 0.993), Vec3::new(0.0, 0.5, 0.8), 0.01, RED),
        ),
        (
            "a ceiling whose middle is behind the eye",
            disk(Vec3::new(0.1, 0.3, 1.4), Vec3::Y, 1.2, RED),
        ),
    ] {
        assert_met_by_rays(&[splat], 1.0, what);
    }
}

#[test]
fn intersecting_splats_hide_each_other_like_ray_traced_disks() {
    let green = disk(Vec3::new(0.1, 0.0, 0.0), Vec3::new(0.7, 0.1, 0.7), 0.8, GREEN);
    for (what, red) in [
        ("crossed", disk(Vec3::ZERO, Vec3::new(-0.6, 0.2, 0.7), 0.8, RED)),
        ("almost edge-on", disk(Vec3::ZERO, Vec3::new(0.05, 1.0, 0.05), 0.9, RED)),
        (
            "from behind the eye",
            disk(Vec3::new(0.0, -0.1, 1.0), Vec3::Y, 2.0, RED),
        ),
    ] {
        assert_met_by_rays(&[red, green], 1.0, what);
        assert_met_by_rays(&[green, red], 1.0, what);
    }
}
