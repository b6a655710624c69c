//! A feed axis with a tool, maybe a piezo stack, and its contact with the part.

use super::piezo::Charged;
use super::{ActuatorState, Command, Contact, Driven, Effort, Piezo};
use crate::name::{Name, within};
use crate::real::Real;

/// What touches the part.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(tag = "kind", rename_all = "snake_case"))]
pub enum Tip<R> {
    /// The tool itself.
    Rigid,
    /// A piezo stack on the tool.
    Piezo(Piezo<R>),
}

/// A feed axis: its drive p follows the commanded speed, the rest yields.
///
/// ```text
/// dp/dt   = w,  dw/dt = a sgn(command − w) until w = command,  |w| ≤ w_max
/// m_t x_t'' = k_f (p − x_t) + c_f (w − x_t') − F_s                      tool
/// m_p x_p'' = F_s − F,  F_s = k (u − x_p + x_t) − c (x_p' − x_t')       tip of the stack
/// F       = that of the [`Contact`] with the part
/// ```
///
/// Without a stack the tool is the tip. The linearly implicit midpoint eliminates tool and tip, so
/// the part meets a force F₀ − S v at a face; no spring here limits the step.
/// Stack and axis are those of [`Piezo`]; its stroke u has hysteresis.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields))]
pub struct FeedAxis<R> {
    /// w_max in m/s.
    pub speed_max_m_per_s: R,
    /// a in m/s².
    pub acceleration_max_m_per_s2: R,
    /// k_f in N/m: the axis between its drive and the tool.
    pub stiffness_n_per_m: R,
    /// c_f in N s/m.
    pub damping_n_s_per_m: R,
    /// m_t in kg.
    pub tool_mass_kg: R,
    /// What touches the part.
    pub tip: Tip<R>,
    /// How it touches.
    pub contact: Contact<R>,
}

/// Tool and tip of a step, solved but for the contact force F and the part's motion.
///
/// ```text
/// v_tip  = a_tip − y_tip F,   v_tool = a_tool + b_tool v_tip     at the middle of the step
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Chain<R> {
    tip_free: R,
    tip_yield: R,
    tool_free: R,
    tool_follows: R,
    feed_mean_m_per_s: R,
    feed_mid_m: R,
    stroke_mid_m: R,
    stroke_rate_m_per_s: R,
    pressed_m: R,
}

impl<R: Real> Chain<R> {
    /// The tool is the tip: `impedance` (v_tip) = `carried` − F.
    #[inline(always)]
    fn rigid(carried: R, impedance: R) -> Self {
        let (zero, tip_yield) = (R::zero(), (R::one() / impedance).named("tip_yield_m_per_n_s"));
        Self {
            tip_free: (carried * tip_yield).named("tip_free_m_per_s"),
            tip_yield,
            tool_free: zero,
            tool_follows: R::one(),
            feed_mean_m_per_s: zero,
            feed_mid_m: zero,
            stroke_mid_m: zero,
            stroke_rate_m_per_s: zero,
            pressed_m: zero,
        }
    }

    /// A stack between tool and tip.
    #[inline(always)]
    fn stacked(
        piezo: &Piezo<R>,
        state: &ActuatorState<R>,
        charged: &Charged<R>,
        carried: R,
        impedance: R,
        h: R,
    ) -> Self {
        R::section("stack and tip: F_s = k (u - x_p + x_t) - c (v_p - v_t)");
        let half = R::constant(0.5);
        let stroke_mid_m = (half * (charged.before_m + state.stroke_m)).named("stroke_middle_m");
        let stack_n = piezo.stiffness_n_per_m * (stroke_mid_m - state.tip_m + state.tool_m);
        let stack_n = stack_n.named("stack_n");
        let stack = piezo.stiffness_n_per_m.mul_add(half * h, piezo.damping_n_s_per_m);
        let stack = stack.named("stack_n_s_per_m");
        let tool = (R::one() / (impedance + stack)).named("tool_yield_m_per_n_s");
        let tool_free = ((carried - stack_n) * tool).named("tool_free_m_per_s");
        let tool_follows = (stack * tool).named("tool_follows");
        let inertia = (piezo.tip_mass_kg / (half * h)).named("tip_inertia_n_s_per_m");
        let tip_yield = R::one() / (-stack).mul_add(tool_follows, inertia + stack);
        let tip_yield = tip_yield.named("tip_yield_m_per_n_s");
        let pushed = inertia.mul_add(state.tip_m_per_s, stack_n).named("tip_pushed_n");
        Self {
            tip_free: (stack.mul_add(tool_free, pushed) * tip_yield).named("tip_free_m_per_s"),
            tip_yield,
            tool_free,
            tool_follows,
            stroke_mid_m,
            stroke_rate_m_per_s: (state.stroke_m - charged.before_m) / h,
            ..Self::rigid(carried, impedance)
        }
    }
}

