//! Scripts: one command per line, run in the window as a user would, for tests and demonstrations.
//!
//! **How it works.** A line is the title or the word of a command ([`commands`]), followed by a value for commands that
//! take one; `#` begins a comment. `wait 2` waits 2 seconds, `wait shown` until the requested content is in the image,
//! `wait done` until all tasks have ended, such as the writing of a file. Names are looked up before the first line is
//! run; a command that does not apply when its turn comes ends the program with file, line and reason.

use super::command::{Act, Command};
use super::commands::{commands, row_of};
use super::panels::menu_panels;
use super::state::State;
use super::work::works::WorkKind;
use std::collections::VecDeque;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Polling interval for the conditions that a script waits for.
const LOOK_INTERVAL: Duration = Duration::from_millis(30);

/// Errors of reading or running a script.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ScriptError {
    /// The file.
    #[error("{} cannot be read: {reason}", file.display())]
    Unreadable {
        /// Its name.
        file: PathBuf,
        /// Error message of the system.
        reason: String,
    },
    /// A line of it.
    #[error("{}, line {line}: {reason}", file.display())]
    Line {
        /// The name of the file.
        file: PathBuf,
        /// The number of the line, from 1.
        line: usize,
        /// Description of the problem.
        reason: String,
    },
}

/// Script step requested by a line.
#[derive(Debug, Clone, PartialEq)]
enum Step {
    Run(Command),
    Take(Command, String),
    Wait(Duration),
    WaitShown,
    WaitDone,
}

/// A running script.
#[derive(Debug, Clone)]
pub struct Script {
    file: PathBuf,
    steps: VecDeque<(usize, Step)>,
    /// When the last line that was waited for began.
    begun: Option<Duration>,
}

impl Script {
    /// Reads a script from a file.
    pub fn read(file: &Path) -> Result<Self, ScriptError> {
        let text = fs::read_to_string(file).map_err(|reason| ScriptError::Unreadable {
            file: file.to_owned(),
            reason: reason.to_string(),
        })?;
        Self::of(file, &text)
    }

    /// Reads the text of a script that is called `file`.
    pub fn of(file: &Path, text: &str) -> Result<Self, ScriptError> {
        let lines = text.lines().zip(1..);
        let lines = lines.map(|(line, number)| (number, line.trim()));
        let lines = lines.filter(|(_, line)| !line.is_empty() && !line.starts_with('#'));
        let steps = lines.map(|(number, line)| match step(line) {
            Ok(step) => Ok((number, step)),
            Err(reason) => Err(ScriptError::Line {
                file: file.to_owned(),
                line: number,
                reason,
            }),
        });
        Ok(Self {
            file: file.to_owned(),
            steps: steps.collect::<Result<_, _>>()?,
            begun: None,
        })
    }

    /// Runs the lines that are due at `now`. True if one was run.
    pub fn advance(&mut self, state: &mut State, now: Duration) -> Result<bool, ScriptError> {
        let mut has_run = false;
        while let Some((line, step)) = self.steps.front() {
            let begun = *self.begun.get_or_insert(now);
            // The state sees the effect of a line at its next update: a wait begins after that.
            let is_over = match step {
                Step::Wait(length) => now >= begun + *length,
                Step::WaitShown => !has_run && now > begun && is_shown(state),
                Step::WaitDone => !has_run && now > begun && is_done(state),
                Step::Run(_) | Step::Take(..) => true,
            };
            if !is_over {
                break;
            }
            let outcome = match step {
                Step::Run(command) => run(state, *command, None),
                Step::Take(command, value) => run(state, *command, Some(value)),
                Step::Wait(_) | Step::WaitShown | Step::WaitDone => Ok(()),
            };
            let is_step = matches!(step, Step::Run(_) | Step::Take(..));
            has_run |= is_step;
            if is_step {
                // As a user would do it: one change after another.
                state.note_step();
            }
            if let Err(reason) = outcome {
                return Err(ScriptError::Line {
                    file: self.file.clone(),
                    line: *line,
                    reason,
                });
            }
            self.steps.pop_front();
            self.begun = None;
        }
        Ok(has_run)
    }

    /// Time at which [`Script::advance`] has something to do without input; `None` at its end.
    pub fn next_deadline(&self, now: Duration) -> Option<Duration> {
        let (_, step) = self.steps.front()?;
        let begun = self.begun.unwrap_or(now);
        Some(match step {
            Step::Wait(length) => begun + *length,
            _ => now + LOOK_INTERVAL,
        })
    }
}

/// Returns true if the requested content is in the rendered image, complete, or cannot be.
fn is_shown(state: &State) -> bool {
    let is_opening = state.shared.works.has(WorkKind::Open);
    let is_whole = state.player.as_ref().is_none_or(|player| {
        (player.shown().is_some() && !player.is_partial() && player.waiting_for().is_none())
            || player.failure().is_some()
    });
    !is_opening && is_whole && (state.player.is_none() || state.is_drawn())
}

/// Returns true if no task that ends by itself is in progress.
fn is_done(state: &State) -> bool {
    state.shared.requests.is_empty() && state.shared.tasks.are_done()
}

