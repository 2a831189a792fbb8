//! QSplat: a tree of spheres of six bytes per node, decoded on the way (Rusinkiewicz and Levoy 2000).
//!
//! How it works: nodes are in breadth-first order, siblings contiguous, leaves as well. A group of siblings begins
//! with a pointer to the children of its first that has any; the children of the others follow there. A group of leaves
//! alone has none, as stated in the parent. A sphere is encoded relative to its parent's, so a cut keeps the spheres of
//! its nodes. Everything of a node comes from its code, also of a leaf: positions, normals and colours are rounded.
//!
//! When it wins: where memory is short. A point takes nine to ten bytes with all nodes above it.

use super::before::WasDivided;
use super::bounds::Bounds;
use super::node_code::{NODE_WORDS, NodeCode};
use super::rule::{NodeClass, Rule};
use super::sphere_code;
use super::splat::Splat;
use super::split::{Child, Inner};
use super::summary::Summary;
use super::tree::SphereTree;
use crate::cloud::{PointRecord, ShapeRecord};
use crate::levels::cut::{Cut, CutHints, ListedNodes, SelectView};
use crate::levels::structure::{LevelsSize, RecordBuffers, Records};
use crate::math::Sphere;
use bytemuck::Zeroable;
use rayon::prelude::*;

/// Numbers of 16 bits that a pointer takes.
const POINTER_WORDS: usize = 2;

/// Nodes down to this level may go to several threads.
const PARALLEL_LEVELS: u32 = 3;

/// A group that is the root alone begins here.
const ROOT_GROUP: usize = 0;

/// The tree in one array.
#[derive(Debug)]
pub(super) struct QSplat {
    /// Groups of siblings. A node is named by the index of its first word.
    words: Vec<u16>,
    root: Sphere,
    node_count: usize,
}

/// Start offset and word count of groups of children.
fn group_words(node: &Inner) -> usize {
    let pointer = if node.inner_children().is_empty() {
        0
    } else {
        POINTER_WORDS
    };
    pointer + node.child_count() * NODE_WORDS
}

/// Returns the start offsets of the children of each node of a tree, and the end of the last ones.
fn group_starts(tree: &SphereTree) -> Vec<usize> {
    let first = ROOT_GROUP + POINTER_WORDS + NODE_WORDS;
    let sizes = tree.division.inners.iter().map(group_words);
    let ends = sizes.scan(first, |end, size| {
        *end += size;
        Some(*end)
    });
    std::iter::once(first).chain(ends).collect()
}

impl QSplat {
    /// The codes of a coded tree of these points.
    pub(super) fn of(tree: &SphereTree, points: &[PointRecord], shapes: &[ShapeRecord]) -> Self {
        let Some(root) = tree.nodes.first() else {
            return Self {
                words: Vec::new(),
                root: Sphere::around(std::iter::empty()),
                node_count: 0,
            };
        };
        let starts = group_starts(tree);
        let inners = &tree.division.inners;
        let code_of = |index: usize| {
            let node = &inners[index];
            tree.codes[index].with_children(node.child_count(), !node.inner_children().is_empty())
        };
        let write_group = |parent: usize, group: &mut [u16]| {
            let node = &inners[parent];
            let inner_children = node.inner_children();
            let pointer = starts
                .get(inner_children.start as usize)
                .filter(|_| !inner_children.is_empty());
            let nodes = write_pointer(pointer, group);
            for (words, child) in nodes.chunks_exact_mut(NODE_WORDS).zip(node.children()) {
                let code = match child {
                    Child::Inner(index) => code_of(index as usize),
                    Child::Leaf(point) => leaf_code(
                        &tree.nodes[parent].sphere,
                        &points[point as usize],
                        &shapes[point as usize],
                    ),
                };
                words.copy_from_slice(&code.to_words());
            }
        };
        let mut words = vec![0; starts[inners.len()]];
        let (root_group, mut left) = words.split_at_mut(starts[0]);
        write_pointer(starts.first(), root_group).copy_from_slice(&code_of(0).to_words());
        let mut groups = Vec::with_capacity(inners.len());
        for node in inners {
            let (group, after) = left.split_at_mut(group_words(node));
            groups.push(group);
            left = after;
        }
        let groups = groups.into_par_iter().enumerate();
        groups.for_each(|(parent, group)| write_group(parent, group));
        Self {
            words,
            root: root.sphere,
            node_count: inners.len() + points.len(),
        }
    }

