//! Whole files: what is written is read, and what is damaged is said.

mod clouds;
mod codings;
mod damage;
mod inter;
mod mutations;
mod round_trip;
mod spacing;
mod vector;
