//! Sequential point trees as Sainz and Pajarola 2004 §4.3 prints them: points are merged by their distance to their
//! parents.
//!
//! How it works: `r_min = √A` is the distance at which a node is divided at an error of 1, and `r_max = r_min(parent) +
//! |p − p(parent)|` that at which it is merged. Nodes are sorted by `r_max`; bisection finds the range `[lo, hi]` for
//! the sphere around all, and of these a node is drawn where `r_min ≤ √τ·|p − v| ∧ r_max ≥ √τ·|p − v|`, with √τ the LOD
//! threshold as an angle.
//!
//! It is too conservative where thresholds are small: the error of a view scales `r_min`, but not the distance between
//! a node and its parent, so many nodes are drawn whose parents are drawn as well. These are counted. Normals are not
//! tested, so `f = 1`, but nodes outside the frustum or facing away are dropped, node by node, as vertex programs do.
//!
//! When it wins: never; it exists for comparison with the exact rule of [`super::sequential`].

use super::before::WasDivided;
use super::bounds::Bounds;
use super::order::{NO_PARENT, Order};
use super::rule::{HYSTERESIS, Rule};
use super::splat::{self, Splat};
use super::split::Child;
use super::tree::SphereTree;
use crate::cloud::{PointRecord, ShapeRecord};
use crate::levels::cut::{Cut, CutHints, ListedNodes, SelectView};
use crate::levels::structure::{LevelsSize, RecordBuffers, Records};
use crate::math::Sphere;
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use std::f64::consts::PI;

/// Entries that are worth handing to another thread.
const ENTRIES_PER_TASK: usize = 1 << 12;

/// Entries are tested from so much nearer than they can be drawn from, so that it is known of those that the next view
/// may draw that they were divided.
const KNOWN_BEYOND: f64 = 1.25;

/// All nodes of a tree, sorted.
#[derive(Debug)]
pub(super) struct PrintedSequence {
    entries: Vec<Entry>,
    /// The least `r_min` of the entries up to each.
    min_r_min: Vec<f32>,
    /// Nodes that are not leaves, in breadth-first order.
    inners: Vec<(Splat, Bounds)>,
    /// Around all.
    root: Sphere,
}

#[derive(Debug, Clone, Copy)]
struct Entry {
    position: Vec3,
    /// 0 for leaves.
    r_min: f32,
    r_max: f32,
    level: u32,
    /// Index of its parent among the entries, or [`NO_PARENT`].
    parent: u32,
    node: Child,
    /// The inner node whose bounds it is dropped with: itself, or the parent of a leaf.
    bounds: u32,
}

impl PrintedSequence {
    /// Sorts the nodes of a tree of these points.
    pub(super) fn of(tree: &SphereTree, points: &[PointRecord]) -> Self {
        let unsorted = entries(tree, points);
        let order = Order::of(unsorted.len(), |place| unsorted[place as usize].r_max);
        let entry = |&place: &u32| {
            let entry = unsorted[place as usize];
            let parent = order.place_of(entry.parent);
            Entry { parent, ..entry }
        };
        let entries: Vec<Entry> = order.sorted.iter().map(entry).collect();
        let min_r_min = entries.iter().scan(f32::INFINITY, |min, entry| {
            *min = min.min(entry.r_min);
            Some(*min)
        });
        let root = tree.nodes.first().map(|root| root.sphere);
        Self {
            min_r_min: min_r_min.collect(),
            entries,
            inners: tree.nodes.iter().map(|node| (Splat::of(node), node.bounds)).collect(),
            root: root.unwrap_or(Sphere::around(std::iter::empty())),
        }
    }

    pub(super) fn size(&self) -> LevelsSize {
        LevelsSize {
            nodes: self.entries.len(),
            bytes: size_of_val(self.entries.as_slice())
                + size_of_val(self.min_r_min.as_slice())
                + size_of_val(self.inners.as_slice()),
        }
    }

    pub(super) fn cut(&self, view: &SelectView, hints: CutHints<'_>) -> Cut {
        let selection = Selection {
            sequence: self,
            rule: Rule::new(view, &hints),
            eye: view.eye.as_dvec3(),
            root_tau: f64::from(view.metric.root_area_px(view.lod_px).max(0.0) / view.pixels_per_unit_at_1),
            band: if hints.before.is_some() { HYSTERESIS } else { 0.0 },
            before: WasDivided::new(hints.before),
            has_last_level: view.deepest_level < SelectView::ALL_LEVELS,
        };
        let (lo, hi) = selection.range();
        let tested = self.entries[lo..hi].par_iter().with_min_len(ENTRIES_PER_TASK);
        let tests: Vec<Test> = tested
            .enumerate()
            .map(|(place, entry)| selection.test(lo + place, entry))
            .collect();
        let places_of = |test: Test| {
            let places = tests.iter().zip(lo as u32..);
            places.filter(move |&(&found, _)| found == test).map(|(_, place)| place)
        };
        let drawn: Vec<u32> = places_of(Test::Drawn).collect();
        let is_drawn = |place: u32| place as usize >= lo && tests.get(place as usize - lo) == Some(&Test::Drawn);
        let duplicates = drawn.par_iter().with_min_len(ENTRIES_PER_TASK);
        let listed = ListedNodes {
            duplicates: duplicates.filter(|&&place| self.ancestors(place).any(is_drawn)).count(),
            divided: places_of(Test::Divided).collect(),
            drawn,
            ..ListedNodes::default()
        };
        listed.into_cut(hi - lo, view.lod_px)
    }

