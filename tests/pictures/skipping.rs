//! The counters prove that work is skipped: resident data is not uploaded, an unchanged image is not drawn.

use crate::common::{self, camera_at, cost, plain, sphere, surfels, voxels};
use pointreel::cloud::VoxelRecord;
use pointreel::levels::Lod;
use pointreel::render::gpu::GpuRenderer;
use pointreel::render::{RenderError, Renderer};
use pointreel::scene::{Camera, Content, Lighting, Primitive, Scene, ScenePacket, Splatting, Strategy, Style};
use pointreel::sequence::{PrepareCounters, Sequence, prepare};
use std::sync::Arc;

#[test]
fn an_unchanged_image_costs_nothing() {
    let mut renderer = GpuRenderer::new(common::context()).unwrap();
    for &strategy in Strategy::ALL {
        let style = plain().with(|style| style.drawing.strategy = strategy);
        let packet = surfels(&sphere(500, 1.0), &camera_at(3.0), style, [64, 64]);
        assert_eq!(cost(&mut renderer, &packet).frames, 1);
        let again = cost(&mut renderer, &packet.clone());
        assert_eq!((again.frames, again.passes, again.uploads), (0, 0, 0), "{strategy}");
    }
}

#[test]
fn a_moved_camera_uploads_nothing() {
    for &strategy in Strategy::ALL {
        let mut renderer = GpuRenderer::new(common::context()).unwrap();
        let style = plain().with(|style| style.drawing.strategy = strategy);
        let mut packet = surfels(&sphere(500, 1.0), &camera_at(3.0), style, [64, 64]);
        let first = cost(&mut renderer, &packet);
        assert_eq!(
            (first.uploads, first.uploaded_bytes),
            (2, 2 * 500 * 16),
            "{strategy}: points and shapes"
        );
        packet.view = camera_at(2.5).transform(glam::DVec3::ZERO, packet.viewport_px);
        let moved = cost(&mut renderer, &packet);
        assert_eq!((moved.frames, moved.uploads), (1, 0), "{strategy}");
    }
}

#[test]
fn moving_among_voxels_only_uploads_the_new_visible_set() {
    let mut renderer = GpuRenderer::new(common::context()).unwrap();
    let style = Style {
        primitive: Primitive::Voxel,
        ..plain()
    };
    let record = VoxelRecord {
        center: [0.0; 3],
        color: [9; 3],
        level: 2,
    };
    let first = voxels(vec![record; 10], 1.0, &camera_at(3.0), style, [64, 64]);
    cost(&mut renderer, &first);
    let second = voxels(vec![record; 7], 1.0, &camera_at(3.0), style, [64, 64]);
    drop(first);
    let moved = cost(&mut renderer, &second);
    assert_eq!((moved.uploads, moved.uploaded_bytes), (1, 7 * 16));
}

#[test]
fn points_do_not_upload_shapes_and_surfels_then_upload_only_shapes() {
    let mut renderer = GpuRenderer::new(common::context()).unwrap();
    let as_surfels = surfels(&sphere(500, 1.0), &camera_at(3.0), plain(), [64, 64]);
    let points = ScenePacket {
        style: Style {
            primitive: Primitive::Point,
            ..plain()
        }
        .painted(),
        content: Content::Points(Arc::clone(as_surfels.content.points().unwrap())),
        ..as_surfels.clone()
    };
    assert_eq!(cost(&mut renderer, &points).uploaded_bytes, 500 * 16);
    assert_eq!(cost(&mut renderer, &as_surfels).uploaded_bytes, 500 * 16);
    assert_eq!(cost(&mut renderer, &points).uploads, 0, "back to points");
}

#[test]
fn looping_over_a_sequence_uploads_each_pose_once() {
    let mut renderer = GpuRenderer::new(common::context()).unwrap();
    let poses: Vec<ScenePacket> = (1..=5)
        .map(|pose| surfels(&sphere(100 * pose, 1.0), &camera_at(3.0), plain(), [64, 64]))
        .collect();
    let uploads: u64 = poses.iter().map(|pose| cost(&mut renderer, pose).uploads).sum();
    assert_eq!(uploads, 10);
    let uploads: u64 = poses.iter().map(|pose| cost(&mut renderer, pose).uploads).sum();
    assert_eq!(uploads, 0, "second round");
}

#[test]
fn dropped_data_is_freed_on_the_gpu() {
    let mut renderer = GpuRenderer::new(common::context()).unwrap();
    for _ in 0..20 {
        let packet = surfels(&sphere(1000, 1.0), &camera_at(3.0), plain(), [64, 64]);
        renderer.prepare(&packet).unwrap();
        renderer.render().unwrap();
        // The renderer itself holds the packets of two images: the drawn and the prepared one.
        assert!(
            renderer.stats().resident_bytes <= 2 * 2 * 1000 * 16,
            "{}",
            renderer.stats().resident_bytes
        );
    }
}

