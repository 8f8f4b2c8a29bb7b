//! `docs/api-controller.md` against the source: the page lists every public item with its variants, fields and methods, it lists
//! nothing that does not exist, and every item has an example that the compiler checks.
//!
//! A row of the page begins with the item's path as a user of the crate writes it: `estimate::State`.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use syn::{Attribute, Fields, Item, Meta, UseTree, Visibility};

/// A public item: the names that its row must contain, and whether its documentation has or names an example.
#[derive(Clone, Debug, Default)]
struct Entry {
    names: BTreeSet<String>,
    example: bool,
}

/// The items of one module, private ones included, by name.
#[derive(Debug, Default)]
struct Module {
    items: BTreeMap<String, Entry>,
    children: BTreeMap<String, Module>,
    public_children: BTreeSet<String>,
    /// Path and name of each public re-export.
    exports: Vec<Vec<String>>,
    public: BTreeSet<String>,
    /// Methods that are written here for a type of another module.
    foreign: BTreeMap<String, Entry>,
}

fn is_public(visibility: &Visibility) -> bool {
    matches!(visibility, Visibility::Public(_))
}

fn has_example(attributes: &[Attribute]) -> bool {
    attributes.iter().any(|attribute| {
        let Meta::NameValue(meta) = &attribute.meta else {
            return false;
        };
        let text = text_of(&meta.value);
        attribute.path().is_ident("doc") && (text.contains("```") || text.contains("for an example"))
    })
}

/// The text of a doc comment.
fn text_of(value: &syn::Expr) -> String {
    match value {
        syn::Expr::Lit(syn::ExprLit {
            lit: syn::Lit::Str(text),
            ..
        }) => text.value(),
        _ => String::new(),
    }
}

fn field_names(fields: &Fields) -> impl Iterator<Item = String> {
    let public = fields.iter().filter(|field| is_public(&field.vis));
    public.filter_map(|field| Some(field.ident.as_ref()?.to_string()))
}

/// What a macro defines cannot be parsed as items: names and examples are read from its text.
fn read_macro(module: &mut Module, text: &str) {
    let words: Vec<&str> = text.split_whitespace().collect();
    for (place, window) in words.windows(3).enumerate() {
        if let ["pub", "struct" | "enum", name] = window {
            let before = words[..place].iter().rev().take(250);
            module.public.insert((*name).to_owned());
            module.items.entry((*name).to_owned()).or_default().example |=
                before.copied().any(|word| word.contains("```"));
        }
    }
}

fn leaves(tree: &UseTree, path: &[String], found: &mut Vec<Vec<String>>) {
    let with = |name: &syn::Ident| [path, &[name.to_string()]].concat();
    match tree {
        UseTree::Path(inner) => leaves(&inner.tree, &with(&inner.ident), found),
        UseTree::Name(name) => found.push(with(&name.ident)),
        UseTree::Rename(_) => {} // `oleo_interface as interface`: its items have rows of their own
        UseTree::Group(group) => group.items.iter().for_each(|tree| leaves(tree, path, found)),
        UseTree::Glob(_) => panic!("a glob re-export hides what is public"),
    }
}

fn read(file: &Path, folder: &Path) -> Module {
    let text = std::fs::read_to_string(file).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
    let mut module = Module::default();
    let mut methods = Vec::new();
    for item in syn::parse_file(&text).expect("the crate compiles").items {
        let (name, public, entry) = match item {
            Item::Struct(item) => (
                item.ident,
                is_public(&item.vis),
                Entry {
                    names: field_names(&item.fields).collect(),
                    example: has_example(&item.attrs),
                },
            ),
            Item::Enum(item) => (
                item.ident,
                is_public(&item.vis),
                Entry {
                    names: item.variants.iter().map(|variant| variant.ident.to_string()).collect(),
                    example: has_example(&item.attrs),
                },
            ),
            Item::Trait(item) => (
                item.ident,
                is_public(&item.vis),
                Entry {
                    names: item
                        .items
                        .iter()
                        .filter_map(|item| match item {
                            syn::TraitItem::Fn(item) => Some(item.sig.ident.to_string()),
                            syn::TraitItem::Type(item) => Some(item.ident.to_string()),
                            _ => None,
                        })
                        .collect(),
                    example: has_example(&item.attrs),
                },
            ),
            Item::Fn(item) => (
                item.sig.ident,
                is_public(&item.vis),
                Entry {
                    names: BTreeSet::new(),
                    example: has_example(&item.attrs),
                },
            ),
            // A constant is its own example.
            Item::Const(item) => (
                item.ident,
                is_public(&item.vis),
                Entry {
                    names: BTreeSet::new(),
                    example: true,
                },
            ),
            Item::Impl(item) if item.trait_.is_none() => {
                let syn::Type::Path(of) = *item.self_ty else { continue };
                let of = of.path.segments.last().expect("a type has a name").ident.to_string();
                for item in item.items {
                    match item {
                        syn::ImplItem::Fn(item) if is_public(&item.vis) => {
                            methods.push((of.clone(), item.sig.ident.to_string(), has_example(&item.attrs)));
                        }
                        syn::ImplItem::Const(item) if is_public(&item.vis) => {
                            methods.push((of.clone(), item.ident.to_string(), false));
                        }
                        _ => {}
                    }
                }
                continue;
            }
            Item::Mod(item) if item.content.is_none() => {
                let name = item.ident.to_string();
                let flat = folder.join(format!("{name}.rs"));
                let inner = folder.join(&name);
                let file = if flat.is_file() { flat } else { inner.join("mod.rs") };
                if is_public(&item.vis) {
                    module.public_children.insert(name.clone());
                }
                module.children.insert(name, read(&file, &inner));
                continue;
            }
            Item::Use(item) if is_public(&item.vis) => {
                leaves(&item.tree, &[], &mut module.exports);
                continue;
            }
            Item::Macro(item) if item.ident.is_some() => {
                read_macro(&mut module, &text);
                continue;
            }
            _ => continue,
        };
        if public {
            module.public.insert(name.to_string());
        }
        module.items.insert(name.to_string(), entry);
    }
    for (of, name, example) in methods {
        let entry = match module.items.get_mut(&of) {
            Some(entry) => entry,
            None => module.foreign.entry(of).or_default(),
        };
        entry.names.insert(name);
        entry.example |= example;
    }
    module
}

