//! Deferred shading against light computed in double precision, by both renderers; and parts that it does not light.

use crate::common::{Surfel, camera_at, draw, draw_on_cpu, plain, sphere, surfels, to_display, to_linear};
use glam::{DVec3, Vec3};
use image::RgbaImage;
use pointreel::math::Aabb;
use pointreel::scene::{BackFaces, LightRig, Lighting, Lights, Primitive, ScenePacket, Splatting, Style};

/// Odd, so that the centre of a pixel is on the axis of the view.
const EDGE_PX: u32 = 121;

const DISTANCE: f64 = 3.0;

const DEFERRED: [Lighting; 2] = [Lighting::Lambert, Lighting::BlinnPhong];

fn lit_by(lighting: Lighting, rig: LightRig) -> Style {
    plain().with(|style| {
        style.light.lighting = lighting;
        style.light.rig = rig;
        style.surfels.back_faces = BackFaces::Drawn;
    })
}

fn draw_on_both(packet: &ScenePacket) -> [(RgbaImage, &'static str); 2] {
    [(draw_on_cpu(packet), "processor"), (draw(packet), "GPU")]
}

/// One surfel at the centre of a cloud of radius 1.
fn one_surfel(normal: Vec3, color: [u8; 3], style: Style) -> ScenePacket {
    let surfel = Surfel {
        position: Vec3::ZERO,
        normal,
        radius: 0.5,
        color,
    };
    let mut packet = surfels(&[surfel], &camera_at(DISTANCE), style, [EDGE_PX; 2]);
    packet.bounds = Aabb::from_points(&[Vec3::splat(-0.577), Vec3::splat(0.577)]);
    packet
}

fn center(picture: &RgbaImage) -> [u8; 3] {
    let [red, green, blue, _] = picture.get_pixel(EDGE_PX / 2, EDGE_PX / 2).0;
    [red, green, blue]
}

/// The colour of a position under lights, all in view space: Lambert and Blinn 1977, added in linear light.
fn expected(lights: &Lights, position: DVec3, normal: DVec3, color: [u8; 3]) -> [f64; 3] {
    let to_eye = -position.normalize();
    let normal = normal.normalize() * normal.dot(to_eye).signum();
    let mut diffuse = DVec3::splat(f64::from(lights.ambient));
    let mut specular = DVec3::ZERO;
    let mut add = |to_light: DVec3, light: DVec3| {
        let facing = normal.dot(to_light);
        if facing > 0.0 {
            let along = normal.dot((to_light + to_eye).normalize());
            let highlight = along.max(0.0).powi(Lights::SHININESS as i32);
            diffuse += light * facing;
            specular += light * f64::from(lights.specular) * highlight;
        }
    };
    add(to_eye, DVec3::splat(f64::from(lights.head)));
    for lamp in lights.lamps.iter().filter(|lamp| lamp.is_on()) {
        let place = lamp.place.truncate().as_dvec3();
        add(
            (place - position * f64::from(lamp.place.w)).normalize(),
            lamp.color.as_dvec3(),
        );
    }
    [0, 1, 2].map(|channel| {
        let linear = to_linear(f64::from(color[channel]) / 255.0) * diffuse[channel] + specular[channel];
        255.0 * to_display(linear.min(1.0))
    })
}

#[test]
fn light_of_every_rig_adds_up_as_linear_light() {
    let color = [200, 120, 40];
    let normals = [Vec3::Z, -Vec3::Z, Vec3::new(0.5, 0.3, 0.8), Vec3::new(-0.6, 0.2, 0.4)];
    for lighting in DEFERRED {
        for &rig in LightRig::ALL {
            for normal in normals {
                let packet = one_surfel(normal.normalize(), color, lit_by(lighting, rig));
                let lights = Lights::of(&packet).unwrap();
                let expected = expected(&lights, DVec3::new(0.0, 0.0, -DISTANCE), normal.as_dvec3(), color);
                for (picture, by) in draw_on_both(&packet) {
                    let drawn = center(&picture);
                    let is_near = drawn
                        .iter()
                        .zip(expected)
                        .all(|(&drawn, expected)| (f64::from(drawn) - expected).abs() <= 1.0);
                    assert!(
                        is_near,
                        "{lighting}, {rig}, {normal}, {by}: {drawn:?}, not {expected:?}"
                    );
                }
            }
        }
    }
}

#[test]
fn without_light_colors_match_the_file() {
    for level in (0..=255).step_by(17) {
        let color = [level, 255 - level, level / 2 + 60];
        let packet = one_surfel(Vec3::new(0.4, 0.2, 0.7).normalize(), color, plain());
        for (picture, by) in draw_on_both(&packet) {
            assert_eq!(center(&picture), color, "{by}");
        }
    }
}

#[test]
fn surfaces_facing_a_matt_headlight_have_the_file_color() {
    for level in (0..=255).step_by(17) {
        let color = [level, 255 - level, level / 2 + 60];
        let packet = one_surfel(Vec3::Z, color, lit_by(Lighting::Lambert, LightRig::Head));
        for (picture, by) in draw_on_both(&packet) {
            let drawn = center(&picture);
            let max = drawn.iter().zip(color).map(|(a, b)| a.abs_diff(b)).max().unwrap();
            assert!(max <= 1, "{by}: {drawn:?}, not {color:?}");
        }
    }
}

/// For a unit sphere at the centre: where the ray through a pixel meets it, in view space.
fn on_sphere(x: u32, y: u32, focal: [f32; 2]) -> Option<DVec3> {
    let ndc = |px: u32| (2.0 * f64::from(px) + 1.0) / f64::from(EDGE_PX) - 1.0;
    let [right, up] = focal.map(f64::from);
    let ray = DVec3::new(ndc(x) / right, -ndc(y) / up, -1.0).normalize();
    let center = DVec3::new(0.0, 0.0, -DISTANCE);
    let along = ray.dot(center);
    let inside = along * along - center.length_squared() + 1.0;
    (inside >= 0.0).then(|| ray * (along - inside.sqrt()))
}

/// A sphere of few surfels is round, as the normals in a pixel are blended before light falls on them.
#[test]
fn blended_normals_are_closer_to_the_surface_than_splat_normals() {
    let color = [200; 3];
    let mut cloud = sphere(400, 1.0);
    for surfel in &mut cloud {
        surfel.color = color;
    }
    let style = lit_by(Lighting::Lambert, LightRig::Colored);
    let packet = surfels(&cloud, &camera_at(DISTANCE), style, [EDGE_PX; 2]);
    let lights = Lights::of(&packet).unwrap();
    let center = DVec3::new(0.0, 0.0, -DISTANCE);
    for (picture, by) in draw_on_both(&packet) {
        let [mut of_blended, mut of_splats] = [0.0; 2];
        for (x, y, pixel) in picture.enumerate_pixels() {
            let Some(position) = on_sphere(x, y, packet.view.focal) else {
                continue;
            };
            let normal = position - center;
            // Towards the silhouette, the blended splats lack those behind it.
            if normal.dot(-position.normalize()) < 0.7 {
                continue;
            }
            let distance = |surfel: &&Surfel| surfel.position.as_dvec3().distance_squared(normal);
            let nearest = cloud.iter().min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap();
            let grey = |normal| expected(&lights, position, normal, color)[0];
            of_blended += (f64::from(pixel.0[0]) - grey(normal)).abs();
            of_splats += (grey(nearest.normal.as_dvec3()) - grey(normal)).abs();
        }
        assert!(of_blended < 0.25 * of_splats, "{by}: {of_blended} and {of_splats}");
    }
}

#[test]
fn points_and_depths_are_not_lit() {
    let as_points = |style: &mut Style| style.primitive = Primitive::Point;
    let as_depths = |style: &mut Style| style.surfels.splatting = Splatting::Visibility;
    let cloud = sphere(700, 1.0);
    for edit in [as_points as fn(&mut Style), as_depths] {
        let picture_of = |style: Style| {
            let packet = surfels(&cloud, &camera_at(DISTANCE), style.with(edit), [EDGE_PX; 2]);
            draw_on_both(&packet)
        };
        let unlit = picture_of(lit_by(Lighting::Unlit, LightRig::Head));
        for lighting in DEFERRED {
            assert!(picture_of(lit_by(lighting, LightRig::Colored)) == unlit, "{lighting}");
        }
    }
}
