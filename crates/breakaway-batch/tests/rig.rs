//! A rig run plainly, with slopes and in lanes: the same bits each way.

use breakaway_batch::{
    Instructions, Kept, Misfit, Record, Simulated, differentiate_rig, rig_misfits, simulate_rig,
};
use breakaway_core::Maybe;
use breakaway_core::control::{AntiWindup, Cascade, DerivativeOf, Gains, Pid, VelocityFrom};
use breakaway_core::rig::{Drive, LimitedPid, RIG_NUMBERS, Rig, Row};

/// All numbers of a rig but the offset.
const SHARED: [f64; 15] =
    [5.0, 50.0, 20.0, 30.0, 40.0, 60.0, 1.3, 0.01, 1e6, 300.0, 100.0, 0.6, 2.0, -0.2, 3e-5];

const DRIVES: [Drive<f64>; 4] = [
    Drive::Imposed,
    Drive::Force,
    Drive::Cascade(Cascade {
        position_gain_per_s: 20.0,
        velocity_gain_n_s_per_m: 500.0,
        force_limit_n: 100.0,
    }),
    Drive::Pid(LimitedPid {
        pid: Pid {
            gains: Gains { kp_n_per_m: 40_000.0, ki_n_per_m_s: 2e5, kd_n_s_per_m: 400.0 },
            derivative_of: DerivativeOf::Error,
            velocity_from: VelocityFrom::PositionDifference,
            derivative_filter_s: Maybe::some(2e-3),
            anti_windup: AntiWindup::BackCalculation,
            tracking_time_s: 0.05,
        },
        force_limit_n: 100.0,
    }),
];

/// A log to and fro, its measured forces and positions a little off any model's.
fn record(drive: Drive<f64>, elasto_plastic: bool, segments: usize) -> Record {
    let (speed, omega, period) = (0.05, 4.0 * std::f64::consts::PI, 2e-3);
    let x = |t: f64| {
        let c = (omega * t).cos();
        speed / omega * (2.0 / 3.0 - c + c.powi(3) / 3.0) // of v = speed sin³
    };
    let row = |n| {
        let t = period * f64::from(n);
        let (s, c) = (omega * t).sin_cos();
        Row {
            position_m: x(t) + 1e-6 * (137.0 * t).sin(),
            velocity_m_per_s: speed * s.powi(3),
            acceleration_m_per_s2: 3.0 * speed * omega * s * s * c,
            force_n: 4.0 + 45.0 * s + (321.0 * t).sin(),
            reference_m: 0.005 * (1.0 - c),
            reference_rate_m_per_s: 0.005 * omega * s,
            period_s: period,
            mean_velocity_m_per_s: (x(t + period) - x(t)) / period,
            held_force_n: -2.0 + 60.0 * s.powi(3),
            outside_force_n: 3.0 * c,
            time_s: t - 0.3,
        }
    };
    // Three rows between segments belong to none.
    let length = 300 / segments;
    let segments = (0..segments).map(|s| s * length..(s + 1) * length - 3).collect();
    Record { rows: (0..300).map(row).collect(), segments, drive, elasto_plastic, steps: 3 }
}

fn records() -> impl Iterator<Item = Record> {
    DRIVES
        .into_iter()
        .flat_map(|d| [false, true].map(|elasto_plastic| record(d, elasto_plastic, 3)))
}

/// Numbers of model `i` of a record; those of model 0 are the nominal ones.
fn model(record: &Record, i: usize) -> Vec<f64> {
    let varied = |place: usize| 1.0 + 0.2 * ((i * (place + 1)) as f64).sin();
    let nominal = |place: usize| match SHARED.get(place) {
        Some(number) => *number,
        None => 4.0 - (place - SHARED.len()) as f64,
    };
    (0..record.numbers()).map(|place| nominal(place) * varied(place)).collect()
}

fn models(record: &Record, count: usize) -> Vec<f64> {
    (0..count).flat_map(|i| model(record, i)).collect()
}

