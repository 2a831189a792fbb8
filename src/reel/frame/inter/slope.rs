//! Prediction of how child nodes move from the motion of the nodes of a level.
//!
//! How it works: a body that rotates moves by another step at each of its points, and that difference is practically
//! linear from a node to those around it. The linear map that fits the steps of the nodes around a node best (least
//! squares) predicts how the motion of its children differs from its own.

use super::followed::Family;
use crate::reel::tree::NONE;
use glam::DVec3;

/// Regularisation as a factor on the squared edge of a cell: directions in which a node has no neighbours, as across a
/// surface, get no slope.
const STIFFNESS: f64 = 0.125;

/// The nodes of a level, and of those below them.
#[derive(Debug, Clone, Copy)]
pub(super) struct Below<'a> {
    pub(super) family: &'a Family,
    /// For each node how far it moves.
    pub(super) steps: &'a [[i32; 3]],
    /// Positions of the children.
    pub(super) positions: &'a [[i32; 3]],
    /// Edge of the cells of the nodes, in parts.
    pub(super) edge: f64,
}

impl Below<'_> {
    fn children(&self, node: usize) -> &[[i32; 3]] {
        &self.positions[self.family.first[node] as usize..self.family.first[node + 1] as usize]
    }

    /// Differences of each child's motion from its parent's, by the motion of the nodes around that.
    pub(super) fn differences(&self) -> Vec<[i32; 3]> {
        let nodes = self.steps.len();
        let centers: Vec<DVec3> = (0..nodes).map(|node| center_of(self.children(node))).collect();
        let mut differences = Vec::with_capacity(self.positions.len());
        for node in 0..nodes {
            let children = self.children(node);
            if let [_] = children {
                differences.push([0; 3]);
                continue;
            }
            let slope = self.slope(node, &centers);
            let difference = |&child: &[i32; 3]| slope.along(place(child) - centers[node]);
            differences.extend(children.iter().map(difference));
        }
        differences
    }

    fn slope(&self, node: usize, centers: &[DVec3]) -> Slope {
        let stiffness = STIFFNESS * self.edge * self.edge;
        let mut spread = [DVec3::ZERO; 3];
        let mut turned = [DVec3::ZERO; 3];
        let own = place(self.steps[node]);
        for &neighbour in &self.family.neighbours[node] {
            if neighbour == NONE || neighbour as usize == node {
                continue;
            }
            let way = centers[neighbour as usize] - centers[node];
            let step = place(self.steps[neighbour as usize]) - own;
            for axis in 0..3 {
                spread[axis] += way * way[axis];
                turned[axis] += step * way[axis];
            }
        }
        for (axis, column) in spread.iter_mut().enumerate() {
            column[axis] += stiffness;
        }
        Slope { spread, turned }
    }
}

/// Steps around a node against displacements to it: sums of products, a column for each axis of the displacement.
struct Slope {
    /// Products of direction vectors with direction vectors.
    spread: [DVec3; 3],
    /// Products of steps with direction vectors.
    turned: [DVec3; 3],
}

impl Slope {
    /// The difference of steps for a displacement, in whole parts.
    fn along(&self, way: DVec3) -> [i32; 3] {
        let [x, y, z] = self.spread;
        // Cramer's rule, as the matrix is symmetric.
        let determinant = x.dot(y.cross(z));
        let weights = DVec3::new(way.dot(y.cross(z)), way.dot(z.cross(x)), way.dot(x.cross(y))) / determinant;
        let [x, y, z] = self.turned;
        let difference = x * weights.x + y * weights.y + z * weights.z;
        difference.round().to_array().map(|along| along as i32)
    }
}

fn place(position: [i32; 3]) -> DVec3 {
    DVec3::from_array(position.map(f64::from))
}

/// The mean of places. Precondition: there is one.
fn center_of(children: &[[i32; 3]]) -> DVec3 {
    let sum: DVec3 = children.iter().copied().map(place).sum();
    sum / children.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A body that turns, and is sheared: eight nodes around one whose children are predicted.
    #[test]
    fn linear_motion_is_predicted() {
        let way_of = |index: i32| [index % 3 - 1, index / 3 % 3 - 1, index / 9 - 1];
        let step_of = |[x, y, z]: [i32; 3]| [y / 8 + 7, -x / 8 - 3, x / 16 + z / 4];
        let mut family = Family {
            neighbours: Vec::new(),
            first: Vec::new(),
        };
        let (mut steps, mut positions) = (Vec::new(), Vec::new());
        for node in 0..27 {
            let center = way_of(node).map(|along| 1024 * along);
            family.first.push(positions.len() as u32);
            for side in [-256, 256] {
                positions.push([center[0] + side, center[1] - side, center[2] + side]);
            }
            steps.push(step_of(center));
            family.neighbours.push([NONE; 27]);
        }
        family.first.push(positions.len() as u32);
        family.neighbours[13] = std::array::from_fn(|direction| direction as u32);
        let below = Below {
            family: &family,
            steps: &steps,
            positions: &positions,
            edge: 1024.0,
        };
        let differences = below.differences();
        // x += y / 8, y −= x / 8, z += x / 16 + z / 4, for the offset (256, −256, 256), reduced by the stiffness.
        let found = differences[27];
        let expected = [-32, -32, 80];
        assert!(
            (0..3).all(|axis| (found[axis] - expected[axis]).abs() <= 2),
            "{found:?}"
        );
        assert_eq!(differences[26].map(|along| -along), found);
        // The others have no known neighbours.
        assert_eq!(differences[0], [0; 3]);
    }
}
