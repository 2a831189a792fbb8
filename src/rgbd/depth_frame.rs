//! Depth frame: the source images of a depth image's cloud, for a GPU that makes its points itself.
//!
//! **How it works.** Images are a third of the bytes of their points: two bytes of depth and three of colour per pixel,
//! as cameras deliver them (Hofer et al. 2018 §3.4: depth and colour are uploaded, not points). Numbers of 16 bits stay
//! as they were recorded, with a table of their values in metres: so the metres of GPU and CPU agree bit by bit,
//! whatever the code. Filters are applied where the points are made; [`Filters`] is the reference for them.
//!
//! A temporal filter needs the images before, from the beginning of the group on. Frames of a group that one decoder
//! decodes share them.

use super::filters::{Filters, TemporalFilter};
use super::images::DepthImage;
use super::rays::RayTable;
use crate::cloud::{Frame, MadeFrom};
use std::sync::Arc;

/// Depth lookup table: metres of each of 2¹⁶ numbers; 0 where it is not a distance.
#[derive(Debug, Clone)]
pub struct DepthTable(Arc<Vec<f32>>);

impl DepthTable {
    /// One entry per number.
    pub const LEN: usize = 1 << 16;

    /// The table of values of `metres`; invalid distances (not finite, not above 0) become 0.
    pub fn new(metres: impl Fn(u16) -> f32) -> Self {
        let metres = (0..=u16::MAX).map(|number| distance(metres(number)));
        Self(Arc::new(metres.collect()))
    }

    /// Metres of every number, [`DepthTable::LEN`] of them.
    pub fn metres(&self) -> &[f32] {
        &self.0
    }

