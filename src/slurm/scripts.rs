//! The two scripts of a study on a cluster: the array of its shards, and the merge.

use crate::shard::arguments::quoted;
use crate::shard::in_words;

/// What the scripts say.
pub struct Scripts<'a> {
    /// Name of the study.
    pub name: &'a str,
    /// Path of this program.
    pub program: &'a str,
    /// The study with its options.
    pub arguments: &'a [String],
    /// Folder of the shards.
    pub shards: &'a str,
    /// Folder of the results.
    pub out: &'a str,
    /// Number of shards.
    pub of: u32,
    /// Options for sbatch.
    pub options: &'a [String],
}

impl Scripts<'_> {
    /// The array of these shards.
    pub fn array(&self, numbers: &[u32]) -> String {
        let study = quoted(self.arguments);
        let out = quoted(&[format!("--out={}", self.shards)]);
        format!(
            "{}#SBATCH --array={}\n{}\n\
             # As many threads as the job has processors; --shard takes its number from SLURM_ARRAY_TASK_ID.\n\
             exec {} {study} --threads=\"${{SLURM_CPUS_PER_TASK:-1}}\" --shard=/{} {out}\n",
            self.head("", "%A_%a"),
            in_words(numbers),
            self.options(),
            self.program(),
            self.of,
        )
    }

    /// The merge of all shards.
    pub fn merge(&self) -> String {
        let folders = quoted(&[self.shards.to_owned(), format!("--out={}", self.out)]);
        format!(
            "{}{}\nexec {} merge {folders}\n",
            self.head("-merge", "merge_%j"),
            self.options(),
            self.program()
        )
    }

    fn head(&self, name: &str, log: &str) -> String {
        format!(
            "#!/bin/sh\n#SBATCH --job-name=oleo-{}{name}\n#SBATCH --output={}\n",
            self.name,
            in_directive(&format!("{}/log/{log}.log", self.shards)),
        )
    }

    fn options(&self) -> String {
        let lines = self
            .options
            .iter()
            .map(|option| format!("#SBATCH {}\n", in_directive(option)));
        lines.collect()
    }

    fn program(&self) -> String {
        quoted(&[self.program.to_owned()])
    }
}

/// A word of an `#SBATCH` line, whose quotes sbatch takes away itself.
fn in_directive(word: &str) -> String {
    match word.contains(|c: char| c.is_whitespace() || "\"'\\#".contains(c)) {
        true => format!("\"{}\"", word.replace('\\', r"\\").replace('"', "\\\"")),
        false => word.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_scripts_name_the_missing_shards_and_quote_what_a_shell_would_read() {
        let arguments = ["study", "robust", "--vehicle=my car.toml", "--vehicles=24"].map(str::to_owned);
        let options = ["--partition=short".to_owned(), "--comment=two words".to_owned()];
        let scripts = Scripts {
            name: "study-robust",
            program: "/opt/oleo",
            arguments: &arguments,
            shards: "/home/a b/robust.shards",
            out: "/home/a b/robust",
            of: 12,
            options: &options,
        };
        let array = "#!/bin/sh\n\
            #SBATCH --job-name=oleo-study-robust\n\
            #SBATCH --output=\"/home/a b/robust.shards/log/%A_%a.log\"\n\
            #SBATCH --array=3,7-9\n\
            #SBATCH --partition=short\n\
            #SBATCH \"--comment=two words\"\n\n\
            # As many threads as the job has processors; --shard takes its number from SLURM_ARRAY_TASK_ID.\n\
            exec /opt/oleo study robust '--vehicle=my car.toml' --vehicles=24 --threads=\"${SLURM_CPUS_PER_TASK:-1}\" --shard=/12 '--out=/home/a b/robust.shards'\n";
        assert_eq!(scripts.array(&[3, 7, 8, 9]), array);
        let merge = scripts.merge();
        assert!(
            merge.ends_with("exec /opt/oleo merge '/home/a b/robust.shards' '--out=/home/a b/robust'\n"),
            "{merge}"
        );
    }
}