/// Segment by segment with the step itself.
fn plainly(record: &Record, numbers: &[f64]) -> Simulated {
    let mut out = Simulated::default();
    for (segment, offset) in record.segments.iter().zip(&numbers[SHARED.len()..]) {
        let rig: [f64; 16] = std::array::from_fn(|i| if i < 15 { numbers[i] } else { *offset });
        let rig = Rig::from_numbers(&rig, record.elasto_plastic);
        let rows = &record.rows[segment.clone()];
        let mut state = rig.start(&record.drive, &rows[0]);
        for row in rows {
            let predicted = rig.step(&record.drive, &mut state, row, record.steps);
            out.position_m.push(predicted.position_m);
            out.force_n.push(predicted.force_n);
        }
    }
    out
}

fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|value| value.to_bits()).collect()
}

fn assert_same_values(ours: &Simulated, theirs: &Simulated) {
    assert!(theirs.position_m.iter().chain(&theirs.force_n).all(|value| value.is_finite()));
    assert_eq!(bits(&ours.position_m), bits(&theirs.position_m));
    assert_eq!(bits(&ours.force_n), bits(&theirs.force_n));
}

/// Every number a variable of its own.
fn all(record: &Record) -> Vec<Option<usize>> {
    (0..record.numbers()).map(Some).collect()
}

/// The slopes of variable `index` of `count`, of x and then F.
fn slopes(of: &Both, index: usize, count: usize) -> Vec<f64> {
    let column =
        |slopes: &[f64]| -> Vec<f64> { slopes[index..].iter().copied().step_by(count).collect() };
    [column(&of.position_slopes), column(&of.force_slopes)].concat()
}

#[test]
fn a_simulation_has_the_bits_of_the_step_on_all_instructions() {
    for record in records() {
        for numbers in [model(&record, 0), model(&record, 1)] {
            let expected = plainly(&record, &numbers);
            assert_eq!(expected.position_m.len(), 3 * 97);
            for instructions in Instructions::available() {
                assert_same_values(&simulate_rig(&record, &numbers, instructions), &expected);
            }
        }
    }
}

/// Both channels of all rows, and their derivatives.
struct Both {
    values: Simulated,
    position_slopes: Vec<f64>,
    force_slopes: Vec<f64>,
}

fn differentiated(
    record: &Record,
    numbers: &[f64],
    variable: &[Option<usize>],
    on: Instructions,
) -> Both {
    let one =
        |position| differentiate_rig(record, numbers, variable, Kept { position, every: 1 }, on);
    let (x, force) = (one(true), one(false));
    Both {
        values: Simulated { position_m: x.values, force_n: force.values },
        position_slopes: x.slopes,
        force_slopes: force.slopes,
    }
}

#[test]
fn every_so_many_th_row_is_kept() {
    let on = Instructions::fastest();
    for record in records() {
        let numbers = model(&record, 0);
        let count = record.numbers();
        let kept = |every| {
            let kept = Kept { position: false, every };
            differentiate_rig(&record, &numbers, &all(&record), kept, on)
        };
        let (whole, thin) = (kept(1), kept(7));
        assert_eq!(thin.values.len(), (3 * 97_usize).div_ceil(7));
        for (row, value) in thin.values.iter().enumerate() {
            assert_eq!(value.to_bits(), whole.values[7 * row].to_bits());
            let (thin, whole) = (&thin.slopes[row * count..], &whole.slopes[7 * row * count..]);
            assert_eq!(bits(&thin[..count]), bits(&whole[..count]));
        }
    }
}

#[test]
fn with_slopes_the_values_keep_their_bits_on_all_instructions() {
    for record in records() {
        let numbers = model(&record, 0);
        let differentiate = |on| differentiated(&record, &numbers, &all(&record), on);
        let expected = differentiate(Instructions::fastest());
        assert_eq!(expected.position_slopes.len(), 3 * 97 * record.numbers());
        for instructions in Instructions::available() {
            let ours = differentiate(instructions);
            assert_same_values(&ours.values, &simulate_rig(&record, &numbers, instructions));
            assert_eq!(bits(&ours.position_slopes), bits(&expected.position_slopes));
            assert_eq!(bits(&ours.force_slopes), bits(&expected.force_slopes));
        }
    }
}

