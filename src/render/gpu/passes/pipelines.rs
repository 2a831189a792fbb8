//! Pipelines, made when first needed, then cached: unused modes cost nothing.

use super::state::{DepthUse, GeometryPass, ScreenPass};
use crate::render::gpu::context::Context;
use crate::render::gpu::instancing::Instancing;
use crate::render::gpu::primitives::Amplification;
use crate::render::gpu::shader_reload::Watch;
use crate::render::gpu::shaders::Permutation;
use crate::render::gpu::targets::Precision;
use crate::render::gpu::wgsl::source_or_nothing;
use crate::scene::Strategy;
use std::collections::HashMap;

/// Key of a geometry pipeline: everything that it depends on.
#[derive(Debug, Clone, Copy)]
pub(crate) struct GeometryKey {
    pub(crate) strategy: Strategy,
    pub(crate) amplification: &'static Amplification,
    pub(crate) pass: &'static GeometryPass,
    pub(crate) cull_back_faces: bool,
    pub(crate) precision: Precision,
}

/// The strategy, the names of amplification and pass, whether back faces are culled, and the precision of sums.
type GeometryName = (Strategy, &'static str, &'static str, bool, Precision);

/// The name of a pass and the precision of sums.
type ScreenName = (&'static str, Precision);

impl GeometryKey {
    fn name(&self) -> GeometryName {
        let Self {
            strategy,
            amplification,
            pass,
            cull_back_faces,
            precision,
        } = *self;
        (strategy, amplification.name, pass.name, cull_back_faces, precision)
    }
}

/// All pipelines made so far, and the layouts they share.
#[derive(Debug)]
pub(crate) struct Pipelines {
    geometry: HashMap<GeometryName, wgpu::RenderPipeline>,
    screen: HashMap<ScreenName, wgpu::RenderPipeline>,
    /// Pipelines of the shaders before a hot reload, which stay in use if the new shaders are invalid.
    before: (
        HashMap<GeometryName, wgpu::RenderPipeline>,
        HashMap<ScreenName, wgpu::RenderPipeline>,
    ),
    watch: Option<Watch>,
    pub(crate) view_layout: wgpu::BindGroupLayout,
    /// Bind group layouts, by the name of the screen-space pass, of its bindings in addition to the view.
    source_layouts: HashMap<&'static str, wgpu::BindGroupLayout>,
}

impl Pipelines {
    pub(crate) fn new(context: &Context, view_uniform_bytes: u64) -> Self {
        let view = wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Uniform,
            has_dynamic_offset: true,
            min_binding_size: wgpu::BufferSize::new(view_uniform_bytes),
        };
        let of_all = wgpu::ShaderStages::VERTEX_FRAGMENT | wgpu::ShaderStages::COMPUTE;
        Self {
            geometry: HashMap::new(),
            screen: HashMap::new(),
            before: (HashMap::new(), HashMap::new()),
            watch: Watch::begin(),
            view_layout: layout(context, "view", of_all, [view]),
            source_layouts: HashMap::new(),
        }
    }

    /// Recreates pipelines when a shader has changed, in development builds.
    pub(crate) fn notice_changes(&mut self) {
        if self.watch.as_mut().is_some_and(Watch::has_news) {
            self.before.0.extend(self.geometry.drain());
            self.before.1.extend(self.screen.drain());
        }
    }

    /// Returns the bind group layout of the bindings of a screen-space pass in addition to the view. Precondition:
    /// [`Pipelines::ensure_screen`].
    pub(crate) fn source_layout(&self, pass: &ScreenPass) -> Option<&wgpu::BindGroupLayout> {
        self.source_layouts.get(pass.name)
    }

    /// The pipeline of a geometry pass. Precondition: [`Pipelines::ensure_geometry`].
    pub(crate) fn geometry(&self, key: GeometryKey) -> Option<&wgpu::RenderPipeline> {
        self.geometry.get(&key.name())
    }

    /// The pipeline of a screen pass. Precondition: [`Pipelines::ensure_screen`].
    pub(crate) fn screen(&self, pass: &ScreenPass, precision: Precision) -> Option<&wgpu::RenderPipeline> {
        self.screen.get(&(pass.name, precision))
    }

    /// Makes the pipeline unless it is there.
    pub(crate) fn ensure_geometry(&mut self, context: &Context, key: GeometryKey, instancing: &dyn Instancing) {
        if self.geometry.contains_key(&key.name()) {
            return;
        }
        let mut layouts = vec![Some(&self.view_layout)];
        layouts.extend(instancing.group_layouts(key.amplification).into_iter().map(Some));
        let topology = if key.amplification.is_point_list() {
            wgpu::PrimitiveTopology::PointList
        } else {
            wgpu::PrimitiveTopology::TriangleList
        };
        let pipeline = checked(context, self.watch.as_ref(), || {
            build(
                context,
                Permutation::Geometry(key.strategy, key.amplification, key.pass),
                Onto {
                    targets: key.pass.color.map(|color| color.target_states(key.precision)),
                    depth: key.pass.depth,
                },
                &layouts,
                &instancing.vertex_buffers(key.amplification),
                wgpu::PrimitiveState {
                    topology,
                    front_face: wgpu::FrontFace::Ccw,
                    cull_mode: key.cull_back_faces.then_some(wgpu::Face::Back),
                    ..Default::default()
                },
            )
        });
        let before = self.before.0.remove(&key.name());
        self.geometry
            .extend(pipeline.or(before).map(|pipeline| (key.name(), pipeline)));
    }

    /// Makes the pipeline unless it is there.
    pub(crate) fn ensure_screen(&mut self, context: &Context, pass: &'static ScreenPass, precision: Precision) {
        if self.screen.contains_key(&(pass.name, precision)) {
            return;
        }
        let source_layout = self
            .source_layouts
            .entry(pass.name)
            .or_insert_with(|| source_layout(context, pass));
        let layouts = [Some(&self.view_layout), Some(&*source_layout)];
        let pipeline = checked(context, self.watch.as_ref(), || {
            build(
                context,
                Permutation::Screen(pass),
                Onto {
                    targets: Some(pass.color.target_states(precision)),
                    depth: pass.depth,
                },
                &layouts,
                &[],
                wgpu::PrimitiveState::default(),
            )
        });
        let name = (pass.name, precision);
        let before = self.before.1.remove(&name);
        self.screen.extend(pipeline.or(before).map(|pipeline| (name, pipeline)));
    }
}

