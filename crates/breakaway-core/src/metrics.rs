//! What a run reports, reduced sample by sample; what happens at an instant, step by step.

use crate::actuator::Effort;
use crate::disturbance::Draws;
use crate::extraction::{Extraction, ExtractionState, Sample};
use crate::parameters::parameters;
use crate::period::{Stretch, Witness};
use crate::real::Real;

parameters! {
    /// Where a run counts as diverged, released, loose, or too rough.
    pub struct Limits {
        /// |e| in m above which the run has diverged: l_f / 2.
        pub diverged_error_m,
        /// |F| in N above which the run has diverged: 20 F_s0.
        pub diverged_force_n,
        /// x in m at which the part counts as free: l_f less a tolerance, since a reference that
        /// ends at l_f is approached from below.
        pub release_position_m,
        /// The run ends this long after the release, s; infinite where it goes on.
        pub after_release_s,
        /// Travel in m at which the joint counts as loose: twice the presliding travel F_s0 / k_e.
        pub breakaway_travel_m,
        /// F in N above which the actuator counts as pushing.
        pub contact_force_n,
        /// Largest |F| in N that is allowed.
        pub peak_force_max_n,
        /// Largest jump in m that is allowed.
        pub jump_max_m,
        /// Largest velocity at release in m/s that is allowed.
        pub release_velocity_max_m_per_s,
    }
}

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// The part is free and no limit was exceeded.
    Released,
    /// Time ran out.
    NotReleased,
    /// |e| or |F| passed its bound, or was not a number.
    Diverged,
    /// The part is free or time ran out, and a limit was exceeded.
    LimitExceeded,
}

/// Which metrics are counted. Each group is independent of the others; what is not counted stays as
/// it was at the start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Groups {
    /// `simulated_s`.
    pub time: bool,
    /// `iae_m_s`.
    pub iae: bool,
    /// `ise_m2_s`, `itae_m_s2`.
    pub error: bool,
    /// `largest_error_m`, `peak_force_n`.
    pub extremes: bool,
    /// `impulse_n_s`, `force_square_n2_s`, `work_j`, `joint_work_j`, `saturation_time_s`.
    pub force: bool,
    /// `contact_time_s`, `impacts`, `largest_step_m`, `largest_impact_work_j`.
    pub impacts: bool,
    /// `largest_jump_m`.
    pub jump: bool,
    /// `time_to_breakaway_s`, `time_to_release_s`, `release_velocity_m_per_s`.
    pub events: bool,
    /// `supplied_work_j`, `actuator_loss_j`, `charge_c`, `current_square_a2_s`, `stack_tension_n`.
    pub effort: bool,
    /// `final_position_m`, `end_stored_j`.
    pub end: bool,
}

impl Groups {
    /// Nothing but whether the run stays within its bounds.
    pub const NONE: Self = Self {
        time: false,
        iae: false,
        error: false,
        extremes: false,
        force: false,
        impacts: false,
        jump: false,
        events: false,
        effort: false,
        end: false,
    };
    /// Everything.
    pub const ALL: Self = Self {
        time: true,
        iae: true,
        error: true,
        extremes: true,
        force: true,
        impacts: true,
        jump: true,
        events: true,
        effort: true,
        end: true,
    };

    /// The groups of either.
    #[must_use]
    pub const fn with(self, other: Self) -> Self {
        Self {
            time: self.time | other.time,
            iae: self.iae | other.iae,
            error: self.error | other.error,
            extremes: self.extremes | other.extremes,
            force: self.force | other.force,
            impacts: self.impacts | other.impacts,
            jump: self.jump | other.jump,
            events: self.events | other.events,
            effort: self.effort | other.effort,
            end: self.end | other.end,
        }
    }
}

