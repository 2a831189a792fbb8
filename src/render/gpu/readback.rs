//! Reading an image back to the CPU, through a staging buffer.

use super::context::Context;
use crate::render::RenderError;
use image::RgbaImage;

/// Copies a [`super::targets::COLOR_FORMAT`] texture into an image. Blocks until the GPU is done.
pub(super) fn read_color(context: &Context, texture: &wgpu::Texture) -> Result<RgbaImage, RenderError> {
    let (width, height) = (texture.width(), texture.height());
    let row_bytes = width * 4;
    let padded_row_bytes = row_bytes.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let size = u64::from(padded_row_bytes) * u64::from(height);
    let buffer = context.catching_out_of_memory("reading the picture back", || {
        context.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("readback"),
            size,
            usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        })
    })?;
    let mut encoder = context
        .device
        .create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    encoder.copy_texture_to_buffer(
        texture.as_image_copy(),
        wgpu::TexelCopyBufferInfo {
            buffer: &buffer,
            layout: wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(padded_row_bytes),
                rows_per_image: None,
            },
        },
        texture.size(),
    );
    context.queue.submit([encoder.finish()]);
    let bytes = map_and_read(context, &buffer, |bytes| {
        bytes
            .chunks_exact(padded_row_bytes as usize)
            .flat_map(|row| &row[..row_bytes as usize])
            .copied()
            .collect::<Vec<u8>>()
    })?;
    RgbaImage::from_raw(width, height, bytes).ok_or_else(|| RenderError::Poll {
        reason: "the picture came back incomplete".to_owned(),
    })
}

/// Maps a whole buffer, waits for it and hands its bytes to `read`.
pub(super) fn map_and_read<T>(
    context: &Context,
    buffer: &wgpu::Buffer,
    read: impl FnOnce(&[u8]) -> T,
) -> Result<T, RenderError> {
    let (sender, receiver) = std::sync::mpsc::sync_channel(1);
    buffer.slice(..).map_async(wgpu::MapMode::Read, move |result| {
        // The receiver outlives the wait below.
        let _ = sender.send(result);
    });
    context.wait()?;
    // Another thread that waits on this device may have taken the callback and not called it yet.
    match receiver.recv() {
        Ok(Ok(())) => {
            let result = buffer.slice(..).get_mapped_range().map(|bytes| read(&bytes));
            buffer.unmap();
            result.map_err(|error| RenderError::Poll {
                reason: error.to_string(),
            })
        }
        Ok(Err(error)) => Err(RenderError::Poll {
            reason: error.to_string(),
        }),
        Err(error) => Err(RenderError::Poll {
            reason: error.to_string(),
        }),
    }
}
