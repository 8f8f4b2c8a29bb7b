//! OpenCRG files (`.crg`), the road format of the industry, text and binary.
//!
//! Format: ASAM OpenCRG 1.2, chapter "OpenCRG data format": a text header of sections (`$ROAD_CRG`, `$KD_DEFINITION`,
//! ...), ended by a line of two or more `$`, then rows of channels. Read here: `LRFI` and `LDFI` (text, 10 or 20 characters a number, records of
//! 80), `KRBI` and `KDBI` (big-endian f32 or f64), numbered or positioned long sections, missing values at the edges.
//!
//! What is taken is the surface over the (u, v) strip: heights relative to the reference line. Its curvature, slope and
//! banking are not roughness; a vehicle that drives straight ahead at constant speed does not see them. Sections that would
//! change the heights (`$ROAD_CRG_MODS`, `$ROAD_CRG_FILE`) are refused rather than ignored.

mod header;
mod payload;

use super::{GridRoad, RoadError};

/// Reads a file's bytes; `path` appears in errors.
///
/// # Errors
/// What is not an OpenCRG file of the kinds above, with the line of the header or data it is about.
pub fn read(bytes: &[u8], path: &str) -> Result<GridRoad, RoadError> {
    let header = header::parse(bytes, path)?;
    let rows = payload::decode(bytes, &header, path)?;
    let heights = fill_gaps(rows, &header, path)?;
    let count = heights.len() / header.lateral_m.len();
    if count < 2 {
        return Err(RoadError::payload(path, "has fewer than two rows of heights"));
    }
    Ok(GridRoad::new(header.spacing_m, header.lateral_m, count, heights))
}

