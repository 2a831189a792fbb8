//! Passes compared with the CPU's filters, and the bilateral filter with its definition in double precision.

use super::*;
use crate::render::gpu::GpuRenderer;
use crate::render::gpu::context::ContextOptions;
use crate::render::gpu::readback::map_and_read;
use crate::rgbd::test_images::{bilateral_by_definition, random};
use crate::rgbd::{Bilateral, Camera, DepthRange, DepthTable, Distortion, FlyingPixels, RayTable};
use glam::{DVec2, Vec3};
use std::sync::LazyLock;
use wgpu::BufferUsages as Usages;

/// Sizes: a pixel, a line, odd ones, a workgroup, and more than whole workgroups.
const SIZES: [[u32; 2]; 8] = [[1, 1], [7, 1], [1, 9], [3, 5], [16, 16], [33, 17], [61, 47], [64, 32]];

fn context() -> Arc<Context> {
    let options = ContextOptions {
        prefer_software: true,
        ..ContextOptions::default()
    };
    Context::headless(&options).unwrap()
}

/// Surfaces with steps between them, noise, outliers and holes, in tenths of millimetres; 65535 among them.
fn numbers([width, height]: [u32; 2], seed: u32) -> Vec<u16> {
    let number = |at: u32| {
        let of = 4 * at + 1000 * seed;
        match random(of) {
            share if share < 0.15 => 0,
            share if share < 0.17 => u16::MAX,
            _ => {
                let surface = 8000 + 3000 * ((at % width) / 11 % 5);
                let outlier = if random(of + 1) < 0.05 { 4000.0 } else { 0.0 };
                surface as u16 + (150.0 * random(of + 2) + outlier) as u16
            }
        }
    };
    (0..width * height).map(number).collect()
}

/// Possible output of a half-float sensor: invalid distances among distances.
fn metres([width, height]: [u32; 2], seed: u32) -> Vec<f32> {
    let odd = [
        0.0,
        -0.0,
        -1.5,
        f32::NAN,
        f32::INFINITY,
        f32::NEG_INFINITY,
        // GPUs flush anything smaller to zero.
        f32::MIN_POSITIVE,
        f32::MAX,
    ];
    let metre = |at: u32| match random(3 * at + seed) {
        share if share < 0.2 => odd[at as usize % odd.len()],
        share => 0.4 + 0.01 * share + 0.25 * ((at % width) / 9 % 6) as f32,
    };
    (0..width * height).map(metre).collect()
}

fn rays(size_px: [u32; 2]) -> Arc<RayTable> {
    let focal_px = DVec2::new(52.5, 51.0);
    let camera = Camera::new(size_px, focal_px, DVec2::new(3.2, 1.7), Distortion::None).unwrap();
    Arc::new(RayTable::of(&camera))
}

/// Shared by all images, as in a recording.
static TABLE_OF_ALL: LazyLock<DepthTable> = LazyLock::new(|| {
    DepthTable::new(|number| match number {
        0 | u16::MAX => 0.0,
        number => f32::from(number) / 10_000.0,
    })
});

fn coded(size_px: [u32; 2], seed: u32) -> Arc<DepthSamples> {
    Arc::new(DepthSamples::coded(numbers(size_px, seed), TABLE_OF_ALL.clone()))
}

fn floats(size_px: [u32; 2], seed: u32) -> Arc<DepthSamples> {
    Arc::new(DepthSamples::metres(metres(size_px, seed)))
}

fn images_of(samples: Arc<DepthSamples>, size_px: [u32; 2], filters: Filters) -> PointImages {
    let frame = DepthFrame::new(Vec::new(), samples, rays(size_px), None, filters).unwrap();
    shown(frame)
}

fn shown(frame: DepthFrame) -> PointImages {
    PointImages {
        frame: Arc::new(frame),
        origin: Vec3::ZERO,
        one_color: Some([1, 2, 3, 255]),
    }
}

