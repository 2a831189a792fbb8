//! Names and colours of classes of points: the standard classes of ASPRS LAS 1.4 (R15, table 17: formats 6 to 10), in
//! the colours that programs for them commonly use.

/// Name and colour of the classes 0 to 18.
const STANDARD: [(&str, u32); 19] = [
    ("Never classified", 0x9a_9a_9a),
    ("Unclassified", 0xc0_c0_c0),
    ("Ground", 0xa8_72_3c),
    ("Low vegetation", 0xb4_d9_7a),
    ("Medium vegetation", 0x6d_c0_4b),
    ("High vegetation", 0x1f_8a_34),
    ("Building", 0xe8_5d_4a),
    ("Low noise", 0x8c_1d_1d),
    ("Model key point", 0xd9_b3_2c),
    ("Water", 0x3f_8f_e8),
    ("Rail", 0x8e_5b_c7),
    ("Road surface", 0x6e_74_7c),
    ("Overlap", 0xf2_f2_dc),
    ("Wire, guard", 0xff_e1_4d),
    ("Wire, conductor", 0xff_b0_1f),
    ("Transmission tower", 0x2b_c4_c9),
    ("Wire connector", 0xf2_7d_c8),
    ("Bridge deck", 0x4a_5f_b8),
    ("High noise", 0xd1_1f_7a),
];

/// The class that a number stands for: the nearest whole one.
pub fn class_of(value: f32) -> i32 {
    value.round() as i32
}

/// The name of a standard class.
pub fn class_name(class: i32) -> Option<&'static str> {
    let class = usize::try_from(class).ok()?;
    STANDARD.get(class).map(|&(name, _)| name)
}

/// The opaque colour of a class. Classes without a standard colour get hues far from their neighbours'.
pub fn class_color(class: i32) -> [u8; 4] {
    let standard = usize::try_from(class).ok().and_then(|class| STANDARD.get(class));
    if let Some((_, color)) = standard {
        let [_, red, green, blue] = color.to_be_bytes();
        return [red, green, blue, 255];
    }
    // The golden ratio spreads hues evenly; lightness distinguishes successive rounds of them.
    let hue = 6.0 * (f64::from(class) * 0.618_033_988_749_895).rem_euclid(1.0);
    let bright = [235.0, 190.0, 150.0][class.rem_euclid(3) as usize];
    let channel = |shift: f64| {
        let ramp = ((hue + shift).rem_euclid(6.0) - 3.0).abs() - 1.0;
        (bright * (0.3 + 0.7 * ramp.clamp(0.0, 1.0))) as u8
    };
    [channel(0.0), channel(4.0), channel(2.0), 255]
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn standard_classes_have_their_names_and_colors() {
        assert_eq!(class_name(2), Some("Ground"));
        assert_eq!(class_name(18), Some("High noise"));
        assert_eq!((class_name(19), class_name(-1)), (None, None));
        let brightest = |class: i32| {
            let [red, green, blue, _] = class_color(class);
            [red, green, blue]
                .into_iter()
                .max()
                .map(|max| [red == max, green == max, blue == max])
        };
        assert_eq!(brightest(5), Some([false, true, false]), "vegetation is green");
        assert_eq!(brightest(9), Some([false, false, true]), "water is blue");
        assert_eq!(brightest(6), Some([true, false, false]), "buildings are red");
    }

    #[test]
    fn every_byte_class_has_a_distinct_color() {
        let colors: HashSet<[u8; 4]> = (0..=255).map(class_color).collect();
        assert_eq!(colors.len(), 256);
        for class in 0..255 {
            let [a, b] = [class, class + 1].map(class_color);
            let apart: u32 = a.iter().zip(b).map(|(a, b)| u32::from(a.abs_diff(b))).sum();
            assert!(apart >= 40, "{class}: {a:?} {b:?}");
        }
    }

    #[test]
    fn numbers_map_to_the_nearest_class() {
        assert_eq!([1.6, 2.4, -0.4].map(class_of), [2, 2, 0]);
        assert_eq!(class_of(f32::INFINITY), i32::MAX);
        assert_eq!(class_color(i32::MIN)[3], 255);
    }
}
