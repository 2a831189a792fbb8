//! Sequences whose frames have nothing in common: none, one, the same number or 100 times the points of their
//! neighbours.

use super::{chain, common, sphere};
use glam::DVec3;
use pointreel::scene::{BackFaces, Background, Camera, Primitive, Scene, Style, UpAxis};
use pointreel::sequence::{Loader, LoaderOptions, PreparedFrame, Sequence};
use pointreel::timeline::Direction;
use std::sync::Arc;

const SIZE_PX: [u32; 2] = [96, 64];
const BACKGROUND: [u8; 3] = [1, 2, 3];

fn style(primitive: Primitive) -> Style {
    Style::default().with(|style| {
        style.primitive = primitive;
        style.surfels.back_faces = BackFaces::Drawn;
        style.points.size_px = 3.0;
        style.backdrop.background = Background::solid(BACKGROUND);
    })
}

/// The frames of a folder, in order, as `style` needs them.
fn frames(clouds: &[Vec<DVec3>], style: &Style) -> (DVec3, Vec<Arc<PreparedFrame>>) {
    let folder = tempfile::tempdir().unwrap();
    for (index, cloud) in clouds.iter().enumerate() {
        std::fs::write(folder.path().join(format!("scan_{index}.ply")), chain::ply(cloud)).unwrap();
    }
    let sequence = Arc::new(Sequence::discover(&[folder.path().to_owned()]).unwrap());
    let loader = Loader::new(Arc::clone(&sequence), LoaderOptions::default()).unwrap();
    let needs = Scene::needs(style);
    let frame = |index| {
        loader.request(index, Direction::Forward, &needs);
        loader.wait(index, &needs).unwrap()
    };
    (sequence.origin(), (0..clouds.len()).map(frame).collect())
}

#[test]
fn frames_of_none_one_equal_and_a_hundred_times_as_many_points() {
    let usual = sphere(300);
    let clouds = [
        usual.clone(),
        Vec::new(),
        vec![DVec3::new(0.1, 0.2, 0.3)],
        vec![DVec3::new(-0.2, 0.1, 0.4); 300],
        sphere(30_000),
        usual,
    ];
    for primitive in [
        Primitive::Point,
        Primitive::Surfel,
        Primitive::Ellipse,
        Primitive::Voxel,
    ] {
        let (origin, frames) = frames(&clouds, &style(primitive));
        let camera = Camera::framing(&frames[0].frame.bounds(), origin, UpAxis::Y);
        let mut covered = Vec::new();
        // One scene that goes on from frame to frame, as a window's does.
        let mut scenes = [Scene::that_remembers(), Scene::that_remembers()];
        for (index, frame) in frames.iter().enumerate() {
            let mut packet = |is_processor: bool| {
                let style = style(primitive).drawn_by(is_processor);
                scenes[usize::from(is_processor)].packet(frame, origin, &camera, &style, SIZE_PX)
            };
            let (on_gpu, on_cpu) = (common::draw(&packet(false)), common::draw_on_cpu(&packet(true)));
            let squared = pointreel::measure::mean_squared_error(&on_gpu, &on_cpu).unwrap();
            let db = pointreel::measure::psnr_db(squared);
            assert!(db > 40.0, "{primitive}, frame {index}: {db} dB");
            covered.push(common::covered(&on_cpu, BACKGROUND));
        }
        assert_eq!(covered[1], 0, "{primitive}: {covered:?}");
        assert!(covered[2] > 0 && covered[3] > 0, "{primitive}: {covered:?}");
        assert!(covered[4].min(covered[0]) > 500, "{primitive}: {covered:?}");
        assert_eq!(covered[0], covered[5], "{primitive}");
    }
}
