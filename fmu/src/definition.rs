//! The definition of an FMU: its variables, its step, and the token that binds a file to a library.

use sha2::{Digest, Sha256};

use crate::ls_bus::terminal::Terminal;
use crate::variable::{Kind, Variable};

/// Everything that a tool is told about an FMU.
#[derive(Debug, Clone, PartialEq)]
pub struct Definition {
    /// Name of the model, which is also that of the shared library inside the file.
    pub identifier: &'static str,
    /// What it is, in a sentence.
    pub description: String,
    /// All variables; the place of each is its value reference. The first is time.
    pub variables: Vec<Variable>,
    /// Length of the model's own step, s, of which every step of the tool must be a multiple; `None` where any step will do.
    pub tick_s: Option<f64>,
    /// Step that a tool is advised to take, s.
    pub step_s: f64,
    /// Length of a simulation that a tool is advised to begin with, s.
    pub stop_s: f64,
    /// The network that the model is a node of, if it is one. It then needs the event mode of FMI 3.
    pub terminal: Option<Terminal>,
}

impl Definition {
    /// The token (FMI 2: guid) of the file. It is made of the version and of every variable, so that a library refuses a file that
    /// another version has written.
    pub fn token(&self) -> String {
        let mut hash = Sha256::new();
        let mut add = |text: &str| hash.update([text.as_bytes(), &[0]].concat());
        add(env!("CARGO_PKG_VERSION"));
        add(self.identifier);
        for variable in &self.variables {
            add(&variable.name);
            add(&format!("{:?} {:?}", variable.role, variable.kind));
            add(&format!("{:016x}", variable.start.to_bits()));
        }
        let digest = hash.finalize();
        let hex = |bytes: &[u8]| bytes.iter().map(|byte| format!("{byte:02x}")).collect::<String>();
        format!(
            "{{{}-{}-{}-{}-{}}}",
            hex(&digest[..4]),
            hex(&digest[4..6]),
            hex(&digest[6..8]),
            hex(&digest[8..10]),
            hex(&digest[10..16])
        )
    }

    /// The value that each variable starts with.
    pub fn start(&self) -> Vec<f64> {
        self.variables.iter().map(|variable| variable.start).collect()
    }

    /// Places of the variables that belong to the model.
    pub fn parameters(&self) -> impl Iterator<Item = usize> {
        let is_parameter = |(place, variable): (usize, &Variable)| variable.role.is_parameter().then_some(place);
        self.variables.iter().enumerate().filter_map(is_parameter)
    }

    /// The lists of words that variables have, each once.
    pub fn lists(&self) -> Vec<(&'static str, &'static [crate::variable::Word])> {
        let mut lists: Vec<(&str, &[crate::variable::Word])> = Vec::new();
        for variable in &self.variables {
            if let Kind::Word { list, words } = variable.kind
                && !lists.iter().any(|known| known.0 == list)
            {
                lists.push((list, words));
            }
        }
        lists
    }
}
