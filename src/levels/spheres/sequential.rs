//! Sequential point trees: sorted nodes, of which a view takes a prefix (Dachsbacher et al. 2003).
//!
//! How it works: a node can only be drawn while its parent is not small, so nodes are sorted by the radius of their
//! parents, which is `r_max` at an error of 1. Bisection finds the number that may be drawn; each of these is then
//! tested by itself (`rule.rs`), in the order of memory. Parents come before their children, and their results are read
//! off. Leaves are points of the frame and are drawn as these if their parents are divided. Leaves of one parent follow
//! each other, so CPUs test none of them.
//!
//! *One sequence* of the whole tree tests nodes in a prefix that does not know the frustum. *A hierarchy of sequences*
//! ([`HIERARCHY_POINTS`]; after Windisch et al. 2025) has one for each subtree of a few points: the nodes above are
//! traversed, and only subtrees that are in view and divided are tested, each with a prefix of its own.
//!
//! There is no lower end of a range (Sainz and Pajarola 2004 §4.3): a node that is seen edge-on is small whatever its
//! size.
//!
//! When it wins: where there is no time to descend, and on GPUs, which test a prefix by themselves (`filter.rs`).

use super::before::WasDivided;
use super::bounds::Bounds;
use super::filter::{NodeBounds, SequenceFilter, Tested};
use super::order::{NO_PARENT, Order};
use super::rule::{NodeClass, Rule};
use super::splat::{self, Splat};
use super::split::{Child, Division};
use super::tree::SphereTree;
use crate::cloud::{PointRecord, ShapeRecord};
use crate::levels::cut::{Cut, CutHints, ListedNodes, SelectView};
use crate::levels::structure::{LevelsSize, RecordBuffers, Records};
use rayon::prelude::*;
use std::ops::Range;
use std::sync::Arc;

/// Maximum number of points of a sequence in a hierarchy.
// Smaller subtrees are more homogeneous, so fewer nodes are tested in vain: with 256 points up to a twentieth more.
pub(super) const HIERARCHY_POINTS: usize = 1 << 6;

/// Nodes of a prefix that are worth handing to another thread.
const NODES_PER_TASK: usize = 1 << 12;

/// Sequences, and the nodes above them.
#[derive(Debug)]
pub(super) struct SequentialTree {
    /// The nodes above sequences first, in breadth-first order, then those in sequences.
    inners: Vec<Inner>,
    /// The points of leaves, sequence by sequence.
    leaf_points: Vec<u32>,
    /// Descendants of each of the first nodes.
    uppers: Vec<Upper>,
}

/// A node that is not a leaf.
#[derive(Debug, Clone, Copy)]
struct Inner {
    bounds: Bounds,
    splat: Splat,
    level: u8,
    /// Number of its children that are leaves.
    leaf_count: u8,
    /// Index of the first of these leaves.
    first_leaf: u32,
    /// The index of its parent in the sequence, or [`NO_PARENT`].
    parent: u32,
    /// `r_max`.
    parent_radius: f32,
}

/// Descendants of a node above sequences.
#[derive(Debug, Clone)]
struct Upper {
    /// Nodes of the same kind.
    children: Range<u32>,
    /// Its sequence: unless it has children of its kind, all nodes below.
    inners: Range<usize>,
}

impl SequentialTree {
    /// Sequences of a tree, each of a subtree with at most this many points.
    pub(super) fn of(tree: &SphereTree, max_points: usize) -> Self {
        let uppers = upper_nodes(&tree.division, max_points);
        let sequences: Vec<Sequence> = uppers.par_iter().map(|upper| upper.sequence(tree)).collect();
        let mut built = Self {
            inners: Vec::with_capacity(tree.nodes.len()),
            leaf_points: Vec::with_capacity(sequences.iter().map(|sequence| sequence.leaf_points.len()).sum()),
            uppers: Vec::with_capacity(uppers.len()),
        };
        built.inners.extend(sequences.iter().map(|sequence| sequence.above));
        for (place, (UpperNode { children, .. }, sequence)) in uppers.into_iter().zip(sequences).enumerate() {
            let (first_inner, first_leaf) = (built.inners.len(), built.leaf_points.len() as u32);
            built.inners.extend(sequence.inners);
            built.leaf_points.extend(sequence.leaf_points);
            built.inners[place].first_leaf += first_leaf;
            for inner in &mut built.inners[first_inner..] {
                inner.first_leaf += first_leaf;
            }
            let inners = first_inner..built.inners.len();
            built.uppers.push(Upper { children, inners });
        }
        built
    }

