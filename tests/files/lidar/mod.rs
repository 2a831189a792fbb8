//! Captures of LiDAR sensors that are written here, with points whose positions are computed by the formulas of the
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
