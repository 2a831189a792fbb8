//! Records the passes of one image.

use super::constants::{SOURCE_GROUP, VIEW_GROUP};
use super::context::Context;
use super::instancing::{Draw, Instancing, ViewBinding};
use super::passes::screen::{PHOTO_ANSWERS, PULL, PUSH};
use super::passes::{DepthUse, GeometryKey, Pipelines, ScreenPass};
use super::plan::{LAMP_VIEW, Plan};
use super::recording::Recording;
use super::targets::{Source, Target, Targets};
use super::timer::{Stamps, Timer};
use super::uniforms::PartUniforms;
use crate::render::RenderStats;
use crate::scene::Background;

/// Cleared depth: nothing, at infinity.
const FAR: f32 = 0.0;

/// State for recording the passes of an image.
#[derive(Debug)]
pub(super) struct Recorder<'a> {
    pub(super) context: &'a Context,
    pub(super) pipelines: &'a Pipelines,
    pub(super) targets: &'a mut Targets,
    pub(super) view_group: &'a wgpu::BindGroup,
    pub(super) uniforms: &'a PartUniforms,
    pub(super) view_stride: u32,
    pub(super) encoder: &'a mut wgpu::CommandEncoder,
    /// Timer, if the adapter has timestamps.
    pub(super) timer: Option<&'a mut Timer>,
    pub(super) stats: &'a mut RenderStats,
}

/// Textures that colours are drawn to.
struct ColorTargets<'a> {
    views: Vec<&'a wgpu::TextureView>,
    /// All are loaded or cleared in the same way.
    load: wgpu::LoadOp<wgpu::Color>,
}

impl ColorTargets<'_> {
    /// No colour targets, for passes that draw only depths.
    const NONE: Self = Self {
        views: Vec::new(),
        load: wgpu::LoadOp::Load,
    };
}

/// A depth buffer.
struct DepthTarget<'a> {
    view: &'a wgpu::TextureView,
    /// Without it, depths are only read.
    load: Option<wgpu::LoadOp<f32>>,
}

impl<'a> Recorder<'a> {
    /// Records all passes of a plan.
    pub(super) fn record(
        &mut self,
        plan: &Plan<'_>,
        background: Background,
        instancing: &mut dyn Instancing,
        draw: &Draw<'_>,
    ) {
        self.stats.draw_calls = 0;
        self.stats.drawn_instances = 0;
        self.shadow_map(plan, instancing, draw);
        self.background(plan, background);
        for (index, key) in (0..).zip(plan.geometry_keys()) {
            self.geometry(index, key, instancing, draw);
        }
        if plan.fills_photo_holes() {
            self.answers_of_photos(plan);
        }
        for pass in &plan.finish {
            self.screen(pass, plan, 0);
        }
    }

    /// Records the view-dependent texturing of all pixels, with surfaces not seen in the input images filled from their
    /// surroundings.
    fn answers_of_photos(&mut self, plan: &Plan<'_>) {
        // Without a check for holes: its result would arrive one image late.
        let coarsest = self.targets.coarsest_photo_level();
        self.screen(&PHOTO_ANSWERS, plan, 0);
        for level in 1..=coarsest {
            self.screen(&PULL, plan, level);
        }
        for level in (0..coarsest).rev() {
            self.screen(&PUSH, plan, level);
        }
    }

    /// Clears the image, and draws the gradient.
    fn background(&mut self, plan: &Plan<'_>, background: Background) {
        let [red, green, blue] = background.top.map(|channel| f64::from(channel) / 255.0);
        let clear = wgpu::LoadOp::Clear(wgpu::Color {
            r: red,
            g: green,
            b: blue,
            a: 1.0,
        });
        let behind: Vec<_> = plan
            .behind
            .iter()
            .filter_map(|pass| self.bound(pass, plan, 0))
            .collect();
        let onto = ColorTargets {
            views: self.targets.views(Target::Picture, 0),
            load: clear,
        };
        let mut pass = begin(self.encoder, self.timer.as_deref_mut(), "background", onto, None);
        self.stats.passes += 1;
        for bound in &behind {
            bound.draw(&mut pass, self.view_group);
            self.stats.draw_calls += 1;
        }
    }

    /// The depths that the key light sees, unless they are there.
    fn shadow_map(&mut self, plan: &Plan<'_>, instancing: &mut dyn Instancing, draw: &Draw<'_>) {
        if let (Some(shadow), Some(key)) = (&plan.shadow, plan.shadow_key())
            && let Some(map) = self.targets.outdated_shadow_map(&shadow.lamp_packet).cloned()
        {
            let view = self.view(LAMP_VIEW);
            let draw = &Draw {
                amplification: key.amplification,
                ..*draw
            };
            self.amplify(view, instancing, draw);
            let depth = DepthTarget {
                view: &map,
                load: Some(wgpu::LoadOp::Clear(FAR)),
            };
            let pass = begin(
                self.encoder,
                self.timer.as_deref_mut(),
                "shadow map",
                ColorTargets::NONE,
                Some(depth),
            );
            draw_records(self.stats, pass, self.pipelines.geometry(key), view, instancing, draw);
        }
    }

    fn amplify(&mut self, view: ViewBinding<'_>, instancing: &mut dyn Instancing, draw: &Draw<'_>) {
        let mut recording = Recording::new(self.context, self.encoder, self.timer.as_deref_mut());
        self.stats.passes += instancing.amplify(&mut recording, view, draw);
    }

