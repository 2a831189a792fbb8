//! The benchmark window: progress and cancel while it runs, then the table and a bar chart.

use super::lab::lab_ui;
use super::rates::rates_ui;
use super::{Benchmark, BenchmarkTable, ReportFormat};
use crate::app::open_panels::PanelId;
use crate::app::theme::ACCENT;
use crate::app::widgets::tool_window::{is_small, space, tool_window};
use crate::app::work::panel::{bar, cancel_button};
use crate::bench::{LabPoint, RatePoint, Table, suites};
use crate::scene::Strategy;
use egui::{Grid, Label, Rect, RichText, ScrollArea, Ui, Vec2, vec2};
use egui_plot::{Bar, BarChart, Plot};
use std::sync::Arc;
use std::time::Duration;

/// Height of a bar in the chart, points.
const BAR_HEIGHT: f32 = 22.0;

/// Margin between the window and the edges of its space, points.
const MARGIN: f32 = 10.0;

/// Default width: the right half of the image is visible next to it, points.
const USUAL_WIDTH: f32 = 460.0;

/// Minimum size: below it the window shows nothing, points.
const MIN_SIZE: [f32; 2] = [260.0, 140.0];

/// Request of the panel to the window.
#[derive(Debug, Clone)]
pub(in crate::app) enum BenchmarkRequest {
    /// Write the report to a file that is chosen with a dialog.
    Save(ReportFormat),
    /// Draw with this mode.
    DrawAs(Arc<LabPoint>),
    /// Draw by this instancing strategy.
    Use(Strategy),
    /// Show the frame as decoded from this encoding.
    ShowRetained(Arc<RatePoint>),
}

/// Shows the benchmark window while it is open: at first as high as the image and left of its centre, so that both are
/// seen, then at its last position (`place`). It never moves or grows by itself.
pub(in crate::app) fn benchmark_ui(
    ui: &mut Ui,
    is_open: &mut bool,
    place: &mut Option<Rect>,
    benchmark: &Benchmark,
    now: Duration,
) -> Option<BenchmarkRequest> {
    let mut request = None;
    let (space, is_small) = (space(ui.ctx()), is_small(ui.ctx()));
    let usual = Rect::from_min_size(
        space.min + Vec2::splat(MARGIN),
        vec2(
            USUAL_WIDTH.min(space.width() - 2.0 * MARGIN),
            space.height() - 2.0 * MARGIN,
        ),
    );
    let mut window = tool_window(ui.ctx(), PanelId::BENCHMARK.name(), "Benchmark");
    if !is_small {
        window = window
            .min_size(MIN_SIZE)
            .max_size(space.size() - Vec2::splat(2.0 * MARGIN));
    }
    let shown = window
        .open(is_open)
        .collapsible(false)
        .resizable(true)
        .default_rect(place.unwrap_or(usual).intersect(space))
        .show(ui, |ui| {
            head(ui, benchmark, now);
            ScrollArea::vertical()
                .id_salt("all")
                .auto_shrink(is_small)
                .show(ui, |ui| request = contents(ui, benchmark));
        });
    *place = shown.map(|shown| shown.response.rect).or(*place);
    request
}

/// The title of a suite, as in the menu.
fn title_of(suite: &str) -> &str {
    suites::all()
        .find(|known| known.name() == suite)
        .map_or(suite, |known| known.title)
}

/// Shows the header with the running or completed benchmark, above all that scrolls.
fn head(ui: &mut Ui, benchmark: &Benchmark, now: Duration) {
    match benchmark {
        Benchmark::Idle => {
            ui.label(
                "Choose a suite in the Benchmark menu. It measures the open sequence; playing is paused \
                meanwhile.",
            );
        }
        Benchmark::Running(running) => {
            ui.strong(title_of(&running.suite));
            bar(ui, &running.work, now);
            // However long the name of a step is, the layout below does not move.
            ui.add(Label::new(running.label()).truncate());
            cancel_button(ui, &running.work);
        }
        Benchmark::Cancelled(_) => {
            ui.label("The benchmark was cancelled.");
        }
        Benchmark::Failed(text, _) => {
            ui.label(RichText::new(text).color(ui.visuals().error_fg_color));
            if ui.button("Copy").clicked() {
                ui.ctx().copy_text(text.clone());
            }
        }
        Benchmark::Done(table) => {
            ui.strong(title_of(&table.suite));
            ui.weak(&table.adapter);
        }
    }
    ui.separator();
}

