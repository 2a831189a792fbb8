//! Frames completed for rendering: their contents, shared data, work not done twice.

use super::*;
use pointreel::analysis::{ColorMap, fake_color};
use pointreel::cloud::{ScalarField, oct_decode};
use pointreel::sequence::{PrepareCounters, UNIFORM_COLOR, complete, prepare, prepare_part};

/// Octrees, surfaces, radii and records made so far.
fn work(counters: &PrepareCounters) -> [u64; 4] {
    [
        counters.octrees_built(),
        counters.surfaces_estimated(),
        counters.radii_estimated(),
        counters.records_written(),
    ]
}

fn frame_of(raw: RawCloud) -> Arc<Frame> {
    Arc::new(Frame::from_raw(raw, DVec3::ZERO).unwrap())
}

const N: u64 = 100;

#[test]
fn attributes_of_the_file_are_not_estimated() {
    let counters = PrepareCounters::default();
    let frame = frame_of(complete_sheet(10, 3));
    let prepared = prepare(0, Arc::clone(&frame), 0.0, &SURFELS, &counters);
    assert_eq!(work(&counters), [0, 0, 0, 2 * N]);
    let shapes = prepared.shapes.unwrap();
    assert!(shapes.iter().all(|shape| shape.radius == 0.5));
    assert!(shapes.iter().all(|shape| oct_decode(shape.normal) == Vec3::Y));
    let positions = by_file(&frame, frame.positions());
    for (i, point) in by_file(&frame, &prepared.points).iter().enumerate() {
        assert_eq!(Vec3::from_array(point.position), positions[i]);
        assert_eq!(point.color, [i as u8, 3, 7, 255]);
    }
}

#[test]
fn a_subset_has_the_points_of_its_slots_and_radii_that_close_its_surface() {
    let counters = PrepareCounters::default();
    let whole = prepare(0, frame_of(complete_sheet(10, 3)), 0.0, &SURFELS, &counters);
    // Every second row: they are two apart.
    let is_retained = |index: u32| (index / 10).is_multiple_of(2);
    let of_file = whole.frame.file_index().iter();
    let slots = (0..).zip(of_file).filter(|&(_, &index)| is_retained(index));
    let slots: Vec<u32> = slots.map(|(slot, _)| slot).collect();
    let part = prepare_part(&whole, &slots, &SURFELS, &counters).unwrap();
    assert_eq!((part.points.len(), part.frame.points_in_file()), (50, 100));
    assert!(part.is_sample() && part.paint() == whole.paint());
    let slot_of = |index: u32| {
        let mut of_file = whole.frame.file_index().iter();
        of_file.position(|&other| other == index).unwrap()
    };
    let shapes = part.shapes.as_ref().unwrap();
    for (slot, &index) in part.frame.file_index().iter().enumerate() {
        assert!(is_retained(index));
        assert_eq!(part.points[slot], whole.points[slot_of(index)]);
        assert_eq!(oct_decode(shapes[slot].normal), Vec3::Y);
        // The file has 0.5, which would leave gaps between the rows.
        assert!(shapes[slot].radius > 1.0, "{}", shapes[slot].radius);
    }
    assert!(prepare_part(&whole, &[], &SURFELS, &counters).is_ok_and(|part| part.points.is_empty()));
}

#[test]
fn only_what_is_missing_is_estimated() {
    let counters = PrepareCounters::default();
    let mut raw = complete_sheet(10, 0);
    raw.attributes.radii = None;
    prepare(0, frame_of(raw), 0.0, &SURFELS, &counters);
    assert_eq!(work(&counters)[1..3], [0, 1]);
    let prepared = prepare(0, frame_of(sheet(10, 0)), 0.0, &SURFELS, &counters);
    assert_eq!(work(&counters)[1..3], [1, 1]);
    assert!(prepared.shapes.unwrap().iter().all(|shape| shape.radius > 0.0));
}

#[test]
fn points_alone_need_nothing_else() {
    let counters = PrepareCounters::default();
    let prepared = prepare(0, frame_of(complete_sheet(10, 0)), 0.0, &Needs::default(), &counters);
    assert_eq!(work(&counters), [0, 0, 0, N]);
    assert!(prepared.shapes.is_none() && prepared.levels.octree().is_none());
}

