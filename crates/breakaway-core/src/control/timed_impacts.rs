//! Impacts that time themselves by what the part does.

use super::{Control, Measurement};
use crate::actuator::Command;
use crate::name::{Name, within};
use crate::parameters::parameters;
use crate::real::Real;
use crate::states::states;

/// Positions that the slopes are taken over.
const WINDOW: usize = 8;

parameters! {
    /// Impacts that end as soon as the part slips, or fruitless at a ceiling. No friction parameter
    /// is needed.
    ///
    /// ```text
    ///            (x − x₀) + κ v̂ ≥ Δ,  or F = C, v̂ < v_1, and dwelt
    ///   ┌──────┐ ─────────────────────────> ┌───────┐   x ≥ l   ┌──────┐
    ///   │ rise │                            │ coast │ ────────> │ free │
    ///   └──────┘ <───────────────────────── └───────┘           └──────┘
    ///               at rest: x₀, Δ, κ, C anew
    /// rise   F ← F (1 + b T_s / τ),  b = clip(1 − (v̂ − v_1) / (v_2 − v_1), 0, 1)
    /// coast  F = 0, at least t_c, until means over ten samples agree within d
    /// ```
    ///
    /// Exponential growth makes an overshoot relative: a weak part meets as many percent too much as
    /// a strong one. The first search rises from F_1 with τ_s until something slips, at F_b. From then
    /// on an impact rises with τ, which is in proportion to the time s / max v̂ that slips of this part
    /// take, within its limits, from `restart_ratio` C to the ceiling C. There it ends, unless the
    /// part is seen to move: what is heavy for its friction is pushed on, to Δ; what slips at the peak
    /// slips under a force that already falls, so that the slip need not be seen to be short. The
    /// ceiling is set so that impacts make the step:
    ///
    /// ```text
    /// C ← C [1 + p clip((Δ − s) / Δ, −3, 1)]        s the furthest travel of the impact
    /// ```
    ///
    /// with p = `probe_ratio`. If the slip was seen before, C first moves by `breakaway_share` to the
    /// largest force of that impact as modeled, a lag behind the command; a part that came back only
    /// stretched, and was not seen to slip. At F_b and above, a fruitless impact is not raised at once
    /// but dwells longer at C: a part that is slow for its mass needs time and not more force, and one
    /// whose friction varies slips when that is low.
    ///
    /// After a rough slip, C is lowered and t_end put off: smaller forces, which are enough only
    /// while friction is low, let go of less. Each second that t_end is put off also takes a share from
    /// the largest Δ. So does a ceiling that is low against F_b, towards the end of the guide: there
    /// little is left to stop a heavy part. Neither makes Δ smaller than being out at `latest_s` takes;
    /// that may take more than the largest Δ, up to the length of a rough slip, and then slips are
    /// rough only from a length that is larger in proportion.
    ///
    /// v̂ is the largest slope of least squares over 3, 5 and 8 positions, each less `noise_margin` of
    /// its deviation from noise; where it slows the rise and times the cut, only once x has left x₀
    /// by more than the joint's recoil: before, that only stretches. The lead κ adapts: a slip beyond
    /// Δ multiplies it by 1.15, one short of Δ by 0.95. Δ is what has to be traveled in each cycle to
    /// be out at t_end, plus the recoil of the joint, within its limits. The part counts as free once
    /// the mean of three positions is `free_margin` beyond l.
    pub struct TimedImpacts {
        /// l in m: where the part is out.
        pub travel_m,
        /// t_end in s: when it should be out.
        pub target_s,
        /// F_1 in N: where the first search begins.
        pub force_start_n,
        /// τ_s in s.
        pub search_time_constant_s,
        /// Largest τ in s.
        pub rise_time_constant_s,
        /// Smallest τ in s.
        pub rise_min_s,
        /// τ over the mean time of a slip.
        pub rise_per_slip,
        /// v_1 in m/s: above this v̂ the force grows slower.
        pub slowing_m_per_s,
        /// v_2 in m/s: above this v̂ it does not grow.
        pub holding_m_per_s,
        /// Smallest Δ in m.
        pub step_min_m,
        /// Largest Δ in m while the part is not late.
        pub step_max_m,
        /// Travel in m beyond the recoil below which nothing counts as a slip.
        pub travel_min_m,
        /// Share of C at which a rise begins.
        pub restart_ratio,
        /// p: share by which a fruitless impact raises C.
        pub probe_ratio,
        /// Share by which C follows the force of a slip that was seen.
        pub breakaway_share,
        /// F/F_b from which a fruitless impact dwells longer before it is raised.
        pub dwell_from_ratio,
        /// What each such impact adds to the dwell, s.
        pub dwell_step_s,
        /// Longest dwell, s.
        pub dwell_max_s,
        /// Share of the dwell that stays after a slip that was seen.
        pub dwell_kept_share,
        /// Travel of a slip in m beyond which it is rough, and Δ never is.
        pub rough_slip_m,
        /// Share by which a rough slip lowers C.
        pub rough_cut_ratio,
        /// Time by which a rough slip puts t_end off, s.
        pub patience_s,
        /// Most by which t_end is put off, s.
        pub patience_max_s,
        /// Share of the largest Δ that each second takes by which t_end is put off, 1/s.
        pub caution_per_s,
        /// C/F_b below which the largest Δ falls with it.
        pub low_force_ratio,
        /// Share of the largest Δ to which it falls at most.
        pub low_step_ratio,
        /// When it should be out for all that, s.
        pub latest_s,
        /// t_c in s.
        pub coast_min_s,
        /// d in m.
        pub settled_m,
        /// κ in s at the start.
        pub lead_start_s,
        /// Smallest κ in s.
        pub lead_min_s,
        /// Largest κ in s.
        pub lead_max_s,
        /// Deviation of the position sensor's noise, m.
        pub noise_rms_m,
        /// Deviations of noise that a slope must exceed.
        pub noise_margin,
        /// Distance beyond l at which the part is taken as free, m.
        pub free_margin_m,
        /// Lag of the actuator as modeled, s.
        pub actuator_lag_s,
    }
}

