//! The loader with decoders that the test holds in its hand.

use super::*;
use proptest::prelude::*;

/// Bytes of a prepared complete sheet with shapes.
fn sheet_bytes(edge: usize) -> usize {
    edge * edge * 68
}

fn ready(loader: &Loader, index: usize, needs: &Needs) -> bool {
    matches!(loader.get(index, needs), Slot::Ready(_))
}

#[test]
fn the_sequence_is_prepared_ahead_of_the_playhead() {
    let sequence = sheets(10, 8);
    let loader = loader(&sequence, 2, usize::MAX);
    loader.request(7, Direction::Forward, &SURFELS);
    until("all frames", || (0..10).all(|index| ready(&loader, index, &SURFELS)));
    let stats = loader.stats();
    assert_eq!((stats.decoded, stats.resident_frames, stats.evicted), (10, 10, 0));
    assert_eq!(stats.resident_bytes, 10 * sheet_bytes(8));
    assert!(loader.states().iter().all(|&state| state == FrameState::Ready));
}

#[test]
fn frames_are_loaded_in_playback_order() {
    use Direction::{Backward, Forward};
    let cases = [
        (LoopMode::Loop, 3, Forward, vec![3, 4, 0, 1, 2]),
        (LoopMode::Loop, 1, Backward, vec![1, 0, 4, 3, 2]),
        (LoopMode::Off, 3, Forward, vec![3, 4]),
        (LoopMode::Off, 1, Backward, vec![1, 0]),
        (LoopMode::PingPong, 3, Forward, vec![3, 4, 2, 1, 0]),
    ];
    for (loop_mode, playhead, direction, expected) in cases {
        let order = Arc::new(Mutex::new(Vec::new()));
        let seen = Arc::clone(&order);
        let sequence = Arc::new(Sequence::with_decoder(fake_sources(5), move |source| {
            seen.lock().unwrap().push(index_of(source));
            Ok(complete_sheet(4, 0))
        }));
        // Frame 0 determines the origin, whatever is played.
        sequence.origin();
        let loader = loader(&sequence, 1, usize::MAX);
        loader.set_loop_mode(loop_mode);
        loader.request(playhead, direction, &SURFELS);
        until_idle(&loader);
        let decoded = order.lock().unwrap().clone();
        let expected: Vec<usize> = std::iter::once(0)
            .chain(expected.into_iter().filter(|&index| index != 0))
            .collect();
        assert_eq!(decoded, expected, "{loop_mode:?} {direction:?} from {playhead}");
    }
}

#[test]
fn only_the_played_range_is_prepared_and_the_rest_is_evicted_first() {
    let sequence = sheets(10, 8);
    sequence.origin();
    let loader = loader(&sequence, 2, usize::MAX);
    loader.set_range(PlayRange::default().beginning_at(2).ending_at(4));
    // The playhead is elsewhere: its frame is made, and those that playback would reach.
    loader.request(8, Direction::Forward, &SURFELS);
    until_idle(&loader);
    let made = |loader: &Loader| -> Vec<usize> { (0..10).filter(|&index| ready(loader, index, &SURFELS)).collect() };
    assert_eq!(made(&loader), [2, 3, 4, 8]);
    // Without a range the others follow; with a range again, they are evicted first.
    loader.set_range(PlayRange::default());
    until_idle(&loader);
    assert_eq!(made(&loader).len(), 10);
    loader.set_range(PlayRange::default().beginning_at(5).ending_at(6));
    loader.request(5, Direction::Forward, &SURFELS);
    loader.set_budget_bytes(2 * sheet_bytes(8));
    assert_eq!(made(&loader), [5, 6]);
}

#[test]
fn the_first_frame_decides_the_origin_and_is_decoded_once() {
    let decodes = Arc::new(AtomicUsize::new(0));
    let counted = Arc::clone(&decodes);
    let sequence = Arc::new(Sequence::with_decoder(fake_sources(3), move |source| {
        counted.fetch_add(1, Ordering::SeqCst);
        let far = 1e6 * (1.0 + index_of(source) as f64);
        Ok(RawCloud::from_positions(Positions::F64(vec![
            [far, 0.0, 0.0],
            [far + 1.001, 0.0, 0.0],
        ])))
    }));
    assert_eq!(decodes.load(Ordering::SeqCst), 0, "opening reads nothing");
    let loader = loader(&sequence, 2, usize::MAX);
    let last = loader.wait(2, &Needs::default()).unwrap();
    assert_eq!(sequence.origin(), DVec3::new(1e6, 0.0, 0.0));
    assert_eq!(last.frame.positions()[0].x, 2e6);
    assert_eq!(decodes.load(Ordering::SeqCst), 2);
    let first = loader.wait(0, &Needs::default()).unwrap();
    assert!((first.frame.positions()[1].x - 1.001).abs() < 1e-6);
    assert_eq!(decodes.load(Ordering::SeqCst), 2, "decoded for the origin already");
}

