//! EWA filtering: far away, pixels show the mean of their area; nearby surfaces stay as they are.

use crate::common::{Surfel, camera_at, draw, draw_on_cpu, plain, surfels};
use glam::{DVec3, Vec3};
use image::{Rgba, RgbaImage};
use pointreel::measure::flip;
use pointreel::scene::{BackFaces, Camera, Primitive, ScenePacket, SplatFilter, Splatting, Style};

const EDGE_PX: u32 = 48;

fn style(filter: SplatFilter) -> Style {
    plain().with(|style| {
        style.surfels.splatting = Splatting::TwoPass;
        style.surfels.filter = filter;
        style.surfels.back_faces = BackFaces::Drawn;
    })
}

/// A camera that sees this many points of a lattice with a spacing of 1 across a pixel, slightly off its centre.
fn camera(points_per_px: f64) -> Camera {
    Camera {
        target_in_world: DVec3::new(0.3, 0.2, 0.0) * points_per_px,
        ..camera_at(0.5 * f64::from(EDGE_PX) * points_per_px)
    }
}

/// A lattice of black and white squares, this many points wide, that faces the eye and is larger than the image.
fn checkers(points_per_px: f64, square: i32) -> Vec<Surfel> {
    let half = (0.5 * f64::from(EDGE_PX) * points_per_px) as i32 + 40;
    let surfel = |x: i32, y: i32| Surfel {
        position: Vec3::new(x as f32, y as f32, 0.0),
        normal: Vec3::Z,
        // The disks just cover the plane.
        radius: 0.708,
        color: [if (x.div_euclid(square) + y.div_euclid(square)) % 2 == 0 {
            255
        } else {
            0
        }; 3],
    };
    (-half..half)
        .flat_map(|y| (-half..half).map(move |x| surfel(x, y)))
        .collect()
}

/// The exact mean of the checkers in each pixel: they are the product of two waves, one of each coordinate.
fn mean_of_checkers(points_per_px: f64, square: i32) -> RgbaImage {
    let square = f64::from(square);
    // The integral from 0 to a position of a square wave that is 1 for the first square, and then -1.
    let integral = |place: f64| {
        let place = (place + 0.5).rem_euclid(2.0 * square);
        place.min(2.0 * square - place)
    };
    let target = camera(points_per_px).target_in_world;
    let mean = |center: f64| {
        let half = 0.5 * points_per_px;
        (integral(center + half) - integral(center - half)) / points_per_px
    };
    RgbaImage::from_fn(EDGE_PX, EDGE_PX, |x, y| {
        let aside = |px: u32| (f64::from(px) + 0.5 - 0.5 * f64::from(EDGE_PX)) * points_per_px;
        let product = mean(target.x + aside(x)) * mean(target.y - aside(y));
        let grey = (127.5 + 127.5 * product).round() as u8;
        Rgba([grey, grey, grey, 255])
    })
}

/// The same plane by the other filter that is known for splats: a Gaussian is at least as wide as a pixel's, whose
/// variance is a half, but as strong as before (2D Gaussian splatting; Botsch et al. 2005).
fn clamped(surfels: &[Surfel], points_per_px: f64) -> RgbaImage {
    let target = camera(points_per_px).target_in_world;
    let radius_px = f64::from(surfels[0].radius) / points_per_px;
    let mut sums = vec![[0.0f64; 2]; (EDGE_PX * EDGE_PX) as usize];
    for surfel in surfels {
        let center = 0.5 * f64::from(EDGE_PX);
        let place = [
            center + (f64::from(surfel.position.x) - target.x) / points_per_px,
            center - (f64::from(surfel.position.y) - target.y) / points_per_px,
        ];
        let range = |along: f64| {
            let end = |px: f64| px.clamp(0.0, f64::from(EDGE_PX)) as u32;
            end(along - 2.0)..end(along + 3.0)
        };
        for y in range(place[1]) {
            for x in range(place[0]) {
                let aside2 = (f64::from(x) + 0.5 - place[0]).powi(2) + (f64::from(y) + 0.5 - place[1]).powi(2);
                let exponent = (3.0 * aside2 / (radius_px * radius_px)).min(aside2);
                if exponent <= 3.0 {
                    let weight = (-exponent).exp();
                    let sum = &mut sums[(y * EDGE_PX + x) as usize];
                    *sum = [sum[0] + weight * f64::from(surfel.color[0]), sum[1] + weight];
                }
            }
        }
    }
    RgbaImage::from_fn(EDGE_PX, EDGE_PX, |x, y| {
        let [color, weight] = sums[(y * EDGE_PX + x) as usize];
        let grey = (color / weight).round() as u8;
        Rgba([grey, grey, grey, 255])
    })
}