    pub(super) fn size(&self) -> LevelsSize {
        LevelsSize {
            nodes: self.node_count,
            bytes: size_of_val(self.words.as_slice()),
        }
    }

    pub(super) fn cut(&self, view: &SelectView, hints: CutHints<'_>) -> Cut {
        let mut found = FoundNodes::default();
        if self.node_count > 0 {
            let descent = Descent {
                qsplat: self,
                rule: Rule::new(view, &hints),
                before: WasDivided::new(hints.before),
            };
            let code = self.code(ROOT_GROUP + POINTER_WORDS);
            descent.visit(
                &Visit {
                    name: ROOT_GROUP + POINTER_WORDS,
                    code,
                    sphere: self.root,
                    bounds: Bounds {
                        sphere: self.root,
                        cone: code.cone(),
                        radius: self.root.radius,
                    },
                    level: 0,
                    children: self.pointer(ROOT_GROUP),
                },
                &mut found,
            );
        }
        found.listed.into_cut(found.decoded, view.lod_px)
    }

    pub(super) fn write(&self, cut: &Cut, buffers: RecordBuffers) -> Records {
        let RecordBuffers {
            mut points, mut shapes, ..
        } = buffers;
        let nodes = cut.listed.drawn.par_iter().zip(&cut.listed.spheres);
        nodes
            .map(|(&name, sphere)| {
                let code = self.code(name as usize);
                Splat::new(sphere, code.normal(), code.color()).records()
            })
            .unzip_into_vecs(&mut points, &mut shapes);
        Records::Surfels { points, shapes }
    }

    /// The index of a node among [`QSplat::node_records`]. Nodes are at least that many words apart.
    pub(super) fn place_of(name: u32) -> u32 {
        name / NODE_WORDS as u32
    }

    /// The records of all nodes; unused indices have empty records.
    pub(super) fn node_records(&self) -> (Vec<PointRecord>, Vec<ShapeRecord>) {
        let places = self.words.len().div_ceil(NODE_WORDS);
        let mut points = vec![PointRecord::zeroed(); places];
        let mut shapes = vec![ShapeRecord::zeroed(); places];
        let mut keep = |name: usize, code: NodeCode, sphere: Sphere| {
            let place = Self::place_of(name as u32) as usize;
            (points[place], shapes[place]) = Splat::new(&sphere, code.normal(), code.color()).records();
        };
        let mut parents = Vec::new();
        if self.node_count > 0 {
            let code = self.code(ROOT_GROUP + POINTER_WORDS);
            keep(ROOT_GROUP + POINTER_WORDS, code, self.root);
            parents.push((code, self.root, self.pointer(ROOT_GROUP)));
        }
        while let Some((code, sphere, children)) = parents.pop() {
            for child in self.children(code, sphere, children) {
                keep(child.name, child.code, child.sphere);
                parents.extend(child.children.map(|children| (child.code, child.sphere, children)));
            }
        }
        (points, shapes)
    }

    /// The children of a node, which begin at an index.
    #[inline(always)]
    fn children(&self, parent: NodeCode, around: Sphere, group: usize) -> impl Iterator<Item = Decoded> {
        let (count, have_children) = parent.children();
        let (mut first, mut below) = (group, 0);
        if have_children {
            below = self.pointer(group);
            first += POINTER_WORDS;
        }
        (first..).step_by(NODE_WORDS).take(count).map(move |name| {
            let code = self.code(name);
            let (grandchildren, have_children) = code.children();
            let children = (grandchildren > 0).then_some(below);
            if grandchildren > 0 {
                below += grandchildren * NODE_WORDS + if have_children { POINTER_WORDS } else { 0 };
            }
            Decoded {
                name,
                code,
                sphere: sphere_code::decoded(&around, code.sphere()),
                children,
            }
        })
    }

    #[inline(always)]
    fn code(&self, name: usize) -> NodeCode {
        NodeCode::from_words([self.words[name], self.words[name + 1], self.words[name + 2]])
    }

    #[inline(always)]
    fn pointer(&self, group: usize) -> usize {
        self.words[group] as usize | (self.words[group + 1] as usize) << 16
    }
}

