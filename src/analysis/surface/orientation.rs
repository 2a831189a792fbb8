//! Normal orientation: turning normals to one side of the surface.
//!
//! How it works: after Hoppe et al. (1992), the sign of a normal spreads over the minimum spanning tree of the
//! neighbourhood graph, so that it crosses the surface where it is least in doubt. Two things differ from the textbook.
//!
//! *Mirroring.* Where the surface bends between two points, comparing their normals says little: at the edge of a
//! cube they are perpendicular, and across a thin sheet they look alike but face opposite ways. So the normal of one
//! point is first mirrored at the plane midway between the two (Xie et al. 2003), as a circular arc through both would
//! do. An edge along the tangent planes leaves the normal as it is, and the weight is the usual `1 − |n·n'|`. An edge
//! along the normals is the least trustworthy, as noise looks like that too, and comes last.
//!
//! *No tree is built.* Kruskal's algorithm joins components in the order of their weights; each point stores whether
//! its normal agrees with that of its parent in the union-find forest. When all edges are in, every point knows its
//! sign relative to the root of its component. Weights are sorted by counting in 1024 steps (an angle of 2.5 degrees is
//! one step from none), and edges of the first step, nearly all on a smooth surface, need not even be stored.
//!
//! The sign of a component is decided where the outside is certain: at its six extreme points along the axes a closed
//! surface must face that way. An open surface has no outside; it turns its convex side out, by all of its points, so
//! that scans of one scene have the same sign in every frame.
//!
//! When it wins: it is exact for closed surfaces that are sampled densely enough for neighbours to lie on one sheet.

use crate::analysis::search::neighbours::Neighbours;
use crate::analysis::search::point_tree::{LANES, PointTree, SlotPoint};
use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// Turns the normals of consecutive slots to the half-space of `sensor`, in scene units.
pub(in crate::analysis) fn face_sensor(tree: &PointTree, sensor: Vec3, first_slot: usize, normals: &mut [Vec3]) {
    let sensor = sensor / tree.unit();
    for (normal, point) in normals.iter_mut().zip(&tree.points()[first_slot..]) {
        if normal.dot(sensor - point.position) < 0.0 {
            *normal = -*normal;
        }
    }
}

/// Makes normals (by slot) agree over the neighbourhood graph, and every component of it face outwards.
pub(in crate::analysis) fn face_outwards(tree: &PointTree, neighbours: &Neighbours, normals: &mut [Vec3]) {
    let edges = weigh_edges(tree.points(), neighbours, normals);
    let mut signs = SignForest::new(tree.len());
    join_by_weight(&edges, neighbours, &mut signs);

    // From here on by root: the sign of every point relative to its root, then one vote per component.
    let resolved: Vec<Signed> = (0..tree.len() as u32).map(|slot| signs.find(slot)).collect();
    for (normal, sign) in normals.iter_mut().zip(&resolved) {
        if sign.flipped {
            *normal = -*normal;
        }
    }
    let inwards = components_facing_inwards(tree.points(), &resolved, normals);
    for (normal, sign) in normals.iter_mut().zip(&resolved) {
        if inwards[sign.root as usize] {
            *normal = -*normal;
        }
    }
}

/// One in this many points represents those around it: two rings of buckets on a surface, few enough that most lie on
/// one sheet.
const POINTS_PER_REPRESENTATIVE: usize = 8 * LANES;

