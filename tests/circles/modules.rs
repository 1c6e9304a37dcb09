//! The modules of a crate and what their files import from each other.
//!
//! An import is a name that one file takes from another: in `use`, or in a path in the code (`crate::a::B`, `super::B`,
//! `child::b`). It counts towards the file that **defines** the name: `pub use` in between is passed through, and the file
//! that only passes a name on does not import it. A parent is a file like any other: a child that takes a type defined in
//! its parent's `mod.rs`, while the parent takes something from the child, is a circle. `mod child;` imports nothing, nor
//! does naming a module; what is taken out of it counts. Items for tests alone (`#[cfg(test)]`) do not count.

use crate::tokens::{Token, tokens, without_tests};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Sources by their paths.
pub type Sources = BTreeMap<PathBuf, String>;

/// What each file takes from others: the names, by importing and defining file.
pub type Imports = BTreeMap<(PathBuf, PathBuf), BTreeSet<String>>;

/// How many `use` may lead to each other; more is a circle of them.
const DEEPEST: usize = 32;

#[derive(Debug)]
struct Import {
    path: Vec<String>,
    /// What the file calls it; nothing where all names are taken (`*`).
    name: Option<String>,
    is_public: bool,
}

#[derive(Debug, Default)]
struct Module {
    file: PathBuf,
    parent: usize,
    children: BTreeMap<String, usize>,
    items: BTreeSet<String>,
    /// First names given to macros beside the items (`ranged!(Albedo, ...)`): items that nothing else defines.
    from_macros: BTreeSet<String>,
    imports: Vec<Import>,
    /// Names joined by `::` in the code, single ones too.
    paths: BTreeSet<Vec<String>>,
}

/// What a path leads to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Target {
    Module(usize),
    /// An item, in the module that defines it.
    Item(usize),
    /// Something of another crate.
    Outside,
}

/// The modules of one crate, the root first.
#[derive(Debug, Default)]
pub struct Modules {
    modules: Vec<Module>,
}

impl Modules {
    /// Reads a crate from its root file.
    pub fn read(sources: &Sources, root: &Path) -> Self {
        let mut all = Self::default();
        let folder = root.parent().unwrap_or(Path::new(""));
        all.modules.push(Module { file: root.to_path_buf(), ..Module::default() });
        all.read_file(sources, 0, folder);
        all
    }

    /// Reads the file of a module, whose children lie in a folder.
    fn read_file(&mut self, sources: &Sources, module: usize, folder: &Path) {
        let file = self.modules[module].file.clone();
        let source = sources.get(&file).unwrap_or_else(|| panic!("{} is missing", file.display()));
        let tokens = without_tests(&tokens(source));
        // The module that a place belongs to, and the depth of braces at which its items stand.
        let mut open = vec![(module, 0, folder.to_path_buf())];
        let (mut at, mut depth) = (0, 0);
        while at < tokens.len() {
            let (here, level, folder) = open.last().cloned().expect("the file itself is never closed");
            let next = tokens.get(at + 1).and_then(Token::word);
            let behind = tokens.get(at + 2);
            if tokens[at].is("use") && !tokens[at + 1].is("<") {
                at = self.read_use(&tokens, at, here);
            } else if tokens[at].is("mod") && next.is_some() && behind.is_some_and(|t| t.is(";") || t.is("{"))
            {
                let name = next.expect("just seen").to_string();
                let child = self.modules.len();
                self.modules[here].children.insert(name.clone(), child);
                self.modules.push(Module { file: file.clone(), parent: here, ..Module::default() });
                if behind.is_some_and(|t| t.is("{")) {
                    depth += 1;
                    open.push((child, depth, folder.join(&name)));
                } else {
                    let (path, inner) = child_file(sources, &folder, &name, named_path(&tokens, at), &file);
                    self.modules[child].file = path;
                    self.read_file(sources, child, &inner);
                }
                at += 3;
            } else if let Some(word) = tokens[at].word() {
                if depth == level {
                    self.modules[here].items.extend(defined(word, &tokens[at + 1..]));
                    if let [Token::Sign('!'), Token::Sign('('), Token::Word(name), ..] = &tokens[at + 1..] {
                        self.modules[here].from_macros.insert(name.clone());
                    }
                }
                let path = path_at(&tokens, at);
                let is_method = at > 1 && tokens[at - 1].is(".") && !tokens[at - 2].is(".");
                at += 2 * path.len() - 1;
                if !is_method {
                    self.modules[here].paths.insert(path);
                }
            } else {
                depth += usize::from(tokens[at].is("{"));
                depth -= usize::from(tokens[at].is("}"));
                if depth < level {
                    open.pop();
                }
                at += 1;
            }
        }
    }