#[test]
fn zero_normals_and_radii_are_replaced_and_others_retained() {
    let mut raw = complete_sheet(10, 0);
    let tilted = Vec3::new(0.6, 0.8, 0.0);
    raw.attributes.normals = Some(vec![tilted.to_array(); 100]);
    raw.attributes.normals.as_mut().unwrap()[42] = [0.0; 3];
    raw.attributes.radii.as_mut().unwrap()[17] = 0.0;
    let prepared = prepare(0, frame_of(raw), 0.0, &SURFELS, &PrepareCounters::default());
    let shapes = by_file(&prepared.frame, &prepared.shapes.unwrap());
    let normal_of = |i: usize| oct_decode(shapes[i].normal);
    assert!((normal_of(41) - tilted).length() < 1e-3);
    assert!((normal_of(42) - tilted).length() > 1e-2 && normal_of(42).is_normalized());
    assert_eq!(shapes[16].radius, 0.5);
    assert!(shapes[17].radius > 0.0 && shapes[17].radius.is_finite());
}

#[test]
fn colors_come_from_the_best_available_source() {
    let auto = |raw: RawCloud| {
        let prepared = prepare(0, frame_of(raw), 0.0, &Needs::default(), &PrepareCounters::default());
        let points = by_file(&prepared.frame, &prepared.points);
        (prepared.colors(), points[0].color)
    };
    assert_eq!(auto(complete_sheet(10, 9)), (ColorSource::File, [0, 9, 7, 255]));
    let mut raw = complete_sheet(10, 0);
    raw.attributes.colors = None;
    assert_eq!(auto(raw.clone()), (ColorSource::Normal, fake_color(Vec3::Y)));
    let values = (0..100).map(|i| i as f32).collect();
    raw.attributes.scalars = vec![ScalarField::new("intensity", values)];
    let (source, color) = auto(raw.clone());
    assert_eq!(source.to_string(), "scalar:intensity");
    assert_eq!(color, ColorMap::Viridis.color(0.0));
    raw.attributes.scalars[0].values.fill(7.0);
    assert_eq!(auto(raw).0, ColorSource::Normal, "it says nothing");

    let uniform = Needs {
        colors: Coloring::of(ColorSource::Uniform),
        ..Needs::default()
    };
    let prepared = prepare(0, frame_of(sheet(10, 0)), 0.0, &uniform, &PrepareCounters::default());
    assert!(prepared.points.iter().all(|point| point.color == UNIFORM_COLOR));
    // The file lacks the requested data: as if automatic.
    let file = Needs {
        colors: Coloring::of(ColorSource::File),
        ..Needs::default()
    };
    let prepared = prepare(0, frame_of(sheet(10, 0)), 0.0, &file, &PrepareCounters::default());
    assert_eq!(prepared.colors(), ColorSource::Normal);
}

#[test]
fn another_delta_builds_an_octree_and_nothing_else() {
    let counters = PrepareCounters::default();
    let first = prepare(0, frame_of(sheet(10, 0)), 0.0, &surfels_by_octree(0.0), &counters);
    assert_eq!(work(&counters), [1, 1, 0, 2 * N]);
    let second = complete(&first, &surfels_by_octree(0.6), &counters);
    assert_eq!(work(&counters), [2, 1, 0, 2 * N]);
    assert_eq!(first.id, second.id);
    assert!(Arc::ptr_eq(&first.points, &second.points));
    assert!(Arc::ptr_eq(&first.frame, &second.frame));
    assert!(Arc::ptr_eq(
        first.shapes.as_ref().unwrap(),
        second.shapes.as_ref().unwrap()
    ));
    assert!(second.levels.octree().unwrap().leaf_count() < first.levels.octree().unwrap().leaf_count());
}

#[test]
fn repeating_the_same_needs_does_nothing() {
    let counters = PrepareCounters::default();
    let needs = surfels_by_octree(0.1);
    let first = prepare(0, frame_of(sheet(10, 0)), 0.0, &needs, &counters);
    let before = work(&counters);
    let second = complete(&first, &needs, &counters);
    // Lesser needs are satisfied as well: nothing is discarded.
    let third = complete(&second, &Needs::default(), &counters);
    assert_eq!(work(&counters), before);
    assert!(Arc::ptr_eq(
        first.levels.octree().unwrap(),
        third.levels.octree().unwrap()
    ));
    assert!(first.satisfies(&needs) && third.satisfies(&needs));
}

