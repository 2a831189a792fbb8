//! What a pass is: a row that says what it draws into, and how depths and colours get there.

use crate::render::gpu::targets::{DEPTH_FORMAT, Precision, Source, Target};

/// A pass over records.
#[derive(Debug)]
pub struct GeometryPass {
    /// No other pass has the same.
    pub name: &'static str,
    /// A file of `shaders/passes/`: what fragments leave.
    pub(in crate::render::gpu) wgsl: &'static str,
    /// `None` where only depths are drawn.
    pub(in crate::render::gpu) color: Option<ColorUse>,
    pub(in crate::render::gpu) depth: Option<DepthUse>,
}

/// A pass over the whole target.
#[derive(Debug)]
pub struct ScreenPass {
    /// No other pass has the same.
    pub name: &'static str,
    /// A file of `shaders/passes/`.
    pub(in crate::render::gpu) wgsl: &'static str,
    /// The texture that it reads.
    pub(in crate::render::gpu) source: Option<Source>,
    pub(in crate::render::gpu) color: ColorUse,
    pub(in crate::render::gpu) depth: Option<DepthUse>,
}

/// What colours are drawn into, and how.
#[derive(Debug, Clone, Copy)]
pub(in crate::render::gpu) struct ColorUse {
    pub(in crate::render::gpu) target: Target,
    /// `None` where they replace what is there.
    pub(super) blend: Option<wgpu::BlendState>,
}

/// What a pass does with the depth buffer. Reverse-Z: nearer is greater.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::render::gpu) enum DepthUse {
    /// A pass over records clears it first.
    TestAndWrite,
    TestOnly,
}

impl GeometryPass {
    /// Whether depths are tested.
    pub fn has_depths(&self) -> bool {
        self.depth.is_some()
    }

    /// The file of `shaders/entries/` by which that gets into the targets; where fragments write depths, with these.
    pub(in crate::render::gpu) fn entry(&self, writes_depths: bool) -> &'static str {
        match (self.color.map(|color| color.target), writes_depths) {
            (None, false) => include_str!("../../../../shaders/entries/nothing.wgsl"),
            (None, true) => include_str!("../../../../shaders/entries/depths.wgsl"),
            (Some(Target::Surfaces), false) => include_str!("../../../../shaders/entries/surfaces.wgsl"),
            (Some(Target::Surfaces), true) => include_str!("../../../../shaders/entries/surfaces_and_depths.wgsl"),
            (Some(_), false) => include_str!("../../../../shaders/entries/colors.wgsl"),
            (Some(_), true) => include_str!("../../../../shaders/entries/colors_and_depths.wgsl"),
        }
    }
}

impl ColorUse {
    /// One for each texture that is drawn into.
    pub(super) fn target_states(&self, precision: Precision) -> Vec<Option<wgpu::ColorTargetState>> {
        let state = |&format| {
            Some(wgpu::ColorTargetState {
                format,
                blend: self.blend,
                write_mask: wgpu::ColorWrites::ALL,
            })
        };
        self.target.formats(precision).iter().map(state).collect()
    }
}

impl DepthUse {
    pub(super) fn state(self) -> wgpu::DepthStencilState {
        wgpu::DepthStencilState {
            format: DEPTH_FORMAT,
            depth_write_enabled: Some(self == Self::TestAndWrite),
            depth_compare: Some(wgpu::CompareFunction::GreaterEqual),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        }
    }
}

/// Adds colours, and weights.
pub(super) const ADDED: wgpu::BlendState = {
    let add = wgpu::BlendComponent {
        src_factor: wgpu::BlendFactor::One,
        dst_factor: wgpu::BlendFactor::One,
        operation: wgpu::BlendOperation::Add,
    };
    wgpu::BlendState { color: add, alpha: add }
};

/// Adds as much as is missing to make the fourth channel 1.
pub(super) const COMPLETED: wgpu::BlendState = {
    let complete = wgpu::BlendComponent {
        src_factor: wgpu::BlendFactor::OneMinusDstAlpha,
        dst_factor: wgpu::BlendFactor::One,
        operation: wgpu::BlendOperation::Add,
    };
    wgpu::BlendState {
        color: complete,
        alpha: complete,
    }
};

/// The fourth channel stays: the picture's opacity, or the sum of weights.
const KEPT: wgpu::BlendComponent = wgpu::BlendComponent {
    src_factor: wgpu::BlendFactor::Zero,
    dst_factor: wgpu::BlendFactor::One,
    operation: wgpu::BlendOperation::Add,
};

/// Colours over what is there.
pub(super) const OVER: wgpu::BlendState = wgpu::BlendState {
    color: wgpu::BlendState::ALPHA_BLENDING.color,
    alpha: KEPT,
};

/// Colours times their opacities, and opacities, over what is there.
pub(super) const PREMULTIPLIED: wgpu::BlendState = wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING;

/// Multiplies what is there.
pub(super) const MULTIPLIED: wgpu::BlendState = wgpu::BlendState {
    color: wgpu::BlendComponent {
        src_factor: wgpu::BlendFactor::Dst,
        dst_factor: wgpu::BlendFactor::Zero,
        operation: wgpu::BlendOperation::Add,
    },
    alpha: KEPT,
};
