//! Suites that time rendering: strategies, octrees, levels of detail, primitives, renderers.

use super::{STRATEGIES, assert_files_agree, column, demo, measure, numbers, rows_of, small};
use pointreel::bench::{BenchOptions, Cell, Report, run, suites};
use pointreel::progress::Progress;

fn assert_draw_rows(report: &Report) {
    let strategies: Vec<String> = report.rows.iter().map(|row| report.cells(row)[1].clone()).collect();
    assert_eq!(strategies, STRATEGIES);
    // 2 frames, 2 viewpoints, 2 rounds.
    assert_eq!(numbers(report, "samples"), [8.0; 5]);
    assert_eq!(
        numbers(report, "timed_uploads"),
        [0.0; 5],
        "uploads would be in the draw times"
    );
    for key in [
        "draw_ms_min",
        "upload_ms_median",
        "upload_and_draw_ms",
        "upload_bytes",
        "draw_calls",
    ] {
        assert!(numbers(report, key).iter().all(|&number| number > 0.0), "{key}");
    }
    let instances = numbers(report, "instances");
    assert!(
        instances.iter().all(|&count| count == instances[0] && count > 0.0),
        "{instances:?}"
    );
    let [min, max] = ["draw_ms_min", "draw_ms_max"].map(|key| numbers(report, key));
    for ((median, min), max) in numbers(report, "draw_ms_median").iter().zip(&min).zip(&max) {
        assert!(min <= median && median <= max);
    }
    let bars = report.bars();
    assert_eq!(bars.len(), 5);
    assert_eq!(bars[1].0, "demo uniform");
    assert_eq!(
        bars.iter().map(|bar| bar.1).collect::<Vec<_>>(),
        numbers(report, "draw_ms_median")
    );
}

#[test]
fn surfels_are_measured_with_every_strategy() {
    let report = measure(&small(suites::SURFELS));
    assert_draw_rows(&report);
    assert_files_agree(&report);
    // Points and shapes of 16 bytes each, uploaded once per frame; both passes draw all of them.
    let points = numbers(&report, "points");
    assert_eq!(points[0], report.sequences[0].mean_points);
    assert_eq!(numbers(&report, "instances")[0], 2.0 * points[0]);
    assert!(
        numbers(&report, "upload_bytes")
            .iter()
            .all(|&bytes| bytes >= 32.0 * points[0])
    );
    let coverage = report.sequences[0].coverage.unwrap();
    assert_eq!(
        (coverage.count, coverage.outside),
        (4, 0),
        "the demo can be brought into the band: {coverage:?}"
    );
    assert!(coverage.min >= 0.25 && coverage.max <= 0.85);
}

#[test]
fn voxels_are_measured_with_every_strategy() {
    let report = measure(&small(suites::VOXELS));
    assert_draw_rows(&report);
    assert_files_agree(&report);
    assert!(numbers(&report, "octree_depth").iter().all(|&depth| depth > 3.0));
    // Determined with voxels, not with surfels, which are drawn from other viewpoints.
    let coverage = report.sequences[0].coverage.unwrap();
    assert_eq!(coverage.count, 4);
    assert!(
        coverage.min >= 0.15 && coverage.max <= 0.85,
        "a sparse cloud fills the picture as far as it can: {coverage:?}"
    );
    // Viewpoints outside the band are reported.
    assert_eq!(
        coverage.outside > 0,
        report.notes.iter().any(|note| note.contains("in the band")),
        "{:?}",
        report.notes
    );
}

