//! The window's surface (swap chain): handling of every result of acquiring a swap-chain image.
//!
//! **How it works.** A surface lives alongside the window system, which resizes, hides and takes it away at will, and
//! reports so only when the next image is acquired. [`acquire`] decides: an image is presented, a temporary lack of one
//! is waited out, an outdated surface is reconfigured for the window's current size, a lost one is recreated. A repair
//! is tried once per image; if there is still no image then, it is requested again later. A window with zero area has
//! no images: none is even requested. [`SurfaceImages`] keeps the decisions apart from wgpu, so that tests can return
//! every result.

use crate::render::RenderError;
use crate::render::gpu::Context;
use std::sync::Arc;
use winit::window::Window;

/// One frame may wait while the next is drawn: smooth, and not late.
const FRAMES_IN_FLIGHT: u32 = 2;

/// Number of image requests: as it is, and after a repair.
const MAX_ATTEMPTS: usize = 2;

/// Result of acquiring a surface image.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Answer<T> {
    /// An image that can be shown.
    Image(T),
    /// No image at present: the window is occluded, or the display is late.
    NotNow,
    /// It no longer fits the window.
    Outdated,
    /// It is gone.
    Lost,
}

/// Source of surface images.
pub(super) trait SurfaceImages {
    /// An image to draw to.
    type Image;

    /// Width and height of the window, pixels; 0 while it is minimised.
    fn window_size_px(&self) -> [u32; 2];

    /// Asks for the next image.
    fn next(&mut self) -> Answer<Self::Image>;

    /// Makes the surface fit a window of `size_px`, at least 1×1.
    fn reconfigure(&mut self, size_px: [u32; 2]);

    /// Makes another surface.
    fn recreate(&mut self, size_px: [u32; 2]) -> Result<(), RenderError>;
}

/// The next image of `target`; `None` if there is none now.
pub(super) fn acquire<T: SurfaceImages>(target: &mut T) -> Result<Option<T::Image>, RenderError> {
    for attempt in 1..=MAX_ATTEMPTS {
        let size_px = target.window_size_px();
        if size_px.contains(&0) {
            return Ok(None);
        }
        let answer = target.next();
        // A repair also helps the next frame, whether or not this one can wait for it.
        match answer {
            Answer::Image(image) => return Ok(Some(image)),
            Answer::NotNow => return Ok(None),
            Answer::Outdated => target.reconfigure(size_px),
            Answer::Lost => target.recreate(size_px)?,
        }
        log::debug!("the surface was repaired, attempt {attempt}");
    }
    Ok(None)
}

/// The surface of a real window.
pub(super) struct WindowSurface {
    window: Arc<Window>,
    context: Arc<Context>,
    surface: wgpu::Surface<'static>,
    config: wgpu::SurfaceConfiguration,
}

impl WindowSurface {
    /// Opens the adapter that shows on `window`, and its surface.
    pub(super) fn open(
        window: Arc<Window>,
        open_context: impl FnOnce(wgpu::Instance, &wgpu::Surface<'static>) -> Result<Arc<Context>, RenderError>,
    ) -> Result<Self, RenderError> {
        let instance = Context::instance();
        let surface = create_surface(&instance, &window)?;
        let context = open_context(instance, &surface)?;
        let size = window.inner_size();
        // A window can be opened minimised.
        let size_px = within(size.into(), context.max_edge_px()).map(|edge| edge.max(1));
        let config = surface_config(&context, &surface, size_px)?;
        surface.configure(&context.device, &config);
        Ok(Self {
            window,
            context,
            surface,
            config,
        })
    }

    pub(super) fn window(&self) -> &Window {
        &self.window
    }

    pub(super) fn context(&self) -> &Arc<Context> {
        &self.context
    }

    pub(super) fn format(&self) -> wgpu::TextureFormat {
        self.config.format
    }

    /// Size of the images, pixels.
    pub(super) fn size_px(&self) -> [u32; 2] {
        [self.config.width, self.config.height]
    }

    /// Follows the window's size.
    pub(super) fn resize(&mut self) {
        let size_px = self.window_size_px();
        if !size_px.contains(&0) && size_px != self.size_px() {
            self.reconfigure(size_px);
        }
    }
}

impl SurfaceImages for WindowSurface {
    type Image = wgpu::SurfaceTexture;

    fn window_size_px(&self) -> [u32; 2] {
        within(self.window.inner_size().into(), self.context.max_edge_px())
    }

    fn next(&mut self) -> Answer<wgpu::SurfaceTexture> {
        use wgpu::CurrentSurfaceTexture as Current;
        match self.surface.get_current_texture() {
            // An image that does not fit is still shown; the correct size is set with the resize event that follows.
            Current::Success(image) | Current::Suboptimal(image) => Answer::Image(image),
            Current::Timeout | Current::Occluded => Answer::NotNow,
            Current::Outdated | Current::Validation => Answer::Outdated,
            Current::Lost => Answer::Lost,
        }
    }

    fn reconfigure(&mut self, [width, height]: [u32; 2]) {
        self.config.width = width;
        self.config.height = height;
        self.surface.configure(&self.context.device, &self.config);
    }

