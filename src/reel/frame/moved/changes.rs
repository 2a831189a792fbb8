//! How a frame differs from the one before.

use super::super::levels::LevelValues;
use super::super::schema::{Schema, StreamKind};
use super::followed::{Followed, FollowedLevel};

/// How a frame differs from the one before.
#[derive(Debug)]
pub(in crate::reel) struct Changes {
    /// Of each level, and then of the points.
    pub(super) levels: Vec<LevelChanges>,
}

/// How the nodes of a level differ.
#[derive(Debug, Clone, Default)]
pub(super) struct LevelChanges {
    /// In parts of the deepest cells.
    pub(super) steps: Vec<[i32; 3]>,
    pub(super) colors: Vec<[i32; 3]>,
    pub(super) singles: Vec<Vec<[i32; 1]>>,
    /// Those of this frame.
    pub(super) normals: Vec<[i16; 2]>,
}

impl Changes {
    /// Of a frame that is as the one before.
    pub(super) fn none(followed: &Followed) -> Self {
        let of_level = |level: &FollowedLevel| {
            let none = |codes: &Vec<[u16; 1]>| vec![[0]; codes.len()];
            LevelChanges {
                steps: vec![[0; 3]; level.positions.len()],
                colors: vec![[0; 3]; level.values.colors.len()],
                singles: level.values.singles.iter().map(none).collect(),
                normals: level.values.normals.clone(),
            }
        };
        Self {
            levels: followed.levels.iter().map(of_level).collect(),
        }
    }
}

impl LevelChanges {
    /// From the values that nodes had to those that they have.
    pub(super) fn between(before: &LevelValues, values: LevelValues, steps: Vec<[i32; 3]>) -> Self {
        let singles = before.singles.iter().zip(&values.singles);
        Self {
            steps,
            colors: differences(&before.colors, &values.colors),
            singles: singles.map(|(before, values)| differences(before, values)).collect(),
            normals: values.normals,
        }
    }

    /// Whether so much has changed in a stream that it is told.
    pub(super) fn differs(&self, schema: &Schema, kind: StreamKind, before: &LevelValues) -> bool {
        match kind {
            StreamKind::Color => {
                let within = i32::from(schema.color_step / 2);
                self.colors.iter().flatten().any(|change| change.abs() > within)
            }
            StreamKind::Normal => self.normals != before.normals,
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
