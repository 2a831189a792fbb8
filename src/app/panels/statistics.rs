//! Statistics of the program: work done and time taken. Every figure has its unit.

use crate::app::State;
use crate::app::meter::Redraw;
use crate::app::widgets::numbers::bytes;
use crate::app::widgets::rows::heading_of_list;
use crate::levels::LevelsSize;
use crate::levels::octree::Octree;
use crate::messages::grouped;
use crate::playback::Player;
use crate::scene::{LevelStructure, SceneStats, ScreenStats};
use crate::sequence::PreparedFrame;
use crate::source::{Live, LiveState};
use egui::{DragValue, Grid, Label, RichText, ScrollArea, Ui};
use std::time::Duration;

/// Width of the names, so that the figures of all sections stand in one column, points.
const NAME_WIDTH: f32 = 92.0;

/// The panel at the left.
pub(super) fn statistics_ui(ui: &mut Ui, state: &mut State) {
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        redraw(ui, state);
        picture_times(ui, state);
        if let Some(player) = &state.player
            && let Some(live) = player.sequence().source().live()
        {
            live_stream(ui, live, player.shown().map(|frame| frame.index));
        }
        picture(ui, state);
        if let Some(frame) = state.player.as_ref().and_then(|player| player.shown().cloned()) {
            shown_frame(ui, state, &frame);
        }
        memory(ui, state);
        heading_of_list(ui, "Adapter");
        ui.add(Label::new(&state.graphics.adapter).wrap());
    });
}

fn live_stream(ui: &mut Ui, live: &dyn Live, shown: Option<usize>) {
    let status = live.status();
    section(ui, "Live", |ui| {
        let state = match &status.state {
            LiveState::Reconnecting(problem) => format!("reconnecting: {problem}"),
            _ => "connected".to_owned(),
        };
        row(ui, "Stream", state, "A connection that breaks is made again by itself");
        let behind = shown.and_then(|shown| live.frames_behind(shown));
        let behind = behind.map_or_else(|| "not in the ring".to_owned(), |frames| format!("{frames} frames"));
        row(
            ui,
            "Behind",
            behind,
            "How many frames are newer than the one that is shown",
        );
        let delay = status.delay_s.map_or_else(
            || "not yet".to_owned(),
            |(delay_s, wrong_s)| format!("{:.1} ± {:.1} ms", 1e3 * delay_s, 1e3 * wrong_s),
        );
        let tooltip = "Latency of the newest frame, from sending to arrival. Clocks of two machines differ: the \
            offset estimated by pings is uncertain by half of their round trip";
        row(ui, "Delay", delay, tooltip);
        let rate = format!("{:.1} MB/s, {:.1} fps", status.bytes_per_s * 1e-6, status.frames_per_s);
        row(ui, "Arriving", rate, "In the last two seconds");
        let lost = format!(
            "{} of {}",
            grouped(status.lost_frames),
            grouped(status.lost_frames + status.received_frames)
        );
        row(
            ui,
            "Lost",
            lost,
            "Frames that the server dropped for newer ones, or did not make in time",
        );
        let stored = format!("{:.1} s, {}", status.buffered_s, bytes(status.buffered_bytes as u64));
        row(ui, "Kept", stored, "Length of the rewind buffer; set by --live-seconds");
        if let Some(recording) = &status.recording {
            let recorded = format!("{} frames, {}", grouped(recording.frames), bytes(recording.bytes));
            row(ui, "Recording", recorded, &recording.path.display().to_string());
        }
    });
}

fn section(ui: &mut Ui, name: &str, add: impl FnOnce(&mut Ui)) {
    heading_of_list(ui, name);
    Grid::new(name)
        .num_columns(2)
        .min_col_width(NAME_WIDTH)
        .spacing([10.0, 4.0])
        .show(ui, |ui| {
            ui.spacing_mut().interact_size.y = 16.0;
            add(ui);
        });
}

fn row(ui: &mut Ui, name: &str, value: impl Into<String>, tooltip: &str) {
    ui.label(name).on_hover_text(tooltip);
    ui.label(RichText::new(value).monospace()).on_hover_text(tooltip);
    ui.end_row();
}

