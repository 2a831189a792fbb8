//! Images by the graphics library, for the benches that time them.

use pointreel::render::Renderer;
use pointreel::render::gpu::GpuRenderer;
use pointreel::scene::ScenePacket;

/// Draws a packet, also when it was drawn last, and waits until the adapter has finished.
pub(crate) fn draw(renderer: &mut GpuRenderer, packet: &ScenePacket) {
    renderer.invalidate();
    renderer.prepare(packet).expect("the packet can be uploaded");
    renderer.render().expect("the packet can be drawn");
    renderer.context().wait().expect("the adapter answers");
}
