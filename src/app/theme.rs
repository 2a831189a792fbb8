//! Colours, spacing and the icons of the transport buttons.
//!
//! Icons are painted rather than taken from a font: they are sharp at any scale and look the same everywhere.

use egui::{Color32, Context, CornerRadius, Painter, Pos2, Rect, Shape, Stroke, Theme, ThemePreference, Visuals, vec2};

/// Accent colour of the selection and the playhead.
pub(super) const ACCENT: Color32 = Color32::from_rgb(86, 156, 255);

/// Colours of the x, y and z axes, wherever axes are shown.
pub(super) const AXIS_COLORS: [Color32; 3] = [
    Color32::from_rgb(235, 100, 100),
    Color32::from_rgb(120, 200, 110),
    Color32::from_rgb(100, 150, 250),
];
/// Colour of failures.
pub(super) const BAD: Color32 = Color32::from_rgb(236, 92, 92);
/// Colour of anomalies.
pub(super) const ODD: Color32 = Color32::from_rgb(240, 180, 80);
/// Colour of completed actions.
pub(super) const GOOD: Color32 = Color32::from_rgb(98, 190, 130);
/// Frames in memory with fewer points than in the file.
pub(super) const COARSE: Color32 = Color32::from_rgb(62, 116, 112);
/// Frames in memory.
pub(super) const RESIDENT: Color32 = Color32::from_rgb(72, 104, 152);
/// Frames being prepared.
pub(super) const PENDING: Color32 = Color32::from_rgb(58, 70, 92);

/// Sets the look of the window: light or dark as the system is, dark if unknown. The user may choose otherwise
/// ([`super::Appearance::theme`]).
pub fn apply_theme(ctx: &Context) {
    ctx.set_theme(ThemePreference::System);
    ctx.all_styles_mut(|style| {
        style.spacing.item_spacing = vec2(8.0, 6.0);
        style.spacing.button_padding = vec2(8.0, 3.0);
        style.spacing.interact_size.y = 24.0;
        style.spacing.slider_width = 120.0;
        style.spacing.combo_width = 150.0;
        style.interaction.tooltip_delay = 0.4;
    });
    ctx.set_visuals_of(Theme::Dark, shaped(dark()));
    ctx.set_visuals_of(Theme::Light, shaped(light()));
}

/// Applies the visuals shared by both themes.
fn shaped(mut visuals: Visuals) -> Visuals {
    visuals.window_corner_radius = CornerRadius::same(8);
    visuals.menu_corner_radius = CornerRadius::same(6);
    visuals.slider_trailing_fill = true;
    let widgets = &mut visuals.widgets;
    for widget in [
        &mut widgets.noninteractive,
        &mut widgets.inactive,
        &mut widgets.hovered,
        &mut widgets.active,
        &mut widgets.open,
    ] {
        widget.corner_radius = CornerRadius::same(4);
        widget.expansion = 0.0;
    }
    visuals
}

fn dark() -> Visuals {
    let mut visuals = Visuals::dark();
    visuals.panel_fill = Color32::from_rgb(27, 30, 37);
    visuals.window_fill = Color32::from_rgb(31, 35, 43);
    visuals.window_stroke = Stroke::new(1.0, Color32::from_rgb(52, 58, 70));
    visuals.extreme_bg_color = Color32::from_rgb(18, 20, 25);
    visuals.faint_bg_color = Color32::from_rgb(34, 38, 47);
    visuals.selection.bg_fill = Color32::from_rgb(44, 92, 165);
    visuals.selection.stroke = Stroke::new(1.0, Color32::WHITE);
    visuals.hyperlink_color = ACCENT;
    visuals.error_fg_color = BAD;
    visuals.warn_fg_color = ODD;
    let text = |level: u8| Stroke::new(1.0, Color32::from_gray(level));
    let widgets = &mut visuals.widgets;
    widgets.noninteractive.bg_stroke = Stroke::new(1.0, Color32::from_rgb(46, 51, 62));
    widgets.noninteractive.fg_stroke = text(205);
    widgets.inactive.bg_fill = Color32::from_rgb(50, 56, 68);
    widgets.inactive.weak_bg_fill = Color32::from_rgb(44, 49, 60);
    widgets.inactive.fg_stroke = text(215);
    widgets.hovered.bg_fill = Color32::from_rgb(66, 74, 90);
    widgets.hovered.weak_bg_fill = Color32::from_rgb(58, 65, 80);
    widgets.hovered.bg_stroke = Stroke::new(1.0, Color32::from_rgb(92, 104, 128));
    widgets.hovered.fg_stroke = text(245);
    widgets.active.bg_fill = Color32::from_rgb(76, 86, 108);
    widgets.active.weak_bg_fill = Color32::from_rgb(70, 80, 100);
    widgets.open.weak_bg_fill = Color32::from_rgb(50, 56, 68);
    visuals
}

