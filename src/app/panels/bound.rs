//! Panels of features in the window: what each is given of the state, and what becomes of what it asks for.

use super::quality::QualityRequest;
use super::settings::{SettingsContext, SettingsRequest, settings_ui};
use crate::app::command::Command;
use crate::app::features::assumptions::panel::{self as assumptions_panel, assumptions_ui, chip_ui};
use crate::app::features::benchmark::panel::{BenchmarkRequest, benchmark_ui};
use crate::app::features::beside::panel::{BesideRequest, beside_ui};
use crate::app::features::camera_path::panel::camera_path_ui;
use crate::app::features::camera_path::request::PathRequest;
use crate::app::features::clipping::handles::handles_ui;
use crate::app::features::comparison::panel::{ComparisonRequest, comparison_ui};
use crate::app::features::export::panel::{ExportRequest, export_ui};
use crate::app::features::inspection::Tool;
use crate::app::features::inspection::measuring_panel::measuring_ui;
use crate::app::features::inspection::point_panel::{PointContext, point_ui};
use crate::app::features::labels::panel::{self as labels_panel, LabelsRequest, labels_ui};
use crate::app::features::palette::panel::palette_ui;
use crate::app::features::palette::{Action, Entry};
use crate::app::features::photos::Photos;
use crate::app::features::photos::frusta::frusta_ui;
use crate::app::features::photos::panel::{self as photos_panel, PhotosRequest, photos_ui};
use crate::app::features::save::panel::{SaveRequest, save_ui};
use crate::app::features::temporal::panel::change_ui;
use crate::app::features::timeline::panel::{TimelineContext, TimelineRequest, timeline_ui};
use crate::app::features::trails::panel::trail_ui;
use crate::app::presets::built_in;
use crate::app::widgets::overlay::PictureOverlay;
use crate::app::widgets::sought::seek;
use crate::app::{Benchmark, PanelId, Side, State};
use crate::bench::suites;
use crate::playback::Player;
use crate::scene::{Primitive, Scene};
use crate::timeline::DEFAULT_FPS;
use egui::Ui;

/// The list of assumptions.
pub(super) fn assumptions(ui: &mut Ui, state: &mut State) {
    if !state.panels.has(assumptions_panel::PANEL) {
        return;
    }
    let groups = state.assumptions();
    let corner = state.viewport.rect.right_top();
    let mut is_open = true;
    let changes = assumptions_ui(ui, &mut is_open, &groups, corner);
    state.panels.set(assumptions_panel::PANEL, is_open);
    state.choose(changes);
}

/// The chip with the number of assumptions about the open sequence.
pub(super) fn assumptions_chip(ui: &mut Ui, state: &mut State) {
    let groups = state.assumptions();
    if !groups.is_empty() && chip_ui(ui, &groups, state.panels.has(assumptions_panel::PANEL)) {
        state.panels.toggle(assumptions_panel::PANEL);
    }
}

pub(super) fn benchmark(ui: &mut Ui, state: &mut State) {
    let now = state.now();
    let mut is_open = state.panels.has(PanelId::BENCHMARK);
    let request = benchmark_ui(
        ui,
        &mut is_open,
        &mut state.appearance.benchmark_place,
        &state.benchmark,
        now,
    );
    state.panels.set(PanelId::BENCHMARK, is_open);
    match request {
        Some(BenchmarkRequest::Save(format)) => state.ask_for_report(format),
        Some(BenchmarkRequest::DrawAs(way)) => state.draw_as_measured(&way.style),
        Some(BenchmarkRequest::Use(strategy)) => state.style.drawing.strategy = strategy,
        Some(BenchmarkRequest::ShowKept(way)) => state.compare_with_kept(way.options.clone(), &way.label),
        None => {}
    }
}

/// The bar of two ways to draw, or of two sequences.
pub(super) fn pair(ui: &mut Ui, state: &mut State) {
    if let Some(comparison) = &mut state.comparison {
        match comparison_ui(ui, comparison) {
            Some(ComparisonRequest::Edit(side)) => state.edit_side(side),
            Some(ComparisonRequest::Use(side)) => state.end_comparison(side),
            None => {}
        }
    }
    if let (Some(beside), Some(player)) = (&mut state.beside, &state.player) {
        match beside_ui(ui, beside, player) {
            Some(BesideRequest::Measure) => state.measure_distances(),
            Some(BesideRequest::Close) => state.run(Command::CloseComparison),
            None => {}
        }
    }
}

