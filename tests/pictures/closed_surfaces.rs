//! Disks close the surfaces they are estimated from: rays at shapes whose surface is known find no holes, or next to
//! none, and with disks a third smaller they do.
//!
//! A ray goes through a position on the true surface along its true normal. It finds a hole if it hits no disk near
//! that place: beyond the disk's radius there may be another part of the surface. Disks are as large as a Voronoi cell
//! reaches, so that lattices must have no holes at all; among points at random a few cells are cut off wrongly, because
//! more neighbours than there are in a list take part in them.
//!
//! For real frames, whose surface is unknown, see `tests/files/real_frames.rs`.

#![expect(
    clippy::print_stdout,
    reason = "a test fails by panicking, in its helpers too; what was measured, for `--nocapture`"
)]

use glam::Vec3;
use pointreel::analysis::{NormalBasis, Orientation, Surface, estimate_surface, nearest_neighbours};
use std::f32::consts::TAU;

/// Points whose disks may cover a position, the nearest ones; excluding those farther away can only make more holes.
const AROUND: usize = 24;

/// Rays at each shape.
const RAYS: usize = 20_000;

/// Disks that see the ray from farther than this off their normal (cosine) are seen from their edge.
const EDGE_ON: f32 = 0.2;

/// Rays that find a hole: none where points are in a lattice.
const OPEN_LATTICE: f64 = 0.0;

/// The same for random points: fewer than one in a thousand.
const OPEN_RANDOM: f64 = 1e-3;

/// Rays that must find a hole when disks are smaller by a third: more than come with the random ones at full size.
const OPEN_SHRUNK: f64 = 5e-3;

/// Well-mixed numbers from a seed (splitmix64).
struct Random(u64);

impl Random {
    fn unit(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 40) as f32 / (1u32 << 24) as f32
    }
}

/// A surface over the unit square, with positions spread evenly over its area.
#[derive(Debug, Clone, Copy)]
enum Shape {
    /// Sphere of radius 1.
    Sphere,
    /// Torus of radii 1 and 0.4.
    Torus,
}

const TUBE: f32 = 0.4;

/// A position on a surface and the normal there.
type Place = (Vec3, Vec3);

impl Shape {
    /// The position at two parameters in 0..1; equal areas of parameters are equal areas of the sphere, of the torus
    /// only nearly.
    fn place(self, u: f32, v: f32) -> Place {
        let (sine, cosine) = (u * TAU).sin_cos();
        match self {
            Self::Sphere => {
                let z = 1.0 - 2.0 * v;
                let ring = (1.0 - z * z).max(0.0).sqrt();
                let normal = Vec3::new(ring * cosine, ring * sine, z);
                (normal, normal)
            }
            Self::Torus => {
                let outwards = Vec3::new(cosine, sine, 0.0);
                let (rise, reach) = (v * TAU).sin_cos();
                let normal = outwards * reach + Vec3::Z * rise;
                (outwards + normal * TUBE, normal)
            }
        }
    }

    /// `count` random positions.
    fn scattered(self, count: usize, random: &mut Random) -> Vec<Place> {
        let mut places = Vec::with_capacity(count);
        while places.len() < count {
            let (u, v) = (random.unit(), random.unit());
            let is_retained = match self {
                Self::Sphere => true,
                // The outer side has a larger area.
                Self::Torus => random.unit() * (1.0 + TUBE) < 1.0 + TUBE * (v * TAU).cos(),
            };
            if is_retained {
                places.push(self.place(u, v));
            }
        }
        places
    }

    /// About `count` positions in rows: a spiral of the golden angle on the sphere (Swinbank and Purser 2006), a grid
    /// that is square at the centre of the torus.
    fn regular(self, count: usize) -> Vec<Place> {
        match self {
            Self::Sphere => (0..count)
                .map(|index| {
                    let turn = (index as f64 * 0.618_033_988_749_895).fract() as f32;
                    self.place(turn, (index as f32 + 0.5) / count as f32)
                })
                .collect(),
            Self::Torus => {
                let around = (count as f32 * TUBE).sqrt() as usize;
                let along = count / around;
                let steps = (0..along).flat_map(|i| (0..around).map(move |j| (i, j)));
                steps
                    .map(|(i, j)| self.place(i as f32 / along as f32, j as f32 / around as f32))
                    .collect()
            }
        }
    }
}

/// Fractions of rays through `places` that hit no disk of each of `scales` times its radius.
fn open_shares<const N: usize>(positions: &[Vec3], surface: &Surface, places: &[Place], scales: [f32; N]) -> [f64; N] {
    // Finds the nearest points of each position as its neighbours among points and positions: there are few positions
    // compared with the requested neighbours.
    let mut holes = [0u32; N];
    for chunk in places.chunks(places.len().div_ceil(PARTS)) {
        let both: Vec<Vec3> = positions
            .iter()
            .copied()
            .chain(chunk.iter().map(|place| place.0))
            .collect();
        let lists = nearest_neighbours(&both, AROUND);
        for (index, &(place, direction)) in chunk.iter().enumerate() {
            let near = lists.of(positions.len() + index);
            for (holes, scale) in holes.iter_mut().zip(scales) {
                let is_covered = near
                    .iter()
                    .map(|&disk| disk as usize)
                    .filter(|&disk| disk < positions.len())
                    .any(|disk| {
                        let (normal, radius) = (surface.normals[disk], scale * surface.radii[disk]);
                        let offset = positions[disk] - place;
                        let slope = normal.dot(direction);
                        let along = normal.dot(offset) / slope;
                        slope.abs() > EDGE_ON
                            && along.abs() <= radius
                            && (direction * along - offset).length_squared() <= radius * radius
                    });
                *holes += u32::from(!is_covered);
            }
        }
    }
    holes.map(|holes| f64::from(holes) / places.len() as f64)
}

