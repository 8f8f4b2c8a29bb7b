//! Finds the shards of a study in folders, and says what is missing, what is there twice and what does not belong together.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::file::{Header, ShardFile};
use super::folder::ShardFolder;
use super::part::Part;
use crate::failure::Failure;

/// All shards of a study, whole and of one make.
pub struct Shards {
    /// That of one of them; all have the same study.
    pub header: Header,
    paths: BTreeMap<Part, PathBuf>,
}

impl Shards {
    /// Those in these folders. Every file is read and held against its digest.
    pub fn in_folders(folders: &[PathBuf]) -> Result<Self, Failure> {
        let mut found: Option<Self> = None;
        for folder in folders {
            let paths = ShardFolder::shards(folder)?;
            if paths.is_empty() {
                return Err(Failure::new(format!(
                    "{}: holds no finished shard; give the folder that --out of the shards names",
                    folder.display()
                )));
            }
            for path in paths {
                let header = ShardFile::read(&path)?.header;
                match &mut found {
                    None => {
                        let paths = BTreeMap::from([(header.part(), path)]);
                        found = Some(Self { header, paths });
                    }
                    Some(shards) => shards.add(header, path)?,
                }
            }
        }
        let shards = found.ok_or_else(|| Failure::new("no folder of shards is given"))?;
        match shards.missing(folders) {
            Some(missing) => Err(missing),
            None => Ok(shards),
        }
    }

    fn add(&mut self, header: Header, path: PathBuf) -> Result<(), Failure> {
        let wrong = |what: String| Failure::new(format!("{}: {what}", path.display()));
        if let Some(difference) = self.header.identity.difference(&header.identity) {
            let first = self.paths.values().next().cloned().unwrap_or_default();
            return Err(wrong(format!(
                "{difference}, which {} is; keep the shards of each study in a folder of their own",
                first.display()
            )));
        }
        let (part, of) = (header.part(), self.header.part().of);
        if part.of != of || header.cases != self.header.cases {
            return Err(wrong(format!(
                "is one of {}, and others are of {of}; divide a study once, and run the rest with --shard K/{of}",
                part.of
            )));
        }
        if let Some(other) = self.paths.get(&part) {
            let what = format!("is shard {part}, and so is {}; remove one of them", other.display());
            return Err(wrong(what));
        }
        self.paths.insert(part, path);
        Ok(())
    }

    /// What to do about shards that are not there.
    fn missing(&self, folders: &[PathBuf]) -> Option<Failure> {
        let of = self.header.part().of;
        let missing: Vec<u32> = Part::all(of)
            .filter(|part| !self.paths.contains_key(part))
            .map(|part| part.number)
            .collect();
        if missing.is_empty() {
            return None;
        }
        let (count, identity) = (missing.len(), &self.header.identity);
        let (are, each) = if count == 1 { ("is", "it") } else { ("are", "each") };
        Some(Failure::new(format!(
            "{count} of {of} shards {are} missing: {}; run {each} with oleo {} --shard K/{of} --out {}",
            in_words(&missing),
            super::arguments::quoted(&identity.arguments),
            folders.first().map_or(Path::new("DIR"), PathBuf::as_path).display()
        )))
    }

    /// The shards in order, each read when it is its turn.
    pub fn read(&self) -> impl Iterator<Item = Result<ShardFile, Failure>> {
        self.paths.values().map(|path| ShardFile::read(path))
    }

    /// Where a part lies.
    pub fn path(&self, part: Part) -> &Path {
        self.paths.get(&part).map_or(Path::new(""), PathBuf::as_path)
    }
}

/// Rising numbers as ranges, such as `1-3,7`: as an array of Slurm wants them.
pub fn in_words(numbers: &[u32]) -> String {
    let mut ranges: Vec<(u32, u32)> = Vec::new();
    for &number in numbers {
        match ranges.last_mut() {
            Some((_, last)) if *last + 1 == number => *last = number,
            _ => ranges.push((number, number)),
        }
    }
    let range = |(first, last): &(u32, u32)| match first == last {
        true => first.to_string(),
        false => format!("{first}-{last}"),
    };
    ranges.iter().map(range).collect::<Vec<_>>().join(",")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_in_a_row_are_a_range() {
        assert_eq!(in_words(&[1, 2, 3, 7, 9, 10]), "1-3,7,9-10");
        assert_eq!(in_words(&[]), "");
    }
}
