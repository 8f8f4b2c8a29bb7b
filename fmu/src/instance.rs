//! One running model: which call is permitted when, the values, the time, and states to go back to.
//!
//! ```text
//!   Configuring <--> Instantiated --enter--> Initializing --exit--> Stepping --terminate--> Terminated
//!                        ^                         |                  |  ^                      |
//!                        |                         +----> Events <----+  |                      |
//!                        |                                  +------------+                      |
//!                        +------------------------------- reset -------------------------------+   (from every phase)
//! ```
//!
//! Only a node on a network has structural parameters and so a configuration mode, and events: it begins in them, and exchanges bus operations there.
//!
//! Both versions of FMI call the same functions here. Nothing here is unsafe, and nothing prints.

use std::path::Path;

use crate::asked::Asked;
use crate::complaint::Complaint;
use crate::definition::Definition;
use crate::exchange::Exchange;
use crate::ls_bus::terminal::Terminal;
use crate::model::Model;
use crate::phase::Phase;
use crate::resources::Resources;
use crate::saved_state::SavedState;
use crate::variable::{Kind, Role, Variable};

/// The longest step, s: a longer one is an error of the tool.
const LONGEST_STEP_S: f64 = 10.0;
/// The shortest step, s.
const SHORTEST_STEP_S: f64 = 1e-6;
/// How far a step may be from a multiple of the tick, as a fraction of the tick: what adding up of times in doubles can make of it.
const TICK_TOLERANCE: f64 = 1e-6;
/// How far the tool's time may be from the model's, s.
const TIME_TOLERANCE_S: f64 = 1e-7;
/// Place of time in every table.
const TIME: usize = 0;

/// An instance of an FMU.
pub struct Instance {
    definition: Definition,
    token: String,
    model: Box<dyn Model>,
    phase: Phase,
    values: Vec<f64>,
    /// The model has begun with the values as they are.
    has_begun: bool,
    start_s: f64,
    exchange: Exchange,
}

impl Instance {
    /// An instance of the FMU whose resources are in a folder. The token is that of the file; another one belongs to another version. The tool says
    /// whether it will use the event mode.
    ///
    /// # Errors
    /// The resources are wrong, the token does not belong to them, or the FMU can do nothing without events.
    pub fn new(token: &str, resources: &Path, uses_events: bool) -> Result<Self, Complaint> {
        let (definition, model) = Resources::read(resources)?.build()?;
        if definition.terminal.is_some() && !uses_events {
            return Err(Complaint::new(
                "the FMU exchanges bus operations in the event mode of FMI 3.0, which is not used: set eventModeUsed, or use an importer that has it",
            ));
        }
        let own = definition.token();
        if token != own {
            return Err(Complaint::new(format!(
                "the token (guid) is {token} and that of the resources is {own}: the FMU was written by another version of oleo; write it \
                 again with `oleo fmu`"
            )));
        }
        Ok(Self {
            values: definition.start(),
            token: own,
            definition,
            model,
            phase: Phase::Instantiated,
            has_begun: false,
            start_s: 0.0,
            exchange: Exchange::default(),
        })
    }

    /// Sets the time at which the simulation begins, s.
    ///
    /// # Errors
    /// The time is not finite, or it is too late to set it.
    pub fn set_up(&mut self, start_s: f64) -> Result<(), Complaint> {
        self.only_in(&[Phase::Instantiated], "the start time is set")?;
        if !start_s.is_finite() {
            return Err(Complaint::new(format!(
                "the start time is {start_s}: give a finite time"
            )));
        }
        self.start_s = start_s;
        self.values[TIME] = start_s;
        Ok(())
    }

    /// Enters the initialization mode.
    ///
    /// # Errors
    /// It is not the time for it.
    pub fn enter_initialization(&mut self) -> Result<(), Complaint> {
        self.only_in(&[Phase::Instantiated], "the initialization mode begins")?;
        self.phase = Phase::Initializing;
        Ok(())
    }

    /// Leaves the initialization mode: the model begins with the values that it has been given.
    ///
    /// # Errors
    /// It is not the time for it, or the parameters do not make a possible model.
    pub fn exit_initialization(&mut self) -> Result<(), Complaint> {
        self.only_in(&[Phase::Initializing], "the initialization mode ends")?;
        self.begin()?;
        self.phase = if self.definition.terminal.is_some() {
            self.offer();
            Phase::Events
        } else {
            Phase::Stepping
        };
        Ok(())
    }

