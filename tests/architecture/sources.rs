//! The names in the modules of a crate, read from their tokens.
//!
//! **How it works.** Modules are followed from `lib.rs` by their `mod`, as the compiler does, so that a file is known
//! by the place where it is declared, and `super` means what it means there. Of the tokens only four things matter:
//! attributes that mark test code, `mod`, `use`, and identifiers joined by `::` wherever they occur. Macro arguments
//! are tokens as well, so they are seen too.

use proc_macro2::{Delimiter, Spacing, TokenStream, TokenTree};
use std::collections::{BTreeMap, BTreeSet};

/// Names as they are written, or those from the root of the crate, which is the empty path.
pub(crate) type Path = Vec<String>;

/// The modules of a crate by their paths from its root.
#[derive(Debug, Default)]
pub(crate) struct Sources {
    pub(crate) modules: BTreeMap<Path, Module>,
}

#[derive(Debug, Default)]
pub(crate) struct Module {
    /// Relative to the folder of `lib.rs`. A module in braces is in the file around it.
    pub(crate) file: String,
    pub(crate) is_test: bool,
    pub(crate) children: BTreeSet<String>,
    /// Functions, types, constants and macros.
    pub(crate) declared: BTreeSet<String>,
    pub(crate) mentions: BTreeSet<Mention>,
}

/// A path, as it is written.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Mention {
    pub(crate) path: Path,
    pub(crate) place: Place,
    pub(crate) is_test: bool,
}

/// Position of a path.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Place {
    Use {
        /// The name that it has in the module from there on; a glob has none.
        name: Option<String>,
        is_export: bool,
    },
    Code,
    Comment,
}

impl Mention {
    /// The path from the root, unless it begins with a name, which another `use` has brought or which is below the
    /// module.
    pub(crate) fn absolute(&self, module: &[String]) -> Option<Path> {
        let mut at = module.to_vec();
        for (i, name) in self.path.iter().enumerate() {
            match name.as_str() {
                "crate" => at.clear(),
                "self" => {}
                "super" => drop(at.pop()),
                _ if i == 0 => return None,
                _ => at.push(name.clone()),
            }
        }
        Some(at)
    }
}

impl Module {
    /// The path that a `use` of this module, outside tests, calls `name`.
    pub(crate) fn import(&self, name: &str) -> Option<&[String]> {
        self.uses()
            .find(|(_, known_as)| *known_as == Some(name))
            .map(|(path, _)| path)
    }

    pub(crate) fn globs(&self) -> impl Iterator<Item = &[String]> {
        self.uses().filter(|(_, name)| name.is_none()).map(|(path, _)| path)
    }

    fn uses(&self) -> impl Iterator<Item = (&[String], Option<&str>)> {
        let outside_tests = self.mentions.iter().filter(|mention| !mention.is_test);
        outside_tests.filter_map(|mention| match &mention.place {
            Place::Use { name, .. } => Some((mention.path.as_slice(), name.as_deref())),
            Place::Code | Place::Comment => None,
        })
    }

    /// The names in all paths outside comments.
    pub(crate) fn names_in_code(&self) -> impl Iterator<Item = &str> {
        let in_code = self.mentions.iter().filter(|mention| mention.place != Place::Comment);
        in_code.flat_map(|mention| mention.path.iter().map(String::as_str))
    }
}

impl Sources {
    /// Reads `lib.rs` and its declared modules; `text` returns the contents of a file, if it exists.
    pub(crate) fn read(text: &dyn Fn(&str) -> Option<String>) -> Self {
        let mut reader = Reader {
            text,
            sources: Self::default(),
        };
        let root = Scope {
            file: "lib.rs".into(),
            ..Scope::default()
        };
        let root_text = text(&root.file).expect("a crate has a lib.rs");
        reader.read_file(&root, &root_text);
        reader.sources
    }
}

/// Position of the reader.
#[derive(Debug, Clone, Default)]
struct Scope {
    module: Path,
    file: String,
    /// Folder of the files of child modules, with a `/` at its end.
    folder: String,
    is_test: bool,
}

impl Scope {
    /// Scope of the child `name`: in the same file until another one is found for it.
    fn child(&self, name: &str) -> Self {
        let mut child = self.clone();
        child.module.push(name.into());
        child.folder.extend([name, "/"]);
        child
    }
}

struct Reader<'a> {
    text: &'a dyn Fn(&str) -> Option<String>,
    sources: Sources,
}

