//! View-dependent texturing settings (Yang et al. 2006 §3).

use super::choices::choices;
use super::describe::{Label, Numbers, Place, Section, Typed, Unit, Values, group};

choices! {
    /// View-dependent texturing mode: the colour source of surfaces that posed images show.
    PhotoMode, "texturing mode" {
        /// Yang et al. 2006 §3.2.
        Vdts = "vdts", "View-dependent", "Blends the images whose cameras are closest to your viewpoint, per \
            surface point";
        Single = "single", "Nearest image", "Uses the image whose camera is closest to your viewpoint, per \
            surface point";
        Colored = "colored", "Colours of points", "The points' own colours";
    }
}

choices! {
    /// Clipping mode for positions where the posed images show something else.
    PhotoClipping, "way of clipping" {
        Vote = "vote", "Vote", "Carves points that most images see through";
        /// Yang et al. 2006 §4.1.
        Paper = "paper", "Any image", "Carves points where a blended image sees something nearer or farther";
        Off = "off", "Off", "Drawn nevertheless";
    }
}

choices! {
    /// Hole filling mode for positions that no posed image sees.
    PhotoHoles, "way to fill holes" {
        Points = "point-color", "Colours of points", "Have the points' own colours";
        Left = "discard", "Nothing", "Are not drawn";
        /// Gortler et al. 1996.
        Filled = "push-pull", "Filled from around", "Have the colours of what is around them";
    }
}

choices! {
    /// Relighting mode of the surfaces in the posed images.
    PhotoRelight, "way of relighting" {
        Off = "off", "Off", "Uses the normals of points; without lighting, images keep the light they were taken \
            in";
        Photos = "photos", "Colours of images",
            "Lights the colours of images with depth-map normals";
        DepthOnly = "depth-only", "White", "Clay render lit with depth-map normals";
    }
}

choices! {
    /// Exposure compensation between posed images, which makes them equally bright.
    PhotoGains, "exposure compensation" {
        On = "on", "On", "By what shared points look like in each";
        Off = "off", "Off", "As they were taken";
    }
}