parameters! {
    /// Running sums and extremes. Times that have not come yet are infinite.
    ///
    /// Integrals over forces are exact for the held force; those over the error are sums of
    /// the samples times the period, as the paper's index is.
    pub struct Metrics {
        /// 1 while |e| and |F| are within bounds; once 0, nothing is counted any more.
        pub bounded,
        /// 1 once the run has ended with its release; nothing is counted any more.
        pub over,
        /// Why the watch stopped the controller; 0 if it did not.
        pub stop_reason,
        /// ∫ dt over counted samples, s.
        pub simulated_s,
        /// IAE = ∫ |e| dt, m s.
        pub iae_m_s,
        /// ISE = ∫ e² dt, m² s.
        pub ise_m2_s,
        /// ITAE = ∫ t |e| dt, m s².
        pub itae_m_s2,
        /// Largest |e|, m.
        pub largest_error_m,
        /// Largest |F|, N.
        pub peak_force_n,
        /// ∫ F dt, N s.
        pub impulse_n_s,
        /// ∫ F² dt, N² s.
        pub force_square_n2_s,
        /// ∫ F dx, J.
        pub work_j,
        /// ∫ R dx, J: lost in the joint or stored in its bristles.
        pub joint_work_j,
        /// Time during which the actuator could not deliver the command, s.
        pub saturation_time_s,
        /// Time in contact, s: with F above the contact force.
        pub contact_time_s,
        /// Number of impacts: stretches of time in contact.
        pub impacts,
        /// 1 while in contact, else 0.
        pub in_contact,
        /// Travel since the start of the last impact, m.
        pub step_m,
        /// Work done since the start of the last impact, J.
        pub impact_work_j,
        /// Largest travel from the start of an impact to the start of the next or the end, m.
        pub largest_step_m,
        /// Largest work done by one impact, J.
        pub largest_impact_work_j,
        /// Travel in the current slip event above the reference's speed, in the guide, m.
        pub jump_m,
        /// Largest jump, m.
        pub largest_jump_m,
        /// When the joint broke loose, s.
        pub time_to_breakaway_s,
        /// When the part came free to stay, s.
        pub time_to_release_s,
        /// v when the part came free, m/s.
        pub release_velocity_m_per_s,
        /// Work that the actuator's drives supplied, J.
        pub supplied_work_j,
        /// Energy lost in the actuator and its contact, J.
        pub actuator_loss_j,
        /// ∫ |I| dt of the amplifier, C.
        pub charge_c,
        /// ∫ I² dt of the amplifier, A² s.
        pub current_square_a2_s,
        /// Largest tension of the stack beyond its preload, N; below 0 if it was always pressed.
        pub stack_tension_n,
        /// x at the end, or when the run left its bounds, m.
        pub final_position_m,
        /// Energy in the bristles then, J.
        pub end_stored_j,
    }
}

impl<R: Real> Metrics<R> {
    /// Nothing counted yet.
    pub fn new() -> Self {
        let zero = R::zero();
        let not_yet = R::constant(f64::INFINITY);
        Self {
            bounded: R::one(),
            over: zero,
            stop_reason: zero,
            simulated_s: zero,
            iae_m_s: zero,
            ise_m2_s: zero,
            itae_m_s2: zero,
            largest_error_m: zero,
            peak_force_n: zero,
            impulse_n_s: zero,
            force_square_n2_s: zero,
            work_j: zero,
            joint_work_j: zero,
            saturation_time_s: zero,
            contact_time_s: zero,
            impacts: zero,
            in_contact: zero,
            step_m: zero,
            impact_work_j: zero,
            largest_step_m: zero,
            largest_impact_work_j: zero,
            jump_m: zero,
            largest_jump_m: zero,
            time_to_breakaway_s: not_yet,
            time_to_release_s: not_yet,
            release_velocity_m_per_s: zero,
            supplied_work_j: zero,
            actuator_loss_j: zero,
            charge_c: zero,
            current_square_a2_s: zero,
            stack_tension_n: R::constant(f64::NEG_INFINITY),
            final_position_m: zero,
            end_stored_j: zero,
        }
    }

    /// One control period of a run, counted.
    #[inline(always)]
    pub fn step(
        &mut self,
        wanted: Groups,
        limits: &Limits<R>,
        extraction: &Extraction<R>,
        state: &mut ExtractionState<R>,
        draws: Draws<R>,
    ) -> Sample<R> {
        let setpoint = extraction.next_setpoint(&mut state.sampling);
        let factors = extraction.factors(draws);
        let error_m = setpoint.position_m - state.plant.position_m;
        let mut seeing = self.seeing(wanted, limits, error_m);
        let sample =
            extraction.follow::<_, false>(state, &setpoint, &factors, &draws.noise, &mut seeing);
        self.update(wanted, limits, &sample);
        sample
    }

