//! Render passes: a pass is a row with the targets that it draws into, and the handling of depths and colours.

use crate::render::gpu::part::{Part, Uniform};
use crate::render::gpu::targets::{DEPTH_FORMAT, Precision, Source, Target, TextureKind};
use crate::render::gpu::wgsl::{ShaderFile, shader_file};
use std::fmt::Write;

/// A pass over records.
#[derive(Debug)]
pub struct GeometryPass {
    /// No other pass has the same.
    pub name: &'static str,
    /// Fragment output file, in `shaders/passes/`.
    pub(in crate::render::gpu) file: ShaderFile,
    /// `None` where only depths are drawn.
    pub(in crate::render::gpu) color: Option<ColorUse>,
    pub(in crate::render::gpu) depth: Option<DepthUse>,
}

/// A pass over the whole target.
#[derive(Debug)]
pub struct ScreenPass {
    /// No other pass has the same.
    pub name: &'static str,
    /// WGSL files of the pass, in addition to their imports.
    pub(in crate::render) files: &'static [ShaderFile],
    /// Parts that Rust provides to these files.
    pub(in crate::render) parts: &'static [&'static Part],
    /// The textures that it reads.
    pub(in crate::render) source: Option<Source>,
    pub(in crate::render) color: ColorUse,
    pub(in crate::render) depth: Option<DepthUse>,
}

/// Colour target and blending.
#[derive(Debug, Clone, Copy)]
pub(in crate::render) struct ColorUse {
    pub(in crate::render) target: Target,
    /// `None` if they replace the existing values.
    pub(in crate::render) blend: Option<wgpu::BlendState>,
}

impl ColorUse {
    /// Colours replace the contents of `target`.
    pub(in crate::render) const fn replacing(target: Target) -> Self {
        Self { target, blend: None }
    }
}

/// Depth buffer usage of a pass. Reverse-Z: nearer is greater.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::render) enum DepthUse {
    /// A pass over records clears it first.
    TestAndWrite,
    TestOnly,
}

impl GeometryPass {
    /// Returns true if depths are tested.
    pub fn has_depths(&self) -> bool {
        self.depth.is_some()
    }

    /// The file of `shaders/entries/` by which that gets into the targets; where fragments write depths, with these.
    pub(in crate::render::gpu) fn entry(&self, writes_depths: bool) -> ShaderFile {
        match (self.color.map(|color| color.target), writes_depths) {
            (None, false) => shader_file!("entries/nothing.wgsl"),
            (None, true) => shader_file!("entries/depths.wgsl"),
            (Some(Target::Surfaces), false) => shader_file!("entries/surfaces.wgsl"),
            (Some(Target::Surfaces), true) => shader_file!("entries/surfaces_and_depths.wgsl"),
            (Some(_), false) => shader_file!("entries/colors.wgsl"),
            (Some(_), true) => shader_file!("entries/colors_and_depths.wgsl"),
        }
    }
}

impl ScreenPass {
    /// The textures that it reads, by the names that its WGSL has for them, in the order of their bindings. After them
    /// comes one uniform with those of all parts: lavapipe crashes if a group has several.
    pub(in crate::render::gpu) fn textures(&self) -> Vec<(&'static str, TextureKind)> {
        self.source.map(Source::textures).unwrap_or_default()
    }

    /// The uniforms of its parts, in the order in which they are members of the one that is bound.
    pub(in crate::render::gpu) fn uniforms(&self) -> impl Iterator<Item = &'static Uniform> + use<> {
        self.parts.iter().filter_map(|part| part.uniform.as_ref())
    }

    /// Bytes of the uniform that is bound; 0 if there is none.
    pub(in crate::render::gpu) fn uniform_bytes(&self) -> u64 {
        self.uniforms().map(|uniform| uniform.layout.size as u64).sum()
    }

    /// The WGSL that its files get from Rust.
    pub(in crate::render::gpu) fn declarations(&self) -> String {
        let mut text = "#import generated/constants\n".to_owned();
        for part in self.parts {
            text += &(part.constants)();
            text.push('\n');
        }
        let textures = self.textures().into_iter();
        let textures = textures.map(|(name, kind)| format!("var {name}: {}", kind.wgsl()));
        for (binding, variable) in textures.enumerate() {
            // Writing to a String cannot fail.
            let _ = writeln!(text, "@group(SOURCE_GROUP) @binding({binding}) {variable};");
        }
        if self.uniforms().next().is_none() {
            return text;
        }
        let mut members = String::new();
        for uniform in self.uniforms() {
            text += &uniform.layout.declaration();
            let _ = writeln!(members, "    @align(16) {}: {},", uniform.name, uniform.layout.name);
        }
        let binding = self.textures().len();
        let _ = writeln!(
            text,
            "struct Parts {{\n{members}}}\n@group(SOURCE_GROUP) @binding({binding}) var<uniform> parts: Parts;"
        );
        text
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
pub(in crate::render) const COMPLETED: wgpu::BlendState = {
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

/// The fourth channel stays: the image's opacity, or the sum of weights.
const CACHED: wgpu::BlendComponent = wgpu::BlendComponent {
    src_factor: wgpu::BlendFactor::Zero,
    dst_factor: wgpu::BlendFactor::One,
    operation: wgpu::BlendOperation::Add,
};

/// Alpha blending: colours over the existing ones.
pub(in crate::render) const OVER: wgpu::BlendState = wgpu::BlendState {
    color: wgpu::BlendState::ALPHA_BLENDING.color,
    alpha: CACHED,
};

/// Alpha blending of premultiplied colours: colours times their opacities, and opacities, over the existing ones.
pub(super) const PREMULTIPLIED: wgpu::BlendState = wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING;

/// Multiplies the existing colours.
pub(in crate::render) const MULTIPLIED: wgpu::BlendState = wgpu::BlendState {
    color: wgpu::BlendComponent {
        src_factor: wgpu::BlendFactor::Dst,
        dst_factor: wgpu::BlendFactor::Zero,
        operation: wgpu::BlendOperation::Add,
    },
    alpha: CACHED,
};
