//! XML elements. Reading an attribute takes it out of its element, so that unread attributes can be
//! reported.

use std::path::PathBuf;
use std::rc::Rc;
use std::str::FromStr;

use roxmltree::{Attribute, Node};

use super::files::Files;
use crate::model::{MAX_ITERATIONS, most_iterations};
use crate::{Error, Result};

/// An element of a model's text, with the attributes that are not read yet.
pub(crate) struct Element<'a, 'input> {
    node: Node<'a, 'input>,
    unread: Vec<Attribute<'a, 'input>>,
    known: Vec<&'static str>,
    files: &'a Files<'input>,
    /// The number of the file that has the element.
    file: usize,
    line: u32,
    depth: usize,
}

/// The positions at which the lines of a text begin. (`roxmltree` would count lines from the start
/// of the text for each position.)
pub(crate) struct Lines(Vec<usize>);

impl Lines {
    pub(crate) fn of(text: &str) -> Self {
        Self(
            std::iter::once(0)
                .chain(text.match_indices('\n').map(|(at, _)| at + 1))
                .collect(),
        )
    }

    /// The line of a position in the text, counted from 1.
    pub(crate) fn at(&self, position: usize) -> u32 {
        self.0.partition_point(|start| *start <= position) as u32
    }
}

/// The largest depth of nested elements.
const MAX_DEPTH: usize = 200;
/// The largest length in bytes of an attribute, except of lists of numbers: `replicate` and classes
/// copy it.
const MAX_ATTRIBUTE: usize = 1000;
/// The largest number of nodes that are visited, with the copies that `replicate` makes.
pub(super) const MAX_VISITS: usize = 20_000_000;

/// The place of an element in the text, for errors that are found after reading.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Place {
    /// The path of an included file that contains the element; empty for the text itself.
    file: Rc<str>,
    line: u32,
    element: String,
}

impl Place {
    /// An element of a file on a line.
    pub(crate) fn new(file: impl Into<Rc<str>>, line: u32, element: &str) -> Self {
        let (file, element) = (file.into(), element.to_owned());
        Self {
            file,
            line,
            element,
        }
    }

    /// An error about an attribute of this element.
    pub(crate) fn attribute(&self, attribute: &str, reason: impl Into<String>) -> Error {
        self.fault(Some(attribute.to_owned()), reason.into())
    }

    /// An error about this element.
    pub(crate) fn error(&self, reason: impl Into<String>) -> Error {
        self.fault(None, reason.into())
    }

    fn fault(&self, attribute: Option<String>, reason: String) -> Error {
        let (line, element) = (self.line, self.element.clone());
        let fault = Error::Mjcf {
            line,
            element,
            attribute,
            reason,
        };
        if self.file.is_empty() {
            return fault;
        }
        Error::File {
            path: self.file.to_string(),
            reason: fault.to_string(),
        }
    }
}

impl<'a, 'input> Element<'a, 'input> {
    /// The outermost element of a file.
    pub(crate) fn root(files: &'a Files<'input>, file: usize) -> Self {
        Self::new(files.root(file), files, file, 0)
    }

    /// The element before anything of it was read.
    pub(crate) fn again(&self) -> Self {
        Self::new(self.node, self.files, self.file, self.depth)
    }

    /// Which element it is, among those of all files.
    pub(crate) fn identity(&self) -> (usize, usize) {
        (self.file, self.node.range().start)
    }

    /// Whether the attribute is given, and not read yet.
    pub(crate) fn has(&self, name: &str) -> bool {
        self.unread.iter().any(|attribute| attribute.name() == name)
    }

    /// Whether another element is this one or within it.
    pub(crate) fn contains(&self, other: &Self) -> Result<bool> {
        let mut waiting = vec![self.again()];
        while let Some(element) = waiting.pop() {
            if element.identity() == other.identity() {
                return Ok(true);
            }
            waiting.extend(element.children()?);
        }
        Ok(false)
    }

