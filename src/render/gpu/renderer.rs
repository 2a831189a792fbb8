//! [`GpuRenderer`]: holds the state shared by images, and makes the next one from a packet.

use super::coded::CodeExpander;
use super::context::Context;
use super::depth_images::DepthMaker;
use super::gather::Gatherer;
use super::gpu_data::ViewUniform;
use super::instancing::{self, Draw, Indexed, Instancing, RecordInstancing};
use super::passes::Pipelines;
use super::photos::PhotoTextures;
use super::picture::Recorder;
use super::plan::{Plan, VIEWS};
use super::primitives;
use super::readback::read_color;
use super::recording::Recording;
use super::residency::RecordSource;
use super::streams::{Streams, UploadBy};
use super::targets::{Precision, SizesPx, Targets};
use super::timer::{GpuTimes, Timer};
use super::uniforms::PartUniforms;
use super::visible::{CULL_PASS, NORMALS_PASS, VisibleMaker};
use crate::render::gathered::Gathered;
use crate::render::{PassTimes, RenderError, RenderStats, Renderer};
use crate::rgbd::DepthFrame;
use crate::scene::{Content, PointImages, ScenePacket, ScreenStats, Strategy, Style};
use glam::Vec3;
use std::sync::Arc;
use std::time::Instant;

/// Default memory budget, in bytes, of the record streams that stay resident on the GPU for later images.
pub const DEFAULT_RESIDENT_BUDGET_BYTES: u64 = 1 << 30;

/// Draws packets with wgpu into a texture of its own.
#[derive(Debug)]
pub struct GpuRenderer {
    context: Arc<Context>,
    pipelines: Pipelines,
    strategy: Strategy,
    instancing: Box<dyn RecordInstancing>,
    indexed: Indexed,
    streams: Streams,
    /// Most recent timings of culling and normal estimation of an image.
    screen_ms: [Option<f64>; 2],
    makes_surfels: bool,
    gathered: Gathered,
    targets: Option<Targets>,
    quad_indices: wgpu::Buffer,
    view_group: wgpu::BindGroup,
    view_stride: u32,
    timer: Option<Timer>,
    stats: RenderStats,
    view_buffer: wgpu::Buffer,
    uniforms: PartUniforms,
    quad_capacity: u32,
    prepared: Option<Prepared>,
    drawn: Option<ScenePacket>,
    color_generation: u64,
}

/// A packet, and the plan of drawing it.
#[derive(Debug, Clone)]
struct Prepared {
    packet: ScenePacket,
    drawn: ScenePacket,
}

