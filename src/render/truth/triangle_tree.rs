//! Bounding volume hierarchy of triangles, for rays in f64.
//!
//! How it works: triangles are divided at the median of their centroids, along the longest edge of the box around
//! these, until four are left; so no branch is deeper than the logarithm of their number. A ray visits the nearer half
//! first and skips boxes behind its nearest hit. The triangle test follows Woop, Benthin and Wald 2013: the edge
//! functions of two triangles that share an edge are negatives of each other to the last bit, so that no ray slips
//! between them.
//!
//! Not one of the crates: their rays are f32, or their tests are not watertight.

use glam::DVec3;

/// Triangles that are not divided further.
const MAX_LEAF: usize = 4;

/// Relative margin of boxes, near and far, more than rounding adds to depths.
const SLACK: f64 = 1e-12;

/// Triangles by the boxes around them.
#[derive(Debug)]
pub(super) struct TriangleTree {
    /// The root first, and the first child of a node next to it.
    nodes: Vec<Node>,
    /// Corners in the order of the leaves.
    corners: Vec<[DVec3; 3]>,
    /// Numbers of these triangles among those that the tree was made of.
    numbers: Vec<u32>,
}

#[derive(Debug, Clone, Copy)]
struct Node {
    min: DVec3,
    max: DVec3,
    /// First triangle of a leaf; second child of another node.
    first: u32,
    /// Triangles of a leaf; 0 of another node.
    count: u32,
}

/// Nearest intersection of a ray with triangles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct TriangleHit {
    /// Number of the triangle.
    pub(super) triangle: usize,
    /// Multiple of the direction.
    pub(super) depth: f64,
    /// Barycentric coordinates: the share of each corner.
    pub(super) shares: [f64; 3],
}

/// A ray, made ready for boxes and triangles.
pub(super) struct Ray {
    from: DVec3,
    direction: DVec3,
    /// Axes; the last is the one along which the direction is longest.
    axes: [usize; 3],
    /// Shear to a direction along the last of these axes.
    shear: DVec3,
}

impl Ray {
    /// Precondition: `direction` is not zero.
    pub(super) fn new(from: DVec3, direction: DVec3) -> Self {
        let along = direction.abs().max_position();
        let axes = [(along + 1) % 3, (along + 2) % 3, along];
        let [right, up, along] = axes.map(|axis| direction[axis]);
        Self {
            from,
            direction,
            axes,
            shear: DVec3::new(right, up, 1.0) / along,
        }
    }

    /// The depths between which the ray is in a box; none where it misses it.
    fn within(&self, node: &Node) -> Option<[f64; 2]> {
        let [mut enter, mut leave] = [0.0f64, f64::INFINITY];
        for axis in 0..3 {
            let [min, max] = [node.min[axis] - self.from[axis], node.max[axis] - self.from[axis]];
            let along = self.direction[axis];
            if along == 0.0 {
                if min > 0.0 || max < 0.0 {
                    return None;
                }
                continue;
            }
            let [first, second] = [min / along, max / along];
            enter = enter.max(first.min(second));
            leave = leave.min(first.max(second));
        }
        let [enter, leave] = [enter * (1.0 - SLACK), leave * (1.0 + SLACK)];
        (enter <= leave).then_some([enter, leave])
    }

    /// The depth at which the ray meets a triangle from either side, and the shares of the corners.
    pub(super) fn meet(&self, corners: &[DVec3; 3]) -> Option<(f64, [f64; 3])> {
        let [right, up, along] = self.axes;
        let [a, b, c] = corners.map(|corner| {
            let offset = corner - self.from;
            DVec3::new(
                offset[right] - self.shear.x * offset[along],
                offset[up] - self.shear.y * offset[along],
                self.shear.z * offset[along],
            )
        });
        let edge = |first: DVec3, second: DVec3| first.x * second.y - first.y * second.x;
        let edges = [edge(c, b), edge(a, c), edge(b, a)];
        if edges.iter().any(|&edge| edge < 0.0) && edges.iter().any(|&edge| edge > 0.0) {
            return None;
        }
        let sum = edges[0] + edges[1] + edges[2];
        let depth = (edges[0] * a.z + edges[1] * b.z + edges[2] * c.z) / sum;
        // Seen edge on, the sum is 0 and the depth not a number.
        (depth > 0.0 && depth.is_finite()).then(|| (depth, edges.map(|edge| edge / sum)))
    }
}

