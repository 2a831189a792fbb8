//! Picking the point under a pixel.
//!
//! Measured: `pick` at the centre and at a corner of an image of 1920×1080 that 1,000,000 points fill (Morton order),
//! drawn as points and as surfels; and, in the same run, one read of all positions (their box), on the same number of
//! threads.
//!
//! Not measured: drawing; the data read from the frame for the panel.

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use glam::{DVec3, Vec3};
use pointreel::cloud::{Frame, Positions, RawCloud};
use pointreel::math::Aabb;
use pointreel::scene::{Camera, Primitive, Scene, Style, UpAxis, pick};
use pointreel::sequence::{Needs, PrepareCounters, PreparedFrame, prepare};
use rayon::prelude::*;
use std::hint::black_box;
use std::sync::Arc;

mod shapes;

const POINTS: usize = 1_000_000;
const SIZE: [u32; 2] = [1920, 1080];

fn prepared() -> PreparedFrame {
    let (positions, _) = shapes::bumpy_torus(POINTS);
    let positions: Vec<[f32; 3]> = positions.iter().map(Vec3::to_array).collect();
    let mut raw = RawCloud::from_positions(Positions::F32(positions.clone()));
    // Neither the radius that closes the surface nor the normal matters here.
    raw.attributes.normals = Some(positions);
    raw.attributes.radii = Some(vec![0.003; POINTS]);
    let frame = Arc::new(Frame::from_raw(raw, DVec3::ZERO).expect("arrays of one length"));
    let needs = Needs {
        shapes: true,
        ..Needs::default()
    };
    prepare(0, frame, 0.0, &needs, &PrepareCounters::default())
}

fn picking(criterion: &mut Criterion) {
    let frame = prepared();
    let camera = Camera::framing(&frame.frame.bounds(), DVec3::ZERO, UpAxis::Y);
    let mut group = criterion.benchmark_group(format!("pick/{POINTS}"));
    for primitive in [Primitive::Point, Primitive::Surfel] {
        let style = Style {
            primitive,
            ..Style::default()
        };
        let packet = Scene::default().packet(&frame, DVec3::ZERO, &camera, &style, SIZE);
        for (name, place_px) in [("middle", [960.0, 640.0]), ("corner", [10.0, 10.0])] {
            let id = BenchmarkId::new(primitive.name(), name);
            group.bench_function(id, |bencher| {
                bencher.iter(|| pick(&packet, &frame, black_box(place_px), 6.0));
            });
        }
    }
    group.bench_function("one read of all positions", |bencher| {
        bencher.iter(|| {
            let chunks = frame.points.par_chunks(1 << 14);
            let boxes = chunks.map(|chunk| {
                let places = chunk.iter().map(|point| Vec3::from_array(point.position));
                places.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), place| {
                    (low.min(place), high.max(place))
                })
            });
            let (min, max) = boxes.reduce(
                || (Vec3::INFINITY, Vec3::NEG_INFINITY),
                |a, b| (a.0.min(b.0), a.1.max(b.1)),
            );
            black_box(Aabb { min, max })
        });
    });
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(30);
    targets = picking
}
criterion_main!(benches);
