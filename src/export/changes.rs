//! Changed region of an image relative to the previous one: formats that allow it store no more.

use image::RgbaImage;

/// Columns and rows from `start` on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct ChangedRect {
    pub(super) start: [u32; 2],
    pub(super) size: [u32; 2],
}

impl ChangedRect {
    /// The pixels of it.
    pub(super) fn of(self, picture: &RgbaImage) -> Vec<u8> {
        let [left, top] = self.start.map(|px| px as usize);
        let [width, height] = self.size.map(|px| px as usize);
        let row_bytes = 4 * picture.width() as usize;
        let rows = picture.as_raw().chunks_exact(row_bytes);
        rows.skip(top)
            .take(height)
            .flat_map(|row| &row[4 * left..4 * (left + width)])
            .copied()
            .collect()
    }
}

/// The smallest rectangle, beginning at multiples of `grid`, that contains all differences of `picture` from `before`:
/// one pixel at least. The whole image if there is none before.
pub(super) fn changed_part(before: Option<&RgbaImage>, picture: &RgbaImage, grid: u32) -> ChangedRect {
    let (width, height) = picture.dimensions();
    let whole = ChangedRect {
        start: [0, 0],
        size: [width, height],
    };
    let Some(before) = before else {
        return whole;
    };
    let row_bytes = 4 * width as usize;
    let mut ends = [[u32::MAX, 0]; 2];
    let rows = before.as_raw().chunks_exact(row_bytes);
    for (y, (old, new)) in (0..).zip(rows.zip(picture.as_raw().chunks_exact(row_bytes))) {
        if old == new {
            continue;
        }
        let differs = |&(old, new): &(&[u8; 4], &[u8; 4])| old != new;
        let ((old, _), (new, _)) = (old.as_chunks::<4>(), new.as_chunks::<4>());
        let first = old.iter().zip(new).position(|pair| differs(&pair));
        let last = old.iter().zip(new).rposition(|pair| differs(&pair));
        for (axis, place) in [(0, first), (0, last), (1, Some(y))] {
            let place = place.map_or(0, |place| place as u32);
            ends[axis] = [ends[axis][0].min(place), ends[axis][1].max(place + 1)];
        }
    }
    if ends[1][1] == 0 {
        return ChangedRect {
            start: [0, 0],
            size: [1, 1],
        };
    }
    let start = ends.map(|[first, _]| first - first % grid);
    ChangedRect {
        start,
        size: [0, 1].map(|axis| ends[axis][1] - start[axis]),
    }
}
