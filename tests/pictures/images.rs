//! Images with known answers: covered pixels are counted by casting a ray through every pixel's centre in f64.

use crate::common::{self, Surfel, camera_at, count_color, covered, draw, plain, sphere, surfels, voxels};
use glam::{DVec3, Vec3};
use image::RgbaImage;
use pointreel::cloud::VoxelRecord;
use pointreel::scene::{BackFaces, Background, Camera, Lighting, PointStyle, Primitive, Splatting, Style};

const BLACK: [u8; 3] = [0, 0, 0];
const RED: [u8; 3] = [255, 0, 0];
const GREEN: [u8; 3] = [0, 255, 0];
const SIZE: [u32; 2] = [200, 160];

/// Returns true if the ray through the centre of a pixel meets the disk beyond the near plane, for
/// `camera_at(distance)`.
fn ray_hits_disk(surfel: &Surfel, radius: f64, distance: f64, x: u32, y: u32) -> bool {
    let [width, height] = SIZE.map(f64::from);
    // 90 degrees vertically: one unit at distance 1 is half the height.
    let ray = DVec3::new(
        (f64::from(x) + 0.5 - width / 2.0) / (height / 2.0),
        -(f64::from(y) + 0.5 - height / 2.0) / (height / 2.0),
        -1.0,
    );
    let (center, normal) = (
        surfel.position.as_dvec3() - DVec3::Z * distance,
        surfel.normal.as_dvec3(),
    );
    let t = center.dot(normal) / ray.dot(normal);
    // The renderer's near plane is at 0.005 of the distance to the target.
    t > 0.005 * distance && (ray * t - center).length() <= radius
}

fn disk_pixels(surfel: &Surfel, radius: f64, distance: f64) -> Vec<(u32, u32)> {
    (0..SIZE[1])
        .flat_map(|y| (0..SIZE[0]).map(move |x| (x, y)))
        .filter(|&(x, y)| ray_hits_disk(surfel, radius, distance, x, y))
        .collect()
}

fn covered_pixels(image: &RgbaImage, background: [u8; 3]) -> Vec<(u32, u32)> {
    image
        .enumerate_pixels()
        .filter(|(_, _, pixel)| pixel.0[..3] != background)
        .map(|(x, y, _)| (x, y))
        .collect()
}

fn tilted(angle_deg: f32) -> Surfel {
    let (sin, cos) = angle_deg.to_radians().sin_cos();
    Surfel {
        position: Vec3::new(0.11, -0.07, 0.0),
        normal: Vec3::new(sin, 0.0, cos),
        radius: 0.83,
        color: RED,
    }
}

#[test]
fn a_single_surfel_covers_its_disk_in_every_mode() {
    for &splatting in Splatting::ALL {
        let [_, scale] = splatting.scales(2.0);
        for angle_deg in [0.0, 35.0, 60.0] {
            let surfel = tilted(angle_deg);
            let style = plain().with(|style| style.surfels.splatting = splatting);
            let image = draw(&surfels(&[surfel], &camera_at(3.0), style, SIZE));
            let expected = disk_pixels(&surfel, f64::from(surfel.radius * scale), 3.0);
            assert!(expected.len() > 300);
            assert_eq!(
                covered_pixels(&image, BLACK),
                expected,
                "{splatting} at {angle_deg} degrees"
            );
        }
    }
}

#[test]
fn the_splat_scale_scales_the_disk() {
    let surfel = tilted(20.0);
    for splat_scale in [0.5, 1.0, 1.7] {
        let style = plain().with(|style| {
            style.surfels.splat_scale = splat_scale;
            style.surfels.splatting = Splatting::TwoPass;
        });
        let image = draw(&surfels(&[surfel], &camera_at(4.0), style, SIZE));
        let expected = disk_pixels(&surfel, f64::from(surfel.radius * splat_scale), 4.0);
        assert_eq!(covered_pixels(&image, BLACK), expected, "scale {splat_scale}");
    }
}

#[test]
fn a_surfel_across_the_near_plane_is_cut_there() {
    // Its plane passes just below the eye, from behind it to far in front.
    let surfel = Surfel {
        position: Vec3::new(0.0, -0.2, 1.0),
        normal: Vec3::Y,
        radius: 1.5,
        color: RED,
    };
    let style = plain().with(|style| style.surfels.splatting = Splatting::TwoPass);
    let image = draw(&surfels(&[surfel], &camera_at(1.0), style, SIZE));
    let expected = disk_pixels(&surfel, 1.5, 1.0);
    assert!(expected.len() > 3000);
    assert_eq!(covered_pixels(&image, BLACK), expected);
}

