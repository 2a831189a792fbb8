//! Fig. 10 of Yang et al. 2006 in numbers: images with and without clipping, by the number of points.
//!
//! How it works: input images have the depths of all points, and are projected onto fewer and fewer of them. Disks
//! whose size is the spacing of the points reach beyond the outline, where depths show that there is no surface.

use super::columns::CLIPPED;
use super::multiview::{Errors, MultiView, StyledFrame, TrueView};
use crate::bench::BenchError;
use crate::bench::report::{Cell, Row};
use crate::bench::run::Run;
use crate::bench::runner::Runner;
use crate::photos::PosedImages;
use crate::scene::PhotoClipping;
use std::sync::Arc;

const POINTS: [usize; 5] = [1_000, 3_000, 10_000, 30_000, 100_000];

/// Returns the number of rows for a cloud of the given number of points; each is a step.
pub(super) fn steps(points: usize) -> usize {
    PhotoClipping::ALL.len() * POINTS.into_iter().filter(|&few| few < points).count()
}

/// Measures the views with every kind of clipping.
pub(super) fn measure(
    run: &mut Run<'_>,
    runner: &mut Runner,
    multiview: &MultiView<'_>,
    used: &Arc<PosedImages>,
    views: &[TrueView],
) -> Result<Vec<Row>, BenchError> {
    let mut rows = Vec::new();
    let all = multiview.frame.frame.len();
    for points in POINTS.into_iter().filter(|&few| few < all) {
        let frame = multiview.few(points)?.with_photos(Arc::clone(used));
        for &clipping in PhotoClipping::ALL {
            run.begin_step(format!("{}: {points} points, clipping {clipping}", multiview.name))?;
            let style = multiview.style.with(|style| style.photos.clipping = clipping);
            let drawn = StyledFrame {
                frame: &frame,
                style: &style,
            };
            let errors = Errors::of(run, runner, multiview, drawn, views)?;
            let cells = vec![
                ("sequence", Cell::Text(multiview.name.to_owned())),
                ("mode", Cell::Text(style.photos.mode.name().to_owned())),
                ("clipping", Cell::Text(clipping.name().to_owned())),
                ("points", Cell::Number(frame.frame.len() as f64)),
                ("photographs", Cell::Number(used.all().len() as f64)),
            ];
            rows.push(errors.row(CLIPPED, cells, &[]));
        }
    }
    Ok(rows)
}
