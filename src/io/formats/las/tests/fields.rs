//! Fields that are unpacked here, compared with the crate that packs them, and bytes at which the crate overflows the
//! stack.

use super::super::fields::unpack;
use super::*;
use laz::compressors::IntegerCompressorBuilder;
use laz::encoders::ArithmeticEncoder;
use laz::las::{Point1, Point3, Point6, Point7, Point8, Point10, v2};
use laz::models::{ArithmeticModel, ArithmeticModelBuilder};
use laz::record::*;
use laz::{DecompressionSelection, LazItem, LazItemRecordBuilder as Items, LazVlrBuilder};
use proptest::prelude::*;
use std::io::Write;
use std::thread;

/// The fields of a format and version with two extra bytes, and where the time is.
fn kinds() -> Vec<(Vec<LazItem>, usize)> {
    vec![
        (Items::version_2_of::<Point1>(2), 20),
        (Items::version_2_of::<Point3>(2), 20),
        (Items::version_3_of::<Point6>(2), 22),
        (Items::version_4_of::<Point6>(2), 22),
        (Items::version_3_of::<Point7>(2), 22),
        (Items::version_4_of::<Point7>(2), 22),
        (Items::version_3_of::<Point8>(2), 22),
        (Items::version_4_of::<Point8>(2), 22),
        (Items::version_3_of::<Point10>(2), 22),
        (Items::version_4_of::<Point10>(2), 22),
    ]
}

fn is_layered(items: &[LazItem]) -> bool {
    items[0].version() >= 3
}

fn point_bytes(items: &[LazItem]) -> usize {
    items.iter().copied().map(super::super::fields::bytes).sum()
}

fn packed(items: &Vec<LazItem>, rows: &[u8]) -> Vec<u8> {
    let file = Cursor::new(Vec::new());
    let pack = |mut chunk: Box<dyn RecordCompressor<Cursor<Vec<u8>>>>| {
        chunk.set_fields_from(items).unwrap();
        chunk.compress_many(rows).unwrap();
        chunk.done().unwrap();
        chunk.box_into_inner().into_inner()
    };
    if is_layered(items) {
        pack(Box::new(LayeredPointRecordCompressor::new(file)))
    } else {
        pack(Box::new(SequentialPointRecordCompressor::new(file)))
    }
}

fn unpacked_by_crate(items: &Vec<LazItem>, packed: &[u8], rows: &mut [u8]) {
    let packed = Cursor::new(packed);
    let mut unpack = |mut chunk: Box<dyn RecordDecompressor<Cursor<&[u8]>> + '_>| {
        chunk.set_fields_from(items).unwrap();
        chunk.set_selection(
            DecompressionSelection::all()
                .skip_flags()
                .skip_scan_angle()
                .skip_user_data()
                .skip_point_source_id()
                .skip_wavepacket(),
        );
        chunk.decompress_many(rows).unwrap();
    };
    if is_layered(items) {
        unpack(Box::new(LayeredPointRecordDecompressor::new(packed)));
    } else {
        unpack(Box::new(SequentialPointRecordDecompressor::new(packed)));
    }
}

/// A point without the data skipped in layers: most flags, user data, angle and source.
fn without_passed_over(items: &[LazItem], row: &[u8]) -> Vec<u8> {
    let mut row = row.to_vec();
    if is_layered(items) {
        row[15] &= 0x30;
        row[17..22].fill(0);
    }
    row
}

/// Relation of a point's time to the previous ones.
#[derive(Debug, Clone)]
enum Time {
    Same,
    Steps(i64),
    /// The time of a flight line, advanced.
    Line(usize, i64),
    Bits(i64),
}

fn time() -> impl Strategy<Value = Time> {
    let bits = [0.0, 1.0, -0.5, f64::NAN, f64::INFINITY, f64::MAX, -f64::MAX].map(f64::to_bits);
    let special: Vec<i64> = bits.into_iter().map(|bits| bits as i64).collect();
    prop_oneof![
        4 => Just(Time::Same),
        8 => Just(Time::Steps(1)),
        4 => (-12i64..60).prop_map(Time::Steps),
        4 => (-700i64..700).prop_map(Time::Steps),
        6 => (0usize..6, -1000i64..100_000).prop_map(|(line, further)| Time::Line(line, further)),
        1 => (0usize..6, any::<i32>()).prop_map(|(line, further)| Time::Line(line, further.into())),
        1 => any::<i64>().prop_map(Time::Bits),
        1 => prop::sample::select(special).prop_map(Time::Bits),
        1 => prop_oneof![Just(Time::Bits(i64::MIN)), Just(Time::Bits(i64::MAX))],
    ]
}

