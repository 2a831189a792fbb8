//! Names and parameters of the depth image filters: read by the command line, session files and the window, so that a
//! filter is described once.

use super::{Bilateral, DepthRange, Filters, FlyingPixels, Temporal};
use std::ops::RangeInclusive;

/// A filter, by the names that people see.
#[derive(Debug)]
pub struct FilterKind {
    /// In `--rgbd-filters` and in session files.
    pub name: &'static str,
    /// In the window.
    pub title: &'static str,
    /// Description of the filter's effect.
    pub hint: &'static str,
    /// Returns true if the filter is applied.
    pub is_on: fn(&Filters) -> bool,
    /// Applies it with its usual parameters, or leaves it out.
    pub set_on: fn(&mut Filters, bool),
    /// Adjustable parameters of the filter.
    pub parameters: &'static [FilterParameter],
}

/// A number of a filter.
#[derive(Debug)]
pub struct FilterParameter {
    /// In `--rgbd-filters` and in session files.
    pub name: &'static str,
    /// In the window.
    pub title: &'static str,
    /// Description of the parameter's effect, with the default value.
    pub hint: &'static str,
    /// Behind the number.
    pub unit: &'static str,
    /// Range of valid values.
    pub range: RangeInclusive<f32>,
    /// Digits behind the point; whole numbers have none.
    pub digits: u8,
    get: fn(&Filters) -> Option<f32>,
    set: fn(&mut Filters, f32),
}

impl FilterParameter {
    /// Returns the parameter's value; `None` if its filter is disabled.
    pub fn get(&self, filters: &Filters) -> Option<f32> {
        (self.get)(filters)
    }

    /// Sets it to the value in its range that is nearest to `value`, if its filter is applied. A value that is not a
    /// number changes nothing.
    pub fn set(&self, filters: &mut Filters, value: f32) {
        if !value.is_nan() {
            let value = value.clamp(*self.range.start(), *self.range.end());
            (self.set)(filters, if self.digits == 0 { value.round() } else { value });
        }
    }
}

impl Filters {
    /// Returns the names and adjustable parameters of the filters, in the order in which they are applied.
    pub fn kinds() -> &'static [FilterKind] {
        &KINDS
    }
}

