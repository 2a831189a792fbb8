//! The order of passes of one picture.
//!
//! | primitive | passes |
//! |---|---|
//! | point | background, point |
//! | voxel | background, solid |
//! | surfel `regular`, `no-depth` | background, splat |
//! | surfel `visibility` | background, visibility, depth view |
//! | surfel, other modes | background, visibility, attribute, resolve |
//!
//! Where it is asked for, eye-dome lighting follows, of sums before they are resolved; and the grid at the end.

use super::context::Context;
use super::gpu_data::ViewUniform;
use super::instancing::{Draw, Stream, ViewBinding};
use super::passes::GeometryKey;
use super::renderer::{GpuRenderer, stream_keys};
use super::residency::StreamKey;
use super::shaders::{Amplification, GeometryPass, ScreenPass};
use super::targets::Targets;
use crate::render::RenderError;
use crate::scene::{EyeDomeLight, PointShape, Primitive, ScenePacket, Splatting};

/// What a packet asks for.
#[derive(Debug)]
pub(super) struct Plan {
    pub(super) amplification: Amplification,
    /// Streams to draw; none when the frame lacks what the primitive needs.
    pub(super) streams: Vec<StreamKey>,
    geometry: &'static [GeometryPass],
    /// What follows the geometry.
    finish: Vec<ScreenPass>,
}

