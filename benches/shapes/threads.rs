//! Functions measured on a chosen number of threads.

use criterion::{BenchmarkGroup, BenchmarkId, measurement::WallTime};
use rayon::ThreadPool;

/// A pool of this many threads for each of `counts`, one after the other: work installed in it is shared among them.
#[allow(dead_code, reason = "most benches use the threads there are")]
pub(crate) fn pools(counts: [usize; 2]) -> impl Iterator<Item = (usize, ThreadPool)> {
    counts.into_iter().map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("threads can be started");
        (threads, pool)
    })
}

/// Measures each of `functions` on each number of threads in `counts`, named by both.
#[allow(dead_code, reason = "most benches use the threads there are")]
pub(crate) fn bench_on_threads(
    group: &mut BenchmarkGroup<'_, WallTime>,
    counts: [usize; 2],
    functions: &[(&str, &(dyn Fn() -> usize + Sync))],
) {
    for (threads, pool) in pools(counts) {
        for (name, run) in functions {
            let id = BenchmarkId::new(*name, format!("{threads} threads"));
            group.bench_function(id, |bencher| {
                pool.install(|| bencher.iter(run));
            });
        }
    }
}
