//! Table 2 of Sainz and Pajarola 2004: level-of-detail structures from three distances.
//!
//! **How it works.** Clouds of a torus with the requested numbers of points are measured in addition to the inputs.
//! Each step turns around the object by 2°, as in the paper (§6.1). In each step a structure is cut and its records are
//! selected (LOD time) and uploaded, and the image is drawn. All structures take their turn at a view before the next
//! step, so that a slowdown of the machine affects all of them. *none* draws all points as they are, which are
//! resident. Records of all nodes are resident as well, once a structure has written that many: mostly before the
//! rounds that are counted.
//!
//! The paper drew points on the hardware of 2004; its times are listed next to ours for their ratios, not as absolute
//! times.

use super::paper_style::surfel_style;
use super::pass_samples::PassSamples;
use super::turning::{VIEWS, cameras};
use crate::bench::report::{Cell, Column, Row};
use crate::bench::run::Run;
use crate::bench::statistics::mean;
use crate::bench::subject::Subject;
use crate::bench::suite::{Defaults, OptionGroup, Suite};
use crate::bench::{BenchError, Quantiles};
use crate::levels::LevelsSize;
use crate::scene::{Camera, Content, LevelStructure, LevelStyle, Scene, Style};
use crate::sequence::{PrepareCounters, PreparedFrame, complete};

/// Names of the tables.
const STRUCTURE_TABLE: &str = "structures";
const PASS_TABLE: &str = "passes";

/// Columns of both tables; the first names the table of a row.
const COLUMNS: &[Column] = &[
    Column::text(Column::TABLE, "table"),
    Column::text("sequence", "sequence"),
    Column::text("structure", "structure"),
    Column::text("view", "view"),
    Column::number("points", "points", 0).hidden(),
    Column::number("nodes", "nodes", 0).hidden(),
    Column::number("bytes_per_node", "bytes a node", 1),
    Column::number("build_ms_median", "build ms", 2),
    Column::number("build_per_octree", "/ octree", 2),
    Column::number("lod_ms_median", "LOD ms", 3),
    Column::number("upload_ms_median", "upload ms", 3),
    Column::number("uploaded_bytes_per_node", "bytes a drawn node", 2),
    Column::number("render_ms_median", "render ms", 3),
    Column::number("gpu_ms_median", "GPU ms", 3),
    Column::number("total_ms_median", "total ms", 3),
    Column::number("total_ms_q1", "25 %", 3).hidden(),
    Column::number("total_ms_q3", "75 %", 3).hidden(),
    Column::number("total_per_none", "/ none", 2),
    Column::number("total_per_octree", "/ octree", 2),
    Column::number("processed_nodes", "processed", 0),
    Column::number("processed_per_octree", "/ octree", 2),
    Column::number("drawn_nodes", "drawn", 0),
    Column::number("duplicates", "duplicates", 0),
    Column::number("paper_lod_ms", "paper: LOD ms", 0),
    Column::number("paper_render_ms", "render ms", 0),
    Column::number("paper_points", "points", 0),
    Column::number("paper_total_per_none", "/ none", 2),
    Column::number("samples", "pictures", 0).hidden(),
    Column::text("pass", "pass"),
    Column::number("pass_gpu_ms_median", "GPU ms", 3),
];

/// Structures of levels of detail from three distances.
pub const LOD: &Suite = &Suite {
    name: "lod",
    brief: "level-of-detail structures: Table 2 of Sainz and Pajarola 2004",
    title: "LOD structures",
    hint: "Cutting and drawing each level-of-detail structure, from three distances (Sainz and Pajarola 2004, Table 2)",
    description: "structures of levels of detail, surfels, from three distances, turning by 2° a picture",
    measured: "choosing nodes and writing their records (LOD ms), uploading these, and CPU wall time from packet to \
        finished picture (render ms); the total is all three; GPU ms and the table of passes are timestamps of the \
        adapter, medians; processed nodes are those that were looked at; LOD \
        threshold of 1 pixel by edges",
    not_measured: "decoding, normals, reading back, showing; the octree works surfels out while it is cut, the others \
        while they are built; the paper's are points of the David head (2,000,646) on a GeForce 5900",
    covered_by: "surfels",
    defaults: Defaults {
        viewport_px: [640, 480],
        viewpoints: Defaults::PROTOCOL_VIEWPOINTS,
        frames: 1,
    },
    takes: &[OptionGroup::Clouds],
    is_of_paper: false,
    has_paper_layout: false,
    columns: COLUMNS,
    headline: "total_ms_median",
    bars_title: "LOD, upload and render time of a picture, median ms",
    bar_labels: 3,
};

