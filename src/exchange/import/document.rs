//! The elements of an XML scene: includes put in place, parameters replaced.

use crate::error::{Error, Result};
use crate::input::{is_inside, read_text};
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::rc::Rc;

/// Larger files are refused.
const MOST_BYTES: u64 = 1 << 26;
/// More bytes in all files together are refused.
const MOST_IN_ALL: usize = 1 << 27;
/// More elements in a file are refused; each takes some hundred bytes.
const MOST_ELEMENTS: u32 = 1 << 20;
/// Files that include each other, at most.
const DEEPEST: usize = 16;
/// Elements within elements, at most.
const DEEPEST_ELEMENT: usize = 32;
/// Memory over the size of a file while it is read.
const IN_MEMORY: f64 = 60.0;

/// An element, with its place.
#[derive(Debug, Clone)]
pub(super) struct Element {
    pub tag: String,
    pub attributes: Vec<(String, String)>,
    pub children: Vec<Element>,
    file: Rc<str>,
    line: u32,
}

impl Element {
    /// The value of an attribute.
    pub fn attribute(&self, name: &str) -> Option<&str> {
        self.attributes.iter().find(|(key, _)| key == name).map(|(_, value)| value.as_str())
    }

    /// An error in this element, with file and line.
    pub fn error(&self, text: impl std::fmt::Display) -> Error {
        Error::Scene(format!("{}: {text}", self.place()))
    }

    /// Refuses it.
    pub fn refuse<T>(&self, text: impl std::fmt::Display) -> Result<T> {
        Err(self.error(text))
    }

    /// File and line.
    pub fn place(&self) -> String {
        format!("{}:{}", self.file, self.line)
    }

    /// What messages call it, such as `<float name="fov">`.
    pub fn name(&self) -> String {
        let word = |key: &str| self.attribute(key).map(|value| format!(" {key}=\"{}\"", shown(value)));
        format!("<{}{}>", shown(&self.tag), word("name").or_else(|| word("type")).unwrap_or_default())
    }
}

/// Of a word of a file that is none of ours a few signs, and none that a terminal would obey.
pub(super) fn shown(word: &str) -> String {
    word.chars().take(40).flat_map(char::escape_debug).collect()
}

/// What has been read.
struct Reader<'a> {
    folder: &'a Path,
    is_confined: bool,
    /// Parameters by name; those of the user keep their values.
    parameters: BTreeMap<String, String>,
    given: &'a [(String, String)],
    /// Parameters that a value named.
    named: RefCell<BTreeSet<String>>,
    bytes: usize,
    /// The files that include the present one, and itself.
    open: Vec<PathBuf>,
    /// All files.
    read: Vec<PathBuf>,
}

/// The root element of a scene with all its includes, and the files that it is in. Names of files are relative to the folder of this one.
///
/// # Errors
/// `Error::Scene` with file and line
pub(super) fn read(
    path: &Path,
    given: &[(String, String)],
    is_confined: bool,
) -> Result<(Element, Vec<PathBuf>)> {
    let folder = path.parent().map(Path::to_path_buf).unwrap_or_default();
    let parameters = given.iter().cloned().collect();
    let mut reader = Reader {
        folder: &folder,
        is_confined,
        parameters,
        given,
        named: RefCell::default(),
        bytes: 0,
        open: Vec::new(),
        read: Vec::new(),
    };
    let root = reader.file(path)?;
    if let Some((name, value)) = given.iter().find(|(name, _)| !reader.named.borrow().contains(name)) {
        let known: Vec<String> = reader
            .parameters
            .keys()
            .filter(|key| *key != name)
            .map(|key| format!("${}", shown(key)))
            .collect();
        let allowed =
            if known.is_empty() { "none, it has no parameters".to_string() } else { known.join(", ") };
        return root.refuse(format!(
            "-D {}={}: nothing names this parameter; allowed: {allowed}",
            shown(name),
            shown(value)
        ));
    }
    if root.tag != "scene" {
        return root.refuse(format!("{}; allowed: <scene>", root.name()));
    }
    let version = root.attribute("version").unwrap_or_default();
    if !(version.starts_with("2.") || version.starts_with("3.")) {
        return root.refuse(format!("version is `{}`; allowed: 2.0.0 to 3.x", shown(version)));
    }
    Ok((root, reader.read))
}

