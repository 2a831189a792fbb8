//! Every structure that Rust and WGSL share. `tests/pictures/shaders.rs` holds these layouts against the shaders by
//! reflection.

pub use crate::cloud::{PointRecord, ShapeRecord, TexturePlace, TriangleRecord, VertexRecord, VoxelRecord};
pub use crate::levels::NodeBounds;

use crate::analysis::screen::{RADIUS_SPACINGS, ScreenCloud, ScreenView};
use crate::levels::{Selection, SequenceFilter};
use crate::math::Frustum;
use crate::render::constants::{DEPTH_SLACK_RADII, opaque_weight};
use crate::rgbd::{Bilateral, Filters, FlyingPixels, Temporal};
use crate::scene::{
    AmbientOcclusion, Backdrop, EyeDomeLight, Kernel, Lamp, Lighting, Lights, PhysicalLight, PointSize, ScenePacket,
    Shadow, SplatFilter, Style, rim_px,
};
use crate::stereo::matching::constants::MOST_RADIUS;
use crate::stereo::{self, Between, DisparityRange, Matching, Penalties};
use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use std::f32::consts::LOG2_E;
use std::ops::Range;

/// [`ViewUniform::lighting`] of surfaces that are lit; WGSL gets these numbers from here (`constants.rs`).
pub(super) const LIGHTING_PER_SURFEL: u32 = 1;
pub(super) const LIGHTING_PER_VERTEX: u32 = 2;
pub(super) const LIGHTING_PER_FRAGMENT: u32 = 3;
const LIGHTING_UNLIT: u32 = 0;

/// [`ViewUniform::back_faces`] that are not drawn as fronts are.
pub(super) const BACK_FACES_CULLED: u32 = 1;
pub(super) const BACK_FACES_DARKER: u32 = 2;
const BACK_FACES_DRAWN: u32 = 0;

/// [`ViewUniform::kernel`].
pub(super) const KERNEL_HAT: u32 = 1;
pub(super) const KERNEL_BOX: u32 = 2;
const KERNEL_GAUSSIAN: u32 = 0;

/// Twin of `Gathering` in `passes/gather.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[expect(missing_docs, reason = "the fields are documented in their WGSL twin")]
pub struct Gathering {
    pub first: u32,
    pub count: u32,
    pub step: u32,
    pub radius_factor: f32,
}

impl Gathering {
    /// Of these records of a selection, with their radii or without.
    pub fn of(selection: &Selection, records: Range<u32>, has_radii: bool) -> Self {
        let (step, factor) = match *selection {
            Selection::At(_) | Selection::Filtered(_) => (0, 1.0),
            Selection::Every {
                step, radius_factor, ..
            } => (step, radius_factor),
        };
        Self {
            first: records.start,
            count: records.len() as u32,
            step,
            radius_factor: if has_radii { factor } else { 1.0 },
        }
    }
}

/// Twin of `Filtering` in `passes/filter.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[expect(missing_docs, reason = "the fields are documented in their WGSL twin")]
pub struct Filtering {
    pub first: u32,
    pub count: u32,
    pub inner_candidates: u32,
    pub inners: u32,
    pub eye: [f32; 3],
    pub marks: u32,
    pub area_px2: [u32; 2],
    pub small_px2: [u32; 2],
    pub rough_area_px2: f32,
    pub rough_small_px2: f32,
    pub is_oriented: u32,
    pub culls_back_faces: u32,
    pub deepest_level: u32,
    pub unused_a: u32,
    pub unused_b: u32,
    pub unused_c: u32,
    pub planes: [[f32; 4]; Frustum::PLANES],
}

