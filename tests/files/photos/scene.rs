//! A scene whose projections are known without the code that is tested, and writers of it in every format.

use glam::{DMat3, DVec2, DVec3};
use image::RgbImage;
use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

/// Images around a cloud of points. Cameras have x right, y down, z forward; centres of pixels are at integers.
pub(crate) struct Scene {
    pub(crate) size_px: [u32; 2],
    pub(crate) focal_px: DVec2,
    pub(crate) principal_px: DVec2,
    pub(crate) k: [f64; 2],
    /// World to camera.
    pub(crate) poses: Vec<(DMat3, DVec3)>,
    pub(crate) points: Vec<DVec3>,
}

impl Scene {
    /// One that every format can hold: one focal length, the principal point at the centre, no distortion.
    pub(crate) fn simple() -> Self {
        let size_px = [64, 48];
        let pose = |index: usize| {
            let turn = 0.8 * index as f64;
            let center = DVec3::new(4.0 * turn.sin(), 0.7 - 0.3 * index as f64, -4.0 * turn.cos());
            let forward = -center.normalize();
            let right = DVec3::new(0.1, 1.0, 0.05).cross(forward).normalize();
            let down = forward.cross(right);
            let world_from_camera = DMat3::from_cols(right, down, forward);
            (world_from_camera.transpose(), -(world_from_camera.transpose() * center))
        };
        let point = |index: usize| {
            let (a, b) = (0.37 * TAU * index as f64, (1.7 * index as f64).sin());
            DVec3::new(0.5 * a.cos(), 0.8 * b, 0.5 * a.sin())
        };
        Self {
            size_px,
            focal_px: DVec2::splat(90.0),
            principal_px: DVec2::new(31.5, 23.5),
            k: [0.0; 2],
            poses: (0..6).map(pose).collect(),
            points: (0..40).map(point).collect(),
        }
    }

    /// Two focal lengths, and a principal point that is off the centre.
    pub(crate) fn off_center() -> Self {
        Self {
            focal_px: DVec2::new(90.0, 84.0),
            principal_px: DVec2::new(36.25, 20.125),
            ..Self::simple()
        }
    }

    /// A lens that bends.
    pub(crate) fn distorted() -> Self {
        Self {
            k: [-0.12, 0.03],
            ..Self::simple()
        }
    }

    /// The pixel at which an image shows a point of the world; not finite where either is not.
    pub(crate) fn pixel(&self, photo: usize, point: DVec3) -> DVec2 {
        let (turn, shift) = self.poses[photo];
        let at = turn * point + shift;
        assert!(
            at.z > 0.0 || !at.is_finite(),
            "the points of the scene are before its cameras"
        );
        let at = DVec2::new(at.x / at.z, at.y / at.z);
        let r2 = at.x * at.x + at.y * at.y;
        self.focal_px * at * (1.0 + self.k[0] * r2 + self.k[1] * r2 * r2) + self.principal_px
    }

    pub(crate) fn center(&self, photo: usize) -> DVec3 {
        let (turn, shift) = self.poses[photo];
        -(turn.transpose() * shift)
    }

    fn color(point: usize) -> [u8; 3] {
        [point as u8, 100, 255 - point as u8]
    }

    pub(crate) fn name(photo: usize) -> String {
        format!("view_{photo:02}.png")
    }

    /// Images, each of a colour of its own.
    pub(crate) fn write_photos(&self, folder: &Path) {
        fs::create_dir_all(folder).unwrap();
        for photo in 0..self.poses.len() {
            let [width, height] = self.size_px;
            let color = image::Rgb([photo as u8 * 40, 128, 64]);
            RgbImage::from_pixel(width, height, color)
                .save(folder.join(Self::name(photo)))
                .unwrap();
        }
    }

    /// Rotation of an image as w x y z.
    fn quaternion(&self, photo: usize) -> [f64; 4] {
        let quaternion = glam::DQuat::from_mat3(&self.poses[photo].0);
        [quaternion.w, quaternion.x, quaternion.y, quaternion.z]
    }

    fn colmap_camera(&self) -> (i32, &'static str, Vec<f64>) {
        let DVec2 { x: fx, y: fy } = self.focal_px;
        let (cx, cy) = (self.principal_px.x + 0.5, self.principal_px.y + 0.5);
        if self.k == [0.0; 2] {
            (1, "PINHOLE", vec![fx, fy, cx, cy])
        } else {
            (3, "RADIAL", vec![fx, cx, cy, self.k[0], self.k[1]])
        }
    }