impl Reader<'_> {
    fn file(&mut self, path: &Path) -> Result<Element> {
        let name = path.display().to_string();
        let refuse = |what: String| Error::Scene(format!("{name}: {what}"));
        let text = read_text(path, MOST_BYTES).map_err(|e| refuse(format!("cannot be read: {e}")))?;
        self.read.push(path.to_path_buf());
        let whole = path.canonicalize().map_err(|e| refuse(e.to_string()))?;
        if self.open.contains(&whole) {
            return Err(refuse("includes itself; allowed: files that do not".into()));
        }
        if self.open.len() >= DEEPEST {
            return Err(refuse(format!("is included by {DEEPEST} files in turn; allowed: fewer")));
        }
        self.bytes += text.len();
        if self.bytes > MOST_IN_ALL {
            return Err(refuse(format!(
                "with all it includes has more than {MOST_IN_ALL} bytes, which are allowed"
            )));
        }
        let what = || format!("an XML file of {} bytes", text.len());
        crate::memory::check(what, IN_MEMORY * text.len() as f64).map_err(|e| refuse(e.to_string()))?;
        let options =
            roxmltree::ParsingOptions { allow_dtd: false, nodes_limit: MOST_ELEMENTS, ..Default::default() };
        let document = roxmltree::Document::parse_with_options(&text, options).map_err(|e| {
            let at = e.pos();
            match e {
                roxmltree::Error::DtdDetected => {
                    refuse("a document type definition (DTD); allowed: none, and no entities".into())
                }
                roxmltree::Error::NodesLimitReached => {
                    refuse(format!("more than {MOST_ELEMENTS} elements, which are allowed"))
                }
                e => Error::Scene(format!("{name}:{}:{}: {e}", at.row, at.col)),
            }
        })?;
        // Counting lines from the beginning for each element would take their square.
        let mut starts = vec![0];
        starts.extend(text.bytes().enumerate().filter(|(_, b)| *b == b'\n').map(|(at, _)| at + 1));
        let place = Place { file: Rc::from(name.as_str()), starts };
        self.open.push(whole);
        let element = self.element(document.root_element(), &place, 0)?;
        self.open.pop();
        Ok(element)
    }

    fn element(&mut self, node: roxmltree::Node, place: &Place, depth: usize) -> Result<Element> {
        let mut element = Element {
            tag: node.tag_name().name().to_string(),
            attributes: Vec::new(),
            children: Vec::new(),
            file: place.file.clone(),
            line: place.line(node.range().start),
        };
        if depth > DEEPEST_ELEMENT {
            return element
                .refuse(format!("more than {DEEPEST_ELEMENT} elements in each other, which are allowed"));
        }
        for attribute in node.attributes() {
            let value = self.replaced(attribute.value()).map_err(|what| element.error(what))?;
            element.attributes.push((attribute.name().to_string(), value));
        }
        for child in node.children() {
            if child.is_text() && !child.text().unwrap_or_default().trim().is_empty() {
                return element.refuse(format!(
                    "text `{}`; allowed: elements",
                    shown(child.text().unwrap_or_default().trim())
                ));
            }
            if !child.is_element() {
                continue;
            }
            let child = self.element(child, place, depth + 1)?;
            match child.tag.as_str() {
                "default" => self.default(&child)?,
                "include" => {
                    let Some(file) = child.attribute("filename") else {
                        return child.refuse("<include> without filename; allowed: one");
                    };
                    check_inside(self.is_confined, &child, file, self.folder)?;
                    let included =
                        self.file(&self.folder.join(file)).map_err(|e| e.within(&child.place()))?;
                    match included.tag.as_str() {
                        "scene" => element.children.extend(included.children),
                        _ => element.children.push(included),
                    }
                }
                _ => element.children.push(child),
            }
        }
        Ok(element)
    }

    fn default(&mut self, element: &Element) -> Result<()> {
        let (Some(name), Some(value)) = (element.attribute("name"), element.attribute("value")) else {
            return element.refuse("<default> without name or value; allowed: both");
        };
        if !self.given.iter().any(|(given, _)| given == name) {
            self.parameters.insert(name.to_string(), value.to_string());
        }
        Ok(())
    }

    /// A value with its parameters, `$name`, in their place.
    fn replaced(&self, value: &str) -> std::result::Result<String, String> {
        let mut parts = value.split('$');
        let mut text = parts.next().unwrap_or_default().to_string();
        for part in parts {
            let end = part.find(|c: char| !(c.is_ascii_alphanumeric() || c == '_')).unwrap_or(part.len());
            let (name, rest) = part.split_at(end);
            let Some(value) = self.parameters.get(name) else {
                return Err(format!(
                    "`${}` has no value; allowed: a <default> before, or -D {0}=VALUE",
                    shown(name)
                ));
            };
            self.named.borrow_mut().insert(name.to_string());
            text.push_str(value);
            text.push_str(rest);
        }
        Ok(text)
    }
}

/// Refuses a file that leads out of a folder, where that is not allowed.
pub(super) fn check_inside(is_confined: bool, element: &Element, name: &str, folder: &Path) -> Result<()> {
    if is_confined && !is_inside(name, folder) {
        return element.refuse(format!(
            "file {name:?} is outside of the scene's folder; allowed with --confined: files in it"
        ));
    }
    Ok(())
}

struct Place {
    file: Rc<str>,
    /// Where lines begin.
    starts: Vec<usize>,
}

impl Place {
    fn line(&self, at: usize) -> u32 {
        self.starts.partition_point(|start| *start <= at) as u32
    }
}
