//! A sample of every kind, as small as it can be.

use super::*;
use crate::io::Format;
use std::collections::HashSet;

/// A name and the first bytes of a file, with words of its display name.
type Sample = (&'static str, &'static [u8], &'static str);

/// Files whose content identifies their kind, whatever their name.
const BY_CONTENT: &[Sample] = &[
    ("scan.bin", b"CCB2\x00\x00", "CloudCompare"),
    ("scan", b"CCB3\x00\x00", "CloudCompare"),
    (
        "cloud.js",
        br#"{"version":"1.8","octreeDir":"data","hierarchyStepSize":5}"#,
        "Potree 1",
    ),
    (
        "metadata.json",
        br#"{"version":"2.0","hierarchy":{"firstChunkSize":22}}"#,
        "Potree 2",
    ),
    ("octree.bin", b"\x00\x00\x00\x00", "Potree 2"),
    (
        "ept.json",
        br#"{"dataType":"laszip","hierarchyType":"json"}"#,
        "Entwine",
    ),
    ("0.pnts", b"pnts\x01\x00\x00\x00", "PNTS"),
    ("0.b3dm", b"b3dm\x01\x00\x00\x00", "B3DM"),
    (
        "tileset.json",
        br#"{"asset":{"version":"1.0"},"geometricError":70,"root":{}}"#,
        "tileset",
    ),
    ("a.lvx", b"livox_tech\x00\x00\x00\x00\x00\x00\x01\x01\x00\x00", "LVX)"),
    ("a.lvx2", b"livox_tech\x00\x00\x00\x00\x00\x00\x02\x00\x00\x00", "LVX2"),
    ("run_0.db3.zstd", b"\x28\xb5\x2f\xfd\x00", "ROS 2 bag"),
    ("run_0.mcap.zstd", b"\x28\xb5\x2f\xfd\x00", "ROS 2 bag"),
    (
        "metadata.yaml",
        b"rosbag2_bagfile_information:\n  version: 5\n",
        "description of a ROS 2 bag",
    ),
    ("a.osf", b"\x10\x00\x00\x00\x10\x00\x00\x00OSF!", "OSF"),
    ("a.bt", b"# Octomap OcTree binary file\n", "OctoMap"),
    ("meta.json", br#"{"version":2,"means":{},"quats":{}}"#, "SOG"),
    ("a.splatv", b"\x4b\x67\x00\x00\x3a\x00\x00\x00[{", "SPLATV"),
    ("a.vtk", b"# vtk DataFile Version 3.0\n", "VTK"),
    (
        "a.vtu",
        b"<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\">",
        "VTK data set in XML",
    ),
    ("a.usdc", b"PXR-USDC", "USD"),
    ("a.usda", b"#usda 1.0\n", "USD"),
    ("a.fbx", b"Kaydara FBX Binary  \x00", "FBX"),
    ("a.blend", b"BLENDER-v300", "Blender"),
    ("b.blend", b"\x28\xb5\x2f\xfd", "Blender"),
    ("a.ifc", b"ISO-10303-21;\nHEADER;\nFILE_SCHEMA(('IFC4'));", "IFC"),
    ("a.stp", b"ISO-10303-21;\nHEADER;\n", "STEP"),
    ("a.dwg", b"AC1027", "DWG"),
    ("a.dxf", b"  0\r\nSECTION\r\n  2\r\n", "DXF"),
    ("a.dae", b"<?xml version=\"1.0\"?>\n<COLLADA>", "COLLADA"),
    ("a.wrl", b"#VRML V2.0 utf8", "VRML"),
    ("a.3dm", b"3D Geometry File Format ", "Rhino"),
    ("a.abc", b"Ogawa\xff", "Alembic"),
    ("a.vdb", b"\x20\x42\x44\x56", "OpenVDB"),
    ("a.msh", b"$MeshFormat\n4.1 0 8\n", "Gmsh"),
    (
        "well.las",
        b"# made by hand\n~Version information\n VERS. 2.0:\n",
        "well log",
    ),
    ("well2.las", b"~V\n", "well log"),
    ("1abc.pdb", b"HEADER    HYDROLASE", "Protein Data Bank"),
    (
        "2abc.txt",
        b"REMARK 1\nATOM      1  N   MET A   1\n",
        "Protein Data Bank",
    ),
    ("a.mol2", b"# x\n@<TRIPOS>MOLECULE\n", "MOL2"),
    (
        "a.mol",
        b"water\n  made\n\n  3  2  0  0  0  0  0  0  0  0999 V2000\n",
        "MDL",
    ),
    ("a.cif", b"data_quartz\n_cell_length_a 4.9\n", "CIF"),
    (
        "a.pt",
        b"\x80\x02\x8a\x0a\x6c\xfc\x9c\x46\xf9\x20\x6a\xa8\x50\x19.",
        "PyTorch",
    ),
    ("a.pkl", b"\x80\x04\x95\x10\x00\x00\x00\x00\x00\x00\x00}", "pickled"),
    (
        "a.safetensors",
        b"\x40\x00\x00\x00\x00\x00\x00\x00{\"a\":{}}",
        "safetensors",
    ),
    ("a.mat", b"MATLAB 5.0 MAT-file, Platform", "MATLAB"),
    ("a.h5", b"\x89HDF\r\n\x1a\n", "HDF5"),
    ("a.nc", b"CDF\x01", "NetCDF"),
    ("a.parquet", b"PAR1\x15", "Parquet"),
    ("a.feather", b"ARROW1\x00\x00", "Arrow"),
    ("a.rds", b"RDX3\n", "R data"),
    ("a.nrrd", b"NRRD0004\n", "NRRD"),
    ("a.shp", b"\x00\x00\x27\x0a\x00\x00\x00\x00\x00", "shapefile"),
    ("cloud.ply", b"\n<!DOCTYPE html>\n<html>", "web page"),
    (
        "cloud.las",
        b"<?xml version=\"1.0\"?>\n<Error><Code>AccessDenied</Code>",
        "file store",
    ),
    (
        "cloud.laz",
        b"version https://git-lfs.github.com/spec/v1\noid sha256:00\n",
        "git lfs pull",
    ),
    ("cloud.pcd", b"/annex/objects/SHA256E-s12--00.pcd\n", "git annex get"),
    ("._cloud.ply", b"\x00\x05\x16\x07\x00\x02\x00\x00Mac", "AppleDouble"),
    ("a.tif", b"II\x2a\x00\x08", "GeoTIFF"),
    ("a.png", b"\x89PNG\r\n\x1a\n", "an image"),
    ("a.jpg", b"\xff\xd8\xff\xe0\x00", "an image"),
    ("a.webp", b"RIFF\x00\x00\x00\x00WEBP", "an image"),
    ("a.heic", b"\x00\x00\x00\x18ftypheic", "an image"),
    ("a.mp4", b"\x00\x00\x00\x18ftypisom", "a video"),
    ("a.avi", b"RIFF\x00\x00\x00\x00AVI ", "a video"),
    ("a.mkv", b"\x1a\x45\xdf\xa3", "a video"),
    ("a.pdf", b"%PDF-1.7", "PDF"),
    ("a.ply.bz2", b"BZh91AY", "bzip2"),
    ("a.tar.xz", b"\xfd7zXZ\x00", "xz"),
    ("a.ply.zst", b"\x28\xb5\x2f\xfd", "compressed with zstd"),
    ("a.ply.lz4", b"\x04\x22\x4d\x18", "lz4"),
    ("a.7z", b"7z\xbc\xaf\x27\x1c", "7-Zip"),
    ("a.rar", b"Rar!\x1a\x07\x00", "RAR"),
    ("scan_old.bin", b"CCBF\x00\x00\x00\x00", "CloudCompare"),
    (
        "a.psx",
        b"<?xml version=\"1.0\"?>\n<document version=\"1.2.0\" path=\"{projectname}.files\"/>",
        "Metashape",
    ),
    ("poses.txt", b"VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\n", "g2o"),
    ("a.rrd", b"RRF2\x00\x16\x00\x00", "Rerun"),
    ("a.grd", b"DSBB\x02\x00\x02\x00", "Surfer"),
    ("a.grd", b"DSRB\x04\x00\x00\x00", "Surfer"),
    ("a.dat", b"! grid\n@TOP HEADER, GRID, 5\n", "ZMap"),
    ("a.img", b"EHFA_HEADER_TAG\x00", "Erdas"),
    ("a.jp2", b"\x00\x00\x00\x0cjP  \r\n\x87\n", "JPEG 2000"),
    ("a.city.json", br#"{"type":"CityJSON","version":"1.1"}"#, "CityJSON"),
    ("a.json", br#"{"type": "FeatureCollection", "features": []}"#, "GeoJSON"),
    ("a.xml", b"<?xml version=\"1.0\"?><gml:FeatureCollection/>", "GML"),
    ("a.gpx", b"<?xml version=\"1.0\"?><gpx version=\"1.1\"/>", "GPX"),
    ("a.xml", b"<?xml version=\"1.0\"?><LandXML/>", "LandXML"),
    ("a.nii", NIFTI, "NIfTI"),
    ("a.mha", b"ObjectType = Image\nNDims = 3\n", "MetaImage"),
    ("a.map", MRC, "MRC"),
    ("a.fits", b"SIMPLE  =                    T", "FITS"),
    ("a.dcd", b"\x54\x00\x00\x00CORD", "DCD"),
    ("a.xtc", b"\x00\x00\x07\xcb\x00", "XTC"),
    ("dump.txt", b"ITEM: TIMESTEP\n0\n", "LAMMPS"),
    ("POSCAR", b"cubic\n1.0\n", "VASP"),
    ("a", b"X\n\x00\x00\x00\x03\x00", "R data"),
    ("a.xmf", b"<?xml version=\"1.0\" ?>\n<Xdmf Version=\"3.0\"/>", "XDMF"),
    ("a.case", b"FORMAT\ntype: ensight gold\n", "EnSight"),
    ("a.plt", b"#!TDV112\x01", "Tecplot"),
    (
        "a.tec",
        b"TITLE = \"x\"\nVARIABLES = \"X\", \"Y\", \"Z\"\nZONE\n",
        "Tecplot",
    ),
    ("a.inp", b"** made\n*Heading\n*Node\n1, 0, 0, 0\n", "Abaqus"),
    ("a.root", b"root\x00\x00\xf4\x25", "ROOT"),
    ("a.json", b"[[0, 0, 0], [1, 1, 1]]", "JSON list"),
    ("b.json", br#"{"points": [[0, 0, 0]]}"#, "JSON list"),
    ("a.ipynb", br#"{"cells": [], "nbformat": 4}"#, "Jupyter"),
    ("zarr.json", br#"{"zarr_format": 3}"#, "Zarr"),
    ("a.prt", b"\xc0PRT\r\n\x1a\n", "PRT"),
    ("a.bgeo", b"\x7fNSJb", "Houdini"),
    ("a.bgeo.sc", b"scblosc\x00", "Houdini"),
    ("a.ma", b"//Maya ASCII 2020 scene", "Maya"),
    ("a.mb", b"FOR8\x00", "Maya"),
    ("a.c4d", b"QC4DC4D6", "Cinema"),
    ("a.vox", b"VOX \x96\x00\x00\x00", "MagicaVoxel"),
    ("a.ctm", b"OCTM\x05", "OpenCTM"),
    ("a.iv", b"#Inventor V2.1 ascii\n", "Inventor"),
    ("a.u3d", b"U3D\x00", "U3D"),
    ("a.ktx2", b"\xabKTX 20\xbb\r\n\x1a\n", "KTX"),
    ("a.nxs", b"\x20sxN", "Nexus"),
    ("a.mesh", b"MeshVersionFormatted 2\nDimension 3\n", "Medit"),
    ("a.bin", b"\x7fELF\x02\x01", "a program"),
];

/// A header of the volume of NIfTI-1 and one of MRC, which have their magic far in.
const NIFTI: &[u8] = &with_bytes_at::<348>(344, *b"n+1\x00");
const MRC: &[u8] = &with_bytes_at::<212>(208, *b"MAP ");

const fn with_bytes_at<const N: usize>(at: usize, bytes: [u8; 4]) -> [u8; N] {
    let mut header = [0; N];
    let mut index = 0;
    while index < bytes.len() {
        header[at + index] = bytes[index];
        index += 1;
    }
    header
}

/// Files that only their names tell.
const BY_NAME: &[(&str, &str)] = &[
    ("hierarchy.bin", "Potree 2"),
    ("site.rcp", "ReCap"),
    ("site.RCS", "ReCap"),
    ("scan.ptg", "PTG"),
    ("scan.lgs", "Leica"),
    ("scan.fls", "FARO"),
    ("scan000.3d", "3DTK"),
    ("scan.zfs", "Zoller"),
    ("scan.rxp", "RIEGL"),
    ("scan.tzf", "Trimble"),
    ("scan.cl3", "Topcon"),
    ("scan.pod", "Pointools"),
    ("scan.zlas", "ZLAS"),
    ("lod-meta.json", "levels of detail"),
    ("scene.ksplat", "KSPLAT"),
    ("scene.lcc", "LCC"),
    ("scene.spx", "SPX"),
    ("scene.rad", "RAD"),
    ("model.3ds", "3D Studio"),
    ("model.igs", "IGES"),
    ("model.skp", "SketchUp"),
    ("a.tfrecord", "TensorFlow"),
    ("a.dcm", "DICOM"),
    ("a.dp", "DotProduct"),
    ("a.p4d", "Pix4D"),
    ("a.tdx", "Trimble Data Exchange"),
    ("a.lasx", "ArcGIS"),
    ("a.lax", "LAStools"),
    ("a.klg", "KLG"),
    ("a.svo", "SVO"),
    ("000000.label", "SemanticKITTI"),
    ("N45E009.hgt", "SRTM"),
    ("a.dem", "USGS"),
    ("a.bil", "BIL"),
    ("a.slpk", "I3S"),
    ("a.gro", "GROMACS"),
    ("a.zarr", "Zarr"),
    ("a.onnx", "ONNX"),
    ("a.x_t", "Parasolid"),
    ("a.rdb", "RIEGL"),
];

/// Databases, by the names of their tables.
const BY_TABLES: &[(&[&str], &str)] = &[
    (&["gpkg_contents", "gpkg_geometry_columns"], "GeoPackage"),
    (&["geometry_columns", "spatial_ref_sys", "roads"], "SpatiaLite"),
    (&["Admin", "Data", "Link", "Node"], "RTAB-Map"),
    (&["cameras", "images", "keypoints", "matches"], "COLMAP"),
    (&["metadata", "tiles"], "MBTiles"),
];

fn kind_of_tables(names: &[&str]) -> Option<&'static Foreign> {
    let names: Vec<String> = names.iter().map(|name| (*name).to_owned()).collect();
    by_tables(&names)
}

/// Archives and folders, by the names of their files.
const BY_MEMBERS: &[(&[&str], &str)] = &[
    (&["cloud.js", "data"], "Potree 1"),
    (&["metadata.json", "octree.bin", "hierarchy.bin"], "Potree 2"),
    (&["ept.json"], "Entwine"),
    (&["tileset.json", "0.pnts"], "tileset"),
    (&["meta.json", "means_l.webp", "means_u.webp"], "SOG"),
    (&["lod-meta.json"], "levels of detail"),
    (&["Scene.LCC", "data.bin", "index.bin"], "LCC"),
    (&["site.rcp"], "ReCap"),
    (&["model.usdc", "0/texture.png"], "USD"),
    (&["model.usda"], "USDZ"),
    (&["[Content_Types].xml", "3D/3dmodel.model"], "3MF"),
    (&["archive/data.pkl", "archive/version"], "PyTorch"),
    (&["[Content_Types].xml", "xl/workbook.xml"], "Excel"),
    (&["[Content_Types].xml", "word/document.xml"], "Office"),
    (&["doc.kml"], "KML"),
];

#[test]
fn samples_are_recognised_by_their_content() {
    for (name, bytes, words) in BY_CONTENT {
        let path = Path::new(name);
        let kind = by_content(path, bytes).unwrap_or_else(|| panic!("{name} is not recognised"));
        assert!(kind.to_string().contains(words), "{name}: {kind}");
        assert_eq!(Format::detect(path, bytes), None, "{name}");
    }
}

#[test]
fn names_decide_where_content_does_not() {
    for (name, words) in BY_NAME {
        let kind = recognise(Path::new(name), b"\x01\x02\x03\x04").unwrap_or_else(|| panic!("{name}"));
        assert!(kind.to_string().contains(words), "{name}: {kind}");
    }
    for (names, words) in BY_MEMBERS {
        let kind = by_members(&names.iter().copied()).unwrap_or_else(|| panic!("{names:?}"));
        assert!(kind.to_string().contains(words), "{names:?}: {kind}");
    }
    assert!(by_members(&["a.ply", "meta.json"].into_iter()).is_none());
    for (names, words) in BY_TABLES {
        let kind = kind_of_tables(names).unwrap_or_else(|| panic!("{names:?}"));
        assert!(kind.to_string().contains(words), "{names:?}: {kind}");
    }
    assert!(kind_of_tables(&["topics", "messages", "users"]).is_none());
}

#[test]
fn every_row_has_a_sample() {
    let by_content = BY_CONTENT
        .iter()
        .filter_map(|(name, bytes, _)| by_content(Path::new(name), bytes));
    let by_name = BY_NAME
        .iter()
        .filter_map(|(name, _)| recognise(Path::new(name), b"\x01"));
    let by_members = BY_MEMBERS
        .iter()
        .filter_map(|(names, _)| by_members(&names.iter().copied()));
    let hit: HashSet<&str> = by_content
        .chain(by_name)
        .chain(by_members)
        .chain(BY_TABLES.iter().filter_map(|(names, _)| kind_of_tables(names)))
        .map(|kind| kind.name)
        .collect();
    let missed: Vec<&str> = rows().map(|row| row.name).filter(|name| !hit.contains(name)).collect();
    assert_eq!(missed, [""; 0]);
    let names: HashSet<&str> = rows().map(|row| row.name).collect();
    assert_eq!(names.len(), rows().count(), "two rows have one name");
    assert!(rows().count() >= 60, "{}", rows().count());
}

#[test]
fn rows_do_not_claim_extensions_of_supported_formats() {
    let read: HashSet<&str> = crate::io::supported_extensions().collect();
    for row in rows() {
        for extension in row.extensions {
            assert!(!read.contains(extension), "{}: {extension}", row.name);
        }
        assert!(!row.name.is_empty() && !row.advice.is_empty());
        assert!(
            row.name.starts_with("a ")
                || row.name.starts_with("an ")
                || row.name.contains("macOS")
                || row.name.starts_with("the "),
            "{}",
            row.name
        );
    }
}

#[test]
fn supported_files_are_not_claimed() {
    let floats: Vec<u8> = [12.5f32, -3.25, 1.75, 0.5]
        .iter()
        .flat_map(|number| number.to_le_bytes())
        .collect();
    let samples: [(&str, &[u8]); 15] = [
        ("a.ply", b"ply\nformat ascii 1.0\n"),
        ("a.txt", b"1 2 3\n4 5 6\n"),
        ("data_points.csv", b"data_x,y,z\n1,2,3\n"),
        ("a.xyz", b"# REMARK\n1 2 3\n"),
        ("000000.bin", &floats),
        ("a.bin", &[0; 64]),
        ("a.splat", &[0; 32]),
        ("a.stl", b"solid cube\n"),
        ("a.obj", b"v 0 0 0\n"),
        ("a.gltf", br#"{"asset":{"version":"2.0"},"meshes":[]}"#),
        ("a.pcd", b"# .PCD v0.7\nVERSION 0.7\n"),
        ("a.pts", b"3\n1 2 3 4\n"),
        ("a.txt", b"root_x,root_y,root_z\n1,2,3\n"),
        ("b.txt", b"[0, 0, 0]\n[1, 2, 3]\n"),
        ("a.grd", b"DSAA\n2 2\n0 1\n0 1\n0 1\n0 0\n1 1\n"),
    ];
    for (name, bytes) in samples {
        let kind = by_content(Path::new(name), bytes);
        assert!(kind.is_none(), "{name}: {kind:?}");
        assert!(Format::detect(Path::new(name), bytes).is_some(), "{name}");
    }
}