/// Reads a line.
fn step(line: &str) -> Result<Step, String> {
    let (first, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
    if first.eq_ignore_ascii_case("wait") {
        return match rest.trim() {
            "shown" => Ok(Step::WaitShown),
            "done" => Ok(Step::WaitDone),
            seconds => seconds
                .parse()
                .ok()
                .and_then(|seconds| Duration::try_from_secs_f64(seconds).ok())
                .map(Step::Wait)
                .ok_or_else(|| "wait takes a number of seconds, `shown` or `done`".to_owned()),
        };
    }
    let is_name = |name: &str| {
        name.trim_end_matches('…')
            .eq_ignore_ascii_case(line.trim_end_matches('…'))
    };
    let mut panels = menu_panels().map(|(title, panel)| (title, Command::panel(panel)));
    for row in commands() {
        let word = row.command.word();
        match row.act {
            Act::Run(_) if is_name(word) || is_name(row.title) => return Ok(Step::Run(row.command)),
            Act::Take(value, _) if first.eq_ignore_ascii_case(word) => {
                return match rest.trim() {
                    "" => Err(format!("{word} needs a value: {word} {value}")),
                    value => Ok(Step::Take(row.command, value.to_owned())),
                };
            }
            _ => {}
        }
    }
    match panels.find(|(title, command)| is_name(title) || is_name(command.word())) {
        Some((_, command)) => Ok(Step::Run(command)),
        None => Err(format!(
            "unknown command {line:?}: the list of commands (Ctrl+P) shows their titles"
        )),
    }
}

fn run(state: &mut State, command: Command, value: Option<&str>) -> Result<(), String> {
    if let Some(value) = value {
        return state.give(command, value);
    }
    if let Some(reason) = row_of(command).and_then(|row| row.why_not(state)) {
        return Err(reason.to_owned());
    }
    state.run(command);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::{PanelId, StateOptions, WindowRequest};
    use crate::sequence::Sequence;
    use std::sync::Arc;

    fn script(text: &str) -> Result<Script, ScriptError> {
        Script::of(Path::new("tour.txt"), text)
    }

    fn demo() -> State {
        let mut state = State::new(StateOptions {
            paused: true,
            ..StateOptions::default()
        });
        state.open(Arc::new(Sequence::demo()));
        state
    }

    #[test]
    fn titles_words_and_values_run_in_order() {
        let text =
            "# a tour\nGRID\nopen files\n\nTurntable\nframe 3\nset point-size 4\nlabels\nspeed -2\nsave picture\n";
        let mut script = script(text).unwrap();
        let mut state = demo();
        assert!(script.advance(&mut state, Duration::ZERO).unwrap());
        assert!(state.style.backdrop.grid && state.motion.turntable.is_on);
        assert_eq!(state.style.points.size_px, 4.0);
        assert!(state.panels.has(PanelId::new("labels")), "a panel is a command");
        let player = state.player.as_ref().unwrap();
        assert_eq!(player.waiting_for().unwrap_or(player.clock().frame()), 2);
        assert_eq!(player.clock().speed(), -2.0);
        assert_eq!(state.take_requests(), [WindowRequest::Screenshot(None)]);
        assert_eq!(script.next_deadline(Duration::ZERO), None);
    }

    #[test]
    fn script_lines_are_undone_one_by_one() {
        let mut script = script("turntable\nset point-size 4\nset point-size 6\nundo").unwrap();
        let mut state = demo();
        assert!(script.advance(&mut state, Duration::ZERO).unwrap());
        assert_eq!(state.style.points.size_px, 4.0);
    }

    #[test]
    fn a_wait_delays_what_follows_it() {
        let mut script = script("grid\nwait 1.5\ngrid").unwrap();
        let mut state = demo();
        let at = Duration::from_secs_f64;
        assert!(script.advance(&mut state, at(1.0)).unwrap());
        assert_eq!(script.next_deadline(at(1.0)), Some(at(2.5)));
        assert!(!script.advance(&mut state, at(2.0)).unwrap());
        assert!(state.style.backdrop.grid);
        assert!(script.advance(&mut state, at(2.5)).unwrap());
        assert!(!state.style.backdrop.grid);
        assert_eq!(script.next_deadline(at(2.5)), None);
    }

    #[test]
    fn errors_name_the_file_and_line() {
        let wrong = |text: &str| script(text).unwrap_err().to_string();
        assert!(wrong("grid\n\nno such thing").starts_with("tour.txt, line 3: unknown command"));
        assert_eq!(wrong("frame"), "tour.txt, line 1: frame needs a value: frame NUMBER");
        assert!(wrong("wait long").contains("line 1: wait takes a number of seconds"));
        assert!(
            Script::read(Path::new("/nowhere/tour.txt"))
                .unwrap_err()
                .to_string()
                .contains("/nowhere/tour.txt")
        );
        let mut state = State::new(StateOptions::default());
        let mut run = |text: &str| {
            script(text)
                .unwrap()
                .advance(&mut state, Duration::ZERO)
                .unwrap_err()
                .to_string()
        };
        assert_eq!(run("grid\nsave session"), "tour.txt, line 2: Nothing is open yet");
        assert!(run("set no-such 3").contains("line 1: unknown setting no-such"));
    }
}
