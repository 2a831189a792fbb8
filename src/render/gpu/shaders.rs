//! The permutation table: which files make the shader of a strategy, an amplification and a pass.
//!
//! WGSL has no includes; a permutation is the constants that it shares with Rust (`constants.rs`) and the concatenation
//! of its files. A test validates every row without a GPU.

pub use super::passes::{GeometryPass, SCREEN_PASSES, ScreenPass};
pub use super::primitives::{AMPLIFICATIONS, Amplification};

use super::constants;
use crate::scene::Strategy;

/// One shader module.
#[derive(Debug, Clone, Copy)]
pub enum Permutation {
    /// A geometry pass under a strategy.
    Geometry(Strategy, &'static Amplification, &'static GeometryPass),
    /// The compute stage of [`Strategy::Compute`].
    Amplify(&'static Amplification),
    /// A pass over the screen.
    Screen(&'static ScreenPass),
}

impl Permutation {
    /// Every module that a renderer can ask for.
    pub fn all() -> Vec<Self> {
        let mut all: Vec<Self> = SCREEN_PASSES.map(Self::Screen).to_vec();
        for amplification in AMPLIFICATIONS {
            if amplification.compute_amplifies {
                all.push(Self::Amplify(amplification));
            }
            for pass in amplification.passes {
                let of_strategy = |&strategy| Self::Geometry(strategy, amplification, pass);
                all.extend(Strategy::ALL.iter().map(of_strategy));
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
            Self::Screen(pass) => format!("screen/{}", pass.name),
        }
    }

    /// The complete WGSL source.
    pub fn source(self) -> String {
        let mut texts = vec![constants::shared()];
        match self {
            Self::Geometry(_, amplification, _) | Self::Amplify(amplification) => {
                let vertices_per_record = amplification.vertices_per_record;
                texts.push(constants::of_amplification(vertices_per_record));
            }
            Self::Screen(_) => {}
        }
        texts.extend(self.files().into_iter().map(str::to_owned));
        texts.join("\n")
    }

    fn files(self) -> Vec<&'static str> {
        let mut files = vec![include_str!("../../../shaders/common/view.wgsl")];
        match self {
            Self::Geometry(strategy, amplification, pass) => {
                files.extend(AMPLIFYING);
                if strategy == Strategy::Compute && amplification.compute_amplifies {
                    files.push(include_str!("../../../shaders/fetch/compute.wgsl"));
                } else {
                    files.push(fetch(strategy, amplification));
                    files.extend(amplification.wgsl);
                }
                files.push(include_str!("../../../shaders/common/varyings.wgsl"));
                files.push(pass.wgsl);
            }
            Self::Amplify(amplification) => {
                files.extend(AMPLIFYING);
                files.push(include_str!("../../../shaders/fetch/storage.wgsl"));
                files.extend(amplification.wgsl);
                files.push(include_str!("../../../shaders/passes/amplify.wgsl"));
            }
            Self::Screen(pass) => {
                files.push(include_str!("../../../shaders/common/fullscreen.wgsl"));
                files.push(pass.wgsl);
            }
        }
        files
    }
}

/// What records become vertices with.
const AMPLIFYING: [&str; 3] = [
    include_str!("../../../shaders/common/records.wgsl"),
    include_str!("../../../shaders/common/light.wgsl"),
    include_str!("../../../shaders/common/quads.wgsl"),
];

fn fetch(strategy: Strategy, amplification: &Amplification) -> &'static str {
    match strategy {
        Strategy::Storage | Strategy::Compute => {
            include_str!("../../../shaders/fetch/storage.wgsl")
        }
        Strategy::Uniform => include_str!("../../../shaders/fetch/uniform.wgsl"),
        Strategy::Texture => include_str!("../../../shaders/fetch/texture.wgsl"),
        Strategy::Vertex if amplification.reads_shapes => {
            include_str!("../../../shaders/fetch/vertex.wgsl")
        }
        Strategy::Vertex => include_str!("../../../shaders/fetch/vertex_points.wgsl"),
    }
}
