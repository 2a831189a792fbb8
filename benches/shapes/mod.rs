//! The clouds that stage benches run on, the same on every machine, the threads they run on, and the allocator that
//! the program has.

use glam::{DVec3, Vec3};

pub(crate) mod memory;
pub(crate) mod threads;

/// A torus with bumps, sampled at random and in random order, with colours that differ from point to point: a closed
/// surface whose density and curvature vary, and the worst order for memory.
pub(crate) fn bumpy_torus(count: usize) -> (Vec<Vec3>, Vec<[u8; 4]>) {
    let mut state = 1;
    (0..count as u32)
        .map(|index| {
            let (ring, turn) = (angle(&mut state), angle(&mut state));
            let tube = 0.4 + 0.03 * (9.0 * ring).sin() * (7.0 * turn).cos();
            let outwards = Vec3::new(ring.cos(), ring.sin(), 0.0);
            let position = outwards + (outwards * turn.cos() + Vec3::Z * turn.sin()) * tube;
            (position, index.wrapping_mul(0x9e37_79b9).to_le_bytes())
        })
        .unzip()
}

/// The outward unit normals of the points of [`bumpy_torus`], from its derivatives.
#[allow(dead_code, reason = "most benches need none")]
pub(crate) fn bumpy_torus_normals(count: usize) -> Vec<Vec3> {
    let mut state = 1;
    (0..count)
        .map(|_| {
            let (ring, turn) = (angle(&mut state), angle(&mut state));
            let (ring, turn) = (f64::from(ring), f64::from(turn));
            let outwards = DVec3::new(ring.cos(), ring.sin(), 0.0);
            let along_ring = DVec3::new(-ring.sin(), ring.cos(), 0.0);
            let across = outwards * turn.cos() + DVec3::Z * turn.sin();
            let along_turn = DVec3::Z * turn.cos() - outwards * turn.sin();
            let tube = 0.4 + 0.03 * (9.0 * ring).sin() * (7.0 * turn).cos();
            let by_ring = 0.27 * (9.0 * ring).cos() * (7.0 * turn).cos();
            let by_turn = -0.21 * (9.0 * ring).sin() * (7.0 * turn).sin();
            let ring_tangent = along_ring * (1.0 + tube * turn.cos()) + across * by_ring;
            let turn_tangent = along_turn * tube + across * by_turn;
            ring_tangent.cross(turn_tangent).normalize().as_vec3()
        })
        .collect()
}

/// splitmix64, as an angle.
fn angle(state: &mut u64) -> f32 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    let unit = ((z ^ (z >> 31)) >> 40) as f32 / (1u32 << 24) as f32;
    unit * std::f32::consts::TAU
}
