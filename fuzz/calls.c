/* SPDX-License-Identifier: Apache-2.0 */
/* Fuzzes the functions of a world: calls them in any order with drape_step
 * between them. */
#include <math.h>
#include <stdlib.h>

#include "fuzz/fuzz.h"
#include "fuzz/play.h"

static const char *play_wake(struct play *p)
{
    for (int k = 0; k < 2 && p->world[k]; k++)
        drape_wake(p->world[k]);
    EXPECT(play_note(p, p->after));
    return NULL;
}

static const char *play_wind(struct play *p)
{
    drape_wind wind = {{0, 0, 0}, 1.2, 1, 0.3};
    double *number[] = {&wind.velocity[0], &wind.velocity[1], &wind.velocity[2],
                        &wind.density,     &wind.drag,        &wind.lift};
    int status[2] = {DRAPE_OK, DRAPE_OK};
    bool finite = true, inside = true;
    wind.velocity[0] = draw_in(&p->b, -9, 9);
    if (pick(&p->b, 2))
        *number[pick(&p->b, 6)] = draw_any(&p->b);
    for (int k = 0; k < 6; k++) {
        finite = finite && fabs(*number[k]) <= 0x1p60;
        inside = inside && (k < 3 || *number[k] >= 0) &&
                 (k < 4 || *number[k] <= 1e6);
    }
    play_short(p);
    for (int k = 0; k < 2 && p->world[k]; k++)
        status[k] = drape_set_wind(p->world[k], &wind);
    EXPECT(finite || status[0] == DRAPE_EDATA || !inside);
    EXPECT(status[0] != DRAPE_OK || (finite && inside));
    for (int k = 0; k < 2 && p->world[k] && status[k] == DRAPE_OK; k++) {
        drape_wind now;
        EXPECT(drape_read_wind(p->world[k], &now) == DRAPE_OK);
        EXPECT(!memcmp(&now, &wind, sizeof now));
    }
    EXPECT(status[0] == DRAPE_OK || status[0] == DRAPE_ENOMEM || !finite ||
           !inside);
    return play_judge(p, status, !finite || !inside);
}

static const char *play_save(struct play *p)
{
    p->after[0].size = p->after[0].at = 0;
    p->after[0].left = (int)pick(&p->b, 10) - 1;
    int left = p->after[0].left;
    int status = drape_save(p->world[0], tape_write, &p->after[0]);
    EXPECT(status == DRAPE_OK || (status == DRAPE_EIO && left >= 0));
    EXPECT(status == DRAPE_OK || p->after[0].left < 0);
    if (pick(&p->b, 2))
        EXPECT(tape_save(&p->kept, p->world[0]));
    return play_unchanged(p);
}

static const char *play_load(struct play *p)
{
    struct tape *t = &p->kept;
    int status[2] = {DRAPE_OK, DRAPE_OK};
    if (!t->size)
        return NULL;
    size_t size = t->size, at = pick(&p->b, (uint32_t)size);
    int left = (int)pick(&p->b, 6) - 1;
    uint8_t flip = pick(&p->b, 2) ? (uint8_t)pick(&p->b, 256) : 0;
    t->data[at] ^= flip;
    t->size = pick(&p->b, 4) == 3 ? at : size;
    bool whole = t->size == size && !flip;
    for (int k = 0; k < 2 && p->world[k]; k++) {
        t->at = 0;
        t->left = left;
        status[k] = drape_load(p->world[k], tape_read, t);
    }
    t->data[at] ^= flip;
    t->size = size;
    EXPECT(!p->world[1] || status[0] == status[1]);
    if (status[0] != DRAPE_OK) {
        EXPECT(status[0] == DRAPE_EIO || status[0] == DRAPE_EMATCH);
        EXPECT(!whole || left >= 0);
        return play_unchanged(p);
    }
    EXPECT(whole && play_note(p, p->after) && tape_same(t, &p->after[0]));
    p->time = -1;
    p->pairs = -1;
    return NULL;
}