#[test]
fn back_faces_are_culled_unless_asked_for() {
    let surfel = Surfel {
        normal: -tilted(20.0).normal,
        ..tilted(20.0)
    };
    for &splatting in Splatting::ALL {
        let style = plain().with(|style| style.surfels.splatting = splatting);
        let image = draw(&surfels(&[surfel], &camera_at(3.0), style, SIZE));
        assert_eq!(covered(&image, BLACK), 0, "{splatting}");
        let style = style.with(|style| style.surfels.back_faces = BackFaces::Drawn);
        let image = draw(&surfels(&[surfel], &camera_at(3.0), style, SIZE));
        let [_, scale] = splatting.scales(2.0);
        let expected = disk_pixels(&tilted(20.0), f64::from(surfel.radius * scale), 3.0);
        assert_eq!(covered_pixels(&image, BLACK), expected, "{splatting} from behind");
    }
}

/// Red at z = 1 in front of green at z = -1; both face the eye at z = 4 and are separated by more than the slack.
fn red_before_green() -> [Surfel; 2] {
    let red = Surfel {
        position: Vec3::new(-0.3, 0.0, 1.0),
        normal: Vec3::Z,
        radius: 0.7,
        color: RED,
    };
    let green = Surfel {
        position: Vec3::new(0.5, 0.0, -1.0),
        normal: Vec3::Z,
        radius: 0.9,
        color: GREEN,
    };
    [red, green]
}

#[test]
fn the_nearer_of_two_surfels_hides_the_other_in_any_order() {
    let [red, green] = red_before_green();
    let red_disk = disk_pixels(&red, 0.7, 4.0);
    let green_disk = disk_pixels(&green, 0.9, 4.0);
    let overlap = red_disk.iter().filter(|pixel| green_disk.contains(pixel)).count();
    assert!(overlap > 100);
    for order in [[red, green], [green, red]] {
        let style = plain().with(|style| style.surfels.splatting = Splatting::TwoPass);
        let image = draw(&surfels(&order, &camera_at(4.0), style, SIZE));
        for (x, y, pixel) in image.enumerate_pixels() {
            let [r, g, b, _] = pixel.0;
            let in_red = red_disk.contains(&(x, y));
            let in_green = green_disk.contains(&(x, y)) && !in_red;
            assert_eq!((r > 0, g > 0, b), (in_red, in_green, 0), "at {x}, {y}");
        }
    }
}

#[test]
fn without_depth_the_farther_one_shows_through() {
    let [red, green] = red_before_green();
    let style = plain().with(|style| style.surfels.splatting = Splatting::NoDepth);
    let image = draw(&surfels(&[red, green], &camera_at(4.0), style, SIZE));
    let both = image.pixels().filter(|pixel| pixel.0[0] > 0 && pixel.0[1] > 0).count();
    let red_disk = disk_pixels(&red, 0.7, 4.0);
    let overlap = disk_pixels(&green, 0.9, 4.0)
        .into_iter()
        .filter(|pixel| red_disk.contains(pixel))
        .count();
    // At the edges a weight of 5 % of one over the other may be rounded away.
    assert!(both > overlap * 9 / 10 && both <= overlap, "{both} of {overlap}");
}

#[test]
fn surfels_of_one_surface_are_averaged() {
    let surfel = |x: f32, color| Surfel {
        position: Vec3::new(x, 0.0, 0.0),
        normal: Vec3::Z,
        radius: 1.0,
        color,
    };
    let style = plain().with(|style| style.surfels.splatting = Splatting::TwoPass);
    let image = draw(&surfels(
        &[surfel(-0.3, RED), surfel(0.3, GREEN)],
        &camera_at(3.0),
        style,
        [201, 161],
    ));
    let midpoint = image.get_pixel(100, 80).0;
    assert!(
        midpoint[0].abs_diff(128) <= 1 && midpoint[1].abs_diff(128) <= 1,
        "{midpoint:?}"
    );
    assert!(
        image.get_pixel(80, 80).0[0] > image.get_pixel(80, 80).0[1],
        "left is nearer to red"
    );
}

