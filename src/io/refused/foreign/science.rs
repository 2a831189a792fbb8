//! Volumes, simulations, molecules and tables.

use super::looks_text;
use super::row::{Foreign, ROW};
use crate::io::format::Magic;

pub(super) const ROWS: &[Foreign] = &[
    Foreign {
        name: "a NIfTI volume",
        writer: "FSL, SPM and other neuroimaging programs",
        advice: "extract a surface and save it as PLY, OBJ or STL, for example with 3D Slicer",
        magic: &[
            Magic {
                offset: 344,
                bytes: b"n+1\x00",
            },
            Magic {
                offset: 344,
                bytes: b"ni1\x00",
            },
            Magic {
                offset: 4,
                bytes: b"n+2\x00\r\n",
            },
        ],
        extensions: &["nii"],
        ..ROW
    },
    Foreign {
        name: "a MetaImage volume",
        writer: "ITK and 3D Slicer",
        advice: "extract a surface and save it as PLY, OBJ or STL, for example with 3D Slicer",
        looks_like: Some(looks_text::meta_image),
        extensions: &["mha", "mhd"],
        ..ROW
    },
    Foreign {
        name: "a density map (MRC or CCP4)",
        writer: "electron microscopes and crystallography programs",
        advice: "extract a surface and save it as STL or OBJ, for example with ChimeraX",
        magic: &[Magic {
            offset: 208,
            bytes: b"MAP ",
        }],
        extensions: &["mrc", "ccp4"],
        ..ROW
    },
    Foreign {
        name: "a FITS file",
        writer: "telescopes and astronomy programs",
        advice: "save the columns with the coordinates as CSV, for example with astropy: \
            Table.read(FILE).write('points.csv')",
        magic: &[Magic::start(b"SIMPLE  =")],
        extensions: &["fits", "fit", "fts"],
        ..ROW
    },
    Foreign {
        name: "a trajectory of molecules (DCD, XTC or TRR)",
        writer: "NAMD, CHARMM, OpenMM and GROMACS",
        advice: "save its frames as an array: numpy.save('frames.npy', MDAnalysis positions of every frame), an \
            array of T × N × 3",
        magic: &[
            Magic {
                offset: 4,
                bytes: b"CORD",
            },
            Magic::start(b"\x00\x00\x07\xcb"),
            Magic::start(b"\x00\x00\x07\xc9"),
        ],
        extensions: &["dcd", "xtc", "trr"],
        ..ROW
    },
    Foreign {
        name: "a structure of molecules (GRO)",
        writer: "GROMACS",
        advice: "open it in a molecule viewer, or save its coordinates as text with a line `x y z` per atom",
        extensions: &["gro"],
        ..ROW
    },
    Foreign {
        name: "a crystal structure (VASP)",
        writer: "VASP",
        advice: "open it in a molecule viewer, or save its coordinates as text with a line `x y z` per atom, for \
            example with ASE",
        names: &["poscar", "contcar", "xdatcar"],
        extensions: &["vasp"],
        ..ROW
    },
    Foreign {
        name: "a LAMMPS dump",
        writer: "LAMMPS",
        advice: "write its columns x y z as CSV or an array, for example with OVITO (File > Export File > XYZ) or \
            MDAnalysis",
        magic: &[Magic::start(b"ITEM: TIMESTEP"), Magic::start(b"ITEM: UNITS")],
        extensions: &["lammpstrj"],
        ..ROW
    },
    Foreign {
        name: "an XDMF data set",
        writer: "simulation programs",
        advice: "open it in ParaView and save it as PLY (File > Save Data)",
        looks_like: Some(looks_text::xdmf),
        extensions: &["xdmf", "xmf"],
        ..ROW
    },
    Foreign {
        name: "an EnSight data set",
        writer: "EnSight and simulation programs",
        advice: "open it in ParaView and save it as PLY (File > Save Data)",
        looks_like: Some(looks_text::ensight),
        extensions: &["case", "encas"],
        ..ROW
    },
    Foreign {
        name: "a Tecplot data set",
        writer: "Tecplot and simulation programs",
        advice: "open it in ParaView and save it as PLY (File > Save Data), or save its points as CSV from Tecplot",
        magic: &[Magic::start(b"#!TDV"), Magic::start(b"#!SZPLT")],
        looks_like: Some(looks_text::tecplot),
        extensions: &["plt", "szplt", "tec"],
        ..ROW
    },
    Foreign {
        name: "a finite element model (Abaqus)",
        writer: "Abaqus and CalculiX",
        advice: "convert it with `meshio convert FILE.inp mesh.ply`",
        looks_like: Some(looks_text::abaqus),
        extensions: &["inp"],
        ..ROW
    },
    Foreign {
        name: "a Zarr array",
        writer: "zarr, xarray and Dask",
        advice: "save the array with the points: numpy.save('points.npy', zarr.open(FOLDER)['points'][:])",
        names: &["zarr.json"],
        extensions: &["zarr"],
        members: &["zarr.json"],
        ..ROW
    },
    Foreign {
        name: "a ROOT file",
        writer: "CERN ROOT",
        advice: "save its coordinates as an array with uproot and numpy.save, an array of N × 3",
        magic: &[Magic::start(b"root\x00")],
        extensions: &["root"],
        ..ROW
    },
    Foreign {
        name: "a JSON list of points",
        writer: "scripts and web programs",
        advice: "save it as an array: numpy.save('points.npy', numpy.array(json.load(open(FILE)))), with the list of \
            points of x y z",
        looks_like: Some(looks_text::json_points),
        ..ROW
    },
    Foreign {
        name: "a Jupyter notebook",
        writer: "Jupyter",
        advice: "save the arrays in it with numpy.save or numpy.savez",
        looks_like: Some(looks_text::notebook),
        extensions: &["ipynb"],
        ..ROW
    },
];