#[test]
fn other_colors_rewrite_points_and_the_octree_only_if_it_is_needed() {
    let counters = PrepareCounters::default();
    let first = prepare(
        0,
        frame_of(complete_sheet(10, 0)),
        0.0,
        &surfels_by_octree(0.1),
        &counters,
    );
    assert_eq!(work(&counters), [1, 0, 0, 2 * N]);
    let recolored = Needs {
        shapes: true,
        colors: Coloring::of(ColorSource::Normal),
        ..surfels_by_octree(0.1)
    };
    let second = complete(&first, &recolored, &counters);
    assert_eq!(work(&counters), [2, 0, 0, 3 * N]);
    assert_ne!(first.id, second.id);
    assert!(Arc::ptr_eq(
        first.shapes.as_ref().unwrap(),
        second.shapes.as_ref().unwrap()
    ));
    let root_color = |prepared: &PreparedFrame| prepared.levels.octree().unwrap().level_voxels(0)[0].color;
    assert_eq!(root_color(&second), fake_color(Vec3::Y)[..3]);
    assert_ne!(root_color(&first), root_color(&second));
    let without_octree = Needs {
        levels: None,
        colors: Coloring::of(ColorSource::Uniform),
        ..recolored
    };
    let third = complete(&second, &without_octree, &counters);
    assert_eq!(work(&counters), [2, 0, 0, 4 * N]);
    assert!(third.levels.octree().is_none(), "an octree in colours of the past");
}

#[test]
fn the_order_of_requested_needs_does_not_change_the_result() {
    let fake = Needs {
        colors: Coloring::of(ColorSource::Normal),
        ..Needs::default()
    };
    let both = Needs { shapes: true, ..fake };
    for raw in [sheet(10, 0), complete_sheet(10, 0)] {
        let counters = PrepareCounters::default();
        let at_once = prepare(0, frame_of(raw.clone()), 0.0, &both, &counters);
        let colors_first = complete(
            &prepare(0, frame_of(raw.clone()), 0.0, &fake, &counters),
            &both,
            &counters,
        );
        let shapes_first = complete(&prepare(0, frame_of(raw), 0.0, &SURFELS, &counters), &both, &counters);
        for other in [&colors_first, &shapes_first] {
            assert_eq!(at_once.points, other.points);
            assert_eq!(at_once.shapes, other.shapes);
        }
    }
}

#[test]
fn frames_without_points_and_with_one_are_prepared() {
    for count in [0, 1] {
        let raw = RawCloud::from_positions(Positions::F32(vec![[1.0, 2.0, 3.0]; count]));
        for source in ColorSource::ALL {
            let needs = Needs {
                shapes: true,
                ellipses: true,
                mesh: true,
                levels: Some(levels(LevelsKind::Codes, 0.05)),
                colors: Coloring::of(source),
                smoothing: 3.0,
                ..Needs::default()
            };
            let prepared = prepare(0, frame_of(raw.clone()), 0.0, &needs, &PrepareCounters::default());
            assert_eq!(prepared.points.len(), count);
            assert_eq!(prepared.shapes.as_ref().unwrap().len(), count);
            assert_eq!(prepared.levels.codes().unwrap().level(0).len(), count);
            assert!(prepared.satisfies(&needs));
        }
    }
}

/// A sheet of 900 points without normals, off its plane by up to half their spacing.
fn rough_sheet() -> RawCloud {
    let height = |at: u32| (at.wrapping_mul(0x9e37_79b9) >> 8) as f32 / (1 << 24) as f32 - 0.5;
    let place = |at: u32| [(at % 30) as f32, height(at), (at / 30) as f32];
    RawCloud::from_positions(Positions::F32((0..900).map(place).collect()))
}

#[test]
fn other_options_of_normals_estimate_them_again_and_nothing_else() {
    let counters = PrepareCounters::default();
    let automatic = Needs {
        levels: Some(levels(LevelsKind::Surfels, 0.05)),
        colors: Coloring::of(ColorSource::Uniform),
        ..SURFELS
    };
    let few = Needs {
        surface: SurfaceOptions {
            neighbours: Some(5),
            ..SurfaceOptions::AUTO
        },
        ..automatic
    };
    let first = prepare(0, frame_of(rough_sheet()), 0.0, &automatic, &counters);
    assert!(first.satisfies(&automatic) && !first.satisfies(&few));
    let second = complete(&first, &few, &counters);
    assert!(second.satisfies(&few) && !second.satisfies(&automatic));
    assert_eq!((counters.surfaces_estimated(), counters.octrees_built()), (2, 1));
    assert!(Arc::ptr_eq(&first.points, &second.points) && first.id == second.id);
    assert_ne!(first.shapes, second.shapes);
    let at_once = prepare(0, frame_of(rough_sheet()), 0.0, &few, &counters);
    assert_eq!(second.shapes, at_once.shapes);
    assert_eq!(complete(&second, &automatic, &counters).shapes, first.shapes);
    // Points in the colours of their normals have other colours.
    let by_normal = |needs: Needs| Needs {
        colors: Coloring::of(ColorSource::Normal),
        ..needs
    };
    let colored = complete(&first, &by_normal(automatic), &counters);
    let recolored = complete(&colored, &by_normal(few), &counters);
    assert!(colored.id != recolored.id && colored.points != recolored.points);
    // Normals of a file are unchanged.
    let given = prepare(0, frame_of(complete_sheet(10, 0)), 0.0, &automatic, &counters);
    assert!(given.satisfies(&few));
}

