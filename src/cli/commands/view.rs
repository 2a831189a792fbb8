//! `pointreel view`: the window.

use crate::app::{
    GivenStyle, Options, Preferences, PreferencesFile, PresentChoice, Presets, ReadingChoices, Recent, Script,
    StateOptions, open_as_chosen,
};
use crate::cli::options::arguments::{PictureArgs, ReadArgs, VIEW, byte_count, frame_rate};
use crate::cli::options::colors::check_source;
use crate::cli::options::known_values::KnownValues;
use crate::cli::options::size_arguments::SizeArgs;
use crate::cli::options::sources::{OutputKind, check_replaced, check_sources};
use crate::cli::options::values::{FrameChoice, ON_OFF, on_or_off, positive_f64};
use crate::cli::session::{OpenedInputs, open_inputs};
use crate::document::{DocumentFolder, ReadSession, session_of};
use crate::export::PictureFormat;
use crate::progress::Progress;
use crate::scene::{Camera, Settings, UpAxis};
use crate::sequence::{OpenOptions, Sequence, SequenceError};
use crate::source;
use crate::timeline::LoopMode;
use anyhow::{Context as _, bail};
use clap::Args;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Arguments of the viewer: inputs and display options.
#[derive(Debug, Clone, Default, Args)]
#[expect(clippy::struct_excessive_bools, reason = "each is a switch of its own")]
pub(in crate::cli) struct ViewArgs {
    /// Folder, pattern, files or session (.pointreel); without any, the start screen
    #[arg(value_name = "INPUT")]
    inputs: Vec<PathBuf>,

    /// Folder, pattern or file to compare with, side by side with the same camera and clock
    #[arg(long, value_name = "INPUT")]
    compare: Vec<PathBuf>,

    /// Topic of a recording in --compare [default: that of --topic]
    #[arg(long, hide_short_help = true, value_name = "NAME", requires = "compare")]
    compare_topic: Option<String>,

    /// Up axis: x, y, z, -x, -y or -z [default: estimated]
    #[arg(long, value_name = "AXIS", allow_hyphen_values = true, help_heading = VIEW)]
    up: Option<UpAxis>,

    /// Start with a camera view copied in the window (Ctrl+C)
    #[arg(long, alias = "camera", value_name = "TEXT", help_heading = VIEW)]
    view: Option<Camera>,

    /// Frames per second, evenly spaced [default: by time stamps, else 24]
    #[arg(long, value_name = "FPS", value_parser = frame_rate)]
    fps: Option<f64>,

    /// Play at a multiple of the speed of the sequence [default: as last time]
    #[arg(long, value_name = "FACTOR", value_parser = positive_f64)]
    speed: Option<f64>,

    /// Loop the sequence, or stop after the last frame [default: as last time]
    #[arg(long = "loop", value_name = "on|off", num_args = 0..=1, require_equals = true, default_missing_value = "on",
        value_parser = KnownValues::<bool>::new(ON_OFF, on_or_off))]
    loops: Option<bool>,

    /// Show this frame, paused; counted from 0, last or -1 is the last one
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    frame: Option<FrameChoice>,

    /// Follow a growing folder: show the newest frame as it arrives
    #[arg(long, hide_short_help = true)]
    follow: bool,

    /// Record a live stream (tcp://) to this file, which can be opened again
    #[arg(long, hide_short_help = true, value_name = "FILE")]
    record: Option<PathBuf>,

    /// Start paused
    #[arg(long)]
    paused: bool,

    /// Start from defaults, ignoring what was stored about INPUT
    #[arg(long, hide_short_help = true, visible_alias = "no-document")]
    fresh: bool,

    /// Memory for prepared frames, such as 2GB
    #[arg(long, value_name = "SIZE", value_parser = byte_count, hide_short_help = true)]
    memory: Option<u64>,

    /// Paint the window on the GPU or the CPU (auto: a hardware GPU if there is one) [default: auto]
    #[arg(long, value_name = "auto|gpu|cpu", hide_short_help = true)]
    present: Option<PresentChoice>,

    #[command(flatten)]
    size: SizeArgs,

    /// Start in full screen
    #[arg(long, alias = "full-screen")]
    fullscreen: bool,

    /// Write the 3D view to this image (.png, .jpg, .webp or .tif) and exit
    #[arg(long, hide_short_help = true, value_name = "FILE")]
    screenshot: Option<PathBuf>,

    /// Show N frames before the screenshot
    #[arg(
        long,
        hide_short_help = true,
        value_name = "N",
        default_value_t = 1,
        requires = "screenshot"
    )]
    after_frames: u64,

    /// Run the commands of this file, one per line, by title or word; also `wait SECONDS|shown|done`
    #[arg(long, hide_short_help = true, value_name = "FILE")]
    script: Option<PathBuf>,

    /// End the GPU device after this many pictures, as a crashed driver would
    #[arg(long, value_name = "N", hide = true)]
    lose_device_after: Option<u64>,

    #[command(flatten)]
    read: ReadArgs,

    #[command(flatten)]
    picture: PictureArgs,
}

