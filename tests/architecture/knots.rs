//! Files that import one another.
//!
//! **How it works.** Each name of a file is followed through the `use` of the modules on its way to the file that
//! defines it. Files are the nodes of a graph, and those that can be reached from each other are a knot: none of them
//! can be read, or taken out, without the others.

use super::sources::{Mention, Path, Place, Sources};
use std::collections::{BTreeMap, BTreeSet, VecDeque};

/// For each file those that it imports, each with a path that does so.
pub(crate) type Imports = BTreeMap<String, BTreeMap<String, String>>;

pub(crate) type Knot = BTreeSet<String>;

/// What a path leads to.
enum Target {
    Module(Path),
    /// Something that is defined in this module.
    Item(Path),
}

/// Longer chains of `use` are circles of globs.
const MAX_USES: usize = 16;

/// What files import, tests left out.
pub(crate) fn imports(sources: &Sources) -> Imports {
    let mut imports = Imports::new();
    for (path, module) in &sources.modules {
        if module.is_test {
            continue;
        }
        let of_file = imports.entry(module.file.clone()).or_default();
        let mut mentions: Vec<&Mention> = module.mentions.iter().filter(|mention| !mention.is_test).collect();
        // What is written in full is shown rather than what follows from it.
        mentions.sort_by_key(|mention| mention.place == Place::Code);
        for mention in mentions {
            let is_glob = match &mention.place {
                Place::Comment | Place::Use { is_export: true, .. } => continue,
                Place::Use { name, .. } => name.is_none(),
                Place::Code => false,
            };
            let definer = match resolve(sources, path, &mention.path, MAX_USES) {
                Some(Target::Item(module)) => module,
                Some(Target::Module(module)) if is_glob => module,
                _ => continue,
            };
            let file = &sources.modules[&definer].file;
            if *file != module.file {
                of_file.entry(file.clone()).or_insert_with(|| mention.path.join("::"));
            }
        }
    }
    imports
}

/// Follows `path`, as written in the module `at`. Names of other crates and of what is local to a function lead
/// nowhere.
fn resolve(sources: &Sources, at: &[String], path: &[String], uses_left: usize) -> Option<Target> {
    let uses_left = uses_left.checked_sub(1)?;
    let mut at = at.to_vec();
    for (i, name) in path.iter().enumerate() {
        let module = &sources.modules[&at];
        let is_child = module.children.contains(name);
        let is_last = i + 1 == path.len();
        match name.as_str() {
            "crate" => at.clear(),
            "self" => {}
            "super" => drop(at.pop()),
            // A function may have the name of its module: it is meant where the path ends.
            _ if is_child && (!is_last || module.import(name).is_none()) => at.push(name.clone()),
            _ => {
                let target = match module.import(name) {
                    Some(import) => resolve(sources, &at, import, uses_left),
                    None if module.declared.contains(name) => Some(Target::Item(at.clone())),
                    None => by_glob(sources, &at, name, uses_left)
                        // What a macro makes is seen nowhere, but is there if a path leads there.
                        .or_else(|| (i > 0).then(|| Target::Item(at.clone()))),
                };
                match target {
                    Some(Target::Module(module)) => at = module,
                    found => return found,
                }
            }
        }
    }
    Some(Target::Module(at))
}

fn by_glob(sources: &Sources, at: &[String], name: &str, uses_left: usize) -> Option<Target> {
    let mut globs = sources.modules[at].globs();
    globs.find_map(|glob| match resolve(sources, at, glob, uses_left)? {
        Target::Module(module) => resolve(sources, &module, &[name.to_string()], uses_left),
        Target::Item(_) => None,
    })
}

/// The strongly connected components of more than one file.
pub(crate) fn knots(imports: &Imports) -> BTreeSet<Knot> {
    let reached: BTreeMap<&str, BTreeSet<&str>> = imports
        .keys()
        .map(|file| (file.as_str(), reached_from(imports, file)))
        .collect();
    reached
        .iter()
        .map(|(file, others)| {
            others
                .iter()
                .filter(|other| reached[**other].contains(file))
                .map(ToString::to_string)
                .collect()
        })
        .filter(|knot: &Knot| knot.len() > 1)
        .collect()
}

fn reached_from<'a>(imports: &'a Imports, file: &'a str) -> BTreeSet<&'a str> {
    let mut reached = BTreeSet::new();
    let mut left = vec![file];
    while let Some(next) = left.pop() {
        let new = imports[next].keys().map(String::as_str);
        left.extend(new.filter(|file| reached.insert(*file)));
    }
    reached
}

/// The shortest way from a file of a knot back to itself, an import a line.
pub(crate) fn circle(imports: &Imports, file: &str) -> String {
    let mut line_to: BTreeMap<&str, (&str, String)> = BTreeMap::new();
    let mut left = VecDeque::from([file]);
    while let Some(from) = left.pop_front()
        && !line_to.contains_key(file)
    {
        for (to, path) in &imports[from] {
            line_to.entry(to).or_insert_with(|| {
                left.push_back(to);
                (from, format!("  {from} imports {to}: {path}"))
            });
        }
    }
    let mut lines = Vec::new();
    let mut at = file;
    while let Some((from, line)) = line_to.get(at) {
        lines.insert(0, line.as_str());
        at = from;
        if at == file {
            break;
        }
    }
    lines.join("\n")
}

/// What is wrong with the list of known knots: files that were tied to one, knots that are new, and those that are
/// smaller than listed.
pub(crate) fn differences(imports: &Imports, known: &[&[&str]]) -> Vec<String> {
    let mut wrong = Vec::new();
    let found = knots(imports);
    let known: BTreeSet<Knot> = known
        .iter()
        .map(|files| files.iter().map(ToString::to_string).collect())
        .collect();
    for knot in found.difference(&known) {
        let nearest = known.iter().max_by_key(|files| files.intersection(knot).count());
        let listed = nearest.cloned().unwrap_or_default();
        for file in knot.difference(&listed) {
            wrong.push(format!(
                "{file} is tied into a knot of {} files by\n{}",
                knot.len(),
                circle(imports, file)
            ));
        }
    }
    for listed in known.difference(&found) {
        let rests: Vec<&Knot> = found.iter().filter(|knot| !knot.is_disjoint(listed)).collect();
        let tied: Knot = rests.iter().copied().flatten().cloned().collect();
        for file in listed.difference(&tied) {
            wrong.push(format!("{file} is tied no longer: take it off the list"));
        }
        if rests.len() > 1 {
            wrong.push(format!(
                "the knot of {} is {} knots now: take it apart in the list",
                listed.first().map_or("", String::as_str),
                rests.len()
            ));
        }
    }
    wrong
}
