//! Materials of OBJ files: the diffuse colour of each, and the texture image that may replace it.
//!
//! Materials are in material libraries (MTL), companions of the file, read by `tobj`, and name images in the same
//! folder. Anything that cannot be read is a warning: the shape does not depend on it.

use crate::cloud::Textures;
use crate::io::codec::Encoded;
use crate::io::error::Fault;
use crate::io::files::sidecars;
use crate::io::meshes::picture;
use image::RgbaImage;
use std::collections::HashMap;
use std::path::Path;

/// Appearance of a face.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Paint {
    /// One colour: `Kd`. White where the material has none, or is missing.
    Color([u8; 4]),
    /// The image of this index in [`Materials::textures`]: `map_Kd`. `Kd`, which many programs write anyhow, does not
    /// dim it.
    Picture(u32),
}

/// Materials of a file.
#[derive(Debug, Default)]
pub(super) struct Materials {
    /// In the order of their first use.
    pub(super) paints: Vec<Paint>,
    pub(super) textures: Textures,
    pub(super) warnings: Vec<String>,
}

impl Materials {
    /// Loads the materials of `names` from the libraries of a file.
    pub(super) fn load(libraries: &[String], names: &[String], file: &Encoded<'_>) -> Result<Self, Fault> {
        let mut reading = Reading {
            file,
            left_bytes: file.options.left_bytes(),
            pictures: Vec::new(),
            numbers: HashMap::new(),
            warnings: Vec::new(),
        };
        let found = reading.libraries(libraries);
        let mut paints = Vec::with_capacity(names.len());
        for name in names {
            if file.progress.is_cancelled() {
                return Err(Fault::cancelled());
            }
            paints.push(match found.get(name) {
                Some(material) => reading.paint(material),
                None => Paint::WHITE,
            });
        }
        Ok(Self {
            paints,
            textures: Textures::of(reading.pictures),
            warnings: reading.warnings,
        })
    }
}

impl Paint {
    pub(super) const WHITE: Self = Self::Color([255; 4]);
}

/// Progress of reading the materials.
struct Reading<'a> {
    file: &'a Encoded<'a>,
    /// Remaining memory for images.
    left_bytes: u64,
    pictures: Vec<RgbaImage>,
    /// The index of each image by its name in the library; none for unreadable ones.
    numbers: HashMap<String, Option<u32>>,
    warnings: Vec<String>,
}

impl Reading<'_> {
    /// The materials of all libraries by their names.
    fn libraries(&mut self, libraries: &[String]) -> HashMap<String, tobj::Material> {
        let mut found = HashMap::new();
        for library in libraries {
            match self.library(library) {
                Ok(materials) => found.extend(materials.into_iter().map(|material| (material.name.clone(), material))),
                Err(problem) => self.warnings.push(format!("its materials are skipped: {problem}")),
            }
        }
        found
    }

    fn library(&self, name: &str) -> Result<Vec<tobj::Material>, String> {
        let bytes = self.bytes_sidecar(name)?;
        // Names in other encodings are not found; everything else is ASCII.
        let text = String::from_utf8_lossy(&bytes);
        let (materials, _) = tobj::load_mtl_buf(&mut text.as_bytes()).map_err(|error| format!("`{name}`: {error}"))?;
        Ok(materials)
    }

    fn paint(&mut self, material: &tobj::Material) -> Paint {
        if let Some(statement) = &material.diffuse_texture
            && let Some(number) = self.number_of_picture(picture_name(statement))
        {
            return Paint::Picture(number);
        }
        let byte = |channel: f32| (channel * 255.0).round() as u8;
        match material.diffuse {
            Some([red, green, blue]) => Paint::Color([byte(red), byte(green), byte(blue), 255]),
            None => Paint::WHITE,
        }
    }

    fn number_of_picture(&mut self, name: &str) -> Option<u32> {
        if let Some(&number) = self.numbers.get(name) {
            return number;
        }
        let number = match self.picture(name) {
            Ok(picture) => {
                self.left_bytes = self.left_bytes.saturating_sub(picture.as_raw().len() as u64);
                self.pictures.push(picture);
                Some(self.pictures.len() as u32 - 1)
            }
            Err(problem) => {
                self.warnings.push(format!("a texture is skipped: {problem}"));
                None
            }
        };
        self.numbers.insert(name.to_owned(), number);
        number
    }

    fn picture(&self, name: &str) -> Result<RgbaImage, String> {
        let bytes = self.bytes_sidecar(name)?;
        picture::decode(&bytes, self.left_bytes).map_err(|error| format!("`{name}`: {error}"))
    }

    /// Returns the bytes of the named file, or, if it is elsewhere, of the file next to the OBJ file with the last
    /// component of the name: programs write the paths of the machine that they ran on.
    fn bytes_sidecar(&self, name: &str) -> Result<Vec<u8>, String> {
        let read = |name: &str| sidecars::read(name, self.file.name, self.left_bytes, self.file.options);
        let name = name.replace('\\', "/");
        read(&name).or_else(
            |problem| match Path::new(&name).file_name().and_then(|last| last.to_str()) {
                Some(last) if last != name => read(last).map_err(|_| problem),
                _ => Err(problem),
            },
        )
    }
}

/// The name of a file in a statement that may have options before it, such as `-s 1 1 1`.
fn picture_name(statement: &str) -> &str {
    let mut rest = statement.trim();
    while let Some(option) = rest.strip_prefix('-') {
        let (option, behind) = option.split_once(char::is_whitespace).unwrap_or((option, ""));
        // `-mm` has two arguments; those that are triples may have fewer, all of them numbers.
        let max_arguments = match option {
            "o" | "s" | "t" => 3,
            "mm" => 2,
            _ => 1,
        };
        rest = behind.trim_start();
        for taken in 0..max_arguments {
            let Some((argument, behind)) = rest.split_once(char::is_whitespace) else {
                break;
            };
            if taken > 0 && argument.parse::<f32>().is_err() {
                break;
            }
            rest = behind.trim_start();
        }
    }
    rest
}

#[cfg(test)]
mod tests {
    use super::picture_name;

    #[test]
    fn options_precede_the_texture_file_name() {
        for statement in [
            "a b.png",
            " -s 1 1 1 a b.png ",
            "-s 2 a b.png",
            "-o 0.5 0 a b.png",
            "-clamp on -mm 0 1 a b.png",
            "-blendu off -bm 0.2 a b.png",
        ] {
            assert_eq!(picture_name(statement), "a b.png", "{statement}");
        }
        assert_eq!(picture_name("-s"), "");
    }
}
