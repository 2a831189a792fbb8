//! Colour maps: from a fraction of 0 to 1 to a colour.
//!
//! How it works: 33 colours of each published table stand at equal steps, with lines between them in the stored values
//! of channels. No channel is more than 2 of 255 off the table of 256 colours. Many values at a time go through a table
//! of 1,025 colours, whose steps are finer than those of the channels.

use std::sync::OnceLock;

/// Colour map: a mapping from scalar values to colours.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ColorMap {
    /// Dark violet to yellow; lightness grows evenly, also for the colour-blind and in print.
    #[default]
    Viridis,
    /// Blue over green to red: many colours, so that details are distinguishable.
    Turbo,
    /// Black over purple to pale yellow; lightness grows evenly.
    Magma,
    /// Black to white.
    Grey,
    /// Blue over light grey to red: diverging, for values on both sides of a centre.
    Diverging,
}

/// Number of entries of [`ColorMap::table`]; the central entry is the centre of the map.
pub(crate) const TABLE_LEN: usize = 1025;

type Anchors = [u32; 33];

/// Smith, van der Walt and Firing 2015, for matplotlib, dedicated to the public domain under CC0.
#[expect(clippy::mistyped_literal_suffixes, reason = "these are bytes of colours")]
const VIRIDIS: Anchors = [
    0x44_01_54, 0x47_0d_60, 0x48_18_6a, 0x48_23_74, 0x47_2d_7b, 0x45_36_81, 0x42_40_86, 0x3f_49_89, 0x3b_52_8b,
    0x37_5a_8d, 0x33_63_8d, 0x2f_6a_8e, 0x2c_72_8e, 0x29_7a_8e, 0x26_81_8e, 0x23_89_8e, 0x21_90_8c, 0x1f_98_8b,
    0x1f_9f_88, 0x21_a6_85, 0x28_ae_80, 0x31_b5_7b, 0x3e_bc_74, 0x4c_c2_6c, 0x5d_c9_63, 0x6e_ce_58, 0x82_d3_4c,
    0x96_d8_3f, 0xab_dc_32, 0xc0_df_24, 0xd5_e2_1a, 0xea_e5_1a, 0xfd_e7_25,
];

/// Mikhailov 2019, "Turbo, an improved rainbow colormap for visualization", Apache 2.0.
#[expect(clippy::mistyped_literal_suffixes, reason = "these are bytes of colours")]
const TURBO: Anchors = [
    0x30_12_3b, 0x39_2a_73, 0x40_40_a1, 0x44_56_c7, 0x46_6b_e3, 0x46_7f_f6, 0x42_93_ff, 0x37_a7_fa, 0x29_bb_ec,
    0x1d_cd_d8, 0x18_dc_c3, 0x1e_e8_b0, 0x31_f2_99, 0x4c_f9_7e, 0x6b_fd_64, 0x8a_ff_4d, 0xa3_fd_3c, 0xb8_f7_35,
    0xcc_ed_34, 0xde_e0_37, 0xed_d0_3a, 0xf8_c0_3a, 0xfd_ae_35, 0xfe_98_2c, 0xfb_80_22, 0xf5_68_17, 0xec_52_0f,
    0xe0_40_09, 0xd2_31_05, 0xc0_23_02, 0xac_17_01, 0x95_0d_01, 0x7a_04_03,
];

/// Smith and van der Walt 2015, for matplotlib, dedicated to the public domain under CC0.
const MAGMA: Anchors = [
    0x00_00_04, 0x03_03_11, 0x0a_08_22, 0x13_0d_33, 0x1d_11_46, 0x28_11_5a, 0x36_10_6a, 0x43_0f_76, 0x50_12_7c,
    0x5d_17_7f, 0x69_1c_81, 0x76_21_81, 0x82_26_81, 0x8f_2a_81, 0x9c_2e_7f, 0xa9_32_7d, 0xb6_37_79, 0xc3_3b_75,
    0xcf_41_70, 0xdb_48_6a, 0xe6_51_63, 0xee_5c_5e, 0xf5_69_5c, 0xf9_78_5d, 0xfb_87_61, 0xfd_96_68, 0xfe_a5_71,
    0xfe_b4_7b, 0xfe_c3_87, 0xfe_d1_94, 0xfd_e0_a2, 0xfc_ee_b0, 0xfc_fd_bf,
];