    /// Counts a sample for the groups that are wanted, unless the run has left its bounds. What
    /// happens within its period is counted by [`Metrics::seeing`], step by step until one leaves them.
    ///
    /// The sample that leaves them still counts for the largest error and force, so that these tell
    /// why the run diverged; for nothing else here. Out of bounds everything that is summed becomes zero,
    /// here and once: cheaper than keeping every sum from a change. Groups do not touch each other:
    /// what one counts has the same bits whether others are wanted or not.
    #[inline(always)]
    pub fn update(&mut self, wanted: Groups, limits: &Limits<R>, sample: &Sample<R>) {
        let going = !self.over.is_set();
        let was_bounded = self.bounded.is_set() & going;
        let error = (sample.reference_m - sample.position_m).abs();
        let force = sample.largest_force_n;
        let within = error.le(limits.diverged_error_m) & force.le(limits.diverged_force_n);
        let bounded = was_bounded & within;
        self.bounded = R::flag(bounded | !going);
        self.count(wanted, sample, was_bounded, bounded);
        let since_s = sample.time_s + sample.period_s - self.time_to_release_s;
        // What left its bounds is not over: a run in lanes goes on beside the others, and stays so.
        self.over = R::flag(!going | (bounded & limits.after_release_s.le(since_s)));
    }

    /// Whether the run goes on: within its bounds, and not over.
    pub fn goes_on(&self) -> R::Mask {
        self.bounded.is_set() & !self.over.is_set()
    }

    /// Counts a sample as [`Metrics::update`] does for one that is within its bounds, without looking.
    ///
    /// Faster; [`Metrics::stayed_within`] tells afterwards whether that was right. Extremes are
    /// counted for it, wanted or not.
    #[inline(always)]
    pub fn update_unseen(&mut self, wanted: Groups, sample: &Sample<R>) {
        let yes = R::known(true);
        let wanted = Groups { extremes: true, ..wanted };
        self.count(wanted, sample, yes, yes);
    }

    /// Whether no error and no force so far was out of bounds. Numbers that are none are passed
    /// over: whoever asks has to look at the state too, where they stay.
    pub fn stayed_within(&self, limits: &Limits<R>) -> R::Mask {
        self.largest_error_m.le(limits.diverged_error_m)
            & self.peak_force_n.le(limits.diverged_force_n)
    }

    #[inline(always)]
    fn count(
        &mut self,
        wanted: Groups,
        sample: &Sample<R>,
        was_bounded: R::Mask,
        bounded: R::Mask,
    ) {
        let error = (sample.reference_m - sample.position_m).abs();
        let period_s = where_it_holds(bounded, sample.period_s);
        if wanted.time {
            self.simulated_s = self.simulated_s + period_s;
        }
        if wanted.iae {
            self.iae_m_s = where_it_holds(bounded, error).mul_add(sample.period_s, self.iae_m_s);
        }
        if wanted.error {
            self.count_error(sample.time_s, period_s, where_it_holds(bounded, error));
        }
        if wanted.extremes {
            let error = sample.reference_m - sample.position_m;
            self.largest_error_m = larger_where(was_bounded, error, self.largest_error_m);
            let force = sample.largest_force_n;
            self.peak_force_n = larger_where(was_bounded, force, self.peak_force_n);
        }
        if wanted.force {
            self.count_force(sample, period_s, bounded);
        }
        if wanted.effort {
            self.count_effort(&sample.effort, bounded);
        }
        if wanted.end {
            self.stop_reason = R::select(bounded, sample.stop_reason, self.stop_reason);
            self.final_position_m =
                R::select(bounded, sample.next_position_m, self.final_position_m);
            self.end_stored_j = R::select(bounded, sample.next_stored_j, self.end_stored_j);
        }
    }

