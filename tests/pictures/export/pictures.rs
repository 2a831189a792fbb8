//! Tiles of an image compared with the whole, and alpha.

use super::{headless, near_by, style};
use crate::common;
use image::RgbaImage;
use pointreel::export::{
    ExportError, MAX_EDGE_PX, Picture, PictureSize, draw_picture, write_picture, write_picture_observed,
};
use pointreel::levels::Lod;
use pointreel::measure::{mean_squared_error, psnr_db};
use pointreel::progress::Progress;
use pointreel::render::AnyRenderer;
use pointreel::scene::{
    Antialiasing, Background, EyeDome, Footprint, Lighting, OnOff, PointStyle, Primitive, Splatting, Strategy, Style,
};
use std::sync::{Arc, Mutex};

const SIZE_PX: [u32; 2] = [300, 220];

/// Difference of an image drawn in tiles from one drawn whole: in dB, and as the number of visibly different pixels.
fn parts_beside_whole(renderer: AnyRenderer, style: &Style) -> (f64, usize) {
    let mut headless = headless(renderer);
    let (frame, camera) = near_by(&headless, style);
    let mut draw = |part_edge_px: Option<u32>| {
        let size = PictureSize {
            part_edge_px,
            ..PictureSize::opaque(SIZE_PX)
        };
        draw_picture(
            &mut headless,
            &Picture {
                frame: &frame,
                camera: &camera,
                style,
                size,
            },
        )
        .unwrap()
    };
    // Divides neither the image edges nor the tiles of the software renderer.
    let (whole, parts) = (draw(None), draw(Some(77)));
    let background = style.backdrop.background.top;
    assert!(common::covered(&whole, background) > 60_000, "the gradient");
    let others = whole
        .pixels()
        .zip(parts.pixels())
        .filter(|(a, b)| (0..3).any(|channel| a.0[channel].abs_diff(b.0[channel]) > 3));
    let db = psnr_db(mean_squared_error(&whole, &parts).unwrap());
    (db, others.count())
}

/// Positions within a tile are rounded differently. Where squares end abruptly, as in the mode `regular`, a pixel whose
/// centre is on a border may be inside in one image and outside in the other: 4 of 66,000 are. A node that is drawn as
/// one pixel may be drawn as its neighbour.
const MAX_BORDER_PIXELS: usize = 10;

/// Asserts that the parts have no visible difference, but for pixels on borders.
fn assert_same(renderer: AnyRenderer, style: &Style) {
    let (db, others) = parts_beside_whole(renderer, style);
    let has_borders = style.surfels.splatting == Splatting::Regular || style.codes.footprint == Footprint::Pixels;
    let is_near = db >= 60.0 || (has_borders && others <= MAX_BORDER_PIXELS);
    assert!(is_near, "{db} dB, {others} pixels: {style:?}");
}

fn ways() -> Vec<Style> {
    let mut ways = vec![
        Style {
            primitive: Primitive::Voxel,
            ..style()
        },
        Style {
            primitive: Primitive::Point,
            points: PointStyle {
                size_px: 5.0,
                ..PointStyle::default()
            },
            ..style()
        },
        style().with(|style| {
            style.levels.surfel_lod = true;
            style.levels.lod = Lod::Budget(900);
        }),
    ];
    ways.extend(
        Splatting::ALL
            .iter()
            .map(|&splatting| style().with(|style| style.surfels.splatting = splatting)),
    );
    // In parts, effects need pixels beyond their borders, and lines continue.
    ways.extend([Primitive::Surfel, Primitive::Voxel].map(|primitive| {
        style().with(|style| {
            style.primitive = primitive;
            style.light.eye_dome = EyeDome::On;
            style.backdrop.grid = true;
        })
    }));
    ways.push(style().with(|style| {
        style.light.lighting = Lighting::Lambert;
        style.light.ao = OnOff::On;
    }));
    ways.extend([Antialiasing::Fxaa, Antialiasing::Supersample].map(|antialiasing| {
        style().with(|style| {
            style.drawing.antialiasing = antialiasing;
            style.light.eye_dome = EyeDome::On;
        })
    }));
    ways
}

