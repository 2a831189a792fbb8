//! A way to draw that was chosen by its measured time and error, or with a session. Who draws and how many pixels is no
//! part of a document; that of such a way is used for the open sequence alone, and comes back with the next.

use super::MeasuredQuality;
use crate::app::features::feature::Feature;
use crate::app::features::quality::MeasuredWay;
use crate::app::side::Side;
use crate::app::state::State;
use crate::scene::Settings;

impl State {
    /// Draws the open sequence as `way`, which was measured with it.
    pub fn draw_as_measured(&mut self, way: &Settings) {
        let before = self.usual_style(self.style);
        self.draw_as(way);
        let chosen = self.style;
        self.opening.measured_way = Some(MeasuredWay { before, chosen });
    }

    /// Settings as they are for other sequences.
    pub(in crate::app) fn usual_style(&self, style: Settings) -> Settings {
        self.opening.measured_way.map_or(style, |way| way.undone(style))
    }

    /// The settings, those of A where two ways to draw are compared.
    pub(in crate::app) fn style_of_a(&self) -> Settings {
        let comparison = self.features.comparison.as_ref();
        let of_a = comparison.filter(|comparison| comparison.edited == Side::B);
        of_a.map_or(self.style, |comparison| comparison.other)
    }
}

impl Feature<State> for MeasuredQuality {
    /// Reads what was measured of the open sequence before.
    fn update(state: &mut State) -> bool {
        let Some(player) = &state.player else {
            return false;
        };
        state.features.quality.look(&state.graphics.adapter, player.sequence())
    }

    fn forget_sequence(state: &mut State) {
        state.opening.measured_way = None;
        state.features.quality.forget();
    }
}
