//! Labels in exported images and videos: at the pixel of their point, whatever the tiles of the image.

use super::headless_of;
use glam::{DVec2, DVec3};
use image::{Rgba, RgbaImage};
use pointreel::cloud::{Positions, RawCloud};
use pointreel::composition::{ComposeOptions, OnionSkin};
use pointreel::export::{Picture, PictureSize, draw_picture};
use pointreel::headless::Headless;
use pointreel::math::Aabb;
use pointreel::render::AnyRenderer;
use pointreel::scene::{Background, Camera, FollowedPoint, Label, Primitive, Style, UpAxis};
use pointreel::sequence::{FrameEntry, Sequence};
use pointreel::timeline::PlayRange;
use std::sync::Arc;

const SIZE_PX: [u32; 2] = [400, 300];
/// Colour of the dot at the point.
const TINT: [u8; 3] = [255, 190, 60];

/// A hundred points on a line that move by a tenth per frame; frames have them in turned order in memory only.
fn moving() -> Sequence {
    let entries = (0..5).map(|number| FrameEntry {
        number: Some(number),
        ..FrameEntry::file(format!("/moving/{number}.ply"))
    });
    Sequence::with_decoder(entries.collect(), |entry| {
        let moved = entry.number.unwrap_or(0) as f32 * 0.1;
        let places = (0..100u8).map(|index| [f32::from(index) * 0.02 - 1.0, moved, 0.3 * moved]);
        Ok(RawCloud::from_positions(Positions::F32(places.collect())))
    })
}

fn style() -> Style {
    Style::default().with(|style| {
        style.primitive = Primitive::Point;
        style.backdrop.background = Background {
            top: [0; 3],
            bottom: [0; 3],
        };
    })
}

fn camera() -> Camera {
    let bounds = Aabb {
        min: glam::Vec3::NEG_ONE,
        max: glam::Vec3::ONE,
    };
    Camera::framing(&bounds, DVec3::ZERO, UpAxis::Y)
}

fn label(index_in_file: u32, text: &str) -> Label {
    Label {
        text: text.to_owned(),
        frame: 0,
        point: Some(FollowedPoint {
            index_in_file,
            points_in_file: Some(100),
        }),
        place: Some(DVec3::ZERO),
        frames: PlayRange::default(),
    }
}

fn drawn(headless: &mut Headless, index: usize, options: &ComposeOptions, part_edge_px: Option<u32>) -> RgbaImage {
    let style = style();
    let frame = headless.frame(index, &style).unwrap();
    let frame = headless.compose(&frame, options, &style).unwrap().0.frame;
    let size = PictureSize {
        part_edge_px,
        ..PictureSize::opaque(SIZE_PX)
    };
    draw_picture(
        headless,
        &Picture {
            frame: &frame,
            camera: &camera(),
            style: &style,
            size,
        },
    )
    .unwrap()
}

/// The centre of the pixels in the colour of dots.
fn dot(picture: &RgbaImage) -> Option<DVec2> {
    let is_tint = |Rgba([red, green, blue, _]): &Rgba<u8>| [*red, *green, *blue] == TINT;
    let dots: Vec<DVec2> = picture
        .enumerate_pixels()
        .filter(|(_, _, pixel)| is_tint(pixel))
        .map(|(x, y, _)| DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5))
        .collect();
    (!dots.is_empty()).then(|| dots.iter().sum::<DVec2>() / dots.len() as f64)
}

fn place(index: usize, frame: usize) -> DVec3 {
    let moved = frame as f64 * 0.1;
    DVec3::new(index as f64 * 0.02 - 1.0, moved, 0.3 * moved)
}

#[test]
fn a_label_is_at_the_projection_of_its_point_in_every_frame() {
    let mut headless = headless_of(moving(), AnyRenderer::cpu());
    headless.set_labels(Arc::new(vec![label(70, "")]));
    // Derived frames contain more points, with different indices.
    let onion = ComposeOptions {
        onion: Some(OnionSkin::default()),
        ..ComposeOptions::default()
    };
    for frame in 0..5 {
        for options in [&ComposeOptions::default(), &onion] {
            let picture = drawn(&mut headless, frame, options, None);
            let expected = camera().to_px(place(70, frame), SIZE_PX).unwrap();
            let found = dot(&picture).expect("the dot is drawn");
            assert!((found - expected).length() < 0.75, "frame {frame}: {found} {expected}");
        }
    }
}

#[test]
fn labels_are_the_same_in_tiles_and_absent_from_other_frames() {
    let mut headless = headless_of(moving(), AnyRenderer::cpu());
    let without = drawn(&mut headless, 2, &ComposeOptions::default(), None);
    assert_eq!(dot(&without), None);
    let mut later = label(40, "later");
    later.frames = PlayRange::default().beginning_at(3);
    headless.set_labels(Arc::new(vec![later.clone()]));
    assert_eq!(drawn(&mut headless, 2, &ComposeOptions::default(), None), without);
    headless.set_labels(Arc::new(vec![later, label(60, "the sixtieth")]));
    let whole = drawn(&mut headless, 3, &ComposeOptions::default(), None);
    assert_eq!(drawn(&mut headless, 3, &ComposeOptions::default(), Some(77)), whole);
    assert_ne!(whole, without);
}
