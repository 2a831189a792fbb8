//! Byte codes: sizes, orders, drawing.

use super::{assert_files_agree, column, common, input, rows_of};
use pointreel::bench::{BenchOptions, Cell, Input, Report, Row, run, suites};
use pointreel::progress::Progress;
use pointreel::sequence::{Sequence, Shape};

fn report() -> Report {
    let torus = Input {
        shape: Some(Shape::Torus),
        ..input("torus", Sequence::of(Shape::Torus.frame(3_000)))
    };
    let options = BenchOptions {
        viewport_px: [96, 64],
        viewpoints: 1,
        repeat: 1,
        ..BenchOptions::new(suites::CODED)
    };
    run(
        &[torus],
        &options,
        Some(&common::context()),
        &|_| {},
        &Progress::default(),
    )
    .unwrap()
}

#[test]
fn byte_codes_are_measured() {
    let report = report();
    assert_files_agree(&report);
    let text = |row: &Row, key: &str| match report.value(row, key) {
        Some(Cell::Text(text)) => text.clone(),
        other => panic!("{key}: {other:?}"),
    };
    let number = |row: &Row, key: &str| report.value(row, key).and_then(Cell::number);

    let sizes = rows_of(&report, "sizes");
    for tree in ["δ 5 %", "by spacing"] {
        let bits = |stream: &str, key: &str| {
            let row = sizes
                .iter()
                .find(|&&row| text(row, "tree") == tree && text(row, "stream") == stream);
            number(row.unwrap_or_else(|| panic!("{tree}: {stream}")), key).unwrap()
        };
        let masks = bits("masks, breadth-first", "bits_per_leaf");
        assert_eq!(masks, bits("masks, depth-first", "bits_per_leaf"), "{tree}");
        assert!(masks > 1.0, "{tree}: {masks}");
        // All nodes are the leaves and one node for each byte.
        let nodes_per_leaf = 1.0 + masks / 8.0;
        for (stream, bits_per_node) in [
            ("offsets, 3 bits", 3.0),
            ("normals, 13 bits", 13.0),
            ("colours, 24 bits", 24.0),
        ] {
            assert!(
                (bits(stream, "bits_per_leaf") - bits_per_node * nodes_per_leaf).abs() < 1e-9,
                "{tree}: {stream}"
            );
            let [all, leaves] = ["gzip_bits_per_leaf", "gzip_leaf_bits_per_leaf"].map(|key| bits(stream, key));
            assert!(leaves < all, "{tree}: {stream}: {leaves} and {all}");
        }
    }

    let orders = rows_of(&report, "orders");
    let [leaves, culled] = ["leaves", "culled_leaves"].map(|key| column(&report, &orders, key));
    assert_eq!((leaves[0], culled[0]), (leaves[1], culled[1]));
    assert!(
        (0.2..0.8).contains(&(culled[0] / leaves[0])),
        "{culled:?} of {leaves:?}"
    );

    let drawing = rows_of(&report, "drawing");
    let ratio = |mode: &str| {
        let row = drawing
            .iter()
            .find(|&&row| text(row, "way") == mode && text(row, "view") == "full");
        number(row.unwrap_or_else(|| panic!("{mode}")), "psnr_db")
    };
    assert_eq!(ratio("exact disks"), None, "the reference");
    let [masks, no_offsets] = ["masks", "masks, no offsets"].map(|mode| ratio(mode).unwrap());
    assert!(masks > 25.0 && no_offsets < masks, "{masks} {no_offsets}");
    for blocks in ["masks, blocks of 8", "masks, blocks of 256", "masks, blocks of 4096"] {
        // A large block is drawn on one level, no coarser than that of each of its parts.
        assert!(ratio(blocks).unwrap() > masks - 0.5, "{blocks}");
    }

    let [by_compute, by_cpu] = ["GPU: code by compute", "GPU: code by the CPU"].map(|mode| ratio(mode).unwrap());
    assert!(
        by_compute > 25.0 && (by_compute - by_cpu).abs() < 0.1,
        "{by_compute} {by_cpu}"
    );
    assert_eq!(ratio("GPU: exact disks"), None, "the reference of the adapter");
    assert!(ratio("GPU: coded pixels").unwrap() < by_compute);

    let equal = rows_of(&report, "equal time");
    let modes: Vec<String> = equal.iter().map(|&row| text(row, "way")).collect();
    assert_eq!(modes, ["mesh", "splats from masks", "coded pixels"]);
    let times = column(&report, &equal, "ms_median");
    for (place, &row) in equal.iter().enumerate().skip(1) {
        assert!(
            times[place] <= times[0] || number(row, "level") == Some(0.0),
            "{times:?}"
        );
    }
}
