//! The words for how points are coloured ([`Coloring`](crate::sequence::Coloring)).

use super::describe::{Described, Section, Values, Word, Words};

/// Its sources, and the description of the whole.
pub const COLORS: Described = Described {
    key: "colors",
    flag: "colors",
    value_name: "SOURCE",
    help: "Source of the colours (also scalar:NAME, height:AXIS, distance:X,Y,Z)",
    everyday: true,
    heading: HEADING,
    title: "Colours",
    hint: "Where the colours of points come from",
    section: Section::Own,
    values: Values::Colors,
    ..Described::USUAL
};

/// Its map.
pub const MAP: Described = Described {
    flag: "color-map",
    other_flags: &["colormap", "cmap"],
    value_name: "MAP",
    help: "Colour map for scalars",
    everyday: true,
    heading: HEADING,
    title: "Colour map",
    hint: "How numbers become colours",
    section: Section::Own,
    values: Values::Words(MAPS),
    ..Described::USUAL
};

/// Its range.
pub const RANGE: Described = Described {
    flag: "color-range",
    value_name: "A..B",
    help: "Value range of the colour map, or percentiles such as p5..p95",
    everyday: true,
    heading: HEADING,
    title: "Colour range",
    hint: "Which values have the first and the last colour. What is beyond has the colour of the nearer end",
    section: Section::Own,
    ..Described::USUAL
};

/// Logarithmic scale switch: the steps are factors.
pub const LOGARITHM: Described = Described {
    flag: "color-log",
    help: "Map values logarithmically",
    heading: HEADING,
    title: "Logarithm",
    hint: "Equal steps of colour are equal factors; evenly where no value is above zero",
    section: Section::Own,
    values: Values::Switch("On"),
    ..Described::USUAL
};

/// Its one colour, which has no option.
pub const ONE_COLOR: Described = Described {
    title: "Point colour",
    hint: "The colour of all points",
    section: Section::Own,
    ..Described::USUAL
};

const HEADING: &str = "Colours";

/// As [`ColorSource::ALL`](crate::sequence::ColorSource::ALL).
pub const SOURCES: &Words = &Words {
    what: "colour source",
    list: &[
        Word {
            word: "auto",
            title: "Automatic",
            hint: "The file's colours if they differ, else its intensity, its classes, the height of a \
            scanned scene or the normal",
            also: &[],
        },
        Word {
            word: "file",
            title: "From the file",
            hint: "Red, green and blue of the file",
            also: &["rgb", "true colour", "original colours", "texture"],
        },
        Word {
            word: "scalar",
            title: "Scalar",
            hint: "Intensity or another scalar of the file through a colour map",
            also: &["scalar field", "attribute", "value"],
        },
        Word {
            word: "height",
            title: "Height",
            hint: "How high a point is, through a colour map",
            also: &["elevation", "altitude", "z", "depth"],
        },
        Word {
            word: "normal",
            title: "Normal",
            hint: "The direction of the normal as a colour (the paper's fake colour)",
            also: &["normals", "normal map", "direction"],
        },
        Word {
            word: "distance",
            title: "Distance",
            hint: "How far a point is from the sensor, or from the origin of the file where it names none, \
            through a colour map",
            also: &["range", "depth", "from the sensor"],
        },
        Word {
            word: "time",
            title: "Time",
            hint: "When a point was measured, through a colour map",
            also: &["timestamp"],
        },
        Word {
            word: "class",
            title: "Class",
            hint: "What a point is: the standard classes of LAS in their usual colours",
            also: &["classification", "categories", "labels", "segmentation", "semantic"],
        },
        Word {
            word: "uniform",
            title: "One colour",
            hint: "The same for all points",
            also: &["solid", "single colour", "flat", "plain", "white points"],
        },
    ],
};

/// As [`ColorMap::ALL`](crate::analysis::ColorMap::ALL).
pub const MAPS: &Words = &Words {
    what: "colour map",
    list: &[
        Word {
            word: "viridis",
            title: "Viridis",
            hint: "Dark violet to yellow, evenly lighter, also for the colour-blind",
            also: &["perceptual", "colour blind"],
        },
        Word {
            word: "turbo",
            title: "Turbo",
            hint: "Blue over green to red: many colours, so that details stand out",
            also: &["rainbow", "jet", "spectral"],
        },
        Word {
            word: "magma",
            title: "Magma",
            hint: "Black over purple to pale yellow, evenly lighter",
            also: &["inferno", "plasma", "heat", "hot"],
        },
        Word {
            word: "grey",
            title: "Grey",
            hint: "Black to white",
            also: &["greyscale", "black and white", "monochrome"],
        },
        Word {
            word: "diverging",
            title: "Diverging",
            hint: "Blue over grey to red: for values on both sides of a midpoint",
            also: &["blue red", "cool warm", "coolwarm"],
        },
    ],
};
