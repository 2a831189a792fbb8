//! Structures that Rust and WGSL share, declared once: WGSL imports them (`shader_library.rs`), but for the records of
//! clouds and trees. `tests/pictures/shaders/mod.rs` checks their layouts against the shaders by reflection.

pub use crate::cloud::{PointRecord, ShapeRecord, TexturePlace, TriangleRecord, VertexRecord, VoxelRecord};
pub use crate::levels::NodeBounds;

use super::layout::{Layout, Shared, shared_struct};
use crate::analysis::screen::{RADIUS_SPACINGS, ScreenCloud, ScreenView};
use crate::cloud::FINEST_NORMAL_BITS;
use crate::levels::octree::CodedCloud;
use crate::levels::octree::coded::{CodeView, offset_of_code};
use crate::levels::{Selection, SequenceFilter};
use crate::math::Frustum;
use crate::render::constants::depth_slack_radii;
use crate::rgbd::{Bilateral, Filters, FlyingPixels, Temporal};
use crate::scene::{Kernel, Lighting, Lights, PointSize, ScenePacket, Shadow, SplatFilter};
use crate::stereo::matching::constants::MAX_RADIUS;
use crate::stereo::{self, Between, DisparityRange, Matching, Penalties};
use bytemuck::Zeroable;
use std::f32::consts::LOG2_E;
use std::ops::Range;

/// The structures declared here; those of effects are with these.
pub const LAYOUTS: [&Layout; 9] = [
    &Gathering::LAYOUT,
    &Filtering::LAYOUT,
    &Screening::LAYOUT,
    &Expanding::LAYOUT,
    &DepthImaging::LAYOUT,
    &StereoMatching::LAYOUT,
    &ViewUniform::LAYOUT,
    &SplatVertex::LAYOUT,
    &DrawIndexedIndirect::LAYOUT,
];

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

shared_struct! {
    /// Uniform of `passes/gather.wgsl`: the records to gather.
    pub Gathering as "Gathering" {
        /// The first of these records among those that are selected.
        first: u32,
        /// Number of records.
        count: u32,
        /// From one record to the next; 0 if indices select them.
        step: u32,
        /// On the second number of a record, which is a radius, unless it is 1.
        radius_factor: f32,
    }
}

impl Gathering {
    /// Creates the uniform for these records of a selection, with their radii or without.
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

shared_struct! {
    /// Uniform of `passes/filter.wgsl`: the criteria that candidates are tested against.
    pub Filtering as "Filtering" {
        /// The first of these candidates.
        first: u32,
        /// Number of candidates.
        count: u32,
        /// Candidates that are not leaves.
        inner_candidates: u32,
        /// Nodes of the tree that are not leaves. The root, the first of these, is not a candidate, but divided.
        inners: u32,
        /// Eye position of the view.
        eye: [f32; 3],
        /// 1 where nodes that are not drawn are marked, which shapes are.
        marks: u32,
        /// A double: the area of a disk of radius 1 at a distance of 1.
        area_px2: [u32; 2],
        /// A double: the area of the largest small node.
        small_px2: [u32; 2],
        /// Roughly the same as `area_px2`.
        rough_area_px2: f32,
        /// Roughly the same as `small_px2`.
        rough_small_px2: f32,
        /// Boolean: nodes have normal cones.
        is_oriented: u32,
        /// Back-face culling flag: nodes that face away are not drawn.
        culls_back_faces: u32,
        /// Nodes of this level are not divided.
        deepest_level: u32,
        /// Padding.
        unused_a: u32,
        /// Padding.
        unused_b: u32,
        /// Padding.
        unused_c: u32,
        /// Planes of the view frustum.
        planes: [[f32; 4]; Frustum::PLANES],
    }
}

impl Filtering {
    /// Creates the uniform for these candidates, with those that are not drawn marked or not.
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

shared_struct! {
    /// The view that surfels of the screen are made in (`screen_normals/view.wgsl`).
    pub Screening as "Screening" {
        /// Columns of the rotation from the axes of the cloud to the view's (right, up, backward).
        rotation_x: [f32; 3],
        /// Distance to the near plane.
        near: f32,
        /// The second column.
        rotation_y: [f32; 3],
        /// In which neighbours are looked for, scene units.
        radius: f32,
        /// The third column.
        rotation_z: [f32; 3],
        /// Between points, scene units.
        spacing: f32,
        /// The eye is `eye_high + eye_low`.
        eye_high: [f32; 3],
        /// Factor on radii.
        closing: f32,
        /// The rest of the eye.
        eye_low: [f32; 3],
        /// Boolean: there is a sensor position.
        has_sensor: u32,
        /// Sensor position relative to the eye.
        sensor: [f32; 3],
        /// Number of points in the cloud.
        point_count: u32,
        /// Pixels for a slope of 1.
        px_per_slope: [f32; 2],
        /// Principal point, where the view axis meets the image.
        center_px: [f32; 2],
        /// Size of the image with its margin.
        size_px: [u32; 2],
        /// The first record written by `surface` among all.
        first: u32,
        /// Number of records that `surface` writes.
        count: u32,
        /// Level of the cells that `coarsen` writes.
        level: u32,
        /// Boolean: points of no colour at all are holes of an image.
        has_holes: u32,
        /// Padding.
        unused_a: u32,
        /// Padding.
        unused_b: u32,
    }
}

impl Screening {
    /// Creates the uniform for the given number of points, in the view of an image with its margin.
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
            center_px: view.center_px,
            size_px: view.size_px,
            ..Self::zeroed()
        }
    }
}