/// A pipeline; where shaders may change, `None` if the adapter refuses it, which is logged.
fn checked(
    context: &Context,
    watch: Option<&Watch>,
    build: impl FnOnce() -> wgpu::RenderPipeline,
) -> Option<wgpu::RenderPipeline> {
    if watch.is_none() {
        return Some(build());
    }
    let scope = context.device.push_error_scope(wgpu::ErrorFilter::Validation);
    let pipeline = build();
    let error = pollster::block_on(scope.pop());
    if let Some(error) = &error {
        log::error!("shaders: {error}");
    }
    error.is_none().then_some(pipeline)
}

fn source_layout(context: &Context, pass: &ScreenPass) -> wgpu::BindGroupLayout {
    let textures = pass.textures().into_iter().map(|(_, kind)| kind.binding_type());
    let uniform = wgpu::BufferSize::new(pass.uniform_bytes()).map(|bytes| wgpu::BindingType::Buffer {
        ty: wgpu::BufferBindingType::Uniform,
        has_dynamic_offset: false,
        min_binding_size: Some(bytes),
    });
    layout(
        context,
        pass.name,
        wgpu::ShaderStages::FRAGMENT,
        textures.chain(uniform),
    )
}

fn layout(
    context: &Context,
    label: &str,
    visibility: wgpu::ShaderStages,
    types: impl IntoIterator<Item = wgpu::BindingType>,
) -> wgpu::BindGroupLayout {
    let entry = |(binding, ty)| wgpu::BindGroupLayoutEntry {
        binding,
        visibility,
        ty,
        count: None,
    };
    let entries: Vec<_> = (0..).zip(types).map(entry).collect();
    context
        .device
        .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some(label),
            entries: &entries,
        })
}

/// The targets of a pipeline.
struct Onto {
    /// `None` where only depths are drawn.
    targets: Option<Vec<Option<wgpu::ColorTargetState>>>,
    depth: Option<DepthUse>,
}

fn build(
    context: &Context,
    permutation: Permutation,
    onto: Onto,
    bind_group_layouts: &[Option<&wgpu::BindGroupLayout>],
    vertex_buffers: &[wgpu::VertexBufferLayout<'static>],
    primitive: wgpu::PrimitiveState,
) -> wgpu::RenderPipeline {
    let label = permutation.label();
    let targets = onto.targets.unwrap_or_default();
    let source = permutation.source(context.tests_depths_early);
    let module = context.device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some(&label),
        source: wgpu::ShaderSource::Wgsl(source_or_nothing(source).into()),
    });
    let layout = context.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some(&label),
        bind_group_layouts,
        immediate_size: 0,
    });
    let buffers: Vec<_> = vertex_buffers.iter().cloned().map(Some).collect();
    context.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(&label),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("vertex"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &buffers,
        },
        primitive,
        depth_stencil: onto.depth.map(DepthUse::state),
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("fragment"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &targets,
        }),
        multiview_mask: None,
        cache: None,
    })
}
