//! Nodes of levels of detail whose records are resident: a moving view uploads indices, and draws the same bytes.

use crate::common::{self, camera_at, colored_sphere, cost, plain};
use glam::DVec3;
use pointreel::levels::Lod;
use pointreel::render::Renderer;
use pointreel::render::cpu::CpuRenderer;
use pointreel::render::gpu::{Context, ContextOptions, GpuRenderer};
use pointreel::scene::{Content, LevelStructure, PointSizing, Primitive, Scene, ScenePacket, Strategy, Style};
use pointreel::sequence::PreparedFrame;
use std::sync::Arc;

const SIZE: [u32; 2] = [120, 100];
const POINTS: u32 = 5000;

/// Those whose nodes have records that stay, and how fine they are drawn: a list knows no screen-space size.
const STRUCTURES: [(LevelStructure, Lod); 6] = [
    (LevelStructure::Octree, Lod::ThresholdPx(3.0)),
    (LevelStructure::None, Lod::Budget(POINTS / 3)),
    (LevelStructure::QSplat, Lod::ThresholdPx(3.0)),
    (LevelStructure::Sequential, Lod::ThresholdPx(3.0)),
    (LevelStructure::Printed, Lod::ThresholdPx(3.0)),
    (LevelStructure::Hierarchical, Lod::ThresholdPx(3.0)),
];

fn style((structure, lod): (LevelStructure, Lod), strategy: Strategy) -> Style {
    let style = plain().with(|style| {
        style.levels.surfel_lod = true;
        style.levels.structure = structure;
        style.levels.lod = lod;
        style.drawing.strategy = strategy;
    });
    style.drawn_by(false)
}

/// A moving view of a scene that has written enough records before.
struct Moving {
    scene: Scene,
    frame: PreparedFrame,
    style: Style,
}

impl Moving {
    fn new(style: Style) -> Self {
        let frame = colored_sphere(POINTS, &style);
        let mut moving = Self {
            scene: Scene::default(),
            frame,
            style,
        };
        for distance in [1.7, 3.0, 6.0] {
            for step in 0..12 {
                moving.at(distance + 0.01 * f64::from(step));
            }
        }
        moving
    }

    fn at(&mut self, distance: f64) -> ScenePacket {
        let camera = camera_at(distance);
        self.scene.packet(&self.frame, DVec3::ZERO, &camera, &self.style, SIZE)
    }
}

/// A device that draws at most a thousand records at once.
fn context_of_small_chunks() -> Arc<Context> {
    let options = ContextOptions {
        prefer_software: true,
        max_chunk_records: Some(1000),
    };
    Context::headless(&options).unwrap()
}

/// The packet with contiguous records.
fn gathered(packet: &ScenePacket) -> ScenePacket {
    let Content::Selected(selected) = &packet.content else {
        panic!("nodes are selected")
    };
    ScenePacket {
        content: Content::Surfels(selected.gathered()),
        ..packet.clone()
    }
}

#[test]
fn a_moving_view_uploads_four_bytes_per_node_and_a_still_one_nothing() {
    for structure in STRUCTURES {
        for &strategy in Strategy::ALL {
            let mut renderer = GpuRenderer::new(common::context()).unwrap();
            let mut moving = Moving::new(style(structure, strategy));
            let name = format!("{} by {strategy}", structure.0);
            // Views at all distances select all levels of an octree.
            for distance in [3.0, 1.7, 6.0] {
                cost(&mut renderer, &moving.at(distance));
            }
            let resident = renderer.stats().resident_bytes;
            assert!(resident >= u64::from(POINTS) * 32, "{name}: all nodes");
            for distance in [2.9, 3.1, 1.7, 6.0] {
                let packet = moving.at(distance);
                let nodes = packet.content.record_count() as u64;
                let moved = cost(&mut renderer, &packet);
                assert_eq!(moved.frames, 1);
                assert!(nodes > 100 && moved.uploaded_bytes <= 4 * nodes, "{name}: {moved:?}");
                assert_eq!(moved.drawn_instances % nodes, 0, "{name}");
                let still = cost(&mut renderer, &moving.at(distance));
                assert_eq!((still.frames, still.uploads, still.passes), (0, 0, 0), "{name}");
            }
        }
    }
}

#[test]
fn images_of_selected_nodes_match_those_of_gathered_ones() {
    let mut processor = CpuRenderer::new();
    let mut of_processor = |packet: &ScenePacket| {
        processor.prepare(packet).unwrap();
        processor.render().unwrap();
        processor.read_image().unwrap()
    };
    for structure in STRUCTURES {
        let mut by_strategy = Vec::new();
        for &strategy in Strategy::ALL {
            // Also with small chunks, which node ranges cross.
            let mut renderer = GpuRenderer::new(context_of_small_chunks()).unwrap();
            let mut moving = Moving::new(style(structure, strategy));
            let mut pictures = Vec::new();
            for distance in [3.0, 1.6, 5.0] {
                let packet = moving.at(distance);
                for packet in [packet.clone(), gathered(&packet)] {
                    renderer.prepare(&packet).unwrap();
                    renderer.render().unwrap();
                    pictures.push(renderer.read_image().unwrap());
                }
                let [.., selected, gathered_picture] = &pictures[..] else {
                    panic!("two pictures")
                };
                assert!(
                    selected == gathered_picture,
                    "{} by {strategy} from {distance}",
                    structure.0
                );
                assert!(
                    of_processor(&packet) == of_processor(&gathered(&packet)),
                    "{} by the processor",
                    structure.0
                );
            }
            by_strategy.push(pictures);
        }
        assert!(by_strategy.windows(2).all(|two| two[0] == two[1]), "{}", structure.0);
    }
}

#[test]
fn selected_nodes_may_be_drawn_as_points() {
    let mut renderer = GpuRenderer::new(common::context()).unwrap();
    let mut moving = Moving::new(style(STRUCTURES[3], Strategy::Storage));
    let packet = moving.at(3.0);
    let as_points = |packet: &ScenePacket| ScenePacket {
        style: packet.style.with(|style| {
            style.primitive = Primitive::Point;
            style.points.sizing = PointSizing::Projected;
        }),
        ..packet.clone()
    };
    let pictures = [as_points(&packet), as_points(&gathered(&packet))].map(|packet| {
        renderer.prepare(&packet).unwrap();
        renderer.render().unwrap();
        renderer.read_image().unwrap()
    });
    assert!(pictures[0] == pictures[1]);
}

#[test]
fn nodes_beyond_the_budget_are_gathered_and_look_the_same() {
    for &strategy in Strategy::ALL {
        let mut moving = Moving::new(style(STRUCTURES[4], strategy));
        let packet = moving.at(3.0);
        let nodes = packet.content.record_count() as u64;
        let mut renderer = GpuRenderer::new(common::context()).unwrap();
        renderer.set_resident_budget_bytes(64 * 1024);
        let stats = cost(&mut renderer, &packet);
        assert_eq!(stats.uploaded_bytes, 32 * nodes, "{strategy}: gathered");
        let of_small_budget = renderer.read_image().unwrap();
        renderer.set_resident_budget_bytes(1 << 30);
        let moved = moving.at(3.0);
        renderer.prepare(&gathered(&moved)).unwrap();
        renderer.render().unwrap();
        assert!(of_small_budget == renderer.read_image().unwrap(), "{strategy}");
    }
}
