//! Highlights on cylinders and cones, as Amanatides has them: energy kept, flicker gone.

use super::*;

#[test]
fn the_conservative_table_is_half_a_cycle_and_the_aggressive_one_lies_below() {
    for exponent in 1..=128 {
        let exponent = exponent as f32;
        let dot = Band::Conservative.smallest_dot(exponent);
        assert!((dot - libm::cosf(std::f32::consts::PI / exponent)).abs() < 1e-6);
        assert!(Band::Aggressive.smallest_dot(exponent) <= dot + 1e-6);
        assert!((Band::Conservative.sampling_rate(exponent, dot) - 1.0).abs() < 0.01);
    }
}

#[test]
fn the_aggressive_cycles_follow_the_binomial_distribution() {
    // Coefficients are near exp(-j^2 / 2n), their squares a Gaussian of deviation sqrt(n / 2), of
    // which 99.9% lie within 3.29 deviations.
    for n in [32, 64, 128] {
        let wanted = 3.29 * (n as f32 / 2.0).sqrt();
        let cycles = Band::Aggressive.cycles(n as f32);
        assert!((cycles - wanted).abs() < 2.0, "{n}: {cycles}, not {wanted}");
    }
}

#[test]
fn what_is_clamped_is_sampled_enough() {
    for band in [Band::Conservative, Band::Aggressive] {
        for radians in [0.02, 0.1, 0.3, 0.9, 2.0] {
            let clamped = band.clamped(100.0, radians);
            assert!((1.0..=100.0).contains(&clamped));
            let enough = band.sampling_rate(clamped, libm::cosf(radians)) <= 1.001;
            assert!(enough || clamped == 1.0, "{band:?} at {radians}: {clamped}");
        }
        assert_eq!(band.clamped(50.0, 0.0), 50.0);
    }
}

#[test]
fn energies_are_those_of_the_sphere() {
    // The integral of cos^n over a hemisphere is 2 pi / (n + 1).
    for n in [1.0f32, 2.0, 7.5, 40.0, 127.0] {
        let product = energy(n) * energy(n + 1.0) * (n + 1.0) / (2.0 * std::f32::consts::PI);
        assert!((product - 1.0).abs() < 2e-3, "{n}: {product}");
    }
    let ratio = energy_ratio(60.0, 20.0, 20.0);
    assert!((ratio - 21.0 / 61.0).abs() < 1e-3, "{ratio}");
}

/// A cylinder of this radius in pixels along y, its axis at `middle`.
fn cylinder(radius: f32, middle: f32, width: usize) -> Surface {
    let lean = |column: usize| {
        let sine = (column as f32 + 0.5 - middle) / radius;
        // Beside it, flat ground turned away.
        if sine.abs() < 0.98 {
            [sine / (1.0 - sine * sine).sqrt(), 0.0]
        } else {
            [5.0 * sine.signum(), 0.0]
        }
    };
    Surface::leaning(width, (0..3 * width).map(|i| lean(i % width)).collect())
}

/// The middle row's energy over all places of a cylinder's axis within a pixel: mean, and least and
/// greatest as shares of it.
fn energies(highlights: Highlights, radius: f32, exponent: f32, tilt: f32) -> (f32, f32, f32) {
    let halfway = normalized([0.25, tilt, 1.0]);
    let phong = Phong::new(exponent, highlights);
    let sums: Vec<f32> = (0..16)
        .map(|phase| {
            let surface = cylinder(radius, 16.0 + phase as f32 / 16.0, 33);
            (0..33).map(|column| phong.at(&surface, column, 1, halfway)).sum()
        })
        .collect();
    let mean = sums.iter().sum::<f32>() / 16.0;
    let bound = |choose: fn(f32, f32) -> f32| sums.iter().fold(sums[0], |a, &b| choose(a, b)) / mean;
    (mean, bound(f32::min), bound(f32::max))
}

#[test]
fn a_clamped_cylinder_keeps_its_energy_and_does_not_flicker() {
    for (radius, exponent) in [(4.0, 100.0), (6.0, 128.0), (8.0, 100.0)] {
        for tilt in [0.0, 0.1] {
            let (aliased, least, most) = energies(Highlights::AsIs, radius, exponent, tilt);
            let (clamped, least_clamped, most_clamped) = energies(Highlights::Clamp, radius, exponent, tilt);
            println!(
                "radius {radius} exponent {exponent} tilt {tilt}: flicker {:.3} -> {:.4}, energy {:.4}",
                most - least,
                most_clamped - least_clamped,
                clamped / aliased
            );
            assert!((clamped / aliased - 1.0).abs() < 0.02, "{clamped} of {aliased}");
            assert!(most_clamped - least_clamped <= most - least + 0.005);
            assert!(most_clamped - least_clamped < 0.02);
        }
    }
}