    /// Returns true if both share the same allocation.
    pub fn is_same(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

/// A depth image before its filters, line by line from the top.
#[derive(Debug)]
pub enum DepthSamples {
    /// As recorded, and the meaning of its numbers.
    Coded {
        /// A number a pixel.
        numbers: Vec<u16>,
        /// Table of the depth of each number.
        table: DepthTable,
    },
    /// Metres; 0 where nothing was measured.
    Metres(Vec<f32>),
}

impl DepthSamples {
    /// Numbers that `table` explains.
    pub fn coded(numbers: Vec<u16>, table: DepthTable) -> Self {
        Self::Coded { numbers, table }
    }

    /// Metres; invalid distances become 0.
    pub fn metres(mut metres: Vec<f32>) -> Self {
        for depth in &mut metres {
            *depth = distance(*depth);
        }
        Self::Metres(metres)
    }

    /// Returns the depth table of the numbers, unless they are metres.
    pub fn table(&self) -> Option<&DepthTable> {
        match self {
            Self::Coded { table, .. } => Some(table),
            Self::Metres(_) => None,
        }
    }

    /// Number of pixels.
    pub fn len(&self) -> usize {
        match self {
            Self::Coded { numbers, .. } => numbers.len(),
            Self::Metres(metres) => metres.len(),
        }
    }

    /// Returns true if it is empty.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Bytes of its pixels.
    pub fn byte_size(&self) -> usize {
        match self {
            Self::Coded { numbers, .. } => size_of_val(numbers.as_slice()),
            Self::Metres(metres) => size_of_val(metres.as_slice()),
        }
    }

    /// The image of these; `None` unless there is one per pixel.
    pub fn image(&self, size_px: [u32; 2]) -> Option<DepthImage> {
        let metres = match self {
            Self::Coded { numbers, table } => numbers
                .iter()
                .map(|&number| table.metres()[usize::from(number)])
                .collect(),
            Self::Metres(metres) => metres.clone(),
        };
        DepthImage::new(size_px, metres)
    }
}

/// Returns a depth that is finite and above 0 unchanged, or else 0.
fn distance(metres: f32) -> f32 {
    if metres.is_finite() && metres > 0.0 {
        metres
    } else {
        0.0
    }
}

/// Images of one frame, all of the size of its rays.
#[derive(Debug)]
pub struct DepthFrame {
    before: Vec<Arc<DepthSamples>>,
    depth: Arc<DepthSamples>,
    rays: Arc<RayTable>,
    colors: Option<Vec<[u8; 3]>>,
    filters: Filters,
}

impl DepthFrame {
    /// The images of a frame: its depths, with the depths of the earlier frames that a temporal filter begins with, and
    /// the colour of each pixel. `None` unless they have one size and code.
    pub fn new(
        before: Vec<Arc<DepthSamples>>,
        depth: Arc<DepthSamples>,
        rays: Arc<RayTable>,
        colors: Option<Vec<[u8; 3]>>,
        filters: Filters,
    ) -> Option<Self> {
        let pixels = rays.rays().len();
        let are_of_one_size = depth.len() == pixels
            && before.iter().all(|before| before.len() == pixels)
            && colors.as_ref().is_none_or(|colors| colors.len() == pixels);
        let is_one_code = {
            let mut tables = before.iter().chain([&depth]).filter_map(|samples| samples.table());
            let first = tables.next();
            tables.all(|table| first.is_some_and(|first| first.is_same(table)))
        };
        (pixels > 0 && are_of_one_size && is_one_code).then_some(Self {
            before,
            depth,
            rays,
            colors,
            filters,
        })
    }

    /// Returns the depth images that `frame` was made from, if it was made from such images and was not modified since.
    pub fn of(frame: &Frame) -> Option<Arc<Self>> {
        frame.made_from()?.get()
    }

    /// For [`RawCloud::made_from`](crate::cloud::RawCloud::made_from). Images before it are counted as one: they belong
    /// to other frames, too.
    pub fn into_made_from(self) -> MadeFrom {
        let images = 1 + usize::from(!self.before.is_empty());
        let of_colors = self.colors.as_ref().map_or(0, |colors| size_of_val(colors.as_slice()));
        let byte_size = images * self.depth.byte_size() + of_colors;
        MadeFrom::new(Arc::new(self), byte_size)
    }

    /// Width and height.
    pub fn size_px(&self) -> [u32; 2] {
        self.rays.size_px()
    }

    /// Number of pixels.
    pub fn pixels(&self) -> usize {
        self.depth.len()
    }

    /// The depth image, and those that a temporal filter goes through first, in their order.
    pub fn images(&self) -> impl DoubleEndedIterator<Item = &Arc<DepthSamples>> + ExactSizeIterator {
        // `Chain` does not know its length.
        let count = self.before.len() + 1;
        (0..count).map(|place| self.before.get(place).unwrap_or(&self.depth))
    }

    /// The ray of every pixel.
    pub fn rays(&self) -> &Arc<RayTable> {
        &self.rays
    }

    /// The colour of every pixel, if there are colours.
    pub fn colors(&self) -> Option<&[[u8; 3]]> {
        self.colors.as_deref()
    }

    /// Returns the filters that are applied to depths before they become points.
    pub fn filters(&self) -> &Filters {
        &self.filters
    }

    /// The filtered image, computed on the CPU.
    pub fn filtered(&self) -> Option<DepthImage> {
        let mut temporal = self.filters.temporal.map(TemporalFilter::new);
        let mut last = None;
        for samples in self.images() {
            let filtered = self.filters.apply(samples.image(self.size_px())?);
            last = Some(match &mut temporal {
                Some(temporal) => temporal.next(filtered),
                None => filtered,
            });
        }
        last
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rgbd::{Camera, Distortion};
    use glam::DVec2;

    fn rays(size_px: [u32; 2]) -> Arc<RayTable> {
        let camera = Camera::new(size_px, DVec2::splat(2.0), DVec2::ZERO, Distortion::None).unwrap();
        Arc::new(RayTable::of(&camera))
    }

    #[test]
    fn invalid_depth_values_are_holes() {
        let odd = [f32::NAN, f32::INFINITY, -1.0, 0.0, 2.5];
        let metres = DepthSamples::metres(odd.to_vec());
        assert_eq!(metres.image([5, 1]).unwrap().metres(), [0.0, 0.0, 0.0, 0.0, 2.5]);
        let table = DepthTable::new(|number| odd.get(usize::from(number)).copied().unwrap_or(1.0));
        assert_eq!(table.metres().len(), DepthTable::LEN);
        let coded = DepthSamples::coded(vec![0, 1, 2, 3, 4, u16::MAX], table);
        let image = coded.image([3, 2]).unwrap();
        assert_eq!(image.metres(), [0.0, 0.0, 0.0, 0.0, 2.5, 1.0]);
        assert_eq!(coded.image([5, 1]), None);
    }

    #[test]
    fn images_of_different_sizes_do_not_form_a_frame() {
        let image = |pixels: usize| Arc::new(DepthSamples::metres(vec![1.0; pixels]));
        let new = |before: usize, depth: usize, colors: usize| {
            let colors = Some(vec![[1, 2, 3]; colors]);
            DepthFrame::new(vec![image(before)], image(depth), rays([3, 2]), colors, Filters::NONE)
        };
        assert!(new(6, 6, 6).is_some());
        assert!(new(5, 6, 6).is_none() && new(6, 7, 6).is_none() && new(6, 6, 0).is_none());
    }

    #[test]
    fn previous_images_count_with_a_temporal_filter() {
        let image = |depth: f32| Arc::new(DepthSamples::metres(vec![depth; 6]));
        let filters: Filters = "temporal".parse().unwrap();
        let frame = DepthFrame::new(vec![image(1.0)], image(1.01), rays([3, 2]), None, filters).unwrap();
        let images: Vec<f32> = frame
            .images()
            .map(|image| image.image([3, 2]).unwrap().metres()[0])
            .collect();
        assert_eq!(images, [1.0, 1.01]);
        assert!((frame.filtered().unwrap().metres()[0] - 1.004).abs() < 1e-6);
    }
}
