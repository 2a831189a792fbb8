//! The plain list: levels of detail without a structure (the list of Sainz and Pajarola 2004).
//!
//! How it works: the points are in Morton order, so every second, fourth or eighth of them is spread as evenly as all
//! are. Level `depth` is the whole list, each level above it half of the one below, with radii that close the surface
//! of that many points. Nothing is built, nothing is culled, and a list knows no screen-space sizes: a threshold draws
//! all points; a level, a number or a time sets how many are drawn.
//!
//! When it wins: where a frame is seen once, from outside, and there is no time to build a tree.

use super::cut::{Cut, CutHints, NodeRange, SelectView};
use super::selection::{NodeRecords, Selection};
use super::structure::{Levels, LevelsSize, RecordBuffers, Records};
use crate::cloud::{PointRecord, ShapeRecord, radius_factor};
use std::sync::Arc;

/// Surfels in Morton order.
#[derive(Debug)]
pub struct PointList {
    points: Arc<Vec<PointRecord>>,
    shapes: Arc<Vec<ShapeRecord>>,
}

impl PointList {
    /// The list of these records.
    ///
    /// # Panics
    /// Precondition: the same number of both.
    pub fn new(points: Arc<Vec<PointRecord>>, shapes: Arc<Vec<ShapeRecord>>) -> Self {
        assert_eq!(points.len(), shapes.len(), "one shape a point");
        Self { points, shapes }
    }

    /// Returns true if it is the list of these records.
    pub fn is_of(&self, points: &Arc<Vec<PointRecord>>, shapes: &Arc<Vec<ShapeRecord>>) -> bool {
        Arc::ptr_eq(&self.points, points) && Arc::ptr_eq(&self.shapes, shapes)
    }

    /// The level of all points: level 0 has one.
    pub fn depth(&self) -> u32 {
        self.points.len().next_power_of_two().ilog2()
    }

    /// The points of a level are those whose index is a multiple of this.
    fn step(&self, level: u32) -> usize {
        1 << (self.depth() - level.min(self.depth()))
    }

    fn nodes(&self) -> NodeRecords {
        NodeRecords {
            points: Arc::clone(&self.points),
            shapes: Arc::clone(&self.shapes),
        }
    }

    fn selection(&self, cut: &Cut) -> Selection {
        let level = cut.ranges.first().map_or(0, |range| range.level);
        Selection::Every {
            step: self.step(level) as u32,
            count: cut.node_count as u32,
            radius_factor: radius_factor(self.points.len(), cut.node_count),
        }
    }

    fn cut_at(&self, level: u32, lod_px: f32) -> Cut {
        let count = self.points.len();
        let mut cut = Cut {
            node_count: count.div_ceil(self.step(level)),
            lod_px,
            ..Cut::default()
        };
        if count > 0 {
            let points = 0..count;
            cut.ranges.push(NodeRange { level, points });
        }
        cut
    }
}

impl Levels for PointList {
    fn cut(&self, view: &SelectView, _: CutHints<'_>) -> Cut {
        self.cut_at(view.deepest_level.min(self.depth()), view.lod_px)
    }

    fn size(&self) -> LevelsSize {
        LevelsSize {
            nodes: self.points.len(),
            bytes: 0,
        }
    }

    fn cut_at_most(&self, max_nodes: usize, view: &SelectView, _: CutHints<'_>) -> Cut {
        let is_few = |&level: &u32| self.points.len().div_ceil(self.step(level)) <= max_nodes;
        let level = (0..=self.depth()).rev().find(is_few).unwrap_or(0);
        self.cut_at(level, view.lod_px)
    }

    fn write(&self, cut: &Cut, _: usize, buffers: RecordBuffers) -> Records {
        let (points, shapes) = self
            .selection(cut)
            .gathered(&self.nodes(), buffers.points, buffers.shapes);
        Records::Surfels { points, shapes }
    }

    fn select(&self, cut: &Cut, _: &mut RecordBuffers) -> Option<Records> {
        Some(Records::Selected {
            nodes: self.nodes(),
            selection: self.selection(cut),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::levels::cut::LodMetric;
    use crate::math::Frustum;
    use glam::{Mat4, Vec3};

    fn list(count: usize) -> PointList {
        let point = |i: usize| PointRecord {
            position: [i as f32, 0.0, 0.0],
            color: [9; 4],
        };
        let shape = |i: usize| ShapeRecord {
            normal: [0, 0],
            radius: 1.0,
            ellipse: 0,
            scalar: i as f32,
        };
        let points = (0..count).map(point).collect();
        let shapes = (0..count).map(shape).collect();
        PointList::new(Arc::new(points), Arc::new(shapes))
    }

    fn view(deepest_level: u32) -> SelectView {
        SelectView {
            frustum: Frustum::from_clip_matrix(&Mat4::IDENTITY),
            eye: Vec3::ZERO,
            pixels_per_unit_at_1: 1000.0,
            lod_px: 100.0,
            metric: LodMetric::default(),
            deepest_level,
        }
    }

    /// The indices of the drawn records, and the factor on their radii.
    fn drawn(list: &PointList, cut: &Cut) -> (Vec<usize>, f32) {
        let Records::Surfels { points, shapes } = list.write(cut, usize::MAX, RecordBuffers::default()) else {
            panic!("a list is drawn as surfels");
        };
        assert_eq!((points.len(), shapes.len()), (cut.node_count(), points.len()));
        let places = points.iter().map(|point| point.position[0] as usize);
        let places: Vec<usize> = places.collect();
        assert!(
            shapes
                .iter()
                .zip(&places)
                .all(|(shape, &place)| shape.scalar as usize == place)
        );
        (places, shapes.first().map_or(1.0, |shape| shape.radius))
    }

    #[test]
    fn each_level_draws_every_other_point_of_the_next_finer() {
        let list = list(10);
        assert_eq!(list.depth(), 4);
        let at = |level| drawn(&list, &list.cut(&view(level), CutHints::default()));
        assert_eq!(at(SelectView::ALL_LEVELS), ((0..10).collect(), 1.0));
        assert_eq!(at(3).0, [0, 2, 4, 6, 8]);
        assert_eq!(at(2).0, [0, 4, 8]);
        assert_eq!(at(0).0, [0]);
        // Half of the points have twice the area each.
        assert!((at(3).1 - 2f32.sqrt()).abs() < 1e-6);
    }

    #[test]
    fn at_least_half_of_a_budget_is_used_and_never_exceeded() {
        for count in [0, 1, 2, 3, 1000, 1024, 1025] {
            let list = list(count);
            for max in [1, 2, 3, 10, 999, 1000, 5000] {
                let cut = list.cut_at_most(max, &view(21), CutHints::default());
                let found = drawn(&list, &cut).0.len();
                assert!(found <= max && found <= count, "{found} of {max}, {count}");
                assert!(2 * found + 1 >= max.min(count), "{found} of {max}, {count}");
            }
        }
    }
}
