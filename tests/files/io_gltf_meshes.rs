//! Meshes of glTF files written here: their known places, faces, encodings, colours and textures.

use crate::io_gltf::{CORNERS, Model, positions, square};
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use pointreel::io::ReadOptions;
use serde_json::{Value, json};
use std::num::NonZeroUsize;

#[test]
fn meshes_are_placed_by_their_nodes() {
    let mut model = square();
    model.json["nodes"] = json!([
        {"mesh": 0, "scale": [2.0, 1.0, 1.0]},
        {"children": [0, 2], "translation": [10.0, 0.0, 0.0]},
        {"mesh": 0, "matrix": [0.0, 1.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 5.0, 1.0]},
        {"mesh": 0}
    ]);
    model.json["scenes"] = json!([{"nodes": [3]}, {"nodes": [1]}]);
    model.json["scene"] = json!(1);
    let cloud = model.read();
    assert_eq!(
        positions(&cloud),
        [
            [10.0, 0.0, 0.0],
            [12.0, 0.0, 0.0],
            [10.0, 1.0, 0.0],
            [12.0, 1.0, 0.0],
            [10.0, 0.0, 5.0],
            [10.0, 1.0, 5.0],
            [9.0, 0.0, 5.0],
            [9.0, 1.0, 5.0],
        ]
    );
    assert_eq!(cloud.faces, [[0, 1, 2], [2, 1, 3], [4, 5, 6], [6, 5, 7]]);
    assert!(cloud.attributes.colors.is_none() && cloud.attributes.normals.is_none());
    // Mirroring reverses the order of the corners, not the visible side.
    model.json["nodes"] = json!([{"mesh": 0, "scale": [-1.0, 1.0, 1.0]}]);
    model.json["scenes"] = json!([]);
    model.json["scene"] = Value::Null;
    model.attribute("NORMAL", "VEC3", &[[1.0, 0.0, 1.0]; 4]);
    let cloud = model.read();
    assert_eq!(cloud.faces[0], [0, 2, 1]);
    let half = 0.5f32.sqrt();
    assert!((cloud.attributes.normals.unwrap()[0][0] + half).abs() < 1e-6);
    for (nodes, problem) in [
        (json!([{"children": [0]}]), "the scene shows no mesh"),
        (
            json!([{"children": [2]}, {"children": [2]}, {}]),
            "node 2: it hangs on two nodes",
        ),
        (json!([{"children": [1], "mesh": 0}, {"children": [7]}]), "node 7"),
        (json!([{"mesh": 3}]), "mesh 3"),
    ] {
        model.json["nodes"] = nodes;
        assert!(model.refused().contains(problem), "{}", model.refused());
    }
    model.json["nodes"] = json!([{"children": [0]}]);
    model.json["scenes"] = json!([{"nodes": [0]}]);
    assert!(
        model.refused().contains("node 0: it hangs on two nodes, or on itself"),
        "{}",
        model.refused()
    );
}

#[test]
fn triangles_strips_fans_and_points_are_read() {
    for (mode, faces) in [
        (4, vec![[0, 1, 2]]),
        (5, vec![[0, 1, 2], [2, 1, 3]]),
        (6, vec![[0, 1, 2], [0, 2, 3]]),
        (0, vec![]),
        (1, vec![]),
    ] {
        let mut model = Model::new();
        model.attribute("POSITION", "VEC3", &CORNERS);
        model.primitive()["mode"] = json!(mode);
        let cloud = model.read();
        assert_eq!((cloud.positions.len(), &cloud.faces), (4, &faces), "mode {mode}");
    }
    // Vertices that no index refers to belong to other shapes.
    let mut model = Model::new();
    model.attribute("POSITION", "VEC3", &CORNERS);
    let indices = model.accessor("SCALAR", 5121, 3, &[3, 1, 0]);
    model.primitive()["indices"] = json!(indices);
    let cloud = model.read();
    assert_eq!(positions(&cloud), [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]]);
    assert_eq!(cloud.faces, [[2, 1, 0]]);
    let indices = model.accessor("SCALAR", 5121, 3, &[3, 1, 4]);
    model.primitive()["indices"] = json!(indices);
    assert!(model.refused().contains("names vertex 4, but it has 4"));
}