    /// Reads `use ...;` and returns the place behind it.
    fn read_use(&mut self, tokens: &[Token], at: usize, module: usize) -> usize {
        let is_public = at > 0 && (tokens[at - 1].is("pub") || tokens[at - 1].is(")"));
        let end = at + tokens[at..].iter().position(|t| t.is(";")).expect("use ends");
        let mut leaves = Vec::new();
        leaves_of(&tokens[at + 1..end], &[], &mut leaves);
        let imports = leaves.into_iter().map(|(path, name)| Import { path, name, is_public });
        self.modules[module].imports.extend(imports);
        end + 1
    }

    /// Where a path leads to, seen from a module. A name may be a module and an item at once: the end of a path is the
    /// item, what stands before it the module.
    fn resolve(&self, from: usize, path: &[String], is_end: bool, deep: usize) -> Option<Target> {
        let mut target = None;
        for (i, name) in path.iter().enumerate() {
            let is_last = is_end && i + 1 == path.len();
            target = match (target, name.as_str()) {
                (Some(Target::Item(at)), _) => Some(Target::Item(at)),
                (Some(Target::Outside), _) => Some(Target::Outside),
                (None, "crate") => Some(Target::Module(0)),
                (None, "self") => Some(Target::Module(from)),
                (None, "super") => Some(Target::Module(self.modules[from].parent)),
                (Some(Target::Module(at)), "super") => Some(Target::Module(self.modules[at].parent)),
                (Some(Target::Module(at)), _) => Some(self.member(at, name, is_last, deep)?),
                (None, _) => Some(self.member(from, name, is_last, deep)?),
            };
        }
        target
    }

    /// What a module calls by a name.
    fn member(&self, module: usize, name: &str, is_last: bool, deep: usize) -> Option<Target> {
        if deep > DEEPEST {
            return None;
        }
        let this = &self.modules[module];
        let child = this.children.get(name).map(|child| Target::Module(*child));
        let item = this.items.contains(name).then_some(Target::Item(module));
        let named = this.imports.iter().filter(|i| i.name.as_deref() == Some(name));
        let mut imported = named.filter_map(|i| self.imported(module, &i.path, is_last, deep));
        let imported = imported.next();
        let globs = this.imports.iter().filter(|i| i.name.is_none());
        let mut from_all = globs.filter_map(|i| match self.imported(module, &i.path, false, deep)? {
            Target::Module(other) if other != module => self.member(other, name, is_last, deep + 1),
            _ => None,
        });
        let in_order = if is_last { [item, imported, child] } else { [child, imported, item] };
        let from_macro = || this.from_macros.contains(name).then_some(Target::Item(module));
        in_order.into_iter().flatten().next().or_else(|| from_all.next()).or_else(from_macro)
    }

    /// What the path of a `use` leads to. Its beginning is a module or an item of the same file, or another crate, but no
    /// name of another `use`.
    fn imported(&self, module: usize, path: &[String], is_end: bool, deep: usize) -> Option<Target> {
        let (first, this) = (&path[0], &self.modules[module]);
        let is_ours = matches!(first.as_str(), "crate" | "self" | "super")
            || this.children.contains_key(first)
            || this.items.contains(first);
        if is_ours { self.resolve(module, path, is_end, deep + 1) } else { Some(Target::Outside) }
    }

    /// All imports between the files of the crate; and the paths within it that lead nowhere, which are faults of this
    /// reader.
    pub fn imports(&self) -> (Imports, Vec<String>) {
        let mut found = Imports::new();
        let mut lost = Vec::new();
        for (here, module) in self.modules.iter().enumerate() {
            let mentioned = |name: &str| module.paths.iter().any(|path| path[0] == name);
            let taken =
                module.imports.iter().filter(|i| !i.is_public || i.name.as_deref().is_some_and(mentioned));
            let taken =
                taken.map(|i| (&i.path, i.name.is_none(), self.imported(here, &i.path, i.name.is_some(), 0)));
            let written = module.paths.iter().filter(|path| path.len() > 1);
            let written = written.map(|path| (path, false, self.resolve(here, path, true, 0)));
            for (path, is_all, target) in taken.chain(written) {
                let other = match target {
                    Some(Target::Item(at)) => at,
                    Some(Target::Module(at)) if is_all => at,
                    Some(Target::Module(_) | Target::Outside) => continue,
                    None => {
                        if matches!(path[0].as_str(), "crate" | "super" | "self") {
                            lost.push(format!("{}: {}", module.file.display(), path.join("::")));
                        }
                        continue;
                    }
                };
                let other = &self.modules[other].file;
                if *other != module.file {
                    let name = if is_all { "*" } else { path.last().expect("no path is empty") };
                    let names = found.entry((module.file.clone(), other.clone())).or_default();
                    names.insert(name.to_string());
                }
            }
        }
        (found, lost)
    }

