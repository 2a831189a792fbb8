use super::*;
use crate::cloud::{Dropped, Positions, RawCloud};
use crate::sequence::FrameEntry;
use std::time::Duration;

/// A grid of 100 points a metre apart, moved by `shift` along X.
fn grid(shift: f64) -> RawCloud {
    let position = |index: u32| {
        let [x, y] = [index % 10, index / 10].map(f64::from);
        [x + shift, y, 0.5 * x]
    };
    RawCloud::from_positions(Positions::F64((0..100).map(position).collect()))
}

/// Findings in these clouds, under these names.
fn found(clouds: Vec<(&str, RawCloud)>) -> Vec<(FindingKind, Vec<usize>)> {
    let sources = clouds.iter().zip(0..).map(|((name, _), place)| FrameEntry {
        number: name.trim_matches(|c: char| !c.is_ascii_digit()).parse().ok(),
        // The decoder looks up the cloud by this name.
        name: format!("{place}"),
        ..FrameEntry::file(*name)
    });
    let sources = sources.collect();
    let clouds: Vec<RawCloud> = clouds.into_iter().map(|(_, cloud)| cloud).collect();
    let sequence = Sequence::with_decoder(sources, move |source| {
        let place: usize = source.name.parse()?;
        Ok(clouds[place].clone())
    });
    let report = check(&sequence, &|_| {});
    report
        .findings
        .into_iter()
        .map(|finding| (finding.kind, finding.frames))
        .collect()
}

#[test]
fn a_clean_sequence_has_no_findings() {
    let clouds = vec![("a_1", grid(0.0)), ("a_2", grid(0.1)), ("a_3", grid(0.2))];
    assert_eq!(found(clouds), []);
}

#[test]
fn each_fault_is_found_where_it_is() {
    use FindingKind as Kind;
    let broken = |change: &dyn Fn(&mut RawCloud)| {
        let mut cloud = grid(0.0);
        change(&mut cloud);
        found(vec![("a_1", grid(0.0)), ("a_2", cloud), ("a_3", grid(0.0))])
    };
    let set = |cloud: &mut RawCloud, index: usize, position: [f64; 3]| {
        if let Positions::F64(positions) = &mut cloud.positions {
            positions[index] = position;
        }
    };
    assert_eq!(
        broken(&|cloud| set(cloud, 3, [f64::NAN, 0.0, 0.0])),
        [(Kind::NonFinitePoints, vec![1])]
    );
    assert_eq!(
        broken(&|cloud| set(cloud, 3, [1.0, 0.0, 0.5])),
        [(Kind::DuplicatePoints, vec![1])]
    );
    assert_eq!(
        broken(&|cloud| cloud.warnings.push("a part is broken".to_owned())),
        [(Kind::UnreadablePart, vec![1])]
    );
    assert_eq!(
        broken(&|cloud| cloud.positions = Positions::F64(Vec::new())),
        [(Kind::EmptyFrame, vec![1])]
    );
    assert_eq!(
        broken(&|cloud| cloud.attributes.colors = Some(vec![[1; 4]; 100])),
        [(Kind::ChangedAttributes, vec![1])]
    );
    assert_eq!(
        broken(&|cloud| set(cloud, 99, [100.0, 0.0, 0.0])),
        [(Kind::BoundsJump, vec![0, 1]), (Kind::BoundsJump, vec![1, 2])]
    );
    assert_eq!(
        broken(&|cloud| {
            cloud.attributes.normals = Some(vec![[0.0, 0.0, 1.0]; 100]);
            cloud.attributes.normals.as_mut().unwrap()[7] = [0.0; 3];
        }),
        [(Kind::ChangedAttributes, vec![1]), (Kind::ZeroNormals, vec![1])]
    );
    assert_eq!(
        broken(&|cloud| cloud.has_narrow_colors = true),
        [(Kind::NarrowColors, vec![1])]
    );
}

#[test]
fn missing_numbers_are_gaps_and_strides_are_not() {
    let names = |numbers: &[&'static str]| {
        let clouds = numbers.iter().map(|&number| (number, grid(0.0)));
        found(clouds.collect())
    };
    assert_eq!(names(&["1", "2", "5", "6"]), [(FindingKind::NumberGap, vec![1, 2])]);
    assert_eq!(names(&["10", "20", "30"]), []);
    assert_eq!(names(&["10", "20", "40", "50"]), [(FindingKind::NumberGap, vec![1, 2])]);
    assert_eq!(
        names(&["5", "6", "8", "10"]),
        [
            (FindingKind::NumberGap, vec![1, 2]),
            (FindingKind::NumberGap, vec![2, 3])
        ]
    );
    // Timestamps of a sensor: numbers between them are not missing.
    assert_eq!(names(&["142255", "142298", "142341", "142399"]), []);
}

#[test]
fn coordinates_that_lose_digits_are_reported() {
    let far: Vec<[f32; 3]> = (0..100).map(|index| [4e6 + index as f32, 5e6, 0.0]).collect();
    let cloud = RawCloud::from_positions(Positions::F32(far));
    assert_eq!(found(vec![("a", cloud)]), [(FindingKind::SuspiciousScale, vec![0])]);
    let mut tiny = grid(0.0);
    if let Positions::F64(positions) = &mut tiny.positions {
        for position in positions {
            *position = position.map(|value| value * 1e-9);
        }
    }
    assert_eq!(found(vec![("a", tiny)]), [(FindingKind::SuspiciousScale, vec![0])]);
}

#[test]
fn pauses_and_decreasing_timestamps_are_found() {
    let at = |times_ms: &[u64]| {
        let sources = times_ms.iter().map(|&time_ms| FrameEntry {
            time: Some(Duration::from_millis(time_ms)),
            ..FrameEntry::file("a.ply")
        });
        let sequence = Sequence::with_decoder(sources.collect(), |_| Ok(grid(0.0)));
        let findings = check(&sequence, &|_| {}).findings;
        let findings = findings.into_iter().map(|finding| (finding.kind, finding.frames));
        findings.collect::<Vec<_>>()
    };
    assert_eq!(at(&[0, 100, 205, 300]), []);
    assert_eq!(at(&[0, 100, 200, 5000, 5100]), [(FindingKind::TimeJump, vec![2, 3])]);
    assert_eq!(at(&[0, 100, 50, 150]), [(FindingKind::TimeJump, vec![1, 2])]);
}

#[test]
fn a_frame_that_fails_is_a_finding_with_its_reason() {
    let sources = vec![FrameEntry::file("a_1.ply"), FrameEntry::file("a_2.ply")];
    let sequence = Sequence::with_decoder(sources, |source| {
        if source.name == "a_2.ply" {
            Err("point 7 is missing".into())
        } else {
            Ok(grid(0.0))
        }
    });
    let report = check(&sequence, &|_| {});
    assert_eq!(report.findings.len(), 1);
    assert_eq!(report.findings[0].kind, FindingKind::UnreadableFrame);
    assert_eq!(report.findings[0].message, "point 7 is missing");
    assert_eq!((report.frame_count, report.point_count), (2, 100));
}

#[test]
fn unread_content_is_a_note() {
    let mut cloud = grid(0.0);
    cloud.dropped = vec![
        Dropped::noted("lists of points are not read: `near`"),
        Dropped::quiet("digits"),
    ];
    let of_all = found(vec![("a_1", cloud.clone()), ("a_2", cloud)]);
    assert_eq!(of_all, [(FindingKind::UnreadProperties, vec![0, 1])]);
    assert_eq!(FindingKind::UnreadProperties.severity(), Severity::Note);
}
