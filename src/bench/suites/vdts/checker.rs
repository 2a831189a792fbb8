//! Fig. 5 of Yang et al. 2006 in numbers: a checkerboard on a few points, from near, from afar and from the side, with
//! and without mip levels.
//!
//! How it works: a square of the plane z = 0 has few points and one image from above. The ground truth is the mean of
//! 8×8 rays per pixel of the checkerboard itself. Without mip levels, one texel or the four around a position stand for
//! all that a pixel covers.

use super::columns::{FILTERED, row};
use super::multiview::{MultiView, StyledFrame};
use crate::bench::BenchError;
use crate::bench::report::{Cell, Row};
use crate::bench::run::Run;
use crate::bench::runner::Runner;
use crate::cloud::{Attributes, Frame, Positions, RawCloud};
use crate::measure::psnr_db;
use crate::photos::{PhotoImage, PosedImage, PosedImages, Texture};
use crate::rgbd::{self, Distortion};
use crate::scene::{Camera, FirstLook, PhotoClipping, PhotoMode, Scene, Settings, UpAxis};
use crate::sequence::{PrepareCounters, prepare};
use glam::{DAffine3, DMat3, DVec2, DVec3, Vec3};
use std::sync::Arc;

/// Squares along an edge of the checker, which reaches from −1 to 1.
const SQUARES: f64 = 48.0;

/// Points along an edge.
const POINTS: usize = 20;

/// Edge length of the input image and of rendered images.
const PHOTO_PX: u32 = 1024;
const PICTURE_PX: u32 = 256;

/// Rays along an edge of a pixel.
const RAYS: u32 = 8;

/// Focal length, as a share of the width.
const FOCAL: f64 = 1.2;

/// Views of the checker: name, degrees from the normal, and distance.
const VIEWS: [(&str, f64, f64); 3] = [("near", 20.0, 1.0), ("far", 20.0, 8.0), ("aslant", 75.0, 2.5)];

/// Rows of [`measure`], each a step.
pub(super) const STEPS: usize = 3 * VIEWS.len();

/// Fraction of the checkerboard that is compared: disks end at its border.
const COMPARED: f64 = 0.9;

fn color(place: DVec2) -> f64 {
    let square = (0.5 * SQUARES * (place + 1.0)).floor();
    if (square.x + square.y).rem_euclid(2.0) == 0.0 {
        0.9
    } else {
        0.1
    }
}

/// Returns a camera that looks at the centre.
fn looking(edge_px: u32, degrees: f64, distance: f64) -> Option<(rgbd::Camera, DAffine3)> {
    let edge = f64::from(edge_px);
    let (focal, principal) = (DVec2::splat(FOCAL * edge), DVec2::splat(0.5 * edge - 0.5));
    let pinhole = rgbd::Camera::new([edge_px; 2], focal, principal, Distortion::None).ok()?;
    let (sin, cos) = degrees.to_radians().sin_cos();
    let eye = distance * DVec3::new(0.0, -sin, cos);
    let axes = DMat3::from_cols(DVec3::X, DVec3::new(0.0, -cos, -sin), DVec3::new(0.0, sin, -cos));
    Some((pinhole, DAffine3::from_mat3_translation(axes, eye)))
}

/// The mean colour along the rays of a pixel; `None` if one of them hits a part that is not compared.
fn seen(pinhole: &rgbd::Camera, world_from_camera: &DAffine3, [x, y]: [u32; 2], max: f64) -> Option<f64> {
    let mut sum = 0.0;
    for ray in 0..RAYS * RAYS {
        let aside = |at: u32| (f64::from(at) + 0.5) / f64::from(RAYS) - 0.5;
        let at = DVec2::new(f64::from(x) + aside(ray % RAYS), f64::from(y) + aside(ray / RAYS));
        let direction = world_from_camera.matrix3 * pinhole.ray(at)?;
        let eye = world_from_camera.translation;
        let along = -eye.z / direction.z;
        let place = (eye + along * direction).truncate();
        if along <= 0.0 || place.abs().max_element() > max {
            return None;
        }
        sum += color(place);
    }
    Some(sum / f64::from(RAYS * RAYS))
}

fn texels() -> Option<(rgbd::Camera, DAffine3, PhotoImage)> {
    let (pinhole, world_from_camera) = looking(PHOTO_PX, 0.0, 2.5)?;
    let texels = (0..PHOTO_PX * PHOTO_PX).map(|at| {
        let pixel = [at % PHOTO_PX, at / PHOTO_PX];
        let grey = seen(&pinhole, &world_from_camera, pixel, f64::INFINITY).unwrap_or(0.0);
        let grey = (255.0 * grey + 0.5) as u8;
        [grey, grey, grey, 255]
    });
    let image = PhotoImage::new([PHOTO_PX; 2], texels.collect())?;
    Some((pinhole, world_from_camera, image))
}

