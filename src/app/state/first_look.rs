//! Initial view and style derived for the open sequence where nothing is chosen, and the user's choices that replace
//! them.
//!
//! **How it works.** The first shown frame determines the target and the initial viewpoint ([`FirstLook::of_first`]).
//! For a sequence of many frames, a thread meanwhile examines some others; when it is done, and the user has not moved
//! the camera, the view fits all of them. An up axis that a user chooses is in the document.

use super::State;
use crate::app::first_look::{FirstView, RefinedLook};
use crate::math::Aabb;
use crate::rgbd::Sensor;
use crate::scene::{Camera, FirstLook, Settings, Style, UpAxis};
use crate::sequence::PreparedFrame;
use std::sync::Arc;

impl State {
    /// Returns the first look derived for the open sequence; `None` before its first frame is shown.
    pub fn first_look(&self) -> Option<&FirstLook> {
        self.opening.looked.look.as_deref()
    }

    /// Returns true once the first look at the open sequence is final: the view no longer changes by itself.
    pub fn has_looked(&self) -> bool {
        self.opening.looked.is_complete
    }

    /// Returns the effective style: the settings, with automatic values and the renderer resolved.
    pub fn drawn_style(&self) -> Style {
        self.resolved(&self.style)
    }

    /// Returns true if the CPU renders the image rather than a GPU.
    pub(in crate::app) fn draws_on_processor(&self) -> bool {
        self.is_drawn_by_processor(&self.style)
    }

    fn is_drawn_by_processor(&self, style: &Settings) -> bool {
        let choice = self.main.renderer(style.drawing.renderer);
        choice.is_processor(self.graphics.is_software)
    }

    pub(in crate::app) fn resolved(&self, style: &Settings) -> Style {
        let is_processor = self.is_drawn_by_processor(style);
        self.first_look()
            .map_or_else(|| style.decided(), |look| style.resolved(look))
            .drawn_by(is_processor)
    }

    /// All settings as in a new installation, for this document and new ones; the camera stays.
    pub(in crate::app) fn reset_settings(&mut self) {
        self.style = Settings::default();
        self.shared.options.preferences.settings = Settings::default();
    }

    /// Looks at the first frame that is shown, and puts the camera where it is seen best.
    pub(in crate::app) fn look_first(&mut self, frame: &Arc<PreparedFrame>) {
        let Some(player) = &self.player else { return };
        let sequence = Arc::clone(player.sequence());
        let look = FirstLook::of_first(&frame.frame, &sequence);
        // A frame re-read because it was half-written must not move a camera that the user has moved.
        let is_chosen = !self.opening.looked.is_empty() && self.opening.looked.untouched(&self.camera).is_none();
        let camera = self.camera;
        if self.opening.looked.is_outdated {
            self.features.thumbnails.redo();
        }
        self.opening.looked.first = Some((frame.index, frame.id));
        self.opening.looked.is_outdated = false;
        self.take_look(Arc::new(look));
        if is_chosen {
            self.camera = camera;
        }
        if let Some(view) = self.shared.options.view.take() {
            self.camera = view;
            self.opening.looked.view = None;
        }
        if sequence.len() == 1 {
            self.opening.looked.is_complete = true;
            self.tell_lack();
            return;
        }
        let frame = Arc::clone(frame);
        self.shared.tasks.start("initial view", move || {
            let look = FirstLook::of_sequence(&frame.frame, &sequence);
            let sequence = Arc::downgrade(&sequence);
            Box::new(RefinedLook { sequence, look })
        });
    }

    /// Takes a thread's result from several frames of the open sequence.
    pub(in crate::app) fn take_more(&mut self, more: RefinedLook) {
        let is_open = self.player.as_ref().is_some_and(|player| {
            let opened = more.sequence.upgrade();
            opened.is_some_and(|opened| Arc::ptr_eq(&opened, player.sequence()))
        });
        if !is_open {
            return;
        }
        self.opening.looked.is_complete = true;
        let is_untouched = self.opening.looked.untouched(&self.camera).is_some();
        let camera = self.camera;
        self.take_look(Arc::new(more.look));
        if !is_untouched {
            self.camera = camera;
        }
        self.tell_lack();
    }

    /// Reports it if the open sequence lacks data for the style.
    fn tell_lack(&mut self) {
        let lack = self
            .first_look()
            .and_then(|look| look.lack_of(self.style.primitive.chosen()?));
        if let Some(lack) = lack {
            self.notices.warn(lack);
        }
    }

