//! Materials and textures on the faces of constructed models.

use crate::cloud::RawCloud;
use crate::io::{Part, ReadOptions, read_part};
use image::{Rgba, RgbaImage};
use std::fs;
use std::num::NonZeroUsize;
use tempfile::TempDir;

/// A square from (0, 0) to (1, 1) with a whole image on it, a vertex that no face names, and a triangle far away that
/// shares a corner with the square and has another material.
const MODEL: &str = "mtllib colors.mtl\n\
    v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 9 9 9\nv 5 0 0\nv 5 5 0\n\
    vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n\
    usemtl skin\nf 1/1 2/2 3/3 4/4\n\
    usemtl iron\nf 2 6 7\n\
    usemtl unknown\nf 5 6 7\n";

const LIBRARY: &str = "newmtl skin\nKd 0 0 0\nmap_Kd -s 1 1 1 pictures\\skin of it.png\nnewmtl iron\nKd 0.2 0.4 0.6\n";

const RED: [u8; 4] = [255, 0, 0, 255];
const GREEN: [u8; 4] = [0, 255, 0, 255];
const BLUE: [u8; 4] = [0, 0, 255, 255];
const GREY: [u8; 4] = [128, 128, 128, 255];
const IRON: [u8; 4] = [51, 102, 153, 255];

/// A folder with the model, and with its library and its image unless these are to be missing. The upper row of the
/// image is red and green, the lower one blue and grey, each 8 pixels wide.
fn folder(library: Option<&str>, has_picture: bool) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("model.obj"), MODEL).unwrap();
    if let Some(library) = library {
        fs::write(folder.path().join("colors.mtl"), library).unwrap();
    }
    if has_picture {
        let picture = RgbaImage::from_fn(16, 16, |x, y| {
            Rgba([[RED, GREEN], [BLUE, GREY]][(y / 8) as usize][(x / 8) as usize])
        });
        fs::create_dir(folder.path().join("pictures")).unwrap();
        picture.save(folder.path().join("pictures/skin of it.png")).unwrap();
    }
    folder
}

fn read(folder: &TempDir, options: &ReadOptions) -> RawCloud {
    read_part(&folder.path().join("model.obj"), &Part::Whole, options).unwrap()
}

#[test]
fn a_mesh_has_its_textures_and_material_colors() {
    let cloud = read(&folder(Some(LIBRARY), true), &ReadOptions::default().of_meshes());
    assert_eq!(cloud.warnings, Vec::<String>::new());
    assert_eq!(cloud.faces.len(), 4);
    let (colors, texturing) = (
        cloud.attributes.colors.as_ref().unwrap(),
        cloud.texturing.as_ref().unwrap(),
    );
    for (index, face) in cloud.faces.iter().enumerate() {
        for &corner in face {
            let corner = corner as usize;
            let [x, y, _] = cloud.positions.get(corner).to_array();
            match index {
                0 | 1 => {
                    assert_eq!(
                        (texturing.texture_of_vertex[corner], colors[corner]),
                        (Some(0), [255; 4])
                    );
                    assert_eq!(texturing.places[corner], [x as f32, 1.0 - y as f32]);
                }
                2 => assert_eq!((texturing.texture_of_vertex[corner], colors[corner]), (None, IRON)),
                _ => assert_eq!((texturing.texture_of_vertex[corner], colors[corner]), (None, [255; 4])),
            }
        }
    }
    // Corner 2 has two materials, corners 6 and 7 have two others.
    assert_eq!(cloud.positions.len(), 7 + 3);
}

#[test]
fn points_on_faces_have_the_texture_color() {
    let options = ReadOptions::default().with_sample_count(NonZeroUsize::new(40_000));
    let cloud = read(&folder(Some(LIBRARY), true), &options);
    assert!(cloud.texturing.is_none());
    let colors = cloud.attributes.colors.unwrap();
    let mut on_the_square = 0;
    for (index, color) in colors.into_iter().enumerate() {
        let [x, y, z] = cloud.positions.get(index).to_array();
        // Between two texels their colours are interpolated.
        let is_between =
            (x - 0.5).abs() < 0.05 || (y - 0.5).abs() < 0.05 || [x, y].iter().any(|c| !(0.05..0.95).contains(c));
        if x < 1.0 && y <= 1.0 && z == 0.0 && !is_between {
            on_the_square += 1;
            let expected = [[BLUE, GREY], [RED, GREEN]][usize::from(y > 0.5)][usize::from(x > 0.5)];
            assert_eq!(color, expected, "at {x}, {y}");
        }
    }
    assert!(on_the_square > 100, "{on_the_square}");
}

#[test]
fn vertices_have_the_colors_of_their_first_faces() {
    let cloud = read(&folder(Some(LIBRARY), true), &ReadOptions::default());
    assert_eq!(
        (cloud.positions.len(), cloud.faces.len(), cloud.texturing.is_some()),
        (7, 4, false)
    );
    // Corners of the texture lie between texels of all four sides, as it repeats.
    assert_eq!(cloud.attributes.colors.unwrap()[4..], [[255; 4], IRON, IRON]);
}

#[test]
fn missing_files_are_reported_and_the_shape_is_read() {
    let without_library = read(&folder(None, true), &ReadOptions::default().of_meshes());
    assert_eq!((without_library.positions.len(), without_library.faces.len()), (7, 4));
    assert!(without_library.attributes.colors.is_none() && without_library.texturing.is_none());
    assert!(without_library.warnings[0].contains("its materials are skipped: `colors.mtl` cannot be read"));

    let without_picture = read(&folder(Some(LIBRARY), false), &ReadOptions::default().of_meshes());
    assert!(without_picture.texturing.is_none());
    assert_eq!(without_picture.warnings.len(), 1);
    assert!(without_picture.warnings[0].contains("a texture is skipped: `pictures/skin of it.png` cannot be read"));

    let damaged = read(
        &folder(Some("newmtl skin\nKd red\n"), true),
        &ReadOptions::default().of_meshes(),
    );
    assert!(damaged.warnings[0].contains("its materials are skipped: `colors.mtl`"));
}

#[test]
fn only_files_next_to_the_model_are_read() {
    let outside = tempfile::tempdir().unwrap();
    let secret = outside.path().join("secret.png");
    RgbaImage::new(1, 1).save(&secret).unwrap();
    let library = format!("newmtl skin\nmap_Kd {}\n", secret.display());
    let cloud = read(&folder(Some(&library), true), &ReadOptions::default().of_meshes());
    assert!(cloud.texturing.is_none());
    assert!(
        cloud.warnings[0].contains("only files in the folder"),
        "{}",
        cloud.warnings[0]
    );

    // An absolute path from the machine where the model was made, with the texture next to the model.
    let folder = folder(Some("newmtl skin\nmap_Kd C:\\work\\skin.png\n"), false);
    RgbaImage::from_pixel(1, 1, Rgba(RED))
        .save(folder.path().join("skin.png"))
        .unwrap();
    let cloud = read(&folder, &ReadOptions::default().of_meshes());
    assert_eq!(
        (cloud.warnings.len(), cloud.texturing.unwrap().textures.texels()),
        (0, &[RED][..])
    );
}
