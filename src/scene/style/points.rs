//! How points are drawn that stay points.

use super::choices::choices;
use super::describe::{Label, Numbers, Place, Section, Unit, Values, When, group};

choices! {
    /// What a point is on the screen, where it is larger than a pixel.
    PointShape, "shape of points" {
        Square = "square", "Square", "All pixels of a square of this size";
        /// A pixel is covered where its middle is in the circle, and the pixel that the point is in.
        Disk = "disk", "Disk", "The pixels of the square that are in the circle in it: round points";
    }
}

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
        /// What a point is on the screen.
        shape: PointShape = PointShape::Square, "point_shape" SHAPE {
            flag: "point-shape",
            value_name: "SHAPE",
            help: "What points are on the screen",
            title: "Shape",
            hint: "What a point is on the screen: a square, or round",
            section: Section::Points,
            when: When::Points,
            label: Label::Unusual(Place::What, "{}"),
            values: Values::Words(PointShape::WORDS),
        }
    }
}
