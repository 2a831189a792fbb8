//! Styles and their descriptions.

use super::describe::{Described, Setting as _, Value, Values};
use super::*;
use crate::analysis::ColorMap;
use crate::levels::Lod;
use crate::levels::octree::StopCriterion;
use crate::scene::environment::Environment;
use crate::sequence::ColorSource;
use std::collections::BTreeSet;

#[test]
fn every_choice_round_trips_through_its_name() {
    for &mode in Splatting::ALL {
        assert_eq!(mode.name().parse(), Ok(mode));
    }
    for &strategy in Strategy::ALL {
        assert_eq!(strategy.name().parse(), Ok(strategy));
    }
    let error = "cone".parse::<Choice<Primitive>>().unwrap_err();
    assert_eq!(
        error.to_string(),
        "unknown primitive `cone`: expected auto, surfel, ellipse, sprite, mesh, voxel, point"
    );
}

#[test]
fn render_modes_override_eye_dome_lighting_where_they_set_it() {
    let settings = |eye_dome, eye_dome_strength| {
        Settings::default().with(|style| {
            style.light.eye_dome = eye_dome;
            style.light.eye_dome_strength = eye_dome_strength;
        })
    };
    let (on, auto) = (settings(EyeDome::On.into(), 2.0), settings(Choice::Auto, 0.5));
    assert_eq!(on.drawn_as(&auto), on);
    assert_eq!(auto.drawn_as(&on), on);
    let grid = on.with(|style| style.backdrop.grid = true);
    assert!(grid.drawn_as(&auto).backdrop.grid);
}

#[test]
fn images_are_drawn_in_whole_pixels() {
    let settings = |resolution| Style::default().with(|style| style.drawing.resolution = resolution);
    assert_eq!(settings(1.0).drawn_px([1921, 1080]), [1921, 1080]);
    assert_eq!(settings(0.5).drawn_px([1921, 1080]), [961, 540]);
    assert_eq!(settings(0.25).drawn_px([1, 0]), [1, 1]);
}

#[test]
fn every_setting_is_described_once() {
    let style = Settings::default();
    let settings = style.settings();
    let in_files: BTreeSet<String> = match serde_json::to_value(style).unwrap() {
        serde_json::Value::Object(fields) => fields.into_iter().map(|(name, _)| name).collect(),
        other => panic!("{other}"),
    };
    let described: BTreeSet<String> = settings.iter().map(|(described, _)| described.key.to_owned()).collect();
    assert_eq!(described, in_files);
    assert_eq!(described.len(), settings.len());
    let mut flags = BTreeSet::new();
    for (described, value) in &settings {
        let Described { key, title, hint, .. } = described;
        assert!(!title.is_empty() && !hint.is_empty(), "{key}");
        match (&described.values, value) {
            (Values::Words(words), Value::Word(place)) => assert!(*place < words.list.len()),
            (Values::Kinds(kinds), Value::Kind(place, _)) => {
                assert!(*place < kinds.len());
                assert!(kinds.iter().all(|kind| flags.insert(kind.flag)), "{key}");
                continue;
            }
            (Values::Number(_), Value::Number(_))
            | (Values::Switch(_), Value::Switch(_))
            | (Values::Colors, Value::Colors(_))
            | (Values::Environment, Value::Environment(_)) => {}
            // Its option accepts values that no style has.
            (Values::Background, Value::Background(_)) => continue,
            (values, value) => panic!("{key}: {values:?} has no {value:?}"),
        }
        assert!(flags.insert(described.flag), "{key}");
    }
}

#[test]
fn an_edit_only_changes_the_setting_it_names() {
    let style = Settings::default();
    for (changed, value) in style.settings() {
        let other = match value {
            Value::Word(place) => Value::Word(if place == 0 { 1 } else { place - 1 }),
            Value::Number(number) => Value::Number(if number == 0.0 { 0.5 } else { 0.5 * number }),
            Value::Switch(is_on) => Value::Switch(!is_on),
            Value::Kind(..) => Value::Kind(1, 3.0),
            Value::Background(_) => Value::Background(Background::solid([1, 2, 3])),
            Value::Colors(_) => Value::Colors(Coloring::of(ColorSource::Normal)),
            Value::Environment(_) => Value::Environment(Environment::Sky),
        };
        let mut edited = style;
        edited.edit(&mut |described, value| {
            if described.key == changed.key { other } else { value }
        });
        let differing: Vec<_> = style
            .settings()
            .into_iter()
            .zip(edited.settings())
            .filter(|((_, before), (_, after))| before != after)
            .map(|(_, (described, value))| (described.key, value))
            .collect();
        assert_eq!(differing, [(changed.key, other)]);
        // And files distinguish it.
        let stored = serde_json::to_value(edited).unwrap();
        let usual = serde_json::to_value(style).unwrap();
        assert_ne!(stored[changed.key], usual[changed.key]);
        assert_eq!(serde_json::from_value::<Settings>(stored).unwrap(), edited);
    }
}

