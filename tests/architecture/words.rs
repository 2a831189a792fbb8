//! Words that the glossary replaces: their numbers may only shrink.

use proc_macro2::{TokenStream, TokenTree};
use std::collections::{BTreeMap, HashMap};
use std::fmt::Write as _;

/// Counts of one row of the glossary, by where its phrases were found.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Counts {
    pub(crate) pages: usize,
    pub(crate) strings: usize,
    pub(crate) doc_comments: usize,
    pub(crate) names: usize,
}

impl Counts {
    pub(crate) fn is_within(&self, other: &Self) -> bool {
        self.pages <= other.pages
            && self.strings <= other.strings
            && self.doc_comments <= other.doc_comments
            && self.names <= other.names
    }
}

/// Scope in which the phrases of a row must not be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Scope {
    Texts,
    Names,
    All,
}

/// A row of the glossary.
#[derive(Debug)]
struct Row {
    /// First column, as written: the key of the row.
    key: String,
    scope: Scope,
}

#[derive(Debug)]
pub(crate) struct Glossary {
    rows: Vec<Row>,
    /// By their first word: the row, and the words after it in lower case; `…` matches any word.
    phrases: HashMap<String, Vec<(usize, Vec<String>)>>,
    /// First words that a doc comment must not begin with.
    first_words: Vec<Vec<String>>,
}

/// Key of the row of [`Tally`] for first words of doc comments.
const FIRST_WORDS: &str = "first words";

/// Counts by the key of the row.
pub(crate) type Tally = BTreeMap<String, Counts>;

/// The parts of a Rust file that the glossary applies to.
#[derive(Debug, Default)]
struct Spoken {
    strings: Vec<String>,
    /// Consecutive lines are one comment.
    doc_comments: Vec<String>,
    names: Vec<String>,
}

impl Glossary {
    /// Reads the tables of `docs/glossary.md`.
    pub(crate) fn read(page: &str) -> Self {
        let rows: Vec<Row> = page
            .lines()
            .filter_map(|line| {
                let cells: Vec<&str> = line
                    .strip_prefix('|')?
                    .strip_suffix('|')?
                    .split('|')
                    .map(str::trim)
                    .collect();
                let &[key, _, scope] = cells.as_slice() else {
                    return None;
                };
                let scope = match scope {
                    "texts" => Scope::Texts,
                    "names" => Scope::Names,
                    "all" => Scope::All,
                    _ => return None,
                };
                Some(Row {
                    key: key.to_owned(),
                    scope,
                })
            })
            .collect();
        let first_words = page
            .split_once("begin with: ")
            .map_or(Vec::new(), |(_, list)| phrases(list.trim().trim_end_matches('.')));
        let mut by_first: HashMap<String, Vec<_>> = HashMap::new();
        for (row, entry) in rows.iter().enumerate() {
            for mut phrase in phrases(&entry.key) {
                let rest = phrase.split_off(1);
                by_first.entry(phrase.remove(0)).or_default().push((row, rest));
            }
        }
        Self {
            rows,
            phrases: by_first,
            first_words,
        }
    }

