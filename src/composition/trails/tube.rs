//! A trail as points around its line: a tube that every renderer and every primitive draws, occluded by nearer
//! surfaces.

use super::Trails;
use crate::cloud::{CloudError, Frame, Positions, RawCloud};
use crate::sequence::{ColorSource, Coloring, Needs, PrepareCounters, PreparedFrame, prepare};
use glam::{DVec3, Vec3};
use std::f32::consts::TAU;
use std::ops::Range;
use std::sync::Arc;

/// Points around the line.
const SIDES: usize = 8;

/// Most rings of points along a trail, so that a tiny radius cannot fill the memory.
const MAX_RINGS: usize = 100_000;

impl Trails {
    /// The tube around a trail, `radius` scene units thick, white up to `frame` and black from there; without points
    /// where the trail has no path. Every point has a normal and a radius, so that surfels close it.
    pub fn tube(&self, trail: usize, frame: usize, radius: f32) -> Result<PreparedFrame, CloudError> {
        self.tube_through(trail, self.frames(), frame, radius)
    }

    /// The part of [`Trails::tube`] that leads through the frames of `range`.
    pub fn tube_through(
        &self,
        trail: usize,
        range: Range<usize>,
        frame: usize,
        radius: f32,
    ) -> Result<PreparedFrame, CloudError> {
        let (mut positions, mut normals, mut colors) = (Vec::new(), Vec::new(), Vec::new());
        let mut rings_left = MAX_RINGS;
        for index in range.start..range.end.saturating_sub(1) {
            let ends = (self.place(trail, index), self.place(trail, index + 1));
            let (Some(from), Some(to)) = ends else {
                continue;
            };
            let Some(along) = (to - from).try_normalize() else {
                continue;
            };
            let (side, up) = along.any_orthonormal_pair();
            let rings = ((to - from).length() / radius).ceil().max(1.0);
            let rings = (rings as usize).min(rings_left);
            rings_left -= rings;
            let brightness = if index < frame { 255 } else { 0 };
            for ring in 0..rings {
                let center = from.lerp(to, (ring as f32 + 0.5) / rings as f32);
                for number in 0..SIDES {
                    let (sine, cosine) = (TAU * number as f32 / SIDES as f32).sin_cos();
                    let normal: Vec3 = cosine * side + sine * up;
                    positions.push((center + radius * normal).to_array());
                    normals.push(normal.to_array());
                    colors.push([brightness, brightness, brightness, 255]);
                }
            }
        }
        let mut raw = RawCloud::from_positions(Positions::F32(positions));
        raw.attributes.radii = Some(vec![radius; normals.len()]);
        // Ordinary points, so that every primitive and renderer draws the trail, occluded by nearer surfaces.
        raw.attributes.normals = Some(normals);
        raw.attributes.colors = Some(colors);
        let needs = Needs {
            shapes: true,
            // They may all have the same colour, which the automatic choice would ignore.
            colors: Coloring::of(ColorSource::File),
            ..Needs::default()
        };
        let points = Arc::new(Frame::from_raw(raw, DVec3::ZERO)?);
        let counters = PrepareCounters::default();
        Ok(prepare(frame, points, 0.0, &needs, &counters))
    }
}
