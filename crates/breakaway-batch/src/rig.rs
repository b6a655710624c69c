//! What a log of a rig should show: simulated, with exact gradients, or only how far off it is for
//! many sets of numbers at once.

use std::io;
use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread::{self, ScopedJoinHandle};

use breakaway_core::rig::{Drive, Predicted, RIG_NUMBERS, Rig, Row};
use breakaway_core::{Dual, Real};

use crate::instructions::{Instructions, Kernel};
use crate::lanes::Wide;

/// How many numbers all parts of a record share: all but the offset.
const SHARED: usize = RIG_NUMBERS.len() - 1;

/// A log and how a model of its rig is to be run.
#[derive(Clone, Debug)]
pub struct Record {
    /// The rows.
    pub rows: Vec<Row<f64>>,
    /// Rows that are run in one go, each from its first row's measured state.
    pub segments: Vec<Range<usize>>,
    /// What moves the part.
    pub drive: Drive<f64>,
    /// Elasto-plastic friction; else LuGre.
    pub elasto_plastic: bool,
    /// Steps of the integrator from row to row.
    pub steps: u32,
}

/// What a model says of the rows of a record, segment by segment.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Simulated {
    /// x in m.
    pub position_m: Vec<f64>,
    /// F in N.
    pub force_n: Vec<f64>,
}

/// Sums over all rows of the squared differences between model and log.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Misfit {
    /// Of x, m².
    pub position_m2: f64,
    /// Of F, N².
    pub force_n2: f64,
}

/// Numbers of a model of a record: those of [`RIG_NUMBERS`] but the offset, then an offset for each
/// segment.
impl Record {
    /// How many numbers a model of this record has.
    #[must_use]
    pub fn numbers(&self) -> usize {
        SHARED + self.segments.len()
    }

    /// Runs the model, segment by segment, and hands each row to `keep`.
    #[inline(always)]
    fn run<R: Real, K: Keep<R>>(&self, number: &impl Number<R>, keep: &mut K) {
        let drive = self.drive.constant();
        let mut numbers = [R::zero(); SHARED + 1];
        for (i, slot) in numbers.iter_mut().enumerate().take(SHARED) {
            *slot = number.at(i);
        }
        for (s, segment) in self.segments.iter().enumerate() {
            numbers[SHARED] = number.at(SHARED + s);
            let rig = Rig::from_numbers(&numbers, self.elasto_plastic);
            let rows = &self.rows[segment.clone()];
            let mut state = rig.start(&drive, &rows[0].constant());
            for row in rows {
                let predicted = rig.step(&drive, &mut state, &row.constant(), self.steps);
                keep.row(row, predicted);
            }
        }
    }
}

/// The numbers of a model, by place.
trait Number<R> {
    fn at(&self, place: usize) -> R;
}

/// What is done with each row.
trait Keep<R> {
    fn row(&mut self, measured: &Row<f64>, predicted: Predicted<R>);
}

impl Number<f64> for &[f64] {
    #[inline(always)]
    fn at(&self, place: usize) -> f64 {
        self[place]
    }
}

impl Keep<f64> for Simulated {
    #[inline(always)]
    fn row(&mut self, _: &Row<f64>, predicted: Predicted<f64>) {
        self.position_m.push(predicted.position_m);
        self.force_n.push(predicted.force_n);
    }
}

struct Values<'a> {
    record: &'a Record,
    numbers: &'a [f64],
}

impl Kernel for Values<'_> {
    type Output = Simulated;
    #[inline(always)]
    fn run<V: Wide, const N: usize>(self) -> Simulated {
        let mut out = Simulated::default();
        self.record.run(&self.numbers, &mut out);
        out
    }
}

/// Simulates what the log of a record should show.
///
/// # Panics
/// If `numbers` are not [`Record::numbers`], or a segment is empty or beyond the rows.
#[must_use]
pub fn simulate_rig(record: &Record, numbers: &[f64], instructions: Instructions) -> Simulated {
    assert_eq!(numbers.len(), record.numbers());
    instructions.run(Values { record, numbers })
}

struct Seeded<'a> {
    numbers: &'a [f64],
    variable: &'a [Option<usize>],
}

impl<const P: usize> Number<Dual<f64, P>> for Seeded<'_> {
    #[inline(always)]
    fn at(&self, place: usize) -> Dual<f64, P> {
        match self.variable[place] {
            Some(index) => Dual::variable(self.numbers[place], index),
            None => Dual::constant(self.numbers[place]),
        }
    }
}

/// What is kept of a differentiated run: one channel, of every so many-th row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Kept {
    /// The position; else the force.
    pub position: bool,
    /// Rows per row that is kept, above 0.
    pub every: usize,
}

/// A channel and its derivatives.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Differentiated {
    /// x in m, or F in N.
    pub values: Vec<f64>,
    /// The derivatives of each, with respect to all variables side by side.
    pub slopes: Vec<f64>,
}

struct Slopes<const P: usize> {
    kept: Kept,
    variables: usize,
    row: usize,
    out: Differentiated,
}

impl<const P: usize> Keep<Dual<f64, P>> for Slopes<P> {
    #[inline(always)]
    fn row(&mut self, _: &Row<f64>, predicted: Predicted<Dual<f64, P>>) {
        if self.row == 0 {
            let kept = if self.kept.position { predicted.position_m } else { predicted.force_n };
            self.out.values.push(kept.value);
            self.out.slopes.extend_from_slice(&kept.derivative[..self.variables]);
            self.row = self.kept.every;
        }
        self.row -= 1;
    }
}