    /// Point `index` is feature `index` of each image. Rows are written backwards, as no order is promised.
    pub(crate) fn write_colmap_text(&self, folder: &Path) {
        let model = folder.join("sparse/0");
        fs::create_dir_all(&model).unwrap();
        self.write_photos(&folder.join("images"));
        let (_, name, numbers) = self.colmap_camera();
        let [width, height] = self.size_px;
        let cameras = format!("# cameras\n7 {name} {width} {height} {}\n", words(&numbers));
        fs::write(model.join("cameras.txt"), cameras).unwrap();
        let mut images = "# images\n#   two lines each\n".to_owned();
        for photo in (0..self.poses.len()).rev() {
            let (quaternion, shift) = (self.quaternion(photo), self.poses[photo].1.to_array());
            let (quaternion, shift, name) = (words(&quaternion), words(&shift), Self::name(photo));
            writeln!(images, "{} {quaternion} {shift} 7 {name}", photo + 10).unwrap();
            for (index, &point) in self.points.iter().enumerate() {
                let pixel = self.pixel(photo, point) + 0.5;
                write!(images, "{} {} {} ", pixel.x, pixel.y, index + 500).unwrap();
            }
            images.push('\n');
        }
        fs::write(model.join("images.txt"), images).unwrap();
        let mut points = "# points\n".to_owned();
        for (index, point) in self.points.iter().enumerate() {
            let [r, g, b] = Self::color(index);
            write!(points, "{} {} {r} {g} {b} 0.25", index + 500, words(&point.to_array())).unwrap();
            for photo in 0..self.poses.len() {
                write!(points, " {} {index}", photo + 10).unwrap();
            }
            points.push('\n');
        }
        fs::write(model.join("points3D.txt"), points).unwrap();
    }

    pub(crate) fn write_colmap_binary(&self, folder: &Path) {
        let model = folder.join("sparse");
        fs::create_dir_all(&model).unwrap();
        self.write_photos(&folder.join("images"));
        let (number, _, numbers) = self.colmap_camera();
        let mut cameras = Vec::new();
        cameras.extend(1_u64.to_le_bytes());
        cameras.extend(7_u32.to_le_bytes());
        cameras.extend(number.to_le_bytes());
        cameras.extend(self.size_px.map(u64::from).map(u64::to_le_bytes).concat());
        cameras.extend(doubles(&numbers));
        fs::write(model.join("cameras.bin"), cameras).unwrap();
        let mut images = (self.poses.len() as u64).to_le_bytes().to_vec();
        for photo in (0..self.poses.len()).rev() {
            images.extend((photo as u32 + 10).to_le_bytes());
            images.extend(doubles(&self.quaternion(photo)));
            images.extend(doubles(&self.poses[photo].1.to_array()));
            images.extend(7_u32.to_le_bytes());
            images.extend(Self::name(photo).as_bytes());
            images.push(0);
            images.extend((self.points.len() as u64).to_le_bytes());
            for (index, &point) in self.points.iter().enumerate() {
                images.extend(doubles(&(self.pixel(photo, point) + 0.5).to_array()));
                images.extend((index as u64 + 500).to_le_bytes());
            }
        }
        fs::write(model.join("images.bin"), images).unwrap();
        let mut points = (self.points.len() as u64).to_le_bytes().to_vec();
        for (index, point) in self.points.iter().enumerate() {
            points.extend((index as u64 + 500).to_le_bytes());
            points.extend(doubles(&point.to_array()));
            points.extend(Self::color(index));
            points.extend(doubles(&[0.25]));
            points.extend((self.poses.len() as u64).to_le_bytes());
            for photo in 0..self.poses.len() {
                points.extend((photo as u32 + 10).to_le_bytes());
                points.extend((index as u32).to_le_bytes());
            }
        }
        fs::write(model.join("points3D.bin"), points).unwrap();
    }