#[test]
fn a_broken_first_frame_leaves_the_origin_to_the_next() {
    let sequence = Sequence::with_decoder(fake_sources(4), |source| match index_of(source) {
        0 => Err("bad magic".into()),
        // Holes only.
        1 => Ok(RawCloud::from_positions(Positions::F32(vec![[f32::NAN; 3]]))),
        _ => Ok(RawCloud::from_positions(Positions::F32(vec![[4096.0; 3], [4097.0; 3]]))),
    });
    assert_eq!(sequence.origin(), DVec3::splat(4096.0));
    assert_eq!(sequence.decode_count(), 3);
    assert_eq!(sequence.frame(0).unwrap_err().to_string(), "bad magic");
    assert_eq!(sequence.decode_count(), 3, "the error is remembered");
    assert_eq!(sequence.frame(1).unwrap().dropped_points(), 1);
    assert_eq!(sequence.frame(2).unwrap().positions()[1], Vec3::ONE);
}

#[test]
fn a_sequence_of_broken_frames_has_an_origin_too() {
    let sequence = Sequence::with_decoder(fake_sources(3), |_| Err("torn".into()));
    assert_eq!(sequence.origin(), DVec3::ZERO);
}

#[test]
fn broken_frames_are_reported_and_skipped() {
    let sequence = Arc::new(Sequence::with_decoder(fake_sources(6), |source| {
        match index_of(source) {
            1 => Err("1.fake: byte 7: expected a number".into()),
            2 => panic!("index out of bounds"),
            3 => {
                let mut raw = complete_sheet(4, 0);
                raw.attributes.normals = Some(Vec::new());
                Ok(raw)
            }
            time => Ok(complete_sheet(4, time)),
        }
    }));
    let loader = loader(&sequence, 2, usize::MAX);
    loader.request(0, Direction::Forward, &SURFELS);
    for index in [0, 4, 5] {
        until("a good frame", || ready(&loader, index, &SURFELS));
    }
    until_idle(&loader);
    assert_eq!(
        loader.states(),
        [
            FrameState::Ready,
            FrameState::Failed,
            FrameState::Failed,
            FrameState::Failed,
            FrameState::Ready,
            FrameState::Ready
        ]
    );
    assert_eq!(loader.stats().failed_frames, 3);
    let error = |index| match loader.get(index, &SURFELS) {
        Slot::Failed(error) => error,
        other => panic!("frame {index} is {other:?}"),
    };
    assert!(error(1).to_string().starts_with("1.fake: byte 7"));
    assert!(matches!(&*error(2), FrameError::Panic { message, .. } if message.contains("bounds")));
    assert!(error(2).to_string().starts_with("2.fake: "));
    assert!(error(3).to_string().contains("normal has 0 entries"));
    for index in 1..4 {
        assert_eq!(error(index).index(), index);
        assert_eq!(error(index).path().unwrap(), Path::new(&format!("{index}.fake")));
    }
    // Remembered: requesting it again does not read it again.
    let decoded = loader.stats().decoded;
    loader.request(1, Direction::Backward, &SURFELS);
    assert!(loader.wait(1, &SURFELS).is_err());
    until_idle(&loader);
    assert_eq!(loader.stats().decoded, decoded);
}

#[test]
fn an_index_beyond_the_end_is_an_error() {
    let loader = loader(&sheets(3, 4), 1, usize::MAX);
    let message = loader.wait(3, &SURFELS).unwrap_err().to_string();
    assert!(
        message.contains("frame 3 does not exist") && message.contains("3 frames"),
        "{message}"
    );
    assert!(matches!(loader.get(99, &SURFELS), Slot::Failed(_)));
    // A playhead past the end means the last frame; an empty sequence has none.
    loader.request(99, Direction::Forward, &SURFELS);
    until("the last frame", || ready(&loader, 2, &SURFELS));
    let empty = Arc::new(Sequence::with_decoder(Vec::new(), |_| Err("never".into())));
    let loader = super::loader(&empty, 1, 0);
    loader.request(0, Direction::Forward, &SURFELS);
    assert!(loader.wait(0, &SURFELS).is_err());
    assert!(loader.states().is_empty());
    assert_eq!(empty.origin(), DVec3::ZERO);
}

