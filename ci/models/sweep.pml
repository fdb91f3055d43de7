/* SPDX-License-Identifier: Apache-2.0 */
/* The sweep of a product down a strip of three columns, a thread each: rows of x in a
 * ring, pulls in two halves, and edges that bulk copies bring into one of two stages. A
 * copy lands at any time after the thread asked; the stage's mbarrier tells.
 * code gpu/solve/sweep.cuh sweep_kernel: bulk_open(&stage.row[lane], EDGES) __syncthreads stage row= __syncthreads passed bulk_wait(&stage.row[w.j % STAGES], (w.j - first) / STAGES) stage row row= __syncthreads stage
 * code gpu/solve/sweeper.cuh ask_row: bulk_ask(&s->row[stage], s->edge[stage][o], from, wanted ? (w->end - w->low) * (int)sizeof(B) : 0)
 */
#define THREADS 3
#define BLOCK 3
#define ROWS 5 /* that the block owns */
#define X_ROWS 4
#define STAGES 2
#define EDGES 2 /* copies of a stage */
#define X 0     /* [X_ROWS][THREADS] */
#define PASSED 12 /* [2][THREADS] */
#define EDGE 18   /* [STAGES][EDGES] */
#define OPEN 22   /* [STAGES] the mbarriers */
#define CELLS 24
#include "memory.pml"

byte asked[STAGES]; /* copies of the round that have been asked for */
byte landed[STAGES];
byte rounds[STAGES]; /* those that are complete: the mbarrier's phase */

inline bulk_open(t)
{
    d_step
    {
        if
        :: t < STAGES -> store(t, OPEN + t, 1)
        :: else
        fi
    }
}

inline bulk_ask(t, stage)
{
    d_step
    {
        load(t, OPEN + stage);
        store(t, EDGE + stage * EDGES + t, 0);
        written[EDGE + stage * EDGES + t] = 0;
        asked[stage]++
    }
}

/* True once the round is complete; all its copies are then seen. The phase is one bit. */
inline bulk_wait(t, stage, round)
{
    rounds[stage] % 2 != (round) % 2;
    d_step
    {
        written[EDGE + stage * EDGES] = written[EDGE + stage * EDGES] | BIT(t);
        written[EDGE + stage * EDGES + 1] = written[EDGE + stage * EDGES + 1] | BIT(t)
    }
}

inline ask_row(t, j)
{
    if
    :: t < EDGES -> bulk_ask(t, (j) % STAGES)
    :: else
    fi
}

inline sweep_kernel(t)
{
    bulk_open(t);
    block_sync(t);
    ask_row(t, 0);
    ask_row(t, 1);
    d_step
    {
        store(t, X + t, 0);
        store(t, X + THREADS + t, 0);
        store(t, X + 2 * THREADS + t, 0)
    };
    block_sync(t);
    j = 0;
    do
    :: j < ROWS ->
        bulk_wait(t, j % STAGES, j / STAGES);
        d_step
        {
            /* the neighbours' x in this row and the two below, and the stage's edges */
            load_all(t, X + j % X_ROWS * THREADS, THREADS);
            load_all(t, X + (j + 1) % X_ROWS * THREADS, THREADS);
            load_all(t, X + (j + 2) % X_ROWS * THREADS, THREADS);
            load_all(t, EDGE + j % STAGES * EDGES, EDGES);
            store(t, PASSED + j % 2 * THREADS + t, 0);
            store(t, X + (j + 3) % X_ROWS * THREADS + t, 0)
        };
        block_sync(t);
        if
        :: j + STAGES < ROWS -> ask_row(t, j + STAGES)
        :: else
        fi;
        d_step { load_all(t, PASSED + j % 2 * THREADS, THREADS) };
        j++
    :: else -> break
    od
}

/* The hardware. A round ends when all its copies have been asked for and have landed. */
active proctype copies()
{
    byte s;
end:
    do
    :: atomic
       {
           if
           :: asked[0] > landed[0] -> s = 0
           :: asked[1] > landed[1] -> s = 1
           fi;
           landed[s]++;
           if
           :: landed[s] == EDGES ->
               landed[s] = 0;
               asked[s] = asked[s] - EDGES;
               rounds[s]++
           :: else
           fi
       }
    od
}

proctype thread(byte t)
{
    bit turn;
    byte j;
    sweep_kernel(t)
}

START
