//! The nodes of a code that are drawn in a view, level by level, and their surfels.
//!
//! How it works: a queue holds the nodes of one level that may be seen. Each of them is drawn where its cell is small
//! enough in the image, dropped where nothing of it can be seen, else divided: its children are in the next queue. All
//! nodes of a queue are independent of each other, so a GPU tests them at once (`render/gpu/coded`, whose
//! `coded/expand.wgsl` has the same rule). The drawn nodes are in the order of their levels, and in Morton order on
//! each level.
//!
//! The rule is that of the CPU renderer's blocks where each block is a node, but with spheres around cells instead of
//! boxes.

use super::attributes::cone_of_code;
use super::{CodedCloud, LARGEST_OFFSET, NodeAttributes, offset_of_code, radius_of_code};
use crate::cloud::{PointRecord, ShapeRecord, coarser_normal, largest_normal_error, oct_encode, quantised_normals};
use glam::Vec3;

/// A view of a byte code, in the space of its frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CodeView {
    /// The eye is `eye_high + eye_low`.
    pub eye_high: Vec3,
    /// Rounding remainder of the eye.
    pub eye_low: Vec3,
    /// Unit vector of the view axis.
    pub forward: Vec3,
    /// Unit normals of the side planes, which contain the eye, pointing inwards.
    pub sides: [Vec3; 4],
    /// Distance to the near plane.
    pub near: f32,
    /// Pixels of a length of 1 at a distance of 1.
    pub px_per_slope: f32,
    /// Cells whose edge projects below this many pixels are not divided.
    pub lod_px: f32,
    /// Cells of this level are not divided.
    pub deepest_level: u32,
    /// Nodes whose normals all face away are dropped.
    pub culls_back_faces: bool,
    /// Drawn nodes whose own normal faces away are dropped too. A rasteriser culls the back faces of disks, but pixels
    /// have none.
    pub culls_by_own_normals: bool,
    /// Reach of a splat in its radii.
    pub reach_radii: f32,
    /// Bits of normals that are used.
    pub normal_bits: u32,
    /// Bits of offsets along normals that are used.
    pub offset_bits: u32,
}

/// A node that is drawn, or tested.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CodeNode {
    /// Its number, breadth-first.
    pub number: u32,
    /// Its level.
    pub level: u32,
    /// Its cell.
    pub cell: [u32; 3],
}

impl CodeNode {
    /// The root of a code that has nodes.
    pub const ROOT: Self = Self {
        number: 0,
        level: 0,
        cell: [0; 3],
    };
}

impl CodeView {
    /// Angle that is added to normal cones: the axis is drawn with fewer bits than it was stored with, and so are the
    /// normals of the nodes below; plus rounding.
    pub fn cone_slack(&self) -> f32 {
        3.0 * largest_normal_error(self.normal_bits) + 2e-3
    }

    /// Radius in cell edges, and sine and cosine of the normal cone with its slack, that each code means.
    pub fn code_values(&self) -> impl Iterator<Item = [f32; 3]> {
        let cone_slack = self.cone_slack();
        (0..=u8::MAX).map(move |code| {
            let (sine, cosine) = (cone_of_code(code) + cone_slack).sin_cos();
            [radius_of_code(code), sine, cosine]
        })
    }

    /// The normals with the bits that are used, by index.
    pub fn normals(&self) -> &'static [Vec3] {
        quantised_normals(self.normal_bits)
    }

    fn normal_of(&self, attributes: NodeAttributes) -> Vec3 {
        normal_of(attributes, self.normal_bits)
    }

    fn offset_from_eye(&self, position: Vec3) -> Vec3 {
        (position - self.eye_high) - self.eye_low
    }

    /// Returns true if a cell with this centre relative to the eye is small enough in the image.
    fn is_small(&self, offset: Vec3, edge: f32) -> bool {
        let [x, y, z] = self.forward.abs().to_array();
        let nearest = offset.dot(self.forward) - 0.5 * edge * (x + y + z);
        nearest > self.near && edge * (self.px_per_slope / nearest) < self.lod_px
    }

    fn is_outside(&self, offset: Vec3, radius: f32) -> bool {
        // More than the radius, to cover rounding.
        let radius = radius * 1.001 + 1e-5 * offset.length();
        offset.dot(self.forward) < -radius || self.sides.iter().any(|side| offset.dot(*side) < -radius)
    }
}