/// Aspect ratio of a window with only one given edge.
const WINDOW_SIZE_PX: [u32; 2] = [1280, 720];

/// Opens the window and returns when it is closed.
pub(in crate::cli) fn run(args: &ViewArgs) -> anyhow::Result<()> {
    if args.picture.is_transparent() {
        bail!("a window has no transparent background: choose colours, or `pointreel render`");
    }
    if let Some(screenshot) = &args.screenshot {
        PictureFormat::of_name(screenshot)?;
        check_replaced(screenshot, OutputKind::Picture)?;
    }
    let script = args.script.as_deref().map(Script::read).transpose()?;
    let open = OpenOptions {
        fps: args.fps,
        waits_for_first: args.follow,
        ..args.read.picture_options()
    };
    let (recent, recent_problem) = Recent::load();
    // Users who have opened something before are offered it again.
    let is_bare = args.inputs.is_empty() && args.compare.is_empty();
    let offers_recent = is_bare && args.screenshot.is_none() && args.record.is_none() && !recent.entries().is_empty();
    // The window shows that it is waiting for the first frame.
    let can_ask = args.screenshot.is_none() && args.record.is_none();
    let waits = can_ask && args.follow && is_empty_folder(&args.inputs);
    // The window asks whether a session may open files outside its folder.
    let asks = can_ask && reaches_beyond(&args.inputs, &open);
    // A scripted image does not depend on earlier sessions.
    let (reading_choices, choices_problem) = match args.screenshot {
        Some(_) => Default::default(),
        None => ReadingChoices::load(),
    };
    let documents = args.screenshot.is_none().then(DocumentFolder::of_user).flatten();
    let FirstOpened {
        sequence,
        mut session,
        opened_with,
        problem,
    } = if offers_recent || waits || asks {
        FirstOpened::default()
    } else {
        FirstOpened::of(args, &open, &reading_choices, documents.as_ref())?
    };
    let frame = match (&args.frame, &sequence) {
        (Some(frame), Some(sequence)) => Some(frame.one_of("--frame", sequence.len())?),
        _ => None,
    };
    if let Some(read) = &mut session {
        read.document.frame = frame.unwrap_or(read.document.frame);
        give_precedence(args, read);
    }
    if let (Some(screenshot), Some(sequence)) = (&args.screenshot, &sequence) {
        check_sources(sequence, std::iter::once(screenshot.clone()))?;
    }
    if let Some(path) = &args.record {
        record_arrivals(sequence.as_ref(), path)?;
    }
    if let (Some(source), Some(sequence)) = (args.picture.color_source(), &sequence)
        && !args.follow
        && !sequence.source().is_live()
    {
        check_source(source, sequence, 0, None)?;
    }
    let compare = open_compared(args, &open)?.map(Arc::new);
    let presets = Presets::load();
    let (preferences_file, preferences) = load_preferences(args, session.is_some());
    let retained_problems = [presets.problem(), preferences_file.problem()];
    let warnings = retained_problems.into_iter().flatten().map(str::to_owned);
    let warnings = warnings.chain(recent_problem).chain(choices_problem).chain(problem);
    let warnings = warnings.collect();
    let options = Options {
        state: StateOptions {
            preferences,
            up: args.up,
            given: given_style(args),
            view: args.view,
            open,
            follow: args.follow,
            paused: args.paused || frame.is_some(),
            frame,
            budget_bytes: args.memory.map(|bytes| usize::try_from(bytes).unwrap_or(usize::MAX)),
            recent,
            reading_choices,
            presets,
            documents,
            is_fresh: args.fresh,
            ..StateOptions::default()
        },
        sequence: sequence.map(Arc::new),
        compare,
        named: args.inputs.clone(),
        opened_with,
        session: session.map(Box::new),
        // The demo is in the menu, and special words are not listed among the recent files.
        inputs: args
            .inputs
            .iter()
            .filter(|input| !source::is_word(input))
            .cloned()
            .collect(),
        warnings,
        preferences_file,
        size_px: args.size.of(WINDOW_SIZE_PX),
        is_full_screen: args.fullscreen,
        screenshot: args.screenshot.clone(),
        after_frames: args.after_frames,
        script,
        lose_device_after: args.lose_device_after,
    };
    crate::app::run(options).context("the window ended")
}