struct Gradient<'a, const P: usize> {
    record: &'a Record,
    seeded: Seeded<'a>,
    variables: usize,
    kept: Kept,
}

impl<const P: usize> Kernel for Gradient<'_, P> {
    type Output = Differentiated;
    #[inline(always)]
    fn run<V: Wide, const N: usize>(self) -> Differentiated {
        let Self { record, seeded, variables, kept } = self;
        let rows = record.segments.iter().map(Range::len).sum::<usize>().div_ceil(kept.every);
        let out = Differentiated {
            values: Vec::with_capacity(rows),
            slopes: Vec::with_capacity(rows * variables),
        };
        let mut keep = Slopes::<P> { kept, variables, row: 0, out };
        record.run(&seeded, &mut keep);
        keep.out
    }
}

/// Simulates with exact derivatives. `variable` says for each number which variable it is, if any;
/// several numbers may be the same variable, such as levels that are equal in both directions.
///
/// # Panics
/// As [`simulate_rig`]; if `variable` has not one entry for each number; or if there are more than 24
/// variables.
#[must_use]
pub fn differentiate_rig(
    record: &Record,
    numbers: &[f64],
    variable: &[Option<usize>],
    kept: Kept,
    instructions: Instructions,
) -> Differentiated {
    assert_eq!(numbers.len(), record.numbers());
    assert_eq!(variable.len(), numbers.len());
    let variables = variable.iter().flatten().max().map_or(0, |last| last + 1);
    let seeded = Seeded { numbers, variable };
    match variables {
        0..=8 => instructions.run(Gradient::<8> { record, seeded, variables, kept }),
        9..=12 => instructions.run(Gradient::<12> { record, seeded, variables, kept }),
        13..=16 => instructions.run(Gradient::<16> { record, seeded, variables, kept }),
        _ => instructions.run(Gradient::<24> { record, seeded, variables, kept }),
    }
}

/// The numbers of several models, a lane each.
struct Lane<'a> {
    models: &'a [f64],
    numbers: usize,
    count: usize,
}

impl<V: Wide> Number<V> for Lane<'_> {
    #[inline(always)]
    fn at(&self, place: usize) -> V {
        let mut values = [0.0; MOST_LANES];
        for (lane, value) in values.iter_mut().enumerate() {
            // Lanes beyond the last model repeat it.
            *value = self.models[lane.min(self.count - 1) * self.numbers + place];
        }
        V::gather(&values[..V::WIDTH])
    }
}

const MOST_LANES: usize = 32;

struct Squares<V> {
    position: V,
    force: V,
}

impl<V: Real> Keep<V> for Squares<V> {
    #[inline(always)]
    fn row(&mut self, measured: &Row<f64>, predicted: Predicted<V>) {
        let x = predicted.position_m - V::constant(measured.position_m);
        let force = predicted.force_n - V::constant(measured.force_n);
        self.position = x.mul_add(x, self.position);
        self.force = force.mul_add(force, self.force);
    }
}

struct Misfits<'a> {
    record: &'a Record,
    models: &'a [f64],
}

impl Kernel for Misfits<'_> {
    type Output = Vec<Misfit>;
    #[inline(always)]
    fn run<V: Wide, const N: usize>(self) -> Vec<Misfit> {
        let numbers = self.record.numbers();
        let count = self.models.len() / numbers;
        let lane = Lane { models: self.models, numbers, count };
        let mut sums = Squares { position: V::zero(), force: V::zero() };
        self.record.run(&lane, &mut sums);
        (0..count)
            .map(|i| Misfit {
                position_m2: sums.position.extract(i),
                force_n2: sums.force.extract(i),
            })
            .collect()
    }
}

/// How far each of many models is off, in lanes and on `threads` threads. `models` holds the numbers
/// of one model after the other. A model's misfit does not depend on the others, or on threads.
///
/// # Errors
/// What kept a thread from being started.
///
/// # Panics
/// If `models` is not a whole number of models.
pub fn rig_misfits(
    record: &Record,
    models: &[f64],
    threads: usize,
    instructions: Instructions,
) -> io::Result<Vec<Misfit>> {
    let numbers = record.numbers();
    assert_eq!(models.len() % numbers, 0);
    let packs: Vec<&[f64]> = models.chunks(numbers * instructions.lanes()).collect();
    let next = AtomicUsize::new(0);
    let work = || {
        let mut done = Vec::new();
        while let Some((i, pack)) = take(&packs, &next) {
            done.push((i, instructions.run(Misfits { record, models: pack })));
        }
        done
    };
    let mut done: Vec<_> = thread::scope(|scope| {
        let start = |_| thread::Builder::new().spawn_scoped(scope, work);
        let workers = (0..threads.min(packs.len())).map(start).collect::<io::Result<Vec<_>>>()?;
        let join = |worker: ScopedJoinHandle<_>| worker.join().expect("no panics");
        io::Result::Ok(workers.into_iter().flat_map(join).collect())
    })?;
    done.sort_by_key(|&(i, _)| i);
    Ok(done.into_iter().flat_map(|(_, misfits)| misfits).collect())
}

fn take<'a>(packs: &[&'a [f64]], next: &AtomicUsize) -> Option<(usize, &'a [f64])> {
    let i = next.fetch_add(1, Ordering::Relaxed);
    packs.get(i).map(|pack| (i, *pack))
}