/// Picks the long sections out of the rows and fills missing heights: between two measured ones by a straight line, at the
/// edges with the outermost measured height.
fn fill_gaps(rows: Vec<f64>, header: &header::Header, path: &str) -> Result<Vec<f32>, RoadError> {
    let mut heights = Vec::with_capacity(rows.len() / header.channels * header.columns.len());
    for (index, row) in rows.chunks_exact(header.channels).enumerate() {
        let start = heights.len();
        heights.extend(header.columns.iter().map(|&column| row[column] as f32));
        let section = &mut heights[start..];
        let Some(first) = section.iter().position(|height| height.is_finite()) else {
            let problem = format!(
                "row {} has no height at all: cut the file to where it was measured",
                index + 1
            );
            return Err(RoadError::payload(path, problem));
        };
        let edge = section[first];
        section[..first].fill(edge);
        let mut known = first;
        for i in first + 1..section.len() {
            if !section[i].is_finite() {
                continue;
            }
            let (from, to) = (section[known], section[i]);
            let gap = (i - known) as f32;
            for (k, height) in section[known..i].iter_mut().enumerate().skip(1) {
                *height = from + (to - from) * (k as f32 / gap);
            }
            known = i;
        }
        let edge = section[known];
        section[known..].fill(edge);
    }
    Ok(heights)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::road::Road;

    fn text(header: &str, data: &str) -> Vec<u8> {
        format!("$CT\nany words = here\n$\n{header}$$$$\n{data}").into_bytes()
    }

    const SEVEN: &str = "$ROAD_CRG ! a comment\nreference_line_increment = 1.0\nLONG_SECTION_V_INCREMENT = 0.50\n$\n\
        $KD_Definition\n#:LRFI\nD:long section 1,m\nD:long section 2,m\nD:long section 3,m\nD:long section 4,m\n\
        D:long section 5,m\nD:long section 6,m\nD:long section 7,m\n$\n";

    #[test]
    fn text_rows_without_spaces_and_with_missing_edges_are_read() {
        let road = read(
            &text(
                SEVEN,
                " 0.0000000 0.0000000 0.0111111 0.0111111 0.0111111 *missing* *missing*\n \
                  *missing* *missing* 0.0000000 0.0111111 0.0000000 0.0000000-0.0111111\n",
            ),
            "a.crg",
        )
        .unwrap();
        assert_eq!(road.lateral_m(), [-1.5, -1.0, -0.5, 0.0, 0.5, 1.0, 1.5]);
        assert_eq!(road.length_m(), 1.0);
        assert!((road.height_m(0.0, 1.5) - 0.0111111).abs() < 1e-7);
        assert!((road.height_m(1.0, 1.5) + 0.0111111).abs() < 1e-7);
        assert_eq!(road.height_m(1.0, -1.5), 0.0);
    }

    #[test]
    fn wide_rows_continue_on_the_next_record_and_positions_may_be_uneven() {
        let sections: String = (0..10)
            .map(|i| {
                format!(
                    "D:long section at v = {:.2},m\n",
                    [-2.0, -1.0, -0.5, -0.2, -0.1, 0.0, 0.1, 0.5, 1.0, 3.0][i]
                )
            })
            .collect();
        let header = format!(
            "$ROAD_CRG\nREFERENCE_LINE_INCREMENT=0.5\n$\n$KD_DEFINITION\n#:LRFI\nU:reference line u,m,0,0.5\n\
             D:reference line phi,rad\n{sections}$\n"
        );
        let row = |base: f64| -> String {
            let fields: Vec<String> = (0..11).map(|i| format!("{:10.5}", base + f64::from(i))).collect();
            format!("{}\n{}\n", fields[..8].concat(), fields[8..].concat())
        };
        let road = read(&text(&header, &format!("{}{}", row(0.0), row(100.0))), "wide.crg").unwrap();
        assert_eq!(road.height_m(0.0, -2.0), 1.0, "the first channel is phi, not a height");
        assert_eq!(road.height_m(0.5, 3.0), 110.0);
        assert_eq!(road.height_m(0.25, 0.0), 56.0);
    }

    #[test]
    fn double_text_and_both_binaries_are_read() {
        let header = |format: &str| {
            format!(
                "$ROAD_CRG\nreference_line_start_u = 10\nreference_line_end_u = 10.5\nreference_line_increment = 0.25\n\
                 long_section_v_right = -1\nlong_section_v_left = 1\nlong_section_v_increment = 1\n$\n\
                 $KD_DEFINITION\n#:{format}\nD:long section 1,m\nD:long section 2,m\nD:long section 3,m\n"
            )
        };
        let values = [0.0, 0.25, -0.5, f64::NAN, 1.5, f64::NAN, 2.0, f64::NAN, 4.0];
        let check = |bytes: Vec<u8>| {
            let road = read(&bytes, "b.crg").unwrap();
            assert_eq!((road.rows(), road.spacing_m()), (3, 0.25));
            assert_eq!(road.height_m(0.0, -1.0), 0.0);
            assert_eq!(road.height_m(0.0, 1.0), -0.5);
            assert_eq!(road.height_m(0.25, -1.0), 1.5, "edges hold the outermost height");
            assert_eq!(road.height_m(0.5, 0.0), 3.0, "gaps are bridged");
        };
        let mut real = text(&header("KRBI"), "");
        values.iter().for_each(|v| real.extend((*v as f32).to_be_bytes()));
        real.extend(f32::NAN.to_be_bytes().repeat(11));
        check(real);
        let mut double = text(&header("KDBI"), "");
        values.iter().for_each(|v| double.extend(v.to_be_bytes()));
        check(double);
        let field = |v: &f64| {
            if v.is_nan() {
                format!("{:>20}", "*missing*")
            } else {
                format!("{v:20.12}")
            }
        };
        let rows: String = values
            .chunks(3)
            .map(|row| row.iter().map(field).collect::<String>() + "\r\n")
            .collect();
        check(text(&header("LDFI"), &rows));
    }

    #[test]
    fn bad_files_say_where() {
        let line = |bytes: &[u8], expected: &str| {
            let error = read(bytes, "bad.crg").unwrap_err().to_string();
            assert!(error.contains(expected), "{error} <> {expected}");
            assert!(!error.contains('\n'));
        };
        line(b"", "bad.crg:1: ");
        line(b"$CT\n$\n", "no line of '$$$$'");
        line(&text("", ""), "no $KD_DEFINITION");
        line(
            &text("$KD_DEFINITION\n#:LRFX\nD:long section 1,m\n", ""),
            "bad.crg:5: data format 'LRFX'",
        );
        line(
            &text(&SEVEN.replace("= 1.0", "= one"), ""),
            "bad.crg:5: reference_line_increment",
        );
        line(&text(&SEVEN.replace("= 1.0", "= -1.0"), ""), "reference_line_increment");
        line(
            &text(&format!("$ROAD_CRG_MODS\nSCALE_Z_GRID = 2\n$\n{SEVEN}"), ""),
            "bad.crg:4: $ROAD_CRG_MODS",
        );
        line(
            &text(SEVEN, " 0.0000000 0.0000000\n"),
            "bad.crg:19: ends after 20 characters",
        );
        line(&text(SEVEN, " 0.0 x    \n"), "bad.crg:19: ");
        line(&text(SEVEN, ""), "fewer than two rows");
        line(&text(SEVEN, &" *missing*".repeat(7)), "row 1 has no height");
        let truncated = text(
            &SEVEN
                .replace("LRFI", "KRBI")
                .replace("$ROAD_CRG ", "$ROAD_CRG\nreference_line_end_u = 5\n* "),
            "1234",
        );
        line(&truncated, "4 bytes of data where 6 rows of 7 numbers need 168");
    }

    #[test]
    fn measured_and_military_files_are_read_where_they_are() {
        for (name, length_m, columns) in [
            ("belgian_block", 10.0, 341),
            ("detrended_rms_course_1in", 504.75, 3),
            ("detrended_rms_course_2in", 504.75, 3),
            ("halfround_6in", 100.0, 3),
        ] {
            let path = format!("{}/../../shared/roads/{name}.crg", env!("CARGO_MANIFEST_DIR"));
            let Ok(bytes) = std::fs::read(&path) else {
                println!("SKIPPED: {name}.crg is not beside the checkout");
                continue;
            };
            let road = read(&bytes, name).unwrap();
            assert!((road.length_m() - length_m).abs() < 1e-6, "{name} {}", road.length_m());
            assert_eq!(road.lateral_m().len(), columns);
            let highest = (0..road.rows())
                .map(|i| road.height_m(i as f64 * road.spacing_m(), 0.5))
                .fold(0.0, f64::max);
            if name == "halfround_6in" {
                assert!((highest - 0.1524).abs() < 2e-3, "six inches, here {highest}");
            }
        }
    }
}

#[cfg(test)]
mod properties {
    use proptest::prelude::*;

    proptest! {
        /// Whatever the bytes, the reader answers with a road or one line.
        #[test]
        fn any_bytes_are_answered(bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
            let _ = super::read(&bytes, "any.crg");
        }

        /// Headers that are nearly right are answered too.
        #[test]
        fn damaged_headers_are_answered(cut in 0usize..240, flip in 0usize..240, to in any::<u8>()) {
            let mut bytes = b"$ROAD_CRG\nreference_line_increment = 0.5\nlong_section_v_right = -1\n\
                long_section_v_left = 1\nreference_line_end_u = 1\n$\n$KD_DEFINITION\n#:KRBI\nD:long section 1,m\n\
                D:long section 2,m\n$\n$$$$\n1234567812345678123456781234567812345678".to_vec();
            let flip = flip % bytes.len();
            bytes[flip] = to;
            bytes.truncate(bytes.len() - cut % bytes.len());
            if let Err(error) = super::read(&bytes, "any.crg") {
                prop_assert!(!error.to_string().contains('\n'));
            }
        }
    }
}
