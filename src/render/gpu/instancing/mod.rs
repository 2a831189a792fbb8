//! Instancing strategies (paper 000 §IV): how records reach the vertex stage.
//!
//! A strategy knows one thing: how to bring a *stream* of 16-byte records to the GPU and how to draw from it. It does
//! not know what a record means nor what is drawn into. Streams longer than the adapter can bind are cut into chunks,
//! each uploaded with one copy and drawn with one call (the uniform strategy: one a batch).

mod binding;
mod compute;
mod storage;
mod strategy;
mod stream;
mod texture;
mod uniform;
mod vertex;

pub(super) use strategy::{Instancing, upload};
pub(super) use stream::{Draw, Stream, ViewBinding};

use super::context::Context;
use crate::scene::Strategy;

/// The strategy's implementation; `view_layout` is the layout of bind group 0.
pub(super) fn new(strategy: Strategy, context: &Context, view_layout: &wgpu::BindGroupLayout) -> Box<dyn Instancing> {
    match strategy {
        Strategy::Storage => Box::new(storage::Storage::new(context)),
        Strategy::Uniform => Box::new(uniform::Uniform::new(context)),
        Strategy::Texture => Box::new(texture::Texture::new(context)),
        Strategy::Vertex => Box::new(vertex::Vertex),
        Strategy::Compute => Box::new(compute::Compute::new(context, view_layout)),
    }
}
