//! What is held out together when a model is judged on what it was not fitted to.

/// What a fold of several recordings holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Folding {
    /// A part of each recording, because each excites what no other does.
    PartsOfEach,
    /// A whole recording, because each repeats one motion: a part of it that was fitted tells what the held-out rest is, whatever
    /// the model, and only another amplitude or frequency tells whether the model is right. Of two recordings a fold holds a
    /// part of each, and an effect must besides not worsen the prediction of either recording by a fit of the other.
    WholeRecordings,
}