    /// Cameras look along −z with y up; keys are relative to the centre of the image, y up.
    pub(crate) fn write_bundler(&self, folder: &Path) {
        self.write_photos(folder);
        let (cameras, points) = (self.poses.len(), self.points.len());
        let mut bundle = format!("# Bundle file v0.3\n{cameras} {points}\n");
        let mut list = String::new();
        for photo in 0..cameras {
            let (turn, shift) = self.poses[photo];
            let [x, y, z] = [turn.row(0), -turn.row(1), -turn.row(2)].map(|row| words(&row.to_array()));
            let shift = words(&[shift.x, -shift.y, -shift.z]);
            let [k1, k2] = self.k;
            writeln!(bundle, "{} {k1} {k2}\n{x}\n{y}\n{z}\n{shift}", self.focal_px.x).unwrap();
            writeln!(list, "./{} 0 {}", Self::name(photo), self.focal_px.x).unwrap();
        }
        for (index, &point) in self.points.iter().enumerate() {
            let track: Vec<String> = (0..cameras)
                .map(|photo| {
                    let pixel = self.offset_from_center(photo, point);
                    format!("{photo} {index} {} {}", pixel.x, -pixel.y)
                })
                .collect();
            let (position, color) = (words(&point.to_array()), Self::color(index).map(f64::from));
            writeln!(bundle, "{position}\n{}\n{cameras} {}", words(&color), track.join(" ")).unwrap();
        }
        fs::write(folder.join("bundle.out"), bundle).unwrap();
        fs::write(folder.join("list.txt"), list).unwrap();
    }

    fn offset_from_center(&self, photo: usize, point: DVec3) -> DVec2 {
        let [width, height] = self.size_px;
        self.pixel(photo, point) - 0.5 * DVec2::new(f64::from(width) - 1.0, f64::from(height) - 1.0)
    }

    /// With a fixed calibration where one focal length and the centre are not enough.
    pub(crate) fn write_nvm(&self, folder: &Path) {
        self.write_photos(folder);
        let [width, height] = self.size_px;
        let midpoint = 0.5 * DVec2::new(f64::from(width) - 1.0, f64::from(height) - 1.0);
        let is_simple = self.principal_px == midpoint && self.focal_px.x == self.focal_px.y;
        let mut nvm = "NVM_V3".to_owned();
        if !is_simple {
            let (focal, principal) = (self.focal_px, self.principal_px + 0.5);
            write!(nvm, " FixedK {} {} {} {}", focal.x, principal.x, focal.y, principal.y).unwrap();
        }
        writeln!(nvm, "\n\n{}", self.poses.len()).unwrap();
        for photo in 0..self.poses.len() {
            let (quaternion, center) = (words(&self.quaternion(photo)), words(&self.center(photo).to_array()));
            let (name, focal) = (Self::name(photo), self.focal_px.x);
            writeln!(nvm, "C:\\photos\\{name}\t{focal} {quaternion} {center} 0 0").unwrap();
        }
        writeln!(nvm, "\n{}", self.points.len()).unwrap();
        for (index, &point) in self.points.iter().enumerate() {
            let color = words(&Self::color(index).map(f64::from));
            write!(nvm, "{} {color} {}", words(&point.to_array()), self.poses.len()).unwrap();
            for photo in 0..self.poses.len() {
                let pixel = self.pixel(photo, point) - self.principal_px;
                write!(nvm, " {photo} {index} {} {}", pixel.x, pixel.y).unwrap();
            }
            nvm.push('\n');
        }
        // Images that were not placed, and the end of the models.
        nvm.push_str(
            "1\nlost.png 50 1 0 0 0 0 0 0 0 0\n0\n\n0\n\n#the last part of NVM file points to the PLY files\n0\n",
        );
        fs::write(folder.join("scan.nvm"), nvm).unwrap();
    }