/// Parts that rays are shot in, so that they do not crowd the points out of each other's lists.
const PARTS: usize = 5;

/// Holds samples of `shape` together against both bounds.
fn check(name: &str, shape: Shape, samples: &[Vec<Vec3>], max_open: f64) {
    let mut random = Random(99);
    let mut shares = [0.0, 0.0];
    for positions in samples {
        let places = shape.scattered(RAYS / samples.len(), &mut random);
        let surface = estimate_surface(positions, None);
        let open = open_shares(positions, &surface, &places, [1.0, 2.0 / 3.0]);
        for (share, open) in shares.iter_mut().zip(open) {
            *share += open / samples.len() as f64;
        }
    }
    let [open, shrunk] = shares;
    println!(
        "{name}: {:.4} % open, {:.2} % with disks a third smaller",
        100.0 * open,
        100.0 * shrunk
    );
    assert!(open <= max_open, "{open} of {name} is open");
    assert!(shrunk >= OPEN_SHRUNK, "smaller disks would do for {name}: {shrunk}");
}

const SHAPES: [Shape; 2] = [Shape::Sphere, Shape::Torus];
/// Points on each.
const COUNTS: [usize; 3] = [2_000, 5_000, 25_000];

/// Points of random samples together: one cell that is cut off wrongly is more than one of 2000 parts of the surface,
/// so that a few random points say little.
const POINTS_OF_SAMPLES: usize = 25_000;

fn positions_of(places: &[Place]) -> Vec<Vec3> {
    places.iter().map(|place| place.0).collect()
}

/// Samples of `count` points, enough to make [`POINTS_OF_SAMPLES`].
fn samples(count: usize, sample: impl FnMut() -> Vec<Vec3>) -> Vec<Vec<Vec3>> {
    std::iter::repeat_with(sample).take(POINTS_OF_SAMPLES / count).collect()
}

#[test]
fn regular_points_leave_no_hole() {
    for shape in SHAPES {
        for count in COUNTS {
            let name = format!("{shape:?}, {count} in rows");
            let positions = positions_of(&shape.regular(count));
            check(&name, shape, &[positions], OPEN_LATTICE);
        }
    }
}

#[test]
fn random_points_leave_almost_no_holes() {
    let mut random = Random(1);
    for shape in SHAPES {
        for count in COUNTS {
            let name = format!("{shape:?}, {count} at random");
            let samples = samples(count, || positions_of(&shape.scattered(count, &mut random)));
            check(&name, shape, &samples, OPEN_RANDOM);
        }
    }
}

/// Points up to a tenth of their mean distance off the surface.
#[test]
fn noisy_points_leave_almost_no_holes() {
    let mut random = Random(2);
    for shape in SHAPES {
        for count in COUNTS {
            let area = match shape {
                Shape::Sphere => 2.0 * TAU,
                Shape::Torus => TAU * TAU * TUBE,
            };
            let off = 0.1 * (area / count as f32).sqrt();
            let samples = samples(count, || {
                let mut positions = Vec::with_capacity(count);
                for (place, normal) in shape.scattered(count, &mut random) {
                    positions.push(place + normal * (off * (2.0 * random.unit() - 1.0)));
                }
                positions
            });
            let name = format!("{shape:?}, {count} with noise");
            check(&name, shape, &samples, OPEN_RANDOM);
        }
    }
}

/// The count of holes is itself checked: one disk over a plane is hit within its radius, from its edge and beyond it is
/// not.
#[test]
fn rays_distinguish_disks_from_holes() {
    let surface = Surface {
        normals: vec![Vec3::Z],
        orientation: Orientation::Neighbours,
        radii: vec![1.0],
        without_plane: Vec::new(),
        basis: NormalBasis::default(),
    };
    let up = Vec3::Z;
    let share = |place: Vec3, direction: Vec3| {
        let [share] = open_shares(&[Vec3::ZERO], &surface, &[(place, direction.normalize())], [1.0]);
        share
    };
    assert_eq!(share(Vec3::new(0.99, 0.0, 0.0), up), 0.0);
    assert_eq!(share(Vec3::new(1.01, 0.0, 0.0), up), 1.0);
    assert_eq!(share(Vec3::new(0.0, 0.0, 1.01), up), 1.0, "another part of the surface");
    assert_eq!(share(Vec3::ZERO, Vec3::new(1.0, 0.0, 0.1)), 1.0, "from its edge");
}
