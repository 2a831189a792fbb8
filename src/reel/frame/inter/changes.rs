//! Differences of a frame from the previous one.

use super::super::levels::LevelValues;
use super::super::schema::{Schema, StreamKind};
use super::followed::{Followed, FollowedLevel};
use crate::reel::attributes::NormalGrid;
use glam::Vec3;

/// Differences of a frame from the previous one.
#[derive(Debug)]
pub(in crate::reel) struct Changes {
    /// Changes of each level, and then of the points.
    pub(super) levels: Vec<LevelChanges>,
}

/// Differences of the nodes of a level.
#[derive(Debug, Clone, Default)]
pub(super) struct LevelChanges {
    /// In parts of the deepest cells.
    pub(super) steps: Vec<[i32; 3]>,
    pub(super) colors: Vec<[i32; 3]>,
    pub(super) singles: Vec<Vec<[i32; 1]>>,
    /// Normals of this frame.
    pub(super) normals: Vec<[i16; 2]>,
    /// Unit normals of an encoder before they were rounded to those.
    pub(super) directions: Vec<Vec3>,
}

impl Changes {
    /// Creates the changes of a frame identical to the previous one.
    pub(super) fn none(followed: &Followed) -> Self {
        let of_level = |level: &FollowedLevel| {
            let none = |codes: &Vec<[u16; 1]>| vec![[0]; codes.len()];
            LevelChanges {
                steps: vec![[0; 3]; level.positions.len()],
                colors: vec![[0; 3]; level.values.colors.len()],
                singles: level.values.singles.iter().map(none).collect(),
                normals: level.values.normals.clone(),
                directions: Vec::new(),
            }
        };
        Self {
            levels: followed.levels.iter().map(of_level).collect(),
        }
    }

    /// Applies the changes, which turns the followed frame into the next one.
    pub(super) fn apply(self, schema: &Schema, followed: &mut Followed) {
        for (changes, level) in self.levels.into_iter().zip(&mut followed.levels) {
            changes.apply(schema, level);
        }
    }
}

impl LevelChanges {
    /// Changes the nodes of a level.
    fn apply(self, schema: &Schema, level: &mut FollowedLevel) {
        for (position, step) in level.positions.iter_mut().zip(&self.steps) {
            // Damaged bytes may move a node without limit.
            *position = [0, 1, 2].map(|axis| position[axis].saturating_add(step[axis]));
        }
        let values = &mut level.values;
        add(&mut values.colors, &self.colors, 255);
        for (single, (codes, changes)) in values.singles.iter_mut().zip(&self.singles).enumerate() {
            add(codes, changes, schema.max_code(single));
        }
        values.normals = self.normals;
    }

    /// From the values that nodes had to those that they have.
    pub(super) fn between(
        before: &LevelValues,
        values: LevelValues,
        directions: Vec<Vec3>,
        steps: Vec<[i32; 3]>,
    ) -> Self {
        let singles = before.singles.iter().zip(&values.singles);
        Self {
            steps,
            colors: differences(&before.colors, &values.colors),
            singles: singles.map(|(before, values)| differences(before, values)).collect(),
            normals: values.normals,
            directions,
        }
    }

    /// Returns true if a stream has changed enough to be coded.
    pub(super) fn differs(&self, schema: &Schema, kind: StreamKind, before: &LevelValues) -> bool {
        match kind {
            StreamKind::Color => {
                let within = i32::from(schema.color_step / 2);
                self.colors.iter().flatten().any(|change| change.abs() > within)
            }
            StreamKind::Normal => {
                let grid = NormalGrid::of(schema.normal_bits);
                let mut nodes = self.normals.iter().zip(&self.directions).zip(&before.normals);
                !nodes.all(|((&now, &direction), &before)| now == before || grid.is_near(before, direction))
            }
            _ => self.singles.iter().enumerate().any(|(single, changes)| {
                schema.stream_of_single(single) == kind && changes.iter().any(|[change]| *change != 0)
            }),
        }
    }
}

fn differences<const N: usize>(before: &[[u16; N]], values: &[[u16; N]]) -> Vec<[i32; N]> {
    let of_node = |(before, value): (&[u16; N], &[u16; N])| {
        std::array::from_fn(|channel| i32::from(value[channel]) - i32::from(before[channel]))
    };
    before.iter().zip(values).map(of_node).collect()
}

fn add<const N: usize>(values: &mut [[u16; N]], changes: &[[i32; N]], max: u16) {
    for (value, change) in values.iter_mut().zip(changes) {
        for channel in 0..N {
            value[channel] = (i32::from(value[channel]) + change[channel]).clamp(0, i32::from(max)) as u16;
        }
    }
}
