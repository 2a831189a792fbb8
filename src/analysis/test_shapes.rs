//! Sampled shapes with known normals, for tests.

use glam::Vec3;

/// Well-mixed numbers from a seed (splitmix64), the same on every machine.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn next_bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ z >> 31
    }

    /// Evenly in 0..1.
    pub(crate) fn unit(&mut self) -> f32 {
        (self.next_bits() >> 40) as f32 / (1u32 << 24) as f32
    }

    /// Evenly in −1..1 on each axis.
    pub(crate) fn cube(&mut self) -> Vec3 {
        Vec3::new(self.unit(), self.unit(), self.unit()) * 2.0 - 1.0
    }
}

/// Points with their outward normals.
#[derive(Default, Clone)]
pub(crate) struct Sampled {
    pub(crate) positions: Vec<Vec3>,
    pub(crate) normals: Vec<Vec3>,
}

impl Sampled {
    fn push(&mut self, position: Vec3, normal: Vec3) {
        self.positions.push(position);
        self.normals.push(normal);
    }

    pub(crate) fn moved(mut self, by: Vec3) -> Self {
        for position in &mut self.positions {
            *position += by;
        }
        self
    }

    pub(crate) fn and(mut self, other: Self) -> Self {
        self.positions.extend(other.positions);
        self.normals.extend(other.normals);
        self
    }
}

/// Evenly at random on the unit sphere.
pub(crate) fn sphere(count: usize, random: &mut Random) -> Sampled {
    let mut sampled = Sampled::default();
    while sampled.positions.len() < count {
        let inside = random.cube();
        if (0.01..1.0).contains(&inside.length_squared()) {
            let normal = inside.normalize();
            sampled.push(normal, normal);
        }
    }
    sampled
}

/// Evenly at random on a torus around z with radii 1 and `tube`.
pub(crate) fn torus(count: usize, tube: f32, random: &mut Random) -> Sampled {
    let mut sampled = Sampled::default();
    while sampled.positions.len() < count {
        let (ring, turn) = (
            random.unit() * std::f32::consts::TAU,
            random.unit() * std::f32::consts::TAU,
        );
        // The outer side has a larger area.
        if random.unit() * (1.0 + tube) > 1.0 + tube * turn.cos() {
            continue;
        }
        let outwards = Vec3::new(ring.cos(), ring.sin(), 0.0);
        let normal = outwards * turn.cos() + Vec3::Z * turn.sin();
        sampled.push(outwards + normal * tube, normal);
    }
    sampled
}

/// Evenly at random on the faces of a box with these half edges.
pub(crate) fn cuboid(count: usize, half_edges: Vec3, random: &mut Random) -> Sampled {
    let [x, y, z] = half_edges.to_array();
    let areas = [y * z, x * z, x * y];
    let total: f32 = areas.iter().sum();
    let mut sampled = Sampled::default();
    for _ in 0..count {
        let mut pick = random.unit() * total;
        let mut axis = 0;
        while axis < 2 && pick > areas[axis] {
            pick -= areas[axis];
            axis += 1;
        }
        let sign = if random.unit() < 0.5 { -1.0 } else { 1.0 };
        let mut normal = Vec3::ZERO;
        normal[axis] = sign;
        let mut position = random.cube();
        position[axis] = sign;
        sampled.push(position * half_edges, normal);
    }
    sampled
}
