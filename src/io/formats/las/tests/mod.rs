//! Files with known answers, made here byte by byte or by the writer.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod damaged;
mod fields;
mod formats;
mod octrees;
mod written;

use super::decode;
use super::header::take;
use super::write::write;
use crate::cloud::{Positions, RawCloud, ScalarField};
use crate::io::ReadOptions;
use crate::progress::Progress;
use std::io::Cursor;

/// Offsets in the header that tests change.
const COUNT_AT: usize = 247;
const RECORDS_AT: usize = 100;
const POINTS_AT: usize = 96;

fn options() -> ReadOptions {
    ReadOptions::default().with_max_memory(64 << 20)
}

fn read(bytes: &[u8]) -> RawCloud {
    decode(bytes, &options(), &Progress::default()).unwrap_or_else(|fault| panic!("{fault:?}"))
}

fn written(cloud: &RawCloud, compressed: bool) -> Vec<u8> {
    let mut file = Cursor::new(Vec::new());
    write(&mut file, cloud, compressed).unwrap();
    file.into_inner()
}

fn field<'a>(cloud: &'a RawCloud, name: &str) -> &'a ScalarField {
    let found = cloud.attributes.scalars.iter().find(|field| field.name == name);
    found.unwrap_or_else(|| panic!("no {name} among {:?}", cloud.point_names()))
}

/// Numbers of a field with its offset.
fn numbers(cloud: &RawCloud, name: &str) -> Vec<f64> {
    let field = field(cloud, name);
    let values = field.values.iter();
    values.map(|&value| f64::from(value) + field.offset).collect()
}

/// A cloud of `count` points with all that the writer knows.
fn sample(count: usize) -> RawCloud {
    let at = |index: usize| index as f64;
    let positions = (0..count).map(|i| [at(i) * 0.25, 5.0 - at(i), (at(i) * 0.7).sin()]);
    let mut cloud = RawCloud::from_positions(Positions::F64(positions.collect()));
    let colors = (0..count).map(|i| [i as u8, 255 - i as u8, 7, 255]);
    cloud.attributes.colors = Some(colors.collect());
    let field = |name: &str, number: &dyn Fn(f64) -> f64| {
        let values: Vec<f64> = (0..count).map(|index| number(at(index))).collect();
        ScalarField::from_f64(name, &values)
    };
    cloud.attributes.scalars = vec![
        field("intensity", &|index| index * 13.0),
        field("classification", &|index| index % 40.0),
        field("gps_time", &|index| 3.1e8 + index * 0.5),
    ];
    cloud
}

/// A header of version 1.4 for `count` points of `point_bytes` that begin at `points_start`.
fn header(format: u8, point_bytes: u16, count: u64, records: u32, points_start: usize) -> Vec<u8> {
    let mut header = vec![0; 375];
    let mut put = |at: usize, bytes: &[u8]| header[at..at + bytes.len()].copy_from_slice(bytes);
    put(0, b"LASF");
    put(24, &[1, 4]);
    put(94, &375u16.to_le_bytes());
    put(POINTS_AT, &(points_start as u32).to_le_bytes());
    put(RECORDS_AT, &records.to_le_bytes());
    put(104, &[format]);
    put(105, &point_bytes.to_le_bytes());
    for axis in 0..3 {
        put(131 + 8 * axis, &0.5f64.to_le_bytes());
        put(155 + 8 * axis, &100f64.to_le_bytes());
    }
    put(COUNT_AT, &count.to_le_bytes());
    header
}

/// A record with its header.
fn record(user: &[u8], id: u16, data: &[u8]) -> Vec<u8> {
    let mut record = vec![0; 54];
    record[2..2 + user.len()].copy_from_slice(user);
    record[18..20].copy_from_slice(&id.to_le_bytes());
    record[20..22].copy_from_slice(&(data.len() as u16).to_le_bytes());
    record.extend(data);
    record
}
