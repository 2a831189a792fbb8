//! WGSL assembly of a shader. WGSL has no includes: files declare their imports in lines `#import NAME`, a shader names
//! some files, and their imports are put before them, each file once.
//!
//! A name denotes a file of `shaders/`, or something defined in Rust as well (`generated/…`), so that no constant,
//! structure or binding is written twice. Parts that only some shaders have (such as the source of records) are not
//! imported: a shader names one of the files that have it.

use super::shader_library::{GENERATED, LIBRARY};
use super::shader_reload;
use std::borrow::Cow;

pub use super::shader_file::ShaderFile;
pub(in crate::render) use super::shader_file::shader_file;

/// An import that cannot be followed.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ImportError {
    /// There is nothing of this name.
    #[error("{file}:{line}: {name} does not exist and cannot be imported")]
    Unknown {
        /// The file with the import.
        file: String,
        /// Its line, from 1 on.
        line: usize,
        /// Name of the import.
        name: String,
    },
    /// A file needs itself.
    #[error("{file}:{line}: the import of {name} goes in a circle: {circle}")]
    Cycle {
        /// The file with the import.
        file: String,
        /// Its line, from 1 on.
        line: usize,
        /// Name of the import.
        name: String,
        /// From that file back to it.
        circle: String,
    },
}

/// The WGSL of `files` and of all that they import, after the texts `given` to this shader alone, by the names that
/// they are imported by.
pub(super) fn assembled(given: &[(&str, String)], files: &[ShaderFile]) -> Result<String, ImportError> {
    let of_given = given.iter().map(|(name, _)| *name);
    let roots: Vec<&str> = of_given.chain(files.iter().map(|file| file.name)).collect();
    assembled_from(&roots, |name| {
        let of_shader = given.iter().find(|(known, _)| *known == name);
        if let Some((_, text)) = of_shader {
            return Some(Cow::Owned(text.clone()));
        }
        let mut all = files.iter().chain(LIBRARY);
        if let Some(file) = all.find(|file| file.name == name) {
            return Some(shader_reload::text_of(file));
        }
        let generated = GENERATED.iter().find(|(known, _)| *known == name);
        generated.map(|(_, text)| Cow::Owned(text()))
    })
}

/// A source; an import that cannot be followed is logged, and the adapter refuses the rest.
pub(super) fn source_or_nothing(source: Result<String, ImportError>) -> String {
    source.unwrap_or_else(|error| {
        log::error!("shaders: {error}");
        String::new()
    })
}

/// Assembles a shader from any texts: `text_of` looks them up by name.
fn assembled_from<'a>(roots: &[&str], text_of: impl Fn(&str) -> Option<Cow<'a, str>>) -> Result<String, ImportError> {
    let mut assembly = Assembly {
        text_of,
        begun: Vec::new(),
        done: Vec::new(),
        source: String::new(),
    };
    for root in roots {
        let text = (assembly.text_of)(root).unwrap_or_default();
        if !assembly.done.iter().any(|done| done == root) {
            assembly.add(root, &text)?;
        }
    }
    Ok(assembly.source)
}

/// A shader that is being put together.
struct Assembly<Texts> {
    text_of: Texts,
    /// The file that is being added, and those that import it.
    begun: Vec<String>,
    /// Names of the files that are in the source already.
    done: Vec<String>,
    source: String,
}

impl<'a, Texts: Fn(&str) -> Option<Cow<'a, str>>> Assembly<Texts> {
    /// Adds a text behind all that it imports.
    fn add(&mut self, name: &str, text: &str) -> Result<(), ImportError> {
        self.begun.push(name.to_owned());
        for (index, line) in text.lines().enumerate() {
            if let Some(import) = imported_by(line) {
                self.import(import, index + 1)?;
            }
        }
        self.begun.pop();
        self.done.push(name.to_owned());
        self.source.push_str("// ");
        self.source.push_str(name);
        self.source.push('\n');
        for line in text.lines().filter(|line| imported_by(line).is_none()) {
            self.source.push_str(line);
            self.source.push('\n');
        }
        Ok(())
    }

    /// Adds the import in a line of the file begun last, unless it is there.
    fn import(&mut self, name: &str, line: usize) -> Result<(), ImportError> {
        if self.done.iter().any(|done| done == name) {
            return Ok(());
        }
        let file = self.begun.last().cloned().unwrap_or_default();
        if let Some(first) = self.begun.iter().position(|begun| begun == name) {
            let circle = [&self.begun[first..], &[name.to_owned()]].concat().join(" → ");
            let name = name.to_owned();
            return Err(ImportError::Cycle {
                file,
                line,
                name,
                circle,
            });
        }
        match (self.text_of)(name) {
            Some(text) => self.add(name, &text),
            None => Err(ImportError::Unknown {
                file,
                line,
                name: name.to_owned(),
            }),
        }
    }
}

/// Returns the name that a line imports.
fn imported_by(line: &str) -> Option<&str> {
    line.strip_prefix("#import ").map(str::trim)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn assembled_of(roots: &[&str], files: &[(&str, &'static str)]) -> Result<String, String> {
        let text_of = |name: &str| {
            let file = files.iter().find(|(known, _)| *known == name);
            file.map(|(_, text)| Cow::Borrowed(*text))
        };
        assembled_from(roots, text_of).map_err(|error| error.to_string())
    }

    #[test]
    fn every_file_is_included_once_after_its_imports() {
        let files = [
            ("pass", "#import light\n#import view\nfn pass() {}"),
            ("light", "// Light.\n\n#import view\nfn light() {}"),
            ("view", "fn view() {}"),
        ];
        let source = assembled_of(&["pass", "light"], &files).unwrap();
        assert_eq!(
            source,
            "// view\nfn view() {}\n// light\n// Light.\n\nfn light() {}\n// pass\nfn pass() {}\n"
        );
    }

    #[test]
    fn an_unknown_import_is_an_error_with_its_location() {
        let error = assembled_of(&["pass"], &[("pass", "// A pass.\n\n#import ligth\n")]).unwrap_err();
        assert_eq!(error, "pass:3: ligth does not exist and cannot be imported");
    }

    #[test]
    fn a_cycle_of_imports_is_an_error_with_its_location() {
        let files = [("pass", "#import a"), ("a", "\n#import b"), ("b", "#import a")];
        let error = assembled_of(&["pass"], &files).unwrap_err();
        assert_eq!(error, "b:1: the import of a goes in a circle: a → b → a");
    }

    #[test]
    fn a_file_that_imports_itself_is_a_cycle() {
        let error = assembled_of(&["a"], &[("a", "#import a")]).unwrap_err();
        assert_eq!(error, "a:1: the import of a goes in a circle: a → a");
    }
}