fn milliseconds(value: f64) -> String {
    format!("{value:.2} ms")
}

/// The parts of a redraw, each with an explanation.
fn parts(redraw: &Redraw) -> [(&'static str, Duration, &'static str); 5] {
    [
        ("  panels", redraw.panels, "Moving on, and running the panels"),
        ("  picture", redraw.drawing, "Rendering the 3D view"),
        ("  painting", redraw.painting, "Painting the changed parts"),
        (
            "  presenting",
            redraw.presenting,
            "Handing the window to the window system or the driver",
        ),
        (
            "  waiting",
            redraw.waiting,
            "For the screen, or for a driver that is behind",
        ),
    ]
}

/// The last run of the panels with its parts, which add up, and the state of playback.
fn redraw(ui: &mut Ui, state: &State) {
    let graphics = &state.graphics;
    section(ui, "Last redraw", |ui| {
        row(
            ui,
            "CPU",
            milliseconds(graphics.frame_ms),
            "CPU time of the last redraw, with its parts below. A redraw without changes of the view renders \
                nothing",
        );
        for (name, part, tooltip) in parts(&graphics.redraw) {
            row(ui, name, milliseconds(part.as_secs_f64() * 1e3), tooltip);
        }
        let held = state.player.as_ref().and_then(Player::fps_held);
        let held = held.map_or_else(|| "paused".to_owned(), |fps| format!("{fps:.1} fps"));
        row(ui, "Rate held", held, "Frames per second shown in the last second");
        let skipped = state.player.as_ref().map_or(0, |player| player.clock().skipped());
        row(
            ui,
            "Skipped",
            grouped(skipped),
            "Frames that were due but never shown, because drawing was too slow",
        );
    });
}

/// Shows the timing of the last image, which need not be of the last redraw; measured values only.
fn picture_times(ui: &mut Ui, state: &State) {
    let render = &state.graphics.render;
    if render.frames == 0 {
        return;
    }
    let draws_on_gpu = !state.draws_on_processor();
    section(ui, "Time of the last render", |ui| {
        row(
            ui,
            "Preparing",
            milliseconds(render.prepare_ms),
            "Uploading data for the render",
        );
        let (name, tooltip) = if draws_on_gpu {
            ("Encoding", "Recording and submitting GPU commands")
        } else {
            ("Drawing", "Rendering on all CPU cores")
        };
        row(ui, name, milliseconds(render.encode_ms), tooltip);
        if !draws_on_gpu {
            return;
        }
        if let Some(gpu_ms) = render.gpu_ms {
            let tooltip = "GPU time of the last measured render, by timestamp queries";
            row(ui, "GPU", milliseconds(gpu_ms), tooltip);
        }
        for time in render.gpu_passes.iter() {
            if let Some(gpu_ms) = time.gpu_ms {
                row(ui, &format!("  {}", time.pass), milliseconds(gpu_ms), "This pass of it");
            }
        }
        for time in render.image_passes.iter() {
            if let Some(gpu_ms) = time.gpu_ms {
                let tooltip = "This pass over the images of a depth camera, once per frame";
                row(ui, &format!("  {}", time.pass), milliseconds(gpu_ms), tooltip);
            }
        }
    });
}

