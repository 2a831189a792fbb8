//! Temporal filter, the mean with the images before: a running mean that is reset where something moved.

use crate::rgbd::DepthImage;
use rayon::prelude::*;

/// Parameters of the filter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Temporal {
    /// Share of the newest image, above 0 and up to 1.
    pub share: f32,
    /// Difference in depth above which the mean of a pixel is reset, in metres.
    pub max_m: f32,
    /// Number of images for which a hole is filled with its last measurement.
    pub fill_frames: u8,
}

impl Temporal {
    /// A camera at rest; holes stay.
    pub const USUAL: Self = Self {
        share: 0.4,
        max_m: 0.02,
        fill_frames: 0,
    };

    /// Number of images after which earlier ones weigh a sixtieth of a difference of at most [`Self::max_m`], and fill
    /// no hole: 8 by default.
    pub fn lead_frames(&self) -> usize {
        let rest = (1.0 - self.share).clamp(0.0, 0.9);
        let images = if rest > 0.0 { -(60f32.ln()) / rest.ln() } else { 0.0 };
        (images.round() as usize).max(self.fill_frames.into())
    }
}

/// The filter with its state from earlier images.
#[derive(Debug, Clone)]
pub struct TemporalFilter {
    temporal: Temporal,
    before: Option<DepthImage>,
    /// For how many images each pixel was a hole.
    ages: Vec<u8>,
}

impl TemporalFilter {
    /// Before the first image.
    pub fn new(temporal: Temporal) -> Self {
        Self {
            temporal,
            before: None,
            ages: Vec::new(),
        }
    }

    /// Filters the next image and returns it. An image of another size resets the filter.
    pub fn next(&mut self, depth: DepthImage) -> DepthImage {
        let Temporal {
            share,
            max_m,
            fill_frames,
        } = self.temporal;
        let next = match self.before.take() {
            Some(mut before) if before.size_px() == depth.size_px() => {
                let pixels = before.metres_mut().par_iter_mut().zip(&mut self.ages);
                pixels.zip(depth.metres()).for_each(|((before, age), &now)| {
                    if now > 0.0 {
                        let is_same = *before > 0.0 && (now - *before).abs() <= max_m;
                        *before = if is_same {
                            *before + share * (now - *before)
                        } else {
                            now
                        };
                        *age = 0;
                    } else if *age < fill_frames {
                        *age += 1;
                    } else {
                        *before = 0.0;
                    }
                });
                before
            }
            _ => {
                self.ages = vec![0; depth.metres().len()];
                depth
            }
        };
        self.before = Some(next.clone());
        next
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image(metres: [f32; 4]) -> DepthImage {
        DepthImage::new([2, 2], metres.to_vec()).unwrap()
    }

    #[test]
    fn static_pixels_are_averaged_and_moving_ones_restart() {
        let mut filter = TemporalFilter::new(Temporal::USUAL);
        assert_eq!(filter.next(image([1.0, 1.0, 1.0, 0.0])), image([1.0, 1.0, 1.0, 0.0]));
        let second = filter.next(image([1.01, 1.5, 0.0, 2.0]));
        assert!((second.metres()[0] - 1.004).abs() < 1e-6, "{second:?}");
        assert_eq!(second.metres()[1..], [1.5, 0.0, 2.0]);
        let third = filter.next(image([1.01, 1.5, 1.2, 2.01]));
        assert!((third.metres()[0] - 1.0064).abs() < 1e-6, "{third:?}");
        assert_eq!(third.metres()[2], 1.2);
    }

    #[test]
    fn holes_are_filled_for_the_given_number_of_frames() {
        let mut filter = TemporalFilter::new(Temporal {
            fill_frames: 2,
            ..Temporal::USUAL
        });
        let hole = || image([0.0; 4]);
        let full = filter.next(image([1.0; 4]));
        for expected in [full.clone(), full, hole(), hole()] {
            assert_eq!(filter.next(hole()), expected);
        }
    }

    /// Property of `lead_frames`: two filters that began differently agree after that many images.
    #[test]
    fn the_influence_of_past_frames_fades() {
        assert_eq!(Temporal::USUAL.lead_frames(), 8);
        for share in [0.1, 0.4, 0.9, 1.0] {
            let temporal = Temporal {
                share,
                ..Temporal::USUAL
            };
            let mut filters = [1.0, 1.02].map(|first| {
                let mut filter = TemporalFilter::new(temporal);
                filter.next(image([first; 4]));
                filter
            });
            let mut difference = 0.02;
            // One is enough if nothing of the past is retained.
            for _ in 0..temporal.lead_frames().max(1) {
                let [a, b] = &mut filters;
                difference = (a.next(image([1.01; 4])).metres()[0] - b.next(image([1.01; 4])).metres()[0]).abs();
            }
            assert!(difference < 0.02 / 50.0, "{share}: {difference}");
        }
        let fills = Temporal {
            fill_frames: 20,
            ..Temporal::USUAL
        };
        assert_eq!(fills.lead_frames(), 20);
    }
}
