//! Shader complexity: the amount of work in the shaders of an image, counted in naga's intermediate representation, as
//! Table 1 of Sainz and Pajarola 2004 counted it in the instructions of its day.
//!
//! **How it works.** From an entry point calls are followed into functions, each counted as often as it is called, as
//! compilers inline them. An operation is an expression that computes something, on numbers or on vectors; names,
//! constants, and the parts of vectors do not count. All branches count, and the body of a loop counts once. So the
//! numbers rank shaders; the number of instructions that a driver makes of them is its own affair.

use super::passes::ScreenPass;
use super::plan::Plan;
use super::shaders::Permutation;
use crate::scene::ScenePacket;
use naga::{AddressSpace, Block, Expression, Function, Handle, Module, ShaderStage, Statement, front};

/// Complexity of one stage per vertex or fragment.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct StageComplexity {
    /// Expressions that work something out.
    pub operations: usize,
    /// Reads from uniform and storage buffers.
    pub buffer_reads: usize,
    /// Reads from textures.
    pub texture_reads: usize,
}

/// Complexity of a render pass.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PassComplexity {
    /// Its name.
    pub pass: &'static str,
    /// For each vertex; the strategy is the packet's.
    pub vertex: StageComplexity,
    /// For each fragment.
    pub fragment: StageComplexity,
}

/// The passes that draw the records of `packet`, then those that finish them over the whole image.
pub fn passes_of(packet: &ScenePacket) -> Vec<PassComplexity> {
    let plan = Plan::new(packet, true);
    let over_records = plan.geometry_keys().map(|key| {
        let permutation = Permutation::Geometry(key.strategy, key.amplification, key.pass);
        of_pass(key.pass.name, permutation)
    });
    let over_screen = |pass: &&'static ScreenPass| of_pass(pass.name, Permutation::Screen(pass));
    over_records
        .chain(plan.finish.iter().map(over_screen))
        .flatten()
        .collect()
}

/// `None` for invalid WGSL, which no permutation is (`tests/pictures/shaders/mod.rs`).
fn of_pass(pass: &'static str, permutation: Permutation) -> Option<PassComplexity> {
    // Naga's representation: instructions differ from driver to driver, and querying a driver for them needs vendor
    // tools.
    let module = front::wgsl::parse_str(&permutation.source(false).ok()?).ok()?;
    Some(PassComplexity {
        pass,
        vertex: of_stage(&module, ShaderStage::Vertex),
        fragment: of_stage(&module, ShaderStage::Fragment),
    })
}

fn of_stage(module: &Module, stage: ShaderStage) -> StageComplexity {
    let mut sum = StageComplexity::default();
    for entry_point in module
        .entry_points
        .iter()
        .filter(|entry_point| entry_point.stage == stage)
    {
        sum.add_function(module, &entry_point.function);
    }
    sum
}

impl StageComplexity {
    fn add_function(&mut self, module: &Module, function: &Function) {
        for (_, expression) in function.expressions.iter() {
            match expression {
                Expression::Unary { .. }
                | Expression::Binary { .. }
                | Expression::Select { .. }
                | Expression::Derivative { .. }
                | Expression::Relational { .. }
                | Expression::Math { .. }
                | Expression::As { .. } => self.operations += 1,
                Expression::ImageSample { .. } | Expression::ImageLoad { .. } => self.texture_reads += 1,
                Expression::Load { pointer } if is_in_buffer(module, function, *pointer) => self.buffer_reads += 1,
                _ => {}
            }
        }
        self.add_calls(module, &function.body);
    }

    fn add_calls(&mut self, module: &Module, block: &Block) {
        for statement in block {
            match statement {
                Statement::Call { function, .. } => self.add_function(module, &module.functions[*function]),
                Statement::Block(block) => self.add_calls(module, block),
                Statement::If { accept, reject, .. } => {
                    self.add_calls(module, accept);
                    self.add_calls(module, reject);
                }
                Statement::Switch { cases, .. } => {
                    for case in cases {
                        self.add_calls(module, &case.body);
                    }
                }
                Statement::Loop { body, continuing, .. } => {
                    self.add_calls(module, body);
                    self.add_calls(module, continuing);
                }
                _ => {}
            }
        }
    }
}

/// Returns true if a pointer leads into a uniform or a storage buffer.
fn is_in_buffer(module: &Module, function: &Function, pointer: Handle<Expression>) -> bool {
    match function.expressions[pointer] {
        Expression::Access { base, .. } | Expression::AccessIndex { base, .. } => is_in_buffer(module, function, base),
        Expression::GlobalVariable(variable) => matches!(
            module.global_variables[variable].space,
            AddressSpace::Uniform | AddressSpace::Storage { .. }
        ),
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::gpu::shaders::screen_passes;
    use crate::scene::Strategy;

    #[test]
    fn operations_and_reads_of_a_shader_match_its_source() {
        let module = front::wgsl::parse_str(
            "@group(0) @binding(0) var<uniform> scale: vec4f;
            @group(0) @binding(1) var picture: texture_2d<f32>;

            fn twice(number: f32) -> f32 {
                return number + number;
            }

            @vertex
            fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
                var place = f32(index);
                if (index > 7u) {
                    place = twice(place) * twice(place);
                }
                return vec4f(place, scale.y, 0.0, 1.0);
            }

            @fragment
            fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
                return textureLoad(picture, vec2u(position.xy), 0) * scale;
            }",
        );
        let module = module.unwrap();
        // A conversion, a comparison, two additions in calls and a product.
        let vertex = StageComplexity {
            operations: 5,
            buffer_reads: 1,
            texture_reads: 0,
        };
        assert_eq!(of_stage(&module, ShaderStage::Vertex), vertex);
        let fragment = StageComplexity {
            operations: 2,
            buffer_reads: 1,
            texture_reads: 1,
        };
        assert_eq!(of_stage(&module, ShaderStage::Fragment), fragment);
        assert_eq!(of_stage(&module, ShaderStage::Compute), StageComplexity::default());
    }

    #[test]
    fn every_permutation_that_is_drawn_is_counted() {
        for permutation in Permutation::all() {
            let (pass, reads) = match permutation {
                Permutation::Geometry(strategy, _, pass) => (pass.name, Some(strategy)),
                Permutation::Screen(pass) => (pass.name, None),
                Permutation::Amplify(_)
                | Permutation::Gather
                | Permutation::Filter
                | Permutation::Visible
                | Permutation::Coded
                | Permutation::DepthImages
                | Permutation::Stereo => continue,
            };
            let counted = of_pass(pass, permutation).unwrap_or_else(|| panic!("{}", permutation.label()));
            assert!(counted.vertex.operations > 0, "{}", permutation.label());
            assert_eq!(
                counted.vertex.texture_reads > 0,
                reads == Some(Strategy::Texture),
                "{}",
                permutation.label()
            );
        }
        for pass in screen_passes() {
            let reads = of_pass(pass.name, Permutation::Screen(pass))
                .unwrap()
                .fragment
                .texture_reads;
            assert_eq!(reads > 0, pass.source.is_some(), "{}", pass.name);
        }
    }
}
