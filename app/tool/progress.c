/* SPDX-License-Identifier: Apache-2.0 */
/* Shows how far a run or a film is: one line that is rewritten on a terminal,
 * else a line every few seconds. Lets Ctrl-C end it between steps. */
#include "app/tool/progress.h"
#include "app/base/app.h"
#include "app/write/report.h"

#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

static volatile sig_atomic_t stopped;

static void stop(int signal_number)
{
    (void)signal_number;
    stopped = 1;
}

void progress_catch_stop(void)
{
    struct sigaction action;
    memset(&action, 0, sizeof action);
    action.sa_handler = stop;
    action.sa_flags = (int)SA_RESETHAND;
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
}

bool progress_stopped(void)
{
    return stopped != 0;
}

double seconds_now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

void progress_begin(struct progress *p, int64_t first, int64_t total)
{
    *p = (struct progress){.terminal = isatty(STDERR_FILENO) != 0,
                           .first = first,
                           .total = total,
                           .began = seconds_now()};
}

static void duration(double seconds, char text[32])
{
    int s = seconds < 359999 ? (int)(seconds + 0.5) : 359999;
    if (s < 3600)
        snprintf(text, 32, "%d:%02d", s / 60, s % 60);
    else
        snprintf(text, 32, "%d:%02d:%02d", s / 3600, s / 60 % 60, s % 60);
}

void progress_show(struct progress *p, int64_t done, const char *words)
{
    double now = seconds_now();
    int64_t new = done - p->first, left = p->total - done;
    /* a terminal is updated ten times a second, a log every 5 s */
    if (app_quiet || (now - p->printed < (p->terminal ? 0.1 : 5) && left > 0))
        return;
    p->printed = now;
    char eta[32], bar[21];
    double spent = now - p->began;
    duration(new > 0 ? spent / (double)new *(double)left : 0, eta);
    for (int k = 0; k < 20; k++)
        bar[k] = 20 * done > k * p->total ? '#' : '.';
    bar[20] = 0;
    fprintf(stderr, "%s[%s] %s  ETA %s%s", p->terminal ? "\r" : "", bar, words,
            eta, p->terminal ? "\033[K" : "\n");
    fflush(stderr);
}

void progress_step(struct progress *p, const drape_step_report *step)
{
    char words[128], line[320];
    snprintf(line, sizeof line,
             "step %lld/%lld  contacts %lld  rounds %d  iterations %d  %s",
             (long long)step->step, (long long)p->total,
             (long long)step->contacts, step->rounds, step->iterations,
             report_outcome(step->outcome, words));
    progress_show(p, step->step, line);
}

void progress_end(struct progress *p)
{
    if (p->terminal && p->printed > 0)
        fputc('\n', stderr);
}
