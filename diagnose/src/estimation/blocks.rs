//! Recordings cut into blocks, and blocks dealt into folds.
//!
//! A fold is held out as a whole: its blocks have no say in a fit, and the fit is judged on them. Sums are kept for each
//! block, so that leaving blocks out costs no simulation.

use crate::specimen::Folding;

/// Blocks that a recording is cut into; also the number of folds of several recordings.
const BLOCKS_PER_RECORDING: usize = 8;
/// Each recording's first block goes to another fold, this many further, so that no fold holds all beginnings.
const SHIFT_OF_FOLDS: usize = 3;
/// With this many recordings a fold holds a part of each even if each repeats one motion: a single motion is too little to fit a
/// model to. [`Folding::WholeRecordings`] then says what is asked besides.
const PAIR: usize = 2;
/// Folds of a single recording: its first half predicts the second and the other way round, and nothing in between leaks.
const FOLDS_OF_ONE: usize = 2;

/// A stretch of one recording.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Block {
    /// Index of the recording.
    pub recording: usize,
    /// First sample.
    pub start: usize,
    /// One past the last sample.
    pub end: usize,
    /// Fold that it is held out with.
    pub fold: usize,
}

impl Block {
    /// The block's part of a series over the whole recording.
    #[must_use]
    pub fn of<'s>(&self, series: &'s [f64]) -> &'s [f64] {
        &series[self.start..self.end]
    }

    /// Number of samples.
    #[must_use]
    pub const fn samples(&self) -> usize {
        self.end - self.start
    }
}

/// The blocks of all recordings.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Blocks {
    list: Vec<Block>,
    folds: usize,
}

impl Blocks {
    /// Cuts recordings of these numbers of samples into blocks and deals them into folds.
    #[must_use]
    pub fn cut(samples: &[usize], folding: Folding) -> Self {
        let mut list = Vec::new();
        let mut folds = 0;
        for (recording, n) in samples.iter().enumerate() {
            for k in 0..BLOCKS_PER_RECORDING {
                let fold = match folding {
                    _ if samples.len() == 1 => FOLDS_OF_ONE * k / BLOCKS_PER_RECORDING,
                    Folding::WholeRecordings if samples.len() > PAIR => recording,
                    _ => (k + SHIFT_OF_FOLDS * recording) % BLOCKS_PER_RECORDING,
                };
                folds = folds.max(fold + 1);
                list.push(Block {
                    recording,
                    start: n * k / BLOCKS_PER_RECORDING,
                    end: n * (k + 1) / BLOCKS_PER_RECORDING,
                    fold,
                });
            }
        }
        Self { list, folds }
    }

    /// The blocks in order.
    #[must_use]
    pub fn as_slice(&self) -> &[Block] {
        &self.list
    }

    /// Number of folds, of all blocks as they were cut.
    #[must_use]
    pub const fn folds(&self) -> usize {
        self.folds
    }

    /// Some of the blocks.
    #[must_use]
    pub fn keeping(&self, wanted: impl Fn(&Block) -> bool) -> Self {
        Self {
            list: self.list.iter().filter(|b| wanted(b)).cloned().collect(),
            folds: self.folds,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn every_sample_is_in_one_block(samples in prop::collection::vec(50_usize..5000, 1..12)) {
            let blocks = Blocks::cut(&samples, Folding::PartsOfEach);
            for (recording, n) in samples.iter().enumerate() {
                let own: Vec<&Block> = blocks.as_slice().iter().filter(|b| b.recording == recording).collect();
                prop_assert!(own[0].start == 0 && own[own.len() - 1].end == *n);
                prop_assert!(own.windows(2).all(|w| w[0].end == w[1].start));
            }
        }

        #[test]
        fn every_fold_of_several_recordings_holds_a_part_of_each(count in 2_usize..12) {
            let blocks = Blocks::cut(&vec![800; count], Folding::PartsOfEach);
            for fold in 0..blocks.folds() {
                let own = blocks.keeping(|b| b.fold == fold);
                let mut recordings: Vec<usize> = own.as_slice().iter().map(|b| b.recording).collect();
                recordings.dedup();
                prop_assert_eq!(recordings.len(), count);
            }
        }
    }

    #[test]
    fn a_single_recording_is_halved() {
        let blocks = Blocks::cut(&[1000], Folding::WholeRecordings);
        assert_eq!(blocks.folds(), 2);
        assert!(blocks.as_slice().iter().all(|b| b.fold == usize::from(b.start >= 500)));
    }
    #[test]
    fn a_recording_that_repeats_one_motion_is_held_out_as_a_whole() {
        let blocks = Blocks::cut(&[1000, 400, 700], Folding::WholeRecordings);
        assert_eq!(blocks.folds(), 3);
        assert!(blocks.as_slice().iter().all(|b| b.fold == b.recording));
        // Two recordings are too few for that.
        assert_eq!(
            Blocks::cut(&[1000, 400], Folding::WholeRecordings),
            Blocks::cut(&[1000, 400], Folding::PartsOfEach)
        );
    }
}
