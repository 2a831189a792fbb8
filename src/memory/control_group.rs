//! The memory that the control groups of this process leave it (Linux): a Slurm job, a service with `MemoryMax`, a
//! container without a namespace of its own.
//!
//! **How it works.** `/proc/self/cgroup` names the group of each hierarchy. Each group and every one above it may have
//! a limit; the least of them holds. Version 2 of control groups has one hierarchy, version 1 one per controller.

use std::fs;
use std::path::Path;

/// The smallest limit of all groups of this process, bytes; `None` if there is none.
pub(super) fn limit_bytes() -> Option<u64> {
    let groups = fs::read_to_string("/proc/self/cgroup").ok()?;
    limit_of(&groups, Path::new("/sys/fs/cgroup"))
}

/// The smallest limit of the groups named by the lines of `groups`, whose hierarchies are mounted in `mounts`.
fn limit_of(groups: &str, mounts: &Path) -> Option<u64> {
    let limits = groups.lines().filter_map(|line| {
        let (_, rest) = line.split_once(':')?;
        let (controllers, group) = rest.split_once(':')?;
        let (mount, file) = match controllers {
            "" => (mounts.to_owned(), "memory.max"),
            _ if controllers.split(',').any(|name| name == "memory") => {
                (mounts.join("memory"), "memory.limit_in_bytes")
            }
            _ => return None,
        };
        let groups = Path::new(group).ancestors();
        let limits = groups.filter_map(|group| {
            let group = group.strip_prefix("/").unwrap_or(group);
            // "max" is not a number.
            fs::read_to_string(mount.join(group).join(file))
                .ok()?
                .trim()
                .parse()
                .ok()
        });
        limits.min()
    });
    limits.min()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn write(folder: &Path, file: &str, text: &str) {
        let path = folder.join(file);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }

    #[test]
    fn the_smallest_limit_of_a_group_and_its_ancestors_applies() {
        let folder = tempfile::tempdir().unwrap();
        let mounts = folder.path();
        write(mounts, "slurm/job_7/memory.max", "419430400\n");
        write(mounts, "slurm/job_7/step_0/memory.max", "max\n");
        write(mounts, "slurm/memory.max", "900000000\n");
        assert_eq!(limit_of("0::/slurm/job_7/step_0\n", mounts), Some(419_430_400));
        assert_eq!(limit_of("0::/slurm/job_8\n", mounts), Some(900_000_000));
        assert_eq!(limit_of("0::/other\n", mounts), None);
        assert_eq!(limit_of("nonsense\n", mounts), None);
    }

    #[test]
    fn version_1_has_a_separate_memory_hierarchy() {
        let folder = tempfile::tempdir().unwrap();
        let mounts = folder.path();
        write(mounts, "memory/jobs/a/memory.limit_in_bytes", "1048576\n");
        write(mounts, "memory/memory.limit_in_bytes", "9223372036854771712\n");
        let groups = "12:cpu,cpuacct:/jobs/a\n4:memory:/jobs/a\n0::/\n";
        assert_eq!(limit_of(groups, mounts), Some(1_048_576));
        assert_eq!(limit_of("4:memory:/\n", mounts), Some(9_223_372_036_854_771_712));
    }
}
