//! Text tables, bare binary columns and their kin as other programs write them: right values, or a refusal that names
//! the remedy. Inputs of `shared/data/meaning`, and neighbours that are written here.

use super::data::shared;
use pointreel::assumption::{Evidence, Subject};
use pointreel::cloud::{LengthUnit, RawCloud};
use pointreel::io::{self, ColumnMap, IoError, Part, ReadOptions};
use std::fmt::Write as _;
use std::path::Path;
use std::time::Duration;

fn read(name: &str, text: &str) -> RawCloud {
    try_read(name, text.as_bytes()).unwrap_or_else(|error| panic!("{error}"))
}

fn try_read(name: &str, bytes: &[u8]) -> Result<RawCloud, IoError> {
    io::read_bytes(Path::new(name), bytes)
}

fn points(cloud: &RawCloud) -> Vec<[f64; 3]> {
    (0..cloud.positions.len())
        .map(|index| cloud.positions.get(index).to_array())
        .collect()
}

fn with_columns(path: &Path, columns: &str) -> Result<RawCloud, IoError> {
    let options = ReadOptions::default().with_columns(Some(columns.parse().unwrap()));
    io::read_part(path, &Part::Whole, &options)
}

fn names(cloud: &RawCloud) -> Vec<&str> {
    cloud
        .attributes
        .scalars
        .iter()
        .map(|field| field.name.as_str())
        .collect()
}

fn scalar<'a>(cloud: &'a RawCloud, name: &str) -> &'a [f32] {
    let field = cloud.attributes.scalars.iter().find(|field| field.name == name);
    &field
        .unwrap_or_else(|| panic!("no {name} in {:?}", names(cloud)))
        .values
}

fn assumed(cloud: &RawCloud, subject: Subject) -> Option<(&str, Evidence)> {
    let found = cloud
        .assumptions
        .iter()
        .find(|assumption| assumption.subject == subject);
    found.map(|assumption| (assumption.value.as_str(), assumption.evidence))
}

/// The first point of the synthetic scans of `meaning`.
const FIRST: [f64; 3] = [-1.1186, -0.0832, -0.2184];

#[track_caller]
fn assert_first(cloud: &RawCloud, count: usize) {
    assert_eq!(cloud.positions.len(), count);
    let first = points(cloud)[0];
    let is_near = first
        .iter()
        .zip(FIRST)
        .all(|(found, expected)| (found - expected).abs() < 1e-4);
    assert!(is_near, "{first:?}");
}

#[test]
fn names_decide_not_positions() {
    for (file, colored, guessed) in [
        ("T10_veloview.csv", false, None),
        ("T10a_points_first.csv", false, None),
        ("T15a_pandas_index_only_xyz.csv", false, None),
        ("T15m_pos_x.csv", false, None),
        ("T01d_rf_gf_bf.txt", true, None),
        // Its clock restarts every 60 points: these are neither frames nor tracks, which only the values show.
        ("T15g_text_column_first.csv", false, Some((Subject::Frames, "one"))),
        ("T15e_text_column_last.csv", false, None),
        ("T15i_empty_cells.csv", false, None),
    ] {
        let Some(path) = shared(&format!("meaning/{file}")) else {
            return;
        };
        let cloud = io::read(&path).unwrap_or_else(|error| panic!("{error}"));
        assert_first(&cloud, 6000);
        assert_eq!(cloud.attributes.colors.is_some(), colored, "{file}");
        assert_eq!(cloud.attributes.normals, None, "{file}");
        assert!(cloud.warnings.is_empty(), "{file}: {:?}", cloud.warnings);
        let guesses: Vec<(Subject, &str)> = cloud
            .assumptions
            .iter()
            .filter(|assumption| assumption.evidence.is_guess())
            .map(|assumption| (assumption.subject, assumption.value.as_str()))
            .collect();
        assert_eq!(guesses.first().copied(), guessed, "{file}: {:?}", cloud.assumptions);
        assert_eq!(guesses.len(), usize::from(guessed.is_some()), "{file}: {guesses:?}");
    }
}

