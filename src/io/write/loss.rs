//! What of a cloud a format has no place for.

use crate::cloud::RawCloud;

/// Something that some formats do not hold.
#[derive(Debug, Clone, Copy)]
pub(in crate::io) struct Loss {
    name: &'static str,
    is_in: fn(&RawCloud) -> bool,
}

impl Loss {
    /// Called `name`, where `is_in` finds it in a cloud.
    pub(in crate::io) const fn new(name: &'static str, is_in: fn(&RawCloud) -> bool) -> Self {
        Self { name, is_in }
    }

    pub(in crate::io) const NORMALS: Self = Self {
        name: "normals",
        is_in: |cloud| cloud.attributes.normals.is_some(),
    };
    pub(in crate::io) const RADII: Self = Self {
        name: "radii",
        is_in: |cloud| cloud.attributes.radii.is_some(),
    };
    pub(in crate::io) const ELLIPSES: Self = Self {
        name: "shapes of splats",
        is_in: |cloud| cloud.attributes.ellipses.is_some(),
    };
    pub(in crate::io) const ALPHA: Self = Self {
        name: "opacities",
        is_in: |cloud| {
            let mut colors = cloud.attributes.colors.iter().flatten();
            colors.any(|color| color[3] != u8::MAX)
        },
    };
    pub(in crate::io) const HOLES: Self = Self {
        name: "points without finite coordinates",
        is_in: |cloud| cloud.positions.finite_bounds().0 < cloud.positions.len(),
    };
    pub(in crate::io) const FACES: Self = Self {
        name: "faces",
        is_in: |cloud| !cloud.faces.is_empty(),
    };
    pub(in crate::io) const SENSOR: Self = Self {
        name: "the position of the sensor",
        is_in: |cloud| cloud.sensor.is_some(),
    };

    /// The names of those of `losses` that concern `cloud`.
    pub(super) fn of<'a>(losses: &'a [Self], cloud: &'a RawCloud) -> impl Iterator<Item = &'static str> + 'a {
        losses.iter().filter(|loss| (loss.is_in)(cloud)).map(|loss| loss.name)
    }
}