shared_struct! {
    /// The view that a byte code is traversed for, at one level of it (`coded/code.wgsl`).
    pub Expanding as "Expanding" {
        /// The eye is `eye_high + eye_low`.
        eye_high: [f32; 3],
        /// Distance to the near plane.
        near: f32,
        /// The rest of the eye.
        eye_low: [f32; 3],
        /// Pixels for a slope of 1.
        px_per_slope: f32,
        /// Unit vector of the view axis.
        forward: [f32; 3],
        /// Cells whose edge projects below this many pixels are not divided.
        lod_px: f32,
        /// Smallest corner of the cube of the root.
        cube_min: [f32; 3],
        /// Its edge.
        cube_edge: f32,
        /// Unit normals of the side planes, which contain the eye, pointing inwards; the fourth numbers are unused.
        sides: [[f32; 4]; 4],
        /// Offsets along normals by their codes, in cell edges.
        offsets: [[f32; 4]; 2],
        /// Level of the queue.
        level: u32,
        /// Nodes of this level are not divided.
        deepest_level: u32,
        /// Reach of splats from their cells on this level and below, scene units.
        reach: f32,
        /// Reach of a splat in its radii.
        reach_radii: f32,
        /// Back-face culling flag: nodes that face away are not drawn.
        culls_back_faces: u32,
        /// Bits of the index of a normal that are not used.
        normal_shift: u32,
        /// Word at which the numbers of bits begin.
        ranks_start: u32,
        /// Word at which the attributes begin.
        attributes_start: u32,
        /// The first record of a chunk among the drawn nodes.
        first: u32,
        /// Number of records of the chunk.
        count: u32,
        /// Boolean: drawn nodes whose own normal faces away are not drawn either.
        culls_by_own_normals: u32,
        /// Nodes of the level, which its queue has no more of.
        max_queued: u32,
    }
}

impl Expanding {
    /// Creates the uniforms of the levels of a code from the root to the deepest that is drawn.
    pub fn of_levels(cloud: &CodedCloud, view: &CodeView, deepest_level: u32) -> Vec<Self> {
        let [ranks_start, attributes_start, _] = cloud.word_starts().map(|word| word as u32);
        let offset = |code| offset_of_code(code, view.offset_bits);
        let of_view = Self {
            eye_high: view.eye_high.to_array(),
            near: view.near,
            eye_low: view.eye_low.to_array(),
            px_per_slope: view.px_per_slope,
            forward: view.forward.to_array(),
            lod_px: view.lod_px,
            cube_min: cloud.cube().min.as_vec3().to_array(),
            cube_edge: cloud.cube().edge,
            sides: view.sides.map(|side| side.extend(0.0).to_array()),
            offsets: [[0, 1, 2, 3], [4, 5, 6, 7]].map(|codes| codes.map(offset)),
            deepest_level,
            reach_radii: view.reach_radii,
            culls_back_faces: view.culls_back_faces.into(),
            culls_by_own_normals: view.culls_by_own_normals.into(),
            normal_shift: FINEST_NORMAL_BITS - view.normal_bits,
            ranks_start,
            attributes_start,
            ..Self::zeroed()
        };
        let reaches = cloud.reaches(view.reach_radii).into_iter();
        (0..=deepest_level)
            .zip(reaches)
            .map(|(level, reach)| Self {
                level,
                reach,
                max_queued: cloud.level(level).len() as u32,
                ..of_view
            })
            .collect()
    }
}