pub(super) fn timeline(ui: &mut Ui, state: &mut State) {
    let mut context = TimelineContext {
        needs: Scene::needs(&state.drawn_style()),
        now: state.now(),
        player: state.player.as_mut(),
        timeline: &mut state.timeline,
        thumbnails: &mut state.thumbnails,
    };
    for request in timeline_ui(ui, &mut context) {
        match request {
            TimelineRequest::Run(command) => state.run(command),
            TimelineRequest::Keep => state.keep_document(),
        }
    }
}

pub(super) fn camera_path(ui: &mut Ui, state: &mut State) {
    let player = state.player.as_ref();
    let fps = player.map_or(DEFAULT_FPS, |player| player.clock().fps());
    let corner = state.viewport.rect.left_top();
    let mut is_open = state.panels.has(PanelId::CAMERA_PATH);
    let request = camera_path_ui(ui, &mut is_open, &mut state.path, fps, corner);
    state.panels.set(PanelId::CAMERA_PATH, is_open);
    match request {
        Some(PathRequest::Run(command)) => state.run(command),
        Some(PathRequest::GoTo(time_s)) => state.set_path_time(time_s),
        Some(PathRequest::Replace(index)) => state.replace_keyframe(index),
        None => {}
    }
}

pub(super) fn export(ui: &mut Ui, state: &mut State) {
    let of = state.exportable();
    let top = state.viewport.rect.center_top();
    let mut is_open = state.panels.has(PanelId::EXPORT);
    let request = export_ui(ui, &mut is_open, &mut state.export, &of, top);
    state.panels.set(PanelId::EXPORT, is_open);
    match request {
        Some(ExportRequest::ChoosePlace) => state.ask_for_place(),
        Some(ExportRequest::Start) => state.start_export(),
        None => {}
    }
}

pub(super) fn save(ui: &mut Ui, state: &mut State) {
    if !state.panels.has(PanelId::SAVE) {
        return;
    }
    let of = state.savable();
    let top = state.viewport.rect.center_top();
    let mut is_open = true;
    let request = save_ui(ui, &mut is_open, (&mut state.save, &state.estimates), &of, top);
    state.panels.set(PanelId::SAVE, is_open);
    match request {
        Some(SaveRequest::ChoosePlace) => state.ask_for_save_place(),
        Some(SaveRequest::Compare) => state.compare_with_saved(),
        Some(SaveRequest::Start) => state.start_save(),
        None => {}
    }
}

pub(super) fn point(ui: &mut Ui, state: &mut State) {
    let index_in_file = state.inspection.point.as_ref().map(|point| point.values.index_in_file);
    let trail = state.player.as_ref().and_then(|player| {
        let time_s = |frame| player.time_s(frame);
        state.trails.measure(index_in_file?, time_s)
    });
    let names = state.beside.as_ref().map(|beside| {
        let name = state.sequence_name().unwrap_or_default();
        [name, beside.name.clone()]
    });
    let side = state.inspection.point.as_ref().map(|point| point.anchor.side);
    let sequence = match (side, &state.beside) {
        (Some(Side::B), Some(beside)) => Some(beside.companion.sequence()),
        _ => state.player.as_ref().map(Player::sequence),
    };
    let frame_count = sequence.map_or(0, |sequence| sequence.len());
    let context = PointContext {
        camera: &state.camera,
        names,
        trail,
        frame_count,
        unit: state.length_unit(),
    };
    let corner = state.viewport.rect.left_top();
    let trails = &mut state.trails;
    point_ui(ui, &mut state.inspection, &context, corner, |ui, anchor| {
        trail_ui(ui, trails, anchor);
    });
}

pub(super) fn measuring(ui: &mut Ui, state: &mut State) {
    let up = state.camera.up.direction();
    let corner = state.viewport.rect.left_bottom();
    let unit = state.length_unit();
    measuring_ui(ui, &mut state.inspection, (up, unit), corner);
}

