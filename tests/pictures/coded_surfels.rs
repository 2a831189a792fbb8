//! Surfels drawn from the byte code of an octree: compared with exact disks, with and without offsets, with and without
//! culling.
//!
//! Images are saved in the folder that `POINTREEL_KEEP_PICTURES` names, if it names one.

#![allow(clippy::print_stdout, reason = "what was measured, for `--nocapture`")]

use crate::common::{camera_at, plain, sphere};
use crate::data::shared;
use glam::{DVec3, Vec3};
use image::RgbaImage;
use pointreel::cloud::{Frame, Positions, RawCloud};
use pointreel::levels::Lod;
use pointreel::levels::octree::StopCriterion;
use pointreel::measure::{mean_squared_error, psnr_db};
use pointreel::render::Renderer;
use pointreel::render::cpu::CpuRenderer;
use pointreel::scene::{
    BackFaces, Camera, FirstLook, Footprint, Lighting, NormalBits, OffsetBits, OnOff, RendererChoice, Scene, Splatting,
    Style,
};
use pointreel::sequence::{PrepareCounters, PreparedFrame, prepare};
use std::path::Path;
use std::sync::Arc;

fn draw(frame: &PreparedFrame, camera: &Camera, style: &Style, size: [u32; 2]) -> RgbaImage {
    let packet = Scene::default().packet(frame, DVec3::ZERO, camera, style, size);
    let mut renderer = CpuRenderer::new();
    renderer.prepare(&packet).unwrap();
    renderer.render().unwrap();
    renderer.read_image().unwrap()
}

fn keep(picture: &RgbaImage, name: &str) {
    if let Some(folder) = std::env::var_os("POINTREEL_KEEP_PICTURES") {
        picture.save(Path::new(&folder).join(format!("{name}.png"))).unwrap();
    }
}

fn prepared(raw: RawCloud, style: &Style) -> PreparedFrame {
    let frame = Frame::from_raw(raw, DVec3::ZERO).unwrap();
    let needs = Scene::needs(style);
    prepare(0, Arc::new(frame), 0.0, &needs, &PrepareCounters::default())
}

/// A closed sphere of radius 1 in colours that change along it, or white.
fn ball(count: u32, radius: f32, is_white: bool, style: &Style) -> PreparedFrame {
    let surfels = sphere(count, 1.0);
    let positions = surfels.iter().map(|surfel| surfel.position.to_array());
    let mut raw = RawCloud::from_positions(Positions::F32(positions.collect()));
    let color = |normal: Vec3| {
        let [red, green, blue] = (normal * 100.0 + 128.0).to_array().map(|value| value as u8);
        if is_white { [255; 4] } else { [red, green, blue, 255] }
    };
    raw.attributes.colors = Some(surfels.iter().map(|surfel| color(surfel.normal)).collect());
    raw.attributes.normals = Some(surfels.iter().map(|surfel| surfel.normal.to_array()).collect());
    raw.attributes.radii = Some(vec![radius; surfels.len()]);
    prepared(raw, style)
}

/// By the CPU, from the byte code.
fn coded() -> Style {
    plain().with(|style| {
        // Pure white would not be recognised as colours.
        style.colors = pointreel::sequence::ColorSource::File.into();
        style.levels.lod = Lod::ThresholdPx(0.0);
        style.codes.footprint = Footprint::Masks;
        style.drawing.renderer = RendererChoice::Cpu;
    })
}

fn exact(style: &Style) -> Style {
    style.with(|style| style.codes.footprint = Footprint::Disks)
}

fn psnr(a: &RgbaImage, b: &RgbaImage) -> f64 {
    psnr_db(mean_squared_error(a, b).unwrap())
}

const SIZE: [u32; 2] = [480, 480];

/// Pixels that are mostly background although their ray meets a sphere of radius 1 around the origin, smaller by a
/// margin.
fn gaps(picture: &RgbaImage, camera: &Camera, margin: f64) -> usize {
    let radius = 1.0 - margin;
    let largest_slope = radius / (camera.distance * camera.distance - radius * radius).sqrt();
    let px_per_slope = 0.5 * f64::from(SIZE[1]) / (0.5 * camera.fov_deg).to_radians().tan();
    let center = SIZE.map(|edge| 0.5 * f64::from(edge));
    let is_gap = |&(x, y, pixel): &(u32, u32, &image::Rgba<u8>)| {
        let right = f64::from(x) + 0.5 - center[0];
        let down = f64::from(y) + 0.5 - center[1];
        right.hypot(down) < largest_slope * px_per_slope && pixel.0[0] < 128
    };
    picture.enumerate_pixels().filter(is_gap).count()
}

