//! A diagnosis that may find some of the vocabulary only.

use std::sync::atomic::AtomicBool;

use oleo_diagnose::Diagnosis;
use oleo_diagnose::estimation::LeastSquares;
use oleo_diagnose::specimen::Specimen;
use oleo_diagnose::specimen::strut::TwoStageStrut;
use oleo_diagnose::vocabulary::EffectId;
use oleo_report::digest;

use super::contract::Work;
use super::rig;
use crate::failure::Failure;

/// Samples of both recordings together.
const SAMPLES: u64 = 4_000;
/// The effect that is missing, which is always among the candidates.
const MISSING: EffectId = EffectId::GasChargeError;

/// A strut with few candidates.
pub struct Candidates {
    strut: TwoStageStrut,
    improved_toml: String,
}

impl Candidates {
    /// Makes the recordings, and leaves all but so many named candidates out of the search.
    pub fn prepare(candidates: u64) -> Result<Self, Failure> {
        let mut strut = TwoStageStrut::new(rig::believed(), rig::recordings(SAMPLES)?).map_err(Failure::new)?;
        let all = strut.candidates().iter().enumerate();
        let mut named: Vec<usize> = all
            .filter(|(_, candidate)| candidate.untestable.is_none() && !candidate.is_unlisted())
            .map(|(k, _)| k)
            .collect();
        // A stable sort: the others stay in the order of the vocabulary.
        named.sort_by_key(|&k| strut.candidates()[k].id != MISSING);
        let (wanted, there) = (candidates as usize, named.len());
        if wanted > there {
            return Err(Failure::new(format!(
                "{wanted} candidates: these recordings can show {there} named ones only; this is a fault of oleo"
            )));
        }
        named.truncate(wanted);
        strut.search_only(&named);
        Ok(Self {
            strut,
            improved_toml: String::new(),
        })
    }
}

impl Work for Candidates {
    fn run(&mut self) -> Result<u64, Failure> {
        let stop = AtomicBool::new(false);
        let diagnosis = Diagnosis::of(&LeastSquares::new(&self.strut, &stop), &|_, _| {})?;
        self.improved_toml.clone_from(&diagnosis.model_toml);
        Ok(diagnosis.simulated as u64)
    }

    fn outcome(&self) -> Result<String, Failure> {
        Ok(digest::of_bytes(self.improved_toml.as_bytes()))
    }
}