    #[inline(always)]
    fn count_force(&mut self, sample: &Sample<R>, period_s: R, bounded: R::Mask) {
        let moved = bounded & sample.next_position_m.abs().lt(R::constant(f64::INFINITY));
        let force = where_it_holds(bounded, sample.applied_force_n);
        self.impulse_n_s = force.mul_add(period_s, self.impulse_n_s);
        self.work_j = self.work_j + where_it_holds(moved, sample.work_j);
        self.joint_work_j = self.joint_work_j + where_it_holds(moved, sample.joint_work_j);
        let saturated_s = where_it_holds(bounded, sample.effort.saturated_s);
        self.saturation_time_s = self.saturation_time_s + saturated_s;
    }

    #[inline(always)]
    fn count_error(&mut self, time_s: R, period_s: R, error: R) {
        let area = error * period_s;
        self.ise_m2_s = error.mul_add(area, self.ise_m2_s);
        self.itae_m_s2 = time_s.mul_add(area, self.itae_m_s2);
    }

    #[inline(always)]
    fn count_effort(&mut self, effort: &Effort<R>, bounded: R::Mask) {
        self.supplied_work_j = self.supplied_work_j + where_it_holds(bounded, effort.supplied_j);
        self.actuator_loss_j = self.actuator_loss_j + where_it_holds(bounded, effort.lost_j);
        self.charge_c = self.charge_c + where_it_holds(bounded, effort.charge_c);
        let square = where_it_holds(bounded, effort.current_square_a2_s);
        self.current_square_a2_s = self.current_square_a2_s + square;
        let tension = self.stack_tension_n.max(effort.stack_tension_n);
        self.stack_tension_n = R::select(bounded, tension, self.stack_tension_n);
    }

    /// Who counts what is seen of a period's integration steps: impacts, jumps, events. It begins with
    /// the part's error `error_m` at the sample.
    #[inline(always)]
    pub fn seeing<'a>(
        &'a mut self,
        wanted: Groups,
        limits: &'a Limits<R>,
        error_m: R,
    ) -> Seeing<'a, R> {
        let going = self.bounded.is_set() & !self.over.is_set();
        let bounded = going & error_m.abs().le(limits.diverged_error_m);
        Seeing { metrics: self, wanted, limits, bounded }
    }

    /// As [`Metrics::seeing`], of a run within its bounds, without looking.
    #[inline(always)]
    pub fn seeing_unseen<'a>(
        &'a mut self,
        wanted: Groups,
        limits: &'a Limits<R>,
    ) -> SeeingAll<'a, R> {
        SeeingAll(Seeing { metrics: self, wanted, limits, bounded: R::known(true) })
    }

    #[inline(always)]
    fn count_impacts(&mut self, limits: &Limits<R>, duration_s: R, force: R, travel: R) {
        let zero = R::zero();
        let contact = limits.contact_force_n.lt(force);
        let starts = contact & !self.in_contact.is_set();
        self.in_contact = R::flag(contact);
        self.contact_time_s = self.contact_time_s + R::select(contact, duration_s, zero);
        self.impacts = self.impacts + R::flag(starts);
        self.step_m = R::select(starts, zero, self.step_m) + travel;
        self.largest_step_m = self.largest_step_m.max(self.step_m);
        self.impact_work_j = force.mul_add(travel, R::select(starts, zero, self.impact_work_j));
        self.largest_impact_work_j = self.largest_impact_work_j.max(self.impact_work_j);
    }

    /// A jump is travel faster than the reference while still in the guide, which is what harms a
    /// part: it ends when the part is no faster than the reference, or free.
    #[inline(always)]
    fn count_jump(&mut self, duration_s: R, travel: R, commanded: R) {
        let commanded = commanded.max(R::zero());
        let excess = (-commanded).mul_add(duration_s, travel);
        self.jump_m = R::select(R::zero().lt(excess), self.jump_m + excess, R::zero());
        self.largest_jump_m = self.largest_jump_m.max(self.jump_m);
    }

    /// Both places are passed within the step, and found there.
    #[inline(always)]
    fn note_times(&mut self, limits: &Limits<R>, step: &Stretch<R>, bounded: R::Mask) {
        let not_yet = R::constant(f64::INFINITY);
        let (motion, h) = (&step.motion, step.motion.duration_s);
        let loose = bounded & limits.breakaway_travel_m.lt(step.next_position_m);
        let breaks = loose & not_yet.le(self.time_to_breakaway_s);
        let at_s = h.mul_add(motion.share_at(limits.breakaway_travel_m, breaks), step.time_s);
        self.time_to_breakaway_s = R::select(breaks, at_s, self.time_to_breakaway_s);
        // A part that is pulled back into its guide is not free: only the last release counts.
        let free = limits.release_position_m.le(step.next_position_m);
        let releases = bounded & free & not_yet.le(self.time_to_release_s);
        let share = motion.share_at(limits.release_position_m, releases);
        let release_s = R::select(releases, h.mul_add(share, step.time_s), self.time_to_release_s);
        let since_s = R::select(free, release_s, not_yet);
        self.release_velocity_m_per_s =
            R::select(releases, motion.velocity_after(share), self.release_velocity_m_per_s);
        self.time_to_release_s = R::select(bounded, since_s, self.time_to_release_s);
    }
}

