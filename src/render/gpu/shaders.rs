//! The permutation table: which files make the shader of a strategy, an amplification and a pass.
//!
//! They are put together in `wgsl.rs`. A test validates every row without a GPU.

pub use super::passes::{GeometryPass, SCREEN_PASSES, ScreenPass};
pub use super::primitives::{AMPLIFICATIONS, Amplification};

use super::{depth_images, gather, instancing, stereo, visible, wgsl};
use crate::scene::Strategy;

/// One shader module.
#[derive(Debug, Clone, Copy)]
pub enum Permutation {
    /// A geometry pass under a strategy.
    Geometry(Strategy, &'static Amplification, &'static GeometryPass),
    /// The compute stage of [`Strategy::Compute`].
    Amplify(&'static Amplification),
    /// The pass that gathers the records of selected nodes.
    Gather,
    /// The same of those of a sequence, which it tests.
    Filter,
    /// The passes that make surfels of the screen.
    Visible,
    /// The passes that filter depth images and make points of them.
    DepthImages,
    /// The passes that match pairs of photographs.
    Stereo,
    /// A pass over the screen.
    Screen(&'static ScreenPass),
}

impl Permutation {
    /// Every module that a renderer can ask for.
    pub fn all() -> Vec<Self> {
        let mut all: Vec<Self> = SCREEN_PASSES.map(Self::Screen).to_vec();
        all.extend([
            Self::Gather,
            Self::Filter,
            Self::Visible,
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
            Self::DepthImages => "depth images".to_owned(),
            Self::Stereo => "stereo".to_owned(),
            Self::Screen(pass) => format!("screen/{}", pass.name),
        }
    }

    /// The complete WGSL source. If the adapter `tests_depths_early`, fragments that write depths say that they are
    /// none that is nearer than their quads.
    pub fn source(self, tests_depths_early: bool) -> String {
        match self {
            Self::Geometry(strategy, amplification, pass) => {
                let mut files = instancing::vertex_wgsl(strategy, amplification);
                let writes_depths = amplification.writes_depths && pass.depth.is_some();
                let entry = pass.entry(writes_depths);
                // Reversed: what is less is farther.
                let early = "@fragment\n@early_depth_test(less_equal)";
                let entry = if writes_depths && tests_depths_early {
                    &entry.replace("@fragment", early)
                } else {
                    entry
                };
                let fragments = include_str!("../../../shaders/common/fragments.wgsl");
                files.extend([amplification.varyings, fragments, pass.wgsl, entry]);
                wgsl::of_records(amplification, &files)
            }
            Self::Amplify(amplification) => instancing::compute_source(amplification),
            Self::Gather => gather::source(),
            Self::Filter => gather::filter_source(),
            Self::Visible => visible::source(),
            Self::DepthImages => depth_images::source(),
            Self::Stereo => stereo::source(),
            Self::Screen(pass) => wgsl::of_screen(pass.wgsl),
        }
    }
}