group! {
    /// View-dependent texturing settings.
    PhotoStyle {
        /// Colour source of surfaces.
        mode: PhotoMode = PhotoMode::Vdts, "photos" MODE {
            flag: "photos",
            value_name: "MODE",
            help: "Colour surfaces from the input images: view-dependent blending, the nearest image, or not at all",
            title: "Colours from",
            hint: "Source of the colours of surfaces that have images",
            section: Section::Photos,
            when: |drawn| drawn.has_photos(),
            label: Label::Unusual(Place::What, "images: {}"),
            full_name: "Image colours",
            also: &[
                "view-dependent texturing",
                "projective texturing",
                "texture",
                "image-based rendering",
                "photos",
            ],
            values: Values::Words(PhotoMode::WORDS),
        }
        /// Number of posed images blended at a position.
        // With a falloff of 1.5, six instead of four improved held-out views by 0.06 dB (ray-traced room).
        views: f32 = 4.0, "photo_views" VIEWS {
            flag: "photo-views",
            value_name: "1..8",
            help: "Number of images blended at a surface point",
            title: "Blended",
            hint: "Number of images blended per surface point",
            section: Section::Photos,
            when: |drawn| drawn.draws_view_dependent_textures(),
            full_name: "Blended images",
            also: &["number of cameras"],
            values: Values::Number(Numbers {
                retained: [1.0, PhotoStyle::MAX_VIEWS as f32],
                offered: [1.0, PhotoStyle::MAX_VIEWS as f32],
                typed: Typed::Whole,
                decimals: 0,
                ..Numbers::USUAL
            }),
        }
        /// Angle at which the weight of an image has fallen to 1/e, as a factor on the angle between neighbours.
        // With 1, often only a single image remains, along with its noise. Held-out views: 36.78 dB with 1, 36.89 with
        // 1.5, 36.92 with 2 and 2.5 (depth camera); 35.72, 35.99, 36.13, 36.31 (ray-traced room with its noise; the
        // last with six images).
        angle: f32 = 2.0, "photo_angle" ANGLE {
            flag: "photo-angle",
            value_name: "FACTOR",
            help: "Angular reach of an image, relative to the angle between neighbouring images",
            title: "Reach",
            hint: "Falloff of an image's weight with the angle to your view: σ, as a factor on the angle between \
                   neighbouring cameras",
            section: Section::Photos,
            when: |drawn| drawn.draws_view_dependent_textures(),
            full_name: "Reach of images",
            values: Values::Number(Numbers {
                retained: [0.05, 10.0],
                offered: [0.1, 5.0],
                unit: Unit::Is(" ×"),
                is_logarithmic: true,
                ..Numbers::USUAL
            }),
        }
        /// Clipping of positions where the posed images show something else.
        // By vote, 0.02 of a man (3,000 points) and 0.18 of a tree (100,000) are missing; by the rule of the paper,
        // which needs high-resolution depth maps, 0.33 and 0.94.
        clipping: PhotoClipping = PhotoClipping::Vote, "photo_clipping" CLIPPING {
            flag: "clipping",
            value_name: "HOW",
            help: "Carve points that images see through",
            title: "Silhouettes",
            hint: "Treatment of points where images show something nearer or farther",
            section: Section::Photos,
            when: |drawn| drawn.draws_photos(),
            full_name: "Silhouettes of images",
            also: &["carve", "space carving"],
            values: Values::Words(PhotoClipping::WORDS),
        }
        /// Hole filling of positions that no posed image sees.
        holes: PhotoHoles = PhotoHoles::Points, "photo_holes" HOLES {
            flag: "holes",
            value_name: "MODE",
            help: "Fill surface points that no image sees",
            title: "Holes",
            hint: "Colours of points that no image sees",
            section: Section::Photos,
            when: |drawn| drawn.draws_photos(),
            full_name: "Holes between images",
            also: &["hole filling", "inpainting", "push-pull"],
            values: Values::Words(PhotoHoles::WORDS),
        }
        /// Maximum width of gaps in a surface that are closed, in percent of the height of an image.
        gaps: f32 = 5.0, "photo_gaps" GAPS {
            flag: "photo-gaps",
            value_name: "PERCENT",
            help: "Close gaps in surfaces up to this width, in percent of the image height; 0 closes none",
            title: "Gaps",
            hint: "Maximum width of gaps in a surface that are closed where images show something, in percent of the \
                   image height; 0: they stay open",
            section: Section::Photos,
            when: |drawn| drawn.draws_photos(),
            full_name: "Gaps between images",
            also: &["hole filling"],
            values: Values::Number(Numbers {
                retained: [0.0, 20.0],
                offered: [0.0, 10.0],
                typed: Typed::Retained("a number from 0 to 20"),
                unit: Unit::Is(" %"),
                decimals: 1,
                ..Numbers::USUAL
            }),
        }
        /// Relighting of the surfaces in the posed images, and the normals used for it.
        relight: PhotoRelight = PhotoRelight::Off, "photo_relight" RELIGHT {
            flag: "relight",
            value_name: "WHAT",
            help: "Relight by depth-map normals: the images, or a white surface",
            title: "Relighting",
            hint: "Lights what images show with depth-map normals",
            section: Section::Photos,
            when: |drawn| drawn.draws_photos(),
            label: Label::Unusual(Place::What, "relit: {}"),
            also: &["clay", "relit"],
            values: Values::Words(PhotoRelight::WORDS),
        }
        /// Exposure compensation between posed images, which makes them equally bright.
        gains: PhotoGains = PhotoGains::On, "photo_gains" GAINS {
            flag: "photo-gains",
            value_name: "WHETHER",
            help: "Compensate exposure differences between images",
            title: "Exposure",
            hint: "Exposure compensation: makes images equally bright, by the points that they share",
            section: Section::Photos,
            when: |drawn| drawn.draws_photos(),
            full_name: "Exposure compensation",
            also: &["white balance", "exposure"],
            values: Values::Words(PhotoGains::WORDS),
        }
    }
}

impl PhotoStyle {
    /// Maximum number of posed images blended at a position.
    pub const MAX_VIEWS: usize = 8;

    /// Returns the number of posed images blended at a position.
    pub fn blended(&self) -> usize {
        match self.mode {
            PhotoMode::Vdts => (self.views as usize).clamp(1, Self::MAX_VIEWS),
            PhotoMode::Single => 1,
            PhotoMode::Colored => 0,
        }
    }
}
