//! Known clouds have known paints.

use super::*;
use crate::cloud::{Positions, RawCloud};
use crate::sequence::{Needs, PrepareCounters, prepare};
use glam::DVec3;
use std::sync::Arc;

/// A line of 101 points along X, or a wide flat field of them.
fn cloud(is_flat: bool) -> RawCloud {
    let position = |index: usize| {
        let along = index as f32;
        let across = if is_flat { (index % 10) as f32 * 5.0 } else { 0.0 };
        [along, across, (index % 7) as f32]
    };
    let mut raw = RawCloud::from_positions(Positions::F32((0..101).map(position).collect()));
    raw.attributes.normals = Some(vec![[0.0, 1.0, 0.0]; 101]);
    raw
}

fn field(name: &str, value: impl Fn(usize) -> f32) -> ScalarField {
    ScalarField::new(name, (0..101).map(value).collect())
}

fn frame(raw: RawCloud) -> Frame {
    Frame::from_raw(raw, DVec3::ZERO).unwrap()
}

fn paint_of(source: ColorSource, raw: &RawCloud) -> Paint {
    Coloring::of(source).paint(&ColorHints::default(), &frame(raw.clone()))
}

fn scale_of(paint: Paint) -> [f64; 2] {
    match paint {
        Paint::Scale { scale, .. } => scale.ends(),
        other => panic!("{other:?} has no scale"),
    }
}

fn colors(color: impl Fn(usize) -> [u8; 3]) -> Vec<[u8; 4]> {
    let opaque = |[red, green, blue]: [u8; 3]| [red, green, blue, 255];
    (0..101).map(|index| opaque(color(index))).collect()
}

#[test]
fn the_automatic_source_is_the_first_informative_one() {
    let auto = |raw: &RawCloud| paint_of(ColorSource::Auto, raw).source();
    let intensity = ColorSource::Scalar(Some(FieldName::new("intensity")));
    let mut full = cloud(true);
    full.attributes.colors = Some(colors(|index| [index as u8, 7, 7]));
    full.attributes.scalars = vec![
        field("intensity", |index| index as f32),
        field("classification", |index| (index % 3) as f32),
    ];
    assert_eq!(auto(&full), ColorSource::File);
    for plain in [
        Some(colors(|_| [90, 90, 90])),
        Some(colors(|_| [0; 3])),
        Some(colors(|index| if index < 50 { [0; 3] } else { [255; 3] })),
        None,
    ] {
        let mut raw = full.clone();
        raw.attributes.colors = plain;
        assert_eq!(auto(&raw), intensity);
    }
    let mut raw = full;
    raw.attributes.colors = None;
    raw.attributes.scalars[0] = field("intensity", |_| 3.0);
    assert_eq!(auto(&raw), ColorSource::Class);
    raw.attributes.scalars[1] = field("classification", |_| 1.0);
    assert_eq!(
        auto(&raw),
        ColorSource::Height(HeightAxis::Auto),
        "a flat field is a survey"
    );
    let mut line = cloud(false);
    line.attributes.scalars = raw.attributes.scalars;
    assert_eq!(auto(&line), ColorSource::Normal);
    line.attributes.scalars = vec![field("curvature", |index| index as f32)];
    assert_eq!(auto(&line), ColorSource::Normal, "other fields are for those who ask");
    line.attributes.scalars = vec![field("scalar_Reflectance", |index| index as f32)];
    assert!(matches!(auto(&line), ColorSource::Scalar(_)));
}

#[test]
fn hints_override_guesses() {
    let paint = |prefers_height, up| {
        let hints = ColorHints { up, prefers_height };
        Coloring::default().paint(&hints, &frame(cloud(true)))
    };
    assert_eq!(paint(Some(false), None), Paint::Normal);
    let heights = |paint| match paint {
        Paint::Scale {
            values: PaintValues::Height(up),
            ..
        } => Some(up),
        _ => None,
    };
    assert_eq!(heights(paint(None, None)), Some(Vec3::Z));
    assert_eq!(heights(paint(Some(true), Some(Vec3::X))), Some(Vec3::X));
}

#[test]
fn ranges_exclude_one_per_cent_at_either_end_unless_given() {
    let mut raw = cloud(false);
    raw.attributes.scalars = vec![field("heat", |index| index as f32)];
    raw.attributes.scalars[0].values[100] = 1e30;
    raw.attributes.scalars[0].values[50] = f32::NAN;
    let heat = ColorSource::Scalar(Some(FieldName::new("Heat")));
    assert_eq!(scale_of(paint_of(heat, &raw)), [1.0, 99.0]);
    let fixed = Coloring {
        range: ColorRange::Fixed { low: -5.0, high: 5.0 },
        ..Coloring::of(heat)
    };
    let paint = fixed.paint(&ColorHints::default(), &frame(raw.clone()));
    assert_eq!(scale_of(paint), [-5.0, 5.0]);
    let all = Coloring {
        range: "p0..p100".parse().unwrap(),
        ..Coloring::of(heat)
    };
    let paint = all.paint(&ColorHints::default(), &frame(raw.clone()));
    assert_eq!(scale_of(paint), [0.0, f64::from(1e30f32)]);
    // On a logarithmic scale only values with a logarithm count.
    let logarithmic = Coloring {
        is_logarithmic: true,
        ..all
    };
    let paint = logarithmic.paint(&ColorHints::default(), &frame(raw));
    assert_eq!(scale_of(paint), [1.0, f64::from(1e30f32)]);
}