/// Moreland 2009, "Diverging color maps for scientific visualization": smooth cool to warm.
const DIVERGING: Anchors = [
    0x3b_4c_c0, 0x44_5a_cc, 0x4d_68_d7, 0x57_75_e1, 0x62_82_ea, 0x6c_8e_f1, 0x77_9a_f7, 0x82_a5_fb, 0x8d_b0_fe,
    0x98_b9_ff, 0xa3_c2_fe, 0xae_c9_fc, 0xb8_d0_f9, 0xc2_d5_f4, 0xcc_d9_ee, 0xd5_db_e6, 0xdd_dd_dd, 0xe5_d8_d1,
    0xec_d3_c5, 0xf1_cc_b9, 0xf4_c4_ad, 0xf7_bb_a0, 0xf7_b1_94, 0xf7_a6_87, 0xf4_9a_7b, 0xf1_8d_6f, 0xec_7f_63,
    0xe5_70_58, 0xde_60_4d, 0xd5_50_42, 0xcb_3e_38, 0xc0_28_2f, 0xb4_04_26,
];

impl ColorMap {
    /// All maps, in the order in which a list shows them.
    pub const ALL: [Self; 5] = [Self::Viridis, Self::Turbo, Self::Magma, Self::Grey, Self::Diverging];

    /// Its word on the command line and in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Viridis => "viridis",
            Self::Turbo => "turbo",
            Self::Magma => "magma",
            Self::Grey => "grey",
            Self::Diverging => "diverging",
        }
    }

    /// The opaque colour at fraction `share` of the map; clamped to 0..=1, NaN is 0.
    pub fn color(self, share: f32) -> [u8; 4] {
        let anchors = match self {
            Self::Viridis => &VIRIDIS,
            Self::Turbo => &TURBO,
            Self::Magma => &MAGMA,
            Self::Diverging => &DIVERGING,
            Self::Grey => {
                let grey = (share.clamp(0.0, 1.0) * 255.0).round() as u8;
                return [grey, grey, grey, 255];
            }
        };
        let intervals = anchors.len() - 1;
        let place = share.clamp(0.0, 1.0) * intervals as f32;
        let index = (place as usize).min(intervals - 1);
        let weight = place - index as f32;
        let [from, to] = [anchors[index], anchors[index + 1]].map(u32::to_be_bytes);
        let channel = |channel: usize| {
            let [from, to] = [from, to].map(|color| f32::from(color[channel]));
            (from + (to - from) * weight).round() as u8
        };
        [channel(1), channel(2), channel(3), 255]
    }

    /// [`ColorMap::color`] at even steps from 0 to 1.
    pub(crate) fn table(self) -> &'static [[u8; 4]; TABLE_LEN] {
        static TABLES: [OnceLock<[[u8; 4]; TABLE_LEN]>; ColorMap::ALL.len()] =
            [const { OnceLock::new() }; ColorMap::ALL.len()];
        TABLES[self as usize]
            .get_or_init(|| std::array::from_fn(|step| self.color(step as f32 / (TABLE_LEN - 1) as f32)))
    }
}

impl std::fmt::Display for ColorMap {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.pad(self.name())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const TABLES: [(ColorMap, &Anchors); 4] = [
        (ColorMap::Viridis, &VIRIDIS),
        (ColorMap::Turbo, &TURBO),
        (ColorMap::Magma, &MAGMA),
        (ColorMap::Diverging, &DIVERGING),
    ];

