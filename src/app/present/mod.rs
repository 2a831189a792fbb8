//! Presentation of the window on the screen: the 3-D images, and egui's panels around them.
//!
//! **How it works.** There are two presenters behind one trait. The GPU presenter (`gpu.rs`) paints through egui-wgpu
//! on a surface of the driver. The CPU presenter (`cpu.rs`) paints into memory which the window system shows as it is.
//! A software driver would do the latter's work too, but compiles shaders, bins triangles and copies textures for it:
//! on two cores that is fifteen windows per second, whatever their content. So the CPU presents wherever no GPU does.
//!
//! An image is drawn when there is a new packet, panels are painted when egui has run, and either may come without the
//! other.

mod cpu;
mod gpu;
mod gpu_picture;
mod presenter;
mod software;
mod surface;

pub(super) use presenter::{Panels, Presenter};

use super::present_choice::PresentChoice;
use crate::render::RenderError;
use crate::render::gpu::may_have_gpu;
use cpu::CpuPresenter;
use gpu::GpuPresenter;
use std::sync::Arc;
use winit::window::Window;

/// Opens the chosen presenter. Where the choice is automatic, it takes a hardware GPU, and else needs no driver at all.
pub(super) fn open(choice: PresentChoice, window: &Arc<Window>) -> Result<Box<dyn Presenter>, RenderError> {
    match choice {
        PresentChoice::Gpu => open_gpu(window),
        PresentChoice::Cpu => open_cpu(window),
        // A software driver is worse than none: fifteen windows per second on two cores, regardless of their contents,
        // and it took the cores away from the loader.
        PresentChoice::Auto if may_have_gpu() => match open_gpu(window) {
            Ok(presenter) if !presenter.info().is_software => Ok(presenter),
            Ok(software) => {
                log::info!("{} is not a GPU", software.info().adapter);
                // A window can have only one surface at a time.
                drop(software);
                open_cpu(window)
            }
            Err(error) => {
                log::info!("{error}");
                open_cpu(window)
            }
        },
        // An unusual display may be one that only a driver can present to.
        PresentChoice::Auto => open_cpu(window).or_else(|error| {
            log::info!("{error}");
            open_gpu(window)
        }),
    }
}

fn open_gpu(window: &Arc<Window>) -> Result<Box<dyn Presenter>, RenderError> {
    Ok(Box::new(GpuPresenter::open(Arc::clone(window))?))
}

fn open_cpu(window: &Arc<Window>) -> Result<Box<dyn Presenter>, RenderError> {
    Ok(Box::new(CpuPresenter::open(Arc::clone(window))?))
}