impl Plan {
    pub(super) fn new(packet: &ScenePacket) -> Self {
        let settings = &packet.settings;
        let amplification = match settings.primitive {
            Primitive::Auto | Primitive::Surfel => Amplification::Surfel,
            Primitive::Voxel => match packet.content.voxels() {
                Some(voxels) if voxels.normals.is_some() => Amplification::VoxelWithNormal,
                _ => Amplification::Voxel,
            },
            Primitive::Point if settings.points.size_px <= 1.0 => Amplification::Pixel,
            Primitive::Point => Amplification::Square,
        };
        let is_round =
            amplification == Amplification::Square && settings.points.shape == PointShape::Disk;
        let (geometry, resolve): (&'static [GeometryPass], _) =
            match (settings.primitive, settings.surfels.splatting) {
                (Primitive::Point, _) if is_round => (&[GeometryPass::RoundPoint], None),
                (Primitive::Point, _) => (&[GeometryPass::Point], None),
                (Primitive::Voxel, _) => (&[GeometryPass::Solid], None),
                (_, Splatting::Regular) => (&[GeometryPass::Regular], None),
                (_, Splatting::NoDepth) => (&[GeometryPass::NoDepth], None),
                (_, Splatting::Visibility) => {
                    (&[GeometryPass::Visibility], Some(ScreenPass::DepthView))
                }
                (_, Splatting::TwoPass | Splatting::Enlarged | Splatting::TwoPassEnlarged) => (
                    &[GeometryPass::Visibility, GeometryPass::Attribute],
                    Some(ScreenPass::Resolve),
                ),
            };
        let is_shaded = EyeDomeLight::of(packet).is_some();
        let shading = |pass: ScreenPass| is_shaded.then_some(pass);
        let finish: [Option<ScreenPass>; 3] = [
            match resolve {
                Some(ScreenPass::Resolve) => shading(ScreenPass::EyeDomeOfSums),
                _ => resolve,
            },
            match resolve {
                Some(ScreenPass::Resolve) => resolve,
                _ => shading(ScreenPass::EyeDome),
            },
            packet.ground.map(|_| ScreenPass::Grid),
        ];
        Self {
            amplification,
            streams: stream_keys(&packet.content),
            geometry,
            finish: finish.into_iter().flatten().collect(),
        }
    }

    /// The uniforms of each geometry pass.
    pub(super) fn views(packet: &ScenePacket) -> [ViewUniform; 2] {
        let [visibility, attribute] = packet
            .settings
            .surfels
            .splatting
            .scales(packet.settings.surfels.enlargement);
        [
            ViewUniform::new(packet, visibility),
            ViewUniform::new(packet, attribute).without_slack(),
        ]
    }

    pub(super) fn geometry_keys(&self, packet: &ScenePacket) -> impl Iterator<Item = GeometryKey> {
        let strategy = packet.settings.drawing.strategy;
        let amplification = self.amplification;
        // The faces of a cube that do not face the eye are never right to draw.
        let cull_back_faces = amplification.draws_cells() || packet.settings.culls_back_faces();
        self.geometry.iter().map(move |&pass| GeometryKey {
            strategy,
            amplification,
            pass,
            cull_back_faces,
        })
    }

    pub(super) fn screen_passes(&self, packet: &ScenePacket) -> impl Iterator<Item = ScreenPass> {
        let background = packet.settings.backdrop.background;
        let gradient = (background.top != background.bottom).then_some(ScreenPass::Background);
        gradient.into_iter().chain(self.finish.iter().copied())
    }
}

/// Cleared depth: nothing, at infinity.
const FAR: f32 = 0.0;

impl GpuRenderer {
    pub(super) fn encode_picture(
        &mut self,
        packet: &ScenePacket,
    ) -> Result<wgpu::CommandBuffer, RenderError> {
        let plan = Plan::new(packet);
        let Self {
            context,
            pipelines,
            instancing,
            residency,
            targets,
            timer,
            stats,
            ..
        } = self;
        let targets = targets.as_ref().ok_or(RenderError::NothingPrepared)?;
        let streams: Vec<&Stream> = plan
            .streams
            .iter()
            .filter_map(|&key| residency.get(key))
            .collect();
        let draw = Draw {
            streams: &streams,
            amplification: plan.amplification,
            quad_indices: &self.quad_indices,
        };
        let mut encoder = context
            .device
            .create_command_encoder(&wgpu::CommandEncoderDescriptor {
                label: Some("picture"),
            });
        if let Some(timer) = timer {
            timer.begin(context, &mut encoder);
        }
        stats.draw_calls = 0;
        stats.drawn_instances = 0;

        let background = packet.settings.backdrop.background;
        {
            let [red, green, blue] = background.top.map(|channel| f64::from(channel) / 255.0);
            let clear = wgpu::LoadOp::Clear(wgpu::Color {
                r: red,
                g: green,
                b: blue,
                a: 1.0,
            });
            let mut pass = begin(
                &mut encoder,
                "background",
                Some((&targets.color_view, clear)),
                None,
            );
            stats.passes += 1;
            if background.top != background.bottom
                && let Some(pipeline) = pipelines.screen(ScreenPass::Background)
            {
                pass.set_pipeline(pipeline);
                pass.set_bind_group(0, &self.view_group, &[0]);
                pass.draw(0..3, 0..1);
                stats.draw_calls += 1;
            }
        }

        for (index, key) in (0..).zip(plan.geometry_keys(packet)) {
            let view = ViewBinding {
                bind_group: &self.view_group,
                offset: index * self.view_stride,
            };
            stats.passes += instancing.amplify(context, &mut encoder, view, &draw);
            let mut pass = begin_geometry(&mut encoder, key.pass, targets);
            stats.passes += 1;
            if !streams.is_empty()
                && let Some(pipeline) = pipelines.geometry(key)
            {
                pass.set_pipeline(pipeline);
                pass.set_bind_group(0, view.bind_group, &[view.offset]);
                pass.set_index_buffer(draw.quad_indices.slice(..), wgpu::IndexFormat::Uint32);
                stats.draw_calls += instancing.draw(&mut pass, &draw);
                stats.drawn_instances += streams[0]
                    .chunks
                    .iter()
                    .map(|chunk| u64::from(chunk.record_count))
                    .sum::<u64>();
            }
        }

        for &finish in &plan.finish {
            let Some(pipeline) = pipelines.screen(finish) else {
                continue;
            };
            let source = pipelines.source_layout(finish).map(|layout| {
                let view = match finish {
                    ScreenPass::Resolve => &targets.accumulation_view,
                    _ => &targets.depth_view,
                };
                source_group(context, layout, view)
            });
            let has_depths = !matches!(plan.geometry, [GeometryPass::NoDepth]);
            let mut pass = begin_finish(&mut encoder, finish, targets, has_depths);
            stats.passes += 1;
            pass.set_pipeline(pipeline);
            pass.set_bind_group(0, &self.view_group, &[0]);
            if let Some(source) = &source {
                pass.set_bind_group(1, source, &[]);
            }
            pass.draw(0..3, 0..1);
            stats.draw_calls += 1;
        }

        if let Some(timer) = timer {
            timer.end(&mut encoder);
        }
        Ok(encoder.finish())
    }
}

fn begin_geometry<'e>(
    encoder: &'e mut wgpu::CommandEncoder,
    pass: GeometryPass,
    targets: &Targets,
) -> wgpu::RenderPass<'e> {
    let clear_depth = Some((&targets.depth_view, Some(wgpu::LoadOp::Clear(FAR))));
    let keep_color = Some((&targets.color_view, wgpu::LoadOp::Load));
    match pass {
        GeometryPass::Visibility => begin(encoder, "visibility", None, clear_depth),
        GeometryPass::Attribute => {
            let clear = wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT);
            let read_depth = Some((&targets.depth_view, None));
            begin(
                encoder,
                "attribute",
                Some((&targets.accumulation_view, clear)),
                read_depth,
            )
        }
        GeometryPass::Regular => begin(encoder, "splat", keep_color, clear_depth),
        GeometryPass::NoDepth => begin(encoder, "splat without depth", keep_color, None),
        GeometryPass::Solid => begin(encoder, "solid", keep_color, clear_depth),
        GeometryPass::Point => begin(encoder, "point", keep_color, clear_depth),
        GeometryPass::RoundPoint => begin(encoder, "round point", keep_color, clear_depth),
    }
}

