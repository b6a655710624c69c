//! A rig with a moving part whose friction is to be identified: what a log of it should show.

use crate::actuator::ForceRange;
use crate::control::{Cascade, CascadeState, DerivativeOf, Measurement, Pid, PidState};
use crate::disturbance::Factors;
use crate::joint::{DirectionalLugre, JointState};
use crate::maybe::Maybe;
use crate::plant::{Integrator, Plant, PlantState, Push};
use crate::real::Real;
use crate::variation::Variation;

/// A part on a rig.
///
/// ```text
/// m dv/dt = F + F_out − R(x, v, z) − F_0 − d t − k_r x
/// ```
///
/// The friction's levels are multiplied by 1 + w t; t counts from the start of the log. A free travel b
/// lies between what moves and the friction: the bristle lets go, then nothing resists over b.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rig<R> {
    /// m in kg.
    pub mass_kg: R,
    /// k_r in N/m: a spring of the rig itself, such as a cable or a bellows.
    pub spring_n_per_m: R,
    /// F_0 in N: a constant force of the rig, such as a weight or the zero of a load cell.
    pub offset_n: R,
    /// d in N/s: how fast that force changes.
    pub drift_n_per_s: R,
    /// w in 1/s: how fast the friction's levels change, as a share of themselves.
    pub warming_per_s: R,
    /// b in m: free travel when the force changes its direction.
    pub backlash_m: R,
    /// R, the friction.
    pub friction: DirectionalLugre<R>,
}

/// The names of the numbers of a rig, in the order of [`Rig::from_numbers`].
pub const RIG_NUMBERS: [&str; 16] = [
    "mass_kg",
    "spring_n_per_m",
    "coulomb_positive_n",
    "coulomb_negative_n",
    "viscous_positive_n_s_per_m",
    "viscous_negative_n_s_per_m",
    "stiction_ratio",
    "stribeck_velocity_m_per_s",
    "stiffness_n_per_m",
    "damping_n_s_per_m",
    "coulomb_slope_n_per_m",
    "elastic_share",
    "drift_n_per_s",
    "warming_per_s",
    "backlash_m",
    "offset_n",
];

/// A PID within limits of its force.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields))]
pub struct LimitedPid<R> {
    /// The PID.
    pub pid: Pid<R>,
    /// The largest force either way, N.
    pub force_limit_n: R,
}

/// What moves the part.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(tag = "kind", rename_all = "snake_case"))]
pub enum Drive<R> {
    /// Its motion is imposed: force is predicted from the measured motion.
    Imposed,
    /// The measured force: motion is predicted.
    Force,
    /// A cascade that follows the reference: both are predicted.
    Cascade(Cascade<R>),
    /// A PID that follows the reference: both are predicted.
    Pid(LimitedPid<R>),
}

/// A row of a log, and the interval up to the next row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row<R> {
    /// x in m.
    pub position_m: R,
    /// v in m/s.
    pub velocity_m_per_s: R,
    /// dv/dt in m/s².
    pub acceleration_m_per_s2: R,
    /// F in N.
    pub force_n: R,
    /// r in m.
    pub reference_m: R,
    /// dr/dt in m/s.
    pub reference_rate_m_per_s: R,
    /// Time to the next row, s.
    pub period_s: R,
    /// Travel to the next row over that time, m/s.
    pub mean_velocity_m_per_s: R,
    /// F between this row and the next, N.
    pub held_force_n: R,
    /// F_out in N: a known force beside the drive's, up to the next row.
    pub outside_force_n: R,
    /// t from the start of the log, s.
    pub time_s: R,
}

impl Row<f64> {
    /// The row as constants of another number.
    #[inline(always)]
    pub fn constant<R: Real>(&self) -> Row<R> {
        Row {
            position_m: R::constant(self.position_m),
            velocity_m_per_s: R::constant(self.velocity_m_per_s),
            acceleration_m_per_s2: R::constant(self.acceleration_m_per_s2),
            force_n: R::constant(self.force_n),
            reference_m: R::constant(self.reference_m),
            reference_rate_m_per_s: R::constant(self.reference_rate_m_per_s),
            period_s: R::constant(self.period_s),
            mean_velocity_m_per_s: R::constant(self.mean_velocity_m_per_s),
            held_force_n: R::constant(self.held_force_n),
            outside_force_n: R::constant(self.outside_force_n),
            time_s: R::constant(self.time_s),
        }
    }
}

impl Drive<f64> {
    /// The drive with its numbers as constants of another number.
    pub fn constant<R: Real>(&self) -> Drive<R> {
        match self {
            Self::Imposed => Drive::Imposed,
            Self::Force => Drive::Force,
            Self::Cascade(c) => Drive::Cascade(Cascade {
                position_gain_per_s: R::constant(c.position_gain_per_s),
                velocity_gain_n_s_per_m: R::constant(c.velocity_gain_n_s_per_m),
                force_limit_n: R::constant(c.force_limit_n),
            }),
            Self::Pid(c) => Drive::Pid(LimitedPid {
                pid: c.pid.map(&mut |_, value| R::constant(value)),
                force_limit_n: R::constant(c.force_limit_n),
            }),
        }
    }
}

