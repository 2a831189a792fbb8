//! Whole files: written data is read back, and damage is reported.

mod clouds;
mod codings;
mod damage;
mod inter;
mod mutations;
mod parent_colors;
mod round_trip;
mod spacing;
mod vector;
