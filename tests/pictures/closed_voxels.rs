//! Voxels as they are drawn by default close the same surfaces as surfels, and look like them.
//!
//! Checked: the fraction of the surfels' pixels that voxels cover, the pixels outside that they cover, and FLIP over
//! both. `bench accuracy` has the same numbers as a table, compared with the paper's δ.

#![allow(clippy::print_stdout, reason = "what was measured, for `--nocapture`")]

use crate::data::shared;
use image::RgbaImage;
use pointreel::levels::octree::StopCriterion;
use pointreel::measure::flip;
use pointreel::render::Renderer;
use pointreel::render::cpu::CpuRenderer;
use pointreel::scene::{BackFaces, Background, Camera, FirstLook, Primitive, Scene, Style, UpAxis, VoxelLight};
use pointreel::sequence::{OpenOptions, PrepareCounters, PreparedFrame, Sequence, Shape, complete, prepare};
use std::sync::Arc;

/// Minimum fraction of the surfels' pixels that voxels cover.
const COVERED: f64 = 0.99;

/// Pixels that voxels cover outside, as a fraction of the surfels', and FLIP over the pixels that show the object in
/// either image, at most. Cubes pass the outline by half of their edge, which is at least the spacing: the fewer
/// points, and the thinner limbs are, the more that is.
#[derive(Clone, Copy)]
struct Bounds {
    outside: f64,
    flip: f64,
}

const BOUNDS: Bounds = Bounds {
    outside: 0.06,
    flip: 0.25,
};

/// A body of 8,000 points.
const BOUNDS_OF_DEMO: Bounds = Bounds {
    outside: 0.08,
    flip: 0.30,
};

/// A grey of medium lightness, and the difference that separates the object from it.
const BACKGROUNDS: [[u8; 3]; 2] = [[119; 3], [255; 3]];

/// The image on the first background, and which pixels show the object.
fn draw(
    frame: &PreparedFrame,
    sequence: &Sequence,
    camera: &Camera,
    style: Style,
    size_px: [u32; 2],
) -> (RgbaImage, Vec<bool>) {
    let needs = Scene::needs(&style);
    let frame = complete(frame, &needs, &PrepareCounters::default());
    let mut renderer = CpuRenderer::new();
    let [first, second] = BACKGROUNDS.map(|color| {
        let style = style.with(|style| style.backdrop.background = Background::solid(color));
        let packet = Scene::default().packet(&frame, sequence.origin(), camera, &style, size_px);
        renderer.prepare(&packet).unwrap();
        renderer.render().unwrap();
        renderer.read_image().unwrap()
    });
    let shows = |image: &RgbaImage, color: [u8; 3]| -> Vec<bool> {
        image.pixels().map(|pixel| pixel.0[..3] != color).collect()
    };
    let on_second = shows(&second, BACKGROUNDS[1]);
    let shows_object = shows(&first, BACKGROUNDS[0]).into_iter().zip(on_second);
    let shows_object = shows_object.map(|(first, second)| first || second).collect();
    (first, shows_object)
}

/// Covered, outside and FLIP of voxels compared with surfels.
fn compared(frame: &PreparedFrame, sequence: &Sequence, camera: &Camera, style: Style, size_px: [u32; 2]) -> [f64; 3] {
    let surfels = Style::default().with(|style| style.surfels.back_faces = BackFaces::Drawn);
    let (surfels, is_surfel) = draw(frame, sequence, camera, surfels, size_px);
    let (voxels, is_voxel) = draw(frame, sequence, camera, style, size_px);
    let count = |is_counted: fn(bool, bool) -> bool| {
        let pixels = is_surfel.iter().zip(&is_voxel);
        pixels.filter(|&(&surfel, &voxel)| is_counted(surfel, voxel)).count() as f64
    };
    let all = count(|surfel, _| surfel);
    let map = flip(&surfels, &voxels).unwrap();
    [
        count(|surfel, voxel| surfel && voxel) / all,
        count(|surfel, voxel| !surfel && voxel) / all,
        map.mean_where(|pixel| is_surfel[pixel] || is_voxel[pixel]),
    ]
}