/// Orients normals (by slot) to agree with those of representatives, which agree over their own neighbourhood graph and
/// face outwards.
///
/// Each row of buckets is represented by its central point. The forest over a sixty-fourth of the points takes a
/// sixty-fourth of the time and memory of [`face_outwards`], and the rest is one visit per point. It fails for points
/// whose representative is on another sheet: thin walls, and creases sharper than rows are wide.
pub(in crate::analysis) fn face_as_representatives(tree: &PointTree, k: usize, normals: &mut [Vec3]) {
    let points = tree.points();
    let centers: Vec<usize> = points
        .par_chunks(POINTS_PER_REPRESENTATIVE)
        .enumerate()
        .map(|(row, points)| row * POINTS_PER_REPRESENTATIVE + center_of(points))
        .collect();
    let positions: Vec<Vec3> = centers.iter().map(|&slot| points[slot].position).collect();
    let own: Vec<Vec3> = centers.iter().map(|&slot| normals[slot]).collect();
    let representatives = PointTree::new(&positions);
    let mut facing = representatives.to_slot_order(&own);
    let neighbours = representatives.neighbours(k);
    face_outwards(&representatives, &neighbours, &mut facing);
    let facing = representatives.to_file_order(&facing);
    normals
        .par_chunks_mut(POINTS_PER_REPRESENTATIVE)
        .zip(points.par_chunks(POINTS_PER_REPRESENTATIVE))
        .zip(positions.par_iter().zip(&facing))
        .for_each(|((normals, points), (&position, &facing))| {
            for (normal, point) in normals.iter_mut().zip(points) {
                if disagree(weigh(point.position - position, facing, *normal)) {
                    *normal = -*normal;
                }
            }
        });
}

/// Returns the index of the point nearest to the centroid of all. Precondition: there is one.
fn center_of(points: &[SlotPoint]) -> usize {
    let sum: Vec3 = points.iter().map(|point| point.position).sum();
    let mean = sum / points.len() as f32;
    let distances = points.iter().map(|point| point.position.distance_squared(mean));
    let nearest = distances.enumerate().min_by(|a, b| a.1.total_cmp(&b.1));
    nearest.map_or(0, |(place, _)| place)
}

/// Weight in steps above one bit that is set if the two normals disagree.
type Edge = u16;

/// Steps that the weight 1 is divided into.
const STEPS: f32 = 1024.0;

fn edge(weight: f32, disagree: bool) -> Edge {
    // Weight 1 falls into the last step.
    ((weight * STEPS).min(STEPS - 1.0) as Edge) << 1 | Edge::from(disagree)
}

fn step_of(edge: Edge) -> usize {
    usize::from(edge >> 1)
}

fn disagree(edge: Edge) -> bool {
    edge & 1 == 1
}

/// The edges to all neighbours of all points, laid out like the neighbours.
fn weigh_edges(points: &[SlotPoint], neighbours: &Neighbours, normals: &[Vec3]) -> Vec<Edge> {
    let per_point = neighbours.per_point();
    let mut edges = vec![0; points.len() * per_point];
    if per_point == 0 {
        return edges;
    }
    edges
        .par_chunks_mut(per_point)
        .enumerate()
        .with_min_len(1 << 9)
        .for_each(|(slot, edges)| {
            for (edge, &other) in edges.iter_mut().zip(neighbours.of(slot)) {
                let other = other as usize;
                *edge = weigh(
                    points[other].position - points[slot].position,
                    normals[slot],
                    normals[other],
                );
            }
        });
    edges
}

fn weigh(offset: Vec3, a: Vec3, b: Vec3) -> Edge {
    let length_squared = offset.length_squared();
    let inverse = if length_squared > 0.0 {
        1.0 / length_squared
    } else {
        0.0
    };
    let (along_a, along_b) = (offset.dot(a), offset.dot(b));
    // dot(a mirrored at the bisecting plane, b)
    let agreement = a.dot(b) - 2.0 * along_a * along_b * inverse;
    let in_plane = 1.0 - 0.5 * (along_a * along_a + along_b * along_b) * inverse;
    edge((1.0 - agreement.abs() * in_plane).max(0.0), agreement < 0.0)
}