pub(super) fn labels(ui: &mut Ui, state: &mut State) {
    if !state.panels.has(labels_panel::PANEL) {
        return;
    }
    let count = state.player.as_ref().map_or(0, |player| player.sequence().len());
    let is_placing = state.inspection.tool == Tool::Label;
    let corner = state.viewport.rect.right_top();
    let mut is_open = true;
    let request = labels_ui(ui, &mut is_open, &mut state.labels, (count, is_placing), corner);
    state.panels.set(labels_panel::PANEL, is_open);
    match request {
        Some(LabelsRequest::ToggleTool) => state.run(Command::ToggleTool(Tool::Label)),
        Some(LabelsRequest::GoTo(index)) => state.go_to_label(index),
        None => {}
    }
}

pub(super) fn change(ui: &mut Ui, state: &mut State) {
    let player = state.player.as_ref();
    let shown = player.and_then(|player| Some((player.shown()?, player.sequence().len())));
    let colors = state.style.colors.map;
    let corner = state.viewport.rect.right_top();
    change_ui(ui, &mut state.temporal, shown, colors, corner);
}

/// The handles of what is clipped, over the picture of the open sequence.
pub(super) fn clip_handles(ui: &Ui, state: &mut State) {
    let is_shown = state.clipping.shows_outline;
    let Some(frames) = state.clipped_frames().filter(|_| is_shown) else {
        return;
    };
    let unit = state.length_unit();
    let rect = state.viewport.rect;
    let painter = ui.painter_at(rect);
    let canvas = PictureOverlay::new(&painter, rect, state.viewport.size_px, &state.camera);
    if let Some(clip) = state.style.clip.as_mut().filter(|clip| clip.is_on) {
        handles_ui(ui, &canvas, (&mut state.clipping, clip), &frames, unit);
    }
}

/// Where photographs were taken, over the picture of the open sequence.
pub(super) fn photo_frusta(ui: &Ui, state: &mut State) {
    let set = state.player.as_ref().and_then(Photos::set_of);
    let Some(set) = set.filter(|_| state.photos.shows_frusta) else {
        return;
    };
    let rect = state.viewport.rect;
    let painter = ui.painter_at(rect);
    let canvas = PictureOverlay::new(&painter, rect, state.viewport.size_px, &state.camera);
    if let Some(number) = frusta_ui(ui, &canvas, &set, &mut state.photos) {
        state.stand_at_photo(number);
    }
}

pub(super) fn photos(ui: &mut Ui, state: &mut State) {
    let set = state.player.as_ref().and_then(Photos::set_of);
    let corner = state.viewport.rect.left_top();
    let mut is_open = state.panels.has(photos_panel::PANEL);
    let request = photos_ui(ui, &mut is_open, &mut state.photos, set.as_deref(), corner);
    state.panels.set(photos_panel::PANEL, is_open);
    if let Some(PhotosRequest::StandAt(number)) = request {
        state.stand_at_photo(number);
    }
}

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
        angle: state.inspection.last_angle(),
        frames,
        clipping: &mut state.clipping,
        quality: &mut state.quality,
        camera: &mut state.camera,
        turntable: &mut state.motion.turntable,
        present: &mut state.appearance.present,
        has_legend: &mut has_legend,
        shows_advanced: &mut state.appearance.shows_advanced,
        thumbnails: &mut state.thumbnails,
        trails: &mut state.trails,
        temporal: &mut state.temporal,
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

/// The list of all that can be asked for, `more` beside what the palette knows by itself.
pub(super) fn palette(ui: &mut Ui, state: &mut State, more: &[Entry]) {
    let presets = state.presets.list().iter();
    let presets: Vec<String> = presets.map(|preset| preset.name.clone()).collect();
    let Some(action) = palette_ui(ui, &mut state.palette, &presets, more) else {
        return;
    };
    match action {
        Action::Run(command) => state.run(command),
        Action::Set(key, value) => state
            .style
            .edit(&mut |described, before| if described.key == key { value } else { before }),
        Action::Take(shorthand) => state.style.take(shorthand),
        Action::BuiltIn(place) => {
            if let Some((.., style)) = built_in().get(place) {
                state.draw_as(style);
            }
        }
        Action::Preset(place) => {
            if let Some(preset) = state.presets.list().get(place) {
                state.style = preset.settings;
            }
        }
        Action::Measure(suite) => {
            if !matches!(state.benchmark, Benchmark::Running(_)) {
                state.start_benchmark(suite);
            }
        }
        Action::ShowSetting(title) => {
            state.panels.set(PanelId::SETTINGS, true);
            seek(ui.ctx(), title);
        }
    }
}
