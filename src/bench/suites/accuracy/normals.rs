//! Normals on known shapes: angle to the truth and time by noise and number of neighbours.
//!
//! Signs are not compared: they come later, from the neighbourhood graph or the sensor. The time is that of the whole
//! estimate (tree, neighbours, principal components) on all threads that the program has.

use super::shapes::Shape;
use super::{NORMALS, row};
use crate::analysis::estimate_planes;
use crate::bench::report::Cell;
use crate::bench::runner::milliseconds_since;
use crate::bench::suites::Run;
use crate::bench::{BenchError, Quantiles};
use crate::measure::{AngularError, Orientation};
use std::hint::black_box;
use std::time::Instant;

/// Points on each shape: of a sphere, about a hundred along its diameter.
const POINTS: usize = 20_000;

/// Standard deviations of the noise, as parts of the diameter.
const NOISES: [f32; 4] = [0.0, 0.005, 0.01, 0.02];

/// Numbers of neighbours; the program's own 12 is between the first two.
const NEIGHBOURS: [usize; 3] = [8, 16, 32];

/// One for each shape with each noise.
pub(super) const STEPS: usize = Shape::ALL.len() * NOISES.len();

pub(super) fn measure(run: &mut Run<'_>) -> Result<(), BenchError> {
    for shape in Shape::ALL {
        for noise in NOISES {
            // Written as a person would: free of the rounding to f32.
            let noise_share = f64::from((noise * 1e4).round()) / 1e4;
            run.begin_step(format!("{}, {} % noise", shape.name(), noise_share * 100.0))?;
            let truth = shape.sample(POINTS, noise);
            for neighbours in NEIGHBOURS {
                let mut times_ms = Vec::new();
                let mut normals = Vec::new();
                for round in 0..run.options.warmup + run.options.repeat {
                    run.check_cancelled()?;
                    let start = Instant::now();
                    let estimated =
                        estimate_planes(black_box(&truth.positions), neighbours).normals;
                    let time_ms = milliseconds_since(start);
                    if round >= run.options.warmup {
                        times_ms.push(time_ms);
                    }
                    // Freeing those before is not part of estimating.
                    normals = estimated;
                }
                let error = AngularError::of(&normals, &truth.normals, Orientation::Ignored);
                let time = Quantiles::of(&times_ms);
                run.report.rows.push(row(
                    NORMALS,
                    &[
                        ("shape", Cell::Text(shape.name().to_owned())),
                        ("noise", Cell::Number(noise_share)),
                        ("neighbours", Cell::Number(neighbours as f64)),
                        ("points", Cell::Number(POINTS as f64)),
                        (
                            "normals_ms_median",
                            Cell::maybe(time.map(|time| time.median)),
                        ),
                        ("normals_ms_q1", Cell::maybe(time.map(|time| time.q1))),
                        ("normals_ms_q3", Cell::maybe(time.map(|time| time.q3))),
                        (
                            "angle_deg_mean",
                            Cell::maybe(error.map(|error| error.mean_deg)),
                        ),
                        (
                            "angle_deg_p95",
                            Cell::maybe(error.map(|error| error.p95_deg)),
                        ),
                        (
                            "angle_deg_max",
                            Cell::maybe(error.map(|error| error.max_deg)),
                        ),
                    ],
                ));
            }
        }
    }
    Ok(())
}