/// A point after another: its time, its channel, whether it has nothing else in common with the one before, and noise.
type Next = (Time, u8, bool, u64);

fn points() -> impl Strategy<Value = Vec<Next>> {
    let channel = prop_oneof![6 => Just(0u8), 2 => Just(1), 1 => 0..4u8];
    prop::collection::vec((time(), channel, prop::bool::weighted(0.2), any::<u64>()), 1..400)
}

/// Bits of times whose differences fit 64 bits: the crate packs others only where overflow is not an error.
fn ranges() -> impl Strategy<Value = (i64, i64)> {
    prop::sample::select(vec![(0, i64::MAX), (i64::MIN, -1), (-(1 << 62), (1 << 62) - 1)])
}

fn rows((items, time_at): &(Vec<LazItem>, usize), points: &[Next], range: (i64, i64)) -> Vec<u8> {
    let mut row = vec![0; point_bytes(items)];
    // A little over a microsecond, hours apart.
    let step = 9_000;
    let within = |time: i64| time.clamp(range.0, range.1);
    let mut lines: [i64; 6] = std::array::from_fn(|line| within((200_000.0f64 + 5e3 * line as f64).to_bits() as i64));
    let mut last = lines[0];
    let mut rows = Vec::new();
    for (time, channel, is_other, noise) in points {
        let mut noise = *noise;
        let mut random = || {
            noise = noise.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (noise >> 56) as u8
        };
        if *is_other {
            row.fill_with(&mut random);
        } else {
            for axis in 0..3 {
                row[4 * axis] = row[4 * axis].wrapping_add(random() & 15);
            }
            row[12] ^= random() & 3;
            // Returns, flags, class or anything else, often unchanged.
            let at = 14 + usize::from(random());
            if let Some(byte) = row.get_mut(at) {
                *byte ^= 1 << (random() & 7);
            }
        }
        // Random waveform packets are too far apart for the crate.
        if let Some(packet) = row.get_mut(38..67) {
            packet.fill(0);
        }
        last = within(match *time {
            Time::Same => last,
            Time::Steps(steps) => last.saturating_add(steps * step),
            Time::Line(line, further) => {
                lines[line] = within(lines[line].saturating_add(further));
                lines[line]
            }
            Time::Bits(bits) => bits,
        });
        row[*time_at..time_at + 8].copy_from_slice(&last.to_le_bytes());
        if is_layered(items) {
            row[15] = row[15] & !0x30 | channel << 4;
        }
        rows.extend(&row);
    }
    rows
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn points_are_unpacked_as_the_laz_crate_does(points in points(), range in ranges()) {
        for kind in kinds() {
            let rows = rows(&kind, &points, range);
            let items = &kind.0;
            let packed = packed(items, &rows);
            let mut found = vec![0; rows.len()];
            let mut cursor = Cursor::new(&packed[..]);
            unpack(items, &mut cursor, &mut found).unwrap();
            prop_assert_eq!(cursor.position(), packed.len() as u64, "{:?}", items);

            let mut expected = vec![0; rows.len()];
            unpacked_by_crate(items, &packed, &mut expected);
            let size = point_bytes(items);
            for (index, (found, row)) in found.chunks(size).zip(rows.chunks(size)).enumerate() {
                prop_assert_eq!(found, &expected[index * size..][..size], "{} of {:?}", index, items);
                let parts = |row| without_passed_over(items, row);
                prop_assert_eq!(parts(found), parts(row), "{} of {:?}", index, items);
            }
        }
    }
}

/// A time that changes to the next sequence so often and is a first step of 1000 there.
fn changing_time(encoder: &mut ArithmeticEncoder<impl Write>, changes: usize, layered: bool) {
    let missing = u32::from(layered);
    let mut symbols: ArithmeticModel = ArithmeticModelBuilder::new(6 - missing).build();
    for _ in 0..changes {
        encoder.encode_symbol(&mut symbols, 3 - missing).unwrap();
    }
    encoder.encode_symbol(&mut symbols, 1 - missing).unwrap();
    let mut differences = IntegerCompressorBuilder::new().bits(32).contexts(9).build_initialized();
    differences.compress(encoder, 0, 1000, 0).unwrap();
}

