//! Colours by change, ghosts and trails in videos: a column of points that walks, so that every pixel is known.

use super::headless_of;
use image::RgbaImage;
use pointreel::analysis::ColorMap;
use pointreel::cloud::{Positions, RawCloud};
use pointreel::composition::{ChangeColors, ComposeOptions, OnionSkin, TrailLook, TrailRequest, Trails};
use pointreel::export::{Picture, PictureSize, Video, draw_picture, export_video};
use pointreel::headless::Headless;
use pointreel::math::Aabb;
use pointreel::progress::Progress;
use pointreel::render::AnyRenderer;
use pointreel::scene::{Background, Camera, CameraPath, Lighting, Primitive, Style, UpAxis};
use pointreel::sequence::{ColorSource, Coloring, FrameEntry, Sequence};
use std::collections::HashSet;
use std::sync::Arc;

const FRAMES: usize = 4;

fn size() -> PictureSize {
    PictureSize::opaque([160, 90])
}

/// Forty white points above each other, which walk two units per frame.
fn walk() -> Headless {
    let sources = (0..FRAMES).map(|frame| FrameEntry::file(format!("/walk/{frame}.ply")));
    let sequence = Sequence::with_decoder(sources.collect(), |source| {
        let frame: f32 = source.name[..1].parse()?;
        let place = |point: i32| [2.0 * frame, 0.05 * point as f32 - 1.0, 0.0];
        let mut cloud = RawCloud::from_positions(Positions::F32((0..40).map(place).collect()));
        cloud.attributes.colors = Some(vec![[255; 4]; 40]);
        Ok(cloud)
    });
    headless_of(sequence, AnyRenderer::cpu())
}

fn style() -> Style {
    Style::default().with(|style| {
        style.primitive = Primitive::Point;
        // All points are white, which the automatic choice ignores.
        style.colors = Coloring::of(ColorSource::File);
        style.points.size_px = 3.0;
        style.light.lighting = Lighting::Unlit;
        style.backdrop.background = Background::solid([0; 3]);
    })
}

/// The whole trajectory, from the front.
fn path() -> CameraPath {
    let bounds = Aabb {
        min: [-0.5, -1.0, -0.1].into(),
        max: [6.5, 1.0, 0.1].into(),
    };
    let mut camera = Camera::framing(&bounds, glam::DVec3::ZERO, UpAxis::Y);
    (camera.azimuth_deg, camera.elevation_deg) = (0.0, 0.0);
    CameraPath::turntable(camera, 0.0, [FRAMES as f64, 10.0], [0.0, 1.0]).unwrap()
}

/// The images of a video with `options`, each compared with the single image of its frame; and the messages.
fn pictures(options: &ComposeOptions) -> (Vec<RgbaImage>, Vec<String>) {
    let (path, style) = (path(), style());
    let video = Video {
        path: &path,
        style: &style,
        options,
        size: size(),
        per_second: 10.0,
        speed: 1.0,
    };
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("{frame}.png");
    let mut said = Vec::new();
    let failed = export_video(&mut walk(), &video, &output, &Progress::default(), &mut |picture| {
        said.extend(picture.problems.clone());
    });
    assert!(failed.unwrap().is_empty());
    let mut headless = walk();
    let pictures = (0..FRAMES).map(|frame| {
        let file = pointreel::export::numbered(&output, frame, FRAMES);
        let picture = image::open(file).unwrap().to_rgba8();
        let pose = headless.frame(frame, &style).unwrap();
        let composed = headless.compose(&pose, options, &style).unwrap().0.frame;
        let (camera, _) = path.at(frame as f64 / 10.0);
        let single = draw_picture(
            &mut headless,
            &Picture {
                frame: &composed,
                camera: &camera,
                style: &style,
                size: size(),
            },
        )
        .unwrap();
        assert!(picture == single, "frame {frame}");
        picture
    });
    (pictures.collect(), said)
}

/// Colours that are not the background's, of the pixels of some columns.
fn colors(picture: &RgbaImage, columns: std::ops::Range<u32>) -> HashSet<[u8; 3]> {
    let pixels = picture.enumerate_pixels();
    let within = pixels.filter(|(x, _, _)| columns.contains(x));
    let colors = within.map(|(_, _, pixel)| [pixel[0], pixel[1], pixel[2]]);
    colors.filter(|color| *color != [0; 3]).collect()
}