#[test]
fn regular_splatting_shows_the_square_corners_that_the_paper_shows() {
    // In front: a small surfel whose square corners are transparent but write depth.
    let front = Surfel {
        position: Vec3::new(0.0, 0.0, 0.5),
        normal: Vec3::Z,
        radius: 0.5,
        color: RED,
    };
    let back = Surfel {
        position: Vec3::ZERO,
        normal: Vec3::Z,
        radius: 2.0,
        color: GREEN,
    };
    let at_corner = |splatting| {
        let style = plain().with(|style| style.surfels.splatting = splatting);
        let image = draw(&surfels(&[front, back], &camera_at(3.0), style, [200, 200]));
        // The corner (0.45, 0.45) of the square is outside the disk.
        image.get_pixel(100 + 18, 100 - 18).0
    };
    assert_eq!(at_corner(Splatting::Regular)[..3], BLACK);
    assert!(at_corner(Splatting::TwoPass)[1] > 200);
}

#[test]
fn a_voxel_seen_face_on_is_a_square() {
    let record = VoxelRecord {
        center: [0.0; 3],
        color: [10, 200, 30],
        level: 1,
    };
    let style = Style {
        primitive: Primitive::Voxel,
        ..plain()
    };
    // A cell of edge 1: its front face is 4.5 from the eye, 160 / 2 / 4.5 = 17.8 pixels high and wide.
    let image = draw(&voxels(vec![record], 2.0, &camera_at(5.0), style, SIZE));
    assert_eq!(count_color(&image, [10, 200, 30]), 18 * 18);
    assert_eq!(covered(&image, BLACK), 18 * 18);
}

#[test]
fn a_voxel_seen_from_a_corner_shows_three_faces_with_their_own_light() {
    let record = VoxelRecord {
        center: [0.0; 3],
        color: [200, 200, 200],
        level: 0,
    };
    let camera = Camera {
        azimuth_deg: 30.0,
        elevation_deg: 20.0,
        fov_deg: 30.0,
        ..camera_at(6.0)
    };
    let style = plain().with(|style| {
        style.primitive = Primitive::Voxel;
        style.light.lighting = Lighting::PerSurfel;
    });
    let image = draw(&voxels(vec![record], 1.0, &camera, style, SIZE));
    let mut colors: Vec<[u8; 4]> = image
        .pixels()
        .map(|pixel| pixel.0)
        .filter(|pixel| pixel[..3] != BLACK)
        .collect();
    colors.sort_unstable();
    colors.dedup();
    assert_eq!(colors.len(), 3, "{colors:?}");
}

#[test]
fn a_voxel_is_invisible_from_inside() {
    let record = VoxelRecord {
        center: [0.0; 3],
        color: [200, 200, 200],
        level: 0,
    };
    let style = Style {
        primitive: Primitive::Voxel,
        ..plain()
    };
    let image = draw(&voxels(vec![record], 10.0, &camera_at(1.0), style, SIZE));
    assert_eq!(covered(&image, BLACK), 0);
}

#[test]
fn the_nearer_voxel_hides_the_other_in_any_order() {
    let near = VoxelRecord {
        center: [0.0, 0.0, 1.0],
        color: RED,
        level: 1,
    };
    let far = VoxelRecord {
        center: [0.0, 0.0, -1.0],
        color: GREEN,
        level: 1,
    };
    let style = Style {
        primitive: Primitive::Voxel,
        ..plain()
    };
    for order in [vec![near, far], vec![far, near]] {
        let image = draw(&voxels(order, 2.0, &camera_at(4.0), style, SIZE));
        assert_eq!(count_color(&image, GREEN), 0);
        // Front face at 2.5 from the eye: 32 pixels.
        assert_eq!(count_color(&image, RED), 32 * 32);
    }
}

#[test]
fn points_are_squares_of_their_size_at_any_distance() {
    let point = |x: f32, z: f32| Surfel {
        position: Vec3::new(x, 0.013, z),
        normal: Vec3::NEG_Z,
        radius: 0.0,
        color: RED,
    };
    // Their squares do not touch, and they face away: points have no back.
    let cloud = [point(-1.0, 0.0), point(0.013, -3.0), point(1.0, 1.0)];
    for (point_size_px, pixels) in [(1.0, 1), (3.0, 9), (6.0, 36)] {
        let style = Style {
            primitive: Primitive::Point,
            points: PointStyle {
                size_px: point_size_px,
                ..PointStyle::default()
            },
            ..plain()
        };
        let image = draw(&surfels(&cloud, &camera_at(4.0), style, SIZE));
        assert_eq!(count_color(&image, RED), 3 * pixels, "{point_size_px} px");
    }
}

