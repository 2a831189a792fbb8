//! The timeline: a bar to scrub on, with what is in memory and what failed, and the transport under it.

use crate::app::State;
use crate::app::command::{Command, keys_of};
use crate::app::theme::{ACCENT, BAD, COARSE, Icon, PENDING, RESIDENT, paint_icon};
use crate::playback::{Mark, Player, Run};
use crate::scene::Scene;
use crate::sequence::{LoopMode, MAX_SPEED, MIN_SPEED, Slot};
use egui::{
    Align, Color32, ComboBox, DragValue, Label, Layout, Painter, Rect, Response, RichText, Role,
    Sense, Stroke, Ui, WidgetInfo, pos2, vec2,
};
use std::time::Duration;

/// Height of the bar, points.
const BAR_HEIGHT: f32 = 24.0;

/// Frames narrower than this have no line between them, points.
const MIN_TICK_WIDTH: f32 = 7.0;

/// A broken frame is seen however long the sequence is, points.
const MIN_FAILED_WIDTH: f32 = 3.0;

/// Size of a transport icon, points.
const ICON_SIZE: f32 = 13.0;

/// Bar, transport, place and pace.
pub fn timeline_ui(ui: &mut Ui, state: &mut State) {
    if let Some(player) = &mut state.player {
        player.refresh_runs();
    }
    scrub_bar(ui, state);
    ui.add_space(4.0);
    ui.horizontal(|ui| {
        // From the right, so that a narrow window cuts the name of the file and nothing else.
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            pace(ui, state);
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                transport(ui, state);
                ui.add_space(6.0);
                place(ui, state);
            });
        });
    });
}

fn scrub_bar(ui: &mut Ui, state: &mut State) {
    let size = vec2(ui.available_width(), BAR_HEIGHT);
    let (rect, response) = ui.allocate_exact_size(size, Sense::click_and_drag());
    let Some(player) = &state.player else {
        ui.painter()
            .rect_filled(rect, 4.0, ui.visuals().extreme_bg_color);
        return;
    };
    let count = player.sequence().len();
    let playhead = player.waiting_for().unwrap_or(player.clock().frame());
    response.widget_info(|| WidgetInfo::slider(true, (playhead + 1) as f64, "Timeline"));
    paint_bar(ui, rect, player.runs(), count, playhead);
    let under_pointer = |response: &Response| {
        response
            .interact_pointer_pos()
            .or(response.hover_pos())
            .map(|pos| frame_at(rect, pos.x, count))
    };
    if let Some(frame) = under_pointer(&response)
        && response.hovered()
        && !response.dragged()
    {
        let text = tooltip(state, player, frame);
        response.clone().on_hover_text_at_pointer(text);
    }
    scrub(state, &response, under_pointer(&response));
}

/// The playhead follows the pointer; playing goes on when it is let go.
fn scrub(state: &mut State, response: &Response, frame: Option<usize>) {
    let Some(frame) = frame else { return };
    if response.drag_started() {
        state.play_with_scrubbing(true);
    }
    if response.dragged() || response.clicked() {
        let now = state.now();
        if let Some(player) = &mut state.player
            && player.clock().frame() != frame
        {
            player.seek(frame, now);
        }
    }
    if response.drag_stopped() {
        state.play_with_scrubbing(false);
    }
}

fn frame_at(rect: Rect, x: f32, count: usize) -> usize {
    let part = ((x - rect.left()) / rect.width().max(1.0)).clamp(0.0, 1.0);
    ((part * count as f32) as usize).min(count.saturating_sub(1))
}

fn paint_bar(ui: &Ui, rect: Rect, runs: &[Run], count: usize, playhead: usize) {
    let painter = ui.painter_at(rect.expand(2.0));
    painter.rect_filled(rect, 4.0, ui.visuals().extreme_bg_color);
    let count = count.max(1) as f32;
    let x = |frame: usize| rect.left() + rect.width() * frame as f32 / count;
    for run in runs {
        let (color, min_width) = match run.mark {
            Mark::Absent => continue,
            Mark::Pending => (PENDING, 0.0),
            Mark::Coarse => (COARSE, 0.0),
            Mark::Resident => (RESIDENT, 0.0),
            Mark::Failed => (BAD, MIN_FAILED_WIDTH),
        };
        let right = x(run.end).max(x(run.start) + min_width);
        let span = Rect::from_min_max(pos2(x(run.start), rect.top()), pos2(right, rect.bottom()));
        painter.rect_filled(span, 0.0, color);
    }
    let width = rect.width() / count;
    if width >= MIN_TICK_WIDTH {
        let stroke = Stroke::new(1.0, Color32::from_black_alpha(90));
        for frame in 1..count as usize {
            painter.vline(x(frame), rect.y_range(), stroke);
        }
    }
    paint_playhead(&painter, rect, x(playhead), x(playhead + 1));
}