#[test]
fn distant_checkers_are_closer_to_their_mean_than_disks_or_clamped_splats() {
    let far = [4.0, 8.0, 16.0].into_iter();
    for (points_per_px, square) in far.flat_map(|far| [5, 7, 11].map(|square| (far, square))) {
        let truth = mean_of_checkers(points_per_px, square);
        let cloud = checkers(points_per_px, square);
        let packet = |filter| surfels(&cloud, &camera(points_per_px), style(filter), [EDGE_PX; 2]);
        let error = |image: &RgbaImage| flip(&truth, image).unwrap().mean();
        let disks = error(&draw_on_cpu(&packet(SplatFilter::Off)));
        let clamped = error(&clamped(&cloud, points_per_px));
        let [cpu, gpu] = [draw_on_cpu, draw].map(|draw| error(&draw(&packet(SplatFilter::Ewa))));
        for ewa in [cpu, gpu] {
            // From squares of a third of a pixel both filters make a grey, to within one byte step.
            assert!(
                ewa <= 0.5 * disks && ewa < clamped.max(0.005),
                "{points_per_px}, {square}: {ewa} for {disks} and {clamped}"
            );
        }
    }
}

/// The filter that is the control for EWA, as both renderers draw it.
#[test]
fn clamped_splats_match_the_common_definition() {
    for (points_per_px, square) in [(1.0, 5), (4.0, 7), (8.0, 11)] {
        let cloud = checkers(points_per_px, square);
        let expected = clamped(&cloud, points_per_px);
        for primitive in [Primitive::Surfel, Primitive::Sprite] {
            let style = style(SplatFilter::Clamp).with(|style| style.primitive = primitive);
            let packet = surfels(&cloud, &camera(points_per_px), style, [EDGE_PX; 2]);
            for (image, by) in [(draw_on_cpu(&packet), "CPU"), (draw(&packet), "GPU")] {
                let error = flip(&expected, &image).unwrap().mean();
                assert!(error < 0.004, "{points_per_px}, {square}, {primitive}, {by}: {error}");
            }
        }
    }
}

/// The sum of white surfels over a row, or over the image, in white pixels.
fn light_of(cloud: &[Surfel], camera: &Camera, draw: fn(&ScenePacket) -> RgbaImage, rows: std::ops::Range<u32>) -> f64 {
    let image = draw(&surfels(cloud, camera, style(SplatFilter::Ewa), [EDGE_PX; 2]));
    let of_row = |y: u32| {
        (0..EDGE_PX)
            .map(|x| f64::from(image.get_pixel(x, y).0[0]) / 255.0)
            .sum::<f64>()
    };
    rows.map(of_row).sum()
}

#[test]
fn a_subpixel_splat_adds_its_area_wherever_it_is() {
    // Ten pixels per unit.
    let camera = camera_at(0.05 * f64::from(EDGE_PX));
    for (radius_px, tilt_deg) in [(0.2, 0.0), (0.3, 0.0), (0.3, 45.0), (0.3, 60.0)] {
        let tilt = f32::to_radians(tilt_deg);
        let places = (0..16).map(|i| Vec3::new((i % 4) as f32, (i / 4) as f32, 0.0) * 0.025);
        let lights: Vec<f64> = places
            .map(|position| {
                let normal = Vec3::new(tilt.sin(), 0.0, tilt.cos());
                let surfel = Surfel {
                    position,
                    normal,
                    radius: 0.1 * radius_px,
                    color: [255; 3],
                };
                light_of(&[surfel], &camera, draw_on_cpu, 0..EDGE_PX)
            })
            .collect();
        // The mask integrates to a third of the disk, and a surface of them hides the background from a weight of one
        // half.
        let area_px = std::f64::consts::PI * f64::from(radius_px * radius_px * tilt.cos());
        let expected = area_px * (1.0 - (-3.0f64).exp()) / 3.0 / 0.5;
        let mean = lights.iter().sum::<f64>() / lights.len() as f64;
        assert!(
            (mean / expected - 1.0).abs() < 0.1,
            "{mean} for {expected}: radius {radius_px}, {tilt_deg} degrees"
        );
        for light in lights {
            assert!((light / mean - 1.0).abs() < 0.4, "{light} of {mean}");
        }
    }
}

#[test]
fn an_edge_of_distant_points_covers_pixels_by_area() {
    for points_per_px in [4.0, 8.0, 16.0] {
        let camera = camera(points_per_px);
        let whole: Vec<Surfel> = checkers(points_per_px, 1)
            .into_iter()
            .map(|surfel| Surfel {
                color: [255; 3],
                ..surfel
            })
            .collect();
        for eighth in 0..8 {
            let last = f64::from(eighth) / 8.0 * points_per_px;
            let half: Vec<Surfel> = whole
                .iter()
                .copied()
                .filter(|surfel| f64::from(surfel.position.x) <= last)
                .collect();
            // The surface ends half a spacing beyond the last points.
            let edge = (last.floor() + 0.5 - camera.target_in_world.x) / points_per_px + 0.5 * f64::from(EDGE_PX);
            for draw in [draw_on_cpu, draw] {
                let covered = light_of(&half, &camera, draw, 20..21);
                assert!((covered - edge).abs() < 0.1, "{points_per_px}: {covered} of {edge}");
            }
        }
    }
}

#[test]
fn near_splats_are_unchanged() {
    let cloud = checkers(0.25, 7);
    let packet = |filter| surfels(&cloud, &camera(0.05), style(filter), [EDGE_PX; 2]);
    let [plain, filtered] = [SplatFilter::Off, SplatFilter::Ewa].map(|filter| draw_on_cpu(&packet(filter)));
    assert!(flip(&plain, &filtered).unwrap().mean() < 0.01);
}