#[test]
fn the_headlight_is_full_where_a_surfel_faces_the_eye() {
    let surfel = Surfel {
        position: Vec3::ZERO,
        normal: Vec3::Z,
        radius: 2.0,
        color: [100, 60, 20],
    };
    for lighting in [Lighting::PerSurfel, Lighting::PerFragment] {
        let style = plain().with(|style| {
            style.surfels.splatting = Splatting::TwoPass;
            style.light.lighting = lighting;
        });
        let image = draw(&surfels(&[surfel], &camera_at(3.0), style, [201, 201]));
        let [r, g, b, _] = image.get_pixel(100, 100).0;
        // All of the colour, and the highlight's 15 % white.
        let highlight = 38;
        let expected = [100 + highlight, 60 + highlight, 20 + highlight];
        assert!(
            [r, g, b].iter().zip(expected).all(|(a, b)| a.abs_diff(b) <= 1),
            "{lighting}: {:?}",
            [r, g, b]
        );
    }
    let tilted = Surfel {
        normal: Vec3::new(0.866_025_4, 0.0, 0.5),
        ..surfel
    };
    let style = plain().with(|style| {
        style.surfels.splatting = Splatting::TwoPass;
        style.light.lighting = Lighting::PerSurfel;
    });
    let image = draw(&surfels(&[tilted], &camera_at(3.0), style, [201, 201]));
    // 60 degrees: 0.25 + 0.75 / 2 of the colour, no highlight to speak of.
    assert!(
        image.get_pixel(100, 100).0[0].abs_diff(63) <= 1,
        "{:?}",
        image.get_pixel(100, 100)
    );
}

#[test]
fn a_closed_sphere_shows_no_background_in_the_modes_that_close_it() {
    let background = [255, 0, 255];
    let cloud: Vec<Surfel> = sphere(2000, 1.0)
        .into_iter()
        .map(|s| Surfel {
            color: [90, 90, 90],
            ..s
        })
        .collect();
    for splatting in [Splatting::TwoPassEnlarged, Splatting::Enlarged] {
        for (azimuth_deg, elevation_deg) in [(0.0, 0.0), (77.0, 31.0), (190.0, -80.0)] {
            let camera = Camera {
                azimuth_deg,
                elevation_deg,
                ..camera_at(2.0)
            };
            let style = plain().with(|style| {
                style.surfels.splatting = splatting;
                style.backdrop.background = Background::solid(background);
            });
            let image = draw(&surfels(&cloud, &camera, style, [200, 200]));
            // The silhouette of a unit sphere at distance 2 is tan(30°) × 100 pixels wide.
            let silhouette = 100.0 * 30f32.to_radians().tan();
            for (x, y, pixel) in image.enumerate_pixels() {
                let from_center = (x as f32 + 0.5 - 100.0).hypot(y as f32 + 0.5 - 100.0);
                if from_center < 0.97 * silhouette {
                    assert_eq!(pixel.0[0], pixel.0[1], "{splatting}: background at {x}, {y}");
                } else if from_center > 1.2 * silhouette {
                    assert_eq!(pixel.0[..3], background, "{splatting}: splat at {x}, {y}");
                }
            }
        }
    }
}

#[test]
fn a_gradient_runs_from_top_to_bottom() {
    let style = plain().with(|style| {
        style.backdrop.background = Background {
            top: [0, 0, 0],
            bottom: [160, 80, 0],
        }
    });
    let image = draw(&surfels(&[], &camera_at(1.0), style, SIZE));
    for (_, y, pixel) in image.enumerate_pixels() {
        let expected = (y as f32 + 0.5).round() as u8;
        assert!(
            pixel.0[0].abs_diff(expected) <= 1 && pixel.0[1].abs_diff(expected / 2) <= 1,
            "row {y}: {pixel:?}"
        );
    }
}

#[test]
fn a_cloud_far_from_the_world_origin_looks_the_same() {
    let cloud = sphere(800, 1.0);
    let near = surfels(&cloud, &camera_at(3.0), plain(), SIZE);
    let origin = DVec3::new(4.5e6, -1.2e7, 321.0);
    let camera = Camera {
        target_in_world: origin,
        ..camera_at(3.0)
    };
    let mut far = surfels(&cloud, &camera, plain(), SIZE);
    far.view = camera.transform(origin, SIZE);
    let (pixels, max) = common::difference(&draw(&near), &draw(&far));
    assert!(pixels <= 20 && max <= 2, "{pixels} pixels differ by up to {max}");
}

#[test]
fn images_of_odd_sizes_are_complete() {
    for size in [[1, 1], [3, 7], [65, 1], [257, 33]] {
        let style = plain().with(|style| style.backdrop.background = Background::solid([1, 2, 3]));
        let image = draw(&surfels(&[], &camera_at(1.0), style, size));
        assert_eq!([image.width(), image.height()], size);
        assert_eq!(count_color(&image, [1, 2, 3]), (size[0] * size[1]) as usize);
    }
}