    pub(super) fn size(&self) -> LevelsSize {
        LevelsSize {
            nodes: self.inners.len() + self.leaf_points.len(),
            bytes: size_of_val(self.inners.as_slice())
                + size_of_val(self.leaf_points.as_slice())
                + size_of_val(self.uppers.as_slice()),
        }
    }

    pub(super) fn cut(&self, view: &SelectView, hints: CutHints<'_>) -> Cut {
        let selection = Selection {
            tree: self,
            rule: Rule::new(view, &hints),
            before: WasDivided::new(hints.before),
        };
        let mut listed = ListedNodes::default();
        let mut divided = Vec::new();
        let mut tested = 0;
        let mut stack = Vec::from_iter((!self.uppers.is_empty()).then_some(0));
        while let Some(upper) = stack.pop() {
            tested += 1;
            match selection.node_class(upper as usize) {
                NodeClass::Dropped => {}
                NodeClass::Small => listed.drawn.push(upper),
                NodeClass::Divided => {
                    divided.push(upper);
                    stack.extend(self.uppers[upper as usize].children.clone().rev());
                }
            }
        }
        let parts: Vec<(ListedNodes, usize)> = divided
            .par_iter()
            .map(|&upper| selection.sequence(upper as usize))
            .collect();
        listed.divided = divided;
        for (part, tested_in_part) in parts {
            listed.append(part);
            tested += tested_in_part;
        }
        listed.into_cut(tested, view.lod_px)
    }

    pub(super) fn write(
        &self,
        cut: &Cut,
        points: &[PointRecord],
        shapes: &[ShapeRecord],
        buffers: RecordBuffers,
    ) -> Records {
        splat::write(&cut.listed.drawn, buffers, |name| self.records(name, points, shapes))
    }

    /// Returns the records of all nodes, by their names.
    pub(super) fn node_records(
        &self,
        points: &[PointRecord],
        shapes: &[ShapeRecord],
    ) -> (Vec<PointRecord>, Vec<ShapeRecord>) {
        splat::all(self.inners.len() + self.leaf_points.len(), |name| {
            self.records(name, points, shapes)
        })
    }

    fn records(&self, name: u32, points: &[PointRecord], shapes: &[ShapeRecord]) -> (PointRecord, ShapeRecord) {
        if let Some(inner) = self.inners.get(name as usize) {
            return inner.splat.records();
        }
        let point = self.leaf_points[name as usize - self.inners.len()] as usize;
        (points[point], shapes[point])
    }
}

/// A tree that is one sequence.
#[derive(Clone, Copy)]
pub(super) struct OnlySequence<'a>(&'a SequentialTree);

impl SequentialTree {
    /// The sequence, if there is but one, below the root.
    pub(super) fn only_sequence(&self) -> Option<OnlySequence<'_>> {
        (self.uppers.len() == 1).then_some(OnlySequence(self))
    }
}

impl OnlySequence<'_> {
    /// Its nodes as they are tested.
    pub(super) fn tested(self) -> Tested {
        // Names are indices below the root, which has none.
        let name = |parent: u32| if parent == NO_PARENT { 0 } else { parent + 1 };
        let bounds = self.0.inners.par_iter();
        let bounds = bounds.map(|inner| NodeBounds::new(&inner.bounds, inner.level.into(), name(inner.parent)));
        let mut parents = vec![0; self.0.leaf_points.len()];
        for (inner, name) in self.0.inners.iter().zip(0..) {
            parents[inner.leaves()].fill(name);
        }
        Tested {
            bounds: Arc::new(bounds.collect()),
            parents: Arc::new(parents),
        }
    }

    /// Returns the filter of the nodes that are drawn in a view; `None` if that is the root alone, or nothing.
    pub(super) fn filter(self, tested: &Tested, view: &SelectView, hints: CutHints<'_>) -> Option<SequenceFilter> {
        let before = None;
        let selection = Selection {
            tree: self.0,
            rule: Rule::new(view, &CutHints { before, ..hints }),
            before: WasDivided::new(before),
        };
        if selection.node_class(0) != NodeClass::Divided {
            return None;
        }
        let small_radius = selection.rule.small_radius_below(&self.0.inners[0].bounds);
        let is_divisible = |&parent: &u32| f64::from(self.0.inners[parent as usize].bounds.radius) > small_radius;
        Some(SequenceFilter {
            tested: tested.clone(),
            inner_candidates: selection.candidates(0).len() as u32,
            leaf_candidates: tested.parents.partition_point(is_divisible) as u32,
            rule: selection.rule,
        })
    }
}

