//! Outputs are not written over the files that they are made of, nor over files of another kind.

use crate::convert::SourceFiles;
use crate::sequence::Sequence;
use crate::{persist, regular_file};
use anyhow::{Context as _, bail};
use std::io::Read as _;
use std::path::{Path, PathBuf};

/// Number of leading bytes used to detect the kind of a file.
const BEGIN_BYTES: u64 = 64;

/// Kind of an output, in so far as the file that it replaces must be of that kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::cli) enum OutputKind {
    /// An image, or a video.
    Picture,
    /// A JSON text.
    Json,
}

/// Refuses to write over a file that is read.
pub(in crate::cli) fn check_sources(sequence: &Sequence, outputs: impl Iterator<Item = PathBuf>) -> anyhow::Result<()> {
    let sources = SourceFiles::of(sequence);
    for output in outputs {
        if sources.has(&output) {
            bail!(
                "the output {} is a file of the input: nothing was written, choose another name",
                output.display()
            );
        }
    }
    Ok(())
}

/// Refuses to write over a file that is read, and over one that is there and of another kind.
pub(in crate::cli) fn check_outputs(
    sequence: &Sequence,
    outputs: impl Iterator<Item = PathBuf>,
    kind: OutputKind,
) -> anyhow::Result<()> {
    let outputs: Vec<PathBuf> = outputs.collect();
    check_sources(sequence, outputs.iter().cloned())?;
    outputs.iter().try_for_each(|output| check_replaced(output, kind))
}

/// Refuses to replace a file at `output` that is not of `kind`; an empty one is of any.
pub(in crate::cli) fn check_replaced(output: &Path, kind: OutputKind) -> anyhow::Result<()> {
    // Pipes and devices hold no data that could be lost.
    if !output.exists() || persist::is_pipe_or_device(output) {
        return Ok(());
    }
    let mut begin = Vec::new();
    regular_file::open(output)
        .and_then(|file| file.take(BEGIN_BYTES).read_to_end(&mut begin))
        .with_context(|| format!("{} cannot be replaced", output.display()))?;
    let (is_kind, name) = match kind {
        OutputKind::Picture => (is_picture(&begin), "an image or video"),
        OutputKind::Json => (
            matches!(begin.trim_ascii_start().first(), Some(b'{' | b'[')),
            "a JSON file",
        ),
    };
    if !is_kind && !begin.is_empty() {
        bail!(
            "{} already exists and is not {name}: nothing was written, choose another name or remove it",
            output.display()
        );
    }
    Ok(())
}

/// Writes a text to a file as a whole, or to the pipe or device that the user has named.
pub(in crate::cli) fn write_text(path: &Path, text: &str) -> anyhow::Result<()> {
    persist::write_to(path, text.as_bytes()).with_context(|| format!("{} cannot be written", path.display()))
}

/// Returns true if a file that begins with these bytes is of a kind that this program writes as an image or a video.
fn is_picture(begin: &[u8]) -> bool {
    const BEGINS: [&[u8]; 6] = [b"\x89PNG", b"\xff\xd8\xff", b"RIFF", b"II*\x00", b"MM\x00*", b"GIF8"];
    BEGINS.iter().any(|known| begin.starts_with(known)) || begin.get(4..8) == Some(b"ftyp")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_of_another_kind_are_not_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("out.png");
        let check = |bytes: &[u8], kind: OutputKind| {
            std::fs::write(&file, bytes).unwrap();
            check_replaced(&file, kind)
        };
        let scan: &[u8] = b"ply\nformat ascii 1.0\n";
        for kind in [OutputKind::Picture, OutputKind::Json] {
            let refused = check(scan, kind).unwrap_err().to_string();
            assert!(refused.contains("out.png already exists and is not "), "{refused}");
            assert!(check(b"", kind).is_ok());
        }
        assert!(check(b"\x89PNG\r\n\x1a\n", OutputKind::Picture).is_ok());
        assert!(check(b"\x00\x00\x00\x20ftypisom", OutputKind::Picture).is_ok());
        assert!(check(b"{\n}", OutputKind::Json).is_ok());
        assert!(check_replaced(&folder.path().join("missing"), OutputKind::Json).is_ok());
        assert!(check_replaced(folder.path(), OutputKind::Json).is_err());
    }
}
