//! `pointreel serve`: a sequence served over the network, as a file or live.

use crate::cli::options::arguments::{ReadArgs, frame_rate, open_sequence_and_tell};
use crate::cli::options::known_values::KnownValues;
use crate::cli::options::values::{ON_OFF, on_or_off};
use crate::cli::terminal::output::{answer, check_answers, say};
use crate::reel::MAGIC;
use crate::sequence::{OpenOptions, Sequence};
use crate::serve::live::{ClientReport, LiveEvent, LiveOptions, LiveServer, Schedule};
use crate::serve::{CorsOrigin, FileServer, FileServerOptions};
use crate::wire::{ColorCoding, DepthCoding, ImageCoding};
use crate::{regular_file, signals};
use anyhow::{Context as _, bail};
use clap::{Args, ValueEnum};
use std::io::Read as _;
use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Default listening address: other machines cannot connect.
const USUAL_ADDRESS: SocketAddr = SocketAddr::new(IpAddr::V4(Ipv4Addr::LOCALHOST), 8089);

/// Arguments of `pointreel serve`.
#[derive(Debug, Args)]
pub(in crate::cli) struct ServeArgs {
    /// Sequence file (.reel, written by `pointreel convert`); with --live any INPUT of `view`
    #[arg(value_name = "INPUT", required = true)]
    inputs: Vec<PathBuf>,

    /// Address and port to listen on; port 0 picks a free one, address 0.0.0.0 admits other machines
    #[arg(long, value_name = "ADDRESS:PORT", default_value_t = USUAL_ADDRESS)]
    listen: SocketAddr,

    /// Stream live: watch with `pointreel tcp://ADDRESS:PORT`
    #[arg(long)]
    live: bool,

    /// Frames per second of the stream [default: by time stamps, else 24 or 30]
    #[arg(long, value_name = "FPS", value_parser = frame_rate, requires = "live")]
    fps: Option<f64>,

    /// Stop after the last frame instead of looping
    #[arg(long, requires = "live")]
    once: bool,

    /// Loop the sequence [default: on]
    #[arg(long = "loop", value_name = "on|off", requires = "live", conflicts_with = "once", num_args = 0..=1,
        require_equals = true, default_missing_value = "on", hide_short_help = true,
        value_parser = KnownValues::<bool>::new(ON_OFF, on_or_off))]
    loops: Option<bool>,

    /// Encoding of depth images: rvl (lossless) or raw
    #[arg(
        long,
        value_name = "rvl|raw",
        default_value = "rvl",
        hide_short_help = true,
        requires = "live"
    )]
    depth_coding: Depths,

    /// Encoding of colour images: jpeg, or raw (lossless)
    #[arg(
        long,
        value_name = "jpeg|raw",
        default_value = "jpeg",
        hide_short_help = true,
        requires = "live"
    )]
    color_coding: Colors,

    /// Allow web pages of this origin to read the file, such as `https://example.org`, or `*` for all; repeatable
    /// [default: none]
    #[arg(long, hide_short_help = true, value_name = "ORIGIN", conflicts_with = "live")]
    cors: Vec<CorsOrigin>,

    #[command(flatten)]
    read: ReadArgs,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Depths {
    Rvl,
    Raw,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Colors {
    Jpeg,
    Raw,
}

pub(in crate::cli) fn run(arguments: &ServeArgs) -> anyhow::Result<()> {
    if arguments.live {
        return run_live(arguments);
    }
    match arguments.inputs.as_slice() {
        [file] => run_file(file, arguments),
        _ => bail!("one sequence file is served by HTTP: name one, or add --live to play all of these as one sequence"),
    }
}

fn run_file(path: &Path, arguments: &ServeArgs) -> anyhow::Result<()> {
    let mut begin = [0; MAGIC.len()];
    let read = regular_file::open(path).and_then(|mut file| file.read_exact(&mut begin));
    read.with_context(|| {
        format!(
            "{} cannot be read as a sequence file: name a .reel file, or add --live to play any input as a stream",
            path.display()
        )
    })?;
    if begin != MAGIC {
        bail!(
            "{} is not a sequence file: make one with pointreel convert INPUT {}, or add --live to play it as a stream",
            path.display(),
            path.with_extension("reel").display()
        );
    }
    let options = FileServerOptions {
        cors: arguments.cors.clone(),
        ..FileServerOptions::default()
    };
    let server = FileServer::bind(path, arguments.listen, options);
    let server = server.with_context(|| format!("{} cannot be listened at", arguments.listen))?;
    answer(&format!("{} (play it with pointreel, end with Ctrl+C)", server.url()?));
    check_answers()?;
    server.run()?;
    Ok(())
}

fn run_live(arguments: &ServeArgs) -> anyhow::Result<()> {
    let open = OpenOptions {
        fps: arguments.fps,
        ..arguments.read.picture_options()
    };
    let sequence = open_sequence_and_tell(&arguments.inputs, &open)?;
    let options = LiveOptions {
        coding: ImageCoding {
            depth: match arguments.depth_coding {
                Depths::Rvl => DepthCoding::Rvl,
                Depths::Raw => DepthCoding::Raw,
            },
            color: match arguments.color_coding {
                Colors::Jpeg => ColorCoding::Jpeg,
                Colors::Raw => ColorCoding::Raw,
            },
        },
        repeats: arguments.loops.unwrap_or(!arguments.once),
        max_bytes: open.read.max_memory_bytes,
    };
    let source = Arc::clone(sequence.source());
    let server = LiveServer::bind(source, schedule(&sequence), arguments.listen, options, tell);
    let server = server.with_context(|| format!("{} cannot be listened at", arguments.listen))?;
    let server = Arc::new(server);
    let stopped = Arc::clone(&server);
    let _ends_well = signals::on_first(move || stopped.stop(), None);
    answer(&format!(
        "{} ({} frames, {:.1} a second; show it with pointreel, end with Ctrl+C)",
        server.url()?,
        sequence.len(),
        sequence.fps()
    ));
    check_answers()?;
    server.run()?;
    let report = server.report();
    say(&format!(
        "{} frames served, {} not made in time, {} dropped for clients that were slow, {:.1} MB sent",
        report.served_frames,
        report.missed_frames,
        report.dropped_frames,
        report.sent_bytes as f64 * 1e-6
    ));
    Ok(())
}

/// The pace of a sequence.
fn schedule(sequence: &Sequence) -> Schedule {
    let pace = sequence.pace();
    Schedule::new(sequence.len(), sequence.fps(), |frame| pace.duration(frame))
}

fn tell(event: LiveEvent) {
    match event {
        LiveEvent::Joined(address) => say(&format!("{address} has connected")),
        LiveEvent::Full(address) => say(&format!(
            "{address} was turned away: the maximum number of clients is connected"
        )),
        LiveEvent::Left(report) => say(&left(&report)),
    }
}

fn left(report: &ClientReport) -> String {
    let seconds = report.time.as_secs_f64().max(1e-3);
    let rate = |bytes: u64| bytes as f64 * 1e-6 / seconds;
    let whole = report.whole_bytes.map(|bytes| {
        let rate = rate(bytes);
        format!(" of what it sees; whole frames are {rate:.1} MB/s")
    });
    format!(
        "{}: {}; {} frames sent in {seconds:.1} s, {} dropped, {:.1} MB/s{}",
        report.address,
        report.reason,
        report.sent_frames,
        report.dropped_frames,
        rate(report.sent_bytes),
        whole.unwrap_or_default()
    )
}
