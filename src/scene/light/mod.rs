//! Light on surfaces: lamps, shadows, physical materials.

pub(super) mod albedo_curve;
pub(super) mod lights;
pub(super) mod physical_light;
pub(super) mod shadow;