/// What a pass over the screen reads.
fn source_group(
    context: &Context,
    layout: &wgpu::BindGroupLayout,
    source: &wgpu::TextureView,
) -> wgpu::BindGroup {
    context
        .device
        .create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("screen source"),
            layout,
            entries: &[wgpu::BindGroupEntry {
                binding: 0,
                resource: wgpu::BindingResource::TextureView(source),
            }],
        })
}

fn begin_finish<'e>(
    encoder: &'e mut wgpu::CommandEncoder,
    pass: ScreenPass,
    targets: &Targets,
    has_depths: bool,
) -> wgpu::RenderPass<'e> {
    let onto = |view| Some((view, wgpu::LoadOp::Load));
    match pass {
        ScreenPass::EyeDomeOfSums => begin(
            encoder,
            "eye-dome lighting of sums",
            onto(&targets.accumulation_view),
            None,
        ),
        ScreenPass::Grid => {
            // What is drawn without depth hides nothing.
            let cleared = (!has_depths).then_some(wgpu::LoadOp::Clear(FAR));
            let depth = Some((&targets.depth_view, cleared));
            begin(encoder, "grid", onto(&targets.color_view), depth)
        }
        _ => begin(encoder, "finish", onto(&targets.color_view), None),
    }
}

/// Begins a render pass. A depth buffer without load operation is only read.
fn begin<'e>(
    encoder: &'e mut wgpu::CommandEncoder,
    label: &str,
    color: Option<(&wgpu::TextureView, wgpu::LoadOp<wgpu::Color>)>,
    depth: Option<(&wgpu::TextureView, Option<wgpu::LoadOp<f32>>)>,
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
        depth_stencil_attachment: depth.map(|(view, load)| {
            wgpu::RenderPassDepthStencilAttachment {
                view,
                depth_ops: load.map(|load| wgpu::Operations {
                    load,
                    store: wgpu::StoreOp::Store,
                }),
                stencil_ops: None,
            }
        }),
        timestamp_writes: None,
        occlusion_query_set: None,
        multiview_mask: None,
    })
}
