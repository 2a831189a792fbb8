//! Metallic–roughness shading against its formulas in double precision, whose integrals are taken by brute force; and
//! those against their guarantees: no light is made or lost, and eye and lamp are interchangeable.

use crate::common::{Surfel, camera_at, draw, draw_on_cpu, plain, surfels, to_display, to_linear};
use glam::{DVec3, Vec3};
use pointreel::math::Aabb;
use pointreel::scene::{
    BackFaces, Camera, DrawSettings, Environment, EnvironmentMap, LightRig, Lighting, Lights, OnOff, PhysicalLight,
    PhysicalTables, ScenePacket, Style,
};
use proptest::prelude::*;
use std::f64::consts::{PI, TAU};

/// Odd, so that the centre of a pixel is on the axis of the view.
const EDGE_PX: u32 = 41;

const DISTANCE: f64 = 3.0;

const NORMALS: [Vec3; 4] = [
    Vec3::Z,
    Vec3::new(0.5, 0.3, -0.8),
    Vec3::new(-0.6, 0.2, 0.4),
    Vec3::new(0.4, -0.85, 0.3),
];

fn style_of(material: (f32, f32), rig: LightRig, environment: Environment) -> Style {
    plain().with(|style| {
        style.light.lighting = Lighting::Physical;
        (style.light.metallic, style.light.roughness) = material;
        style.light.rig = rig;
        style.light.environment = environment;
        style.surfels.back_faces = BackFaces::Drawn;
    })
}

/// One surfel at the centre of a cloud of radius 1.
fn one_surfel(normal: Vec3, color: [u8; 3], camera: &Camera, style: Style) -> ScenePacket {
    let surfel = Surfel {
        position: Vec3::ZERO,
        normal: normal.normalize(),
        radius: 0.5,
        color,
    };
    let mut packet = surfels(&[surfel], camera, style, [EDGE_PX; 2]);
    packet.bounds = Aabb::from_points(&[Vec3::splat(-0.577), Vec3::splat(0.577)]);
    packet
}