/// Directions from which a ball is seen: along axes, where terraces of cells are widest at its outline, and across
/// them.
const VIEWS_DEG: [[f64; 2]; 5] = [[0.0, 0.0], [90.0, 0.0], [0.0, 90.0], [45.0, 0.0], [30.0, 35.0]];

fn ball_camera([azimuth_deg, elevation_deg]: [f64; 2], distance: f64) -> Camera {
    Camera {
        azimuth_deg,
        elevation_deg,
        fov_deg: 80.0,
        ..camera_at(distance)
    }
}

/// Botsch et al. 2002, Figs. 8 and 9: tangential splats at the centres of coarse cells leave gaps where the surface is
/// seen at a grazing angle; moved along their normals they leave none.
#[test]
fn offsets_close_the_gaps_of_quantised_positions() {
    let style = coded().with(|style| {
        // Without enlargement in the second pass and without the fill behind soft edges, which hide gaps. Scaled, radii
        // are about a cell edge, as in the paper.
        style.surfels.splatting = Splatting::TwoPass;
        style.surfels.rims = OnOff::Off;
        style.surfels.splat_scale = 1.4;
        style.levels.stop = StopCriterion::Depth(6);
        style.codes.normal_bits = NormalBits::Thirteen;
    });
    let frame = ball(200_000, 0.01, true, &style);
    let edge = f64::from(frame.levels.octree().unwrap().cube().cell_edge(6));
    for view in VIEWS_DEG {
        let camera = ball_camera(view, 1.6);
        let count = |offset_bits: OffsetBits| {
            let style = style.with(|style| style.codes.offset_bits = offset_bits);
            let picture = draw(&frame, &camera, &style, SIZE);
            keep(&picture, &format!("ball_{}_{}_{offset_bits}_bits", view[0], view[1]));
            gaps(&picture, &camera, 0.5 * edge)
        };
        let [without, two, three] = [OffsetBits::None, OffsetBits::Two, OffsetBits::Three].map(count);
        println!("{view:?}: {without}, {two} and {three} gaps with 0, 2 and 3 bits");
        assert!(without > 400, "{view:?}: {without} gaps without offsets");
        assert!(
            10 * two < without,
            "{view:?}: {two} gaps with 2 bits, {without} without"
        );
        assert_eq!(three, 0, "{view:?}");
        // Enlarged, splats of the attribute pass cover the remaining gaps.
        let enlarged = style.with(|style| {
            style.surfels.splatting = Splatting::TwoPassEnlarged;
            style.surfels.splat_scale = 1.0;
        });
        let picture = draw(&frame, &camera, &enlarged, SIZE);
        assert_eq!(gaps(&picture, &camera, 0.5 * edge), 0, "{view:?}, enlarged");
    }
}

/// Minimum decibels of masks compared with exact disks, unlit or lit, of a ball from far (cells of a pixel), as large
/// as the image, and from near, where most are drawn as exact disks. The loss is mostly at the outline, where a splat
/// ends in another pixel.
const BALL_DB: [(f64, f64, f64); 3] = [(8.0, 34.0, 43.0), (2.4, 26.0, 35.5), (1.3, 52.0, 48.0)];

#[test]
fn masks_are_close_to_exact_disks_on_a_sphere() {
    for count in [5000, 40_000] {
        let frame = ball(count, 1.3 * (4.0 / count as f32).sqrt(), false, &coded());
        for &normal_bits in NormalBits::ALL {
            for (distance, unlit_db, lit_db) in BALL_DB {
                let camera = Camera {
                    azimuth_deg: 25.0,
                    elevation_deg: 17.0,
                    fov_deg: 60.0,
                    ..camera_at(distance)
                };
                for (lighting, min_db) in [(Lighting::Unlit, unlit_db), (Lighting::PerFragment, lit_db)] {
                    let style = coded().with(|style| {
                        style.codes.normal_bits = normal_bits;
                        style.light.lighting = lighting;
                    });
                    let masks = draw(&frame, &camera, &style, SIZE);
                    let disks = draw(&frame, &camera, &exact(&style), SIZE);
                    let found_db = psnr(&masks, &disks);
                    let what = format!("{count} from {distance}, light {lighting}, {normal_bits} bits");
                    println!("{what}: {found_db:.1} dB");
                    assert!(found_db >= min_db, "{what}: {found_db:.1} dB");
                }
            }
        }
    }
}

