//! GPU presence test that does not open a driver.
//!
//! To open Vulkan only to learn that its one adapter is a software rasteriser takes 0.3 s, and more where many drivers
//! are installed. Linux exposes a GPU as a device file, so there a look at the names in `/dev` is enough to know that
//! there is none. Other systems always have a driver of their own, and are queried.

use std::io;
use std::path::Path;

/// Devices of GPUs whose drivers need no render node: NVIDIA's (containers may have any number), Windows' below Linux,
/// AMD's for computing, and ARM's, Qualcomm's and NVIDIA's on small boards.
const DEVICES: &[&str] = &["nvidiactl", "dxg", "kfd", "mali0", "kgsl-3d0", "nvhost-gpu"];

/// Returns false where there is certainly no GPU, so that no driver needs to be opened to look for one.
pub(crate) fn may_have_gpu() -> bool {
    !cfg!(target_os = "linux") || may_have_gpu_in(Path::new("/dev"))
}

/// [`may_have_gpu`] of a folder of device files. Inaccessible devices may be there.
fn may_have_gpu_in(devices: &Path) -> bool {
    has_name(devices, |name| DEVICES.contains(&name) || is_numbered(name, "nvidia"))
        || has_name(&devices.join("dri"), |name| is_numbered(name, "renderD"))
}

fn is_numbered(name: &str, prefix: &str) -> bool {
    name.strip_prefix(prefix)
        .is_some_and(|number| !number.is_empty() && number.bytes().all(|b| b.is_ascii_digit()))
}

fn has_name(folder: &Path, is_wanted: impl Fn(&str) -> bool) -> bool {
    match folder.read_dir() {
        Ok(mut entries) => {
            entries.any(|entry| entry.map_or(true, |entry| entry.file_name().to_str().is_some_and(&is_wanted)))
        }
        Err(error) => error.kind() != io::ErrorKind::NotFound,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    fn folder_with(names: &[&str]) -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        for name in names {
            let path = folder.path().join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, []).unwrap();
        }
        folder
    }

    #[test]
    fn a_machine_without_gpu_devices_has_no_gpu() {
        // A display without a GPU has only an output node.
        for names in [
            &[][..],
            &["null", "fb0", "dri/card0", "dri/by-path/renderD128"],
            &["nvidia", "nvidia-caps", "nvidiax0", "dri/renderD", "renderD128"],
        ] {
            let folder = folder_with(names);
            assert!(!may_have_gpu_in(folder.path()), "{names:?}");
        }
        assert!(!may_have_gpu_in(Path::new("/none/such")));
    }

    #[test]
    fn each_kind_of_device_is_detected() {
        for name in [
            "dri/renderD128",
            "nvidia0",
            "nvidia3",
            "nvidiactl",
            "dxg",
            "kfd",
            "mali0",
        ] {
            let folder = folder_with(&["null", name]);
            assert!(may_have_gpu_in(folder.path()), "{name}");
        }
    }

    #[test]
    fn an_unreadable_device_folder_may_contain_a_gpu() {
        // A file in place of the folder fails with a different error than a missing folder.
        let folder = folder_with(&["dri"]);
        assert!(may_have_gpu_in(folder.path()));
    }
}
