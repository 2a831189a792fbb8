//! The clouds that stage benches run on, the same on every machine, and the allocator that the program has.

use glam::Vec3;

pub(crate) mod memory;

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

/// splitmix64, as an angle.
fn angle(state: &mut u64) -> f32 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    let unit = ((z ^ (z >> 31)) >> 40) as f32 / (1u32 << 24) as f32;
    unit * std::f32::consts::TAU
}