    fn take_look(&mut self, guessed: Arc<FirstLook>) {
        let look = match self.chosen_up() {
            Some(up) => Arc::new(FirstLook::clone(&guessed).with_up(up)),
            None => Arc::clone(&guessed),
        };
        self.opening.looked.guessed = Some(guessed);
        self.opening.looked.look = Some(look);
        self.reset_view();
    }

    /// The up axis that the user has chosen for the open sequence.
    pub(in crate::app) fn chosen_up(&self) -> Option<UpAxis> {
        self.shared.options.up.or(self.document.up)
    }

    /// Puts the camera where it is for a sequence that was just opened.
    pub(in crate::app) fn reset_view(&mut self) {
        self.show_first_view(self.second_bounds());
    }

    fn show_first_view(&mut self, second_bounds: Aabb) {
        let Some((look, player)) = self.opening.looked.look.as_ref().zip(self.player.as_ref()) else {
            return;
        };
        let origin = player.sequence().origin();
        let aspect = self.aspect();
        let mut camera = look.camera(origin, aspect);
        camera.projection = self.camera.projection;
        look.frame(&mut camera, origin, aspect, &second_bounds);
        self.camera = camera;
        self.opening.looked.view = Some(FirstView {
            camera,
            size_px: self.viewport.size_px,
            second_bounds,
        });
    }

    /// Fits the initial view to an image whose size has changed. A view chosen by the user stays.
    pub(in crate::app) fn fit_first_view(&mut self) {
        if let Some(view) = self.opening.looked.untouched(&self.camera)
            && view.size_px != self.viewport.size_px
        {
            self.show_first_view(view.second_bounds);
        }
    }

    /// Sets `up` as the up axis of the open sequence, now and whenever it is opened again, and shows the sequence
    /// again.
    pub fn choose_up(&mut self, up: UpAxis) {
        self.camera.up = up;
        self.take_chosen_up(Some(up));
    }

    /// Takes back the choice of an up axis: the guessed one is up again.
    pub(in crate::app) fn guess_up(&mut self) {
        self.take_chosen_up(None);
    }

    pub(super) fn take_chosen_up(&mut self, up: Option<UpAxis>) {
        self.shared.options.up = None;
        self.document.up = up;
        self.keep_document();
        if let Some(guessed) = self.opening.looked.guessed.take() {
            self.take_look(guessed);
        }
    }

    /// Moves back until all points are visible, including outliers and far ones, and `second_bounds`, relative to the
    /// origin of the open sequence.
    pub(in crate::app) fn all_framed(&self, second_bounds: &Aabb) -> Option<Camera> {
        let player = self.player.as_ref()?;
        let bounds = self.first_look()?.full;
        let shown = player.shown().map(|frame| frame.frame.bounds());
        let bounds = bounds.union(&shown.unwrap_or(Aabb::EMPTY)).union(second_bounds);
        let mut camera = self.camera;
        camera.frame_bounds(&bounds, player.sequence().origin());
        Some(camera)
    }

    /// Returns the sensor that captured the shown frame, as far as it is known.
    pub(in crate::app) fn sensor(&self) -> Option<Sensor> {
        let player = self.player.as_ref()?;
        player.sequence().source().sensor(player.shown()?.index)
    }

    /// Puts the camera where the sensor was, with its view.
    pub(in crate::app) fn look_from_sensor(&mut self) {
        let looked = self.opening.looked.look.as_deref().zip(self.player.as_ref());
        let Some(((look, player), sensor)) = looked.zip(self.sensor()) else {
            self.notices
                .info("No camera is known: depth images have one, point files do not");
            return;
        };
        self.camera = look.camera_of_sensor(&sensor, player.sequence().origin());
    }

    /// Moves the camera to the pose of a calibrated image, with its view.
    pub(in crate::app) fn stand_at_photo(&mut self, number: usize) {
        let looked = self.opening.looked.look.as_deref().zip(self.player.as_ref());
        if let Some((look, player)) = looked
            && let Some(set) = player.posed_images()
            && let Some(photo) = set.photos.get(number)
        {
            self.camera = look.camera_of_photo(photo, player.sequence().origin());
        }
    }

    /// Aspect ratio of the image.
    fn aspect(&self) -> f64 {
        match self.viewport.size_px.map(f64::from) {
            [width, height] if width > 0.0 && height > 0.0 => width / height,
            // Nothing has been laid out yet.
            _ => 16.0 / 9.0,
        }
    }
}
