/* SPDX-License-Identifier: Apache-2.0 */
/* A reel is a CUDA graph. What follows a fence is the body of an IF node behind
 * it, so that graphs lie one in another. gpu/run/reel.cuh */
#include "gpu/run/reel.cuh"

struct reel {
    cudaGraphExec_t graph;
};

/* Of the reel that is recorded. */
struct gpu_reel {
    cudaStream_t stream, callers; /* captured; g->stream meanwhile */
    cudaGraph_t whole, segment;   /* its first graph, and the last so far */
    bool on, failed;              /* launches are captured just now */
};

bool reel_spoils(struct gpu *g)
{
    bool on = g->reel && g->reel->on;
    if (on)
        g->reel->failed = true;
    return on;
}

#if CUDART_VERSION >= 13000

/* Thread t owns word t, as show_kernel's. */
static __global__ void __launch_bounds__(GPU_ALL_WORDS)
    look_kernel(int64_t *words, int64_t *seen, int64_t *kept, int64_t *told,
                struct reel_look k, cudaGraphConditionalHandle next)
{
    int t = (int)threadIdx.x;
    int64_t word = words[t];
    seen[t] = kept[t] = word;
    if (k.clear)
        words[t] = 0;
    __syncthreads();
    if (t == 0) {
        int64_t verdict = judge(&k, kept, told);
        told[TAPE_TOLD] = seen[VERDICT] = verdict;
        if (k.fence)
            cudaGraphSetConditional(next, verdict == GOES_ON);
    }
    __threadfence_system();
    __syncthreads();
    if (t == 0)
        *(volatile int64_t *)&seen[MARK] = 1;
}

static void expect_success(struct gpu_reel *l, cudaError_t error)
{
    if (error == cudaSuccess)
        return;
    l->failed = true;
    cudaGetLastError(); /* it is an answer */
}

bool reel_open(struct gpu *g, struct reel_memory *m)
{
    struct gpu_reel *l = g->reel;
    int shown = (int)REEL_LOOKS * SLOT + (int)TAPE_TOLD;
    int kept = (int)REEL_LOOKS * (int)GPU_ALL_WORDS + (int)TAPE_TOLD + 1;
    if (!gpu_loops_open(g))
        return false;
    l = (struct gpu_reel *)arena_take(&g->host, ARENA_OTHER, 1, sizeof *l);
    g->reel = l;
    m->kept = (int64_t *)gpu_take(g, ARENA_SCRATCH, kept, sizeof *m->kept);
    if (!l || !m->kept)
        return false;
    gpu_note(g, cudaMallocHost(&m->shown, (size_t)shown * sizeof *m->shown));
    gpu_note(g, cudaStreamCreateWithFlags(&l->stream, cudaStreamNonBlocking));
    return !g->failed;
}

void reel_close(struct gpu *g, struct reel_memory m)
{
    cudaFreeHost(m.shown);
    if (g->reel && g->reel->stream)
        cudaStreamDestroy(g->reel->stream);
}

/* ---- Recording ---- */

/* The last node that is captured. */
static cudaGraphNode_t last_node(struct gpu_reel *l)
{
    cudaStreamCaptureStatus status;
    const cudaGraphNode_t *last = NULL;
    size_t n = 0;
    expect_success(l, cudaStreamGetCaptureInfo(l->stream, &status, NULL, NULL,
                                               &last, NULL, &n));
    l->failed |= n != 1;
    return n == 1 ? last[0] : NULL;
}

static void follow(struct gpu_reel *l, cudaGraphNode_t node,
                   cudaGraphNode_t next)
{
    expect_success(l,
                   cudaGraphAddDependencies(l->segment, &node, &next, NULL, 1));
}

static void begin_capture(struct gpu_reel *l, cudaGraph_t graph)
{
    l->segment = graph;
    expect_success(
        l, cudaStreamBeginCaptureToGraph(l->stream, graph, NULL, NULL, 0,
                                         cudaStreamCaptureModeRelaxed));
}

static void end_capture(struct gpu_reel *l)
{
    cudaGraph_t graph;
    expect_success(l, cudaStreamEndCapture(l->stream, &graph));
}