/// The one that all points are drawn of comes first, then the octree, as others are compared with them.
const STRUCTURES: [LevelStructure; 6] = [
    LevelStructure::None,
    LevelStructure::Octree,
    LevelStructure::QSplat,
    LevelStructure::Sequential,
    LevelStructure::Printed,
    LevelStructure::Hierarchical,
];

/// Row of a structure in [`STRUCTURES`].
const NONE: usize = 0;
const OCTREE: usize = 1;

/// One step to prepare a frame, one to build each structure, one for each view.
const STEPS_PER_FRAME: usize = 1 + STRUCTURES.len() + VIEWS.len();

/// Measurements from the paper for one structure from one distance.
#[derive(Debug, Clone, Copy)]
struct OfPaper {
    lod_ms: f64,
    render_ms: f64,
    points: f64,
}

/// Table 2 of Sainz and Pajarola 2004 in the order of [`VIEWS`]; it has no rows for the others.
fn of_paper(structure: LevelStructure) -> Option<[OfPaper; VIEWS.len()]> {
    let row = |lod_ms: [f64; 3], render_ms: [f64; 3], points: [f64; 3]| {
        std::array::from_fn(|view| OfPaper {
            lod_ms: lod_ms[view],
            render_ms: render_ms[view],
            points: points[view],
        })
    };
    match structure {
        LevelStructure::None => Some(row([0.0; 3], [122.0; 3], [2_000_606.0; 3])),
        LevelStructure::Octree => Some(row(
            [35.0, 86.0, 40.0],
            [13.0, 65.0, 28.0],
            [148_158.0, 1_042_306.0, 443_791.0],
        )),
        LevelStructure::QSplat => Some(row(
            [91.0, 121.0, 58.0],
            [44.0, 86.0, 32.0],
            [687_051.0, 1_097_956.0, 493_014.0],
        )),
        // The paper's sequential point trees are drawn by the rule as printed.
        LevelStructure::Printed => Some(row(
            [0.0; 3],
            [110.0, 230.0, 230.0],
            [1_342_261.0, 2_802_620.0, 2_802_620.0],
        )),
        LevelStructure::Sequential | LevelStructure::Hierarchical => None,
    }
}

/// Measurements of one structure.
#[derive(Default)]
struct Measured {
    size: Option<LevelsSize>,
    build_ms: Vec<f64>,
    views: [Samples; VIEWS.len()],
}

/// Measurements of one structure from one distance.
#[derive(Default)]
struct Samples {
    lod_ms: Vec<f64>,
    upload_ms: Vec<f64>,
    uploaded_bytes: Vec<f64>,
    render_ms: Vec<f64>,
    gpu_ms: Vec<f64>,
    passes: PassSamples,
    total_ms: Vec<f64>,
    processed: Vec<f64>,
    drawn: Vec<f64>,
    duplicates: Vec<f64>,
}

/// A frame with one structure.
struct Subjected {
    style: Style,
    frame: PreparedFrame,
    scene: Scene,
}

pub(super) fn measure(run: &mut Run<'_>) -> Result<(), BenchError> {
    for subject in run.subjects(STEPS_PER_FRAME)? {
        measure_sequence(run, &subject)?;
    }
    Ok(())
}

