//! A colour map as a bar, and two handles over a histogram of the values.

use crate::analysis::{ColorMap, ColorScale, histogram, quantile_range};
use egui::{Color32, CursorIcon, Id, Mesh, Painter, Pos2, Rect, Role, Sense, Stroke, Ui, Vec2, WidgetInfo, pos2, vec2};

/// Strips that a ramp is painted in.
const STRIPS: u16 = 64;

/// Bars of a histogram.
const BINS: usize = 80;

const BAR_HEIGHT: f32 = 12.0;
const HISTOGRAM_HEIGHT: f32 = 56.0;

/// Values at the ends that the histogram leaves to its first and last bar: a thousandth.
const TAIL: f64 = 0.001;

/// The colours of `map` over `rect`, from left to right, or from bottom to top if it is upright.
pub(in crate::app) fn paint_ramp(painter: &Painter, rect: Rect, map: ColorMap, is_upright: bool) {
    let mut mesh = Mesh::default();
    for strip in 0..STRIPS {
        let [begin, end] = [strip, strip + 1].map(|edge| f32::from(edge) / f32::from(STRIPS));
        let strip = if is_upright {
            let at = |share: f32| rect.bottom() - rect.height() * share;
            Rect::from_min_max(pos2(rect.left(), at(end)), pos2(rect.right(), at(begin)))
        } else {
            let at = |share: f32| rect.left() + rect.width() * share;
            Rect::from_min_max(pos2(at(begin), rect.top()), pos2(at(end), rect.bottom()))
        };
        let [red, green, blue, _] = map.color(0.5 * (begin + end));
        mesh.add_colored_rect(strip, Color32::from_rgb(red, green, blue));
    }
    painter.add(mesh);
}

/// A bar of the map with the available width.
pub(in crate::app) fn ramp_ui(ui: &mut Ui, map: ColorMap) {
    let (bar, response) = ui.allocate_exact_size(bar_size(ui, BAR_HEIGHT), Sense::hover());
    response.on_hover_text("The colour map, from the first colour to the last");
    paint_ramp(ui.painter(), bar, map, false);
    ui.add_space(4.0);
}

fn bar_size(ui: &Ui, height: f32) -> Vec2 {
    vec2(ui.available_width().clamp(120.0, 420.0), height)
}

/// A histogram of the ascending `sorted` and `offset` with the ends of `scale` as handles; where they were dragged to,
/// if they were.
pub(in crate::app) fn handles_ui(
    ui: &mut Ui,
    sorted: &[f32],
    offset: f64,
    scale: &ColorScale,
    map: ColorMap,
) -> Option<[f64; 2]> {
    let axis = axis_of(sorted, offset, scale)?;
    let size = bar_size(ui, HISTOGRAM_HEIGHT);
    let (area, response) = ui.allocate_exact_size(size, Sense::click_and_drag());
    let response = response
        .on_hover_text("How many values there are (logarithm of the number); the ends of the colours can be dragged");
    response.widget_info(|| WidgetInfo::labeled(Role::Slider, true, "Range of colours"));
    let counts = histogram(sorted, offset, &axis, BINS);
    paint_histogram(ui.painter(), area, &counts, &axis, scale, map);
    let x_of = |value: f64| area.left() + area.width() * axis.share(value);
    let ends = scale.ends();
    let places = ends.map(x_of);
    for x in places {
        let stroke = Stroke::new(1.5, ui.visuals().strong_text_color());
        ui.painter()
            .line_segment([pos2(x, area.top()), pos2(x, area.bottom())], stroke);
        let knob = Rect::from_center_size(pos2(x, area.bottom()), vec2(7.0, 7.0));
        ui.painter().rect_filled(knob, 2.0, ui.visuals().strong_text_color());
    }
    dragged(ui, &response, places).map(|(handle, place)| {
        let share = f64::from((place.x - area.left()) / area.width()).clamp(0.0, 1.0);
        let value = axis.value_at(share);
        let [low, high] = ends;
        if handle == 0 {
            [value.min(high), high]
        } else {
            [low, value.max(low)]
        }
    })
}

/// Returns the axis range of the histogram: nearly all values, and the colour range; linear or logarithmic like the
/// colours.
fn axis_of(sorted: &[f32], offset: f64, scale: &ColorScale) -> Option<ColorScale> {
    let begin = if scale.is_logarithmic() {
        sorted.partition_point(|&value| f64::from(value) + offset <= 0.0)
    } else {
        0
    };
    let [min, max] = quantile_range(&sorted[begin..], offset, TAIL..1.0 - TAIL)?;
    let [low, high] = scale.ends();
    let axis = ColorScale::new(min.min(low), max.max(high), scale.is_logarithmic());
    (axis.ends()[0] < axis.ends()[1]).then_some(axis)
}

fn paint_histogram(
    painter: &Painter,
    area: Rect,
    counts: &[u32],
    axis: &ColorScale,
    scale: &ColorScale,
    map: ColorMap,
) {
    painter.rect_filled(area, 3.0, Color32::from_black_alpha(70));
    let max = counts.iter().copied().max().unwrap_or(0).max(1);
    let height = |count: u32| f64::from(count).ln_1p() / f64::from(max).ln_1p();
    let mut mesh = Mesh::default();
    for (bin, &count) in counts.iter().enumerate() {
        let share = |edge: usize| edge as f32 / BINS as f32;
        let center = axis.value_at((bin as f64 + 0.5) / BINS as f64);
        let [red, green, blue, _] = map.color(scale.share(center));
        let bar = Rect::from_min_max(
            pos2(
                area.left() + area.width() * share(bin),
                area.bottom() - area.height() * height(count) as f32,
            ),
            pos2(area.left() + area.width() * share(bin + 1), area.bottom()),
        );
        mesh.add_colored_rect(bar, Color32::from_rgb(red, green, blue));
    }
    painter.add(mesh);
}

/// Returns the handle being dragged and the pointer position. The nearer one is taken, and held until the button is
/// released.
fn dragged(ui: &Ui, response: &egui::Response, places: [f32; 2]) -> Option<(usize, Pos2)> {
    if response.hovered() || response.dragged() {
        ui.set_cursor_icon(CursorIcon::ResizeHorizontal);
    }
    let id: Id = response.id.with("handle");
    let place = response.interact_pointer_pos()?;
    if response.drag_started() || response.clicked() {
        let away = places.map(|x| (x - place.x).abs());
        let nearer = usize::from(away[1] < away[0] || (away[1] == away[0] && place.x > places[1]));
        ui.data_mut(|data| data.insert_temp(id, nearer));
    }
    if !response.dragged() && !response.clicked() {
        return None;
    }
    let held = ui.data(|data| data.get_temp::<usize>(id))?;
    Some((held, place))
}
