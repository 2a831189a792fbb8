//! Recording of a live stream, and reporting of its connection events.

use super::State;
use super::dialogs::Dialog;
use crate::app::work::files::with_extension;
use crate::scene::{Camera, screen_view};
use crate::source::{ConnectionChange, Source};
use crate::wire::View;
use std::path::Path;
use std::sync::Arc;

impl State {
    fn stream(&self) -> Option<Arc<dyn Source>> {
        let source = self.player.as_ref()?.sequence().source();
        source.live().is_some().then(|| Arc::clone(source))
    }

    /// Says that the connection of a stream has broken, and that it is back. True if something is said.
    pub(in crate::app) fn follow_connection(&mut self) -> bool {
        let Some(source) = self.stream() else { return false };
        let Some(live) = source.live() else { return false };
        let Some(change) = self.opening.connection.watch.look(&live.status(), self.shared.now) else {
            return false;
        };
        // The connection has recovered, or broken again.
        if let Some(said) = self.opening.connection.said.take() {
            self.notices.dismiss_text(&said);
        }
        let stream = source.inputs().first().map(|input| input.display().to_string());
        let text = format!("{}: {change}", stream.unwrap_or_default());
        match change {
            ConnectionChange::Broken(_) => {
                self.notices.warn(text.clone());
                self.opening.connection.said = Some(text);
            }
            _ => self.notices.info(text),
        }
        true
    }

    /// Sends the view to a stream, once whole frames have determined the viewpoint.
    pub(in crate::app) fn tell_view(&self) {
        let size_px = self.drawn_style().drawn_px(self.viewport.size_px);
        if self.opening.looked.is_empty() || self.viewport.size_px.contains(&0) {
            return;
        }
        if let Some(source) = self.stream()
            && let Some(live) = source.live()
        {
            live.look_from(view_of(&self.camera, size_px));
        }
    }

    /// Asks where to record to, or ends the recording.
    pub(in crate::app) fn toggle_recording(&mut self) {
        let Some(source) = self.stream() else {
            return self
                .notices
                .error("Only live streams (tcp://…) are recorded, and none is open");
        };
        let Some(live) = source.live() else { return };
        match live.stop_recording() {
            Ok(None) => self.ask(record_dialog()),
            Ok(Some(recording)) => {
                self.notices
                    .info(format!("{} has {} frames", recording.path.display(), recording.frames));
            }
            Err(problem) => self.notices.error(problem),
        }
    }

    /// Records to a new file.
    pub(in crate::app) fn record_to(&mut self, path: &Path) {
        let started = self
            .stream()
            .and_then(|source| Some(source.live()?.start_recording(path)));
        match started {
            Some(Ok(())) => self.notices.info(format!("Recording to {}", path.display())),
            Some(Err(problem)) => self.notices.error(problem),
            None => self.notices.error("The stream was closed meanwhile"),
        }
    }
}

/// Returns the view sent for a camera: of an image a quarter wider and higher, as the camera moves on while points are
/// on the way.
fn view_of(camera: &Camera, size_px: [u32; 2]) -> View {
    let eye = camera.eye_in_world();
    let view = screen_view(&camera.transform(eye, size_px), size_px);
    let margin_px = view.size_px.map(|edge| edge / 8);
    View {
        eye,
        rotation: view.rotation,
        // The server knows the points near the eye; the client does not, until they have been sent.
        near: 0.0,
        size_px: [0, 1].map(|axis| view.size_px[axis] + 2 * margin_px[axis]),
        px_per_slope: view.px_per_slope,
        center_px: [0, 1].map(|axis| view.center_px[axis] + margin_px[axis] as f32),
    }
}

/// Asks where to record the live stream.
fn record_dialog() -> Dialog<State> {
    let record = |state: &mut State, file| state.record_to(&with_extension(file, "pointreel-stream"));
    Dialog::new_file("Record the live stream", "live.pointreel-stream".to_owned(), record)
        .filter("Recording of a stream", ["pointreel-stream"])
        .without("Name the file on the command line: pointreel view tcp://… --record FILE")
}
