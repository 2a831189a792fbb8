//! Traversals by the clock, for every suite that reports them.

use crate::bench::BenchError;
use crate::bench::run::Run;
use crate::bench::subject::Subject;
use crate::levels::octree::Octree;
use crate::scene::Camera;
use crate::stopwatch::milliseconds_since;
use rayon::ThreadPool;
use std::hint::black_box;
use std::time::Instant;

/// One number for each traversal.
#[derive(Default)]
pub(super) struct Traversals {
    pub(super) times_ms: Vec<f64>,
    pub(super) visited_nodes: Vec<f64>,
    pub(super) emitted_voxels: Vec<f64>,
}

impl Traversals {
    /// Adds traversals of one tree from every camera, in rounds, on the threads of `pool` or on all. Each reuses the
    /// memory of the one before it, as in playback.
    pub(super) fn measure(
        &mut self,
        run: &Run<'_>,
        subject: &Subject<'_>,
        octree: &Octree,
        cameras: &[Camera],
        lod_px: f32,
        pool: Option<&ThreadPool>,
    ) -> Result<(), BenchError> {
        let mut voxels = Vec::new();
        for round in 0..run.options.warmup + run.options.repeat {
            for camera in cameras {
                run.check_cancelled()?;
                let view = camera.transform(subject.sequence.origin(), run.options.viewport_px);
                let start = Instant::now();
                let select_view = view.select_view(lod_px);
                let mut select = || octree.select(&select_view, black_box(&mut voxels));
                let selected = match pool {
                    Some(pool) => pool.install(select),
                    None => select(),
                };
                let time_ms = milliseconds_since(start);
                if round >= run.options.warmup {
                    self.times_ms.push(time_ms);
                    self.visited_nodes.push(selected.visited_nodes as f64);
                    self.emitted_voxels.push(selected.emitted as f64);
                }
            }
        }
        Ok(())
    }
}