    /// The outermost element of the file of the model that an element `model` names.
    pub(crate) fn model(&self) -> Option<Self> {
        let file = self.files.named(self.file, self.node, "model")?;
        Some(Self::root(self.files, file))
    }

    fn new(node: Node<'a, 'input>, files: &'a Files<'input>, file: usize, depth: usize) -> Self {
        Self {
            node,
            unread: node.attributes().collect(),
            known: Vec::new(),
            files,
            file,
            line: files.line(file, node.range().start),
            depth,
        }
    }

    /// The name of the element.
    pub(crate) fn name(&self) -> &'a str {
        self.node.tag_name().name()
    }

    /// The place of the element.
    pub(crate) fn place(&self) -> Place {
        Place::new(self.files.name(self.file).clone(), self.line, self.name())
    }

    /// Returns the child elements. The child elements of the root element of an included file
    /// replace an `include` element. Texts and comments are ignored.
    ///
    /// # Errors
    /// For an element of another namespace, for nesting that is too deep, and for copies with too
    /// many nodes together.
    pub(crate) fn children(&self) -> Result<Vec<Self>> {
        let mut children = Vec::new();
        self.add_children(self.node, self.file, &mut children)?;
        Ok(children)
    }

    /// Recurses into included files only. Their number is limited.
    fn add_children(
        &self,
        parent: Node<'a, 'input>,
        file: usize,
        children: &mut Vec<Self>,
    ) -> Result<()> {
        for node in parent.children() {
            if !self.files.visit() {
                let reason = format!(
                    "more than {MAX_VISITS} elements, texts and comments, with all copies, are not supported"
                );
                return Err(self.error(reason));
            }
            if !node.is_element() {
                continue;
            }
            let child = Self::new(node, self.files, file, self.depth + 1);
            if child.depth > MAX_DEPTH {
                return Err(child.error(format!("elements are nested deeper than {MAX_DEPTH}")));
            }
            if node.tag_name().namespace() != parent.tag_name().namespace() {
                return Err(child.error("an element of another namespace is not part of MJCF"));
            }
            match self.files.named(file, node, "include") {
                Some(within) => self.add_children(self.files.root(within), within, children)?,
                None => children.push(child),
            }
        }
        Ok(())
    }

    /// Refuses child elements, and attributes that were not read.
    pub(crate) fn finish_without_children(self) -> Result<()> {
        if let Some(child) = self.children()?.first() {
            let within = self.name();
            let reason = format!("not supported within <{within}>, which has no elements");
            return Err(child.error(reason));
        }
        self.finish()
    }

    /// Refuses attributes that were not read.
    pub(crate) fn finish(self) -> Result<()> {
        let Some(attribute) = self.unread.first() else {
            return Ok(());
        };
        let known = match self.known.join(", ") {
            none if none.is_empty() => "none".to_owned(),
            known => known,
        };
        let reason = format!("not supported: the attributes that are, are {known}");
        Err(self.at(attribute, reason))
    }

    /// An error about this element.
    pub(crate) fn error(&self, reason: impl Into<String>) -> Error {
        self.place().error(reason)
    }

    /// The error of a child element that is not supported.
    pub(crate) fn unsupported(&self, child: &Self, supported: &[&str]) -> Error {
        let within = self.name();
        let these = supported.join(", ");
        child.error(format!(
            "not supported within <{within}>, where these are: {these}"
        ))
    }

    fn at(&self, attribute: &Attribute<'_, '_>, reason: impl Into<String>) -> Error {
        let line = self.files.line(self.file, attribute.range().start);
        Place {
            line,
            ..self.place()
        }
        .attribute(attribute.name(), reason)
    }

    /// Takes the attribute `name`.
    fn take(&mut self, name: &'static str) -> Option<Attribute<'a, 'input>> {
        self.known.push(name);
        let mut unread = self.unread.iter();
        let index = unread.position(|a| a.name() == name && a.namespace().is_none())?;
        Some(self.unread.swap_remove(index))
    }

    /// Takes the attribute `name`, which is not a long list.
    fn take_short(&mut self, name: &'static str) -> Result<Option<Attribute<'a, 'input>>> {
        let attribute = self.take(name);
        match attribute {
            Some(attribute) if attribute.value().len() > MAX_ATTRIBUTE => {
                let length = attribute.value().len();
                let reason =
                    format!("has {length} bytes: more than {MAX_ATTRIBUTE} are not supported");
                Err(self.at(&attribute, reason))
            }
            attribute => Ok(attribute),
        }
    }

    /// Skips attributes without effect.
    pub(crate) fn ignore(&mut self, names: &'static str) {
        for name in names.split(' ') {
            self.take(name);
        }
    }

    /// Reads a text. An empty one counts as absent.
    pub(crate) fn text(&mut self, name: &'static str) -> Result<Option<String>> {
        let attribute = self.take_short(name)?;
        let text = attribute.map(|attribute| attribute.value().to_owned());
        Ok(text.filter(|text| !text.is_empty()))
    }

    /// Reads a text that must be given.
    pub(crate) fn required_text(&mut self, name: &'static str) -> Result<String> {
        self.text(name)?.ok_or_else(|| self.missing(name))
    }

    /// The error of an attribute that must be given.
    pub(crate) fn missing(&self, name: &str) -> Error {
        self.place().attribute(name, "missing: it must be given")
    }

    /// Reads one of the words of `words`.
    pub(crate) fn keyword<T: Copy>(
        &mut self,
        name: &'static str,
        words: &[(&str, T)],
    ) -> Result<Option<T>> {
        let Some(attribute) = self.take_short(name)? else {
            return Ok(None);
        };
        let value = attribute.value();
        match words.iter().find(|(word, _)| *word == value) {
            Some((_, meaning)) => Ok(Some(*meaning)),
            None => {
                let words: Vec<&str> = words.iter().map(|(word, _)| *word).collect();
                let reason = format!("{value:?} is not supported: use {}", words.join(", "));
                Err(self.at(&attribute, reason))
            }
        }
    }

    /// Reads `true` or `false`.
    pub(crate) fn flag(&mut self, name: &'static str) -> Result<Option<bool>> {
        self.keyword(name, &[("false", false), ("true", true)])
    }

    /// Reads at most `out.len()` numbers to the start of `out`; returns their number.
    pub(crate) fn up_to(&mut self, name: &'static str, out: &mut [f64]) -> Result<usize> {
        let Some(attribute) = self.take_short(name)? else {
            return Ok(0);
        };
        let mut count = 0;
        for word in attribute.value().split_ascii_whitespace() {
            let Some(slot) = out.get_mut(count) else {
                let most = out.len();
                let reason = format!("too many numbers: at most {most} are expected");
                return Err(self.at(&attribute, reason));
            };
            *slot = self.parse(&attribute, word)?;
            count += 1;
        }
        if count == 0 {
            Err(self.at(&attribute, "a number is expected"))
        } else {
            Ok(count)
        }
    }

    /// Reads the coefficients of a polynomial, the first of which must not be negative.
    pub(crate) fn polynomial(&mut self, name: &'static str, out: &mut [f64; 3]) -> Result<()> {
        self.up_to(name, out)?;
        if out[0] < 0.0 {
            return Err(self.place().attribute(name, "must not be negative"));
        }
        Ok(())
    }

    /// Reads exactly `N` numbers.
    pub(crate) fn numbers<const N: usize>(
        &mut self,
        name: &'static str,
    ) -> Result<Option<[f64; N]>> {
        let place = self.unread.iter().find(|a| a.name() == name).copied();
        let mut out = [0.0; N];
        match (self.up_to(name, &mut out)?, place) {
            (0, _) | (_, None) => Ok(None),
            (n, _) if n == N => Ok(Some(out)),
            (n, Some(attribute)) => Err(self.at(&attribute, format!("{n} numbers instead of {N}"))),
        }
    }

    /// Reads any number of numbers.
    pub(crate) fn list(&mut self, name: &'static str) -> Result<Option<Vec<f64>>> {
        let Some(attribute) = self.take(name) else {
            return Ok(None);
        };
        let words = attribute.value().split_ascii_whitespace();
        let numbers = words.map(|word| self.parse(&attribute, word));
        numbers.collect::<Result<_>>().map(Some)
    }

    /// Reads any number of numbers of a kind, such as "a whole number".
    pub(crate) fn list_of<T: FromStr>(
        &mut self,
        name: &'static str,
        kind: &str,
    ) -> Result<Option<Vec<T>>> {
        let Some(attribute) = self.take(name) else {
            return Ok(None);
        };
        let words = attribute.value().split_ascii_whitespace();
        let numbers = words.map(|word| {
            let wrong = |_| self.at(&attribute, format!("{word:?} is not {kind}"));
            word.parse().map_err(wrong)
        });
        numbers.collect::<Result<_>>().map(Some)
    }

    /// The path of a file that an attribute names: in `folder` beside the model, or else beside the
    /// text of this element.
    pub(crate) fn find(&self, name: &str, folder: &str, file: &str) -> Result<PathBuf> {
        let found = self.files.find(self.file, folder, file);
        found.map_err(|reason| self.place().attribute(name, reason))
    }

    /// Reads a number.
    pub(crate) fn number(&mut self, name: &'static str) -> Result<Option<f64>> {
        self.numbers(name)
            .map(|numbers| numbers.map(|[x]: [f64; 1]| x))
    }

    /// Reads a number that must be positive.
    pub(crate) fn positive(&mut self, name: &'static str) -> Result<Option<f64>> {
        let number = self.number(name)?;
        if number.is_some_and(|x| x <= 0.0) {
            return Err(self.place().attribute(name, "must be positive"));
        }
        Ok(number)
    }

    /// Reads a number that must not be negative.
    pub(crate) fn non_negative(&mut self, name: &'static str) -> Result<Option<f64>> {
        let number = self.number(name)?;
        if number.is_some_and(|x| x < 0.0) {
            return Err(self.place().attribute(name, "must not be negative"));
        }
        Ok(number)
    }

    /// Changes `value` to an attribute that must not be negative.
    pub(crate) fn set_non_negative(&mut self, name: &'static str, value: &mut f64) -> Result<()> {
        *value = self.non_negative(name)?.unwrap_or(*value);
        Ok(())
    }

    /// Changes `value` to the meaning of an attribute that is one of `words`.
    pub(crate) fn set_keyword<T: Copy>(
        &mut self,
        name: &'static str,
        words: &[(&str, T)],
        value: &mut T,
    ) -> Result<()> {
        *value = self.keyword(name, words)?.unwrap_or(*value);
        Ok(())
    }

    /// Reads a whole number.
    pub(crate) fn integer<T: TryFrom<i64>>(&mut self, name: &'static str) -> Result<Option<T>> {
        let Some(attribute) = self.take_short(name)? else {
            return Ok(None);
        };
        let value = attribute.value().trim();
        let number = value.parse::<i64>().ok();
        let number = number.and_then(|number| T::try_from(number).ok());
        match number {
            Some(number) => Ok(Some(number)),
            None => {
                let reason = format!("{value:?} is not a whole number in range");
                Err(self.at(&attribute, reason))
            }
        }
    }

    /// Reads a number of iterations, at most [`MAX_ITERATIONS`].
    pub(crate) fn iterations(&mut self, name: &'static str) -> Result<Option<usize>> {
        let number = self.integer(name)?;
        match number {
            Some(number) if number > MAX_ITERATIONS => {
                let reason = format!("{number} is more than {}", most_iterations());
                Err(self.place().attribute(name, reason))
            }
            number => Ok(number),
        }
    }

    fn parse(&self, attribute: &Attribute<'_, '_>, word: &str) -> Result<f64> {
        match word.parse::<f64>() {
            Ok(number) if number.is_finite() => Ok(number),
            _ => Err(self.at(attribute, format!("{word:?} is not a finite number"))),
        }
    }
}
