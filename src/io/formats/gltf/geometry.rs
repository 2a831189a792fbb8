//! The vertices and triangles of all shapes that the scene shows, where its nodes put them.

use super::accessor::AccessorSource;
use super::animation::NodePose;
use super::document::{Document, Mesh, Node, Primitive, at};
use super::nodes::PlacedNodes;
use crate::io::error::Fault;
use crate::io::meshes::mesh::{fan, strip};
use glam::{DAffine3, DMat3, DVec3};

/// Bytes that a vertex takes while it is read, and a triangle.
const VERTEX_BYTES: u64 = 128;
const FACE_BYTES: u64 = 12;

/// Bytes of a vertex index.
const INDEX_BYTES: u64 = 4;

/// Scene geometry, vertex by vertex.
#[derive(Default)]
pub(super) struct Geometry {
    pub(super) positions: Vec<DVec3>,
    /// Zeros where a shape has none.
    pub(super) normals: Vec<[f32; 3]>,
    pub(super) has_normals: bool,
    /// Linear light; white where a shape has none.
    pub(super) colors: Vec<[f32; 4]>,
    pub(super) has_colors: bool,
    /// Texture coordinates of each vertex in the texture of its material.
    pub(super) texture_places: Vec<[f32; 2]>,
    /// Material of each vertex.
    pub(super) materials: Vec<Option<usize>>,
    /// Attributes of the application, whose names begin with an underscore; NaN where a shape has none.
    pub(super) fields: Vec<(String, Vec<f64>)>,
    pub(super) faces: Vec<[u32; 3]>,
}

/// Everything that the scene shows.
pub(super) fn gather(
    source: &AccessorSource<'_>,
    placed: &PlacedNodes,
    changes: &[NodePose],
) -> Result<Geometry, Fault> {
    let mut geometry = Geometry::default();
    for &index in &placed.shown {
        let node = &source.document.nodes[index];
        let Some(mesh) = node.mesh else { continue };
        let mesh = at(&source.document.meshes, mesh, "mesh")?;
        let bones = match node.skin {
            Some(skin) => Some(bones(source, placed, skin)?),
            None => None,
        };
        let weights = weights(node, mesh, &changes[index]);
        for primitive in &mesh.primitives {
            geometry.add(source, primitive, weights, &placed.transforms[index], bones.as_deref())?;
        }
    }
    Ok(geometry)
}

fn weights<'a>(node: &'a Node, mesh: &'a Mesh, change: &'a NodePose) -> &'a [f32] {
    match &change.weights {
        Some(weights) => weights,
        None if node.weights.is_empty() => &mesh.weights,
        None => &node.weights,
    }
}

/// The transform of each bone from the place where its skin was bound to it.
fn bones(source: &AccessorSource<'_>, placed: &PlacedNodes, skin: usize) -> Result<Vec<DAffine3>, Fault> {
    let skin = at(&source.document.skins, skin, "skin")?;
    let bound: Vec<[f32; 16]> = match skin.inverse_bind_matrices {
        Some(accessor) => source.read(accessor)?,
        None => Vec::new(),
    };
    let bone = |(index, &joint): (usize, &usize)| {
        let to_scene = at(&placed.transforms, joint, "node")?;
        Ok(match bound.get(index) {
            Some(matrix) => *to_scene * DAffine3::from_mat4(glam::DMat4::from_cols_array(&matrix.map(f64::from))),
            None => *to_scene,
        })
    };
    skin.joints.iter().enumerate().map(bone).collect()
}

/// Four bones of each vertex, and their weights.
type Joints = (Vec<[f32; 4]>, Vec<[f32; 4]>);

/// Attributes of a primitive before its vertices are placed.
struct PrimitiveAttributes {
    positions: Vec<[f32; 3]>,
    normals: Option<Vec<[f32; 3]>>,
    colors: Option<Vec<[f32; 4]>>,
    texture_places: Option<Vec<[f32; 2]>>,
    /// Four bones and their weights, as often as there are.
    joints: Vec<Joints>,
    /// By name, as [`Geometry::fields`].
    fields: Vec<(String, Vec<f64>)>,
}