shared_struct! {
    /// The filters of a depth image, and the points of its pixels (`depth_images/image.wgsl`).
    pub DepthImaging as "DepthImaging" {
        /// Size of the depth image.
        size_px: [u32; 2],
        /// Nearer depths are dropped.
        near_m: f32,
        /// Farther depths are dropped.
        far_m: f32,
        /// Origin of the points: the position that their centre is moved to, in the camera frame.
        origin: [f32; 3],
        /// Boolean: samples are 16-bit codes, two in a word, that the table maps to metres; otherwise they are metres.
        is_coded: u32,
        /// Exponent of 2 by the square of the distance in pixels.
        exponent_per_px2: f32,
        /// Depth sigma of the bilateral filter, if it is the same everywhere, else 0.
        sigma_m: f32,
        /// On the noise of the sensor, where that is the measure.
        noise_factor: f32,
        /// Distance within which neighbours are near.
        flying_m: f32,
        /// Flying-pixel threshold as a fraction of the depth.
        flying_share: f32,
        /// Pixels with fewer near neighbours are dropped.
        min_neighbours: f32,
        /// Weight of the newest image in the temporal mean.
        newest_share: f32,
        /// Depths that differ by less are of one surface.
        same_m: f32,
        /// For how many frames holes are filled.
        fill_frames: u32,
        /// Boolean: there is a colour image.
        has_colors: u32,
        /// Colour of all points without a colour image: red, green, blue, alpha.
        one_color: u32,
        /// Padding.
        unused: u32,
    }
}

impl DepthImaging {
    /// Creates the uniform for an image of this size; the values for disabled filters have no meaning.
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
            flying_m: flying.max_m,
            flying_share: flying.max_share,
            min_neighbours: flying.min_neighbours.into(),
            newest_share: temporal.share,
            same_m: temporal.max_m,
            fill_frames: temporal.fill_frames.into(),
            ..Self::zeroed()
        }
    }
}

shared_struct! {
    /// Uniform of `stereo/pair.wgsl`: parameters for matching a stereo pair.
    pub StereoMatching as "StereoMatching" {
        /// Size of either image.
        size_px: [u32; 2],
        /// Labels of a pixel, an even number; label k is the disparity `min_px` + k.
        count: u32,
        /// Minimum disparity.
        min_px: i32,
        /// From pixel to pixel of a path.
        path_step: [i32; 2],
        /// Boolean: the path is the first one and writes sums; otherwise it adds to them.
        is_first_path: u32,
        /// Radius of the squares that costs are summed over.
        radius_px: u32,
        /// Penalty of a step of one label.
        p1: u32,
        /// Minimum penalty of a longer step.
        p2_min: u32,
        /// Additional penalty of a longer step where brightness does not change.
        p2_above_min: u32,
        /// Change of brightness at which half of that is left.
        half_change: u32,
        /// Margin by which the best label must be better than others.
        unique_percent: u32,
        /// Boolean: subpixel positions between labels come from a parabola.
        by_parabola: u32,
    }
}

impl StereoMatching {
    /// Creates the uniform for a pair of this size, before its first path. Precondition: penalties are valid.
    pub fn of(size_px: [u32; 2], range: DisparityRange, matching: &Matching) -> Self {
        let (penalties, radius_px) = match matching.gathering {
            stereo::Gathering::SemiGlobal(penalties) => (penalties, 0),
            stereo::Gathering::Local { radius_px } => (Penalties::default(), radius_px.min(MAX_RADIUS)),
        };
        Self {
            size_px,
            count: range.count() as u32,
            min_px: range.min(),
            radius_px: radius_px as u32,
            p1: penalties.p1.into(),
            p2_min: penalties.p2_min.into(),
            p2_above_min: (penalties.p2 - penalties.p2_min).into(),
            half_change: penalties.half_change.max(1).into(),
            unique_percent: matching.unique_percent.into(),
            by_parabola: (matching.between == Between::Parabola).into(),
            ..Self::zeroed()
        }
    }
}