/// What moves in timed impacts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimedImpactsState<R> {
    /// Numbers.
    pub numbers: ImpactNumbers<R>,
    /// The last positions, newest first, m.
    pub window_m: [R; WINDOW],
}

states! {
    /// The numbers that move in timed impacts.
    pub struct ImpactNumbers {
        /// 1 while coasting.
        pub coasting,
        /// 1 if this impact was cut because the part slipped.
        pub seen_to_slip,
        /// 1 once the part is out.
        pub free,
        /// F in N.
        pub force_n,
        /// The actuator's force as modeled, N.
        pub modeled_n,
        /// Largest modeled force of this impact, N.
        pub peak_n,
        /// C in N, 0 until the first slip.
        pub ceiling_n,
        /// F_b in N: the modeled force of the first slip.
        pub first_slip_n,
        /// How long this dwell may be, s.
        pub dwell_s,
        /// Time at the ceiling in this impact, s.
        pub dwelt_s,
        /// How far t_end was put off, s.
        pub put_off_s,
        /// x₀ in m.
        pub start_m,
        /// Largest position in the cycle, m.
        pub furthest_m,
        /// Largest v̂ in the cycle, m/s.
        pub fastest_m_per_s,
        /// Mean time that a slip takes, s, 0 before the first.
        pub slip_s,
        /// κ in s.
        pub lead_s,
        /// Δ in m.
        pub step_m,
        /// Mean recoil in m.
        pub recoil_m,
        /// Mean duration of a cycle, s.
        pub cycle_s,
        /// Time in this cycle, s.
        pub in_cycle_s,
        /// Time coasted in this cycle, s.
        pub coasted_s,
        /// Time since the start, s.
        pub elapsed_s,
        /// Samples in the present mean.
        pub mean_count,
        /// Their sum, m.
        pub mean_sum_m,
        /// The last mean, m.
        pub mean_m,
        /// Samples so far, up to the window's.
        pub seen,
    }
}