/// The plane, with the colours that the checker has at its points.
fn plane() -> RawCloud {
    let at = |step: usize| 2.0 * step as f32 / (POINTS - 1) as f32 - 1.0;
    let places = (0..POINTS * POINTS).map(|place| [at(place % POINTS), at(place / POINTS), 0.0]);
    let places: Vec<[f32; 3]> = places.collect();
    let grey = |place: &[f32; 3]| (255.0 * color(DVec2::new(place[0].into(), place[1].into()))) as u8;
    let colors = places.iter().map(grey).map(|grey| [grey, grey, grey, 255]);
    RawCloud {
        attributes: Attributes {
            colors: Some(colors.collect()),
            normals: Some(vec![[0.0, 0.0, 1.0]; places.len()]),
            ..Attributes::default()
        },
        ..RawCloud::from_positions(Positions::F32(places))
    }
}

/// Compares images of the checkerboard with the ground truth.
pub(super) fn measure(run: &mut Run<'_>, runner: &mut Runner, settings: &Settings) -> Result<Vec<Row>, BenchError> {
    let frame = Arc::new(Frame::from_raw(plane(), DVec3::ZERO)?);
    let look = FirstLook::of(&[&frame], DVec3::ZERO);
    let style = settings
        .resolved(&look)
        .with(|style| style.photos.clipping = PhotoClipping::Off);
    let frame = prepare(0, frame, 0.0, &Scene::needs(&style), &PrepareCounters::default());
    let multiview = MultiView {
        name: "checker",
        frame: &frame,
        origin: DVec3::ZERO,
        look: &look,
        style,
    };
    let Some((pinhole, world_from_camera, image)) = texels() else {
        return Ok(Vec::new());
    };
    let with = |texture: Texture| {
        let posed_image = PosedImage {
            name: "from above".to_owned(),
            number: 0,
            pinhole: pinhole.clone(),
            camera_from_world: world_from_camera.inverse(),
            texture,
            is_masked: false,
            gain: Vec3::ONE,
            depth: None,
        };
        frame.with_photos(Arc::new(PosedImages::new(vec![posed_image], None)))
    };
    let bare = Texture::without_levels(image.clone());
    let kinds = [
        (PhotoMode::Vdts, "mip levels", with(Texture::new(image))),
        (PhotoMode::Vdts, "none", with(bare)),
        (PhotoMode::Colored, "none", frame.clone()),
    ];
    let mut rows = Vec::new();
    for (view, degrees, distance) in VIEWS {
        let Some((pinhole, world_from_camera)) = looking(PICTURE_PX, degrees, distance) else {
            continue;
        };
        let camera = Camera::of_pinhole(&pinhole, world_from_camera, distance, UpAxis::Z);
        let truth = (0..PICTURE_PX * PICTURE_PX).map(|at| {
            seen(
                &pinhole,
                &world_from_camera,
                [at % PICTURE_PX, at / PICTURE_PX],
                COMPARED,
            )
        });
        let truth: Vec<Option<f64>> = truth.collect();
        for (mode, filter, frame) in &kinds {
            run.begin_step(format!("checker {view}: {mode}, {filter}"))?;
            let style = multiview.style.with(|style| style.photos.mode = *mode);
            let packet = multiview.packet(StyledFrame { frame, style: &style }, &camera, [0; 3], [PICTURE_PX; 2]);
            let picture = runner.image(&packet)?;
            let compared = picture.pixels().zip(&truth);
            let squares = compared.filter_map(|(pixel, truth)| Some((f64::from(pixel[1]) - 255.0 * (*truth)?).powi(2)));
            let squares: Vec<f64> = squares.collect();
            let squared = squares.iter().sum::<f64>() / squares.len().max(1) as f64;
            rows.push(row(
                FILTERED,
                &[
                    ("sequence", Cell::Text(multiview.name.to_owned())),
                    ("view", Cell::Text(view.to_owned())),
                    ("mode", Cell::Text(mode.name().to_owned())),
                    ("filter", Cell::Text((*filter).to_owned())),
                    ("points", Cell::Number(frame.frame.len() as f64)),
                    (
                        "photographs",
                        Cell::Number(frame.posed_images.as_ref().map_or(0, |of| of.all().len()) as f64),
                    ),
                    ("psnr_db", Cell::Number(psnr_db(squared))),
                ],
            ));
        }
    }
    Ok(rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ground_truth_is_a_checker_up_close_and_gray_from_afar() {
        let (pinhole, near) = looking(PHOTO_PX, 0.0, 2.5).unwrap();
        let in_square = DVec2::splat(0.5 / SQUARES);
        let pixel = pinhole
            .pixel(near.inverse().transform_point3(in_square.extend(0.0)))
            .unwrap();
        let found = seen(&pinhole, &near, [pixel.x.round() as u32, pixel.y.round() as u32], 1.0);
        assert!((found.unwrap() - color(in_square)).abs() < 1e-9);
        let (pinhole, far) = looking(PICTURE_PX, 20.0, 40.0).unwrap();
        let grey = seen(&pinhole, &far, [PICTURE_PX / 2; 2], 1.0).unwrap();
        assert!((grey - 0.5).abs() < 0.05, "{grey}");
        assert_eq!(seen(&pinhole, &far, [0; 2], 1.0), None);
    }

    #[test]
    fn the_plane_has_both_colors() {
        let colors = plane().attributes.colors.unwrap();
        assert_eq!(colors.len(), POINTS * POINTS);
        assert!(colors.iter().any(|color| color[0] < 30) && colors.iter().any(|color| color[0] > 200));
    }
}
