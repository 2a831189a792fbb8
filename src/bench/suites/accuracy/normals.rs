//! Normals on known shapes: angle to the truth and time by noise, outliers and number of neighbours, of least squares
//! and of robust fits; and the result of the automatic choice.
//!
//! Signs are not compared: they come later, from the neighbourhood graph or the sensor. The time covers the whole
//! estimate (tree, neighbours, planes) on all threads of the program.

use super::columns::{NORMALS, row};
use crate::analysis::{PlaneFit, SurfaceOptions, estimate_planes_with};
use crate::bench::report::Cell;
use crate::bench::run::Run;
use crate::bench::{BenchError, Quantiles};
use crate::measure::{AngularError, Orientation};
use crate::source::{OUTLIERS, Sampled, Shape};
use crate::stopwatch::milliseconds_since;
use std::hint::black_box;
use std::time::Instant;

/// Points on each shape: of a sphere, about a hundred along its diameter.
const POINTS: usize = 20_000;

/// Disturbances of the points: the standard deviation of noise, as a fraction of the diameter, and whether one point in
/// [`OUTLIERS`] is far off the surface.
const DISTURBANCES: [(f32, bool); 6] = [
    (0.0, false),
    (0.005, false),
    (0.01, false),
    (0.02, false),
    (0.0, true),
    (0.005, true),
];

/// Numbers of neighbours; `None` for the automatic choice, which the program makes where no one else does.
const NEIGHBOURS: [Option<u16>; 4] = [Some(8), Some(16), Some(32), None];

fn options(neighbours: Option<u16>, fit: PlaneFit) -> SurfaceOptions {
    SurfaceOptions { neighbours, fit }
}

/// One for each shape with each disturbance.
pub(super) const STEPS: usize = Shape::ALL.len() * DISTURBANCES.len();

pub(super) fn measure(run: &mut Run<'_>) -> Result<(), BenchError> {
    for shape in Shape::ALL {
        for (noise, has_outliers) in DISTURBANCES {
            // As one would write it: without the rounding to f32.
            let noise_share = f64::from((noise * 1e4).round()) / 1e4;
            let outlier_share = f64::from(u8::from(has_outliers)) / OUTLIERS as f64;
            run.begin_step(format!(
                "{}, {} % noise, {} % outliers",
                shape.name(),
                noise_share * 100.0,
                outlier_share * 100.0
            ))?;
            let mut truth = shape.sample(POINTS, noise);
            if has_outliers {
                shape.scatter(&mut truth);
            }
            for neighbours in NEIGHBOURS {
                let basis = estimate_planes_with(&truth.positions, options(neighbours, PlaneFit::default())).basis;
                let is_automatic = neighbours.is_none();
                let mut cells = vec![
                    ("shape", Cell::Text(shape.name().to_owned())),
                    ("noise", Cell::Number(noise_share)),
                    ("outliers", Cell::Number(outlier_share)),
                    ("neighbours", Cell::Number(basis.reach() as f64)),
                    (
                        "chosen",
                        Cell::Text(if is_automatic { "auto" } else { "given" }.to_owned()),
                    ),
                    ("points", Cell::Number(POINTS as f64)),
                ];
                if is_automatic {
                    cells.push(("noise_found", Cell::Number(f64::from(basis.noise))));
                }
                for fit in PlaneFit::ALL {
                    let values = measure_fit(run, &truth, options(neighbours, fit))?;
                    let keys = keys(fit);
                    cells.extend(keys.into_iter().zip(values.map(Cell::maybe)));
                }
                run.add_rows([row(NORMALS, &cells)]);
            }
        }
    }
    Ok(())
}

/// Columns of [`measure_fit`].
fn keys(fit: PlaneFit) -> [&'static str; 6] {
    match fit {
        PlaneFit::Plain => [
            "normals_ms_median",
            "normals_ms_q1",
            "normals_ms_q3",
            "angle_deg_mean",
            "angle_deg_p95",
            "angle_deg_max",
        ],
        PlaneFit::Robust => [
            "robust_ms_median",
            "robust_ms_q1",
            "robust_ms_q3",
            "robust_angle_deg_mean",
            "robust_angle_deg_p95",
            "robust_angle_deg_max",
        ],
    }
}

/// Median and quartiles of the time in milliseconds; mean, 95th percentile and largest of the angles in degrees.
fn measure_fit(run: &mut Run<'_>, truth: &Sampled, options: SurfaceOptions) -> Result<[Option<f64>; 6], BenchError> {
    let mut times_ms = Vec::new();
    let mut normals = Vec::new();
    for round in 0..run.options.warmup + run.options.repeat {
        run.check_cancelled()?;
        let start = Instant::now();
        let estimated = estimate_planes_with(black_box(&truth.positions), options).normals;
        let time_ms = milliseconds_since(start);
        if round >= run.options.warmup {
            times_ms.push(time_ms);
        }
        // Freeing the previous normals is not part of the estimation.
        normals = estimated;
    }
    let error = AngularError::of(&normals, &truth.normals, Orientation::Ignored);
    let time = Quantiles::of(&times_ms);
    Ok([
        time.map(|time| time.median),
        time.map(|time| time.q1),
        time.map(|time| time.q3),
        error.map(|error| error.mean_deg),
        error.map(|error| error.p95_deg),
        error.map(|error| error.max_deg),
    ])
}
