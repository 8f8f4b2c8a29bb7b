//! A TOML document with the position of each of its keys and array entries.

use std::ops::Range;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::path::{KeyPath, Step};

/// A parsed file: its tree, each node with the place in the text that it came from.
pub(super) struct Document<'text> {
    text: &'text str,
    root: Spanned<DeTable<'text>>,
}

/// A table or a value of the tree.
#[derive(Clone, Copy)]
enum Node<'tree, 'text> {
    Table(&'tree DeTable<'text>),
    Value(&'tree DeValue<'text>),
}

impl<'text> Document<'text> {
    /// Parses the text of a model file.
    pub fn parse(text: &'text str) -> Result<Self, toml::de::Error> {
        let root = DeTable::parse(text)?;
        Ok(Self { text, root })
    }

    /// Line, counted from 1, of the key or entry that a path leads to. Where the file does not write it (a default
    /// stands there), the line of the nearest table around it; 1 if there is none.
    pub fn line_of(&self, path: &KeyPath) -> usize {
        let mut node = Node::Table(self.root.get_ref());
        let mut place = 0;
        for step in path.steps() {
            let Some((found, start)) = node.step(step) else { break };
            (node, place) = (found, start);
        }
        line_at(self.text, place)
    }

    /// Path of the key, entry or table whose place in the text is `span`; of the smallest one around it where none fits
    /// exactly.
    pub fn path_at(&self, span: &Range<usize>) -> KeyPath {
        if self.root.span() == *span {
            return KeyPath::default();
        }
        let mut best: Option<(usize, KeyPath)> = None;
        look(Node::Table(self.root.get_ref()), &KeyPath::default(), span, &mut best);
        best.map_or_else(KeyPath::default, |(_, path)| path)
    }
}

impl<'tree, 'text> Node<'tree, 'text> {
    /// What a step leads to, and where in the text that begins.
    fn step(self, step: &Step) -> Option<(Self, usize)> {
        match (self, step) {
            (Self::Table(table) | Self::Value(DeValue::Table(table)), Step::Key(wanted)) => table
                .iter()
                .find(|(key, _)| key.get_ref() == wanted)
                .map(|(key, value)| (Node::Value(value.get_ref()), key.span().start)),
            (Self::Value(DeValue::Array(entries)), Step::Entry(position)) => entries
                .get(*position)
                .map(|entry| (Node::Value(entry.get_ref()), entry.span().start)),
            _ => None,
        }
    }
}

/// Look for `wanted` in a node and all below it. `best` holds the length of the smallest span around it seen so far, 0
/// for an exact one, and its path.
fn look(node: Node<'_, '_>, at: &KeyPath, wanted: &Range<usize>, best: &mut Option<(usize, KeyPath)>) {
    let mut offer = |span: Range<usize>, path: &KeyPath| {
        let length = if span == *wanted {
            0
        } else if span.start <= wanted.start && wanted.end <= span.end {
            span.len()
        } else {
            return;
        };
        if best.as_ref().is_none_or(|(least, _)| length < *least) {
            *best = Some((length, path.clone()));
        }
    };
    let mut below: Vec<(Node<'_, '_>, KeyPath)> = Vec::new();
    match node {
        Node::Table(table) | Node::Value(DeValue::Table(table)) => {
            for (key, value) in table.iter() {
                let path = at.clone().then(key.get_ref().to_string());
                offer(key.span(), &path);
                offer(value.span(), &path);
                below.push((Node::Value(value.get_ref()), path));
            }
        }
        Node::Value(DeValue::Array(entries)) => {
            for (position, entry) in entries.iter().enumerate() {
                let path = at.clone().then(position);
                offer(entry.span(), &path);
                below.push((Node::Value(entry.get_ref()), path));
            }
        }
        Node::Value(_) => {}
    }
    for (child, path) in below {
        look(child, &path, wanted, best);
    }
}

/// Line, counted from 1, of a byte position.
pub(super) fn line_at(text: &str, position: usize) -> usize {
    1 + text.bytes().take(position).filter(|byte| *byte == b'\n').count()
}