    /// Enters the configuration mode, in which structural parameters are set.
    ///
    /// # Errors
    /// It is not the time for it, or there are no structural parameters.
    pub fn enter_configuration(&mut self) -> Result<(), Complaint> {
        if !(self.definition.variables.iter()).any(|variable| variable.role == Role::Structural) {
            return Err(Complaint::new(
                "there are no structural parameters, so there is no configuration mode",
            ));
        }
        self.only_in(&[Phase::Instantiated], "the configuration mode begins")?;
        self.phase = Phase::Configuring;
        Ok(())
    }

    /// Leaves the configuration mode.
    ///
    /// # Errors
    /// It is not the time for it.
    pub fn exit_configuration(&mut self) -> Result<(), Complaint> {
        self.only_in(&[Phase::Configuring], "the configuration mode ends")?;
        self.phase = Phase::Instantiated;
        Ok(())
    }

    /// Enters the event mode.
    ///
    /// # Errors
    /// It is not the time for it, or there are no events.
    pub fn enter_events(&mut self) -> Result<(), Complaint> {
        self.terminal()?;
        self.only_in(&[Phase::Stepping], "the event mode begins")?;
        self.phase = Phase::Events;
        Ok(())
    }

    /// Leaves the event mode.
    ///
    /// # Errors
    /// It is not the time for it, or there are no events.
    pub fn enter_steps(&mut self) -> Result<(), Complaint> {
        self.in_events("the step mode begins")?;
        self.phase = Phase::Stepping;
        Ok(())
    }

    /// Whether the instance is in the event mode.
    ///
    /// # Errors
    /// It is not, or there are no events.
    pub fn in_events(&self, what: &str) -> Result<(), Complaint> {
        self.terminal()?;
        self.only_in(&[Phase::Events], what)
    }

    /// Ends an instant of the event mode: the model takes what has come with the clock, and what the tool has fetched is gone. What the model
    /// answers is offered at the end of the next step.
    ///
    /// # Errors
    /// It is not the time for it, or there are no events.
    pub fn update_discrete_states(&mut self) -> Result<(), Complaint> {
        self.in_events("discrete states are updated")?;
        let received = self.exchange.end_of_instant();
        if let (Some(received), Some(network)) = (received, self.model.network()) {
            network.take(&received);
            self.model.outputs(&mut self.values);
        }
        Ok(())
    }

    /// Whether clocks tick. An output clock says so once for each time that it ticks.
    ///
    /// # Errors
    /// No clock has this reference, or it is not the time for it.
    pub fn get_clocks(&mut self, references: &[u32]) -> Result<Vec<bool>, Complaint> {
        let places = self.places(Asked::Clock, references)?;
        let terminal = self.terminal()?;
        self.only_in(&[Phase::Events], "clocks are asked for")?;
        let ticks = |place: usize| {
            if place == terminal.tx_clock() {
                self.exchange.tells()
            } else {
                self.exchange.is_received
            }
        };
        Ok(places.into_iter().map(ticks).collect())
    }

    /// Lets input clocks tick.
    ///
    /// # Errors
    /// No clock has this reference, it is not an input, or it is not the time for it.
    pub fn set_clocks(&mut self, references: &[u32], ticks: &[bool]) -> Result<(), Complaint> {
        let places = self.places(Asked::Clock, references)?;
        self.only_in(&[Phase::Events], "clocks are set")?;
        (places.iter()).try_for_each(|place| self.may_set(&self.definition.variables[*place]))?;
        if let Some(ticks) = ticks.last() {
            self.exchange.is_received = *ticks;
        }
        Ok(())
    }

    /// The bytes of a binary variable. Those of an output are none while its clock does not tick.
    ///
    /// # Errors
    /// No binary has this reference.
    pub fn get_binary(&mut self, reference: u32) -> Result<&[u8], Complaint> {
        let place = self.place(Asked::Binary, reference)?;
        let terminal = self.terminal()?;
        if place != terminal.tx_data() {
            return Ok(&self.exchange.received);
        }
        if self.phase != Phase::Events {
            return Ok(&[]);
        }
        Ok(self.exchange.fetch())
    }

    /// Sets binary variables. They count when their clock ticks in the same instant.
    ///
    /// # Errors
    /// No binary has this reference, it is not an input, there are too many bytes, or it is not the time for it.
    pub fn set_binaries(&mut self, references: &[u32], values: &[&[u8]]) -> Result<(), Complaint> {
        let places = self.places(Asked::Binary, references)?;
        self.only_in(
            &[Phase::Events, Phase::Instantiated, Phase::Initializing],
            "binaries are set",
        )?;
        for (place, value) in places.iter().zip(values) {
            let variable = &self.definition.variables[*place];
            self.may_set(variable)?;
            if let Kind::Binary { most_bytes, .. } = variable.kind
                && value.len() > most_bytes
            {
                return Err(Complaint::new(format!(
                    "{} is set to {} bytes: at most {most_bytes} at a time",
                    variable.name,
                    value.len()
                )));
            }
        }
        if let Some(value) = values.last() {
            self.exchange.received = value.to_vec();
        }
        Ok(())
    }

