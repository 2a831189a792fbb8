//! Losses of a cloud in a format, by comparing its attributes with those that the format holds.
//!
//! **How it works.** An [`Encoder`] lists the attributes of its format ([`Held`]). An attribute of the cloud that is
//! not listed is a [`Loss`], as are the encoder's own findings, such as rounded coordinates.

use super::encoder::{Encoder, Held};
use super::loss::{Loss, Losses};
use crate::cloud::RawCloud;

/// Returns the losses of `cloud` with `encoder`: everything that it cannot hold.
pub(super) fn losses(encoder: &Encoder, cloud: &RawCloud) -> Losses {
    let attributes = &cloud.attributes;
    let mut losses = Losses::default();
    let mut note = |held: Held, is_there: bool, loss: Loss, amount: f64| {
        if is_there && !encoder.holds.contains(&held) {
            losses.add(loss, amount);
        }
    };
    let field = |name: &str| Loss::Field(name.to_owned());
    let colors = attributes.colors.as_deref().unwrap_or_default();
    let has_alpha = colors.iter().any(|color| color[3] != u8::MAX);
    note(Held::Normals, attributes.normals.is_some(), field("normals"), 0.0);
    note(Held::Alpha, has_alpha, field("the alpha of colours"), 0.0);
    note(Held::Radii, attributes.radii.is_some(), field("radii"), 0.0);
    note(Held::Ellipses, attributes.ellipses.is_some(), field("ellipses"), 0.0);
    for scalar in &attributes.scalars {
        note(Held::Scalars, true, Loss::Field(format!("`{}`", scalar.name)), 0.0);
    }
    let face_count = cloud.faces.len();
    note(Held::Faces, face_count > 0, Loss::Faces, face_count as f64);
    note(Held::Textures, cloud.texturing.is_some(), Loss::Textures, 0.0);
    note(Held::Rows, cloud.grid.is_some(), Loss::Rows, 0.0);
    note(Held::Sensor, cloud.sensor.is_some(), Loss::Sensor, 0.0);
    if !encoder.holds.contains(&Held::Holes) {
        let holes = cloud.positions.len() - cloud.positions.finite_bounds().0;
        note(Held::Holes, holes > 0, Loss::Holes, holes as f64);
    }
    losses.add_dropped(cloud);
    for (loss, amount) in (encoder.lost)(cloud) {
        losses.add(loss, amount);
    }
    losses
}
