//! Disables a Vulkan layer that only complains without a session.
//!
//! Mesa installs a layer that asks the Wayland session which GPU is its own, each time that GPUs are enumerated.
//! Without a session it learns nothing, and libwayland prints `error: XDG_RUNTIME_DIR is invalid or not set in the
//! environment.` for each query. wgpu has no option that would exclude the layer: it always asks for all kinds of
//! windows that Vulkan knows. The layer's own switch is in the environment, and is set here.
//!
//! Without the layer GPUs are listed in the order of their drivers. The only consequence is which of two equally good
//! GPUs is taken.

use std::ffi::OsString;

/// The switch in the layer's manifest, `VkLayer_MESA_device_select.json`.
const SWITCH: &str = "NODEVICE_SELECT";

/// Disables the layer for the rest of the program if there is no session that it could ask. To be called once, when the
/// program starts and has one thread.
pub(in crate::cli) fn skip_without_session() {
    if cfg!(all(target_os = "linux", feature = "gpu")) && is_useless(|name| std::env::var_os(name)) {
        #[allow(
            unsafe_code,
            reason = "the layer is chosen by the loader of Vulkan, which asks the environment alone"
        )]
        // SAFETY: nothing else reads or writes the environment at the same time, since the program has no other thread
        // yet.
        unsafe {
            std::env::set_var(SWITCH, "1");
        }
    }
}

/// Returns true if the layer would look for a session, and libwayland would not know where.
fn is_useless(variable: impl Fn(&str) -> Option<OsString>) -> bool {
    // A user who names a GPU, or has set the switch, knows about the layer.
    let names_a_card = ["MESA_VK_DEVICE_SELECT", "DRI_PRIME", SWITCH];
    if names_a_card.iter().any(|name| variable(name).is_some()) {
        return false;
    }
    let is_absolute = |name| variable(name).is_some_and(|path| path.as_encoded_bytes().starts_with(b"/"));
    let has_place = is_absolute("XDG_RUNTIME_DIR") || is_absolute("WAYLAND_DISPLAY");
    !has_place && variable("WAYLAND_SOCKET").is_none()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn is_useless_with(variables: &[(&str, &str)]) -> bool {
        is_useless(|name| {
            let (_, value) = variables.iter().find(|(set, _)| *set == name)?;
            Some(OsString::from(value))
        })
    }

    #[test]
    fn the_layer_is_disabled_where_libwayland_would_complain() {
        assert!(is_useless_with(&[]));
        assert!(is_useless_with(&[("DISPLAY", ":0")]));
        assert!(is_useless_with(&[("WAYLAND_DISPLAY", "wayland-0")]));
        assert!(is_useless_with(&[("XDG_RUNTIME_DIR", "")]));
        assert!(is_useless_with(&[("XDG_RUNTIME_DIR", "run/1")]));
    }

    #[test]
    fn the_layer_stays_enabled_where_it_is_useful_or_requested() {
        for variable in [
            ("XDG_RUNTIME_DIR", "/run/user/1000"),
            ("WAYLAND_DISPLAY", "/run/user/1000/wayland-0"),
            ("WAYLAND_SOCKET", "5"),
            ("DRI_PRIME", "1"),
            ("MESA_VK_DEVICE_SELECT", "10de:2204"),
            ("NODEVICE_SELECT", "0"),
        ] {
            assert!(!is_useless_with(&[variable]), "{variable:?}");
        }
    }
}
