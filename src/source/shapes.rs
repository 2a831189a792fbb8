//! Surfaces with a formula: sampled like a scan, but known exactly, so that errors can be measured.
//!
//! Points are spread evenly at random over the area, as scans are nearly; each shape has its seed, so that every
//! machine measures the same points. Noise moves a point by a normal deviate along each axis.

use super::opener::Made;
use super::{FrameEntry, FrameList};
use crate::cloud::{Positions, RawCloud};
use glam::{DVec2, DVec3, Vec3};
use std::f32::consts::TAU;
use std::path::Path;
use std::sync::Arc;

/// Points of a shape when their number is not given.
const USUAL_POINTS: usize = 100_000;

/// Maximum number of points of a shape.
const MAX_POINTS: usize = 50_000_000;

/// One frame of a shape: `torus:` or `torus:20000`.
pub(super) const SHAPES: Made = Made {
    has_word: |word| Shape::named(word).is_some(),
    said: || {
        let names = Shape::ALL.map(Shape::name).join(", ");
        format!("a shape ({names}) and 1 to {MAX_POINTS} points, such as torus:100000")
    },
    make: |name, count| {
        let (shape, points) = counted(name, count)?;
        Some(Arc::new(shape.frame(points)))
    },
};

/// A shape and the number of its points, by the text before and after a colon.
pub(super) fn counted(name: &str, count: &str) -> Option<(Shape, usize)> {
    let points = match count {
        "" => USUAL_POINTS,
        count => count.parse().ok().filter(|count| (1..=MAX_POINTS).contains(count))?,
    };
    Some((Shape::named(name)?, points))
}

/// Surfaces of different difficulty.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    /// Equally curved everywhere; radius 1.
    Sphere,
    /// Curved in both directions; radii 1 and 0.4.
    Torus,
    /// Flat, with edges at which no normal is right for all neighbours; from −1 to 1.
    Cube,
    /// z = x² − y² over −1 to 1: hollow in both directions, and with an edge.
    Saddle,
}

/// One point in this many is an outlier, if there are any.
pub(crate) const OUTLIERS: usize = 20;

/// Standard deviation of an outlier along each axis, as a part of the diameter: about twice the distance between points
/// of the sphere, so that it is a neighbour of others.
const OUTLIER_DEVIATION: f32 = 0.03;

/// Points with their normals.
#[derive(Debug, Clone, Default)]
pub(crate) struct Sampled {
    pub(crate) positions: Vec<Vec3>,
    pub(crate) normals: Vec<Vec3>,
}

impl Shape {
    /// Radius of the tube of the torus.
    pub(crate) const TUBE: f32 = 0.4;

    /// Every shape.
    pub const ALL: [Self; 4] = [Self::Sphere, Self::Torus, Self::Cube, Self::Saddle];

    /// The word for it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Sphere => "sphere",
            Self::Torus => "torus",
            Self::Cube => "cube",
            Self::Saddle => "saddle",
        }
    }

    fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|shape| shape.name() == name)
    }

    /// The shape that `input` names, as in `torus:20000`; `None` of other inputs.
    pub fn of_input(input: &Path) -> Option<Self> {
        let (name, count) = input.to_str()?.split_once(':')?;
        counted(name, count).map(|(shape, _)| shape)
    }

    /// The largest distance between two of its points.
    fn diameter(self) -> f32 {
        match self {
            Self::Sphere => 2.0,
            Self::Torus => 2.0 * (1.0 + Self::TUBE),
            Self::Cube => 12f32.sqrt(),
            Self::Saddle => 8f32.sqrt(),
        }
    }

    /// `count` points with the normals of where they were before `noise` moved them: its standard deviation along each
    /// axis as a part of the diameter.
    pub(crate) fn sample(self, count: usize, noise: f32) -> Sampled {
        self.sample_of_scan(count, noise, 0)
    }

    /// [`Shape::sample`] of one scan of several, each with other points.
    fn sample_of_scan(self, count: usize, noise: f32, scan: u32) -> Sampled {
        let mut random = Random((u64::from(scan) << 32) + 0x5eed + self as u64);
        let mut sampled = Sampled::default();
        while sampled.positions.len() < count {
            if let Some((position, normal)) = self.draw(&mut random) {
                sampled.positions.push(position);
                sampled.normals.push(normal);
            }
        }
        let deviation = noise * self.diameter();
        for position in &mut sampled.positions {
            *position += deviation * random.normal_deviates();
        }
        sampled
    }

    /// Moves one point in [`OUTLIERS`] off the surface, by a normal deviate along each axis of [`OUTLIER_DEVIATION`] of
    /// the diameter.
    pub(crate) fn scatter(self, sampled: &mut Sampled) {
        let mut random = Random(0x0ff + self as u64);
        let deviation = OUTLIER_DEVIATION * self.diameter();
        for position in sampled.positions.iter_mut().step_by(OUTLIERS) {
            *position += deviation * random.normal_deviates();
        }
    }

    /// One point with its normal, or none where the surface has less area than by its parameters.
    fn draw(self, random: &mut Random) -> Option<(Vec3, Vec3)> {
        match self {
            Self::Sphere => {
                let direction = random.normal_deviates().normalize_or_zero();
                (direction != Vec3::ZERO).then_some((direction, direction))
            }
            Self::Torus => {
                let [ring, turn] = [random.unit() * TAU, random.unit() * TAU];
                let is_retained = random.unit() * (1.0 + Self::TUBE) < 1.0 + Self::TUBE * turn.cos();
                let outwards = Vec3::new(ring.cos(), ring.sin(), 0.0);
                let normal = outwards * turn.cos() + Vec3::Z * turn.sin();
                is_retained.then_some((outwards + normal * Self::TUBE, normal))
            }
            Self::Cube => {
                let face = ((random.unit() * 6.0) as usize).min(5);
                let mut normal = Vec3::ZERO;
                normal[face % 3] = if face < 3 { 1.0 } else { -1.0 };
                let mut position = Vec3::from_array([(); 3].map(|()| 2.0 * random.unit() - 1.0));
                position[face % 3] = normal[face % 3];
                Some((position, normal))
            }
            Self::Saddle => {
                let [x, y] = [(); 2].map(|()| 2.0 * random.unit() - 1.0);
                let across = Vec3::new(-2.0 * x, 2.0 * y, 1.0);
                // Its length is the ratio of the surface area to its projection, at most 3, the value at the corners.
                let is_retained = random.unit() * 3.0 < across.length();
                is_retained.then(|| (Vec3::new(x, y, x * x - y * y), across.normalize()))
            }
        }
    }
}

