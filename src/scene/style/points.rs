//! Rendering of points that stay points.

use super::choices::choices;
use super::describe::{Label, Numbers, Place, Section, Unit, Values, group};

choices! {
    /// Point shape on the screen, where it is larger than a pixel.
    PointShape, "shape of points" {
        Square = "square", "Square", "All pixels of a square of this size";
        /// A pixel is covered if its centre is in the circle, as is the pixel that the point is in.
        Disk = "disk", "Disk", "The pixels of the square that are in the circle in it: round points",
            also ["circle", "round"];
        /// Blended in two passes as surfels are, without normals.
        Gaussian = "gaussian", "Gaussian", "Round with a soft falloff: overlapping points blend into a surface",
            also ["soft", "blurred"];
    }
}

choices! {
    /// Point lighting mode: the lit geometry.
    PointLight, "light of points" {
        None = "none", "None", "No light: the colours of the file";
        /// Normals of the file, or estimated ones.
        Normals = "normals", "Normals", "The surface around a point: its normal";
    }
}

choices! {
    /// Size mode of a point: the unit that its size is measured in.
    PointSizing, "size mode of points" {
        Pixels = "pixels", "Fixed", "The same size in pixels at any distance";
        /// *Attenuated* in other viewers.
        Projected = "projected", "Attenuated", "As wide in the scene as points are apart: smaller from afar";
        /// The radius of a point is its surfel's, or that of the node of a level of detail that it stands for.
        Adaptive = "adaptive", "Adaptive", "As wide in the scene as each point is from those around it";
    }
}

group! {
    /// Rendering settings of points that stay points.
    PointStyle {
        /// Size mode: the unit that point sizes are measured in.
        sizing: PointSizing = PointSizing::Pixels, "point_size_mode" SIZING {
            flag: "point-size-mode",
            value_name: "MODE",
            help: "Unit of the point size: pixels, or lengths in the scene (attenuated with distance)",
            title: "Size",
            hint: "Unit of the point size: pixels, or lengths in the scene",
            section: Section::Look,
            when: |drawn| drawn.is_of_points(),
            label: Label::Unusual(Place::What, "{}"),
            full_name: "Point size mode",
            also: &["attenuation", "perspective size", "adaptive point size", "fixed size"],
            values: Values::Words(PointSizing::WORDS),
        }
        /// Edge of a drawn point in pixels.
        size_px: f32 = 2.0, "point_size_px" SIZE_PX {
            flag: "point-size",
            value_name: "PX",
            help: "Point size in pixels",
            everyday: true,
            title: "Point size",
            hint: "Edge of the square drawn for a point, pixels (+ and -)",
            section: Section::Look,
            when: |drawn| drawn.has_points_of_pixels(),
            label: Label::If(|drawn| drawn.has_points_of_pixels(), Place::What, "{} px"),
            also: &["size of points", "thickness"],
            values: Values::Number(Numbers {
                retained: [1.0, 32.0],
                offered: [1.0, 32.0],
                unit: Unit::Is(" px"),
                decimals: 1,
                ..Numbers::USUAL
            }),
        }
        /// Factor on the edge of points that are sized in the scene; at 1 points just close a surface.
        scale: f32 = 1.0, "point_scale" SCALE {
            flag: "point-scale",
            value_name: "FACTOR",
            help: "Scale projected and adaptive points",
            title: "Point scale",
            hint: "Factor on the size of points in the scene; at 1 they just close a surface (+ and -)",
            section: Section::Look,
            when: |drawn| drawn.has_points_of_lengths(),
            label: Label::Unusual(Place::What, "×{}"),
            also: &["size of points", "point size factor"],
            values: Values::Number(Numbers {
                retained: [0.1, 10.0],
                offered: [0.1, 10.0],
                unit: Unit::Is(" ×"),
                is_logarithmic: true,
                ..Numbers::USUAL
            }),
        }
        /// Point shape on the screen.
        shape: PointShape = PointShape::Square, "point_shape" SHAPE {
            flag: "point-shape",
            value_name: "SHAPE",
            help: "Shape of points on the screen",
            title: "Shape",
            hint: "Shape of a point on screen",
            section: Section::Look,
            when: |drawn| drawn.draws_points(),
            label: Label::Unusual(Place::What, "{}"),
            full_name: "Point shape",
            also: &["round points", "circles", "square points", "point style"],
            values: Values::Words(PointShape::WORDS),
        }
        /// Point lighting mode: the lit geometry.
        light: PointLight = PointLight::None, "point_light" LIGHT {
            flag: "point-light",
            value_name: "WHAT",
            help: "Light points by their normals",
            title: "Light on",
            hint: "Surfaces that lighting of points uses",
            section: Section::Shading,
            when: |drawn| drawn.is_of_points(),
            label: Label::Unusual(Place::What, "lit by {}"),
            full_name: "Light on points",
            also: &["shade points"],
            values: Values::Words(PointLight::WORDS),
        }
    }
}
