//! Disks that are drawn on squares of pixels: their coverage and occlusion, against rays in f64, and against disks that
//! are drawn on their surface.

use crate::common::{Surfel, camera_at, draw, draw_on_cpu, plain, sphere, surfels};
use glam::{DVec3, Vec3};
use image::RgbaImage;
use pointreel::cloud::oct_decode;
use pointreel::measure::{mean_squared_error, psnr_db};
use pointreel::render::Renderer;
use pointreel::render::cpu::CpuRenderer;
use pointreel::scene::{
    BackFaces, Kernel, LightRig, Lighting, OnOff, Primitive, ScenePacket, SplatFilter, Splatting, Style,
};

const SIZE: [u32; 2] = [64, 48];

fn on_both(packet: &ScenePacket) -> [(RgbaImage, &'static str); 2] {
    [(draw(packet), "GPU"), (draw_on_cpu(packet), "CPU")]
}

/// Hard sprites without light, from both sides.
fn hard() -> Style {
    plain().with(|style| {
        style.primitive = Primitive::Sprite;
        style.surfels.splatting = Splatting::Opaque;
        style.surfels.back_faces = BackFaces::Drawn;
    })
}

/// Intersection of the ray through a pixel with the plane of a surfel: depth, and distance from its centre, in radii.
fn meets(packet: &ScenePacket, surfel: &Surfel, x: u32, y: u32) -> Option<[f64; 2]> {
    let view = &packet.view;
    let [width, height] = packet.viewport_px.map(f64::from);
    let [right, up] = view.focal.map(f64::from);
    let ndc = [
        2.0 * (f64::from(x) + 0.5) / width - 1.0,
        1.0 - 2.0 * (f64::from(y) + 0.5) / height,
    ];
    let rotation = view.view_from_frame_rotation.as_dmat3();
    let ray = rotation.inverse() * DVec3::new(ndc[0] / right, ndc[1] / up, -1.0);
    let eye = view.eye_high.as_dvec3() + view.eye_low.as_dvec3();
    let center = surfel.position.as_dvec3() - eye;
    let normal = oct_decode(pointreel::cloud::oct_encode(surfel.normal)).as_dvec3();
    let depth = normal.dot(center) / normal.dot(ray);
    let aside = (ray * depth - center).length() / f64::from(surfel.radius);
    (depth >= f64::from(view.near)).then_some([depth, aside])
}

/// Numbers from 0 to 1 that look random.
fn noise(seed: u32) -> f32 {
    let mixed = seed.wrapping_mul(0x9e37_79b9) ^ (seed.wrapping_mul(0x85eb_ca6b) >> 13);
    (mixed.wrapping_mul(0xc2b2_ae35) >> 8) as f32 / (1u32 << 24) as f32
}

/// Large and small, from the front to almost edge-on, some around the eye, behind it, or across the near plane.
fn some_surfel(seed: u32) -> Surfel {
    let number = |index: u32| noise(31 * seed + index);
    let direction = Vec3::new(number(0) - 0.5, number(1) - 0.5, number(2) - 0.5).normalize();
    Surfel {
        position: Vec3::new(4.0 * number(3) - 2.0, 3.0 * number(4) - 1.5, 6.0 * number(5) - 2.5),
        normal: direction,
        radius: 0.02 * (100.0f32).powf(number(6)),
        color: [255; 3],
    }
}

#[test]
fn a_sprite_covers_the_pixels_whose_rays_hit_its_disk() {
    let camera = camera_at(3.0);
    let (mut covered, mut around_eye) = (0, 0);
    for seed in 0..150 {
        let surfel = some_surfel(seed);
        let packet = surfels(&[surfel], &camera, hard(), SIZE);
        around_eye += u32::from((surfel.position - 3.0 * Vec3::Z).length() < surfel.radius);
        for (image, by) in on_both(&packet) {
            for (x, y, pixel) in image.enumerate_pixels() {
                let is_drawn = pixel.0[0] != 0;
                covered += u32::from(is_drawn);
                match meets(&packet, &surfel, x, y) {
                    // Within the rounding error of the edge, or of the near plane, it may be either.
                    Some([depth, aside])
                        if (aside - 1.0).abs() < 2e-3 || depth < 1.001 * f64::from(packet.view.near) => {}
                    Some([_, aside]) => {
                        assert_eq!(is_drawn, aside < 1.0, "{by}: surfel {seed}, ({x}, {y}), {aside} radii");
                    }
                    None => assert!(!is_drawn, "{by}: surfel {seed}, ({x}, {y}) is behind the eye"),
                }
            }
        }
    }
    assert!(covered > 5_000 && around_eye > 0, "{covered}, {around_eye}");
}

#[test]
fn intersecting_disks_show_the_nearer_one_per_pixel() {
    let mut seen = [0; 2];
    for seed in 0..60 {
        let colored = |seed: u32, color| Surfel {
            position: 0.2 * some_surfel(seed).position,
            radius: 0.8 + noise(seed),
            color,
            ..some_surfel(seed)
        };
        let pair = [colored(2 * seed, [255, 0, 0]), colored(2 * seed + 1, [0, 255, 0])];
        let packet = surfels(&pair, &camera_at(3.0), hard(), SIZE);
        for (image, by) in on_both(&packet) {
            for (x, y, pixel) in image.enumerate_pixels() {
                let met = pair.map(|surfel| meets(&packet, &surfel, x, y));
                let is_unsure = |met: &Option<[f64; 2]>| met.is_some_and(|[_, aside]| (aside - 1.0).abs() < 2e-3);
                let depths = met.map(|met| {
                    met.filter(|[_, aside]| *aside < 1.0)
                        .map_or(f64::INFINITY, |[depth, _]| depth)
                });
                if met.iter().any(is_unsure) || (depths[0] / depths[1] - 1.0).abs() < 1e-5 {
                    continue;
                }
                let expected: &[u8] = if depths.iter().all(|depth| depth.is_infinite()) {
                    &[0, 0]
                } else if depths[0] < depths[1] {
                    seen[0] += 1;
                    &[255, 0]
                } else {
                    seen[1] += 1;
                    &[0, 255]
                };
                assert_eq!(&pixel.0[..2], expected, "{by}: pair {seed}, ({x}, {y})");
            }
        }
    }
    assert!(seen.iter().all(|&count| count > 5_000), "{seen:?}");
}

fn psnr(a: &RgbaImage, b: &RgbaImage) -> f64 {
    psnr_db(mean_squared_error(a, b).unwrap())
}

/// A sphere as sprites and as disks on its surface.
fn both_directions(style: Style) -> [ScenePacket; 2] {
    let mut camera = camera_at(1.9);
    camera.azimuth_deg = 25.0;
    [Primitive::Sprite, Primitive::Surfel]
        .map(|primitive| surfels(&sphere(3_000, 1.0), &camera, Style { primitive, ..style }, [240, 180]))
}

#[test]
fn sprites_match_the_disks_of_surfels() {
    let blending = [
        Splatting::TwoPass,
        Splatting::TwoPassEnlarged,
        Splatting::NoDepth,
        Splatting::Visibility,
    ];
    for splatting in blending.into_iter().chain([Splatting::Opaque, Splatting::Enlarged]) {
        for lighting in [
            Lighting::Unlit,
            Lighting::PerSurfel,
            Lighting::PerFragment,
            Lighting::BlinnPhong,
        ] {
            let style = plain().with(|style| {
                style.surfels.splatting = splatting;
                style.light.lighting = lighting;
            });
            let [sprites, disks] = both_directions(style).map(|packet| on_both(&packet));
            let [on_gpu, on_cpu] = [0, 1].map(|by: usize| psnr(&sprites[by].0, &disks[by].0));
            // The CPU computes disks per pixel, too; for squares on the surface it starts elsewhere.
            assert!(on_cpu > 90.0, "{splatting}, {lighting}: {on_cpu} dB");
            assert!(on_gpu > 50.0, "{splatting}, {lighting}: {on_gpu} dB");
        }
    }
    for (kernel, filter) in [(Kernel::Hat, SplatFilter::Off), (Kernel::Gaussian, SplatFilter::Ewa)] {
        let style = plain().with(|style| {
            style.surfels.kernel = kernel;
            style.surfels.filter = filter;
        });
        let [sprites, disks] = both_directions(style).map(|packet| on_both(&packet));
        for by in 0..2 {
            assert!(
                psnr(&sprites[by].0, &disks[by].0) > 50.0,
                "{kernel}, {filter}, {}",
                disks[by].1
            );
        }
    }
}

/// Corners of quads occlude in one pass; sprites have none on their surface.
#[test]
fn sprites_in_one_pass_have_no_square_artefacts() {
    let white = Surfel {
        position: Vec3::ZERO,
        normal: Vec3::new(0.3, 0.2, 1.0).normalize(),
        radius: 0.5,
        color: [255; 3],
    };
    let behind = Surfel {
        position: -0.2 * Vec3::Z,
        radius: 4.0,
        color: [255, 0, 0],
        ..white
    };
    let style = hard().with(|style| style.surfels.splatting = Splatting::Regular);
    // In the order of the cloud: near ones first.
    let packet = surfels(&[white, behind], &camera_at(1.5), style, SIZE);
    for (image, by) in on_both(&packet) {
        for (x, y, pixel) in image.enumerate_pixels() {
            let [_, aside] = meets(&packet, &white, x, y).unwrap();
            let [_, of_behind] = meets(&packet, &behind, x, y).unwrap();
            if (1.01..1.5).contains(&aside) && of_behind < 0.5 {
                assert!(pixel.0[0] > 100, "{by}: ({x}, {y}) is {pixel:?}");
            }
        }
    }
}

#[test]
fn a_sprite_has_one_vertex_on_its_disk() {
    let lit = |lighting| both_directions(plain().with(|style| style.light.lighting = lighting))[0].clone();
    for (a, b) in on_both(&lit(Lighting::PerVertex))
        .iter()
        .zip(&on_both(&lit(Lighting::PerSurfel)))
    {
        assert_eq!(a.0, b.0, "{}", a.1);
    }
}

#[test]
fn sprites_cast_and_receive_shadows_and_are_occluded() {
    let style = plain().with(|style| {
        style.light.lighting = Lighting::BlinnPhong;
        style.light.rig = LightRig::ThreePoint;
        style.light.shadows = OnOff::On;
        style.light.ao = OnOff::On;
        style.surfels.splatting = Splatting::TwoPass;
    });
    // A ball in front of a wall.
    let mut cloud = sphere(2_000, 0.4);
    for y in -20..20 {
        cloud.extend((-20..20).map(|x| Surfel {
            position: Vec3::new(0.05 * x as f32, 0.05 * y as f32, -0.6),
            normal: Vec3::Z,
            radius: 0.04,
            color: [255; 3],
        }));
    }
    let pictures = |style: Style| {
        let of = |primitive| surfels(&cloud, &camera_at(1.6), Style { primitive, ..style }, [160, 120]);
        [Primitive::Sprite, Primitive::Surfel].map(|primitive| on_both(&of(primitive)))
    };
    let [sprites, disks] = pictures(style);
    let [bare, _] = pictures(style.with(|style| style.light.shadows = OnOff::Off));
    for by in 0..2 {
        assert!(psnr(&sprites[by].0, &disks[by].0) > 45.0, "{}", disks[by].1);
        assert!(
            psnr(&sprites[by].0, &bare[by].0) < 35.0,
            "{}: nothing is in shadow",
            disks[by].1
        );
    }
}

#[test]
fn depths_match_rays() {
    let surfel = Surfel {
        position: Vec3::new(0.2, -0.1, 0.0),
        normal: Vec3::new(0.9, 0.1, 0.3).normalize(),
        radius: 1.3,
        color: [255; 3],
    };
    for splatting in [Splatting::Opaque, Splatting::TwoPass] {
        let style = hard().with(|style| style.surfels.splatting = splatting);
        let packet = surfels(&[surfel], &camera_at(3.0), style, SIZE);
        let mut renderer = CpuRenderer::new();
        renderer.prepare(&packet).unwrap();
        let depths = renderer.draw_depths().unwrap().depth;
        let mut met = 0;
        for (at, &drawn) in (0..).zip(&depths) {
            let Some([depth, aside]) = meets(&packet, &surfel, at % SIZE[0], at / SIZE[0]) else {
                continue;
            };
            if aside < 0.999 {
                met += 1;
                assert!((f64::from(drawn) / depth - 1.0).abs() < 1e-4, "{drawn} for {depth}");
            }
        }
        assert!(met > 100, "{met}");
    }
}