#[test]
fn values_of_other_columns_are_retained() {
    let Some(path) = shared("meaning/T01d_rf_gf_bf.txt") else {
        return;
    };
    let cloud = io::read(&path).unwrap();
    assert_eq!(cloud.attributes.colors.unwrap()[0], [55, 240, 255, 255]);
    let cloud = io::read(&path.with_file_name("T10_veloview.csv")).unwrap();
    assert_eq!(cloud.unit, Some(LengthUnit::Metre));
    assert_eq!(scalar(&cloud, "laser_id")[..3], [0.0, 1.0, 2.0]);
    assert_eq!(scalar(&cloud, "vertical_angle")[..2], [-15.0, -14.0]);
    let cloud = io::read(&path.with_file_name("T15i_empty_cells.csv")).unwrap();
    let intensity = scalar(&cloud, "intensity");
    assert!(intensity[0] == 0.0 && intensity[1].is_nan());
    let cloud = io::read(&path.with_file_name("T15e_text_column_last.csv")).unwrap();
    assert!(
        cloud
            .assumptions
            .iter()
            .any(|assumption| assumption.value.contains("0 = car")),
        "{:?}",
        cloud.assumptions
    );
    assert_eq!(scalar(&cloud, "label")[0], 0.0);
    let cloud = io::read(&path.with_file_name("T15g_text_column_first.csv")).unwrap();
    let time = &cloud
        .attributes
        .scalars
        .iter()
        .find(|field| field.name == "time")
        .unwrap();
    assert!((f64::from(time.values[1]) - f64::from(time.values[0]) - 1.0).abs() < 1e-3);
    let cloud = io::read(&path.with_file_name("T15v_thousands_columns_65.xyz")).unwrap();
    assert_first(&cloud, 500);
    assert_eq!(cloud.attributes.colors, None);
    assert_eq!(scalar(&cloud, "c61").len(), 500);
}

#[test]
fn headers_of_many_programs_are_read() {
    for header in [
        "\"Points_m_XYZ:0\",\"Points_m_XYZ:1\",\"Points_m_XYZ:2\",i",
        "Points:0,Points:1,Points:2,i",
        "X1 (m),Y1 (m),Z1 (m),i",
        "x [m],y [m],z [m],i",
        "X_coord,Y_coord,Z_coord,i",
        "x_m,y_m,z_m,i",
        "easting,northing,elevation,i",
        "posX,posY,posZ,i",
        "'x','y','z','i'",
        "#x,y,z,i",
        "//X,Y,Z,i",
        "% x,y,z,i",
        "# x y z i",
    ] {
        let cloud = read("a.csv", &format!("{header}\n1,2,3,9\n4,5,6,8\n"));
        assert_eq!(points(&cloud), [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]], "{header}");
        assert_eq!(scalar(&cloud, "i"), [9.0, 8.0], "{header}");
    }
    for (unit, expected) in [
        ("cm", LengthUnit::Centimetre),
        ("mm", LengthUnit::Millimetre),
        ("ft", LengthUnit::Foot),
        ("m", LengthUnit::Metre),
    ] {
        let cloud = read("a.csv", &format!("x [{unit}],y [{unit}],z [{unit}]\n1,2,3\n"));
        assert_eq!(cloud.unit, Some(expected), "{unit}");
        assert_eq!(assumed(&cloud, Subject::Unit), Some((unit, Evidence::File)));
    }
    let error = try_read("a.csv", b"alpha,beta,gamma,delta\n1,2,3,4\n5,6,7,8\n")
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("0 alpha, 1 beta, 2 gamma, 3 delta") && error.contains("--columns x=0"),
        "{error}"
    );
}

