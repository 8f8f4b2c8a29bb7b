//! One study on many machines: each runs a part of its cases, and the parts are put together.
//!
//! ```text
//!                        +-- part 1/N --> ledger --> shard-1-of-N.records --+
//!  study: list of cases -+-- part 2/N --> ledger --> shard-2-of-N.records --+--> merge --> table, data, page
//!                        +-- ...                                            |    (of one shard after the other)
//!                        +-- whole -----> ledger ------------------------------> table, data, page
//! ```
//!
//! A study ([`Study`]) knows nothing of shards. It names its cases, runs those that it is asked for, and makes its results of the
//! outcomes of all. What is random in a case depends on the case and not on the shard. A shard's file holds the lines of the
//! study's own ledger of finished runs, so that a merge is the study itself with everything known: its results have the same bits.
//!
//! | file | what it contains |
//! |---|---|
//! | `part` | K/N, and which cases are those of a part |
//! | `study` | what a study must be able to do |
//! | `arguments` | the options that a result depends on, in one order |
//! | `identity` | what two shards have in common if they are of one study |
//! | `file` | a shard's file: whole, with its digest |
//! | `folder` | a folder of shards, and the lock on a part that is being run |
//! | `conduct` | runs a study whole, in part, or from shards |
//! | `merge` | finds the shards of a study, and says what is missing |

pub mod arguments;
mod conduct;
mod file;
mod folder;
mod identity;
mod merge;
mod part;
mod study;

pub use conduct::{Request, conduct};
pub use folder::ShardFolder;
pub use identity::Identity;
pub use merge::{Shards, in_words};
pub use part::{Part, ShardArgs};
pub use study::{About, Kept, Said, Study, Work};