/// A cone's energy over all places of its apex within a pixel, as in [`energies`].
fn cone_energies(highlights: Highlights, exponent: f32) -> (f32, f32, f32) {
    const SIDE: usize = 61;
    let halfway = normalized([0.5, 0.2, 1.0]);
    let phong = Phong::new(exponent, highlights);
    let sums: Vec<f32> = (0..64)
        .map(|phase| {
            let apex = [30.0 + (phase % 8) as f32 / 8.0, 30.0 + (phase / 8) as f32 / 8.0];
            let lean = |i: usize| {
                let (x, y) = ((i % SIDE) as f32 + 0.5 - apex[0], (i / SIDE) as f32 + 0.5 - apex[1]);
                let radius = (x * x + y * y).sqrt().max(1e-3);
                [0.5 * x / radius, 0.5 * y / radius]
            };
            let surface = Surface::leaning(SIDE, (0..SIDE * SIDE).map(lean).collect());
            // A soft window around the apex, so that the borders do not count.
            let weight = |i: usize| {
                let (x, y) = ((i % SIDE) as f32 + 0.5 - apex[0], (i / SIDE) as f32 + 0.5 - apex[1]);
                libm::expf(-(x * x + y * y) / 200.0)
            };
            (0..SIDE * SIDE).map(|i| weight(i) * phong.at(&surface, i % SIDE, i / SIDE, halfway)).sum()
        })
        .collect();
    let mean = sums.iter().sum::<f32>() / sums.len() as f32;
    let bound = |choose: fn(f32, f32) -> f32| sums.iter().fold(sums[0], |a, &b| choose(a, b)) / mean;
    (mean, bound(f32::min), bound(f32::max))
}

#[test]
fn a_clamped_cone_keeps_its_energy_and_flickers_less() {
    let (aliased, least, most) = cone_energies(Highlights::AsIs, 128.0);
    for highlights in [Highlights::Clamp, Highlights::Aggressive, Highlights::Supersample] {
        let (clamped, least_clamped, most_clamped) = cone_energies(highlights, 128.0);
        println!(
            "cone {highlights:?}: flicker {:.4} -> {:.4}, energy {:.4}",
            most - least,
            most_clamped - least_clamped,
            clamped / aliased
        );
        assert!((clamped / aliased - 1.0).abs() < 0.025, "{highlights:?}: {clamped} of {aliased}");
        assert!(most_clamped - least_clamped < (most - least) * 0.6);
    }
}

#[test]
fn the_aggressive_clamp_still_quiets_a_thin_cylinder() {
    for (radius, exponent) in [(2.0, 128.0), (3.0, 128.0), (4.0, 100.0)] {
        let (aliased, least, most) = energies(Highlights::AsIs, radius, exponent, 0.0);
        let (clamped, least_clamped, most_clamped) = energies(Highlights::Aggressive, radius, exponent, 0.0);
        println!(
            "aggressive radius {radius} exponent {exponent}: flicker {:.4} -> {:.4}, energy {:.4}",
            most - least,
            most_clamped - least_clamped,
            clamped / aliased
        );
        assert!((most_clamped - least_clamped) < (most - least) * 0.12);
        assert!((clamped / aliased - 1.0).abs() < 0.05);
    }
}

#[test]
fn where_nothing_aliases_no_bit_changes() {
    let halfway = normalized([0.25, 0.1, 1.0]);
    let surface = cylinder(400.0, 16.0, 33);
    let bits = |highlights| -> Vec<u32> {
        let phong = Phong::new(30.0, highlights);
        (0..33).map(|column| phong.at(&surface, column, 1, halfway).to_bits()).collect()
    };
    for highlights in [Highlights::Clamp, Highlights::Aggressive, Highlights::Supersample] {
        assert_eq!(bits(highlights), bits(Highlights::AsIs));
    }
}

#[test]
fn the_aggressive_clamp_leaves_more_alone() {
    let dot = libm::cosf(0.08);
    assert!(dot < Band::Conservative.smallest_dot(100.0));
    assert!(dot > Band::Aggressive.smallest_dot(100.0));
}

#[test]
fn supersampling_comes_near_the_true_energy() {
    let (aliased, ..) = energies(Highlights::AsIs, 4.0, 100.0, 0.0);
    let (sampled, least, most) = energies(Highlights::Supersample, 4.0, 100.0, 0.0);
    println!("supersampled energy {:.4}, flicker {:.4}", sampled / aliased, most - least);
    assert!((sampled / aliased - 1.0).abs() < 0.05 && most - least < 0.05);
}