#[test]
fn octrees_are_measured_at_the_loss_thresholds_of_the_paper() {
    let report = measure(&small(suites::OCTREE));
    assert_files_agree(&report);
    assert_eq!(numbers(&report, "delta"), [0.02, 0.1, 0.5]);
    for (loss, delta) in numbers(&report, "loss").iter().zip(numbers(&report, "delta")) {
        assert!(*loss <= delta, "a loss of {loss} where {delta} is acceptable");
    }
    for key in ["depth", "nodes", "leaves"] {
        let numbers = numbers(&report, key);
        assert!(
            numbers.windows(2).all(|pair| pair[0] >= pair[1]),
            "{key} grows with the loss: {numbers:?}"
        );
    }
    for key in [
        "build_file_order_one_thread_ms_median",
        "build_file_order_all_threads_ms_median",
        "build_morton_order_one_thread_ms_median",
        "build_morton_order_all_threads_ms_median",
        "traverse_ms_median",
        "traverse_one_thread_ms_median",
        "visited_nodes",
        "emitted_voxels",
    ] {
        assert!(numbers(&report, key).iter().all(|&number| number > 0.0), "{key}");
    }
    let bars: Vec<f64> = report.bars().iter().map(|bar| bar.1).collect();
    assert_eq!(
        bars,
        numbers(&report, "build_file_order_one_thread_ms_median"),
        "the chart shows what the paper's table does"
    );
}

#[test]
fn level_of_detail_structures_are_measured_from_three_distances() {
    let report = measure(&small(suites::LOD));
    assert_files_agree(&report);
    let rows = rows_of(&report, "structures");
    let of = |key: &str| -> Vec<[f64; 3]> {
        let numbers = column(&report, &rows, key);
        let views = numbers.chunks_exact(3);
        views.map(|views| [views[0], views[1], views[2]]).collect()
    };
    let structure = |place: usize| report.value(rows[3 * place], "structure");
    let named: Vec<String> = (0..6)
        .map(|place| match structure(place) {
            Some(Cell::Text(name)) => name.clone(),
            other => panic!("no name: {other:?}"),
        })
        .collect();
    assert_eq!(named, ["none", "octree", "qsplat", "spt", "spt-paper", "hspt"]);
    let drawn = of("drawn_nodes");
    assert!(drawn[0].iter().all(|&all| all == drawn[0][0]), "{drawn:?}");
    for structure in &drawn[1..] {
        assert!(structure[0] < structure[1], "fewer from afar: {drawn:?}");
    }
    // The whole object is in view: variants with the same tree draw the same nodes.
    for view in [0, 1] {
        let [qsplat, sequential, hierarchical] = [2, 3, 5].map(|structure: usize| drawn[structure][view]);
        assert_eq!(sequential, hierarchical);
        // Quantised spheres are wider.
        assert!(qsplat >= sequential, "{qsplat} {sequential}");
    }
    for (structure, duplicates) in of("duplicates").into_iter().enumerate() {
        assert!(
            structure == 4 || duplicates == [0.0; 3],
            "{duplicates:?} of {}",
            named[structure]
        );
    }
    for key in ["render_ms_median", "total_ms_median", "processed_nodes"] {
        assert!(column(&report, &rows, key).iter().all(|&number| number > 0.0), "{key}");
    }
    assert_passes_are_timed(&report);
}

/// Passes have a time where the adapter has a clock.
fn assert_passes_are_timed(report: &Report) {
    let passes = rows_of(report, "passes");
    assert_eq!(passes.is_empty(), !report.environment.has_timestamps);
    assert!(
        column(report, &passes, "pass_gpu_ms_median")
            .iter()
            .all(|&gpu_ms| gpu_ms > 0.0)
    );
}

