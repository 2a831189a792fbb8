//! Commands that take a value: a script gives it, or an item of a menu.

use super::common::{Row, needs_sequence};
use super::playing::SPEEDS;
use crate::app::command::{Command, NumberUse, Offer};
use crate::app::presets::built_in;
use crate::app::recent::entry_name;
use crate::app::state::{State, WindowRequest};
use crate::scene::UpAxis;
use crate::scene::describe::Described;
use crate::timeline::{LoopMode, MAX_SPEED, MIN_SPEED};
use std::ops::RangeInclusive;
use std::path::PathBuf;

pub(super) const ROWS: &[Row] = &[
    Row::taking(Command::new("open"), "Open by name", "INPUT", |state, input| {
        state.open_paths(vec![PathBuf::from(input)]);
        Ok(())
    })
    .offers(|state, _| {
        recent(
            state,
            "Open recent",
            &["recent files", "reopen", "history", "last file"],
        )
    }),
    Row::taking(Command::new("compare"), "Compare by name", "INPUT", |state, input| {
        state.compare_paths(vec![PathBuf::from(input)]);
        Ok(())
    })
    .offers(|state, _| recent(state, "Compare with", &["recent files"]))
    .applies(needs_sequence),
    Row::taking(Command::new("frame"), "Go to a frame", "NUMBER", |state, number| {
        let count = state.player.as_ref().map_or(0, |player| player.sequence().len());
        match number.parse::<usize>() {
            Ok(place) if (1..=count).contains(&place) => {
                state.play_with(|player, now| player.seek(place - 1, now));
                Ok(())
            }
            _ => Err(format!("frames are numbered from 1 to {count}")),
        }
    })
    .offers(|state, number| {
        let count = state
            .player
            .as_ref()
            .map_or(usize::MAX, |player| player.sequence().len());
        let place = number.filter(|number| number.fract() == 0.0 && (1.0..=count as f64).contains(number));
        let to_it = place.map(|place| {
            Offer::new(format!("Go to frame {place}"), place.to_string())
                .also(FRAME_WORDS)
                .of_number(NumberUse::Alone)
        });
        let begun = Offer::begun("Go to frame…", "go to frame ").also(FRAME_WORDS);
        to_it.into_iter().chain([begun]).collect()
    })
    .applies(needs_sequence),
    Row::taking(Command::new("speed"), "Play at a speed", "FACTOR", |state, factor| {
        let is_offered = |speed: &f64| (MIN_SPEED..=MAX_SPEED).contains(&speed.abs());
        let Some(speed) = factor.parse().ok().filter(is_offered) else {
            return Err(format!(
                "speeds are numbers from {MIN_SPEED} to {MAX_SPEED}, or below 0 backward"
            ));
        };
        state.play_with(|player, now| player.set_speed(speed, now));
        Ok(())
    })
    .offers(|_, number| {
        let typed = number.filter(|speed| (MIN_SPEED..=MAX_SPEED).contains(speed));
        let typed = typed.map(|speed| speed_of(speed).of_number(NumberUse::Alone));
        let listed = SPEEDS.iter().filter(|speed| number != Some(**speed));
        typed.into_iter().chain(listed.map(|&speed| speed_of(speed))).collect()
    })
    .applies(needs_sequence),
    Row::taking(
        Command::new("frame rate"),
        "Play at a frame rate",
        "FPS",
        |state, rate| {
            let Some(fps) = rate.parse().ok().filter(|fps| RATES.contains(fps)) else {
                return Err(format!(
                    "frame rates are numbers from {} to {}",
                    RATES.start(),
                    RATES.end()
                ));
            };
            state.play_with(|player, now| player.set_fps(fps, now));
            Ok(())
        },
    )
    .offers(|_, number| {
        let typed = number.filter(|fps| RATES.contains(fps)).map(|fps| {
            Offer::new(format!("Frames per second: {fps}"), fps.to_string())
                .also(RATE_WORDS)
                .of_number(NumberUse::WithWords)
        });
        let begun = Offer::begun("Frames per second (fps)…", "frames per second ").also(RATE_WORDS);
        typed.into_iter().chain([begun]).collect()
    })
    .applies(needs_sequence),
    Row::taking(Command::new("loop"), "Loop in a mode", "MODE", |state, mode| {
        let Some((_, _, mode)) = LOOP_MODES.iter().find(|(word, ..)| *word == mode) else {
            return Err("loop modes are once, loop and ping-pong".to_owned());
        };
        state.play_with(|player, now| player.set_loop_mode(*mode, now));
        Ok(())
    })
    .offers(|_, _| {
        let offer = |&(word, title, _): &(&'static str, &str, _)| {
            Offer::new(format!("Loop mode: {title}"), word).also(&["repeat", "cycle", "playback mode"])
        };
        LOOP_MODES.iter().map(offer).collect()
    })
    .applies(needs_sequence),
    Row::taking(
        Command::new("field of view"),
        "Set the field of view",
        "DEGREES",
        |state, angle| {
            let Some(fov_deg) = angle.parse().ok().filter(|angle| FOV_DEG.contains(angle)) else {
                return Err(format!(
                    "fields of view are {} to {} degrees",
                    FOV_DEG.start(),
                    FOV_DEG.end()
                ));
            };
            state.camera.set_fov_deg(fov_deg);
            Ok(())
        },
    )
    .offers(|_, number| {
        let typed = number.filter(|angle| FOV_DEG.contains(angle));
        let offer = |angle| {
            Offer::new(format!("Field of view: {angle} °"), f64::to_string(&angle))
                .also(&["fov", "focal length", "lens", "zoom"])
                .of_number(NumberUse::WithWords)
        };
        typed.map(offer).into_iter().collect()
    }),
    Row::taking(Command::new("up"), "Turn an axis up", "AXIS", |state, axis| {
        let up = axis.parse().map_err(|error| format!("{error}"))?;
        state.choose_up(up);
        Ok(())
    })
    .offers(|_, _| {
        let offer = |&(word, axis): &(&'static str, UpAxis)| {
            Offer::new(format!("Up axis: {}", axis.label()), word)
                .hint("The axis of the file that points up on screen")
                .also(&["axes", "orientation", "upside down", "vertical axis", "flip"])
        };
        UpAxis::ALL.iter().map(offer).collect()
    })
    .applies(needs_sequence),
    Row::taking(Command::new("view"), "Look from a view", "TEXT", |state, text| {
        let camera = text.parse().map_err(|error| format!("{error}"))?;
        state.camera = camera;
        Ok(())
    }),
    Row::taking(Command::new("set"), "Change a setting", "NAME VALUE", set),
    Row::taking(Command::PRESET, "Take a preset", "NAME", preset).offers(|state, _| {
        let presets = state.stored.presets.list().iter();
        let offer = |name: &String| Offer::new(format!("Preset: {name}"), name.clone()).also(PRESET_WORDS);
        presets.map(|preset| offer(&preset.name)).collect()
    }),
    Row::taking(
        Command::BUILT_IN_PRESET,
        "Take a built-in preset",
        "NAME",
        built_in_preset,
    )
    .offers(|_, _| {
        let presets = built_in().into_iter();
        let offer = |name: &'static str, hint| {
            Offer::new(format!("Preset: {name}"), name)
                .hint(hint)
                .also(PRESET_WORDS)
        };
        presets.map(|(name, hint, _)| offer(name, hint)).collect()
    }),
    Row::taking(Command::DELETE_PRESET, "Delete a preset", "NAME", |state, name| {
        state.stored.presets.delete(name)
    }),
    Row::taking(
        Command::new("picture"),
        "Save image to a file",
        "FILE",
        |state, file| {
            state.request(WindowRequest::Screenshot(Some(PathBuf::from(file))));
            Ok(())
        },
    )
    .applies(needs_sequence),
    Row::taking(Command::new("click"), "Click in the viewport", "X Y", |state, place| {
        let shares: Vec<f32> = place
            .split_whitespace()
            .filter_map(|share| share.parse().ok())
            .collect();
        let &[x, y] = &shares[..] else {
            return Err("a position is two fractions of the image size, such as 0.5 0.5 for its centre".to_owned());
        };
        let rect = state.viewport.rect;
        state.click_at(rect.min + rect.size() * egui::vec2(x, y));
        Ok(())
    })
    .applies(needs_sequence),
];

