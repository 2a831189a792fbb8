//! Scenes, particles and meshes of graphics programs.

use super::looks_text;
use super::row::{Foreign, ROW};
use crate::io::format::Magic;

pub(super) const ROWS: &[Foreign] = &[
    Foreign {
        name: "a particle file (PRT)",
        writer: "Thinkbox Krakatoa and Houdini",
        advice: "convert it to PLY or CSV with Krakatoa's PRT tools, or with Houdini",
        magic: &[Magic::start(b"\xc0PRT\r\n\x1a\n")],
        ..ROW
    },
    Foreign {
        name: "a Houdini geometry (BGEO)",
        writer: "Houdini",
        advice: "write it from Houdini as PLY or OBJ, a file per frame ($F4 in the name)",
        magic: &[Magic::start(b"\x7fNSJb"), Magic::start(b"scblosc")],
        extensions: &["bgeo"],
        ..ROW
    },
    Foreign {
        name: "a Maya scene",
        writer: "Maya",
        advice: "export it from Maya as OBJ, or as FBX and that as glTF with FBX2glTF",
        magic: &[Magic::start(b"//Maya ASCII")],
        looks_like: Some(looks_text::maya_binary),
        extensions: &["ma", "mb"],
        ..ROW
    },
    Foreign {
        name: "a Cinema 4D scene",
        writer: "Cinema 4D",
        advice: "export it from Cinema 4D as glTF or OBJ",
        magic: &[Magic::start(b"QC4DC4D6")],
        extensions: &["c4d"],
        ..ROW
    },
    Foreign {
        name: "a voxel model (VOX)",
        writer: "MagicaVoxel",
        advice: "export it from MagicaVoxel as PLY or OBJ",
        magic: &[Magic::start(b"VOX ")],
        extensions: &["vox"],
        ..ROW
    },
    Foreign {
        name: "a compressed mesh (OpenCTM)",
        writer: "OpenCTM tools and MeshLab",
        advice: "convert it with `ctmconv FILE.ctm mesh.ply`, or with MeshLab",
        magic: &[Magic::start(b"OCTM")],
        extensions: &["ctm"],
        ..ROW
    },
    Foreign {
        name: "an Open Inventor scene",
        writer: "Open Inventor and Coin3D",
        advice: "convert it to VRML with `ivvrml` and that to PLY with MeshLab",
        magic: &[Magic::start(b"#Inventor")],
        extensions: &["iv"],
        ..ROW
    },
    Foreign {
        name: "a Universal 3D model (U3D)",
        writer: "MeshLab and Acrobat",
        advice: "open what it was made of: programs that write it rarely read it",
        magic: &[Magic::start(b"U3D\x00")],
        extensions: &["u3d"],
        ..ROW
    },
    Foreign {
        name: "a texture (KTX)",
        writer: "game and web programs",
        advice: "it holds images and no points: open the glTF file that uses it",
        magic: &[
            Magic::start(b"\xabKTX 20\xbb\r\n\x1a\n"),
            Magic::start(b"\xabKTX 11\xbb\r\n\x1a\n"),
        ],
        extensions: &["ktx", "ktx2"],
        ..ROW
    },
    Foreign {
        name: "a multiresolution mesh (Nexus)",
        writer: "Nexus of CNR",
        advice: "open the PLY or OBJ that it was made of",
        magic: &[Magic::start(b"\x20sxN")],
        extensions: &["nxs", "nxz"],
        ..ROW
    },
    Foreign {
        name: "a neural network (ONNX)",
        writer: "PyTorch and other frameworks",
        advice: "it holds weights and no points: save the tensors that it yields with numpy.savez",
        extensions: &["onnx"],
        ..ROW
    },
    Foreign {
        name: "a Medit mesh",
        writer: "Medit, Gmsh, CGAL and Mmg",
        advice: "convert it with `gmsh FILE.mesh -save -o mesh.stl`, or `meshio convert FILE.mesh mesh.ply`",
        magic: &[Magic::start(b"MeshVersionFormatted")],
        ..ROW
    },
    Foreign {
        name: "a Parasolid model",
        writer: "CAD programs",
        advice: "export its surface as STL, OBJ or glTF from the CAD program that wrote it",
        extensions: &["x_t", "x_b"],
        ..ROW
    },
];