fn measure_sequence(run: &mut Run<'_>, subject: &Subject<'_>) -> Result<(), BenchError> {
    let mut measured: [Measured; STRUCTURES.len()] = Default::default();
    let mut point_counts = Vec::new();
    let mut first_failure = None;
    for &index in &subject.chosen {
        let frame = match run.load(subject, index, STEPS_PER_FRAME, &Scene::needs(&surfel_style()))? {
            Ok(frame) => frame,
            Err(reason) => {
                first_failure.get_or_insert(reason);
                continue;
            }
        };
        point_counts.push(frame.points.len() as f64);
        let mut subjected = Vec::new();
        for (structure, measured) in STRUCTURES.into_iter().zip(&mut measured) {
            run.begin_step(format!("{}: building {structure}", subject.named(index)))?;
            subjected.push(measured.build(run, &frame, structure)?);
        }
        for (place, (view, distance)) in VIEWS.into_iter().enumerate() {
            run.begin_step(format!("{}: {view}", subject.named(index)))?;
            let cameras = cameras(subject, &frame, distance, run.options.viewpoints);
            measure_view(run, subject, &cameras, place, &mut subjected, &mut measured)?;
        }
    }
    Run::check_measured(subject, &point_counts, first_failure)?;
    let mut rows = Vec::new();
    for (structure, of_structure) in STRUCTURES.into_iter().zip(&measured) {
        for place in 0..VIEWS.len() {
            let points = mean(&point_counts);
            rows.push(of_structure.row(
                subject.name,
                points,
                structure,
                place,
                [&measured[NONE], &measured[OCTREE]],
            ));
        }
    }
    run.finish(subject, &point_counts, &[], rows);
    let pass_rows = STRUCTURES
        .into_iter()
        .zip(&measured)
        .flat_map(|(structure, of_structure)| {
            let views = VIEWS.into_iter().zip(&of_structure.views);
            views.flat_map(move |((view, _), samples)| samples.pass_rows(subject.name, structure, view))
        });
    run.add_rows(pass_rows);
    Ok(())
}

/// All structures from one camera after the other, in rounds.
fn measure_view(
    run: &mut Run<'_>,
    subject: &Subject<'_>,
    cameras: &[Camera],
    place: usize,
    subjected: &mut [Subjected],
    measured: &mut [Measured],
) -> Result<(), BenchError> {
    for round in 0..run.options.warmup + run.options.repeat {
        for camera in cameras {
            for (subjected, measured) in subjected.iter_mut().zip(&mut *measured) {
                run.check_cancelled()?;
                let samples = &mut measured.views[place];
                let is_counted = round >= run.options.warmup;
                subjected.measure(run, subject, camera, is_counted.then_some(samples))?;
            }
        }
    }
    Ok(())
}

fn style(structure: LevelStructure) -> Style {
    Style {
        levels: LevelStyle {
            surfel_lod: structure != LevelStructure::None,
            structure,
            ..LevelStyle::default()
        },
        ..surfel_style()
    }
}

impl Measured {
    fn build(
        &mut self,
        run: &Run<'_>,
        frame: &PreparedFrame,
        structure: LevelStructure,
    ) -> Result<Subjected, BenchError> {
        // The residency of all nodes' records depends on the renderer.
        let style = style(structure).drawn_by(run.runner.is_processor());
        let needs = Scene::needs(&style);
        let build = || complete(frame, &needs, &PrepareCounters::default());
        let mut built = build();
        for round in 0..run.options.warmup + run.options.repeat {
            run.check_cancelled()?;
            built = build();
            if round >= run.options.warmup && structure != LevelStructure::None {
                self.build_ms.push(f64::from(built.timings.octree_ms));
            }
        }
        let levels = built.levels.get(structure.kind());
        self.size = levels.map(|levels| levels.size());
        Ok(Subjected {
            style,
            frame: built,
            scene: Scene::default(),
        })
    }

