//! [`GpuRenderer`]: keeps what pictures share, and makes the next one from a packet.

use super::context::Context;
use super::gpu_data::ViewUniform;
use super::instancing::{self, Instancing};
use super::passes::Pipelines;
use super::picture::Plan;
use super::readback::read_color;
use super::residency::{Residency, StreamKey};
use super::shaders::Amplification;
use super::targets::Targets;
use super::timer::Timer;
use crate::render::{RenderError, RenderStats, Renderer};
use crate::scene::{Content, ScenePacket, Surfels, Voxels};
use std::sync::Arc;
use std::time::Instant;

/// How many bytes of record streams stay on the GPU for pictures to come, unless somebody says otherwise.
pub const DEFAULT_RESIDENT_BUDGET_BYTES: u64 = 1 << 30;

/// Views a picture can need: one for each pass over geometry.
pub(super) const VIEWS: u32 = 2;

/// Draws packets with wgpu into a texture of its own.
#[derive(Debug)]
pub struct GpuRenderer {
    pub(super) context: Arc<Context>,
    pub(super) pipelines: Pipelines,
    pub(super) instancing: Box<dyn Instancing>,
    pub(super) residency: Residency,
    pub(super) targets: Option<Targets>,
    pub(super) quad_indices: wgpu::Buffer,
    pub(super) view_group: wgpu::BindGroup,
    pub(super) view_stride: u32,
    pub(super) timer: Option<Timer>,
    pub(super) stats: RenderStats,
    view_buffer: wgpu::Buffer,
    quad_capacity: u32,
    prepared: Option<ScenePacket>,
    drawn: Option<ScenePacket>,
    color_generation: u64,
}