    /// The rows, among those of `scopes`, whose phrases are in `words`, each as often as it occurs.
    fn found<'a>(&'a self, words: &'a [String], scopes: &'a [Scope]) -> impl Iterator<Item = &'a Row> {
        words.iter().enumerate().flat_map(move |(at, first)| {
            let phrases = self.phrases.get(first).into_iter().flatten();
            phrases.filter_map(move |(row, rest)| {
                let following = words.get(at + 1..at + 1 + rest.len())?;
                let is_found = following
                    .iter()
                    .zip(rest)
                    .all(|(word, wanted)| wanted == "…" || word == wanted);
                Some(&self.rows[*row]).filter(|row| is_found && scopes.contains(&row.scope))
            })
        })
    }

    /// A row for each of the glossary, of nothing.
    pub(crate) fn empty_tally(&self) -> Tally {
        let keys = self.rows.iter().map(|row| row.key.clone());
        keys.chain([FIRST_WORDS.to_owned()])
            .map(|key| (key, Counts::default()))
            .collect()
    }

    pub(crate) fn number_of_rows(&self) -> usize {
        self.rows.len()
    }

    /// Adds the words of a page in Markdown. Code in it is ignored.
    pub(crate) fn count_page(&self, page: &str, tally: &mut Tally) {
        let mut is_code = false;
        let mut prose = String::new();
        for line in page.lines() {
            if line.trim_start().starts_with("```") {
                is_code = !is_code;
            } else if !is_code {
                prose.push_str(line);
                prose.push('\n');
            }
        }
        let words = words(&without_code(&prose));
        for row in self.found(&words, &[Scope::Texts, Scope::All]) {
            tally.get_mut(&row.key).unwrap().pages += 1;
        }
    }

    /// Adds the words of a Rust file; its tests are ignored.
    pub(crate) fn count_rust(&self, tokens: TokenStream, tally: &mut Tally) {
        let mut spoken = Spoken::default();
        listen(tokens, &mut spoken);
        for text in &spoken.strings {
            let words = words(text);
            for row in self.found(&words, &[Scope::Texts, Scope::All]) {
                tally.get_mut(&row.key).unwrap().strings += 1;
            }
        }
        for comment in &spoken.doc_comments {
            let words = words(&without_code(comment));
            for row in self.found(&words, &[Scope::All]) {
                tally.get_mut(&row.key).unwrap().doc_comments += 1;
            }
            let begins_so = self.first_words.iter().any(|first| words.starts_with(first));
            tally.get_mut(FIRST_WORDS).unwrap().doc_comments += usize::from(begins_so);
        }
        for name in &spoken.names {
            let parts = parts_of_name(name);
            for row in self.found(&parts, &[Scope::Names, Scope::All]) {
                tally.get_mut(&row.key).unwrap().names += 1;
            }
        }
    }
}

/// A table of counts, one row per line, as it is stored.
pub(crate) fn written(tally: &Tally) -> String {
    let mut text = String::from("phrases\tpages\tstrings\tdoc comments\tnames\n");
    for (key, counts) in tally {
        let Counts {
            pages,
            strings,
            doc_comments,
            names,
        } = counts;
        writeln!(text, "{key}\t{pages}\t{strings}\t{doc_comments}\t{names}").unwrap();
    }
    text
}

/// The inverse of [`written`].
pub(crate) fn read_tally(text: &str) -> Tally {
    text.lines()
        .skip(1)
        .map(|line| {
            let cells: Vec<&str> = line.split('\t').collect();
            let number = |column: usize| cells[column].parse().unwrap();
            let counts = Counts {
                pages: number(1),
                strings: number(2),
                doc_comments: number(3),
                names: number(4),
            };
            (cells[0].to_owned(), counts)
        })
        .collect()
}

fn phrases(list: &str) -> Vec<Vec<String>> {
    list.split(';').map(words).filter(|phrase| !phrase.is_empty()).collect()
}

/// Words of a text in lower case. An apostrophe or a hyphen within a word belongs to it.
fn words(text: &str) -> Vec<String> {
    text.split(|c: char| !(c.is_alphanumeric() || "'’-…_".contains(c)))
        .map(|word| word.trim_matches(['\'', '-', '’']).to_lowercase())
        .filter(|word| !word.is_empty())
        .collect()
}

/// Without the text in backticks.
fn without_code(text: &str) -> String {
    text.split('`').step_by(2).collect::<Vec<_>>().join(" code ")
}

/// `is_retained`, `RetainedLevels` and `RETAINED_BYTES` all have the part `retained`.
fn parts_of_name(name: &str) -> Vec<String> {
    let mut parts: Vec<String> = Vec::new();
    let mut was_lower = false;
    for c in name.chars() {
        if c == '_' {
            parts.push(String::new());
        } else {
            if parts.is_empty() || (c.is_uppercase() && was_lower) {
                parts.push(String::new());
            }
            parts.last_mut().unwrap().extend(c.to_lowercase());
        }
        was_lower = c.is_lowercase();
    }
    parts.retain(|part| !part.is_empty());
    parts
}

/// Returns true if `attribute`, the text in the brackets, marks the next item as test code.
fn is_of_tests(attribute: &TokenStream) -> bool {
    let text = attribute.to_string();
    text == "test" || text.starts_with("cfg (test") || text.starts_with("cfg(test")
}