fn contents(ui: &mut Ui, benchmark: &Benchmark) -> Option<BenchmarkRequest> {
    let mut request = None;
    let points = benchmark.points();
    if let Benchmark::Done(table) = benchmark {
        request = done(ui, table).map(BenchmarkRequest::Save);
        if let Some((strategy, ms)) = table.fastest {
            request = fastest_ui(ui, strategy, ms).or(request);
        }
    }
    if !points.is_empty() {
        ui.separator();
        request = lab_ui(ui, &points).map(BenchmarkRequest::DrawAs).or(request);
    }
    let rates = benchmark.rates();
    if !rates.is_empty() {
        ui.separator();
        request = rates_ui(ui, &rates).map(BenchmarkRequest::ShowRetained).or(request);
    }
    request
}

/// The tables; returns the format in which the user wants to save them.
fn done(ui: &mut Ui, table: &BenchmarkTable) -> Option<ReportFormat> {
    ScrollArea::both().id_salt("table").max_height(260.0).show(ui, |ui| {
        for table in &table.tables {
            if !table.name.is_empty() {
                ui.strong(&table.name);
            }
            cells(ui, table);
        }
    });
    for note in &table.notes {
        ui.label(RichText::new(note).color(ui.visuals().warn_fg_color));
    }
    // Tables of variants by time and error, and by rate, have their own plots.
    if !table.bars.is_empty() && table.points.is_empty() && table.rates.is_empty() {
        ui.add_space(8.0);
        ui.label(&table.bars_title);
        chart(ui, table);
    }
    ui.separator();
    ui.horizontal(|ui| {
        let json = ui
            .button("Export JSON…")
            .on_hover_text("Everything measured, for programs");
        let csv = ui.button("Export CSV…").on_hover_text("The table, for spreadsheets");
        let html = (!table.html.is_empty()).then(|| {
            ui.button("Export page…")
                .on_hover_text("A page with the plot and the images, for browsers")
        });
        if json.clicked() {
            Some(ReportFormat::Json)
        } else if csv.clicked() {
            Some(ReportFormat::Csv)
        } else if html.is_some_and(|html| html.clicked()) {
            Some(ReportFormat::Html)
        } else {
            None
        }
    })
    .inner
}

/// Offers the strategy that was the fastest.
fn fastest_ui(ui: &mut Ui, strategy: Strategy, ms: f64) -> Option<BenchmarkRequest> {
    let title = Strategy::WORDS.list[strategy as usize].title;
    let button = ui.button(format!("Use the fastest: {title}"));
    let tooltip = format!("Draws by {title} from now on, which took {ms:.1} ms");
    let is_used = button.on_hover_text(tooltip).clicked();
    is_used.then_some(BenchmarkRequest::Use(strategy))
}

fn cells(ui: &mut Ui, table: &Table) {
    Grid::new(("cells", &table.name))
        .striped(true)
        .spacing([18.0, 4.0])
        .show(ui, |ui| {
            for column in &table.columns {
                ui.strong(column);
            }
            ui.end_row();
            for row in &table.rows {
                for cell in row {
                    ui.label(RichText::new(cell).monospace());
                }
                ui.end_row();
            }
        });
}

fn chart(ui: &mut Ui, table: &BenchmarkTable) {
    // The first row of the table is at the top.
    let bars: Vec<Bar> = (0..)
        .zip(table.bars.iter().rev())
        .map(|(place, (label, median_ms))| {
            Bar::new(f64::from(place), *median_ms)
                .name(label)
                .width(0.7)
                .fill(ACCENT)
        })
        .collect();
    let labels: Vec<String> = table.bars.iter().rev().map(|(label, _)| label.clone()).collect();
    let longest = labels.iter().map(|label| label.chars().count()).max().unwrap_or(0);
    Plot::new("bars")
        .height(BAR_HEIGHT * (bars.len() as f32 + 2.0))
        .allow_drag(false)
        .allow_zoom(false)
        .allow_scroll(false)
        .allow_boxed_zoom(false)
        .include_x(0.0)
        .y_axis_min_width(7.0 * longest as f32)
        .y_grid_spacer(|input| {
            let (from, to) = input.bounds;
            (from.ceil() as i64..=to.floor() as i64)
                .map(|place| egui_plot::GridMark {
                    value: place as f64,
                    step_size: 1.0,
                })
                .collect()
        })
        .y_axis_formatter(move |mark, _| {
            let place = mark.value.round();
            let label = (place >= 0.0).then(|| labels.get(place as usize)).flatten();
            label.cloned().unwrap_or_default()
        })
        .show(ui, |plot| {
            plot.bar_chart(BarChart::new(&table.bars_title, bars).horizontal().color(ACCENT));
        });
}
