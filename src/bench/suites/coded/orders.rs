//! The code in both of its orders, on one thread.

use super::columns::{ORDERS, row};
use super::subjected::Subjected;
use crate::bench::report::{Cell, Row};
use crate::bench::run::Run;
use crate::bench::{BenchError, Quantiles};
use crate::levels::octree::coded::DepthFirstCode;
use crate::stopwatch::milliseconds_since;
use glam::Vec3;
use std::hint::black_box;
use std::time::Instant;

/// Level from which nodes are culled: above it, nothing is small enough.
const FIRST_CULLED_LEVEL: u32 = 2;

/// Times of one order, milliseconds.
#[derive(Default)]
struct OrderTimes {
    write: Vec<f64>,
    decode: Vec<f64>,
    culled: Vec<f64>,
}

/// Measures both orders by turns.
pub(super) fn rows(run: &Run<'_>, of: &Subjected<'_>) -> Result<Vec<Row>, BenchError> {
    let depth_first = DepthFirstCode::of(&of.octree);
    let cube = of.cloud.cube();
    let cube_center = cube.cell_center(0, [0; 3]);
    // Nodes on one side of a plane through the centre, by the spheres around them.
    let is_visible = |level: u32, center: Vec3| {
        let reach = 0.87 * cube.cell_edge(level);
        level < FIRST_CULLED_LEVEL || (center - cube_center).dot(Vec3::new(0.6, 0.64, 0.48)) > -reach
    };
    let mut times: [OrderTimes; 2] = Default::default();
    let mut culled_leaves = [0; 2];
    for round in 0..run.options.warmup + run.options.repeat {
        run.check_cancelled()?;
        let [breadth, depth] = &mut times;
        let is_counted = round >= run.options.warmup;
        let time = |times: &mut Vec<f64>, work: &mut dyn FnMut()| {
            let start = Instant::now();
            work();
            times.extend(is_counted.then(|| milliseconds_since(start)));
        };
        time(&mut breadth.write, &mut || drop(black_box(of.octree.masks())));
        time(&mut depth.write, &mut || {
            drop(black_box(DepthFirstCode::of(&of.octree)));
        });
        let all = |_: u32, _: Vec3| true;
        let mut sum = Vec3::ZERO;
        time(&mut breadth.decode, &mut || {
            of.cloud.leaves(all, |_, center| sum += center);
        });
        time(&mut depth.decode, &mut || {
            depth_first.leaves(all, |_, center| sum += center);
        });
        culled_leaves = [0; 2];
        time(&mut breadth.culled, &mut || {
            of.cloud.leaves(is_visible, |_, center| {
                sum += center;
                culled_leaves[0] += 1;
            });
        });
        time(&mut depth.culled, &mut || {
            depth_first.leaves(is_visible, |_, center| {
                sum += center;
                culled_leaves[1] += 1;
            });
        });
        black_box(sum);
    }
    let leaves = of.cloud.level(of.cloud.depth()).len() as f64;
    let orders = ["breadth-first", "depth-first"]
        .into_iter()
        .zip(times)
        .zip(culled_leaves);
    let row_of = |((order, times), culled): ((&str, OrderTimes), usize)| {
        let median = |times: &[f64]| Quantiles::of(times).map(|quantiles| quantiles.median);
        let decode_ms = median(&times.decode);
        row(
            ORDERS,
            &[
                ("sequence", Cell::Text(of.name.clone())),
                ("way", Cell::Text(order.to_owned())),
                ("leaves", Cell::Number(leaves)),
                ("write_ms_median", Cell::maybe(median(&times.write))),
                ("decode_ms_median", Cell::maybe(decode_ms)),
                (
                    "decode_mleaves_per_s",
                    Cell::maybe(decode_ms.map(|ms| leaves / ms / 1e3)),
                ),
                ("culled_decode_ms_median", Cell::maybe(median(&times.culled))),
                ("culled_leaves", Cell::Number(culled as f64)),
            ],
        )
    };
    Ok(orders.map(row_of).collect())
}
