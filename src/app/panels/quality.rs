//! From fast to exact by one slider, once it is known what each way to draw takes and how wrong it is.

use super::settings::{heading, row, rows};
use crate::app::State;
use crate::bench::{Quality, suites};
use egui::{Button, DragValue, Slider, Ui};

/// A slider over the ways that no other beats, and the two limits that choose one of them.
pub(super) fn quality_ui(ui: &mut Ui, state: &mut State) {
    if state.player.is_none() {
        return;
    }
    heading(ui, "Quality");
    if let Some(quality) = state.quality.known.clone() {
        choose(ui, state, &quality);
        return;
    }
    let tooltip = "Draws the first frame in every way and compares it with the truth, which takes a minute or more. \
        Then one slider chooses from fast to exact. What was measured is kept for this sequence";
    let measure = ui.add(Button::new("Measure…")).on_hover_text(tooltip);
    if measure.clicked() {
        state.start_benchmark(suites::ERROR);
    }
}

fn choose(ui: &mut Ui, state: &mut State, quality: &Quality) {
    let choices = quality.choices();
    let current = choices
        .iter()
        .position(|choice| state.style.drawn_as(&choice.style) == state.style);
    let mut wanted = current;
    let mut limits = state.quality.limits;
    rows(ui, "quality", |ui| {
        // Without a place among the choices, the slider stands where the time of pictures would put it.
        let mut place = current.unwrap_or(choices.len() - 1);
        row(
            ui,
            "Fast to exact",
            "The ways to draw that no other beats in time and error, as measured on this machine",
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
            "Draws in the way with the least error that takes at most this for a picture",
            time,
        );
    });
    let place_of = |chosen: &crate::bench::QualityChoice| choices.iter().position(|choice| choice == chosen);
    if limits.flip != state.quality.limits.flip {
        wanted = place_of(quality.fastest_below(limits.flip));
    } else if limits.draw_ms != state.quality.limits.draw_ms {
        wanted = place_of(quality.best_within(limits.draw_ms));
    }
    state.quality.limits = limits;
    match wanted.and_then(|place| choices.get(place)) {
        Some(choice) => {
            ui.weak(format!(
                "{:.1} ms, FLIP {:.3}: {}",
                choice.draw_ms, choice.flip, choice.label
            ));
            if wanted != current {
                state.draw_as(&choice.style);
            }
        }
        None => {
            ui.weak("Drawn in a way of your own");
        }
    }
}
