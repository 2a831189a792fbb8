//! The near plane follows the content: eight balls over seven orders of distance are drawn for every target, on both
//! renderers, and can be picked.

use crate::common;
use glam::{DVec3, Vec3};
use image::RgbaImage;
use pointreel::cloud::{Frame, Positions, RawCloud};
use pointreel::scene::{
    Background, Camera, Lighting, PicturePlane, Primitive, Projection, Scene, ScenePacket, Style, UpAxis, pick,
};
use pointreel::sequence::{ColorSource, Coloring, Needs, PrepareCounters, PreparedFrame, prepare};
use std::sync::Arc;

const SIZE_PX: [u32; 2] = [256, 192];
const POINTS_PER_BALL: usize = 300;

/// Slope between the centres of two balls, and radius of a ball as a part of its distance.
const SPACING: f64 = 0.2;
const RADIUS: f64 = 0.08;

fn distance_of(ball: usize) -> f64 {
    0.01 * 10f64.powi(ball as i32)
}

fn center_of(ball: usize) -> DVec3 {
    let [column, row] = [(ball % 4) as f64 - 1.5, (ball / 4) as f64 - 0.5];
    distance_of(ball) * DVec3::new(SPACING * column, SPACING * row, -1.0)
}

fn color_of(ball: usize) -> [u8; 3] {
    [40 + 25 * ball as u8, 250, 10]
}

/// Eight balls from 0.01 to 1e5 units away along −Z, all as large seen from the origin, each in a colour.
fn balls(style: &Style) -> PreparedFrame {
    let (mut positions, mut normals, mut colors, mut radii) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let unit_ball = common::sphere(POINTS_PER_BALL as u32, 1.0);
    for ball in 0..8 {
        let radius = RADIUS * distance_of(ball);
        for surfel in &unit_ball {
            positions.push(
                (center_of(ball) + radius * surfel.normal.as_dvec3())
                    .as_vec3()
                    .to_array(),
            );
            normals.push(surfel.normal.to_array());
            radii.push(surfel.radius * radius as f32);
            let [red, green, blue] = color_of(ball);
            colors.push([red, green, blue, 255]);
        }
    }
    let mut raw = RawCloud::from_positions(Positions::F32(positions));
    raw.attributes.normals = Some(normals);
    raw.attributes.colors = Some(colors);
    raw.attributes.radii = Some(radii);
    let frame = Frame::from_raw(raw, DVec3::ZERO).unwrap();
    let needs = Needs {
        colors: Coloring::of(ColorSource::File),
        ..Scene::needs(style)
    };
    prepare(0, Arc::new(frame), 0.0, &needs, &PrepareCounters::default())
}

fn style(primitive: Primitive) -> Style {
    Style::default().with(|style| {
        style.primitive = primitive;
        style.colors = Coloring::of(ColorSource::File);
        style.light.lighting = Lighting::Unlit;
        style.backdrop.background = Background::solid([0, 0, 0]);
        style.points.size_px = 3.0;
    })
}

/// The eye at the origin, looking along −Z at a target at a distance.
fn camera(target: f64) -> Camera {
    Camera {
        target_in_world: DVec3::new(0.0, 0.0, -target),
        distance: target,
        azimuth_deg: 0.0,
        elevation_deg: 0.0,
        fov_deg: 50.0,
        up: UpAxis::Y,
        projection: Projection::Perspective,
        plane: PicturePlane::CENTERED,
    }
}

fn packet(frame: &PreparedFrame, camera: &Camera, primitive: Primitive) -> ScenePacket {
    Scene::default().packet(frame, DVec3::ZERO, camera, &style(primitive), SIZE_PX)
}

/// The balls with less than half of the disk visible.
fn missing(image: &RgbaImage) -> Vec<usize> {
    let px_per_slope = 0.5 * f64::from(SIZE_PX[1]) / 25f64.to_radians().tan();
    let disk_px = std::f64::consts::PI * (RADIUS * px_per_slope).powi(2);
    let is_missing = |&ball: &usize| (common::count_color(image, color_of(ball)) as f64) < 0.5 * disk_px;
    (0..8).filter(is_missing).collect()
}

