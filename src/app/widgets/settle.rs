//! Windows whose size changes with their content.

use egui::{Id, InnerResponse, Ui, Vec2};

/// Reruns the panels when the size of the window `name` differs from the last pass: its content takes its new places
/// then.
pub(in crate::app) fn settle<R>(ui: &Ui, name: &'static str, shown: Option<InnerResponse<R>>) {
    let size = shown.map(|shown| shown.response.rect.size());
    let id = Id::unique(name).with("size");
    let before = ui.data_mut(|data| {
        let before = data.get_temp::<Option<Vec2>>(id);
        data.insert_temp(id, size);
        before
    });
    if before.is_some_and(|before| before != size) {
        ui.ctx().request_repaint();
    }
}