/// Packs every time but the first as one that changes so often.
struct Changing(usize);

impl<W: Write> FieldCompressor<W> for Changing {
    fn size_of_field(&self) -> usize {
        8
    }

    fn compress_first(&mut self, file: &mut W, time: &[u8]) -> std::io::Result<()> {
        file.write_all(time)
    }

    fn compress_with(&mut self, encoder: &mut ArithmeticEncoder<W>, _: &[u8]) -> std::io::Result<()> {
        changing_time(encoder, self.0, false);
        Ok(())
    }
}

const FIRST_TIME: i64 = 77;

/// Position of the size of the layer of times, the last of nine: after the first point, the count and the other sizes.
const LAST_SIZE: usize = 34 + 4 * 8;

/// Chunks of two points, where the second one's time changes sequence `changes` times, with their fields, format and
/// position of the time.
fn changing(changes: usize) -> [(Vec<LazItem>, u8, usize, Vec<u8>); 2] {
    let mut rows = vec![0; 56];
    rows[20..28].copy_from_slice(&FIRST_TIME.to_le_bytes());
    let mut chunk = SequentialPointRecordCompressor::new(Cursor::new(Vec::new()));
    chunk.add_field_compressor(v2::LasPoint0Compressor::default());
    chunk.add_field_compressor(Changing(changes));
    chunk.compress_many(&rows).unwrap();
    chunk.done().unwrap();
    let in_one_stream = chunk.into_inner().into_inner();

    let items = Items::version_3_of::<Point6>(0);
    let mut rows = vec![0; 60];
    rows[22..30].copy_from_slice(&FIRST_TIME.to_le_bytes());
    let mut layered = packed(&items, &rows);
    let mut encoder = ArithmeticEncoder::new(Vec::new());
    changing_time(&mut encoder, changes, true);
    encoder.done().unwrap();
    let layer = encoder.into_inner();
    let size = u32::from_le_bytes(take(&layered, LAST_SIZE)) as usize;
    layered.truncate(layered.len() - size);
    layered[LAST_SIZE..LAST_SIZE + 4].copy_from_slice(&(layer.len() as u32).to_le_bytes());
    layered.extend(layer);
    [
        (Items::version_2_of::<Point1>(0), 1, 20, in_one_stream),
        (items, 6, 22, layered),
    ]
}

#[test]
fn times_that_switch_sequences_match_the_laz_crate() {
    for changes in 0..=4 {
        for (items, format, time_at, chunk) in changing(changes) {
            let mut rows = vec![0; 2 * point_bytes(&items)];
            unpack(&items, &mut Cursor::new(&chunk), &mut rows).unwrap();
            let last = rows.len() / 2 + time_at;
            let began = if changes % 4 == 0 { FIRST_TIME } else { 0 };
            assert_eq!(i64::from_le_bytes(take(&rows, last)), began + 1000);
            let mut expected = vec![0; rows.len()];
            unpacked_by_crate(&items, &chunk, &mut expected);
            assert_eq!(rows, expected, "format {format}, {changes} changes");
        }
    }
}

#[test]
fn endless_time_sequence_switches_are_rejected_on_a_small_stack() {
    const STACK_BYTES: usize = 256 << 10;
    for changes in [5, 1_000_000] {
        for (items, format, _, chunk) in changing(changes) {
            assert!(chunk.len() < 512, "{} bytes", chunk.len());
            let size = point_bytes(&items);
            let compression = LazVlrBuilder::default().with_point_format(format, 0).unwrap();
            let mut described = Vec::new();
            compression.build().write_to(&mut described).unwrap();
            let described = record(b"laszip encoded", 22204, &described);
            let points_start = 375 + described.len();
            let mut file = header(0x80 | format, size as u16, 2, 1, points_start);
            file.extend(described);
            file.extend([0; 8]);
            file.extend(&chunk);
            let problem = decode(&file, &options(), &Progress::default()).unwrap_err().problem;
            assert!(problem.contains("chunk 0 are damaged"), "{problem}");

            let thread = thread::Builder::new().name(format!("format {format}"));
            let refused = thread.stack_size(STACK_BYTES).spawn(move || {
                let mut rows = vec![0; 2 * size];
                let refusal = unpack(&items, &mut Cursor::new(&chunk), &mut rows).unwrap_err();
                assert!(refusal.to_string().contains("belongs to none"), "{refusal}");
            });
            refused.unwrap().join().unwrap();
        }
    }
}
