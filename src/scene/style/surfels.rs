//! Surfel settings.

use super::Choice;
use super::choices::choices;
use super::describe::{Label, Numbers, Place, Section, Unit, Values, group};
use super::light::OnOff;

choices! {
    /// The six splatting variants of the 4D media paper, Fig. 3, the one that it calls the proper solution, and hard
    /// disks.
    Splatting, "splatting mode" {
        /// (a) Square artefacts where splats cut each other.
        Regular = "regular", "Regular", "One pass, depth test and blending";
        /// (b)
        NoDepth = "no-depth", "No depth", "One pass without depth test: far splats shine through";
        /// (c)
        Visibility = "visibility", "Visibility", "The depths of the first pass as grey";
        /// (d)
        TwoPass = "two-pass", "Two-pass", "Visibility first, then blending at the surface";
        /// (e)
        Enlarged = "enlarged", "Enlarged", "Two passes, both with enlarged splats";
        /// (f) The paper's proposal.
        TwoPassEnlarged = "two-pass-enlarged", "Two-pass, enlarged",
            "Two passes, enlarged in the second only: the smoothest";
        /// The reference for blending.
        Sorted = "sorted", "Sorted", "One pass without depth test, from back to front: the reference, slow";
        /// Sainz and Pajarola 2004, Figs. 5 and 6.
        Opaque = "opaque", "Opaque", "One pass, nothing blended: hard disks, of which the nearest is seen";
    }
}

impl Splatting {
    /// Factors on the splat radius in the visibility and in the attribute pass.
    pub fn scales(self, enlargement: f32) -> [f32; 2] {
        match self {
            Self::Regular | Self::NoDepth | Self::Visibility | Self::TwoPass | Self::Sorted | Self::Opaque => {
                [1.0, 1.0]
            }
            Self::Enlarged => [enlargement, enlargement],
            Self::TwoPassEnlarged => [1.0, enlargement],
        }
    }

    /// Returns true if a pass enlarges splats.
    pub fn enlarges(self) -> bool {
        matches!(self, Self::Enlarged | Self::TwoPassEnlarged)
    }

    /// Returns true if masks are summed up at the surface.
    pub fn sums_masks(self) -> bool {
        matches!(self, Self::TwoPass | Self::Enlarged | Self::TwoPassEnlarged)
    }

    /// Returns true if splats fall off towards their edges.
    pub fn has_masks(self) -> bool {
        !matches!(self, Self::Visibility | Self::Opaque)
    }

    /// Returns true if there is a visibility pass: depths are written before colours are blended.
    pub fn has_visibility_pass(self) -> bool {
        !matches!(self, Self::Regular | Self::NoDepth | Self::Sorted | Self::Opaque)
    }

    /// Returns true if depths are tested or written: otherwise splats are blended in the order in which they are drawn.
    pub fn has_depths(self) -> bool {
        !matches!(self, Self::NoDepth | Self::Sorted)
    }
}

choices! {
    /// Splat filter: filtering of splats to the pixels that they are seen in.
    SplatFilter, "splat filter" {
        Off = "none", "None", "Splats as they are: those smaller than a pixel flicker";
        /// Ren et al. 2002.
        Ewa = "ewa", "EWA", "At least as large as a pixel, and as much fainter: far surfaces are smooth and still";
        /// Botsch et al. 2005.
        Clamp = "clamp", "Clamp", "At least as large as a pixel, and as strong as before: outlines grow";
    }
}

impl SplatFilter {
    /// Radius of the splat of a point: nearest to the mean of a pixel's square, among radii at which each splat covers
    /// the centre of a pixel (`tests/pictures/ewa.rs`). The variance of its Gaussian, a sixth of the square, is 1/8;
    /// the variance of a pixel's square is 1/12.
    // The FLIP of distant checkerboards is a sixth to a half of the disks' FLIP; a radius of 1 was twice as far from
    // the ground truth. The price: an isolated splat is up to a third brighter or darker, depending on its position in
    // a pixel.
    pub const RADIUS_PX: f32 = 0.87;

    /// Radius of the least splat of [`SplatFilter::Clamp`], which covers the centre of a pixel wherever it is: its
    /// variance is a half, as elsewhere, so that exp(−r²) at its edge equals the masks.
    pub const CLAMP_RADIUS_PX: f32 = 1.732_050_8;

