//! What no photograph sees, filled from what is around it.

use super::*;
use pointreel::cloud::Frame;
use pointreel::sequence::{PrepareCounters, prepare};

/// The scene in blue points, with photographs of its front in which all is red.
fn red_on_blue() -> PreparedFrame {
    let mut raw = cloud(POINTS);
    let count = raw.positions.len();
    raw.attributes.colors = Some(vec![[0, 0, 255, 255]; count]);
    let frame = Frame::from_raw(raw, DVec3::ZERO).unwrap();
    let needs = Scene::needs(&style());
    let frame = prepare(0, Arc::new(frame), 0.0, &needs, &PrepareCounters::default());
    let of_front = PHOTOGRAPHS
        .all()
        .iter()
        .filter(|photograph| photograph.number.is_multiple_of(12));
    let red = of_front.map(|photograph| Photograph {
        name: photograph.name.clone(),
        pinhole: photograph.pinhole.clone(),
        texture: Texture::new(PhotoImage::new([4; 2], vec![[255, 0, 0, 255]; 16]).unwrap()),
        depth: None,
        ..**photograph
    });
    // Their pinholes have the size of their textures.
    let scaled = red.map(|photograph| Photograph {
        pinhole: pinhole(4),
        ..photograph
    });
    frame.with_photographs(Arc::new(Photographs::new(scaled.collect(), Some(0.5))))
}

fn holes(holes: PhotoHoles) -> Style {
    style().with(|style| style.photos.holes = holes)
}

fn count(picture: &RgbaImage, channel: usize) -> usize {
    picture.pixels().filter(|pixel| pixel[channel] > 40).count()
}

#[test]
fn holes_have_the_colours_of_what_is_around_them_and_nothing_else_changes() {
    let frame = red_on_blue();
    let camera = camera_at(&pose(100.0, 5.0));
    let drawn = |style: &Style| draw_on_cpu(&packet(&frame, &camera, style));
    let (own, filled) = (drawn(&holes(PhotoHoles::Points)), drawn(&holes(PhotoHoles::Filled)));
    keep(&own, "holes_own.png");
    keep(&filled, "holes_filled.png");
    let blue = count(&own, 2);
    assert!(blue > 10_000 && count(&own, 0) > 5_000, "{blue} pixels are unseen");
    assert_eq!(count(&filled, 2), 0, "blue is left");
    // What the photographs see stays, and no pixel beside the surface has a colour.
    for (own, filled) in own.pixels().zip(filled.pixels()) {
        assert_eq!(own.0[..3] == [0; 3], filled.0[..3] == [0; 3]);
        // Back sides are darker and of another hue.
        if own[1] == 0 && own[2] == 0 {
            assert_eq!(own, filled);
        }
    }
}

#[test]
fn filled_pictures_do_not_depend_on_the_number_of_threads() {
    let frame = red_on_blue();
    let packet = packet(&frame, &camera_at(&pose(70.0, -20.0)), &holes(PhotoHoles::Filled));
    let drawn_by = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| draw_on_cpu(&packet))
    };
    assert_eq!(drawn_by(1), drawn_by(3));
}

/// What looks beyond a pixel is the processor's.
#[test]
fn a_graphics_card_draws_the_colours_of_points_where_the_processor_fills() {
    let frame = red_on_blue();
    let camera = camera_at(&pose(100.0, 5.0));
    let [filled, own] =
        [PhotoHoles::Filled, PhotoHoles::Points].map(|kind| draw(&packet(&frame, &camera, &holes(kind))));
    assert_eq!(filled, own);
}