/// Counts what is seen of a period's integration steps.
pub struct Seeing<'a, R: Real> {
    metrics: &'a mut Metrics<R>,
    wanted: Groups,
    limits: &'a Limits<R>,
    bounded: R::Mask,
}

impl<R: Real> Seeing<'_, R> {
    #[inline(always)]
    fn count(&mut self, step: &Stretch<R>) {
        let Self { metrics, wanted, limits, bounded } = self;
        let (before_m, h) = (step.motion.position_m, step.motion.duration_s);
        let moved = *bounded & step.next_position_m.abs().lt(R::constant(f64::INFINITY));
        let travel = where_it_holds(moved, step.next_position_m - before_m);
        let force = where_it_holds(*bounded, step.force_n);
        if wanted.force {
            metrics.force_square_n2_s = (force * h).mul_add(force, metrics.force_square_n2_s);
        }
        if wanted.impacts {
            metrics.count_impacts(limits, where_it_holds(*bounded, h), force, travel);
        }
        if wanted.jump {
            let end_m = limits.release_position_m;
            let in_guide = where_it_holds(moved, end_m.min(step.next_position_m) - before_m);
            let slipped = R::select(before_m.lt(end_m), in_guide, R::zero());
            metrics.count_jump(h, slipped, step.commanded_m_per_s);
        }
        if wanted.events {
            metrics.note_times(limits, step, *bounded);
        }
    }
}

impl<R: Real> Witness<R> for Seeing<'_, R> {
    #[inline(always)]
    fn see(&mut self, step: &Stretch<R>) {
        self.bounded = self.bounded & step.force_n.abs().le(self.limits.diverged_force_n);
        self.count(step);
    }
}

/// Counts likewise, of a run that is within its bounds.
pub struct SeeingAll<'a, R: Real>(Seeing<'a, R>);

impl<R: Real> Witness<R> for SeeingAll<'_, R> {
    #[inline(always)]
    fn see(&mut self, step: &Stretch<R>) {
        self.0.count(step);
    }
}

// Functions and not closures, because these are not inlined into the instruction set of a batch.

#[inline(always)]
fn where_it_holds<R: Real>(mask: R::Mask, value: R) -> R {
    R::select(mask, value, R::zero())
}

/// The largest magnitude so far; what is not a number is passed over.
#[inline(always)]
fn larger_where<R: Real>(mask: R::Mask, value: R, largest: R) -> R {
    R::select(mask, value.max_abs(largest), largest)
}

impl Metrics<f64> {
    /// How a run with these metrics ended.
    #[must_use]
    pub fn outcome(&self, limits: &Limits<f64>) -> Outcome {
        let exceeded = self.peak_force_n > limits.peak_force_max_n
            || self.largest_jump_m > limits.jump_max_m
            || self.release_velocity_m_per_s > limits.release_velocity_max_m_per_s;
        if self.bounded == 0.0 {
            Outcome::Diverged
        } else if exceeded {
            Outcome::LimitExceeded
        } else if self.time_to_release_s.is_finite() {
            Outcome::Released
        } else {
            Outcome::NotReleased
        }
    }
}

impl<R: Real> Default for Metrics<R> {
    fn default() -> Self {
        Self::new()
    }
}