fn paint_playhead(painter: &Painter, rect: Rect, left: f32, right: f32) {
    let right = right.max(left + 2.0);
    let cell = Rect::from_min_max(
        pos2(left, rect.top() - 2.0),
        pos2(right, rect.bottom() + 2.0),
    );
    painter.rect_filled(cell, 2.0, ACCENT.gamma_multiply(0.55));
    let middle = 0.5 * (left + right);
    painter.rect_filled(
        Rect::from_center_size(
            pos2(middle, rect.center().y),
            vec2(3.0, rect.height() + 4.0),
        ),
        1.5,
        Color32::WHITE,
    );
}

fn tooltip(state: &State, player: &Player, frame: usize) -> String {
    let sequence = player.sequence();
    let head = format!(
        "Frame {} of {}\n{}",
        frame + 1,
        sequence.len(),
        sequence.source(frame).name
    );
    let rest = match player.loader().get(frame, &Scene::needs(&state.settings)) {
        Slot::Ready(prepared) => format!(
            "in memory, {} points",
            super::grouped(prepared.points.len() as u64)
        ),
        Slot::Coarse(prepared) => format!(
            "in memory, {} of {} points",
            super::grouped(prepared.points.len() as u64),
            super::grouped(prepared.frame.points_in_file() as u64)
        ),
        Slot::Stale(_) => "in memory, being made ready for these settings".to_owned(),
        Slot::Pending => "not in memory".to_owned(),
        Slot::Failed(error) => error.to_string(),
    };
    format!("{head}\n{rest}")
}

fn transport(ui: &mut Ui, state: &mut State) {
    let playing = state.player.as_ref().is_some_and(Player::is_playing);
    let (play_icon, play_text) = if playing {
        (Icon::Pause, "Pause")
    } else {
        (Icon::Play, "Play")
    };
    for (icon, text, command) in [
        (Icon::First, "First frame", Command::First),
        (Icon::Back, "Previous frame", Command::Step(-1)),
        (play_icon, play_text, Command::TogglePlay),
        (Icon::Forward, "Next frame", Command::Step(1)),
        (Icon::Last, "Last frame", Command::Last),
    ] {
        if icon_button(ui, icon, text, command, state.player.is_some()).clicked() {
            state.run(command);
        }
    }
}

fn icon_button(ui: &mut Ui, icon: Icon, text: &str, command: Command, enabled: bool) -> Response {
    let wide = if command == Command::TogglePlay {
        40.0
    } else {
        30.0
    };
    let sense = if enabled {
        Sense::click()
    } else {
        Sense::hover()
    };
    let (rect, response) = ui.allocate_exact_size(vec2(wide, 26.0), sense);
    response.widget_info(|| WidgetInfo::labeled(Role::Button, enabled, text));
    let visuals = ui.style().interact(&response);
    let fill = if command == Command::TogglePlay && enabled {
        ui.visuals().selection.bg_fill
    } else {
        visuals.weak_bg_fill
    };
    ui.painter().rect(
        rect,
        visuals.corner_radius,
        fill,
        visuals.bg_stroke,
        egui::StrokeKind::Inside,
    );
    let color = if enabled {
        visuals.text_color()
    } else {
        ui.visuals().weak_text_color()
    };
    paint_icon(ui.painter(), icon, rect.center(), ICON_SIZE, color);
    response.on_hover_text(format!("{text} ({})", keys_of(command)))
}

