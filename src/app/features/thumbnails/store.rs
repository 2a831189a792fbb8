//! Thumbnail cache, within a budget.

use egui::{ColorImage, Context, TextureHandle, TextureId, TextureOptions};
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::sync::Arc;

/// Bytes of all thumbnails; the textures of shown ones take the same amount again.
pub(super) const BUDGET_BYTES: usize = 16 << 20;

/// Size of a thumbnail in pixels; the strip shows it smaller.
pub(in crate::app) const PICTURE_PX: [u32; 2] = [160, 120];

/// Bytes of a thumbnail.
pub(super) const PICTURE_BYTES: usize = 4 * PICTURE_PX[0] as usize * PICTURE_PX[1] as usize;

/// Maximum number of cells of a strip that fit into the budget, with some thumbnails under the pointer in addition.
pub(in crate::app) const MAX_CELLS: usize = BUDGET_BYTES / PICTURE_BYTES * 3 / 4;

/// Cached thumbnail of a frame.
enum StoredThumbnail {
    Picture(Arc<ColorImage>, Option<TextureHandle>),
    /// It cannot be read.
    Broken,
}

/// Display state of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::app) enum ThumbnailState {
    /// Not made yet.
    Unknown,
    /// It cannot be read.
    Broken,
    /// By this thumbnail.
    Picture(TextureId),
}

/// Thumbnails by frame.
#[derive(Default)]
pub(super) struct Store {
    entries: BTreeMap<usize, StoredThumbnail>,
    /// Frames with thumbnails, the oldest at the front.
    order: VecDeque<usize>,
}

impl std::fmt::Debug for Store {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter
            .debug_struct("Store")
            .field("frames", &self.entries.len())
            .field("bytes", &self.bytes())
            .finish_non_exhaustive()
    }
}

impl Store {
    /// Bytes of all thumbnails.
    pub(super) fn bytes(&self) -> usize {
        PICTURE_BYTES * self.order.len()
    }

    /// Returns true if the thumbnail of `frame` is known.
    pub(super) fn has(&self, frame: usize) -> bool {
        self.entries.contains_key(&frame)
    }

    /// Remembers that `frame` cannot be read.
    pub(super) fn mark_broken(&mut self, frame: usize) {
        self.entries.entry(frame).or_insert(StoredThumbnail::Broken);
    }

    /// Stores the thumbnail of `frame`. Where space is lacking, evicts the oldest that is not among `wanted`, else the
    /// oldest.
    pub(super) fn insert(&mut self, frame: usize, image: ColorImage, wanted: &BTreeSet<usize>) {
        self.order.retain(|&other| other != frame);
        while self.bytes() + PICTURE_BYTES > BUDGET_BYTES {
            let unwanted = self.order.iter().position(|other| !wanted.contains(other));
            let Some(oldest) = self.order.remove(unwanted.unwrap_or(0)) else {
                break;
            };
            self.entries.remove(&oldest);
        }
        self.order.push_back(frame);
        self.entries
            .insert(frame, StoredThumbnail::Picture(Arc::new(image), None));
    }

    /// Returns the thumbnail state of `frame` in the window of `ctx`; its texture is created on first use.
    pub(super) fn look(&mut self, ctx: &Context, frame: usize) -> ThumbnailState {
        match self.entries.get_mut(&frame) {
            None => ThumbnailState::Unknown,
            Some(StoredThumbnail::Broken) => ThumbnailState::Broken,
            Some(StoredThumbnail::Picture(image, texture)) => {
                let load = || {
                    let name = format!("thumbnail {frame}");
                    ctx.load_texture(name, Arc::clone(image), TextureOptions::LINEAR)
                };
                ThumbnailState::Picture(texture.get_or_insert_with(load).id())
            }
        }
    }

    /// Nothing is known of `frame` any more.
    pub(super) fn forget(&mut self, frame: usize) {
        self.entries.remove(&frame);
        self.order.retain(|&other| other != frame);
    }

    /// Forgets the textures so that they are re-created: they belonged to another window.
    pub(super) fn forget_textures(&mut self) {
        for entry in self.entries.values_mut() {
            if let StoredThumbnail::Picture(_, texture) = entry {
                *texture = None;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn picture() -> ColorImage {
        ColorImage::filled(PICTURE_PX.map(|edge| edge as usize), egui::Color32::RED)
    }

    // A strip wider than any screen at 50 points per cell, plus the hovered frame, fits into the budget.
    const _: () = assert!(MAX_CELLS >= 150);
    const _: () = assert!((MAX_CELLS + 1) * PICTURE_BYTES <= BUDGET_BYTES);

    #[test]
    fn bytes_are_those_of_the_pixels() {
        assert_eq!(PICTURE_BYTES, picture().pixels.len() * 4);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(8))]

        #[test]
        fn thumbnails_stay_within_the_budget_and_wanted_ones_stay_cached(
            frames in prop::collection::vec(0usize..2000, 300..700),
            wanted in prop::collection::btree_set(0usize..2000, 0..MAX_CELLS),
        ) {
            let mut store = Store::default();
            let mut inserted = BTreeSet::new();
            for frame in frames {
                store.insert(frame, picture(), &wanted);
                inserted.insert(frame);
                prop_assert!(store.bytes() <= BUDGET_BYTES);
                prop_assert!(store.has(frame));
                prop_assert_eq!(store.order.len(), store.entries.len());
            }
            for frame in wanted.intersection(&inserted) {
                prop_assert!(store.has(*frame), "{}", frame);
            }
        }
    }

    #[test]
    fn textures_are_created_once_per_window() {
        let mut store = Store::default();
        let ctx = Context::default();
        store.insert(3, picture(), &BTreeSet::new());
        store.mark_broken(4);
        store.mark_broken(3);
        let look = store.look(&ctx, 3);
        assert!(matches!(look, ThumbnailState::Picture(_)));
        assert_eq!(store.look(&ctx, 3), look);
        assert_eq!(store.look(&ctx, 4), ThumbnailState::Broken);
        assert_eq!(store.look(&ctx, 5), ThumbnailState::Unknown);
        store.forget_textures();
        assert_ne!(store.look(&ctx, 3), look);
        store.forget(3);
        store.forget(4);
        assert_eq!(
            [3, 4].map(|frame| store.look(&ctx, frame)),
            [ThumbnailState::Unknown; 2]
        );
        assert_eq!(store.bytes(), 0);
    }
}
