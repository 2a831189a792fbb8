//! Attribute pass: sums colours and weights of what passes the depth test against the visibility pass (paper 000 §V-B,
//! second pass; normalised sums instead of ordered blending, as in paper 002, so that no order is needed).

use super::{ACCUMULATION_FORMAT, DepthUse, PassState, target};

pub(super) fn state() -> PassState {
    let add = wgpu::BlendComponent {
        src_factor: wgpu::BlendFactor::One,
        dst_factor: wgpu::BlendFactor::One,
        operation: wgpu::BlendOperation::Add,
    };
    PassState {
        color: Some(target(
            ACCUMULATION_FORMAT,
            Some(wgpu::BlendState {
                color: add,
                alpha: add,
            }),
        )),
        depth: Some(DepthUse::TestOnly),
    }
}