/// The points of images, holes among them.
fn made(maker: &mut DepthMaker, context: &Context, images: &PointImages) -> Vec<PointRecord> {
    let made = maker.make(context, images);
    let readable = context.device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: made.buffer.size(),
        usage: Usages::MAP_READ | Usages::COPY_DST,
        mapped_at_creation: false,
    });
    let mut encoder = context
        .device
        .create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    encoder.copy_buffer_to_buffer(&made.buffer, 0, &readable, 0, readable.size());
    context.queue.submit([encoder.finish()]);
    map_and_read(context, &readable, bytemuck::pod_collect_to_vec).unwrap()
}

/// Depths of these points.
fn depths(points: &[PointRecord]) -> Vec<f32> {
    points.iter().map(|point| point.position[2]).collect()
}

fn filters_of(text: &str) -> Filters {
    text.parse().unwrap()
}

#[test]
fn range_median_and_flying_pixel_filters_match_the_cpu_bit_for_bit() {
    let context = context();
    let mut maker = DepthMaker::default();
    let near = Filters {
        near: Some(DepthRange {
            near_m: 0.9,
            far_m: 1.7,
        }),
        ..Filters::NONE
    };
    let median = Filters {
        median: true,
        ..Filters::NONE
    };
    let flying = |flying| Filters {
        flying: Some(flying),
        ..Filters::NONE
    };
    let all = [
        Filters::NONE,
        near,
        median,
        flying(FlyingPixels::USUAL),
        flying(FlyingPixels {
            min_neighbours: 6,
            ..FlyingPixels::USUAL
        }),
        flying(FlyingPixels {
            erosion_px: 2,
            max_share: 0.3,
            ..FlyingPixels::USUAL
        }),
        Filters { median: true, ..near },
        Filters {
            median: true,
            ..flying(FlyingPixels {
                erosion_px: 1,
                ..FlyingPixels::USUAL
            })
        },
    ];
    for size_px in SIZES {
        for filters in all {
            for samples in [coded(size_px, 1), floats(size_px, 2)] {
                let images = images_of(samples, size_px, filters);
                let expected = images.frame.filtered().unwrap();
                let found = depths(&made(&mut maker, &context, &images));
                // Depths too far away for a point count as none.
                let is_point = |depth: &f32| if *depth < 1e28 { *depth } else { 0.0 };
                let expected: Vec<f32> = expected.metres().iter().map(is_point).collect();
                assert_eq!(found, expected, "{size_px:?} {filters:?}");
            }
        }
    }
}

#[test]
fn the_bilateral_filter_matches_its_definition() {
    let context = context();
    let mut maker = DepthMaker::default();
    let all = [
        Bilateral::USUAL,
        Bilateral {
            space_px: 1.5,
            depth_m: Some(0.05),
            ..Bilateral::USUAL
        },
        Bilateral {
            noise_factor: 7.0,
            ..Bilateral::USUAL
        },
    ];
    for size_px in SIZES {
        for bilateral in all {
            let filters = Filters {
                bilateral: Some(bilateral),
                ..Filters::NONE
            };
            let samples = coded(size_px, 5);
            let expected = bilateral_by_definition(&samples.image(size_px).unwrap(), &bilateral);
            let found = depths(&made(&mut maker, &context, &images_of(samples, size_px, filters)));
            for (at, (&found, expected)) in found.iter().zip(expected).enumerate() {
                let error = (f64::from(found) - expected).abs();
                assert!(
                    error <= 1e-4 * expected,
                    "{size_px:?} {bilateral:?} {at}: {found}, {expected}"
                );
                assert_eq!(found > 0.0, expected > 0.0);
            }
        }
    }
}

