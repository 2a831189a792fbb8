//! The permutation table: which files make the shader of a strategy, an amplification and a pass.
//!
//! They import others (`wgsl.rs`). A test validates every row without a GPU.

pub use super::layout::{Layout, Member};
pub use super::passes::{GeometryPass, ScreenPass};
pub use super::primitives::{AMPLIFICATIONS, Amplification};
pub use super::wgsl::{ImportError, ShaderFile};

use super::gather_program::{FILTER, GATHER};
use super::passes::screen::SCREEN_PASSES;
use super::wgsl::assembled;
use super::{coded, depth_images, instancing, stereo, visible};
use crate::render::effects::EFFECTS;
use crate::scene::Strategy;

/// All passes over the screen.
pub fn screen_passes() -> impl Iterator<Item = &'static ScreenPass> {
    let of_effects = EFFECTS.iter().flat_map(|effect| effect.passes);
    SCREEN_PASSES.into_iter().chain(of_effects.copied())
}

/// The structures of their uniforms.
pub fn uniform_layouts() -> impl Iterator<Item = &'static Layout> {
    let uniforms = screen_passes().flat_map(ScreenPass::uniforms);
    uniforms.map(|uniform| uniform.layout)
}

/// One shader module.
#[derive(Debug, Clone, Copy)]
pub enum Permutation {
    /// A geometry pass under a strategy.
    Geometry(Strategy, &'static Amplification, &'static GeometryPass),
    /// The compute stage of [`Strategy::Compute`].
    Amplify(&'static Amplification),
    /// The pass that gathers the records of selected nodes.
    Gather,
    /// The pass that gathers the records of the nodes of a sequence, which it tests.
    Filter,
    /// The passes that make surfels of the screen.
    Visible,
    /// The passes that traverse and decode a byte code.
    Coded,
    /// The passes that filter depth images and make points of them.
    DepthImages,
    /// The stereo matching passes.
    Stereo,
    /// A pass over the screen.
    Screen(&'static ScreenPass),
}

impl Permutation {
    /// Every module that a renderer can request.
    pub fn all() -> Vec<Self> {
        let mut all: Vec<Self> = screen_passes().map(Self::Screen).collect();
        all.extend([
            Self::Gather,
            Self::Filter,
            Self::Visible,
            Self::Coded,
            Self::DepthImages,
            Self::Stereo,
        ]);
        for amplification in AMPLIFICATIONS {
            if amplification.compute_amplifies {
                all.push(Self::Amplify(amplification));
            }
            for pass in amplification.passes {
                let of_strategy = |&strategy| Self::Geometry(strategy, amplification, pass);
                let strategies = Strategy::ALL
                    .iter()
                    .filter(|&&strategy| amplification.strategy(strategy) == strategy);
                all.extend(strategies.map(of_strategy));
            }
        }
        all
    }

    /// A name for error messages and debuggers.
    pub fn label(self) -> String {
        match self {
            Self::Geometry(strategy, amplification, pass) => {
                format!("{strategy}/{}/{}", amplification.name, pass.name)
            }
            Self::Amplify(amplification) => format!("amplify/{}", amplification.name),
            Self::Gather => "gather".to_owned(),
            Self::Filter => "filter".to_owned(),
            Self::Visible => "visible".to_owned(),
            Self::Coded => "byte code".to_owned(),
            Self::DepthImages => "depth images".to_owned(),
            Self::Stereo => "stereo".to_owned(),
            Self::Screen(pass) => format!("screen/{}", pass.name),
        }
    }

    /// The complete WGSL source. If the adapter `tests_depths_early`, fragments that write depths say that they are
    /// none that is nearer than their quads.
    pub fn source(self, tests_depths_early: bool) -> Result<String, ImportError> {
        match self {
            Self::Geometry(strategy, amplification, pass) => {
                let mut files = instancing::vertex_files(strategy, amplification);
                let writes_depths = amplification.writes_depths && pass.depth.is_some();
                files.extend([amplification.varyings, pass.file, pass.entry(writes_depths)]);
                let source = assembled(&[amplification.given()], &files)?;
                // Without this declaration, a shader that writes depth moves the depth test behind the shader.
                Ok(if writes_depths && tests_depths_early {
                    // Reversed: smaller is farther.
                    source.replace("@fragment", "@fragment\n@early_depth_test(less_equal)")
                } else {
                    source
                })
            }
            Self::Amplify(amplification) => instancing::amplifying_source(amplification),
            Self::Gather => GATHER.source(),
            Self::Filter => FILTER.source(),
            Self::Visible => visible::SHADER.source(),
            Self::Coded => coded::SHADER.source(),
            Self::DepthImages => depth_images::SHADER.source(),
            Self::Stereo => stereo::SHADER.source(),
            Self::Screen(pass) => assembled(&[("generated/bindings", pass.declarations())], pass.files),
        }
    }
}
