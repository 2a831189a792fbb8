//! How points are drawn that stay points.

use super::describe::{Label, Numbers, Place, Section, Unit, Values, When, group};

group! {
    /// How points are drawn that stay points.
    PointStyle {
        /// Edge of a drawn point in pixels.
        size_px: f32 = 2.0, "point_size_px" SIZE_PX {
            flag: "point-size",
            value_name: "PX",
            help: "Edge of a point in pixels",
            title: "Point size",
            hint: "Edge of the square drawn for a point, pixels (+ and -)",
            section: Section::Points,
            when: When::Points,
            label: Label::Always(Place::What, "{} px"),
            values: Values::Number(Numbers {
                kept: [1.0, 32.0],
                offered: [1.0, 32.0],
                unit: Unit::Is(" px"),
                decimals: 1,
                ..Numbers::USUAL
            }),
        }
    }
}
