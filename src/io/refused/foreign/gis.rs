//! Rasters, maps and city models.

use super::looks_text;
use super::row::{Foreign, ROW};
use crate::io::format::Magic;

pub(super) const ROWS: &[Foreign] = &[
    Foreign {
        name: "a binary Surfer grid",
        writer: "Golden Software Surfer",
        advice: "save it from Surfer as an ASCII grid (GS ASCII), or convert it with `gdal_translate -of XYZ \
            FILE.grd points.xyz`",
        magic: &[Magic::start(b"DSBB"), Magic::start(b"DSRB")],
        ..ROW
    },
    Foreign {
        name: "an SRTM elevation tile (HGT)",
        writer: "NASA and GIS programs",
        advice: "convert it to points with `gdal_translate -of XYZ FILE.hgt points.xyz` (the name has to stay, as it \
            says where the tile is), in metres with `gdalwarp -t_srs EPSG:326ZZ` before",
        extensions: &["hgt"],
        ..ROW
    },
    Foreign {
        name: "a USGS elevation model (DEM)",
        writer: "USGS and GIS programs",
        advice: "convert it to points with `gdal_translate -of XYZ FILE.dem points.xyz`",
        extensions: &["dem"],
        ..ROW
    },
    Foreign {
        name: "a ZMap grid",
        writer: "Landmark ZMAP and Petrel",
        advice: "convert it to points with `gdal_translate -of XYZ FILE points.xyz`",
        looks_like: Some(looks_text::z_map),
        extensions: &["zmap", "zycor"],
        ..ROW
    },
    Foreign {
        name: "an Erdas Imagine raster (IMG)",
        writer: "Erdas Imagine and ArcGIS",
        advice: "convert an elevation to points with `gdal_translate -of XYZ FILE.img points.xyz`",
        magic: &[Magic::start(b"EHFA_HEADER_TAG")],
        ..ROW
    },
    Foreign {
        name: "a raw raster with a header file next to it (BIL, BIP or BSQ)",
        writer: "GIS programs",
        advice: "convert an elevation to points with `gdal_translate -of XYZ FILE points.xyz`",
        extensions: &["bil", "bip", "bsq"],
        ..ROW
    },
    Foreign {
        name: "a JPEG 2000 image",
        writer: "GIS programs and satellites",
        advice: "it shows colours and no depth; convert an elevation to points with `gdal_translate -of XYZ FILE.jp2 \
            points.xyz`",
        magic: &[
            Magic::start(b"\x00\x00\x00\x0cjP  \r\n\x87\n"),
            Magic::start(b"\xff\x4f\xff\x51"),
        ],
        extensions: &["jp2", "j2k"],
        ..ROW
    },
    Foreign {
        name: "a CityJSON model",
        writer: "3D city programs",
        advice: "convert it with `cjio FILE export obj model.obj`",
        looks_like: Some(looks_text::city_json),
        ..ROW
    },
    Foreign {
        name: "a GeoJSON file",
        writer: "GIS programs",
        advice: "save its points as CSV with coordinates: ogr2ogr -f CSV points.csv FILE -lco GEOMETRY=AS_XYZ",
        looks_like: Some(looks_text::geo_json),
        extensions: &["geojson"],
        ..ROW
    },
    Foreign {
        name: "a GML or CityGML file",
        writer: "GIS programs",
        advice: "convert a city model to CityJSON with citygml-tools and that with `cjio FILE export obj model.obj`; \
            save points as CSV with ogr2ogr",
        looks_like: Some(looks_text::gml),
        extensions: &["gml"],
        ..ROW
    },
    Foreign {
        name: "a GPS track (GPX)",
        writer: "GPS devices",
        advice: "save its points as CSV with coordinates: ogr2ogr -f CSV points.csv FILE.gpx track_points -lco \
            GEOMETRY=AS_XYZ",
        looks_like: Some(looks_text::gpx),
        extensions: &["gpx"],
        ..ROW
    },
    Foreign {
        name: "a LandXML file",
        writer: "Civil 3D and survey programs",
        advice: "export its points as text with a line `x y z` each, or its surface as DXF, and that as PLY with \
            CloudCompare",
        looks_like: Some(looks_text::land_xml),
        extensions: &["landxml"],
        ..ROW
    },
    Foreign {
        name: "an I3S scene layer package (SLPK)",
        writer: "ArcGIS",
        advice: "open the LAS files that it was made of; a mesh is exported from ArcGIS Pro as OBJ or glTF",
        extensions: &["slpk"],
        members: &["3dscenelayer.json.gz"],
        ..ROW
    },
];
