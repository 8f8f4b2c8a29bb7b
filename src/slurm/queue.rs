//! The queue of a cluster: `sbatch` takes jobs, `squeue` says which still run.

use std::path::Path;
use std::process::Command;

use crate::failure::Failure;

/// Number of the array that was submitted last, in the folder of the shards.
const JOB: &str = "job";

/// Numbers of submitted jobs.
pub struct Jobs {
    /// The array; `None` where no shard was missing.
    pub array: Option<String>,
    pub merge: String,
}

/// Refuses a machine without Slurm, before anything is written.
pub fn refuse_without_slurm() -> Result<(), Failure> {
    match Command::new("sbatch").arg("--version").output() {
        Ok(_) => Ok(()),
        Err(error) => Err(Failure::new(format!(
            "sbatch: cannot be run: {error}; run this where jobs are given to Slurm, or add --dry-run and submit the scripts there"
        ))),
    }
}

/// Refuses a folder whose last array is still in the queue: its shards would be run twice.
pub fn refuse_while_running(folder: &Path) -> Result<(), Failure> {
    let Ok(job) = std::fs::read_to_string(folder.join(JOB)) else {
        return Ok(());
    };
    let job = job.trim();
    // A job that the queue has forgotten is an error of squeue.
    let queued = Command::new("squeue")
        .args(["--noheader", "--jobs", job, "--format=%i"])
        .output();
    match queued {
        Ok(output) if output.status.success() && !output.stdout.trim_ascii().is_empty() => Err(Failure::new(format!(
            "job {job} still runs shards in {}; wait for it, or end it with scancel {job}",
            folder.display()
        ))),
        _ => Ok(()),
    }
}

/// Gives the scripts to the queue: the merge begins when every shard of the array has ended well.
pub fn submit(folder: &Path, array: Option<&str>, merge: &str) -> Result<Jobs, Failure> {
    write(&folder.join("log"), None)?;
    let array = match array {
        None => None,
        Some(script) => {
            let path = folder.join("shards.sbatch");
            write(&path, Some(script))?;
            let job = sbatch(&[], &path)?;
            write(&folder.join(JOB), Some(&format!("{job}\n")))?;
            Some(job)
        }
    };
    let path = folder.join("merge.sbatch");
    write(&path, Some(merge))?;
    let after = array.iter().flat_map(|job| {
        // A merge whose shards failed would wait for ever.
        [
            format!("--dependency=afterok:{job}"),
            "--kill-on-invalid-dep=yes".to_owned(),
        ]
    });
    let merge = sbatch(&after.collect::<Vec<_>>(), &path)?;
    Ok(Jobs { array, merge })
}

/// Writes a file; makes a folder where there is no text.
fn write(path: &Path, text: Option<&str>) -> Result<(), Failure> {
    let written = match text {
        Some(text) => std::fs::write(path, text),
        None => std::fs::create_dir_all(path),
    };
    written.map_err(|error| Failure::new(format!("{}: cannot be written: {error}", path.display())))
}

/// Submits a script and gives the number of its job.
fn sbatch(options: &[String], script: &Path) -> Result<String, Failure> {
    let output = (Command::new("sbatch")
        .arg("--parsable")
        .args(options)
        .arg(script)
        .output())
    .map_err(|error| Failure::new(format!("sbatch: cannot be run: {error}")))?;
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr);
        return Err(Failure::new(format!("sbatch refused {}: {said}", script.display())));
    }
    // The number, and behind a semicolon the cluster.
    let said = String::from_utf8_lossy(&output.stdout);
    Ok(said.trim().split(';').next().unwrap_or_default().to_owned())
}