fn place(ui: &mut Ui, state: &State) {
    let Some(player) = &state.player else { return };
    let sequence = player.sequence();
    let frame = player.waiting_for().unwrap_or(player.clock().frame());
    let digits = sequence.len().to_string().len();
    let text = format!("frame {:>digits$}/{}", frame + 1, sequence.len());
    ui.label(RichText::new(text).monospace().strong());
    if player.waiting_for().is_some() {
        ui.weak("loading…");
    }
    if let Some(frame) = player.shown().filter(|frame| frame.is_sample()) {
        let share = frame.frame.points_in_file() as f64 / frame.frame.len().max(1) as f64;
        ui.label(RichText::new(format!("1/{share:.0} of points")).color(ui.visuals().warn_fg_color))
            .on_hover_text(format!(
                "{} of {} points are shown: there is no time for more at this frame rate. All are, when paused.",
                super::grouped(frame.frame.len() as u64),
                super::grouped(frame.frame.points_in_file() as u64),
            ));
    }
    if !sequence.is_empty() {
        let source = sequence.source(frame);
        ui.add(Label::new(&source.name).truncate())
            .on_hover_text(source.path.display().to_string());
    }
}

/// From the right: fps asked and held, rate, speed, loop mode.
fn pace(ui: &mut Ui, state: &mut State) {
    let now = state.now();
    let Some(player) = &mut state.player else {
        return;
    };
    let held = player.fps_held();
    let asked = player.clock().fps() * player.clock().speed().abs();
    let text = held.map_or_else(|| "—".to_owned(), |fps| format!("{fps:.1}"));
    let color = match held {
        Some(fps) if fps < 0.9 * asked => BAD,
        _ => ui.visuals().text_color(),
    };
    ui.label(
        RichText::new(format!("{text:>5} held"))
            .monospace()
            .color(color),
    )
    .on_hover_text(format!(
        "Frames a second shown in the last second; {asked:.1} are asked for.\n\
         Since opening: {} shown, {} of them with fewer points, {} late, {} skipped",
        player.frames_shown(),
        player.coarse_frames_shown(),
        player.late_frames(),
        player.clock().skipped()
    ));

    let mut fps = player.clock().fps();
    let rate = DragValue::new(&mut fps)
        .range(0.1..=1000.0)
        .speed(0.2)
        .max_decimals(2)
        .suffix(" fps");
    if named(ui.add(rate), "Frame rate")
        .on_hover_text("Frames a second at speed 1 (fps)")
        .changed()
    {
        player.set_fps(fps, now);
    }

    let mut speed = player.clock().speed();
    let mut size = speed.abs();
    let drag = DragValue::new(&mut size)
        .range(MIN_SPEED..=MAX_SPEED)
        .speed(0.02)
        .max_decimals(2)
        .suffix(" ×");
    if named(ui.add(drag), "Speed")
        .on_hover_text("Speed, a factor of the frame rate ([ and ])")
        .changed()
    {
        speed = size.copysign(speed);
        player.set_speed(speed, now);
    }
    let reverse = speed < 0.0;
    let button = egui::Button::selectable(reverse, "Reverse");
    if ui
        .add(button)
        .on_hover_text("Play backward (Backspace)")
        .clicked()
    {
        player.set_speed(-speed, now);
    }

    let mut mode = player.clock().loop_mode();
    ComboBox::from_id_salt("loop mode")
        .width(92.0)
        .selected_text(loop_name(mode))
        .show_ui(ui, |ui| {
            for other in LoopMode::ALL {
                ui.selectable_value(&mut mode, other, loop_name(other));
            }
        })
        .response
        .on_hover_text("What happens at the ends of the sequence (L)");
    if mode != player.clock().loop_mode() {
        player.set_loop_mode(mode, now);
    }
    follow(ui, player, now);
}

/// Whether the newest frame of a folder that may grow is shown as it comes.
fn follow(ui: &mut Ui, player: &mut Player, now: Duration) {
    if !player.sequence().may_grow() {
        return;
    }
    let follows = player.follows_newest();
    let button = egui::Button::selectable(follows, "Follow");
    if ui
        .add(button)
        .on_hover_text("Show the newest frame of this folder as it comes (Shift+End)")
        .clicked()
    {
        player.follow_newest(!follows, now);
    }
}

fn loop_name(mode: LoopMode) -> &'static str {
    match mode {
        LoopMode::Off => "Play once",
        LoopMode::Loop => "Loop",
        LoopMode::PingPong => "Ping-pong",
    }
}

/// Gives a control without a text of its own a name for screen readers and tests.
fn named(response: Response, name: &str) -> Response {
    response
        .ctx
        .accesskit_node_builder(response.id, |node| node.set_label(name));
    response
}
