//! Captures of laser scanners that are written here, with points whose places are worked out by the formulas of the
//! manuals, in double precision.

mod captures;
mod clocks;
mod containers;
mod hdl_64;
mod hostile;
mod live;
mod lost;
mod ouster;
mod sensors;
mod velodyne;
mod windows;