#[test]
fn another_delta_decodes_and_estimates_nothing() {
    let sequence = Arc::new(Sequence::with_decoder(fake_sources(4), |source| {
        Ok(sheet(8, index_of(source)))
    }));
    let loader = loader(&sequence, 2, usize::MAX);
    let needs = |delta| surfels_by_octree(delta);
    let all_ready = |needs: Needs| {
        loader.request(0, Direction::Forward, &needs);
        until("all frames", || (0..4).all(|index| ready(&loader, index, &needs)));
        until_idle(&loader);
        loader.stats()
    };
    let first = all_ready(needs(0.02));
    assert_eq!(
        (first.decoded, first.surfaces_estimated, first.octrees_built),
        (4, 4, 4)
    );
    assert_eq!(first.records_written, 4 * 2 * 64);
    let second = all_ready(needs(0.5));
    assert_eq!(
        (second.decoded, second.surfaces_estimated, second.octrees_built),
        (4, 4, 8)
    );
    assert_eq!(second.records_written, first.records_written);
    // The same again, another playhead, fewer needs: no work at all.
    let revision = loader.revision();
    let third = all_ready(needs(0.5));
    assert_eq!((second, revision), (third, loader.revision()));
    loader.request(2, Direction::Backward, &Needs::default());
    until_idle(&loader);
    assert_eq!(loader.stats().records_written, second.records_written);
    assert_eq!(loader.stats().octrees_built, second.octrees_built);
}

#[test]
fn the_old_frame_stays_available_while_the_new_one_is_prepared() {
    let sequence = sheets(2, 8);
    let loader = loader(&sequence, 1, usize::MAX);
    loader.wait(0, &SURFELS).unwrap();
    assert!(matches!(loader.get(0, &voxels(0.1)), Slot::Stale(frame) if frame.index == 0));
    assert!(matches!(loader.get(1, &SURFELS), Slot::Pending));
    loader.request(0, Direction::Forward, &voxels(0.1));
    until("the octree", || ready(&loader, 0, &voxels(0.1)));
}

#[test]
fn work_the_playhead_has_passed_is_cancelled() {
    let gate = Arc::new(Gate::default());
    let held = Arc::clone(&gate);
    let sequence = Arc::new(Sequence::with_decoder(fake_sources(100), move |source| {
        let index = index_of(source);
        if index > 0 {
            held.pass(index);
        }
        Ok(complete_sheet(4, index))
    }));
    sequence.origin();
    let loader = loader(&sequence, 1, usize::MAX);
    loader.set_loop_mode(LoopMode::Off);
    loader.request(10, Direction::Forward, &SURFELS);
    until("the worker", || gate.arrivals() == [10]);
    // The playhead jumps while frame 10 is being read: 11, 12 … are never started, 10 is not prepared.
    loader.request(95, Direction::Forward, &SURFELS);
    gate.open();
    until("the last frame", || ready(&loader, 99, &SURFELS));
    until_idle(&loader);
    assert_eq!(gate.arrivals(), [10, 95, 96, 97, 98, 99]);
    let stats = loader.stats();
    assert_eq!((stats.cancelled, stats.resident_frames), (1, 5));
    // Frame 0 was decoded for the origin and is cached: 16 points with position, colour, normal and radius.
    assert_eq!(stats.in_flight_bytes, 16 * 32);
    assert!(matches!(loader.get(10, &SURFELS), Slot::Pending));
}

#[test]
fn current_needs_are_met_not_those_at_the_start() {
    let gate = Arc::new(Gate::default());
    let held = Arc::clone(&gate);
    let sequence = Arc::new(Sequence::with_decoder(fake_sources(1), move |_| {
        held.pass(0);
        Ok(complete_sheet(4, 0))
    }));
    let loader = loader(&sequence, 1, usize::MAX);
    loader.request(0, Direction::Forward, &voxels(0.1));
    until("the worker", || gate.arrivals() == [0]);
    loader.request(0, Direction::Forward, &SURFELS);
    gate.open();
    until("the frame", || ready(&loader, 0, &SURFELS));
    until_idle(&loader);
    let stats = loader.stats();
    assert_eq!((stats.octrees_built, stats.decoded), (0, 1));
}

