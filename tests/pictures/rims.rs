//! Edges of splats in front of others: the splats behind them show through, and not the background.

use crate::common::{Surfel, camera_at, draw, draw_on_cpu, plain, surfels};
use glam::Vec3;
use image::RgbaImage;
use pointreel::measure::{mean_squared_error, psnr_db};
use pointreel::scene::{Background, EyeDome, LightRig, Lighting, Primitive, ScenePacket, Style, halo_px};

const EDGE_PX: u32 = 200;

/// Changes to the settings of [`style`].
type Change = fn(&mut Style);

/// Neither has anything of blue.
const RED: [u8; 3] = [220, 30, 0];
const GREEN: [u8; 3] = [40, 200, 0];

/// A red square before a green wall, which is wider than the image unless it `ends`.
fn square_before_wall(style: &Style, ends: bool) -> ScenePacket {
    let square = |half_edge: f32, z: f32, color: [u8; 3]| {
        let steps = (half_edge / 0.05) as i32;
        let places = move |row: i32| (-steps..=steps).map(move |column| Vec3::new(column as f32, row as f32, 0.0));
        (-steps..=steps).flat_map(places).map(move |place| Surfel {
            position: 0.05 * place + Vec3::new(0.013, 0.021, z),
            normal: Vec3::Z,
            radius: 0.06,
            color,
        })
    };
    let wall = square(if ends { 2.4 } else { 3.4 }, -1.0, GREEN);
    let all: Vec<Surfel> = wall.chain(square(0.5, 0.5, RED)).collect();
    surfels(&all, &camera_at(2.0), *style, [EDGE_PX; 2])
}

fn style() -> Style {
    plain().with(|style| {
        style.primitive = Primitive::Surfel;
        style.backdrop.background = Background::solid([0, 0, 255]);
    })
}

fn max_blue(picture: &RgbaImage) -> u8 {
    picture.pixels().map(|pixel| pixel.0[2]).max().unwrap()
}

#[test]
fn no_background_is_between_two_surfaces() {
    let ways: [(&str, Change); 5] = [
        ("usual", |_| ()),
        ("sprites", |style| style.primitive = Primitive::Sprite),
        ("eye-dome", |style| style.light.eye_dome = EyeDome::On),
        ("matt", |style| {
            style.light.lighting = Lighting::Lambert;
            style.light.rig = LightRig::None;
        }),
        ("grid", |style| style.backdrop.grid = true),
    ];
    for (name, change) in ways {
        let packet = square_before_wall(&style().with(change), false);
        for picture in [draw_on_cpu(&packet), draw(&packet)] {
            // The wall has no edge within the image.
            assert!(max_blue(&picture) <= 2, "{name}: {}", max_blue(&picture));
        }
    }
}

#[test]
fn both_renderers_agree_and_outlines_against_the_background_are_smooth() {
    let packet = square_before_wall(&style(), true);
    let [cpu, gpu] = [draw_on_cpu(&packet), draw(&packet)];
    let psnr = psnr_db(mean_squared_error(&cpu, &gpu).unwrap());
    assert!(psnr > 50.0, "{psnr:.1} dB");
    let is_mixed = |pixel: &image::Rgba<u8>| (20..235).contains(&pixel.0[2]);
    let mixed = cpu.enumerate_pixels().filter(|(_, _, pixel)| is_mixed(pixel));
    // All around the wall, which is 160 pixels wide, and nowhere around the square.
    let (mut outer, mut inner) = (0, 0);
    for (x, y, _) in mixed {
        let from_center = [x, y].map(|edge| (edge as i32 - EDGE_PX as i32 / 2).abs());
        let is_outer = from_center[0].max(from_center[1]) > 60;
        *(if is_outer { &mut outer } else { &mut inner }) += 1;
    }
    assert!(outer > 300 && inner == 0, "{outer}, {inner}");
}

#[test]
fn image_tiles_include_the_surroundings_they_need() {
    let packet = square_before_wall(&style(), true);
    assert_eq!(halo_px(&packet), EDGE_PX / 50);
    let one_pass = style().with(|style| style.surfels.splatting = pointreel::scene::Splatting::Opaque);
    assert_eq!(halo_px(&square_before_wall(&one_pass, true)), 0);
}
