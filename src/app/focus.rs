//! Keyboard focus where no window manager assigns it.
//!
//! Under X11 the window manager gives a new window the keyboard focus. On a bare server (a kiosk, a virtual screen,
//! `xinit` with a single program) there is none, and requests through it, as `Window::focus_window` makes, have no
//! effect. Such a window takes the focus itself, once, when it has come onto the screen. A window manager is the client
//! with the right to redirect the root window's children, which the server grants once; where there is one, this does
//! nothing.

use winit::window::Window;

/// Gives the keyboard focus to `window` where no window manager does. Failures are only logged.
#[cfg(all(unix, not(target_os = "macos")))]
pub(super) fn take_if_unmanaged(window: &Window) {
    use winit::raw_window_handle::{HasWindowHandle as _, RawWindowHandle};
    let id = match window.window_handle().map(|handle| handle.as_raw()) {
        // The ids of windows have 29 bits.
        Ok(RawWindowHandle::Xlib(handle)) => handle.window as u32,
        Ok(RawWindowHandle::Xcb(handle)) => handle.window.get(),
        _ => return,
    };
    match x11::take_if_unmanaged(id) {
        Ok(true) => log::debug!("no window manager: the window took the keyboard itself"),
        Ok(false) => {}
        Err(reason) => log::debug!("the keyboard could not be taken: {reason}"),
    }
}

/// Other systems hand out the keyboard themselves.
#[cfg(not(all(unix, not(target_os = "macos"))))]
pub(super) fn take_if_unmanaged(_window: &Window) {}

#[cfg(all(unix, not(target_os = "macos")))]
mod x11 {
    use x11rb::connection::Connection as _;
    use x11rb::protocol::xproto::{ConnectionExt as _, EventMask, InputFocus, MapState, Window};

    /// Checks and acts on its own connection to the window's display. True if it took the keyboard focus.
    pub(super) fn take_if_unmanaged(window: Window) -> Result<bool, Box<dyn std::error::Error>> {
        let (connection, screen) = x11rb::connect(None)?;
        let root = connection.setup().roots[screen].root;
        let of_root = connection.get_window_attributes(root)?.reply()?;
        let is_managed = of_root.all_event_masks.contains(EventMask::SUBSTRUCTURE_REDIRECT);
        let of_window = connection.get_window_attributes(window)?.reply()?;
        if is_managed || of_window.map_state != MapState::VIEWABLE {
            return Ok(false);
        }
        connection
            .set_input_focus(InputFocus::PARENT, window, x11rb::CURRENT_TIME)?
            .check()?;
        Ok(true)
    }
}