#[test]
fn the_playhead_comes_before_everything_planned() {
    let gate = Arc::new(Gate::default());
    let held = Arc::clone(&gate);
    let sequence = Arc::new(Sequence::with_decoder(fake_sources(50), move |source| {
        let index = index_of(source);
        if index == 1 {
            held.pass(index);
        }
        held.arrived.lock().unwrap().push(index);
        Ok(complete_sheet(4, index))
    }));
    let loader = loader(&sequence, 1, usize::MAX);
    loader.request(0, Direction::Forward, &SURFELS);
    until("the worker", || gate.arrivals().last() == Some(&1));
    loader.request(30, Direction::Forward, &SURFELS);
    gate.open();
    until_idle(&loader);
    let order = gate.arrivals();
    let after: Vec<usize> = order.iter().copied().skip_while(|&i| i != 1).skip(2).collect();
    assert_eq!(after[..3], [30, 31, 32], "{order:?}");
}

#[test]
fn a_loop_that_does_not_fit_caches_a_part_and_streams_the_rest() {
    let frames = 40;
    let sequence = sheets(frames, 8);
    let loader = loader(&sequence, 1, 24 * sheet_bytes(8));
    let turn = || {
        for playhead in 0..frames {
            loader.request(playhead, Direction::Forward, &SURFELS);
            loader.wait(playhead, &SURFELS).unwrap();
            until_idle(&loader);
        }
        loader.stats().decoded
    };
    let first = turn();
    let second = turn();
    let third = turn();
    // Twelve of the 24 resident frames are cycled, so that twelve of 40 or more need not be read again.
    for (before, after) in [(first, second), (second, third)] {
        assert!(after - before <= 28, "{} of 40 were read", after - before);
    }
    assert!(loader.stats().peak_bytes <= 25 * sheet_bytes(8));
}

#[test]
fn the_budget_can_change_while_playing() {
    let sequence = sheets(20, 8);
    let bytes = sheet_bytes(8);
    let loader = loader(&sequence, 2, usize::MAX);
    loader.request(5, Direction::Forward, &SURFELS);
    until("all frames", || loader.stats().resident_frames == 20);
    loader.set_budget_bytes(3 * bytes);
    let states = loader.states();
    let resident: Vec<usize> = (0..20).filter(|&i| states[i] == FrameState::Ready).collect();
    assert_eq!(resident, [5, 6, 7], "what is needed first stays");
    loader.set_budget_bytes(0);
    assert!(ready(&loader, 5, &SURFELS), "the playhead's own frame stays");
    assert_eq!(loader.stats().resident_frames, 1);
    loader.set_budget_bytes(5 * bytes);
    until("more frames", || loader.stats().resident_frames == 5);
}

#[test]
fn a_frame_larger_than_the_budget_is_shown_alone() {
    let sequence = sheets(3, 16);
    let loader = loader(&sequence, 2, 1000);
    for playhead in [0, 1, 2, 0] {
        loader.request(playhead, Direction::Forward, &SURFELS);
        until("the playhead's frame", || ready(&loader, playhead, &SURFELS));
        until_idle(&loader);
        assert_eq!(loader.stats().resident_frames, 1);
    }
}

#[test]
fn the_window_is_woken_once_per_frame() {
    let woken = Arc::new(AtomicUsize::new(0));
    let counted = Arc::clone(&woken);
    let sequence = Arc::new(Sequence::with_decoder(fake_sources(5), |source| {
        match index_of(source) {
            3 => Err("torn".into()),
            time => Ok(complete_sheet(4, time)),
        }
    }));
    let loader = Loader::new(
        Arc::clone(&sequence),
        LoaderOptions {
            workers: 2,
            wake: Arc::new(move || {
                counted.fetch_add(1, Ordering::SeqCst);
            }),
            ..LoaderOptions::default()
        },
    )
    .unwrap();
    loader.request(0, Direction::Forward, &SURFELS);
    until_idle(&loader);
    assert_eq!(woken.load(Ordering::SeqCst), 5);
}