    pub(super) fn write(
        &self,
        cut: &Cut,
        points: &[PointRecord],
        shapes: &[ShapeRecord],
        buffers: RecordBuffers,
    ) -> Records {
        splat::write(&cut.listed.drawn, buffers, |place| self.records(place, points, shapes))
    }

    /// Returns the records of all nodes, by their positions.
    pub(super) fn node_records(
        &self,
        points: &[PointRecord],
        shapes: &[ShapeRecord],
    ) -> (Vec<PointRecord>, Vec<ShapeRecord>) {
        splat::all(self.entries.len(), |place| self.records(place, points, shapes))
    }

    fn records(&self, place: u32, points: &[PointRecord], shapes: &[ShapeRecord]) -> (PointRecord, ShapeRecord) {
        match self.entries[place as usize].node {
            Child::Leaf(point) => (points[point as usize], shapes[point as usize]),
            Child::Inner(node) => self.inners[node as usize].0.records(),
        }
    }

    fn ancestors(&self, place: u32) -> impl Iterator<Item = u32> {
        let parent = |place: &u32| Some(self.entries[*place as usize].parent).filter(|&parent| parent != NO_PARENT);
        std::iter::successors(Some(place), parent).skip(1)
    }
}

/// The nodes of a tree, parents before their children.
fn entries(tree: &SphereTree, points: &[PointRecord]) -> Vec<Entry> {
    let r_min = |radius: f32| PI.sqrt() as f32 * radius;
    let mut entries: Vec<Entry> = Vec::with_capacity(tree.nodes.len() + points.len());
    let mut place_of = vec![NO_PARENT; tree.nodes.len()];
    if let Some(root) = tree.nodes.first() {
        place_of[0] = 0;
        entries.push(Entry {
            position: root.sphere.center,
            r_min: r_min(root.sphere.radius),
            r_max: f32::INFINITY,
            level: 0,
            parent: NO_PARENT,
            node: Child::Inner(0),
            bounds: 0,
        });
    }
    for (parent, index) in tree.division.inners.iter().zip(0_u32..) {
        let above = &tree.nodes[index as usize].sphere;
        for child in parent.children() {
            let (position, radius, bounds) = match child {
                Child::Leaf(point) => (Vec3::from_array(points[point as usize].position), 0.0, index),
                Child::Inner(node) => {
                    let sphere = tree.nodes[node as usize].sphere;
                    place_of[node as usize] = entries.len() as u32;
                    (sphere.center, sphere.radius, node)
                }
            };
            entries.push(Entry {
                position,
                r_min: r_min(radius),
                r_max: r_min(above.radius) + position.distance(above.center),
                level: u32::from(parent.level) + 1,
                parent: place_of[index as usize],
                node: child,
                bounds,
            });
        }
    }
    entries
}

/// Result of a test.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Test {
    /// Not near enough, or not to be seen.
    Left,
    Drawn,
    /// Too near to be drawn.
    Divided,
}

/// A view of a sequence.
struct Selection<'a> {
    sequence: &'a PrintedSequence,
    rule: Rule,
    eye: DVec3,
    /// √τ: an angle.
    root_tau: f64,
    /// Fraction of the threshold within which the previous view decides.
    band: f64,
    before: WasDivided,
    has_last_level: bool,
}

impl Selection<'_> {
    /// The entries that may be drawn.
    fn range(&self) -> (usize, usize) {
        let PrintedSequence {
            entries,
            min_r_min,
            root,
            ..
        } = self.sequence;
        let distance = root.center.as_dvec3().distance(self.eye);
        let radius = f64::from(root.radius);
        let d_min = self.root_tau * (distance + radius) * KNOWN_BEYOND;
        let d_max = self.root_tau * (distance - radius) * (1.0 - self.band);
        // A level that was requested explicitly may be drawn however near.
        let lo = if self.has_last_level {
            0
        } else {
            min_r_min.partition_point(|&r_min| f64::from(r_min) > d_min)
        };
        (
            lo,
            entries.partition_point(|entry| f64::from(entry.r_max) >= d_max).max(lo),
        )
    }

    fn test(&self, place: usize, entry: &Entry) -> Test {
        let distance = self.root_tau * entry.position.as_dvec3().distance(self.eye);
        let is_below_end = entry.level > 0 && self.rule.ends_at(entry.level - 1);
        if f64::from(entry.r_max) < distance * (1.0 - self.band) || is_below_end {
            return Test::Left;
        }
        let r_min = f64::from(entry.r_min);
        let is_leaf = matches!(entry.node, Child::Leaf(_));
        let is_small = r_min <= distance * (1.0 - self.band)
            || r_min <= distance * (1.0 + self.band) && !self.before.at(place)
            || self.rule.ends_at(entry.level);
        if !is_leaf && !is_small {
            return Test::Divided;
        }
        let (_, bounds) = &self.sequence.inners[entry.bounds as usize];
        if self.rule.drops(bounds) {
            Test::Left
        } else {
            Test::Drawn
        }
    }
}

#[cfg(test)]
impl PrintedSequence {
    /// Returns the tree node of each name.
    pub(super) fn nodes(&self) -> std::collections::HashMap<u32, Child> {
        let nodes = self.entries.iter().zip(0_u32..);
        nodes.map(|(entry, name)| (name, entry.node)).collect()
    }
}
