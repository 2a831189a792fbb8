//! OBJ of Wavefront: one statement per line; vertices, normals, and faces that name them by number.
//!
//! Read here rather than by a crate: the available ones drop vertices that no face names, which are all of them where
//! an OBJ file is a cloud, and retain single precision only. Colours follow the coordinates of a vertex, or are in the
//! material of a face (`materials.rs`), which may have a texture (`surface.rs`).

mod counts;
mod materials;
mod numbering;
mod surface;
#[cfg(test)]
mod tests;

use crate::cloud::{Positions, RawCloud};
use crate::io::codec::Encoded;
use crate::io::columns::numbers::{parse_number, quoted};
use crate::io::error::{Fault, Place};
use crate::io::format::{Format, Traits};
use crate::io::meshes::broken_faces::BrokenFaces;
use counts::Counts;
use numbering::resolve;
use surface::Corners;

/// Wavefront OBJ.
pub(in crate::io) const FORMAT: Format = Format::new(&Traits {
    name: "OBJ",
    extensions: &["obj"],
    is_for_meshes: true,
    ..Traits::PLAIN
});

/// Lines between two checks for cancellation.
const LINES_AT_ONCE: usize = 1 << 14;

pub(in crate::io) fn decode(file: &Encoded<'_>) -> Result<RawCloud, Fault> {
    let Encoded { bytes, progress, .. } = *file;
    progress.set(0, bytes.len());
    let mut done = 0;
    let counts = Counts::of(bytes);
    let options = file.options.holding(counts.claim(file.options)?);
    let mut model = Model::with_capacity(&counts);
    // A backslash at the end of a line continues it on the next one.
    let mut joined: Vec<u8> = Vec::new();
    for (index, line) in bytes.split(|&byte| byte == b'\n').enumerate() {
        done += line.len() + 1;
        if index % LINES_AT_ONCE == 0 {
            if progress.is_cancelled() {
                return Err(Fault::cancelled());
            }
            progress.set(done, bytes.len());
        }
        let line = line.trim_ascii();
        if let Some(start) = line.strip_suffix(b"\\") {
            joined.extend(start);
            joined.push(b' ');
        } else if joined.is_empty() {
            model.statement(line, index + 1)?;
        } else {
            joined.extend(line);
            model.statement(&joined, index + 1)?;
            joined.clear();
        }
    }
    progress.set(bytes.len(), bytes.len());
    model.into_cloud(&Encoded {
        options: &options,
        ..*file
    })
}

#[derive(Default)]
struct Model {
    positions: Vec<[f64; 3]>,
    /// One a vertex, white where a vertex has none.
    colors: Vec<[f64; 3]>,
    has_colors: bool,
    normals: Vec<[f32; 3]>,
    /// Sum of the normals at the corners that are each vertex.
    vertex_normals: Vec<[f32; 3]>,
    has_normals: bool,
    faces: Vec<[u32; 3]>,
    polygon: Vec<u32>,
    corners: Corners,
    broken: BrokenFaces,
}

impl Model {
    /// An empty model whose lists need not grow.
    fn with_capacity(counts: &Counts) -> Self {
        Self {
            positions: Vec::with_capacity(counts.vertices),
            colors: Vec::with_capacity(counts.vertices),
            normals: Vec::with_capacity(counts.normals),
            faces: Vec::with_capacity(counts.triangles),
            corners: Corners::with_capacity(counts),
            ..Self::default()
        }
    }

    fn statement(&mut self, line: &[u8], number: usize) -> Result<(), Fault> {
        let mut words = line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
        match words.next() {
            Some(b"v") => self.vertex(words, number),
            Some(b"vn") => {
                let (normal, count) = numbers::<3>(words, number)?;
                if count < 3 {
                    return Err(too_few("normal", count, number));
                }
                self.normals.push(normal.map(|axis| axis as f32));
                Ok(())
            }
            Some(b"vt") => {
                let (place, count) = numbers::<2>(words, number)?;
                if count == 0 {
                    return Err(Fault::new(Place::Line(number), "the texture coordinate has no number"));
                }
                self.corners.push_place(place);
                Ok(())
            }
            Some(b"f" | b"fo") => {
                let fault = self.face(words, number).err();
                self.broken.count(fault);
                Ok(())
            }
            Some(keyword @ (b"usemtl" | b"mtllib")) => {
                let name = String::from_utf8_lossy(line[keyword.len()..].trim_ascii());
                match keyword {
                    b"usemtl" => self.corners.use_material(&name, self.faces.len()),
                    _ => self.corners.add_library(&name),
                }
                Ok(())
            }
            // Groups, lines, curves and comments.
            _ => Ok(()),
        }
    }

