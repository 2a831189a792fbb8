//! How photographs are put on surfaces (paper 004 §3).

use super::choices::choices;
use super::describe::{Label, Numbers, Place, Section, Typed, Unit, Values, group};

choices! {
    /// What surfaces have their colours from where there are photographs of them.
    PhotoMode, "way to use photographs" {
        /// Paper 004 §3.2.
        Vdts = "vdts", "View-dependent", "Blends the photographs that see a place from about where you stand";
        Single = "single", "Nearest photograph", "At each place the photograph that sees it most as you do";
        Colored = "colored", "Colours of points", "The points' own colours";
    }
}

choices! {
    /// What becomes of places of which photographs show something else.
    PhotoClipping, "way of clipping" {
        Vote = "vote", "Vote", "Left out where more photographs see through a place than see it";
        /// Paper 004 §4.1.
        Paper = "paper", "Any photograph", "Left out where a blended photograph sees something nearer or farther";
        Off = "off", "Off", "Drawn nevertheless";
    }
}

choices! {
    /// What places look like that no photograph sees.
    PhotoHoles, "way to fill holes" {
        Points = "point-color", "Colours of points", "Have the points' own colours";
        Left = "discard", "Nothing", "Are not drawn";
        /// Gortler et al. 1996.
        Filled = "push-pull", "Filled from around", "Have the colours of what is around them";
    }
}

choices! {
    /// Whether light falls on what photographs show.
    PhotoRelight, "way of relighting" {
        Off = "off", "Off", "Normals are those of points; without a choice of light, photographs keep theirs";
        Photos = "photos", "Colours of photographs",
            "Light falls on colours of photographs, by normals of their depths";
        DepthOnly = "depth-only", "White", "Light falls on a white surface, by normals of depths of photographs";
    }
}

choices! {
    /// Whether photographs are made as bright as each other.
    PhotoGains, "choice of gains" {
        On = "on", "On", "By what shared points look like in each";
        Off = "off", "Off", "As they were taken";
    }
}

group! {
    /// How photographs are put on surfaces.
    PhotoStyle {
        /// What surfaces have their colours from.
        mode: PhotoMode = PhotoMode::Vdts, "photos" MODE {
            flag: "photos",
            value_name: "MODE",
            help: "Colour surfaces from the input images: view-dependent blending, the nearest image, or not at all",
            title: "Colours from",
            hint: "What surfaces have their colours from where there are photographs of them",
            section: Section::Photographs,
            when: |drawn| drawn.has_photographs(),
            label: Label::Unusual(Place::What, "{} photographs"),
            values: Values::Words(PhotoMode::WORDS),
        }
        /// How many photographs are blended at a place.
        views: f32 = 4.0, "photo_views" VIEWS {
            flag: "photo-views",
            value_name: "1..8",
            help: "Number of images blended at a surface point",
            title: "Blended",
            hint: "How many photographs are blended at a place",
            section: Section::Photographs,
            when: |drawn| drawn.draws_view_dependent_textures(),
            values: Values::Number(Numbers {
                kept: [1.0, PhotoStyle::MOST_VIEWS as f32],
                offered: [1.0, PhotoStyle::MOST_VIEWS as f32],
                typed: Typed::Whole,
                decimals: 0,
                ..Numbers::USUAL
            }),
        }
        /// Angle at which the weight of a photograph has fallen to 1/e, as a factor on what is between neighbours.
        angle: f32 = 2.0, "photo_angle" ANGLE {
            flag: "photo-angle",
            value_name: "FACTOR",
            help: "Angular reach of an image, relative to the angle between neighbouring images",
            title: "Reach",
            hint: "How fast the weight of a photograph falls with its angle to you: σ, as a factor on the angle \
                   between neighbouring photographs",
            section: Section::Photographs,
            when: |drawn| drawn.draws_view_dependent_textures(),
            values: Values::Number(Numbers {
                kept: [0.05, 10.0],
                offered: [0.1, 5.0],
                unit: Unit::Is(" ×"),
                is_logarithmic: true,
                ..Numbers::USUAL
            }),
        }
        /// What becomes of places of which photographs show something else.
        clipping: PhotoClipping = PhotoClipping::Vote, "photo_clipping" CLIPPING {
            flag: "clipping",
            value_name: "HOW",
            help: "Carve points that images see through",
            title: "Silhouettes",
            hint: "What becomes of places where photographs show something that is nearer or farther",
            section: Section::Photographs,
            when: |drawn| drawn.draws_photographs(),
            values: Values::Words(PhotoClipping::WORDS),
        }
        /// What places look like that no photograph sees.
        holes: PhotoHoles = PhotoHoles::Points, "photo_holes" HOLES {
            flag: "holes",
            value_name: "MODE",
            help: "Fill surface points that no image sees",
            title: "Holes",
            hint: "What places look like that no photograph sees",
            section: Section::Photographs,
            when: |drawn| drawn.draws_photographs(),
            values: Values::Words(PhotoHoles::WORDS),
        }
        /// How wide gaps in a surface are that are closed, in percent of the height of a picture.
        gaps: f32 = 5.0, "photo_gaps" GAPS {
            flag: "photo-gaps",
            value_name: "PERCENT",
            help: "Close gaps in surfaces up to this width, in percent of the image height; 0 closes none",
            title: "Gaps",
            hint: "How wide gaps in a surface are that are closed where photographs show something there, in percent \
                   of the height of the picture; 0: they stay open",
            section: Section::Photographs,
            when: |drawn| drawn.draws_photographs(),
            values: Values::Number(Numbers {
                kept: [0.0, 20.0],
                offered: [0.0, 10.0],
                typed: Typed::Kept("a number from 0 to 20"),
                unit: Unit::Is(" %"),
                decimals: 1,
                ..Numbers::USUAL
            }),
        }
        /// Whether light falls on what photographs show, and on which normals.
        relight: PhotoRelight = PhotoRelight::Off, "photo_relight" RELIGHT {
            flag: "relight",
            value_name: "WHAT",
            help: "Relight by depth-map normals: the images, or a white surface",
            title: "Relighting",
            hint: "Whether light falls on what photographs show, by normals of their depths",
            section: Section::Photographs,
            when: |drawn| drawn.draws_photographs(),
            label: Label::Unusual(Place::What, "relit: {}"),
            values: Values::Words(PhotoRelight::WORDS),
        }
        /// Whether photographs are made as bright as each other.
        gains: PhotoGains = PhotoGains::On, "photo_gains" GAINS {
            flag: "photo-gains",
            value_name: "WHETHER",
            help: "Compensate exposure differences between images",
            title: "Gains",
            hint: "Whether photographs are made as bright as each other, by what shared points look like in them",
            section: Section::Photographs,
            when: |drawn| drawn.draws_photographs(),
            values: Values::Words(PhotoGains::WORDS),
        }
    }
}

impl PhotoStyle {
    /// The most photographs that are blended at a place.
    pub const MOST_VIEWS: usize = 8;

    /// How many are.
    pub fn blended(&self) -> usize {
        match self.mode {
            PhotoMode::Vdts => (self.views as usize).clamp(1, Self::MOST_VIEWS),
            PhotoMode::Single => 1,
            PhotoMode::Colored => 0,
        }
    }
}
