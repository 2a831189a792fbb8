//! Size of an image or of the window: one option, or width and height.

use super::arguments::size_px;
use clap::Args;

/// Width and height in pixels.
#[derive(Debug, Clone, Default, Args)]
pub(in crate::cli) struct SizeArgs {
    /// Size of the image or window in pixels [default: 1280x720, for the window as last time]
    #[arg(long, value_name = "WxH", value_parser = size_px)]
    size: Option<[u32; 2]>,

    /// Width in pixels; the height keeps the aspect ratio of the default size
    #[arg(long, value_name = "PX", hide_short_help = true, conflicts_with = "size",
        value_parser = clap::value_parser!(u32).range(1..))]
    width: Option<u32>,

    /// Height in pixels; the width keeps the aspect ratio of the default size
    #[arg(long, value_name = "PX", hide_short_help = true, conflicts_with = "size",
        value_parser = clap::value_parser!(u32).range(1..))]
    height: Option<u32>,
}

impl SizeArgs {
    /// The size that is given; a missing edge has the aspect ratio of `default_px`. `None` if nothing is given.
    pub(in crate::cli) fn of(&self, default_px: [u32; 2]) -> Option<[u32; 2]> {
        let [width, height] = default_px.map(f64::from);
        let scaled = |edge: u32, ratio: f64| ((f64::from(edge) * ratio).round() as u32).max(1);
        self.size.or(match (self.width, self.height) {
            (None, None) => None,
            (Some(given), None) => Some([given, scaled(given, height / width)]),
            (None, Some(given)) => Some([scaled(given, width / height), given]),
            (Some(width), Some(height)) => Some([width, height]),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_missing_edge_keeps_the_aspect_ratio() {
        let of = |width, height| {
            SizeArgs {
                size: None,
                width,
                height,
            }
            .of([1280, 720])
        };
        assert_eq!(of(None, None), None);
        assert_eq!(of(Some(640), None), Some([640, 360]));
        assert_eq!(of(None, Some(360)), Some([640, 360]));
        assert_eq!(of(Some(10), Some(20)), Some([10, 20]));
    }
}
