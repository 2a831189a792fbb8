//! Settings of estimates from the points: normals, and positions on a smooth surface.

use super::choices::choices;
use super::describe::{Label, Numbers, Place, Section, Typed, Unit, Values, group};
use crate::analysis::{PlaneFit, SurfaceOptions};

choices! {
    /// Plane fit: the method by which a normal is estimated from neighbours.
    NormalFit, "fit of normals" {
        Plain = "plain", "Plain", "All neighbours count alike: best against noise that all points have";
        /// Holland and Welsch 1977.
        Robust = "robust", "Robust", "Points far off the plane hardly count: outliers and edges; takes longer";
    }
}

group! {
    /// Estimation settings. They change the preparation of frames, not their drawing.
    EstimationStyle {
        /// Number of neighbours that a normal is estimated from; 0 for an automatic one.
        neighbours: f32 = 0.0, "normals_k" NEIGHBOURS {
            flag: "normals-k",
            value_name: "auto|N",
            help: "Neighbours that normals are estimated from (auto: 12, and more where the points are noisy)",
            title: "Neighbours",
            hint: "Number of neighbours that a normal is estimated from; automatic: 12, and more where the points are \
                   noisy",
            section: Section::Surfels,
            when: |drawn| drawn.is_lit(),
            label: Label::Unusual(Place::What, "{} neighbours"),
            full_name: "Neighbours of normals",
            also: &["knn", "k nearest neighbours", "noise", "smooth normals"],
            values: Values::Number(Numbers {
                retained: [0.0, 128.0],
                offered: [0.0, 64.0],
                typed: Typed::Whole,
                unit: Unit::Is(""),
                zero: "auto",
                ..Numbers::USUAL
            }),
        }
        /// Plane fit.
        fit: NormalFit = NormalFit::Plain, "normal_fit" FIT {
            flag: "fit",
            value_name: "FIT",
            help: "Fit of normals to neighbours: plain, or robust against outliers",
            title: "Fit",
            hint: "How a normal is estimated from neighbours",
            section: Section::Surfels,
            when: |drawn| drawn.is_lit(),
            label: Label::Unusual(Place::What, "{} fit"),
            full_name: "Fit of normals",
            also: &["outliers", "robust normals"],
            values: Values::Words(NormalFit::WORDS),
        }
        /// Radius in point spacings of the neighbourhoods by which points are moved onto the surface around them; 0 if
        /// they stay where they are.
        smoothing: f32 = 0.0, "smooth" SMOOTHING {
            flag: "smooth",
            value_name: "off|RADIUS",
            help: "Move the points onto the surface around them, from neighbours within RADIUS point spacings, such as \
                   3 (moving least squares)",
            title: "Smoothing",
            hint: "Moves the points onto the surface around them. Radius of the neighbourhoods in point spacings; \
                   measurements are of the moved points",
            section: Section::Look,
            label: Label::Unusual(Place::What, "smoothed ×{}"),
            also: &["mls", "moving least squares", "denoise", "noise", "project"],
            values: Values::Number(Numbers {
                retained: [0.0, 6.0],
                offered: [0.0, 6.0],
                typed: Typed::Retained("a number of point spacings from 1 to 6"),
                unit: Unit::Is(""),
                decimals: 1,
                zero: "off",
                ..Numbers::USUAL
            }),
        }
    }
}

impl EstimationStyle {
    /// Returns the options of estimating normals.
    pub fn surface(&self) -> SurfaceOptions {
        SurfaceOptions {
            neighbours: (self.neighbours >= 1.0).then_some(self.neighbours as u16),
            fit: match self.fit {
                NormalFit::Plain => PlaneFit::Plain,
                NormalFit::Robust => PlaneFit::Robust,
            },
        }
    }
}
