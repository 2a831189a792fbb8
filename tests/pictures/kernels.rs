//! The weight of a splat at a distance from its centre is its kernel's value.

use crate::common::{Surfel, camera_at, draw, plain, surfels};
use glam::Vec3;
use pointreel::render::Renderer;
use pointreel::render::cpu::CpuRenderer;
use pointreel::scene::{Kernel, Splatting};

#[test]
fn a_lone_splat_falls_off_as_its_kernel_does() {
    // Its radius is 40 of 101 pixels.
    let surfel = Surfel {
        position: Vec3::ZERO,
        normal: Vec3::Z,
        radius: 80.0 / 101.0,
        color: [255; 3],
    };
    for &kernel in Kernel::ALL {
        let style = plain().with(|style| {
            // Without accumulation the mask is the opacity.
            style.surfels.splatting = Splatting::NoDepth;
            style.surfels.kernel = kernel;
        });
        let packet = surfels(&[surfel], &camera_at(1.0), style, [101; 2]);
        let mut processor = CpuRenderer::new();
        processor.prepare(&packet).unwrap();
        processor.render().unwrap();
        for image in [processor.read_image().unwrap(), draw(&packet)] {
            for aside_px in [0, 10, 20, 30, 39, 42] {
                let share = f64::from(aside_px) / 40.0;
                let expected = match kernel {
                    _ if share > 1.0 => 0.0,
                    Kernel::Gaussian => (-3.0 * share * share).exp(),
                    Kernel::Hat => 1.0 - share,
                    Kernel::Flat => 1.0,
                };
                let found = f64::from(image.get_pixel(50 + aside_px, 50).0[1]);
                assert!((found - 255.0 * expected).abs() <= 1.0, "{kernel} at {share}: {found}");
            }
        }
    }
}