impl Inner {
    fn of(tree: &SphereTree, node: u32, parent: u32) -> Self {
        let inner = &tree.division.inners[node as usize];
        let rounded = &tree.nodes[node as usize];
        Self {
            bounds: rounded.bounds,
            splat: Splat::of(rounded),
            level: inner.level,
            leaf_count: 0,
            first_leaf: 0,
            parent,
            parent_radius: parent_radius(tree, node),
        }
    }

    /// Returns the range of its children that are leaves, as indices of leaves.
    fn leaves(&self) -> Range<usize> {
        let first = self.first_leaf as usize;
        first..first + usize::from(self.leaf_count)
    }
}

fn parent_radius(tree: &SphereTree, node: u32) -> f32 {
    let parent = tree.division.inners[node as usize].parent;
    tree.nodes[parent as usize].bounds.radius
}

/// A node above sequences while they are made.
struct UpperNode {
    node: u32,
    children: Range<u32>,
}

/// The root, and as long as these have more points than a sequence may have, their children.
fn upper_nodes(division: &Division, max_points: usize) -> Vec<UpperNode> {
    let mut uppers: Vec<UpperNode> = Vec::new();
    let mut nodes = Vec::from_iter((!division.inners.is_empty()).then_some(0));
    let mut next = 0;
    while let Some(&node) = nodes.get(next) {
        let inner = &division.inners[node as usize];
        let first = nodes.len() as u32;
        if inner.point_count() > max_points {
            nodes.extend(inner.inner_children());
        }
        let children = first..nodes.len() as u32;
        uppers.push(UpperNode { node, children });
        next += 1;
    }
    uppers
}

struct Sequence {
    /// The node that it is below.
    above: Inner,
    inners: Vec<Inner>,
    leaf_points: Vec<u32>,
}

/// A node of a sequence while it is made.
#[derive(Debug, Clone, Copy)]
struct Below {
    node: u32,
    /// The index of its parent among the nodes below, or [`NO_PARENT`].
    parent: u32,
}

impl UpperNode {
    /// Nodes below, sorted by the radius of their parents; of equals those nearer to the root come first.
    fn sequence(&self, tree: &SphereTree) -> Sequence {
        let below = self.nodes_below(tree);
        let order = Order::of(below.len(), |place| parent_radius(tree, below[place as usize].node));
        let inners = order.sorted.par_iter().with_min_len(NODES_PER_TASK).map(|&place| {
            let Below { node, parent } = below[place as usize];
            Inner::of(tree, node, order.place_of(parent))
        });
        let mut sequence = Sequence {
            above: Inner::of(tree, self.node, NO_PARENT),
            inners: inners.collect(),
            leaf_points: Vec::with_capacity(tree.division.inners[self.node as usize].point_count()),
        };
        // Leaves are sorted as well, so that GPUs test a prefix of them.
        let in_order = order.sorted.iter().map(|&place| below[place as usize].node);
        let nodes: Vec<u32> = std::iter::once(self.node).chain(in_order).collect();
        let leaf_parents = Order::of(nodes.len(), |place| {
            tree.nodes[nodes[place as usize] as usize].bounds.radius
        });
        for place in leaf_parents.sorted {
            let first = sequence.leaf_points.len();
            let children = tree.division.inners[nodes[place as usize] as usize].children();
            sequence.leaf_points.extend(children.filter_map(|child| match child {
                Child::Leaf(point) => Some(point),
                Child::Inner(_) => None,
            }));
            let parent = match place.checked_sub(1) {
                Some(place) => &mut sequence.inners[place as usize],
                None => &mut sequence.above,
            };
            parent.first_leaf = first as u32;
            parent.leaf_count = (sequence.leaf_points.len() - first) as u8;
        }
        sequence
    }

    /// The nodes of its sequence, in breadth-first order.
    fn nodes_below(&self, tree: &SphereTree) -> Vec<Below> {
        let children_of = |node: u32, parent: u32| {
            let children = tree.division.inners[node as usize].inner_children();
            children.map(move |node| Below { node, parent })
        };
        let mut below: Vec<Below> = Vec::new();
        if self.children.is_empty() {
            below.extend(children_of(self.node, NO_PARENT));
            let mut next = 0;
            while let Some(&Below { node, .. }) = below.get(next) {
                below.extend(children_of(node, next as u32));
                next += 1;
            }
        }
        below
    }
}