void reel_record(struct gpu *g)
{
    struct gpu_reel *l = g->reel;
    l->failed = false;
    expect_success(l, cudaGraphCreate(&l->whole, 0));
    begin_capture(l, l->whole);
}

void reel_record_look(struct gpu *g, struct reel_memory m,
                      const struct reel_look *k)
{
    struct gpu_reel *l = g->reel;
    struct conditional c = {};
    if (k->fence)
        expect_success(l,
                       gpu_conditional(l->segment, cudaGraphCondTypeIf, 0, &c));
    look_kernel<<<1, GPU_ALL_WORDS, 0, l->stream>>>(
        g->words, shown_of(m, k->number), kept_of(m, k->number), told_of(m), *k,
        c.handle);
    expect_success(l, cudaGetLastError());
    if (!k->fence)
        return;
    cudaGraphNode_t last = last_node(l);
    end_capture(l);
    follow(l, last, c.node);
    begin_capture(l, c.body);
}

/* First where the stream is, then where it is captured. */
int reel_next(struct gpu *g, int left)
{
    struct gpu_reel *l = g->reel;
    if (left == 2) {
        gpu_note(g, cudaGetLastError());
        l->callers = g->stream;
        g->stream = l->stream;
        l->on = true;
        return 3;
    }
    g->stream = l->callers;
    l->on = false;
    expect_success(l, cudaGetLastError());
    return 0;
}

void reel_record_loop(struct gpu *g, const int32_t *again, loop_turn turn)
{
    struct gpu_reel *l = g->reel;
    struct conditional c = {};
    int status = DRAPE_OK;
    cudaStream_t callers = g->stream;
    g->tape = TAPE_OFF;
    l->on = true;
    if (again) {
        expect_success(
            l, gpu_conditional(l->segment, cudaGraphCondTypeWhile, 0, &c));
        gpu_loop_ask(l->stream, c.handle, again);
        follow(l, last_node(l), c.node);
        expect_success(l, cudaStreamUpdateCaptureDependencies(
                              l->stream, &c.node, NULL, 1,
                              cudaStreamSetCaptureDependencies));
        expect_success(l, gpu_loop_body(g, &c, again, turn, &status));
    } else {
        g->stream = l->stream;
        status = turn.run(turn.with);
        g->stream = callers;
        expect_success(l, cudaGetLastError());
    }
    l->on = false;
    g->tape = TAPE_RECORDS;
    l->failed |= status != DRAPE_OK;
}

struct reel *reel_recorded(struct gpu *g, bool good)
{
    struct gpu_reel *l = g->reel;
    struct reel *r = NULL;
    end_capture(l);
    if (good && !l->failed)
        r = (struct reel *)arena_take(&g->host, ARENA_OTHER, 1, sizeof *r);
    if (r)
        expect_success(l, cudaGraphInstantiate(&r->graph, l->whole, 0));
    cudaGraphDestroy(l->whole);
    if (!r || r->graph)
        return r;
    arena_give(&g->host, r);
    return NULL;
}

#else /* nodes that hold others came with CUDA 12.3, their edges with 13 */

bool reel_open(struct gpu *, struct reel_memory *)
{
    return false;
}
void reel_close(struct gpu *, struct reel_memory) {}
void reel_record(struct gpu *) {}
void reel_record_look(struct gpu *, struct reel_memory,
                      const struct reel_look *)
{
}
void reel_record_loop(struct gpu *, const int32_t *, loop_turn) {}
int reel_next(struct gpu *, int)
{
    return 0;
}
struct reel *reel_recorded(struct gpu *, bool)
{
    return NULL;
}

#endif

/* ---- Playing ---- */

void reel_play(struct gpu *g, struct reel *r)
{
    gpu_note(g, cudaGraphLaunch(r->graph, g->stream));
}

void reel_drop(struct gpu *g, struct reel *r)
{
    if (!r)
        return;
    cudaStreamSynchronize(g->stream); /* it may run still */
    cudaGraphExecDestroy(r->graph);
    arena_give(&g->host, r);
}

void reel_await(struct gpu *g, struct reel_memory m, int look)
{
    gpu_await(g, &shown_of(m, look)[MARK], 1);
}