/// What the model says of a row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Predicted<R> {
    /// x in m.
    pub position_m: R,
    /// F in N.
    pub force_n: R,
}

/// What moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigState<R> {
    plant: PlantState<R>,
    /// Where in the free travel the part is, m: 0 in its middle.
    free_m: R,
    cascade: CascadeState<R>,
    pid: PidState<R>,
}

impl<R: Real> Rig<R> {
    /// A rig from its numbers, in the order of [`RIG_NUMBERS`]; LuGre unless `elasto_plastic`.
    #[inline(always)]
    pub fn from_numbers(numbers: &[R; RIG_NUMBERS.len()], elasto_plastic: bool) -> Self {
        Self {
            mass_kg: numbers[0],
            spring_n_per_m: numbers[1],
            friction: DirectionalLugre {
                coulomb_positive_n: numbers[2],
                coulomb_negative_n: numbers[3],
                viscous_positive_n_s_per_m: numbers[4],
                viscous_negative_n_s_per_m: numbers[5],
                stiction_ratio: numbers[6],
                stribeck_velocity_m_per_s: numbers[7],
                stiffness_n_per_m: numbers[8],
                damping_n_s_per_m: numbers[9],
                coulomb_slope_n_per_m: numbers[10],
                elastic_share: if elasto_plastic {
                    Maybe::some(numbers[11])
                } else {
                    Maybe::none()
                },
            },
            drift_n_per_s: numbers[12],
            warming_per_s: numbers[13],
            backlash_m: numbers[14],
            offset_n: numbers[15],
        }
    }

    /// The state at a measured row: its motion, the bristle that balances its forces, and a PID's
    /// integral that gives its force.
    #[inline(always)]
    pub fn start(&self, drive: &Drive<R>, row: &Row<R>) -> RigState<R> {
        let (x, v) = (row.position_m, row.velocity_m_per_s);
        let inertial = self.mass_kg * row.acceleration_m_per_s2;
        let friction_n = row.force_n - inertial - self.rig_force(x, row);
        let warmth = self.warmth(row);
        let bristle_m = warmth * self.friction.deflection_under(friction_n / warmth, x, v);
        let half = R::constant(0.5) * self.backlash_m;
        let free_m = R::select(friction_n.lt(R::zero()), -half, half);
        let plant = PlantState {
            position_m: x,
            velocity_m_per_s: v,
            bristle_m,
            joint_force_n: friction_n,
            ..PlantState::at_rest()
        };
        let previous_position_m = x - v * row.period_s;
        let pid = PidState { previous_position_m, ..PidState::at_rest() };
        let mut state =
            RigState { plant, free_m, cascade: CascadeState::moving(x, v, row.period_s), pid };
        if let Drive::Pid(limited) = drive {
            self.start_pid(limited, &mut state, row);
        }
        state
    }

    #[inline(always)]
    fn start_pid(&self, limited: &LimitedPid<R>, state: &mut RigState<R>, row: &Row<R>) {
        let v = row.velocity_m_per_s;
        state.pid.derivative_m_per_s = match limited.pid.derivative_of {
            DerivativeOf::Error => row.reference_rate_m_per_s - v,
            DerivativeOf::Measurement => -v,
        };
        let mut unbiased = *state;
        let missing = row.force_n - self.pid_force(limited, &mut unbiased, row);
        let integrates = R::zero().lt(limited.pid.gains.ki_n_per_m_s);
        state.pid.integral_n = R::select(integrates, missing, R::zero());
    }

    /// What the rig takes of the drive's force: F_0 + d t + k_r x − F_out.
    #[inline(always)]
    fn rig_force(&self, x: R, row: &Row<R>) -> R {
        let offset_n = self.drift_n_per_s.mul_add(row.time_s, self.offset_n - row.outside_force_n);
        self.spring_n_per_m.mul_add(x, offset_n)
    }

    /// The factor on the friction's levels.
    #[inline(always)]
    fn warmth(&self, row: &Row<R>) -> R {
        self.warming_per_s.mul_add(row.time_s, R::one())
    }

    /// Lets the bristle's deflection, where it has just changed its sign, go through the free travel.
    #[inline(always)]
    fn take_free_travel(&self, state: &mut RigState<R>) {
        let half = R::constant(0.5) * self.backlash_m;
        let z = state.plant.bristle_m;
        let forward = z.max(R::zero()).min(half - state.free_m);
        let backward = (-z).max(R::zero()).min(half + state.free_m);
        state.free_m = state.free_m + forward - backward;
        state.plant.bristle_m = z - forward + backward;
    }