    /// Radius of the splat that a point becomes.
    pub fn radius_px(self) -> f32 {
        match self {
            Self::Off => 0.0,
            Self::Ewa => Self::RADIUS_PX,
            Self::Clamp => Self::CLAMP_RADIUS_PX,
        }
    }

    /// Splats seen at a smaller cosine between normal and view are filtered almost as with this one: on their planes,
    /// pixels reach too far into the scene.
    pub const MIN_COSINE: f32 = 0.1;
}

choices! {
    /// Splat geometry that the GPU draws (Sainz and Pajarola 2004 §5.1). The CPU fills the pixels of each splat and
    /// needs none.
    SplatGeometry, "splat geometry" {
        Quad = "quad", "Quad", "A square around each splat, in its plane: four vertices, two triangles";
        Triangle = "triangle", "Triangle",
            "One triangle around each splat, in its plane: three vertices, a third more area";
    }
}

choices! {
    /// Shape of a splat in the visibility pass: the part of its square that hides what is behind.
    VisibilityShape, "visibility shape" {
        Disk = "disk", "Disk", "The disk that is blended: nothing is hidden where nothing is drawn";
        /// The 4D media paper §V, Fig. 3e.
        Square = "square", "Square",
            "The whole square, as in the 4D media paper: its corners are not drawn but hide what is behind them";
    }
}

choices! {
    /// Falloff kernel of a splat from its centre to its edge.
    Kernel, "kernel" {
        /// The mask of the 4D media paper §V.
        Gaussian = "gaussian", "Gaussian", "A bell: smooth, and closed where splats meet";
        Hat = "hat", "Hat", "A cone: smooth, and zero at the edge";
        Flat = "box", "Box", "The same everywhere: every splat has its edge";
    }
}

choices! {
    /// Back-face culling of surfels whose normals point away from the eye. If left open and the surface is not closed
    /// they are drawn, and darker where the normals are known to point outwards; see
    /// [`FirstLook`](crate::scene::FirstLook).
    BackFaces, "choice for back faces", auto Culled = "Auto",
        "Culled where the surface is closed, so that nothing is missed"
    {
        Drawn = "drawn", "Drawn", "From behind as from the front";
        /// If there is light.
        Darker = "darker", "Darker", "From behind a little darker than from the front";
        Culled = "culled", "Culled", "Not drawn: lets you look into rooms from outside";
    }
}

choices! {
    /// Normal source: the data from which normals and radii of surfels are estimated.
    NormalSource, "source of normals" {
        Neighbours = "neighbours", "Neighbours", "The file, else the nearest points of each: once for a frame";
        /// Hofer et al. 2018 §3.5.
        Screen = "screen", "Screen", "Neighbours in the image, for each view: visible points only";
    }
}

choices! {
    /// Quantity that the colours of surfels show.
    SurfelColors, "choice of what is shown" {
        Points = "colors", "Colours", "The colours of the points";
        /// Hofer et al. 2018, Figs. 5 and 6.
        NormalErrors = "normal-error", "Normal errors",
            "Angle of screen-space normals to the file's, or neighbours': blue 0°, green, red from 22.5°";
    }
}

/// Serialised form in files: its word, or the form written when there were two choices. Culling was the default then,
/// so that value carries no information.
#[derive(serde::Deserialize)]
#[serde(untagged)]
enum StoredBackFaces {
    Are(Choice<BackFaces>),
    AreCulled(bool),
}

/// For serde.
fn stored_back_faces<'de, D: serde::Deserializer<'de>>(deserializer: D) -> Result<Choice<BackFaces>, D::Error> {
    Ok(match serde::Deserialize::deserialize(deserializer)? {
        StoredBackFaces::Are(choice) => choice,
        StoredBackFaces::AreCulled(true) => Choice::Auto,
        StoredBackFaces::AreCulled(false) => BackFaces::Drawn.into(),
    })
}

