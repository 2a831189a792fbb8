//! Point clouds of other programs and devices.

use super::looks;
use super::row::{Foreign, ROW};
use crate::io::format::Magic;

pub(super) const ROWS: &[Foreign] = &[
    Foreign {
        name: "a CloudCompare project (BIN)",
        writer: "CloudCompare",
        advice: "open it in CloudCompare and save its clouds as PLY, LAS or E57, or run CloudCompare -SILENT -O \
            FILE.bin -C_EXPORT_FMT PLY -SAVE_CLOUDS",
        // The fourth byte holds flags, as a character.
        magic: &[Magic::start(b"CCB")],
        ..ROW
    },
    Foreign {
        name: "a Potree 1 octree",
        writer: "PotreeConverter 1",
        advice: "open the LAS or LAZ file it was made of; if that is lost, and its nodes are LAZ (data/**/*.laz), \
            merge \
            them with `pdal merge`",
        looks_like: Some(looks::potree_1),
        names: &["cloud.js"],
        members: &["cloud.js"],
        ..ROW
    },
    Foreign {
        name: "a Potree 2 octree",
        writer: "PotreeConverter 2",
        advice: "open the LAS or LAZ file it was made of, or crop all of it to a LAS file with PotreeDesktop or \
            CPotree",
        looks_like: Some(looks::potree_2),
        names: &["octree.bin", "hierarchy.bin"],
        members: &["metadata.json", "octree.bin"],
        ..ROW
    },
    Foreign {
        name: "an Entwine Point Tile set (EPT)",
        writer: "Entwine and PDAL",
        advice: "write it as one file with `pdal translate ept.json cloud.laz`; its tiles are LAZ files, which open \
            one \
            by one (ept-data/0-0-0-0.laz is the coarsest)",
        looks_like: Some(looks::ept),
        names: &["ept.json"],
        members: &["ept.json"],
        ..ROW
    },
    Foreign {
        name: "a 3D Tiles point cloud tile (PNTS)",
        writer: "Cesium ion, py3dtiles and gocesiumtiler",
        advice: "convert it to PLY with py3dtiles or to glTF with 3d-tiles-tools (`pntsToGlb`)",
        magic: &[Magic::start(b"pnts")],
        extensions: &["pnts"],
        ..ROW
    },
    Foreign {
        name: "a 3D Tiles model tile (B3DM, I3DM or CMPT)",
        writer: "Cesium ion and other tilers",
        advice: "convert it to glTF with 3d-tiles-tools (`b3dmToGlb`)",
        magic: &[Magic::start(b"b3dm"), Magic::start(b"i3dm"), Magic::start(b"cmpt")],
        extensions: &["b3dm", "i3dm", "cmpt"],
        ..ROW
    },
    Foreign {
        name: "a 3D Tiles tileset",
        writer: "Cesium ion and other tilers",
        advice: "open the data it was made of, or its glTF tiles (*.glb) one by one; tiles of other kinds are \
            converted \
            with 3d-tiles-tools",
        looks_like: Some(looks::tileset),
        names: &["tileset.json"],
        members: &["tileset.json"],
        ..ROW
    },
    Foreign {
        name: "an Autodesk ReCap project or scan",
        writer: "Autodesk ReCap",
        advice: "export it from ReCap Pro as E57, PTS or PCG, and open the E57 or PTS",
        extensions: &["rcp", "rcs"],
        members: &["*.rcp"],
        ..ROW
    },
    Foreign {
        name: "a gridded Leica scan (PTG)",
        writer: "Leica Cyclone",
        advice: "export it from Leica Cyclone or Register 360 as E57, PTX or PTS",
        extensions: &["ptg"],
        ..ROW
    },
    Foreign {
        name: "a Leica database or project",
        writer: "Leica Cyclone and Register 360",
        advice: "export it from Leica Cyclone or Register 360 as E57, PTX or PTS",
        extensions: &["imp", "lgs", "lgsx", "b2g"],
        ..ROW
    },
    Foreign {
        name: "a FARO scan or project",
        writer: "FARO Focus scanners and FARO SCENE",
        advice: "export it from FARO SCENE as E57, PTX or XYZ",
        extensions: &["fls", "fws", "lsproj"],
        ..ROW
    },
    Foreign {
        name: "a scan of 3DTK (its pose is in the file .pose next to it)",
        writer: "3DTK",
        advice: "give copies of the files the extension .xyz, as they are text of x y z: their poses are not read, so \
                 export registered scans from 3DTK where places matter",
        extensions: &["3d"],
        ..ROW
    },
    Foreign {
        name: "a Zoller + Fröhlich scan (ZFS)",
        writer: "Z+F scanners and LaserControl",
        advice: "export it from Z+F LaserControl or Scout as E57 or PTX",
        extensions: &["zfs", "zfc", "zfprj"],
        ..ROW
    },
    Foreign {
        name: "a RIEGL scan",
        writer: "RIEGL scanners and RiSCAN PRO",
        advice: "export it from RiSCAN PRO or RiPROCESS as LAS, LAZ or E57",
        extensions: &["rxp", "rdbx", "rdb", "3dd", "rsp", "sdc", "sdw"],
        ..ROW
    },
    Foreign {
        name: "a Trimble scan",
        writer: "Trimble scanners and RealWorks",
        advice: "export it from Trimble RealWorks as E57, LAS or PTX",
        extensions: &["tzf", "tzs", "rwp", "rwi"],
        ..ROW
    },
    Foreign {
        name: "a Topcon scan",
        writer: "Topcon ScanMaster and MAGNET Collage",
        advice: "export it from MAGNET Collage as E57 or LAS",
        extensions: &["cl3", "clr"],
        ..ROW
    },
    Foreign {
        name: "a Pointools point cloud (POD)",
        writer: "Bentley Pointools and MicroStation",
        advice: "export it from Bentley software as E57, LAS or PTS",
        extensions: &["pod"],
        ..ROW
    },
    Foreign {
        name: "an Optimized LAS file (ZLAS)",
        writer: "Esri ArcGIS",
        advice: "convert it to LAS with Esri's EzLAS",
        extensions: &["zlas"],
        ..ROW
    },
    Foreign {
        name: "a Livox recording (LVX)",
        writer: "Livox Viewer",
        advice: "export its frames from Livox Viewer as LAS or CSV, or convert it to a ROS bag with livox_ros_driver \
            (`roslaunch livox_ros_driver lvx_to_rosbag.launch`), which is read",
        looks_like: Some(looks::lvx),
        extensions: &["lvx"],
        ..ROW
    },
    Foreign {
        name: "a Livox recording (LVX2 or LVX3)",
        writer: "Livox Viewer 2",
        advice: "export its frames from Livox Viewer 2 as LAS, PCD or CSV, or record a bag with livox_ros_driver2, \
            which is read",
        looks_like: Some(looks::lvx_2),
        extensions: &["lvx2", "lvx3"],
        ..ROW
    },
    Foreign {
        name: "a ROS 2 bag that is compressed as a whole with zstd",
        writer: "`ros2 bag record --compression-mode file`",
        advice: "unpack it with `zstd -d FILE.zstd`, or rewrite the bag with `ros2 bag convert`, and open the .db3 or \
            .mcap file",
        looks_like: Some(looks::packed_ros_2_bag),
        ..ROW
    },
    Foreign {
        name: "the description of a ROS 2 bag",
        writer: "`ros2 bag record`",
        advice: "open its folder, or the .db3 or .mcap file next to it",
        looks_like: Some(looks::ros_2_metadata),
        ..ROW
    },
    Foreign {
        name: "an Ouster sequence (OSF)",
        writer: "ouster-cli",
        advice: "convert it with `ouster-cli source FILE.osf save cloud.las` (also .pcd, .pcap or .bag)",
        magic: &[Magic {
            offset: 8,
            bytes: b"OSF!",
        }],
        extensions: &["osf"],
        ..ROW
    },
    Foreign {
        name: "an octree map (OctoMap)",
        writer: "OctoMap and octomap_server",
        advice: "write its occupied cells as points with `octree2pointcloud map.bt map.pcd`",
        magic: &[Magic::start(b"# Octomap OcTree")],
        extensions: &["bt", "ot"],
        ..ROW
    },
];
