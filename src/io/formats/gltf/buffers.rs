//! Buffers that a glTF file refers to: within it, in `data:` URIs, or in companion files.

use super::document::{Buffer, Document, at};
use crate::io::error::{Fault, mebibytes};
use crate::io::files::sidecars;
use crate::io::options::ReadOptions;
use base64::Engine as _;
use base64::alphabet::STANDARD;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use std::borrow::Cow;
use std::path::Path;

/// The requested buffers of a document, and their total memory limit.
pub(super) struct Buffers<'a> {
    loaded: Vec<Option<Cow<'a, [u8]>>>,
}

impl<'a> Buffers<'a> {
    /// All buffers of `document` in the file `path`.
    pub(super) fn load(
        document: &Document,
        binary: Option<&'a [u8]>,
        path: &Path,
        options: &ReadOptions,
    ) -> Result<Self, Fault> {
        let mut left = options.left_bytes();
        let mut loaded = Vec::new();
        for (index, buffer) in document.buffers.iter().enumerate() {
            let bytes = Self::bytes(buffer, index, binary, path, left, options)?;
            if let Some(Cow::Owned(bytes)) = &bytes {
                left = left.saturating_sub(bytes.len() as u64);
            }
            loaded.push(bytes);
        }
        Ok(Self { loaded })
    }

    /// Returns the memory taken by the buffers in addition to the file, which is not counted.
    pub(super) fn owned_bytes(&self) -> usize {
        let owned = self.loaded.iter().map(|bytes| match bytes {
            Some(Cow::Owned(bytes)) => bytes.len(),
            _ => 0,
        });
        owned.sum()
    }

    pub(super) fn into_owned(self) -> Buffers<'static> {
        let owned = |bytes: Cow<'a, [u8]>| Cow::Owned(bytes.into_owned());
        Buffers {
            loaded: self.loaded.into_iter().map(|bytes| bytes.map(owned)).collect(),
        }
    }

    fn bytes(
        buffer: &Buffer,
        index: usize,
        binary: Option<&'a [u8]>,
        path: &Path,
        left: u64,
        options: &ReadOptions,
    ) -> Result<Option<Cow<'a, [u8]>>, Fault> {
        let bytes = match &buffer.uri {
            Some(uri) => Cow::Owned(
                resource(uri, path, left, options).map_err(|problem| Fault::entry("buffer", index, problem))?,
            ),
            None if index == 0 => match binary {
                Some(bytes) => Cow::Borrowed(bytes),
                None => return Ok(None),
            },
            // Compressed views leave their buffer empty.
            None => return Ok(None),
        };
        if bytes.len() < buffer.byte_length {
            return Err(Fault::entry(
                "buffer",
                index,
                format!(
                    "it has {} bytes, expected {}: it is truncated",
                    bytes.len(),
                    buffer.byte_length
                ),
            ));
        }
        Ok(Some(bytes))
    }

    /// The bytes of a view.
    pub(super) fn view(&self, document: &Document, index: usize) -> Result<&[u8], Fault> {
        let view = at(&document.buffer_views, index, "bufferView")?;
        if let Some(name) = view
            .extensions
            .keys()
            .find(|name| name.ends_with("_meshopt_compression"))
        {
            return Err(super::document::packed(name));
        }
        let buffer = at(&self.loaded, view.buffer, "buffer")?.as_deref().unwrap_or_default();
        let end = view.byte_offset.checked_add(view.byte_length);
        end.and_then(|end| buffer.get(view.byte_offset..end)).ok_or_else(|| {
            Fault::entry(
                "bufferView",
                index,
                format!(
                    "it takes {} bytes from byte {} on of a buffer that has {}: the file is truncated",
                    view.byte_length,
                    view.byte_offset,
                    buffer.len()
                ),
            )
        })
    }
}

/// The bytes of `uri` in the file `path`, not more than `max_bytes`.
pub(super) fn resource(uri: &str, path: &Path, max_bytes: u64, options: &ReadOptions) -> Result<Vec<u8>, String> {
    if let Some(data) = uri.strip_prefix("data:") {
        let lenient = GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent);
        let engine = GeneralPurpose::new(&STANDARD, lenient);
        let (kind, text) = data.split_once(',').ok_or("its data: URI has no comma")?;
        if !kind.ends_with(";base64") {
            return Err("its data: URI is not in base64".to_owned());
        }
        if text.len() as u64 > max_bytes {
            return Err(format!(
                "its data: URI is larger than --max-memory allows ({})",
                mebibytes(options.max_memory_bytes)
            ));
        }
        return engine
            .decode(text)
            .map_err(|error| format!("its data: URI is damaged ({error})"));
    }
    let name = percent_decoded(uri).ok_or_else(|| format!("`{}` is not a URI of a file", uri.escape_default()))?;
    sidecars::read(&name, path, max_bytes, options)
}

/// Text without `%20` and its like.
fn percent_decoded(uri: &str) -> Option<String> {
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let Some((&first, others)) = rest.split_first() {
        rest = others;
        if first == b'%' {
            let digits = std::str::from_utf8(rest.get(..2)?).ok()?;
            bytes.push(u8::from_str_radix(digits, 16).ok()?);
            rest = &rest[2..];
        } else {
            bytes.push(first);
        }
    }
    String::from_utf8(bytes).ok()
}
