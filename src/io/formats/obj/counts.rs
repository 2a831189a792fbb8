//! Entries of an OBJ file, counted before they are read, to claim their memory.
//!
//! The file does not have their number, and lists that double as lines come take up to three times their final size.

use crate::io::error::Fault;
use crate::io::options::ReadOptions;

/// Upper bounds of the number of each.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq)]
pub(super) struct Counts {
    pub(super) vertices: usize,
    pub(super) normals: usize,
    /// Texture coordinates.
    pub(super) places: usize,
    pub(super) triangles: usize,
    /// Corners of the polygon that has the most.
    corners: usize,
    /// Changes of the material.
    uses: usize,
    /// Bytes of their names.
    name_bytes: usize,
}

impl Counts {
    pub(super) fn of(bytes: &[u8]) -> Self {
        let mut counts = Self::default();
        let mut corners_before = 0;
        for line in bytes.split(|&byte| byte == b'\n') {
            let line = line.trim_ascii();
            let corners = |line: &[u8]| {
                let spaces = line.windows(2);
                let starts = spaces.filter(|pair| pair[0].is_ascii_whitespace() && !pair[1].is_ascii_whitespace());
                starts.count()
            };
            // A line that is continued may be a face.
            let goes_on = line.ends_with(b"\\");
            let is_continued = corners_before > 0;
            match line {
                _ if is_continued || goes_on || line.starts_with(b"f") => {
                    let found = corners_before + corners(line) + usize::from(is_continued);
                    counts.corners = counts.corners.max(found);
                    counts.triangles += if goes_on { 0 } else { found.saturating_sub(2) };
                    counts.vertices += usize::from(line.starts_with(b"v"));
                    corners_before = if goes_on { found.max(1) } else { 0 };
                }
                [b'v', b'n', ..] => counts.normals += 1,
                [b'v', b't', ..] => counts.places += 1,
                [b'v', ..] => counts.vertices += 1,
                [b'u', b's', b'e', b'm', ..] | [b'm', b't', b'l', ..] => {
                    counts.uses += 1;
                    counts.name_bytes += line.len();
                }
                _ => {}
            }
        }
        counts
    }

    /// Bytes that all of them take.
    ///
    /// # Errors
    /// Memory does not suffice for them.
    pub(super) fn claim(&self, options: &ReadOptions) -> Result<usize, Fault> {
        /// Coordinates and colours in double precision, the colour and the normal in the cloud.
        const VERTEX_BYTES: usize = 24 + 24 + 4 + 12;
        const NORMAL_BYTES: usize = 12;
        const PLACE_BYTES: usize = 8;
        /// Corners and their texture coordinates, a list that doubles.
        const TRIANGLE_BYTES: usize = 12 + 2 * 12;
        /// Lists of corners and of their places, which double.
        const CORNER_BYTES: usize = 2 * 2 * 4;
        /// The use and the entry of the name in an index and a list.
        const USE_BYTES: usize = 2 * (16 + 24 + 64);
        let parts = [
            (self.vertices, VERTEX_BYTES),
            (self.normals, NORMAL_BYTES),
            (self.places, PLACE_BYTES),
            (self.triangles, TRIANGLE_BYTES),
            (self.corners, CORNER_BYTES),
            (self.uses, USE_BYTES),
            (self.name_bytes, 2),
        ];
        let bytes = parts.into_iter().fold(0usize, |sum, (count, bytes)| {
            sum.saturating_add(count.saturating_mul(bytes))
        });
        let what = format!("a model of {} vertices and {} triangles", self.vertices, self.triangles);
        options.claim(&what, bytes as u64)?;
        Ok(bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_are_counted_across_continued_lines() {
        let vertices = "v 0 0 0\nvn 0 0 1\nvt 0 0\n  v 1 1 1\r\n";
        let faces = "f 1 2 3\nf  1/1 2/2\t3/3 4/4\nf 1 2 \\\n3 4 5\nusemtl a b\n# f 1 2 3\n";
        let counts = Counts::of([vertices, faces].concat().as_bytes());
        assert_eq!((counts.vertices, counts.normals, counts.places), (2, 1, 1));
        assert_eq!((counts.corners, counts.uses, counts.name_bytes), (6, 1, 10));
        // Continuing a line counts one corner too many.
        assert_eq!(counts.triangles, 1 + 2 + 4);
    }

    #[test]
    fn a_polygon_with_millions_of_corners_is_rejected() {
        let text = [b"v 0 0 0\nf".as_slice(), &b" 1".repeat(100_000)].concat();
        let counts = Counts::of(&text);
        assert_eq!(counts.triangles, 99_998);
        let options = ReadOptions::default().with_max_memory(1 << 20);
        let problem = counts.claim(&options).unwrap_err().problem;
        assert!(problem.contains("99998 triangles"), "{problem}");
        assert!(counts.claim(&options.with_max_memory(8 << 20)).is_ok());
    }
}