/// Egui's light theme, with text dark enough to read and an accent that is visible on white.
fn light() -> Visuals {
    let mut visuals = Visuals::light();
    visuals.panel_fill = Color32::from_rgb(240, 242, 246);
    visuals.window_fill = Color32::from_rgb(248, 249, 251);
    visuals.window_stroke = Stroke::new(1.0, Color32::from_rgb(196, 202, 212));
    visuals.extreme_bg_color = Color32::WHITE;
    visuals.faint_bg_color = Color32::from_rgb(230, 233, 239);
    visuals.selection.bg_fill = Color32::from_rgb(158, 198, 255);
    visuals.selection.stroke = Stroke::new(1.0, Color32::from_rgb(10, 40, 90));
    visuals.hyperlink_color = Color32::from_rgb(20, 92, 200);
    visuals.error_fg_color = Color32::from_rgb(178, 30, 30);
    visuals.warn_fg_color = Color32::from_rgb(150, 88, 0);
    let text = |level: u8| Stroke::new(1.0, Color32::from_gray(level));
    let widgets = &mut visuals.widgets;
    widgets.noninteractive.fg_stroke = text(45);
    // For check boxes and sliders: the default of egui is as light as the panel.
    widgets.inactive.bg_fill = Color32::from_rgb(192, 198, 209);
    widgets.inactive.fg_stroke = text(40);
    widgets.hovered.fg_stroke = text(10);
    visuals
}

/// Icon of a transport button.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Icon {
    /// To the first frame.
    First,
    /// One frame back.
    Back,
    /// Play.
    Play,
    /// Pause.
    Pause,
    /// One frame on.
    Forward,
    /// To the last frame.
    Last,
}

/// Paints `icon` in a square of `size` around `center`.
pub(super) fn paint_icon(painter: &Painter, icon: Icon, center: Pos2, size: f32, color: Color32) {
    let half = 0.5 * size;
    // x from -1 (left) to 1 (right), y from -1 (top) to 1 (bottom).
    let at = |x: f32, y: f32| center + vec2(x * half, y * half);
    let triangle = |from: f32, tip: f32| {
        painter.add(Shape::convex_polygon(
            vec![at(from, -0.85), at(tip, 0.0), at(from, 0.85)],
            color,
            Stroke::NONE,
        ));
    };
    let bar = |from: f32, to: f32| {
        painter.rect_filled(Rect::from_two_pos(at(from, -0.85), at(to, 0.85)), 1.0, color);
    };
    match icon {
        Icon::Play => triangle(-0.65, 0.85),
        Icon::Pause => {
            bar(-0.65, -0.18);
            bar(0.18, 0.65);
        }
        Icon::Forward => {
            bar(-0.75, -0.45);
            triangle(-0.25, 0.8);
        }
        Icon::Back => {
            bar(0.45, 0.75);
            triangle(0.25, -0.8);
        }
        Icon::Last => {
            triangle(-0.75, 0.4);
            bar(0.45, 0.75);
        }
        Icon::First => {
            triangle(0.75, -0.4);
            bar(-0.75, -0.45);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::Rgba;

    /// Contrast ratio of two colours (WCAG 2.1): 1 to 21.
    fn contrast(one: Color32, other: Color32) -> f32 {
        let luminance = |color: Color32| {
            let linear = Rgba::from(color);
            0.2126 * linear.r() + 0.7152 * linear.g() + 0.0722 * linear.b()
        };
        let [one, other] = [luminance(one), luminance(other)];
        (one.max(other) + 0.05) / (one.min(other) + 0.05)
    }

    #[test]
    fn text_is_legible_on_all_backgrounds_in_light_and_dark() {
        let ctx = Context::default();
        apply_theme(&ctx);
        for theme in [Theme::Dark, Theme::Light] {
            let visuals = ctx.style_of(theme).visuals.clone();
            assert_eq!(visuals.dark_mode, theme == Theme::Dark);
            let widgets = &visuals.widgets;
            let texts = [
                ("plain text", widgets.noninteractive.text_color()),
                ("errors", visuals.error_fg_color),
                ("warnings", visuals.warn_fg_color),
                ("links", visuals.hyperlink_color),
            ];
            for (what, color) in texts {
                for fill in [visuals.panel_fill, visuals.window_fill] {
                    let contrast = contrast(color, fill);
                    assert!(contrast >= 4.5, "{theme:?}: {what} {contrast}");
                }
            }
            for widget in [&widgets.inactive, &widgets.hovered, &widgets.active] {
                let contrast = contrast(widget.text_color(), widget.weak_bg_fill);
                assert!(contrast >= 4.5, "{theme:?}: a button {contrast}");
            }
            for fill in [visuals.panel_fill, visuals.window_fill] {
                let contrast = contrast(widgets.inactive.bg_fill, fill);
                assert!(contrast >= 1.3, "{theme:?}: a box to tick {contrast}");
            }
            let chosen = contrast(visuals.selection.stroke.color, visuals.selection.bg_fill);
            assert!(chosen >= 4.5, "{theme:?}: what is chosen {chosen}");
        }
    }
}