#[test]
fn primitives_are_measured_with_the_cost_of_their_shaders() {
    let options = BenchOptions {
        cloud_points: vec![3000],
        ..small(suites::PRIMITIVES)
    };
    let report = measure(&options);
    assert_files_agree(&report);
    let names: Vec<&str> = report.sequences.iter().map(|sequence| sequence.name.as_str()).collect();
    assert_eq!(names, ["torus of 3000", "demo"]);
    let speed = rows_of(&report, "speed");
    // The torus has a mesh as well.
    let primitives = 16;
    assert_eq!(speed.len(), 3 * (2 * primitives + 1));
    assert_passes_are_timed(&report);
    let records = column(&report, &speed, "records");
    // All points from every distance, except for voxels: one per leaf.
    assert!(
        records[..3 * (primitives - 1)].iter().all(|&count| count == 3000.0),
        "{records:?}"
    );
    for (mean, rate) in [
        ("processor_ms_mean", "processor_mpoints_per_s"),
        ("adapter_ms_mean", "adapter_mpoints_per_s"),
    ] {
        let [means, rates] = [mean, rate].map(|key| column(&report, &speed, key));
        for ((mean, rate), records) in means.iter().zip(rates).zip(&records) {
            // All images have the same number of records, so the ratio of sums is the ratio of means.
            assert!(
                (rate * mean * 1e3 / records - 1.0).abs() < 1e-9,
                "{rate} {mean} {records}"
            );
        }
    }
    let complexity = rows_of(&report, "complexity");
    let passes: Vec<String> = complexity.iter().map(|row| report.cells(row)[..2].join(": ")).collect();
    assert_eq!(passes[..2], ["pixel: point", "square point: point"]);
    let work = column(&report, &complexity, "vertex_operations");
    let of = |name: &str| work[passes.iter().position(|pass| pass == name).unwrap()];
    assert!(of("pixel: point") <= of("square point: point"));
    assert!(of("disk, two-pass: attribute") > of("square point: point"));
    assert!(passes.contains(&"disk, two-pass: resolve".to_owned()), "{passes:?}");
}

#[test]
fn the_renderers_are_measured_side_by_side() {
    let report = measure(&small(suites::RENDER));
    assert_files_agree(&report);
    let kinds: Vec<Vec<String>> = report.rows.iter().map(|row| report.cells(row)[1..3].to_vec()).collect();
    let expected = ["point", "surfel", "voxel"]
        .iter()
        .flat_map(|primitive| ["whole", "afar", "near"].map(|view| vec![(*primitive).to_owned(), view.to_owned()]));
    assert_eq!(kinds, expected.collect::<Vec<_>>());
    let records = numbers(&report, "records");
    assert!(
        records[..6].iter().all(|&count| count == records[0]),
        "all points: {records:?}"
    );
    assert!(records[7] < records[6], "fewer voxels from afar: {records:?}");
    let [processor, adapter] = ["processor_ms_median", "adapter_ms_median"].map(|key| numbers(&report, key));
    for (ratio, (processor, adapter)) in numbers(&report, "adapter_per_processor")
        .into_iter()
        .zip(processor.into_iter().zip(adapter))
    {
        assert_eq!(ratio, adapter / processor);
    }
}

#[test]
fn without_an_adapter_the_cpu_is_measured() {
    let all = [
        suites::SURFELS,
        suites::VOXELS,
        suites::RENDER,
        suites::ACCURACY,
        suites::LOD,
        suites::PRIMITIVES,
    ];
    for suite in all {
        let options = BenchOptions {
            frames: 1,
            viewpoints: 1,
            warmup: 0,
            repeat: 1,
            ..small(suite)
        };
        let report = run(&demo(), &options, None, &|_| {}, &Progress::default()).unwrap();
        assert!(report.environment.adapter.starts_with("software renderer"), "{suite}");
        assert!(!report.rows.is_empty(), "{suite}");
        let has = |key: &str| report.value(&report.rows[0], key).and_then(Cell::number).is_some();
        if suite == suites::SURFELS || suite == suites::VOXELS {
            assert_eq!(report.rows.len(), 1);
            assert_eq!(report.cells(&report.rows[0])[1], "processor");
            assert!(has("draw_ms_median"), "{suite}");
        } else if suite == suites::RENDER {
            assert!(has("processor_ms_median") && !has("adapter_ms_median"));
        } else if suite == suites::LOD {
            assert!(has("render_ms_median") && has("total_ms_median") && !has("gpu_ms_median"));
            assert!(rows_of(&report, "passes").is_empty(), "no adapter has timed one");
        } else if suite == suites::PRIMITIVES {
            assert!(has("processor_ms_mean") && !has("adapter_ms_mean"));
        }
    }
}