    /// Rows of the published tables of 256 colours, about half-way between the steps above.
    const BETWEEN: [(ColorMap, &[(u16, u32)]); 4] = [
        (
            ColorMap::Viridis,
            &[
                (4, 0x46_07_5a),
                (12, 0x47_13_65),
                (20, 0x48_1d_6f),
                (36, 0x46_32_7e),
                (52, 0x40_45_88),
                (68, 0x39_56_8c),
                (92, 0x2e_6f_8e),
                (116, 0x25_85_8e),
                (131, 0x20_93_8c),
                (155, 0x24_aa_83),
                (171, 0x37_b8_78),
                (187, 0x54_c5_68),
                (203, 0x77_d1_53),
                (219, 0xa0_da_39),
                (235, 0xca_e1_1f),
                (251, 0xf4_e6_1e),
            ],
        ),
        (
            ColorMap::Turbo,
            &[
                (4, 0x35_1e_58),
                (12, 0x3d_35_8b),
                (28, 0x46_61_d6),
                (44, 0x45_8a_fc),
                (60, 0x2f_b2_f4),
                (76, 0x19_d5_cd),
                (84, 0x19_e3_b9),
                (100, 0x3f_f6_8a),
                (116, 0x7d_ff_56),
                (124, 0x99_fe_42),
                (131, 0xac_fb_38),
                (155, 0xe5_d9_38),
                (179, 0xfe_a4_31),
                (195, 0xf9_75_1d),
                (219, 0xda_39_07),
                (251, 0x88_08_02),
            ],
        ),
        (
            ColorMap::Magma,
            &[
                (4, 0x02_01_09),
                (12, 0x06_05_1a),
                (28, 0x18_0f_3d),
                (44, 0x2f_11_63),
                (52, 0x3d_0f_71),
                (76, 0x64_1a_80),
                (100, 0x89_28_81),
                (124, 0xb0_35_7b),
                (131, 0xbc_39_78),
                (147, 0xd5_44_6d),
                (163, 0xea_56_61),
                (171, 0xf2_62_5d),
                (187, 0xfa_7f_5e),
                (211, 0xfe_ac_76),
                (235, 0xfe_d8_9a),
                (251, 0xfc_f6_b8),
            ],
        ),
        (
            ColorMap::Diverging,
            &[
                (4, 0x3f_53_c6),
                (20, 0x53_6e_dd),
                (36, 0x67_88_ee),
                (52, 0x7d_a0_f9),
                (68, 0x93_b5_fe),
                (84, 0xa9_c6_fd),
                (100, 0xbe_d2_f6),
                (124, 0xd9_dc_e1),
                (131, 0xe0_db_d8),
                (147, 0xee_d0_c0),
                (163, 0xf5_c0_a7),
                (179, 0xf7_ac_8e),
                (195, 0xf3_94_75),
                (211, 0xe9_78_5d),
                (235, 0xd0_47_3d),
                (251, 0xba_16_2b),
            ],
        ),
    ];

    fn rgb(color: u32) -> [u8; 4] {
        let [_, red, green, blue] = color.to_be_bytes();
        [red, green, blue, 255]
    }

    #[test]
    fn color_maps_pass_through_their_stops_from_end_to_end() {
        for (map, anchors) in TABLES {
            for (step, &anchor) in anchors.iter().enumerate() {
                assert_eq!(map.color(step as f32 / 32.0), rgb(anchor), "{map} {step}");
            }
            assert_eq!(map.color(-1.0), rgb(anchors[0]));
            assert_eq!(map.color(7.0), rgb(anchors[32]));
        }
        let ends = |map: ColorMap| [map.color(0.0), map.color(1.0)];
        assert_eq!(ends(ColorMap::Viridis), [0x44_01_54, 0xfd_e7_25].map(rgb));
        assert_eq!(ends(ColorMap::Turbo), [0x30_12_3b, 0x7a_04_03].map(rgb));
        assert_eq!(ends(ColorMap::Magma), [0x00_00_04, 0xfc_fd_bf].map(rgb));
        assert_eq!(ends(ColorMap::Grey), [0x00_00_00, 0xff_ff_ff].map(rgb));
        assert_eq!(ends(ColorMap::Diverging), [0x3b_4c_c0, 0xb4_04_26].map(rgb));
        assert_eq!(ColorMap::Diverging.color(0.5), rgb(0xdd_dd_dd));
        assert_eq!(ColorMap::Grey.color(0.5), [128, 128, 128, 255]);
    }

    #[test]
    fn channels_between_stops_are_at_most_two_off() {
        for (map, rows) in BETWEEN {
            for &(row, published) in rows {
                let found = map.color(f32::from(row) / 255.0);
                let off = found.iter().zip(rgb(published)).map(|(a, b)| a.abs_diff(b));
                assert!(off.max() <= Some(2), "{map} {row}: {found:?}");
            }
        }
    }

    #[test]
    fn lightness_of_sequential_maps_increases_strictly() {
        let lightness = |map: ColorMap, step: u32| {
            let [red, green, blue, _] = map.color(step as f32 / 64.0).map(f64::from);
            0.2126 * red + 0.7152 * green + 0.0722 * blue
        };
        for map in [ColorMap::Viridis, ColorMap::Magma, ColorMap::Grey] {
            assert!(
                (0..64).all(|step| lightness(map, step) < lightness(map, step + 1)),
                "{map}"
            );
        }
    }

    proptest! {
        #[test]
        fn lookup_table_matches_the_map(share in 0f32..=1.0) {
            for map in ColorMap::ALL {
                let entry = map.table()[(share * (TABLE_LEN - 1) as f32).round() as usize];
                let off = entry.iter().zip(map.color(share)).map(|(a, b)| a.abs_diff(b));
                prop_assert!(off.max() <= Some(1), "{} {}", map, share);
            }
        }
    }
}