impl Reader<'_> {
    fn read_file(&mut self, scope: &Scope, text: &str) {
        let stream: TokenStream = text.parse().unwrap_or_else(|error| panic!("{}: {error}", scope.file));
        let mut tokens = Vec::new();
        flatten(stream, &mut tokens);
        self.read_module(&borrowed(&tokens), scope);
        for path in paths_in_comments(text) {
            self.mention(scope, path, Place::Comment);
        }
    }

    fn read_module(&mut self, tokens: &[&str], scope: &Scope) {
        let module = self.module(scope);
        module.file.clone_from(&scope.file);
        module.is_test = scope.is_test;
        self.read_items(tokens, scope);
    }

    fn read_items(&mut self, tokens: &[&str], scope: &Scope) {
        let mut given_file = None;
        let mut is_export = false;
        let mut rest = tokens;
        while let Some((token, after)) = rest.split_first() {
            let follows_visibility = matches!(*token, "pub" | ")");
            rest = match rest {
                ["#", "[", "cfg", "(", "test", ")", "]", ..] | ["#", "[", "cfg", "(", "all", "(", "test", ",", ..] => {
                    let attribute = 1 + closing(&rest[1..]);
                    let (item, after) = rest[attribute..].split_at(end_of_item(&rest[attribute..]));
                    let test = Scope {
                        is_test: true,
                        ..scope.clone()
                    };
                    self.read_items(item, &test);
                    after
                }
                ["#", "[", "path", "=", file, "]", after @ ..] => {
                    given_file = Some(file.trim_matches('"'));
                    after
                }
                ["#", "[", "cfg_attr", "(", ..] => {
                    let (attribute, after) = rest.split_at(1 + closing(&rest[1..]));
                    self.read_stand_in(attribute, scope);
                    after
                }
                ["mod", name, ";", after @ ..] => {
                    self.read_file_of_child(name, given_file.take(), scope);
                    after
                }
                ["mod", name, "{", ..] => {
                    let end = 2 + closing(&rest[2..]);
                    self.module(scope).children.insert((*name).into());
                    self.read_module(&rest[3..end - 1], &scope.child(name));
                    &rest[end..]
                }
                // `use<'a>` is a bound.
                ["use", next, ..] if *next != "<" => {
                    let mut leaves = Vec::new();
                    let after = read_tree(after, &Path::new(), &mut leaves);
                    for (path, name) in leaves {
                        self.mention(scope, path, Place::Use { name, is_export });
                    }
                    after
                }
                [
                    "fn" | "struct" | "enum" | "trait" | "type" | "const" | "static",
                    name,
                    after @ ..,
                ] if is_name(name) && *name != "fn" => {
                    self.module(scope).declared.insert((*name).into());
                    after
                }
                ["macro_rules", "!", name, after @ ..] => {
                    self.module(scope).declared.insert((*name).into());
                    after
                }
                // Ranges; then fields and methods, and lifetimes, which name no module item.
                [".", ".", after @ ..] | ["." | "'", _, after @ ..] => after,
                [name, ..] if is_name(name) => {
                    let (path, after) = read_path(rest);
                    self.mention(scope, path, Place::Code);
                    after
                }
                _ => after,
            };
            is_export = follows_visibility;
        }
    }

    fn read_file_of_child(&mut self, name: &str, given: Option<&str>, scope: &Scope) {
        self.module(scope).children.insert(name.into());
        let child = scope.child(name);
        let files = match given {
            Some(file) => vec![format!("{}{file}", folder_of(&scope.file))],
            None => vec![format!("{}{name}.rs", scope.folder), format!("{}mod.rs", child.folder)],
        };
        let Some((file, text)) = files.iter().find_map(|file| Some((file, (self.text)(file)?))) else {
            panic!("{} declares {name}, which has no file", scope.file);
        };
        let child = Scope {
            file: file.clone(),
            folder: given.map_or(child.folder, |_| folder_of(file).into()),
            ..child
        };
        self.read_file(&child, &text);
    }

    /// The file that replaces a module where the build lacks a feature: a module of its own name.
    fn read_stand_in(&mut self, attribute: &[&str], scope: &Scope) {
        if let [.., "path", "=", file, ")", "]"] = attribute {
            let file = file.trim_matches('"');
            self.read_file_of_child(file.trim_end_matches(".rs"), Some(file), scope);
        }
    }

    fn module(&mut self, scope: &Scope) -> &mut Module {
        self.sources.modules.entry(scope.module.clone()).or_default()
    }

    fn mention(&mut self, scope: &Scope, path: Path, place: Place) {
        let is_test = scope.is_test;
        self.module(scope).mentions.insert(Mention { path, place, is_test });
    }
}

/// With the `/` at its end.
fn folder_of(file: &str) -> &str {
    &file[..file.rfind('/').map_or(0, |slash| slash + 1)]
}

fn is_name(token: &str) -> bool {
    token.starts_with(|c: char| c.is_alphabetic() || c == '_') && token.chars().all(|c| c.is_alphanumeric() || c == '_')
}

fn borrowed(tokens: &[String]) -> Vec<&str> {
    tokens.iter().map(String::as_str).collect()
}