#[test]
fn a_plane_retains_its_holes_and_a_step_stays_sharp() {
    let context = context();
    let mut maker = DepthMaker::default();
    let size_px = [45, 23];
    let plane: Vec<f32> = (0..45 * 23)
        .map(|at| if at % 7 == 3 { 0.0 } else { 1.234_567 })
        .collect();
    // `flying` would drop the corners, which have too few neighbours.
    let filters = Filters {
        flying: None,
        ..Filters::USUAL
    };
    let images = images_of(Arc::new(DepthSamples::metres(plane.clone())), size_px, filters);
    assert_eq!(depths(&made(&mut maker, &context, &images)), plane);
    let step: Vec<f32> = (0..45 * 23).map(|at| if at % 45 < 20 { 1.0 } else { 1.1 }).collect();
    let filters = Filters {
        bilateral: Some(Bilateral {
            depth_m: Some(0.01),
            ..Bilateral::USUAL
        }),
        ..Filters::NONE
    };
    let images = images_of(Arc::new(DepthSamples::metres(step.clone())), size_px, filters);
    for (found, before) in depths(&made(&mut maker, &context, &images)).iter().zip(step) {
        assert!((found - before).abs() < 1e-4, "{before} became {found}");
    }
}

#[test]
fn all_filters_together_match_the_cpu() {
    let context = context();
    let mut maker = DepthMaker::default();
    for size_px in SIZES {
        let images = images_of(coded(size_px, 9), size_px, Filters::USUAL);
        let found = depths(&made(&mut maker, &context, &images));
        let expected = images.frame.filtered().unwrap();
        let differing = found.iter().zip(expected.metres()).filter(|(found, expected)| {
            // The CPU's powers of two are off by two thousandths.
            (*found - *expected).abs() > 1e-4 * expected.max(1.0)
        });
        assert_eq!(differing.count(), 0, "{size_px:?}");
    }
}

/// Frames of a group, each with those before it.
fn group(size_px: [u32; 2], count: usize, filters: Filters) -> Vec<PointImages> {
    let all: Vec<Arc<DepthSamples>> = (0..count as u32).map(|seed| coded(size_px, seed % 3)).collect();
    let rays = rays(size_px);
    (0..count)
        .map(|place| {
            let (before, depth) = (all[..place].to_vec(), Arc::clone(&all[place]));
            shown(DepthFrame::new(before, depth, Arc::clone(&rays), None, filters).unwrap())
        })
        .collect()
}

#[test]
fn the_temporal_mean_matches_the_cpu_and_a_frame_alone() {
    let context = context();
    for text in [
        "temporal",
        "temporal:fill=2",
        "near,median,bilateral,flying,temporal:share=0.7:m=0.3",
    ] {
        let filters = filters_of(text);
        for size_px in [[1, 1], [33, 17]] {
            let frames = group(size_px, 6, filters);
            let mut going_on = DepthMaker::default();
            for (index, images) in frames.iter().enumerate() {
                let points = made(&mut going_on, &context, images);
                let expected = images.frame.filtered().unwrap();
                for (found, expected) in depths(&points).iter().zip(expected.metres()) {
                    assert!(
                        (found - expected).abs() <= 1e-4 * expected,
                        "{text} {index}: {found}, {expected}"
                    );
                }
                let alone = made(&mut DepthMaker::default(), &context, images);
                assert_eq!(points, alone, "{text} {size_px:?}: frame {index}");
            }
            // Once more, and back: state cached from the last frame is only used for the same frame.
            let last = made(&mut going_on, &context, &frames[5]);
            assert_eq!(
                made(&mut going_on, &context, &frames[2]),
                made(&mut DepthMaker::default(), &context, &frames[2])
            );
            assert_eq!(last, made(&mut going_on, &context, &frames[5]));
        }
    }
}

