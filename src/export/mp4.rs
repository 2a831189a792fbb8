//! MP4 files: H.264 by the program `ffmpeg`, which takes raw images from a pipe.

use super::error::ExportError;
use super::sink::{FrameSink, VideoStream};
use crate::persist::Partial;
use crate::temporary::Helper;
use image::RgbaImage;
use std::io::{ErrorKind, Read as _, Write as _};
use std::path::{Path, PathBuf};
use std::process::{ChildStdin, Command, Stdio};
use std::thread::{self, JoinHandle};

/// Max stored bytes of its messages.
const MAX_MESSAGE_BYTES: u64 = 1 << 16;

/// Returns true if ffmpeg, the encoder for MP4, is on the PATH.
pub fn has_ffmpeg() -> bool {
    let name = format!("ffmpeg{}", std::env::consts::EXE_SUFFIX);
    std::env::var_os("PATH").is_some_and(|path| {
        let mut folders = std::env::split_paths(&path);
        folders.any(|folder| folder.join(&name).is_file())
    })
}

/// An MP4 that is being written.
pub(super) struct Mp4File {
    output: PathBuf,
    /// Killed before its output is removed.
    ffmpeg: Helper,
    /// Standard input pipe through which the encoder receives the frames.
    pictures: Option<ChildStdin>,
    /// Reads its messages, so that it never blocks on the pipe.
    messages: Option<JoinHandle<String>>,
    partial: Partial,
}

impl Mp4File {
    pub(super) fn create(output: &Path, stream: &VideoStream) -> Result<Self, ExportError> {
        let partial = Partial::of(output);
        let write = |reason| ExportError::Write {
            path: output.to_owned(),
            reason,
        };
        let [width, height] = stream.size_px;
        let mut command = Command::new("ffmpeg");
        command
            .args(["-hide_banner", "-loglevel", "error", "-nostdin", "-y"])
            .args(["-f", "rawvideo", "-pix_fmt", "rgba"])
            .args(["-s", &format!("{width}x{height}")])
            .args(["-r", &stream.per_second.to_string(), "-i", "pipe:0"])
            .args(["-c:v", "libx264", "-preset", "medium", "-crf", "18"])
            // A format that every player supports, with explicit colour metadata: otherwise players guess it from the
            // size.
            .args(["-vf", "scale=out_color_matrix=bt709:out_range=tv,format=yuv420p"])
            .args(["-colorspace", "bt709", "-color_primaries", "bt709"])
            .args(["-color_trc", "bt709", "-color_range", "tv"])
            .args(["-movflags", "+faststart", "-fflags", "+bitexact"])
            .args(["-flags:v", "+bitexact", "-f", "mp4"])
            .arg(file_name(partial.hidden()))
            .stdin(Stdio::piped())
            .stdout(Stdio::null())
            .stderr(Stdio::piped());
        let ffmpeg = Helper::spawn(&mut command).map_err(|reason| match reason.kind() {
            ErrorKind::NotFound => ExportError::NoFfmpeg,
            _ => write(reason),
        })?;
        let said = ffmpeg.child().stderr.take();
        let pictures = ffmpeg.child().stdin.take();
        let read = move || {
            let mut text = Vec::new();
            if let Some(mut said) = said {
                // Unreadable output is treated as absent.
                let _ = said.by_ref().take(MAX_MESSAGE_BYTES).read_to_end(&mut text);
                let _ = std::io::copy(&mut said, &mut std::io::sink());
            }
            String::from_utf8_lossy(&text).trim().replace('\n', "; ")
        };
        let messages = thread::Builder::new().name("ffmpeg messages".to_owned()).spawn(read);
        let mut sink = Self {
            output: output.to_owned(),
            ffmpeg,
            pictures,
            messages: None,
            partial,
        };
        sink.messages = Some(messages.map_err(write)?);
        Ok(sink)
    }

    /// Returns the error message of the encoder after it has ended.
    fn failure(&mut self) -> ExportError {
        // A broken pipe is only a symptom of the failure.
        let _ = self.ffmpeg.wait();
        let messages = self.messages.take().map(JoinHandle::join);
        let reason = match messages {
            Some(Ok(text)) if !text.is_empty() => text,
            _ => "it ended without saying why".to_owned(),
        };
        ExportError::Ffmpeg {
            path: self.output.clone(),
            reason,
        }
    }
}

impl FrameSink for Mp4File {
    fn push(&mut self, picture: &RgbaImage) -> Result<(), ExportError> {
        match self.pictures.as_mut().map(|pipe| pipe.write_all(picture)) {
            Some(Ok(())) => Ok(()),
            _ => Err(self.failure()),
        }
    }

    fn finish(mut self: Box<Self>) -> Result<(), ExportError> {
        drop(self.pictures.take());
        let is_done = self.ffmpeg.wait().is_ok_and(|status| status.success());
        if !is_done {
            return Err(self.failure());
        }
        self.partial.rename().map_err(|reason| ExportError::Write {
            path: self.output.clone(),
            reason,
        })
    }
}

/// A name that `ffmpeg` takes for a file, whatever it begins with.
fn file_name(path: &Path) -> std::ffi::OsString {
    let mut name = std::ffi::OsString::from("file:");
    name.push(path);
    name
}
