//! Its pass.

use crate::render::constants::{COARSE_LINES, FINE_LINES, NARROWEST_CELL_PX, USUAL_LINES, WIDEST_CELL_PX};
use crate::render::gpu::constants::declared;
use crate::render::gpu::layout::{Shared, shared_struct};
use crate::render::gpu::part::{Part, Uniform};
use crate::render::gpu::passes::{ColorUse, DepthUse, OVER, ScreenPass};
use crate::render::gpu::targets::Target;
use crate::render::gpu::wgsl::shader_file;
use crate::scene::ScenePacket;
use bytemuck::Zeroable;

/// Lines on the ground, laid over the image where nothing is in front of them.
pub(super) const PASS: ScreenPass = ScreenPass {
    name: "grid",
    files: &[shader_file!("effects/grid.wgsl")],
    parts: &[&PART],
    source: None,
    color: ColorUse {
        target: Target::Picture,
        blend: Some(OVER),
    },
    depth: Some(DepthUse::TestOnly),
};

const PART: Part = Part {
    constants: || declared![COARSE_LINES, FINE_LINES, NARROWEST_CELL_PX, USUAL_LINES, WIDEST_CELL_PX,],
    uniform: Some(Uniform {
        name: "grid",
        layout: &GridUniform::LAYOUT,
        bytes: |packet| bytemuck::bytes_of(&uniform(packet)).to_vec(),
    }),
};

shared_struct! {
    /// The plane with lines, in view space.
    GridUniform as "Grid" {
        /// Its normal, and how far along that it is from the eye.
        normal: [f32; 4],
        /// A direction across the lines, and how far along it the point is where two of them cross.
        right: [f32; 4],
        /// The other direction.
        forward: [f32; 4],
        /// Line colour; the fourth component is the distance from that point up to which lines are seen, scene units.
        color: [f32; 4],
        /// Between two lines, scene units.
        spacing: f32,
        /// Pixels drawn per pixel shown, along both edges of the image.
        samples_per_edge: f32,
        /// Padding.
        unused: [f32; 2],
    }
}

fn uniform(packet: &ScenePacket) -> GridUniform {
    let Some(ground) = packet.ground.map(|ground| ground.seen_by(&packet.view)) else {
        return GridUniform::zeroed();
    };
    let [right, forward] = [0, 1].map(|axis: usize| ground.axes[axis].extend(ground.point_along_axes[axis]).to_array());
    let [red, green, blue] = ground.color;
    GridUniform {
        normal: ground.normal.extend(ground.height).to_array(),
        right,
        forward,
        color: [red, green, blue, ground.reach],
        spacing: ground.spacing,
        samples_per_edge: packet.style.drawing.antialiasing.samples_per_edge() as f32,
        unused: [0.0; 2],
    }
}
