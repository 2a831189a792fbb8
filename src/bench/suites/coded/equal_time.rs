//! Points and splats that take as long as the mesh (Botsch et al. 2002, Fig. 11).
//!
//! How it works: any prefix of the code is a coarser cloud. The finest level that takes no longer than the triangles is
//! drawn, and compared with their image.

use super::columns::{EQUAL_TIME, row};
use super::subjected::{Subjected, drawn_records, style};
use crate::bench::report::{Cell, Row};
use crate::bench::run::Run;
use crate::bench::runner::Runner;
use crate::bench::{BenchError, Quantiles};
use crate::levels::Lod;
use crate::measure::{mean_squared_error, psnr_db};
use crate::scene::{Camera, Footprint, Primitive, Scene, ScenePacket, Style};
use image::RgbaImage;

/// A mode, and its style down to a level.
type Mode = (&'static str, Footprint);

const MODES: [Mode; 2] = [
    ("splats from masks", Footprint::Masks),
    ("coded pixels", Footprint::Pixels),
];

/// An image, and what it took.
struct Timed {
    ms: f64,
    records: f64,
    image: RgbaImage,
}

/// The rows of a frame with triangles; none without.
pub(super) fn rows(run: &Run<'_>, processor: &mut Runner, of: &Subjected<'_>) -> Result<Vec<Row>, BenchError> {
    if of.frame.triangles().is_none() {
        return Ok(Vec::new());
    }
    let camera = of.subject.framing(&of.frame);
    let mesh = timed(
        run,
        processor,
        of,
        &camera,
        &style().with(|style| style.primitive = Primitive::Mesh),
    )?;
    let mut rows = vec![row_of(of, "mesh", None, &mesh, None)];
    for (mode, footprint) in MODES {
        // From the finest on; the root takes next to nothing.
        for level in (0..=of.cloud.depth()).rev() {
            let style = style().with(|style| {
                style.codes.footprint = footprint;
                style.levels.lod = Lod::Level(of.frame.frame.level_of_first(level));
            });
            let drawn = timed(run, processor, of, &camera, &style)?;
            if drawn.ms <= mesh.ms || level == 0 {
                let squared = mean_squared_error(&mesh.image, &drawn.image)?;
                rows.push(row_of(of, mode, Some(level), &drawn, Some(psnr_db(squared))));
                break;
            }
        }
    }
    Ok(rows)
}

fn timed(
    run: &Run<'_>,
    processor: &mut Runner,
    of: &Subjected<'_>,
    camera: &Camera,
    style: &Style,
) -> Result<Timed, BenchError> {
    let packet: ScenePacket =
        of.subject
            .packet(&mut Scene::default(), &of.frame, camera, style, run.options.viewport_px);
    let image = processor.image(&packet)?;
    let mut times_ms = Vec::new();
    for _ in 0..run.options.repeat {
        run.check_cancelled()?;
        times_ms.push(processor.draw(&packet)?.wall_ms);
    }
    Ok(Timed {
        ms: Quantiles::of(&times_ms).map_or(f64::INFINITY, |times| times.median),
        records: drawn_records(processor, &packet),
        image,
    })
}

fn row_of(of: &Subjected<'_>, mode: &str, level: Option<u32>, drawn: &Timed, psnr: Option<f64>) -> Row {
    row(
        EQUAL_TIME,
        &[
            ("sequence", Cell::Text(of.name.clone())),
            ("way", Cell::Text(mode.to_owned())),
            ("level", Cell::maybe(level.map(f64::from))),
            ("records", Cell::Number(drawn.records)),
            ("ms_median", Cell::Number(drawn.ms)),
            ("psnr_db", Cell::maybe(psnr.filter(|psnr| psnr.is_finite()))),
        ],
    )
}
