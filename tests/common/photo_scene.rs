//! A scene whose every ray has a known colour: a textured ball in a textured ring, photographed from all around.

use crate::common::plain;
use glam::{DAffine3, DMat3, DVec2, DVec3, Vec3};
use pointreel::cloud::{Attributes, Frame, Positions, RawCloud};
use pointreel::photos::{PhotoImage, PosedImage, PosedImages, Texture};
use pointreel::rgbd::{Camera, Distortion};
use pointreel::scene::{Scene, Splatting, Style};
use pointreel::sequence::{PrepareCounters, PreparedFrame, prepare};
use rayon::prelude::*;
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

const BALL_RADIUS: f64 = 0.7;
const RING_RADIUS: f64 = 1.25;
const TUBE_RADIUS: f64 = 0.16;

/// Everything that cameras look at is within this.
pub(crate) const SCENE_RADIUS: f64 = RING_RADIUS + TUBE_RADIUS;

/// From the centre to each camera.
pub(crate) const DISTANCE: f64 = 4.2;

/// The ring lies in a plane that is tilted.
fn in_ring(place: DVec3) -> DVec3 {
    DMat3::from_rotation_x(0.5) * place
}

/// Distance to the nearest surface, and whether that is the ring's.
fn distance(place: DVec3) -> (f64, bool) {
    let ball = place.length() - BALL_RADIUS;
    let at = in_ring(place);
    let ring = DVec2::new(DVec2::new(at.x, at.z).length() - RING_RADIUS, at.y).length() - TUBE_RADIUS;
    if ring < ball { (ring, true) } else { (ball, false) }
}

/// The colour of a position on the surface, 0 to 1: waves that a few thousand points cannot resolve.
fn color(place: DVec3, is_ring: bool) -> DVec3 {
    let waves = |frequency: f64| {
        let [x, y, z] = (frequency * place).to_array();
        DVec3::new((x + 0.3 * y).sin(), (y - 0.4 * z).sin(), (z + 0.5 * x).sin())
    };
    let base = if is_ring {
        DVec3::new(0.75, 0.55, 0.3)
    } else {
        DVec3::new(0.35, 0.5, 0.65)
    };
    base + 0.1 * waves(9.0) + 0.14 * waves(37.0)
}

/// The position that a ray meets, with the colour there.
pub(crate) fn hit(origin: DVec3, direction: DVec3) -> Option<(DVec3, DVec3)> {
    let center = -origin.dot(direction);
    let nearest2 = origin.length_squared() - center * center;
    let within = SCENE_RADIUS * SCENE_RADIUS - nearest2;
    if within <= 0.0 {
        return None;
    }
    let (mut along, end) = (center - within.sqrt(), center + within.sqrt());
    while along < end {
        let place = origin + along * direction;
        let (free, is_ring) = distance(place);
        if free < 1e-5 {
            return Some((place, color(place, is_ring)));
        }
        along += free;
    }
    None
}

/// From a position on the sphere around the scene, looking at its centre, with y up.
pub(crate) fn pose(azimuth_deg: f64, elevation_deg: f64) -> DAffine3 {
    let (azimuth, elevation) = (azimuth_deg.to_radians(), elevation_deg.to_radians());
    let toward = DVec3::new(
        azimuth.sin() * elevation.cos(),
        elevation.sin(),
        azimuth.cos() * elevation.cos(),
    );
    let forward = -toward;
    let right = forward.cross(DVec3::Y).normalize();
    let down = forward.cross(right);
    let world_from_camera = DMat3::from_cols(right, down, forward);
    DAffine3::from_mat3_translation(world_from_camera, DISTANCE * toward).inverse()
}

/// A camera of square images that shows all of the scene.
pub(crate) fn pinhole(edge_px: u32) -> Camera {
    let focal = DVec2::splat(1.28 * f64::from(edge_px));
    // Not quite at the centre, as in real ones.
    let principal = DVec2::new(0.503, 0.494) * f64::from(edge_px) - 0.5;
    Camera::new([edge_px; 2], focal, principal, Distortion::None).unwrap()
}

/// The image of such a camera: red, green, blue and 255 where the scene is, else zeros.
pub(crate) fn textured(pinhole: &Camera, camera_from_world: &DAffine3) -> Vec<[u8; 4]> {
    let [width, height] = pinhole.size_px();
    let world_from_camera = camera_from_world.inverse();
    (0..width * height)
        .into_par_iter()
        .map(|at| {
            let ray = pinhole
                .ray(DVec2::new(f64::from(at % width), f64::from(at / width)))
                .unwrap();
            let direction = (world_from_camera.matrix3 * ray).normalize();
            let found = hit(world_from_camera.translation, direction);
            found.map_or([0; 4], |(_, color)| {
                let [red, green, blue] = color.to_array().map(|channel| (255.0 * channel + 0.5) as u8);
                [red, green, blue, 255]
            })
        })
        .collect()
}