impl TriangleTree {
    /// Tree of triangles by their corners. Precondition: these are finite, and no more than `u32` counts.
    pub(super) fn new(triangles: &[[DVec3; 3]]) -> Self {
        let centroids: Vec<DVec3> = triangles.iter().map(|[a, b, c]| (a + b + c) / 3.0).collect();
        let mut numbers: Vec<u32> = (0..triangles.len() as u32).collect();
        let mut nodes = Vec::new();
        if !numbers.is_empty() {
            let build = Build {
                triangles,
                centroids: &centroids,
            };
            build.divide(&mut numbers, 0, &mut nodes);
        }
        Self {
            nodes,
            corners: numbers.iter().map(|&number| triangles[number as usize]).collect(),
            numbers,
        }
    }

    /// The nearest triangle that a ray meets; of several at one depth the last one, as renderers show them.
    pub(super) fn nearest(&self, ray: &Ray) -> Option<TriangleHit> {
        let mut nearest: Option<TriangleHit> = None;
        // Medians halve, so that 2³² triangles have 32 levels.
        let mut waiting = [(0, 0.0); 40];
        let mut count = 0;
        if let Some([enter, _]) = self.nodes.first().and_then(|root| ray.within(root)) {
            waiting[0] = (0, enter);
            count = 1;
        }
        while count > 0 {
            count -= 1;
            let (place, enter): (u32, f64) = waiting[count];
            if nearest.is_some_and(|nearest| enter > nearest.depth) {
                continue;
            }
            let node = &self.nodes[place as usize];
            if node.count > 0 {
                self.meet_leaf(ray, node, &mut nearest);
                continue;
            }
            let children = [place + 1, node.first];
            let [first, second] = children.map(|child| {
                let within = ray.within(&self.nodes[child as usize]);
                within.map(|[enter, _]| (child, enter))
            });
            // The nearer one last, which is the next to be visited.
            let is_ordered = match (first, second) {
                (Some((_, first)), Some((_, second))) => first >= second,
                _ => true,
            };
            let ordered = if is_ordered { [first, second] } else { [second, first] };
            for child in ordered.into_iter().flatten() {
                waiting[count] = child;
                count += 1;
            }
        }
        nearest
    }

    fn meet_leaf(&self, ray: &Ray, node: &Node, nearest: &mut Option<TriangleHit>) {
        let leaf = node.first as usize..(node.first + node.count) as usize;
        for (corners, &number) in self.corners[leaf.clone()].iter().zip(&self.numbers[leaf]) {
            let Some((depth, shares)) = ray.meet(corners) else {
                continue;
            };
            let triangle = number as usize;
            let is_nearest = nearest
                .is_none_or(|nearest| depth < nearest.depth || depth == nearest.depth && triangle > nearest.triangle);
            if is_nearest {
                *nearest = Some(TriangleHit {
                    triangle,
                    depth,
                    shares,
                });
            }
        }
    }
}

/// Input of a tree.
struct Build<'a> {
    triangles: &'a [[DVec3; 3]],
    centroids: &'a [DVec3],
}

impl Build<'_> {
    /// Adds the node of `numbers`, which are the leaves' from `first` on, and those below it.
    fn divide(&self, numbers: &mut [u32], first: usize, nodes: &mut Vec<Node>) {
        let corners = numbers.iter().flat_map(|&number| self.triangles[number as usize]);
        let [min, max] = around(corners);
        let place = nodes.len();
        nodes.push(Node {
            min,
            max,
            first: first as u32,
            count: numbers.len() as u32,
        });
        if numbers.len() <= MAX_LEAF {
            return;
        }
        let [min, max] = around(numbers.iter().map(|&number| self.centroids[number as usize]));
        let axis = (max - min).max_position();
        let half = numbers.len() / 2;
        let along = |number: &u32| self.centroids[*number as usize][axis];
        numbers.select_nth_unstable_by(half, |a, b| along(a).total_cmp(&along(b)));
        let (lower, upper) = numbers.split_at_mut(half);
        self.divide(lower, first, nodes);
        nodes[place].first = nodes.len() as u32;
        nodes[place].count = 0;
        self.divide(upper, first + half, nodes);
    }
}