#[test]
fn the_cpu_draws_the_same_image_in_tiles() {
    for style in ways() {
        assert_same(AnyRenderer::cpu(), &style);
    }
}

/// Masks are made for directions at the centres of sectors of the image, which are then the sectors of its tiles.
#[test]
fn byte_codes_are_nearly_the_same_in_tiles() {
    let of = |footprint| style().with(|style| style.codes.footprint = footprint);
    let (db, _) = parts_beside_whole(AnyRenderer::cpu(), &of(Footprint::Masks));
    assert!(db >= 35.0, "{db} dB");
    assert_same(AnyRenderer::cpu(), &of(Footprint::Pixels));
}

#[test]
fn the_gpu_draws_the_same_image_in_tiles() {
    let mut ways = ways();
    ways.extend(
        Strategy::ALL
            .iter()
            .map(|&strategy| style().with(|style| style.drawing.strategy = strategy)),
    );
    for style in ways {
        let renderer = AnyRenderer::gpu(common::context()).unwrap();
        assert_same(renderer, &style);
    }
}

/// `picture` over one colour.
fn over(picture: &RgbaImage, behind: [u8; 3]) -> RgbaImage {
    let mut over = picture.clone();
    for pixel in over.pixels_mut() {
        let alpha = f32::from(pixel.0[3]) / 255.0;
        for (channel, behind) in pixel.0.iter_mut().zip(behind) {
            *channel = (f32::from(*channel) * alpha + f32::from(behind) * (1.0 - alpha)).round() as u8;
        }
        pixel.0[3] = 255;
    }
    over
}

#[test]
fn a_transparent_image_over_a_color_matches_the_opaque_one() {
    let primitives = [Primitive::Surfel, Primitive::Voxel, Primitive::Point];
    let with_each = primitives.into_iter().flat_map(|primitive| {
        Antialiasing::ALL.iter().flat_map(move |&antialiasing| {
            [EyeDome::Off, EyeDome::On].map(|eye_dome| (primitive, antialiasing, eye_dome))
        })
    });
    for (primitive, antialiasing, eye_dome) in with_each {
        let style = Style::default().with(|style| {
            style.primitive = primitive;
            style.light.eye_dome = eye_dome;
            style.backdrop.background = Background::solid([200, 60, 120]);
        });
        let mut headless = headless(AnyRenderer::cpu());
        let (frame, camera) = near_by(&headless, &style);
        let mut draw = |is_transparent, antialiasing| {
            let size = PictureSize {
                is_transparent,
                ..PictureSize::opaque(SIZE_PX)
            };
            let style = style.with(|style| style.drawing.antialiasing = antialiasing);
            draw_picture(
                &mut headless,
                &Picture {
                    frame: &frame,
                    camera: &camera,
                    style: &style,
                    size,
                },
            )
            .unwrap()
        };
        // FXAA would find different edges on another background.
        let opaque = draw(false, antialiasing.without_background());
        let transparent = draw(true, antialiasing);
        let (_, largest) = common::difference(&over(&transparent, [200, 60, 120]), &opaque);
        assert!(largest <= 2, "{primitive}: {largest}");
        let share = |alpha: u8| transparent.pixels().filter(|pixel| pixel.0[3] == alpha).count();
        assert!(share(0) > 1000, "{primitive}: nothing is transparent");
        assert!(share(255) > 1000, "{primitive}: nothing is opaque");
        assert_eq!(transparent.get_pixel(0, 0).0, [0; 4]);
    }
}