/// Poses of the input images: three rings of twelve.
pub(crate) fn poses() -> Vec<DAffine3> {
    let ring =
        |elevation_deg: f64| (0..12).map(move |at| pose(30.0 * f64::from(at) + 0.4 * elevation_deg, elevation_deg));
    [-35.0, 5.0, 45.0].into_iter().flat_map(ring).collect()
}

/// Images of `edge_px`² from [`poses`]. The background is black, and not masked.
pub(crate) fn posed_images(edge_px: u32) -> PosedImages {
    let pinhole = pinhole(edge_px);
    let posed_image = |(number, camera_from_world): (usize, DAffine3)| {
        let mut texels = textured(&pinhole, &camera_from_world);
        for texel in &mut texels {
            texel[3] = 255;
        }
        PosedImage {
            name: format!("{number:02}.png"),
            number,
            pinhole: pinhole.clone(),
            camera_from_world,
            texture: Texture::new(PhotoImage::new([edge_px; 2], texels).unwrap()),
            is_masked: false,
            gain: Vec3::ONE,
            depth: None,
        }
    };
    let all = poses().into_iter().enumerate().map(posed_image).collect();
    PosedImages::new(all, Some(30.0_f64.to_radians()))
}

/// About `count` points of the surface, with their colours and normals.
pub(crate) fn cloud(count: usize) -> RawCloud {
    let ball_area = 4.0 * PI * BALL_RADIUS * BALL_RADIUS;
    let ring_area = 4.0 * PI * PI * RING_RADIUS * TUBE_RADIUS;
    let on_ball = (count as f64 * ball_area / (ball_area + ring_area)) as usize;
    let golden = PI * (3.0 - 5.0_f64.sqrt());
    let ball = (0..on_ball).map(|at| {
        let z = 1.0 - (2.0 * at as f64 + 1.0) / on_ball as f64;
        let (sin, cos) = (golden * at as f64).sin_cos();
        let radius = (1.0 - z * z).sqrt();
        let normal = DVec3::new(radius * cos, radius * sin, z);
        (BALL_RADIUS * normal, normal, false)
    });
    let spacing = (ring_area / (count - on_ball) as f64).sqrt();
    let around = (TAU * TUBE_RADIUS / spacing).round() as usize;
    let along = (TAU * RING_RADIUS / spacing).round() as usize;
    let ring = (0..around * along).map(|at| {
        let turn = TAU * (at / around) as f64 / along as f64;
        let tilt = TAU * ((at % around) as f64 + 0.5 * (at / around % 2) as f64) / around as f64;
        let outward = DVec3::new(turn.cos(), 0.0, turn.sin());
        let normal = tilt.cos() * outward + tilt.sin() * DVec3::Y;
        let back = DMat3::from_rotation_x(-0.5);
        (
            back * (RING_RADIUS * outward + TUBE_RADIUS * normal),
            back * normal,
            true,
        )
    });
    let points: Vec<(DVec3, DVec3, bool)> = ball.chain(ring).collect();
    let colors = points.iter().map(|&(place, _, is_ring)| {
        let [red, green, blue] = color(place, is_ring)
            .to_array()
            .map(|channel| (255.0 * channel + 0.5) as u8);
        [red, green, blue, 255]
    });
    RawCloud {
        attributes: Attributes {
            colors: Some(colors.collect()),
            normals: Some(
                points
                    .iter()
                    .map(|(_, normal, _)| normal.as_vec3().to_array())
                    .collect(),
            ),
            ..Attributes::default()
        },
        ..RawCloud::from_positions(Positions::F64(
            points.iter().map(|(place, ..)| place.to_array()).collect(),
        ))
    }
}

/// That cloud, prepared for a style.
pub(crate) fn frame(count: usize, style: &Style) -> PreparedFrame {
    let frame = Frame::from_raw(cloud(count), DVec3::ZERO).unwrap();
    prepare(
        0,
        Arc::new(frame),
        0.0,
        &Scene::needs(style),
        &PrepareCounters::default(),
    )
}

/// Settings without light, with a black background; disks as large as the point spacing.
pub(crate) fn style() -> Style {
    plain().with(|style| {
        style.surfels.splatting = Splatting::TwoPass;
        style.of_sequence.has_photos = true;
    })
}