fn picture(ui: &mut Ui, state: &mut State) {
    let draws_on_processor = state.draws_on_processor();
    let render = &state.graphics.render;
    let [width, height] = state.viewport.size_px;
    section(ui, "Picture", |ui| {
        row(
            ui,
            "Size",
            format!("{width} × {height} px"),
            "Physical pixels of the 3D view",
        );
        row(
            ui,
            "Drawn",
            grouped(render.records),
            "Points, surfels, voxels or triangles of the last render, each counted once",
        );
        if draws_on_processor {
            let tooltip = "The same, counted in each tile that they overlap";
            row(ui, "In tiles", grouped(render.drawn_instances), tooltip);
        } else {
            let tooltip = "The same, counted in each pass that draws them";
            row(ui, "In passes", grouped(render.drawn_instances), tooltip);
            row(
                ui,
                "Draw calls",
                grouped(u64::from(render.draw_calls)),
                "Draw calls of the last render",
            );
        }
        row(
            ui,
            "Pictures",
            grouped(render.frames),
            "Renders so far; none while nothing changes",
        );
        if !draws_on_processor {
            row(ui, "Passes", grouped(render.passes), "Render and compute passes so far");
            row(
                ui,
                "Uploads",
                grouped(render.uploads),
                "Uploads of points or voxels so far",
            );
            row(ui, "Uploaded", bytes(render.uploaded_bytes), "Bytes of these uploads");
            row(
                ui,
                "On the GPU",
                bytes(render.resident_bytes),
                "Points and voxels in GPU memory now",
            );
            let mut budget_mib = state.graphics.budget_bytes as f64 / f64::from(1 << 20);
            let tooltip = "GPU memory limit for points and voxels, MiB. The least recently drawn data is evicted";
            if budget_row(ui, "GPU budget", &mut budget_mib, tooltip) {
                state.graphics.budget_bytes = (budget_mib * f64::from(1 << 20)) as u64;
            }
        }
        row(
            ui,
            "Redraws",
            grouped(state.shared.counters.ui_passes),
            "Runs of the panels so far",
        );
    });
}

fn shown_frame(ui: &mut Ui, state: &State, frame: &PreparedFrame) {
    let timings = &frame.timings;
    section(ui, "Frame", |ui| {
        row(
            ui,
            "Points",
            grouped(frame.points.len() as u64),
            "Points of the current frame",
        );
        let dropped = frame.frame.dropped_points() as u64;
        if dropped > 0 {
            row(
                ui,
                "Skipped",
                grouped(dropped),
                "Points of the file without finite coordinates",
            );
        }
        if let Some(mesh) = &frame.mesh {
            row(
                ui,
                "Triangles",
                grouped(mesh.mesh().triangles().len() as u64),
                "Triangles of the file, which were read as they are drawn",
            );
        }
        row(
            ui,
            "Decode",
            milliseconds(timings.decode_ms.into()),
            "Reading and checking the file, on a worker",
        );
        row(
            ui,
            "Analysis",
            milliseconds(timings.analysis_ms.into()),
            "Normals and radii, on a worker; 0 if in the file",
        );
        row(
            ui,
            "Packing",
            milliseconds(timings.records_ms.into()),
            "Writing the records that are uploaded, on a worker",
        );
    });
    if let Some(screen) = state.screen_stats() {
        section(ui, "Screen-space normals", |ui| screen_rows(ui, &screen));
    }
    if let Some(octree) = frame.levels.octree() {
        octree_ui(ui, octree, timings.octree_ms, &state.scene_stats());
    } else if let Some((kind, levels)) = frame.levels.of_surfels() {
        section(ui, "Levels of detail", |ui| {
            levels_rows(ui, LevelStructure::of(kind), levels.size());
            traversal_rows(ui, timings.octree_ms, &state.scene_stats());
        });
    }
}

/// Shows the contents of the last image, and the cost of its normals.
fn screen_rows(ui: &mut Ui, screen: &ScreenStats) {
    row(
        ui,
        "Visible points",
        grouped(screen.visible as u64),
        "Visible points: not hidden by others",
    );
    if let Some(cull_ms) = screen.cull_ms {
        row(
            ui,
            "Culling",
            milliseconds(cull_ms),
            "Telling visible points from hidden ones, for each view",
        );
    }
    if let Some(normals_ms) = screen.normals_ms {
        row(
            ui,
            "Planes",
            milliseconds(normals_ms),
            "Normals and radii of the visible points, for each view",
        );
    }
}

/// The tree, and its last drawn part.
fn octree_ui(ui: &mut Ui, octree: &Octree, build_ms: f32, scene: &SceneStats) {
    section(ui, "Octree", |ui| {
        row(
            ui,
            "Depth",
            octree.depth().to_string(),
            "Level of the deepest leaves; the root is 0",
        );
        row(
            ui,
            "Nodes",
            grouped(octree.node_count() as u64),
            "Internal nodes and leaves",
        );
        row(
            ui,
            "Leaves",
            grouped(octree.leaf_count() as u64),
            "Cells that are not divided",
        );
        row(
            ui,
            "Loss",
            format!("{:.2} %", octree.loss() * 100.0),
            "Percentage of points that share a leaf with another one",
        );
        traversal_rows(ui, build_ms, scene);
    });
}