impl GpuRenderer {
    /// A renderer with nothing resident.
    pub fn new(context: Arc<Context>) -> Result<Self, RenderError> {
        context.check_alive()?;
        let uniform_bytes = size_of::<ViewUniform>() as u64;
        let pipelines = Pipelines::new(&context, uniform_bytes);
        let view_stride = (uniform_bytes as u32)
            .next_multiple_of(context.limits.min_uniform_buffer_offset_alignment);
        let view_buffer = context.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("views"),
            size: u64::from(view_stride * VIEWS),
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let view_group = context
            .device
            .create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("view"),
                layout: &pipelines.view_layout,
                entries: &[wgpu::BindGroupEntry {
                    binding: 0,
                    resource: wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                        buffer: &view_buffer,
                        offset: 0,
                        size: wgpu::BufferSize::new(uniform_bytes),
                    }),
                }],
            });
        let strategy = crate::scene::Style::default().drawing.strategy;
        Ok(Self {
            instancing: instancing::new(strategy, &context, &pipelines.view_layout),
            residency: Residency::new(DEFAULT_RESIDENT_BUDGET_BYTES),
            targets: None,
            quad_indices: quad_index_buffer(&context, 1),
            quad_capacity: 1,
            timer: Timer::new(&context),
            stats: RenderStats::default(),
            prepared: None,
            drawn: None,
            color_generation: 0,
            context,
            pipelines,
            view_buffer,
            view_group,
            view_stride,
        })
    }

    /// The device that draws.
    pub fn context(&self) -> &Arc<Context> {
        &self.context
    }

    /// The picture as a texture of the last packet's size; `None` before the first packet.
    pub fn color_view(&self) -> Option<&wgpu::TextureView> {
        self.targets.as_ref().map(|targets| &targets.color_view)
    }

    /// Changes whenever [`GpuRenderer::color_view`] is another texture than before.
    pub fn color_generation(&self) -> u64 {
        self.color_generation
    }

    /// Waits for the last picture and returns its GPU time; `None` where the adapter cannot measure it.
    pub fn wait_gpu_ms(&mut self) -> Option<f64> {
        let context = Arc::clone(&self.context);
        let gpu_ms = self.timer.as_mut()?.wait_ms(&context);
        self.stats.gpu_ms = gpu_ms;
        gpu_ms
    }

    /// Sets how many bytes of points and voxels stay on the GPU for pictures to come. Those of the picture that is
    /// drawn stay whatever the budget.
    pub fn set_resident_budget_bytes(&mut self, budget_bytes: u64) {
        self.residency.set_budget_bytes(budget_bytes);
    }

    /// The commands that draw what was prepared, for whoever submits them together with others; `None` if it is drawn
    /// already. They are to be submitted before another packet is prepared, which overwrites what they read.
    pub fn encode(&mut self) -> Result<Option<wgpu::CommandBuffer>, RenderError> {
        self.context.check_alive()?;
        let packet = self.prepared.clone().ok_or(RenderError::NothingPrepared)?;
        if self.drawn.as_ref() == Some(&packet) {
            return Ok(None);
        }
        let start = Instant::now();
        let commands = self.encode_picture(&packet)?;
        self.stats.frames += 1;
        self.stats.encode_ms = start.elapsed().as_secs_f64() * 1e3;
        self.drawn = Some(packet);
        Ok(Some(commands))
    }

    /// Forgets what was drawn, so that the same packet is drawn again: benchmarks measure that.
    pub fn invalidate(&mut self) {
        self.drawn = None;
    }

    fn ensure_targets(&mut self, size_px: [u32; 2]) -> Result<(), RenderError> {
        if self
            .targets
            .as_ref()
            .is_some_and(|targets| targets.size_px == size_px)
        {
            return Ok(());
        }
        let [width, height] = size_px;
        let max = self.context.max_edge_px();
        if width > max || height > max {
            return Err(RenderError::TooLarge { width, height, max });
        }
        // The old ones go first: both at once may not fit.
        self.targets = None;
        self.drawn = None;
        let targets = self
            .context
            .catching_out_of_memory("the picture", || Targets::new(&self.context, size_px))?;
        self.targets = Some(targets);
        self.color_generation += 1;
        Ok(())
    }

    /// Uploads what `plan` draws and is not resident; keeps the residency within its budget. Where that does not fit
    /// into the memory of the GPU, all else makes room for it.
    fn ensure_streams(&mut self, packet: &ScenePacket, plan: &Plan) -> Result<(), RenderError> {
        let has_others = self.residency.resident_bytes() > 0;
        let mut result = self.upload_streams(packet, plan);
        if has_others && matches!(result, Err(RenderError::OutOfMemory { .. })) {
            log::warn!("the GPU is out of memory: frames that were kept there make room");
            self.residency.clear();
            result = self.upload_streams(packet, plan);
        }
        if result.is_err() {
            // What was made of the streams cannot be drawn.
            self.residency.clear();
        }
        self.residency.trim(&plan.streams);
        self.stats.resident_bytes = self.residency.resident_bytes();
        result
    }

    fn upload_streams(&mut self, packet: &ScenePacket, plan: &Plan) -> Result<(), RenderError> {
        let Self {
            context,
            instancing,
            residency,
            stats,
            ..
        } = self;
        let mut ensure = |bytes: u64| {
            if bytes > 0 {
                stats.uploads += 1;
                stats.uploaded_bytes += bytes;
            }
        };
        context.catching_out_of_memory("the cloud", || {
            let upload = |bytes: &[u8], amplification| {
                instancing::upload(instancing.as_ref(), context, amplification, bytes)
            };
            // Surfels have the smallest chunks of what is drawn from a cloud. All its streams are cut for them, so that
            // switching the primitive uploads nothing again.
            let of_cloud = Amplification::Surfel;
            match &packet.content {
                Content::Voxels(Voxels {
                    records, normals, ..
                }) => {
                    ensure(residency.ensure(records, |records| {
                        upload(bytemuck::cast_slice(records), plan.amplification)
                    }));
                    if let Some(normals) = normals {
                        ensure(residency.ensure(normals, |records| {
                            upload(bytemuck::cast_slice(records), plan.amplification)
                        }));
                    }
                }
                Content::Points(points) => ensure(residency.ensure(points, |records| {
                    upload(bytemuck::cast_slice(records), of_cloud)
                })),
                Content::Surfels(Surfels { points, shapes }) => {
                    ensure(residency.ensure(points, |records| {
                        upload(bytemuck::cast_slice(records), of_cloud)
                    }));
                    ensure(residency.ensure(shapes, |records| {
                        upload(bytemuck::cast_slice(records), of_cloud)
                    }));
                }
                Content::Nothing | Content::Coded(_) => {}
            }
        })
    }

    fn ensure_quad_indices(&mut self, plan: &Plan) -> Result<(), RenderError> {
        let quads = plan
            .streams
            .iter()
            .filter_map(|&key| self.residency.get(key))
            .flat_map(|stream| &stream.chunks)
            .map(|chunk| {
                self.instancing
                    .quads_per_draw(chunk.record_count, plan.amplification)
            })
            .max()
            .unwrap_or(0);
        if quads > self.quad_capacity {
            let context = &self.context;
            self.quad_indices = context.catching_out_of_memory("the quads' indices", || {
                quad_index_buffer(context, quads)
            })?;
            self.quad_capacity = quads;
        }
        Ok(())
    }
}

