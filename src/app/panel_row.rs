//! A panel of the window, as the table of panels and the features have it.

use super::PanelId;
use egui::Ui;
use std::ops::RangeInclusive;

/// A panel of the window whose state is `S`.
#[derive(Debug)]
pub(in crate::app) struct PanelRow<S> {
    /// Id by which a user opens and closes it; `None` for one that appears with its subject.
    pub(in crate::app) id: Option<PanelId>,
    /// Its item of the menu View; `None` of one that is opened from elsewhere.
    pub(in crate::app) menu: Option<&'static str>,
    /// Words of people and of other programs that find it in the palette.
    pub(in crate::app) also: &'static [&'static str],
    pub(in crate::app) place: Dock<S>,
    /// Shows it. A window is asked in each pass, and knows whether it is open.
    pub(in crate::app) show: fn(&mut Ui, &mut S),
}

/// Dock position of a panel.
#[derive(Debug)]
pub(in crate::app) enum Dock<S> {
    /// Left side panel, next to the image; initial width and width range, points.
    Left(f32, RangeInclusive<f32>),
    /// Right side panel; initial width and width range, points.
    Right(f32, RangeInclusive<f32>),
    /// A bar of this name above the image, while it is visible.
    Top(&'static str, fn(&S) -> bool),
    /// A chip at the right end of the menu bar, where that has more space than this, points.
    Chip(f32),
    /// A bar of this name below the image.
    Bottom(&'static str),
    /// A window over the image.
    Window,
    /// A window over all others.
    Over,
}

impl<S> PanelRow<S> {
    /// A window that has an item in the menu View.
    pub(in crate::app) const fn in_menu(id: PanelId, menu: &'static str, show: fn(&mut Ui, &mut S)) -> Self {
        Self {
            id: Some(id),
            menu: Some(menu),
            also: &[],
            place: Dock::Window,
            show,
        }
    }

    /// Adds synonyms: words of users and of other programs.
    pub(in crate::app) const fn also(mut self, also: &'static [&'static str]) -> Self {
        self.also = also;
        self
    }

    /// A window that is opened from elsewhere than the menu View.
    pub(in crate::app) const fn window(id: PanelId, show: fn(&mut Ui, &mut S)) -> Self {
        Self {
            id: Some(id),
            menu: None,
            also: &[],
            place: Dock::Window,
            show,
        }
    }

    /// A window that appears with its subject.
    pub(in crate::app) const fn by_itself(show: fn(&mut Ui, &mut S)) -> Self {
        Self {
            id: None,
            menu: None,
            also: &[],
            place: Dock::Window,
            show,
        }
    }
}