/// Writes the pointer of a group, if it has one; returns the remaining words.
fn write_pointer<'w>(pointer: Option<&usize>, group: &'w mut [u16]) -> &'w mut [u16] {
    let Some(&pointer) = pointer else { return group };
    let (words, nodes) = group.split_at_mut(POINTER_WORDS);
    words.copy_from_slice(&[pointer as u16, (pointer >> 16) as u16]);
    nodes
}

fn leaf_code(parent: &Sphere, point: &PointRecord, shape: &ShapeRecord) -> NodeCode {
    let sphere = Summary::of_point(point, shape).sphere;
    NodeCode::new(sphere_code::encoded(parent, &sphere), shape.normal, point.color)
}

/// Nodes found by a traversal.
#[derive(Default)]
struct FoundNodes {
    listed: ListedNodes,
    /// Nodes that were decoded.
    decoded: usize,
}

/// A node whose code was read.
struct Decoded {
    name: usize,
    code: NodeCode,
    sphere: Sphere,
    /// Start offset of its children, unless it is a leaf.
    children: Option<usize>,
}

struct Descent<'a> {
    qsplat: &'a QSplat,
    rule: Rule,
    before: WasDivided,
}

/// A node with children to be tested.
struct Visit {
    name: usize,
    code: NodeCode,
    sphere: Sphere,
    bounds: Bounds,
    level: u32,
    /// Start offset of the children.
    children: usize,
}

impl Descent<'_> {
    /// Recursion is bounded by the bits of a Morton code and of the number of points.
    fn visit(&self, visit: &Visit, found: &mut FoundNodes) {
        found.decoded += 1;
        let was_divided = || self.before.at(visit.name);
        match self.rule.node_class(&visit.bounds, visit.level, was_divided) {
            NodeClass::Dropped => {}
            NodeClass::Small => found.draw(visit.name, visit.sphere),
            NodeClass::Divided => {
                found.listed.divided.push(visit.name as u32);
                if visit.level < PARALLEL_LEVELS {
                    let mut children = Vec::with_capacity(super::split::MAX_CHILDREN);
                    self.each_child(visit, found, |child, _| children.push(child));
                    let parts: Vec<FoundNodes> = children.par_iter().map(|child| self.found_from(child)).collect();
                    for part in parts {
                        found.append(part);
                    }
                } else {
                    self.each_child(visit, found, |child, found| self.visit(&child, found));
                }
            }
        }
    }

    fn found_from(&self, visit: &Visit) -> FoundNodes {
        let mut found = FoundNodes::default();
        self.visit(visit, &mut found);
        found
    }

    /// Draws the leaves among the children of a node and passes on the others.
    #[inline(always)]
    fn each_child(&self, parent: &Visit, found: &mut FoundNodes, mut hand_on: impl FnMut(Visit, &mut FoundNodes)) {
        for child in self.qsplat.children(parent.code, parent.sphere, parent.children) {
            let Decoded { name, code, sphere, .. } = child;
            let Some(children) = child.children else {
                found.decoded += 1;
                found.draw(name, sphere);
                continue;
            };
            let child = Visit {
                name,
                code,
                sphere,
                bounds: parent.bounds.nested(sphere, code.cone(), sphere.radius),
                level: parent.level + 1,
                children,
            };
            hand_on(child, found);
        }
    }
}

impl FoundNodes {
    #[inline(always)]
    fn draw(&mut self, name: usize, sphere: Sphere) {
        self.listed.drawn.push(name as u32);
        self.listed.spheres.push(sphere);
    }

    fn append(&mut self, other: Self) {
        self.listed.append(other.listed);
        self.decoded += other.decoded;
    }
}

#[cfg(test)]
impl QSplat {
    /// Returns the node of `tree` for each name.
    pub(super) fn nodes(tree: &SphereTree) -> std::collections::HashMap<u32, Child> {
        let mut nodes = std::collections::HashMap::from([(POINTER_WORDS as u32, Child::Inner(0))]);
        for (node, start) in tree.division.inners.iter().zip(group_starts(tree)) {
            let first = start + group_words(node) - node.child_count() * NODE_WORDS;
            let names = (first..).step_by(NODE_WORDS).map(|name| name as u32);
            nodes.extend(names.zip(node.children()));
        }
        nodes
    }
}
