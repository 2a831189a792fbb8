//! Photographs of what has none: pictures of all its points, and a few of the points to put them on.
//!
//! That is the experiment of paper 004 (§6, Table 2): what a few thousand points with photographs show of a dense
//! cloud.

use super::backgrounds::is_covered;
use crate::bench::BenchError;
use crate::bench::run::{COVERAGE_BACKGROUNDS, Run};
use crate::bench::runner::Runner;
use crate::bench::scenario;
use crate::photos::{PhotoImage, Photograph, Photographs, Texture};
use crate::rgbd::{self, Distortion};
use crate::scene::{Background, Camera, FirstLook, Scene, Style};
use crate::sequence::{PrepareCounters, PreparedFrame, prepare};
use glam::{DAffine3, DMat3, DVec2, DVec3, Vec3};
use std::sync::Arc;

/// Photographs that are made, and their width and height: the paper has 36 to 50 of 512 or 1024.
pub(super) const COUNT: usize = 36;
const EDGE_PX: u32 = 512;

/// Points that are left of the cloud (paper 004, Table 2: 3.5 K of the bunny).
const POINTS: usize = 3_500;

/// Cotangent of half the field of view.
const FOCAL: f64 = 2.5;

/// The few points of `frame`, and pictures of all of them from around `look`; `None` where too few are left.
pub(super) fn make(
    run: &mut Run<'_>,
    runner: &mut Runner,
    frame: &PreparedFrame,
    (look, style, origin): (&FirstLook, &Style, DVec3),
) -> Result<Option<(PreparedFrame, Photographs)>, BenchError> {
    let Ok((few, _)) = frame.frame.sample(POINTS) else {
        return Ok(None);
    };
    let few = prepare(
        frame.index,
        Arc::new(few),
        0.0,
        &Scene::needs(style),
        &PrepareCounters::default(),
    );
    let edge = f64::from(EDGE_PX);
    let focal = DVec2::splat(0.5 * FOCAL * edge);
    let Ok(pinhole) = rgbd::Camera::new([EDGE_PX; 2], focal, DVec2::splat(0.5 * edge - 0.5), Distortion::None) else {
        return Ok(None);
    };
    let middle = origin + look.trimmed.center().as_dvec3();
    let distance = 1.1 * FOCAL.hypot(1.0) * f64::from(look.trimmed.radius()).max(f64::MIN_POSITIVE.sqrt());
    let mut photographs = Vec::new();
    for (number, (azimuth_deg, elevation_deg)) in scenario::directions(COUNT).enumerate() {
        run.check_cancelled()?;
        let camera_from_world = pose(look, middle, distance, [azimuth_deg, elevation_deg]);
        let camera = Camera::of_pinhole(&pinhole, camera_from_world.inverse(), distance, look.up);
        let mut pictures = Vec::new();
        for background in COVERAGE_BACKGROUNDS {
            let style = style.with(|style| style.backdrop.background = Background::solid(background));
            let packet = Scene::default().packet(frame, origin, &camera, &style, [EDGE_PX; 2]);
            pictures.push(runner.image(&packet)?);
        }
        let pixels = pictures[0].pixels().zip(pictures[1].pixels());
        let texels = pixels.map(|(dark, bright)| {
            let [red, green, blue, _] = dark.0;
            if is_covered(*dark, *bright) {
                [red, green, blue, 255]
            } else {
                [0; 4]
            }
        });
        let Some(image) = PhotoImage::new([EDGE_PX; 2], texels.collect()) else {
            return Ok(None);
        };
        photographs.push(Photograph {
            name: format!("made {number:02}"),
            number,
            pinhole: pinhole.clone(),
            camera_from_world,
            texture: Texture::new(image),
            is_masked: true,
            gain: Vec3::ONE,
            depth: None,
        });
    }
    // Directions are spread evenly over the sphere.
    let angle = (4.0 * std::f64::consts::PI / COUNT as f64).sqrt();
    Ok(Some((few, Photographs::new(photographs, Some(angle)))))
}

/// Of a camera that looks at `middle`.
fn pose(look: &FirstLook, middle: DVec3, distance: f64, [azimuth_deg, elevation_deg]: [f64; 2]) -> DAffine3 {
    let mut camera = Camera::framing(&look.trimmed, DVec3::ZERO, look.up);
    camera.azimuth_deg = azimuth_deg;
    camera.elevation_deg = elevation_deg;
    // From right, up, backward to right, down, forward.
    let flip = DMat3::from_diagonal(DVec3::new(1.0, -1.0, -1.0));
    let rotation = flip * camera.view_from_world_rotation();
    let eye = middle - distance * rotation.row(2);
    DAffine3::from_mat3_translation(rotation, -(rotation * eye))
}
