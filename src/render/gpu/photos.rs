//! Input images as textures, for the passes of view-dependent texturing (`shaders/common/photos.wgsl`).
//!
//! All of them are layers of one texture, each in the upper left corner, with mip levels of their own: shaders read
//! texels and filter them themselves, as the CPU does. Depths are drawn by the CPU, once for each frame. A small table
//! holds the projections of the input images in the rendered image.

use super::context::Context;
use crate::photos::{PosedImage, PosedImages};
use crate::render::known_depths::KnownDepths;
use crate::scene::{
    DepthMap, PhotoClipping, PhotoDepths, PhotoHoles, PhotoRelight, PhotoView, PhotoViews, PhotosInFrame, ScenePacket,
};
use std::sync::Arc;

/// Bit flags of the non-numeric options, as shaders read them.
pub(super) const PHOTO_LEAVES_HOLES: u32 = 1;
pub(super) const PHOTO_CLIPS_BY_VOTE: u32 = 2;
pub(super) const PHOTO_CLIPS_BY_ANY: u32 = 4;
pub(super) const PHOTO_RELIGHTS: u32 = 8;
pub(super) const PHOTO_IS_WHITE: u32 = 16;

/// Result codes of view-dependent texturing, as shaders read them (`PhotoAnswer` of the software renderer).
pub(super) const ANSWER_CLIPPED: f32 = -1.0;
pub(super) const ANSWER_UNSEEN: f32 = 0.0;
pub(super) const ANSWER_SHOWN: f32 = 1.0;

/// Entries of a row of the table.
const COLUMNS: usize = 8;

/// GPU textures of the input images.
#[derive(Debug)]
pub(super) struct PhotoTextures {
    texels: wgpu::TextureView,
    texels_of: Arc<PosedImages>,
    depths: wgpu::TextureView,
    depths_of: Arc<PhotoDepths>,
    known_depths: KnownDepths,
    table: wgpu::TextureView,
}

impl PhotoTextures {
    /// Creates the textures of a packet, reusing those that `known` already has.
    pub(super) fn of(
        context: &Context,
        known: Option<Self>,
        shown: &PhotosInFrame,
        views: &PhotoViews,
        packet: &ScenePacket,
    ) -> Self {
        let posed_images = &shown.posed_images;
        let same = |known: &&Self| Arc::ptr_eq(&known.texels_of, posed_images);
        let same_texels = known.as_ref().filter(same).map(|known| known.texels.clone());
        let (mut known_depths, before) = known.map_or_else(Default::default, |known| {
            (known.known_depths, Some((known.depths, known.depths_of)))
        });
        let depths_of = known_depths.of(packet);
        let same_depths = before.filter(|(_, of)| Arc::ptr_eq(of, &depths_of));
        let same_depths = same_depths.map(|(depths, _)| depths);
        Self {
            texels: same_texels.unwrap_or_else(|| texels(context, posed_images)),
            texels_of: Arc::clone(posed_images),
            depths: same_depths.unwrap_or_else(|| depths(context, &depths_of.maps)),
            table: table(context, views, shown, &depths_of.maps),
            depths_of,
            known_depths,
        }
    }

    /// In the order of their bindings.
    pub(super) fn views(&self) -> [&wgpu::TextureView; 3] {
        [&self.table, &self.texels, &self.depths]
    }

    /// Returns the table of the projections of the input images in the rendered image, and of the handling of surfaces
    /// that they do not show.
    pub(super) fn table(&self) -> &wgpu::TextureView {
        &self.table
    }
}

/// Returns the number of texture layers, limited by the adapter: input images beyond the limit are ignored.
fn layers(context: &Context, posed_images: usize) -> usize {
    posed_images
        .min(context.limits.max_texture_array_layers as usize)
        .max(1)
}

/// The largest width and height of some.
fn largest(sizes: impl Iterator<Item = [u32; 2]>) -> [u32; 2] {
    sizes.fold([1; 2], |largest, size| [0, 1].map(|axis| largest[axis].max(size[axis])))
}

fn texels(context: &Context, posed_images: &PosedImages) -> wgpu::TextureView {
    let all = posed_images.all();
    let count = layers(context, all.len());
    let size = largest(all.iter().map(|posed_image| posed_image.texture.size_px()));
    let levels = 32 - size[0].max(size[1]).leading_zeros();
    let texture = layered(
        context,
        "images",
        LayersSize {
            size_px: size,
            layers: count,
            levels,
        },
        wgpu::TextureFormat::Rgba8Unorm,
    );
    for (layer, posed_image) in (0..).zip(&all[..count.min(all.len())]) {
        for (level, of_level) in (0..).zip(posed_image.texture.levels()) {
            write(
                context,
                &texture,
                layer,
                level,
                of_level.size_px(),
                bytemuck::cast_slice(of_level.pixels()),
            );
        }
    }
    view(&texture, wgpu::TextureViewDimension::D2Array)
}