    fn vertex<'a>(&mut self, words: impl Iterator<Item = &'a [u8]>, number: usize) -> Result<(), Fault> {
        let (values, count) = numbers::<7>(words, number)?;
        if count < 3 {
            return Err(too_few("vertex", count, number));
        }
        self.positions.push([values[0], values[1], values[2]]);
        // Four numbers are coordinates and a weight, seven have the weight before the colour.
        let color = match count {
            6 => Some([values[3], values[4], values[5]]),
            7 => Some([values[4], values[5], values[6]]),
            _ => None,
        };
        self.has_colors |= color.is_some();
        self.colors.push(color.unwrap_or([f64::NAN; 3]));
        Ok(())
    }

    /// Adds the triangles of a face; none where it names a vertex that is not there.
    fn face<'a>(&mut self, words: impl Iterator<Item = &'a [u8]>, number: usize) -> Result<(), Fault> {
        self.polygon.clear();
        self.corners.start_polygon();
        for word in words {
            if word.starts_with(b"#") {
                break;
            }
            let mut parts = word.split(|&byte| byte == b'/');
            let vertex = parts.next().unwrap_or_default();
            let index = resolve(vertex, self.positions.len()).ok_or_else(|| {
                Fault::new(
                    Place::Line(number),
                    format!(
                        "the face names vertex {}, but there are {} before it, counted from 1: the file is damaged",
                        quoted(vertex),
                        self.positions.len()
                    ),
                )
            })?;
            self.polygon.push(index as u32);
            let place = parts.next().unwrap_or_default();
            self.corners.push_corner(place);
            let normal = parts.next().filter(|normal| !normal.is_empty());
            if let Some(normal) = normal.and_then(|normal| resolve(normal, self.normals.len())) {
                self.vertex_normals.resize(self.positions.len(), [0.0; 3]);
                self.has_normals = true;
                for (sum, axis) in self.vertex_normals[index].iter_mut().zip(self.normals[normal]) {
                    *sum += axis;
                }
            }
        }
        crate::io::meshes::mesh::fan(&self.polygon, &mut self.faces);
        self.corners.end_polygon();
        Ok(())
    }

    fn into_cloud(mut self, file: &Encoded<'_>) -> Result<RawCloud, Fault> {
        if self.positions.is_empty() {
            return Err(Fault::new(Place::Line(1), "missing vertices: expected lines `v x y z`"));
        }
        let count = self.positions.len();
        let mut cloud = RawCloud::from_positions(Positions::F64(self.positions));
        if self.has_colors {
            cloud.attributes.colors = Some(colors(&self.colors));
        }
        if self.has_normals {
            self.vertex_normals.resize(count, [0.0; 3]);
            cloud.attributes.normals = Some(self.vertex_normals);
        } else if self.normals.len() == count && self.faces.is_empty() {
            // A cloud with a normal for each point.
            cloud.attributes.normals = Some(self.normals);
        }
        self.broken.put_into(self.faces, &mut cloud);
        self.corners.put_on(&mut cloud, file)?;
        Ok(cloud)
    }
}

/// Fractions, as the format is commonly used, or numbers to 255 where there are larger ones; vertices without a colour
/// are white.
fn colors(colors: &[[f64; 3]]) -> Vec<[u8; 4]> {
    let largest = colors.iter().flatten().copied().fold(0.0, f64::max);
    let scale = if largest > 1.0 { 1.0 } else { 255.0 };
    let byte = |value: f64| {
        if value.is_nan() {
            255
        } else {
            (value * scale).round() as u8
        }
    };
    colors
        .iter()
        .map(|&[red, green, blue]| [byte(red), byte(green), byte(blue), 255])
        .collect()
}

/// Up to `N` numbers, and how many there are.
fn numbers<'a, const N: usize>(words: impl Iterator<Item = &'a [u8]>, line: usize) -> Result<([f64; N], usize), Fault> {
    let mut values = [0.0; N];
    let mut count = 0;
    for word in words.take_while(|word| !word.starts_with(b"#")).take(N) {
        values[count] = parse_number(word)
            .ok_or_else(|| Fault::new(Place::Line(line), format!("found {}, expected a number", quoted(word))))?;
        count += 1;
    }
    Ok((values, count))
}

fn too_few(what: &str, count: usize, line: usize) -> Fault {
    Fault::new(Place::Line(line), format!("the {what} has {count} numbers, expected 3"))
}