    fn row(&self, sequence: &str, points: f64, structure: LevelStructure, place: usize, reference: [&Self; 2]) -> Row {
        let samples = &self.views[place];
        let median = |times_ms: &[f64]| Quantiles::of(times_ms).map(|quantiles| quantiles.median);
        let ratio = |a: Option<f64>, b: Option<f64>| a.zip(b).map(|(a, b)| a / b);
        let [none, octree] = reference;
        let total = Quantiles::of(&samples.total_ms);
        let total_per = |other: &Self| ratio(median(&samples.total_ms), median(&other.views[place].total_ms));
        let (processed, of_octree) = (mean(&samples.processed), mean(&octree.views[place].drawn));
        let paper = of_paper(structure).map(|views| views[place]);
        let paper_total = |paper: OfPaper| paper.lod_ms + paper.render_ms;
        let paper_none = of_paper(LevelStructure::None).map(|views| paper_total(views[place]));
        let (view, _) = VIEWS[place];
        let (uploaded, drawn) = (mean(&samples.uploaded_bytes), mean(&samples.drawn));
        Row::of_table(
            COLUMNS,
            STRUCTURE_TABLE,
            &[
                ("sequence", Cell::Text(sequence.to_owned())),
                ("structure", Cell::Text(structure.to_string())),
                ("view", Cell::Text(view.to_owned())),
                ("points", Cell::Number(points)),
                ("nodes", Cell::maybe(self.size.map(|size| size.nodes as f64))),
                (
                    "bytes_per_node",
                    Cell::maybe(self.size.map(|size| size.bytes as f64 / size.nodes as f64)),
                ),
                ("build_ms_median", Cell::maybe(median(&self.build_ms))),
                (
                    "build_per_octree",
                    Cell::maybe(ratio(median(&self.build_ms), median(&octree.build_ms))),
                ),
                ("lod_ms_median", Cell::maybe(median(&samples.lod_ms))),
                ("upload_ms_median", Cell::maybe(median(&samples.upload_ms))),
                (
                    "uploaded_bytes_per_node",
                    Cell::maybe(ratio(Some(uploaded), Some(drawn))),
                ),
                ("render_ms_median", Cell::maybe(median(&samples.render_ms))),
                ("gpu_ms_median", Cell::maybe(median(&samples.gpu_ms))),
                ("total_ms_median", Cell::maybe(total.map(|total| total.median))),
                ("total_ms_q1", Cell::maybe(total.map(|total| total.q1))),
                ("total_ms_q3", Cell::maybe(total.map(|total| total.q3))),
                ("total_per_none", Cell::maybe(total_per(none))),
                ("total_per_octree", Cell::maybe(total_per(octree))),
                ("processed_nodes", Cell::Number(processed)),
                ("processed_per_octree", Cell::Number(processed / of_octree)),
                ("drawn_nodes", Cell::Number(drawn)),
                ("duplicates", Cell::Number(mean(&samples.duplicates))),
                ("paper_lod_ms", Cell::maybe(paper.map(|paper| paper.lod_ms))),
                ("paper_render_ms", Cell::maybe(paper.map(|paper| paper.render_ms))),
                ("paper_points", Cell::maybe(paper.map(|paper| paper.points))),
                (
                    "paper_total_per_none",
                    Cell::maybe(ratio(paper.map(paper_total), paper_none)),
                ),
                ("samples", Cell::Number(samples.total_ms.len() as f64)),
            ],
        )
    }
}

impl Samples {
    fn pass_rows(&self, sequence: &str, structure: LevelStructure, view: &str) -> impl Iterator<Item = Row> {
        let medians_ms = self.passes.medians_ms();
        medians_ms.map(move |(pass, gpu_ms)| {
            Row::of_table(
                COLUMNS,
                PASS_TABLE,
                &[
                    ("sequence", Cell::Text(sequence.to_owned())),
                    ("structure", Cell::Text(structure.to_string())),
                    ("view", Cell::Text(view.to_owned())),
                    ("pass", Cell::Text(pass.to_owned())),
                    ("pass_gpu_ms_median", Cell::Number(gpu_ms)),
                ],
            )
        })
    }
}

impl Subjected {
    /// Draws one image; its times go to `samples`.
    fn measure(
        &mut self,
        run: &mut Run<'_>,
        subject: &Subject<'_>,
        camera: &Camera,
        samples: Option<&mut Samples>,
    ) -> Result<(), BenchError> {
        let viewport_px = run.options.viewport_px;
        let packet = subject.packet(&mut self.scene, &self.frame, camera, &self.style, viewport_px);
        let upload = run.runner.upload(&packet)?;
        let time = run.runner.draw(&packet)?;
        if let Some(samples) = samples {
            let stats = self.scene.stats();
            let lod_ms = stats.traverse_time.as_secs_f64() * 1e3;
            let drawn = match &packet.content {
                Content::Selected(selected) => selected.selection.count_drawn(),
                content => content.record_count(),
            };
            // Without a selection, the renderer processes all points.
            let processed = if stats.traversals > 0 {
                stats.visited_nodes
            } else {
                drawn
            };
            samples.lod_ms.push(lod_ms);
            samples.upload_ms.push(upload.wall_ms);
            samples.uploaded_bytes.push(upload.bytes as f64);
            samples.render_ms.push(time.wall_ms);
            samples.gpu_ms.extend(time.gpu_ms);
            samples.passes.add(&time.gpu_passes);
            samples.total_ms.push(lod_ms + upload.wall_ms + time.wall_ms);
            samples.processed.push(processed as f64);
            samples.drawn.push(drawn as f64);
            samples.duplicates.push(stats.duplicates as f64);
        }
        Ok(())
    }
}