impl Geometry {
    fn add(
        &mut self,
        source: &AccessorSource<'_>,
        primitive: &Primitive,
        weights: &[f32],
        transform: &DAffine3,
        bones: Option<&[DAffine3]>,
    ) -> Result<(), Fault> {
        const DRACO: &str = "KHR_draco_mesh_compression";
        if primitive.extensions.contains_key(DRACO) {
            return Err(super::document::packed(DRACO));
        }
        let Some(&position) = primitive.attributes.get("POSITION") else {
            return Ok(());
        };
        let shape = PrimitiveAttributes::read(source, primitive, position, weights)?;
        let count = shape.positions.len();
        let indices = primitive
            .indices
            .map(|accessor| source.read_indices(accessor))
            .transpose()?;
        // Shapes may share one list of vertices, each using a part of it. The sorted index list is held in memory as
        // well.
        let listed = indices.as_ref().map_or(count, Vec::len) as u64;
        source.spend(listed * INDEX_BYTES)?;
        let mut used: Vec<u32> = indices.clone().unwrap_or_else(|| (0..count as u32).collect());
        if indices.is_some() {
            used.sort_unstable();
            used.dedup();
        }
        if let Some(&last) = used.last().filter(|&&last| last as usize >= count) {
            return Err(Fault::header(format!(
                "a shape names vertex {last}, but it has {count}: the file is damaged"
            )));
        }
        source.spend(used.len() as u64 * VERTEX_BYTES)?;
        let first = self.positions.len();
        if first + used.len() > u32::MAX as usize {
            return Err(Fault::header("there are more than four thousand million vertices"));
        }
        for &vertex in &used {
            self.vertex(&shape, vertex as usize, transform, bones)?;
        }
        self.has_normals |= shape.normals.is_some();
        self.has_colors |= shape.colors.is_some();
        self.materials.resize(self.positions.len(), primitive.material);
        self.add_fields(source, &shape.fields, &used)?;
        let corners: Vec<u32> = match indices {
            Some(indices) => {
                let place = |vertex: &u32| used.partition_point(|other| other < vertex);
                indices.iter().map(|vertex| (first + place(vertex)) as u32).collect()
            }
            None => (first as u32..(first + count) as u32).collect(),
        };
        source.spend(corners.len() as u64 * (FACE_BYTES + INDEX_BYTES))?;
        let first_face = self.faces.len();
        match primitive.mode.unwrap_or(4) {
            4 => self.faces.extend(corners.as_chunks::<3>().0),
            5 => strip(&corners, &mut self.faces),
            6 => fan(&corners, &mut self.faces),
            // Points and lines have no faces.
            _ => {}
        }
        // Mirroring shows the back of a shape, so the winding order is reversed.
        if bones.is_none() && transform.matrix3.determinant() < 0.0 {
            for face in &mut self.faces[first_face..] {
                face.swap(1, 2);
            }
        }
        Ok(())
    }

    /// Appends the numbers of the vertices `used` of a shape with these `fields`.
    fn add_fields(
        &mut self,
        source: &AccessorSource<'_>,
        fields: &[(String, Vec<f64>)],
        used: &[u32],
    ) -> Result<(), Fault> {
        let end = self.positions.len();
        for (name, values) in fields {
            let place = self.fields.iter().position(|(known, _)| known == name);
            let place = place.unwrap_or_else(|| {
                self.fields.push((name.clone(), Vec::new()));
                self.fields.len() - 1
            });
            let all = &mut self.fields[place].1;
            source.spend((end - all.len()) as u64 * size_of::<f64>() as u64)?;
            all.resize(end - used.len(), f64::NAN);
            all.extend(used.iter().map(|&vertex| values[vertex as usize]));
        }
        for (_, values) in &mut self.fields {
            values.resize(end, f64::NAN);
        }
        Ok(())
    }

    fn vertex(
        &mut self,
        shape: &PrimitiveAttributes,
        index: usize,
        transform: &DAffine3,
        bones: Option<&[DAffine3]>,
    ) -> Result<(), Fault> {
        let skinned = match bones {
            Some(bones) => shape.skinned(index, bones)?,
            None => None,
        };
        let transform = skinned.as_ref().unwrap_or(transform);
        let position = DVec3::from_array(shape.positions[index].map(f64::from));
        self.positions.push(transform.transform_point3(position));
        self.normals.push(
            shape
                .normals
                .as_ref()
                .map_or([0.0; 3], |normals| turned(transform.matrix3, normals[index])),
        );
        self.colors
            .push(shape.colors.as_ref().map_or([1.0; 4], |colors| colors[index]));
        self.texture_places
            .push(shape.texture_places.as_ref().map_or([0.0; 2], |places| places[index]));
        Ok(())
    }
}

