//! The images of PCL's grabbers: `PCLZF`, width, height, kind, packed and unpacked length, then LZF.

use super::lzf::unpack_lzf;
use super::pixels::{Raster, Samples, checked_bytes, checked_size};

/// First bytes of such an image.
pub(super) const MAGIC: &[u8] = b"PCLZF";

/// Bytes before the packed ones.
const HEADER_BYTES: usize = 37;

/// The maximum ratio of LZF: 264 bytes out of three.
const MAX_LZF_RATIO: u64 = 88;

/// Header before the compressed bytes of a PCL image.
struct Header {
    size_px: [u32; 2],
    kind: String,
    packed_bytes: u64,
    bytes: u64,
}

impl Header {
    fn of(file: &[u8]) -> Result<Self, String> {
        let header: &[u8; HEADER_BYTES] = file
            .first_chunk()
            .ok_or_else(|| format!("it ends within its header of {HEADER_BYTES} bytes"))?;
        let number = |at: usize| u32::from_le_bytes([header[at], header[at + 1], header[at + 2], header[at + 3]]);
        Ok(Self {
            size_px: checked_size([number(5), number(9)])?,
            kind: String::from_utf8_lossy(&header[13..29])
                .trim_end_matches([' ', '\0'])
                .to_ascii_lowercase(),
            packed_bytes: number(29).into(),
            bytes: number(33).into(),
        })
    }
}

/// Width and height of the image in `file`, read from its head only.
pub(super) fn size_px(file: &[u8]) -> Result<[u32; 2], String> {
    Ok(Header::of(file)?.size_px)
}

/// The image in `file`, which takes no more than `max_bytes`.
pub(super) fn decode(file: &[u8], max_bytes: u64) -> Result<Raster, String> {
    let header = Header::of(file)?;
    let packed = &file[HEADER_BYTES..];
    if packed.len() as u64 != header.packed_bytes {
        return Err(format!(
            "it has {} packed bytes and claims {}: it may not have been written to its end",
            packed.len(),
            header.packed_bytes
        ));
    }
    let pixels = header.size_px.map(u64::from).iter().product::<u64>();
    let bytes_per_pixel = match header.kind.as_str() {
        "depth16" | "yuv422" => 2,
        "rgb24" => 3,
        kind => {
            return Err(format!(
                "its pixels are of kind `{}`: depth16, rgb24 and yuv422 are read",
                kind.escape_default()
            ));
        }
    };
    if header.bytes != pixels * bytes_per_pixel || header.bytes > header.packed_bytes * MAX_LZF_RATIO {
        return Err(format!("it claims {} bytes for {pixels} pixels", header.bytes));
    }
    checked_bytes(header.bytes, max_bytes)?;
    let bytes = unpack_lzf(packed, header.bytes as usize)
        .ok()
        .filter(|bytes| bytes.len() as u64 == header.bytes)
        .ok_or("its packed bytes are damaged")?;
    let samples = match header.kind.as_str() {
        "depth16" => {
            let samples = bytes.as_chunks().0.iter();
            Samples::Gray16(samples.map(|&sample| u16::from_le_bytes(sample)).collect())
        }
        "rgb24" => {
            // All of red, then all of green, then all of blue.
            let (red, rest) = bytes.split_at(pixels as usize);
            let (green, blue) = rest.split_at(pixels as usize);
            let pixels = red.iter().zip(green).zip(blue);
            Samples::Rgb8(pixels.map(|((&r, &g), &b)| [r, g, b]).collect())
        }
        _ => Samples::Rgb8(colors_of_yuv422(&bytes)),
    };
    Ok(Raster {
        size_px: header.size_px,
        samples,
    })
}

/// The colours of all U, then all Y, then all V, where U and V cover two pixels (ITU-R BT.601, full range).
fn colors_of_yuv422(bytes: &[u8]) -> Vec<[u8; 3]> {
    let pairs = bytes.len() / 4;
    let (u, rest) = bytes.split_at(pairs);
    let (y, v) = rest.split_at(2 * pairs);
    let color = |(at, &y): (usize, &u8)| {
        let [u, v] = [u[at / 2], v[at / 2]].map(|difference| f32::from(difference) - 128.0);
        let y = f32::from(y);
        [y + 1.402 * v, y - 0.344_14 * u - 0.714_14 * v, y + 1.772 * u].map(|channel| channel.round() as u8)
    };
    y.iter().enumerate().map(color).collect()
}