/// Kruskal's algorithm over edges that are sorted by their step.
fn join_by_weight(edges: &[Edge], neighbours: &Neighbours, signs: &mut SignForest) {
    let per_point = neighbours.per_point();
    if per_point == 0 {
        return;
    }
    // Most neighbours are mutual, so one direction of the first step joins nearly all of a smooth surface.
    let joins_at_once = |slot: u32, other: u32, edge: Edge| step_of(edge) == 0 && slot < other;
    let all = || {
        edges.chunks(per_point).zip(0u32..).flat_map(|(edges, slot)| {
            let others = neighbours.of(slot as usize);
            edges.iter().zip(others).map(move |(&edge, &other)| (slot, other, edge))
        })
    };
    for (slot, other, edge) in all() {
        if joins_at_once(slot, other, edge) {
            signs.join(slot, other, disagree(edge));
        }
    }
    signs.flatten();
    let left: Vec<(u32, u32, Edge)> = all()
        .filter(|&(slot, other, edge)| !joins_at_once(slot, other, edge) && signs.parent(slot) != signs.parent(other))
        .collect();
    for (slot, other, edge) in sorted_by_step(&left) {
        signs.join(slot, other, disagree(edge));
    }
}

/// A counting sort; equal steps stay in their order.
fn sorted_by_step(edges: &[(u32, u32, Edge)]) -> Vec<(u32, u32, Edge)> {
    let mut places = vec![0; STEPS as usize];
    for &(_, _, edge) in edges {
        places[step_of(edge)] += 1;
    }
    let mut start = 0;
    for place in &mut places {
        start += std::mem::replace(place, start);
    }
    let mut sorted = vec![(0, 0, 0); edges.len()];
    for &edge in edges {
        let place: &mut usize = &mut places[step_of(edge.2)];
        sorted[*place] = edge;
        *place += 1;
    }
    sorted
}

/// A union-find forest in which every point knows whether its normal has to be flipped to agree with its parent's.
struct SignForest {
    /// Parent above the flip bit; roots are their own parents, others come after theirs.
    links: Vec<u32>,
}

/// Signed position of a point in its component.
#[derive(Debug, Clone, Copy)]
struct Signed {
    root: u32,
    /// The normal has to be flipped to agree with the root's.
    flipped: bool,
}

impl SignForest {
    fn new(count: usize) -> Self {
        Self {
            links: (0..count as u32).map(|slot| slot << 1).collect(),
        }
    }

    /// Makes every parent a root. Parents come before their children, so one pass is enough.
    fn flatten(&mut self) {
        for slot in 0..self.links.len() {
            let link = self.links[slot];
            self.links[slot] = self.links[(link >> 1) as usize] ^ (link & 1);
        }
    }

    fn parent(&self, slot: u32) -> u32 {
        self.links[slot as usize] >> 1
    }

    fn find(&mut self, slot: u32) -> Signed {
        let mut at = slot;
        let mut flip = 0;
        loop {
            let link = self.links[at as usize];
            let parent = link >> 1;
            if parent == at {
                return Signed {
                    root: at,
                    flipped: flip == 1,
                };
            }
            // Point to the grandparent, so that paths halve each time they are walked.
            let shorter = self.links[parent as usize] ^ (link & 1);
            self.links[at as usize] = shorter;
            flip ^= shorter & 1;
            at = shorter >> 1;
        }
    }

    /// Joins two components, if they are two, so that the normals of `a` and `b` disagree or not.
    fn join(&mut self, a: u32, b: u32, disagree: bool) {
        let (a, b) = (self.find(a), self.find(b));
        if a.root == b.root {
            return;
        }
        let flip = u32::from(a.flipped ^ b.flipped ^ disagree);
        let (low, high) = (a.root.min(b.root), a.root.max(b.root));
        self.links[high as usize] = low << 1 | flip;
    }
}

/// Agreement of six extreme points, of 6 at most, from which on they decide before all others: a closed surface has
/// nearly all of it, an open one as much as chance gives. And from which on they decide where nothing else does, as
/// where an outlier has moved the centroid out of the surface: a flat surface has next to none.
const DECISIVE: f32 = 3.0;
const LIKELY: f32 = 1.0;

/// Share by which normals away from the centroid outnumber those towards it, or the other way round, from which on a
/// surface is bent rather than flat and noisy.
const BENT: f64 = 0.1;