fn depths(context: &Context, maps: &[DepthMap]) -> wgpu::TextureView {
    let count = layers(context, maps.len());
    let size = largest(maps.iter().map(|map| map.size));
    let texture = layered(
        context,
        "depths of images",
        LayersSize {
            size_px: size,
            layers: count,
            levels: 1,
        },
        wgpu::TextureFormat::R32Float,
    );
    for (layer, map) in (0..).zip(&maps[..count.min(maps.len())]) {
        write(
            context,
            &texture,
            layer,
            0,
            map.size,
            bytemuck::cast_slice(&map.distances),
        );
    }
    view(&texture, wgpu::TextureViewDimension::D2Array)
}

fn table(context: &Context, views: &PhotoViews, shown: &PhotosInFrame, maps: &[DepthMap]) -> wgpu::TextureView {
    let count = layers(context, views.views.len()).min(views.views.len());
    let mut flags = match views.clipping {
        PhotoClipping::Vote => PHOTO_CLIPS_BY_VOTE,
        PhotoClipping::Paper => PHOTO_CLIPS_BY_ANY,
        PhotoClipping::Off => 0,
    };
    flags |= match views.holes {
        PhotoHoles::Left => PHOTO_LEAVES_HOLES,
        // If no image shows any of the rendered surface, nothing can be filled either.
        PhotoHoles::Points | PhotoHoles::Filled => 0,
    };
    flags |= match views.relight {
        PhotoRelight::Off => 0,
        PhotoRelight::Photos => PHOTO_RELIGHTS,
        PhotoRelight::DepthOnly => PHOTO_RELIGHTS | PHOTO_IS_WHITE,
    };
    let mut rows = vec![[0.0; 4]; COLUMNS];
    rows[0] = [count as f32, views.blended as f32, views.per_sigma2, flags as f32];
    rows[1][0] = views.gap_px as f32;
    for ((view, posed_image), map) in views.views.iter().zip(shown.posed_images.all()).zip(maps).take(count) {
        rows.extend(row(view, posed_image, map));
    }
    let size = [COLUMNS as u32, (rows.len() / COLUMNS) as u32];
    let texture = layered(
        context,
        "table of images",
        LayersSize {
            size_px: size,
            layers: 1,
            levels: 1,
        },
        wgpu::TextureFormat::Rgba32Float,
    );
    write(context, &texture, 0, 0, size, bytemuck::cast_slice(&rows));
    view(&texture, wgpu::TextureViewDimension::D2)
}

fn row(view: &PhotoView, posed_image: &PosedImage, map: &DepthMap) -> [[f32; 4]; COLUMNS] {
    let levels = posed_image.texture.levels().len();
    let [x, y, z] = view.camera_from_view.map(|row| row.to_array());
    let one_if = |condition: bool| if condition { 1.0 } else { 0.0 };
    let [width, height] = map.size.map(|edge| edge as f32);
    [
        x,
        y,
        z,
        view.center.extend(0.0).to_array(),
        [view.focal[0], view.focal[1], view.principal[0], view.principal[1]],
        [view.size[0], view.size[1], levels as f32, one_if(posed_image.is_masked)],
        view.gain.extend(0.0).to_array(),
        [width, height, map.tolerance, one_if(map.is_measured)],
    ]
}

/// Size of a layered texture.
#[derive(Debug, Clone, Copy)]
struct LayersSize {
    size_px: [u32; 2],
    layers: usize,
    levels: u32,
}

fn layered(context: &Context, label: &str, extent: LayersSize, format: wgpu::TextureFormat) -> wgpu::Texture {
    context.device.create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size: wgpu::Extent3d {
            width: extent.size_px[0],
            height: extent.size_px[1],
            depth_or_array_layers: extent.layers as u32,
        },
        mip_level_count: extent.levels,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    })
}

/// Writes the upper left corner of a level of a layer.
fn write(context: &Context, texture: &wgpu::Texture, layer: u32, level: u32, size: [u32; 2], texels: &[u8]) {
    let [width, height] = size;
    let to = wgpu::TexelCopyTextureInfo {
        texture,
        mip_level: level,
        origin: wgpu::Origin3d { x: 0, y: 0, z: layer },
        aspect: wgpu::TextureAspect::All,
    };
    let rows = wgpu::TexelCopyBufferLayout {
        offset: 0,
        bytes_per_row: Some(texels.len() as u32 / height),
        rows_per_image: None,
    };
    let extent = wgpu::Extent3d {
        width,
        height,
        depth_or_array_layers: 1,
    };
    context.queue.write_texture(to, texels, rows, extent);
}

fn view(texture: &wgpu::Texture, dimension: wgpu::TextureViewDimension) -> wgpu::TextureView {
    texture.create_view(&wgpu::TextureViewDescriptor {
        dimension: Some(dimension),
        ..wgpu::TextureViewDescriptor::default()
    })
}