impl<R: Real> FeedAxis<R> {
    /// Applies `f` to every number.
    pub fn map<S: Real>(&self, f: &mut impl FnMut(Name<'_>, R) -> S) -> FeedAxis<S> {
        FeedAxis {
            speed_max_m_per_s: f(Name::of("speed_max_m_per_s"), self.speed_max_m_per_s),
            acceleration_max_m_per_s2: f(
                Name::of("acceleration_max_m_per_s2"),
                self.acceleration_max_m_per_s2,
            ),
            stiffness_n_per_m: f(Name::of("stiffness_n_per_m"), self.stiffness_n_per_m),
            damping_n_s_per_m: f(Name::of("damping_n_s_per_m"), self.damping_n_s_per_m),
            tool_mass_kg: f(Name::of("tool_mass_kg"), self.tool_mass_kg),
            tip: match &self.tip {
                Tip::Rigid => Tip::Rigid,
                Tip::Piezo(piezo) => Tip::Piezo(within!("tip", piezo, f)),
            },
            contact: within!("contact", self.contact, f),
        }
    }

    #[inline(always)]
    pub(super) fn drive(
        &self,
        state: &mut ActuatorState<R>,
        command: &Command<R>,
        part_m: R,
        h: R,
    ) -> Driven<R> {
        let k = (R::constant(0.5) * h).named("half_step_s");
        let (feed_mean, feed_mid, late_s) = self.feed(state, command, h);
        R::section("tool: m_t dv_t/dt = k_f (p - x_t) + c_f (w - v_t) - F_s");
        let (k_f, c_f) = (self.stiffness_n_per_m, self.damping_n_s_per_m);
        let inertia = (self.tool_mass_kg / k).named("tool_inertia_n_s_per_m");
        let axis_n = (k_f * (feed_mid - state.tool_m) + c_f * feed_mean).named("axis_n");
        let carried = inertia.mul_add(state.tool_m_per_s, axis_n).named("carried_n");
        let impedance = (inertia + k_f.mul_add(k, c_f)).named("impedance_n_s_per_m");
        let (charged, mut chain) = match &self.tip {
            Tip::Rigid => (Charged::none(), Chain::rigid(carried, impedance)),
            Tip::Piezo(piezo) => {
                let charged = piezo.charge(state, command, h);
                (charged, Chain::stacked(piezo, state, &charged, carried, impedance, h))
            }
        };
        (chain.feed_mean_m_per_s, chain.feed_mid_m) = (feed_mean, feed_mid);
        R::section("contact: F = max(0, k_c (x_p - gap - x) + c_c (v_p - v))");
        chain.pressed_m = self.pressed(state, part_m).named("pressed_m");
        let current = charged.current_a;
        Driven {
            push: self.contact.push(chain.pressed_m, chain.tip_free, chain.tip_yield, k),
            chain: Some(chain),
            effort: Effort {
                charge_c: current.abs() * h,
                current_square_a2_s: current * current * h,
                saturated_s: R::select(charged.limited.is_set(), h, late_s),
                ..Effort::none()
            },
        }
    }

    /// How far the tip reaches into the part, m; below zero where there is a gap.
    #[inline(always)]
    fn pressed(&self, state: &ActuatorState<R>, part_m: R) -> R {
        let tip_m = match &self.tip {
            Tip::Rigid => state.tool_m,
            Tip::Piezo(_) => state.tip_m,
        };
        tip_m - self.contact.gap_m - part_m
    }

    /// Moves the drive: at its acceleration until it is as fast as commanded. Gives its mean speed, its
    /// middle, and for how long it lags its command. A command that is not a number stops it.
    #[inline(always)]
    fn feed(&self, state: &mut ActuatorState<R>, command: &Command<R>, h: R) -> (R, R, R) {
        R::section("feed: dw/dt = a sgn(command - w) until w is the command");
        let half = R::constant(0.5);
        let limit = self.speed_max_m_per_s;
        let told = command.feed_m_per_s;
        let wanted = R::select(told.le(told), told.clamp(-limit, limit), R::zero());
        let most = (self.acceleration_max_m_per_s2 * h).named("most_m_per_s");
        let change = (wanted - state.feed_m_per_s).clamp(-most, most).named("change_m_per_s");
        let share = (change.abs() / most).named("accelerating_share");
        let follows = (-half).mul_add(share, R::one()).named("follows");
        let mean = follows.mul_add(change, state.feed_m_per_s).named("feed_mean_m_per_s");
        let mid = (half * h).mul_add(mean, state.feed_m).named("feed_middle_m");
        state.feed_m = h.mul_add(mean, state.feed_m);
        state.feed_m_per_s = state.feed_m_per_s + change;
        let beyond = wanted.lt(told) | told.lt(wanted);
        (mean, mid, R::select(beyond, h, share * h))
    }

    /// Moves tool and tip by the force that acted; books the energy of the step. The contact's loss
    /// is what goes in less what its springs keep: also in a step in which contact begins or ends.
    #[inline(always)]
    pub(super) fn settle(
        &self,
        state: &mut ActuatorState<R>,
        chain: &Chain<R>,
        effort: &Effort<R>,
        push_n: R,
        part_m_per_s: R,
        h: R,
    ) -> Effort<R> {
        R::section("tool and tip move on");
        let (half, two) = (R::constant(0.5), R::constant(2.0));
        let k = half * h;
        let tip_v = (-chain.tip_yield).mul_add(push_n, chain.tip_free).named("tip_m_per_s");
        let tool_v = chain.tool_follows.mul_add(tip_v, chain.tool_free).named("tool_m_per_s");
        let tool_mid = k.mul_add(tool_v, state.tool_m);
        let slip = chain.feed_mean_m_per_s - tool_v;
        let axis_n =
            self.stiffness_n_per_m * (chain.feed_mid_m - tool_mid) + self.damping_n_s_per_m * slip;
        let mut supplied = axis_n * chain.feed_mean_m_per_s;
        let mut lost = self.damping_n_s_per_m * slip * slip;
        let mut tension = effort.stack_tension_n;
        if let Tip::Piezo(piezo) = &self.tip {
            let tip_mid = k.mul_add(tip_v, state.tip_m);
            let lengthens = tip_v - tool_v;
            let elastic = piezo.stiffness_n_per_m * (chain.stroke_mid_m - tip_mid + tool_mid);
            let damped = piezo.damping_n_s_per_m * lengthens;
            supplied = elastic.mul_add(chain.stroke_rate_m_per_s, supplied);
            lost = damped.mul_add(lengthens, lost);
            tension = damped - elastic - piezo.preload_n;
            state.tip_m = h.mul_add(tip_v, state.tip_m);
            state.tip_m_per_s = two * tip_v - state.tip_m_per_s;
        }
        let closing = tip_v - part_m_per_s;
        lost = push_n.mul_add(closing, lost);
        let kept = self.contact.energy_j(h.mul_add(closing, chain.pressed_m))
            - self.contact.energy_j(chain.pressed_m);
        state.tool_m = h.mul_add(tool_v, state.tool_m);
        state.tool_m_per_s = two * tool_v - state.tool_m_per_s;
        Effort {
            supplied_j: supplied * h,
            lost_j: lost.mul_add(h, -kept),
            stack_tension_n: tension,
            ..*effort
        }
    }

    /// Energy in springs and masses, that of the contact with a part at `part_m` included, J.
    pub(super) fn stored_energy_j(&self, state: &ActuatorState<R>, part_m: R) -> R {
        let half = R::constant(0.5);
        let axis = state.feed_m - state.tool_m;
        let mut twice = self.stiffness_n_per_m * axis * axis
            + self.tool_mass_kg * state.tool_m_per_s * state.tool_m_per_s;
        if let Tip::Piezo(piezo) = &self.tip {
            let spring = state.stroke_m - state.tip_m + state.tool_m;
            twice = twice
                + piezo.stiffness_n_per_m * spring * spring
                + piezo.tip_mass_kg * state.tip_m_per_s * state.tip_m_per_s;
        }
        half.mul_add(twice, self.contact.energy_j(self.pressed(state, part_m)))
    }
}
