//! The tone curve: its effect on images, and both renderers against each other.

use crate::common::{camera_at, draw, draw_on_cpu, sphere, surfels};
use image::RgbaImage;
use pointreel::measure::{mean_squared_error, psnr_db};
use pointreel::scene::{Antialiasing, Background, Lighting, ScenePacket, Style};

fn ball(gamma: f32, antialiasing: Antialiasing) -> ScenePacket {
    let style = Style::default().with(|style| {
        style.light.lighting = Lighting::PerFragment;
        style.light.gamma = gamma;
        style.drawing.antialiasing = antialiasing;
        style.backdrop.background = Background::solid([30, 60, 90]);
    });
    surfels(&sphere(2000, 1.0), &camera_at(2.0), style, [160, 120])
}

/// Maximum deviation of an image's channels from the curve of another one.
fn max_off(toned: &RgbaImage, plain: &RgbaImage, gamma: f32) -> u8 {
    let on_curve = |byte: u8| ((f32::from(byte) / 255.0).powf(1.0 / gamma) * 255.0).round() as u8;
    let pairs = toned.pixels().zip(plain.pixels());
    let off =
        pairs.flat_map(|(toned, plain)| [0, 1, 2].map(|channel| toned[channel].abs_diff(on_curve(plain[channel]))));
    off.max().unwrap()
}

#[test]
fn every_pixel_is_on_the_curve() {
    let plain = ball(1.0, Antialiasing::None);
    for gamma in [0.5, 2.2] {
        let toned = ball(gamma, Antialiasing::None);
        assert_eq!(max_off(&draw_on_cpu(&toned), &draw_on_cpu(&plain), gamma), 0, "{gamma}");
        let off = max_off(&draw(&toned), &draw(&plain), gamma);
        assert!(off <= 1, "{gamma}: {off}");
        assert_ne!(draw(&toned), draw(&plain));
    }
}

#[test]
fn both_renderers_tone_map_smooth_images_alike() {
    for &antialiasing in Antialiasing::ALL {
        let toned = ball(2.0, antialiasing);
        let (gpu, cpu) = (draw(&toned), draw_on_cpu(&toned));
        let psnr = psnr_db(mean_squared_error(&gpu, &cpu).unwrap());
        assert!(psnr >= 44.0, "{antialiasing}: {psnr:.1} dB");
    }
}