/// A view of sequences.
struct Selection<'a> {
    tree: &'a SequentialTree,
    rule: Rule,
    before: WasDivided,
}

impl Selection<'_> {
    fn node_class(&self, name: usize) -> NodeClass {
        let inner = &self.tree.inners[name];
        let was_divided = || self.before.at(name);
        self.rule.node_class(&inner.bounds, inner.level.into(), was_divided)
    }

    /// Those nodes of the sequence below a node that is divided that may be drawn: its first.
    fn candidates(&self, upper: usize) -> Range<usize> {
        let inners = self.tree.uppers[upper].inners.clone();
        let small_radius = self.rule.small_radius_below(&self.tree.inners[upper].bounds);
        let of_sequence = &self.tree.inners[inners.clone()];
        let count = of_sequence.partition_point(|inner| f64::from(inner.parent_radius) > small_radius);
        inners.start..inners.start + count
    }

    /// Returns the drawn nodes of the sequence below a node that is divided, and the number of nodes visited for it.
    fn sequence(&self, upper: usize) -> (ListedNodes, usize) {
        let candidates = self.candidates(upper);
        let tested = candidates.clone().into_par_iter();
        let verdicts: Vec<NodeClass> = tested
            .with_min_len(NODES_PER_TASK)
            .map(|name| self.node_class(name))
            .collect();
        let is_divided = |parent: u32| parent == NO_PARENT || verdicts[parent as usize] == NodeClass::Divided;
        let mut listed = ListedNodes::default();
        let mut leaves = vec![self.tree.inners[upper].leaves()];
        for (&node_class, name) in verdicts.iter().zip(candidates.clone()) {
            let inner = &self.tree.inners[name];
            match node_class {
                NodeClass::Small if is_divided(inner.parent) => listed.drawn.push(name as u32),
                NodeClass::Divided => {
                    listed.divided.push(name as u32);
                    leaves.push(inner.leaves());
                }
                NodeClass::Small | NodeClass::Dropped => {}
            }
        }
        // In memory order, which is the order in which GPUs list them.
        leaves.par_sort_unstable_by_key(|leaves| leaves.start);
        let inner_count = self.tree.inners.len();
        let names = leaves.into_iter().flatten().map(|leaf| (inner_count + leaf) as u32);
        let drawn_inners = listed.drawn.len();
        listed.drawn.extend(names);
        let leaf_count = listed.drawn.len() - drawn_inners;
        (listed, candidates.len() + leaf_count)
    }
}

#[cfg(test)]
impl SequentialTree {
    /// Returns the node of `tree` for each name, identified by the leaves, whose parents are known.
    pub(super) fn nodes(&self, tree: &SphereTree) -> std::collections::HashMap<u32, Child> {
        let division = &tree.division.inners;
        let mut parent_of_point = vec![0; self.leaf_points.len()];
        for (node, index) in division.iter().zip(0_u32..) {
            for child in node.children() {
                if let Child::Leaf(point) = child {
                    parent_of_point[point as usize] = index;
                }
            }
        }
        // The nodes above sequences are the first nodes of the tree in breadth-first order.
        let mut nodes = std::collections::HashMap::from([(0, Child::Inner(0))]);
        for (upper, name) in self.uppers.iter().zip(0_u32..) {
            let Some(&Child::Inner(node)) = nodes.get(&name) else {
                break;
            };
            let children = division[node as usize].inner_children().map(Child::Inner);
            nodes.extend(upper.children.clone().zip(children));
        }
        for (upper, name) in self.uppers.iter().zip(0_u32..) {
            let place_above = |parent: u32| {
                if parent == NO_PARENT {
                    name
                } else {
                    upper.inners.start as u32 + parent
                }
            };
            let owners = std::iter::once(name as usize).chain(upper.inners.clone());
            for (owner, leaf) in owners.flat_map(|owner| self.inners[owner].leaves().map(move |leaf| (owner, leaf))) {
                let point = self.leaf_points[leaf];
                nodes.insert((self.inners.len() + leaf) as u32, Child::Leaf(point));
                let (mut place, mut node) = (owner as u32, parent_of_point[point as usize]);
                loop {
                    let known = *nodes.entry(place).or_insert(Child::Inner(node));
                    assert_eq!(
                        known,
                        Child::Inner(node),
                        "one node of the tree for each of the sequence"
                    );
                    if place == name {
                        break;
                    }
                    place = place_above(self.inners[place as usize].parent);
                    node = division[node as usize].parent;
                }
            }
        }
        nodes
    }
}