/// Tokens in a row, brackets among them, with `::` as one.
fn flatten(stream: TokenStream, tokens: &mut Vec<String>) {
    let mut after_colon = false;
    for tree in stream {
        let mut is_first_colon = false;
        match tree {
            TokenTree::Group(group) => {
                let (open, close) = match group.delimiter() {
                    Delimiter::Parenthesis => ("(", ")"),
                    Delimiter::Brace => ("{", "}"),
                    Delimiter::Bracket => ("[", "]"),
                    Delimiter::None => ("", ""),
                };
                tokens.push(open.into());
                flatten(group.stream(), tokens);
                tokens.push(close.into());
            }
            TokenTree::Punct(colon) if colon.as_char() == ':' && after_colon => {
                tokens.pop();
                tokens.push("::".into());
            }
            TokenTree::Punct(punct) => {
                is_first_colon = punct.as_char() == ':' && punct.spacing() == Spacing::Joint;
                tokens.push(punct.as_char().into());
            }
            TokenTree::Ident(name) => tokens.push(name.to_string()),
            TokenTree::Literal(literal) => tokens.push(literal.to_string()),
        }
        after_colon = is_first_colon;
    }
}

/// Number of tokens up to the bracket, inclusive, that closes the first one.
fn closing(tokens: &[&str]) -> usize {
    let mut depth = 0;
    for (i, token) in tokens.iter().enumerate() {
        depth += depth_of(token);
        if depth == 0 {
            return i + 1;
        }
    }
    tokens.len()
}

fn depth_of(token: &str) -> i32 {
    match token {
        "(" | "[" | "{" => 1,
        ")" | "]" | "}" => -1,
        _ => 0,
    }
}

/// Number of tokens of the first item: up to a semicolon or the end of its braces.
fn end_of_item(tokens: &[&str]) -> usize {
    let mut depth = 0;
    for (i, token) in tokens.iter().enumerate() {
        depth += depth_of(token);
        if depth == 0 && matches!(*token, ";" | "}") {
            return i + 1;
        }
    }
    tokens.len()
}

/// The names that `::` joins, and the tokens after them.
fn read_path<'a, 'b>(tokens: &'b [&'a str]) -> (Path, &'b [&'a str]) {
    let mut path = vec![tokens[0].to_string()];
    let mut rest = &tokens[1..];
    while let ["::", name, after @ ..] = rest
        && is_name(name)
    {
        path.push((*name).into());
        rest = after;
    }
    (path, rest)
}

/// Reads the tree of a `use` below `stem` into paths and the names that they are given, none for a glob. The tokens
/// after it are returned.
fn read_tree<'a, 'b>(tokens: &'b [&'a str], stem: &Path, leaves: &mut Vec<(Path, Option<String>)>) -> &'b [&'a str] {
    let joined = |name: &str| [stem.as_slice(), &[name.to_string()]].concat();
    match tokens {
        ["{", after @ ..] => {
            let mut rest = after;
            loop {
                rest = match rest {
                    [] => return rest,
                    ["}", after @ ..] => return after,
                    [",", after @ ..] => after,
                    _ => read_tree(rest, stem, leaves),
                };
            }
        }
        ["*", after @ ..] => {
            leaves.push((stem.clone(), None));
            after
        }
        [name, "::", after @ ..] if is_name(name) => read_tree(after, &joined(name), leaves),
        ["self", after @ ..] if !stem.is_empty() => read_name(stem.clone(), after, leaves),
        [name, after @ ..] if is_name(name) => read_name(joined(name), after, leaves),
        [_, after @ ..] => after,
        [] => tokens,
    }
}

/// Reads the end of a path in the tree of a `use`, which may have another name there.
fn read_name<'a, 'b>(path: Path, tokens: &'b [&'a str], leaves: &mut Vec<(Path, Option<String>)>) -> &'b [&'a str] {
    let (name, after) = match tokens {
        ["as", name, after @ ..] => (Some((*name).into()), after),
        _ => (path.last().cloned(), tokens),
    };
    leaves.push((path, name));
    after
}

/// Links of comments: anything that looks like a path from the root or the module above. Examples name the crate as
/// others do.
fn paths_in_comments(text: &str) -> Vec<Path> {
    let comments: Vec<&str> = text.lines().filter_map(|line| Some(line.split_once("//")?.1)).collect();
    let tokens = words(&comments);
    let mut leaves = Vec::new();
    let mut rest = tokens.as_slice();
    while !rest.is_empty() {
        rest = match rest {
            ["pointreel", "::", after @ ..] => read_tree(after, &vec!["crate".into()], &mut leaves),
            ["crate" | "super" | "self", "::", ..] => read_tree(rest, &Path::new(), &mut leaves),
            [_, after @ ..] => after,
            [] => break,
        };
    }
    leaves.into_iter().map(|(path, _)| path).collect()
}

/// Names, `::` and single other characters of texts that need not be code.
fn words<'a>(texts: &[&'a str]) -> Vec<&'a str> {
    let mut words = Vec::new();
    for text in texts {
        let mut rest = text.trim_start_matches(['/', '!']).trim_start();
        while let Some(first) = rest.chars().next() {
            let is_part = |c: char| c.is_alphanumeric() || c == '_';
            let length = if rest.starts_with("::") {
                2
            } else if is_part(first) {
                rest.find(|c| !is_part(c)).unwrap_or(rest.len())
            } else {
                first.len_utf8()
            };
            let (word, after) = rest.split_at(length);
            words.push(word);
            rest = after.trim_start();
        }
    }
    words
}
