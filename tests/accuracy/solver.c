/* An extraction by an explicit Runge-Kutta pair with adaptive steps, written from the equations of
 * the models and not from the core. Events are located by bisection, so that no step crosses one.
 *
 * Reads lines "name value", writes lines "name value". SI units.
 */
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

enum law { LUGRE, ELASTO_PLASTIC, GMS, TWO_REGION, COULOMB_STICTION };
enum drive { IDEAL, PUSH_ONLY, LAGGED, FEED };
enum controller { RAMP, PID, STEADY_FEED };
enum reference { STEP, LINEAR, MINIMUM_JERK, TRAPEZOID };

#define NUMBERS(N) \
    N(law) N(stiction) N(coulomb) N(residual) N(guide) N(backward) N(stiffness) N(damping) \
    N(viscous) N(stribeck) N(damping_velocity) N(elastic_share) N(elements) N(attraction) N(mass) \
    N(drive) N(force_max) N(bandwidth) N(force_rate) \
    N(axis_stiffness) N(axis_damping) N(tool_mass) N(speed_max) N(acceleration) \
    N(contact_stiffness) N(contact_damping) N(gap) N(backlash) N(grips) \
    N(controller) N(ramp_rate) N(ramp_travel) N(kp) N(ki) N(kd) N(of_error) N(from_sensor) \
    N(filter) N(feed_speed) N(approach_speed) N(approach_time) \
    N(reference) N(distance) N(start) N(motion) N(cruise) N(reference_acceleration) \
    N(duration) N(period) N(delayed) N(release) N(after_release) N(loose) N(contact_force)

#define DECLARE(name) double name;
static struct { NUMBERS(DECLARE) } p;

static struct { const char *name; double *value; } const names[] = {
#define ENTRY(name) {#name, &p.name},
    NUMBERS(ENTRY)
};

/* What is integrated: motion first, then what is counted. */
enum { ELEMENTS_MAX = 10 };
enum { X, V, FORCE, TOOL, TOOL_V, Z, MOVING = Z + ELEMENTS_MAX, IMPULSE = MOVING, SQUARE, WORK, JOINT, SUPPLIED,
       CONTACT, JUMP, STATES };

/* What happens between events. */
static struct { int stuck; double direction; } slip, element[ELEMENTS_MAX];
static double command, speed_asked;           /* held over a period */
static double feed, feed_v, feed_a;           /* of the drive at the start of a stretch */
static double error_scale[MOVING];

static double level(double seated, double x)
{
    double left = 1.0 - fmin(fmax(x, 0.0), p.guide) / p.guide;
    return p.residual + (seated - p.residual) * left;
}

static double bell(double v, double scale) { return exp(-(v / scale) * (v / scale)); }

static double backward(double direction) { return direction < 0.0 ? p.backward : 1.0; }

static double stribeck(double x, double v)
{
    double f_s = level(p.stiction, x), f_c = level(p.coulomb, x);
    return (f_c + (f_s - f_c) * bell(v, p.stribeck)) * backward(v);
}

/* alpha of Dupont et al., with a polynomial step. */
static double onset(double z, double v, double g)
{
    double s;
    if (p.law == LUGRE) return 1.0;
    if (z * v <= 0.0) return 0.0;
    s = (fabs(z) * p.stiffness / g - p.elastic_share) / (1.0 - p.elastic_share);
    s = fmin(fmax(s, 0.0), 1.0);
    return s * s * (3.0 - 2.0 * s);
}

static double damping(double v)
{
    return p.damping_velocity > 0.0 ? p.damping * bell(v, p.damping_velocity) : p.damping;
}

/* Equal springs whose yield deflections rise linearly. */
static double element_stiffness(void) { return p.stiffness / p.elements; }

static double element_level(int i) { return 2.0 * (i + 1) / (p.elements * (p.elements + 1)); }

/* Springs side by side: each sticks up to its share of the level, then follows it. */
static double generalized_maxwell_slip(double x, double v, const double *z, double *z_rate)
{
    double g = stribeck(x, v), k = element_stiffness(), force = p.viscous * v;
    for (int i = 0; i < p.elements; i++) {
        double d = element[i].direction;
        z_rate[i] = v;
        if (!element[i].stuck) {
            double follows = p.attraction * (element_level(i) * d - k * z[i] / g) / k;
            z_rate[i] = d * fmin(d * follows, fabs(v));
        }
        force += k * z[i] + damping(v) / p.elements * z_rate[i];
    }
    return force;
}

