//! Records the passes of one picture.

use super::constants::{SOURCE_GROUP, VIEW_GROUP};
use super::context::Context;
use super::instancing::{Draw, Instancing, ViewBinding};
use super::passes::{DepthUse, GeometryKey, Pipelines, ScreenPass, Source, Target};
use super::plan::Plan;
use super::targets::Targets;
use crate::render::RenderStats;
use crate::scene::Background;

/// Cleared depth: nothing, at infinity.
const FAR: f32 = 0.0;

/// What passes are recorded with.
#[derive(Debug)]
pub(super) struct Recorder<'a> {
    pub(super) context: &'a Context,
    pub(super) pipelines: &'a Pipelines,
    pub(super) targets: &'a Targets,
    pub(super) view_group: &'a wgpu::BindGroup,
    pub(super) view_stride: u32,
    pub(super) encoder: &'a mut wgpu::CommandEncoder,
    pub(super) stats: &'a mut RenderStats,
}

type ColorTarget<'a> = Option<(&'a wgpu::TextureView, wgpu::LoadOp<wgpu::Color>)>;

/// A depth buffer without load operation is only read.
type DepthTarget<'a> = Option<(&'a wgpu::TextureView, Option<wgpu::LoadOp<f32>>)>;

impl Recorder<'_> {
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
        self.background(plan, background);
        for (index, key) in (0..).zip(plan.geometry_keys()) {
            self.geometry(index, key, instancing, draw);
        }
        for pass in &plan.finish {
            self.screen(pass, plan.leaves_depths());
        }
    }

    /// Clears the picture, and draws the gradient.
    fn background(&mut self, plan: &Plan<'_>, background: Background) {
        let [red, green, blue] = background.top.map(|channel| f64::from(channel) / 255.0);
        let clear = wgpu::LoadOp::Clear(wgpu::Color {
            r: red,
            g: green,
            b: blue,
            a: 1.0,
        });
        let onto = Some((&self.targets.color_view, clear));
        let mut pass = begin(self.encoder, "background", onto, None);
        self.stats.passes += 1;
        if let Some(pipeline) = plan.background.and_then(|pass| self.pipelines.screen(pass)) {
            pass.set_pipeline(pipeline);
            pass.set_bind_group(VIEW_GROUP, self.view_group, &[0]);
            pass.draw(0..3, 0..1);
            self.stats.draw_calls += 1;
        }
    }

    /// The pass of this index over all records.
    fn geometry(&mut self, index: u32, key: GeometryKey, instancing: &mut dyn Instancing, draw: &Draw<'_>) {
        let view = ViewBinding {
            bind_group: self.view_group,
            offset: index * self.view_stride,
        };
        self.stats.passes += instancing.amplify(self.context, self.encoder, view, draw);
        let targets = self.targets;
        let color = key.pass.color.map(|color| match color.target {
            Target::Picture => (&targets.color_view, wgpu::LoadOp::Load),
            Target::Sums => {
                let clear = wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT);
                (&targets.accumulation_view, clear)
            }
        });
        let depth = key.pass.depth.map(|depth| match depth {
            DepthUse::TestAndWrite => (&targets.depth_view, Some(wgpu::LoadOp::Clear(FAR))),
            DepthUse::TestOnly => (&targets.depth_view, None),
        });
        let mut pass = begin(self.encoder, key.pass.name, color, depth);
        self.stats.passes += 1;
        if !draw.streams.is_empty()
            && let Some(pipeline) = self.pipelines.geometry(key)
        {
            pass.set_pipeline(pipeline);
            pass.set_bind_group(VIEW_GROUP, view.bind_group, &[view.offset]);
            pass.set_index_buffer(draw.quad_indices.slice(..), wgpu::IndexFormat::Uint32);
            self.stats.draw_calls += instancing.draw(&mut pass, draw);
            self.stats.drawn_instances += draw.record_count();
        }
    }

    /// A pass over the screen.
    fn screen(&mut self, screen: &'static ScreenPass, has_depths: bool) {
        let Some(pipeline) = self.pipelines.screen(screen) else {
            return;
        };
        let targets = self.targets;
        let source = screen.source.map(|source| {
            let view = match source {
                Source::Sums => &targets.accumulation_view,
                Source::Depths => &targets.depth_view,
            };
            source_group(self.context, self.pipelines.source_layout(source), view)
        });
        let onto = match screen.color.target {
            Target::Picture => &targets.color_view,
            Target::Sums => &targets.accumulation_view,
        };
        // What is drawn without depth hides nothing.
        let cleared = (!has_depths).then_some(wgpu::LoadOp::Clear(FAR));
        let depth = screen.depth.map(|_| (&targets.depth_view, cleared));
        let color = Some((onto, wgpu::LoadOp::Load));
        let mut pass = begin(self.encoder, screen.name, color, depth);
        self.stats.passes += 1;
        pass.set_pipeline(pipeline);
        pass.set_bind_group(VIEW_GROUP, self.view_group, &[0]);
        if let Some(source) = &source {
            pass.set_bind_group(SOURCE_GROUP, source, &[]);
        }
        pass.draw(0..3, 0..1);
        self.stats.draw_calls += 1;
    }
}

/// What a pass over the screen reads.
fn source_group(context: &Context, layout: &wgpu::BindGroupLayout, source: &wgpu::TextureView) -> wgpu::BindGroup {
    context.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("screen source"),
        layout,
        entries: &[wgpu::BindGroupEntry {
            binding: 0,
            resource: wgpu::BindingResource::TextureView(source),
        }],
    })
}

/// Begins a render pass.
fn begin<'e>(
    encoder: &'e mut wgpu::CommandEncoder,
    label: &str,
    color: ColorTarget<'_>,
    depth: DepthTarget<'_>,
) -> wgpu::RenderPass<'e> {
    let color = color.map(|(view, load)| wgpu::RenderPassColorAttachment {
        view,
        depth_slice: None,
        resolve_target: None,
        ops: wgpu::Operations {
            load,
            store: wgpu::StoreOp::Store,
        },
    });
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some(label),
        color_attachments: if color.is_some() {
            std::slice::from_ref(&color)
        } else {
            &[]
        },
        depth_stencil_attachment: depth.map(|(view, load)| wgpu::RenderPassDepthStencilAttachment {
            view,
            depth_ops: load.map(|load| wgpu::Operations {
                load,
                store: wgpu::StoreOp::Store,
            }),
            stencil_ops: None,
        }),
        timestamp_writes: None,
        occlusion_query_set: None,
        multiview_mask: None,
    })
}
