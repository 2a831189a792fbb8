//! Files that lie, end early or are noise: always an answer, never a panic, never memory for sizes that are only
//! claimed.

use pointreel::io::{self, IoError};
use proptest::prelude::*;
use std::alloc::{GlobalAlloc, Layout, System};
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};

/// The system's allocator, remembering the largest single request.
struct Watched;

static LARGEST_REQUEST: AtomicUsize = AtomicUsize::new(0);

#[expect(
    unsafe_code,
    reason = "an allocator cannot be written otherwise; it only counts and forwards"
)]
// SAFETY: every call is forwarded unchanged to the system's allocator.
unsafe impl GlobalAlloc for Watched {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        LARGEST_REQUEST.fetch_max(layout.size(), Ordering::Relaxed);
        // SAFETY: the caller upholds the contract of `alloc`.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller upholds the contract of `dealloc`.
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        LARGEST_REQUEST.fetch_max(layout.size(), Ordering::Relaxed);
        // SAFETY: the caller upholds the contract of `alloc_zeroed`.
        unsafe { System.alloc_zeroed(layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, new_size: usize) -> *mut u8 {
        LARGEST_REQUEST.fetch_max(new_size, Ordering::Relaxed);
        // SAFETY: the caller upholds the contract of `realloc`.
        unsafe { System.realloc(pointer, layout, new_size) }
    }
}

#[global_allocator]
static ALLOCATOR: Watched = Watched;

/// No test here reads a file that needs this much.
const MEMORY_LIMIT: usize = 64 << 20;

fn read(name: &str, bytes: &[u8]) -> Result<pointreel::cloud::RawCloud, IoError> {
    let result = io::read_bytes(Path::new(name), bytes);
    assert!(
        LARGEST_REQUEST.load(Ordering::Relaxed) < MEMORY_LIMIT,
        "memory for what is only claimed"
    );
    result
}

fn ply(encoding: &str, vertices: &str, properties: &str, payload: &[u8]) -> Vec<u8> {
    let mut file =
        format!("ply\nformat {encoding} 1.0\nelement vertex {vertices}\n{properties}end_header\n").into_bytes();
    file.extend(payload);
    file
}

fn pcd(points: &str, data: &str, payload: &[u8]) -> Vec<u8> {
    let mut file = format!(
        "VERSION .7\nFIELDS x y z rgb\nSIZE 4 4 4 4\nTYPE F F F U\nCOUNT 1 1 1 1\nWIDTH {points}\nHEIGHT 1\n\
         VIEWPOINT 0 0 0 1 0 0 0\nPOINTS {points}\nDATA {data}\n"
    )
    .into_bytes();
    file.extend(payload);
    file
}

const XYZ: &str = "property float x\nproperty float y\nproperty float z\n";

/// The error, the file's name, its bytes, and a part of the message.
type Case = (&'static str, &'static str, Vec<u8>, &'static str);

/// Points that no file here has.
const CLAIM: &str = "1000000000000";

fn wrong_plys() -> Vec<Case> {
    let lists = format!("{XYZ}property list int uchar names\n");
    let negative_list = [[0u8; 12].as_slice(), &(-1i32).to_le_bytes()].concat();
    let huge_list = [[0u8; 12].as_slice(), &i32::MAX.to_le_bytes()].concat();
    vec![
        ("empty", "a.ply", Vec::new(), "is empty"),
        ("wrong magic", "a.ply", b"plx\n".to_vec(), "line 1: expected `ply`"),
        (
            "no magic, no extension",
            "a.dat",
            b"\x01\x02\x03\x04".to_vec(),
            "not in a format that pointreel reads",
        ),
        (
            "header cut",
            "a.ply",
            b"ply\nformat ascii 1.0\nelement vertex 1\n".to_vec(),
            "missing line `end_header`",
        ),
        (
            "odd header",
            "a.ply",
            b"ply\nformat ascii 1.0\nelephant\nend_header\n".to_vec(),
            "line 3",
        ),
        (
            "no vertices",
            "a.ply",
            b"ply\nformat ascii 1.0\nelement face 0\nproperty list uchar int i\nend_header\n".to_vec(),
            "missing element `vertex`",
        ),
        (
            "no coordinates",
            "a.ply",
            ply("ascii", "0", "property float x\n", b""),
            "expected x, y and z",
        ),
        (
            "an element twice",
            "a.ply",
            ply("ascii", "0", &format!("{XYZ}element vertex 0\n"), b""),
            "same name",
        ),
        (
            "claim, binary",
            "a.ply",
            ply("binary_little_endian", CLAIM, XYZ, &[0; 100]),
            "vertex 8: the file ends here",
        ),
        (
            "claim, ascii",
            "a.ply",
            ply("ascii", CLAIM, XYZ, b"1 2 3\n"),
            "truncated",
        ),
        (
            "claim of nothing",
            "a.ply",
            ply("ascii", CLAIM, "", b""),
            "expected x, y and z, found nothing",
        ),
        (
            "claim beyond 64 bits",
            "a.ply",
            ply("ascii", "99999999999999999999999", XYZ, b""),
            "line 3",
        ),
        (
            "claim that overflows",
            "a.ply",
            ply("binary_little_endian", "18446744073709551615", XYZ, b""),
            "truncated",
        ),
        (
            "cut, binary",
            "a.ply",
            ply("binary_little_endian", "2", XYZ, &[0; 23]),
            "vertex 1: the file ends here",
        ),
        (
            "cut, ascii",
            "a.ply",
            ply("ascii", "2", XYZ, b"1 2 3\n4 55555"),
            "vertex 1: the file ends before property `z`",
        ),
        (
            "words",
            "a.ply",
            ply("ascii", "1", XYZ, b"1 two 3\n"),
            "line 8: property `y` of vertex 0 is `two`",
        ),
        (
            "negative list",
            "a.ply",
            ply("binary_little_endian", "1", &lists, &negative_list),
            "cannot have -1 items",
        ),
        (
            "huge list",
            "a.ply",
            ply("binary_little_endian", "1", &lists, &huge_list),
            "beyond the end",
        ),
    ]
}

fn wrong_pcds() -> Vec<Case> {
    let packed = |packed: u32, unpacked: u32| [packed.to_le_bytes(), unpacked.to_le_bytes()].concat();
    vec![
        (
            "claim, PCD",
            "a.pcd",
            pcd(CLAIM, "binary", &[0; 100]),
            "point 6: the file ends here",
        ),
        (
            "claim, ascii PCD",
            "a.pcd",
            pcd(CLAIM, "ascii", b"1 2 3 4\n"),
            "truncated",
        ),
        (
            "claim, packed PCD",
            "a.pcd",
            pcd(CLAIM, "binary_compressed", &packed(0, 0)),
            "truncated",
        ),
        (
            "cut, packed PCD",
            "a.pcd",
            pcd("1", "binary_compressed", &packed(999, 16)),
            "should have 999 bytes",
        ),
        (
            "bomb, packed PCD",
            "a.pcd",
            pcd("1", "binary_compressed", &[packed(4, u32::MAX), vec![0; 4]].concat()),
            "cannot unpack",
        ),
        (
            "more than LZF can hold, packed PCD",
            "a.pcd",
            pcd("1", "binary_compressed", &[packed(4, 4 * 88 + 1), vec![0; 4]].concat()),
            "cannot unpack",
        ),
        (
            "noise, packed PCD",
            "a.pcd",
            pcd("1", "binary_compressed", &[packed(4, 16), vec![0xff; 4]].concat()),
            "damaged",
        ),
        (
            "words, PCD",
            "a.pcd",
            pcd("1", "ascii", b"1 2 x 4\n"),
            "line 11: field `z` is `x`",
        ),
        (
            "odd header, PCD",
            "a.pcd",
            b"VERSION .7\nFIELDS x y z\nDATA ascii\n".to_vec(),
            "missing line `SIZE`",
        ),
    ]
}

fn wrong_texts() -> Vec<Case> {
    vec![
        (
            "words, text",
            "a.xyz",
            b"1 2 3\n1 2 oops\n".to_vec(),
            "line 2: found `oops`",
        ),
        (
            "uneven rows, text",
            "a.xyz",
            b"1 2 3\n1 2\n".to_vec(),
            "line 2: found 2 numbers, expected 3",
        ),
        (
            "two columns, text",
            "a.xyz",
            b"1 2\n".to_vec(),
            "line 1: found 2 numbers",
        ),
        (
            "cut, counted text",
            "a.pts",
            b"3\n1 2 3\n4 5 6\n".to_vec(),
            "point 2: the file ends here, but its first line counts 3 points",
        ),
        ("noise, text", "a.xyz", vec![0xff; 300], "no line has numbers"),
    ]
}

#[test]
fn errors_name_the_file_and_location() {
    for (what, name, bytes, expected) in [wrong_plys(), wrong_pcds(), wrong_texts()].concat() {
        let message = match read(name, &bytes) {
            Ok(cloud) => panic!("{what}: read {} points", cloud.positions.len()),
            Err(error) => error.to_string(),
        };
        assert!(message.contains(expected), "{what}: {message}");
        assert!(message.contains(name), "{what}: which file? {message}");
        assert!(!message.contains('\n'), "{what}: more than a sentence: {message}");
    }
}

#[test]
fn unreadable_files_are_reported() {
    let folder = tempfile::tempdir().unwrap();
    let missing = io::read(&folder.path().join("missing.ply")).unwrap_err();
    assert!(matches!(missing, IoError::Io { .. }), "{missing}");
    assert!(missing.to_string().contains("missing.ply"), "{missing}");
    let folder = io::read(folder.path()).unwrap_err();
    assert!(matches!(folder, IoError::NotAFile { .. }), "{folder}");
    // Would never return.
    #[cfg(unix)]
    {
        let device = io::read(Path::new("/dev/zero")).unwrap_err();
        assert!(matches!(device, IoError::NotAFile { .. }), "{device}");
    }
}

/// Small valid files of every format and encoding.
fn valid_files() -> Vec<(&'static str, Vec<u8>)> {
    let colored = format!("{XYZ}property uchar red\nproperty uchar green\nproperty uchar blue\n");
    let listed =
        format!("{XYZ}property list uchar int i\nproperty double nx\nproperty double ny\nproperty double nz\n");
    let mut listed_row = vec![0; 12];
    listed_row.push(2);
    listed_row.extend([0; 8 + 24]);
    let lzf = [24u32.to_le_bytes(), 32u32.to_le_bytes()].concat();
    // Two runs of literals of 16 and 5 bytes, then a back reference for the rest.
    let block: Vec<u8> = [&[15u8][..], &[7; 16], &[4], &[9; 5], &[0xe0, 0x02, 0x00]].concat();
    let lzf: Vec<u8> = [lzf, block].concat();
    vec![
        ("a.ply", ply("binary_little_endian", "3", &colored, &[65; 45])),
        ("a.ply", ply("binary_big_endian", "3", &colored, &[65; 45])),
        (
            "a.ply",
            ply(
                "binary_little_endian",
                "2",
                &listed,
                &[listed_row.clone(), listed_row].concat(),
            ),
        ),
        ("a.ply", ply("ascii", "2", &listed, b"1 2 3 1 9 0 0 1\n4 5 6 0 1 0 0\n")),
        ("a.pcd", pcd("2", "binary", &[65; 32])),
        ("a.pcd", pcd("2", "ascii", b"1 2 3 4\n5 nan 7 8\n")),
        ("a.pcd", pcd("2", "binary_compressed", &lzf)),
        ("a.xyz", b"# x y z\n1 2 3 4 5 6\n7 8 9 10 11 12\n".to_vec()),
        ("a.pts", b"2\n1 2 3 -4 5 6 7\n7 8 9 1 10 11 12\n".to_vec()),
    ]
}

#[test]
fn files_truncated_at_any_byte_are_handled() {
    for (name, bytes) in valid_files() {
        for length in 0..bytes.len() {
            let _ = read(name, &bytes[..length]);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3000))]

    #[test]
    fn damaged_files_are_handled(
        file in 0..9usize,
        damages in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
        insert in any::<bool>(),
    ) {
        let (name, mut bytes) = valid_files().swap_remove(file);
        for (place, value) in damages {
            let at = place.index(bytes.len());
            if insert {
                bytes.insert(at, value);
            } else {
                bytes[at] = value;
            }
        }
        let _ = read(name, &bytes);
    }

    #[test]
    fn digits_replaced_in_headers_are_handled(
        file in 0..9usize,
        place in any::<prop::sample::Index>(),
        number in prop::sample::select(vec!["0", "-1", "4294967295", "1000000000000", "18446744073709551616", "1e308",
            "nan", ""]),
    ) {
        let (name, bytes) = valid_files().swap_remove(file);
        let digits: Vec<usize> = (0..bytes.len()).filter(|&at| bytes[at].is_ascii_digit()).collect();
        prop_assume!(!digits.is_empty());
        let at = digits[place.index(digits.len())];
        let replaced = [&bytes[..at], number.as_bytes(), &bytes[at + 1..]].concat();
        let _ = read(name, &replaced);
    }

    #[test]
    fn noise_is_handled(name in prop::sample::select(vec!["a.ply", "a.pcd", "a.xyz", "a.csv", "a"]),
        bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        let _ = read(name, &bytes);
    }
}
