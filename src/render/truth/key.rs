//! Identity of a ground truth: the bytes of all that it is made of.

use super::{Disks, RayTraced, TruthView};
use crate::cloud::MeshRecords;
use crate::scene::{Lighting, PhysicalLight};

/// Everything that a truth depends on, by which it is known again.
#[derive(Debug, Clone, Copy)]
pub struct TruthKey<'a> {
    view: &'a TruthView,
    of: TruthSubject<'a>,
}

#[derive(Debug, Clone, Copy)]
enum TruthSubject<'a> {
    Disks(Disks<'a>),
    Shape(RayTraced, f64),
    Mesh(&'a MeshRecords, f64),
}

impl<'a> TruthKey<'a> {
    /// The key of [`Truth::of_disks`](super::Truth::of_disks).
    pub fn of_disks(disks: Disks<'a>, view: &'a TruthView) -> Self {
        Self {
            view,
            of: TruthSubject::Disks(disks),
        }
    }

    /// The key of [`Truth::of_shape`](super::Truth::of_shape).
    pub fn of_shape(shape: RayTraced, view: &'a TruthView, tolerance: f64) -> Self {
        Self {
            view,
            of: TruthSubject::Shape(shape, tolerance),
        }
    }

    /// The key of [`Truth::of_mesh`](super::Truth::of_mesh).
    pub fn of_mesh(mesh: &'a MeshRecords, view: &'a TruthView, tolerance: f64) -> Self {
        Self {
            view,
            of: TruthSubject::Mesh(mesh, tolerance),
        }
    }

    /// Width and height of the image.
    pub fn size_px(&self) -> [u32; 2] {
        self.view.size_px
    }

    /// Hands over the bytes of all that it is made of, in pieces.
    pub fn for_each_bytes(&self, take: &mut dyn FnMut(&[u8])) {
        let TruthView {
            view_from_frame,
            eye,
            px_per_slope,
            axis_px,
            size_px,
            lighting,
            physical,
            background,
        } = self.view;
        let numbers = view_from_frame.to_cols_array().into_iter();
        let plane = px_per_slope.to_array().into_iter().chain(axis_px.to_array());
        for number in numbers.chain(eye.to_array()).chain(plane) {
            take(&number.to_le_bytes());
        }
        for edge in size_px {
            take(&edge.to_le_bytes());
        }
        take(&[u8::from(*lighting == Lighting::Unlit), u8::from(physical.is_some())]);
        if let Some(physical) = physical {
            bytes_of_light(physical, take);
        }
        take(&background.top);
        take(&background.bottom);
        match self.of {
            TruthSubject::Disks(disks) => {
                take(&[0, u8::from(disks.cull_back_faces), u8::from(disks.are_ellipses)]);
                take(bytemuck::cast_slice(disks.points));
                take(bytemuck::cast_slice(disks.shapes));
            }
            TruthSubject::Shape(shape, tolerance) => {
                take(&[1, u8::from(shape.cull_back_faces)]);
                take(shape.shape.name().as_bytes());
                take(&tolerance.to_le_bytes());
            }
            TruthSubject::Mesh(mesh, tolerance) => {
                take(&[2]);
                take(bytemuck::cast_slice(mesh.vertices.as_slice()));
                take(bytemuck::cast_slice(mesh.triangles.as_slice()));
                take(bytemuck::cast_slice(mesh.textures.places()));
                take(bytemuck::cast_slice(mesh.textures.texels()));
                take(&tolerance.to_le_bytes());
            }
        }
    }
}

fn bytes_of_light(physical: &PhysicalLight, take: &mut dyn FnMut(&[u8])) {
    let PhysicalLight {
        metallic,
        alpha,
        environment_from_view,
        environment_light,
        harmonics,
        tables,
    } = physical;
    let means = [tables.curve.mean_loss, tables.curve.mean_let_in];
    take(bytemuck::cast_slice(&[*metallic, *alpha, *environment_light]));
    take(bytemuck::cast_slice(&environment_from_view.to_cols_array()));
    take(bytemuck::cast_slice(
        &harmonics.0.map(|coefficient| coefficient.to_array()),
    ));
    // The entries of the curve are the last row of the texels.
    take(bytemuck::cast_slice(&tables.texels));
    take(bytemuck::cast_slice(&means));
}