impl<R: Real> TimedImpactsState<R> {
    /// Before the first sample.
    pub fn at_rest() -> Self {
        Self { numbers: ImpactNumbers::at_rest(), window_m: [R::zero(); WINDOW] }
    }

    /// Every number of `yes` where `mask` holds, of `no` elsewhere.
    #[inline(always)]
    pub fn select(mask: R::Mask, yes: &Self, no: &Self) -> Self {
        let mut window_m = yes.window_m;
        for (chosen, &other) in window_m.iter_mut().zip(&no.window_m) {
            *chosen = R::select(mask, *chosen, other);
        }
        Self { numbers: ImpactNumbers::select(mask, &yes.numbers, &no.numbers), window_m }
    }

    /// Applies `f` to every number.
    pub fn map<S>(&self, f: &mut impl FnMut(Name<'_>, R) -> S) -> TimedImpactsState<S> {
        TimedImpactsState {
            numbers: within!("numbers", self.numbers, f),
            window_m: self.window_m.map(|x| f(Name::of("window_m"), x)),
        }
    }
}

/// Samples in a mean while coasting.
const MEAN_SAMPLES: f64 = 10.0;
/// What κ is multiplied by after a slip beyond Δ, and after one short of it.
const LEAD_UP: f64 = 1.15;
const LEAD_DOWN: f64 = 0.95;
/// Most that a slip beyond Δ lowers the ceiling, over what a fruitless impact raises it.
const MOST_DOWN: f64 = 3.0;
/// What a cycle is taken to last before there was one, s.
const FIRST_CYCLE_S: f64 = 0.01;
/// Share of a new value in the running means of recoil and cycle.
const NEW_SHARE: f64 = 0.2;

impl<R: Real> Control<R> for TimedImpacts<R> {
    type State = TimedImpactsState<R>;

    #[inline(always)]
    fn step(&self, state: &mut TimedImpactsState<R>, measured: &Measurement<R>) -> Command<R> {
        // A copy is known to be this function's own: compilers choose in registers then, where they
        // would store under a mask.
        let mut moved = *state;
        self.look(&mut moved, measured);
        R::section("impacts: cut when (x - x_0) + kappa v >= Delta, or fruitless at the ceiling");
        let seen = self.velocity(&moved.window_m, measured.period_s);
        let n = &mut moved.numbers;
        let stretched = (n.start_m + n.recoil_m + self.travel_min_m).named("stretched_m");
        let v = R::select(stretched.lt(measured.position_m), seen, R::zero());
        let v = v.named("seen_m_per_s");
        n.fastest_m_per_s = n.fastest_m_per_s.max(v);
        let rising = !n.coasting.is_set() & !n.free.is_set();
        let known = R::zero().lt(n.ceiling_n);
        let at_ceiling = rising & known & n.ceiling_n.le(n.force_n);
        n.dwelt_s = R::select(at_ceiling, n.dwelt_s + measured.period_s, n.dwelt_s);
        let spent = at_ceiling & seen.lt(self.slowing_m_per_s) & n.dwell_s.lt(n.dwelt_s);
        let slips = self.slips(n, measured.position_m, v);
        let cut = rising & (slips | spent);
        n.seen_to_slip = R::select(cut, R::flag(slips), n.seen_to_slip);
        n.force_n = R::select(rising, self.grown(n, v, measured), n.force_n);
        n.coasting = R::select(cut, R::one(), n.coasting);
        self.coast(n, measured);
        let off = n.coasting.is_set() | n.free.is_set();
        n.force_n = R::select(off, R::zero(), n.force_n);
        *state = moved;
        Command::force(state.numbers.force_n)
    }
}

impl<R: Real> TimedImpacts<R> {
    /// Takes a sample in: window, clocks, the modeled force.
    #[inline(always)]
    fn look(&self, state: &mut TimedImpactsState<R>, measured: &Measurement<R>) {
        R::section("impacts, sample: window of positions, clocks, modeled force");
        let (x, period) = (measured.position_m, measured.period_s);
        let first = state.numbers.seen.lt(R::constant(0.5));
        for i in (1..WINDOW).rev() {
            state.window_m[i] = R::select(first, x, state.window_m[i - 1]);
        }
        state.window_m[0] = x;
        let n = &mut state.numbers;
        n.seen = R::one();
        n.start_m = R::select(first, x, n.start_m);
        n.furthest_m = R::select(first, x, n.furthest_m.max(x));
        n.force_n = R::select(first, self.force_start_n, n.force_n);
        n.lead_s = R::select(first, self.lead_start_s, n.lead_s);
        n.step_m = R::select(first, self.step_min_m, n.step_m);
        n.elapsed_s = (n.elapsed_s + period).named("elapsed_s");
        n.in_cycle_s = (n.in_cycle_s + period).named("in_cycle_s");
        let share = (period / (self.actuator_lag_s + period)).named("lag_share");
        n.modeled_n = share.mul_add(n.force_n - n.modeled_n, n.modeled_n).named("modeled_n");
        n.peak_n = n.peak_n.max(n.modeled_n).named("peak_n");
        let [w0, w1, w2, ..] = state.window_m;
        let beyond = (self.travel_m + self.free_margin_m) * R::constant(3.0);
        n.free = R::select(beyond.le(w0 + w1 + w2), R::one(), n.free);
    }

