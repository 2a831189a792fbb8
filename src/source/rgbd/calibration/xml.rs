//! Cameras in XML: PCL's grabbers.

use super::model::{Calibration, Intrinsics};

/// Parses the calibration XML written by PCL's grabbers: two root elements without a common parent, which XML does not
/// allow.
pub(super) fn calibration(text: &str, because: String) -> Result<Calibration, String> {
    let start = text.trim_start();
    let content = match start.strip_prefix("<?").and_then(|rest| rest.split_once("?>")) {
        Some((_, content)) => content,
        None => start,
    };
    let whole = format!("<camera>{content}</camera>");
    let document = roxmltree::Document::parse(&whole).map_err(|error| error.to_string())?;
    let element = |name: &str| document.descendants().find(|node| node.has_tag_name(name));
    let of = |camera: roxmltree::Node<'_, '_>| -> Result<Intrinsics, String> {
        let number = |name: &str| {
            let node = camera.children().find(|node| node.has_tag_name(name));
            let number = node.and_then(|node| node.text()?.trim().parse().ok());
            number.ok_or_else(|| format!("<{name}> is missing"))
        };
        let numbers = [
            number("focal_length_x")?,
            number("focal_length_y")?,
            number("principal_point_x")?,
            number("principal_point_y")?,
        ];
        Ok(Intrinsics::pinhole(numbers, None))
    };
    let depth = element("depth").ok_or("<depth> is missing")?;
    let factor = depth
        .children()
        .find(|node| node.has_tag_name("z_multiplication_factor"));
    let factor: Option<f64> = factor.and_then(|node| node.text()?.trim().parse().ok());
    Ok(Calibration {
        units_per_metre: factor.filter(|&factor| factor > 0.0).map(|factor| 1.0 / factor),
        ..Calibration::of_depth(of(depth)?, because)
    })
}