    /// Whether there are bus operations that the tool should fetch in the event mode.
    pub fn has_event(&self) -> bool {
        self.exchange.has_offers()
    }

    /// Ends the simulation.
    ///
    /// # Errors
    /// It is not the time for it.
    pub fn terminate(&mut self) -> Result<(), Complaint> {
        self.only_in(&[Phase::Stepping, Phase::Events], "a simulation is terminated")?;
        self.phase = Phase::Terminated;
        Ok(())
    }

    /// Everything as after the instantiation.
    pub fn reset(&mut self) {
        self.values = self.definition.start();
        self.phase = Phase::Instantiated;
        self.has_begun = false;
        self.start_s = 0.0;
        self.exchange = Exchange::default();
    }

    /// The values of variables of a type.
    ///
    /// # Errors
    /// No variable has this reference and type, or the model cannot begin with its parameters.
    pub fn get(&mut self, asked: Asked, references: &[u32]) -> Result<Vec<f64>, Complaint> {
        let places = self.places(asked, references)?;
        let asks_outputs = || {
            places
                .iter()
                .any(|place| self.definition.variables[*place].role == Role::Output)
        };
        if self.phase == Phase::Initializing && !self.has_begun && asks_outputs() {
            self.begin()?;
        }
        Ok(places.into_iter().map(|place| self.values[place]).collect())
    }

    /// Sets variables of a type: all of them, or none.
    ///
    /// # Errors
    /// No variable has this reference and type, it may not be set now, or not to this value.
    pub fn set(&mut self, asked: Asked, references: &[u32], values: &[f64]) -> Result<(), Complaint> {
        if references.len() != values.len() {
            return Err(Complaint::new(format!(
                "{} variables are set to {} values: give one value for each",
                references.len(),
                values.len()
            )));
        }
        let places = self.places(asked, references)?;
        for (place, value) in places.iter().zip(values) {
            let variable = &self.definition.variables[*place];
            self.may_set(variable)?;
            if let Some(refused) = variable.refuses(*value) {
                return Err(Complaint::new(refused));
            }
            if let Kind::Word { list, words } = &variable.kind
                && !(0..words.len()).any(|word| word as f64 == *value)
            {
                let last = words.len() - 1;
                return Err(Complaint::new(format!(
                    "{} is {value}: must be a word of {list}, 0 to {last}",
                    variable.name
                )));
            }
        }
        for (place, value) in places.into_iter().zip(values) {
            self.values[place] = *value;
        }
        if self.phase == Phase::Initializing {
            self.has_begun = false;
        }
        Ok(())
    }

    /// Goes on from a time (s) by a step (s). Returns the time reached.
    ///
    /// # Errors
    /// It is not the time for it, the times are wrong, a parameter is, or what comes out is not finite.
    pub fn step(&mut self, from_s: f64, step_s: f64) -> Result<f64, Complaint> {
        self.only_in(&[Phase::Stepping], "a step is made")?;
        let now_s = self.values[TIME];
        let tolerance_s = TIME_TOLERANCE_S.max(1e-12 * now_s.abs());
        let follows = (from_s - now_s).abs() <= tolerance_s;
        if !follows {
            return Err(Complaint::new(format!(
                "the step begins at {from_s} s and the model is at {now_s} s: steps follow on each other; set an earlier state to go back"
            )));
        }
        if !(SHORTEST_STEP_S..=LONGEST_STEP_S).contains(&step_s) {
            return Err(Complaint::new(format!(
                "the step is {step_s} s: must be from {SHORTEST_STEP_S:e} to {LONGEST_STEP_S} s"
            )));
        }
        let duration_s = match self.definition.tick_s {
            None => step_s,
            Some(tick_s) => {
                let ticks = (step_s / tick_s).round();
                if ticks < 1.0 || (step_s / tick_s - ticks).abs() > TICK_TOLERANCE {
                    return Err(Complaint::new(format!(
                        "the step is {step_s} s: must be a multiple of the model's own step, {tick_s} s"
                    )));
                }
                ticks * tick_s
            }
        };
        self.exchange.has_room()?;
        self.model.step(&self.values, duration_s)?;
        self.model.outputs(&mut self.values);
        self.values[TIME] = from_s + step_s;
        self.offer();
        match self.not_finite() {
            None => Ok(self.values[TIME]),
            Some(variable) => Err(Complaint::new(format!(
                "{} is not finite at {} s: set an earlier state or reset, and check inputs and parameters",
                variable.name, self.values[TIME]
            ))),
        }
    }

