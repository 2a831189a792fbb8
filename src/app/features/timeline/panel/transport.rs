//! The row under the bar: transport, place, pace.

use super::bar::own_number;
use super::context::TimelineContext;
use super::legend::legend_ui;
use crate::app::command::Command;
use crate::app::commands::keys_of;
use crate::app::features::timeline::{Quantity, Timeline};
use crate::app::theme::{BAD, Icon, paint_icon};
use crate::messages::grouped;
use crate::playback::Player;
use crate::timeline::{LoopMode, MAX_SPEED, MIN_SPEED};
use egui::{Align, ComboBox, DragValue, Label, Layout, Response, RichText, Role, Sense, Ui, WidgetInfo, vec2};
use std::time::Duration;

/// A window that is narrower has the row in two parts, points.
const ONE_ROW_WIDTH: f32 = 860.0;

/// Minimum width at which the name of the file is shown, points.
const MIN_NAME_WIDTH: f32 = 60.0;

/// Min height of a window with a row for the speed, points.
const MIN_PACE_HEIGHT: f32 = 280.0;

/// A row that is narrower has one button, points.
const ALL_BUTTONS_WIDTH: f32 = 240.0;

/// Size of a transport icon, points.
const ICON_SIZE: f32 = 13.0;

/// Transport and place from the left, pace from the right; in a narrow window one below the other.
pub(super) fn row_ui(ui: &mut Ui, context: &mut TimelineContext<'_>) -> Option<Command> {
    let mut command = None;
    if ui.available_width() < ONE_ROW_WIDTH {
        ui.horizontal(|ui| command = transport_and_place(ui, context));
        // The Playback menu has it as well.
        if ui.ctx().content_rect().height() >= MIN_PACE_HEIGHT {
            ui.horizontal_wrapped(|ui| {
                curve_choice(ui, context.timeline);
                legend_ui(ui);
                pace(ui, context);
            });
        }
        return command;
    }
    ui.horizontal(|ui| {
        // Right to left, so that a narrow window truncates only the name of the file.
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            pace(ui, context);
            legend_ui(ui);
            curve_choice(ui, context.timeline);
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                command = transport_and_place(ui, context);
            });
        });
    });
    command
}

fn transport_and_place(ui: &mut Ui, context: &TimelineContext<'_>) -> Option<Command> {
    let command = transport(ui, context.player.as_deref());
    ui.add_space(6.0);
    if let Some(player) = &context.player {
        place(ui, player);
    }
    command
}

/// Shows the choice of the number per frame that the curve under the bar displays.
fn curve_choice(ui: &mut Ui, timeline: &mut Timeline) {
    let name = |quantity: Option<Quantity>| quantity.map_or("Graph: none", Quantity::name);
    let mut quantity = timeline.quantity;
    ComboBox::from_id_salt("curve")
        .width(84.0)
        .selected_text(name(quantity))
        .show_ui(ui, |ui| {
            ui.selectable_value(&mut quantity, None, name(None))
                .on_hover_text("The bar alone");
            for choice in Quantity::ALL {
                ui.selectable_value(&mut quantity, Some(choice), choice.name())
                    .on_hover_text(choice.tooltip());
            }
        })
        .response
        .on_hover_text("Graph under the bar: a number of every frame that was prepared so far");
    timeline.quantity = quantity;
}

fn transport(ui: &mut Ui, player: Option<&Player>) -> Option<Command> {
    let mut clicked = None;
    let has_all_buttons = ui.available_width() >= ALL_BUTTONS_WIDTH;
    let playing = player.is_some_and(Player::is_playing);
    let (play_icon, play_text) = if playing {
        (Icon::Pause, "Pause")
    } else {
        (Icon::Play, "Play")
    };
    for (icon, text, command) in [
        (Icon::First, "First frame", Command::FIRST),
        (Icon::Back, "Previous frame", Command::PREVIOUS_FRAME),
        (play_icon, play_text, Command::TOGGLE_PLAY),
        (Icon::Forward, "Next frame", Command::NEXT_FRAME),
        (Icon::Last, "Last frame", Command::LAST),
    ] {
        let is_there = has_all_buttons || command == Command::TOGGLE_PLAY;
        if is_there && icon_button(ui, icon, text, command, player.is_some()).clicked() {
            clicked = Some(command);
        }
    }
    clicked
}