    /// v̂ in m/s.
    #[inline(always)]
    fn velocity(&self, window: &[R; WINDOW], period_s: R) -> R {
        R::section("impacts, velocity: largest slope over 3, 5 and 8 positions, less its noise");
        let c = |value: f64| R::constant(value);
        let [w0, w1, w2, w3, w4, w5, w6, w7] = *window;
        let noise = (self.noise_margin * self.noise_rms_m).named("noise_m");
        let three = c(0.5) * (w0 - w2) - noise * c(0.707_106_781_186_547_5);
        let five = c(0.1) * (c(2.0) * (w0 - w4) + (w1 - w3)) - noise * c(0.316_227_766_016_837_9);
        let eight = c(1.0 / 84.0)
            * (c(7.0) * (w0 - w7) + c(5.0) * (w1 - w6) + c(3.0) * (w2 - w5) + (w3 - w4))
            - noise * c(0.154_303_349_962_091_9);
        let (three, five) = (three.named("slope_of_3_m"), five.named("slope_of_5_m"));
        let slope_m = three.max(five).max(eight.named("slope_of_8_m")).max(R::zero());
        (slope_m.named("slope_m") / period_s).named("slope_m_per_s")
    }

    /// Whether the force must be cut now.
    #[inline(always)]
    fn slips(&self, n: &ImpactNumbers<R>, x: R, v: R) -> R::Mask {
        let travel = (x - n.start_m).named("travel_m");
        n.step_m.le(n.lead_s.mul_add(v, travel)) & (n.recoil_m + self.travel_min_m).lt(travel)
    }

    #[inline(always)]
    fn grown(&self, n: &ImpactNumbers<R>, v: R, measured: &Measurement<R>) -> R {
        R::section(
            "impacts, rise: F = F (1 + b T_s / tau), b = clip(1 - (v - v_1) / (v_2 - v_1), 0, 1)",
        );
        let (zero, one) = (R::zero(), R::one());
        let range = (self.holding_m_per_s - self.slowing_m_per_s).named("slowing_range_m_per_s");
        let b = (one - (v - self.slowing_m_per_s) / range).clamp(zero, one).named("growth");
        let known = zero.lt(n.ceiling_n);
        let quick = (self.rise_per_slip * n.slip_s).max(self.rise_min_s);
        let rise = quick.min(self.rise_time_constant_s).named("rise_s");
        let tau = R::select(known, rise, self.search_time_constant_s);
        let tau = tau.named("time_constant_s");
        let grown = (n.force_n * (b * measured.period_s / tau + one)).named("grown_n");
        let limited = measured.range.limit(grown).named("limited_n");
        R::select(known, limited.min(n.ceiling_n.max(n.force_n)), limited)
    }

