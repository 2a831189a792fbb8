//! Parts that no input image sees, filled from their surroundings.

use super::*;
use crate::common::{draw_with, renderer, set_lighting};
use pointreel::cloud::Frame;
use pointreel::scene::{Lighting, PhotoRelight};
use pointreel::sequence::{PrepareCounters, prepare};

/// The scene in blue points, with images of its front in which all is red.
fn red_on_blue() -> PreparedFrame {
    let mut raw = cloud(POINTS);
    let count = raw.positions.len();
    raw.attributes.colors = Some(vec![[0, 0, 255, 255]; count]);
    let frame = Frame::from_raw(raw, DVec3::ZERO).unwrap();
    let needs = Scene::needs(&style());
    let frame = prepare(0, Arc::new(frame), 0.0, &needs, &PrepareCounters::default());
    let of_front = PHOTOS
        .all()
        .iter()
        .filter(|posed_image| posed_image.number.is_multiple_of(12));
    let red = of_front.map(|posed_image| PosedImage {
        name: posed_image.name.clone(),
        pinhole: posed_image.pinhole.clone(),
        texture: Texture::new(PhotoImage::new([4; 2], vec![[255, 0, 0, 255]; 16]).unwrap()),
        depth: None,
        ..**posed_image
    });
    // Their pinhole cameras match the size of their textures.
    let scaled = red.map(|posed_image| PosedImage {
        pinhole: pinhole(4),
        ..posed_image
    });
    frame.with_photos(Arc::new(PosedImages::new(scaled.collect(), Some(0.5))))
}

fn holes(holes: PhotoHoles) -> Style {
    style().with(|style| style.photos.holes = holes)
}

fn count(picture: &RgbaImage, channel: usize) -> usize {
    picture.pixels().filter(|pixel| pixel[channel] > 40).count()
}

#[test]
fn holes_take_the_surrounding_colors_and_nothing_else_changes() {
    let frame = red_on_blue();
    let camera = camera_at(&pose(100.0, 5.0));
    let drawn = |style: &Style| draw_on_cpu(&packet(&frame, &camera, style));
    let (own, filled) = (drawn(&holes(PhotoHoles::Points)), drawn(&holes(PhotoHoles::Filled)));
    keep(&own, "holes_own.png");
    keep(&filled, "holes_filled.png");
    let blue = count(&own, 2);
    assert!(blue > 10_000 && count(&own, 0) > 5_000, "{blue} pixels are unseen");
    assert_eq!(count(&filled, 2), 0, "blue is left");
    // Parts that the images show stay, and no pixel outside the surface has a colour.
    for (own, filled) in own.pixels().zip(filled.pixels()) {
        assert_eq!(own.0[..3] == [0; 3], filled.0[..3] == [0; 3]);
        // Back sides are darker and have another hue.
        if own[1] == 0 && own[2] == 0 {
            assert_eq!(own, filled);
        }
    }
}

#[test]
fn filled_images_do_not_depend_on_thread_count() {
    let frame = red_on_blue();
    let packet = packet(&frame, &camera_at(&pose(70.0, -20.0)), &holes(PhotoHoles::Filled));
    let drawn_by = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| draw_on_cpu(&packet))
    };
    assert_eq!(drawn_by(1), drawn_by(3));
}

/// Fraction of the channels that are clearly different: near steps of depth, a rounding decides whether images are
/// used.
fn share_apart(one: &RgbaImage, other: &RgbaImage) -> f64 {
    let channels = one.as_raw().iter().zip(other.as_raw());
    let apart = channels.filter(|(one, other)| one.abs_diff(**other) > 8).count();
    apart as f64 / one.as_raw().len() as f64
}

/// From the side, where a third of the surface is unseen by the images of its front; by a renderer that has drawn
/// other sizes and other holes before.
#[test]
fn both_renderers_fill_the_same_holes() {
    let frame = FRAME.with_photos(Arc::new(of_front()));
    let camera = camera_at(&pose(100.0, 5.0));
    let mut card = renderer();
    for (size_px, relight, lighting) in [
        ([321, 203], PhotoRelight::Off, Lighting::Unlit),
        ([96, 257], PhotoRelight::Off, Lighting::Unlit),
        ([320, 240], PhotoRelight::Photos, Lighting::Lambert),
        ([320, 240], PhotoRelight::DepthOnly, Lighting::Physical),
    ] {
        let of_kind = |kind| {
            let style = holes(kind).with(|style| {
                style.photos.relight = relight;
                set_lighting(style, lighting);
            });
            Scene::default().packet(&frame, DVec3::ZERO, &camera, &style, size_px)
        };
        let left = draw_with(&mut card, &of_kind(PhotoHoles::Left));
        let filled = of_kind(PhotoHoles::Filled);
        let (of_card, of_processor) = (draw_with(&mut card, &filled), draw_on_cpu(&filled));
        keep(&of_card, &format!("filled_{relight}_gpu.png"));
        keep(&of_processor, &format!("filled_{relight}_cpu.png"));
        assert!(share_apart(&left, &of_card) > 0.03, "{relight}: few holes");
        let apart = share_apart(&of_processor, &of_card);
        assert!(apart < 0.01, "{size_px:?}, {relight}: {apart} of the channels differ");
    }
}

/// The fill is not black, white or the points' own: all of the surface is red, seen or not.
#[test]
fn the_gpu_fills_holes_with_their_surroundings() {
    let frame = red_on_blue();
    let filled = packet(&frame, &camera_at(&pose(100.0, 5.0)), &holes(PhotoHoles::Filled));
    let drawn = draw(&filled);
    assert_eq!(count(&drawn, 2), 0, "blue is left");
    assert!(count(&drawn, 0) > 15_000);
    assert!(share_apart(&drawn, &draw_on_cpu(&filled)) < 0.01);
}
