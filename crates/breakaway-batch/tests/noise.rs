//! The noise of sensors: its moments, and that no draw has to do with another.

use breakaway_batch::draws::noise;

const RUNS: u64 = 400;
const SAMPLES: u64 = 1000;

/// Draws of a sensor of a run, one for each sample.
fn course(run: u64, sensor: usize) -> Vec<f64> {
    (0..SAMPLES).map(|sample| noise(3, &[run], &[sample])[sensor][0]).collect()
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), value| (sum + value, count + 1.0));
    sum / count
}

/// Of 400 000 draws: a mean within 5 deviations 1/√n, a variance within 5 √(1.85 / n), and the
/// fourth moment of eight bytes, 3 − 0.15.
#[test]
fn it_has_mean_0_variance_1_and_the_tails_that_it_says() {
    for sensor in [0, 1] {
        let draws: Vec<f64> = (0..RUNS).flat_map(|run| course(run, sensor)).collect();
        let moment = |power: i32| mean(draws.iter().map(|w| w.powi(power)));
        let n = draws.len() as f64;
        assert!(moment(1).abs() < 5.0 / n.sqrt(), "{}", moment(1));
        assert!((moment(2) - 1.0).abs() < 5.0 * (1.85 / n).sqrt(), "{}", moment(2));
        assert!(moment(3).abs() < 0.03, "{}", moment(3));
        assert!((moment(4) - 2.85).abs() < 0.05, "{}", moment(4));
        assert!(draws.iter().all(|w| w.abs() < 4.88));
    }
}

/// The correlation of independent draws has a deviation of 1/√n.
#[test]
fn it_is_independent_of_time_run_sensor_and_seed() {
    let n = (SAMPLES - 1) as f64;
    let far = |a: &[f64], b: &[f64]| mean(a.iter().zip(b).map(|(a, b)| a * b)).abs() * n.sqrt();
    for run in 0..100 {
        let (position, force) = (course(run, 0), course(run, 1));
        let other = course(run + 1, 0);
        let reseeded: Vec<f64> = (0..SAMPLES).map(|n| noise(4, &[run], &[n])[0][0]).collect();
        assert!(far(&position[1..], &position) < 4.5, "{run}: one sample later");
        assert!(far(&position, &force) < 4.5, "{run}: the other sensor");
        assert!(far(&position, &other) < 4.5, "{run}: the other run");
        assert!(far(&position, &reseeded) < 4.5, "{run}: the other seed");
    }
}

#[test]
fn it_is_a_function_of_seed_run_and_sample() {
    let runs: [u64; 8] = std::array::from_fn(|lane| (1 << 33) + 7 * lane as u64);
    for sample in [0, 1, 1 << 31] {
        let together = noise(u64::MAX, &runs, &[sample; 8]);
        for (lane, &run) in runs.iter().enumerate() {
            let alone = noise(u64::MAX, &[run], &[sample]);
            assert_eq!([together[0][lane], together[1][lane]], [alone[0][0], alone[1][0]]);
        }
    }
}