/// The text of a doc attribute.
fn doc_line(attribute: TokenStream) -> Option<String> {
    let mut tokens = attribute.into_iter();
    let is_doc = matches!(tokens.next()?, TokenTree::Ident(name) if name == "doc");
    let is_assigned = matches!(tokens.next()?, TokenTree::Punct(sign) if sign.as_char() == '=');
    match tokens.next()? {
        TokenTree::Literal(text) if is_doc && is_assigned => text_of(&text.to_string()),
        _ => None,
    }
}

/// The text of a literal, if it is a string.
fn text_of(literal: &str) -> Option<String> {
    let start = literal.find('"')?;
    let end = literal.rfind('"').filter(|end| *end > start)?;
    (literal.starts_with('"') || literal.starts_with('r'))
        .then(|| literal[start + 1..end].replace("\\n", " ").replace('\\', " "))
}

fn listen(tokens: TokenStream, spoken: &mut Spoken) {
    let mut tokens = tokens.into_iter().peekable();
    let mut comment: Vec<String> = Vec::new();
    while let Some(token) = tokens.next() {
        if let TokenTree::Punct(sign) = &token
            && sign.as_char() == '#'
        {
            // Inner doc comments have a `!` before their brackets.
            if matches!(tokens.peek(), Some(TokenTree::Punct(sign)) if sign.as_char() == '!') {
                tokens.next();
            }
            let Some(TokenTree::Group(attribute)) = tokens.next() else {
                continue;
            };
            if is_of_tests(&attribute.stream()) {
                comment.clear();
                skip_item(&mut tokens);
            } else if let Some(line) = doc_line(attribute.stream()) {
                comment.push(line);
            }
            continue;
        }
        if !comment.is_empty() {
            spoken.doc_comments.push(comment.join("\n"));
            comment.clear();
        }
        match token {
            TokenTree::Group(group) => listen(group.stream(), spoken),
            TokenTree::Ident(name) => spoken.names.push(name.to_string()),
            TokenTree::Literal(literal) => spoken.strings.extend(text_of(&literal.to_string())),
            TokenTree::Punct(_) => {}
        }
    }
    if !comment.is_empty() {
        spoken.doc_comments.push(comment.join("\n"));
    }
}

/// Goes behind the item that follows: its body, or its semicolon.
fn skip_item(tokens: &mut impl Iterator<Item = TokenTree>) {
    for token in tokens {
        match token {
            TokenTree::Group(group) if group.delimiter() == proc_macro2::Delimiter::Brace => return,
            TokenTree::Punct(sign) if sign.as_char() == ';' => return,
            _ => {}
        }
    }
}

#[test]
fn phrases_are_found_in_texts_comments_and_names() {
    let glossary = Glossary::read(
        "| not | write | where |\n|---|---|---|\n| kept | cached | names |\n| told by; a file a … | by | all |\n\n\
         counts those that begin with: What; The same.\n",
    );
    let source = "
        //! What files say.
        //! More.
        /// A number that is told by `told by` a name.
        fn is_kept() -> &'static str { \"A file a frame, Told\\nby others, kept\" }
        /// The same for tests.
        #[cfg(test)]
        mod tests { fn kept() { \"told by\"; } }
        const KEPT_BYTES: u8 = 0; struct WholeKept; #[test] fn kept() {}";
    let mut tally = glossary.empty_tally();
    glossary.count_rust(source.parse().unwrap(), &mut tally);
    glossary.count_page("It is told\nby `told by` names, kept.\n```\ntold by\n```\n", &mut tally);
    let of = |key: &str| tally[key];
    assert_eq!(
        of("kept"),
        Counts {
            names: 3,
            ..Counts::default()
        }
    );
    let told = Counts {
        pages: 1,
        strings: 2,
        doc_comments: 1,
        names: 0,
    };
    assert_eq!(of("told by; a file a …"), told);
    assert_eq!(
        of(FIRST_WORDS),
        Counts {
            doc_comments: 1,
            ..Counts::default()
        }
    );
    assert_eq!(read_tally(&written(&tally)), tally);
}