    /// Of the versions whose numbers differ: 1.0.0, 1.2.0, 1.2.1, 1.2.4, 1.2.6 and 1.2.11.
    pub(crate) fn write_meshroom(&self, folder: &Path, version: [u32; 3]) {
        self.write_photos(&folder.join("images"));
        let [width, height] = self.size_px;
        let half = 0.5 * DVec2::new(f64::from(width), f64::from(height));
        let pixels = if version < [1, 2, 1] {
            self.principal_px
        } else {
            self.principal_px - half
        };
        let text = |number: f64| number.to_string();
        let texts = |numbers: &[f64]| numbers.iter().copied().map(text).collect::<Vec<_>>();
        let mut intrinsic = serde_json::json!({
            "intrinsicId": "99",
            "width": width.to_string(),
            "height": height.to_string(),
            "type": "radial3",
            "principalPoint": texts(&pixels.to_array()),
            "distortionParams": texts(&[self.k[0], self.k[1], 0.0]),
        });
        let ratio = self.focal_px.x / self.focal_px.y;
        let sensor_mm = 23.5;
        let mut set = |key: &str, value: serde_json::Value| intrinsic[key] = value;
        match version {
            [1, 0 | 1, _] => set("pxFocalLength", text(self.focal_px.x).into()),
            [1, 2, 0 | 1] => set("pxFocalLength", texts(&self.focal_px.to_array()).into()),
            _ => {
                let focal_px = if version < [1, 2, 11] {
                    self.focal_px.x
                } else {
                    self.focal_px.y
                };
                set("focalLength", text(focal_px * sensor_mm / f64::from(width)).into());
                set("sensorWidth", text(sensor_mm).into());
                set(
                    "pixelRatio",
                    text(if version < [1, 2, 5] { ratio } else { 1.0 / ratio }).into(),
                );
            }
        }
        let mut views = Vec::new();
        let mut poses = Vec::new();
        for photo in 0..self.poses.len() {
            let id = (photo + 1000).to_string();
            let path = format!("/home/somebody/images/{}", Self::name(photo));
            views.push(serde_json::json!({"viewId": id, "poseId": id, "intrinsicId": "99", "path": path}));
            // World to camera, column by column.
            let rotation = texts(&self.poses[photo].0.to_cols_array());
            let center = texts(&self.center(photo).to_array());
            let transform = serde_json::json!({"rotation": rotation, "center": center});
            poses.push(serde_json::json!({"poseId": id, "pose": {"transform": transform, "locked": "0"}}));
        }
        views.push(serde_json::json!({"viewId": "1", "poseId": "1", "intrinsicId": "99", "path": "unplaced.png"}));
        let structure: Vec<serde_json::Value> = (self.points.iter().enumerate())
            .map(|(index, &point)| {
                let seen: Vec<serde_json::Value> = (0..self.poses.len())
                    .map(|photo| {
                        let x = texts(&self.pixel(photo, point).to_array());
                        let id = (photo + 1000).to_string();
                        serde_json::json!({"observationId": id, "featureId": index.to_string(), "x": x})
                    })
                    .collect();
                let color = texts(&Self::color(index).map(f64::from));
                serde_json::json!({"X": texts(&point.to_array()), "color": color, "observations": seen})
            })
            .collect();
        let scene = serde_json::json!({
            "version": version.map(|part| part.to_string()),
            "views": views,
            "intrinsics": [intrinsic],
            "poses": poses,
            "structure": structure,
        });
        fs::write(folder.join("sfm.json"), scene.to_string()).unwrap();
    }

    pub(crate) fn write_middlebury(&self, folder: &Path) {
        self.write_photos(folder);
        let mut par = format!("{}\n", self.poses.len());
        let (focal, principal) = (self.focal_px, self.principal_px);
        let calibration = words(&[focal.x, 0.0, principal.x, 0.0, focal.y, principal.y, 0.0, 0.0, 1.0]);
        for (photo, (turn, shift)) in self.poses.iter().enumerate() {
            let (turn, shift) = (words(&turn.transpose().to_cols_array()), words(&shift.to_array()));
            writeln!(par, "{} {calibration} {turn} {shift}", Self::name(photo)).unwrap();
        }
        fs::write(folder.join("scene_par.txt"), par).unwrap();
    }

    /// Cameras have y up and z backward; names lack their extension.
    pub(crate) fn write_transforms(&self, folder: &Path) {
        self.write_photos(&folder.join("images"));
        let frames: Vec<serde_json::Value> = (0..self.poses.len())
            .map(|photo| {
                let axes = self.poses[photo].0.transpose();
                let (x, y, z, c) = (axes.x_axis, -axes.y_axis, -axes.z_axis, self.center(photo));
                let row = |at: usize| [x[at], y[at], z[at], c[at]];
                let name = format!("./images/{}", Self::name(photo).trim_end_matches(".png"));
                let matrix = [row(0), row(1), row(2), [0.0, 0.0, 0.0, 1.0]];
                serde_json::json!({"file_path": name, "transform_matrix": matrix})
            })
            .collect();
        let file = serde_json::json!({
            "fl_x": self.focal_px.x, "fl_y": self.focal_px.y,
            "cx": self.principal_px.x + 0.5, "cy": self.principal_px.y + 0.5,
            "w": self.size_px[0], "h": self.size_px[1],
            "k1": self.k[0], "k2": self.k[1], "p1": 0.0, "p2": 0.0,
            "aabb_scale": 16,
            "frames": frames,
        });
        fs::write(folder.join("transforms.json"), file.to_string()).unwrap();
    }