#[test]
fn the_user_can_choose_the_coordinate_columns() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.csv");
    std::fs::write(&path, "alpha,beta,gamma,delta\n1,2,3,4\n5,6,7,8\n").unwrap();
    for columns in ["x=1,y=2,z=3,intensity=0", "x=beta,y=gamma,z=delta,intensity=alpha"] {
        let cloud = with_columns(&path, columns).unwrap();
        assert_eq!(points(&cloud), [[2.0, 3.0, 4.0], [6.0, 7.0, 8.0]], "{columns}");
        assert_eq!(scalar(&cloud, "intensity"), [1.0, 5.0]);
        assert_eq!(assumed(&cloud, Subject::Columns), None, "a person has said it");
    }
    let error = with_columns(&path, "x=1,y=2,z=9").unwrap_err().to_string();
    assert!(
        error.contains("column 9 of --columns does not exist") && error.contains("0 alpha"),
        "{error}"
    );
    std::fs::write(&path, "9 8 7 1 2 3 255 0 9\n9 8 7 4 5 6 255 0 9\n").unwrap();
    let cloud = with_columns(&path, "x=3,y=4,z=5,r=6,g=7,b=8").unwrap();
    assert_eq!(points(&cloud)[1], [4.0, 5.0, 6.0]);
    assert_eq!(cloud.attributes.colors.unwrap()[0], [255, 0, 9, 255]);
}

#[test]
fn longitude_and_latitude_are_projected_and_reported() {
    let text = "lon,lat,alt\n8.5,47.0,400\n8.5,47.0009,401\n8.5012,47.0,402\n";
    let cloud = read("a.csv", text);
    let [origin, north, east] = points(&cloud)[..] else {
        panic!()
    };
    let distance = |one: [f64; 3], other: [f64; 3]| (one[0] - other[0]).hypot(one[1] - other[1]);
    assert!((distance(origin, north) - 100.0).abs() < 0.5 && (distance(origin, east) - 91.2).abs() < 0.5);
    assert_eq!(origin[2], 400.0);
    let (value, evidence) = assumed(&cloud, Subject::Projection).unwrap();
    assert!(value.contains("32N") && evidence.is_guess(), "{value}");
    assert_eq!(cloud.unit, Some(LengthUnit::Metre));
    for wrong in ["lon,lat,speed\n8.5,47,1\n", "lon,lat,alt\n500000,5400000,1\n"] {
        let error = try_read("a.csv", wrong.as_bytes()).unwrap_err().to_string();
        assert!(error.contains("--columns"), "{error}");
    }
    let Some(path) = shared("meaning/T17_lat_lon_csv.csv") else {
        return;
    };
    let cloud = io::read(&path).unwrap();
    assert!(assumed(&cloud, Subject::Projection).unwrap().0.contains("22N"));
    let (first, last) = (points(&cloud)[0], points(&cloud)[2]);
    assert!((distance(first, last) - 0.24).abs() < 0.05, "{}", distance(first, last));
    assert_eq!(first[2], 631.0);
}

#[test]
fn one_odd_line_only_affects_itself() {
    let mut text = String::from("x,y,z,i\n");
    for i in 0..50 {
        let _ = writeln!(text, "{i},2,3,4");
    }
    for (footer, problem) in [
        ("Total: 50 points\n", "line 52: found"),
        ("1,2\n", "line 52: found 2 numbers, expected 4"),
        ("a,b,c,d\n1,x,3,4\n", "line 52: found `a`"),
    ] {
        let cloud = read("a.csv", &format!("{text}{footer}"));
        assert_eq!(cloud.positions.len(), 50, "{footer}");
        assert!(
            cloud.warnings[0].contains(problem) && cloud.warnings[0].contains("skipped"),
            "{:?}",
            cloud.warnings
        );
    }
    let many = format!("{text}{}", "1,2\n".repeat(20));
    assert!(
        try_read("a.csv", many.as_bytes())
            .unwrap_err()
            .to_string()
            .contains("line 52")
    );
    let cloud = read("a.csv", &format!("{text}1,NaN,3,4\n,,3,4\n1,2,3,\n"));
    assert_eq!(cloud.positions.len(), 53);
    assert!(
        cloud.warnings[0].contains("2 of 53 points have no coordinates"),
        "{:?}",
        cloud.warnings
    );
}

