//! What exported code has to give: the core's own step in the same numbers.

use breakaway_batch::HeldDraws;
use breakaway_batch::draws::{field_keys, noise};
use breakaway_core::period::Nobody;
use breakaway_core::sensor::Noise;
use breakaway_core::{Draws, Extraction, ExtractionState};

use crate::c::Precision;
use crate::model::{self, What};
use crate::passes::Scalar;

/// Seed and number of a run: what random draws depend on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Seeded {
    /// Seed of all draws.
    pub seed: u64,
    /// Number of the run.
    pub run: u64,
}

/// The outputs of [`What::outputs`] of consecutive steps from rest, one row for each row of
/// [`What::inputs`]; inputs that a loop or a controller does not have are ignored. A plant gives one
/// row more, the first: what it shows before the first step.
///
/// # Example
/// ```
/// use breakaway_core::test_models::paper_as_computed;
/// use breakaway_export::{What, c::Precision, reference::{Seeded, reference}};
/// let (draws, still) = (Seeded { seed: 0, run: 0 }, [[0.0; 3]; 2]);
/// let rows = reference(What::Controller, Precision::Double, &paper_as_computed(), draws, &still);
/// assert_eq!(rows[0][0], 0.0); // at the seat there is nothing to push for
/// assert!(rows[1][0] > 0.0);
/// ```
#[must_use]
pub fn reference(
    what: What,
    precision: Precision,
    extraction: &Extraction<f64>,
    draws: Seeded,
    inputs: &[[f64; 3]],
) -> Vec<Vec<f64>> {
    match precision {
        Precision::Single => Rig::<f32>::new(extraction, draws).run(what, inputs),
        Precision::Double => Rig::<f64>::new(extraction, draws).run(what, inputs),
    }
}

struct Rig<R> {
    extraction: Extraction<R>,
    state: ExtractionState<R>,
    draws: Seeded,
    held: HeldDraws<1>,
}

impl<R: Scalar> Rig<R> {
    fn new(extraction: &Extraction<f64>, draws: Seeded) -> Self {
        let mut extraction = *extraction;
        if let Some(field) = &mut extraction.variation.field {
            field.keys = field_keys(draws.seed, draws.run);
        }
        let extraction = extraction.map(&mut |_, value| R::constant(value));
        // Draws are made in double precision, from the numbers as they are in `R`.
        let disturbance = extraction.disturbance.map(&mut |_, value: R| value.into());
        let period_s: f64 = extraction.timing.control_period_s.into();
        let held = HeldDraws::new(draws.seed, [draws.run], |_| disturbance, |_| period_s);
        Self { extraction, state: ExtractionState::at_rest(), draws, held }
    }

    fn run(mut self, what: What, inputs: &[[f64; 3]]) -> Vec<Vec<f64>> {
        let mut rows = Vec::with_capacity(inputs.len() + 1);
        if what == What::Plant {
            let shown = self.show(0);
            rows.push([&shown[..], &[R::zero(); 2]].concat());
        }
        for (n, row) in (0..).zip(inputs) {
            let row = row.map(R::constant);
            rows.push(match what {
                What::Controller => model::control(&self.extraction, &mut self.state, row).to_vec(),
                What::Plant => self.plant(n, row),
                What::Loop => self.looped(n),
            });
        }
        let exact = |row: Vec<R>| row.into_iter().map(Into::into).collect();
        rows.into_iter().map(exact).collect()
    }

    fn draw(&mut self, sample: u64) -> R {
        self.held.redraw_after(sample);
        R::constant(self.held.held()[0])
    }

    fn noise(&self, sample: u64) -> Noise<R> {
        let [[position], [force]] = noise(self.draws.seed, &[self.draws.run], &[sample]);
        Noise { position: R::constant(position), force: R::constant(force) }
    }

    fn show(&mut self, sample: u64) -> [R; 6] {
        let noise = self.noise(sample);
        model::show(&self.extraction, &mut self.state, &noise)
    }

    fn plant(&mut self, sample: u64, commanded: [R; 3]) -> Vec<R> {
        let draw = self.draw(sample);
        let state = &mut self.state;
        let (command, factors, time_s) = model::begin(&self.extraction, state, commanded, draw);
        let zero = R::zero();
        let period =
            self.extraction.move_plant(state, &command, &factors, time_s, zero, &mut Nobody);
        let forces = model::end(state, &period);
        [&self.show(sample + 1)[..], &forces].concat()
    }

    fn looped(&mut self, sample: u64) -> Vec<R> {
        let draws = Draws { disturbance: self.draw(sample), noise: self.noise(sample) };
        // A sample does not tell the whole command: it is decided once more, on a copy.
        let (command, ..) = model::begin_loop(&self.extraction, &mut self.state.clone(), draws);
        let sample = self.extraction.step(&mut self.state, draws);
        let plant = &self.state.plant;
        let moved = [
            plant.position_m,
            plant.velocity_m_per_s,
            plant.bristle_m,
            sample.applied_force_n,
            sample.joint_force_n,
        ];
        let decided =
            [command.force_n, command.feed_m_per_s, command.stack_share, sample.stop_reason];
        [&[sample.reference_m][..], &decided, &moved].concat()
    }
}
