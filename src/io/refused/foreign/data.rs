//! Arrays, tables, volumes, molecules and measurements.

use super::looks;
use super::row::{Foreign, ROW};
use crate::io::format::Magic;

pub(super) const ROWS: &[Foreign] = &[
    Foreign {
        name: "a well log (Log ASCII Standard)",
        writer: "borehole logging programs",
        advice: "it shares only its extension with LiDAR data; its depth curves are a table: save them as CSV, for \
            example with lasio",
        looks_like: Some(looks::well_log),
        ..ROW
    },
    Foreign {
        name: "a molecule (Protein Data Bank)",
        writer: "molecular modelling programs",
        advice: "open it in a molecule viewer, or save its coordinates as text with a line `x y z` per atom",
        looks_like: Some(looks::pdb),
        extensions: &["pdb", "ent", "pqr"],
        ..ROW
    },
    Foreign {
        name: "a molecule (MOL2)",
        writer: "molecular modelling programs",
        advice: "open it in a molecule viewer, or save its coordinates as text with a line `x y z` per atom",
        looks_like: Some(looks::mol_2),
        extensions: &["mol2"],
        ..ROW
    },
    Foreign {
        name: "a molecule (MDL)",
        writer: "chemistry programs",
        advice: "open it in a molecule viewer, or save its coordinates as text with a line `x y z` per atom",
        looks_like: Some(looks::mdl_mol),
        extensions: &["mol", "sdf"],
        ..ROW
    },
    Foreign {
        name: "a crystal or molecule (CIF)",
        writer: "crystallography programs",
        advice: "open it in a molecule viewer, or save its coordinates as text with a line `x y z` per atom",
        looks_like: Some(looks::cif),
        extensions: &["cif", "mmcif"],
        ..ROW
    },
    Foreign {
        name: "a PyTorch file",
        writer: "PyTorch",
        advice: "save its tensors with numpy.savez('frames.npz', *[t.cpu().numpy() for t in frames])",
        magic: &[Magic::start(
            b"\x80\x02\x8a\x0a\x6c\xfc\x9c\x46\xf9\x20\x6a\xa8\x50\x19",
        )],
        extensions: &["pt", "pth", "ckpt"],
        members: &["data.pkl"],
        ..ROW
    },
    Foreign {
        name: "a file of pickled Python objects",
        writer: "Python (pickle)",
        advice: "objects are code and are never run here: save the arrays with numpy.save or numpy.savez",
        looks_like: Some(looks::pickle),
        extensions: &["pkl", "pickle"],
        ..ROW
    },
    Foreign {
        name: "a safetensors file",
        writer: "Hugging Face programs",
        advice: "save its tensors with numpy.savez",
        looks_like: Some(looks::safetensors),
        extensions: &["safetensors"],
        ..ROW
    },
    Foreign {
        name: "a MATLAB file (MAT)",
        writer: "MATLAB",
        advice: "save the points with writematrix(points, 'points.csv') or pcwrite(ptCloud, 'cloud.ply'), or with \
            scipy.io.loadmat and numpy.save",
        magic: &[
            Magic::start(b"MATLAB 5.0 MAT-file"),
            Magic::start(b"MATLAB 7.3 MAT-file"),
        ],
        extensions: &["mat"],
        ..ROW
    },
    Foreign {
        name: "an HDF5 file",
        writer: "h5py, MATLAB, simulation and satellite programs",
        advice: "save the data set with the points as an array: numpy.save('points.npy', h5py.File(FILE)['points'][:])",
        magic: &[Magic::start(b"\x89HDF\r\n\x1a\n")],
        extensions: &["h5", "hdf5", "hdf", "he5"],
        ..ROW
    },
    Foreign {
        name: "a NetCDF file",
        writer: "climate and simulation programs",
        advice: "save the variables with the coordinates as an array (numpy.save) or as CSV",
        magic: &[
            Magic::start(b"CDF\x01"),
            Magic::start(b"CDF\x02"),
            Magic::start(b"CDF\x05"),
        ],
        extensions: &["nc", "nc4"],
        ..ROW
    },
    Foreign {
        name: "a Parquet table",
        writer: "pandas, Spark and DuckDB",
        advice: "save it as CSV: pandas.read_parquet(FILE).to_csv('points.csv', index=False)",
        magic: &[Magic::start(b"PAR1")],
        extensions: &["parquet"],
        ..ROW
    },
    Foreign {
        name: "an Arrow or Feather table",
        writer: "pandas, Polars and Arrow",
        advice: "save it as CSV: pandas.read_feather(FILE).to_csv('points.csv', index=False)",
        magic: &[Magic::start(b"ARROW1"), Magic::start(b"FEA1")],
        extensions: &["feather", "arrow"],
        ..ROW
    },
    Foreign {
        name: "a TensorFlow record file",
        writer: "TensorFlow (Waymo Open Dataset)",
        advice: "save the points of each frame with numpy.save, using the tools of the data set",
        extensions: &["tfrecord", "tfrecords"],
        ..ROW
    },
    Foreign {
        name: "an R data file",
        writer: "R",
        advice: "save the points with lidR::writeLAS or write.csv",
        magic: &[
            Magic::start(b"RDX2\n"),
            Magic::start(b"RDX3\n"),
            Magic::start(b"X\n\x00\x00\x00\x02"),
            Magic::start(b"X\n\x00\x00\x00\x03"),
        ],
        extensions: &["rds", "rdata"],
        ..ROW
    },
    Foreign {
        name: "a NRRD volume",
        writer: "3D Slicer and ITK",
        advice: "extract a surface and save it as PLY, OBJ or STL, for example with 3D Slicer",
        magic: &[Magic::start(b"NRRD000")],
        extensions: &["nrrd", "nhdr"],
        ..ROW
    },
    Foreign {
        name: "a medical image (DICOM)",
        writer: "medical scanners",
        advice: "extract a surface and save it as PLY, OBJ or STL, for example with 3D Slicer",
        magic: &[Magic {
            offset: 128,
            bytes: b"DICM",
        }],
        extensions: &["dcm"],
        ..ROW
    },
    Foreign {
        name: "an Excel workbook",
        writer: "Excel and LibreOffice",
        advice: "save the sheet with the points as CSV",
        extensions: &["xlsx", "xls", "ods"],
        members: &["workbook.xml"],
        ..ROW
    },
    Foreign {
        name: "a shapefile",
        writer: "ArcGIS and QGIS",
        advice: "save its points as CSV with coordinates: ogr2ogr -f CSV points.csv FILE.shp -lco GEOMETRY=AS_XYZ",
        magic: &[Magic::start(b"\x00\x00\x27\x0a\x00\x00\x00\x00")],
        extensions: &["shp"],
        ..ROW
    },
    Foreign {
        name: "a KML or KMZ file",
        writer: "Google Earth",
        advice: "save its points as CSV: ogr2ogr -f CSV points.csv FILE.kml -lco GEOMETRY=AS_XYZ",
        extensions: &["kml", "kmz"],
        members: &["doc.kml"],
        ..ROW
    },
];