#[test]
fn encodings_and_numbers_of_spreadsheets_are_read() {
    let text = "x;y;z;Größe\r\n1.234,5;2,25;3,5;1\r\n-1,5;0,5;;2\r\n";
    let units = |mark: fn(u16) -> [u8; 2]| -> Vec<u8> {
        std::iter::once(0xfeff)
            .chain(text.encode_utf16())
            .flat_map(mark)
            .collect()
    };
    for bytes in [
        text.as_bytes().to_vec(),
        format!("\u{feff}{text}").into_bytes(),
        units(u16::to_le_bytes),
        units(u16::to_be_bytes),
    ] {
        let cloud = try_read("a.csv", &bytes).unwrap();
        assert_eq!(points(&cloud)[0], [1234.5, 2.25, 3.5]);
        assert!(points(&cloud)[1][2].is_nan());
        assert_eq!(names(&cloud), ["Größe"]);
    }
    let cloud = read("a.txt", "x;y;z\n1,234.5;2;3\n1'234.5;2;3\n");
    assert_eq!(points(&cloud)[0], points(&cloud)[1]);
}

#[test]
fn file_names_do_not_determine_columns() {
    let normals = "1 2 3 0 0.6 0.8\n1 2 4 1 0 0\n";
    let colors = "1 2 3 255 128 0\n1 2 4 0 1 2\n";
    for name in ["a.xyzn", "a.xyzrgb", "a.xyz", "a.txt", "a.asc"] {
        assert_eq!(
            read(name, normals).attributes.normals,
            Some(vec![[0.0, 0.6, 0.8], [1.0, 0.0, 0.0]]),
            "{name}"
        );
        assert_eq!(
            read(name, colors).attributes.colors.unwrap()[0],
            [255, 128, 0, 255],
            "{name}"
        );
        let cloud = read(name, "1 2 3 -40.5 7.25 300\n1 2 4 -41 8 301\n");
        assert_eq!(
            (cloud.attributes.colors.clone(), cloud.attributes.normals.clone()),
            (None, None),
            "{name}"
        );
        assert!(assumed(&cloud, Subject::Columns).unwrap().1.is_guess());
    }
    let alpha = read("a.txt", "x y z r g b a\n1 2 3 255 0 9 128\n");
    assert_eq!(alpha.attributes.colors, Some(vec![[255, 0, 9, 128]]));
}

/// The frames of a text: names, times and points.
fn frames(name: &str, text: &str, columns: Option<&str>) -> Vec<(String, Option<Duration>, RawCloud)> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, text).unwrap();
    let columns: Option<ColumnMap> = columns.map(|columns| columns.parse().unwrap());
    let options = ReadOptions::default().with_columns(columns);
    let entries = io::list(&path, &options).unwrap();
    let read = |entry: io::Entry| {
        let cloud = io::read_part(&path, &entry.part, &options).unwrap();
        (entry.name, entry.time, cloud)
    };
    entries.into_iter().map(read).collect()
}

/// Rows `x y z` of `count` points in a cube, moved a little from a frame to the next.
fn rows(frame: usize, count: usize) -> Vec<String> {
    let point = |i: usize| format!("{}.5,{},{}", i % 7, i % 5, (i % 3) as f64 + 0.1 * frame as f64);
    (0..count).map(point).collect()
}

