//! The adapter and device: opened once, shared by every renderer.

use crate::locks::lock;
use crate::render::RenderError;
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, Mutex};

/// Adapter selection and limits.
#[derive(Debug, Clone, Copy, Default)]
pub struct ContextOptions {
    /// Take a software adapter even where there is a GPU. Tests do: their images then come from one rasteriser.
    pub prefer_software: bool,
    /// Draw at most this many records from one buffer, below the adapter's own limit. Tests force many chunks with it.
    pub max_chunk_records: Option<usize>,
}

/// An open device with its queried properties.
#[derive(Debug)]
pub struct Context {
    /// The graphics library.
    pub instance: wgpu::Instance,
    /// The adapter.
    pub adapter: wgpu::Adapter,
    /// The device.
    pub device: wgpu::Device,
    /// Its queue.
    pub queue: wgpu::Queue,
    /// Name, type and driver.
    pub info: wgpu::AdapterInfo,
    /// The adapter's limits, all of which were requested.
    pub limits: wgpu::Limits,
    /// True if GPU time can be measured.
    pub has_timestamps: bool,
    /// True if fragments that write depths may be discarded by an early depth test, before they are drawn.
    pub tests_depths_early: bool,
    /// True if blending is supported for textures of single-precision floats.
    pub blends_single_floats: bool,
    pub(super) max_chunk_records: Option<usize>,
    lost: Arc<Mutex<Option<String>>>,
    /// Number of allocations that will fail as if there were no memory, for tests.
    allocations_to_fail: AtomicU32,
}

impl Context {
    /// Opens an adapter that needs no window.
    pub fn headless(options: &ContextOptions) -> Result<Arc<Self>, RenderError> {
        let instance = Self::instance();
        let adapter = choose_adapter(&instance, None, options)?;
        Self::open(instance, adapter, options)
    }

    /// Opens an adapter that can show on `surface`, which `instance` made.
    pub fn for_window(
        instance: wgpu::Instance,
        surface: &wgpu::Surface<'_>,
        options: &ContextOptions,
    ) -> Result<Arc<Self>, RenderError> {
        let adapter = choose_adapter(&instance, Some(surface), options)?;
        Self::open(instance, adapter, options)
    }

    /// The graphics library with Vulkan, Metal or DirectX 12, unless `WGPU_BACKEND` names another.
    pub fn instance() -> wgpu::Instance {
        let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle_from_env();
        // Also looking for OpenGL takes a second and complains on stderr if it is missing.
        descriptor.backends = wgpu::Backends::from_env().unwrap_or(wgpu::Backends::PRIMARY);
        wgpu::Instance::new(descriptor)
    }

