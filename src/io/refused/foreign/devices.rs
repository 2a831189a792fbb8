//! Projects, recordings and databases of scanners, photogrammetry and SLAM.

use super::looks_text;
use super::row::{Foreign, ROW};
use crate::io::format::Magic;

pub(super) const ROWS: &[Foreign] = &[
    Foreign {
        name: "a DotProduct capture (DP)",
        writer: "DotProduct Dot3D and Phi.3D",
        advice: "export it from Dot3D as E57, LAS, PTS or PLY",
        extensions: &["dp"],
        ..ROW
    },
    Foreign {
        name: "a Metashape project",
        writer: "Agisoft Metashape and PhotoScan",
        advice: "export its point cloud from Metashape as LAS, E57 or PLY (File > Export > Export Point Cloud), or \
            its cameras as XML with the images",
        looks_like: Some(looks_text::metashape),
        extensions: &["psx", "psz"],
        ..ROW
    },
    Foreign {
        name: "a Pix4D project",
        writer: "Pix4Dmapper and PIX4Dmatic",
        advice: "open the LAS or PLY files that it wrote (in 2_densification/point_cloud), or export the point cloud \
            as LAS",
        extensions: &["p4d", "p4m", "pix4d"],
        ..ROW
    },
    Foreign {
        name: "a Trimble Data Exchange scan (TDX)",
        writer: "Trimble Perspective and RealWorks",
        advice: "export it from Trimble RealWorks as E57, LAS or PTX",
        extensions: &["tdx"],
        ..ROW
    },
    Foreign {
        name: "the statistics and index that ArcGIS keeps of a LAS file",
        writer: "ArcGIS",
        advice: "open the LAS file that lies next to it",
        extensions: &["lasx", "lasd"],
        ..ROW
    },
    Foreign {
        name: "the spatial index of a LAS file",
        writer: "LAStools",
        advice: "open the LAS or LAZ file that lies next to it",
        extensions: &["lax"],
        ..ROW
    },
    Foreign {
        name: "a graph of poses (g2o)",
        writer: "g2o and SLAM programs",
        advice: "it holds poses and their edges, no points: open the clouds of the recording, with the poses as text \
            lines of `time x y z qx qy qz qw`",
        looks_like: Some(looks_text::g2o),
        extensions: &["g2o"],
        ..ROW
    },
    Foreign {
        name: "a depth recording (KLG)",
        writer: "Logger2 of ElasticFusion and Kintinuous",
        advice: "extract its images with a converter such as `klg2png`, and open their folder as a recording of \
            depth images",
        extensions: &["klg"],
        ..ROW
    },
    Foreign {
        name: "a ZED recording (SVO)",
        writer: "Stereolabs ZED cameras",
        advice: "export point clouds as PLY, or images and depths, with the ZED SDK (ZED_SVO_Export or the sample of \
            the SDK)",
        extensions: &["svo"],
        ..ROW
    },
    Foreign {
        name: "a Rerun recording (RRD)",
        writer: "Rerun",
        advice: "save the clouds where they are logged, for example with numpy.save or as PLY",
        magic: &[
            Magic::start(b"RRF0"),
            Magic::start(b"RRF1"),
            Magic::start(b"RRF2"),
            Magic::start(b"RRIO"),
        ],
        extensions: &["rrd", "rbl"],
        ..ROW
    },
    Foreign {
        name: "the labels of points, a number for each",
        writer: "SemanticKITTI tools",
        advice: "it holds no coordinates: open the .bin file of the same number in the folder velodyne",
        extensions: &["label"],
        ..ROW
    },
    Foreign {
        name: "a GeoPackage",
        writer: "QGIS, ArcGIS and GDAL",
        advice: "save its points as CSV with coordinates: ogr2ogr -f CSV points.csv FILE.gpkg -lco GEOMETRY=AS_XYZ",
        extensions: &["gpkg"],
        tables: &["gpkg_contents"],
        ..ROW
    },
    Foreign {
        name: "a SpatiaLite database",
        writer: "QGIS and GDAL",
        advice: "save its points as CSV with coordinates: ogr2ogr -f CSV points.csv FILE -lco GEOMETRY=AS_XYZ",
        tables: &["geometry_columns", "spatial_ref_sys"],
        ..ROW
    },
    Foreign {
        name: "an RTAB-Map database",
        writer: "RTAB-Map",
        advice: "export its cloud as PLY with `rtabmap-export --output cloud FILE.db`",
        tables: &["node", "link", "data"],
        ..ROW
    },
    Foreign {
        name: "a COLMAP database of features",
        writer: "COLMAP",
        advice: "it holds features and matches, no points: open the folder with the model (cameras, images and \
            points3D), which `colmap mapper` writes",
        tables: &["cameras", "images", "keypoints"],
        ..ROW
    },
    Foreign {
        name: "a set of map tiles (MBTiles)",
        writer: "map tilers",
        advice: "it holds images of maps, no points: open the data that it was made of",
        extensions: &["mbtiles"],
        tables: &["tiles", "metadata"],
        ..ROW
    },
];