#[test]
fn slopes_are_those_of_differences() {
    let on = Instructions::fastest();
    for record in records() {
        let numbers = model(&record, 0);
        let exact = differentiated(&record, &numbers, &all(&record), on);
        for place in 0..record.numbers() {
            let h = 1e-6 * numbers[place]; // few rows change their direction within it
            let moved = |by| {
                let mut numbers = numbers.clone();
                numbers[place] += by;
                simulate_rig(&record, &numbers, on)
            };
            let (above, below) = (moved(h), moved(-h));
            let values = |s: &Simulated| [s.position_m.clone(), s.force_n.clone()].concat();
            let (above, below) = (values(&above), values(&below));
            let exact = slopes(&exact, place, record.numbers());
            let rows = exact.len() / 2;
            for part in [0..rows, rows..2 * rows] {
                let size = exact[part.clone()].iter().fold(0.0, |s: f64, e| s.max(e.abs()));
                for row in part {
                    let error = exact[row] - (above[row] - below[row]) / (2.0 * h);
                    assert!(error.abs() <= 1e-5 * size, "{place}, {row}: {error:e} of {size:e}");
                }
            }
        }
    }
}

/// What moves the rig is known when its motion is imposed: an offset is all in the force.
#[test]
fn an_offset_belongs_to_its_segment() {
    let on = Instructions::fastest();
    for record in records() {
        let numbers = model(&record, 0);
        let run = differentiated(&record, &numbers, &all(&record), on);
        for segment in 0..3 {
            let slopes = slopes(&run, SHARED.len() + segment, record.numbers());
            for (n, slope) in slopes.into_iter().enumerate() {
                let (within, of_force) = (n / 97 % 3 == segment, n >= 3 * 97);
                assert!(within || slope == 0.0, "{n}: {slope}");
                if record.drive == Drive::Imposed {
                    // Where it starts, the balance leaves to the bristle what the offset takes.
                    let expected = f64::from(u8::from(within && of_force));
                    let settled = n % 97 > 60;
                    assert!(!settled || (slope - expected).abs() < 1e-9, "{n}: {slope}");
                }
            }
        }
    }
}

#[test]
fn tied_numbers_have_the_sum_of_their_slopes() {
    let on = Instructions::fastest();
    let places = |name: &str| RIG_NUMBERS.iter().position(|known| known.starts_with(name));
    for record in records() {
        let numbers = model(&record, 0);
        let mut tied = vec![None; record.numbers()];
        let coulomb = places("coulomb_positive").expect("a number");
        let viscous = places("viscous_positive").expect("a number");
        (tied[coulomb], tied[coulomb + 1]) = (Some(1), Some(1));
        (tied[viscous], tied[viscous + 1]) = (Some(0), Some(0));
        let ours = differentiated(&record, &numbers, &tied, on);
        let apart = differentiated(&record, &numbers, &all(&record), on);
        assert_same_values(&ours.values, &apart.values);
        for (variable, place) in [(1, coulomb), (0, viscous)] {
            let ours = slopes(&ours, variable, 2);
            let parts = [0, 1].map(|i| slopes(&apart, place + i, record.numbers()));
            let size = parts.iter().flatten().fold(0.0, |size: f64, part| size.max(part.abs()));
            for (i, ours) in ours.into_iter().enumerate() {
                let error = ours - (parts[0][i] + parts[1][i]);
                assert!(error.abs() < 1e-12 * size, "{error:e}");
            }
        }
    }
}