/* Force of the joint; sets dz/dt. */
static double friction(const double *y, double push, double *z_rate)
{
    double x = y[X], v = y[V], z = y[Z], g;
    memset(z_rate, 0, ELEMENTS_MAX * sizeof *z_rate);
    if (x >= p.guide) return 0.0;
    if (p.law == COULOMB_STICTION) {
        if (slip.stuck) return push;
        return slip.direction * stribeck(x, slip.direction * fabs(v)) + p.viscous * v;
    }
    if (p.law == TWO_REGION) {
        if (!slip.stuck) return slip.direction * level(p.coulomb, x) * backward(slip.direction);
        *z_rate = v;
        return p.stiffness * z + p.damping * v;
    }
    if (p.law == GMS) return generalized_maxwell_slip(x, v, y + Z, z_rate);
    g = stribeck(x, v);
    *z_rate = v - onset(z, v, g) * p.stiffness * fabs(v) / g * z;
    return p.stiffness * z + damping(v) * *z_rate + p.viscous * v;
}

static double pressed(const double *y) { return y[TOOL] - p.gap - y[X]; }

static double push_of(const double *y)
{
    double depth, closing, force;
    if (p.drive == IDEAL) return command;
    if (p.drive == PUSH_ONLY) return fmin(fmax(command, 0.0), p.force_max);
    if (p.drive == LAGGED) return y[FORCE];
    depth = pressed(y), closing = p.contact_damping * (y[TOOL_V] - y[V]);
    force = fmax(0.0, p.contact_stiffness * depth + closing);
    if (p.grips) force += fmin(0.0, p.contact_stiffness * (depth + p.backlash) + closing);
    return force;
}

static void rates(double t, const double *y, double *dy)
{
    double z_rate[ELEMENTS_MAX], push = push_of(y), joint = friction(y, push, z_rate), axis, w;
    int held = p.law == COULOMB_STICTION && slip.stuck && y[X] < p.guide;
    memset(dy, 0, STATES * sizeof *dy);
    dy[X] = y[V];
    dy[V] = held ? 0.0 : (push - joint) / p.mass;
    memcpy(dy + Z, z_rate, sizeof z_rate);
    if (p.drive == LAGGED) {
        double target = fmin(fmax(command, 0.0), p.force_max);
        double wanted = (target - y[FORCE]) * 2.0 * M_PI * p.bandwidth;
        dy[FORCE] = fmin(fmax(wanted, -p.force_rate), p.force_rate);
    }
    if (p.drive == FEED) {
        w = feed_v + feed_a * t;
        axis = p.axis_stiffness * (feed + (feed_v + 0.5 * feed_a * t) * t - y[TOOL])
             + p.axis_damping * (w - y[TOOL_V]);
        dy[TOOL] = y[TOOL_V];
        dy[TOOL_V] = (axis - push) / p.tool_mass;
        dy[SUPPLIED] = axis * w;
    } else {
        dy[SUPPLIED] = push * y[V];
    }
    dy[IMPULSE] = push, dy[SQUARE] = push * push;
    dy[WORK] = push * y[V], dy[JOINT] = joint * y[V];
    dy[CONTACT] = push > p.contact_force;
    dy[JUMP] = y[V] > speed_asked && y[X] < p.release ? y[V] - speed_asked : 0.0;
}

/* Everything that changes the equations or is counted when it changes; a step ends where one does. */
enum { TOUCHES = 1, PULLS = 2, GONE = 4, LOOSE = 8, FREE = 16, JUMPS = 32, FORWARD = 64, TURNS = 128,
       BREAKS = 256, PUSHES = 512, FIRST_ELEMENT = 1024 };

/* Whether an element that sticks should slip, or one that slips should stick. */
static int changes(int i, const double *y)
{
    double v = y[V], z = y[Z + i];
    if (!element[i].stuck) return v * element[i].direction < 0.0;
    return v * z > 0.0 && element_stiffness() * fabs(z) > element_level(i) * stribeck(y[X], v);
}