impl GpuRenderer {
    /// A renderer with nothing resident.
    pub fn new(context: Arc<Context>) -> Result<Self, RenderError> {
        context.check_alive()?;
        let uniform_bytes = size_of::<ViewUniform>() as u64;
        let pipelines = Pipelines::new(&context, uniform_bytes);
        let view_stride = (uniform_bytes as u32).next_multiple_of(context.limits.min_uniform_buffer_offset_alignment);
        let view_buffer = context.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("views"),
            size: u64::from(view_stride) * VIEWS as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let view_group = context.device.create_bind_group(&wgpu::BindGroupDescriptor {
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
        let strategy = Style::default().drawing.strategy;
        Ok(Self {
            strategy,
            instancing: (instancing::row(strategy).open)(&context, &pipelines.view_layout),
            indexed: Indexed::new(&context),
            streams: Streams::new(DEFAULT_RESIDENT_BUDGET_BYTES),
            screen_ms: [None; 2],
            // lavapipe, two cores, a Redwood frame at 640×480: culling and normals took 108 and 116 ms, the CPU's code
            // 15 and 50 ms. Filters of its depth images: 187 ms (bilateral) instead of 5.7 ms. 51,000 nodes of a byte
            // code at 1920×1080: 397 ms per image, 271 ms where the CPU decodes and uploads them.
            makes_surfels: !context.is_software(),
            gathered: Gathered::default(),
            targets: None,
            quad_indices: quad_index_buffer(&context, 1),
            quad_capacity: 1,
            timer: Timer::new(&context),
            stats: RenderStats::default(),
            prepared: None,
            drawn: None,
            color_generation: 0,
            uniforms: PartUniforms::new(&context),
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

    /// The image as a texture of the last packet's size; `None` before the first packet.
    pub fn color_view(&self) -> Option<&wgpu::TextureView> {
        self.targets.as_ref().map(|targets| targets.picture().1)
    }

    /// Changes whenever [`GpuRenderer::color_view`] is another texture than before.
    pub fn color_generation(&self) -> u64 {
        self.color_generation
    }

    /// Waits for the last image and returns its GPU time; `None` if the adapter cannot measure it.
    pub fn wait_gpu_ms(&mut self) -> Option<f64> {
        let context = Arc::clone(&self.context);
        // Without timestamps, the number of visible points still has to be waited for.
        self.streams.depth_images.wait_times(&context).ok()?;
        let times = self.timer.as_mut()?.wait(&context)?;
        self.note_screen_times();
        times.total_ms
    }

    /// Returns the GPU times of the passes over the images of a frame, once they are uploaded: of its filters and of
    /// its points. `None` where the adapter has no timestamps, or the CPU makes these points.
    pub fn depth_image_times(&mut self, frame: &Arc<DepthFrame>) -> Result<Option<PassTimes>, RenderError> {
        self.context.check_alive()?;
        let is_here = self.makes_surfels && DepthMaker::can_hold(&self.context, frame);
        if !is_here || !self.context.has_timestamps {
            return Ok(None);
        }
        let Self { context, streams, .. } = self;
        let images = PointImages {
            frame: Arc::clone(frame),
            origin: Vec3::ZERO,
            one_color: None,
        };
        context.catching_out_of_memory("the depth image", || streams.depth_images.make(context, &images))?;
        streams.depth_images.wait_times(context).map(Some)
    }

    /// Records the times of culling and normals, if the last measured image has them: one that is drawn again does not.
    fn note_screen_times(&mut self) {
        let passes = self.timer.as_ref().map(|timer| timer.last().passes).unwrap_or_default();
        let time_of = |name| {
            passes
                .iter()
                .find(|time| time.pass == name)
                .and_then(|time| time.gpu_ms)
        };
        if let Some(cull_ms) = time_of(CULL_PASS) {
            self.screen_ms = [Some(cull_ms), time_of(NORMALS_PASS)];
        }
    }

    /// Returns the statistics of screen-space normals, if the last image has such and they were computed here.
    fn screen_stats(&self) -> Option<ScreenStats> {
        let drawn = &self.prepared.as_ref()?.drawn.content;
        let count = self
            .streams
            .visible
            .count()
            .filter(|_| matches!(drawn, Content::Visible(_)))?;
        let [cull_ms, normals_ms] = self.screen_ms;
        Some(ScreenStats {
            points: count.points,
            visible: count.visible,
            cull_ms,
            normals_ms,
            errors: None,
        })
    }

    /// Sets how many bytes of points and voxels stay on the GPU for images to come. Those of the image being drawn stay
    /// regardless of the budget.
    pub fn set_resident_budget_bytes(&mut self, budget_bytes: u64) {
        self.streams.residency.set_budget_bytes(budget_bytes);
    }

    /// Sets if screen-space surfels, and those of byte codes, are made by the adapter, rather than by the CPU and
    /// uploaded; by default only hardware GPUs make them.
    pub fn set_makes_surfels(&mut self, makes_surfels: bool) {
        if self.makes_surfels != makes_surfels {
            self.makes_surfels = makes_surfels;
            (self.prepared, self.drawn) = (None, None);
        }
    }

    /// The commands that draw the prepared packet, for a caller that submits them together with others; `None` if it is
    /// drawn already. They are to be submitted before another packet is prepared, which overwrites their inputs.
    pub fn encode(&mut self) -> Result<Option<wgpu::CommandBuffer>, RenderError> {
        self.context.check_alive()?;
        let Prepared { packet, drawn } = self.prepared.clone().ok_or(RenderError::NothingPrepared)?;
        if self.drawn.as_ref() == Some(&packet) {
            return Ok(None);
        }
        let start = Instant::now();
        let commands = self.encode_picture(&drawn)?;
        self.stats.records = drawn.content.record_count() as u64;
        self.stats.frames += 1;
        self.stats.encode_ms = start.elapsed().as_secs_f64() * 1e3;
        self.drawn = Some(packet);
        Ok(Some(commands))
    }

    /// Discards the drawn image, so that the same packet is drawn again, for benchmarks.
    pub fn invalidate(&mut self) {
        self.drawn = None;
        self.streams.invalidate();
    }

    /// Returns the packet as it is drawn. Nodes that cannot all be resident are gathered here, and surfels that the
    /// adapter does not make are made here.
    fn as_drawn(&mut self, packet: &ScenePacket) -> ScenePacket {
        let drawn = packet.as_drawn().with_coded_pixels_as_points();
        if let Content::Visible(visible) = &drawn.content
            && !(self.makes_surfels && VisibleMaker::can_hold(&self.context, visible))
        {
            return self.gathered.packet(&drawn);
        }
        if let Content::Coded(cells) = &drawn.content
            && !(self.makes_surfels && CodeExpander::can_hold(&self.context, cells))
        {
            return drawn.with_surfels_of(cells);
        }
        let streams = primitives::drawable(&drawn).streams;
        let mut sizes = streams.iter().map(RecordSource::record_bytes);
        let are_bindable = sizes.clone().all(|bytes| Gatherer::can_hold(&self.context, bytes));
        if are_bindable && sizes.by_ref().sum::<usize>() as u64 <= self.streams.residency.budget_bytes() {
            return drawn;
        }
        drop(streams);
        self.gathered.packet(&drawn)
    }

    fn encode_picture(&mut self, packet: &ScenePacket) -> Result<wgpu::CommandBuffer, RenderError> {
        let plan = Plan::new(packet, self.context.blends_single_floats);
        let label = wgpu::CommandEncoderDescriptor { label: Some("picture") };
        let mut encoder = self.context.device.create_command_encoder(&label);
        if let Some(timer) = &mut self.timer {
            timer.begin(&self.context);
        }
        self.note_screen_times();
        let mut recording = Recording::new(&self.context, &mut encoder, self.timer.as_mut());
        self.stats.passes += self.streams.record(&mut recording, &plan);
        let streams = self.streams.drawn(&plan);
        let draw = Draw {
            streams: &streams,
            amplification: plan.drawable.amplification,
            quad_indices: &self.quad_indices,
        };
        let mut recorder = Recorder {
            context: &self.context,
            pipelines: &self.pipelines,
            targets: self.targets.as_mut().ok_or(RenderError::NothingPrepared)?,
            view_group: &self.view_group,
            uniforms: &self.uniforms,
            view_stride: self.view_stride,
            encoder: &mut encoder,
            timer: self.timer.as_mut(),
            stats: &mut self.stats,
        };
        let background = packet.style.backdrop.background;
        let instancing = instancing_of(&plan, self.instancing.as_mut(), &mut self.indexed);
        recorder.record(&plan, background, instancing, &draw);
        if let Some(timer) = &mut self.timer {
            timer.end(&mut encoder);
        }
        Ok(encoder.finish())
    }

    fn ensure_targets(&mut self, sizes_px: SizesPx, precision: Precision) -> Result<(), RenderError> {
        let is_made = |targets: &Targets| targets.sizes_px() == sizes_px && targets.precision == precision;
        if self.targets.as_ref().is_some_and(is_made) {
            return Ok(());
        }
        let [width, height] = sizes_px.drawn;
        let max = self.context.max_edge_px();
        if width > max || height > max {
            return Err(RenderError::TooLarge { width, height, max });
        }
        // The old ones are dropped first: both at once may not fit into memory.
        let posed_images = self.targets.take().and_then(|targets| targets.posed_images);
        self.drawn = None;
        let mut targets = self
            .context
            .catching_out_of_memory("the picture", || Targets::new(&self.context, sizes_px, precision))?;
        targets.posed_images = posed_images;
        self.targets = Some(targets);
        self.color_generation += 1;
        Ok(())
    }

    fn ensure_picture_copy(&mut self, plan: &Plan<'_>) -> Result<(), RenderError> {
        match &mut self.targets {
            Some(targets) if plan.reads_picture() => self
                .context
                .catching_out_of_memory("a copy of the picture", || targets.ensure_picture_copy(&self.context)),
            _ => Ok(()),
        }
    }

    fn ensure_surfaces(&mut self, plan: &Plan<'_>) -> Result<(), RenderError> {
        match &mut self.targets {
            Some(targets) if plan.defers_shading() => {
                self.context.catching_out_of_memory("the surfaces of the picture", || {
                    targets.ensure_surfaces(&self.context);
                    if plan.shadow.is_some() {
                        targets.ensure_shadow_map(&self.context);
                    }
                    if let Some(physical) = &plan.physical {
                        targets.ensure_environment(&self.context, &physical.tables);
                    }
                    if plan.fills_photo_holes() {
                        targets.ensure_photo_answers(&self.context);
                    }
                })
            }
            _ => Ok(()),
        }
    }

    /// Uploads the input images for view-dependent texturing, and their projections in the rendered image. They stay
    /// when the image is resized.
    fn ensure_photos(&mut self, plan: &Plan<'_>, packet: &ScenePacket) -> Result<(), RenderError> {
        if let (Some(views), Some(shown), Some(targets)) = (&plan.posed_images, &packet.posed_images, &mut self.targets)
        {
            let known = targets.posed_images.take();
            targets.posed_images = Some(self.context.catching_out_of_memory("the images", || {
                PhotoTextures::of(&self.context, known, shown, views, packet)
            })?);
        }
        Ok(())
    }

    /// Uploads the streams that `plan` draws and that are not resident; keeps the residency within its budget. If they
    /// do not fit into the memory of the GPU, everything else is evicted.
    fn ensure_streams(&mut self, plan: &Plan<'_>) -> Result<(), RenderError> {
        let has_others = self.streams.residency.resident_bytes() > 0;
        let mut result = self.upload_streams(plan);
        if has_others && matches!(result, Err(RenderError::OutOfMemory { .. })) {
            log::warn!("the GPU is out of memory: frames that were cached there are evicted");
            self.streams.clear();
            result = self.upload_streams(plan);
        }
        if result.is_err() {
            // Buffers derived from the streams cannot be drawn.
            self.streams.clear();
        }
        self.streams.residency.trim(&plan.stream_keys());
        self.stats.resident_bytes = self.streams.residency.resident_bytes();
        result
    }

    fn upload_streams(&mut self, plan: &Plan<'_>) -> Result<(), RenderError> {
        let Self {
            context,
            instancing,
            indexed,
            streams,
            stats,
            ..
        } = self;
        let by = UploadBy {
            context,
            instancing: instancing.as_ref(),
            indexed,
        };
        context.catching_out_of_memory("the cloud", || streams.upload(by, plan, stats))
    }

    fn ensure_quad_indices(&mut self, plan: &Plan<'_>) -> Result<(), RenderError> {
        let amplification = plan.drawable.amplification;
        let instancing = instancing_of(plan, self.instancing.as_mut(), &mut self.indexed);
        let streams = self.streams.drawn(plan);
        let quads = streams
            .into_iter()
            .flat_map(|stream| &stream.chunks)
            .map(|chunk| instancing.quads_per_draw(chunk.record_count, amplification))
            .max()
            .unwrap_or(0);
        if quads > self.quad_capacity {
            let context = &self.context;
            self.quad_indices =
                context.catching_out_of_memory("the quads' indices", || quad_index_buffer(context, quads))?;
            self.quad_capacity = quads;
        }
        Ok(())
    }
}

impl Renderer for GpuRenderer {
    fn prepare(&mut self, packet: &ScenePacket) -> Result<(), RenderError> {
        self.context.check_alive()?;
        if self
            .prepared
            .as_ref()
            .is_some_and(|prepared| prepared.packet == *packet)
        {
            return Ok(());
        }
        let start = Instant::now();
        self.prepared = None;
        let drawn = self.as_drawn(packet);
        let plan = Plan::new(&drawn, self.context.blends_single_floats);
        let is_smoothed = plan.makes_another();
        let sizes_px = SizesPx {
            drawn: drawn.viewport_px,
            shown: is_smoothed.then_some(packet.viewport_px),
        };
        self.ensure_targets(sizes_px, plan.precision)?;
        let strategy = packet.style.drawing.strategy;
        if self.strategy != strategy {
            self.streams.clear();
            self.instancing = (instancing::row(strategy).open)(&self.context, &self.pipelines.view_layout);
            self.strategy = strategy;
        }
        self.ensure_picture_copy(&plan)?;
        self.ensure_surfaces(&plan)?;
        self.ensure_photos(&plan, &drawn)?;
        self.ensure_streams(&plan)?;
        self.ensure_quad_indices(&plan)?;
        self.pipelines.notice_changes();
        let instancing = instancing_of(&plan, self.instancing.as_mut(), &mut self.indexed);
        for key in plan.geometry_keys().chain(plan.shadow_key()) {
            self.pipelines.ensure_geometry(&self.context, key, instancing);
        }
        for pass in plan.screen_passes() {
            self.pipelines.ensure_screen(&self.context, pass, plan.precision);
        }
        self.uniforms.prepare(&self.context, plan.screen_passes(), &drawn);
        for (index, view) in (0..).zip(plan.views(&drawn)) {
            let offset = u64::from(self.view_stride) * index;
            self.context
                .queue
                .write_buffer(&self.view_buffer, offset, bytemuck::bytes_of(&view));
        }
        self.prepared = Some(Prepared {
            packet: packet.clone(),
            drawn,
        });
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
        read_color(&self.context, targets.picture().0)
    }

    fn stats(&self) -> RenderStats {
        let GpuTimes { total_ms, passes } = self.timer.as_ref().map_or_else(GpuTimes::default, Timer::last);
        RenderStats {
            gpu_ms: total_ms,
            gpu_passes: passes,
            image_passes: self.streams.depth_images.times(),
            screen: self.screen_stats(),
            ..self.stats
        }
    }
}

/// Returns the instancing by which the records of a plan reach the vertex stage: the strategy's, or always the indexed
/// one for meshes.
fn instancing_of<'a>(
    plan: &Plan<'_>,
    of_strategy: &'a mut dyn RecordInstancing,
    indexed: &'a mut Indexed,
) -> &'a mut dyn Instancing {
    if plan.drawable.amplification.is_indexed {
        indexed
    } else {
        of_strategy
    }
}

/// Indices 0 1 2 2 1 3, 4 5 6 6 5 7, … of `quads` quads.
fn quad_index_buffer(context: &Context, quads: u32) -> wgpu::Buffer {
    let indices: Vec<u32> = (0..quads)
        .flat_map(|quad| [0, 1, 2, 2, 1, 3].map(|corner| 4 * quad + corner))
        .collect();
    let bytes: &[u8] = bytemuck::cast_slice(&indices);
    context.filled_buffer("quad indices", wgpu::BufferUsages::INDEX, bytes, bytes.len())
}