#[test]
fn offsets_of_fields_and_of_the_origin_are_included_in_the_numbers() {
    let origin = DVec3::new(5e6, 0.0, 1000.0);
    let mut raw = cloud(true);
    let times: Vec<f64> = (0..101).map(|index| 3.1e8 + index as f64 * 0.25).collect();
    raw.attributes.scalars = vec![ScalarField::from_f64("gps_time", &times)];
    let positions = (0..101).map(|index| [5e6 + index as f64, 0.0, 1000.0 + index as f64]);
    raw.positions = Positions::F64(positions.collect());
    let sample = Arc::new(ValueSample::of_raw(&raw, &[], origin));
    let frame = Frame::from_raw(raw, origin).unwrap();
    frame.share_sample(sample);
    let hints = ColorHints {
        up: Some(Vec3::Z),
        prefers_height: None,
    };
    let ends = |source| scale_of(Coloring::of(source).paint(&hints, &frame));
    assert_eq!(ends(ColorSource::Time), [3.1e8 + 0.25, 3.1e8 + 24.75]);
    assert_eq!(ends(ColorSource::Height(HeightAxis::Auto)), [1001.0, 1099.0]);
    assert_eq!(ends(ColorSource::Height(HeightAxis::Axis(2, true))), [-1099.0, -1001.0]);
    let place = DVec3::new(5e6, 0.0, 1000.0);
    let [near, far] = ends(ColorSource::Distance(DistanceFrom::Place(place)));
    assert!((near - 2f64.sqrt()).abs() < 1e-6 && (far - 99.0 * 2f64.sqrt()).abs() < 1e-4);
    // The colours as well: the centre of the range has the colour at the centre of the map.
    for source in [ColorSource::Time, ColorSource::Height(HeightAxis::Auto)] {
        let needs = Needs {
            colors: Coloring::of(source),
            hints,
            ..Needs::default()
        };
        let prepared = prepare(0, Arc::new(frame.clone()), 0.0, &needs, &PrepareCounters::default());
        let slot = frame.file_index().iter().position(|&index| index == 50).unwrap();
        assert_eq!(prepared.points[slot].color, ColorMap::Viridis.color(0.5), "{source}");
    }
}

#[test]
fn frames_of_a_sequence_share_one_range_whichever_is_seen_first() {
    let at = |factor: f32| {
        let mut raw = cloud(false);
        raw.attributes.scalars = vec![field("heat", |index| index as f32 * factor)];
        raw
    };
    let sample = Arc::new(ValueSample::of_raw(&at(1.0), &[], DVec3::ZERO));
    let later = frame(at(3.0));
    later.share_sample(sample);
    let paint = Coloring::of(ColorSource::Scalar(None)).paint(&ColorHints::default(), &later);
    assert_eq!(scale_of(paint), [1.0, 99.0]);
}

#[test]
fn attributes_a_frame_lacks_are_replaced_for_that_frame_only() {
    let mut first = cloud(false);
    first.attributes.scalars = vec![field("intensity", |index| index as f32)];
    let sample = Arc::new(ValueSample::of_raw(&first, &[], DVec3::ZERO));
    let mut bare = cloud(false);
    bare.attributes.scalars = vec![field("other", |index| 2.0 * index as f32)];
    let bare = frame(bare);
    bare.share_sample(sample);
    let paint = |source| Coloring::of(source).paint(&ColorHints::default(), &bare);
    assert_eq!(paint(ColorSource::Auto), Paint::Normal);
    assert_eq!(paint(ColorSource::File), Paint::Normal);
    assert_eq!(paint(ColorSource::Class), Paint::Normal);
    // A field that the first frame lacks: the range is the frame's.
    assert_eq!(scale_of(paint(ColorSource::Scalar(None))), [2.0, 198.0]);
}

#[test]
fn frames_with_one_point_no_point_or_one_value_are_colored() {
    for count in [0, 1, 5] {
        let mut raw = RawCloud::from_positions(Positions::F32(vec![[1.0, 2.0, 3.0]; count]));
        raw.attributes.scalars = vec![
            ScalarField::new("classification", vec![2.0; count]),
            ScalarField::new("t", vec![f32::NAN; count]),
        ];
        raw.attributes.normals = Some(vec![[1.0, 0.0, 0.0]; count]);
        let frame = Arc::new(frame(raw));
        for source in ColorSource::ALL {
            for is_logarithmic in [false, true] {
                let colors = Coloring {
                    is_logarithmic,
                    ..Coloring::of(source)
                };
                let needs = Needs {
                    colors,
                    ..Needs::default()
                };
                let prepared = prepare(0, Arc::clone(&frame), 0.0, &needs, &PrepareCounters::default());
                assert_eq!(prepared.points.len(), count);
                let color = prepared.points.first().map(|point| point.color);
                let expected = match source {
                    ColorSource::Scalar(_) | ColorSource::Height(_) | ColorSource::Distance(_) => {
                        ColorMap::Viridis.color(0.5)
                    }
                    ColorSource::Time => crate::sequence::NO_VALUE_COLOR,
                    ColorSource::Class => crate::analysis::class_color(2),
                    ColorSource::Uniform => crate::sequence::UNIFORM_COLOR,
                    ColorSource::Auto | ColorSource::File | ColorSource::Normal => [255, 128, 128, 255],
                };
                assert_eq!(color, (count > 0).then_some(expected), "{source} of {count}");
            }
        }
    }
}