/// A structure without an octree.
fn levels_rows(ui: &mut Ui, structure: LevelStructure, size: LevelsSize) {
    row(ui, "Structure", structure.name(), "Source of the surfels");
    row(
        ui,
        "Nodes",
        grouped(size.nodes as u64),
        "Points, and nodes that represent them",
    );
    row(
        ui,
        "Memory",
        bytes(size.bytes as u64),
        "In addition to the points themselves",
    );
}

/// Shows the statistics of the levels of detail that were last drawn.
fn traversal_rows(ui: &mut Ui, build_ms: f32, scene: &SceneStats) {
    row(ui, "Build", milliseconds(build_ms.into()), "Building it, on a worker");
    row(
        ui,
        "Traverse",
        milliseconds(scene.traverse_time.as_secs_f64() * 1e3),
        "Selecting the cells to draw, and writing their representatives",
    );
    row(
        ui,
        "Visited",
        grouped(scene.visited_nodes as u64),
        "Nodes visited by the last traversal",
    );
    row(
        ui,
        "Visible",
        grouped(scene.emitted_voxels as u64),
        "Voxels or surfels found by the last traversal",
    );
    if scene.duplicates > 0 {
        row(
            ui,
            "Duplicates",
            grouped(scene.duplicates as u64),
            "Those of them for whose points another one is drawn, too",
        );
    }
    let threshold = scene
        .lod_px
        .map_or_else(|| "a fixed level".to_owned(), |lod_px| format!("{lod_px:.2} px"));
    row(
        ui,
        "Smallest cell (τ)",
        threshold,
        "Cells that are smaller on the screen were not divided; found by the last traversal if there is a budget",
    );
    row(
        ui,
        "Traversals",
        grouped(scene.traversals),
        "Traversals so far; none while nothing changes",
    );
}

fn memory(ui: &mut Ui, state: &mut State) {
    let Some(stats) = state.player.as_ref().map(|player| player.loader().stats()) else {
        return;
    };
    let mut budget_mib = state.budget_bytes() as f64 / f64::from(1 << 20);
    let mut changed = false;
    section(ui, "Memory for frames", |ui| {
        row(
            ui,
            "In use",
            bytes(stats.resident_bytes as u64),
            "Prepared frames in main memory",
        );
        if let Some(split_view) = &state.features.split_view {
            let stats = split_view.companion.loader().stats();
            row(
                ui,
                "  of B",
                bytes(stats.resident_bytes as u64),
                "Prepared frames of the other sequence, which has half of the budget",
            );
        }
        changed = budget_row(
            ui,
            "Budget",
            &mut budget_mib,
            "Maximum memory for prepared frames, MiB. Frames that the playhead needs last are evicted first",
        );
        row(
            ui,
            "Frames",
            grouped(stats.resident_frames as u64),
            "Frames in main memory",
        );
        row(ui, "Decoded", grouped(stats.decoded), "Files decoded so far");
        row(
            ui,
            "Normals",
            grouped(stats.surfaces_estimated),
            "Frames whose normals were estimated",
        );
        row(ui, "Octrees", grouped(stats.octrees_built), "Octrees built so far");
        row(
            ui,
            "Evicted",
            grouped(stats.evicted),
            "Frames that made room for others",
        );
        row(
            ui,
            "Failed",
            grouped(stats.failed_frames as u64),
            "Frames that cannot be shown",
        );
    });
    if changed {
        state.set_budget_bytes((budget_mib * f64::from(1 << 20)) as usize);
    }
}

/// A budget that can be changed; true if it was.
fn budget_row(ui: &mut Ui, name: &str, budget_mib: &mut f64, tooltip: &str) -> bool {
    let label = ui.label(name).on_hover_text(tooltip);
    let drag = DragValue::new(budget_mib)
        .range(16.0..=1_048_576.0)
        .speed(8.0)
        .max_decimals(0)
        .suffix(" MiB");
    let changed = ui.add(drag).labelled_by(label.id).on_hover_text(tooltip).changed();
    ui.end_row();
    changed
}
