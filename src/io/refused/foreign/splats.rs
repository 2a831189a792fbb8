//! Gaussian splats of other programs.

use super::looks;
use super::row::{Foreign, ROW};
use crate::io::format::Magic;

pub(super) const ROWS: &[Foreign] = &[
    Foreign {
        name: "a Gaussian splat scene (SOG)",
        writer: "PlayCanvas SuperSplat and splat-transform",
        advice: "convert it with `splat-transform scene.sog scene.ply`, or open it in SuperSplat and export PLY",
        looks_like: Some(looks::sog_text),
        extensions: &["sog"],
        members: &["meta.json", "means_l.webp"],
        ..ROW
    },
    Foreign {
        name: "a streamed Gaussian splat scene (SOG with levels of detail)",
        writer: "PlayCanvas splat-transform",
        advice: "convert it with `splat-transform lod-meta.json scene.ply`",
        names: &["lod-meta.json"],
        members: &["lod-meta.json"],
        ..ROW
    },
    Foreign {
        name: "a Gaussian splat scene (KSPLAT)",
        writer: "GaussianSplats3D",
        advice: "convert it with `splat-transform scene.ksplat scene.ply`, or open the PLY it was made of",
        extensions: &["ksplat"],
        ..ROW
    },
    Foreign {
        name: "a moving Gaussian splat scene (SPLATV)",
        writer: "splaTV",
        advice: "open the PLY it was made of (SpacetimeGaussians)",
        magic: &[Magic::start(b"\x4b\x67\x00\x00")],
        extensions: &["splatv"],
        ..ROW
    },
    Foreign {
        name: "a Gaussian splat scene (LCC)",
        writer: "XGRIDS Lixel CyberColor",
        advice: "export it from LCC Studio as PLY, or convert it with `splat-transform scene.lcc scene.ply`",
        extensions: &["lcc"],
        members: &["*.lcc"],
        ..ROW
    },
    Foreign {
        name: "a Gaussian splat scene (SPX)",
        writer: "Reall3D",
        advice: "convert it with gsbox (`gsbox x2p -i scene.spx -o scene.ply`)",
        extensions: &["spx"],
        ..ROW
    },
    Foreign {
        name: "a Gaussian splat scene (RAD)",
        writer: "Spark",
        advice: "open the PLY or SPZ it was made of",
        extensions: &["rad"],
        ..ROW
    },
];
