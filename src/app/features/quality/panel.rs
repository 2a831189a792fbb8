//! Quality slider from fast to exact, once the time and error of each render mode are known.

use super::{MeasuredQuality, QualityLimits};
use crate::app::widgets::rows::{heading, row, rows};
use crate::bench::{Quality, QualityChoice};
use crate::scene::Settings;
use egui::{Button, DragValue, Slider, Ui};

/// Request of the section to the window.
pub(super) enum QualityRequest {
    /// Measure the render modes.
    Measure,
    /// Draw the open sequence so.
    DrawAs(Box<Settings>),
}

/// A slider over the Pareto-optimal modes, and the two limits that choose one of them. Returns the request.
pub(super) fn quality_ui(ui: &mut Ui, quality: &mut MeasuredQuality, style: &Settings) -> Option<QualityRequest> {
    heading(ui, "Quality");
    if let Some(known) = &quality.known {
        let way = choose(ui, known, &mut quality.limits, style);
        return way.map(|way| QualityRequest::DrawAs(Box::new(way)));
    }
    let tooltip = "Benchmarks all render modes on the first frame against the reference, which takes a minute or \
        more. Then one slider chooses from fast to exact. The result is saved with this sequence";
    let button = ui.add(Button::new("Measure…")).on_hover_text(tooltip);
    button.clicked().then_some(QualityRequest::Measure)
}

/// Shows the slider and the limits; returns the render mode chosen in this pass.
fn choose(ui: &mut Ui, quality: &Quality, limits: &mut QualityLimits, style: &Settings) -> Option<Settings> {
    let choices = quality.choices();
    let current = choices
        .iter()
        .position(|choice| style.drawn_as(&choice.style) == *style);
    let mut wanted = current;
    let before = *limits;
    rows(ui, "quality", |ui| {
        // If the current settings are not among the choices, the slider is placed by the draw time.
        let mut place = current.unwrap_or(choices.len() - 1);
        row(
            ui,
            "Fast to exact",
            "Render modes that no other beats in both time and error, as measured on this machine",
            Slider::new(&mut place, 0..=choices.len() - 1).show_value(false),
        );
        if current.unwrap_or(choices.len() - 1) != place {
            wanted = Some(place);
        }
        let error = DragValue::new(&mut limits.flip)
            .range(0.0..=1.0)
            .speed(0.002)
            .max_decimals(3);
        row(
            ui,
            "Error below",
            "Draws in the fastest way whose error (FLIP of the object, 0 to 1) is at most this",
            error,
        );
        let time = DragValue::new(&mut limits.draw_ms)
            .range(0.1..=10_000.0)
            .speed(0.5)
            .max_decimals(1)
            .suffix(" ms");
        row(
            ui,
            "Time within",
            "Uses the render mode with the smallest error that takes at most this time per image",
            time,
        );
    });
    let place_of = |chosen: &QualityChoice| choices.iter().position(|choice| choice == chosen);
    if limits.flip != before.flip {
        wanted = place_of(quality.fastest_below(limits.flip));
    } else if limits.draw_ms != before.draw_ms {
        wanted = place_of(quality.best_within(limits.draw_ms));
    }
    let Some(choice) = wanted.and_then(|place| choices.get(place)) else {
        ui.weak("Custom settings");
        return None;
    };
    ui.weak(format!(
        "{:.1} ms, FLIP {:.3}: {}",
        choice.draw_ms, choice.flip, choice.label
    ));
    (wanted != current).then_some(choice.style)
}