impl Renderer for GpuRenderer {
    fn prepare(&mut self, packet: &ScenePacket) -> Result<(), RenderError> {
        self.context.check_alive()?;
        if self.prepared.as_ref() == Some(packet) {
            return Ok(());
        }
        let start = Instant::now();
        self.prepared = None;
        self.ensure_targets(packet.viewport_px)?;
        if self.instancing.strategy() != packet.settings.drawing.strategy {
            self.residency.clear();
            self.instancing = instancing::new(
                packet.settings.drawing.strategy,
                &self.context,
                &self.pipelines.view_layout,
            );
        }
        let plan = Plan::new(packet);
        self.ensure_streams(packet, &plan)?;
        self.ensure_quad_indices(&plan)?;
        for key in plan.geometry_keys(packet) {
            self.pipelines
                .ensure_geometry(&self.context, key, self.instancing.as_ref());
        }
        for pass in plan.screen_passes(packet) {
            self.pipelines.ensure_screen(&self.context, pass);
        }
        for (index, view) in (0..).zip(Plan::views(packet)) {
            let offset = u64::from(self.view_stride) * index;
            self.context
                .queue
                .write_buffer(&self.view_buffer, offset, bytemuck::bytes_of(&view));
        }
        self.prepared = Some(packet.clone());
        self.stats.prepare_ms = start.elapsed().as_secs_f64() * 1e3;
        Ok(())
    }

    fn render(&mut self) -> Result<(), RenderError> {
        if let Some(commands) = self.encode()? {
            let start = Instant::now();
            self.context.queue.submit([commands]);
            self.stats.encode_ms += start.elapsed().as_secs_f64() * 1e3;
        }
        Ok(())
    }

    fn read_image(&mut self) -> Result<image::RgbaImage, RenderError> {
        self.context.check_alive()?;
        let targets = self.targets.as_ref().ok_or(RenderError::NothingPrepared)?;
        read_color(&self.context, &targets.color)
    }

    fn stats(&self) -> RenderStats {
        RenderStats {
            gpu_ms: self
                .timer
                .as_ref()
                .and_then(Timer::last_ms)
                .or(self.stats.gpu_ms),
            ..self.stats
        }
    }
}

/// Indices 0 1 2 2 1 3, 4 5 6 6 5 7, … of `quads` quads.
fn quad_index_buffer(context: &Context, quads: u32) -> wgpu::Buffer {
    let indices: Vec<u32> = (0..quads)
        .flat_map(|quad| [0, 1, 2, 2, 1, 3].map(|corner| 4 * quad + corner))
        .collect();
    let bytes: &[u8] = bytemuck::cast_slice(&indices);
    context.filled_buffer(
        "quad indices",
        wgpu::BufferUsages::INDEX,
        bytes,
        bytes.len(),
    )
}

/// The streams that a packet draws, in the order of their bind groups.
pub(super) fn stream_keys(content: &Content) -> Vec<StreamKey> {
    match content {
        Content::Voxels(voxels) => {
            let normals = voxels.normals.as_ref().map(StreamKey::of);
            let records = StreamKey::of(&voxels.records);
            std::iter::once(records).chain(normals).collect()
        }
        Content::Surfels(surfels) => {
            vec![
                StreamKey::of(&surfels.points),
                StreamKey::of(&surfels.shapes),
            ]
        }
        Content::Points(points) => vec![StreamKey::of(points)],
        // Only the background is drawn: byte codes are for the processor alone.
        Content::Nothing | Content::Coded(_) => Vec::new(),
    }
}
