//! Per-node filter of a sequence, which determines the drawn nodes by a test of each: the GPU runs it by itself.
//!
//! How it works: bisection finds the prefix in which anything may be drawn (`sequential.rs`). Of its nodes, the
//! *candidates*, those are drawn that are small, or leaves, and whose parents are divided. So a view is a rule and two
//! numbers, and no list of nodes is built. A sequence that is filtered remembers nothing of the previous view.

use super::bounds::Bounds;
use super::cone::Cone;
use super::rule::{NodeClass, Rule, RuleNumbers};
use crate::math::Sphere;
use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use std::sync::Arc;

/// Bounds that decide whether a node that is not a leaf is drawn. Twin of `NodeBounds` in `passes/filter.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct NodeBounds {
    /// Centre of the sphere.
    pub center: [f32; 3],
    /// Radius of the sphere.
    pub sphere_radius: f32,
    /// Axis of the normal cone.
    pub axis: [f32; 3],
    /// Cosine of the normal cone.
    pub cone_cosine: f32,
    /// Radius of the disk that is drawn.
    pub radius: f32,
    /// The root is on level 0.
    pub level: u32,
    /// Name of the parent; the root is its own.
    pub parent: u32,
    /// Padding.
    pub unused: u32,
}

/// The nodes of one sequence, as they are tested.
#[derive(Debug, Clone)]
pub(super) struct Tested {
    /// Bounds of nodes that are not leaves, by their names: the root, then the sequence.
    pub(super) bounds: Arc<Vec<NodeBounds>>,
    /// The parents of leaves.
    pub(super) parents: Arc<Vec<u32>>,
}

/// A view of a sequence.
#[derive(Debug)]
pub struct SequenceFilter {
    pub(super) rule: Rule,
    pub(super) tested: Tested,
    /// Candidates that are not leaves: the first of the sequence.
    pub(super) inner_candidates: u32,
    /// The first leaves.
    pub(super) leaf_candidates: u32,
}

impl NodeBounds {
    pub(super) fn new(bounds: &Bounds, level: u32, parent: u32) -> Self {
        Self {
            center: bounds.sphere.center.to_array(),
            sphere_radius: bounds.sphere.radius,
            axis: bounds.cone.axis.to_array(),
            cone_cosine: bounds.cone.cosine,
            radius: bounds.radius,
            level,
            parent,
            unused: 0,
        }
    }

    fn bounds(&self) -> Bounds {
        Bounds {
            sphere: Sphere {
                center: Vec3::from_array(self.center),
                radius: self.sphere_radius,
            },
            cone: Cone {
                axis: Vec3::from_array(self.axis),
                cosine: self.cone_cosine,
            },
            radius: self.radius,
        }
    }
}

impl SequenceFilter {
    /// Number of candidates.
    pub fn len(&self) -> usize {
        self.inner_candidates as usize + self.leaf_candidates as usize
    }

    /// Returns true if there are no candidates to draw.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Candidates that are not leaves, which are the first.
    pub fn inner_candidates(&self) -> u32 {
        self.inner_candidates
    }

    /// Returns the bounds that decide about nodes that are not leaves, by their names.
    pub fn bounds(&self) -> &Arc<Vec<NodeBounds>> {
        &self.tested.bounds
    }

    /// Names of the parents of leaves.
    pub fn parents(&self) -> &Arc<Vec<u32>> {
        &self.tested.parents
    }

    /// Returns the parameters of the rule.
    pub fn numbers(&self) -> RuleNumbers {
        self.rule.numbers()
    }

    /// The name of a candidate: the index of its record.
    pub fn name(&self, candidate: u32) -> u32 {
        match candidate.checked_sub(self.inner_candidates) {
            None => candidate + 1,
            Some(leaf) => self.tested.bounds.len() as u32 + leaf,
        }
    }

    /// Returns true if a candidate is drawn.
    ///
    /// # Panics
    /// Precondition: it is one.
    pub fn draws(&self, candidate: u32) -> bool {
        let name = self.name(candidate) as usize;
        let bounds = &self.tested.bounds;
        let parent = match bounds.get(name) {
            Some(node) if self.node_class(node) == NodeClass::Small => node.parent,
            Some(_) => return false,
            None => self.tested.parents[name - bounds.len()],
        };
        // The root is subdivided, or there would be no candidates.
        parent == 0 || self.node_class(&bounds[parent as usize]) == NodeClass::Divided
    }

    fn node_class(&self, node: &NodeBounds) -> NodeClass {
        self.rule.node_class(&node.bounds(), node.level, || false)
    }
}
