//! Pipelines, made when they are first needed and kept: nobody pays for modes that are not used.

use super::state::{DepthUse, GeometryPass, ScreenPass};
use crate::render::gpu::context::Context;
use crate::render::gpu::instancing::Instancing;
use crate::render::gpu::primitives::Amplification;
use crate::render::gpu::shaders::Permutation;
use crate::render::gpu::targets::{Precision, Source};
use crate::scene::Strategy;
use std::collections::HashMap;

/// What a geometry pipeline depends on.
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
    pub(crate) view_layout: wgpu::BindGroupLayout,
    color_source_layout: wgpu::BindGroupLayout,
    sum_source_layout: wgpu::BindGroupLayout,
    depth_source_layout: wgpu::BindGroupLayout,
    surface_source_layout: wgpu::BindGroupLayout,
    photographed_source_layout: wgpu::BindGroupLayout,
    photo_answer_source_layout: wgpu::BindGroupLayout,
}

impl Pipelines {
    pub(crate) fn new(context: &Context, view_uniform_bytes: u64) -> Self {
        let layout = |label, visibility, types: &[wgpu::BindingType]| {
            let entry = |(binding, &ty): (u32, &wgpu::BindingType)| wgpu::BindGroupLayoutEntry {
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
        };
        let texture = |sample_type, view_dimension| wgpu::BindingType::Texture {
            sample_type,
            view_dimension,
            multisampled: false,
        };
        let [single, layers] = [wgpu::TextureViewDimension::D2, wgpu::TextureViewDimension::D2Array];
        let color = texture(wgpu::TextureSampleType::Float { filterable: false }, single);
        let colors = texture(wgpu::TextureSampleType::Float { filterable: false }, layers);
        let depth = texture(wgpu::TextureSampleType::Depth, single);
        let surface = [color, color, color, depth, depth, color];
        let of_fragments = wgpu::ShaderStages::FRAGMENT;
        Self {
            geometry: HashMap::new(),
            screen: HashMap::new(),
            view_layout: layout(
                "view",
                wgpu::ShaderStages::VERTEX_FRAGMENT | wgpu::ShaderStages::COMPUTE,
                &[wgpu::BindingType::Buffer {
                    ty: wgpu::BufferBindingType::Uniform,
                    has_dynamic_offset: true,
                    min_binding_size: wgpu::BufferSize::new(view_uniform_bytes),
                }],
            ),
            color_source_layout: layout("color source", of_fragments, &[color]),
            sum_source_layout: layout("sum source", of_fragments, &[color, depth]),
            depth_source_layout: layout("depth source", of_fragments, &[depth]),
            surface_source_layout: layout("surface source", of_fragments, &surface),
            photographed_source_layout: layout(
                "photographed source",
                of_fragments,
                &[&surface[..], &[color, colors, colors]].concat(),
            ),
            photo_answer_source_layout: layout(
                "photo answer source",
                of_fragments,
                &[&surface[..], &[color; 3]].concat(),
            ),
        }
    }

    /// Layout of the textures that a screen pass reads.
    pub(crate) fn source_layout(&self, source: Source) -> &wgpu::BindGroupLayout {
        match source {
            Source::Sums => &self.sum_source_layout,
            Source::Picture | Source::FinerLevel | Source::CoarserLevel => &self.color_source_layout,
            Source::Depths => &self.depth_source_layout,
            Source::Surfaces => &self.surface_source_layout,
            Source::Photographed | Source::PhotographedSums => &self.photographed_source_layout,
            Source::PhotoAnswers => &self.photo_answer_source_layout,
        }
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
        let pipeline = build(
            context,
            Permutation::Geometry(key.strategy, key.amplification, key.pass),
            (
                key.pass.color.map(|color| color.target_states(key.precision)),
                key.pass.depth,
            ),
            &layouts,
            &instancing.vertex_buffers(key.amplification),
            wgpu::PrimitiveState {
                topology,
                front_face: wgpu::FrontFace::Ccw,
                cull_mode: key.cull_back_faces.then_some(wgpu::Face::Back),
                ..Default::default()
            },
        );
        self.geometry.insert(key.name(), pipeline);
    }

    /// Makes the pipeline unless it is there.
    pub(crate) fn ensure_screen(&mut self, context: &Context, pass: &'static ScreenPass, precision: Precision) {
        if self.screen.contains_key(&(pass.name, precision)) {
            return;
        }
        let mut layouts = vec![Some(&self.view_layout)];
        let source = pass.source.map(|source| self.source_layout(source));
        layouts.extend(source.map(Some));
        let pipeline = build(
            context,
            Permutation::Screen(pass),
            (Some(pass.color.target_states(precision)), pass.depth),
            &layouts,
            &[],
            wgpu::PrimitiveState::default(),
        );
        self.screen.insert((pass.name, precision), pipeline);
    }
}

fn build(
    context: &Context,
    permutation: Permutation,
    (targets, depth): (Option<Vec<Option<wgpu::ColorTargetState>>>, Option<DepthUse>),
    bind_group_layouts: &[Option<&wgpu::BindGroupLayout>],
    vertex_buffers: &[wgpu::VertexBufferLayout<'static>],
    primitive: wgpu::PrimitiveState,
) -> wgpu::RenderPipeline {
    let label = permutation.label();
    let targets = targets.unwrap_or_default();
    let module = context.device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some(&label),
        source: wgpu::ShaderSource::Wgsl(permutation.source(context.tests_depths_early).into()),
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
        depth_stencil: depth.map(DepthUse::state),
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