    /// What the model says of a row, and the state at the next one, `steps` steps later.
    #[inline(always)]
    pub fn step(
        &self,
        drive: &Drive<R>,
        state: &mut RigState<R>,
        row: &Row<R>,
        steps: u32,
    ) -> Predicted<R> {
        let force_n = match drive {
            Drive::Imposed => return self.follow_motion(state, row, steps),
            Drive::Force => row.held_force_n,
            Drive::Cascade(cascade) => {
                let x = state.plant.position_m;
                cascade.step(&mut state.cascade, row.reference_m, x, row.period_s)
            }
            Drive::Pid(c) => self.pid_force(c, state, row),
        };
        let predicted = Predicted { position_m: state.plant.position_m, force_n };
        let h = row.period_s * R::constant(1.0 / f64::from(steps));
        let factors = Factors { joint_force: R::one(), friction_level: self.warmth(row) };
        for _ in 0..steps {
            let half = R::constant(0.5) * h;
            let x_mid = half.mul_add(state.plant.velocity_m_per_s, state.plant.position_m);
            let push = Push::rigid(force_n - self.rig_force(x_mid, row));
            let plant = Plant {
                joint: &self.friction,
                mass_kg: self.mass_kg,
                push,
                factors,
                variation: &Variation::none(),
            };
            plant.step(Integrator::LinearlyImplicitMidpoint, &mut state.plant, R::zero(), h);
            self.take_free_travel(state);
        }
        predicted
    }

    #[inline(always)]
    fn pid_force(&self, limited: &LimitedPid<R>, state: &mut RigState<R>, row: &Row<R>) -> R {
        let range = ForceRange { min_n: -limited.force_limit_n, max_n: limited.force_limit_n };
        let measured = Measurement {
            reference_m: row.reference_m,
            reference_rate_m_per_s: row.reference_rate_m_per_s,
            position_m: state.plant.position_m,
            velocity_m_per_s: state.plant.velocity_m_per_s,
            force_n: row.force_n,
            period_s: row.period_s,
            range,
        };
        range.limit(limited.pid.force(&mut state.pid, &measured))
    }

    /// The force at a row whose motion is measured; the bristle follows to the next row.
    #[inline(always)]
    fn follow_motion(&self, state: &mut RigState<R>, row: &Row<R>, steps: u32) -> Predicted<R> {
        let (x, v) = (row.position_m, row.velocity_m_per_s);
        let z = state.plant.bristle_m;
        let joint =
            JointState { bristle_m: z, transverse_bristle_m: R::zero(), sliding: R::zero() };
        let bristle = self.friction.freeze(&joint, x, v, self.warmth(row));
        let half = R::constant(0.5) * self.backlash_m;
        let rate = R::select(state.free_m.abs().lt(half), R::zero(), bristle.rate(v, z));
        let friction_n = bristle.force(v, z, rate);
        let force_n =
            self.mass_kg.mul_add(row.acceleration_m_per_s2, friction_n + self.rig_force(x, row));
        state.plant.position_m = x;
        let share = R::constant(1.0 / f64::from(steps));
        let h = row.period_s * share;
        // The speed goes linearly on from the row's, so that the travel is what was measured.
        let change = R::constant(2.0) * (row.mean_velocity_m_per_s - v) * share;
        let mut speed = R::constant(0.5).mul_add(change, v);
        for _ in 0..steps {
            self.carry_bristle(&mut state.plant, speed, h, self.warmth(row));
            self.take_free_travel(state);
            speed = speed + change;
        }
        Predicted { position_m: x, force_n }
    }

    /// Moves the part at `v` for `h`. With velocity and level frozen the bristle's equation has the
    /// solution
    ///
    /// ```text
    /// z ← z e^(−y) + v h (1 − e^(−y)) / y,     y = h α k_e |v| / g
    /// ```
    ///
    /// which is used as it stands: a log's rows may be far apart for a stiff bristle, whose value at
    /// a row would ring with the midpoint rule. Below y = 1e-4 its series replaces the quotient. An
    /// elastic step that ends beyond the level, as α is taken before it, ends at the level.
    #[inline(always)]
    fn carry_bristle(&self, state: &mut PlantState<R>, v: R, h: R, warmth: R) {
        let z = state.bristle_m;
        let joint =
            JointState { bristle_m: z, transverse_bristle_m: R::zero(), sliding: R::zero() };
        let x_mid = (R::constant(0.5) * h).mul_add(v, state.position_m);
        let b = self.friction.freeze(&joint, x_mid, v, warmth);
        let y = h * b.relaxation() / b.friction_level_n;
        let small = R::constant(1e-4);
        let kept = (-y).exp();
        let series = R::one() - y * (R::constant(0.5) - y * R::constant(1.0 / 6.0));
        let share = R::select(y.lt(small), series, (R::one() - kept) / y.max(small));
        let reach = (b.friction_level_n / b.stiffness_n_per_m).max(z.abs());
        state.bristle_m = z.mul_add(kept, v * h * share).clamp(-reach, reach);
        state.position_m = h.mul_add(v, state.position_m);
    }
}