/// Share of a direction along a normal below which there is only rounding.
const UNDECIDED: f64 = 1e-3;

/// Share of a unit normal along an axis that is certain.
const CERTAIN: f64 = 0.1;

/// Sums over the points of a component, which decide its sign.
#[derive(Debug, Clone, Default)]
struct Component {
    /// Smallest and largest point along each axis.
    extremes: [[u32; 2]; 3],
    count: f64,
    position_sum: DVec3,
    normal_sum: DVec3,
    /// Normals away from the centroid less those towards it.
    outwards: f64,
}

impl Component {
    fn add(&mut self, slot: u32, points: &[SlotPoint], normal: Vec3) {
        let position = points[slot as usize].position;
        if self.count == 0.0 {
            self.extremes = [[slot; 2]; 3];
        }
        for (axis, [lowest, highest]) in self.extremes.iter_mut().enumerate() {
            if position[axis] < points[*lowest as usize].position[axis] {
                *lowest = slot;
            }
            if position[axis] > points[*highest as usize].position[axis] {
                *highest = slot;
            }
        }
        self.count += 1.0;
        self.position_sum += position.as_dvec3();
        self.normal_sum += normal.as_dvec3();
    }

    /// Counts a point, once all are added. Votes are equal: an outlier that is joined to a surface does not outweigh
    /// it.
    fn vote(&mut self, position: Vec3, normal: Vec3) {
        let from_centroid = position.as_dvec3() - self.position_sum / self.count;
        let along = from_centroid.dot(normal.as_dvec3());
        if along.abs() > UNDECIDED * from_centroid.length() {
            self.outwards += along.signum();
        }
    }

    /// Returns true if the component faces inwards.
    fn faces_inwards(&self, normals: &[Vec3]) -> bool {
        let extremes = [0, 1, 2].map(|axis| self.extremes[axis].map(|slot| slot as usize));
        let outwards: f32 = (0..3)
            .map(|axis| {
                let [lowest, highest] = extremes[axis].map(|slot| normals[slot][axis]);
                highest - lowest
            })
            .sum();
        if outwards.abs() >= DECISIVE {
            return outwards < 0.0;
        }
        if self.outwards.abs() > BENT * self.count {
            return self.outwards < 0.0;
        }
        if outwards.abs() >= LIKELY {
            return outwards < 0.0;
        }
        let [x, y, z] = (self.normal_sum / self.count).to_array();
        [z, y, x]
            .into_iter()
            .find(|component| component.abs() > CERTAIN)
            .is_some_and(|component| component < 0.0)
    }
}

/// For each root, whether its component faces inwards.
///
/// A closed surface faces outwards at its extreme points. An open one, as a scan of the ground and the walls around the
/// sensor, turns the convex side of the whole out: most normals point away from its centroid, which does not change
/// from frame to frame as a few extreme points do. A flat one faces the positive side of the last axis it can.
fn components_facing_inwards(points: &[SlotPoint], resolved: &[Signed], normals: &[Vec3]) -> Vec<bool> {
    let mut places = vec![u32::MAX; points.len()];
    let mut components: Vec<Component> = Vec::new();
    for ((sign, normal), slot) in resolved.iter().zip(normals).zip(0u32..) {
        let place = &mut places[sign.root as usize];
        if *place == u32::MAX {
            *place = components.len() as u32;
            components.push(Component::default());
        }
        components[*place as usize].add(slot, points, *normal);
    }
    for (sign, (point, normal)) in resolved.iter().zip(points.iter().zip(normals)) {
        let place = places[sign.root as usize];
        components[place as usize].vote(point.position, *normal);
    }
    let inwards: Vec<bool> = components
        .iter()
        .map(|component| component.faces_inwards(normals))
        .collect();
    // Only roots have a place.
    places
        .into_iter()
        .map(|place| inwards.get(place as usize).copied().unwrap_or(false))
        .collect()
}