    /// Coasts until the part rests; then plans the next cycle.
    #[inline(always)]
    fn coast(&self, n: &mut ImpactNumbers<R>, measured: &Measurement<R>) {
        R::section("impacts, coast: until means over ten samples agree within d");
        let (zero, one) = (R::zero(), R::one());
        let coasting = n.coasting.is_set();
        let count = R::constant(MEAN_SAMPLES);
        n.coasted_s = R::select(coasting, n.coasted_s + measured.period_s, zero);
        n.mean_count = R::select(coasting, n.mean_count + one, zero);
        n.mean_sum_m = R::select(coasting, n.mean_sum_m + measured.position_m, zero);
        let full = coasting & count.le(n.mean_count);
        let mean = (n.mean_sum_m / count).named("position_mean_m");
        let agrees = (mean - n.mean_m).abs().lt(self.settled_m);
        n.mean_m = R::select(full, mean, n.mean_m);
        n.mean_count = R::select(full, zero, n.mean_count);
        n.mean_sum_m = R::select(full, zero, n.mean_sum_m);
        let rests = full & agrees & self.coast_min_s.le(n.coasted_s);
        let next = self.next_cycle(n);
        *n = ImpactNumbers::select(rests, &next, n);
    }

    /// The cycle after this one, from where the part rests.
    #[inline(always)]
    fn next_cycle(&self, n: &ImpactNumbers<R>) -> ImpactNumbers<R> {
        R::section("impacts, next cycle: recoil, duration, time of a slip, delay of the end");
        let (zero, share) = (R::zero(), R::constant(NEW_SHARE));
        let first = n.ceiling_n.le(zero);
        let travel = (n.furthest_m - n.start_m).named("travel_m");
        let recoil = share.mul_add((n.furthest_m - n.mean_m) - n.recoil_m, n.recoil_m);
        let recoil = recoil.named("recoil_m");
        let mean_cycle = share.mul_add(n.in_cycle_s - n.cycle_s, n.cycle_s).named("mean_cycle_s");
        let cycle = R::select(first, R::constant(FIRST_CYCLE_S), mean_cycle).named("cycle_s");
        let took = (travel / n.fastest_m_per_s.max(self.slowing_m_per_s)).named("took_s");
        let mean_slip = share.mul_add(took - n.slip_s, n.slip_s);
        let slip = R::select(n.slip_s.le(zero), took, mean_slip).named("mean_slip_s");
        let usual = (n.step_m / self.step_max_m).max(R::one()).named("step_ratio");
        let rough = (self.rough_slip_m * usual).lt(travel);
        let later = (n.put_off_s + self.patience_s).min(self.patience_max_s);
        let put_off = R::select(rough, later, n.put_off_s).named("put_off_s");
        let (ceiling, dwell) = self.next_ceiling(n, travel, rough);
        let next = ImpactNumbers {
            coasting: zero,
            force_n: self.restart_ratio * ceiling,
            peak_n: zero,
            ceiling_n: ceiling,
            first_slip_n: R::select(first, n.peak_n, n.first_slip_n).named("first_slip_n"),
            dwell_s: dwell,
            dwelt_s: zero,
            put_off_s: put_off,
            start_m: n.mean_m,
            furthest_m: n.mean_m,
            fastest_m_per_s: zero,
            slip_s: R::select(self.stays(n), slip, n.slip_s),
            lead_s: self.next_lead(n, travel),
            recoil_m: recoil,
            cycle_s: cycle,
            in_cycle_s: zero,
            coasted_s: zero,
            ..*n
        };
        ImpactNumbers { step_m: self.next_step(&next), ..next }
    }

