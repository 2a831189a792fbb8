//! The panel of settings in the window: what it is given of the state, and what becomes of what it asks for.

use super::quality::QualityRequest;
use super::settings::{SettingsContext, SettingsRequest, settings_ui};
use crate::app::{PanelId, State};
use crate::bench::suites;
use crate::scene::Primitive;
use egui::Ui;

pub(super) fn settings(ui: &mut Ui, state: &mut State) {
    let frames = state.clipped_frames();
    let drawn = state.drawn_style();
    let look = state.first_look();
    let primitive = look.map(|look| (look.primitive, look.primitive_why));
    let up_why = look.map(|look| look.up_why);
    let lack = |&primitive: &Primitive| Some((primitive, look?.lack_of(primitive)?));
    let lacks: Vec<_> = Primitive::ALL.iter().filter_map(lack).collect();
    let mut has_legend = state.panels.has(PanelId::LEGEND);
    let mut context = SettingsContext {
        player: state.player.as_ref(),
        style: &mut state.style,
        drawn,
        primitive,
        lacks: &lacks,
        up_why,
        angle: state.features.inspection.last_angle(),
        frames,
        clipping: &mut state.features.clipping,
        quality: &mut state.features.quality,
        camera: &mut state.camera,
        turntable: &mut state.motion.turntable,
        present: &mut state.appearance.present,
        has_legend: &mut has_legend,
        shows_advanced: &mut state.appearance.shows_advanced,
        thumbnails: &mut state.features.thumbnails,
        trails: &mut state.features.trails,
        temporal: &mut state.features.temporal,
    };
    let request = settings_ui(ui, &mut context);
    state.panels.set(PanelId::LEGEND, has_legend);
    match request {
        Some(SettingsRequest::Quality(QualityRequest::Measure)) => state.start_benchmark(suites::ERROR),
        Some(SettingsRequest::Quality(QualityRequest::DrawAs(way))) => state.draw_as_measured(&way),
        Some(SettingsRequest::ChooseUp(up)) => state.choose_up(up),
        Some(SettingsRequest::FilterDepth(filters)) => state.filter_depth(filters),
        Some(SettingsRequest::Reset) => state.reset_settings(),
        None => {}
    }
}