static int flags_of(const double *y)
{
    double push = push_of(y);
    int flags = 0;
    if (p.drive == FEED && push > 0.0) flags |= TOUCHES;
    if (p.drive == FEED && push < 0.0) flags |= PULLS;
    if (y[X] >= p.guide) flags |= GONE;
    if (y[X] > p.loose) flags |= LOOSE;
    if (y[X] >= p.release) flags |= FREE;
    if (y[V] > speed_asked) flags |= JUMPS;
    if (y[V] > 0.0) flags |= FORWARD;
    if (push > p.contact_force) flags |= PUSHES;
    if (y[X] >= p.guide) return flags;
    for (int i = 0; p.law == GMS && i < p.elements; i++)
        if (changes(i, y)) flags |= FIRST_ELEMENT << i;
    if (!slip.stuck && y[V] * slip.direction < 0.0) flags |= TURNS;
    if (slip.stuck && p.law == COULOMB_STICTION
        && fabs(push) > level(p.stiction, y[X]) * backward(push)) flags |= BREAKS;
    if (slip.stuck && p.law == TWO_REGION
        && p.stiffness * fabs(y[Z]) > level(p.stiction, y[X]) * backward(y[Z])) flags |= BREAKS;
    return flags;
}

/* Dormand and Prince, 5(4): J. Comput. Appl. Math. 6, 1980. Gives the error relative to its scale. */
static double runge_kutta(double t, const double *y, double h, double *out)
{
    static const double c[7] = {0, 0.2, 0.3, 0.8, 8.0 / 9, 1, 1};
    static const double a[7][6] = {
        {0},
        {0.2},
        {3.0 / 40, 9.0 / 40},
        {44.0 / 45, -56.0 / 15, 32.0 / 9},
        {19372.0 / 6561, -25360.0 / 2187, 64448.0 / 6561, -212.0 / 729},
        {9017.0 / 3168, -355.0 / 33, 46732.0 / 5247, 49.0 / 176, -5103.0 / 18656},
        {35.0 / 384, 0, 500.0 / 1113, 125.0 / 192, -2187.0 / 6784, 11.0 / 84},
    };
    static const double e[7] = {71.0 / 57600, 0, -71.0 / 16695, 71.0 / 1920, -17253.0 / 339200,
                                22.0 / 525, -1.0 / 40};
    double k[7][STATES], worst = 0.0;
    for (int stage = 0; stage < 7; stage++) {
        for (int i = 0; i < STATES; i++) {
            out[i] = y[i];
            for (int j = 0; j < stage; j++) out[i] += h * a[stage][j] * k[j][i];
        }
        rates(t + c[stage] * h, out, k[stage]);
    }
    for (int i = 0; i < MOVING; i++) {
        double error = 0.0;
        for (int j = 0; j < 7; j++) error += h * e[j] * k[j][i];
        worst = fmax(worst, fabs(error) / (error_scale[i] + 1e-9 * fabs(out[i])));
    }
    return worst;
}

static struct {
    double loose_s, release_s, release_v, jump, peak, impacts, error, largest_error;
} found;

static void note(double t, const double *y, int before, int after)
{
    if ((after & LOOSE) && isnan(found.loose_s)) found.loose_s = t;
    if ((after & FREE) && !(before & FREE)) found.release_s = t, found.release_v = y[V];
    if (!(after & FREE)) found.release_s = found.release_v = NAN;
    if ((after & PUSHES) && !(before & PUSHES)) found.impacts += 1.0;
}

/* What an event does to the state. */
static void settle(double *y, int flags)
{
    for (int i = 0; i < ELEMENTS_MAX; i++) {
        if (flags & GONE) y[Z + i] = 0.0, element[i].stuck = slip.stuck = 1;
        if (!(flags & FIRST_ELEMENT << i)) continue;
        element[i].stuck = !element[i].stuck;
        element[i].direction = y[V] > 0.0 ? 1.0 : -1.0;
    }
    if (flags & TURNS) {
        slip.stuck = 1;
        if (p.law == TWO_REGION) return;
        double push = push_of(y);
        y[V] = 0.0;
        if (fabs(push) > level(p.stiction, y[X]) * backward(push)) flags |= BREAKS;
    }
    if (flags & BREAKS) {
        slip.stuck = 0;
        slip.direction = (p.law == TWO_REGION ? y[Z] : push_of(y)) > 0.0 ? 1.0 : -1.0;
    }
    if (p.law == TWO_REGION && !slip.stuck)
        y[Z] = slip.direction * level(p.coulomb, y[X]) * backward(slip.direction) / p.stiffness;
}

