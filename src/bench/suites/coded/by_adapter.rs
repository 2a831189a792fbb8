//! The byte code drawn by an adapter: traversed and decoded in compute passes, compared with its records, and with the
//! nodes that the CPU decodes and uploads for each view.

use super::drawings::Samples;
use super::subjected::{Subjected, style};
use crate::bench::BenchError;
use crate::bench::report::Row;
use crate::bench::run::Run;
use crate::bench::runner::Runner;
use crate::bench::suites::turning::{VIEWS, cameras};
use crate::measure::mean_squared_error;
use crate::scene::{Footprint, Scene, ScenePacket, Style};
use crate::stopwatch::milliseconds_since;
use std::time::Instant;

/// A mode of drawing by an adapter.
#[derive(Clone, Copy, PartialEq)]
enum Mode {
    /// All points, from records that are resident.
    Records,
    /// Nodes that compute passes find and decode.
    Compute,
    /// Those nodes, found and decoded by the CPU, and uploaded.
    Uploaded,
    /// Nodes by compute passes, a pixel each.
    Pixels,
}

/// The first is what the others are compared with.
const MODES: [(Mode, &str); 4] = [
    (Mode::Records, "GPU: exact disks"),
    (Mode::Compute, "GPU: code by compute"),
    (Mode::Uploaded, "GPU: code by the CPU"),
    (Mode::Pixels, "GPU: coded pixels"),
];

impl Mode {
    fn style(self) -> Style {
        style().drawn_by(false).with(|style| {
            style.codes.footprint = match self {
                Self::Records => Footprint::Disks,
                Self::Compute | Self::Uploaded => Footprint::Masks,
                Self::Pixels => Footprint::Pixels,
            };
        })
    }

    /// Milliseconds from the packet to the finished image.
    fn draw_ms(self, adapter: &mut Runner, packet: &ScenePacket) -> Result<f64, BenchError> {
        let start = Instant::now();
        match packet.content.coded().filter(|_| self == Self::Uploaded) {
            Some(cells) => adapter.draw(&packet.with_surfels_of(cells))?,
            None => adapter.draw(packet)?,
        };
        Ok(milliseconds_since(start))
    }

    fn drawn_records(packet: &ScenePacket) -> f64 {
        let of_code = packet.content.coded();
        let drawn = of_code.map(|cells| cells.cloud.drawn_nodes(&packet.code_view(cells)).len());
        drawn.unwrap_or_else(|| packet.content.record_count()) as f64
    }
}

/// The rows of an adapter; none without one.
pub(super) fn rows(run: &mut Run<'_>, of: &Subjected<'_>) -> Result<Vec<Row>, BenchError> {
    let mut rows = Vec::new();
    if run.runner.is_processor() {
        return Ok(rows);
    }
    run.runner.set_makes_surfels(true);
    for (view, distance) in VIEWS {
        let mut samples = MODES.map(|_| Samples::default());
        for camera in cameras(of.subject, &of.frame, distance, run.options.viewpoints) {
            let packets = MODES.map(|(mode, _)| {
                let size_px = run.options.viewport_px;
                of.subject
                    .packet(&mut Scene::default(), &of.frame, &camera, &mode.style(), size_px)
            });
            let exact = run.runner.image(&packets[0])?;
            for (packet, samples) in packets.iter().zip(&mut samples) {
                let image = run.runner.image(packet)?;
                samples.squared.push(mean_squared_error(&exact, &image)?);
                samples.records.push(Mode::drawn_records(packet));
            }
            for round in 0..run.options.warmup + run.options.repeat {
                for (((mode, _), packet), samples) in MODES.iter().zip(&packets).zip(&mut samples) {
                    run.check_cancelled()?;
                    let time_ms = mode.draw_ms(&mut run.runner, packet)?;
                    if round >= run.options.warmup {
                        samples.times_ms.push(time_ms);
                    }
                }
            }
        }
        let of_modes = MODES.iter().zip(&samples);
        rows.extend(of_modes.map(|((_, mode), samples)| samples.row(of, mode, view)));
    }
    Ok(rows)
}
