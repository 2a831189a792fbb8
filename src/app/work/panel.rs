//! Progress bars of long-running work, below the notices.

use super::works::{Work, WorkKind};
use crate::app::work::works::left_text;
use crate::messages::grouped;
use crate::printable;
use crate::waiting::waits;
use egui::{Frame, ProgressBar, Role, Ui, WidgetInfo};
use std::time::Duration;

/// Shows one task at the given width: its name, a progress bar with the remaining time, and a button.
pub(in crate::app) fn work_ui(ui: &mut Ui, work: &Work, now: Duration, width: f32) {
    Frame::window(ui.style()).show(ui, |ui| {
        ui.set_width(width);
        ui.label(&work.name);
        if matches!(work.kind, WorkKind::Open | WorkKind::Read) {
            waits_ui(ui);
        }
        bar(ui, work, now);
        cancel_button(ui, work);
    });
}

/// Waits for other machines.
fn waits_ui(ui: &mut Ui) {
    // Work is shown once it has taken longer than this.
    const MIN_SHOWN: Duration = Duration::from_millis(200);
    for wait in waits(MIN_SHOWN).iter().take(2) {
        ui.weak(printable::text(&format!("Waiting for {}", wait.what)));
    }
}

/// Shows a progress bar with the completed share and the remaining time.
pub(in crate::app) fn bar(ui: &mut Ui, work: &Work, now: Duration) {
    let Some(share) = work.share() else {
        // Nothing is animated here: a spinner would make the window redraw all the time.
        ui.weak(match work.kind {
            WorkKind::Read => "Decoding and preparing…".to_owned(),
            _ => left_text(None),
        });
        return;
    };
    let progress = work.progress();
    let [done, of] = [progress.done(), progress.of().unwrap_or(0)].map(grouped);
    let so_far = match work.kind {
        WorkKind::Open => format!("files {done} of {of}"),
        WorkKind::Read => format!("{:.0} %", (100.0 * share).floor()),
        WorkKind::Export => format!("image {done} of {of}"),
        WorkKind::Save => format!("frames {done} of {of}"),
        WorkKind::Benchmark => format!("{done} of {of}"),
    };
    let text = format!("{so_far}, {}", left_text(work.time_left(now)));
    let bar = ui.add(ProgressBar::new(share).text(&text));
    bar.widget_info(|| WidgetInfo::labeled(Role::ProgressIndicator, true, &text));
}

/// Stops the work.
pub(in crate::app) fn cancel_button(ui: &mut Ui, work: &Work) {
    let progress = work.progress();
    let tooltip = match work.kind {
        WorkKind::Save => "Stops this; saving the same again goes on from here",
        _ => "Cancels; incomplete files are removed",
    };
    if progress.is_cancelled() {
        ui.weak("Stopping…");
    } else if ui.button("Cancel").on_hover_text(tooltip).clicked() {
        progress.cancel();
    }
}