#[test]
fn waiting_for_a_frame_prepares_no_other() {
    let sequence = sheets(10, 4);
    let loader = loader(&sequence, 2, usize::MAX);
    assert_eq!(loader.wait(0, &SURFELS).unwrap().index, 0);
    until_idle(&loader);
    assert_eq!(loader.stats().decoded, 1);
    // Even without memory to cache it.
    loader.set_budget_bytes(0);
    loader.request(0, Direction::Forward, &SURFELS);
    assert_eq!(loader.wait(6, &SURFELS).unwrap().index, 6);
    // From several threads, for several needs, at the same time.
    std::thread::scope(|scope| {
        for index in 0..8 {
            let loader = &loader;
            scope.spawn(move || {
                let needs = if index % 2 == 0 { SURFELS } else { voxels(0.1) };
                let frame = loader.wait(index / 2, &needs).unwrap();
                assert!(frame.satisfies(&needs));
            });
        }
    });
}

#[test]
fn dropping_the_loader_ends_its_threads() {
    let sequence = Arc::new(Sequence::with_decoder(fake_sources(10_000), |source| {
        std::thread::sleep(Duration::from_millis(5));
        Ok(complete_sheet(4, index_of(source)))
    }));
    let loader = loader(&sequence, 3, usize::MAX);
    loader.request(0, Direction::Forward, &SURFELS);
    until("some work", || loader.stats().decoded > 3);
    let start = Instant::now();
    drop(loader);
    // One frame each, not the thousands that were planned.
    assert!(start.elapsed() < Duration::from_secs(2));
    assert_eq!(Arc::strong_count(&sequence), 1, "no thread holds the sequence any more");
}

#[test]
fn request_cost_does_not_depend_on_sequence_length() {
    // A million frames, none of which can be read: planning must not iterate over them.
    let sequence = Arc::new(Sequence::with_decoder(fake_sources(1_000_000), |_| {
        Ok(complete_sheet(1, 0))
    }));
    let loader = loader(&sequence, 1, 10_000);
    let start = Instant::now();
    for playhead in 0..1000 {
        loader.request(playhead * 997, Direction::Forward, &SURFELS);
        assert!(!matches!(loader.get(playhead, &SURFELS), Slot::Failed(_)));
    }
    // Iterating over the sequence would take a thousand million steps.
    assert!(start.elapsed() < Duration::from_secs(5), "{:?}", start.elapsed());
}

#[test]
fn frames_do_not_depend_on_worker_count_or_timing() {
    let decode = |source: &FrameEntry| -> Result<RawCloud, DecodeFailure> { Ok(sheet(12, index_of(source))) };
    let needs = surfels_by_octree(0.05);
    let prepared = |workers: usize, playhead: usize| -> Vec<Arc<PreparedFrame>> {
        let sequence = Arc::new(Sequence::with_decoder(fake_sources(6), decode));
        let loader = loader(&sequence, workers, usize::MAX);
        loader.request(playhead, Direction::Backward, &needs);
        (0..6).map(|index| loader.wait(index, &needs).unwrap()).collect()
    };
    let reference = prepared(1, 0);
    for (workers, playhead) in [(2, 3), (4, 5)] {
        for (a, b) in reference.iter().zip(prepared(workers, playhead)) {
            assert_eq!(a.frame, b.frame);
            assert_eq!(a.points, b.points);
            assert_eq!(a.shapes, b.shapes);
            assert_eq!(a.levels.octree(), b.levels.octree());
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(24) })]

    /// Whatever is played, the memory in use is never more than the budget and one frame.
    #[test]
    fn the_budget_is_never_exceeded(
        budget_frames in 0usize..6,
        workers in 1usize..4,
        edges in prop::collection::vec(2usize..14, 16),
        moves in prop::collection::vec((0usize..16, any::<bool>(), 0usize..3, any::<bool>()), 1..20),
    ) {
        let largest = 13 * 13 * 68;
        let budget = budget_frames * largest;
        let sequence = Arc::new(Sequence::with_decoder(fake_sources(16), move |source| {
            Ok(complete_sheet(edges[index_of(source)], 0))
        }));
        let loader = loader(&sequence, workers, budget);
        for (playhead, forward, mode, wait) in moves {
            loader.set_loop_mode(LoopMode::ALL[mode]);
            let direction = if forward { Direction::Forward } else { Direction::Backward };
            loader.request(playhead, direction, &SURFELS);
            if wait {
                loader.wait(playhead, &SURFELS).unwrap();
            }
        }
        until_idle(&loader);
        let stats = loader.stats();
        prop_assert!(stats.peak_bytes <= budget + largest, "{stats:?}");
        prop_assert!(stats.resident_frames > 0);
    }
}