    /// In the folder `below` the images' one; lengths are fractions of the longer side, relative to the centre.
    pub(crate) fn write_opensfm(&self, folder: &Path, below: &str) {
        self.write_photos(&folder.join("images"));
        let longer = f64::from(self.size_px[0].max(self.size_px[1]));
        let midpoint = 0.5 * DVec2::new(f64::from(self.size_px[0]), f64::from(self.size_px[1]));
        let parts = |pixel: DVec2| ((pixel + 0.5 - midpoint) / longer).to_array();
        let [c_x, c_y] = parts(self.principal_px);
        let camera = serde_json::json!({
            "projection_type": "brown", "width": self.size_px[0], "height": self.size_px[1],
            "focal_x": self.focal_px.x / longer, "focal_y": self.focal_px.y / longer, "c_x": c_x, "c_y": c_y,
            "k1": self.k[0], "k2": self.k[1], "k3": 0.0, "p1": 0.0, "p2": 0.0,
        });
        let mut shots = serde_json::Map::new();
        let mut tracks = "OPENSFM_TRACKS_VERSION_v2\n".to_owned();
        for (photo, (turn, shift)) in self.poses.iter().enumerate() {
            let rotation = glam::DQuat::from_mat3(turn).to_scaled_axis();
            let shot = serde_json::json!({
                "camera": "v2 c", "rotation": rotation.to_array(), "translation": shift.to_array(), "orientation": 1,
            });
            shots.insert(Self::name(photo), shot);
            for (index, &point) in self.points.iter().enumerate() {
                let ([x, y], [r, g, b]) = (parts(self.pixel(photo, point)), Self::color(index));
                let (name, id) = (Self::name(photo), index + 1000);
                writeln!(tracks, "{name}\t{id}\t{index}\t{x}\t{y}\t0.01\t{r}\t{g}\t{b}\t-1\t-1").unwrap();
            }
        }
        let points: serde_json::Map<String, serde_json::Value> = (self.points.iter().enumerate())
            .map(|(index, point)| {
                let color = Self::color(index).map(f64::from);
                let point = serde_json::json!({"coordinates": point.to_array(), "color": color});
                ((index + 1000).to_string(), point)
            })
            .collect();
        let file = serde_json::json!([{"cameras": {"v2 c": camera}, "shots": shots, "points": points}]);
        let folder = folder.join(below);
        fs::create_dir_all(&folder).unwrap();
        fs::write(folder.join("reconstruction.json"), file.to_string()).unwrap();
        fs::write(folder.join("tracks.csv"), tracks).unwrap();
    }

    /// Rows in the order of names; the axes of cameras are down, right, backward. The header is padded as numpy does.
    pub(crate) fn write_llff(&self, folder: &Path) {
        self.write_photos(&folder.join("images"));
        let mut numbers = Vec::new();
        for (photo, (turn, _)) in self.poses.iter().enumerate() {
            let axes = turn.transpose();
            let (down, right, backward, c) = (axes.y_axis, axes.x_axis, -axes.z_axis, self.center(photo));
            let of_image = [f64::from(self.size_px[1]), f64::from(self.size_px[0]), self.focal_px.x];
            for row in 0..3 {
                numbers.extend([down[row], right[row], backward[row], c[row], of_image[row]]);
            }
            numbers.extend([1.2, 9.5]);
        }
        let header = format!(
            "{{'descr': '<f8', 'fortran_order': False, 'shape': ({}, 17), }}",
            self.poses.len()
        );
        let header = format!("{header:<117}\n");
        let length = (header.len() as u16).to_le_bytes();
        let bytes = [&b"\x93NUMPY\x01\0"[..], &length, header.as_bytes(), &doubles(&numbers)].concat();
        fs::write(folder.join("poses_bounds.npy"), bytes).unwrap();
    }
}

fn words(numbers: &[f64]) -> String {
    numbers.iter().map(f64::to_string).collect::<Vec<_>>().join(" ")
}

fn doubles(numbers: &[f64]) -> Vec<u8> {
    numbers.iter().flat_map(|number| number.to_le_bytes()).collect()
}