impl Filtering {
    /// Of these candidates, of which those that are not drawn are marked or not.
    pub fn of(filter: &SequenceFilter, candidates: Range<u32>, marks: bool) -> Self {
        let numbers = filter.numbers();
        let words = |number: f64| [number.to_bits() as u32, (number.to_bits() >> 32) as u32];
        Self {
            first: candidates.start,
            count: candidates.len() as u32,
            inner_candidates: filter.inner_candidates(),
            inners: filter.bounds().len() as u32,
            eye: numbers.eye,
            marks: marks.into(),
            area_px2: words(numbers.area_px2),
            small_px2: words(numbers.small_px2),
            rough_area_px2: numbers.area_px2 as f32,
            rough_small_px2: numbers.small_px2 as f32,
            is_oriented: numbers.is_oriented.into(),
            culls_back_faces: numbers.culls_back_faces.into(),
            deepest_level: numbers.deepest_level,
            planes: numbers.planes,
            ..Self::zeroed()
        }
    }
}

/// Twin of `Screening` in `screen_normals/view.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[expect(missing_docs, reason = "the fields are documented in their WGSL twin")]
pub struct Screening {
    pub rotation_x: [f32; 3],
    pub near: f32,
    pub rotation_y: [f32; 3],
    pub radius: f32,
    pub rotation_z: [f32; 3],
    pub spacing: f32,
    pub eye_high: [f32; 3],
    pub closing: f32,
    pub eye_low: [f32; 3],
    pub has_sensor: u32,
    pub sensor: [f32; 3],
    pub point_count: u32,
    pub px_per_slope: [f32; 2],
    pub middle_px: [f32; 2],
    pub size_px: [u32; 2],
    pub first: u32,
    pub count: u32,
    pub level: u32,
    pub has_holes: u32,
    pub unused_a: u32,
    pub unused_b: u32,
}

impl Screening {
    /// Of so many points, in the view of a picture with its margin.
    pub fn of(view: &ScreenView, cloud: &ScreenCloud, point_count: u32) -> Self {
        let spacing = cloud.spacing.max(0.0);
        let sensor = cloud.sensor.map(|sensor| (sensor - view.eye_high) - view.eye_low);
        Self {
            rotation_x: view.rotation.x_axis.to_array(),
            rotation_y: view.rotation.y_axis.to_array(),
            rotation_z: view.rotation.z_axis.to_array(),
            near: view.near,
            radius: RADIUS_SPACINGS * spacing,
            spacing,
            eye_high: view.eye_high.to_array(),
            eye_low: view.eye_low.to_array(),
            closing: cloud.closing,
            has_sensor: sensor.is_some().into(),
            sensor: sensor.unwrap_or_default().to_array(),
            point_count,
            px_per_slope: view.px_per_slope,
            middle_px: view.middle_px,
            size_px: view.size_px,
            ..Self::zeroed()
        }
    }
}

/// Twin of `DepthImaging` in `depth_images/image.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[expect(missing_docs, reason = "the fields are documented in their WGSL twin")]
pub struct DepthImaging {
    pub size_px: [u32; 2],
    pub near_m: f32,
    pub far_m: f32,
    pub origin: [f32; 3],
    pub is_coded: u32,
    pub exponent_per_px2: f32,
    pub sigma_m: f32,
    pub noise_factor: f32,
    pub flying_m: f32,
    pub flying_share: f32,
    pub least_neighbours: f32,
    pub newest_share: f32,
    pub same_m: f32,
    pub fill_frames: u32,
    pub has_colors: u32,
    pub one_color: u32,
    pub unused: u32,
}

impl DepthImaging {
    /// Of an image of this size; what filters that are off would be told says nothing.
    pub fn of(size_px: [u32; 2], filters: &Filters) -> Self {
        let (near_m, far_m) = filters.near.map_or((0.0, f32::MAX), |near| (near.near_m, near.far_m));
        let bilateral = filters.bilateral.unwrap_or(Bilateral::USUAL);
        let flying = filters.flying.unwrap_or(FlyingPixels::USUAL);
        let temporal = filters.temporal.unwrap_or(Temporal::USUAL);
        Self {
            size_px,
            near_m,
            far_m,
            exponent_per_px2: -LOG2_E / (2.0 * bilateral.space_px * bilateral.space_px),
            sigma_m: bilateral.depth_m.unwrap_or(0.0),
            noise_factor: bilateral.noise_factor,
            flying_m: flying.most_m,
            flying_share: flying.most_share,
            least_neighbours: flying.least_neighbours.into(),
            newest_share: temporal.share,
            same_m: temporal.most_m,
            fill_frames: temporal.fill_frames.into(),
            ..Self::zeroed()
        }
    }
}