static long steps_left = 40000000;

/* One step that ends at `end` or at an event before; gives its length, and a guess of the next. */
static double advance(double t, double end, double *y, double *guess)
{
    double next[STATES], h = fmin(*guess, end - t), low = 0.0, high, error;
    int before = flags_of(y), after;
    for (;;) {
        if (--steps_left < 0) return -1.0;
        error = runge_kutta(t, y, h, next);
        if (error <= 1.0) break;
        h *= fmax(0.1, 0.9 * pow(error, -0.2));
    }
    *guess = h * fmin(5.0, 0.9 * pow(error + 1e-12, -0.2));
    after = flags_of(next);
    for (high = h; after != before && high - low > 1e-12 * h;) {
        double middle = 0.5 * (low + high), tried[STATES];
        runge_kutta(t, y, middle, tried);
        if (flags_of(tried) == before) low = middle;
        else high = middle, memcpy(next, tried, sizeof next), after = flags_of(next);
    }
    memcpy(y, next, sizeof next);
    if (p.law == TWO_REGION && !slip.stuck && !(after & TURNS))
        y[Z] = slip.direction * level(p.coulomb, y[X]) * backward(slip.direction) / p.stiffness;
    found.peak = fmax(found.peak, fabs(push_of(y)));
    found.jump = fmax(found.jump, y[JUMP]);
    if (!(after & JUMPS)) y[JUMP] = 0.0;
    if (after != before) settle(y, after);
    return high;
}

static int stretch(double *clock, double length, double *y, double *guess)
{
    for (double t = 0.0; t < length * (1.0 - 1e-13);) {
        int before = flags_of(y);
        double h = advance(t, length, y, guess);
        if (h < 0.0) return 0;
        t += h, *clock += h;
        note(*clock, y, before, flags_of(y));
    }
    if (p.drive == FEED)
        feed += (feed_v + 0.5 * feed_a * length) * length, feed_v += feed_a * length;
    return 1;
}

/* The drive speeds up evenly and then holds: two stretches. */
static int move(double *clock, double *y, double *guess)
{
    double wanted, reach, rest = p.period, t = *clock;
    if (p.drive == FEED) {
        wanted = fmin(fmax(command, -p.speed_max), p.speed_max);
        reach = fmin(fabs(wanted - feed_v) / p.acceleration, p.period);
        feed_a = wanted > feed_v ? p.acceleration : -p.acceleration;
        if (reach > 0.0 && !stretch(&t, reach, y, guess)) return 0;
        feed_a = 0.0, rest = p.period - reach;
        if (reach < p.period) feed_v = wanted;
    }
    return rest <= 0.0 || stretch(&t, rest, y, guess);
}

static double reference(double t, double *rate)
{
    double s = t - p.start, d = p.distance, a = p.reference_acceleration, v = p.cruise, u, up, whole;
    *rate = 0.0;
    if (s < 0.0) return 0.0;
    if (p.reference == STEP) return d;
    u = s / p.motion;
    if (p.reference == LINEAR) return u >= 1.0 ? d : (*rate = d / p.motion, d * u);
    if (p.reference == MINIMUM_JERK) {
        if (u >= 1.0) return d;
        *rate = d / p.motion * 30.0 * u * u * (1.0 - u) * (1.0 - u);
        return d * u * u * u * (10.0 - 15.0 * u + 6.0 * u * u);
    }
    up = v / a, whole = d / v + up;
    if (s < up) return *rate = a * s, 0.5 * a * s * s;
    if (s < whole - up) return *rate = v, v * (s - 0.5 * up);
    if (s >= whole) return d;
    *rate = a * (whole - s);
    return d - 0.5 * a * (whole - s) * (whole - s);
}

