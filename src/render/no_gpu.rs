//! Stub of the wgpu renderer, for a build without it: nothing of it can be opened.
//!
//! Uninhabited types have the functions that the rest of the program calls on the real ones, so that no other code
//! needs to know which build this is.

#![allow(
    clippy::needless_pass_by_value,
    reason = "functions take what those of the real module take"
)]

use super::{PassTimes, RenderError, RenderStats, Renderer};
use crate::rgbd::DepthFrame;
use crate::scene::ScenePacket;
use crate::stereo::SharedMatcher;
use image::RgbaImage;
use std::sync::Arc;

/// Nothing can be chosen.
#[derive(Debug, Clone, Copy, Default)]
pub struct ContextOptions {
    _private: (),
}

/// An open device: there is none.
#[derive(Debug)]
pub enum Context {}

impl Context {
    /// Refuses.
    pub fn headless(_options: &ContextOptions) -> Result<Arc<Self>, RenderError> {
        Err(RenderError::NotBuilt)
    }

    /// Name, type and driver.
    pub fn adapter_summary(&self) -> String {
        match *self {}
    }

    /// Returns true if the adapter is a software rasteriser.
    pub fn is_software(&self) -> bool {
        match *self {}
    }

    /// Longest edge of an image.
    pub fn max_edge_px(&self) -> u32 {
        match *self {}
    }

    /// Waits for requested work.
    pub fn wait_for_uploads(&self) -> Result<(), RenderError> {
        match *self {}
    }
}

/// GPU renderer, absent from this build.
#[derive(Debug)]
pub enum GpuRenderer {}

impl GpuRenderer {
    /// Draws on the device of `context`.
    pub fn new(context: Arc<Context>) -> Result<Self, RenderError> {
        match *context {}
    }

    /// Its device.
    pub fn context(&self) -> &Arc<Context> {
        match *self {}
    }

    /// Waits for the last image's time.
    pub fn wait_gpu_ms(&mut self) -> Option<f64> {
        match *self {}
    }

    /// Times of the passes over depth images.
    pub fn depth_image_times(&mut self, _frame: &Arc<DepthFrame>) -> Result<Option<PassTimes>, RenderError> {
        match *self {}
    }

    /// Sets if the adapter makes surfels.
    pub fn set_makes_surfels(&mut self, _makes_surfels: bool) {
        match *self {}
    }

    /// Discards the drawn image.
    pub fn invalidate(&mut self) {
        match *self {}
    }
}

impl Renderer for GpuRenderer {
    fn prepare(&mut self, _packet: &ScenePacket) -> Result<(), RenderError> {
        match *self {}
    }

    fn render(&mut self) -> Result<(), RenderError> {
        match *self {}
    }

    fn read_image(&mut self) -> Result<RgbaImage, RenderError> {
        match *self {}
    }

    fn stats(&self) -> RenderStats {
        match *self {}
    }
}

/// GPU stereo matcher, absent from this build.
#[derive(Debug)]
pub enum CardMatcher {}

impl CardMatcher {
    /// The matcher of `context`.
    pub fn shared(context: &Arc<Context>) -> SharedMatcher {
        match **context {}
    }
}

/// No GPU is looked for.
pub(crate) fn may_have_gpu() -> bool {
    false
}