/// Twin of `StereoMatching` in `stereo/pair.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[expect(missing_docs, reason = "the fields are documented in their WGSL twin")]
pub struct StereoMatching {
    pub size_px: [u32; 2],
    pub count: u32,
    pub min_px: i32,
    pub path_step: [i32; 2],
    pub is_first_path: u32,
    pub radius_px: u32,
    pub p1: u32,
    pub p2_least: u32,
    pub p2_above_least: u32,
    pub half_change: u32,
    pub unique_percent: u32,
    pub by_parabola: u32,
}

impl StereoMatching {
    /// Of a pair of this size, before its first path. Precondition: penalties are valid.
    pub fn of(size_px: [u32; 2], range: DisparityRange, matching: &Matching) -> Self {
        let (penalties, radius_px) = match matching.gathering {
            stereo::Gathering::SemiGlobal(penalties) => (penalties, 0),
            stereo::Gathering::Local { radius_px } => (Penalties::default(), radius_px.min(MOST_RADIUS)),
        };
        Self {
            size_px,
            count: range.count() as u32,
            min_px: range.min(),
            radius_px: radius_px as u32,
            p1: penalties.p1.into(),
            p2_least: penalties.p2_least.into(),
            p2_above_least: (penalties.p2 - penalties.p2_least).into(),
            half_change: penalties.half_change.max(1).into(),
            unique_percent: matching.unique_percent.into(),
            by_parabola: (matching.between == Between::Parabola).into(),
            ..Self::zeroed()
        }
    }
}

/// Twin of `View` in `common/view.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[expect(missing_docs, reason = "the fields are documented in their WGSL twin")]
pub struct ViewUniform {
    pub rotation_x: [f32; 4],
    pub rotation_y: [f32; 4],
    pub rotation_z: [f32; 4],
    pub eye_high: [f32; 3],
    pub splat_scale: f32,
    pub eye_low: [f32; 3],
    pub near: f32,
    pub focal: [f32; 2],
    pub viewport_px: [f32; 2],
    pub background_top: [f32; 3],
    pub opaque_weight: f32,
    pub background_bottom: [f32; 3],
    pub rim_px: f32,
    pub depth_range: [f32; 2],
    pub point_least_px: f32,
    pub cube_half_edge: f32,
    pub depth_slack: f32,
    pub lighting: u32,
    pub back_faces: u32,
    pub ground_spacing: f32,
    pub center_ndc: [f32; 2],
    pub eye_dome_reach_px: [i32; 2],
    pub eye_dome: [f32; 4],
    pub ground_normal: [f32; 4],
    pub ground_right: [f32; 4],
    pub ground_forward: [f32; 4],
    pub ground_color: [f32; 4],
    pub ambient: f32,
    pub head_light: f32,
    pub specular: f32,
    pub usual_distance: f32,
    pub depth_slack_px: f32,
    pub filter_radius_px: f32,
    pub kernel: u32,
    pub samples_per_edge: f32,
    pub occlusion_near_radius_px: f32,
    pub occlusion_most_radius_px: f32,
    pub occlusion_strength: f32,
    pub shadow_texel: f32,
    pub px_per_slope: [f32; 2],
    pub point_edge: f32,
    pub point_edge_per_radius: f32,
    pub lamps: [LampUniform; Lights::MOST_LAMPS],
    pub lamp_from_view_x: [f32; 4],
    pub lamp_from_view_y: [f32; 4],
    pub lamp_from_view_z: [f32; 4],
    pub shadow_focal: f32,
    pub shadow_near: f32,
    pub metallic: f32,
    pub alpha: f32,
    pub mean_loss: f32,
    pub mean_let_in: f32,
    pub environment_light: f32,
    pub clamp_radius_px: f32,
    pub environment_from_view_x: [f32; 4],
    pub environment_from_view_y: [f32; 4],
    pub environment_from_view_z: [f32; 4],
    pub harmonics: [[f32; 4]; 9],
}

