//! Tuples in the parameters of functions, read from tokens: they hide the number of arguments, and have no names.

use proc_macro2::{Delimiter, TokenStream, TokenTree};

/// Number of parts of tuples in the parameters of the functions of a file; closures and function types do not count.
pub(crate) fn tuples(text: &str) -> Vec<(String, usize)> {
    let mut found = Vec::new();
    look_into(text.parse().expect("a file of Rust"), &mut found);
    found
}

fn look_into(stream: TokenStream, found: &mut Vec<(String, usize)>) {
    let trees: Vec<TokenTree> = stream.into_iter().collect();
    for (i, tree) in trees.iter().enumerate() {
        if let (true, Some(TokenTree::Ident(name))) = (is_word(tree, "fn"), trees.get(i + 1)) {
            let parameters = parameters(&trees[i + 2..]);
            let tuples = parameters.iter().filter_map(|parameter| tuple_in(parameter));
            found.extend(tuples.map(|parts| (name.to_string(), parts)));
        }
        if let TokenTree::Group(group) = tree {
            look_into(group.stream(), found);
        }
    }
}

/// The parameters of a function, from the tokens after its name.
fn parameters(trees: &[TokenTree]) -> Vec<Vec<TokenTree>> {
    let mut depth = 0;
    let mut follows_dash = false;
    for tree in trees {
        depth += step_into(tree, follows_dash);
        follows_dash = is_sign(tree, '-') || is_sign(tree, '=');
        if let (0, Some(parameters)) = (depth, in_brackets(tree, Delimiter::Parenthesis)) {
            return split(parameters, ',');
        }
    }
    Vec::new()
}

/// Change in the depth of angle brackets behind a token.
fn step_into(tree: &TokenTree, follows_dash: bool) -> i32 {
    i32::from(is_sign(tree, '<')) - i32::from(is_sign(tree, '>') && !follows_dash)
}

/// The parts of the tuple that a parameter is, by its pattern or its type.
fn tuple_in(parameter: &[TokenTree]) -> Option<usize> {
    let mut sides = split(parameter.iter().cloned().collect(), ':').into_iter();
    let pattern = sides.next().and_then(|pattern| parts_of_tuple(&pattern));
    // Of a path only the part before its first `::` is examined: it is not a tuple.
    let of_type = sides.next().and_then(|of_type| parts_of_tuple(&of_type));
    pattern.max(of_type)
}

/// The parts of a tuple, behind references and `mut`.
fn parts_of_tuple(tokens: &[TokenTree]) -> Option<usize> {
    let is_lifetime = |i: usize| i > 0 && is_sign(&tokens[i - 1], '\'');
    let mut rest = (0..tokens.len()).filter(|&i| {
        let tree = &tokens[i];
        !is_sign(tree, '&') && !is_sign(tree, '\'') && !is_word(tree, "mut") && !is_lifetime(i)
    });
    let only = rest.next().filter(|_| rest.next().is_none())?;
    let parts = split(in_brackets(&tokens[only], Delimiter::Parenthesis)?, ',').len();
    (parts > 1).then_some(parts)
}

/// Tokens between signs that are not in brackets, angular ones among them.
fn split(stream: TokenStream, sign: char) -> Vec<Vec<TokenTree>> {
    let mut parts = vec![Vec::new()];
    let mut depth = 0;
    let mut follows_dash = false;
    for tree in stream {
        depth += step_into(&tree, follows_dash);
        follows_dash = is_sign(&tree, '-') || is_sign(&tree, '=');
        if depth == 0 && is_sign(&tree, sign) {
            parts.push(Vec::new());
        } else if let Some(last) = parts.last_mut() {
            last.push(tree);
        }
    }
    parts.retain(|part| !part.is_empty());
    parts
}

fn is_sign(tree: &TokenTree, sign: char) -> bool {
    matches!(tree, TokenTree::Punct(punct) if punct.as_char() == sign)
}

fn is_word(tree: &TokenTree, word: &str) -> bool {
    matches!(tree, TokenTree::Ident(name) if name == word)
}

fn in_brackets(tree: &TokenTree, delimiter: Delimiter) -> Option<TokenStream> {
    match tree {
        TokenTree::Group(group) if group.delimiter() == delimiter => Some(group.stream()),
        _ => None,
    }
}

#[test]
fn tuples_are_found_by_pattern_and_by_type() {
    let of = |text| {
        tuples(text)
            .into_iter()
            .map(|(name, parts)| format!("{name} {parts}"))
            .collect::<Vec<_>>()
    };
    assert_eq!(of("fn a((x, y): (f32, Vec<(u8, u8)>), z: u8) {}"), ["a 2"]);
    assert_eq!(
        of("impl A { fn b(&self, c: &'a mut (u8, [u8; 2], D<E, F>)) {} }"),
        ["b 3"]
    );
    assert_eq!(of("fn d<F: Fn(u8, u8) -> u8>(f: F, (x, y, z,): Named) {}"), ["d 3"]);
    assert_eq!(
        of("mod m { fn e(x: (u8), y: &[(u8, u8)], z: impl Fn((u8, u8)), w: a::B) { |(p, q)| p } }"),
        [""; 0]
    );
    assert_eq!(
        of("fn f() { fn g(x: (u8, u8)) {} } const H: fn((u8, u8)) = h;"),
        ["g 2"]
    );
}