impl Module {
    /// Everything of a name in this module and below it, as one entry.
    fn find(&self, name: &str) -> Option<Entry> {
        let mut found = self.items.get(name).cloned();
        for child in self.children.values() {
            if let Some(more) = child.find(name) {
                let entry = found.get_or_insert_default();
                entry.names.extend(more.names);
                entry.example |= more.example;
            }
        }
        found
    }

    /// Methods of a type that are written in other modules than its own.
    fn foreign(&self, name: &str) -> BTreeSet<String> {
        let here = self.foreign.get(name).map(|entry| entry.names.clone());
        let below = self.children.values().flat_map(|child| child.foreign(name));
        here.unwrap_or_default().into_iter().chain(below).collect()
    }

    fn at(&self, path: &[String]) -> Option<&Self> {
        path.iter().try_fold(self, |module, name| module.children.get(name))
    }

    /// The public items of this module, by the path behind `prefix` that a user writes.
    fn exported(&self, prefix: &str, other: &Module, into: &mut BTreeMap<String, Entry>) {
        for name in &self.public {
            into.insert(format!("{prefix}{name}"), self.items[name].clone());
        }
        for path in &self.exports {
            let (name, module) = path.split_last().expect("a path has a name");
            let entry = match path[0].as_str() {
                "oleo_interface" => other.find(name),
                _ => self.at(module).and_then(|module| module.find(name)),
            };
            let entry = entry.unwrap_or_else(|| panic!("{path:?} is exported and was not found"));
            into.insert(format!("{prefix}{name}"), entry);
        }
        for name in &self.public_children {
            self.children[name].exported(&format!("{prefix}{name}::"), other, into);
        }
    }
}

fn source(relative: &str) -> Module {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(relative);
    read(&folder.join("lib.rs"), &folder)
}

/// The rows of the page by the path that each begins with.
fn rows() -> BTreeMap<String, String> {
    let page = include_str!("../../docs/api-controller.md");
    let rows = page.lines().filter_map(|line| {
        let (name, _) = line.strip_prefix("| `")?.split_once('`')?;
        Some((name.to_owned(), line.to_owned()))
    });
    rows.collect()
}

/// Whether an item of a module has its row under its name alone, because it is exported at the root too.
fn exported_at_root(path: &str) -> bool {
    matches!(
        path,
        "estimate::Estimate"
            | "failsafe::FaultCode"
            | "failsafe::Mode"
            | "strategy::DamperPolicy"
            | "strategy::Strategy"
    ) || path.ends_with("semi_active::DamperPolicy")
}

fn words(row: &str) -> BTreeSet<&str> {
    row.split(|c: char| !c.is_alphanumeric() && c != '_').collect()
}

#[test]
fn the_page_lists_what_is_public_and_nothing_else() {
    let mut public = BTreeMap::new();
    let controller = source("src");
    controller.exported("", &source("../interface/src"), &mut public);
    for (path, entry) in &mut public {
        if !path.contains("::") {
            entry.names.extend(controller.foreign(path));
        }
    }
    let rows = rows();
    let mut complaints = Vec::new();
    for (path, entry) in &public {
        let Some(row) = rows.get(path) else {
            if !exported_at_root(path) {
                complaints.push(format!(
                    "no row for {path}: {}",
                    entry.names.iter().cloned().collect::<Vec<_>>().join(", ")
                ));
            }
            continue;
        };
        let words = words(row);
        for name in &entry.names {
            if !words.contains(name.as_str()) {
                complaints.push(format!("the row of {path} does not mention {name}"));
            }
        }
        if !entry.example {
            complaints.push(format!("{path} has no example in its documentation"));
        }
    }
    for path in rows.keys().filter(|path| !public.contains_key(*path)) {
        complaints.push(format!("{path} has a row and is not public"));
    }
    assert!(
        complaints.is_empty(),
        "docs/api-controller.md:\n{}",
        complaints.join("\n")
    );
}