const FRAME_WORDS: &[&str] = &["jump to frame", "seek", "time step", "frame number"];
const RATE_WORDS: &[&str] = &["fps", "frame rate", "playback rate"];
const PRESET_WORDS: &[&str] = &["look", "style", "profile", "quality"];

/// Frame rates that can be chosen.
const RATES: RangeInclusive<f64> = 0.1..=1000.0;

/// Fields of view that can be chosen, degrees.
const FOV_DEG: RangeInclusive<f64> = 5.0..=120.0;

/// Words and titles of the loop modes.
const LOOP_MODES: [(&str, &str, LoopMode); 3] = [
    ("once", "Once (off)", LoopMode::Off),
    ("loop", "Loop", LoopMode::Loop),
    ("ping-pong", "Ping-pong (bounce)", LoopMode::PingPong),
];

/// The offer to play at a speed.
fn speed_of(speed: f64) -> Offer {
    let also: &[&str] = match speed {
        _ if speed < 1.0 => &["slow motion", "slower", "playback speed", "half speed"],
        _ if speed > 1.0 => &["fast forward", "faster", "playback speed", "time-lapse"],
        _ => &["normal speed", "real time", "playback speed"],
    };
    Offer::new(format!("Speed {speed} ×"), speed.to_string()).also(also)
}