    /// The uniforms of this index.
    fn view(&self, index: u32) -> ViewBinding<'a> {
        ViewBinding {
            bind_group: self.view_group,
            offset: index * self.view_stride,
        }
    }

    /// The pass of this index over all records.
    fn geometry(&mut self, index: u32, key: GeometryKey, instancing: &mut dyn Instancing, draw: &Draw<'_>) {
        let view = self.view(index);
        self.amplify(view, instancing, draw);
        let targets = &*self.targets;
        let load = |target| match target {
            Target::Sums | Target::Surfaces => wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
            Target::Picture | Target::PhotoAnswers | Target::PhotoLevel | Target::Shown => wgpu::LoadOp::Load,
        };
        let color = key.pass.color.map_or(ColorTargets::NONE, |color| ColorTargets {
            views: targets.views(color.target, 0),
            load: load(color.target),
        });
        let depth = key.pass.depth.map(|depth| DepthTarget {
            view: &targets.depth_view,
            load: match depth {
                DepthUse::TestAndWrite => Some(wgpu::LoadOp::Clear(FAR)),
                DepthUse::TestOnly => None,
            },
        });
        let pass = begin(self.encoder, self.timer.as_deref_mut(), key.pass.name, color, depth);
        draw_records(self.stats, pass, self.pipelines.geometry(key), view, instancing, draw);
    }

    /// A pass over the screen, or over a level of a pyramid.
    fn screen(&mut self, screen: &'static ScreenPass, plan: &Plan<'_>, level: usize) {
        let Some(bound) = self.bound(screen, plan, level) else {
            return;
        };
        if screen.source == Some(Source::PictureCopy) {
            self.targets.copy_picture(self.encoder);
        }
        let targets = &*self.targets;
        // Primitives drawn without depth occlude nothing.
        let cleared = (!plan.leaves_depths()).then_some(wgpu::LoadOp::Clear(FAR));
        let depth = screen.depth.map(|_| DepthTarget {
            view: &targets.depth_view,
            load: cleared,
        });
        let color = ColorTargets {
            views: targets.views(screen.color.target, level),
            load: wgpu::LoadOp::Load,
        };
        let mut pass = begin(self.encoder, self.timer.as_deref_mut(), screen.name, color, depth);
        self.stats.passes += 1;
        bound.draw(&mut pass, self.view_group);
        self.stats.draw_calls += 1;
    }

    /// A pass over the screen with its inputs: textures, then its uniform.
    fn bound(&self, screen: &ScreenPass, plan: &Plan<'_>, level: usize) -> Option<BoundPass<'a>> {
        let textures = screen.source.map(|source| self.targets.sources(source, level));
        let textures = textures.into_iter().flatten().map(wgpu::BindingResource::TextureView);
        let uniform = self.uniforms.binding(screen);
        let entry = |(binding, resource)| wgpu::BindGroupEntry { binding, resource };
        let entries: Vec<_> = (0..).zip(textures.chain(uniform)).map(entry).collect();
        Some(BoundPass {
            pipeline: self.pipelines.screen(screen, plan.precision)?,
            source: self.context.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some(screen.name),
                layout: self.pipelines.source_layout(screen)?,
                entries: &entries,
            }),
        })
    }
}

/// A pass over the screen with its inputs.
struct BoundPass<'a> {
    pipeline: &'a wgpu::RenderPipeline,
    source: wgpu::BindGroup,
}

impl BoundPass<'_> {
    /// Draws the one triangle over the whole target.
    fn draw(&self, pass: &mut wgpu::RenderPass<'_>, view_group: &wgpu::BindGroup) {
        pass.set_pipeline(self.pipeline);
        pass.set_bind_group(VIEW_GROUP, view_group, &[0]);
        pass.set_bind_group(SOURCE_GROUP, &self.source, &[]);
        pass.draw(0..3, 0..1);
    }
}

/// Draws all records in a pass that has begun.
fn draw_records(
    stats: &mut RenderStats,
    mut pass: wgpu::RenderPass<'_>,
    pipeline: Option<&wgpu::RenderPipeline>,
    view: ViewBinding<'_>,
    instancing: &dyn Instancing,
    draw: &Draw<'_>,
) {
    stats.passes += 1;
    if !draw.streams.is_empty()
        && let Some(pipeline) = pipeline
    {
        pass.set_pipeline(pipeline);
        pass.set_bind_group(VIEW_GROUP, view.bind_group, &[view.offset]);
        pass.set_index_buffer(draw.quad_indices.slice(..), wgpu::IndexFormat::Uint32);
        stats.draw_calls += instancing.draw(&mut pass, draw);
        stats.drawn_instances += draw.record_count();
    }
}

/// Begins a render pass.
fn begin<'e>(
    encoder: &'e mut wgpu::CommandEncoder,
    timer: Option<&mut Timer>,
    label: &'static str,
    color: ColorTargets<'_>,
    depth: Option<DepthTarget<'_>>,
) -> wgpu::RenderPass<'e> {
    let attachment = |view| {
        Some(wgpu::RenderPassColorAttachment {
            view,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations {
                load: color.load,
                store: wgpu::StoreOp::Store,
            },
        })
    };
    let attachments: Vec<_> = color.views.into_iter().map(attachment).collect();
    let stamps = timer.and_then(|timer| timer.stamps(label));
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some(label),
        color_attachments: &attachments,
        depth_stencil_attachment: depth.map(|depth| wgpu::RenderPassDepthStencilAttachment {
            view: depth.view,
            depth_ops: depth.load.map(|load| wgpu::Operations {
                load,
                store: wgpu::StoreOp::Store,
            }),
            stencil_ops: None,
        }),
        timestamp_writes: stamps.map(Stamps::of_render),
        occlusion_query_set: None,
        multiview_mask: None,
    })
}
