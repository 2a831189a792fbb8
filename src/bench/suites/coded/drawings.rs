//! Points and splats per second, drawn from the byte code, and from records.

use super::columns::{DRAWING, row};
use super::subjected::{Subjected, drawn_records, style};
use crate::bench::report::{Cell, Row};
use crate::bench::run::Run;
use crate::bench::runner::Runner;
use crate::bench::statistics::mean;
use crate::bench::suites::turning::{VIEWS, cameras};
use crate::bench::{BenchError, Quantiles};
use crate::measure::{mean_squared_error, psnr_db};
use crate::scene::{Footprint, Lighting, NormalBits, OffsetBits, Primitive, Scene, ScenePacket, Style};

/// A mode, and the change to the default style that selects it.
type Mode = (&'static str, fn(&mut Style));

/// The first is what the others are compared with.
const MODES: [Mode; 13] = [
    ("exact disks", |style| style.codes.footprint = Footprint::Disks),
    ("masks", |_| {}),
    ("masks, normals 15 bits", |style| {
        style.codes.normal_bits = NormalBits::Fifteen;
    }),
    ("masks, normals 17 bits", |style| {
        style.codes.normal_bits = NormalBits::Seventeen;
    }),
    ("masks, no offsets", |style| style.codes.offset_bits = OffsetBits::None),
    ("masks, offsets 2 bits", |style| {
        style.codes.offset_bits = OffsetBits::Two;
    }),
    ("masks, light per pixel", |style| {
        style.light.lighting = Lighting::PerFragment;
    }),
    ("masks, blocks of 8", |style| style.codes.block_nodes = 8.0),
    ("masks, blocks of 256", |style| style.codes.block_nodes = 256.0),
    ("masks, blocks of 4096", |style| style.codes.block_nodes = 4096.0),
    ("coded pixels", |style| style.codes.footprint = Footprint::Pixels),
    // OpenGL's points.
    ("points from records", |style| {
        style.primitive = Primitive::Point;
        style.points.size_px = 1.0;
    }),
    ("mesh", |style| style.primitive = Primitive::Mesh),
];

/// Measurements of one mode from one distance.
#[derive(Default)]
pub(super) struct Samples {
    pub(super) times_ms: Vec<f64>,
    pub(super) records: Vec<f64>,
    pub(super) squared: Vec<f64>,
}

pub(super) fn rows(run: &mut Run<'_>, processor: &mut Runner, of: &Subjected<'_>) -> Result<Vec<Row>, BenchError> {
    let modes: Vec<Mode> = MODES
        .into_iter()
        .filter(|(_, change)| style().with(*change).primitive != Primitive::Mesh || of.frame.triangles().is_some())
        .collect();
    let mut rows = Vec::new();
    for (view, distance) in VIEWS {
        let mut samples: Vec<Samples> = modes.iter().map(|_| Samples::default()).collect();
        for camera in cameras(of.subject, &of.frame, distance, run.options.viewpoints) {
            let packet = |(_, change): &Mode| -> ScenePacket {
                let style = style().with(*change);
                of.subject.packet(
                    &mut Scene::default(),
                    &of.frame,
                    &camera,
                    &style,
                    run.options.viewport_px,
                )
            };
            let packets: Vec<ScenePacket> = modes.iter().map(packet).collect();
            let exact = processor.image(&packets[0])?;
            for (packet, samples) in packets.iter().zip(&mut samples) {
                let image = processor.image(packet)?;
                samples.squared.push(mean_squared_error(&exact, &image)?);
            }
            for round in 0..run.options.warmup + run.options.repeat {
                for (packet, samples) in packets.iter().zip(&mut samples) {
                    run.check_cancelled()?;
                    let time_ms = processor.draw(packet)?.wall_ms;
                    if round >= run.options.warmup {
                        samples.times_ms.push(time_ms);
                        samples.records.push(drawn_records(processor, packet));
                    }
                }
            }
        }
        rows.extend(
            modes
                .iter()
                .zip(&samples)
                .map(|(&(mode, _), samples)| samples.row(of, mode, view)),
        );
    }
    Ok(rows)
}

impl Samples {
    pub(super) fn row(&self, of: &Subjected<'_>, mode: &str, view: &str) -> Row {
        let times = Quantiles::of(&self.times_ms);
        let records = mean(&self.records);
        // For identical images it is infinite, which JSON cannot represent.
        let psnr = Some(psnr_db(mean(&self.squared))).filter(|ratio| ratio.is_finite());
        row(
            DRAWING,
            &[
                ("sequence", Cell::Text(of.name.clone())),
                ("way", Cell::Text(mode.to_owned())),
                ("view", Cell::Text(view.to_owned())),
                ("records", Cell::Number(records)),
                ("ms_median", Cell::maybe(times.map(|times| times.median))),
                ("ms_q1", Cell::maybe(times.map(|times| times.q1))),
                ("ms_q3", Cell::maybe(times.map(|times| times.q3))),
                (
                    "mrecords_per_s",
                    Cell::maybe(times.map(|times| records / times.median / 1e3)),
                ),
                ("psnr_db", Cell::maybe(psnr)),
                ("samples", Cell::Number(self.times_ms.len() as f64)),
            ],
        )
    }
}
