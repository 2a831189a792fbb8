//! glTF files written here, with known poses and colours, damaged ones, and models that move against a sequence that
//! was sampled from one of them.

#![allow(clippy::print_stdout, reason = "what was compared is for who runs the test")]

use crate::data::shared;
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use glam::DVec3;
use pointreel::cloud::RawCloud;
use pointreel::io::{self, Part, ReadOptions, SharedFile};
use pointreel::progress::Progress;
use pointreel::sequence::{OpenOptions, Sequence};
use serde_json::{Value, json};
use std::num::NonZeroUsize;
use std::path::Path;
use std::time::Duration;

fn positions(cloud: &RawCloud) -> Vec<[f64; 3]> {
    (0..cloud.positions.len())
        .map(|index| cloud.positions.get(index).to_array())
        .collect()
}

/// A document whose arrays are made one by one; each gets an accessor and a view of its own.
struct Model {
    json: Value,
    bytes: Vec<u8>,
}

impl Model {
    fn new() -> Self {
        Self {
            json: json!({"asset": {"version": "2.0"}, "accessors": [], "bufferViews": [],
                "meshes": [{"primitives": [{"attributes": {}}]}], "nodes": [{"mesh": 0}]}),
            bytes: Vec::new(),
        }
    }

    fn view(&mut self, bytes: &[u8]) -> usize {
        let views = self.json["bufferViews"].as_array_mut().unwrap();
        views.push(json!({"buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len()}));
        self.bytes.extend(bytes);
        views.len() - 1
    }

    fn accessor(&mut self, kind: &str, component: u32, count: usize, bytes: &[u8]) -> usize {
        let view = self.view(bytes);
        let accessors = self.json["accessors"].as_array_mut().unwrap();
        accessors.push(json!({"bufferView": view, "componentType": component, "count": count, "type": kind}));
        accessors.len() - 1
    }

    fn floats<const N: usize>(&mut self, kind: &str, values: &[[f32; N]]) -> usize {
        let bytes: Vec<u8> = values.iter().flatten().flat_map(|value| value.to_le_bytes()).collect();
        self.accessor(kind, 5126, values.len(), &bytes)
    }

    fn attribute<const N: usize>(&mut self, name: &str, kind: &str, values: &[[f32; N]]) {
        let accessor = self.floats(kind, values);
        self.primitive()["attributes"][name] = json!(accessor);
    }

    fn primitive(&mut self) -> &mut Value {
        &mut self.json["meshes"][0]["primitives"][0]
    }

    /// With the bytes in a `data:` URI.
    fn file(&self) -> Vec<u8> {
        let uri = format!("data:application/octet-stream;base64,{}", STANDARD.encode(&self.bytes));
        self.with_uri(&uri)
    }

    fn with_uri(&self, uri: &str) -> Vec<u8> {
        let mut json = self.json.clone();
        json["buffers"] = json!([{"byteLength": self.bytes.len(), "uri": uri}]);
        json.to_string().into_bytes()
    }

    fn glb(&self) -> Vec<u8> {
        let mut json = self.json.clone();
        json["buffers"] = json!([{"byteLength": self.bytes.len()}]);
        let mut json = json.to_string().into_bytes();
        json.resize(json.len().next_multiple_of(4), b' ');
        let mut file = b"glTF".to_vec();
        let length = 12 + 8 + json.len() + 8 + self.bytes.len();
        for word in [2, length, json.len(), 0x4e4f_534a] {
            file.extend((word as u32).to_le_bytes());
        }
        file.extend(json);
        for word in [self.bytes.len(), 0x004e_4942] {
            file.extend((word as u32).to_le_bytes());
        }
        file.extend(&self.bytes);
        file
    }

    fn read(&self) -> RawCloud {
        io::read_bytes(Path::new("a.gltf"), &self.file()).unwrap_or_else(|error| panic!("{error}"))
    }

    fn refused(&self) -> String {
        io::read_bytes(Path::new("a.gltf"), &self.file())
            .unwrap_err()
            .to_string()
    }

    /// At `seconds`.
    fn pose(&self, seconds: f64, options: &ReadOptions) -> RawCloud {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.gltf");
        std::fs::write(&path, self.file()).unwrap();
        io::read_part(&path, &Part::TimeStep(Duration::from_secs_f64(seconds)), options)
            .unwrap_or_else(|error| panic!("{error}"))
    }
}

const CORNERS: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]];

fn square() -> Model {
    let mut model = Model::new();
    model.attribute("POSITION", "VEC3", &CORNERS);
    let indices = model.accessor("SCALAR", 5123, 6, &[0, 0, 1, 0, 2, 0, 2, 0, 1, 0, 3, 0]);
    model.primitive()["indices"] = json!(indices);
    model
}

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

/// Node 0 moved along x by keys at 1 and 3 seconds.
fn moving(interpolation: &str, keys: &[[f32; 3]]) -> Model {
    let mut model = square();
    let times = model.floats("SCALAR", &[[1.0], [3.0]]);
    let values = model.floats("VEC3", keys);
    model.json["animations"] = json!([{
        "channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}],
        "samplers": [{"input": times, "output": values, "interpolation": interpolation}]
    }]);
    model
}

#[test]
fn animations_interpolate_nodes_between_keyframes() {
    let options = ReadOptions::default();
    let place = |model: &Model, seconds: f64| positions(&model.pose(seconds, &options))[0][0];
    let linear = moving("LINEAR", &[[2.0, 0.0, 0.0], [6.0, 0.0, 0.0]]);
    let step = moving("STEP", &[[2.0, 0.0, 0.0], [6.0, 0.0, 0.0]]);
    // Starts with a speed of 8 per second and arrives with none: 2 + 4 * 0.5 + 2 * 8 * 0.125 halfway.
    let cubic = moving(
        "CUBICSPLINE",
        &[
            [0.0; 3],
            [2.0, 0.0, 0.0],
            [8.0, 0.0, 0.0],
            [0.0; 3],
            [6.0, 0.0, 0.0],
            [0.0; 3],
        ],
    );
    for (seconds, expected) in [
        (0.0, [2.0; 3]),
        (1.0, [2.0; 3]),
        (2.0, [4.0, 2.0, 6.0]),
        (3.0, [6.0; 3]),
        (9.0, [6.0; 3]),
    ] {
        assert_eq!(
            [&linear, &step, &cubic].map(|model| place(model, seconds)),
            expected,
            "{seconds} s"
        );
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.gltf");
    std::fs::write(&path, linear.file()).unwrap();
    let entries = io::list(&path, &options).unwrap();
    assert_eq!(entries.len(), 3 * 24 + 1);
    assert_eq!(entries[1].name, "t=0.042 s");
    assert_eq!(entries[72].time, Some(Duration::from_secs(3)));
    assert_eq!(entries[72].part, Part::TimeStep(Duration::from_secs(3)));
    assert_eq!(
        io::read(&path).unwrap(),
        io::read_part(&path, &entries[0].part, &options).unwrap()
    );
    std::fs::write(&path, square().file()).unwrap();
    assert_eq!(io::list(&path, &options).unwrap().len(), 1);
    let mut long = moving("STEP", &[[0.0; 3], [0.0; 3]]);
    let times = long.floats("SCALAR", &[[1.0], [3e30]]);
    long.json["animations"][0]["samplers"][0]["input"] = json!(times);
    std::fs::write(&path, long.file()).unwrap();
    assert_eq!(io::list(&path, &options).unwrap().len(), 100_000);
    let short = moving("CUBICSPLINE", &[[0.0; 3], [2.0, 0.0, 0.0]]);
    assert!(
        short.refused().contains("expected 3 for each of 2 keyframes"),
        "{}",
        short.refused()
    );
}

#[test]
fn data_shared_by_frames_is_read_once() {
    let options = ReadOptions::default();
    let model = moving("LINEAR", &[[2.0, 0.0, 0.0], [6.0, 0.0, 0.0]]);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.glb");
    std::fs::write(&path, model.glb()).unwrap();
    let shared = SharedFile::default();
    let read = |part: &Part| shared.read_part(&path, part, &options, &Progress::default());
    let alone: Vec<(Part, RawCloud)> = io::list(&path, &options)
        .unwrap()
        .into_iter()
        .map(|entry| {
            let cloud = io::read_part(&path, &entry.part, &options).unwrap();
            (entry.part, cloud)
        })
        .collect();
    assert_eq!(read(&alone[0].0).unwrap(), alone[0].1);
    // The file is no longer needed.
    std::fs::remove_file(&path).unwrap();
    for (part, cloud) in &alone {
        assert_eq!(read(part).unwrap(), *cloud);
    }
}

#[test]
fn a_damaged_animation_fails_once() {
    let options = ReadOptions::default();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.gltf");
    // 100,000 poses, and an array that is too short for each of them.
    let mut damaged = moving("CUBICSPLINE", &[[0.0; 3], [2.0, 0.0, 0.0]]);
    let times = damaged.floats("SCALAR", &[[1.0], [3e30]]);
    damaged.json["animations"][0]["samplers"][0]["input"] = json!(times);
    std::fs::write(&path, damaged.file()).unwrap();
    let listed = io::list(&path, &options).unwrap_err().to_string();
    assert!(listed.contains("expected 3 for each"), "{listed}");
    let sequence = Sequence::open(std::slice::from_ref(&path), &OpenOptions::default()).unwrap();
    assert_eq!(sequence.len(), 1);
    let error = sequence.frame(0).unwrap_err().to_string();
    assert!(error.contains("expected 3 for each"), "{error}");
    // A reader that listed it before it was damaged gets the same error for each frame, without waiting.
    let shared = SharedFile::default();
    let time_step = |seconds| Part::TimeStep(Duration::from_secs(seconds));
    let read = |seconds| {
        let progress = Progress::default();
        let read = shared.read_part(&path, &time_step(seconds), &options, &progress);
        read.unwrap_err()
    };
    let first = read(0);
    std::fs::remove_file(&path).unwrap();
    assert!(std::sync::Arc::ptr_eq(&first, &read(1)));
}

#[test]
fn rotations_take_the_short_way_and_morphs_add_up() {
    let options = ReadOptions::default();
    let mut model = square();
    let half = 0.5f32.sqrt();
    let times = model.floats("SCALAR", &[[0.0], [1.0]]);
    // No rotation, then a quarter turn about z with the opposite sign of the same quaternion.
    let values = model.floats("VEC4", &[[0.0, 0.0, 0.0, 1.0], [0.0, 0.0, -half, -half]]);
    let deltas = model.floats("VEC3", &[[0.0, 0.0, 4.0]; 4]);
    let weights = model.floats("SCALAR", &[[0.0], [0.5], [1.0], [0.5]]);
    model.primitive()["targets"] = json!([{"POSITION": deltas}, {"POSITION": deltas}]);
    model.json["animations"] = json!([{
        "channels": [{"sampler": 0, "target": {"node": 0, "path": "rotation"}},
            {"sampler": 1, "target": {"node": 0, "path": "weights"}}],
        "samplers": [{"input": times, "output": values}, {"input": times, "output": weights}]
    }]);
    let turned = |seconds: f64| positions(&model.pose(seconds, &options))[1];
    let near = |a: [f64; 3], b: [f64; 3]| {
        assert!(DVec3::from(a).distance(DVec3::from(b)) < 1e-6, "{a:?} {b:?}");
    };
    near(turned(0.0), [1.0, 0.0, 2.0]);
    near(turned(0.5), [f64::from(half), f64::from(half), 4.0]);
    near(turned(1.0), [0.0, 1.0, 6.0]);
    model.json["animations"] = json!([]);
    model.json["meshes"][0]["weights"] = json!([0.25, 0.0]);
    near(positions(&model.read())[0], [0.0, 0.0, 1.0]);
    model.json["nodes"][0]["weights"] = json!([0.0, 1.0]);
    near(positions(&model.read())[0], [0.0, 0.0, 4.0]);
}

#[test]
fn skins_follow_their_bones() {
    let mut model = square();
    let joints = model.accessor("VEC4", 5121, 4, &[0, 1, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 9, 0, 0, 0]);
    model.primitive()["attributes"]["JOINTS_0"] = json!(joints);
    model.attribute(
        "WEIGHTS_0",
        "VEC4",
        &[
            [0.5, 0.5, 0.0, 0.0],
            [1.0, 0.0, 0.0, 0.0],
            [1.0, 1.0, 0.0, 0.0],
            [0.0; 4],
        ],
    );
    let identity: [f32; 16] = std::array::from_fn(|index| f32::from(u8::from(index % 5 == 0)));
    let mut back = identity;
    back[12] = -1.0;
    let bound = model.floats("MAT4", &[identity, back]);
    // The node of a skinned mesh does not move it; a vertex without bone weights stays with it.
    model.json["nodes"] = json!([{"mesh": 0, "skin": 0, "translation": [100.0, 0.0, 0.0]},
        {"translation": [0.0, 2.0, 0.0]}, {"translation": [5.0, 0.0, 0.0]}]);
    model.json["skins"] = json!([{"joints": [1, 2], "inverseBindMatrices": bound}]);
    assert_eq!(
        positions(&model.read()),
        [[2.0, 1.0, 0.0], [5.0, 0.0, 0.0], [2.0, 2.0, 0.0], [101.0, 1.0, 0.0]]
    );
    model.attribute("WEIGHTS_0", "VEC4", &[[1.0, 0.0, 0.0, 0.0]; 4]);
    assert!(model.refused().contains("joint 9"), "{}", model.refused());
    model.attribute("WEIGHTS_0", "VEC4", &[[1.0, 0.0, 0.0, 0.0]; 3]);
    assert!(model.refused().contains("4 positions but 3"), "{}", model.refused());
}

#[test]
fn only_files_within_the_folder_are_read() {
    let model = square();
    let folder = tempfile::tempdir().unwrap();
    let inside = folder.path().join("models");
    std::fs::create_dir_all(inside.join("a b")).unwrap();
    std::fs::write(folder.path().join("secret.bin"), &model.bytes).unwrap();
    std::fs::write(inside.join("a b").join("a.bin"), &model.bytes).unwrap();
    let path = inside.join("a.gltf");
    let read = |uri: &str| {
        std::fs::write(&path, model.with_uri(uri)).unwrap();
        io::read(&path)
            .map(|cloud| cloud.positions.len())
            .map_err(|error| error.to_string())
    };
    for uri in ["a%20b/a.bin", "a b/a.bin", "./a%20b/a.bin"] {
        assert_eq!(read(uri), Ok(4), "{uri}");
    }
    let absolute = folder.path().join("secret.bin").display().to_string();
    for uri in [
        "../secret.bin",
        "%2e%2e/secret.bin",
        "a b/../../secret.bin",
        absolute.as_str(),
        "file:///etc/passwd",
        "http://localhost/a.bin",
        "..\\secret.bin",
        "",
    ] {
        assert!(
            read(uri).unwrap_err().contains("only files in the folder"),
            "{uri}: {:?}",
            read(uri)
        );
    }
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(folder.path().join("secret.bin"), inside.join("link.bin")).unwrap();
        assert!(read("link.bin").unwrap_err().contains("only files in the folder"));
    }
    assert!(read("missing.bin").unwrap_err().contains("must be next to"));
    assert!(read("a%20b").unwrap_err().contains("not a regular file"));
    assert!(read("a%2").unwrap_err().contains("not a URI"));
    std::fs::write(inside.join("short.bin"), [0; 8]).unwrap();
    assert!(read("short.bin").unwrap_err().contains("it is truncated"));
}

#[test]
fn damaged_files_are_handled() {
    let model = moving("LINEAR", &[[2.0, 0.0, 0.0], [6.0, 0.0, 0.0]]);
    let file = model.glb();
    assert_eq!(io::read_bytes(Path::new("a.glb"), &file).unwrap(), model.read());
    let options = ReadOptions::default();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.glb");
    for length in 0..file.len() {
        let _ = io::read_bytes(Path::new("a.glb"), &file[..length]);
        for change in [0x01, 0x08, 0x80] {
            let mut damaged = file.clone();
            damaged[length] ^= change;
            let _ = io::read_bytes(Path::new("a.glb"), &damaged);
            if length % 16 == 0 {
                std::fs::write(&path, &damaged).unwrap();
                let _ = io::list(&path, &options);
            }
        }
    }
    let mut repeated = square();
    repeated.json["nodes"] = json!(vec![json!({"mesh": 0}); 100_000]);
    std::fs::write(&path, repeated.file()).unwrap();
    let error =
        io::read_part(&path, &Part::Whole, &options.with_max_memory(1 << 29)).map(|cloud| cloud.positions.len());
    assert_eq!(error.unwrap(), 400_000);
    let error = io::read_part(&path, &Part::Whole, &options.with_max_memory(1 << 26)).unwrap_err();
    assert!(error.to_string().contains("--max-memory"), "{error}");
}

#[test]
fn a_sampled_point_is_the_same_surface_point_in_every_frame() {
    let model = moving("LINEAR", &[[2.0, 0.0, 0.0], [6.0, 8.0, 0.0]]);
    let options = ReadOptions::default().with_sample_count(NonZeroUsize::new(500));
    let [first, last] = [0.0, 3.0].map(|seconds| model.pose(seconds, &options));
    assert_eq!((first.positions.len(), first.faces.len()), (500, 0));
    for (from, to) in positions(&first).into_iter().zip(positions(&last)) {
        assert!((DVec3::from(to) - DVec3::from(from)).distance(DVec3::new(4.0, 8.0, 0.0)) < 1e-6);
    }
}

/// The point of a triangle that is nearest to `point`, and its distance.
fn nearest(point: DVec3, [a, b, c]: [DVec3; 3]) -> (DVec3, f64) {
    let normal = (b - a).cross(c - a);
    let within = [(a, b), (b, c), (c, a)]
        .iter()
        .all(|&(from, to)| (to - from).cross(point - from).dot(normal) >= 0.0);
    let on_edge = |(from, to): (DVec3, DVec3)| {
        let along = to - from;
        let length = along.length_squared();
        let fraction = if length > 0.0 {
            ((point - from).dot(along) / length).clamp(0.0, 1.0)
        } else {
            0.0
        };
        from + along * fraction
    };
    let place = if within && normal.length_squared() > 0.0 {
        point - normal * ((point - a).dot(normal) / normal.length_squared())
    } else {
        [(a, b), (b, c), (c, a)]
            .map(on_edge)
            .into_iter()
            .min_by(|p, q| p.distance(point).total_cmp(&q.distance(point)))
            .unwrap()
    };
    (place, place.distance(point))
}

/// Points that another program put on the surface of each pose lie on it as this one poses the model, all of them.
#[test]
fn a_walking_man_has_the_pose_of_another_program() {
    /// One in this many points of a frame.
    const STEP: usize = 50;
    const FRAMES: [usize; 5] = [0, 5, 11, 17, 23];
    /// The man is 1.5 high: single precision rounds a position by up to 6e-8 along each axis, 1.03e-7 in all, and both
    /// a point of the sequence and the surface are rounded. The farthest of all was measured 1.3e-7 away.
    const TOLERANCE: f64 = 2.1e-7;
    let (Some(model), Some(sequence)) = (shared("models/CesiumMan.glb"), shared("sequences/cesiumman_24fps")) else {
        return;
    };
    let options = ReadOptions::default();
    let sampling = options.with_sample_count(NonZeroUsize::new(1000));
    let entries = io::list(&model, &options).unwrap();
    assert_eq!(entries.len(), 49, "two seconds");
    let mut poses: Vec<Vec<(DVec3, f64)>> = Vec::new();
    for frame in FRAMES {
        let mesh = io::read_part(&model, &entries[frame].part, &options).unwrap();
        let triangle = |face: &[u32; 3]| face.map(|corner| mesh.positions.get(corner as usize));
        let triangles: Vec<[DVec3; 3]> = mesh.faces.iter().map(triangle).collect();
        let distance = |point: DVec3| {
            let distances = triangles.iter().map(|&corners| nearest(point, corners).1);
            distances.fold(f64::INFINITY, f64::min)
        };
        let path = sequence.join(format!("frame_{frame:04}.ply"));
        let points = positions(&io::read(&path).unwrap());
        let points = points.into_iter().step_by(STEP).map(DVec3::from);
        poses.push(points.map(|point| (point, distance(point))).collect());
        // And our own samples lie on it, with texture and normals.
        let sampled = io::read_part(&model, &entries[frame].part, &sampling).unwrap();
        assert!(sampled.attributes.normals.is_some() && sampled.attributes.colors.is_some());
        for point in positions(&sampled) {
            assert!(distance(DVec3::from(point)) < TOLERANCE, "{point:?}");
        }
    }
    let farthest = poses.iter().flatten().map(|point| point.1);
    let farthest = farthest.fold(0.0, f64::max);
    let moved = poses[2].iter().zip(&poses[0]);
    let moved = moved.map(|(then, first)| then.0.distance(first.0));
    let moved = moved.fold(0.0, f64::max);
    println!(
        "{} points lie within {farthest} of the posed surface in {} frames; they moved by up to {moved}",
        poses[0].len(),
        FRAMES.len()
    );
    assert_eq!(poses[0].len(), 1000);
    assert!(farthest < TOLERANCE, "{farthest}");
    // Not moving at all would not pass.
    assert!(moved > 0.2, "{moved}");
}

#[test]
fn a_fox_is_read_with_its_external_files() {
    let Some(path) = shared("models/Fox/Fox.gltf") else {
        return;
    };
    let options = ReadOptions::default();
    let entries = io::list(&path, &options).unwrap();
    let fox = io::read_part(
        &path,
        &entries[7].part,
        &options.with_sample_count(NonZeroUsize::new(5000)),
    )
    .unwrap();
    let (finite, bounds) = fox.positions.finite_bounds();
    println!("{} frames, bounds {bounds:?}", entries.len());
    // The longest of its three animations takes 3.417 seconds.
    assert_eq!((entries.len(), finite), (83, 5000));
    let colors = fox.attributes.colors.unwrap();
    let orange = colors
        .iter()
        .filter(|[red, green, blue, _]| red > green && green > blue)
        .count();
    assert!(orange > 2500, "{orange} of 5000 points are orange");
}
