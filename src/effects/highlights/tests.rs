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
fn the_aggressive_cycles_hold_nearly_all_power_of_the_lobe_as_it_is_seen() {
    // The highlight is dark on the far side, where cos^n may not be: one lobe a turn, by its samples. Below
    // an exponent of 5 the lobe's cut-off end has frequencies of its own.
    const SAMPLES: usize = 2048;
    for n in [5u32, 10, 33, 128] {
        let lobe: Vec<f64> = (0..SAMPLES)
            .map(|i| libm::cos(i as f64 / SAMPLES as f64 * std::f64::consts::TAU).max(0.0).powi(n as i32))
            .collect();
        let total = lobe.iter().map(|v| v * v).sum::<f64>() * SAMPLES as f64;
        // The lobe is even: cosines alone.
        let amplitude = |k: usize| -> f64 {
            let turn = |i: usize| (i * k % SAMPLES) as f64 / SAMPLES as f64 * std::f64::consts::TAU;
            lobe.iter().enumerate().map(|(i, v)| v * libm::cos(turn(i))).sum()
        };
        let cycles = Band::Aggressive.cycles(n as f32);
        let power = |k: usize| amplitude(k).powi(2) * if k == 0 { 1.0 } else { 2.0 };
        let kept = (0..=cycles.ceil() as usize).map(power).sum::<f64>() / total;
        assert!(kept > 0.998, "{kept} of the power of {n} lies within {cycles} cycles");
        let fewer = (0..=(0.75 * cycles) as usize).map(power).sum::<f64>() / total;
        assert!(
            n < 10 || fewer < 0.998,
            "{fewer} of the power of {n} lies within three quarters of {cycles}"
        );
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
    // Seen foreshortened: one more cosine.
    let ratio = energy_ratio(60.0, 20.0, 20.0);
    assert!((ratio - 22.0 / 62.0).abs() < 1e-3, "{ratio}");
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
fn energies(highlights: Highlights, radius: f32, exponent: f32, (lean, tilt): (f32, f32)) -> (f32, f32, f32) {
    let halfway = normalized([lean, tilt, 1.0]);
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
fn a_clamped_cylinder_keeps_its_energy_and_flickers_less() {
    for highlights in [Highlights::Clamp, Highlights::Aggressive] {
        let mut worst = 0.0f32;
        for radius in [2.0, 3.0, 4.0, 6.0, 8.0] {
            for exponent in [32.0, 100.0, 128.0] {
                for light in [(0.0, 0.0), (0.25, 0.0), (0.25, 0.1), (0.1, 0.3)] {
                    let (aliased, least, most) = energies(Highlights::AsIs, radius, exponent, light);
                    let (clamped, least_clamped, most_clamped) =
                        energies(highlights, radius, exponent, light);
                    let (energy, flicker) = (clamped / aliased, most_clamped - least_clamped);
                    println!(
                        "{highlights:?} radius {radius} exponent {exponent} light {light:?}: flicker {:.4} -> \
                         {flicker:.4}, energy {energy:.4}",
                        most - least
                    );
                    worst = worst.max((energy - 1.0).abs());
                    assert!(flicker <= (0.2 * (most - least)).max(0.02), "{flicker} was {}", most - least);
                }
            }
        }
        println!("{highlights:?}: energy within {worst:.4}");
        assert!(worst < 0.02, "{highlights:?}: {worst}");
    }
}

/// The share of a cylinder's highlight, across it, whose frequencies are above half a cycle a pixel: what
/// comes back as something else, wherever the pixels fall. The cylinder is moved under them in 16 steps.
fn aliasing_share(highlights: Highlights, radius: f32, exponent: f32) -> f64 {
    const PIXELS: usize = 33;
    const STEPS: usize = 16;
    let halfway = normalized([0.25, 0.0, 1.0]);
    let phong = Phong::new(exponent, highlights);
    let mut profile = vec![0.0; PIXELS * STEPS];
    for step in 0..STEPS {
        let surface = cylinder(radius, 16.0 + (STEPS - 1 - step) as f32 / STEPS as f32, PIXELS);
        for column in 0..PIXELS {
            profile[column * STEPS + step] = f64::from(phong.at(&surface, column, 1, halfway));
        }
    }
    let count = profile.len() as f64;
    let total: f64 = profile.iter().map(|v| v * v).sum::<f64>() * count;
    // Frequency k is k cycles in all of the pixels.
    let power = |k: usize| {
        let turn = |i: usize| (i * k) as f64 / count * std::f64::consts::TAU;
        let part = |f: fn(f64) -> f64| profile.iter().enumerate().map(|(i, v)| v * f(turn(i))).sum::<f64>();
        let (even, odd) = (part(libm::cos), part(libm::sin));
        even * even + odd * odd
    };
    let kept = power(0) + 2.0 * (1..=PIXELS / 2).map(power).sum::<f64>();
    1.0 - kept / total
}

#[test]
fn next_to_no_energy_aliases_of_a_clamped_highlight() {
    println!("| radius | exponent | as-is | clamp | aggressive | supersample |");
    for (radius, exponent) in [(2.0, 128.0), (3.0, 128.0), (4.0, 128.0), (6.0, 128.0), (4.0, 32.0)] {
        let share = |highlights| aliasing_share(highlights, radius, exponent);
        let (as_is, clamp) = (share(Highlights::AsIs), share(Highlights::Clamp));
        let (aggressive, supersample) = (share(Highlights::Aggressive), share(Highlights::Supersample));
        println!(
            "| {radius} | {exponent} | {:.3}% | {:.3}% | {:.3}% | {:.3}% |",
            100.0 * as_is,
            100.0 * clamp,
            100.0 * aggressive,
            100.0 * supersample
        );
        assert!(clamp < 0.005 && aggressive < 0.01 && supersample <= 0.5 * as_is, "{radius}");
        // Pixels that see more of the cylinder than a quarter turn have no limit left to keep.
        assert!(radius < 3.0 || clamp < 0.0005 && aggressive < 0.003, "{clamp} {aggressive}");
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
        assert!((clamped / aliased - 1.0).abs() < 0.02, "{highlights:?}: {clamped} of {aliased}");
        assert!(most_clamped - least_clamped < (most - least) * 0.6);
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
    let (aliased, ..) = energies(Highlights::AsIs, 4.0, 100.0, (0.25, 0.0));
    let (sampled, least, most) = energies(Highlights::Supersample, 4.0, 100.0, (0.25, 0.0));
    println!("supersampled energy {:.4}, flicker {:.4}", sampled / aliased, most - least);
    assert!((sampled / aliased - 1.0).abs() < 0.05 && most - least < 0.05);
}
