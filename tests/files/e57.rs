//! E57 files written by the crate, and the clouds read from them: several scans, poses, invalid points, damaged files.

use e57::{
    DateTime, E57Writer, Extension, PointCloudWriter, Quaternion, Record, RecordDataType, RecordName, RecordValue,
    Transform, Translation,
};
use pointreel::cloud::{Positions, RawCloud};
use pointreel::io::{self, Part, ReadOptions};
use std::io::Cursor;
use std::path::Path;
use std::time::{Duration, Instant};

const PAGE_BYTES: usize = 1024;

type File<'a> = E57Writer<&'a mut Cursor<Vec<u8>>>;

fn file(fill: impl FnOnce(&mut File<'_>)) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    let mut writer = E57Writer::new(&mut bytes, "file").unwrap();
    fill(&mut writer);
    writer.finalize().unwrap();
    drop(writer);
    bytes.into_inner()
}

fn scan(
    file: &mut File<'_>,
    prototype: &[(RecordName, RecordDataType)],
    points: &[Vec<RecordValue>],
    set: impl FnOnce(&mut PointCloudWriter<'_, &mut Cursor<Vec<u8>>>),
) {
    let prototype = prototype
        .iter()
        .map(|(name, data_type)| Record {
            name: name.clone(),
            data_type: data_type.clone(),
        })
        .collect();
    let mut scan = file.add_pointcloud("scan", prototype).unwrap();
    set(&mut scan);
    for point in points {
        scan.add_point(point.clone()).unwrap();
    }
    scan.finalize().unwrap();
}

fn read(bytes: &[u8]) -> Result<RawCloud, io::IoError> {
    io::read_bytes(Path::new("a.e57"), bytes)
}

const DOUBLE: RecordDataType = RecordDataType::Double { min: None, max: None };

fn xyz() -> Vec<(RecordName, RecordDataType)> {
    [RecordName::CartesianX, RecordName::CartesianY, RecordName::CartesianZ]
        .map(|name| (name, DOUBLE))
        .to_vec()
}

fn doubles(values: &[f64]) -> Vec<RecordValue> {
    values.iter().map(|&value| RecordValue::Double(value)).collect()
}

fn integer(min: i64, max: i64) -> RecordDataType {
    RecordDataType::Integer { min, max }
}

fn positions(cloud: &RawCloud) -> &[[f64; 3]] {
    match &cloud.positions {
        Positions::F64(positions) => positions,
        Positions::F32(_) => panic!("not of double precision"),
    }
}

/// A rotation by 90° about z, and then by (10, 20, 30).
fn pose() -> Transform {
    let half = std::f64::consts::FRAC_1_SQRT_2;
    Transform {
        rotation: Quaternion {
            w: half,
            x: 0.0,
            y: 0.0,
            z: half,
        },
        translation: Translation {
            x: 10.0,
            y: 20.0,
            z: 30.0,
        },
    }
}

fn time(gps_time: f64) -> DateTime {
    DateTime {
        gps_time,
        atomic_reference: false,
    }
}

/// A bare scan with a pose, an empty one, and one with colours, intensities, normals and packed integers.
fn three_scans() -> Vec<u8> {
    let unknown = |name: &str| RecordName::Unknown {
        namespace: "nor".to_owned(),
        name: name.to_owned(),
    };
    file(|file| {
        let url = "http://www.libe57.org/E57_NOR_surface_normals.txt";
        file.register_extension(Extension::new("nor", url)).unwrap();
        scan(file, &xyz(), &[doubles(&[1.0, 2.0, 3.0])], |scan| {
            scan.set_name(Some("first".to_owned()));
            scan.set_transform(Some(pose()));
            scan.set_acquisition_start(Some(time(200.0)));
        });
        scan(file, &xyz(), &[], |_| {});
        let millimetres = RecordDataType::ScaledInteger {
            min: -5000,
            max: 5000,
            scale: 0.001,
            offset: 2.0,
        };
        let mut prototype = vec![
            (RecordName::CartesianX, millimetres.clone()),
            (RecordName::CartesianY, millimetres.clone()),
            (RecordName::CartesianZ, millimetres),
            (RecordName::ColorRed, integer(0, 255)),
            (RecordName::ColorGreen, integer(0, 255)),
            (RecordName::ColorBlue, integer(0, 255)),
            (RecordName::Intensity, integer(7, 7)),
        ];
        prototype.extend(["normalX", "normalY", "normalZ"].map(|axis| (unknown(axis), DOUBLE)));
        let points: Vec<Vec<RecordValue>> = (0..5000)
            .map(|index| {
                let mut point: Vec<RecordValue> = [index, -index, 1].map(RecordValue::ScaledInteger).to_vec();
                point.extend([index % 256, 0, 255, 7].map(RecordValue::Integer));
                point.extend(doubles(&[0.0, 0.0, 1.0]));
                point
            })
            .collect();
        scan(file, &prototype, &points, |scan| {
            scan.set_transform(Some(pose()));
            scan.set_acquisition_start(Some(time(100.5)));
        });
    })
}

#[test]
fn scans_are_read_together_or_individually() {
    let bytes = three_scans();
    let cloud = read(&bytes).unwrap();
    assert_eq!(cloud.positions.len(), 5001);
    let is_at = |found: [f64; 3], expected: [f64; 3]| {
        let near = found.into_iter().zip(expected);
        assert!(near.into_iter().all(|(a, b)| (a - b).abs() < 1e-9), "{found:?}");
    };
    is_at(positions(&cloud)[0], [8.0, 21.0, 33.0]);
    // (2 + 4.999, 2 - 4.999, 2.001) in its scan.
    is_at(positions(&cloud)[5000], [12.999, 26.999, 32.001]);
    let colors = cloud.attributes.colors.unwrap();
    assert_eq!((colors[0], colors[259]), ([255; 4], [2, 0, 255, 255]));
    assert_eq!(cloud.attributes.scalars[0].name, "intensity");
    assert_eq!(cloud.attributes.scalars[0].values[..2], [0.0, 7.0]);
    assert_eq!((cloud.attributes.normals, cloud.sensor), (None, None));

    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scans.e57");
    std::fs::write(&path, &bytes).unwrap();
    let options = ReadOptions::default();
    let entries = io::list(&path, &options).unwrap();
    let listed: Vec<_> = entries
        .iter()
        .map(|entry| (entry.name.as_str(), entry.time, entry.part.clone()))
        .collect();
    let seconds = |seconds| Some(Duration::from_secs_f64(seconds));
    assert_eq!(
        listed,
        [
            ("scan 3", seconds(100.5), Part::Scan(2)),
            ("first", seconds(200.0), Part::Scan(0)),
        ]
    );
    let alone = io::read_part(&path, &Part::Scan(2), &options).unwrap();
    assert_eq!(alone.positions.len(), 5000);
    assert_eq!(alone.attributes.normals.unwrap()[77], [0.0, 0.0, 1.0]);
    assert_eq!(alone.sensor.unwrap().to_array(), [10.0, 20.0, 30.0]);
    let empty = io::read_part(&path, &Part::Scan(1), &options).unwrap();
    assert!(empty.positions.is_empty());
    let error = io::read_part(&path, &Part::Scan(3), &options).unwrap_err();
    assert!(error.to_string().contains("the file has 3 scans"), "{error}");
    let error = io::read_part(&path, &Part::Whole, &options.with_max_memory(9999)).unwrap_err();
    assert!(error.to_string().contains("--max-memory"), "{error}");
}

#[test]
fn spherical_coordinates_and_invalid_points() {
    let prototype = [
        (RecordName::SphericalRange, DOUBLE),
        (RecordName::SphericalAzimuth, DOUBLE),
        (RecordName::SphericalElevation, DOUBLE),
        (RecordName::SphericalInvalidState, integer(0, 2)),
        (RecordName::Intensity, DOUBLE),
        (RecordName::IsIntensityInvalid, integer(0, 1)),
    ];
    let quarter = std::f64::consts::FRAC_PI_2;
    let point = |range, azimuth, elevation, state, invalid| {
        let mut point = doubles(&[range, azimuth, elevation]);
        point.push(RecordValue::Integer(state));
        point.extend([RecordValue::Double(0.25), RecordValue::Integer(invalid)]);
        point
    };
    let points = [
        point(2.0, quarter, 0.0, 0, 0),
        point(3.0, 0.0, -quarter, 0, 1),
        point(3.0, 0.0, 0.0, 1, 0),
        point(3.0, 0.0, 0.0, 2, 0),
    ];
    let cloud = read(&file(|file| scan(file, &prototype, &points, |_| {}))).unwrap();
    for (found, expected) in positions(&cloud).iter().zip([[0.0, 2.0, 0.0], [0.0, 0.0, -3.0]]) {
        let near = found.iter().zip(expected);
        assert!(near.into_iter().all(|(a, b)| (a - b).abs() < 1e-9), "{found:?}");
    }
    assert_eq!(cloud.positions.finite_bounds().0, 2);
    assert_eq!(cloud.attributes.scalars[0].values, [0.25, 0.0, 0.25, 0.25]);
}

/// Remainder of Castagnoli's polynomial, bit by bit.
fn sum(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0, |sum, &byte| {
        (0..8).fold(sum ^ u32::from(byte), |sum, _| {
            (sum >> 1) ^ if sum & 1 == 1 { 0x82f6_3b78 } else { 0 }
        })
    })
}

/// Makes the sums of all pages right again.
fn seal(bytes: &mut [u8]) {
    for page in bytes.chunks_mut(PAGE_BYTES) {
        let (payload, end) = page.split_at_mut(PAGE_BYTES - 4);
        end.copy_from_slice(&sum(payload).to_be_bytes());
    }
}

/// The file with other words in its description, of the same length so that nothing else moves.
fn replace(mut bytes: Vec<u8>, from: &str, to: &str) -> Vec<u8> {
    assert_eq!(from.len(), to.len());
    let found: Vec<usize> = (0..bytes.len() - from.len())
        .filter(|&at| bytes[at..].starts_with(from.as_bytes()))
        .collect();
    assert!(!found.is_empty(), "no {from}");
    for at in found {
        bytes[at..at + from.len()].copy_from_slice(to.as_bytes());
    }
    seal(&mut bytes);
    bytes
}

/// Two points with one field of zero bits.
fn small() -> Vec<u8> {
    let mut prototype = xyz();
    prototype.push((RecordName::Intensity, integer(5, 5)));
    let point = |x| {
        let mut point = doubles(&[x, 2.0, 3.0]);
        point.push(RecordValue::Integer(5));
        point
    };
    file(|file| scan(file, &prototype, &[point(1.0), point(-1.0)], |_| {}))
}

#[test]
fn damaged_files_are_refused() {
    let bytes = small();
    assert_eq!(read(&bytes).unwrap().positions.len(), 2);
    for length in 0..bytes.len() {
        assert!(read(&bytes[..length]).is_err(), "{length}");
    }
    for at in 0..bytes.len() {
        let mut changed = bytes.clone();
        changed[at] ^= 0x10;
        assert!(read(&changed).is_err(), "byte {at}");
    }
}

#[test]
fn changed_bytes_with_valid_checksums_never_panic() {
    let bytes = small();
    let mut resealed = bytes.clone();
    seal(&mut resealed);
    assert_eq!(resealed, bytes);
    for at in 0..bytes.len() {
        for change in [0x01, 0x80, 0xff] {
            let mut changed = bytes.clone();
            changed[at] ^= change;
            seal(&mut changed);
            let start = Instant::now();
            if let Ok(cloud) = read(&changed) {
                assert!(cloud.positions.len() < 100, "byte {at}");
            }
            assert!(start.elapsed() < Duration::from_secs(5), "byte {at}");
        }
    }
}

#[test]
fn declared_sizes_are_checked_against_the_file() {
    let with = |from: &str, to: &str| read(&replace(small(), from, to));
    let error = with("recordCount=\"2\"", "recordCount=\"9\"").unwrap_err();
    assert!(error.to_string().contains("points end before the last one"), "{error}");
    let error = with("cartesianX", "cartesianx").unwrap_err();
    assert!(error.to_string().contains("no coordinates"), "{error}");

    // Fields that are declared constant have no bits: no byte of the file vouches for the number of points.
    for (count, is_read) in [(3, true), (100_000, false)] {
        let axes = [RecordName::CartesianX, RecordName::CartesianY, RecordName::CartesianZ];
        let prototype = axes.map(|name| (name, integer(4, 5)));
        let points = vec![vec![RecordValue::Integer(4); 3]; count];
        let bytes = file(|file| scan(file, &prototype, &points, |_| {}));
        let constant = replace(bytes, "maximum=\"5\"", "maximum=\"4\"");
        let found = read(&constant).map(|cloud| positions(&cloud).to_vec());
        assert_eq!(found.is_ok(), is_read, "{count}");
        assert!(found.is_err() || found.unwrap() == vec![[4.0; 3]; count]);
    }
}

#[test]
fn a_deeply_nested_description_is_handled() {
    const DEPTH: usize = 200_000;
    let mut bytes = Cursor::new(Vec::new());
    let mut writer = E57Writer::new(&mut bytes, "file").unwrap();
    let nested = format!("{}{}", "<a>".repeat(DEPTH), "</a>".repeat(DEPTH));
    let nest = |xml: String| Ok(xml.replace("</e57Root>", &format!("{nested}</e57Root>")));
    writer.finalize_customized_xml(nest).unwrap();
    drop(writer);
    // Either result is fine, a stack overflow is not.
    let _ = read(&bytes.into_inner()).is_ok();
}