impl PrimitiveAttributes {
    fn read(
        source: &AccessorSource<'_>,
        primitive: &Primitive,
        position: usize,
        weights: &[f32],
    ) -> Result<Self, Fault> {
        let mut positions: Vec<[f32; 3]> = source.read(position)?;
        let count = positions.len();
        let attribute = |name: &str| primitive.attributes.get(name).copied();
        let mut normals = attribute("NORMAL")
            .map(|accessor| source.read::<3>(accessor))
            .transpose()?;
        for (target, &weight) in primitive.targets.iter().zip(weights) {
            if weight == 0.0 {
                continue;
            }
            if let Some(&accessor) = target.get("POSITION") {
                add(&mut positions, &source.read(accessor)?, weight);
            }
            if let (Some(normals), Some(&accessor)) = (&mut normals, target.get("NORMAL")) {
                add(normals, &source.read(accessor)?, weight);
            }
        }
        let colors = attribute("COLOR_0")
            .map(|accessor| source.read_colors(accessor))
            .transpose()?;
        let texture = texture_set(source.document, primitive);
        let texture_places = attribute(&format!("TEXCOORD_{texture}"))
            .map(|accessor| source.read::<2>(accessor))
            .transpose()?;
        let mut joints = Vec::new();
        while let (Some(bones), Some(weights)) = (
            attribute(&format!("JOINTS_{}", joints.len())),
            attribute(&format!("WEIGHTS_{}", joints.len())),
        ) {
            joints.push((source.read::<4>(bones)?, source.read::<4>(weights)?));
        }
        let fields = fields(source, primitive)?;
        let field_lengths = fields.iter().map(|(_, values)| values.len());
        let lengths = [
            normals.as_ref().map(Vec::len),
            colors.as_ref().map(Vec::len),
            texture_places.as_ref().map(Vec::len),
        ];
        let joint_lengths = joints.iter().flat_map(|(bones, weights)| [bones.len(), weights.len()]);
        if let Some(other) = lengths
            .into_iter()
            .flatten()
            .chain(joint_lengths)
            .chain(field_lengths)
            .find(|&length| length != count)
        {
            return Err(Fault::header(format!(
                "a shape has {count} positions but {other} of another attribute: the file is damaged"
            )));
        }
        Ok(Self {
            positions,
            normals,
            colors,
            texture_places,
            joints,
            fields,
        })
    }

    /// The blended transform of the bones that vertex `index` hangs on; `None` where it hangs on none.
    fn skinned(&self, index: usize, bones: &[DAffine3]) -> Result<Option<DAffine3>, Fault> {
        let mut sum = DAffine3::ZERO;
        let mut total = 0.0;
        for (joints, weights) in &self.joints {
            for (joint, weight) in joints[index].into_iter().zip(weights[index]) {
                let weight = f64::from(weight);
                if weight == 0.0 {
                    continue;
                }
                let bone = at(bones, joint as usize, "joint")?;
                sum.matrix3 += bone.matrix3 * weight;
                sum.translation += bone.translation * weight;
                total += weight;
            }
        }
        if total == 0.0 {
            return Ok(None);
        }
        // Weights stored as bytes rarely add up to one.
        sum.matrix3 *= 1.0 / total;
        sum.translation /= total;
        Ok(Some(sum))
    }
}

/// The attributes of the application, in the order of their names; one field per number for those with several.
fn fields(source: &AccessorSource<'_>, primitive: &Primitive) -> Result<Vec<(String, Vec<f64>)>, Fault> {
    let own = primitive.attributes.iter().filter(|(name, _)| name.starts_with('_'));
    let mut own: Vec<(&String, &usize)> = own.collect();
    own.sort_unstable();
    let mut fields = Vec::new();
    for (name, &accessor) in own {
        let columns = source.read_columns(accessor)?;
        let is_single = columns.len() == 1;
        for (place, values) in columns.into_iter().enumerate() {
            let name = if is_single {
                name.clone()
            } else {
                format!("{name}_{place}")
            };
            fields.push((name, values));
        }
    }
    Ok(fields)
}

/// The set of texture coordinates that the material of a shape uses.
fn texture_set(document: &Document, primitive: &Primitive) -> usize {
    let material = primitive.material.and_then(|material| document.materials.get(material));
    let texture = material.and_then(|material| material.pbr_metallic_roughness.base_color_texture.as_ref());
    texture.map_or(0, |texture| {
        let transform = texture.extensions.transform.as_ref();
        transform
            .and_then(|transform| transform.tex_coord)
            .unwrap_or(texture.tex_coord)
    })
}

fn add(values: &mut [[f32; 3]], deltas: &[[f32; 3]], weight: f32) {
    for (value, delta) in values.iter_mut().zip(deltas) {
        for (value, delta) in value.iter_mut().zip(delta) {
            *value += delta * weight;
        }
    }
}

/// A normal behind a transform: across the surface still where that is stretched, hence the matrix of cofactors, whose
/// sign a mirror changes.
fn turned(matrix: DMat3, normal: [f32; 3]) -> [f32; 3] {
    let [x, y, z] = [matrix.x_axis, matrix.y_axis, matrix.z_axis];
    let cofactors = DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y));
    let sign = if matrix.determinant() < 0.0 { -1.0 } else { 1.0 };
    let turned = cofactors * DVec3::from_array(normal.map(f64::from)) * sign;
    turned.normalize_or_zero().as_vec3().to_array()
}