#[test]
fn values_not_offered_become_the_nearest_offered() {
    assert_eq!(Settings::default().nearest(), Settings::default());
    let nearest = |lod, stop| {
        let mut style = Settings::default();
        style.levels.lod = lod;
        style.levels.stop = stop;
        let levels = style.nearest().levels;
        (levels.lod, levels.stop)
    };
    for (lod, stop, expected) in [
        (
            Lod::ThresholdPx(-1.0),
            StopCriterion::Loss(0.7),
            (Lod::ThresholdPx(0.0), StopCriterion::Loss(0.6)),
        ),
        (
            Lod::ThresholdPx(f32::NAN),
            StopCriterion::Loss(f32::NAN),
            (Lod::default(), StopCriterion::PAPER),
        ),
        (
            Lod::Level(40),
            StopCriterion::Depth(22),
            (Lod::Level(21), StopCriterion::Depth(21)),
        ),
        (
            Lod::Budget(16_777_217),
            StopCriterion::PointsPerOctant(0),
            (Lod::Budget(16_777_217), StopCriterion::PointsPerOctant(1)),
        ),
        (
            Lod::FrameTimeMs(f32::INFINITY),
            StopCriterion::PointsPerOctant(u32::MAX),
            (Lod::FrameTimeMs(1000.0), StopCriterion::PointsPerOctant(u32::MAX)),
        ),
    ] {
        assert_eq!(nearest(lod, stop), expected);
    }
}

#[test]
fn color_sources_and_maps_have_their_words() {
    let names = ColorSource::ALL.map(ColorSource::name);
    assert!(coloring::SOURCES.list.iter().map(|source| source.word).eq(names));
    let names = ColorMap::ALL.map(ColorMap::name);
    assert!(coloring::MAPS.list.iter().map(|map| map.word).eq(names));
}

#[test]
fn choices_round_trip_through_name_and_value_and_may_be_automatic() {
    fn check<T: Automatic + std::fmt::Debug>(other: T) {
        let (open, all) = (Choice::<T>::Auto, Choice::<T>::all().collect::<Vec<_>>());
        assert_eq!(all[0], open);
        assert_eq!(all.len(), Choice::<T>::WORDS.list.len());
        assert!(open.is_open() && open.chosen().is_none() && open != other);
        assert_eq!((open.name(), Choice::default()), ("auto", open));
        assert_eq!((open.or(other), open.decided()), (other, T::USUAL));
        for choice in all {
            assert_eq!(choice.name().parse::<Choice<T>>().ok(), Some(choice));
            assert_eq!(Choice::from_value(choice.value()), Some(choice));
            assert_eq!(serde_json::to_value(choice).unwrap(), choice.name());
            assert_eq!(
                serde_json::from_value::<Choice<T>>(choice.name().into()).unwrap(),
                choice
            );
            let Some(made) = choice.chosen() else { continue };
            assert!(choice == made && choice == Choice::from(made) && choice != open);
            assert_eq!((choice.or(other), choice.decided()), (made, made));
        }
        assert_eq!(
            Choice::<T>::from_value(Value::Word(Choice::<T>::WORDS.list.len())),
            None
        );
        assert_eq!(Choice::<T>::from_value(Value::Switch(true)), None);
    }
    check(Primitive::Voxel);
    check(Lighting::Physical);
    check(LightRig::ThreePoint);
    check(EyeDome::On);
    check(BackFaces::Culled);
    check(RendererChoice::Cpu);
    assert_ne!(Primitive::USUAL, Primitive::Voxel, "else nothing is shown by it");
}

#[test]
fn an_environment_replaces_an_automatic_light_rig() {
    let environment = Environment::Studio;
    let rig = |lighting: Lighting, environment, rig| {
        let settings = Settings::default().with(|settings| {
            settings.light.lighting = lighting.into();
            settings.light.environment = environment;
            settings.light.rig = rig;
        });
        settings.decided().light.rig
    };
    let usual = LightRig::USUAL;
    assert_ne!(usual, LightRig::None);
    assert_eq!(rig(Lighting::Physical, environment, Choice::Auto), LightRig::None);
    assert_eq!(rig(Lighting::Physical, environment, usual.into()), usual);
    assert_eq!(rig(Lighting::Physical, Environment::None, Choice::Auto), usual);
    assert_eq!(rig(Lighting::Lambert, environment, Choice::Auto), usual);
}