#[test]
fn balls_over_seven_orders_are_seen_with_targets_near_and_far() {
    for primitive in [
        Primitive::Surfel,
        Primitive::Point,
        Primitive::Sprite,
        Primitive::Ellipse,
    ] {
        let frame = balls(&style(primitive));
        for target in [0.01, 1.0, 1e3, 1e5] {
            let packet = packet(&frame, &camera(target), primitive);
            for (renderer, image) in [("GPU", common::draw(&packet)), ("CPU", common::draw_on_cpu(&packet))] {
                assert_eq!(
                    missing(&image),
                    [0usize; 0],
                    "{primitive} on the {renderer}, target {target}"
                );
            }
        }
    }
}

/// From between them too, where the box around them has the eye inside: the content is on both sides of it.
#[test]
fn balls_around_the_eye_are_seen() {
    let frame = balls(&style(Primitive::Surfel));
    let mut behind = camera(1e5);
    // Past the nearest four balls: one to the left of the axis, the others further out.
    behind.fly(DVec3::new(0.0, 0.0, -20.0));
    let packet = packet(&frame, &behind, Primitive::Surfel);
    assert!(packet.view.near < 0.01, "{}", packet.view.near);
    for image in [common::draw(&packet), common::draw_on_cpu(&packet)] {
        // At 1e3 and farther nothing has moved much.
        let seen: Vec<usize> = missing(&image).into_iter().filter(|&ball| ball >= 5).collect();
        assert_eq!(seen, [0usize; 0]);
    }
}

/// Depths of all seven orders are distinguished: of two balls one behind the other the nearer one is seen.
#[test]
fn nearer_balls_hide_farther_ones_at_every_distance() {
    let mut surfels = Vec::new();
    for ball in 0..8 {
        let distance = distance_of(ball);
        for (color, share) in [([10, 20, 250], 1.5), (color_of(ball), 1.0)] {
            let center = (share * center_of(ball)).as_vec3();
            let radius = (RADIUS * distance) as f32;
            surfels.push(common::Surfel {
                position: center,
                normal: Vec3::Z,
                radius,
                color,
            });
        }
    }
    // The farther one drawn last and first.
    for _ in 0..2 {
        surfels.reverse();
        let style = style(Primitive::Surfel);
        let mut packet = common::surfels(&surfels, &camera(1e5), style, SIZE_PX);
        packet.view = packet.view.near_for(&packet.bounds);
        for image in [common::draw(&packet), common::draw_on_cpu(&packet)] {
            for ball in 0..8 {
                let px = camera(1e5).to_px(center_of(ball), SIZE_PX).unwrap();
                let seen = image.get_pixel(px.x as u32, px.y as u32).0;
                assert_eq!(seen[..3], color_of(ball), "ball {ball}");
            }
        }
    }
}

#[test]
fn what_is_next_to_the_eye_is_picked_and_has_a_place() {
    let frame = balls(&style(Primitive::Surfel));
    let camera = camera(1e5);
    let packet = packet(&frame, &camera, Primitive::Surfel);
    for ball in 0..8 {
        let px = camera
            .to_px(center_of(ball), SIZE_PX)
            .expect("it is in front of the eye");
        let slot = pick(&packet, &frame, px.to_array(), 0.0).expect("a ball is there");
        let place = frame.frame.positions()[slot].as_dvec3();
        let off = (place - center_of(ball)).length() / distance_of(ball);
        assert!((off / RADIUS - 1.0).abs() < 0.01, "ball {ball}: {off}");
    }
}

/// Views that the usual near plane shows whole are drawn with it, to the bit, and so are orthographic views.
#[test]
fn views_from_outside_are_unchanged() {
    let frame = common::colored_sphere(500, &style(Primitive::Surfel));
    for projection in [Projection::Perspective, Projection::Orthographic] {
        let camera = Camera {
            projection,
            ..Camera::framing(&frame.frame.bounds(), DVec3::ZERO, UpAxis::Y)
        };
        let packet = packet(&frame, &camera, Primitive::Surfel);
        assert_eq!(packet.view, camera.transform(DVec3::ZERO, SIZE_PX), "{projection}");
    }
}