fn icon_button(ui: &mut Ui, icon: Icon, text: &str, command: Command, enabled: bool) -> Response {
    let wide = if command == Command::TOGGLE_PLAY { 40.0 } else { 30.0 };
    let sense = if enabled { Sense::click() } else { Sense::hover() };
    let (rect, response) = ui.allocate_exact_size(vec2(wide, 26.0), sense);
    response.widget_info(|| WidgetInfo::labeled(Role::Button, enabled, text));
    let visuals = ui.style().interact(&response);
    let fill = if command == Command::TOGGLE_PLAY && enabled {
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

/// Returns true if nothing can be played: a single frame that stays the only one.
pub(super) fn is_still(player: &Player) -> bool {
    player.sequence().len() == 1 && !player.sequence().source().may_grow()
}

/// Shows the controls of a single frame.
pub(super) fn still_ui(ui: &mut Ui, player: &Player) {
    shown_ui(ui, player);
    name_ui(ui, player, 0);
}

fn place(ui: &mut Ui, player: &Player) {
    let sequence = player.sequence();
    let frame = player.waiting_for().unwrap_or(player.clock().frame());
    let count = grouped(sequence.len());
    let digits = count.len();
    let text = format!("{:>digits$} of {count}", grouped(frame + 1));
    ui.label(RichText::new(text).monospace().strong());
    if let Some(number) = own_number(sequence, frame).filter(|_| ui.available_width() > MIN_NAME_WIDTH) {
        ui.weak(format!("file {number}"))
            .on_hover_text("The number in the name of the file");
    }
    shown_ui(ui, player);
    name_ui(ui, player, frame);
}

/// Shows the load state of the frame, and the number of its points that are shown.
fn shown_ui(ui: &mut Ui, player: &Player) {
    if player.waiting_for().is_some() {
        ui.weak("loading…");
    }
    if let Some(frame) = player.shown().filter(|frame| frame.is_sample()) {
        let share = frame.frame.points_in_file() as f64 / frame.frame.len().max(1) as f64;
        let why = if player.is_partial() {
            "the others are being read"
        } else {
            "this frame rate leaves no time for more. When paused, all are shown"
        };
        ui.label(RichText::new(format!("1/{share:.0} of points")).color(ui.visuals().warn_fg_color))
            .on_hover_text(format!(
                "{} of {} points are shown: {why}.",
                grouped(frame.frame.len()),
                grouped(frame.frame.points_in_file()),
            ));
    }
}

fn name_ui(ui: &mut Ui, player: &Player, frame: usize) {
    if !player.sequence().is_empty() && ui.available_width() > MIN_NAME_WIDTH {
        let entry = player.sequence().entry(frame);
        ui.add(Label::new(&entry.name).truncate())
            .on_hover_text(entry.path.display().to_string());
    }
}

/// From the right: fps asked and held, rate, speed, loop mode.
fn pace(ui: &mut Ui, context: &mut TimelineContext<'_>) {
    let now = context.now;
    let Some(player) = context.player.as_deref_mut() else {
        return;
    };
    held_ui(ui, player);
    let mut fps = player.clock().fps();
    let rate = DragValue::new(&mut fps)
        .range(0.1..=1000.0)
        .speed(0.2)
        .max_decimals(2)
        .suffix(" fps");
    if named(ui.add(rate), "Frame rate")
        .on_hover_text("Frames per second (fps) at speed 1")
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
    if ui.add(button).on_hover_text("Play backward (Backspace)").clicked() {
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
        .on_hover_text("Loop mode (L)");
    if mode != player.clock().loop_mode() {
        player.set_loop_mode(mode, now);
    }
    follow(ui, player, now);
}

/// Shows the frame rate achieved, in frames per second, of that requested, while it plays.
fn held_ui(ui: &mut Ui, player: &Player) {
    let Some(held) = player.fps_held().filter(|_| player.is_playing()) else {
        return;
    };
    let asked = player.clock().fps() * player.clock().speed().abs();
    let color = if held < 0.9 * asked {
        BAD
    } else {
        ui.visuals().text_color()
    };
    // Frames that catch up after late ones must not exceed the requested rate.
    let text = format!("{:.0} of {asked:.0} fps", held.min(asked));
    ui.label(RichText::new(text).monospace().color(color))
        .on_hover_text(format!(
            "Achieved and requested frames per second ({held:.1} of {asked:.1}).\nSince opening: {} shown, {} of \
                them with fewer points, {} late, {} skipped",
            grouped(player.frames_shown()),
            grouped(player.coarse_frames_shown()),
            grouped(player.late_frames()),
            grouped(player.clock().skipped())
        ));
}

/// Shows the toggle for following the newest frame of a folder that may grow as it comes.
fn follow(ui: &mut Ui, player: &mut Player, now: Duration) {
    if !player.sequence().source().may_grow() {
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

/// Gives a control without text a name for screen readers and tests.
fn named(response: Response, name: &str) -> Response {
    response
        .ctx
        .accesskit_node_builder(response.id, |node| node.set_label(name));
    response
}