/// Twin of `Lamp` in `common/view.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, Default, PartialEq, Pod, Zeroable)]
#[expect(missing_docs, reason = "the fields are documented in their WGSL twin")]
pub struct LampUniform {
    pub place: [f32; 4],
    pub color: [f32; 4],
}

/// Twin of `SplatVertex` in `common/quads.wgsl`: one corner written by the compute strategy.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[expect(missing_docs, reason = "the fields are documented in their WGSL twin")]
pub struct SplatVertex {
    pub clip: [f32; 4],
    pub color: u32,
    pub normal: u32,
    pub light: u32,
    pub weight: f32,
}

impl ViewUniform {
    /// The uniforms of one pass over `packet` as it is drawn ([`ScenePacket::as_drawn`]); `enlargement` multiplies its
    /// splat scale.
    pub fn new(packet: &ScenePacket, enlargement: f32) -> Self {
        let Style {
            backdrop: Backdrop { background, .. },
            ..
        } = packet.style;
        let rotation = packet.view.view_from_frame_rotation;
        // Of a part of a picture the gradient is a part too.
        let [background_top, background_bottom] = packet.view.rows_of_whole.map(|share| {
            let [top, bottom] = [background.top, background.bottom].map(normalized);
            top * (1.0 - share) + bottom * share
        });
        let eye_dome = EyeDomeLight::of(packet);
        let ground = packet.ground.map(|ground| ground.seen_by(&packet.view));
        let ground_axis = |axis: usize| {
            ground.map_or([0.0; 4], |ground| {
                let along = ground.point_along_axes[axis];
                ground.axes[axis].extend(along).to_array()
            })
        };
        let lights = Lights::of(packet);
        let point_size = PointSize::of(packet);
        let of_lights = |value: fn(Lights) -> f32| lights.map_or(0.0, value);
        let occlusion = AmbientOcclusion::of(packet);
        let of_occlusion = |value: fn(AmbientOcclusion) -> f32| occlusion.map_or(0.0, value);
        let has_slack = packet.style.blends_at_depths();
        Self {
            rotation_x: rotation.x_axis.extend(0.0).to_array(),
            rotation_y: rotation.y_axis.extend(0.0).to_array(),
            rotation_z: rotation.z_axis.extend(0.0).to_array(),
            eye_high: packet.view.eye_high.to_array(),
            splat_scale: packet.style.surfels.splat_scale * enlargement,
            eye_low: packet.view.eye_low.to_array(),
            near: packet.view.near,
            focal: packet.view.focal,
            viewport_px: packet.viewport_px.map(|edge| edge as f32),
            background_top: background_top.to_array(),
            opaque_weight: opaque_weight(&packet.style),
            background_bottom: background_bottom.to_array(),
            rim_px: rim_px(packet) as f32,
            depth_range: packet.depth_range(),
            point_least_px: point_size.least_px,
            cube_half_edge: packet.content.voxels().map_or(0.0, |voxels| 0.5 * voxels.cube_edge),
            depth_slack: if has_slack { DEPTH_SLACK_RADII } else { 0.0 },
            lighting: match packet.lighting() {
                Lighting::Unlit | Lighting::Lambert | Lighting::BlinnPhong | Lighting::Physical => LIGHTING_UNLIT,
                Lighting::PerSurfel => LIGHTING_PER_SURFEL,
                Lighting::PerVertex => LIGHTING_PER_VERTEX,
                Lighting::PerFragment => LIGHTING_PER_FRAGMENT,
            },
            back_faces: if packet.style.culls_back_faces() {
                BACK_FACES_CULLED
            } else if packet.style.darkens_back_faces() {
                BACK_FACES_DARKER
            } else {
                BACK_FACES_DRAWN
            },
            ground_spacing: ground.map_or(1.0, |ground| ground.spacing),
            center_ndc: packet.view.center_ndc,
            eye_dome_reach_px: eye_dome.map_or([0; 2], |light| light.reach_px.map(|reach_px| reach_px as i32)),
            eye_dome: eye_dome.map_or([0.0; 4], |light| {
                let [straight, diagonal] = light.gains;
                [straight, diagonal, light.most, light.edge]
            }),
            ground_normal: ground.map_or([0.0; 4], |ground| ground.normal.extend(ground.height).to_array()),
            ground_right: ground_axis(0),
            ground_forward: ground_axis(1),
            ground_color: ground.map_or([0.0; 4], |ground| {
                let [red, green, blue] = ground.color;
                [red, green, blue, ground.reach]
            }),
            ambient: of_lights(|lights| lights.ambient),
            head_light: of_lights(|lights| lights.head),
            specular: of_lights(|lights| lights.specular),
            usual_distance: of_lights(|lights| lights.usual_distance),
            depth_slack_px: packet.style.splat_filter().radius_px(),
            kernel: match packet.style.kernel() {
                Kernel::Gaussian => KERNEL_GAUSSIAN,
                Kernel::Hat => KERNEL_HAT,
                Kernel::Flat => KERNEL_BOX,
            },
            occlusion_near_radius_px: of_occlusion(|occlusion| occlusion.near_radius_px),
            occlusion_most_radius_px: of_occlusion(|occlusion| occlusion.most_radius_px),
            occlusion_strength: of_occlusion(|occlusion| occlusion.strength),
            samples_per_edge: packet.style.drawing.antialiasing.samples_per_edge() as f32,
            px_per_slope: [0, 1].map(|axis| 0.5 * packet.view.focal[axis] * packet.viewport_px[axis] as f32),
            point_edge: point_size.edge,
            point_edge_per_radius: point_size.edge_per_radius,
            lamps: lights.map_or_else(Default::default, |lights| lights.lamps.map(LampUniform::from)),
            ..Self::zeroed()
        }
    }

