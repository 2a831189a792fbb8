//! Synthetic input images of clouds that have none: renderings of all their points.
//!
//! That is the experiment of Yang et al. 2006 (§6, Table 2): a dense cloud shown by a few thousand points with
//! view-dependent texturing.

use super::backgrounds::is_covered;
use super::multiview::{MultiView, StyledFrame};
use crate::bench::BenchError;
use crate::bench::run::{COVERAGE_BACKGROUNDS, Run};
use crate::bench::runner::Runner;
use crate::bench::scenario;
use crate::photos::{PhotoImage, PosedImage, PosedImages, Texture};
use crate::render::Renderer as _;
use crate::render::cpu::CpuRenderer;
use crate::rgbd::{self, DepthImage, Distortion};
use crate::scene::{Camera, FirstLook};
use glam::{DAffine3, DMat3, DVec2, DVec3, Vec3};

/// Number of generated images, and their width and height. Without every eighth there are 50, the number and size of
/// the paper's images of the Buddha.
const COUNT: usize = 58;
const EDGE_PX: u32 = 512;

/// Cotangent of half the field of view.
const FOCAL: f64 = 2.5;

/// Renders images of all points of a cloud from around it, with the depths of all points; `None` where it has no
/// centre.
pub(super) fn make(
    run: &mut Run<'_>,
    runner: &mut Runner,
    multiview: &MultiView<'_>,
) -> Result<Option<PosedImages>, BenchError> {
    let look = multiview.look;
    let edge = f64::from(EDGE_PX);
    let focal = DVec2::splat(0.5 * FOCAL * edge);
    let Ok(pinhole) = rgbd::Camera::new([EDGE_PX; 2], focal, DVec2::splat(0.5 * edge - 0.5), Distortion::None) else {
        return Ok(None);
    };
    let center = multiview.origin + look.trimmed.center().as_dvec3();
    let distance = 1.1 * FOCAL.hypot(1.0) * f64::from(look.trimmed.radius()).max(f64::MIN_POSITIVE.sqrt());
    let mut depths = CpuRenderer::new();
    let mut posed_images = Vec::new();
    for (number, (azimuth_deg, elevation_deg)) in scenario::directions(COUNT).enumerate() {
        run.check_cancelled()?;
        let camera_from_world = pose(look, center, distance, [azimuth_deg, elevation_deg]);
        let camera = Camera::of_pinhole(&pinhole, camera_from_world.inverse(), distance, look.up);
        let drawn = StyledFrame {
            frame: multiview.frame,
            style: &multiview.style,
        };
        let packets = COVERAGE_BACKGROUNDS.map(|background| multiview.packet(drawn, &camera, background, [EDGE_PX; 2]));
        let pictures = [runner.image(&packets[0])?, runner.image(&packets[1])?];
        depths.prepare(&packets[0])?;
        let depth = depths.draw_depths()?;
        // Next to the object, the images see the far distance.
        let far = (distance + 2.0 * f64::from(look.trimmed.radius())) as f32;
        let depth = depth
            .depth
            .iter()
            .map(|&depth| if depth.is_finite() { depth } else { far });
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
        posed_images.push(PosedImage {
            name: format!("made {number:02}"),
            number,
            pinhole: pinhole.clone(),
            camera_from_world,
            texture: Texture::new(image),
            is_masked: true,
            gain: Vec3::ONE,
            depth: DepthImage::new([EDGE_PX; 2], depth.collect()),
        });
    }
    // Directions are evenly distributed over the sphere.
    let angle = (4.0 * std::f64::consts::PI / COUNT as f64).sqrt();
    Ok(Some(PosedImages::new(posed_images, Some(angle))))
}

/// Returns the images without their depths: depths of the surface they are projected onto are then drawn.
pub(super) fn without_depths(posed_images: &PosedImages) -> PosedImages {
    let photos_without = posed_images.all().iter().map(|posed_image| PosedImage {
        name: posed_image.name.clone(),
        pinhole: posed_image.pinhole.clone(),
        texture: posed_image.texture.clone(),
        depth: None,
        ..**posed_image
    });
    let angle = f64::from(posed_images.neighbour_angle());
    PosedImages::new(photos_without.collect(), Some(angle))
}

/// Returns the pose of a camera that looks at `center`.
fn pose(look: &FirstLook, center: DVec3, distance: f64, [azimuth_deg, elevation_deg]: [f64; 2]) -> DAffine3 {
    let mut camera = Camera::framing(&look.trimmed, DVec3::ZERO, look.up);
    camera.azimuth_deg = azimuth_deg;
    camera.elevation_deg = elevation_deg;
    // From right, up, backward to right, down, forward.
    let flip = DMat3::from_diagonal(DVec3::new(1.0, -1.0, -1.0));
    let rotation = flip * camera.view_from_world_rotation();
    let eye = center - distance * rotation.row(2);
    DAffine3::from_mat3_translation(rotation, -(rotation * eye))
}
