//! Cells, blocks of lines, and the memory that they take.

use super::*;

fn cells(line: &str, mark: Option<u8>) -> String {
    let dialect = Dialect { mark, ..Dialect::MIXED };
    format!("{:?}", Cells::new(dialect, line.as_bytes()).all())
}

#[test]
fn empty_cells_are_missing() {
    for (line, mark, expected) in [
        ("1,,3", None, "[Number(1.0), Number(NaN), Number(3.0)]"),
        ("1 , 2 ,3,", None, "[Number(1.0), Number(2.0), Number(3.0)]"),
        ("1;2;\"3.5\"", None, "[Number(1.0), Number(2.0), Number(3.5)]"),
        (
            "1,,3,",
            Some(b','),
            "[Number(1.0), Number(NaN), Number(3.0), Number(NaN)]",
        ),
        ("1\t\t 2 ", Some(b'\t'), "[Number(1.0), Number(NaN), Number(2.0)]"),
    ] {
        assert_eq!(cells(line, mark), expected, "{line}");
    }
    let words = Cells::new(
        Dialect {
            mark: Some(b','),
            ..Dialect::MIXED
        },
        b"a b,\"c,d\", e",
    )
    .words();
    assert_eq!(words, [b"a b".as_slice(), b"c,d", b"e"]);
}

#[test]
fn parsing_in_blocks_matches_parsing_as_one_and_errors_name_the_line() {
    let mut text: Vec<String> = (0..200_000).map(|i| format!("{i} {} -{i}.5 7", i * 2)).collect();
    let (options, progress) = (ReadOptions::default(), Progress::default());
    let kinds = [Kind::Required, Kind::Required, Kind::Required, Kind::Number];
    let rows = parse(
        text.join("\n").as_bytes(),
        1,
        &kinds,
        Dialect::MIXED,
        &options,
        &progress,
    )
    .unwrap();
    assert_eq!(progress.done(), text.join("\n").len());
    assert_eq!(rows.len(), 200_000);
    assert!((0..200_000).all(|i| rows.columns[2][i] == -(i as f64) - 0.5));
    assert!(text.join("\n").len() > 2 * BLOCK_BYTES);
    "1 2 oops 4".clone_into(&mut text[150_000]);
    "1 2".clone_into(&mut text[170_000]);
    "1 2 3 oops".clone_into(&mut text[180_000]);
    let rows = parse(
        text.join("\r\n").as_bytes(),
        11,
        &kinds,
        Dialect::MIXED,
        &options,
        &progress,
    )
    .unwrap();
    assert_eq!(rows.len(), 199_998);
    assert_eq!(rows.odd_lines.count, 2);
    assert_eq!(rows.odd_lines.fault().unwrap().place, Place::Line(150_011));
    assert_eq!(
        (rows.odd_cells.count, rows.odd_cells.first.map(|first| first.0)),
        (1, Some(180_011))
    );
}

#[test]
fn parsing_stays_within_the_memory_limit() {
    let kinds = [Kind::Required; 3];
    let parse = |line: &str, max_bytes: u64| {
        let text = line.repeat(1 << 20);
        let options = ReadOptions::default().with_max_memory(max_bytes);
        let progress = Progress::default();
        parse(text.as_bytes(), 1, &kinds, Dialect::MIXED, &options, &progress).map(|rows| rows.len())
    };
    for (line, rows, bytes) in [
        ("1 2 3\n", 1 << 20, 48 << 20),
        ("1\n", 0, 48 << 20),
        ("1 2 3\n\n", 1 << 20, 112 << 20),
    ] {
        assert_eq!(parse(line, bytes).unwrap(), rows, "{line:?}");
        let refused = parse(line, bytes - 1024).unwrap_err().problem;
        assert!(refused.contains("--max-memory"), "{refused}");
    }
}

#[test]
fn words_become_indices_in_order() {
    let lines = ["1 2 3 car\n", "1 2 3 bus\n", "1 2 3 -\n", "1 2 3 van\n"];
    let text = lines.concat().repeat(150_000 / 4);
    let kinds = [Kind::Required, Kind::Required, Kind::Required, Kind::Text];
    let rows = parse(
        text.as_bytes(),
        1,
        &kinds,
        Dialect::MIXED,
        &ReadOptions::default(),
        &Progress::default(),
    )
    .unwrap();
    assert_eq!(rows.words[3], ["-", "bus", "car", "van"]);
    assert_eq!(rows.columns[3][..4], [2.0, 1.0, 0.0, 3.0]);
    assert_eq!(rows.columns[3][149_996..], [2.0, 1.0, 0.0, 3.0]);
}