impl Shape {
    /// Mean distance between neighbouring points of a sample of `count`.
    pub(crate) fn spacing(self, count: usize) -> f32 {
        let area = match self {
            Self::Sphere => 2.0 * TAU,
            Self::Torus => TAU * TAU * Self::TUBE,
            Self::Cube => 24.0,
            // By integration.
            Self::Saddle => 7.446,
        };
        (area / count.max(1) as f32).sqrt()
    }

    /// The unit normal, outwards or upwards, at a place on it.
    pub(crate) fn normal_at(self, position: DVec3) -> DVec3 {
        match self {
            Self::Sphere => position.normalize(),
            Self::Torus => {
                let center = (position * DVec3::new(1.0, 1.0, 0.0)).normalize();
                (position - center).normalize()
            }
            Self::Cube => {
                let axis = position.abs().max_position();
                DVec3::AXES[axis] * position[axis].signum()
            }
            Self::Saddle => DVec3::new(-2.0 * position.x, 2.0 * position.y, 1.0).normalize(),
        }
    }

    /// Returns true if a position on the surface, unbounded as its formula has it, is within the bounds of the shape;
    /// rounding errors of up to 1e-9 are tolerated.
    pub(crate) fn is_within(self, position: DVec3) -> bool {
        const MAX: f64 = 1.0 + 1e-9;
        match self {
            Self::Sphere | Self::Torus => true,
            Self::Cube => position.abs().max_element() <= MAX,
            Self::Saddle => DVec2::new(position.x, position.y).abs().max_element() <= MAX,
        }
    }

    /// Red, green and blue at a place: soft waves of a few periods, so that blurring shows.
    pub(crate) fn color_at(position: DVec3) -> [u8; 3] {
        let waves = (position * DVec3::new(7.0, 6.0, 5.0)).to_array().map(f64::sin);
        let pattern = waves[0] * waves[1] + waves[1] * waves[2] + waves[2] * waves[0];
        let channel = |phase: f64| 140.0 + 90.0 * (1.5 * pattern + phase).sin();
        [0.0, 2.1, 4.2].map(|phase| channel(phase) as u8)
    }

    /// One frame of `count` points, with normals and colours.
    pub fn frame(self, count: usize) -> FrameList {
        let entry = FrameEntry::embedded(format!("shape/{}", self.name()), &[]);
        FrameList::new(vec![entry], move |_, _| Ok(self.cloud(count)))
    }

    /// `count` points with normals and colours.
    pub(crate) fn cloud(self, count: usize) -> RawCloud {
        self.scan(count, 0)
    }

    /// Scan number `scan` of the shape at rest: `count` points, not those of the other scans, with normals and colours.
    pub(crate) fn scan(self, count: usize, scan: u32) -> RawCloud {
        let Sampled { positions, normals } = self.sample_of_scan(count, 0.0, scan);
        let color = |position: &Vec3| {
            let [red, green, blue] = Self::color_at(position.as_dvec3());
            [red, green, blue, 255]
        };
        let mut cloud = RawCloud::from_positions(Positions::F32(positions.iter().map(Vec3::to_array).collect()));
        cloud.attributes.colors = Some(positions.iter().map(color).collect());
        cloud.attributes.normals = Some(normals.iter().map(Vec3::to_array).collect());
        cloud
    }
}

/// Well-mixed numbers from a seed (splitmix64), the same on every machine.
struct Random(u64);