#[test]
fn smoothed_points_are_moved_once_told_and_taken_back() {
    let counters = PrepareCounters::default();
    let smooth = Needs {
        smoothing: 3.0,
        ..SURFELS
    };
    let roughness = |frame: &PreparedFrame| {
        let heights = frame.points.iter().map(|point| point.position[1].abs());
        heights.sum::<f32>() / frame.points.len() as f32
    };
    let first = prepare(0, frame_of(rough_sheet()), 0.0, &SURFELS, &counters);
    let moved = complete(&first, &smooth, &counters);
    assert!(
        roughness(&moved) < 0.5 * roughness(&first),
        "{} {}",
        roughness(&first),
        roughness(&moved)
    );
    assert!(!first.satisfies(&smooth) && moved.satisfies(&smooth) && !moved.satisfies(&SURFELS));
    assert!(!moved.is_sample() && moved.byte_size() > first.byte_size());
    let told = moved.frame.warnings().concat();
    assert!(
        told.starts_with("900 points are smoothed") && told.contains("in the median"),
        "{told}"
    );
    let mut indices = moved.frame.file_index().to_vec();
    indices.sort_unstable();
    assert!(indices.into_iter().eq(0..900));
    // Each other radius begins with the points of the file.
    let wider = Needs {
        smoothing: 4.5,
        ..SURFELS
    };
    let at_once = prepare(0, frame_of(rough_sheet()), 0.0, &wider, &counters);
    let after = complete(&moved, &wider, &counters);
    assert_eq!((&after.points, &after.shapes), (&at_once.points, &at_once.shapes));
    let back = complete(&moved, &SURFELS, &counters);
    assert!(Arc::ptr_eq(&back.frame, &first.frame));
    assert_eq!((&back.points, &back.shapes), (&first.points, &first.shapes));
    assert!(back.frame.warnings().is_empty());
}

#[test]
fn byte_codes_are_reused_as_long_as_their_inputs() {
    let counters = PrepareCounters::default();
    let without = Needs {
        shapes: true,
        levels: None,
        ..voxels(0.05)
    };
    let with = Needs {
        levels: Some(levels(LevelsKind::Codes, 0.05)),
        ..without
    };
    let frame = frame_of(complete_sheet(10, 0));
    let plain = prepare(0, frame, 0.0, &without, &counters);
    assert!(plain.levels.codes().is_none() && !plain.satisfies(&with));
    let coded = complete(&plain, &with, &counters);
    let code = coded.levels.codes().unwrap();
    let octree = coded.levels.octree().unwrap();
    assert_eq!(code.depth(), octree.depth());
    let added = octree.byte_size() + code.byte_size();
    assert_eq!(coded.byte_size(), plain.byte_size() + added);
    for (needs, is_same) in [
        (with, true),
        (without, true),
        (
            Needs {
                levels: Some(LevelsKey {
                    stop: StopCriterion::Depth(2),
                    ..with.levels.unwrap()
                }),
                ..with
            },
            false,
        ),
        (
            Needs {
                colors: Coloring::of(ColorSource::Uniform),
                ..with
            },
            false,
        ),
    ] {
        let next = complete(&coded, &needs, &counters);
        let other = next.levels.codes().unwrap();
        assert_eq!(Arc::ptr_eq(code, other), is_same, "{needs:?}");
    }
}

#[test]
fn every_byte_is_counted() {
    let needs = surfels_by_octree(0.05);
    let prepared = prepare(
        0,
        frame_of(complete_sheet(10, 0)),
        0.0,
        &needs,
        &PrepareCounters::default(),
    );
    // Position 12, file index 4, colour 4, normal 12, radius 4; a point record and a shape record of 16.
    let octree = prepared.levels.octree().unwrap();
    // Node surfels are counted before they are computed: a node above the leaves takes 40 bytes, and in each level two
    // 4-byte numbers locate the nodes of every 64 points.
    let nodes = octree.internal_count() * 40 + octree.depth() as usize * 8;
    // So are voxel normals, 16 bytes each, for the levels whose cells have at least three points.
    let coarse = octree.level_counts().iter();
    let coarse = coarse.take_while(|&&cells| 3 * cells <= 100);
    let normals: usize = coarse.map(|cells| cells * 16 + 8).sum();
    // And all nodes and points contiguously, as they are stored on a GPU, two records of 16 bytes each.
    let selectable = (octree.internal_count() + 100) * (16 + 16);
    let expected = 100 * (36 + 16 + 16) + octree.byte_size() + nodes + normals + selectable;
    assert_eq!(prepared.byte_size(), expected);
}