/* Discrete controllers, a sample each. */
static double decide(double t, const double *y, double *asked)
{
    static double force, integral, derivative, last;
    double rate, r = reference(t, &rate), v, share, raw;
    double least = p.drive == IDEAL ? -INFINITY : 0.0, most = p.drive == IDEAL ? INFINITY : p.force_max;
    *asked = 0.0;
    if (p.controller == STEADY_FEED)
        return *asked = t < p.approach_time * (1 - 1e-12) ? p.approach_speed : p.feed_speed;
    if (p.controller == RAMP) {
        force = y[X] < p.ramp_travel ? fmin(fmax(force + p.ramp_rate * p.period, least), most) : 0.0;
        return force;
    }
    *asked = rate;
    v = p.from_sensor ? y[V] : (y[X] - last) / p.period;
    last = y[X];
    raw = p.of_error ? rate - v : -v;
    share = p.period / (p.filter + p.period);
    derivative = (1.0 - share) * derivative + share * raw;
    integral += p.ki * p.period * (r - y[X]);
    return p.kp * (r - y[X]) + integral + p.kd * derivative;
}

static int run(double *y, double *simulated)
{
    double guess = 1e-3 * p.period, waiting = 0.0, asked, rate;
    int before = 0, flags;
    long samples = lround(p.duration / p.period);
    for (long n = 0; n < samples; n++) {
        double clock = n * p.period, off = fabs(reference(clock, &rate) - y[X]);
        double decided = decide(clock, y, &asked);
        command = p.delayed ? waiting : decided;
        speed_asked = p.controller == STEADY_FEED ? command : asked;
        waiting = decided;
        found.error += off * p.period;
        found.largest_error = fmax(found.largest_error, off);
        found.peak = fmax(found.peak, fabs(push_of(y)));
        flags = flags_of(y);
        note(clock, y, before, flags);
        settle(y, flags & (GONE | BREAKS));
        if (!(flags & JUMPS)) y[JUMP] = 0.0;
        if (!move(&clock, y, &guess)) return 0;
        before = flags_of(y);
        *simulated = (n + 1) * p.period;
        if (*simulated - found.release_s >= p.after_release) break;
    }
    return 1;
}

static void read_numbers(void)
{
    char name[64];
    double value;
    while (scanf("%63s %lf", name, &value) == 2)
        for (size_t i = 0; i < sizeof names / sizeof *names; i++)
            if (!strcmp(name, names[i].name)) *names[i].value = value;
}

int main(void)
{
    double y[STATES] = {0}, simulated = 0.0, stored = 0.0, speed;
    read_numbers();
    slip.stuck = 1;
    for (int i = 0; i < ELEMENTS_MAX; i++) element[i].stuck = 1;
    found.loose_s = found.release_s = found.release_v = NAN;
    speed = 1e-3 * p.guide / p.duration;
    for (int i = 0; i < MOVING; i++) error_scale[i] = 1e-9 * 1e-3 * p.guide;
    error_scale[V] = error_scale[TOOL_V] = 1e-9 * speed;
    for (int i = 0; i < ELEMENTS_MAX; i++)
        error_scale[Z + i] = 1e-11 * (p.stiffness > 0.0 ? p.stiction / p.stiffness : 1.0);
    error_scale[FORCE] = 1e-9 * p.stiction;
    if (!run(y, &simulated)) return 1;
    for (int i = 0; i < p.elements; i++)
        stored += 0.5 * element_stiffness() * y[Z + i] * y[Z + i];
    printf("simulated_s %.17g\niae_m_s %.17g\nlargest_error_m %.17g\n", simulated, found.error,
           found.largest_error);
    printf("peak_force_n %.17g\nmean_force_n %.17g\nrms_force_n %.17g\n", found.peak,
           y[IMPULSE] / simulated, sqrt(y[SQUARE] / simulated));
    printf("impulse_n_s %.17g\nwork_j %.17g\nfriction_loss_j %.17g\nsupplied_work_j %.17g\n",
           y[IMPULSE], y[WORK], y[JOINT] - stored, y[SUPPLIED]);
    printf("impacts %.17g\ncontact_time_s %.17g\n", found.impacts, y[CONTACT]);
    printf("largest_jump_m %.17g\ntime_to_breakaway_s %.17g\ntime_to_release_s %.17g\n", found.jump,
           found.loose_s, found.release_s);
    printf("release_velocity_m_per_s %.17g\nfinal_position_m %.17g\n", found.release_v, y[X]);
    return 0;
}
