//! What is simulated, whoever does it: a model with inputs, outputs and parameters that is known by its answers only.

/// A model that somebody else wrote. It is simulated on several threads at once.
pub trait Simulator: Send + Sync {
    /// Its name, for people.
    fn name(&self) -> &str;

    /// All its variables. Elsewhere a variable is its place in this list.
    fn variables(&self) -> &[Variable];

    /// The steps that it takes.
    fn stepping(&self) -> Stepping;

    /// Simulates a course: one series for each output of it, with a value at each of its times. The same course gives the same bits.
    ///
    /// # Errors
    /// Why it cannot be simulated so, in one line.
    fn simulate(&self, recording: &str, course: &Course) -> Result<Vec<Vec<f64>>, String>;

    /// Makes sure before the first simulation that counts that the same course gives the same bits.
    ///
    /// # Errors
    /// As [`Self::simulate`]; it does not.
    fn check_repeatable(&self, _recording: &str, _course: &Course) -> Result<(), String> {
        Ok(())
    }
}

/// A variable.
#[derive(Debug, Clone, PartialEq)]
pub struct Variable {
    /// Its name.
    pub name: String,
    /// What it is for.
    pub role: Role,
    /// Whether it is a number that may have any value, and no switch or counter.
    pub is_real: bool,
    /// Its value at the start, where one is stated.
    pub start: Option<f64>,
}

/// What a variable is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// Driven during a simulation.
    Input,
    /// Read.
    Output,
    /// Set before a simulation.
    Parameter,
    /// Set before a simulation or during it.
    TunableParameter,
    /// Read; some of them may be given a value at the start.
    Other,
    /// A text, an array or another thing that is no number.
    NoNumber,
}

/// The steps that a model takes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stepping {
    /// Whether they may differ in length.
    pub variable: bool,
    /// The step that it was made for, s.
    pub step_s: Option<f64>,
}

/// What is simulated: times, what is set at the start, what is driven, what is read.
#[derive(Debug, Clone, PartialEq)]
pub struct Course {
    /// Times at which steps begin and end, s.
    pub times_s: Vec<f64>,
    /// Variables that are set before the simulation.
    pub starts: Vec<(usize, f64)>,
    /// Variables that are driven.
    pub driven: Vec<Driven>,
    /// Variables that are read at each time.
    pub outputs: Vec<usize>,
}

/// A variable that is driven.
#[derive(Debug, Clone, PartialEq)]
pub struct Driven {
    /// Which one.
    pub variable: usize,
    /// Its value during each step.
    pub during: Vec<f64>,
    /// Its value at each time, with which outputs that follow at once are read.
    pub at: Vec<f64>,
}