    /// The time that the model has reached, s.
    pub fn time_s(&self) -> f64 {
        self.values[TIME]
    }

    /// The state as bytes, with what tells whether they are whole.
    ///
    /// # Errors
    /// The model cannot be saved.
    pub fn save(&self) -> Result<Vec<u8>, Complaint> {
        let saved = SavedState {
            phase: self.phase,
            has_begun: self.has_begun,
            start_s: self.start_s,
            values: self.values.clone(),
            exchange: self.exchange.clone(),
            model: if self.has_begun { self.model.save()? } else { Vec::new() },
        };
        saved.to_bytes(&self.token)
    }

    /// Goes back to a state of this FMU, of this instance or another.
    ///
    /// # Errors
    /// The bytes are not whole, or are of another FMU. The instance is then as it was.
    pub fn load(&mut self, bytes: &[u8]) -> Result<(), Complaint> {
        let saved = self.saved(bytes)?;
        if saved.has_begun {
            self.model.load(&saved.values, &saved.model)?;
        }
        self.values = saved.values;
        self.exchange = saved.exchange;
        self.phase = saved.phase;
        self.has_begun = saved.has_begun;
        self.start_s = saved.start_s;
        Ok(())
    }

    /// Whether bytes are a state of this FMU.
    ///
    /// # Errors
    /// As [`Self::load`].
    pub fn check_state(&self, bytes: &[u8]) -> Result<(), Complaint> {
        self.saved(bytes).map(drop)
    }

    fn saved(&self, bytes: &[u8]) -> Result<SavedState, Complaint> {
        SavedState::from_bytes(bytes, &self.token, self.values.len())
    }

    fn begin(&mut self) -> Result<(), Complaint> {
        if self.has_begun {
            return Ok(());
        }
        self.model.begin(&self.values)?;
        self.model.outputs(&mut self.values);
        self.has_begun = true;
        Ok(())
    }

    /// Offers what the model has to send.
    fn offer(&mut self) {
        if let Some(network) = self.model.network() {
            self.exchange.offer(network.take_sent());
        }
    }

    fn terminal(&self) -> Result<Terminal, Complaint> {
        self.definition
            .terminal
            .ok_or_else(|| Complaint::new("there are no events and no clocks: the description says so"))
    }

    fn not_finite(&self) -> Option<&Variable> {
        let variables = self.definition.variables.iter();
        (variables.zip(&self.values)).find_map(|(variable, value)| (!value.is_finite()).then_some(variable))
    }

    fn only_in(&self, permitted: &[Phase], what: &str) -> Result<(), Complaint> {
        if permitted.contains(&self.phase) {
            return Ok(());
        }
        let (now, when) = (self.phase.words(), permitted.first().map_or("", |phase| phase.words()));
        Err(Complaint::new(format!("{what} {when}: the instance is {now}")))
    }

    fn places(&self, asked: Asked, references: &[u32]) -> Result<Vec<usize>, Complaint> {
        let place = |reference: &u32| self.place(asked, *reference);
        references.iter().map(place).collect()
    }

    fn place(&self, asked: Asked, reference: u32) -> Result<usize, Complaint> {
        let place = usize::try_from(reference).unwrap_or(usize::MAX);
        let Some(variable) = self.definition.variables.get(place) else {
            return Err(Complaint::new(format!(
                "value reference {reference} is unknown: they go from 0 to {}",
                self.definition.variables.len() - 1
            )));
        };
        let own = match &variable.kind {
            Kind::Real { .. } => Asked::Real,
            Kind::Switch => Asked::Switch,
            Kind::Word { .. } => Asked::Word,
            Kind::Binary { .. } => Asked::Binary,
            Kind::Clock => Asked::Clock,
        };
        if own == asked {
            return Ok(place);
        }
        Err(Complaint::new(format!(
            "{} (value reference {reference}) is {}, not {}: use the function of its type",
            variable.name,
            own.words(),
            asked.words()
        )))
    }

    fn may_set(&self, variable: &Variable) -> Result<(), Complaint> {
        let may = match variable.role {
            Role::Input | Role::Tunable => !matches!(self.phase, Phase::Terminated | Phase::Configuring),
            Role::Structural => self.phase == Phase::Configuring,
            Role::Fixed => matches!(self.phase, Phase::Instantiated | Phase::Initializing),
            Role::Time | Role::Output => false,
        };
        if may {
            return Ok(());
        }
        let name = &variable.name;
        Err(Complaint::new(match variable.role {
            Role::Time | Role::Output => format!("{name} cannot be set: the model computes it"),
            Role::Structural => format!("{name} cannot be set now: enter the configuration mode first"),
            _ => format!("{name} cannot be set now: the instance is {}", self.phase.words()),
        }))
    }
}