    fn open(
        instance: wgpu::Instance,
        adapter: wgpu::Adapter,
        options: &ContextOptions,
    ) -> Result<Arc<Self>, RenderError> {
        let info = adapter.get_info();
        let timestamps = wgpu::Features::TIMESTAMP_QUERY;
        let single_floats = wgpu::Features::FLOAT32_BLENDABLE;
        // Vulkan only in wgpu 30: Metal and Direct3D 12 have a conservative test, but naga 30 does not emit it for
        // them.
        let early_depths = wgpu::Features::SHADER_EARLY_DEPTH_TEST;
        let features = adapter.features() & (timestamps | single_floats | early_depths);
        let has_timestamps = features.contains(timestamps);
        // wgpu's own defaults (256 MiB per buffer) are below the limits of adapters.
        let limits = adapter.limits();
        let (device, queue) = pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor {
            label: Some("pointreel"),
            required_features: features,
            required_limits: limits.clone(),
            memory_hints: wgpu::MemoryHints::Performance,
            ..Default::default()
        }))
        .map_err(|error| RenderError::NoDevice {
            adapter: info.name.clone(),
            reason: error.to_string(),
        })?;
        let lost = Arc::new(Mutex::new(None));
        let lost_flag = Arc::clone(&lost);
        device.set_device_lost_callback(move |reason, message| {
            // Dropping the device calls this too; that is not a loss.
            if reason != wgpu::DeviceLostReason::Destroyed || !message.is_empty() {
                *lock(&lost_flag) = Some(message);
            }
        });
        device.on_uncaptured_error(Arc::new(|error| log::error!("graphics: {error}")));
        log::info!("adapter {} ({:?}, {})", info.name, info.device_type, info.driver_info);
        Ok(Arc::new(Self {
            instance,
            adapter,
            device,
            queue,
            info,
            limits,
            has_timestamps,
            tests_depths_early: features.contains(early_depths),
            blends_single_floats: features.contains(single_floats),
            max_chunk_records: options.max_chunk_records,
            lost,
            allocations_to_fail: AtomicU32::new(0),
        }))
    }

    /// Fails when the device was lost since it was opened.
    pub fn check_alive(&self) -> Result<(), RenderError> {
        match &*lock(&self.lost) {
            Some(reason) => Err(RenderError::DeviceLost { reason: reason.clone() }),
            None => Ok(()),
        }
    }

    /// Lets the next `count` allocations for images fail as if the GPU had no memory left.
    pub fn simulate_out_of_memory(&self, count: u32) {
        self.allocations_to_fail.store(count, Ordering::Relaxed);
    }

    /// Ends the device as a crashed driver would: every later image fails with [`RenderError::DeviceLost`].
    pub fn simulate_loss(&self) {
        self.device.destroy();
        *lock(&self.lost) = Some("simulated".to_owned());
    }

    /// One line for reports: name, type and driver.
    pub fn adapter_summary(&self) -> String {
        let wgpu::AdapterInfo {
            name,
            driver,
            driver_info,
            backend,
            device_type,
            ..
        } = &self.info;
        format!("{name} ({device_type:?}, {backend:?}, {driver} {driver_info})")
    }

    /// Returns true if the adapter is a software rasteriser that draws on the CPU.
    pub fn is_software(&self) -> bool {
        self.info.device_type == wgpu::DeviceType::Cpu
    }

    /// Largest edge of an image.
    pub fn max_edge_px(&self) -> u32 {
        self.limits.max_texture_dimension_2d
    }

    /// Maximum bytes of a storage binding.
    pub(super) fn max_storage_bytes(&self) -> u64 {
        let limits = &self.limits;
        limits.max_storage_buffer_binding_size.min(limits.max_buffer_size)
    }

    /// Waits until everything submitted is done.
    pub fn wait(&self) -> Result<(), RenderError> {
        self.device
            .poll(wgpu::PollType::wait_indefinitely())
            .map(|_| ())
            .map_err(|error| RenderError::Poll {
                reason: error.to_string(),
            })
    }

    /// Waits for uploads too. Copies out of mapped memory are carried out with the next submission.
    pub fn wait_for_uploads(&self) -> Result<(), RenderError> {
        self.queue.submit([]);
        self.wait()
    }

    /// A buffer of `size` bytes that begins with `bytes`, written with one copy into its mapped memory.
    pub(super) fn filled_buffer(
        &self,
        label: &str,
        usage: wgpu::BufferUsages,
        bytes: &[u8],
        size: usize,
    ) -> wgpu::Buffer {
        let buffer = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size: size as u64,
            usage,
            // One copy into memory that is mapped from the start: uploads need no staging memory besides the driver's.
            mapped_at_creation: true,
        });
        match buffer.slice(..bytes.len() as u64).get_mapped_range_mut() {
            Ok(mut mapped) => mapped.copy_from_slice(bytes),
            // A failed allocation is reported by the surrounding error scope.
            Err(error) => log::error!("the buffer of {label} cannot be written: {error}"),
        }
        buffer.unmap();
        buffer
    }

    /// Runs `allocate` and reports an allocation that did not fit as an error instead of an uncaptured one.
    pub(super) fn catching_out_of_memory<T>(
        &self,
        what: &'static str,
        allocate: impl FnOnce() -> T,
    ) -> Result<T, RenderError> {
        let scope = self.device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let result = allocate();
        let failed = pollster::block_on(scope.pop()).is_some();
        let to_fail = |left: u32| left.checked_sub(1);
        let is_simulated = self
            .allocations_to_fail
            .fetch_update(Ordering::Relaxed, Ordering::Relaxed, to_fail)
            .is_ok();
        if failed || is_simulated {
            return Err(RenderError::OutOfMemory { what });
        }
        Ok(result)
    }
}

fn choose_adapter(
    instance: &wgpu::Instance,
    surface: Option<&wgpu::Surface<'_>>,
    options: &ContextOptions,
) -> Result<wgpu::Adapter, RenderError> {
    let request = |force_fallback_adapter| {
        pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::HighPerformance,
            force_fallback_adapter,
            compatible_surface: surface,
            ..Default::default()
        }))
    };
    let adapter = if options.prefer_software {
        request(true).or_else(|_| request(false))
    } else {
        request(false).or_else(|_| request(true))
    };
    adapter.map_err(|error| RenderError::NoAdapter {
        reason: error.to_string(),
    })
}
