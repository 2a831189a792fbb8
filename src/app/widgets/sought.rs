//! A row of a panel that was searched by name: it is scrolled into view, and briefly framed.

use crate::app::theme::ACCENT;
use egui::{Align, Context, Id, Response, Stroke, StrokeKind};
use std::time::Duration;

/// Duration of the highlight frame, seconds.
const FRAMED_S: f64 = 2.5;

#[derive(Debug, Clone, Copy, Default)]
struct Sought {
    /// As its label has it.
    title: &'static str,
    /// When it was met, in the seconds of the window.
    found_s: Option<f64>,
}

fn id() -> Id {
    Id::unique("sought row")
}

/// The row with this title is looked for from now on.
pub(in crate::app) fn seek(ctx: &Context, title: &'static str) {
    ctx.data_mut(|data| data.insert_temp(id(), Sought { title, found_s: None }));
    ctx.request_repaint();
}

/// Returns true if a searched row has not been found yet.
pub(in crate::app) fn is_missing(ctx: &Context) -> bool {
    let sought = ctx.data(|data| data.get_temp::<Sought>(id()));
    sought.is_some_and(|sought| sought.found_s.is_none())
}

/// Nothing is looked for any more.
pub(in crate::app) fn give_up(ctx: &Context) {
    ctx.data_mut(|data| data.remove_temp::<Sought>(id()));
}

/// Handles each label that can be searched for: this one has the text `text`.
pub(in crate::app) fn meet(label: &Response, text: &str) {
    let ctx = &label.ctx;
    let Some(mut sought) = ctx.data(|data| data.get_temp::<Sought>(id())) else {
        return;
    };
    if sought.title != text {
        return;
    }
    let now_s = ctx.input(|input| input.time);
    let found_s = *sought.found_s.get_or_insert_with(|| {
        label.scroll_to_me(Some(Align::Center));
        now_s
    });
    let left_s = found_s + FRAMED_S - now_s;
    if left_s <= 0.0 {
        return give_up(ctx);
    }
    ctx.data_mut(|data| data.insert_temp(id(), sought));
    let frame = label.rect.expand2(egui::vec2(4.0, 2.0));
    ctx.layer_painter(label.layer_id)
        .with_clip_rect(label.rect.expand(8.0))
        .rect_stroke(frame, 3.0, Stroke::new(1.5, ACCENT), StrokeKind::Outside);
    ctx.request_repaint_after(Duration::from_secs_f64(left_s));
}
