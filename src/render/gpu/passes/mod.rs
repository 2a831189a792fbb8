//! The passes. Each file says what its pass draws into and under which depth and blend state; `pipelines.rs` makes the
//! pipelines from that, once each.

mod attribute;
mod eye_dome;
mod grid;
mod pipelines;
mod point;
mod resolve;
mod solid;
mod splat;
mod visibility;

pub(super) use pipelines::{GeometryKey, Pipelines};

use super::shaders::{GeometryPass, ScreenPass};
use super::targets::{ACCUMULATION_FORMAT, COLOR_FORMAT, DEPTH_FORMAT};

/// Fixed-function state of a pass.
#[derive(Debug, Clone)]
pub(super) struct PassState {
    color: Option<wgpu::ColorTargetState>,
    depth: Option<DepthUse>,
}

/// What a pass does with the depth buffer. Reverse-Z: nearer is greater.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum DepthUse {
    TestAndWrite,
    TestOnly,
}

impl PassState {
    fn depth_stencil(&self) -> Option<wgpu::DepthStencilState> {
        self.depth.map(|depth| wgpu::DepthStencilState {
            format: DEPTH_FORMAT,
            depth_write_enabled: Some(depth == DepthUse::TestAndWrite),
            depth_compare: Some(wgpu::CompareFunction::GreaterEqual),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        })
    }
}

fn target(format: wgpu::TextureFormat, blend: Option<wgpu::BlendState>) -> wgpu::ColorTargetState {
    wgpu::ColorTargetState {
        format,
        blend,
        write_mask: wgpu::ColorWrites::ALL,
    }
}

/// Colours over what is there; the picture stays opaque.
fn over() -> wgpu::BlendState {
    wgpu::BlendState {
        color: wgpu::BlendState::ALPHA_BLENDING.color,
        alpha: wgpu::BlendComponent {
            src_factor: wgpu::BlendFactor::Zero,
            dst_factor: wgpu::BlendFactor::One,
            operation: wgpu::BlendOperation::Add,
        },
    }
}

pub(super) fn geometry_state(pass: GeometryPass) -> PassState {
    match pass {
        GeometryPass::Visibility => visibility::state(),
        GeometryPass::Attribute => attribute::state(),
        GeometryPass::Regular => splat::regular_state(),
        GeometryPass::NoDepth => splat::no_depth_state(),
        GeometryPass::Solid => solid::state(),
        GeometryPass::Point | GeometryPass::RoundPoint => point::state(),
    }
}

fn screen_state(pass: ScreenPass) -> PassState {
    match pass {
        ScreenPass::Background => PassState {
            color: Some(target(COLOR_FORMAT, None)),
            depth: None,
        },
        ScreenPass::Resolve | ScreenPass::DepthView => resolve::state(),
        ScreenPass::EyeDome => eye_dome::state(),
        ScreenPass::EyeDomeOfSums => eye_dome::of_sums_state(),
        ScreenPass::Grid => grid::state(),
    }
}