/// Offers of recently opened inputs: single files and folders.
fn recent(state: &State, text: &str, also: &'static [&'static str]) -> Vec<Offer> {
    let single = state.stored.recent.entries().iter().filter(|inputs| inputs.len() == 1);
    let offer = |inputs: &Vec<PathBuf>| {
        let value = inputs.first()?.to_str()?.to_owned();
        Some(Offer::new(format!("{text}: {}", entry_name(inputs)), value).also(also))
    };
    single.filter_map(offer).collect()
}

/// Gives a setting the value that the command line would.
fn set(state: &mut State, text: &str) -> Result<(), String> {
    let (name, value) = text.split_once(char::is_whitespace).unwrap_or((text, ""));
    let is_it = |described: &Described| {
        described.key == name || described.flag == name || described.other_flags.contains(&name)
    };
    let settings = state.style.settings();
    let Some((described, _)) = settings.into_iter().find(|(described, _)| is_it(described)) else {
        return Err(format!(
            "unknown setting {name}: settings have their names on the command line, without --"
        ));
    };
    let given = described.parse(value.trim())?;
    state.style.edit(&mut |other, before| {
        let chosen = given.iter().find(|(key, _)| *key == other.key);
        chosen.map_or(before, |(_, value)| *value)
    });
    Ok(())
}

/// Draws with the preset of this name.
fn preset(state: &mut State, name: &str) -> Result<(), String> {
    let is_name = |other: &str| other.eq_ignore_ascii_case(name);
    if let Some(preset) = state.stored.presets.list().iter().find(|preset| is_name(&preset.name)) {
        state.style = preset.settings;
        return Ok(());
    }
    built_in_preset(state, name)
}

/// Draws with the built-in preset of this name.
fn built_in_preset(state: &mut State, name: &str) -> Result<(), String> {
    let built_in = built_in();
    let Some((.., style)) = built_in.iter().find(|(other, ..)| other.eq_ignore_ascii_case(name)) else {
        return Err(format!("unknown preset {name}"));
    };
    state.draw_as(style);
    Ok(())
}