/// Returns true if exactly one folder is named and it is empty.
fn is_empty_folder(inputs: &[PathBuf]) -> bool {
    let [folder] = inputs else { return false };
    let open = OpenOptions::default();
    folder.is_dir() && matches!(Sequence::open(inputs, &open), Err(SequenceError::EmptyFolder { .. }))
}

/// Returns true if a session is named that opens more than is allowed.
fn reaches_beyond(inputs: &[PathBuf], open: &OpenOptions) -> bool {
    let session = session_of(inputs).ok().flatten();
    session.is_some_and(|read| !read.beyond(open.session_reach).is_empty())
}

/// First content of the window.
#[derive(Default)]
struct FirstOpened {
    sequence: Option<Sequence>,
    session: Option<ReadSession>,
    /// Open options, if they differ from the command line.
    opened_with: Option<OpenOptions>,
    /// Why a choice that was made in the window before was not taken.
    problem: Option<String>,
}

impl FirstOpened {
    /// As was chosen for the inputs in the window before, where nothing else is given.
    fn of(
        args: &ViewArgs,
        open: &OpenOptions,
        choices: &ReadingChoices,
        documents: Option<&DocumentFolder>,
    ) -> anyhow::Result<Self> {
        let inputs = &args.inputs;
        let chosen = choices.of(inputs).filter(|_| !args.fresh);
        let as_chosen = chosen.map(|chosen| open_as_chosen(inputs, chosen, open, &Progress::default()));
        let problem = match as_chosen {
            Some(Ok((sequence, chosen))) => {
                return Ok(Self {
                    sequence: Some(sequence),
                    opened_with: Some(chosen),
                    ..Self::default()
                });
            }
            Some(Err(problem)) => Some(problem),
            None => None,
        };
        let OpenedInputs { sequence, session } = open_inputs(inputs, open, documents.filter(|_| !args.fresh))?;
        Ok(Self {
            sequence: Some(sequence),
            session,
            problem,
            ..Self::default()
        })
    }
}

/// Lets command-line arguments override the contents of a session.
fn give_precedence(args: &ViewArgs, read: &mut ReadSession) {
    let style = args.picture.style_over(read.document.style());
    read.document.clip = style.clip;
    read.document.settings = style.with(|style| style.clip = None);
    read.document.view = args.view.or(read.document.view);
    if !args.compare.is_empty() {
        read.document.compare = None;
    }
}

/// Returns the command-line settings, which override the stored ones of a sequence.
fn given_style(args: &ViewArgs) -> GivenStyle {
    let picture = args.picture.clone();
    GivenStyle::new(move |style| Settings {
        drawing: style.drawing,
        ..picture.style_over(style)
    })
}

fn record_arrivals(sequence: Option<&Sequence>, path: &Path) -> anyhow::Result<()> {
    match sequence.and_then(|sequence| sequence.source().live()) {
        Some(live) => live.start_recording(path).map_err(anyhow::Error::msg),
        None => bail!("--record is for live streams, as tcp://127.0.0.1:9000: other inputs are files already"),
    }
}

/// Opens the sequence to compare with the one that is opened with `open`, if there is one.
fn open_compared(args: &ViewArgs, open: &OpenOptions) -> anyhow::Result<Option<Sequence>> {
    if args.compare.is_empty() {
        return Ok(None);
    }
    let topic = args.compare_topic.as_deref().map(Arc::from);
    let open = OpenOptions {
        topic: topic.or_else(|| open.topic.clone()),
        ..open.clone()
    };
    Ok(Some(open_inputs(&args.compare, &open, None)?.sequence))
}

/// Loads the current user's preferences, overridden by the command line; `has_settings` refers to a session, whose
/// settings override both.
fn load_preferences(args: &ViewArgs, has_settings: bool) -> (PreferencesFile, Preferences) {
    // A scripted image does not depend on earlier sessions.
    let (file, retained) = if args.screenshot.is_some() {
        (PreferencesFile::default(), Preferences::default())
    } else {
        PreferencesFile::load()
    };
    if retained.settings != Settings::default() {
        log::info!("new documents begin with the settings in settings.json, which are not all as by default");
    }
    let mut settings = retained.settings;
    if !has_settings {
        // The renderer is not part of any document.
        settings.drawing = args.picture.style_over(settings).drawing;
    }
    let preferences = Preferences {
        settings,
        present: args.present.unwrap_or(retained.present),
        speed: args.speed.unwrap_or(retained.speed),
        loop_mode: match args.loops {
            Some(false) => LoopMode::Off,
            Some(true) if retained.loop_mode == LoopMode::Off => LoopMode::Loop,
            _ => retained.loop_mode,
        },
        ..retained
    };
    (file, preferences)
}
