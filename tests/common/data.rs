//! Clouds of other programs. They are outside the project, in `../shared/data`, and a clone of it does not have them.

use std::io::Write as _;
use std::path::{Path, PathBuf};

/// A file or folder of that data. If it is missing, that is reported, as a test that checks less must not pass in
/// silence; and under continuous integration (`CI=true`), where it has to be there, the test fails.
pub(crate) fn shared(name: &str) -> Option<PathBuf> {
    let project = Path::new(env!("CARGO_MANIFEST_DIR"));
    let path = project.join("../shared/data").join(name);
    if path.exists() {
        return Some(path);
    }
    // The test harness names threads after tests.
    let thread = std::thread::current();
    let test = thread.name().unwrap_or("a test");
    let path = path.display();
    assert!(
        std::env::var_os("CI").is_none_or(|value| value != "true"),
        "{test} needs {path}, which is not there. With CI=true the data of the tests has to be in the folder \
         shared/data beside that of the project; without, it is passed over"
    );
    // Not by `eprintln!`: the harness captures the output of passing tests. If stderr is closed, the test continues.
    let _ = writeln!(std::io::stderr(), "{test} skips {path}: it is not there");
    None
}