impl CodedCloud {
    /// The nodes that are drawn in a view.
    pub fn drawn_nodes(&self, view: &CodeView) -> Vec<CodeNode> {
        let deepest = view.deepest_level.min(self.depth());
        let reaches = self.reaches(view.reach_radii);
        let cone_slack = view.cone_slack();
        let (mut drawn, mut queue) = (Vec::new(), Vec::new());
        queue.extend((!self.attributes.is_empty()).then_some(CodeNode::ROOT));
        while let Some(first) = queue.first() {
            let level = first.level;
            let edge = self.cube.cell_edge(level);
            let mut next = Vec::new();
            for node in queue {
                let attributes = self.attributes[node.number as usize];
                let offset = view.offset_from_eye(self.cube.cell_center(level, node.cell));
                let half_diagonal = LARGEST_OFFSET * edge;
                let of_own = view.reach_radii * (attributes.radius_edges() * edge + edge);
                let radius = half_diagonal + reaches[level as usize].min(of_own);
                if view.is_outside(offset, radius)
                    || view.culls_back_faces && faces_away(attributes, offset, half_diagonal, view, cone_slack)
                {
                    continue;
                }
                if level >= deepest || view.is_small(offset, edge) {
                    let faces = !view.culls_by_own_normals || view.normal_of(attributes).dot(offset) <= 0.0;
                    drawn.extend(faces.then_some(node));
                } else {
                    next.extend(self.children(node));
                }
            }
            queue = next;
        }
        drawn
    }

    /// The children of a node above the leaves.
    pub fn children(&self, node: CodeNode) -> impl Iterator<Item = CodeNode> {
        let mask = self.masks[node.number as usize];
        let octants = (0..8u32).filter(move |octant| mask >> octant & 1 != 0);
        let numbered = octants.zip(self.first_child(node.number as usize) as u32..);
        numbered.map(move |(octant, number)| CodeNode {
            number,
            level: node.level + 1,
            cell: [0, 1, 2].map(|axis| 2 * node.cell[axis] + (octant >> axis & 1)),
        })
    }

    /// The surfel of a node, decoded with these numbers of bits.
    pub fn surfel(&self, node: CodeNode, normal_bits: u32, offset_bits: u32) -> (PointRecord, ShapeRecord) {
        let attributes = self.attributes[node.number as usize];
        let edge = self.cube.cell_edge(node.level);
        let normal = normal_of(attributes, normal_bits);
        let offset = offset_of_code(attributes.offset_code(), offset_bits) * edge;
        let [red, green, blue] = attributes.color;
        let point = PointRecord {
            position: (self.cube.cell_center(node.level, node.cell) + offset * normal).to_array(),
            color: [red, green, blue, 255],
        };
        let shape = ShapeRecord {
            normal: oct_encode(normal),
            radius: attributes.radius_edges() * edge,
            ellipse: 0,
            scalar: 0.0,
        };
        (point, shape)
    }

    /// The surfels that are drawn in a view.
    pub fn surfels(&self, view: &CodeView) -> (Vec<PointRecord>, Vec<ShapeRecord>) {
        let nodes = self.drawn_nodes(view).into_iter();
        nodes
            .map(|node| self.surfel(node, view.normal_bits, view.offset_bits))
            .unzip()
    }
}

/// The normal of a node, with this number of bits.
fn normal_of(attributes: NodeAttributes, bits: u32) -> Vec3 {
    quantised_normals(bits)[coarser_normal(attributes.normal(), bits) as usize]
}

/// Returns true if all normals in the cone of a node face away from an eye, wherever they are in a sphere.
fn faces_away(attributes: NodeAttributes, offset: Vec3, radius: f32, view: &CodeView, cone_slack: f32) -> bool {
    let distance = offset.length();
    let (sine, cosine) = (attributes.cone() + cone_slack).sin_cos();
    if distance <= radius || cosine <= 0.0 {
        return false;
    }
    // Of the angle between the directions to the centre and to the border of the sphere.
    let border_sine = radius / distance;
    let border_cosine = (1.0 - border_sine * border_sine).sqrt();
    let facing = view.normal_of(attributes).dot(offset) / distance;
    // Opening below 90°, and the normal farther from the plane across the view than that.
    cosine * border_cosine > sine * border_sine && facing > sine * border_cosine + cosine * border_sine
}