#[test]
fn consecutive_frames_upload_one_image() {
    let context = context();
    let size_px = [32, 20];
    let frames = group(size_px, 4, filters_of("temporal"));
    let mut maker = DepthMaker::default();
    let pixels = 32 * 20;
    let once = (DepthTable::LEN * 4 + pixels * 8) as u64;
    let uploaded = |maker: &mut DepthMaker, place: usize| maker.make(&context, &frames[place]).uploaded_bytes;
    assert_eq!(uploaded(&mut maker, 1), once + 2 * 2 * pixels as u64, "two images");
    assert_eq!(uploaded(&mut maker, 2), 2 * pixels as u64, "one more");
    assert_eq!(uploaded(&mut maker, 2), 0, "the same frame");
    assert_eq!(uploaded(&mut maker, 1), 2 * 2 * pixels as u64, "an earlier one");
}

#[test]
fn points_match_the_cpu_and_have_the_colors_of_the_image() {
    let context = context();
    let mut maker = DepthMaker::default();
    for size_px in SIZES {
        let pixels = size_px[0] * size_px[1];
        let colors: Vec<[u8; 3]> = (0..pixels)
            .map(|at| [at as u8, (at >> 8) as u8 ^ 0x55, 255 - (at % 250) as u8])
            .collect();
        let depth = coded(size_px, 3);
        let frame = DepthFrame::new(Vec::new(), depth, rays(size_px), Some(colors.clone()), Filters::NONE).unwrap();
        let expected = crate::rgbd::cloud(&frame.filtered().unwrap(), frame.rays(), None);
        let images = PointImages {
            one_color: None,
            origin: Vec3::new(0.25, -0.5, 1.0),
            ..shown(frame)
        };
        let points = made(&mut maker, &context, &images);
        for (at, (point, [red, green, blue])) in points.iter().zip(colors).enumerate() {
            let place = expected.positions.get(at);
            if place.is_finite() {
                let off = (place - images.origin.as_dvec3()).as_vec3() - Vec3::from_array(point.position);
                assert!(off.length() < 1e-6, "{at}: {off}");
                assert_eq!(point.color, [red, green, blue, 255]);
            } else {
                assert_eq!((point.position, point.color), ([0.0; 3], [0; 4]));
            }
        }
    }
}

#[test]
fn pixels_outside_the_lens_are_holes() {
    let context = context();
    let size_px = [40, 30];
    let lens = Distortion::Brown {
        k: [-0.9, 0.0, 0.0],
        p: [0.0; 2],
    };
    let camera = Camera::new(size_px, DVec2::splat(14.0), DVec2::new(19.5, 14.5), lens).unwrap();
    let rays = Arc::new(RayTable::of(&camera));
    let unseen = rays.rays().iter().filter(|ray| !ray[0].is_finite()).count();
    assert!(unseen > 0);
    let samples = Arc::new(DepthSamples::metres(vec![1.0; 40 * 30]));
    let frame = DepthFrame::new(Vec::new(), samples, rays, None, Filters::NONE).unwrap();
    let points = made(&mut DepthMaker::default(), &context, &shown(frame));
    assert_eq!(points.iter().filter(|point| point.color == [0; 4]).count(), unseen);
}

#[test]
fn a_renderer_reports_pass_times_where_it_generates_points() {
    let context = context();
    let size_px = [64, 48];
    let filters = filters_of("near,median,bilateral,flying,temporal");
    let (before, depth) = (vec![coded(size_px, 1)], coded(size_px, 2));
    let frame = Arc::new(DepthFrame::new(before, depth, rays(size_px), None, filters).unwrap());
    let mut renderer = GpuRenderer::new(Arc::clone(&context)).unwrap();
    renderer.set_makes_surfels(false);
    assert_eq!(
        renderer.depth_image_times(&frame).unwrap(),
        None,
        "the processor makes them"
    );
    renderer.set_makes_surfels(true);
    let times = renderer.depth_image_times(&frame).unwrap();
    assert_eq!(times.is_some(), context.has_timestamps);
    let names: Vec<&str> = times
        .iter()
        .flat_map(|times| times.iter())
        .map(|time| time.pass)
        .collect();
    let expected = ["near", "median", "bilateral", "flying", "temporal", "reproject"];
    assert!(
        !context.has_timestamps || names == expected,
        "{names:?}: of the last image alone"
    );
}