    fn recreate(&mut self, size_px: [u32; 2]) -> Result<(), RenderError> {
        // A lost device also loses its surfaces; the device loss is then reported.
        self.context.check_alive()?;
        self.surface = create_surface(&self.context.instance, &self.window)?;
        self.reconfigure(size_px);
        Ok(())
    }
}

/// The window's size, limited to the adapter's maximum; zero stays zero.
fn within(size_px: [u32; 2], max_edge_px: u32) -> [u32; 2] {
    size_px.map(|edge| edge.min(max_edge_px))
}

fn create_surface(instance: &wgpu::Instance, window: &Arc<Window>) -> Result<wgpu::Surface<'static>, RenderError> {
    instance
        .create_surface(Arc::clone(window))
        .map_err(|error| RenderError::NoAdapter {
            reason: format!("the window has no surface: {error}"),
        })
}

fn surface_config(
    context: &Context,
    surface: &wgpu::Surface<'_>,
    [width, height]: [u32; 2],
) -> Result<wgpu::SurfaceConfiguration, RenderError> {
    let capabilities = surface.get_capabilities(&context.adapter);
    let mut config = surface
        .get_default_config(&context.adapter, width, height)
        .ok_or_else(|| RenderError::NoAdapter {
            reason: format!("{} cannot show on this window", context.adapter_summary()),
        })?;
    let preferred = [wgpu::TextureFormat::Bgra8Unorm, wgpu::TextureFormat::Rgba8Unorm];
    if let Some(format) = preferred
        .into_iter()
        .find(|format| capabilities.formats.contains(format))
    {
        config.format = format;
    }
    // Fifo is the only mode that every adapter supports.
    config.present_mode = wgpu::PresentMode::Fifo;
    config.desired_maximum_frame_latency = FRAMES_IN_FLIGHT;
    config.alpha_mode = if capabilities.alpha_modes.contains(&wgpu::CompositeAlphaMode::Opaque) {
        wgpu::CompositeAlphaMode::Opaque
    } else {
        wgpu::CompositeAlphaMode::Auto
    };
    Ok(config)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Gives the answers of a script and records the requests.
    struct Scripted {
        window_size_px: [u32; 2],
        answers: Vec<Answer<&'static str>>,
        done: Vec<String>,
        is_device_lost: bool,
    }

    impl Scripted {
        fn new(answers: &[Answer<&'static str>]) -> Self {
            Self {
                window_size_px: [640, 480],
                answers: answers.to_vec(),
                done: Vec::new(),
                is_device_lost: false,
            }
        }
    }

    impl SurfaceImages for Scripted {
        type Image = &'static str;

        fn window_size_px(&self) -> [u32; 2] {
            self.window_size_px
        }

        fn next(&mut self) -> Answer<&'static str> {
            self.done.push("next".to_owned());
            self.answers.remove(0)
        }

        fn reconfigure(&mut self, size_px: [u32; 2]) {
            self.done.push(format!("reconfigure {size_px:?}"));
        }

        fn recreate(&mut self, size_px: [u32; 2]) -> Result<(), RenderError> {
            if self.is_device_lost {
                return Err(RenderError::DeviceLost {
                    reason: "pulled out".to_owned(),
                });
            }
            self.done.push(format!("recreate {size_px:?}"));
            Ok(())
        }
    }

    #[test]
    fn every_surface_status_is_handled() {
        use Answer::{Image, Lost, NotNow, Outdated};
        let (fit, fresh) = ("reconfigure [640, 480]", "recreate [640, 480]");
        let cases = [
            (vec![Image("a")], Some("a"), vec!["next"]),
            (vec![NotNow], None, vec!["next"]),
            (vec![Outdated, Image("a")], Some("a"), vec!["next", fit, "next"]),
            (vec![Lost, Image("a")], Some("a"), vec!["next", fresh, "next"]),
            (vec![Outdated, NotNow], None, vec!["next", fit, "next"]),
            // Recreated while the window is being resized.
            (vec![Lost, Outdated], None, vec!["next", fresh, "next", fit]),
            // Repairs that do not help are eventually given up.
            (vec![Outdated, Outdated], None, vec!["next", fit, "next", fit]),
            (vec![Lost, Lost], None, vec!["next", fresh, "next", fresh]),
        ];
        for (answers, image, done) in cases {
            let mut target = Scripted::new(&answers);
            let acquired = acquire(&mut target).unwrap();
            assert_eq!(acquired, image, "{answers:?}");
            assert_eq!(target.done, done, "{answers:?}");
        }
    }

    #[test]
    fn a_minimised_window_is_not_asked_for_images() {
        for window_size_px in [[0, 0], [0, 480], [640, 0]] {
            let mut target = Scripted {
                window_size_px,
                ..Scripted::new(&[])
            };
            assert_eq!(acquire(&mut target).unwrap(), None);
            assert!(target.done.is_empty(), "{:?}", target.done);
        }
    }

    #[test]
    fn a_lost_device_is_reported() {
        let mut target = Scripted {
            is_device_lost: true,
            ..Scripted::new(&[Answer::Lost])
        };
        assert!(matches!(acquire(&mut target), Err(RenderError::DeviceLost { .. })));
    }

    #[test]
    fn a_window_beyond_the_adapter_limit_is_partly_shown() {
        assert_eq!(within([20_000, 100], 16_384), [16_384, 100]);
        assert_eq!(within([0, 0], 16_384), [0, 0]);
    }
}
