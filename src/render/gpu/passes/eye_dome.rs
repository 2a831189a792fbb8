//! Eye-dome lighting: what is drawn so far is multiplied with the shade of each pixel (Boucheny 2009).
//!
//! What the attribute pass left is shaded before it is resolved: so the background that shines through at the rims of
//! splats keeps its colour, as all of the background does.

use super::{ACCUMULATION_FORMAT, COLOR_FORMAT, PassState, target};

/// Multiplies colours; the fourth channel, opacity or the sum of weights, stays.
const MULTIPLIED: wgpu::BlendState = wgpu::BlendState {
    color: wgpu::BlendComponent {
        src_factor: wgpu::BlendFactor::Dst,
        dst_factor: wgpu::BlendFactor::Zero,
        operation: wgpu::BlendOperation::Add,
    },
    alpha: wgpu::BlendComponent {
        src_factor: wgpu::BlendFactor::Zero,
        dst_factor: wgpu::BlendFactor::One,
        operation: wgpu::BlendOperation::Add,
    },
};

pub(super) fn state() -> PassState {
    PassState {
        color: Some(target(COLOR_FORMAT, Some(MULTIPLIED))),
        depth: None,
    }
}

pub(super) fn of_sums_state() -> PassState {
    PassState {
        color: Some(target(ACCUMULATION_FORMAT, Some(MULTIPLIED))),
        depth: None,
    }
}
