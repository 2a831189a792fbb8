//! Windows over the image: they stay off the menu and the timeline, and get their place and size back after the
//! program's window was small.
//!
//! How it works. egui remembers place and size of a window by its id. In a small window of the program a tool has
//! another id, so its squeezed size is forgotten when there is space again. There it is never larger than the space,
//! and its contents scroll; where menu and timeline leave next to nothing, it may lie over them.

use egui::{Context, Id, Rect, TextStyle, Vec2, Window, vec2};

/// In less space than this, tools are squeezed, points.
const SMALL: [f32; 2] = [760.0, 440.0];

/// In less height than this between menu and timeline, tools may lie over both, points.
const MIN_HEIGHT: f32 = 160.0;

/// Margin between a squeezed tool and the edges of its space, points.
const MARGIN: f32 = 2.0;

/// Sets the space for windows: the area without menu and timeline. False in the first pass after the program's window
/// was resized: the heights of these are not known yet, windows would be squeezed into the rest of the previous size,
/// and are not to be shown. The pass is repeated.
pub(in crate::app) fn note_free_rect(ctx: &Context, space: Rect) -> bool {
    let all = ctx.content_rect();
    let space = if space.height() < MIN_HEIGHT { all } else { space };
    let size = all.size();
    let before: Option<Vec2> = ctx.data(|data| data.get_temp(size_id()));
    ctx.data_mut(|data| {
        data.insert_temp(free_rect_id(), space);
        data.insert_temp(size_id(), size);
    });
    let is_settled = before.is_none_or(|before| before == size);
    if !is_settled {
        // In this pass menu and timeline have the heights of the previous size, and tool windows would be squeezed.
        ctx.request_discard("the window has another size");
        ctx.request_repaint();
    }
    is_settled
}

fn size_id() -> Id {
    Id::unique("size that the room of tools is of")
}

fn free_rect_id() -> Id {
    Id::unique("room of tools")
}

/// Returns the rectangle that [`note_free_rect`] recorded in this pass.
pub(in crate::app) fn space(ctx: &Context) -> Rect {
    ctx.data(|data| data.get_temp(free_rect_id()))
        .unwrap_or_else(|| ctx.content_rect())
}

/// Returns true if there is so little space that tools are compressed and scroll.
pub(in crate::app) fn is_small(ctx: &Context) -> bool {
    let space = space(ctx);
    space.width() < SMALL[0] || space.height() < SMALL[1]
}

/// The id of the window of a tool, for the available space.
pub(in crate::app) fn tool_id(ctx: &Context, name: &'static str) -> Id {
    Id::unique(("tool", name, is_small(ctx)))
}

/// A window of a tool. Tools with their own scroll areas use `.scroll(false)`.
pub(in crate::app) fn tool_window<'a>(ctx: &Context, name: &'static str, title: &'a str) -> Window<'a> {
    let space = space(ctx).shrink(MARGIN);
    let window = Window::new(title).id(tool_id(ctx, name)).constrain_to(space);
    if !is_small(ctx) {
        return window;
    }
    let style = ctx.global_style();
    let title_height = style.text_styles[&TextStyle::Heading].size + 2.0 * style.spacing.item_spacing.y;
    let border = style.spacing.window_margin.sum() + Vec2::splat(2.0 * style.visuals.window_stroke.width);
    window
        .scroll(true)
        .max_size((space.size() - border - vec2(0.0, title_height + border.y)).max(Vec2::ZERO))
}