/// All filters, in the order in which they are applied.
pub(super) static KINDS: [FilterKind; Filters::COUNT] = [
    FilterKind {
        name: "near",
        title: "Depth range",
        hint: "Drops what is nearer or farther than the sensor measures",
        is_on: |filters| filters.near.is_some(),
        set_on: |filters, is_on| filters.near = is_on.then_some(DepthRange::USUAL),
        parameters: &[
            FilterParameter {
                name: "from",
                title: "Nearest depth",
                hint: "Nearer pixels are dropped (default: 0.1 m)",
                unit: " m",
                range: 0.0..=1000.0,
                digits: 2,
                get: |filters| filters.near.map(|near| near.near_m),
                set: |filters, value| {
                    if let Some(near) = &mut filters.near {
                        near.near_m = value;
                    }
                },
            },
            FilterParameter {
                name: "to",
                title: "Farthest depth",
                hint: "Farther pixels are dropped (default: 10 m)",
                unit: " m",
                range: 0.0..=1000.0,
                digits: 2,
                get: |filters| filters.near.map(|near| near.far_m),
                set: |filters, value| {
                    if let Some(near) = &mut filters.near {
                        near.far_m = value;
                    }
                },
            },
        ],
    },
    FilterKind {
        name: "median",
        title: "Depth median",
        hint: "The median of 5 × 5 pixels: single wrong depths go",
        is_on: |filters| filters.median,
        set_on: |filters, is_on| filters.median = is_on,
        parameters: &[],
    },
    FilterKind {
        name: "bilateral",
        title: "Bilateral filter",
        hint: "The mean of 9 × 9 pixels that are at a similar depth: noise goes, edges stay",
        is_on: |filters| filters.bilateral.is_some(),
        set_on: |filters, is_on| filters.bilateral = is_on.then_some(Bilateral::USUAL),
        parameters: &[
            FilterParameter {
                name: "px",
                title: "Bilateral width",
                hint: "Spatial extent of the neighbours, σ_s (default: 3 pixels)",
                unit: " px",
                range: 0.3..=20.0,
                digits: 1,
                get: |filters| filters.bilateral.map(|bilateral| bilateral.space_px),
                set: |filters, value| {
                    if let Some(bilateral) = &mut filters.bilateral {
                        bilateral.space_px = value;
                    }
                },
            },
            FilterParameter {
                name: "noise",
                title: "Bilateral depth",
                hint: "Depth extent of the neighbours, σ_d, as a factor on the sensor noise at that depth (default: 3)",
                unit: " × noise",
                range: 0.1..=50.0,
                digits: 1,
                get: |filters| filters.bilateral.map(|bilateral| bilateral.noise_factor),
                set: |filters, value| {
                    if let Some(bilateral) = &mut filters.bilateral {
                        bilateral.noise_factor = value;
                        bilateral.depth_m = None;
                    }
                },
            },
        ],
    },
    FilterKind {
        name: "flying",
        title: "Flying pixels",
        hint: "Drops pixels between a surface and what is behind it",
        is_on: |filters| filters.flying.is_some(),
        set_on: |filters, is_on| filters.flying = is_on.then_some(FlyingPixels::USUAL),
        parameters: &[
            FilterParameter {
                name: "m",
                title: "Flying within",
                hint: "Largest depth difference between neighbours (default: 0.01 m)",
                unit: " m",
                range: 0.0..=10.0,
                digits: 3,
                get: |filters| filters.flying.map(|flying| flying.max_m),
                set: |filters, value| {
                    if let Some(flying) = &mut filters.flying {
                        flying.max_m = value;
                    }
                },
            },
            FilterParameter {
                name: "share",
                title: "Flying share",
                hint: "The same as a share of the depth: the larger of both applies (default: 0.02)",
                unit: " of depth",
                range: 0.0..=1.0,
                digits: 3,
                get: |filters| filters.flying.map(|flying| flying.max_share),
                set: |filters, value| {
                    if let Some(flying) = &mut filters.flying {
                        flying.max_share = value;
                    }
                },
            },
            FilterParameter {
                name: "neighbours",
                title: "Flying neighbours",
                hint: "Pixels with fewer of their eight neighbours that near are dropped (default: 4)",
                unit: " of 8",
                range: 0.0..=8.0,
                digits: 0,
                get: |filters| filters.flying.map(|flying| flying.min_neighbours.into()),
                set: |filters, value| {
                    if let Some(flying) = &mut filters.flying {
                        flying.min_neighbours = value as u8;
                    }
                },
            },
            FilterParameter {
                name: "erosion",
                title: "Flying erosion",
                hint: "Number of further pixels dropped along every edge (default: 0)",
                unit: " px",
                range: 0.0..=16.0,
                digits: 0,
                get: |filters| filters.flying.map(|flying| flying.erosion_px.into()),
                set: |filters, value| {
                    if let Some(flying) = &mut filters.flying {
                        flying.erosion_px = value as u8;
                    }
                },
            },
        ],
    },
    FilterKind {
        name: "temporal",
        title: "Mean over time",
        hint: "The mean with the frames before, for a camera at rest",
        is_on: |filters| filters.temporal.is_some(),
        set_on: |filters, is_on| filters.temporal = is_on.then_some(Temporal::USUAL),
        parameters: &[
            FilterParameter {
                name: "share",
                title: "Mean share",
                hint: "Weight of the newest frame in the mean, α: less is smoother but lags more (default: 0.4)",
                unit: "",
                range: 0.1..=1.0,
                digits: 2,
                get: |filters| filters.temporal.map(|temporal| temporal.share),
                set: |filters, value| {
                    if let Some(temporal) = &mut filters.temporal {
                        temporal.share = value;
                    }
                },
            },
            FilterParameter {
                name: "m",
                title: "Mean within",
                hint: "Where the depth differs by more, something has moved and the mean restarts (default: 0.02 m)",
                unit: " m",
                range: 0.0..=10.0,
                digits: 3,
                get: |filters| filters.temporal.map(|temporal| temporal.max_m),
                set: |filters, value| {
                    if let Some(temporal) = &mut filters.temporal {
                        temporal.max_m = value;
                    }
                },
            },
            FilterParameter {
                name: "fill",
                title: "Holes filled",
                hint: "Number of frames for which a hole has its last measured depth (default: 0)",
                unit: " frames",
                range: 0.0..=30.0,
                digits: 0,
                get: |filters| filters.temporal.map(|temporal| temporal.fill_frames.into()),
                set: |filters, value| {
                    if let Some(temporal) = &mut filters.temporal {
                        temporal.fill_frames = value as u8;
                    }
                },
            },
        ],
    },
];
