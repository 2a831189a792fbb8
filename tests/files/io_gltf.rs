//! glTF files and the files that they name: in their folder, outside it, missing or damaged.

#![allow(clippy::print_stdout, reason = "what was compared is for who runs the test")]

use crate::data::shared;
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use pointreel::cloud::RawCloud;
use pointreel::io::{self, Part, ReadOptions};
use serde_json::{Value, json};
use std::num::NonZeroUsize;
use std::path::Path;
use std::time::Duration;

pub(crate) fn positions(cloud: &RawCloud) -> Vec<[f64; 3]> {
    (0..cloud.positions.len())
        .map(|index| cloud.positions.get(index).to_array())
        .collect()
}

/// A document whose arrays are made one by one; each gets an accessor and a view of its own.
pub(crate) struct Model {
    pub(crate) json: Value,
    bytes: Vec<u8>,
}

impl Model {
    pub(crate) fn new() -> Self {
        Self {
            json: json!({"asset": {"version": "2.0"}, "accessors": [], "bufferViews": [],
                "meshes": [{"primitives": [{"attributes": {}}]}], "nodes": [{"mesh": 0}]}),
            bytes: Vec::new(),
        }
    }

    pub(crate) fn view(&mut self, bytes: &[u8]) -> usize {
        let views = self.json["bufferViews"].as_array_mut().unwrap();
        views.push(json!({"buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len()}));
        self.bytes.extend(bytes);
        views.len() - 1
    }

    pub(crate) fn accessor(&mut self, kind: &str, component: u32, count: usize, bytes: &[u8]) -> usize {
        let view = self.view(bytes);
        let accessors = self.json["accessors"].as_array_mut().unwrap();
        accessors.push(json!({"bufferView": view, "componentType": component, "count": count, "type": kind}));
        accessors.len() - 1
    }

    pub(crate) fn floats<const N: usize>(&mut self, kind: &str, values: &[[f32; N]]) -> usize {
        let bytes: Vec<u8> = values.iter().flatten().flat_map(|value| value.to_le_bytes()).collect();
        self.accessor(kind, 5126, values.len(), &bytes)
    }

    pub(crate) fn attribute<const N: usize>(&mut self, name: &str, kind: &str, values: &[[f32; N]]) {
        let accessor = self.floats(kind, values);
        self.primitive()["attributes"][name] = json!(accessor);
    }

    pub(crate) fn primitive(&mut self) -> &mut Value {
        &mut self.json["meshes"][0]["primitives"][0]
    }

    /// With the bytes in a `data:` URI.
    pub(crate) fn file(&self) -> Vec<u8> {
        let uri = format!("data:application/octet-stream;base64,{}", STANDARD.encode(&self.bytes));
        self.with_uri(&uri)
    }

    fn with_uri(&self, uri: &str) -> Vec<u8> {
        let mut json = self.json.clone();
        json["buffers"] = json!([{"byteLength": self.bytes.len(), "uri": uri}]);
        json.to_string().into_bytes()
    }

    pub(crate) fn glb(&self) -> Vec<u8> {
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

    pub(crate) fn read(&self) -> RawCloud {
        io::read_bytes(Path::new("a.gltf"), &self.file()).unwrap_or_else(|error| panic!("{error}"))
    }

    pub(crate) fn refused(&self) -> String {
        io::read_bytes(Path::new("a.gltf"), &self.file())
            .unwrap_err()
            .to_string()
    }

    /// At `seconds`.
    pub(crate) fn pose(&self, seconds: f64, options: &ReadOptions) -> RawCloud {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.gltf");
        std::fs::write(&path, self.file()).unwrap();
        io::read_part(&path, &Part::TimeStep(Duration::from_secs_f64(seconds)), options)
            .unwrap_or_else(|error| panic!("{error}"))
    }
}

pub(crate) const CORNERS: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]];

pub(crate) fn square() -> Model {
    let mut model = Model::new();
    model.attribute("POSITION", "VEC3", &CORNERS);
    let indices = model.accessor("SCALAR", 5123, 6, &[0, 0, 1, 0, 2, 0, 2, 0, 1, 0, 3, 0]);
    model.primitive()["indices"] = json!(indices);
    model
}

/// Node 0 moved along x by keys at 1 and 3 seconds.
pub(crate) fn moving(interpolation: &str, keys: &[[f32; 3]]) -> Model {
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
