//! Models, meshes and drawings of other programs.

use super::looks;
use super::row::{Foreign, ROW};
use crate::io::format::Magic;

pub(super) const ROWS: &[Foreign] = &[
    Foreign {
        name: "a legacy VTK data set",
        writer: "VTK and ParaView",
        advice: "open it in ParaView and save it as PLY (File > Save Data)",
        magic: &[Magic::start(b"# vtk DataFile")],
        extensions: &["vtk"],
        ..ROW
    },
    Foreign {
        name: "a VTK data set in XML",
        writer: "VTK and ParaView",
        advice: "open it in ParaView and save it as PLY (File > Save Data)",
        looks_like: Some(looks::vtk_xml),
        extensions: &["vtu", "vtp", "vti", "vtr", "vts", "vtm", "pvd", "pvtu", "pvtp"],
        ..ROW
    },
    Foreign {
        name: "a Universal Scene Description (USD)",
        writer: "Pixar USD, Omniverse, Reality Composer and Object Capture",
        advice: "export it as glTF or PLY, for example with Blender (File > Import > Universal Scene Description)",
        magic: &[Magic::start(b"PXR-USDC")],
        looks_like: Some(looks::usd_text),
        extensions: &["usd", "usda", "usdc", "usdz"],
        members: &["*.usdc"],
        ..ROW
    },
    Foreign {
        name: "a Universal Scene Description archive (USDZ)",
        writer: "Reality Composer, Object Capture and scanning apps",
        advice: "export it as glTF or PLY, for example with Blender (File > Import > Universal Scene Description)",
        members: &["*.usda"],
        ..ROW
    },
    Foreign {
        name: "an FBX model",
        writer: "Autodesk and game engines",
        advice: "export it as glTF, for example with Blender or FBX2glTF",
        magic: &[Magic::start(b"Kaydara FBX Binary"), Magic::start(b"; FBX ")],
        extensions: &["fbx"],
        ..ROW
    },
    Foreign {
        name: "a Blender file",
        writer: "Blender",
        advice: "open it in Blender and export glTF, PLY or OBJ",
        looks_like: Some(looks::blend),
        extensions: &["blend"],
        ..ROW
    },
    Foreign {
        name: "a 3D Studio model",
        writer: "3ds Max",
        advice: "export it as glTF or OBJ, for example with Blender",
        extensions: &["3ds", "max"],
        ..ROW
    },
    Foreign {
        name: "a building model (IFC)",
        writer: "Revit, ArchiCAD and other BIM programs",
        advice: "convert it with `IfcConvert model.ifc model.glb`",
        looks_like: Some(looks::ifc),
        extensions: &["ifc"],
        ..ROW
    },
    Foreign {
        name: "a STEP model",
        writer: "CAD programs",
        advice: "export its surface as STL, OBJ or glTF, for example with FreeCAD",
        magic: &[Magic::start(b"ISO-10303-21;")],
        extensions: &["step", "stp"],
        ..ROW
    },
    Foreign {
        name: "an IGES model",
        writer: "CAD programs",
        advice: "export its surface as STL, OBJ or glTF, for example with FreeCAD",
        extensions: &["iges", "igs"],
        ..ROW
    },
    Foreign {
        name: "an AutoCAD drawing (DWG)",
        writer: "AutoCAD",
        advice: "export its points or surfaces as text, OBJ or STL",
        magic: &[Magic::start(b"AC10")],
        extensions: &["dwg"],
        ..ROW
    },
    Foreign {
        name: "a drawing (DXF)",
        writer: "AutoCAD and other CAD programs",
        advice: "convert it with CloudCompare or QGIS to PLY or text",
        looks_like: Some(looks::dxf),
        extensions: &["dxf"],
        ..ROW
    },
    Foreign {
        name: "a COLLADA model",
        writer: "modelling programs",
        advice: "export it as glTF, for example with Blender or COLLADA2GLTF",
        looks_like: Some(looks::collada),
        extensions: &["dae"],
        ..ROW
    },
    Foreign {
        name: "a VRML or X3D scene",
        writer: "X3D programs and MeshLab",
        advice: "open it in MeshLab and export PLY or OBJ",
        looks_like: Some(looks::x3d),
        extensions: &["wrl", "x3d", "x3dv"],
        ..ROW
    },
    Foreign {
        name: "a Rhino model",
        writer: "Rhino",
        advice: "export it from Rhino as PLY, OBJ or glTF",
        magic: &[Magic::start(b"3D Geometry File Format")],
        extensions: &["3dm"],
        ..ROW
    },
    Foreign {
        name: "a 3D print model (3MF)",
        writer: "slicers and CAD programs",
        advice: "export it as STL or OBJ",
        extensions: &["3mf"],
        members: &["3dmodel.model"],
        ..ROW
    },
    Foreign {
        name: "a SketchUp model",
        writer: "SketchUp",
        advice: "export it from SketchUp as glTF, OBJ or STL",
        extensions: &["skp"],
        ..ROW
    },
    Foreign {
        name: "an Alembic cache",
        writer: "Houdini, Maya and Blender",
        advice: "export it as glTF, or a PLY or OBJ file per frame, for example with Blender",
        magic: &[Magic::start(b"Ogawa")],
        extensions: &["abc"],
        ..ROW
    },
    Foreign {
        name: "an OpenVDB volume",
        writer: "OpenVDB and Houdini",
        advice: "convert its active voxels to points and save them as PLY, for example with Houdini",
        magic: &[Magic::start(b"\x20\x42\x44\x56")],
        extensions: &["vdb"],
        ..ROW
    },
    Foreign {
        name: "a Gmsh mesh",
        writer: "Gmsh",
        advice: "convert it with `gmsh mesh.msh -save -o mesh.stl` or meshio",
        magic: &[Magic::start(b"$MeshFormat")],
        extensions: &["msh"],
        ..ROW
    },
];
