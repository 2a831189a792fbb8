//! Bars of the long work that is under way, at the lower edge of the picture.

use crate::app::progress::left_text;
use crate::app::{Benchmark, Progress, State, Work, WorkKind};
use egui::{Align2, Area, Frame, Id, ProgressBar, Role, Ui, WidgetInfo, vec2};
use std::time::Duration;

/// Width of a bar, points.
const WIDTH: f32 = 300.0;

/// A bar, the time left and a button for each, once it takes long.
pub(super) fn works_ui(ui: &Ui, state: &State) {
    let now = state.now();
    let measuring = match &state.benchmark {
        // Its window has the same bar.
        Benchmark::Running(running) if !state.panels.benchmark => Some(&running.work),
        _ => None,
    };
    let works = state.works.list().iter().chain(measuring);
    let mut shown = works.filter(|work| work.is_long(now)).peekable();
    if shown.peek().is_none() {
        return;
    }
    let place = state.viewport.rect.center_bottom() - vec2(0.0, 12.0);
    Area::new(Id::unique("works"))
        .pivot(Align2::CENTER_BOTTOM)
        .fixed_pos(place)
        .show(ui.ctx(), |ui| {
            for work in shown {
                Frame::window(ui.style()).show(ui, |ui| {
                    ui.set_width(WIDTH);
                    ui.label(&work.name);
                    bar(ui, work, now);
                    cancel_button(ui, work.progress());
                });
            }
        });
}

/// How much is done, and the time left.
pub(super) fn bar(ui: &mut Ui, work: &Work, now: Duration) {
    let Some(share) = work.share() else {
        // Nothing moves here: a spinner would have the window drawn all the time.
        ui.weak(left_text(None));
        return;
    };
    let progress = work.progress();
    let (done, of) = (progress.done(), progress.of().unwrap_or(0));
    let unit = match work.kind {
        WorkKind::Open => "files ",
        WorkKind::Export => "pictures ",
        WorkKind::Benchmark => "",
    };
    let left = left_text(work.time_left(now));
    let text = format!("{unit}{done} of {of}, {left}");
    let bar = ui.add(ProgressBar::new(share).text(&text));
    bar.widget_info(|| WidgetInfo::labeled(Role::ProgressIndicator, true, &text));
}

/// Stops the work.
pub(super) fn cancel_button(ui: &mut Ui, progress: &Progress) {
    if progress.is_cancelled() {
        ui.weak("Stopping…");
    } else if ui
        .button("Cancel")
        .on_hover_text("Stops this; what is not whole is removed")
        .clicked()
    {
        progress.cancel();
    }
}