fn voxels() -> Style {
    Style {
        primitive: Primitive::Voxel,
        ..Style::default()
    }
}

/// Sequences by name; real scans where there are any.
fn sequences() -> Vec<(String, Sequence)> {
    let mut sequences = vec![
        ("demo".to_owned(), Sequence::demo()),
        ("sphere".to_owned(), Sequence::of(Shape::Sphere.frame(40_000))),
        ("torus".to_owned(), Sequence::of(Shape::Torus.frame(100_000))),
    ];
    for name in ["sequences/cesiumman_24fps", "static/bun_zipper.ply"] {
        if let Some(path) = shared(name) {
            sequences.push((
                name.to_owned(),
                Sequence::open(&[path], &OpenOptions::default()).unwrap(),
            ));
        }
    }
    sequences
}

#[test]
fn voxels_cover_the_same_pixels_as_surfels_and_look_like_them() {
    let mut beyond = Vec::new();
    for (name, sequence) in sequences() {
        let frame = Arc::new(sequence.frame(0).unwrap());
        let needs = Scene::needs(&Style::default());
        let frame = prepare(0, frame, 0.0, &needs, &PrepareCounters::default());
        let origin = sequence.origin();
        let up = FirstLook::of(&[&frame.frame], origin).up;
        let framing = Camera::framing(&frame.frame.bounds(), origin, up);
        for size_px in [[640, 480], [1280, 960]] {
            let mut sums = [0.0; 3];
            let views = [(20.0, 10.0), (140.0, 35.0), (260.0, -15.0)];
            for (azimuth_deg, elevation_deg) in views {
                let camera = Camera {
                    azimuth_deg,
                    elevation_deg,
                    ..framing
                };
                let found = compared(&frame, &sequence, &camera, voxels(), size_px);
                for (sum, value) in sums.iter_mut().zip(found) {
                    *sum += value / views.len() as f64;
                }
            }
            let [covered, outside, flip] = sums;
            let found = format!("{name} {size_px:?}: {covered:.4} covered, {outside:.4} outside, FLIP {flip:.3}");
            println!("{found}");
            let max = if name == "demo" { BOUNDS_OF_DEMO } else { BOUNDS };
            if covered < COVERED || outside > max.outside || flip > max.flip {
                beyond.push(found);
            }
        }
    }
    assert!(beyond.is_empty(), "{beyond:#?}");
}

/// The measures of the test above separate closed surfaces from dots, and shading of surfaces from that of cubes.
#[test]
fn cells_sized_as_in_the_paper_are_dots_and_faces_are_lit_like_cubes() {
    let sequence = Sequence::of(Shape::Torus.frame(20_000));
    let frame = Arc::new(sequence.frame(0).unwrap());
    let needs = Scene::needs(&Style::default());
    let frame = prepare(0, frame, 0.0, &needs, &PrepareCounters::default());
    let camera = Camera::framing(&frame.frame.bounds(), sequence.origin(), UpAxis::Z);
    let of = |style| compared(&frame, &sequence, &camera, style, [640, 480]);
    let [covered, _, flip] = of(voxels());
    let dots = voxels().with(|style| style.levels.stop = StopCriterion::PAPER);
    let [covered_by_dots, ..] = of(dots);
    assert!(
        covered > COVERED && covered_by_dots < 0.9,
        "{covered} {covered_by_dots}"
    );
    let faces = voxels().with(|style| style.voxels.light = VoxelLight::Faces);
    let [covered_by_faces, _, flip_of_faces] = of(faces);
    assert_eq!(covered_by_faces, covered, "light changes no silhouette");
    assert!(flip_of_faces > 1.3 * flip, "{flip_of_faces} {flip}");
}
