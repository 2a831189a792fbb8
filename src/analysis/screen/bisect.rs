//! Neighbourhoods of sixteen points: the radius of each is bisected until it contains sixteen, as `AutoSplats` do
//! (Preiner et al. 2012), with which Hofer et al. 2018 compares a fixed radius (Fig. 4).

use super::constants::MAX_REACH_CELLS;
use super::planes::{Neighbourhood, Planes};
use super::view::ScreenPoint;
use crate::analysis::surface::four_matrices::FOUR;
use crate::cloud::ShapeRecord;
use fearless_simd::{Level, Simd, dispatch};
use rayon::prelude::*;

/// Number of neighbours to search for.
const WANTED: f32 = 16.0;

/// Most halvings of the interval; radii are within a thousandth then.
const MAX_STEPS: usize = 10;

/// Points that are worth handing to another thread.
const POINTS_PER_TASK: usize = 1 << 9;

impl Planes<'_> {
    /// Neighbourhoods of sixteen points.
    pub(super) fn bisected(&self, seen: &[ScreenPoint]) -> Vec<ShapeRecord> {
        let level = Level::new();
        let tasks = seen.par_chunks(POINTS_PER_TASK);
        let tasks: Vec<Vec<ShapeRecord>> = tasks
            .map(|seen| {
                let mut shapes = vec![bytemuck::Zeroable::zeroed(); seen.len()];
                dispatch!(level, simd => self.bisect(simd, seen, &mut shapes));
                shapes
            })
            .collect();
        let mut shapes = tasks.concat();
        self.lend_normals(seen, &mut shapes);
        shapes
    }

    #[inline(always)]
    fn bisect<S: Simd>(&self, simd: S, seen: &[ScreenPoint], shapes: &mut [ShapeRecord]) {
        for (seen, shapes) in seen.chunks(FOUR).zip(shapes.chunks_mut(FOUR)) {
            let mut around = [Neighbourhood::NONE; FOUR];
            for (around, seen) in around.iter_mut().zip(seen) {
                *around = self.sixteen_around(simd, seen);
            }
            self.solve(simd, seen, &around, shapes);
        }
    }

    #[inline(always)]
    fn sixteen_around<S: Simd>(&self, simd: S, seen: &ScreenPoint) -> Neighbourhood {
        let max = self.cells.max_radius_px() * seen.depth / self.view.px_per_unit();
        // Doubles the window in pixels until it contains enough points.
        let mut high = MAX_REACH_CELLS * seen.depth / self.view.px_per_unit();
        let mut around = self.around(simd, seen, high, false);
        while around.points < WANTED && high < max {
            high *= 2.0;
            around = self.around(simd, seen, high, false);
        }
        let mut low = 0.0;
        for _ in 0..MAX_STEPS {
            if around.points == WANTED {
                break;
            }
            let center = 0.5 * (low + high);
            let tried = self.around(simd, seen, center, false);
            if tried.points < WANTED {
                low = center;
            } else {
                (high, around) = (center, tried);
            }
        }
        around
    }
}
