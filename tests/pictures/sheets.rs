//! Two sheets of surfels, one behind the other.

use crate::common::{camera_at, draw, draw_on_cpu, plain};
use glam::DVec3;
use pointreel::cloud::{Frame, Positions, RawCloud};
use pointreel::scene::{
    BackFaces, Camera, Scene, ScenePacket, SplatFilter, SplatGeometry, Splatting, Style, VisibilityShape,
};
use pointreel::sequence::{PrepareCounters, prepare};
use std::sync::Arc;

const SIZE: [u32; 2] = [64, 64];

const RADIUS: f32 = 0.12;

/// Two sheets of 40×40 disks that overlap: red in front, green `gap` behind it, from where `camera_at` is.
fn sheets(gap: f32, camera: &Camera, change: impl Fn(&mut Style)) -> ScenePacket {
    let (mut positions, mut colors) = (Vec::new(), Vec::new());
    for (z, color) in [(0.5 * gap, [255, 0, 0, 255]), (-0.5 * gap, [0, 255, 0, 255])] {
        for index in 0..1600u16 {
            let [x, y] = [index % 40, index / 40].map(|step| f32::from(step) / 20.0 - 0.975);
            positions.push([x, y, z]);
            colors.push(color);
        }
    }
    let radii = vec![RADIUS; positions.len()];
    facing(positions, colors, radii, camera, change)
}

/// Disks that face +z.
fn facing(
    positions: Vec<[f32; 3]>,
    colors: Vec<[u8; 4]>,
    radii: Vec<f32>,
    camera: &Camera,
    change: impl Fn(&mut Style),
) -> ScenePacket {
    let mut cloud = RawCloud::from_positions(Positions::F32(positions));
    cloud.attributes.normals = Some(vec![[0.0, 0.0, 1.0]; radii.len()]);
    cloud.attributes.radii = Some(radii);
    cloud.attributes.colors = Some(colors);
    let style = plain().with(|style| {
        style.surfels.splatting = Splatting::TwoPass;
        style.surfels.back_faces = BackFaces::Drawn;
        change(style);
    });
    let frame = Arc::new(Frame::from_raw(cloud, DVec3::ZERO).unwrap());
    let frame = prepare(0, frame, 0.0, &Scene::needs(&style), &PrepareCounters::default());
    Scene::default().packet(&frame, DVec3::ZERO, camera, &style, SIZE)
}

#[test]
fn the_near_sheet_hides_the_far_one_from_both_sides() {
    for (azimuth_deg, [near, far]) in [(0.0, [0, 1]), (180.0, [1, 0]), (160.0, [1, 0])] {
        let camera = Camera {
            azimuth_deg,
            ..camera_at(1.2)
        };
        // How much of the far sheet shows at the centre of the image, and the minimum of the near one.
        let shown = |splatting: Splatting| {
            let packet = sheets(0.2, &camera, |style| style.surfels.splatting = splatting);
            [draw(&packet), draw_on_cpu(&packet)].map(|image| {
                let middle = (24..40).flat_map(|y| (24..40).map(move |x| (x, y)));
                let pixels: Vec<[u8; 4]> = middle.map(|(x, y)| image.get_pixel(x, y).0).collect();
                let most = pixels.iter().map(|pixel| pixel[far]).max().unwrap();
                let least = pixels.iter().map(|pixel| pixel[near]).min().unwrap();
                (most, least)
            })
        };
        for (most_far, least_near) in shown(Splatting::Sorted) {
            assert!(
                most_far <= 8 && least_near >= 247,
                "{azimuth_deg}°: {most_far} {least_near}"
            );
        }
    }
    // In the order of the octree, the far sheet is drawn over the near one from one side or the other.
    let worst = [0.0, 180.0].map(|azimuth_deg| {
        let camera = Camera {
            azimuth_deg,
            ..camera_at(1.2)
        };
        let packet = sheets(0.2, &camera, |style| style.surfels.splatting = Splatting::NoDepth);
        let image = draw_on_cpu(&packet);
        let far = usize::from(azimuth_deg == 0.0);
        image.pixels().map(|pixel| pixel[far]).max().unwrap()
    });
    assert!(worst.into_iter().max() > Some(128), "{worst:?}");
}

#[test]
fn sheets_within_the_depth_offset_are_blended() {
    // Half a radius apart: one surface by default, half of it the far sheet.
    for (depth_offset, far) in [(1.0, 128), (0.4, 0), (0.0, 0)] {
        let packet = sheets(0.5 * RADIUS, &camera_at(1.2), |style| {
            style.surfels.depth_offset = depth_offset;
        });
        for image in [draw(&packet), draw_on_cpu(&packet)] {
            let found = image.get_pixel(32, 32).0[1];
            assert!(found.abs_diff(far) <= 12, "{found} for {far} at {depth_offset} radii");
        }
    }
}

/// The 4D media paper, Fig. 3e: corners of squares hide what is behind them, although they are not drawn.
#[test]
fn corners_of_squares_hide_what_is_behind_them_on_request() {
    // A red disk, and a green one that fills the image farther behind than the depth offset.
    let (positions, radii) = (vec![[0.0, 0.0, 0.5], [0.0, 0.0, -0.5]], vec![0.5, 8.0]);
    let colors = vec![[255, 0, 0, 255], [0, 255, 0, 255]];
    // Pixels of the background for each pixel of the red disk.
    let hidden = |change: &dyn Fn(&mut Style)| {
        let packet = facing(
            positions.clone(),
            colors.clone(),
            radii.clone(),
            &camera_at(1.2),
            change,
        );
        [draw(&packet), draw_on_cpu(&packet)].map(|image| {
            let count = |is_it: fn([u8; 4]) -> bool| image.pixels().filter(|pixel| is_it(pixel.0)).count() as f64;
            // The rim of a lone splat fades to a fifth of its colour.
            let red = count(|[red, ..]| red > 32);
            assert!(red > 1000.0, "{red}");
            count(|[red, green, ..]| red.max(green) <= 32) / red
        })
    };
    let of_square = (4.0 - std::f64::consts::PI) / std::f64::consts::PI;
    for (shape, expected) in [(VisibilityShape::Disk, 0.0), (VisibilityShape::Square, of_square)] {
        for geometry in [SplatGeometry::Quad, SplatGeometry::Triangle] {
            for found in hidden(&|style| (style.surfels.visibility_shape, style.surfels.geometry) = (shape, geometry)) {
                assert!(
                    (found - expected).abs() <= 0.02,
                    "{shape:?}, {geometry:?}: {found}, not {expected}"
                );
            }
        }
        // Sprites have no square in their plane.
        for found in hidden(&|style| {
            style.surfels.visibility_shape = shape;
            style.surfels.filter = SplatFilter::Clamp;
        }) {
            assert_eq!(found, 0.0, "{shape:?}");
        }
    }
}