impl Random {
    /// Evenly in 0..1.
    fn unit(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 40) as f32 / (1u32 << 24) as f32
    }

    /// Three numbers of mean 0 and variance 1 (Box and Muller 1958).
    fn normal_deviates(&mut self) -> Vec3 {
        Vec3::from_array([(); 3].map(|()| {
            // In the half-open interval from 1 down to 0, so that the logarithm is defined.
            let radius = (-2.0 * (1.0 - self.unit()).ln()).sqrt();
            radius * (TAU * self.unit()).cos()
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_on_their_surface_and_normals_perpendicular() {
        for shape in Shape::ALL {
            let Sampled { positions, normals } = shape.sample(5_000, 0.0);
            assert_eq!((positions.len(), normals.len()), (5_000, 5_000));
            // The implicit function of each shape, 0 on it, and its gradient by differences.
            let height = |p: Vec3| match shape {
                Shape::Sphere => p.length() - 1.0,
                Shape::Torus => (p.truncate().length() - 1.0).hypot(p.z) - Shape::TUBE,
                Shape::Cube => p.abs().max_element() - 1.0,
                Shape::Saddle => p.z - p.x * p.x + p.y * p.y,
            };
            for (&position, &normal) in positions.iter().zip(&normals) {
                assert!(height(position).abs() < 1e-5, "{} at {position}", shape.name());
                let gradient = Vec3::from_array(
                    [Vec3::X, Vec3::Y, Vec3::Z]
                        .map(|axis| height(position + axis * 1e-3) - height(position - axis * 1e-3)),
                );
                // Finite differences cross an edge that is closer than their step.
                let near_faces = position.abs().cmpgt(Vec3::splat(0.998));
                let is_at_edge = shape == Shape::Cube && near_faces.bitmask().count_ones() > 1;
                assert!(
                    is_at_edge || gradient.normalize().dot(normal) > 0.999,
                    "{} at {position}: {normal} for {gradient}",
                    shape.name()
                );
                assert!(normal.is_normalized());
            }
        }
    }

    #[test]
    fn points_are_spread_evenly() {
        // Mean of x² over the area: 1/3 for the sphere; (4 · 1/3 + 2 · 1) / 6 for the cube; the torus and the saddle by
        // integration.
        let expected = |shape: Shape| match shape {
            Shape::Sphere => 1.0 / 3.0,
            Shape::Torus => integral_of_x_squared(|turn| {
                let radius = 1.0 + Shape::TUBE * (turn * TAU).cos();
                (radius, 0.5 * radius * radius)
            }),
            Shape::Cube => 5.0 / 9.0,
            Shape::Saddle => saddle_x_squared(),
        };
        for shape in Shape::ALL {
            let positions = shape.sample(40_000, 0.0).positions;
            let mean = positions.iter().map(|p| p.x * p.x).sum::<f32>() / positions.len() as f32;
            let expected = expected(shape);
            // Four standard errors.
            assert!(
                (mean - expected).abs() < 0.01 * shape.diameter(),
                "{}: {mean} for {expected}",
                shape.name()
            );
        }
    }

    /// Mean of a quantity over a parameter in 0..1, weighted by area: both by `at`.
    fn integral_of_x_squared(at: impl Fn(f32) -> (f32, f32)) -> f32 {
        let steps = (0..1000).map(|step| at((step as f32 + 0.5) / 1000.0));
        let (area, sum) = steps.fold((0.0, 0.0), |(area, sum), (weight, value)| {
            (area + weight, sum + weight * value)
        });
        sum / area
    }

    fn saddle_x_squared() -> f32 {
        integral_of_x_squared(|x| {
            let x = 2.0 * x - 1.0;
            let area: f32 = (0..200)
                .map(|y| {
                    let y = (y as f32 + 0.5) / 100.0 - 1.0;
                    (1.0 + 4.0 * (x * x + y * y)).sqrt()
                })
                .sum();
            (area, x * x)
        })
    }

    #[test]
    fn one_point_in_twenty_is_an_outlier() {
        let exact = Shape::Sphere.sample(20_000, 0.0);
        let mut scattered = exact.clone();
        Shape::Sphere.scatter(&mut scattered);
        assert_eq!(exact.normals, scattered.normals);
        let offsets: Vec<Vec3> = exact
            .positions
            .iter()
            .zip(&scattered.positions)
            .map(|(exact, scattered)| *scattered - *exact)
            .filter(|offset| *offset != Vec3::ZERO)
            .collect();
        assert_eq!(offsets.len(), 1000);
        let squares: f32 = offsets.iter().map(|offset| offset.length_squared() / 3.0).sum();
        let deviation = (squares / 1000.0).sqrt();
        assert!((deviation / 0.06 - 1.0).abs() < 0.06, "{deviation}");
    }

    #[test]
    fn noise_has_the_requested_size() {
        let exact = Shape::Torus.sample(20_000, 0.0);
        let noisy = Shape::Torus.sample(20_000, 0.01);
        assert_eq!(exact.normals, noisy.normals);
        let squares: f32 = exact
            .positions
            .iter()
            .zip(&noisy.positions)
            .map(|(exact, noisy)| (*noisy - *exact).length_squared() / 3.0)
            .sum();
        let deviation = (squares / 20_000.0).sqrt();
        assert!((deviation / 0.028 - 1.0).abs() < 0.02, "{deviation}");
    }
}
