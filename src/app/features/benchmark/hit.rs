//! Hit test of the pointer against the points of a plot.

use egui_plot::{PlotPoint, PlotResponse};

/// Maximum distance of a click from a point, screen points.
const REACH: f32 = 14.0;

/// Finds, of points at `places` of a plot, the one that is hovered and the one that was clicked.
pub(super) fn hit<R>(plot: &PlotResponse<R>, places: &[[f64; 2]]) -> (Option<usize>, Option<usize>) {
    let nearest = |pointer: egui::Pos2| {
        let on_screen = |[x, y]: [f64; 2]| plot.transform.position_from_point(&PlotPoint::new(x, y));
        let distances = places.iter().map(|&place| on_screen(place).distance(pointer));
        let nearest = distances.enumerate().min_by(|a, b| a.1.total_cmp(&b.1));
        nearest
            .filter(|(_, distance)| *distance <= REACH)
            .map(|(index, _)| index)
    };
    let hovered = plot.response.hover_pos().and_then(nearest);
    (hovered, plot.response.clicked().then_some(hovered).flatten())
}