#[test]
fn the_octree_is_traversed_only_when_the_answer_can_differ() {
    let sequence = Sequence::demo();
    let style = Style {
        primitive: Primitive::Voxel,
        ..plain()
    };
    let frame = prepare(
        0,
        Arc::new(sequence.frame(0).unwrap()),
        0.0,
        &Scene::needs(&style),
        &PrepareCounters::default(),
    );
    let mut scene = Scene::default();
    let mut traversals = |camera: &Camera, style: &Style, size| {
        let packet = scene.packet(&frame, sequence.origin(), camera, style, size);
        (scene.stats().traversals, packet.content.voxels().cloned())
    };
    let camera = camera_at(3.0);
    let (count, first) = traversals(&camera, &style, [64, 64]);
    assert_eq!(count, 1);
    let (count, again) = traversals(&camera, &style, [64, 64]);
    assert_eq!(count, 1, "untouched");
    assert!(Arc::ptr_eq(&first.unwrap().records, &again.unwrap().records));
    let lit = style.with(|style| style.light.lighting = Lighting::PerFragment);
    assert_eq!(traversals(&camera, &lit, [64, 64]).0, 1, "light");
    let as_points = Style {
        primitive: Primitive::Point,
        ..style
    };
    let (count, voxels) = traversals(&camera, &as_points, [64, 64]);
    assert!(count == 1 && voxels.is_none(), "points need no octree");
    assert_eq!(traversals(&camera_at(2.0), &style, [64, 64]).0, 2, "camera");
    let coarse = style.with(|style| style.levels.lod = Lod::ThresholdPx(8.0));
    assert_eq!(traversals(&camera_at(2.0), &coarse, [64, 64]).0, 3, "LOD");
    assert_eq!(traversals(&camera_at(2.0), &coarse, [64, 32]).0, 4, "viewport");
}

#[test]
fn each_mode_runs_only_its_passes() {
    let mut renderer = GpuRenderer::new(common::context()).unwrap();
    let expected = [
        (Splatting::Regular, 2),
        (Splatting::NoDepth, 2),
        (Splatting::Visibility, 3),
        (Splatting::TwoPass, 4),
        (Splatting::Enlarged, 4),
        (Splatting::TwoPassEnlarged, 4),
    ];
    for (splatting, passes) in expected {
        let style = plain().with(|style| style.surfels.splatting = splatting);
        let packet = surfels(&sphere(100, 1.0), &camera_at(3.0), style, [64, 64]);
        assert_eq!(cost(&mut renderer, &packet).passes, passes, "{splatting}");
    }
}

#[test]
fn a_lost_device_is_an_error_not_a_crash() {
    let context = common::open(&common::software());
    let mut renderer = GpuRenderer::new(Arc::clone(&context)).unwrap();
    let packet = surfels(&sphere(100, 1.0), &camera_at(3.0), plain(), [64, 64]);
    cost(&mut renderer, &packet);
    context.simulate_loss();
    assert!(matches!(renderer.prepare(&packet), Err(RenderError::DeviceLost { .. })));
    assert!(matches!(renderer.render(), Err(RenderError::DeviceLost { .. })));
    assert!(matches!(renderer.read_image(), Err(RenderError::DeviceLost { .. })));
}

#[test]
fn data_that_does_not_fit_evicts_everything_else_and_then_is_an_error() {
    let context = common::open(&common::software());
    let mut renderer = GpuRenderer::new(Arc::clone(&context)).unwrap();
    let clouds = [100, 200].map(|count| sphere(count, 1.0));
    let packets = clouds
        .each_ref()
        .map(|cloud| surfels(cloud, &camera_at(3.0), plain(), [64, 64]));
    let expected = packets.each_ref().map(|packet| {
        cost(&mut renderer, packet);
        renderer.read_image().unwrap()
    });
    let both_bytes = renderer.stats().resident_bytes;

    let mut renderer = GpuRenderer::new(Arc::clone(&context)).unwrap();
    cost(&mut renderer, &packets[0]);
    let first_bytes = renderer.stats().resident_bytes;
    context.simulate_out_of_memory(1);
    cost(&mut renderer, &packets[1]);
    assert_eq!(
        renderer.stats().resident_bytes,
        both_bytes - first_bytes,
        "the first made room"
    );
    assert!(renderer.read_image().unwrap() == expected[1]);

    context.simulate_out_of_memory(2);
    assert!(matches!(
        renderer.prepare(&packets[0]),
        Err(RenderError::OutOfMemory { what: "the cloud" })
    ));
    assert_eq!(renderer.stats().resident_bytes, 0);
    cost(&mut renderer, &packets[0]);
    assert!(renderer.read_image().unwrap() == expected[0], "memory came back");
}

#[test]
fn a_gpu_budget_is_respected() {
    let mut renderer = GpuRenderer::new(common::context()).unwrap();
    let clouds = [100; 3].map(|count| sphere(count, 1.0));
    let packets = clouds
        .each_ref()
        .map(|cloud| surfels(cloud, &camera_at(3.0), plain(), [64, 64]));
    cost(&mut renderer, &packets[0]);
    let one_bytes = renderer.stats().resident_bytes;
    cost(&mut renderer, &packets[1]);
    assert_eq!(renderer.stats().resident_bytes, 2 * one_bytes);
    renderer.set_resident_budget_bytes(one_bytes);
    cost(&mut renderer, &packets[2]);
    assert_eq!(renderer.stats().resident_bytes, one_bytes);
}

#[test]
fn an_image_beyond_the_adapter_limit_is_rejected() {
    let mut renderer = GpuRenderer::new(common::context()).unwrap();
    let packet = surfels(&[], &camera_at(3.0), plain(), [1, 1_000_000]);
    assert!(matches!(
        renderer.prepare(&packet),
        Err(RenderError::TooLarge { height: 1_000_000, .. })
    ));
    assert!(matches!(renderer.render(), Err(RenderError::NothingPrepared)));
}