/// The central pixel of both renderers.
fn drawn(packet: &ScenePacket) -> [([u8; 3], &'static str); 2] {
    [(draw_on_cpu(packet), "processor"), (draw(packet), "GPU")].map(|(picture, by)| {
        let [red, green, blue, _] = picture.get_pixel(EDGE_PX / 2, EDGE_PX / 2).0;
        ([red, green, blue], by)
    })
}

/// Between normal and eye, and normal and light; and of the half vector.
#[derive(Debug, Clone, Copy)]
struct Cosines {
    eye: f64,
    light: f64,
    half: f64,
    /// Between eye and half vector.
    facing: f64,
}

impl Cosines {
    fn of(normal: DVec3, to_eye: DVec3, to_light: DVec3) -> Self {
        let half = (to_eye + to_light).normalize();
        Self {
            eye: normal.dot(to_eye),
            light: normal.dot(to_light),
            half: normal.dot(half).min(1.0),
            facing: half.dot(to_eye),
        }
    }
}

/// D V, times π.
fn microfacets(cosines: Cosines, alpha: f64) -> f64 {
    let alpha2 = alpha * alpha;
    let distribution = alpha2 / (cosines.half * cosines.half * (alpha2 - 1.0) + 1.0).powi(2);
    let smith = |one: f64, other: f64| one * (other * other * (1.0 - alpha2) + alpha2).sqrt();
    distribution * 0.5 / (smith(cosines.light, cosines.eye) + smith(cosines.eye, cosines.light))
}

fn schlick(reflectance: f64, facing: f64) -> f64 {
    reflectance + (1.0 - reflectance) * (1.0 - facing).powi(5)
}

/// A material in double precision: the energy loss of a roughness, by brute force.
#[derive(Debug, Clone)]
struct Exact {
    alpha: f64,
    /// For a surface that reflects 0, and 1, at normal incidence, for cosines in equal steps.
    mirrored: Vec<[f64; 2]>,
    /// For light by its cosine: the fraction that a bounce loses, and the fraction that a dielectric transmits.
    mean_loss: f64,
    mean_let_in: f64,
}

impl Exact {
    const STEPS: usize = 128;

    fn new(roughness: f64) -> Self {
        let alpha = roughness * roughness;
        let mirrored = (0..=Self::STEPS).map(|step| {
            let cosine = (step as f64 / Self::STEPS as f64).max(1e-4);
            Self::integral(cosine, alpha)
        });
        let mut exact = Self {
            mirrored: mirrored.collect(),
            alpha,
            mean_loss: 0.0,
            mean_let_in: 0.0,
        };
        exact.mean_loss = mean(|cosine| exact.loss(cosine));
        exact.mean_let_in = mean(|cosine| exact.let_in(cosine));
        exact
    }

    /// Over all microfacets in equal parts of their distribution, whose density cancels out but for the cosines.
    fn integral(cosine: f64, alpha: f64) -> [f64; 2] {
        const STEPS: [usize; 2] = [1000, 100];
        let to_eye = DVec3::new((1.0 - cosine * cosine).sqrt(), 0.0, cosine);
        let mut sums = [0.0; 2];
        for i in 0..STEPS[0] {
            let share = (i as f64 + 0.5) / STEPS[0] as f64;
            let height2 = (1.0 - share) / (1.0 + (alpha * alpha - 1.0) * share);
            for j in 0..STEPS[1] {
                let azimuth = PI * (j as f64 + 0.5) / STEPS[1] as f64;
                let aside = (1.0 - height2).sqrt();
                let half = DVec3::new(aside * azimuth.cos(), aside * azimuth.sin(), height2.sqrt());
                let facing = half.dot(to_eye);
                let to_light = half * (2.0 * facing) - to_eye;
                if facing <= 0.0 || to_light.z <= 0.0 {
                    continue;
                }
                let cosines = Cosines {
                    eye: cosine,
                    light: to_light.z,
                    half: half.z,
                    facing,
                };
                let distribution = microfacets(cosines, alpha) * cosines.light;
                let density = alpha * alpha / (height2 * (alpha * alpha - 1.0) + 1.0).powi(2) * half.z / (4.0 * facing);
                let weight = distribution / density / (STEPS[0] * STEPS[1]) as f64;
                sums[0] += weight * schlick(0.0, facing);
                sums[1] += weight;
            }
        }
        sums
    }

    fn albedo(&self, reflectance: f64, cosine: f64) -> f64 {
        let place = cosine.clamp(0.0, 1.0) * Self::STEPS as f64;
        let first = (place as usize).min(Self::STEPS - 1);
        let of = |[none, all]: [f64; 2]| none + reflectance * (all - none);
        let [before, after] = [self.mirrored[first], self.mirrored[first + 1]].map(of);
        before + (place - first as f64) * (after - before)
    }

    fn loss(&self, cosine: f64) -> f64 {
        1.0 - self.albedo(1.0, cosine)
    }

    fn of_more_bounces(&self, reflectance: f64) -> f64 {
        let mean = reflectance + (1.0 - reflectance) / 21.0;
        mean * mean * (1.0 - self.mean_loss) / (1.0 - mean * self.mean_loss)
    }

    /// The light of a lamp that a metal of a colour sends to the eye, times π.
    fn metal(&self, color: f64, cosines: Cosines) -> f64 {
        let again = self.loss(cosines.eye) * self.loss(cosines.light) / self.mean_loss;
        microfacets(cosines, self.alpha) * schlick(color, cosines.facing) + self.of_more_bounces(color) * again
    }

    /// The fraction of light that a dielectric transmits.
    fn let_in(&self, cosine: f64) -> f64 {
        1.0 - self.albedo(0.04, cosine) - self.of_more_bounces(0.04) * self.loss(cosine)
    }

    /// The same for a dielectric.
    fn dielectric(&self, color: f64, cosines: Cosines) -> f64 {
        let below = color * self.let_in(cosines.eye) * self.let_in(cosines.light) / self.mean_let_in;
        self.metal(0.04, cosines) + below
    }

    fn surface(&self, metallic: f64, color: f64, cosines: Cosines) -> f64 {
        metallic * self.metal(color, cosines) + (1.0 - metallic) * self.dielectric(color, cosines)
    }
}

/// The mean over the half sphere by the cosine.
fn mean(of: impl Fn(f64) -> f64) -> f64 {
    let steps = 2000;
    let cosines = (0..steps).map(|step| (f64::from(step) + 0.5) / f64::from(steps));
    2.0 * cosines.map(|cosine| cosine * of(cosine)).sum::<f64>() / f64::from(steps)
}

/// The reflection from a direction of the environment: four texels, in double precision.
fn texel_between(tables: &PhysicalTables, direction: DVec3) -> DVec3 {
    let on = direction / (direction.x.abs() + direction.y.abs() + direction.z.abs());
    let (mut x, mut z) = (on.x, on.z);
    if on.y < 0.0 {
        (x, z) = (
            (1.0 - on.z.abs()) * 1f64.copysign(on.x),
            (1.0 - on.x.abs()) * 1f64.copysign(on.z),
        );
    }
    let place = |share: f64| (0.5 * share + 0.5) * EnvironmentMap::EDGE as f64 + 0.5;
    let (column, row) = (place(x), place(z));
    let (left, top) = (column.floor(), row.floor());
    let texel = |right: usize, down: usize| {
        let [red, green, blue, _] =
            tables.texels[(top as usize + down) * PhysicalTables::WIDTH + left as usize + right].map(f64::from);
        DVec3::new(red, green, blue)
    };
    let upper = texel(0, 0).lerp(texel(1, 0), column - left);
    let lower = texel(0, 1).lerp(texel(1, 1), column - left);
    upper.lerp(lower, row - top)
}

/// The polynomial of the light that matt surfaces send back.
fn harmonics(coefficients: &[Vec3; 9], DVec3 { x, y, z }: DVec3) -> DVec3 {
    let basis = [1.0, y, z, x, x * y, y * z, 3.0 * z * z - 1.0, x * z, x * x - y * y];
    let products = coefficients.iter().zip(basis);
    let light: DVec3 = products
        .map(|(coefficient, value)| coefficient.as_dvec3() * value)
        .sum();
    light.max(DVec3::ZERO)
}

/// The colour at the centre of an image, all in view space.
fn expected(packet: &ScenePacket, exact: &Exact, normal: Vec3, color: [u8; 3]) -> [f64; 3] {
    let lights = Lights::of(packet).unwrap();
    let physical = PhysicalLight::of(packet).unwrap();
    let metallic = f64::from(physical.metallic);
    let position = DVec3::new(0.0, 0.0, -DISTANCE);
    let to_eye = DVec3::Z;
    let normal = packet.view.view_from_frame_rotation.as_dmat3() * normal.normalize().as_dvec3();
    let normal = normal * normal.dot(to_eye).signum();
    let mut lamps = vec![(to_eye, DVec3::splat(f64::from(lights.head)))];
    for lamp in lights.lamps.iter().filter(|lamp| lamp.is_on()) {
        let place = lamp.place.truncate().as_dvec3();
        let way = place - position * f64::from(lamp.place.w);
        lamps.push((way.normalize(), lamp.color.as_dvec3()));
    }
    let to_environment = physical.environment_from_view.as_dmat3();
    let facing = normal.dot(to_eye);
    let mirror = to_environment * (2.0 * facing * normal - to_eye);
    let mirrored = texel_between(&physical.tables, mirror) * f64::from(physical.environment_light);
    let matt = harmonics(&physical.harmonics.0, to_environment * normal);
    [0, 1, 2].map(|channel| {
        let color = to_linear(f64::from(color[channel]) / 255.0);
        let of_lamps = lamps.iter().map(|(to_lamp, light)| {
            let cosines = Cosines::of(normal, to_eye, *to_lamp);
            if cosines.light <= 0.0 {
                return 0.0;
            }
            light[channel] * cosines.light * exact.surface(metallic, color, cosines)
        });
        let reflectance = 0.04 + metallic * (color - 0.04);
        let again = metallic * exact.of_more_bounces(color) + (1.0 - metallic) * exact.of_more_bounces(0.04);
        let rest = again * exact.loss(facing) + (1.0 - metallic) * color * exact.let_in(facing);
        let linear =
            of_lamps.sum::<f64>() + exact.albedo(reflectance, facing) * mirrored[channel] + rest * matt[channel];
        255.0 * to_display(linear.min(1.0))
    })
}

#[test]
fn surfaces_match_the_double_precision_formulas() {
    let color = [200, 120, 40];
    // Looking down from the left, so that no axis of the environment coincides with one of the view.
    let camera = Camera {
        azimuth_deg: -40.0,
        elevation_deg: 25.0,
        ..camera_at(DISTANCE)
    };
    for roughness in [0.25f32, 0.5, 1.0] {
        let exact = Exact::new(f64::from(roughness));
        for metallic in [0.0, 0.4, 1.0] {
            let rigs = LightRig::ALL.iter().map(|&rig| (rig, Environment::Studio));
            let none = [LightRig::Head, LightRig::ThreePoint].map(|rig| (rig, Environment::None));
            for (rig, environment) in rigs.chain(none).chain([(LightRig::None, Environment::Sky)]) {
                for normal in NORMALS {
                    let style = style_of((metallic, roughness), rig, environment);
                    let packet = one_surfel(normal, color, &camera, style);
                    let expected = expected(&packet, &exact, normal, color);
                    for (drawn, by) in drawn(&packet) {
                        let is_near = (drawn.iter().zip(expected)).all(|(&a, b)| (f64::from(a) - b).abs() <= 1.0);
                        let what = format!("{metallic} {roughness}, {rig}, {environment}, {normal}, {by}");
                        assert!(is_near, "{what}: {drawn:?}, not {expected:?}");
                    }
                }
            }
        }
    }
}

/// The white furnace: whatever its material, a white surface in white light from all sides is white.
#[test]
fn white_surfaces_in_white_light_from_all_sides_are_white() {
    let camera = camera_at(DISTANCE);
    for roughness in [0.0, 0.1, 0.35, 0.6, 0.8, 1.0] {
        for metallic in [0.0, 0.5, 1.0] {
            for normal in [Vec3::Z, Vec3::new(0.7, 0.0, 0.7), Vec3::new(0.0, 0.97, 0.2)] {
                let style = style_of((metallic, roughness), LightRig::None, Environment::Uniform);
                let packet = one_surfel(normal, [255; 3], &camera, style);
                for (drawn, by) in drawn(&packet) {
                    let min = *drawn.iter().min().unwrap();
                    assert!(min >= 254, "{metallic} {roughness}, {normal}, {by}: {drawn:?}");
                }
            }
        }
    }
}

/// The same for lamps: all directions together are white light from all sides.
#[test]
fn lamp_light_is_conserved() {
    for roughness in [0.3, 0.6, 1.0] {
        let exact = Exact::new(roughness);
        for cosine in [0.1, 0.5, 0.9] {
            let to_eye = DVec3::new((1.0f64 - cosine * cosine).sqrt(), 0.0, cosine);
            let steps = [1200, 480];
            let [mut metal, mut dielectric] = [0.0; 2];
            for i in 0..steps[0] {
                // Equal solid angles over the hemisphere.
                let height = (f64::from(i) + 0.5) / f64::from(steps[0]);
                let aside = (1.0 - height * height).sqrt();
                for j in 0..steps[1] {
                    let azimuth = TAU * (f64::from(j) + 0.5) / f64::from(steps[1]);
                    let to_light = DVec3::new(aside * azimuth.cos(), aside * azimuth.sin(), height);
                    let cosines = Cosines::of(DVec3::Z, to_eye, to_light);
                    metal += height * exact.metal(1.0, cosines);
                    dielectric += height * exact.dielectric(1.0, cosines);
                }
            }
            // Steps of solid angle are 2π / all, with a factor of π omitted.
            let per_step = 2.0 / f64::from(steps[0] * steps[1]);
            for (all, what) in [(metal * per_step, "metal"), (dielectric * per_step, "dielectric")] {
                assert!((all - 1.0).abs() < 4e-3, "{what}, {roughness}, {cosine}: {all}");
            }
        }
    }
}

proptest! {
    /// Eye and lamp are interchangeable.
    #[test]
    fn reflection_is_reciprocal(
        [a, b] in [[-1.0f64..1.0, -1.0..1.0, 0.02..1.0], [-1.0f64..1.0, -1.0..1.0, 0.02..1.0]],
        metallic in 0.0f64..=1.0,
        color in 0.0f64..=1.0,
    ) {
        static ROUGH: std::sync::LazyLock<Exact> = std::sync::LazyLock::new(|| Exact::new(0.7));
        let [a, b] = [a, b].map(|[x, y, z]| DVec3::new(x, y, z).normalize());
        let there = ROUGH.surface(metallic, color, Cosines::of(DVec3::Z, a, b));
        let back = ROUGH.surface(metallic, color, Cosines::of(DVec3::Z, b, a));
        prop_assert!((there - back).abs() <= 1e-9 * there, "{there} {back}");
    }
}

/// Half as bright at the horizon as at the zenith, and black below: all integrals of it are known.
fn gradient_file(folder: &tempfile::TempDir) -> Environment {
    let path = folder.path().join("gradient.hdr");
    let height = 256;
    let pixels = (0..height).flat_map(|row| {
        let latitude = PI * (0.5 - (f64::from(row) + 0.5) / f64::from(height));
        let light = (0.5 + 0.5 * latitude.sin()) as f32;
        std::iter::repeat_n(image::Rgb([light, 0.5 * light, 0.25 * light]), 2 * height as usize)
    });
    let pixels: Vec<_> = pixels.collect();
    let file = std::fs::File::create(&path).unwrap();
    image::codecs::hdr::HdrEncoder::new(file)
        .encode(&pixels, 2 * height as usize, height as usize)
        .unwrap();
    path.to_str().unwrap().parse().unwrap()
}

/// A mirror shows the environment as it is; matt surfaces follow Lambert.
#[test]
fn mirrors_show_the_environment_image_and_matt_surfaces_its_mean() {
    let folder = tempfile::tempdir().unwrap();
    let environment = gradient_file(&folder);
    // A matt surface that faces up receives 0.5 + 0.5 · 2/3, which is to be white.
    let exposure = 1.0 / (0.5 + 1.0 / 3.0);
    let camera = camera_at(DISTANCE);
    for normal in NORMALS {
        let facing = normal.normalize().as_dvec3() * f64::from(normal.z.signum());
        let mirrored = 2.0 * facing.z * facing - DVec3::Z;
        let mirror = style_of((1.0, 0.0), LightRig::None, environment);
        let light = exposure * (0.5 + 0.5 * mirrored.y);
        for (drawn, by) in drawn(&one_surfel(normal, [255; 3], &camera, mirror)) {
            for (drawn, share) in drawn.into_iter().zip([1.0, 0.5, 0.25]) {
                let expected = 255.0 * to_display((share * light).min(1.0));
                assert!(
                    (f64::from(drawn) - expected).abs() <= 1.5,
                    "{normal}, {by}: {drawn}, not {expected}"
                );
            }
        }
        let lambert = exposure * (0.5 + facing.y / 3.0);
        let packet = one_surfel(
            normal,
            [255; 3],
            &camera,
            style_of((0.0, 1.0), LightRig::None, environment),
        );
        let physical = PhysicalLight::of(&packet).unwrap();
        let view = packet.view.view_from_frame_rotation.as_dmat3();
        let in_environment = physical.environment_from_view.as_dmat3() * view * facing;
        let matt = harmonics(&physical.harmonics.0, in_environment);
        assert!((matt.x - lambert).abs() < 2e-3, "{normal}: {matt}, not {lambert}");
    }
}

/// Harmonics and the split sum are approximations. Compared with the integrals that they approximate, the light of
/// environments with sharp lamps is off by this fraction of white at most, and by this in the mean.
#[test]
fn environment_lighting_is_close_to_its_integral() {
    const MAX: f64 = 0.30;
    const MEAN: f64 = 0.045;
    let camera = camera_at(DISTANCE);
    let tables_of = |environment, roughness| {
        let style = style_of((1.0, roughness), LightRig::None, environment);
        PhysicalLight::of(&one_surfel(Vec3::Z, [255; 3], &camera, style)).unwrap()
    };
    let (mut sum, mut count, mut max) = (0.0, 0, 0f64);
    for environment in [Environment::Studio, Environment::Sky] {
        let sharp = tables_of(environment, 0.0);
        for roughness in [0.2f32, 0.4, 0.7, 1.0] {
            let physical = tables_of(environment, roughness);
            let exact = Exact::new(f64::from(roughness));
            for normal in [
                DVec3::Y,
                DVec3::Z,
                DVec3::new(-0.5, 0.6, 0.5),
                DVec3::new(0.6, -0.3, 0.6),
            ] {
                let normal = normal.normalize();
                let (right, up) = normal.any_orthonormal_pair();
                for slope in [0.0, 0.5, 1.2, 2.5] {
                    let to_eye = (normal + slope * right).normalize();
                    let cosine = normal.dot(to_eye);
                    let mut integral = DVec3::ZERO;
                    let steps = [300, 240];
                    for i in 0..steps[0] {
                        let share = (f64::from(i) + 0.5) / f64::from(steps[0]);
                        let alpha2 = exact.alpha * exact.alpha;
                        let height2 = (1.0 - share) / (1.0 + (alpha2 - 1.0) * share);
                        for j in 0..steps[1] {
                            let azimuth = TAU * (f64::from(j) + 0.5) / f64::from(steps[1]);
                            let aside = (1.0 - height2).sqrt();
                            let half = normal * height2.sqrt() + aside * (right * azimuth.cos() + up * azimuth.sin());
                            let to_light = half * (2.0 * half.dot(to_eye)) - to_eye;
                            let cosines = Cosines::of(normal, to_eye, to_light);
                            if half.dot(to_eye) <= 0.0 || cosines.light <= 0.0 {
                                continue;
                            }
                            let density = alpha2 / (height2 * (alpha2 - 1.0) + 1.0).powi(2) * half.dot(normal)
                                / (4.0 * cosines.facing);
                            let weight = microfacets(cosines, exact.alpha) * cosines.light / density;
                            integral += texel_between(&sharp.tables, to_light) * weight;
                        }
                    }
                    integral /= f64::from(steps[0] * steps[1]);
                    let mirror = 2.0 * cosine * normal - to_eye;
                    let split = texel_between(&physical.tables, mirror) * exact.albedo(1.0, cosine);
                    for (exact, split) in integral.to_array().into_iter().zip(split.to_array()) {
                        let off = (exact.min(1.0) - split.min(1.0)).abs();
                        max = max.max(off);
                        sum += off;
                        count += 1;
                    }
                }
            }
        }
        for normal in [DVec3::Y, DVec3::NEG_Y, DVec3::X, DVec3::NEG_X, DVec3::Z, DVec3::NEG_Z] {
            let (right, up) = normal.any_orthonormal_pair();
            let steps = [400, 400];
            let mut lambert = DVec3::ZERO;
            for i in 0..steps[0] {
                let cosine2 = (f64::from(i) + 0.5) / f64::from(steps[0]);
                for j in 0..steps[1] {
                    let azimuth = TAU * (f64::from(j) + 0.5) / f64::from(steps[1]);
                    let aside = (1.0 - cosine2).sqrt() * (right * azimuth.cos() + up * azimuth.sin());
                    lambert += texel_between(&sharp.tables, normal * cosine2.sqrt() + aside);
                }
            }
            lambert /= f64::from(steps[0] * steps[1]);
            let off = (harmonics(&sharp.harmonics.0, normal) - lambert).abs().max_element();
            assert!(off < 0.02, "{environment}, {normal}: {off}");
        }
    }
    let mean = sum / f64::from(count);
    assert!(mean < MEAN && max < MAX, "{mean}, {max}");
}

/// An environment stays where it is when the camera orbits the scene, and up is up whatever axis that is.
#[test]
fn environments_turn_with_the_scene() {
    let style = style_of((1.0, 0.0), LightRig::None, Environment::Sky);
    // Horizontal mirrors reflect the zenith when seen from above, whichever axis is up.
    let zeniths: Vec<[u8; 3]> = [pointreel::scene::UpAxis::Y, pointreel::scene::UpAxis::Z]
        .into_iter()
        .map(|up| {
            let camera = Camera {
                up,
                elevation_deg: 89.0,
                ..camera_at(DISTANCE)
            };
            drawn(&one_surfel(up.direction().as_vec3(), [255; 3], &camera, style))[0].0
        })
        .collect();
    assert_eq!(zeniths[0], zeniths[1]);
    assert!(zeniths[0][2] > zeniths[0][0].saturating_add(60), "{zeniths:?}");
    // The same mirror reflects another side of the sky to an eye elsewhere, and both renderers agree.
    let shown = [0.0, 180.0].map(|azimuth_deg| {
        let camera = Camera {
            azimuth_deg,
            elevation_deg: 30.0,
            ..camera_at(DISTANCE)
        };
        let [(on_cpu, _), (on_gpu, _)] = drawn(&one_surfel(Vec3::Y, [255; 3], &camera, style));
        assert!(
            on_cpu.iter().zip(on_gpu).all(|(a, b)| a.abs_diff(b) <= 1),
            "{on_cpu:?} {on_gpu:?}"
        );
        on_cpu
    });
    assert_ne!(shown[0], shown[1]);
}

/// Nearby surfaces occlude the environment, and the key light casts shadows, as in other deferred light.
#[test]
fn occlusion_and_shadows_dim_physical_light() {
    let style = style_of((0.0, 0.6), LightRig::ThreePoint, Environment::Studio);
    // A small disk above a large one, in the direction of the key light.
    let disk = |position, radius| Surfel {
        position,
        normal: Vec3::Z,
        radius,
        color: [255; 3],
    };
    let mut cloud = vec![disk(Vec3::ZERO, 1.0)];
    cloud.push(disk(Vec3::new(-0.3, 0.36, 0.39), 0.2));
    let mut packet = surfels(&cloud, &camera_at(DISTANCE), style, [EDGE_PX; 2]);
    packet.bounds = Aabb::from_points(&[Vec3::splat(-0.577), Vec3::splat(0.577)]);
    let of = |change: fn(&mut DrawSettings)| {
        let mut packet = packet.clone();
        change(&mut packet.style);
        drawn(&packet)
    };
    let plain = of(|_| {});
    let shadowed = of(|style| style.light.shadows = OnOff::On);
    let occluded = of(|style| {
        style.light.ao = OnOff::On;
        style.light.ao_radius = 4.0;
    });
    for (place, (plain, by)) in plain.into_iter().enumerate() {
        assert!(
            shadowed[place].0[0] + 20 < plain[0],
            "{by}: {:?} {plain:?}",
            shadowed[place]
        );
        assert!(
            occluded[place].0[0] <= plain[0],
            "{by}: {:?} {plain:?}",
            occluded[place]
        );
    }
}