group! {
    /// Surfel settings.
    SurfelSettings decided SurfelStyle {
        /// Splatting mode: how surfels become a surface.
        splatting: Splatting = Splatting::TwoPass, "splatting" SPLATTING {
            flag: "splatting",
            value_name: "MODE",
            help: "Combine overlapping surfels into one surface",
            title: "Splatting",
            hint: "How overlapping surfels become one surface (six modes of the paper's Fig. 3, and hard disks)",
            when: |drawn| drawn.draws_surfels(),
            label: Label::Always(Place::What, "{}"),
            also: &["blending", "splat mode", "visibility pass"],
            values: Values::Words(Splatting::WORDS),
        }
        /// Splat filter: filtering of splats to the pixels.
        filter: SplatFilter = SplatFilter::Off, "splat_filter" FILTER {
            flag: "splat-filter",
            value_name: "FILTER",
            help: "Filter blended splats to the pixel grid (EWA: no flicker far away)",
            title: "Filter",
            hint: "Whether blended splats are filtered to the pixels that they are seen in",
            section: Section::Surfels,
            when: |drawn| drawn.blends_surfels(),
            label: Label::Unusual(Place::What, "{}"),
            full_name: "Splat filter",
            also: &["ewa", "mip", "anti-aliasing"],
            values: Values::Words(SplatFilter::WORDS),
        }
        /// Splat geometry used on the GPU.
        geometry: SplatGeometry = SplatGeometry::Quad, "splat_geometry" GEOMETRY {
            flag: "splat-geometry",
            value_name: "SHAPE",
            help: "Geometry of a splat on the GPU (same image, different speed)",
            title: "Geometry",
            hint: "What the GPU draws a splat as. The picture is the same, its speed differs; the software renderer \
                   needs none",
            section: Section::Surfels,
            when: |drawn| drawn.draws_disks_on_gpu(),
            label: Label::Unusual(Place::What, "as {}"),
            full_name: "Splat geometry",
            values: Values::Words(SplatGeometry::WORDS),
        }
        /// Falloff kernel of splats towards their edges.
        kernel: Kernel = Kernel::Gaussian, "kernel" KERNEL {
            flag: "kernel",
            value_name: "KERNEL",
            help: "Falloff of splats from centre to edge",
            title: "Kernel",
            hint: "Falloff of splats from centre to edge; filtered ones are Gaussian",
            section: Section::Surfels,
            when: |drawn| drawn.has_masks(),
            label: Label::Unusual(Place::What, "{}"),
            also: &["falloff", "gaussian", "weights"],
            values: Values::Words(Kernel::WORDS),
        }
        /// Shape of splats in the visibility pass.
        visibility_shape: VisibilityShape = VisibilityShape::Disk, "visibility_shape" VISIBILITY_SHAPE {
            flag: "visibility-shape",
            value_name: "SHAPE",
            help: "Shape of splats in the visibility pass (square: the artefacts of the 4D media paper, Fig. 3e)",
            title: "Visibility shape",
            hint: "Shape of splats in the visibility pass. Squares hide what is behind their corners, which are not \
                   drawn: square artefacts at outlines, as in the 4D media paper",
            section: Section::Surfels,
            when: |drawn| drawn.has_visibility_squares(),
            label: Label::Unusual(Place::What, "visibility by {}"),
            also: &["square artefacts", "depth mask"],
            values: Values::Words(VisibilityShape::WORDS),
        }
        /// Edge blending: the surface behind the splat edges shines through these, and not the background
        /// ([`rim_px`](crate::scene::rim_px)).
        rims: OnOff = OnOff::On, "rims" RIMS {
            flag: "soft-edges",
            other_flags: &["rims"],
            value_name: "WHETHER",
            help: "Blend the edges of splats with the surface behind them instead of the background",
            title: "Soft edges",
            hint: "What lies behind the edges of splats shines through, and not the background, which would outline \
                   whatever is in front of something",
            section: Section::Surfels,
            when: |drawn| drawn.blends_surfels(),
            label: Label::Unusual(Place::What, "soft edges {}"),
            values: Values::Words(OnOff::WORDS),
        }
        /// Source from which normals and radii are estimated.
        // Not screen-space normals: these cost time for each view, and a frame that is viewed for longer has better
        // normals from its neighbours, computed once.
        normals: NormalSource = NormalSource::Neighbours, "surfel_normals" NORMALS {
            flag: "normals",
            value_name: "FROM",
            help: "Source of the normals and radii of surfels: estimated from neighbours, or in screen space",
            title: "Normals from",
            hint: "Source of the normals and radii of surfels. Screen-space normals need no estimation before a frame \
                   is seen; hidden points have none",
            section: Section::Surfels,
            when: |drawn| drawn.draws_whole_surfels(),
            label: Label::Unusual(Place::What, "{} normals"),
            full_name: "Surfel normals from",
            also: &["estimate normals", "compute normals"],
            values: Values::Words(NormalSource::WORDS),
        }
        /// Quantity that the colours show.
        shown: SurfelColors = SurfelColors::Points, "surfel_colors" SHOWN {
            flag: "show",
            value_name: "WHAT",
            help: "Show the colours of the points, or errors of screen-space normals",
            title: "Show",
            hint: "What the colours of surfels show: those of the points, or errors of screen-space normals",
            section: Section::Surfels,
            when: |drawn| drawn.draws_whole_surfels(),
            label: Label::Unusual(Place::What, "{}"),
            full_name: "Surfel colours",
            also: &["normal error"],
            values: Values::Words(SurfelColors::WORDS),
        }
        /// Factor on every splat radius.
        splat_scale: f32 = 1.0, "splat_scale" SPLAT_SCALE {
            flag: "splat-scale",
            value_name: "FACTOR",
            help: "Scale the radius of all splats",
            title: "Splat scale",
            hint: "Factor on every splat's radius (+ and -)",
            section: Section::Look,
            when: |drawn| drawn.draws_surfels(),
            label: Label::Unusual(Place::What, "×{}"),
            also: &["splat size", "surfel size", "disk radius"],
            values: Values::Number(Numbers {
                retained: [0.1, 10.0],
                offered: [0.1, 10.0],
                unit: Unit::Is(" ×"),
                is_logarithmic: true,
                ..Numbers::USUAL
            }),
        }
        /// Further factor of the enlarged passes; the paper uses 2.
        enlargement: f32 = 2.0, "enlargement" ENLARGEMENT {
            flag: "enlargement",
            value_name: "FACTOR",
            help: "Scale splats further in the enlarged passes",
            title: "Enlargement",
            hint: "Further factor on the radius in the enlarged passes; the paper uses 2",
            section: Section::Surfels,
            when: |drawn| drawn.enlarges_surfels(),
            label: Label::Unusual(Place::What, "by ×{}"),
            values: Values::Number(Numbers {
                retained: [0.01, 100.0],
                offered: [1.0, 4.0],
                unit: Unit::Is(" ×"),
                ..Numbers::USUAL
            }),
        }
        /// Depth of a surface, in splat radii: splats so far behind the nearest one are blended with it, those farther
        /// behind are hidden. One radius is the largest depth distance between two splats of one surface that still
        /// overlap, at 45 degrees.
        depth_offset: f32 = 1.0, "depth_offset" DEPTH_OFFSET {
            flag: "depth-offset",
            value_name: "RADII",
            help: "Blend splats up to this far behind the nearest one, in splat radii",
            title: "Depth offset",
            hint: "Splats up to this far behind the nearest one are blended with it, in splat radii (ε of the depth \
                   test). Less separates sheets that are close together, more closes rough surfaces",
            section: Section::Surfels,
            when: |drawn| drawn.blends_surfels(),
            label: Label::Unusual(Place::What, "ε {} radii"),
            also: &["epsilon", "depth bias", "z-offset", "visibility threshold"],
            values: Values::Number(Numbers {
                retained: [0.0, 100.0],
                offered: [0.0, 4.0],
                unit: Unit::Is(" radii"),
                ..Numbers::USUAL
            }),
        }
        /// Back-face culling.
        #[serde(deserialize_with = "stored_back_faces")]
        back_faces: Choice<BackFaces> = Choice::Auto, "cull_back_faces" BACK_FACES {
            flag: "back-faces",
            value_name: "MODE",
            help: "Draw surfels that face away from the camera (auto: culled on closed surfaces)",
            title: "Back faces",
            hint: "Surfels that face away from the eye",
            section: Section::Surfels,
            when: |drawn| drawn.draws_surfels(),
            also: &["culling", "two-sided", "double-sided"],
            values: Values::Words(Choice::<BackFaces>::WORDS),
        }
    }
}