/// The box around places.
fn around(places: impl Iterator<Item = DVec3>) -> [DVec3; 2] {
    places.fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[min, max], place| {
        [min.min(place), max.max(place)]
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The nearest of all triangles, testing each.
    fn by_brute_force(triangles: &[[DVec3; 3]], ray: &Ray) -> Option<TriangleHit> {
        let hits = triangles.iter().enumerate().filter_map(|(triangle, corners)| {
            let (depth, shares) = ray.meet(corners)?;
            Some(TriangleHit {
                triangle,
                depth,
                shares,
            })
        });
        // Of equal ones the last.
        hits.min_by(|a, b| a.depth.total_cmp(&b.depth).then(b.triangle.cmp(&a.triangle)))
    }

    /// Few numbers, so that corners coincide, lie in planes with boxes, and rays go through them.
    fn place() -> impl Strategy<Value = DVec3> {
        prop::array::uniform3(-4i8..5).prop_map(|place| DVec3::from_array(place.map(|axis| f64::from(axis) / 2.0)))
    }

    proptest! {
        #[test]
        fn the_tree_finds_what_all_triangles_have(
            triangles in prop::collection::vec(prop::array::uniform3(place()), 0..60),
            eyes in prop::collection::vec((place(), place()), 1..30),
        ) {
            let tree = TriangleTree::new(&triangles);
            for (eye, to) in eyes {
                let direction = if to == eye { DVec3::X } else { to - eye };
                let ray = Ray::new(eye, direction);
                let expected = by_brute_force(&triangles, &ray);
                prop_assert_eq!(tree.nearest(&ray), expected, "from {} along {}", eye, direction);
            }
        }

        #[test]
        fn no_ray_slips_between_neighbours(
            center in prop::array::uniform2(0.01f64..0.99),
            shares in prop::collection::vec(0.0f64..1.0, 4..40),
            eye in prop::array::uniform3(-3.0f64..3.0),
        ) {
            // A square of four triangles around a corner within it: rays through places on their inner edges.
            let outer = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, y]| DVec3::new(x, y, 0.0));
            let center = DVec3::new(center[0], center[1], 0.0);
            let triangles: Vec<_> = (0..4).map(|corner| [outer[corner], outer[(corner + 1) % 4], center]).collect();
            let tree = TriangleTree::new(&triangles);
            let eye = DVec3::new(eye[0], eye[1], eye[2] + 3.5);
            for (place, share) in shares.into_iter().enumerate() {
                let on_edge = center.lerp(outer[place % 4], 0.999 * share);
                prop_assert!(tree.nearest(&Ray::new(eye, on_edge - eye)).is_some(), "{on_edge}");
            }
        }
    }

    #[test]
    fn a_triangle_is_met_where_it_is() {
        let corners = [DVec3::ZERO, DVec3::new(4.0, 0.0, 0.0), DVec3::new(0.0, 4.0, 0.0)];
        let tree = TriangleTree::new(&[corners]);
        for (side, along) in [(2.0, -1.0), (-2.0, 1.0)] {
            let hit = |x: f64, y: f64| tree.nearest(&Ray::new(DVec3::new(x, y, side), DVec3::Z * along));
            let inside = hit(1.0, 2.0).unwrap();
            assert_eq!(
                (inside.triangle, inside.depth, inside.shares),
                (0, 2.0, [0.25, 0.25, 0.5])
            );
            // Corners and edges belong to it.
            assert!(hit(0.0, 0.0).is_some() && hit(2.0, 2.0).is_some());
            assert!(hit(2.01, 2.0).is_none() && hit(-0.01, 1.0).is_none());
        }
        // Behind the eye, edge on, and without triangles.
        assert!(tree.nearest(&Ray::new(DVec3::new(1.0, 1.0, 2.0), DVec3::Z)).is_none());
        assert!(tree.nearest(&Ray::new(DVec3::new(-1.0, 1.0, 0.0), DVec3::X)).is_none());
        assert!(
            TriangleTree::new(&[])
                .nearest(&Ray::new(DVec3::ZERO, DVec3::X))
                .is_none()
        );
    }
}
