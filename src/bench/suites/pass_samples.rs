//! The GPU times of passes over many images, as suites collect and report them.

use crate::bench::Quantiles;
use crate::render::PassTimes;

/// The times of each pass, in the order in which the passes were first seen.
#[derive(Debug, Default)]
pub(super) struct PassSamples {
    passes: Vec<(&'static str, Vec<f64>)>,
}

impl PassSamples {
    /// Adds the times of one image. Passes of one name are summed up, as `compute` amplifies several times.
    pub(super) fn add(&mut self, times: &PassTimes) {
        let mut of_picture: Vec<(&'static str, f64)> = Vec::new();
        for time in times.iter() {
            let Some(gpu_ms) = time.gpu_ms else { continue };
            match of_picture.iter_mut().find(|(pass, _)| *pass == time.pass) {
                Some((_, sum_ms)) => *sum_ms += gpu_ms,
                None => of_picture.push((time.pass, gpu_ms)),
            }
        }
        for (pass, gpu_ms) in of_picture {
            match self.passes.iter_mut().find(|(known, _)| *known == pass) {
                Some((_, samples_ms)) => samples_ms.push(gpu_ms),
                None => self.passes.push((pass, vec![gpu_ms])),
            }
        }
    }

    /// The median of each pass.
    pub(super) fn medians_ms(&self) -> impl Iterator<Item = (&'static str, f64)> {
        let passes = self.passes.iter();
        passes.filter_map(|(pass, samples_ms)| Some((*pass, Quantiles::of(samples_ms)?.median)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::PassTime;

    #[test]
    fn passes_with_the_same_name_are_merged_and_untimed_ones_skipped() {
        let time = |(pass, gpu_ms)| PassTime { pass, gpu_ms };
        let mut samples = PassSamples::default();
        let pictures = [
            [("amplify", Some(1.0)), ("solid", Some(5.0)), ("amplify", Some(2.0))],
            [("amplify", Some(3.0)), ("solid", None), ("grid", Some(4.0))],
            [("amplify", Some(8.0)), ("solid", Some(7.0)), ("grid", Some(6.0))],
        ];
        for picture in pictures {
            samples.add(&picture.map(time).into_iter().collect());
        }
        assert!(
            samples
                .medians_ms()
                .eq([("amplify", 3.0), ("solid", 6.0), ("grid", 5.0)])
        );
    }
}