#[test]
fn sparse_quantised_and_absent_accessors_are_read() {
    let mut model = Model::new();
    let indices = model.view(&[1, 3]);
    let values: Vec<u8> = [7f32, 8.0, 9.0, -1.0, -2.0, -3.0]
        .iter()
        .flat_map(|value| value.to_le_bytes())
        .collect();
    let values = model.view(&values);
    let sparse = json!({"count": 2, "indices": {"bufferView": indices, "componentType": 5121},
        "values": {"bufferView": values}});
    model.json["accessors"] = json!([{"componentType": 5126, "count": 4, "type": "VEC3", "sparse": sparse}]);
    model.primitive()["attributes"]["POSITION"] = json!(0);
    assert_eq!(
        positions(&model.read()),
        [[0.0; 3], [7.0, 8.0, 9.0], [0.0; 3], [-1.0, -2.0, -3.0]]
    );
    model.json["accessors"][0]["count"] = json!(3);
    assert!(model.refused().contains("sparse entry 3"), "{}", model.refused());
    model.json["accessors"][0]["count"] = json!(u64::MAX);
    assert!(model.refused().contains("--max-memory"), "{}", model.refused());
    let mut model = Model::new();
    let accessor = model.accessor("VEC3", 5122, 1, &[0xff, 0x7f, 0x01, 0x80, 0, 0]);
    model.json["accessors"][accessor]["normalized"] = json!(true);
    model.primitive()["attributes"]["POSITION"] = json!(accessor);
    assert_eq!(positions(&model.read()), [[1.0, -1.0, 0.0]]);
    model.json["accessors"][accessor]["normalized"] = json!(false);
    model.json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    assert_eq!(positions(&model.read()), [[32767.0, -32767.0, 0.0]]);
    model.json["accessors"][accessor]["count"] = json!(0);
    assert!(model.refused().contains("no mesh"));
    model.json["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]);
    assert!(model.refused().contains("compressed with KHR_draco_mesh_compression"));
}

#[test]
fn colors_come_from_vertices_materials_and_textures() {
    let mut model = square();
    // Half of the light is 188 of 255.
    model.attribute("COLOR_0", "VEC4", &[[0.5, 1.0, 0.0, 0.5]; 4]);
    assert_eq!(model.read().attributes.colors.unwrap(), [[188, 255, 0, 128]; 4]);
    model.json["materials"] = json!([{"pbrMetallicRoughness": {"baseColorFactor": [1.0, 0.5, 1.0, 1.0]}}]);
    model.primitive()["material"] = json!(0);
    assert_eq!(model.read().attributes.colors.unwrap(), [[188, 188, 0, 128]; 4]);
    model.primitive()["attributes"]
        .as_object_mut()
        .unwrap()
        .remove("COLOR_0");
    assert_eq!(model.read().attributes.colors.unwrap(), [[255, 188, 255, 255]; 4]);

    // Two by two texels, the first row at v = 0.
    let texels = [
        [10, 20, 30, 255],
        [40, 50, 60, 255],
        [70, 80, 90, 255],
        [100, 110, 120, 128],
    ];
    let mut picture = std::io::Cursor::new(Vec::new());
    image::RgbaImage::from_raw(2, 2, texels.concat())
        .unwrap()
        .write_to(&mut picture, image::ImageFormat::Png)
        .unwrap();
    let picture = picture.into_inner();
    model.attribute(
        "TEXCOORD_1",
        "VEC2",
        &[[0.1, 0.1], [1.9, 0.1], [-0.9, 0.9], [0.9, -0.1]],
    );
    model.json["materials"] = json!([{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0, "texCoord": 1}}}]);
    model.json["textures"] = json!([{"source": 0}]);
    let view = model.view(&picture);
    for image in [
        json!({"bufferView": view, "mimeType": "image/png"}),
        json!({"uri": format!("data:image/png;base64,{}", STANDARD.encode(&picture))}),
    ] {
        model.json["images"] = json!([image]);
        assert_eq!(model.read().attributes.colors.unwrap(), texels);
        let sampled = model.pose(0.0, &ReadOptions::default().with_sample_count(NonZeroUsize::new(100)));
        assert!(
            sampled
                .attributes
                .colors
                .unwrap()
                .iter()
                .all(|color| texels.contains(color)),
            "texels are not mixed"
        );
    }
    let transform = json!({"KHR_texture_transform": {"offset": [0.5, 0.0], "scale": [1.0, 1.0]}});
    model.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["extensions"] = transform;
    assert_eq!(model.read().attributes.colors.unwrap()[0], texels[1]);
    // When faces are drawn, the texture is separate, and colours come from the material alone.
    model.json["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = json!([1.0, 0.5, 1.0, 1.0]);
    let mesh = model.pose(0.0, &ReadOptions::default().of_meshes());
    assert_eq!(mesh.attributes.colors.unwrap(), [[255, 188, 255, 255]; 4]);
    let texturing = mesh.texturing.unwrap();
    assert_eq!(texturing.texture_of_vertex, [Some(0); 4]);
    assert_eq!(texturing.places[0], [0.6, 0.1]);
    assert_eq!(texturing.textures.texels(), texels);
    model.json["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = json!([1.0, 1.0, 1.0, 1.0]);
    // Without the image the shape is still there.
    for image in [
        json!({"uri": "missing.png"}),
        json!({"uri": "../a.png"}),
        json!({"uri": "data:image/png;base64,AAAA"}),
    ] {
        model.json["images"] = json!([image]);
        assert_eq!(
            (model.read().positions.len(), model.read().attributes.colors),
            (4, None)
        );
    }
}