    /// Whether the part was seen to slip and did not come back: else it only stretched.
    #[inline(always)]
    fn stays(&self, n: &ImpactNumbers<R>) -> R::Mask {
        n.seen_to_slip.is_set() & (n.start_m + self.travel_min_m).lt(n.mean_m)
    }

    /// Δ in m, in a cycle whose other numbers are known.
    #[inline(always)]
    fn next_step(&self, n: &ImpactNumbers<R>) -> R {
        R::section("impacts, next step: Delta = what is left / time left * cycle + recoil");
        let one = R::one();
        let calm = (-self.caution_per_s).mul_add(n.put_off_s, one).named("calm_share");
        let force = n.ceiling_n / (self.low_force_ratio * n.first_slip_n);
        let low = force.clamp(self.low_step_ratio, one).named("low_share");
        let late = self.needed(n, self.latest_s).min(self.rough_slip_m.max(self.step_max_m));
        let most = (self.step_max_m * calm * low).max(late).max(self.step_min_m);
        let most = most.named("largest_step_m");
        self.needed(n, self.target_s + n.put_off_s).clamp(self.step_min_m, most)
    }

    /// What has to be traveled in each cycle to be out at a time, with the recoil, m.
    #[inline(always)]
    fn needed(&self, n: &ImpactNumbers<R>, end_s: R) -> R {
        let left_s = (end_s - n.elapsed_s).max(n.cycle_s).named("left_s");
        let left_m = (self.travel_m - n.mean_m).named("left_m");
        (left_m / left_s * n.cycle_s + n.recoil_m).named("needed_m")
    }

    /// C in N and the dwell at it in s, after an impact of some travel.
    #[inline(always)]
    fn next_ceiling(&self, n: &ImpactNumbers<R>, travel: R, rough: R::Mask) -> (R, R) {
        R::section("impacts, next ceiling: C = C (1 + p clip((Delta - s) / Delta, -3, 1))");
        let (zero, one) = (R::zero(), R::one());
        let slipped = self.stays(n);
        let first = n.ceiling_n.le(zero);
        let high = !first & (self.dwell_from_ratio * n.first_slip_n).le(n.ceiling_n);
        let dwells = high & n.dwell_s.lt(self.dwell_max_s) & !slipped;
        let longer = R::select(dwells, n.dwell_s + self.dwell_step_s, n.dwell_s);
        let dwell = R::select(slipped, n.dwell_s * self.dwell_kept_share, longer);
        let dwell = dwell.named("next_dwell_s");
        let followed = self.breakaway_share.mul_add(n.peak_n - n.ceiling_n, n.ceiling_n);
        let base = R::select(slipped, followed.named("followed_n"), n.ceiling_n).named("base_n");
        let missing = ((n.step_m - travel) / n.step_m).named("missing_share");
        let most_up = R::select(dwells, zero, one);
        let correction = self.probe_ratio * missing.clamp(-R::constant(MOST_DOWN), most_up);
        let kept = one - R::select(rough, self.rough_cut_ratio, zero);
        let moved = base * (one + correction.named("correction")) * kept.named("kept_share");
        (R::select(first, n.peak_n, moved).named("next_ceiling_n"), dwell)
    }

    /// κ in s, after an impact of some travel.
    #[inline(always)]
    fn next_lead(&self, n: &ImpactNumbers<R>, travel: R) -> R {
        let beyond = n.step_m.lt(travel);
        let factor = R::select(beyond, R::constant(LEAD_UP), R::constant(LEAD_DOWN));
        let lead = (n.lead_s * factor).clamp(self.lead_min_s, self.lead_max_s).named("adapted_s");
        R::select(n.seen_to_slip.is_set(), lead, n.lead_s)
    }
}