#[test]
fn a_scale_bar_is_painted_over_the_same_image() {
    let style = style();
    let mut headless = headless(AnyRenderer::cpu());
    let (frame, camera) = near_by(&headless, &style);
    let mut draw = |has_scale_bar, part_edge_px| {
        let size = PictureSize {
            has_scale_bar,
            part_edge_px,
            ..PictureSize::opaque([320, 240])
        };
        draw_picture(
            &mut headless,
            &Picture {
                frame: &frame,
                camera: &camera,
                style: &style,
                size,
            },
        )
        .unwrap()
    };
    let (plain, with_bar) = (draw(false, None), draw(true, None));
    for (x, y, pixel) in with_bar.enumerate_pixels() {
        let is_corner = x < 140 && y >= 210;
        assert!(is_corner || pixel == plain.get_pixel(x, y), "{x} {y}");
    }
    assert!(common::count_color(&with_bar, [245; 3]) > 30);
    let light = |picture: &RgbaImage| common::count_color(picture, [245; 3]);
    assert_eq!(light(&draw(true, Some(77))), light(&with_bar));
}

#[test]
fn a_file_contains_the_image_drawn_in_tiles() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.png");
    let style = style();
    let mut headless = headless(AnyRenderer::cpu());
    let (frame, camera) = near_by(&headless, &style);
    let size = PictureSize {
        is_transparent: true,
        part_edge_px: Some(100),
        ..PictureSize::opaque(SIZE_PX)
    };
    write_picture(
        &mut headless,
        &Picture {
            frame: &frame,
            camera: &camera,
            style: &style,
            size,
        },
        &file,
    )
    .unwrap();
    let drawn = draw_picture(
        &mut headless,
        &Picture {
            frame: &frame,
            camera: &camera,
            style: &style,
            size,
        },
    )
    .unwrap();
    assert_eq!(image::open(&file).unwrap().to_rgba8(), drawn);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn an_image_cancelled_between_tiles_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.png");
    let style = style();
    let mut headless = headless(AnyRenderer::cpu());
    let (frame, camera) = near_by(&headless, &style);
    let size = PictureSize {
        part_edge_px: Some(100),
        ..PictureSize::opaque([250, 120])
    };
    let mut write = |last: usize| {
        let told = Arc::new(Mutex::new(Vec::new()));
        let hears = Arc::clone(&told);
        let progress = Progress::told_to(move |progress| {
            hears.lock().unwrap().push(progress.done());
            if progress.done() == last {
                progress.cancel();
            }
        });
        let written = write_picture_observed(
            &mut headless,
            &Picture {
                frame: &frame,
                camera: &camera,
                style: &style,
                size,
            },
            &file,
            &progress,
        );
        assert_eq!(progress.of(), Some(6));
        let told = told.lock().unwrap().clone();
        (written, told)
    };
    let (cancelled, told) = write(4);
    assert!(matches!(cancelled, Err(ExportError::Cancelled)));
    assert_eq!(told, [1, 2, 3, 4]);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    let (written, told) = write(9);
    written.unwrap();
    assert_eq!(told.last(), Some(&6));
}

#[test]
fn undrawable_images_are_rejected_and_leave_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.png");
    let mut headless = headless(AnyRenderer::cpu());
    let style = style().with(|style| style.drawing.resolution = 0.5);
    let (frame, camera) = near_by(&headless, &style);
    let mut write = |size: PictureSize| {
        write_picture(
            &mut headless,
            &Picture {
                frame: &frame,
                camera: &camera,
                style: &style,
                size,
            },
            &file,
        )
        .unwrap_err()
    };
    let huge = write(PictureSize::opaque([MAX_EDGE_PX + 1, 4]));
    assert!(matches!(huge, ExportError::PictureSize { .. }), "{huge}");
    let scaled = write(PictureSize {
        part_edge_px: Some(50),
        ..PictureSize::opaque(SIZE_PX)
    });
    assert!(matches!(scaled, ExportError::ScaledParts { .. }), "{scaled}");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}