static const struct call {
    const char *name;
    play_call *run;
} calls[] = {{"drape_step", play_step},
             {"again", play_again},
             {"drape_set_wind", play_wind},
             {"drape_wake", play_wake},
             {"drape_set_gravity", play_gravity},
             {"drape_set_material", play_material},
             {"drape_set_positions", play_positions},
             {"drape_set_velocities", play_velocities},
             {"drape_set_pins", play_pins},
             {"drape_set_obstacle", play_obstacle},
             {"drape_contacts", play_contacts},
             {"drape_record", play_log},
             {"drape_save", play_save},
             {"drape_load", play_load},
             {"drape_read", play_read},
             {"drape_read_triangles", play_triangles},
             {"drape_first_vertex", play_first},
             {"drape_borrow", play_borrow},
             {"drape_plan", play_plan},
             {"drape_count", play_count},
             {"drape_add_cloth", play_add_cloth},
             {"drape_add_obstacle", play_add_obstacle},
             {"drape_remove", play_remove},
             {"drape_set_positions_device", play_positions_device},
             {"drape_set_velocities_device", play_velocities_device},
             {"drape_set_pins_device", play_pins_device},
             {"drape_set_obstacle_device", play_obstacle_device},
             {"drape_contacts_device", play_contacts_device},
             {"drape_clock", play_clock},
             {"drape_read_material", play_set_material},
             {"drape_read_wind", play_set_wind},
             {"drape_read_gravity", play_set_gravity},
             {"drape_seam_target", play_seam},
             {"drape_seam_state", play_seam},
             {"drape_are_sewn", play_seam}};
enum { CALLS = sizeof calls / sizeof *calls };

/* Makes calls drawn from the input; every other call is `often`. */
static const char *play(struct play *p, int often)
{
    enum { TURNS = 24 };
    const char *failed = NULL;
    p->time = 0;
    p->pairs = -1;
    for (int k = 0; k < TURNS && !failed; k++) {
        if (k > 2 && p->b.at >= p->b.n_data)
            break;
        int next = pick(&p->b, 2) ? often : (int)pick(&p->b, CALLS);
        if (!play_note(p, p->before))
            return "the backends' checkpoints differ";
        failed = calls[next].run(p);
    }
    return failed;
}

/* Makes the worlds, makes the calls, destroys the worlds. twins: one world for
 * each backend. */
static const char *play_all(struct play *p, int often, bool twins)
{
    drape_error error = {""};
    const char *failed = NULL;
    int status[2] = {DRAPE_OK, DRAPE_OK};
    for (int k = 0; k < 1 + twins; k++) {
        p->s.def.backend = twins ? k : p->s.def.backend;
        status[k] = drape_create(&p->s.def, &p->world[k], &error);
    }
    if (twins && status[0] != status[1])
        failed = "the backends do not refuse the same";
    if (status[0] == DRAPE_OK && !failed)
        failed = play(p, often);
    else if (!error.text[0] || status[0] == DRAPE_ENOMEM)
        failed = "a small world is refused without a reason";
    for (int k = 0; k < 2; k++)
        drape_destroy(p->world[k]);
    if (!failed && (p->s.host.held || p->s.host.blocks || p->s.device.held ||
                    p->s.host.wrong || p->s.device.wrong))
        failed = "memory was not given back as it was taken";
    return failed;
}

static const char *start(const uint8_t *data, size_t size, int often,
                         bool twins)
{
    static uint32_t words[DRAW_WORDS];
    static struct play p;
    memset(&p, 0, sizeof p);
    p.b = draw_open(data, size, words);
    p.most_steps = twins ? 3 : 8;
    small_make(&p.s, &p.b);
    if (!twins && pick(&p.b, 8) == 7) { /* emulation is slow */
        p.s.def.backend = DRAPE_GPU;
        p.most_steps = 2;
    }
    const char *failed = play_all(&p, often, twins);
    free(p.kept.data);
    free(p.log.data);
    for (int k = 0; k < 2; k++) {
        free(p.before[k].data);
        free(p.after[k].data);
    }
    choices_free(&p.b);
    return failed;
}

const char *fuzz_calls(const char *name, const uint8_t *data, size_t size)
{
    int often = 0;
    while (often + 1 < CALLS && strcmp(calls[often].name, name) != 0)
        often++;
    return start(data, size, often, false);
}

const char *fuzz_twins(const char *name, const uint8_t *data, size_t size)
{
    (void)name;
    return start(data, size, 0, true);
}
