//! The built-in Belgian block: a track of any length with the spectrum and left-right coherence of a measured one.
//!
//! The surface measured is `belgian_block.crg` of ASAM OpenCRG (DaimlerChrysler 2005; 10 m x 3.4 m at 1 cm), which is not
//! ours to ship and lasts 0.6 s at 60 km/h. What is shipped is the table below, measured from it with
//! [`super::spectrum`]: Gd averaged over its 308 complete columns, coherence over the 20 pairs of columns 1.49 m apart whose
//! middle lies within 0.1 m of the centre line; one detrended segment of 10 m each, without window for the single lines below
//! 1.05 cycles/m (which keeps the correlation of the tracks), Hann-windowed above (which keeps leakage off the fine end). It has the two
//! families of the paving: the wave at 0.4 to 0.6 cycles/m that the left and right tracks carry in opposite phase
//! (correlation -0.6), and the blocks at 5.5 to 6 cycles/m with their harmonic at 11, nearly independent.
//!
//! What it cannot have: waves longer than the 10 m measured; and the shape of distribution (the real paving's is flatter
//! than Gaussian, kurtosis 1.7, because one wave dominates; random phases give 3).

use super::{EnteredSmoothly, HALF_TRACK_M, Lanes, RoadError, TrackSpectrum, TwoTracks, spectrum::Band, synthesise};
use rustfft::num_complex::Complex;

/// A Belgian-block road of at least `length_m`, entered smoothly from level ground.
///
/// # Errors
/// A length that is not between 1 m and 20 km.
pub fn belgian_block(length_m: f64, seed: u64) -> Result<EnteredSmoothly<Lanes<TwoTracks>>, RoadError> {
    let tracks = Lanes::new(synthesise(length_m, seed, target)?, HALF_TRACK_M);
    Ok(EnteredSmoothly::new(tracks))
}

/// The table as bands: the data of the figure "built-in against measured".
pub fn bands() -> impl Iterator<Item = Band> {
    MEASURED
        .iter()
        .map(|&[low_per_m, high_per_m, psd_m3, real, imaginary]| Band {
            low_per_m,
            high_per_m,
            psd_m3,
            coherence: Complex::new(real, imaginary),
        })
}

/// Spectrum at a spatial frequency, constant within a band, nothing outside the measured range.
fn target(wavenumber_per_m: f64) -> TrackSpectrum {
    let index = MEASURED.partition_point(|band| band[1] <= wavenumber_per_m);
    match MEASURED.get(index) {
        Some(&[low, _, psd_m3, real, imaginary]) if wavenumber_per_m >= low => TrackSpectrum {
            psd_m3,
            coherence: Complex::new(real, imaginary),
        },
        _ => TrackSpectrum {
            psd_m3: 0.0,
            coherence: Complex::default(),
        },
    }
}

