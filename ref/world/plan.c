/* SPDX-License-Identifier: Apache-2.0 */
/* Says which stages a scene uses, and why. */
#include "ref/world/plan.h"

#include "ref/world/state.h"

/* For BDF2: spec/accuracy.md §1. */
enum { NEWTON_DEFAULT = 4 };

bool plan_windy(const drape_wind *wind)
{
    return wind->density > 0 && (wind->drag > 0 || wind->lift > 0);
}

/* Linear systems of a cloth's motion, at most: drape_def's newton. */
static int newton_of(const drape_def *def)
{
    if (!dynamics_implicit(def->integrator))
        return 0;
    if (def->newton == 0)
        return def->integrator == DRAPE_BDF2 ? NEWTON_DEFAULT : 1;
    return def->newton;
}

struct plan plan_make(const drape_def *def)
{
    struct plan p = {0};
    for (int k = 0; k < def->n_obstacles; k++)
        p.prescribed |=
            def->obstacles[k].motion >= 0 || def->obstacles[k].frames;
    for (int k = 0; k < def->n_cloths; k++)
        for (int i = 0; i < def->cloths[k].n_pins; i++)
            p.prescribed |= def->cloths[k].pins[i].motion >= 0;
    p.wind = plan_windy(&def->wind);
    p.implicit = def->integrator >= DRAPE_BW;
    p.history = dynamics_second(def->integrator);
    p.newton = newton_of(def);
    p.self = def->self_collision;
    p.obstacles = def->n_obstacles > 0;
    p.collides = p.self || p.obstacles || def->n_seams > 0;
    p.solves = p.implicit && p.collides && def->response == DRAPE_SOLVE;
    return p;
}

struct row {
    const char *stage;
    bool on;
    const char *yes, *no;
    enum arena_part part; /* part of memory whose bytes the row shows */
    bool shows;
};

int plan_rows(const struct world *w, drape_plan_row *row, int capacity)
{
    const struct plan *p = &w->plan;
    bool multigrid = p->implicit && w->def.precond == DRAPE_MULTIGRID;
    const char *explicit_ = "the integrator is explicit";
    const char *alone = "nothing can collide";
    const struct row rows[] = {
        {"state", true, "positions and velocities", "", ARENA_STATE, true},
        {"kinematics", p->prescribed, "pins or obstacles move",
         "nothing is led: placed once", ARENA_OBSTACLE, true},
        {"wind", p->wind, "there is air", "there is no air", 0, false},
        {"springs", true, "cloth is springs", "", ARENA_CLOTH, true},
        {"advance", !p->implicit, explicit_, "the integrator is implicit", 0,
         false},
        {"implicit", p->implicit, "the integrator is implicit", explicit_,
         ARENA_SOLVER, true},
        {"matrix", p->implicit && w->def.matrix == DRAPE_CDF,
         "17 diagonals asked for",
         p->implicit ? "the symmetric half is used" : explicit_, 0, false},
        {"pcg", p->implicit, "a linear system each step", explicit_, 0, false},
        {"imbalance", p->newton > 1, "Newton's method",
         p->implicit ? "one linear system a step" : explicit_, 0, false},
        {"multigrid", multigrid, "preconditions pcg",
         p->implicit ? "block-Jacobi asked for" : explicit_, 0, false},
        {"refit", p->collides, "boxes follow what moves", alone, ARENA_TREE,
         true},
        {"front, obstacles", p->obstacles, "cloth can meet obstacles",
         "there are no obstacles", ARENA_FRONT, true},
        {"front, self", p->self, "cloth can meet cloth",
         "self-collision is off", 0, false},
        {"features", p->collides, "candidate pairs", alone, ARENA_PAIRS, true},
        {"proximity", p->collides, "contact begins at the thickness", alone,
         ARENA_RESPONSE, true},
        {"narrow", p->collides, "exact, only for candidates", alone, 0, false},
        {"seams", w->seams.n > 0, "points are sewn", "nothing is sewn", 0,
         false},
        {"impulses", p->collides, "only for pairs that penetrate", alone, 0,
         false},
        {"zones", p->collides, "only if impulses do not suffice", alone, 0,
         false},
        {"rollback", p->collides, "only if zones do not suffice", alone, 0,
         false},
        {"scratch", w->device, "sorts and scans of the device",
         "the reference needs none", ARENA_SCRATCH, true},
        {"momentum", conserve_applies(w), "nothing but cloths and gravity acts",
         p->implicit ? "obstacles, pins or wind act" : explicit_, 0, false},
        {"sleep", w->def.sleep, "cloths at rest are skipped", "sleep is off",
         ARENA_OTHER, true},
    };
    int n = (int)(sizeof rows / sizeof *rows);
    for (int k = 0; k < n && k < capacity; k++) {
        row[k].stage = rows[k].stage;
        row[k].on = rows[k].on;
        row[k].why = rows[k].on ? rows[k].yes : rows[k].no;
        row[k].bytes = rows[k].shows ? w->held[rows[k].part] : 0;
    }
    return n;
}