/// Minimum decibels of masks compared with exact disks on real frames, unlit (a white body on black differs along its
/// whole outline, as the ball does) and lit, from far, as large as the image, and near by, where splats of an outline
/// are tens of pixels and reach over it by the offset of positions.
const REAL_DB: [(&str, f64, f64, f64); 3] = [
    ("far", 4.0, 33.0, 33.0),
    ("full", 1.0, 26.0, 28.0),
    ("near", 0.3, 19.5, 22.0),
];

#[test]
fn masks_are_close_to_exact_disks_on_real_frames() {
    let demo = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/demo");
    let man = shared("sequences/cesiumman_24fps");
    for folder in [demo].into_iter().chain(man) {
        let files = std::fs::read_dir(&folder).unwrap();
        let mut files: Vec<_> = files.map(|file| file.unwrap().path()).collect();
        files.retain(|path| path.extension().is_some_and(|extension| extension == "ply"));
        files.sort();
        let raw = pointreel::io::read(&files[0]).unwrap();
        let style = coded().with(|style| style.levels.lod = Lod::default());
        let frame = prepared(raw, &style);
        let code = frame.levels.codes().unwrap();
        println!(
            "{}: depth {}, {:.2?}",
            folder.display(),
            code.depth(),
            code.bits_per_leaf()
        );
        let name = folder.file_name().unwrap().to_str().unwrap();
        for (place, zoom, unlit_db, lit_db) in REAL_DB {
            let up = FirstLook::of(&[&frame.frame], DVec3::ZERO).up;
            let mut camera = Camera::framing(&frame.frame.bounds(), DVec3::ZERO, up);
            camera.zoom(zoom);
            for lighting in [Lighting::PerFragment, Lighting::PerSurfel, Lighting::Unlit] {
                let style = style.with(|style| style.light.lighting = lighting);
                let size = [960, 720];
                let masks = draw(&frame, &camera, &style, size);
                let disks = draw(&frame, &camera, &exact(&style), size);
                keep(&masks, &format!("{name}_{place}_{lighting}_masks"));
                keep(&disks, &format!("{name}_{place}_{lighting}_disks"));
                let found_db = psnr(&masks, &disks);
                println!("{name}, {place}, light {lighting}: {found_db:.1} dB");
                let min_db = if lighting == Lighting::Unlit { unlit_db } else { lit_db };
                // When lighting is computed per normal, the light direction differs.
                let is_same_light = lighting != Lighting::PerSurfel;
                assert!(
                    !is_same_light || found_db >= min_db,
                    "{name}, {place}: {found_db:.1} dB"
                );
            }
        }
    }
}

#[test]
fn images_do_not_depend_on_thread_count() {
    let frame = ball(20_000, 0.02, false, &coded());
    let camera = camera_at(1.7);
    for footprint in [Footprint::Masks, Footprint::Pixels] {
        let style = coded().with(|style| {
            style.codes.footprint = footprint;
            style.light.lighting = Lighting::PerFragment;
        });
        let expected = draw(&frame, &camera, &style, SIZE);
        for threads in [1, 3] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            assert!(pool.install(|| draw(&frame, &camera, &style, SIZE)) == expected);
        }
    }
}

/// Where a closed shape is opaque and not at its outline, its back is hidden by its front, whether it is culled or not.
#[test]
fn culling_changes_no_pixel_of_a_closed_shape() {
    let frame = ball(40_000, 0.013, false, &coded());
    for (footprint, distance) in [
        (Footprint::Masks, 2.2),
        (Footprint::Masks, 1.2),
        (Footprint::Pixels, 9.0),
    ] {
        let camera = Camera {
            azimuth_deg: 25.0,
            elevation_deg: 17.0,
            ..camera_at(distance)
        };
        let culled = coded().with(|style| style.codes.footprint = footprint);
        let not_culled = culled.with(|style| style.surfels.back_faces = BackFaces::Drawn);
        let a = draw(&frame, &camera, &culled, SIZE);
        let b = draw(&frame, &camera, &not_culled, SIZE);
        // At the outline, surfaces just behind it are within ε of it.
        let differs = a.enumerate_pixels().zip(b.pixels()).filter(|((x, y, a), b)| {
            let [right, down] = [(x, 0), (y, 1)].map(|(px, axis)| f64::from(*px) + 0.5 - 0.5 * f64::from(SIZE[axis]));
            let outline = 0.96 / (distance * distance - 0.96 * 0.96).sqrt() * 0.5 * f64::from(SIZE[1]);
            right.hypot(down) < outline && a != b
        });
        let count = differs.count();
        assert_eq!(count, 0, "{footprint} {distance}");
    }
}