    /// The files that were read.
    pub fn files(&self) -> BTreeSet<&Path> {
        self.modules.iter().map(|module| module.file.as_path()).collect()
    }
}

/// The names of an item that begins with a keyword, given what follows.
fn defined(keyword: &str, rest: &[Token]) -> Option<String> {
    let is_item = matches!(keyword, "fn" | "struct" | "enum" | "type" | "const" | "static" | "trait");
    let name = match rest {
        [Token::Word(name), ..] if is_item => name,
        [Token::Sign('!'), Token::Word(name), ..] if keyword == "macro_rules" => name,
        _ => return None,
    };
    Some(name.clone())
}

/// The names joined by `::` from a place on.
fn path_at(tokens: &[Token], at: usize) -> Vec<String> {
    let mut path = Vec::new();
    let mut i = at;
    while let Some(word) = tokens.get(i).and_then(Token::word) {
        path.push(word.to_string());
        if !tokens.get(i + 1).is_some_and(|t| t.is("::")) {
            break;
        }
        i += 2;
    }
    path
}

/// The text of `#[path = "..."]` before a `mod` or its `pub`.
fn named_path(tokens: &[Token], at: usize) -> Option<&str> {
    let before = &tokens[..at];
    let attribute = before.len().checked_sub(6).map(|from| &before[from..])?;
    match attribute {
        [Token::Sign('#'), Token::Sign('['), Token::Word(word), Token::Sign('='), Token::Text(path), _]
            if word == "path" =>
        {
            Some(path)
        }
        _ => None,
    }
}

/// The file of `mod name;` and the folder of its own children.
fn child_file(
    sources: &Sources,
    folder: &Path,
    name: &str,
    given: Option<&str>,
    parent: &Path,
) -> (PathBuf, PathBuf) {
    if let Some(given) = given {
        let path = parent.parent().unwrap_or(Path::new("")).join(given);
        let inner = path.parent().unwrap_or(Path::new("")).to_path_buf();
        return (path, inner);
    }
    let (single, inner) = (folder.join(format!("{name}.rs")), folder.join(name));
    let path = if sources.contains_key(&single) { single } else { inner.join("mod.rs") };
    (path, inner)
}

/// The ends of a tree of imports: each path, and the name that it is given.
fn leaves_of(tree: &[Token], before: &[String], found: &mut Vec<(Vec<String>, Option<String>)>) {
    let mut path = before.to_vec();
    let mut at = 0;
    while let Some(token) = tree.get(at) {
        match token {
            Token::Word(word) if word == "as" => {
                path.truncate(
                    path.len() - usize::from(path.len() > 1 && path.ends_with(&["self".to_string()])),
                );
                return found.push((path, tree.get(at + 1).and_then(Token::word).map(str::to_string)));
            }
            Token::Word(word) => path.push(word.clone()),
            Token::Sign('*') => return found.push((path, None)),
            Token::Sign('{') => {
                for branch in branches(&tree[at + 1..]) {
                    leaves_of(branch, &path, found);
                }
                return;
            }
            _ => {}
        }
        at += 1;
    }
    if path.len() > 1 && path.last().is_some_and(|name| name == "self") {
        path.pop();
    }
    if path.len() > before.len() || !tree.is_empty() {
        let name = path.last().cloned();
        found.push((path, name));
    }
}

/// What stands between the commas of braces whose opening one was just passed.
fn branches(tree: &[Token]) -> Vec<&[Token]> {
    let (mut found, mut from, mut depth) = (Vec::new(), 0, 0);
    for (i, token) in tree.iter().enumerate() {
        if token.is("{") {
            depth += 1;
        } else if token.is("}") && depth > 0 {
            depth -= 1;
        } else if depth == 0 && (token.is(",") || token.is("}")) {
            found.push(&tree[from..i]);
            from = i + 1;
            if token.is("}") {
                break;
            }
        }
    }
    found
}
