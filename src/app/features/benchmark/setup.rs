//! The start dialog of a benchmark: renderer, size and extent of the run, instead of a run of the default length.

use crate::app::open_panels::PanelId;
use crate::app::widgets::rows::{choice, row, rows};
use crate::app::widgets::settle::settle;
use crate::app::widgets::tool_window::{space, tool_window};
use crate::bench::{BenchOptions, OptionGroup, Suite};
use crate::scene::{Choice, RendererChoice};
use egui::{Align2, Button, DragValue, Label, RichText, Ui, vec2};

/// Image sizes offered by name.
const SIZES: [(&str, [u32; 2], &str); 4] = [
    ("320 × 240", [320, 240], "Seconds per mode on any machine"),
    ("640 × 480", [640, 480], "The default of most suites"),
    ("1280 × 720", [1280, 720], "HD"),
    ("1920 × 1280", [1920, 1280], "The size of the 4D media paper"),
];

/// Width of the explanations, points.
const TEXT_WIDTH: f32 = 340.0;

/// Largest image edge, pixels.
const MAX_EDGE_PX: u32 = 8192;

/// Choices for a run that was not started yet.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BenchmarkSetup {
    /// The suite.
    pub suite: &'static Suite,
    /// Renderer to measure: both where it is left open and there is an adapter.
    pub renderer: Choice<RendererChoice>,
    /// Image size.
    pub viewport_px: [u32; 2],
    /// Frames to measure.
    pub frames: usize,
    /// Viewpoints per frame.
    pub viewpoints: usize,
    /// Timed rounds over all viewpoints.
    pub repeat: usize,
}

impl BenchmarkSetup {
    /// The default options of a suite.
    pub fn new(suite: &'static Suite) -> Self {
        let default = BenchOptions::new(suite);
        Self {
            suite,
            renderer: Choice::Auto,
            viewport_px: default.viewport_px,
            frames: default.frames,
            viewpoints: default.viewpoints,
            repeat: default.repeat,
        }
    }

    /// The options of its run.
    pub(super) fn options(&self) -> BenchOptions {
        BenchOptions {
            viewport_px: self.viewport_px,
            frames: self.frames,
            viewpoints: self.viewpoints,
            repeat: self.repeat,
            truth_folder: BenchOptions::truth_folder_of_person(),
            ..BenchOptions::new(self.suite)
        }
    }
}

/// The dialog while it is open, for a sequence of `frame_count` frames; true to start. `lack` is the reason why nothing
/// can start.
pub(super) fn setup_ui(
    ui: &mut Ui,
    is_open: &mut bool,
    setup: &mut BenchmarkSetup,
    frame_count: usize,
    lack: Option<&str>,
) -> bool {
    let mut is_started = false;
    let shown = tool_window(ui.ctx(), PanelId::BENCHMARK_SETUP.name(), "Run a benchmark")
        .open(is_open)
        .collapsible(false)
        .resizable(false)
        .pivot(Align2::CENTER_TOP)
        .default_pos(space(ui.ctx()).center_top() + vec2(0.0, 60.0))
        .show(ui, |ui| {
            ui.set_max_width(TEXT_WIDTH);
            ui.strong(setup.suite.title);
            ui.add(Label::new(setup.suite.hint).wrap());
            rows(ui, "benchmark setup", |ui| {
                renderer(ui, setup);
                size(ui, setup);
                extent(ui, setup, frame_count);
            });
            ui.separator();
            ui.collapsing("What is measured", |ui| {
                let text = format!("Measured: {}. Not: {}.", setup.suite.measured, setup.suite.not_measured);
                ui.add(Label::new(RichText::new(text).weak()).wrap());
            });
            ui.horizontal(|ui| {
                let start = ui.add_enabled(lack.is_none(), Button::new("Start"));
                let tooltip = "Measures the open sequence; playing is paused meanwhile";
                let start = start
                    .on_hover_text(tooltip)
                    .on_disabled_hover_text(lack.unwrap_or_default());
                let reset = ui.button("Reset").on_hover_text("The default options of this suite");
                if reset.clicked() {
                    *setup = BenchmarkSetup::new(setup.suite);
                }
                is_started = start.clicked();
            });
        });
    settle(ui, "Run a benchmark", shown);
    is_started
}

fn renderer(ui: &mut Ui, setup: &mut BenchmarkSetup) {
    let choices = [
        (
            "Automatic",
            Choice::Auto,
            "The CPU renderer, and the adapter if there is one",
        ),
        (
            "GPU",
            RendererChoice::Gpu.into(),
            "Render modes of the adapter alone, where a suite compares modes",
        ),
        (
            "CPU",
            RendererChoice::Cpu.into(),
            "The CPU renderer alone, without opening a driver",
        ),
    ];
    choice(ui, "Renderer", "The renderer to measure", &mut setup.renderer, &choices);
}

fn size(ui: &mut Ui, setup: &mut BenchmarkSetup) {
    choice(
        ui,
        "Size",
        "Width and height of the images",
        &mut setup.viewport_px,
        &SIZES,
    );
    for (name, edge) in ["Width", "Height"].into_iter().zip(&mut setup.viewport_px) {
        let drag = DragValue::new(edge).range(1..=MAX_EDGE_PX).suffix(" px");
        row(ui, name, "Pixels", drag);
    }
}

fn extent(ui: &mut Ui, setup: &mut BenchmarkSetup, frame_count: usize) {
    let plays = setup.suite.takes(OptionGroup::Playing);
    let (max_frames, tooltip) = if plays {
        (100_000, "Number of frames to show; the sequence is repeated")
    } else {
        (
            frame_count.max(1),
            "Number of frames to measure, evenly spread over the sequence",
        )
    };
    row(
        ui,
        "Frames",
        tooltip,
        DragValue::new(&mut setup.frames).range(1..=max_frames),
    );
    if plays {
        return;
    }
    row(
        ui,
        "Viewpoints",
        "Directions from which each frame is seen; the 4D media paper has 8",
        DragValue::new(&mut setup.viewpoints).range(1..=360),
    );
    row(
        ui,
        "Rounds",
        "Timed rounds over all viewpoints, of which the median is taken",
        DragValue::new(&mut setup.repeat).range(1..=100),
    );
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::suites;

    #[test]
    fn options_are_those_of_the_suite_until_they_are_changed() {
        for suite in suites::all() {
            let options = BenchOptions {
                truth_folder: BenchOptions::truth_folder_of_person(),
                ..BenchOptions::new(suite)
            };
            assert_eq!(BenchmarkSetup::new(suite).options(), options);
        }
        let setup = BenchmarkSetup {
            viewport_px: [32, 24],
            frames: 2,
            repeat: 1,
            ..BenchmarkSetup::new(suites::ERROR)
        };
        let options = setup.options();
        assert_eq!((options.viewport_px, options.frames, options.repeat), ([32, 24], 2, 1));
    }
}
