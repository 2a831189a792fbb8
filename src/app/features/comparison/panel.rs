//! The bar of an A/B view: the edited side, the numbers, and the difference of the images.

use super::{Comparison, PicturePair};
use crate::app::side::Side;
use egui::{Checkbox, Ui};

/// Request of the bar to the window.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::app) enum ComparisonRequest {
    /// Edit the settings of this side from now on.
    Edit(Side),
    /// Back to one image, drawn as this side is.
    Use(Side),
}

/// Shows the bar while two render modes are compared.
pub(in crate::app) fn comparison_ui(ui: &mut Ui, comparison: &mut Comparison) -> Option<ComparisonRequest> {
    let mut edited = comparison.edited;
    let mut used = None;
    ui.horizontal_wrapped(|ui| {
        ui.label("Settings of");
        for (side, text, tooltip) in [
            (
                Side::A,
                "A (left)",
                "The panel shows and changes the settings of the left side",
            ),
            (
                Side::B,
                "B (right)",
                "The panel shows and changes the settings of the right side",
            ),
        ] {
            ui.selectable_value(&mut edited, side, text).on_hover_text(tooltip);
        }
        ui.separator();
        error_map_ui(ui, &mut comparison.pictures);
        difference_ui(ui, &comparison.pictures);
        ui.separator();
        for (side, text, tooltip) in [
            (Side::B, "Use B", "Ends the comparison and keeps the settings of B"),
            (Side::A, "Close", "Ends the comparison and keeps the settings of A (C)"),
        ] {
            if ui.button(text).on_hover_text(tooltip).clicked() {
                used = Some(side);
            }
        }
    });
    let edit = (edited != comparison.edited).then_some(ComparisonRequest::Edit(edited));
    used.map(ComparisonRequest::Use).or(edit)
}

/// Shows the toggle between the images and their error map.
pub(in crate::app) fn error_map_ui(ui: &mut Ui, pictures: &mut PicturePair) {
    ui.add(Checkbox::new(&mut pictures.shows_difference, "Error map"))
        .on_hover_text("FLIP per pixel with A as the reference: black is not visible, pale is the largest difference");
}

/// Shows the difference of the images.
pub(in crate::app) fn difference_ui(ui: &mut Ui, pictures: &PicturePair) {
    ui.separator();
    match &pictures.difference {
        Some(difference) => {
            let numbers = numbers(difference.flip, difference.psnr_db, difference.ssim);
            ui.monospace(numbers).on_hover_text(
                "Of the whole images. FLIP: 0 is equal, 1 the largest difference. PSNR: infinite for equal images. \
                    SSIM: 1 for equal images",
            );
        }
        None => {
            ui.weak("Compared when the view is still");
        }
    }
}

fn numbers(flip: f64, psnr_db: f64, ssim: Option<f64>) -> String {
    let psnr = if psnr_db.is_finite() {
        format!("{psnr_db:.1} dB")
    } else {
        "∞".to_owned()
    };
    let ssim = ssim.map_or_else(|| "–".to_owned(), |ssim| format!("{ssim:.4}"));
    format!("FLIP {flip:.4}   PSNR {psnr}   SSIM {ssim}")
}

#[cfg(test)]
mod tests {
    use super::numbers;

    #[test]
    fn equal_and_small_images_have_numbers_too() {
        assert_eq!(numbers(0.0, f64::INFINITY, None), "FLIP 0.0000   PSNR ∞   SSIM –");
        assert_eq!(
            numbers(0.125, 31.26, Some(0.95)),
            "FLIP 0.1250   PSNR 31.3 dB   SSIM 0.9500"
        );
    }
}