/// Position of the column of `frame` in an image.
fn columns(frame: usize) -> std::ops::Range<u32> {
    let (plain, _) = pictures(&ComposeOptions::default());
    let pixels = plain[frame].enumerate_pixels();
    let white = pixels.filter(|(_, _, pixel)| pixel.0 == [255; 4]);
    let xs: Vec<u32> = white.map(|(x, _, _)| x).collect();
    *xs.iter().min().unwrap()..xs.iter().max().unwrap() + 1
}

#[test]
fn ghosts_of_neighbouring_poses_are_in_every_image() {
    let onion = OnionSkin {
        is_on: true,
        before: 1,
        after: 1,
        strength: 1.0,
        ..OnionSkin::default()
    };
    let options = ComposeOptions {
        onion: Some(onion),
        ..ComposeOptions::default()
    };
    let (pictures, said) = pictures(&options);
    let places: Vec<_> = (0..FRAMES).map(columns).collect();
    for (frame, picture) in pictures.iter().enumerate() {
        for (other, place) in places.iter().enumerate() {
            let expected: &[[u8; 3]] = match other as i64 - frame as i64 {
                -1 => &[[255, 150, 60]],
                0 => &[[255; 3]],
                1 => &[[70, 160, 255]],
                _ => &[],
            };
            let expected: HashSet<[u8; 3]> = expected.iter().copied().collect();
            assert_eq!(colors(picture, place.clone()), expected, "{frame} {other}");
        }
    }
    assert!(said.is_empty(), "there is nothing before the first frame");
}

#[test]
fn points_are_colored_by_their_distance_to_the_other_pose() {
    let change = |step, range| ComposeOptions {
        change: Some(ChangeColors { step, range }),
        ..ComposeOptions::default()
    };
    // Every point is two units from the nearest one in the next frame, four from that two frames later.
    for (step, range, share) in [(1, Some(4.0), 0.5), (2, Some(16.0), 0.25), (-1, None, 1.0)] {
        let (pictures, said) = pictures(&change(step, range));
        let [red, green, blue, _] = ColorMap::Viridis.color(share);
        let mut without = 0;
        for (frame, picture) in pictures.iter().enumerate() {
            let is_there = (0..FRAMES as i64).contains(&(frame as i64 + step));
            let expected = if is_there { [red, green, blue] } else { [255; 3] };
            assert_eq!(colors(picture, 0..160), [expected].into(), "frame {frame}");
            without += usize::from(!is_there);
        }
        assert_eq!(said.len(), without, "{said:?}");
        assert!(said.iter().all(|text| text.contains("keeps its colours")));
    }
}

#[test]
fn trails_lead_from_pose_to_pose() {
    let headless = walk();
    let request = TrailRequest {
        indices: vec![20],
        chosen_in: 0,
        points_in_file: 40,
        frames: 0..FRAMES,
    };
    let found = Trails::trace(&request, headless.sequence(), |_| None, &Progress::default());
    let found = Arc::new(found.unwrap());
    assert!(found.breaks().is_empty());
    let with = |look| ComposeOptions {
        trails: Some((Arc::clone(&found), vec![look])),
        ..ComposeOptions::default()
    };
    let between = |from: usize| columns(from).end..columns(from + 1).start;
    let (bright, dim) = ([255, 190, 60], [127, 95, 30]);
    let (all, _) = pictures(&with(TrailLook::picked(0)));
    for (frame, picture) in all.iter().enumerate() {
        for from in 0..FRAMES - 1 {
            let expected = if from < frame { bright } else { dim };
            let found = colors(picture, between(from));
            assert_eq!(found, [expected].into(), "from {from} in frame {frame}");
        }
    }
    let (last, _) = pictures(&with(TrailLook {
        tint: [0, 200, 0],
        length: Some(1),
        ..TrailLook::picked(0)
    }));
    for (frame, picture) in last.iter().enumerate() {
        for from in 0..FRAMES - 1 {
            let is_last = from + 1 == frame;
            assert_eq!(colors(picture, between(from)).len(), usize::from(is_last));
        }
    }
}