    /// The same with the shadow of the key light.
    #[must_use]
    pub fn with_shadow(self, shadow: &Shadow) -> Self {
        let [x, y, z] = shadow.lamp_from_view.map(|row| row.to_array());
        let lamp_view = &shadow.lamp_packet.view;
        Self {
            lamp_from_view_x: x,
            lamp_from_view_y: y,
            lamp_from_view_z: z,
            shadow_focal: lamp_view.focal[0],
            shadow_near: lamp_view.near,
            shadow_texel: shadow.texel,
            ..self
        }
    }

    /// The same with a material and an environment.
    #[must_use]
    pub fn with_physical(self, physical: &PhysicalLight) -> Self {
        let curve = &physical.tables.curve;
        let column = |axis: Vec3| axis.extend(0.0).to_array();
        Self {
            metallic: physical.metallic,
            alpha: physical.alpha,
            mean_loss: curve.mean_loss,
            mean_let_in: curve.mean_let_in,
            environment_light: physical.environment_light,
            environment_from_view_x: column(physical.environment_from_view.x_axis),
            environment_from_view_y: column(physical.environment_from_view.y_axis),
            environment_from_view_z: column(physical.environment_from_view.z_axis),
            harmonics: physical.harmonics.0.map(column),
            ..self
        }
    }

    /// The uniforms of the pass that draws the map of a shadow.
    pub fn of_lamp(shadow: &Shadow) -> Self {
        Self {
            depth_slack: shadow.slack_radii,
            ..Self::new(&shadow.lamp_packet, 1.0)
        }
    }

    /// The same for the attribute pass, whose splats are not pushed back, but filtered.
    #[must_use]
    pub fn of_attributes(self, filter: SplatFilter) -> Self {
        let is = |other| if filter == other { filter.radius_px() } else { 0.0 };
        Self {
            depth_slack: 0.0,
            depth_slack_px: 0.0,
            filter_radius_px: is(SplatFilter::Ewa),
            clamp_radius_px: is(SplatFilter::Clamp),
            ..self
        }
    }
}

impl From<Lamp> for LampUniform {
    fn from(lamp: Lamp) -> Self {
        Self {
            place: lamp.place.to_array(),
            color: lamp.color.extend(0.0).to_array(),
        }
    }
}

fn normalized(color: [u8; 3]) -> Vec3 {
    Vec3::from_array(color.map(|channel| f32::from(channel) / 255.0))
}