#[test]
fn columns_of_frames_and_times_are_sequences() {
    let table = |header: &str, value: fn(usize) -> String| {
        let mut text = format!("{header},x,y,z\n");
        for frame in 0..4 {
            for row in rows(frame, 100) {
                let _ = writeln!(text, "{},{row}", value(frame));
            }
        }
        text
    };
    let seconds = |seconds: f64| Some(Duration::from_secs_f64(seconds));
    for (header, value, time) in [
        ("frame", (|frame| frame.to_string()) as fn(usize) -> String, None),
        ("frame_id", |frame| (10 + frame).to_string(), None),
        ("time", |frame| (0.25 * frame as f64).to_string(), seconds(0.25)),
        ("t", |frame| (0.5 * frame as f64).to_string(), seconds(0.5)),
        (
            "timestamp",
            |frame| (1_700_000_000_000 + 40 * frame).to_string(),
            seconds(1_700_000_000.04),
        ),
        ("time [ms]", |frame| (40 * frame).to_string(), seconds(0.04)),
        ("time", |frame| format!("1970-01-01T00:00:0{frame}.5"), seconds(1.5)),
        ("frame", |frame| format!("f{frame}"), None),
    ] {
        let found = frames("a.csv", &table(header, value), None);
        assert_eq!(found.len(), 4, "{header}");
        let (_, second, cloud) = &found[1];
        assert_eq!(points(cloud)[0], [0.5, 0.0, 0.1], "{header}");
        assert_eq!(cloud.positions.len(), 100);
        assert_eq!(
            second.map(|time| time.as_millis()),
            time.map(|time| time.as_millis()),
            "{header}"
        );
        assert!(assumed(cloud, Subject::Frames).is_some());
    }
    // Per-point times are not frames, and the user has the last word.
    let mut text = String::from("x,y,z,time\n");
    for (i, row) in rows(0, 400).iter().enumerate() {
        let _ = writeln!(text, "{row},{}", 0.001 * i as f64);
    }
    assert_eq!(frames("a.csv", &text, None).len(), 1);
    let text = table("frame", |frame| frame.to_string());
    assert_eq!(frames("a.csv", &text, Some("frame=none")).len(), 1);
    assert_eq!(frames("a.csv", &text.replace("frame,", "batch,"), None).len(), 1);
    assert_eq!(
        frames("a.csv", &text.replace("frame,", "batch,"), Some("frame=batch")).len(),
        4
    );
    // Reading a single cloud reports the others.
    let cloud = read("a.csv", &text);
    assert_eq!(cloud.positions.len(), 100);
    assert!(
        cloud.warnings.iter().any(|warning| warning.contains("4 frames")),
        "{:?}",
        cloud.warnings
    );
}

#[test]
fn blocks_of_rows_are_sequences() {
    let joined = |frame: usize| rows(frame, 60).join("\n").replace(',', " ");
    let counted = (0..4)
        .map(|frame| format!("60\nt = {}\n{}\n", 0.5 * frame as f64, joined(frame)))
        .collect::<Vec<_>>()
        .concat();
    let found = frames("a.xyz", &counted, None);
    assert_eq!(found.len(), 4);
    assert_eq!(found[1].1, Some(Duration::from_millis(500)));
    assert_eq!(points(&found[3].2)[0], [0.5, 0.0, 0.1 * 3.0]);
    let blank = (0..4)
        .map(|frame| format!("{}\n\n", joined(frame)))
        .collect::<Vec<_>>()
        .concat();
    assert_eq!(frames("a.txt", &blank, None).len(), 4);
    let commented = (0..4)
        .map(|frame| format!("# frame {frame}\n{}\n", joined(frame)))
        .collect::<Vec<_>>()
        .concat();
    let found = frames("a.txt", &commented, None);
    assert_eq!((found.len(), found[2].0.as_str()), (4, "frame 3 (frame 2)"));
    // Scans of a survey form one cloud, and so do the lines of a surface.
    let scans = (0..4)
        .map(|scan| format!("60\n{}\n", joined(scan)))
        .collect::<Vec<_>>()
        .concat();
    assert_eq!(frames("a.pts", &scans, None).len(), 1);
    let lines = (0..9)
        .map(|x| {
            (0..9)
                .map(|y| format!("{x} {y} {}\n", x * y))
                .collect::<Vec<_>>()
                .concat()
                + "\n"
        })
        .collect::<Vec<_>>()
        .concat();
    let found = frames("a.txt", &lines, None);
    assert_eq!((found.len(), found[0].2.positions.len()), (1, 81));
    assert_eq!(assumed(&found[0].2, Subject::Frames).unwrap().0, "one");
    let error = try_read("a.xyz", format!("{counted}60\nlast\n1 2 3\n").as_bytes())
        .unwrap_err()
        .to_string();
    assert!(error.contains("truncated"), "{error}");
}

