//! Two sheets of surfels, one behind the other.

use crate::common::{camera_at, draw, draw_on_cpu, plain};
use glam::DVec3;
use pointreel::cloud::{Frame, Positions, RawCloud};
use pointreel::scene::{BackFaces, Camera, Scene, ScenePacket, Splatting, Style};
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
    let mut cloud = RawCloud::from_positions(Positions::F32(positions));
    cloud.attributes.normals = Some(vec![[0.0, 0.0, 1.0]; 3200]);
    cloud.attributes.radii = Some(vec![RADIUS; 3200]);
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
