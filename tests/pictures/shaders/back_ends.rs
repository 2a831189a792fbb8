//! Every permutation as wgpu writes it for Vulkan, Metal and Direct3D 12. A machine has one or two of them; naga writes
//! for all.
//!
//! **How it works.** An entry point is cut out of its module and its bindings are numbered as wgpu does it, for the
//! oldest and the newest language that wgpu chooses. Drivers and the compilers of Apple and Microsoft are not tested:
//! they are not available here. Code that one of them is known to refuse has a test of its own.

use super::languages::{write_hlsl, write_msl, write_spirv};
use super::{parse, parse_with};
use naga::back::PipelineConstants;
use naga::back::hlsl::{FragmentEntryPoint, ShaderModel};
use naga::back::pipeline_constants::process_overrides;
use naga::valid::{FunctionInfo, ModuleInfo};
use naga::{AddressSpace, Expression, Function, Module, ShaderStage, TypeInner};
use pointreel::render::gpu::shaders::Permutation;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// An entry point on its own.
pub(super) struct EntryPoint<'a> {
    pub(super) module: &'a Module,
    pub(super) info: &'a ModuleInfo,
    pub(super) stage: ShaderStage,
    pub(super) name: &'a str,
    /// The stage that takes the results of a vertex stage.
    pub(super) fragment: Option<FragmentEntryPoint<'a>>,
    /// The module that it was cut out of: bindings are numbered for all of its entry points.
    pub(super) whole: &'a Module,
}

/// Writes an entry point, or returns why it cannot.
type BackEnd = fn(&EntryPoint<'_>) -> Result<(), String>;

const BACK_ENDS: [(&str, BackEnd); 6] = [
    // Vulkan 1.0 and 1.3.
    ("SPIR-V 1.0", |entry| write_spirv(entry, (1, 0))),
    ("SPIR-V 1.6", |entry| write_spirv(entry, (1, 6))),
    // macOS 10.12 and 26.
    ("MSL 1.2", |entry| write_msl(entry, (1, 2))),
    ("MSL 4.0", |entry| write_msl(entry, (4, 0))),
    // FXC, which is part of Windows, and DXC.
    ("HLSL 5.1", |entry| write_hlsl(entry, ShaderModel::V5_1)),
    ("HLSL 6.9", |entry| write_hlsl(entry, ShaderModel::V6_9)),
];

#[test]
fn every_back_end_writes_every_entry_point() {
    let mut failures = Vec::new();
    for permutation in Permutation::all() {
        let label = permutation.label();
        let (module, info) = parse(permutation).unwrap();
        let has_one_stage = matches!(permutation, Permutation::Gather | Permutation::Filter);
        assert_eq!(module.entry_points.len() == 1, has_one_stage, "{label}");
        for entry in &module.entry_points {
            for (back_end, write) in BACK_ENDS {
                // When naga finds something unexpected in a valid module, it panics.
                let written = catch_unwind(AssertUnwindSafe(|| {
                    write_alone(&module, &info, (entry.stage, &entry.name), write)
                }));
                if let Err(error) = written.unwrap_or_else(|_| Err("naga panics".to_owned())) {
                    failures.push(format!("{label}, {}, {back_end}: {error}", entry.name));
                }
            }
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// Of the languages of adapters, SPIR-V alone has the conservative test of depths.
#[test]
fn depth_writing_shaders_declare_conservative_depth() {
    let permutations = Permutation::all().into_iter();
    let writing = permutations.filter(|permutation| {
        matches!(permutation, Permutation::Geometry(_, amplification, pass)
            if amplification.writes_depths && pass.has_depths())
    });
    let mut written = 0;
    for permutation in writing {
        let (module, info) = parse_with(permutation, true).unwrap();
        let fragment = module
            .entry_points
            .iter()
            .find(|entry| entry.name == "fragment")
            .unwrap();
        let conservative = naga::ConservativeDepth::LessEqual;
        let expected = Some(naga::EarlyDepthTest::Allow { conservative });
        assert_eq!(fragment.early_depth_test, expected, "{}", permutation.label());
        write_alone(&module, &info, (fragment.stage, &fragment.name), |entry| {
            write_spirv(entry, (1, 0))
        })
        .unwrap();
        written += 1;
    }
    assert!(written >= 30, "{written} permutations");
    let without = Permutation::all().into_iter().filter(|permutation| {
        let (module, _) = parse_with(*permutation, true).unwrap();
        module.entry_points.iter().all(|entry| entry.early_depth_test.is_none())
    });
    assert_eq!(without.count() + written, Permutation::all().len());
}

fn write_alone(
    whole: &Module,
    info: &ModuleInfo,
    (stage, name): (ShaderStage, &str),
    write: BackEnd,
) -> Result<(), String> {
    let constants = PipelineConstants::default();
    let (module, info) =
        process_overrides(whole, info, Some((stage, name)), &constants).map_err(|error| error.to_string())?;
    let fragment = FragmentEntryPoint::new(whole, "fragment");
    write(&EntryPoint {
        module: &module,
        info: &info,
        stage,
        name,
        fragment: fragment.filter(|_| stage == ShaderStage::Vertex),
        whole,
    })
}

/// FXC compiles for Direct3D 12 where DXC is not installed, and refuses `v[i] = x` of a vector (error X3500,
/// <https://github.com/gfx-rs/wgpu/issues/4460>).
#[test]
fn no_vector_variable_is_indexed_dynamically() {
    let refused = Permutation::all().into_iter().filter(|&permutation| {
        let (module, info) = parse(permutation).unwrap();
        let functions = module.functions.iter();
        let functions = functions.map(|(handle, function)| (function, &info[handle]));
        let entries = module.entry_points.iter().enumerate();
        let entries = entries.map(|(index, entry)| (&entry.function, info.get_entry_point(index)));
        functions
            .chain(entries)
            .any(|(function, info)| indexes_a_vector_variable(&module, function, info))
    });
    let refused: Vec<String> = refused.map(Permutation::label).collect();
    assert!(refused.is_empty(), "{}", refused.join("\n"));
}

fn indexes_a_vector_variable(module: &Module, function: &Function, info: &FunctionInfo) -> bool {
    let is_vector_variable = |ty: &TypeInner| match *ty {
        TypeInner::Pointer { base, space } => {
            matches!(module.types[base].inner, TypeInner::Vector { .. }) && is_written(space)
        }
        TypeInner::ValuePointer { size, space, .. } => size.is_some() && is_written(space),
        _ => false,
    };
    function.expressions.iter().any(|(_, expression)| {
        matches!(expression, Expression::Access { base, .. }
            if is_vector_variable(info[*base].ty.inner_with(&module.types)))
    })
}

/// Private variables of a shader. Vectors in buffers are written by address.
fn is_written(space: AddressSpace) -> bool {
    matches!(
        space,
        AddressSpace::Function | AddressSpace::Private | AddressSpace::WorkGroup
    )
}