#[test]
fn molecules_are_points_with_elements() {
    let text = "3\nwater\nO 0 0 0.5\nH 1 0 0\nH -1 0 0.25\n";
    let cloud = read("a.xyz", text);
    assert_eq!(points(&cloud), [[0.0, 0.0, 0.5], [1.0, 0.0, 0.0], [-1.0, 0.0, 0.25]]);
    assert_eq!(scalar(&cloud, "element"), [1.0, 0.0, 0.0]);
    assert!(
        cloud
            .assumptions
            .iter()
            .any(|assumption| assumption.why.contains("molecule"))
    );
    assert_eq!(frames("a.xyz", &text.repeat(5), None).len(), 5);
    let Some(path) = shared("meaning/M04_molecule.xyz") else {
        return;
    };
    let cloud = io::read(&path).unwrap();
    assert_eq!(cloud.positions.len(), 300);
    assert_eq!(points(&cloud)[0], [-11.186, -0.8324, -2.1838]);
}

#[test]
fn elevation_grids_are_points() {
    let Some(path) = shared("meaning/M05_esri_grid.asc") else {
        return;
    };
    let cloud = io::read(&path).unwrap();
    let skipped = assumed(&cloud, Subject::NoData).map_or(0, |(value, _)| {
        let count = value.split(' ').nth(1).unwrap();
        count.parse::<usize>().unwrap()
    });
    assert_eq!(cloud.positions.len() + skipped, 50 * 40);
    let first = points(&cloud)[0];
    assert!(
        (500_000.0..501_000.0).contains(&first[0]) && (5_400_000.0..5_401_000.0).contains(&first[1]),
        "{first:?}"
    );
    assert_eq!((cloud.attributes.colors, cloud.attributes.normals), (None, None));
    let error = try_read("a.las", b"~Version Information\nVERS. 2.0 : CWLS\n")
        .unwrap_err()
        .to_string();
    assert!(error.contains("well log"), "{error}");
}

/// Detections of a radar: `width` numbers per point, of a size of their own each.
fn records(width: usize, count: usize) -> Vec<u8> {
    let mut state = 7u32;
    let mut random = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / (1 << 24) as f32
    };
    let scales = [50.0, 20.0, 3.0, 15.0, 6.0, 5.0, 0.5, 100.0, 1.0, 0.1, 30.0, 2.0];
    let values = (0..count).flat_map(|_| {
        (0..width)
            .map(|column| scales[column] * (random() - 0.4))
            .collect::<Vec<f32>>()
    });
    values.flat_map(f32::to_le_bytes).collect()
}

#[test]
fn bare_records_have_any_width() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.bin");
    for width in 3..=12 {
        std::fs::write(&path, records(width, 2520)).unwrap();
        let cloud = with_columns(&path, &width.to_string()).unwrap();
        assert_eq!(cloud.positions.len(), 2520, "{width}");
        let cloud = io::read(&path).unwrap();
        let (value, _) = assumed(&cloud, Subject::Columns).unwrap();
        assert!(
            value.starts_with(&format!("{width} values per point")),
            "{width}: {value}"
        );
    }
    let bytes: Vec<u8> = [9.0f32, 1.0, 2.0, 3.0, 0.5, 8.0, 4.0, 5.0, 6.0, 0.25]
        .into_iter()
        .flat_map(f32::to_le_bytes)
        .collect();
    std::fs::write(&path, bytes).unwrap();
    for columns in ["5:x=1,y=2,z=3,power=4", "n=5,x=1,y=2,z=3,power=4"] {
        let cloud = with_columns(&path, columns).unwrap();
        assert_eq!(points(&cloud), [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]);
        assert_eq!(scalar(&cloud, "power"), [0.5, 0.25]);
    }
    for columns in ["3:x=0,y=1,z=2,power=7", "7", "x=a,y=1,z=2"] {
        let error = columns
            .parse::<ColumnMap>()
            .map(|_| with_columns(&path, columns).unwrap_err().to_string());
        assert!(error.unwrap_or_else(|error| error).contains("column"), "{columns}");
    }
    let error = try_read("a.bin", &[0; 17]).unwrap_err().to_string();
    assert!(error.contains("--columns N"), "{error}");
    let Some(path) = shared("meaning/M03_vod_radar_7.bin") else {
        return;
    };
    let cloud = io::read(&path).unwrap();
    assert_eq!(cloud.positions.len(), 300, "{:?}", cloud.assumptions);
    assert_eq!(with_columns(&path, "7").unwrap().positions.len(), 300);
}