/// Lower edge, upper edge (cycles/m), Gd (m3), coherence of right with left (real, imaginary).
const MEASURED: [[f64; 5]; 44] = [
    [0.05, 0.15, 1.108e-4, -0.79, 0.56],
    [0.15, 0.25, 4.711e-4, 0.93, 0.02],
    [0.25, 0.35, 5.240e-4, -0.82, 0.56],
    [0.35, 0.45, 1.494e-3, -0.98, -0.18],
    [0.45, 0.55, 1.504e-3, -0.91, -0.36],
    [0.55, 0.65, 2.600e-4, -0.81, 0.56],
    [0.65, 0.75, 2.027e-4, -0.47, -0.76],
    [0.75, 0.85, 1.191e-4, -0.06, 0.36],
    [0.85, 0.95, 9.068e-5, 0.38, -0.85],
    [0.95, 1.05, 2.828e-5, 0.64, -0.13],
    [1.05, 1.179, 4.114e-5, -0.66, 0.49],
    [1.179, 1.323, 7.874e-5, -0.53, -0.34],
    [1.323, 1.485, 1.285e-4, -0.01, -0.98],
    [1.485, 1.667, 4.245e-5, 0.61, 0.06],
    [1.667, 1.871, 1.004e-5, 0.29, -0.61],
    [1.871, 2.1, 1.128e-5, -0.09, -0.47],
    [2.1, 2.357, 7.368e-6, -0.11, 0.35],
    [2.357, 2.646, 6.448e-6, 0.09, -0.07],
    [2.646, 2.97, 5.312e-6, 0.10, -0.46],
    [2.97, 3.334, 4.654e-6, -0.15, 0.12],
    [3.334, 3.742, 3.405e-6, 0.14, -0.30],
    [3.742, 4.2, 3.750e-6, 0.17, -0.54],
    [4.2, 4.714, 4.104e-6, 0.45, -0.07],
    [4.714, 5.292, 2.525e-6, 0.22, 0.49],
    [5.292, 5.94, 9.428e-6, 0.38, -0.03],
    [5.94, 6.667, 3.107e-6, -0.18, -0.62],
    [6.667, 7.484, 8.139e-7, -0.10, 0.29],
    [7.484, 8.4, 5.831e-7, -0.04, 0.28],
    [8.4, 9.429, 4.756e-7, 0.12, -0.00],
    [9.429, 10.583, 5.713e-7, 0.29, -0.21],
    [10.583, 11.879, 9.783e-7, -0.21, 0.05],
    [11.879, 13.334, 4.158e-7, -0.20, 0.09],
    [13.334, 14.967, 1.747e-7, -0.20, -0.14],
    [14.967, 16.8, 1.646e-7, 0.14, -0.07],
    [16.8, 18.857, 1.455e-7, 0.25, 0.03],
    [18.857, 21.167, 6.527e-8, -0.10, -0.03],
    [21.167, 23.759, 4.119e-8, 0.01, 0.02],
    [23.759, 26.668, 2.542e-8, 0.04, -0.05],
    [26.668, 29.934, 1.325e-8, 0.03, 0.06],
    [29.934, 33.6, 7.689e-9, 0.02, -0.17],
    [33.6, 37.715, 4.421e-9, -0.06, -0.06],
    [37.715, 42.333, 2.873e-9, 0.05, 0.05],
    [42.333, 47.518, 2.099e-9, 0.00, 0.04],
    [47.518, 53.337, 1.901e-9, 0.02, 0.05],
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::road::{
        HALF_TRACK_M, Road, crg,
        spectrum::{SpectrumEstimator, Window, detrended},
    };

    /// Spectrum of a long built-in track against its table.
    #[test]
    fn built_in_track_has_the_table_s_spectrum_and_coherence() {
        let road = synthesise(600.0, 1, target).unwrap();
        let (left, right): (Vec<f64>, Vec<f64>) = road.samples_m().iter().map(|h| (h[0], h[1])).unzip();
        let mut estimator = SpectrumEstimator::new(8192, 0.01);
        estimator.add(&left, &right);
        for band in bands() {
            let made = estimator.band(band.low_per_m, band.high_per_m).unwrap();
            let ratio = made.psd_m3 / band.psd_m3;
            // Few lines in the narrow low bands, leakage of the Hann window from the peaks beside.
            let tolerance = if band.low_per_m < 1.5 { 0.35 } else { 0.2 };
            assert!((ratio - 1.0).abs() < tolerance, "{band:?} {ratio}");
            assert!((made.coherence - band.coherence).norm() < 0.35, "{band:?} {made:?}");
        }
        let deviation = (left.iter().map(|h| h * h).sum::<f64>() / left.len() as f64).sqrt();
        assert!(
            (0.022..0.025).contains(&deviation),
            "README: about 23 mm, here {deviation}"
        );
        let correlation =
            left.iter().zip(&right).map(|(l, r)| l * r).sum::<f64>() / (left.len() as f64 * deviation * deviation);
        assert!(
            (-0.72..-0.38).contains(&correlation),
            "README: -0.62, here {correlation}"
        );
    }

    /// The README's fit: slope -2 from 0.6 to 10 cycles/m with Gd(0.1) = 6.1e-3 m3.
    #[test]
    fn table_agrees_with_the_published_fit() {
        let (mut sum, mut sx, mut sy, mut sxx, mut sxy) = (0.0, 0.0, 0.0, 0.0, 0.0);
        for band in bands().filter(|b| b.low_per_m >= 0.55 && b.high_per_m < 10.6) {
            let weight = band.high_per_m - band.low_per_m;
            let (x, y) = (
                libm::log((band.low_per_m * band.high_per_m).sqrt() / 0.1),
                libm::log(band.psd_m3),
            );
            sum += weight;
            sx += weight * x;
            sy += weight * y;
            sxx += weight * x * x;
            sxy += weight * x * y;
        }
        let slope = (sum * sxy - sx * sy) / (sum * sxx - sx * sx);
        let at_fit = libm::exp((sy + 2.0 * sx) / sum);
        assert!((slope + 2.0).abs() < 0.15, "{slope}");
        assert!((at_fit / 6.1e-3 - 1.0).abs() < 0.15, "{at_fit}");
    }

    /// The table is what this code measures of the file, where the file is at hand.
    #[test]
    fn table_is_the_measured_surface_s() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/roads/belgian_block.crg");
        let Ok(bytes) = std::fs::read(path) else {
            println!("SKIPPED: belgian_block.crg is not beside the checkout; the table was not compared with it");
            return;
        };
        let surface = crg::read(&bytes, "belgian_block.crg").unwrap();
        let column = |lateral: f64| -> Vec<f64> {
            detrended(
                &(0..1001)
                    .map(|i| surface.height_m(f64::from(i) * 0.01, lateral))
                    .collect::<Vec<_>>(),
            )
        };
        for (window, range) in [(Window::Rectangular, 0.0..1.0), (Window::Hann, 1.0..60.0)] {
            let mut density = SpectrumEstimator::with_window(1001, 0.01, window);
            for i in 0..308 {
                let track = column(-1.37 + 0.01 * f64::from(i));
                density.add(&track, &track);
            }
            let mut pairs = SpectrumEstimator::with_window(1001, 0.01, window);
            for i in 0..20 {
                let right = -0.84 + 0.01 * f64::from(i);
                pairs.add(&column(right + 1.49), &column(right));
            }
            for band in bands().filter(|band| range.contains(&band.low_per_m)) {
                let measured = density.band(band.low_per_m, band.high_per_m).unwrap();
                assert!(
                    (measured.psd_m3 / band.psd_m3 - 1.0).abs() < 0.01,
                    "{band:?} {measured:?}"
                );
                let measured = pairs.band(band.low_per_m, band.high_per_m).unwrap();
                assert!(
                    (measured.coherence - band.coherence).norm() < 0.03,
                    "{band:?} {measured:?}"
                );
            }
        }
        let deviation = |track: &[f64]| (track.iter().map(|h| h * h).sum::<f64>() / track.len() as f64).sqrt();
        assert!((deviation(&column(HALF_TRACK_M)) - 0.0238).abs() < 3e-4);
        assert!((deviation(&column(-HALF_TRACK_M)) - 0.0226).abs() < 3e-4);
    }
}
