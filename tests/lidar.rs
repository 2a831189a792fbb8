//! Captures of laser scanners that are written here, with points whose places are worked out by the formulas of the
//! manuals, in double precision.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

#[path = "lidar/captures.rs"]
mod captures;
#[path = "lidar/containers.rs"]
mod containers;
#[path = "lidar/hdl_64.rs"]
mod hdl_64;
#[path = "lidar/hostile.rs"]
mod hostile;
#[path = "lidar/live.rs"]
mod live;
#[path = "lidar/ouster.rs"]
mod ouster;
#[path = "lidar/sensors.rs"]
mod sensors;
#[path = "lidar/velodyne.rs"]
mod velodyne;