shared_struct! {
    /// The camera, and how records are drawn in one pass.
    pub ViewUniform as "View" {
        /// Columns of the rotation from the frame's space into view space (right, up, backward).
        rotation_x: [f32; 4],
        /// The second column.
        rotation_y: [f32; 4],
        /// The third column.
        rotation_z: [f32; 4],
        /// The eye in the frame's space is `eye_high + eye_low`.
        eye_high: [f32; 3],
        /// Factor on the splat radius in this pass.
        splat_scale: f32,
        /// The rest of the eye.
        eye_low: [f32; 3],
        /// Distance to the near plane.
        near: f32,
        /// Cotangents of half the field of view, horizontal and vertical.
        focal: [f32; 2],
        /// Viewport size of the rendered image.
        viewport_px: [f32; 2],
        /// Principal point, where the view axis meets the image: 0, except for a part of a larger image.
        center_ndc: [f32; 2],
        /// Pixels for a slope of 1, to the right and upwards.
        px_per_slope: [f32; 2],
        /// Edge of a drawn point at least.
        point_min_px: f32,
        /// Edge of a drawn point, scene units.
        point_edge: f32,
        /// Increase of the point edge per unit of the point's radius.
        point_edge_per_radius: f32,
        /// Half the edge of the octree's cube.
        cube_half_edge: f32,
        /// Depth offset by which the visibility pass and the shadow map are pushed back, in splat radii.
        depth_slack: f32,
        /// Additional depth offset for splats that are filtered to the pixels.
        depth_slack_px: f32,
        /// Radius of a point's splat by that filter; 0 if there is none.
        filter_radius_px: f32,
        /// Minimum splat radius of sprites, in pixels; 0 if there is none.
        clamp_radius_px: f32,
        /// `LIGHTING_*`, or without light.
        lighting: u32,
        /// `BACK_FACES_*`, or drawn as fronts are.
        back_faces: u32,
        /// `KERNEL_*`, or Gaussian.
        kernel: u32,
        /// Distance of the centre of the cloud: the unit of distances that half floats hold.
        usual_distance: f32,
    }
}

shared_struct! {
    /// A draw call that a pass writes. The first four words also serve a draw of vertices without indices.
    pub DrawIndexedIndirect as "DrawIndexedIndirect" {
        /// Number of indices to draw.
        index_count: u32,
        /// Number of instances.
        instance_count: u32,
        /// The first of them.
        first_index: u32,
        /// Is added to each.
        base_vertex: i32,
        /// The number of the first instance.
        first_instance: u32,
    }
}

shared_struct! {
    /// A corner that the strategy `compute` has written, ready for the rasteriser.
    pub SplatVertex as "SplatVertex" {
        /// Its place.
        clip: [f32; 4],
        /// 8-bit red, green, blue in the low bytes.
        color: u32,
        /// Packed, see `oct_decode`.
        normal: u32,
        /// See `light.wgsl`: both unorm16.
        light: u32,
        /// Factor on the mask of a splat.
        weight: f32,
    }
}

impl ViewUniform {
    /// The uniforms of one pass over `packet` as it is drawn ([`ScenePacket::as_drawn`]); `enlargement` multiplies its
    /// splat scale.
    pub fn new(packet: &ScenePacket, enlargement: f32) -> Self {
        let rotation = packet.view.view_from_frame_rotation;
        let lights = Lights::of(packet);
        let point_size = PointSize::of(packet);
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
            point_min_px: point_size.min_px,
            cube_half_edge: packet.content.voxels().map_or(0.0, |voxels| 0.5 * voxels.cube_edge),
            depth_slack: if has_slack {
                depth_slack_radii(&packet.style)
            } else {
                0.0
            },
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
            center_ndc: packet.view.center_ndc,
            usual_distance: lights.map_or(0.0, |lights| lights.usual_distance),
            depth_slack_px: packet.style.splat_filter().radius_px(),
            kernel: match packet.style.kernel() {
                Kernel::Gaussian => KERNEL_GAUSSIAN,
                Kernel::Hat => KERNEL_HAT,
                Kernel::Flat => KERNEL_BOX,
            },
            px_per_slope: [0, 1].map(|axis| 0.5 * packet.view.focal[axis] * packet.viewport_px[axis] as f32),
            point_edge: point_size.edge,
            point_edge_per_radius: point_size.edge_per_radius,
            ..Self::zeroed()
        }
    }

    /// The uniforms of the pass that draws the map of a shadow.
    pub fn of_lamp(shadow: &Shadow) -> Self {
        Self {
            depth_slack: shadow.slack_radii,
            ..Self::new(&shadow.lamp_packet, 1.0)
        }
    }

    /// Returns the view uniform for the attribute pass, whose splats are not pushed back, but filtered.
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