/// One at a time, nine, and as many as a record of nine segments has: 24.
#[test]
fn a_slope_does_not_depend_on_how_many_there_are() {
    let on = Instructions::fastest();
    for drive in DRIVES {
        let record = record(drive, true, 9);
        let numbers = model(&record, 0);
        let all = differentiated(&record, &numbers, &all(&record), on);
        let nine: Vec<_> = (0..24).map(|place: usize| (place < 9).then(|| 8 - place)).collect();
        let nine = differentiated(&record, &numbers, &nine, on);
        for place in 0..24 {
            let alone: Vec<_> = (0..24).map(|other| (other == place).then_some(0)).collect();
            let alone = slopes(&differentiated(&record, &numbers, &alone, on), 0, 1);
            assert_eq!(bits(&slopes(&all, place, 24)), bits(&alone), "{place}");
            if place < 9 {
                assert_eq!(bits(&slopes(&nine, 8 - place, 9)), bits(&alone), "{place}");
            }
        }
        let none = differentiated(&record, &numbers, &[None; 24], on);
        assert_eq!(none.values, simulate_rig(&record, &numbers, on));
    }
}

/// Squares summed row by row.
fn misfit(record: &Record, numbers: &[f64]) -> Misfit {
    let simulated = plainly(record, numbers);
    let rows = record.segments.iter().flat_map(|segment| &record.rows[segment.clone()]);
    let predicted = simulated.position_m.iter().zip(&simulated.force_n);
    let add = |sum: Misfit, (row, (x, force)): (&Row<f64>, (&f64, &f64))| {
        let (x, force) = (x - row.position_m, force - row.force_n);
        Misfit {
            position_m2: x.mul_add(x, sum.position_m2),
            force_n2: force.mul_add(force, sum.force_n2),
        }
    };
    rows.zip(predicted).fold(Misfit::default(), add)
}

fn misfit_bits(misfits: &[Misfit]) -> Vec<[u64; 2]> {
    misfits.iter().map(|m| [m.position_m2.to_bits(), m.force_n2.to_bits()]).collect()
}

#[test]
fn misfits_are_the_sums_of_their_simulations_whoever_runs_beside() {
    for record in records() {
        let alone: Vec<_> = (0..70).map(|i| misfit(&record, &model(&record, i))).collect();
        assert!(alone.iter().all(|m| m.force_n2.is_finite() && m.force_n2 > 1.0), "{alone:?}");
        for instructions in Instructions::available() {
            for count in [0, 1, 31, 32, 33, 70] {
                let ours = misfits_of(&record, &models(&record, count), 2, instructions);
                assert_eq!(misfit_bits(&ours), misfit_bits(&alone[..count]), "{count}");
            }
            let backwards: Vec<_> = (0..70).rev().flat_map(|i| model(&record, i)).collect();
            let mut ours = misfits_of(&record, &backwards, 2, instructions);
            ours.reverse();
            assert_eq!(misfit_bits(&ours), misfit_bits(&alone));
        }
    }
}

fn misfits_of(
    record: &Record,
    models: &[f64],
    threads: usize,
    instructions: Instructions,
) -> Vec<Misfit> {
    rig_misfits(record, models, threads, instructions).expect("a few threads start")
}

#[test]
fn misfits_do_not_depend_on_threads() {
    for record in records() {
        let models = models(&record, 70);
        for instructions in Instructions::available() {
            let one = misfit_bits(&misfits_of(&record, &models, 1, instructions));
            for threads in 2..=5 {
                let ours = misfits_of(&record, &models, threads, instructions);
                assert_eq!(misfit_bits(&ours), one, "{threads}");
            }
        }
    }
}

#[test]
fn nonsense_in_a_model_stays_in_its_lane() {
    let nonsense = [(8, -1e6), (0, 0.0), (2, f64::NAN), (7, 0.0), (0, -5.0), (9, f64::INFINITY)];
    for record in records() {
        let sound = models(&record, 33);
        let mut models = sound.clone();
        for (i, (place, number)) in nonsense.into_iter().enumerate() {
            models[(5 * i + 1) * record.numbers() + place] = number;
        }
        for instructions in Instructions::available() {
            let ours = misfit_bits(&misfits_of(&record, &models, 2, instructions));
            let theirs = misfit_bits(&misfits_of(&record, &sound, 2, instructions));
            for (i, (ours, theirs)) in ours.iter().zip(&theirs).enumerate() {
                let disturbed = i % 5 == 1 && i / 5 < nonsense.len();
                assert_eq!(ours != theirs, disturbed, "{i}, {:?}", record.drive);
            }
        }
    }
}
